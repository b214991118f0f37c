//! `surefoot bake`: a mesh as a grid of signed distances.

use super::bar::LateBar;
use super::console::{Exit, Failure, ends_wrong, print};
use crate::files::FileLoader;
use std::fmt::Write;
use std::path::PathBuf;
use std::time::Instant;
use surefoot_compiler::sampled::{self, BRICK, Findings, Grid, Measured, RESOLUTIONS, Settings, Surface};
use surefoot_runtime::mesh::Mesh;

/// Places at which the report compares grid and mesh, all over the grid, and as many near the surface.
const PLACES: usize = 20_000;

/// What to sample, and how.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The mesh: an OBJ, STL, PLY, glTF or GLB file.
    mesh: String,
    /// The grid to write; its name ends with .sfgrid.
    #[arg(short, long, value_parser = grid, value_name = "FILE")]
    output: PathBuf,
    /// Cells along the longest side, rounded up to whole bricks of 8.
    #[arg(long, default_value_t = 128, value_parser = resolution, value_name = "N")]
    resolution: u32,
    /// Margin around the mesh, as a fraction of its longest side: 0.01 to 1.
    #[arg(long, default_value_t = 0.05, value_parser = padding, value_name = "SHARE")]
    padding: f64,
    /// How to tell inside from outside.
    #[arg(long, value_enum, default_value_t)]
    sign: Sign,
    /// Report the defects of the mesh, and the error of the grid at random places.
    #[arg(long)]
    report: bool,
}

/// The ways to find sides, as the command line names them.
#[derive(Clone, Copy, Debug, Default, clap::ValueEnum)]
enum Sign {
    /// By pseudonormals if the mesh is closed, faces one way and does not cross itself; otherwise by winding numbers.
    #[default]
    Auto,
    /// By the normals of the nearest face, edge or corner.
    Pseudonormal,
    /// By the winding number of the triangles about a point; works for meshes with holes.
    Winding,
    /// By the number of triangles that a ray crosses, whichever way they face.
    Parity,
}

impl From<Sign> for sampled::Sign {
    fn from(sign: Sign) -> Self {
        match sign {
            Sign::Auto => Self::Auto,
            Sign::Pseudonormal => Self::Pseudonormal,
            Sign::Winding => Self::Winding,
            Sign::Parity => Self::Parity,
        }
    }
}

fn grid(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    match path.extension().and_then(|e| e.to_str()) {
        Some("sfgrid") => Ok(path),
        _ => Err(match ends_wrong(&path, &["sfgrid"]) {
            Some(words) => format!("the name ends with .sfgrid; {words}"),
            None => "the name ends with .sfgrid".to_owned(),
        }),
    }
}

fn resolution(text: &str) -> Result<u32, String> {
    let wrong = || format!("write a whole number from {} to {}", RESOLUTIONS.start(), RESOLUTIONS.end());
    text.parse().ok().filter(|cells| RESOLUTIONS.contains(cells)).ok_or_else(wrong)
}

fn padding(text: &str) -> Result<f64, String> {
    text.parse().ok().filter(|share| (0.01..=1.0).contains(share)).ok_or_else(|| "write a share from 0.01 to 1".to_owned())
}

