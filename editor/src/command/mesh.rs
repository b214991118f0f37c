//! `surefoot mesh`: the surface of a scene as triangles.

use super::bar::LateBar;
use super::values::{self, Setting};
use super::console::{Exit, Failure, ends_wrong, print, spare};
use crate::files;
use crate::measures::powers;
use crate::meshes::Format;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use surefoot_compiler::contour::{self, Certificate, Detail, MOST_CELLS, Mesh, Refused, Settings};
use surefoot_compiler::diagnostic::Code;
use surefoot_compiler::functions::Kind;
use surefoot_compiler::measure::ends_now;
use surefoot_compiler::unit::Unit;
use surefoot_compiler::{Compiled, Options};

/// The surface of what, how fine, and where to.
#[derive(Debug, clap::Args)]
#[command(after_help = "\
--certify proves two things by interval arithmetic: no part of the surface is farther from the mesh than the tolerance, and no part of the \
mesh is farther from the surface. So a piece of surface that the mesh lacks is one that lies within the tolerance of the mesh all over. The \
tolerance is that of --tolerance, or half a cell. The surface is where the field changes its sign. The field is the formula of the scene in \
exact numbers, with constants and parameters rounded to 32 bits. The surface is looked for in the extent of the scene, or in the box of --within. The \
mesh is the one in the file. The proof relies on this program, and on the library functions of the processor's language to four units in \
the last place; no claim and no bound of the scene is used.")]
pub struct Args {
    /// The scene.
    scene: String,
    /// The file to write: STL, OBJ, PLY, GLB or 3MF, by the ending of its name. All but STL include colours. With `render { unit: mm }` a 3MF states that unit, STL is in millimetres and GLB in metres.
    #[arg(short, long, value_parser = output, value_name = "FILE")]
    output: PathBuf,
    /// Cells along the longest side of the solid.
    #[arg(long, default_value_t = 128, value_parser = clap::value_parser!(u32).range(2..=i64::from(MOST_CELLS)), value_name = "N")]
    resolution: u32,
    /// Use as many cells as needed until no triangle is found farther from the surface than this.
    #[arg(long, conflicts_with = "resolution", allow_negative_numbers = true, value_parser = above_zero, value_name = "LENGTH")]
    tolerance: Option<f64>,
    /// Round edges and corners off by less than a cell. Without this they stay sharp.
    #[arg(long)]
    smooth: bool,
    /// Prove how far the surface is from the mesh at most, and the mesh from the surface. Ends with code 1 if some part is proven to be farther than the tolerance, and with code 4 if some part is undecided.
    #[arg(long)]
    certify: bool,
    /// Cut the solid off at a box, and close it there. An infinite solid needs this.
    #[arg(long, allow_hyphen_values = true, value_parser = corners, value_name = "(X,Y,Z)..(X,Y,Z)")]
    within: Option<[[f64; 3]; 2]>,
    /// The time, in seconds.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true, value_parser = number, value_name = "SECONDS")]
    time: f64,
    /// Set a parameter.
    #[arg(long, value_parser = values::setting, value_name = "NAME=VALUE")]
    set: Vec<Setting>,
}

/// Reads a finite number.
pub(super) fn number(text: &str) -> Result<f64, String> {
    text.trim().parse().ok().filter(|n: &f64| n.is_finite()).ok_or_else(|| "write a number".to_owned())
}

/// Reads a number above zero.
pub(super) fn above_zero(text: &str) -> Result<f64, String> {
    number(text).ok().filter(|n| *n > 0.0).ok_or_else(|| "write a number above zero".to_owned())
}

