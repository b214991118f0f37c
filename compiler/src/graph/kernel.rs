//! The kernel: every operation of the graph, one row each.
//!
//! A row ([`Row`]) says what the operation is called, what it computes in 64 bits and in intervals, how it is written in WGSL and how
//! accurate that is. Its partial derivatives stand in [`partials`](crate::graph::partials), once for every algebra. Partial functions are made total the
//! same way everywhere: no operation gives NaN.

use crate::graph::interval::Interval;
use crate::figure::{Figure, Found};
use crate::kept::Kept;
use crate::outline::{Nearest, Outline};
use crate::sampled::{Grid, Hull};

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

    /// Whether it reads a grid, whose number is its first argument.
    pub fn reads_grid(self) -> bool {
        matches!(self, Op::Sampled | Op::SampledX | Op::SampledY | Op::SampledZ)
    }

    /// Whether it reads an outline, whose number is its first argument.
    pub fn reads_outline(self) -> bool {
        matches!(self, Op::Outlined | Op::OutlinedX | Op::OutlinedY)
    }

    /// Whether it reads a figure, whose number is its first argument.
    pub fn reads_figure(self) -> bool {
        matches!(self, Op::Figured | Op::FiguredX | Op::FiguredY | Op::FiguredZ)
    }

    /// What it is a component of, where one call of the shader gives several: the operation that stands for the call, the component, and how many there are.
    pub fn component(self) -> Option<(Op, u8, u8)> {
        Some(match self {
            Op::SampledX => (Op::SampledX, 0, 3),
            Op::SampledY => (Op::SampledX, 1, 3),
            Op::SampledZ => (Op::SampledX, 2, 3),
            Op::Outlined => (Op::Outlined, 0, 3),
            Op::OutlinedX => (Op::Outlined, 1, 3),
            Op::OutlinedY => (Op::Outlined, 2, 3),
            Op::Figured => (Op::Figured, 0, 4),
            Op::FiguredX => (Op::Figured, 1, 4),
            Op::FiguredY => (Op::Figured, 2, 4),
            Op::FiguredZ => (Op::Figured, 3, 4),
            _ => return None,
        })
    }

    /// Whether it reads data by its number.
    pub fn reads_data(self) -> bool {
        self.reads_grid() || self.reads_outline() || self.reads_figure()
    }

    /// What is left of a number when its whole part by this operation is taken away. None of operations that find no whole part.
    pub fn part(self) -> Option<Interval> {
        match self {
            Op::Floor => Some(Interval::new(0.0, 1.0)),
            Op::Ceil => Some(Interval::new(-1.0, 0.0)),
            Op::Round => Some(Interval::new(-0.5, 0.5)),
            _ => None,
        }
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
    Atan2 "atan2" 2 true Number true 9 Ulp(4096.0), "sf_atan_of({0}, {1})",
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
    Sampled "sampled" 4 false Number false 9 Inherited, "sf_sampled({0}, {1}, {2}, {3})",
        |[g, x, y, z]| sampled(g, |grid| grid.inside([x, y, z])), |[g, x, y, z]| sampled_interval(g, [x, y, z], |hull| hull.values),
        "The value of the grid of this number at a point, between the samples around; beyond its box, at the nearest place of that.";
    SampledX "sampled_x" 4 false Number true 9 Inherited, "sf_sampled_slope({0}, {1}, {2}, {3})",
        |[g, x, y, z]| sampled(g, |grid| grid.gradient([x, y, z])[0]), |[g, x, y, z]| sampled_interval(g, [x, y, z], |hull| hull.slopes[0]),
        "How fast the value of a grid changes along x, within a cell of it.";
    SampledY "sampled_y" 4 false Number true 9 Inherited, "sf_sampled_slope({0}, {1}, {2}, {3})",
        |[g, x, y, z]| sampled(g, |grid| grid.gradient([x, y, z])[1]), |[g, x, y, z]| sampled_interval(g, [x, y, z], |hull| hull.slopes[1]),
        "How fast the value of a grid changes along y, within a cell of it.";
    SampledZ "sampled_z" 4 false Number true 9 Inherited, "sf_sampled_slope({0}, {1}, {2}, {3})",
        |[g, x, y, z]| sampled(g, |grid| grid.gradient([x, y, z])[2]), |[g, x, y, z]| sampled_interval(g, [x, y, z], |hull| hull.slopes[2]),
        "How fast the value of a grid changes along z, within a cell of it.";
    Outlined "outlined" 3 false Number false 9 Inherited, "sf_outlined({0}, {1}, {2})",
        |[n, x, y, _]| outlined(n, [x, y], |near| near.value), |[n, x, y, _]| outlined_interval(n, [x, y]),
        "The signed distance to the outline of this number, in a plane.";
    OutlinedX "outlined_x" 3 false Number true 9 Inherited, "sf_outlined({0}, {1}, {2})",
        |[n, x, y, _]| outlined(n, [x, y], |near| near.gradient[0]), |[n, x, y, _]| outlined_slope(n, [x, y], |[slope, _]| slope),
        "How fast the distance to an outline changes along x.";
    OutlinedY "outlined_y" 3 false Number true 9 Inherited, "sf_outlined({0}, {1}, {2})",
        |[n, x, y, _]| outlined(n, [x, y], |near| near.gradient[1]), |[n, x, y, _]| outlined_slope(n, [x, y], |[_, slope]| slope),
        "How fast the distance to an outline changes along y.";
    Figured "figured" 4 false Number false 9 Inherited, "sf_figured({0}, {1}, {2}, {3})",
        |[n, x, y, z]| figured(n, [x, y, z], |found| found.value), |[n, x, y, z]| figured_interval(n, [x, y, z]),
        "The distance to the figure of this number, below zero inside of a closed one.";
    FiguredX "figured_x" 4 false Number true 9 Inherited, "sf_figured({0}, {1}, {2}, {3})",
        |[n, x, y, z]| figured(n, [x, y, z], |found| found.gradient[0]), |[_, x, y, z]| figured_slope([x, y, z]),
        "How fast the distance to a figure changes along x.";
    FiguredY "figured_y" 4 false Number true 9 Inherited, "sf_figured({0}, {1}, {2}, {3})",
        |[n, x, y, z]| figured(n, [x, y, z], |found| found.gradient[1]), |[_, x, y, z]| figured_slope([x, y, z]),
        "How fast the distance to a figure changes along y.";
    FiguredZ "figured_z" 4 false Number true 9 Inherited, "sf_figured({0}, {1}, {2}, {3})",
        |[n, x, y, z]| figured(n, [x, y, z], |found| found.gradient[2]), |[_, x, y, z]| figured_slope([x, y, z]),
        "How fast the distance to a figure changes along z.";
}

