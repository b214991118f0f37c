//! `surefoot measure`: what a solid measures, each number with its error.

use super::bar::LateBar;
use super::console::{Exit, Failure, print};
use super::mesh::{above_zero, corners, number, powers, words};
use super::values::{self, Setting};
use serde_json::{Value, json};
use std::fmt::Write;
use surefoot_compiler::Options;
use surefoot_compiler::diagnostic::Code;
use surefoot_compiler::unit::Unit;
use surefoot_compiler::measure::{Across, Known, Line, Measured, Settings, measure};

/// Pieces that are listed for a person.
const LISTED: usize = 20;

/// What to measure, and how well.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The scene.
    scene: String,
    /// For machines: one JSON object.
    #[arg(long)]
    json: bool,
    /// Find lengths to this, and the volume to this times the area. Without it: five millionths of the longest side.
    #[arg(long, allow_negative_numbers = true, value_parser = above_zero, value_name = "LENGTH")]
    tolerance: Option<f64>,
    /// Cut the solid off at a box. An infinite solid needs this.
    #[arg(long, allow_hyphen_values = true, value_parser = corners, value_name = "(X,Y,Z)..(X,Y,Z)")]
    within: Option<[[f64; 3]; 2]>,
    /// Follow a line from one point to another: how far it goes through the solid and through air.
    #[arg(long, allow_hyphen_values = true, value_parser = ends, value_name = "X,Y,Z X,Y,Z")]
    line: Option<[[f64; 3]; 2]>,
    /// Find the thinnest wall and the narrowest gap too.
    #[arg(long)]
    walls: bool,
    /// The time, in seconds.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true, value_parser = number, value_name = "SECONDS")]
    time: f64,
    /// Set a parameter.
    #[arg(long, value_parser = values::setting, value_name = "NAME=VALUE")]
    set: Vec<Setting>,
}

/// Reads `0,0,0 1,2,3`; parentheses and two dots between the points may be written.
fn ends(text: &str) -> Result<[[f64; 3]; 2], String> {
    let text = text.replace("..", " ");
    let parts = text.split(|c: char| c.is_whitespace() || "(),".contains(c)).filter(|part| !part.is_empty());
    let numbers: Option<Vec<f64>> = parts.map(|part| number(part).ok()).collect();
    match numbers.as_deref() {
        Some([a, b, c, d, e, f]) if [a, b, c] != [d, e, f] => Ok([[*a, *b, *c], [*d, *e, *f]]),
        _ => Err("write two points that are not the same, as 0,0,0 1,2,3".to_owned()),
    }
}

/// Measures and prints.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let (outcome, live) = values::read(&args.scene, &args.set, &Options::default())?;
    let (Some(compiled), Some(mut live)) = (&outcome.compiled, live) else { return Ok(Exit::Errors) };
    live.time = args.time;
    compiled.settle(&mut live);
    let refused = |words: String| Failure { exit: Exit::Errors, words: format!("{}: {words}", args.scene) };
    if outcome.diagnostics.iter().any(|d| d.code == Code::NothingSolid) {
        return Err(refused("nothing is solid, so there is nothing to measure".to_owned()));
    }
    let settings = Settings { tolerance: args.tolerance, within: args.within, line: args.line, walls: args.walls };
    let bar = LateBar::new();
    let found = measure(compiled, &live, &settings, &|part| bar.show(part));
    bar.finish();
    let found = found.map_err(|why| refused(words(&why, compiled)))?;
    let text = if args.json { format!("{:#}\n", in_json(args, &found, compiled.blocks.unit)) } else { in_words(args, &found, compiled.blocks.unit) };
    print(text.as_bytes())?;
    Ok(Exit::Fine)
}

/// A number with the digits that its error leaves, and no zeros at its end.
fn digits(value: f64, error: f64) -> String {
    let decimals = if error > 0.0 { (-error.log10().floor()).clamp(0.0, 12.0) as usize } else { 12 };
    let text = format!("{value:.decimals$}");
    let short = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if short == "-0" { "0".to_owned() } else { short.to_owned() }
}

