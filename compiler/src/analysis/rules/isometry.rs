//! Points that are other points turned about the origin, or mirrored: as far from it as those, by whatever angles.

use crate::analysis::tape::{Step, Steps, Tape};
use crate::graph::kernel::Op;
use smallvec::{SmallVec, smallvec};

/// So many turns after one another are seen, and so many steps of each.
const MOST_TURNS: usize = 32;
const MOST_OPENED: usize = 48;
/// How far from one and from zero the products of a matrix's rows may be by rounding.
const ROUNDED: f64 = 1e-9;

/// The first of the points that were turned one after another until they were this one; none where it is none that was turned.
pub fn unturned(tape: &Tape, point: [usize; 3]) -> Option<[usize; 3]> {
    let mirrored = |point: &[usize; 3]| Mirror::of(tape, point)?.of.as_slice().try_into().ok();
    let before = |point: &[usize; 3]| turned_in_a_plane(tape, *point).or_else(|| turned_by_numbers(tape, *point)).or_else(|| mirrored(point));
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

/// A point that is another one mirrored in a plane through the origin, be it on one side of the plane alone: `q - 2 min(q · n, 0) n`.
pub struct Mirror {
    /// The steps that are mirrored.
    pub of: Steps,
    /// The components of the plane's normal, a unit vector by the way it is written.
    pub normal: Steps,
}

/// A coordinate of a mirrored point: a step that a number times two others is added to.
struct Moved {
    from: usize,
    number: f64,
    factors: Steps,
}

impl Mirror {
    /// How a point, or two coordinates of one, are mirrored.
    pub fn of(tape: &Tape, point: &[usize]) -> Option<Self> {
        let moved: SmallVec<[Option<Moved>; 3]> = point.iter().map(|&a| Moved::of(tape, a)).collect();
        let first = moved.iter().flatten().next()?;
        let normal = first.factors.iter().find_map(|&way| normal_of(tape, moved.iter().flatten(), way))?;
        let of = point.iter().zip(&moved).map(|(&at, moved)| moved.as_ref().map_or(at, |moved| moved.from)).collect();
        Some(Self { of, normal })
    }
}

/// The normal along which coordinates are moved by twice their way to the plane, or to it from one side.
fn normal_of<'m>(tape: &Tape, moved: impl Iterator<Item = &'m Moved>, way: usize) -> Option<Steps> {
    let mut normal = Steps::new();
    let mut products: SmallVec<[(usize, usize, f64); 3]> = SmallVec::new();
    for moved in moved {
        let component = match *moved.factors.as_slice() {
            [a, b] if a == way => b,
            [a, b] if b == way => a,
            _ => return None,
        };
        if moved.number.abs() != 2.0 {
            return None;
        }
        normal.push(component);
        products.push((moved.from, component, -moved.number.signum()));
    }
    let is_zero = |step: usize| tape.constant(step) == Some(0.0);
    let way = match tape.operation(way) {
        Some((Op::Min | Op::Max, &[a, b])) if is_zero(b) => a,
        Some((Op::Min | Op::Max, &[a, b])) if is_zero(a) => b,
        _ => way,
    };
    (is_sum_of(tape, way, products) && is_unit(tape, &normal)).then_some(normal)
}

impl Moved {
    fn of(tape: &Tape, step: usize) -> Option<Self> {
        let (op @ (Op::Add | Op::Sub), &[a, b]) = tape.operation(step)? else { return None };
        let sides = [(a, b, if op == Op::Sub { -1.0 } else { 1.0 }), (b, a, 1.0)];
        sides.into_iter().take(if op == Op::Add { 2 } else { 1 }).find_map(|(from, product, sign)| {
            let (number, factors) = factors_of(tape, product)?;
            (factors.len() == 2).then_some(Self { from, number: sign * number, factors })
        })
    }
}

/// The number and the steps that a product is made of; none where it is no product.
fn factors_of(tape: &Tape, product: usize) -> Option<(f64, Steps)> {
    let mut number = 1.0;
    let (mut open, mut factors) = (Steps::from_slice(&[product]), Steps::new());
    while let Some(step) = open.pop() {
        match (tape.operation(step), tape.constant(step)) {
            (Some((Op::Mul, args)), _) if factors.len() + open.len() < 4 => open.extend(args.iter().copied()),
            (Some((Op::Neg, &[a])), _) => {
                number = -number;
                open.push(a);
            }
            (_, Some(c)) => number *= c,
            _ => factors.push(step),
        }
    }
    Some((number, factors)).filter(|(_, factors)| factors.len() > 1)
}