/// Reads `(-1, 0, -1)..(1, 2, 1)`; the parentheses may be left out.
pub(super) fn corners(text: &str) -> Result<[[f64; 3]; 2], String> {
    let corner = |text: &str| {
        let text = text.trim();
        let text = text.strip_prefix('(').and_then(|t| t.strip_suffix(')')).unwrap_or(text);
        let numbers: Vec<f64> = text.split(',').map_while(|part| number(part).ok()).collect();
        <[f64; 3]>::try_from(numbers).ok().filter(|_| text.split(',').count() == 3)
    };
    let found = text.split_once("..").and_then(|(low, high)| Some([corner(low)?, corner(high)?]));
    let [low, high] = found.ok_or("write two corners, as (-1,0,-1)..(1,2,1)")?;
    match low.iter().zip(high).all(|(low, high)| *low < high) {
        true => Ok([low, high]),
        false => Err("each coordinate of the second corner is above that of the first".to_owned()),
    }
}

/// The tolerance of a certificate, as a part of a cell, where none is given.
pub(super) const CERTIFIED: f64 = 0.5;

fn format_of(path: &Path) -> Option<Format> {
    let ending = path.extension()?.to_str()?.to_ascii_lowercase();
    Format::ALL.into_iter().find(|format| format.ending() == ending)
}

fn output(text: &str) -> Result<PathBuf, String> {
    let path = PathBuf::from(text);
    if format_of(&path).is_some() {
        return Ok(path);
    }
    let endings = Format::ALL.map(|format| format!(".{}", format.ending())).join(", ");
    Err(match ends_wrong(&path, &Format::ALL.map(Format::ending)) {
        Some(words) => format!("the name ends with one of {endings}; {words}"),
        None => format!("the name ends with one of {endings}"),
    })
}

/// Finds the surface and writes it.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let (outcome, live) = values::read(&args.scene, &args.set, &Options::default())?;
    let (Some(compiled), Some(mut live)) = (&outcome.compiled, live) else { return Ok(Exit::Errors) };
    live.time = args.time;
    compiled.settle(&mut live);
    spare(&args.output, &outcome)?;
    let refused = |words: String| Failure { exit: Exit::Errors, words: format!("{}: {words}", args.scene) };
    if outcome.diagnostics.iter().any(|d| d.code == Code::NothingSolid) {
        return Err(refused("nothing is solid, so there is no surface".to_owned()));
    }
    if compiled.summary.kind == Kind::Unproven {
        eprintln!("note: the bound of this scene is measured and not proven: a small piece of its surface may be missed");
    }
    let detail = args.tolerance.map_or(Detail::Cells(args.resolution), Detail::Tolerance);
    let within = args.within.or_else(|| ends_now(compiled, &live));
    let settings = Settings { detail, sharp: !args.smooth, within };
    let bar = LateBar::new();
    let mesh = contour::contour(compiled, &live, &settings, &|part| bar.show(part));
    bar.finish();
    let mesh = mesh.map_err(|why| refused(words(&why, compiled)))?;
    // Whoever is told that a file was written can rely on it.
    let format = format_of(&args.output).unwrap_or(Format::Stl);
    let bytes = format.bytes(&mesh, compiled.blocks.unit).map_err(refused)?;
    files::write(&args.output, &bytes).map_err(|why| Failure::usage(format!("can't write {}: {why}", args.output.display())))?;
    print(summary(&args.output, &mesh, compiled.blocks.unit).as_bytes())?;
    if !args.certify {
        return Ok(Exit::Fine);
    }
    let bar = LateBar::new();
    let tolerance = args.tolerance.unwrap_or(CERTIFIED * mesh.cell);
    let found = contour::certify(compiled, &live, &format.rounded(&mesh, compiled.blocks.unit), within, tolerance, &|part| bar.show(part));
    bar.finish();
    let found = found.map_err(|why| refused(why.to_string()))?;
    print(certified(&found, compiled.blocks.unit).as_bytes())?;
    Ok(if found.to_mesh.farther + found.to_surface.farther > 0 {
        Exit::Errors
    } else if found.holds() {
        Exit::Fine
    } else {
        Exit::Undecided
    })
}

