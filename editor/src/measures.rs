//! What a solid measures, in words: for the command line and for the window.

use surefoot_compiler::measure::{Across, Known, Line, Measured};
use surefoot_compiler::unit::Unit;

/// Pieces that are listed for a person.
const LISTED: usize = 20;

/// What stands behind a length, an area and a volume: ` mm`, ` mm²`, ` mm³`, or nothing where a scene says no unit.
pub fn powers(unit: Option<Unit>) -> [String; 3] {
    ["", "²", "³"].map(|power| unit.map_or(String::new(), |unit| format!(" {}{power}", unit.name())))
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

/// What was measured, line by line: a name, and what is said. Lengths are in the scene's unit, where it says one.
pub fn lines(found: &Measured, unit: Option<Unit>) -> Vec<(String, String)> {
    let [long, wide, deep] = powers(unit);
    let mut all = Vec::new();
    let mut line = |name: &str, words: String| all.push((name.to_owned(), words));
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
            format!("{}; from {from} to {to}; {missed}", with_error(across.length, &long))
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
    all
}

fn notes(line: &Line) -> Vec<String> {
    let mut notes: Vec<String> = line.touches.iter().map(|at| format!("may touch the surface at {}", digits(*at, line.error))).collect();
    if line.known_to < line.length {
        notes.push(format!("nothing is known beyond {}: the field was looked at too often", digits(line.known_to, line.error)));
    }
    notes
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_those_that_are_known() {
        assert_eq!(digits(4.188_790_204, 2.4e-5), "4.18879");
        assert_eq!(digits(-1e-9, 1e-4), "0");
        assert_eq!(digits(1200.0, 3.0), "1200");
        assert_eq!(digits(0.5, 0.0), "0.5");
    }
}
