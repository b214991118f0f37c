//! What a GPU may answer where the evaluation in 64 bits gives one number: every value that the accuracy table of the WGSL
//! specification (§ 15.7.4) allows, operation by operation, as an interval.

use super::{INPUTS, Tape};
use crate::graph::interval::Interval;
use crate::graph::kernel::{self, Accuracy, Op};
use crate::figure::Figure;
use crate::kept::Kept;
use crate::outline::Outline;
use crate::sampled::Grid;

/// The most that a unit in the last place of a number in 32 bits is, of that number.
const ULP: f64 = f32::EPSILON as f64;
/// Numbers smaller than this one may count as zero.
const TINY: f64 = f32::MIN_POSITIVE as f64;
/// How far a sine or cosine may be off between -pi and pi.
const SINE: f64 = 1.0 / 2048.0;
/// How far a logarithm may be off for arguments from 0.5 to 2.
const LOGARITHM: f64 = 1.0 / 2_097_152.0;
/// What a constant may be off, in units of the last place: it is rounded, and it may be folded from others before or after.
const CONSTANT: f64 = 4.0;

impl Tape {
    /// For each formula an interval that holds every value that an implementation of WGSL may give at the point `p`, which is in 32
    /// bits on both sides; the normal is zero. Past a half turn the table says nothing of sines: there they are held to what they
    /// owe within it, and to an angle that is known to one unit in the last place.
    pub fn conforming(&self, p: [f32; 3]) -> Vec<Interval> {
        let mut registers = vec![Interval::ZERO; self.registers as usize];
        for (register, c) in registers.iter_mut().zip(p) {
            *register = Interval::point(f64::from(c));
        }
        for (register, &c) in registers.iter_mut().skip(INPUTS).zip(&self.constants) {
            let whole = c.fract() == 0.0 && c.abs() < 16_777_216.0;
            *register = if whole { Interval::point(c) } else { ulps(Interval::point(c), CONSTANT) };
        }
        for instruction in &self.code {
            let arguments = instruction.from.map(|r| registers.get(r as usize).copied().unwrap_or(Interval::ZERO));
            if let Some(register) = registers.get_mut(instruction.to as usize) {
                *register = answers(instruction.op, arguments);
            }
        }
        self.outputs.iter().map(|&o| registers.get(o as usize).copied().unwrap_or(Interval::ZERO)).collect()
    }
}

/// Values that are off by so many units in the last place.
fn ulps(x: Interval, count: f64) -> Interval {
    let off = |end: f64| count * ULP * end.abs() + TINY;
    Interval::new(x.lo - off(x.lo), x.hi + off(x.hi))
}

/// All that may be answered for one operation.
fn answers(op: Op, arguments: [Interval; 4]) -> Interval {
    let [a, b, ..] = arguments;
    let arity = usize::from(op.row().arity);
    let right = kernel::interval(op, arguments.get(..arity).unwrap_or(&arguments));
    match op {
        // The smallest denominators count as zero.
        Op::Div if b.mignitude() < 1e-28 => Interval::ALL,
        // `1 / inverseSqrt(x)`: 2 units, and 2.5 of the division.
        Op::Sqrt => ulps(right, 4.5),
        // The root of a sum of squares, half of whose error is left; small ones are lost.
        Op::Length2 | Op::Length3 | Op::Length4 => ulps(right, 4.5 + 0.5 * f64::from(op.row().arity)).grow(1e-18),
        Op::Exp => exponential(a.min(Interval::point(88.0)), right),
        Op::Log => logarithm(a.max(Interval::point(1e-37)), right),
        Op::Pow => power(a, b),
        Op::Sin | Op::Cos => {
            let pi = std::f64::consts::PI;
            let angle = if a.magnitude() <= pi { a } else { ulps(a, 1.0) };
            kernel::interval(op, &[angle]).grow(SINE)
        }
        _ if op.reads_grid() => read(op, arguments),
        Op::Outlined => nearest(arguments),
        Op::Figured => nearest_in_space(arguments),
        _ => match op.row().accuracy {
            Accuracy::Exact | Accuracy::Inherited => right,
            Accuracy::Rounded => ulps(right, 1.0),
            Accuracy::Ulp(count) => ulps(right, count),
            Accuracy::Absolute(error) => right.grow(error),
        },
    }
}

/// What is read from a grid at a place that is rounded when it is counted in cells, between samples that are mixed in three rounds.
fn read(op: Op, [number, place @ ..]: [Interval; 4]) -> Interval {
    let Some(grid) = Kept::<Grid>::find(number.lo) else { return Interval::ZERO };
    let far = grid.shape().origin.into_iter().chain(grid.shape().end()).fold(0.0, |far: f64, c| far.max(c.abs()));
    let [x, y, z] = place.map(|c| c.grow(4.0 * ULP * (far + c.magnitude())));
    let right = kernel::interval(op, &[number, x, y, z]);
    let (values, steepest) = (grid.hull().values, grid.hull().lipschitz);
    right.grow(8.0 * ULP * if op == Op::Sampled { values[0].abs().max(values[1].abs()) } else { steepest + values[1].abs() / grid.shape().cell })
}

/// The distance to an outline, from a place and to pieces whose coordinates are rounded on the way, as is that of the nearest place along them.
fn nearest([number, x, y, _]: [Interval; 4]) -> Interval {
    let Some(outline) = Kept::<Outline>::find(number.lo) else { return Interval::ZERO };
    let far = outline.size() + x.magnitude() + y.magnitude();
    kernel::interval(Op::Outlined, &[number, x, y]).grow(16.0 * ULP * far)
}

/// The distance to a figure, likewise.
fn nearest_in_space([number, x, y, z]: [Interval; 4]) -> Interval {
    let Some(figure) = Kept::<Figure>::find(number.lo) else { return Interval::ZERO };
    let far = figure.size() + x.magnitude() + y.magnitude() + z.magnitude();
    kernel::interval(Op::Figured, &[number, x, y, z]).grow(32.0 * ULP * far)
}

/// An exponential, of whatever base, of `x`: `3 + 2 |x|` units.
fn exponential(x: Interval, right: Interval) -> Interval {
    ulps(right, 3.0 + 2.0 * x.magnitude())
}

/// A logarithm, of whatever base, of `x`: 3 units, and about 1 an absolute error.
fn logarithm(x: Interval, right: Interval) -> Interval {
    let near_one = x.lo <= 2.0 && x.hi >= 0.5;
    ulps(right, 3.0).grow(if near_one { LOGARITHM } else { 0.0 })
}

/// `exp2(b * log2(a))`, as the helper is written.
fn power(a: Interval, b: Interval) -> Interval {
    let base = a.max(Interval::point(1e-37));
    let log = logarithm(base, base.monotone(f64::log2));
    let exponent = ulps(b.mul(log), 1.0).min(Interval::point(99.65784));
    let mut all = exponential(exponent, exponent.monotone(f64::exp2));
    if a.lo < 1e-37 {
        all = all.hull(Interval::ZERO);
        if b.contains(0.0) {
            all = all.hull(Interval::ONE);
        }
    }
    all
}
