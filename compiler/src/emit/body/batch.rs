//! Calls of one function that do not wait for each other become one loop: drivers write out each call of a function, but not each turn of a loop.

use crate::emit::arms::BlockId;
use crate::emit::body::Body;
use crate::emit::code::{Code, ExprId, Exprs};
use crate::emit::plan::TargetId;
use rustc_hash::FxHashMap;
use smallvec::SmallVec;

/// One call is no loop.
const FEWEST: usize = 2;
/// Calls that take fewer operations together are written out.
const LEAST: usize = 128;

/// More calls are several loops: in each turn all of them move up.
const MOST: usize = 16;

/// Whether so many calls of a function of so many operations are worth a loop.
fn is_worth_a_loop(calls: usize, operations: usize) -> bool {
    calls >= FEWEST && calls.saturating_mul(operations) >= LEAST
}

/// Calls that are one loop.
#[derive(Clone, Debug)]
pub struct Batch {
    target: TargetId,
    calls: Exprs,
}

impl Body {
    /// Whether it holds calls of one function that may be worth a loop. `operations` are those of a function.
    pub fn may_batch(&self, operations: impl Fn(TargetId) -> usize) -> bool {
        let mut counts: SmallVec<[(TargetId, usize); 8]> = SmallVec::new();
        for expr in self.exprs.iter().filter(|_| self.calls >= FEWEST) {
            let Code::Call(target) = expr.code else { continue };
            match counts.iter_mut().find(|(known, _)| *known == target) {
                Some((_, count)) => *count += 1,
                None => counts.push((target, 1)),
            }
        }
        counts.iter().any(|&(target, count)| is_worth_a_loop(count, operations(target)))
    }

    /// The calls that may be one loop. `order` has arguments first, `place` is the block in which each expression is computed, `operations` are those of
    /// a function.
    pub fn batches(
        &self,
        order: &[ExprId],
        place: impl Fn(ExprId) -> BlockId,
        operations: impl Fn(TargetId) -> usize,
    ) -> Vec<Batch> {
        // By how many calls one waits for: what is of one level does not wait for each other.
        let mut levels = vec![0u32; self.exprs.len()];
        let mut groups: Vec<Batch> = Vec::new();
        let mut index: FxHashMap<(TargetId, u32, BlockId), usize> = FxHashMap::default();
        for &id in order {
            let args = self.arguments(id);
            let mut level = args.iter().filter_map(|&a| levels.get(a as usize)).copied().max().unwrap_or(0);
            if let Code::Call(target) = self.code(id) {
                level += 1;
                let at = *index.entry((target, level, place(id))).or_insert_with(|| {
                    groups.push(Batch { target, calls: Exprs::new() });
                    groups.len() - 1
                });
                // Which arguments differ is a bit for each.
                if let (Some(batch), true) = (groups.get_mut(at), args.len() <= u32::BITS as usize) {
                    batch.calls.push(id);
                }
            }
            if let Some(slot) = levels.get_mut(id as usize) {
                *slot = level;
            }
        }
        let part = |Batch { target, calls }: &Batch| {
            let loops = calls.len().div_ceil(MOST).max(1);
            let parts: Vec<Batch> = calls.chunks(calls.len().div_ceil(loops).max(1)).map(|calls| Batch { target: *target, calls: calls.into() }).collect();
            parts
        };
        groups.iter().flat_map(part).filter(|batch| is_worth_a_loop(batch.calls.len(), operations(batch.target))).collect()
    }

    /// Lets results of loops stand for calls. The answer: what stands for the root.
    pub fn batch(&mut self, batches: &[Batch], root: ExprId) -> ExprId {
        let mut shared: FxHashMap<ExprId, ExprId> = FxHashMap::default();
        for Batch { target, calls } in batches {
            let mut args = Exprs::new();
            let mut moving = 0;
            for place in 0..calls.first().map_or(0, |&call| self.arguments(call).len()) {
                let of_all = calls.iter().filter_map(|&call| self.arguments(call).get(place).copied());
                if of_all.clone().all(|arg| Some(arg) == of_all.clone().next()) {
                    args.extend(of_all.take(1));
                } else {
                    moving |= 1 << place;
                    args.extend(of_all);
                }
            }
            let batch = self.add(Code::Batch(*target, calls.len() as u32, moving), &args);
            for (i, &call) in (0..).zip(calls) {
                shared.insert(call, self.add(Code::Item(i), &[batch]));
            }
        }
        let of = |id: ExprId| shared.get(&id).copied().unwrap_or(id);
        self.pool.iter_mut().for_each(|arg| *arg = of(*arg));
        of(root)
    }
}
