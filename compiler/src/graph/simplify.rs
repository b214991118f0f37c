//! Simpler terms for terms: what an operation comes to when something is known of its arguments, as constants, squares, turns and lengths that are
//! written out. The graph and the bodies of functions that are written share it through [`Terms`].

use crate::graph::kernel::Op;
use crate::graph::node::FAR;

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
    if let Some(chosen) = chosen(graph, op, a, b) {
        return Some(chosen);
    }
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
        Op::Min if let Some(step) = step(graph, a, b).or(step(graph, b, a)) => Some(step),
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
        // A logarithm grows, so a least sum can be asked for on either side.
        Op::Log if graph.gathers() && let Some((sum, least)) = at_least(graph, a) => {
            let soft = soft_maximum(graph, sum)?;
            let least = graph.constant(least.ln());
            Some(graph.op(Op::Max, &[soft, least]))
        }
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
            match ca {
                Some(condition) => Some(if condition != 0.0 { b } else { c }),
                None => compared(graph, a, b, c),
            }
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

/// A choice between the two numbers that its condition compares: the lesser, the greater, or the magnitude of one. A union is taken apart at these.
fn compared<T: Terms>(graph: &mut T, condition: T::Id, yes: T::Id, no: T::Id) -> Option<T::Id> {
    let (Op::Lt | Op::Le, &[below, above]) = graph.operation(condition)? else { return None };
    if (yes, no) == (below, above) {
        return Some(graph.op(Op::Min, &[yes, no]));
    }
    if (yes, no) == (above, below) {
        return Some(graph.op(Op::Max, &[yes, no]));
    }
    let zero = Some(0.0);
    let (positive, negative) = match (graph.as_constant(below), graph.as_constant(above)) {
        (_, of) if of == zero => (no, yes),
        (of, _) if of == zero => (yes, no),
        _ => return None,
    };
    let of_one = (positive == below || positive == above) && negated(graph, negative) == Some(positive);
    of_one.then(|| graph.op(Op::Abs, &[positive]))
}

/// `min(1 + sign(x - e), 1)`: a choice, of which more is known than of a sign.
fn step<T: Terms>(graph: &mut T, sum: T::Id, one: T::Id) -> Option<T::Id> {
    let is_one = |graph: &T, term: T::Id| graph.as_constant(term) == Some(1.0);
    let (Op::Add, &[x, y]) = graph.operation(sum)? else { return None };
    let sign = if is_one(graph, x) { y } else { x };
    if !is_one(graph, one) || !is_one(graph, x) && !is_one(graph, y) {
        return None;
    }
    let (Op::Sign, &[of]) = graph.operation(sign)? else { return None };
    let sides = match graph.operation(of) {
        Some((Op::Sub, &[x, edge])) => [x, edge],
        _ => [of, graph.constant(0.0)],
    };
    let below = graph.op(Op::Lt, &sides);
    let zero = graph.constant(0.0);
    Some(graph.op(Op::Select, &[below, zero, one]))
}

/// What a sum, difference or product comes to for each answer to a condition, where that takes no operation but the choice: so a mean by a choice of 0
/// and 1 is a choice itself.
fn chosen<T: Terms>(graph: &mut T, op: Op, a: T::Id, b: T::Id) -> Option<T::Id> {
    if !matches!(op, Op::Add | Op::Sub | Op::Mul) {
        return None;
    }
    let ca = graph.as_constant(a);
    let arms = |graph: &T, term: T::Id| match graph.operation(term) {
        Some((Op::Select, &[condition, yes, no])) => Some((condition, [yes, no])),
        _ => None,
    };
    let (condition, [first, second]) = match (arms(graph, a), arms(graph, b)) {
        (None, None) => return None,
        (Some((condition, first)), Some((other, second))) if condition == other => (condition, [first, second]),
        (Some((condition, first)), None) => (condition, [first, [b, b]]),
        (None, Some((condition, second))) => (condition, [[a, a], second]),
        _ => return None,
    };
    // A choice of 0 and 1, or of which one is 0.
    let masks = |arms: &[T::Id; 2]| arms.iter().all(|&arm| matches!(graph.as_constant(arm), Some(0.0 | 1.0)));
    let is_zero = |term: T::Id| graph.as_constant(term) == Some(0.0);
    let free = match op {
        Op::Mul => masks(&first) || masks(&second),
        Op::Sub => ca == Some(1.0) && masks(&second),
        _ => first.iter().zip(&second).all(|(&x, &y)| is_zero(x) || is_zero(y)),
    };
    let ([x, y], [u, v]) = (first, second);
    let [yes, no] = [(x, u), (y, v)];
    if !free {
        return None;
    }
    let [yes, no] = [yes, no].map(|(x, y)| graph.op(op, &[x, y]));
    Some(graph.op(Op::Select, &[condition, yes, no]))
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

/// Of `max(x, c)` with a positive constant below one, which is what a soft maximum itself asks for: x and c.
fn at_least<T: Terms>(graph: &T, a: T::Id) -> Option<(T::Id, f64)> {
    let (Op::Max, &[x, y]) = graph.operation(a)? else { return None };
    let (x, c) = graph.as_constant(y).map(|c| (x, c)).or(graph.as_constant(x).map(|c| (y, c)))?;
    (c > 0.0 && c < 1.0).then_some((x, c))
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