/// Whether a step is the sum of the products of pairs of steps, each with a sign.
fn is_sum_of(tape: &Tape, sum: usize, mut pairs: SmallVec<[(usize, usize, f64); 3]>) -> bool {
    let take = |pairs: &mut SmallVec<[(usize, usize, f64); 3]>, is_pair: &dyn Fn(&(usize, usize, f64)) -> bool| {
        let at = pairs.iter().position(is_pair);
        at.map(|at| pairs.remove(at)).is_some()
    };
    let is_of = |step: usize, op: Op, of: usize| tape.operation(step) == Some((op, &[of]));
    let mut open: SmallVec<[(usize, f64); 4]> = smallvec![(sum, 1.0)];
    while let Some((step, sign)) = open.pop() {
        let known = match tape.operation(step) {
            Some((op @ (Op::Add | Op::Sub), &[a, b])) if pairs.len() > open.len() + 1 => {
                open.extend([(a, sign), (b, if op == Op::Add { sign } else { -sign })]);
                true
            }
            Some((Op::Neg, &[a])) => {
                open.push((a, -sign));
                true
            }
            Some((Op::Mul, &[a, b])) => [(a, b), (b, a)].into_iter().any(|(of, by)| {
                let (by, own) = match tape.operation(by) {
                    Some((Op::Neg, &[by])) => (by, -sign),
                    _ => (by, sign),
                };
                take(&mut pairs, &|pair| *pair == (of, by, own))
            }),
            // u cos t - v sin t, and u sin t + v cos t.
            Some((op @ (Op::TurnU | Op::TurnV), &[u, v, t])) => {
                let ((first, second), side) = if op == Op::TurnU { ((Op::Cos, Op::Sin), -sign) } else { ((Op::Sin, Op::Cos), sign) };
                take(&mut pairs, &|&(q, n, by)| q == u && is_of(n, first, t) && by == sign) && take(&mut pairs, &|&(q, n, by)| q == v && is_of(n, second, t) && by == side)
            }
            _ => false,
        };
        if !known {
            return false;
        }
    }
    pairs.is_empty()
}

/// Whether a vector has the length one, or none at all, by the way it is written: divided by its own length, or cosine and sine of an angle.
fn is_unit(tape: &Tape, vector: &[usize]) -> bool {
    let parts: Option<SmallVec<[(usize, usize); 3]>> = vector
        .iter()
        .map(|&component| match tape.operation(component) {
            Some((Op::Div, &[a, length])) => Some((a, length)),
            _ => None,
        })
        .collect();
    if let Some(parts) = parts
        && let Some(&(_, length)) = parts.first()
        && let Some((Op::Length2 | Op::Length3, of)) = tape.operation(length)
    {
        let mut of = Steps::from_slice(of);
        return parts.len() == of.len() && parts.iter().all(|&(a, by)| {
            let at = of.iter().position(|&part| part == a).filter(|_| by == length);
            at.map(|at| of.remove(at)).is_some()
        });
    }
    let angle = |wanted: Op| {
        vector.iter().find_map(|&component| match tape.operation(component) {
            Some((op, &[angle])) if op == wanted => Some(angle),
            _ => None,
        })
    };
    vector.len() == 2 && angle(Op::Cos).is_some_and(|cosine| angle(Op::Sin) == Some(cosine))
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
    fn what_is_mirrored_is_as_far_away_as_before() {
        for normal in ["(cos(tilt), -sin(tilt), 0)", "(tilt, tilt, 1)", "(tilt, 0, -1)", "(sin(time), tilt, 2)"] {
            for side in ["min(0, dot(p, n))", "max(dot(p, n), 0)", "dot(p, n)"] {
                let scene = compiled(&format!("f\nlet n = normalize({normal})\nfield f = box(1, 0.6, 0.3).at(p - 2 * {side} * n)"));
                assert!(scene.graph.factors.is_empty(), "{normal} {side}");
                let [low, high] = bounds(&scene.graph, scene.root, &scene.functions, 100.0).unwrap_or_else(|| panic!("{normal} {side}"));
                assert!(low.iter().all(|c| *c > -0.61) && high.iter().all(|c| *c < 0.61), "{normal} {side}: {low:?} {high:?}");
            }
        }
        // A unit vector that is none by its length.
        let scene = compiled("f\nfield f = box(1, 0.6, 0.3).at(p - 2 * min(0, p.x * cos(tilt) - p.y * sin(tilt)) * (cos(tilt), -sin(tilt), 0))");
        assert!(scene.graph.factors.is_empty());
        // Nearly a mirror, and not quite: too far, along another normal, and along one that is too long.
        for wrong in ["p - 2.1 * dot(p, n) * n", "p - 2 * dot(p, n) * n.yxz", "p + 2 * dot(p, n) * n", "p - 2 * dot(p, 2 * n) * n", "p - 2 * dot(p.yxz, n) * n"] {
            let scene = compiled(&format!("f\nlet n = normalize((tilt, 0.3, -1))\nfield f = box(1, 0.6, 0.3).at({wrong})"));
            assert!(scene.graph.factors.iter().any(|f| f.lipschitz > 1.05), "{wrong}");
        }
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
