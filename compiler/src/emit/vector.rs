//! Numbers that belong together as one vector: `p`, `p.xz`, `abs(p) - vec3f(…)`, as a person would write them.
//!
//! Three numbers that are made alike (the same operation, of numbers that are made alike) become one operation on vectors.
//! Where such a number is used by itself too, it is read from the vector.

use crate::emit::body::{Body, FAR_OUT};
use crate::emit::code::{Code, ExprId};
use crate::emit::joined::{Joined, Part};
use crate::emit::library::LEAST_DIVISOR;
use crate::graph::kernel::Op;
use crate::graph::simplify::Terms;

/// No more operations than this lie within each other in one search: it is made by recursion.
const DEPTH: u32 = 64;

const NONE: ExprId = ExprId::MAX;

/// At most four expressions.
#[derive(Clone, Copy, Debug, Default)]
struct Few {
    all: [ExprId; 4],
    count: usize,
}

impl Few {
    fn push(&mut self, id: ExprId) {
        if let Some(slot) = self.all.get_mut(self.count) {
            *slot = id;
            self.count += 1;
        }
    }
}

impl std::ops::Deref for Few {
    type Target = [ExprId];
    fn deref(&self) -> &[ExprId] {
        self.all.get(..self.count).unwrap_or(&[])
    }
}

impl std::ops::DerefMut for Few {
    fn deref_mut(&mut self) -> &mut [ExprId] {
        self.all.get_mut(..self.count).unwrap_or(&mut [])
    }
}

impl FromIterator<ExprId> for Few {
    fn from_iter<I: IntoIterator<Item = ExprId>>(ids: I) -> Self {
        let mut few = Self::default();
        ids.into_iter().for_each(|id| few.push(id));
        few
    }
}

impl Body {
    /// The vector of some numbers, 2 to 4.
    pub fn vector(&mut self, parts: &[ExprId]) -> ExprId {
        self.join(parts, 0).id
    }

    /// Numbers that belong together, as the point or the gradient of a shape that is opened. They are read from a vector
    /// where two of them are used.
    pub fn prefer(&mut self, parts: Option<&[ExprId]>) {
        let Some(parts) = parts else { return };
        let vector = self.vector(parts);
        let name = parts.first().and_then(|&p| self.named(p));
        self.name(vector, name);
        for &part in parts {
            self.prefer_part(part, vector);
        }
    }

    /// A gradient and the field, as one vector.
    pub fn gradient(&mut self, results: &[ExprId]) -> ExprId {
        let (Some(slope), Some(&field)) = (results.get(..3), results.get(3)) else {
            return self.constant(0.0);
        };
        match self.swizzle(results) {
            Some((whole, _)) => whole,
            None => {
                let slope = self.vector(slope);
                self.add(Code::Vector(4), &[slope, field])
            }
        }
    }

    fn join(&mut self, parts: &[ExprId], depth: u32) -> Joined {
        let mut key = [NONE; 4];
        for (slot, &part) in key.iter_mut().zip(parts) {
            *slot = part;
        }
        if let Some(known) = self.joined.get(key) {
            return known;
        }
        let computed = self.computed_vector(parts).map(|id| Joined { id, gathers: 0, newest: 0 });
        let joined = computed.or_else(|| self.find(parts, depth)).unwrap_or_else(|| {
            let constant = parts.iter().all(|&p| self.as_constant(p).is_some());
            let newest = parts.iter().copied().max().unwrap_or(0);
            let id = self.add(Code::Vector(parts.len() as u8), parts);
            Joined { id, gathers: u32::from(!constant), newest: if constant { 0 } else { newest } }
        });
        self.joined.add(key, joined);
        if matches!(self.code(joined.id), Code::VectorOp(..)) {
            for (i, &part) in parts.iter().enumerate() {
                // A constant is never read from a vector: it is as good where it stands, and the vector may hold it itself.
                let stands = self.as_constant(part).is_some() || matches!(self.code(part), Code::Computed(..));
                if part > joined.newest && !stands {
                    let (plain, newest) = (joined.gathers == 0, joined.newest);
                    self.set_part(part, Part { vector: joined.id, index: i as u8, plain, newest });
                }
            }
        }
        joined
    }

