//! `surefoot bench --certified`: what is proven of the meshes of scenes.

use crate::command::bar::LateBar;
use crate::command::console::{Exit, Failure, compile_file, print};
use crate::command::mesh::{CERTIFIED, words};
use crate::command::page;
use crate::meshes::Format;
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;
use surefoot_compiler::Options;
use surefoot_compiler::contour::{self, Detail, Settings, Way};
use surefoot_compiler::measure::ends_now;

/// Meshes and certifies each scene at its first moment, and prints a table; with a page, writes it there. A scene without a mesh has a line that says why.
pub fn run(scenes: &[String], cells: u32, page: Option<&Path>) -> Result<Exit, Failure> {
    let mut table = String::from(
        "| scene | triangles | cell | tolerance | surface to mesh | cells, undecided, farther | mesh to surface | undecided, farther triangles | undecided ‰ | mesh s | proof s |\n\
         |---|---|---|---|---|---|---|---|---|---|---|\n",
    );
    let mut refused = String::new();
    for path in scenes {
        let outcome = compile_file(path, &Options::default())?;
        let compiled = outcome.compiled.ok_or_else(|| Failure::usage(format!("{path} does not compile")))?;
        let name = Path::new(path).file_stem().and_then(|name| name.to_str()).unwrap_or(path);
        let live = compiled.live();
        let within = ends_now(&compiled, &live);
        let bar = LateBar::new();
        let start = Instant::now();
        let settings = Settings { detail: Detail::Cells(cells), sharp: true, within };
        let mesh = match contour::contour(&compiled, &live, &settings, &|part| bar.show(0.2 * part)) {
            Ok(mesh) => mesh,
            Err(why) => {
                bar.finish();
                let _ = writeln!(refused, "- {name}: {}", words(&why, &compiled));
                continue;
            }
        };
        let meshed = start.elapsed().as_secs_f64();
        let tolerance = CERTIFIED * mesh.cell;
        let read = Format::Stl.rounded(&mesh, compiled.blocks.unit);
        let start = Instant::now();
        let found = contour::certify(&compiled, &live, &read, within, tolerance, &|part| bar.show(0.2 + 0.8 * part));
        let found = found.map_err(|why| Failure::usage(format!("{path}: {why}")))?;
        bar.finish();
        let length = |way: &Way| if way.proven.is_finite() { format!("{:.2e}", way.proven) } else { "unknown".to_owned() };
        let (cover, near) = (&found.to_mesh, &found.to_surface);
        let row = format!(
            "| {name} | {} | {:.2e} | {tolerance:.2e} | {} | {}, {}, {} | {} | {}, {} | {:.2} | {meshed:.1} | {:.1} |\n",
            mesh.triangles.len(),
            mesh.cell,
            length(cover),
            cover.parts,
            cover.undecided,
            cover.farther,
            length(near),
            near.undecided,
            near.farther,
            1000.0 * (cover.undecided + near.undecided) as f64 / (cover.parts + near.parts).max(1) as f64,
            start.elapsed().as_secs_f64(),
        );
        print(row.as_bytes())?;
        table.push_str(&row);
    }
    print(refused.as_bytes())?;
    if let Some(file) = page {
        page::put(file, "certified", &on_page(file, scenes, &table, &refused, cells))?;
    }
    Ok(Exit::Fine)
}

fn on_page(file: &Path, scenes: &[String], table: &str, refused: &str, cells: u32) -> String {
    let without = if refused.is_empty() { String::new() } else { format!("\nScenes without a mesh:\n\n{refused}") };
    let slow = if cfg!(debug_assertions) { " Times are those of a debug build." } else { "" };
    format!(
        "# What is proven of meshes\n\n\
         Written by `surefoot bench --certified {} --cells {cells} --page {}` on a machine with {} threads.{slow}\n\n\
         `surefoot mesh SCENE.sdf -o OUT.stl --certify` proves by interval arithmetic how far the surface is from the mesh at most, and the mesh\n\
         from the surface. Each mesh here has {cells} cells along its longest side. The tolerance is half a cell. *Surface to mesh* and *mesh to\n\
         surface* are the proven distances: no point is farther. They include undecided cells and triangles, and those that are proven to be\n\
         farther than the tolerance.\n\n\
         A part that is *farther* is no failure of the proof: the mesh misses something there. It can be a detail smaller than a cell, or a crack between\n\
         two solids of a union whose faces are flush but for rounding.\n\n{table}{without}",
        scenes.join(" "),
        file.display(),
        std::thread::available_parallelism().map_or(1, usize::from),
    )
}
