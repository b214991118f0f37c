//! Points that are other points turned about the origin, or mirrored: as far from it as those, by whatever angles.

use super::tape::{Step, Tape};
use crate::graph::kernel::Op;
use smallvec::SmallVec;

/// So many turns after one another are seen, and so many steps of each.
const MOST_TURNS: usize = 32;
const MOST_OPENED: usize = 48;
/// How far from one and from zero the products of a matrix's rows may be by rounding.
const ROUNDED: f64 = 1e-9;

/// The first of the points that were turned one after another until they were this one; none where it is none that was turned.
pub fn unturned(tape: &Tape, point: [usize; 3]) -> Option<[usize; 3]> {
    let before = |point: &[usize; 3]| turned_in_a_plane(tape, *point).or_else(|| turned_by_numbers(tape, *point));
    std::iter::successors(Some(point), before).take(MOST_TURNS).skip(1).last()
}

/// A point of which two coordinates are two steps turned by an angle.
pub struct PlaneTurn {
    /// Which coordinates these are.
    pub coordinates: [usize; 2],
    /// The steps that are turned, and the angle.
    pub of: [usize; 3],
}

impl PlaneTurn {
    /// How a point is turned in a plane.
    pub fn of(tape: &Tape, point: &[usize]) -> Option<Self> {
        let turns = |wanted: Op| {
            point.iter().enumerate().filter_map(move |(i, &a)| match tape.steps.get(a) {
                Some(Step::Op(op, of)) if *op == wanted => Some((i, of)),
                _ => None,
            })
        };
        let (i, of, j) = turns(Op::TurnU)
            .find_map(|(i, first)| turns(Op::TurnV).find(|(_, second)| first == *second).map(|(j, _)| (i, first, j)))?;
        Some(Self { coordinates: [i, j], of: of.as_slice().try_into().ok()? })
    }
}

/// What a point is turned from, where that is in a plane.
fn turned_in_a_plane(tape: &Tape, point: [usize; 3]) -> Option<[usize; 3]> {
    let PlaneTurn { coordinates: [i, j], of: [u, v, _] } = PlaneTurn::of(tape, &point)?;
    Some([u, v, *point.get(3 - i - j)?])
}

/// What a point is turned from, where it is that times an orthogonal matrix of numbers.
fn turned_by_numbers(tape: &Tape, [x, y, z]: [usize; 3]) -> Option<[usize; 3]> {
    // The point as a sum of steps, each with what it adds to the three coordinates.
    let mut sum: SmallVec<[(usize, [f64; 3]); 8]> = SmallVec::new();
    let add = |sum: &mut SmallVec<[(usize, [f64; 3]); 8]>, step: usize, by: [f64; 3]| {
        match sum.binary_search_by_key(&step, |(s, _)| *s) {
            Ok(at) => {
                if let Some((_, known)) = sum.get_mut(at) {
                    known.iter_mut().zip(by).for_each(|(k, b)| *k += b);
                }
            }
            Err(at) => sum.insert(at, (step, by)),
        }
    };
    for (row, by) in [(x, [1.0, 0.0, 0.0]), (y, [0.0, 1.0, 0.0]), (z, [0.0, 0.0, 1.0])] {
        add(&mut sum, row, by);
    }
    let number = |step: usize| match tape.steps.get(step) {
        Some(Step::Constant(c)) => Some(*c),
        _ => None,
    };
    for _ in 0..MOST_OPENED {
        let (top, by) = sum.pop()?;
        let Some(Step::Op(op, args)) = tape.steps.get(top) else { return None };
        match (op, args.as_slice()) {
            (Op::Add, &[a, b]) => [a, b].into_iter().for_each(|step| add(&mut sum, step, by)),
            (Op::Sub, &[a, b]) => {
                add(&mut sum, a, by);
                add(&mut sum, b, by.map(|c| -c));
            }
            (Op::Neg, &[a]) => add(&mut sum, a, by.map(|c| -c)),
            (Op::Mul, &[a, b]) => {
                let (of, times) = number(a).map(|c| (b, c)).or_else(|| number(b).map(|c| (a, c)))?;
                add(&mut sum, of, by.map(|c| c * times));
            }
            _ => return None,
        }
        if let [(a, first), (b, second), (c, third)] = sum.as_slice()
            && is_orthogonal([first, second, third])
        {
            return Some([*a, *b, *c]);
        }
    }
    None
}

