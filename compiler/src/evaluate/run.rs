//! The interpreter. Every operation computes what its row in the kernel's table says; the common ones in a form that becomes vector
//! code, which a test compares with the table.

use super::{Evaluator, INPUTS, Instruction, LANES, Lanes, Tape, lanes};
use crate::graph::kernel::Op;

impl<'t> Evaluator<'t> {
    pub(super) fn new(tape: &'t Tape) -> Self {
        let mut registers = vec![[0.0; LANES]; tape.registers as usize];
        for (register, &constant) in registers.iter_mut().skip(INPUTS).zip(&tape.constants) {
            *register = [constant; LANES];
        }
        Self { tape, registers }
    }

    /// The tape.
    pub fn tape(&self) -> &'t Tape {
        self.tape
    }

    /// Computes the formulas at [`LANES`] points of the scene; their values are read by [`Evaluator::output`]. The normals of
    /// [`Evaluator::set_normals`] stay.
    pub fn run(&mut self, points: &[Lanes; 3]) {
        for (register, lanes) in self.registers.iter_mut().zip(points) {
            *register = *lanes;
        }
        for instruction in &self.tape.code {
            execute(&mut self.registers, instruction);
        }
    }

    /// The surface's normal at each of the points, where a formula reads it.
    pub fn set_normals(&mut self, normals: &[Lanes; 3]) {
        for (register, lanes) in self.registers.iter_mut().skip(3).zip(normals) {
            *register = *lanes;
        }
    }

    /// The values of a formula at the points of the last run.
    pub fn output(&self, index: usize) -> &Lanes {
        const ZERO: &Lanes = &[0.0; LANES];
        let register = self.tape.outputs.get(index).map_or(usize::MAX, |&r| r as usize);
        self.registers.get(register).unwrap_or(ZERO)
    }

    /// Computes the formulas at any number of points, with a normal for each where a formula reads it (else none), and hands over
    /// the index of each point with the values of its formulas.
    pub fn at(
        &mut self,
        points: &[[f64; 3]],
        normals: &[[f64; 3]],
        mut each: impl FnMut(usize, &[f64]),
    ) {
        let mut values = vec![0.0; self.tape.outputs()];
        for (batch, points) in points.chunks(LANES).enumerate() {
            let first = batch * LANES;
            if let Some(normals) = normals.get(first..first + points.len()) {
                self.set_normals(&lanes(normals));
            }
            self.run(&lanes(points));
            for lane in 0..points.len() {
                for (i, value) in values.iter_mut().enumerate() {
                    *value = self.output(i).get(lane).copied().unwrap_or(0.0);
                }
                each(first + lane, &values);
            }
        }
    }
}

/// The value of an operation as the interpreter computes it.
pub(super) fn value(op: Op, arguments: [f64; 4]) -> f64 {
    let mut registers = [[0.0; LANES]; 5];
    for (register, argument) in registers.iter_mut().zip(arguments) {
        *register = [argument; LANES];
    }
    execute(&mut registers, &Instruction { op, to: 4, from: [0, 1, 2, 3] });
    registers.last().and_then(|lanes| lanes.first()).copied().unwrap_or(0.0)
}

/// One instruction. Every register that a tape names is there: [`Evaluator::new`] made them.
#[allow(clippy::indexing_slicing)]
#[inline(always)]
fn execute(registers: &mut [Lanes], instruction: &Instruction) {
    let [a, b, c, d] = instruction.from.map(|r| r as usize);
    let to = instruction.to as usize;
    macro_rules! one {
        ($f:expr) => {{
            let x = &registers[a];
            let out: Lanes = std::array::from_fn(|i| $f(x[i]));
            registers[to] = out;
        }};
    }
    macro_rules! two {
        ($f:expr) => {{
            let (x, y) = (&registers[a], &registers[b]);
            let out: Lanes = std::array::from_fn(|i| $f(x[i], y[i]));
            registers[to] = out;
        }};
    }
    match instruction.op {
        Op::Add => two!(|x: f64, y: f64| x + y),
        Op::Sub => two!(|x: f64, y: f64| x - y),
        Op::Mul => two!(|x: f64, y: f64| x * y),
        Op::Square => one!(|x: f64| x * x),
        Op::Div => two!(|x: f64, y: f64| {
            let quotient = x / y;
            if y == 0.0 { 0.0 } else { quotient }
        }),
        Op::Neg => one!(|x: f64| -x),
        Op::Min => two!(smaller),
        Op::Max => two!(larger),
        Op::Abs => one!(|x: f64| x.abs()),
        Op::Floor => one!(|x: f64| {
            let whole = nearest(x);
            whole - if whole > x { 1.0 } else { 0.0 }
        }),
        Op::Ceil => one!(|x: f64| {
            let whole = nearest(x);
            whole + if whole < x { 1.0 } else { 0.0 }
        }),
        Op::Round => one!(nearest),
        Op::Sqrt => one!(|x: f64| larger(x, 0.0).sqrt()),
        Op::Sin => registers[to] = sine(&registers[a], 0.0),
        Op::Cos => registers[to] = sine(&registers[a], 1.0),
        Op::Length2 => two!(|x: f64, y: f64| (x * x + y * y).sqrt()),
        Op::Length3 => {
            let (x, y, z) = (&registers[a], &registers[b], &registers[c]);
            let out: Lanes =
                std::array::from_fn(|i| (x[i] * x[i] + y[i] * y[i] + z[i] * z[i]).sqrt());
            registers[to] = out;
        }
        Op::Select => {
            let (x, y, z) = (&registers[a], &registers[b], &registers[c]);
            let out: Lanes = std::array::from_fn(|i| if x[i] != 0.0 { y[i] } else { z[i] });
            registers[to] = out;
        }
        Op::Lt => two!(|x: f64, y: f64| if x < y { 1.0 } else { 0.0 }),
        Op::Le => two!(|x: f64, y: f64| if x <= y { 1.0 } else { 0.0 }),
        Op::Eq => two!(|x: f64, y: f64| if x == y { 1.0 } else { 0.0 }),
        Op::And => two!(|x: f64, y: f64| if (x != 0.0) & (y != 0.0) { 1.0 } else { 0.0 }),
        Op::Or => two!(|x: f64, y: f64| if (x != 0.0) | (y != 0.0) { 1.0 } else { 0.0 }),
        Op::Not => one!(|x: f64| if x == 0.0 { 1.0 } else { 0.0 }),
        Op::Hash => {
            let out = hash([&registers[a], &registers[b], &registers[c], &registers[d]]);
            registers[to] = out;
        }
        other => {
            let value = other.row().value;
            let (x, y, z, w) = (&registers[a], &registers[b], &registers[c], &registers[d]);
            let out: Lanes = std::array::from_fn(|i| value([x[i], y[i], z[i], w[i]]));
            registers[to] = out;
        }
    }
}