fn place(of: [Known; 3]) -> String {
    format!("({})", of.map(|c| digits(c.value, worst(&of))).join(", "))
}

fn worst(of: &[Known]) -> f64 {
    of.iter().map(|known| known.error).fold(0.0, f64::max)
}

/// `4.18879 ± 2.4e-5, proven`
fn with_error(known: Known, unit: &str) -> String {
    let how = match (known.is_proven, known.proven.is_finite()) {
        (true, _) => "proven".to_owned(),
        (false, true) => {
            let [lo, hi] = [known.proven.lo, known.proven.hi].map(|end| digits(end, 0.1 * known.proven.width()));
            format!("estimated; proven from {lo} to {hi}")
        }
        (false, false) => "estimated".to_owned(),
    };
    format!("{} ± {:.1e}{unit}, {how}", digits(known.value, known.error), known.error)
}

/// For a person.
fn in_words(args: &Args, found: &Measured, unit: Option<Unit>) -> String {
    let [long, wide, deep] = powers(unit);
    let mut text = format!("{}\n", args.scene);
    let mut line = |name: &str, words: String| {
        let _ = writeln!(text, "  {name:<15} {words}");
    };
    let [low, high] = found.bounds;
    let error = worst(&found.bounds.concat());
    let how = match found.bounds.concat().iter().all(|side| side.is_proven) {
        true => "proven".to_owned(),
        false => {
            let outer = |end: fn(&Known) -> f64, of: [Known; 3]| format!("({})", of.map(|c| digits(end(&c), 0.1 * error)).join(", "));
            format!("estimated; it is proven that nothing solid lies beyond {} and {}", outer(|c| c.proven.lo, low), outer(|c| c.proven.hi, high))
        }
    };
    line("box", format!("from {} to {}, each side ± {error:.1e}{long}, {how}", place(low), place(high)));
    let sides = [0, 1, 2].map(|i| digits(high[i].value - low[i].value, low[i].error + high[i].error));
    line("size", format!("{}{long}", sides.join(" × ")));
    line("volume", with_error(found.volume, &deep));
    line("area", with_error(found.area, &wide));
    let how = if found.centre.iter().all(|c| c.is_proven) { "proven" } else { "estimated" };
    line("centre of mass", format!("{} ± {:.1e}{long}, {how}", place(found.centre), worst(&found.centre)));
    let cells = found.cells.iter().map(u32::to_string).collect::<Vec<_>>().join(", ");
    let settled = match found.settled {
        true => format!("the same with {cells} cells along the longest side"),
        false => format!("not the same with {cells} cells along the longest side, so some may be missed or joined"),
    };
    line("pieces", format!("{}, {settled}; what is smaller than {:.1e}{long} may be missed", found.pieces.len(), found.cell));
    for (i, piece) in found.pieces.iter().take(LISTED).enumerate() {
        let cavities = match piece.cavities {
            0 => String::new(),
            1 => ", 1 cavity".to_owned(),
            n => format!(", {n} cavities"),
        };
        let volume = if found.pieces.len() == 1 { String::new() } else { format!(", volume {} ± {:.1e}{deep}", digits(piece.volume.value, piece.volume.error), piece.volume.error) };
        line(&format!("  {}", i + 1), format!("Euler number {}{cavities}{volume}", piece.euler));
    }
    if found.pieces.len() > LISTED {
        line("", format!("and {} smaller ones", found.pieces.len() - LISTED));
    }
    if let Some(walls) = &found.walls {
        let missed = format!("what is smaller than {:.1e}{long} may be missed", walls.cell);
        let words = |across: &Option<Across>| across.as_ref().map_or_else(|| format!("none was found; {missed}"), |across| {
            let [from, to] = across.ends.map(|end| format!("({})", end.map(|c| digits(c, across.length.error)).join(", ")));
            format!("{}, from {from} to {to}; {missed}", with_error(across.length, &long))
        });
        line("thinnest wall", words(&walls.wall));
        line("narrowest gap", words(&walls.gap));
    }
    if let Some(met) = &found.line {
        line("line", format!("{}{long} long, {}{long} of it solid", digits(met.length, met.error), digits(met.solid(), met.error)));
        for way in &met.ways {
            let what = if way.solid { "solid" } else { "air" };
            line(&format!("  {what}"), format!("{}{long}, from {} to {}", digits(way.to - way.from, met.error), digits(way.from, met.error), digits(way.to, met.error)));
        }
        for note in notes(met) {
            line("", note);
        }
    }
    text
}