fn is_orthogonal(columns: [&[f64; 3]; 3]) -> bool {
    columns.iter().enumerate().all(|(i, a)| {
        columns.iter().enumerate().all(|(j, b)| {
            let product: f64 = a.iter().zip(b.iter()).map(|(a, b)| a * b).sum();
            (product - f64::from(u8::from(i == j))).abs() < ROUNDED
        })
    })
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]
mod tests {
    use crate::functions::bounds;
    use crate::{Compiled, MemoryLoader, Options, compile};

    fn compiled(scene: &str) -> Compiled {
        let text = format!("param tilt = 0.5 in -2..2\nscene = {scene}");
        let outcome = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default());
        outcome.compiled.unwrap_or_else(|| panic!("{scene}: {:?}", outcome.diagnostics))
    }

    #[test]
    fn what_is_turned_about_any_axis_reaches_as_far_as_before() {
        let axes = ["(1, 2, 0.5)", "(1, tilt, 0.5)", "(0, tilt, 0.5)", "(tilt, 0, -1)", "(sin(time), tilt, 0)"];
        for angle in ["time", "0.7", "tilt * 3"] {
            for axis in axes {
                let scene = compiled(&format!("box(1, 0.6, 0.3).rotate({axis}, {angle})"));
                assert!(scene.graph.factors.is_empty(), "{axis} {angle}");
                let [low, high] = bounds(&scene.graph, scene.root, &scene.functions, 100.0).unwrap_or_else(|| panic!("{axis} {angle}"));
                let reach = 0.61;
                assert!(low.iter().all(|c| *c > -reach) && high.iter().all(|c| *c < reach), "{axis} {angle}: {low:?} {high:?}");
            }
        }
        // About another place.
        let scene = compiled("box(1, 0.6, 0.3).rotate((1, 1, tilt), 2 * time).translate(3, 0, 0)");
        let [low, high] = bounds(&scene.graph, scene.root, &scene.functions, 100.0).unwrap();
        assert!(low[0] > 2.39 && high[0] < 3.61 && high[1] < 0.61 && low[1] > -0.61 && high[2] < 0.61, "{low:?} {high:?}");
    }

    #[test]
    fn in_each_cell_a_turn_may_be_another() {
        let scene = compiled(
            "(for c in grid((1.3, 1.3, 1.3)) { box(1, 0.6, 0.3).rotate((hash(c), hash(c + 7), hash(c + 9)) - 0.5, 6 * hash(c + 3)) })",
        );
        assert!(scene.graph.factors.is_empty());
    }

    #[test]
    fn a_sheared_point_is_no_turned_one() {
        let scene = compiled("f\nfield f = box(1).at((p.x + 0.5 * p.y, p.y, p.z))");
        let [low, high] = bounds(&scene.graph, scene.root, &scene.functions, 100.0).unwrap();
        assert!(low[0] <= -0.75 && high[0] >= 0.75, "{low:?} {high:?}");
        // Nearly a turn, and not quite: the corner is at (0.5, 0.5, 0.5) / 0.9.
        let scene = compiled("f\nfield f = box(1).at(0.9 * turn_about(p, (1, 2, 3), time))");
        let [_, high] = bounds(&scene.graph, scene.root, &scene.functions, 100.0).unwrap_or([[0.0; 3], [9.0; 3]]);
        assert!(high.iter().all(|c| *c > 0.96), "{high:?}");
    }
}