/// The kernel's hash, in all lanes at once.
fn hash(from: [&Lanes; 4]) -> Lanes {
    // The low bits of the sum are the nearest whole number.
    let word = |x: f64| (x.clamp(-2_147_483_520.0, 2_147_483_520.0) + ROUNDER).to_bits() as u32;
    let mix = |v: u32| v.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    let [mut x, mut y, mut z, mut w] = from.map(|lanes| lanes.map(|v| mix(word(v))));
    for _ in 0..2 {
        for (((x, y), z), w) in x.iter_mut().zip(&mut y).zip(&mut z).zip(&mut w) {
            *x = x.wrapping_add(y.wrapping_mul(*w));
            *y = y.wrapping_add(z.wrapping_mul(*x));
            *z = z.wrapping_add(x.wrapping_mul(*y));
            *w = w.wrapping_add(y.wrapping_mul(*z));
            *x ^= *x >> 16;
            *y ^= *y >> 16;
            *z ^= *z >> 16;
            *w ^= *w >> 16;
        }
    }
    let mut out = [0.0; LANES];
    for ((out, x), w) in out.iter_mut().zip(&x).zip(&w) {
        *out = f64::from((x ^ w) >> 8) / 16_777_216.0;
    }
    out
}

fn smaller(x: f64, y: f64) -> f64 {
    if x < y { x } else { y }
}

fn larger(x: f64, y: f64) -> f64 {
    if x > y { x } else { y }
}

/// One and a half times 2^52: a number added to it is rounded to a whole one, halves to the even one.
const ROUNDER: f64 = 6_755_399_441_055_744.0;

/// The nearest whole number, halves to the even one. From 2^51 on every number that matters is whole.
fn nearest(x: f64) -> f64 {
    let whole = (x + ROUNDER) - ROUNDER;
    if x.abs() < 2_251_799_813_685_248.0 { whole } else { x }
}

/// The sine (`quarter` 0) or cosine (`quarter` 1) of each lane: reduced by quarter turns in three parts (Cody and Waite), then the
/// polynomials of FreeBSD's msun (k_sin.c, k_cos.c). Large angles go to the library.
fn sine(angles: &Lanes, quarter: f64) -> Lanes {
    const LIMIT: f64 = 1e5;
    if !angles.iter().all(|x| x.abs() < LIMIT) {
        return angles.map(|x| if quarter == 0.0 { x.sin() } else { x.cos() });
    }
    std::array::from_fn(|i| {
        let x = angles.get(i).copied().unwrap_or(0.0);
        let turned = x * std::f64::consts::FRAC_2_PI + ROUNDER;
        let quarters = turned - ROUNDER;
        let phase = (turned + quarter).to_bits();
        // Half a turn's quarter in three parts, the first two with 33 bits, so that their multiples are exact.
        let r = x - quarters * 1.570_796_326_734_125_6;
        let (r, tail) = {
            let second = quarters * 6.077_100_506_303_966e-11;
            let head = r - second;
            (head, (r - head) - second)
        };
        let tail = tail - quarters * 2.022_266_248_795_950_6e-21;
        let r = r + tail;
        let z = r * r;
        let sin = r + r
            * z
            * (-1.666_666_666_666_663_2e-1
                + z * (8.333_333_333_322_49e-3
                    + z * (-1.984_126_982_985_795e-4
                        + z * (2.755_731_370_707_006_8e-6
                            + z * (-2.505_076_025_340_686_3e-8 + z * 1.589_690_995_211_55e-10)))));
        let cos = 1.0 - 0.5 * z
            + z * z
                * (4.166_666_666_666_66e-2
                    + z * (-1.388_888_888_887_411e-3
                        + z * (2.480_158_728_947_673e-5
                            + z * (-2.755_731_435_139_066_3e-7
                                + z * (2.087_572_321_298_175e-9
                                    + z * -1.135_964_755_778_819_5e-11)))));
        let value = if phase & 1 == 0 { sin } else { cos };
        if phase & 2 == 0 { value } else { -value }
    })
}