    /// Something better than all components written out.
    fn find(&mut self, parts: &[ExprId], depth: u32) -> Option<Joined> {
        if let Some((id, newest)) = self.swizzle(parts) {
            return Some(Joined { id, gathers: 0, newest });
        }
        if depth >= DEPTH {
            return None;
        }
        // What is written twice is computed once, by itself.
        let twice = |(i, p): (usize, &ExprId)| parts.iter().skip(i + 1).any(|other| other == p) && self.operation(*p).is_some();
        if parts.iter().enumerate().any(twice) {
            return None;
        }
        let first = *parts.first()?;
        let mut ops = parts.iter().map(|&p| self.operation(p).map(|o| o.0));
        let op = ops.next()?;
        let same = ops.all(|o| o == op);
        match op {
            Some(op) if same => match op {
                Op::Neg | Op::Abs | Op::Sign | Op::Square | Op::Floor | Op::Ceil | Op::Trunc | Op::Round => {
                    let inner = self.join(&self.column(parts, 0), depth + 1);
                    self.combine(op, parts.len(), &[inner])
                }
                Op::Min | Op::Max => {
                    let a = self.operand(&self.column(parts, 0), depth, true);
                    let b = self.operand(&self.column(parts, 1), depth, true);
                    self.combine(op, parts.len(), &[a, b])
                }
                Op::Select => {
                    let conditions = self.column(parts, 0);
                    let condition = *conditions.first()?;
                    if conditions.iter().any(|&c| c != condition) {
                        return None;
                    }
                    let a = self.operand(&self.column(parts, 1), depth, true);
                    let b = self.operand(&self.column(parts, 2), depth, true);
                    let condition = Joined { id: condition, gathers: 0, newest: condition };
                    self.combine(op, parts.len(), &[condition, a, b])
                }
                Op::Div => {
                    let below = self.column(parts, 1);
                    let divisor = *below.first()?;
                    // The helper takes three and a number; two are divided by what needs no helper.
                    let plain = parts.len() == 3 || self.as_constant(divisor).is_some_and(|c| c.abs() >= LEAST_DIVISOR);
                    if !plain || below.iter().any(|&b| b != divisor) {
                        return None;
                    }
                    let a = self.join(&self.column(parts, 0), depth + 1);
                    let b = Joined { id: divisor, gathers: 0, newest: divisor };
                    self.combine(op, parts.len(), &[a, b])
                }
                Op::Mul => {
                    // A common factor may stand on either side.
                    let (x, y) = (self.argument(first, 0), self.argument(first, 1));
                    let has = |f| parts.iter().all(|&p| self.argument(p, 0) == f || self.argument(p, 1) == f);
                    let common = if has(y) { Some(y) } else { Some(x).filter(|&x| has(x)) };
                    let (a, b) = match common {
                        Some(f) => {
                            let rest: Few = parts
                                .iter()
                                .map(|&p| {
                                    let (x, y) = (self.argument(p, 0), self.argument(p, 1));
                                    if y == f { x } else { y }
                                })
                                .collect();
                            let a = self.join(&rest, depth + 1);
                            (a, Joined { id: f, gathers: 0, newest: self.age(f) })
                        }
                        None => {
                            let a = self.join(&self.column(parts, 0), depth + 1);
                            (a, self.join(&self.column(parts, 1), depth + 1))
                        }
                    };
                    self.combine(op, parts.len(), &[a, b])
                }
                Op::Add | Op::Sub => self.sum_of(parts, depth),
                _ => None,
            },
            _ => self.sum_of(parts, depth),
        }
    }