/// Samples, and writes.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let begun = Instant::now();
    let refused = |why: String| Failure::usage(format!("can't bake {}: {why}", args.mesh));
    let mesh = Mesh::load(&FileLoader, &args.mesh).map_err(refused)?;
    let positions: Vec<[f64; 3]> = mesh.vertices.iter().map(|vertex| vertex.position.map(f64::from)).collect();
    let triangles: Vec<[u32; 3]> = mesh.indices.as_chunks().0.to_vec();
    drop(mesh);
    let surface = Surface::new(&positions, &triangles, args.sign.into()).map_err(refused)?;
    let settings = Settings { resolution: args.resolution, padding: args.padding };
    let bar = LateBar::new();
    let grid = sampled::bake(&surface, settings, &|part| bar.show(part)).map_err(refused);
    bar.finish();
    let grid = grid?;
    let bytes = grid.to_bytes();
    let why = |why| Failure::usage(format!("can't write {}: {why}", args.output.display()));
    crate::files::write(&args.output, &bytes).map_err(why)?;
    let took = begun.elapsed().as_secs_f64();
    let mut text = String::new();
    if args.report {
        examined(&mut text, &args.mesh, &surface);
    } else if let Some(wrong) = wrong(&surface.findings) {
        eprintln!("note: {} has {wrong}; sides are found by {}", args.mesh, surface.sign.name());
    }
    let [x, y, z] = grid.shape().bricks.map(|bricks| bricks as usize * BRICK);
    let _ = writeln!(
        text,
        "{}: {x} × {y} × {z} cells of side {:.6}, {} of {} bricks with samples, {} bytes, {took:.2} s",
        args.output.display(),
        grid.shape().cell,
        grid.fine_bricks(),
        grid.shape().count(),
        bytes.len(),
    );
    if args.report {
        compared(&mut text, &grid, &surface);
    }
    print(text.as_bytes())?;
    Ok(Exit::Fine)
}

/// What was found in a mesh.
fn examined(text: &mut String, name: &str, surface: &Surface) {
    let findings = &surface.findings;
    let volume = findings.volume.map_or(String::new(), |volume| format!(", volume {volume:.6}"));
    let vertices = many(findings.vertices, "vertex", "vertices");
    let [triangles, shells] = [(findings.triangles, "triangle"), (findings.shells, "shell")].map(|(count, one)| many(count, one, &format!("{one}s")));
    let _ = writeln!(text, "{name}: {vertices}, {triangles}, {shells}{volume}");
    let _ = writeln!(text, "  found: {}", wrong(findings).unwrap_or_else(|| "nothing wrong".to_owned()));
    let _ = writeln!(text, "  sides by {}", surface.sign.name());
}

/// How far a grid is from a mesh.
fn compared(text: &mut String, grid: &Grid, surface: &Surface) {
    let steepest = grid.facts().iter().fold(0.0f32, |most, facts| most.max(facts.lipschitz));
    let _ = writeln!(text, "  the value changes by at most {steepest:.3} times the way");
    let [all, near] = sampled::measure(grid, surface, PLACES);
    for (measured, place) in [(all, "of the grid"), (near, "within a cell of the surface")] {
        let Measured { places, largest, mean, wrong, farthest, .. } = measured;
        let side = if wrong == 0 { "no wrong side".to_owned() } else { format!("{wrong} on the wrong side, at most {farthest:.2e} from the surface") };
        let _ = writeln!(text, "  off by at most {largest:.2e}, in the mean {mean:.2e}, {side}: at {places} places {place}");
    }
}

/// What is wrong with a mesh, in words; none where nothing is.
fn wrong(findings: &Findings) -> Option<String> {
    let rows = [
        (findings.open_edges, "open edge", "open edges"),
        (findings.branching_edges, "edge of more than two triangles", "edges of more than two triangles"),
        (findings.turned, "triangle that faced the wrong way", "triangles that faced the wrong way"),
        (findings.one_sided_edges, "edge of a surface with one side", "edges of a surface with one side"),
        (findings.inside_out, "shell that was inside out", "shells that were inside out"),
        (findings.overlapping, "shell within another that faces the same way", "shells within or across others"),
        (findings.crossing_edges, "edge that goes through a triangle", "edges that go through a triangle"),
        (findings.pinched, "corner at which parts merely touch", "corners at which parts merely touch"),
        (findings.duplicates, "triangle that was there already", "triangles that were there already"),
        (findings.flat, "triangle without area", "triangles without area"),
        (findings.needles, "needle", "needles"),
    ];
    let found: Vec<String> = rows.into_iter().filter(|(count, ..)| *count > 0).map(|(count, one, more)| many(count, one, more)).collect();
    (!found.is_empty()).then(|| found.join(", "))
}

fn many(count: usize, one: &str, more: &str) -> String {
    format!("{count} {}", if count == 1 { one } else { more })
}
