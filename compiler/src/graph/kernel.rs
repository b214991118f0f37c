//! The kernel: every operation of the graph, one row each.
//!
//! A row ([`Row`]) says what the operation is called, what it computes in 64 bits and in intervals, how it is written in WGSL and how
//! accurate that is. Its partial derivatives stand in [`partials`], once for every algebra. Partial functions are made total the
//! same way everywhere: no operation gives NaN.

use super::algebra::Algebra;
use super::interval::Interval;
use super::{Claim, Graph, Node, NodeId, FAR};

/// How a WGSL implementation may err, from the accuracy table of the WGSL specification (§ 15.7.4).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Accuracy {
    /// Exact.
    Exact,
    /// Correctly rounded, to either side.
    Rounded,
    /// So many units in the last place of the result.
    Ulp(f64),
    /// An absolute error.
    Absolute(f64),
    /// It depends on the arguments, or is inherited from the expression that it is written as: `evaluate::conforming` follows it.
    Inherited,
}

/// Whether a value is a number or a condition.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A number.
    Number,
    /// A condition.
    Condition,
}

/// One operation.
pub struct Row {
    /// Which.
    pub op: Op,
    /// Its name in printed graphs, and in the language where it has one there.
    pub name: &'static str,
    /// How many arguments it takes.
    pub arity: u8,
    /// Whether a person can call it by its name (the others are operators or made by the compiler).
    pub callable: bool,
    /// What it gives.
    pub result: Kind,
    /// What its value is, in words.
    pub doc: &'static str,
    /// WGSL, arguments as `{0}`, `{1}`; a helper function's name starts with `sf_` and is replaced by the prefix of the module.
    pub wgsl: &'static str,
    /// Binding strength of that text: 9 for calls and names, 8 unary, 7 `* / %`, 6 `+ -`, 4 comparison, 2 `&&`, 1 `||`.
    pub strength: u8,
    /// How accurate that is.
    pub accuracy: Accuracy,
    /// Whether its value jumps.
    pub jumps: bool,
    /// The value in 64 bits. Takes `arity` arguments; missing ones count as 0.
    pub value: fn([f64; 4]) -> f64,
    /// All values over intervals.
    pub interval: fn([Interval; 4]) -> Interval,
}