/// What was proven, for a person.
fn certified(found: &Certificate, unit: Option<Unit>) -> String {
    let [long, ..] = powers(unit);
    let verdict = if found.holds() { "certified" } else { "not certified" };
    let mut text = format!("  {verdict} to {:.3e}{long}\n", found.tolerance);
    for (from, to, parts, way) in [("surface", "mesh", "cells", &found.to_mesh), ("mesh", "surface", "triangles", &found.to_surface)] {
        let place = |at: [f64; 3]| format!("near ({})", at.map(|c| format!("{c:.4}")).join(", "));
        let _ = write!(text, "  from {from} to {to}: {} {parts}, ", way.parts);
        let _ = match way.proven.is_finite() {
            true => write!(text, "all of them proven to be within {:.3e}{long}", way.proven),
            false => write!(text, "nothing is proven of some, as {}", place(way.at)),
        };
        for (count, what) in [(way.farther, "proven to be farther"), (way.undecided, "undecided")] {
            let _ = write!(text, "; {count} {what}");
        }
        if let Some(at) = way.wrong {
            let _ = write!(text, ", as {}", place(at));
        }
        text.push('\n');
    }
    text
}

/// Why a scene has no mesh, or nothing to measure, and what to do about it.
pub(super) fn words(why: &Refused, compiled: &Compiled) -> String {
    match why {
        Refused::Endless => {
            let ask = "it is cut off and closed at a box that is asked for, as `--within=\"(-1,0,-1)..(1,2,1)\"`";
            match compiled.solid_box().filter(|solid| solid.but_planes) {
                Some(solid) => {
                    let corner = |c: [f64; 3]| c.map(|c| format!("{}", (c * 1e4).round() / 1e4)).join(",");
                    let within = format!("--within=\"({})..({})\"", corner(solid.low), corner(solid.high));
                    format!("{why}: {ask}. But for its planes all that is solid lies in `{within}`")
                }
                None => format!("{why}: {ask}"),
            }
        }
        Refused::Beyond(_) => format!("{why}: take a smaller box, or write `render {{ extent: … }}`"),
        Refused::TooMany(_) => format!("{why}: take fewer, or a part of it with `--within`"),
        _ => why.to_string(),
    }
}

/// What was written, for a person.
fn summary(path: &Path, mesh: &Mesh, unit: Option<Unit>) -> String {
    let [long, wide, deep] = powers(unit);
    let found = mesh.examine();
    let corner = |c: [f64; 3]| c.map(|c| format!("{c:.4}")).join(", ");
    let [low, high] = found.bounds.map(corner);
    let pieces = if found.pieces == 1 { "1 piece".to_owned() } else { format!("{} pieces", found.pieces) };
    format!(
        "{}: {} vertices, {} triangles, each edge in two of them\n  {pieces}, Euler number {}, volume {:.6}{deep}, area {:.6}{wide}, from ({low}) to ({high}){long}\n  \
         {} cells along the longest side, each {:.3e}{long}; the farthest triangle found is {:.3e}{long} from the surface\n",
        path.display(),
        mesh.vertices.len(),
        mesh.triangles.len(),
        found.euler,
        found.volume,
        found.area,
        mesh.cells,
        mesh.cell,
        mesh.deviation,
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn boxes_are_two_corners() {
        let found = Ok([[-1.0, 0.0, -1.5], [1.0, 2.0, 1.0]]);
        assert_eq!(corners("(-1, 0, -1.5)..(1,2,1)"), found);
        assert_eq!(corners("-1,0,-1.5..1,2,1"), found);
        for wrong in ["", "1,2,3", "(0,0)..(1,1)", "(0,0,0)..(1,0,1)", "(0,0,0)..(1,1,x)", "(0,0,0,0)..(1,1,1)", "(0,0,0)..(1,1,inf)"] {
            assert!(corners(wrong).is_err(), "{wrong}");
        }
    }
}