/// What an outline says; nought where there is none.
fn outlined(number: f64, p: [f64; 2], of: impl Fn(Nearest) -> f64) -> f64 {
    Kept::<Outline>::find(number).map_or(0.0, |outline| of(outline.at(p)))
}

fn outlined_slope(number: Interval, [x, y]: [Interval; 2], of: impl Fn([[f64; 2]; 2]) -> [f64; 2]) -> Interval {
    if x.is_empty() || y.is_empty() {
        return I::EMPTY;
    }
    let outline = if number.is_point() { Kept::<Outline>::find(number.lo) } else { None };
    let [lo, hi] = outline.map_or([-1.0, 1.0], |outline| of(outline.gradient_within([x.lo, y.lo], [x.hi, y.hi])));
    I { lo, hi }
}

fn outlined_interval(number: Interval, [x, y]: [Interval; 2]) -> Interval {
    if x.is_empty() || y.is_empty() {
        return I::EMPTY;
    }
    if !number.is_point() {
        return I::ALL;
    }
    Kept::<Outline>::find(number.lo).map_or(I::ZERO, |outline| {
        let [lo, hi] = outline.value_within([x.lo, y.lo], [x.hi, y.hi]);
        I { lo, hi }
    })
}

/// What a figure says; nought where there is none.
fn figured(number: f64, p: [f64; 3], of: impl Fn(Found) -> f64) -> f64 {
    Kept::<Figure>::find(number).map_or(0.0, |figure| of(figure.at(p)))
}

/// It is a coordinate of a direction.
fn figured_slope(p: [Interval; 3]) -> Interval {
    if p.iter().any(|side| side.is_empty()) { I::EMPTY } else { I { lo: -1.0, hi: 1.0 } }
}

fn figured_interval(number: Interval, p: [Interval; 3]) -> Interval {
    if p.iter().any(|side| side.is_empty()) {
        return I::EMPTY;
    }
    if !number.is_point() {
        return I::ALL;
    }
    Kept::<Figure>::find(number.lo).map_or(I::ZERO, |figure| {
        let [lo, hi] = figure.value_within(p.map(|side| side.lo), p.map(|side| side.hi));
        I { lo, hi }
    })
}

/// What a grid says; nought where there is none.
fn sampled(number: f64, of: impl Fn(&Grid) -> f64) -> f64 {
    Kept::<Grid>::find(number).map_or(0.0, |grid| of(&grid))
}

fn sampled_interval(number: Interval, p: [Interval; 3], of: impl Fn(&Hull) -> [f64; 2]) -> Interval {
    if p.iter().any(|side| side.is_empty()) {
        return I::EMPTY;
    }
    if !number.is_point() {
        return I::ALL;
    }
    Kept::<Grid>::find(number.lo).map_or(I::ZERO, |grid| {
        let [lo, hi] = of(&grid.hull_within(p.map(|side| side.lo), p.map(|side| side.hi)));
        I { lo, hi }
    })
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
    // The angle turns over from pi to -pi across the negative half of the x axis, which what is never below it does not cross.
    if x.lo <= 0.0 && y.contains(0.0) || !x.is_finite() || !y.is_finite() {
        return I::new(if y.lo >= 0.0 { 0.0 } else { -pi }, pi);
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
