//! `surefoot measure`: what a solid measures, each number with its error.

use super::bar::LateBar;
use super::console::{Exit, Failure, print};
use super::mesh::{above_zero, corners, number, words};
use super::values::{self, Setting};
use crate::measures::lines;
use serde_json::{Value, json};
use std::fmt::Write;
use surefoot_compiler::Options;
use surefoot_compiler::diagnostic::Code;
use surefoot_compiler::unit::Unit;
use surefoot_compiler::measure::{Across, Known, Measured, Settings, measure};

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

/// For a person.
fn in_words(args: &Args, found: &Measured, unit: Option<Unit>) -> String {
    let mut text = format!("{}\n", args.scene);
    for (name, words) in lines(found, unit) {
        let _ = writeln!(text, "  {name:<15} {words}");
    }
    text
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
}