macro_rules! kernel {
    ($($op:ident $name:literal $arity:literal $callable:ident $result:ident $jumps:ident $strength:literal
       $accuracy:expr, $wgsl:literal, |$v:pat_param| $value:expr, |$i:pat_param| $interval:expr, $doc:literal;)*) => {
        /// An operation of the kernel.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
        pub enum Op { $(#[doc = $doc] $op,)* }

        /// The kernel, in the order of [`Op`].
        pub static KERNEL: &[Row] = &[$(Row {
            op: Op::$op, name: $name, arity: $arity, callable: $callable, result: Kind::$result, doc: $doc,
            wgsl: $wgsl, strength: $strength, accuracy: $accuracy, jumps: $jumps,
            value: |$v| $value, interval: |$i| $interval,
        },)*];

        impl Op {
            /// Its row.
            pub fn row(self) -> &'static Row {
                #[allow(clippy::indexing_slicing)] // The table has a row for each variant, in their order.
                &KERNEL[self as usize]
            }
        }
    };
}

impl Op {
    /// Whether it is constant on each of its pieces: it jumps, and between its jumps nothing moves.
    pub fn is_flat(self) -> bool {
        use Op::*;
        matches!(self, Sign | Floor | Ceil | Trunc | Round | Lt | Le | Eq | And | Or | Not | Hash)
    }
}

use Accuracy::{Absolute, Exact, Inherited, Rounded, Ulp};
use Interval as I;

fn truth(condition: bool) -> f64 {
    if condition { 1.0 } else { 0.0 }
}

/// A condition over intervals: surely false, surely true, or either.
fn either(surely: bool, never: bool) -> Interval {
    if surely {
        I::ONE
    } else if never {
        I::ZERO
    } else {
        I { lo: 0.0, hi: 1.0 }
    }
}

/// Largest argument for which an exponential stays finite in 32 bits.
pub const EXP_LIMIT: f64 = 88.0;
/// What a logarithm is taken of is at least this.
pub const LOG_LEAST: f64 = 1e-37;

kernel! {
    Add "add" 2 false Number false 6 Rounded, "{0} + {1}",
        |[a, b, ..]| a + b, |[a, b, ..]| a.add(b), "`a + b`";
    Sub "sub" 2 false Number false 6 Rounded, "{0} - {1}",
        |[a, b, ..]| a - b, |[a, b, ..]| a.sub(b), "`a - b`";
    Mul "mul" 2 false Number false 7 Rounded, "{0} * {1}",
        |[a, b, ..]| a * b, |[a, b, ..]| a.mul(b), "`a * b`";
    Square "square" 1 false Number false 9 Rounded, "sf_square({0})",
        |[a, ..]| a * a, |[a, ..]| a.square(), "`a * a`";
    Div "div" 2 false Number false 9 Ulp(2.5), "sf_div({0}, {1})",
        |[a, b, ..]| if b == 0.0 { 0.0 } else { a / b }, |[a, b, ..]| a.div(b), "`a / b`, and 0 where `b` is 0";
    Neg "neg" 1 false Number false 8 Exact, "-{0}",
        |[a, ..]| -a, |[a, ..]| a.neg(), "`-a`";
    Min "min" 2 true Number false 9 Exact, "min({0}, {1})",
        |[a, b, ..]| a.min(b), |[a, b, ..]| a.min(b), "The smaller of two numbers.";
    Max "max" 2 true Number false 9 Exact, "max({0}, {1})",
        |[a, b, ..]| a.max(b), |[a, b, ..]| a.max(b), "The larger of two numbers.";
    Abs "abs" 1 true Number false 9 Exact, "abs({0})",
        |[a, ..]| a.abs(), |[a, ..]| a.abs(), "The number without its sign.";
    Sign "sign" 1 true Number true 9 Exact, "sign({0})",
        |[a, ..]| if a > 0.0 { 1.0 } else if a < 0.0 { -1.0 } else { 0.0 },
        |[a, ..]| a.steps(|a| if a > 0.0 { 1.0 } else if a < 0.0 { -1.0 } else { 0.0 }),
        "1 above zero, -1 below, 0 at zero.";
    Floor "floor" 1 true Number true 9 Exact, "floor({0})",
        |[a, ..]| a.floor(), |[a, ..]| a.steps(f64::floor), "The whole number at or below.";
    Ceil "ceil" 1 true Number true 9 Exact, "ceil({0})",
        |[a, ..]| a.ceil(), |[a, ..]| a.steps(f64::ceil), "The whole number at or above.";
    Trunc "trunc" 1 true Number true 9 Exact, "trunc({0})",
        |[a, ..]| a.trunc(), |[a, ..]| a.steps(f64::trunc), "The whole number toward zero.";
    Round "round" 1 true Number true 9 Exact, "round({0})",
        |[a, ..]| a.round_ties_even(), |[a, ..]| a.steps(f64::round_ties_even), "The nearest whole number, halves to the even one.";
    Sqrt "sqrt" 1 true Number false 9 Inherited, "sqrt(max({0}, 0.0))",
        |[a, ..]| a.max(0.0).sqrt(), |[a, ..]| a.sqrt(), "The square root, and 0 below zero.";
    Exp "exp" 1 true Number false 9 Inherited, "exp(min({0}, 88.0))",
        |[a, ..]| a.min(EXP_LIMIT).exp(),
        |[a, ..]| a.monotone(|a| a.min(EXP_LIMIT).exp()).max(I::ZERO), "e to the power `a` (which counts as at most 88).";
    Log "log" 1 true Number false 9 Inherited, "log(max({0}, 1e-37))",
        |[a, ..]| a.max(LOG_LEAST).ln(), |[a, ..]| a.monotone(|a| a.max(LOG_LEAST).ln()), "The natural logarithm, of at least 1e-37.";
    Pow "pow" 2 true Number false 9 Inherited, "sf_pow({0}, {1})",
        |[a, b, ..]| power(a, b), |[a, b, ..]| power_interval(a, b),
        "`a` to the power `b`; below zero `a` counts as zero, unless `b` is a constant whole number.";
    Sin "sin" 1 true Number false 9 Inherited, "sin({0})",
        |[a, ..]| a.sin(), |[a, ..]| a.sin(), "The sine.";
    Cos "cos" 1 true Number false 9 Inherited, "cos({0})",
        |[a, ..]| a.cos(), |[a, ..]| a.cos(), "The cosine.";
    Asin "asin" 1 true Number false 9 Absolute(1e-3), "asin(clamp({0}, -1.0, 1.0))",
        |[a, ..]| a.clamp(-1.0, 1.0).asin(), |[a, ..]| a.monotone(|a| a.clamp(-1.0, 1.0).asin()), "The angle whose sine it is.";
    Acos "acos" 1 true Number false 9 Absolute(1.5e-3), "acos(clamp({0}, -1.0, 1.0))",
        |[a, ..]| a.clamp(-1.0, 1.0).acos(), |[a, ..]| a.neg().monotone(|a| (-a).clamp(-1.0, 1.0).acos()), "The angle whose cosine it is.";
    Atan "atan_of" 1 false Number false 9 Ulp(4096.0), "atan({0})",
        |[a, ..]| a.atan(), |[a, ..]| a.monotone(f64::atan), "The angle whose tangent it is.";
    Atan2 "atan2" 2 true Number true 9 Ulp(4096.0), "sf_atan2({0}, {1})",
        |[a, b, ..]| if a == 0.0 && b == 0.0 { 0.0 } else { a.atan2(b) }, |[a, b, ..]| atan2_interval(a, b),
        "The angle of the point (`b`, `a`), from -pi to pi; 0 at the origin.";
    Tanh "tanh" 1 true Number false 9 Absolute(1e-5), "tanh(clamp({0}, -10.0, 10.0))",
        |[a, ..]| a.clamp(-10.0, 10.0).tanh(), |[a, ..]| a.monotone(|a| a.clamp(-10.0, 10.0).tanh()), "The hyperbolic tangent.";
    Length2 "length2" 2 false Number false 9 Inherited, "length(vec2f({0}, {1}))",
        |[a, b, ..]| a.hypot(b), |[a, b, ..]| a.square().add(b.square()).sqrt(), "The length of (`a`, `b`).";
    Length3 "length3" 3 false Number false 9 Inherited, "length(vec3f({0}, {1}, {2}))",
        |[a, b, c, ..]| (a * a + b * b + c * c).sqrt(),
        |[a, b, c, ..]| a.square().add(b.square()).add(c.square()).sqrt(), "The length of (`a`, `b`, `c`).";
    Length4 "length4" 4 false Number false 9 Inherited, "length(vec4f({0}, {1}, {2}, {3}))",
        |[a, b, c, d]| (a * a + b * b + c * c + d * d).sqrt(),
        |[a, b, c, d]| a.square().add(b.square()).add(c.square()).add(d.square()).sqrt(), "The length of (`a`, `b`, `c`, `d`).";
    TurnU "turn_u" 3 false Number false 9 Inherited, "sf_turn_u({0}, {1}, {2})",
        |[u, v, t, _]| u * t.cos() - v * t.sin(), |[u, v, t, _]| turn_interval(u, v, t),
        "First coordinate of (`u`, `v`) turned by the angle `t`: `u cos t - v sin t`.";
    TurnV "turn_v" 3 false Number false 9 Inherited, "sf_turn_v({0}, {1}, {2})",
        |[u, v, t, _]| u * t.sin() + v * t.cos(),
        |[u, v, t, _]| turn_interval(u, v, t.sub(I::point(std::f64::consts::FRAC_PI_2))),
        "Second coordinate of (`u`, `v`) turned by the angle `t`: `u sin t + v cos t`.";
    Select "select" 3 false Number false 9 Exact, "select({2}, {1}, {0})",
        |[c, a, b, _]| if c != 0.0 { a } else { b },
        |[c, a, b, _]| if c == I::ONE { a } else if c == I::ZERO { b } else { a.hull(b) }, "`if c { a } else { b }`";
    Lt "lt" 2 false Condition true 4 Exact, "{0} < {1}",
        |[a, b, ..]| truth(a < b), |[a, b, ..]| either(a.hi < b.lo, a.lo >= b.hi), "`a < b`";
    Le "le" 2 false Condition true 4 Exact, "{0} <= {1}",
        |[a, b, ..]| truth(a <= b), |[a, b, ..]| either(a.hi <= b.lo, a.lo > b.hi), "`a <= b`";
    Eq "eq" 2 false Condition true 4 Exact, "{0} == {1}",
        |[a, b, ..]| truth(a == b), |[a, b, ..]| either(a.is_point() && a == b, a.hi < b.lo || a.lo > b.hi), "`a == b`";
    And "and" 2 false Condition false 2 Exact, "{0} && {1}",
        |[a, b, ..]| truth(a != 0.0 && b != 0.0), |[a, b, ..]| a.min(b), "`a && b`";
    Or "or" 2 false Condition false 1 Exact, "{0} || {1}",
        |[a, b, ..]| truth(a != 0.0 || b != 0.0), |[a, b, ..]| a.max(b), "`a || b`";
    Not "not" 1 false Condition false 8 Exact, "!{0}",
        |[a, ..]| truth(a == 0.0), |[a, ..]| I::ONE.sub(a).max(I::ZERO).min(I::ONE).steps(f64::round), "`!a`";
    Hash "hash_of" 4 false Number true 9 Exact, "sf_hash({0}, {1}, {2}, {3})",
        |[a, b, c, d]| hash(a, b, c, d), |[a, b, c, d]| hash_interval(a, b, c, d),
        "A number in 0..1 made of four whole numbers, the same on every machine.";
}

/// `a` to the power `b`, where `a` counts as at least zero and the result as at most 1e30.
fn power(a: f64, b: f64) -> f64 {
    let a = a.max(0.0);
    if a == 0.0 { truth(b == 0.0) } else { a.powf(b).min(1e30) }
}

fn power_interval(a: Interval, b: Interval) -> Interval {
    if a.is_empty() || b.is_empty() {
        return I::EMPTY;
    }
    let a = a.max(I::ZERO);
    let ends = [(a.lo, b.lo), (a.lo, b.hi), (a.hi, b.lo), (a.hi, b.hi)];
    // Monotone in each argument on either side of a = 1 and b = 0, so the extremes lie at the ends and there.
    let mut hull = ends.iter().fold(I::EMPTY, |h, &(x, y)| h.hull(I::point(power(x, y))));
    if b.contains(0.0) || a.contains(1.0) {
        hull = hull.hull(I::ONE);
    }
    if a.contains(0.0) {
        hull = hull.hull(I::ZERO);
        if b.lo < 0.0 {
            hull = hull.hull(I::point(1e30));
        }
    }
    hull.monotone(|x| x)
}

fn atan2_interval(y: Interval, x: Interval) -> Interval {
    let pi = std::f64::consts::PI;
    if y.is_empty() || x.is_empty() {
        return I::EMPTY;
    }
    // The angle turns over from pi to -pi across the negative half of the x axis.
    if x.lo <= 0.0 && y.contains(0.0) || !x.is_finite() || !y.is_finite() {
        return I::new(-pi, pi);
    }
    let corners = [(y.lo, x.lo), (y.lo, x.hi), (y.hi, x.lo), (y.hi, x.hi)];
    corners.iter().fold(I::EMPTY, |h, &(y, x)| h.hull(I::point(y.atan2(x)))).monotone(|a| a)
}

/// `u cos t - v sin t`: both as written, and within the length of (u, v).
fn turn_interval(u: Interval, v: Interval, t: Interval) -> Interval {
    let written = u.mul(t.cos()).sub(v.mul(t.sin()));
    let reach = u.square().add(v.square()).sqrt().hi;
    written.intersect(I::new(-reach, reach))
}

/// A number in 0..1 from four whole numbers: rounds of multiply and rotate on 32-bit words (PCG3D-like mixing,
/// Jarzynski and Olano, "Hash Functions for GPU Rendering", JCGT 9(3), 2020, § 4), then its upper 24 bits.
pub fn hash(a: f64, b: f64, c: f64, d: f64) -> f64 {
    let word = |x: f64| (x.round_ties_even().clamp(-2147483520.0, 2147483520.0) as i32) as u32;
    let mix = |v: u32| v.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    let (mut x, mut y, mut z, mut w) = (mix(word(a)), mix(word(b)), mix(word(c)), mix(word(d)));
    for _ in 0..2 {
        x = x.wrapping_add(y.wrapping_mul(w));
        y = y.wrapping_add(z.wrapping_mul(x));
        z = z.wrapping_add(x.wrapping_mul(y));
        w = w.wrapping_add(y.wrapping_mul(z));
        x ^= x >> 16;
        y ^= y >> 16;
        z ^= z >> 16;
        w ^= w >> 16;
    }
    f64::from((x ^ w) >> 8) / 16_777_216.0
}

fn hash_interval(a: Interval, b: Interval, c: Interval, d: Interval) -> Interval {
    let whole = |i: Interval| i.lo.round_ties_even() == i.hi.round_ties_even();
    if whole(a) && whole(b) && whole(c) && whole(d) {
        I::point(hash(a.lo, b.lo, c.lo, d.lo))
    } else {
        I { lo: 0.0, hi: 1.0 }
    }
}

fn padded<T: Copy>(args: &[T], zero: T) -> [T; 4] {
    let mut all = [zero; 4];
    for (slot, value) in all.iter_mut().zip(args) {
        *slot = *value;
    }
    all
}

/// The value of an operation.
pub fn value(op: Op, args: &[f64]) -> f64 {
    (op.row().value)(padded(args, 0.0))
}

/// All values of an operation over intervals.
pub fn interval(op: Op, args: &[Interval]) -> Interval {
    (op.row().interval)(padded(args, Interval::ZERO))
}

/// The partial derivatives of an operation by each of its arguments and zeros beyond, in any algebra. `out` is the operation's own value. Of an
/// operation that jumps: of its pieces. Of `min`, `max`, `abs` and `select`: of the branch taken.
pub fn partials<A: Algebra>(
    algebra: &mut A,
    op: Op,
    args: &[A::Value],
    out: A::Value,
) -> [A::Value; 4] {
    let zero = algebra.constant(0.0);
    let one = algebra.constant(1.0);
    let arg = |i: usize| args.get(i).cloned().unwrap_or_else(|| zero.clone());
    let (a, b, c) = (arg(0), arg(1), arg(2));
    let pad = zero.clone();
    match op {
        Op::Add => few([one.clone(), one], &pad),
        Op::Sub => {
            let minus = algebra.constant(-1.0);
            few([one, minus], &pad)
        }
        Op::Mul => few([b, a], &pad),
        Op::Square => {
            let twice = algebra.constant(2.0);
            few([algebra.op(Op::Mul, &[twice, a])], &pad)
        }
        Op::Div => {
            let by_a = algebra.op(Op::Div, &[one, b.clone()]);
            let slope = algebra.op(Op::Div, &[out, b]);
            let by_b = algebra.op(Op::Neg, &[slope]);
            few([by_a, by_b], &pad)
        }
        Op::Neg => few([algebra.constant(-1.0)], &pad),
        Op::Min => {
            let first = algebra.op(Op::Le, &[a, b]);
            let by_a = algebra.op(Op::Select, &[first.clone(), one.clone(), zero.clone()]);
            let by_b = algebra.op(Op::Select, &[first, zero, one]);
            few([by_a, by_b], &pad)
        }
        Op::Max => {
            let first = algebra.op(Op::Lt, &[a, b]);
            let by_a = algebra.op(Op::Select, &[first.clone(), zero.clone(), one.clone()]);
            let by_b = algebra.op(Op::Select, &[first, one, zero]);
            few([by_a, by_b], &pad)
        }
        Op::Abs => {
            let below = algebra.op(Op::Lt, &[a, zero]);
            let minus = algebra.constant(-1.0);
            few([algebra.op(Op::Select, &[below, minus, one])], &pad)
        }
        Op::Sqrt => {
            let twice = algebra.constant(2.0);
            let below = algebra.op(Op::Mul, &[twice, out]);
            few([algebra.op(Op::Div, &[one, below])], &pad)
        }
        Op::Exp => few([out], &pad),
        Op::Log => few([algebra.op(Op::Div, &[one, a])], &pad),
        Op::Pow => {
            let less = algebra.op(Op::Sub, &[b.clone(), one]);
            let power = algebra.op(Op::Pow, &[a.clone(), less]);
            let by_a = algebra.op(Op::Mul, &[b, power]);
            let log = algebra.op(Op::Log, &[a]);
            let by_b = algebra.op(Op::Mul, &[out, log]);
            few([by_a, by_b], &pad)
        }
        Op::Sin => few([algebra.op(Op::Cos, &[a])], &pad),
        Op::Cos => {
            let sine = algebra.op(Op::Sin, &[a]);
            few([algebra.op(Op::Neg, &[sine])], &pad)
        }
        Op::Asin | Op::Acos => {
            let square = algebra.op(Op::Square, &[a]);
            let rest = algebra.op(Op::Sub, &[one.clone(), square]);
            let root = algebra.op(Op::Sqrt, &[rest]);
            let slope = algebra.op(Op::Div, &[one, root]);
            few([if op == Op::Asin { slope } else { algebra.op(Op::Neg, &[slope]) }], &pad)
        }
        Op::Atan => {
            let square = algebra.op(Op::Square, &[a]);
            let below = algebra.op(Op::Add, &[one.clone(), square]);
            few([algebra.op(Op::Div, &[one, below])], &pad)
        }
        Op::Atan2 => {
            let aa = algebra.op(Op::Square, std::slice::from_ref(&a));
            let bb = algebra.op(Op::Square, std::slice::from_ref(&b));
            let square = algebra.op(Op::Add, &[aa, bb]);
            let by_a = algebra.op(Op::Div, &[b, square.clone()]);
            let slope = algebra.op(Op::Div, &[a, square]);
            let by_b = algebra.op(Op::Neg, &[slope]);
            few([by_a, by_b], &pad)
        }
        Op::Tanh => {
            let square = algebra.op(Op::Square, &[out]);
            few([algebra.op(Op::Sub, &[one, square])], &pad)
        }
        Op::Length2 | Op::Length3 | Op::Length4 => {
            let mut slopes = few([], &pad);
            for (slope, x) in slopes.iter_mut().zip(args) {
                *slope = algebra.op(Op::Div, &[x.clone(), out.clone()]);
            }
            slopes
        }
        Op::TurnU => {
            let by_u = algebra.op(Op::Cos, std::slice::from_ref(&c));
            let sine = algebra.op(Op::Sin, std::slice::from_ref(&c));
            let by_v = algebra.op(Op::Neg, &[sine]);
            let other = algebra.op(Op::TurnV, &[a, b, c]);
            let by_t = algebra.op(Op::Neg, &[other]);
            few([by_u, by_v, by_t], &pad)
        }
        Op::TurnV => {
            let by_u = algebra.op(Op::Sin, std::slice::from_ref(&c));
            let by_v = algebra.op(Op::Cos, std::slice::from_ref(&c));
            let by_t = algebra.op(Op::TurnU, &[a, b, c]);
            few([by_u, by_v, by_t], &pad)
        }
        Op::Select => {
            let by_b = algebra.op(Op::Select, &[a.clone(), one.clone(), zero.clone()]);
            let by_c = algebra.op(Op::Select, &[a, zero.clone(), one]);
            few([zero, by_b, by_c], &pad)
        }
        // Constant on each of their pieces.
        Op::Sign | Op::Floor | Op::Ceil | Op::Trunc | Op::Round | Op::Lt | Op::Le | Op::Eq | Op::And
        | Op::Or | Op::Not | Op::Hash => few([], &pad),
    }
}

/// Up to four values, and `pad` for those that are not there.
fn few<V: Clone, const N: usize>(values: [V; N], pad: &V) -> [V; 4] {
    let mut values = values.into_iter();
    std::array::from_fn(|_| values.next().unwrap_or_else(|| pad.clone()))
}

/// Where operations are made and looked into: a graph, or what is made of one.
pub trait Terms {
    /// What stands for a term.
    type Id: Copy + PartialEq;
    /// The constant that a term is, if it is one.
    fn as_constant(&self, id: Self::Id) -> Option<f64>;
    /// The operation that a term is, if it is one.
    fn operation(&self, id: Self::Id) -> Option<(Op, &[Self::Id])>;
    /// A constant.
    fn constant(&mut self, value: f64) -> Self::Id;
    /// An operation, simplified.
    fn op(&mut self, op: Op, args: &[Self::Id]) -> Self::Id;
    /// Whether turns and lengths that are written out are gathered into the operations, of which more is known.
    fn gathers(&self) -> bool;
}

impl Terms for Graph {
    type Id = NodeId;
    fn as_constant(&self, id: NodeId) -> Option<f64> {
        Graph::as_constant(self, id)
    }
    fn operation(&self, id: NodeId) -> Option<(Op, &[NodeId])> {
        match self.node(id) {
            Node::Op(op, args) if !self.labels.stands_apart(id) => Some((*op, args)),
            _ => None,
        }
    }
    fn constant(&mut self, value: f64) -> NodeId {
        Graph::constant(self, value)
    }
    fn op(&mut self, op: Op, args: &[NodeId]) -> NodeId {
        Graph::op(self, op, args)
    }
    fn gathers(&self) -> bool {
        true
    }
}

/// A sine or cosine of a constant. Those of quarter turns are whole: what is left of pi is not meant.
fn quarter(value: f64) -> f64 {
    if (value - value.round()).abs() < 4.0 * f64::EPSILON { value.round() } else { value }
}

/// The largest whole exponent up to which a power is multiplied out.
const MOST_MULTIPLIED: f64 = 16.0;

/// A number to a constant whole power, which takes negative numbers too. None where that is a power of what has no sign.
fn whole_power<T: Terms>(graph: &mut T, a: T::Id, n: f64) -> Option<T::Id> {
    if n.abs() > MOST_MULTIPLIED {
        let size = graph.op(Op::Abs, &[a]);
        // What is its own size takes the power as it is: an absolute value, a length, a constant that is not negative.
        if size == a {
            return None;
        }
        let is_odd = n % 2.0 != 0.0;
        let even = graph.constant(if is_odd { n - 1.0 } else { n });
        let power = graph.op(Op::Pow, &[size, even]);
        return Some(if is_odd { graph.op(Op::Mul, &[a, power]) } else { power });
    }
    let mut result = graph.constant(1.0);
    let (mut square, mut left) = (a, n.abs() as u32);
    while left > 0 {
        if left & 1 == 1 {
            result = graph.op(Op::Mul, &[result, square]);
        }
        left >>= 1;
        if left > 0 {
            square = graph.op(Op::Mul, &[square, square]);
        }
    }
    if n < 0.0 {
        let one = graph.constant(1.0);
        result = graph.op(Op::Div, &[one, result]);
    }
    Some(result)
}

/// A simpler term of the same value (the rounding of a constant apart), or none.
pub fn simplify<T: Terms>(graph: &mut T, op: Op, args: &[T::Id]) -> Option<T::Id> {
    let mut constants = [0.0; 4];
    let mut all = true;
    for (slot, &arg) in constants.iter_mut().zip(args) {
        match graph.as_constant(arg) {
            Some(c) => *slot = c,
            None => all = false,
        }
    }
    if let (Op::Pow, &[a, b]) = (op, args)
        && let Some(n) = graph.as_constant(b).filter(|n| n.fract() == 0.0)
        && let Some(power) = whole_power(graph, a, n)
    {
        return Some(power);
    }
    if all {
        let folded = (op.row().value)(constants);
        let folded = if matches!(op, Op::Sin | Op::Cos) { quarter(folded) } else { folded };
        return Some(graph.constant(folded));
    }
    let a = *args.first()?;
    let b = args.get(1).copied().unwrap_or(a);
    let (ca, cb) = (graph.as_constant(a), graph.as_constant(b));
    let is = |c: Option<f64>, v: f64| c == Some(v);
    match op {
        Op::Add if is(ca, 0.0) => Some(b),
        Op::Add | Op::Sub if is(cb, 0.0) => Some(a),
        Op::Add => match turned(graph, a, b).or(turned(graph, b, a)) {
            // v cos t + u sin t
            Some(((v, u, t), false)) => Some(graph.op(Op::TurnV, &[u, v, t])),
            // v cos t - u sin t
            Some(((v, u, t), true)) => Some(graph.op(Op::TurnU, &[v, u, t])),
            None => negated(graph, b).map(|n| graph.op(Op::Sub, &[a, n])),
        },
        Op::Sub if is(ca, 0.0) => Some(graph.op(Op::Neg, &[b])),
        Op::Sub if a == b => Some(graph.constant(0.0)),
        Op::Sub => match (turned(graph, a, b), turned(graph, b, a)) {
            // u cos t - v sin t
            (Some(((u, v, t), false)), _) => Some(graph.op(Op::TurnU, &[u, v, t])),
            // u cos t + v sin t
            (Some(((u, v, t), true)), _) => Some(graph.op(Op::TurnV, &[v, u, t])),
            (None, Some(((v, u, t), negative))) => {
                // u sin t - v cos t, or -u sin t - v cos t
                let turned = if negative { graph.op(Op::TurnV, &[u, v, t]) } else { graph.op(Op::TurnU, &[v, u, t]) };
                Some(graph.op(Op::Neg, &[turned]))
            }
            _ => negated(graph, b).map(|n| graph.op(Op::Add, &[a, n])),
        },
        Op::Mul if is(ca, 0.0) || is(cb, 0.0) => Some(graph.constant(0.0)),
        // The square of one interval is not the product of two.
        Op::Mul if a == b => Some(graph.op(Op::Square, &[a])),
        // `-x * x` and `2 * x * x` are products of a multiple and `x`.
        Op::Mul if let Some((by, x)) = multiple_of_other(graph, a, b) => {
            let square = graph.op(Op::Square, &[x]);
            let by = graph.constant(by);
            Some(graph.op(Op::Mul, &[by, square]))
        }
        // ((x x) x) x
        Op::Mul if fourth(graph, a, b).is_some() => fourth(graph, a, b).map(|square| graph.op(Op::Square, &[square])),
        Op::Mul if is(ca, 1.0) => Some(b),
        Op::Mul if is(cb, 1.0) => Some(a),
        Op::Mul if is(ca, -1.0) => Some(graph.op(Op::Neg, &[b])),
        Op::Mul if is(cb, -1.0) => Some(graph.op(Op::Neg, &[a])),
        Op::Mul => {
            // c * (x * d) is (c * d) * x.
            let (c, other) = ca.map(|c| (c, b)).or(cb.map(|c| (c, a)))?;
            let (inner, &[x, y]) = graph.operation(other)? else { return None };
            let (cx, cy) = (graph.as_constant(x), graph.as_constant(y));
            let (d, x) = cx.map(|d| (d, y)).or(cy.map(|d| (d, x))).filter(|_| inner == Op::Mul)?;
            let factor = if (c * d - 1.0).abs() < 1e-15 { 1.0 } else { c * d };
            let factor = graph.constant(factor);
            Some(graph.op(Op::Mul, &[factor, x]))
        }
        Op::Div if is(cb, 1.0) => Some(a),
        Op::Div if is(ca, 0.0) => Some(graph.constant(0.0)),
        Op::Div => {
            // Dividing by a power of two is multiplying, exactly.
            let c = cb.filter(|c| c.is_normal() && c.to_bits().trailing_zeros() >= 52)?;
            let inverse = graph.constant(1.0 / c);
            Some(graph.op(Op::Mul, &[a, inverse]))
        }
        Op::Neg => match graph.operation(a)? {
            (Op::Neg, &[x]) => Some(x),
            (Op::Sub, &[x, y]) => Some(graph.op(Op::Sub, &[y, x])),
            _ => None,
        },
        Op::Min if a == b => Some(a),
        Op::Min if is(ca, FAR) => Some(b),
        Op::Min if is(cb, FAR) => Some(a),
        Op::Max if a == b => Some(a),
        Op::Max if is(ca, -FAR) => Some(b),
        Op::Max if is(cb, -FAR) => Some(a),
        Op::Max if is(ca, FAR) || is(cb, FAR) => Some(graph.constant(FAR)),
        Op::Min if is(ca, -FAR) || is(cb, -FAR) => Some(graph.constant(-FAR)),
        Op::Abs => match graph.operation(a)? {
            (Op::Neg, &[x]) => Some(graph.op(Op::Abs, &[x])),
            (Op::Abs | Op::Sqrt | Op::Square | Op::Length2 | Op::Length3 | Op::Length4, _) => Some(a),
            _ => None,
        },
        // Of roots of sums of squares more is known.
        Op::Pow if is(cb, 0.5) => Some(graph.op(Op::Sqrt, &[a])),
        Op::Pow if is(cb, 0.25) => {
            let root = graph.op(Op::Sqrt, &[a]);
            Some(graph.op(Op::Sqrt, &[root]))
        }
        Op::Sqrt => match graph.operation(a)? {
            // sqrt(x²) is |x|, whatever the sign.
            (Op::Square, &[x]) => Some(graph.op(Op::Abs, &[x])),
            // The root of a sum of squares is a length, whose gradient never exceeds one.
            (Op::Add, &[x, y]) if graph.gathers() => {
                let of = sides(graph, x, y)?;
                let op = match of.len() {
                    2 => Op::Length2,
                    3 => Op::Length3,
                    4 => Op::Length4,
                    _ => return None,
                };
                Some(graph.op(op, &of))
            }
            // The root grows, so it can be taken on each side.
            (Op::Min, &[x, y]) => {
                let (x, y) = (graph.op(Op::Sqrt, &[x]), graph.op(Op::Sqrt, &[y]));
                Some(graph.op(Op::Min, &[x, y]))
            }
            _ => None,
        },
        Op::Log if graph.gathers() => soft_maximum(graph, a),
        Op::Length2 | Op::Length3 | Op::Length4 => {
            // A component that is always zero does not count.
            if !args.iter().any(|&x| graph.as_constant(x) == Some(0.0)) {
                return None;
            }
            let rest: Vec<T::Id> =
                args.iter().copied().filter(|&x| graph.as_constant(x) != Some(0.0)).collect();
            Some(match *rest {
                [] => graph.constant(0.0),
                [x] => graph.op(Op::Abs, &[x]),
                [_, _] => graph.op(Op::Length2, &rest),
                _ => graph.op(Op::Length3, &rest),
            })
        }
        Op::TurnU | Op::TurnV => {
            // By whole quarter turns.
            let angle = graph.as_constant(*args.get(2)?)?;
            let (cos, sin) = (quarter(angle.cos()), quarter(angle.sin()));
            if cos != 0.0 && sin != 0.0 {
                return None;
            }
            let u = op == Op::TurnU;
            let of_first = if u { cos } else { sin };
            let of_second = if u { -sin } else { cos };
            let (term, times) = if of_first != 0.0 { (a, of_first) } else { (b, of_second) };
            Some(if times > 0.0 { term } else { graph.op(Op::Neg, &[term]) })
        }
        Op::Select => {
            let c = *args.get(2)?;
            if b == c {
                return Some(b);
            }
            ca.map(|condition| if condition != 0.0 { b } else { c })
        }
        Op::And if is(ca, 1.0) => Some(b),
        Op::And if is(cb, 1.0) => Some(a),
        Op::And if is(ca, 0.0) || is(cb, 0.0) => Some(graph.constant(0.0)),
        Op::Or if is(ca, 0.0) => Some(b),
        Op::Or if is(cb, 0.0) => Some(a),
        Op::Or if is(ca, 1.0) || is(cb, 1.0) => Some(graph.constant(1.0)),
        Op::Not => match graph.operation(a)? {
            (Op::Not, &[x]) => Some(x),
            _ => None,
        },
        _ => None,
    }
}

/// The logarithm of a sum of powers of e, where nothing overflows and each slope is between 0 and 1: log(exp(u) + exp(v)) is
/// max(u, v) + log(1 + exp(-|u - v|)), and of more than two it is m + log Σ exp(u - m) with m the largest. None of anything else.
fn soft_maximum<T: Terms>(graph: &mut T, sum: T::Id) -> Option<T::Id> {
    let (mut open, mut powers) = (vec![sum], Vec::new());
    while let Some(term) = open.pop() {
        match graph.operation(term)? {
            (Op::Add, &[x, y]) if open.len() + powers.len() < MOST_POWERS => open.extend([y, x]),
            (Op::Exp, &[u]) => powers.push(u),
            _ => return None,
        }
    }
    let one = graph.constant(1.0);
    if let [u, v] = *powers {
        let larger = graph.op(Op::Max, &[u, v]);
        let apart = graph.op(Op::Sub, &[u, v]);
        let apart = graph.op(Op::Abs, &[apart]);
        let apart = graph.op(Op::Neg, &[apart]);
        let smaller = graph.op(Op::Exp, &[apart]);
        let sum = graph.op(Op::Add, &[one, smaller]);
        let rest = graph.op(Op::Log, &[sum]);
        return Some(graph.op(Op::Add, &[larger, rest]));
    }
    if powers.len() < 2 {
        return None;
    }
    let largest = balanced(graph, Op::Max, &powers)?;
    let less: Vec<T::Id> = powers
        .iter()
        .map(|&u| {
            let less = graph.op(Op::Sub, &[u, largest]);
            graph.op(Op::Exp, &[less])
        })
        .collect();
    let sum = balanced(graph, Op::Add, &less)?;
    // The largest adds one.
    let sum = graph.op(Op::Max, &[sum, one]);
    let rest = graph.op(Op::Log, &[sum]);
    Some(graph.op(Op::Add, &[largest, rest]))
}

/// Longer sums are left as they are.
const MOST_POWERS: usize = 1000;

/// A balanced tree of one operation over many operands; none of none.
pub fn balanced<T: Terms>(graph: &mut T, op: Op, operands: &[T::Id]) -> Option<T::Id> {
    if let [] | [_] = operands {
        return operands.first().copied();
    }
    let (left, right) = operands.split_at(operands.len() / 2);
    let sides = [balanced(graph, op, left)?, balanced(graph, op, right)?];
    Some(graph.op(op, &sides))
}

/// Of `x cos t` and `y sin t`: x, y and t; and whether it is `-y sin t`.
type Turned<Id> = ((Id, Id, Id), bool);

fn turned<T: Terms>(graph: &T, a: T::Id, b: T::Id) -> Option<Turned<T::Id>> {
    if !graph.gathers() {
        return None;
    }
    let product = |id: T::Id| match graph.operation(id)? {
        (Op::Mul, &[x, y]) => Some([(x, y), (y, x)]),
        _ => None,
    };
    let angle = |id: T::Id, op: Op| match graph.operation(id)? {
        (found, &[t]) if found == op => Some(t),
        _ => None,
    };
    let (c, x) = product(a)?.into_iter().find(|(c, _)| angle(*c, Op::Cos).is_some())?;
    let t = angle(c, Op::Cos)?;
    let (b, outside) = negated(graph, b).map_or((b, false), |b| (b, true));
    let positive = |id: T::Id| negated(graph, id).map_or((id, false), |id| (id, true));
    product(b)?.into_iter().find_map(|(s, y)| {
        let ((s, first), (y, second)) = (positive(s), positive(y));
        (angle(s, Op::Sin) == Some(t)).then_some(((x, y, t), outside ^ first ^ second))
    })
}

/// The square of `x`, where `a` is its cube and `b` is `x`.
fn fourth<T: Terms>(graph: &T, a: T::Id, b: T::Id) -> Option<T::Id> {
    let (Op::Mul, &[square, x]) = graph.operation(a)? else { return None };
    let squared = matches!(graph.operation(square)?, (Op::Square, &[y]) if y == b);
    (x == b && squared).then_some(square)
}

/// What is squared in the terms of a sum, two to four of them; a constant counts as the square of its root.
fn sides<T: Terms>(graph: &mut T, a: T::Id, b: T::Id) -> Option<Vec<T::Id>> {
    let mut open = vec![b, a];
    let mut found = Vec::new();
    let mut constant = 0.0;
    while let Some(term) = open.pop() {
        if let Some(c) = graph.as_constant(term).filter(|c| *c >= 0.0) {
            constant += c;
            continue;
        }
        match graph.operation(term)? {
            (Op::Square, &[x]) => found.push(x),
            (Op::Add, &[x, y]) => open.extend([y, x]),
            _ => return None,
        }
        if found.len() + open.len() > 4 {
            return None;
        }
    }
    if constant > 0.0 {
        found.push(graph.constant(constant.sqrt()));
    }
    Some(found)
}

fn negated<T: Terms>(graph: &T, id: T::Id) -> Option<T::Id> {
    match graph.operation(id)? {
        (Op::Neg, &[x]) => Some(x),
        _ => None,
    }
}

/// Whether a node is a number or a condition.
pub fn kind(graph: &Graph, id: NodeId) -> Kind {
    match graph.node(id) {
        Node::Op(op, _) => op.row().result,
        _ => Kind::Number,
    }
}

impl Claim {
    /// What of an interval of its values is left by what it knows of them.
    pub fn within(&self, value: Interval) -> Interval {
        match self {
            Claim::Lipschitz(_, _, Some(range)) => {
                let common = value.intersect(range.interval());
                if common.is_empty() { value } else { common }
            }
            _ => value,
        }
    }

    /// The name of the claim in printed graphs.
    pub fn name(&self) -> &'static str {
        match self {
            Claim::Lipschitz(..) => "lipschitz",
            Claim::Continuous => "continuous",
        }
    }
}

/// Where one of two nodes is a multiple of the other: by how much, and that other one.
fn multiple_of_other<T: Terms>(graph: &T, a: T::Id, b: T::Id) -> Option<(f64, T::Id)> {
    let multiple = |of: T::Id, x: T::Id| match graph.operation(of)? {
        (Op::Neg, &[y]) if y == x => Some(-1.0),
        (Op::Mul, &[y, z]) if z == x => graph.as_constant(y),
        (Op::Mul, &[y, z]) if y == x => graph.as_constant(z),
        _ => None,
    };
    multiple(a, b).map(|by| (by, b)).or_else(|| multiple(b, a).map(|by| (by, a)))
}