fn notes(line: &Line) -> Vec<String> {
    let mut notes: Vec<String> = line.touches.iter().map(|at| format!("may touch the surface at {}", digits(*at, line.error))).collect();
    if line.known_to < line.length {
        notes.push(format!("nothing is known beyond {}: the field was looked at too often", digits(line.known_to, line.error)));
    }
    notes
}

fn known_json(known: &Known) -> Value {
    let ends = known.proven.is_finite().then_some([known.proven.lo, known.proven.hi]);
    json!({ "value": known.value, "error": known.error, "proven": known.is_proven, "between": ends })
}

/// For a machine.
fn in_json(args: &Args, found: &Measured, unit: Option<Unit>) -> Value {
    let all = |of: &[Known; 3]| of.iter().map(known_json).collect::<Vec<_>>();
    let line = found.line.as_ref().map(|line| {
        let ways = line.ways.iter().map(|way| json!({ "solid": way.solid, "from": way.from, "to": way.to }));
        json!({
            "from": line.ends[0],
            "to": line.ends[1],
            "length": line.length,
            "solid": line.solid(),
            "error": line.error,
            "ways": ways.collect::<Vec<_>>(),
            "touches": line.touches,
            "known_to": line.known_to,
        })
    });
    let pieces = found.pieces.iter().map(|piece| {
        json!({
            "volume": known_json(&piece.volume),
            "area": known_json(&piece.area),
            "euler": piece.euler,
            "cavities": piece.cavities,
            "box": { "min": piece.bounds[0], "max": piece.bounds[1] },
        })
    });
    json!({
        "file": args.scene,
        "time": args.time,
        "unit": unit.map(Unit::name),
        "tolerance": found.tolerance,
        "box": { "min": all(&found.bounds[0]), "max": all(&found.bounds[1]) },
        "volume": known_json(&found.volume),
        "area": known_json(&found.area),
        "centre_of_mass": all(&found.centre),
        "pieces": pieces.collect::<Vec<_>>(),
        "pieces_settled": found.settled,
        "cell": found.cell,
        "cells": found.cells,
        "walls": found.walls.map(|walls| {
            let across = |across: Across| json!({ "length": known_json(&across.length), "from": across.ends[0], "to": across.ends[1] });
            json!({ "wall": walls.wall.map(across), "gap": walls.gap.map(across), "cell": walls.cell })
        }),
        "line": line,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_two_points() {
        let found = Ok([[0.0, -1.0, 0.5], [1.0, 2.0, 3.0]]);
        for text in ["0,-1,0.5 1,2,3", "(0, -1, .5) (1, 2, 3)", "(0,-1,0.5)..(1,2,3)"] {
            assert_eq!(ends(text), found, "{text}");
        }
        for wrong in ["", "0,0,0", "0,0,0 0,0,0", "0,0,0 1,2,x", "0,0,0 1,2,3,4"] {
            assert!(ends(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn digits_are_those_that_are_known() {
        assert_eq!(digits(4.188_790_204, 2.4e-5), "4.18879");
        assert_eq!(digits(-1e-9, 1e-4), "0");
        assert_eq!(digits(1200.0, 3.0), "1200");
        assert_eq!(digits(0.5, 0.0), "0.5");
    }
}