    /// A vector plus or minus a vector or a number. Components without either count as plus zero, constants change their sign
    /// as is needed.
    fn sum_of(&mut self, parts: &[ExprId], depth: u32) -> Option<Joined> {
        let (mut inner, mut amounts) = (Few::default(), Few::default());
        // Operations, and those among them that can't change their sign.
        let (mut sums, mut differences) = ((0, 0), (0, 0));
        for &part in parts {
            let (x, y) = match self.operation(part) {
                Some((op @ (Op::Add | Op::Sub), &[x, y])) => {
                    let fixed = u32::from(self.as_constant(y).is_none());
                    let count = if op == Op::Add { &mut sums } else { &mut differences };
                    *count = (count.0 + 1, count.1 + fixed);
                    (x, y)
                }
                _ => (part, NONE),
            };
            inner.push(x);
            amounts.push(y);
        }
        // The way from a place far out is taken from the module's origin first: so where all of it is such a way, or by itself.
        let of_scene = |id: ExprId| matches!(self.code(id), Code::Component(_)) && self.code(self.argument(id, 0)) == Code::Scene;
        let far = |id: ExprId| id != NONE && self.as_constant(id).is_some_and(|c| c.abs() > FAR_OUT);
        if inner.iter().zip(amounts.iter()).any(|(&x, &y)| of_scene(x) && far(y)) && !inner.iter().all(|&x| of_scene(x)) {
            return None;
        }
        let all = parts.len() as u32;
        let alike = sums.0 == all || differences.0 == all;
        if sums.0 + differences.0 == 0 || sums.1 > 0 && differences.1 > 0 {
            return None;
        }
        let mut op = if sums.1 > 0 || differences.0 == 0 { Op::Add } else { Op::Sub };
        let mut least_sign = sums.1 + differences.1 == 0;
        for (&part, amount) in parts.iter().zip(amounts.iter_mut()) {
            if *amount == NONE {
                *amount = self.constant(0.0);
            } else if let Some(c) = self.as_constant(*amount) {
                let turn = self.operation(part).map(|o| o.0) != Some(op);
                let c = if turn { -c } else { c };
                least_sign &= c <= 0.0;
                *amount = self.constant(c);
            }
        }
        if least_sign {
            op = if op == Op::Add { Op::Sub } else { Op::Add };
            for amount in amounts.iter_mut() {
                let c = self.as_constant(*amount).unwrap_or(0.0);
                *amount = self.constant(-c);
            }
        }
        let a = self.join(&inner, depth + 1);
        // Numbers without an addition among them should at least have something in common.
        if !alike && a.gathers > 0 {
            return None;
        }
        let b = self.operand(&amounts, depth, false);
        self.combine(op, parts.len(), &[a, b])
    }

    /// A vector, or one number for all components; as a vector of its own where the operation wants that.
    fn operand(&mut self, parts: &[ExprId], depth: u32, vector: bool) -> Joined {
        match parts.first() {
            Some(&first) if parts.iter().all(|&p| p == first) => {
                let newest = self.age(first);
                let id = if vector { self.add(Code::Splat(parts.len() as u8), &[first]) } else { first };
                Joined { id, gathers: 0, newest }
            }
            _ => self.join(parts, depth + 1),
        }
    }

    fn combine(&mut self, op: Op, count: usize, args: &[Joined]) -> Option<Joined> {
        // What is shared counts each time, so towers of sums leave every range.
        let gathers = args.iter().fold(0, |sum: u32, a| sum.saturating_add(a.gathers));
        // Vectors written out, and components in an odd order, have nothing in common that an operation would show.
        let odd = |a: &&Joined| match self.code(a.id) {
            Code::Vector(_) => a.gathers > 0,
            Code::Swizzle(n, order) => (1..n).any(|i| order >> (4 * i) & 3 <= order >> (4 * (i - 1)) & 3),
            _ => false,
        };
        let odds = args.iter().filter(odd).count();
        let by_vector = op == Op::Mul && args.iter().all(|a| self.components(a.id) > 1);
        if op != Op::Select && odds > usize::from(!by_vector) {
            return None;
        }
        let ids: Few = args.iter().map(|a| a.id).collect();
        let newest = args.iter().map(|a| a.newest).max().unwrap_or(0);
        let id = self.add(Code::VectorOp(op, count as u8), &ids);
        Some(Joined { id, gathers, newest })
    }

    /// The number of an expression, a constant's being the oldest: it waits for nothing.
    fn age(&self, id: ExprId) -> ExprId {
        if self.as_constant(id).is_some() { 0 } else { id }
    }

    fn argument(&self, id: ExprId, i: usize) -> ExprId {
        self.arguments(id).get(i).copied().unwrap_or(NONE)
    }

    fn column(&self, parts: &[ExprId], i: usize) -> Few {
        parts.iter().map(|&p| self.argument(p, i)).collect()
    }

    /// The numbers as components of one vector, if they are that; and the newest number inside it.
    fn swizzle(&mut self, parts: &[ExprId]) -> Option<(ExprId, ExprId)> {
        let (mut base, mut newest, mut order, mut identity) = (None, 0, 0u16, true);
        for (i, &part) in parts.iter().enumerate() {
            let (of, c, age) = match self.code(part) {
                Code::Component(c) => {
                    let of = *self.arguments(part).first()?;
                    (of, c, of)
                }
                _ => self.part(part).map(|p| (p.vector, p.index, p.newest))?,
            };
            if *base.get_or_insert(of) != of {
                return None;
            }
            newest = newest.max(age);
            order |= u16::from(c) << (4 * i);
            identity &= usize::from(c) == i;
        }
        let (base, count) = (base?, parts.len() as u8);
        if identity && self.components(base) == count {
            return Some((base, newest));
        }
        Some((self.add(Code::Swizzle(count, order), &[base]), newest))
    }
}
