//! What of a function only one arm of a choice needs, and is computed there alone.

use crate::emit::body::Body;
use crate::emit::code::{Code, ExprId};
use crate::graph::kernel::Op;

/// Index of a block: an arm that is worth a branch. 0 is the function itself.
pub type BlockId = u32;

/// An arm that costs less than this is computed whether it is taken or not: a branch is not free either.
pub const LEAST: usize = 32;

/// So many branches stand within each other at most: compilers of shaders take no more than 127 braces.
const MOST_NESTED: u32 = 24;

/// An arm of a choice: which of its arguments.
pub type Arm = (ExprId, u8);

#[derive(Clone, Copy, Debug)]
struct Block {
    parent: BlockId,
    /// The arm; of the function itself nothing.
    arm: Arm,
    cost: usize,
    kept: bool,
    /// How many kept ones it stands in, itself included.
    depth: u32,
}

/// In which block each expression of a function is computed.
#[derive(Debug, Default)]
pub struct Arms {
    blocks: Vec<Block>,
    /// By expression.
    places: Vec<BlockId>,
    /// The arms that are kept: few, while every expression is asked for its own.
    branches: Vec<(Arm, BlockId)>,
}

/// Whether an expression takes one of two values by a condition that is one for all components.
pub fn is_choice(body: &Body, id: ExprId) -> bool {
    matches!(body.code(id), Code::Op(Op::Select) | Code::VectorOp(Op::Select, _))
        && body.arguments(id).first().is_some_and(|&c| body.components(c) == 1)
}

impl Arms {
    /// Of the expressions in `order`, arguments first. `dear`: the arms that may be worth a branch, sorted. `cost`: operations of an expression,
    /// without its arguments.
    pub fn find(body: &Body, order: &[ExprId], dear: &[Arm], cost: impl Fn(ExprId) -> usize) -> Self {
        if dear.is_empty() {
            return Self::default();
        }
        const NEW: BlockId = BlockId::MAX;
        let function = Block { parent: 0, arm: (0, 0), cost: 0, kept: true, depth: 0 };
        let mut arms = Self { blocks: vec![function], places: vec![NEW; body.len()], branches: Vec::new() };
        if let Some(root) = order.last().and_then(|&root| arms.places.get_mut(root as usize)) {
            *root = 0;
        }
        // Users come before what they use.
        for &id in order.iter().rev() {
            let own = arms.place(id);
            if let Some(block) = arms.blocks.get_mut(own as usize) {
                block.cost += cost(id);
            }
            let choice = is_choice(body, id);
            for (i, &argument) in body.arguments(id).iter().enumerate() {
                let arm = (id, i as u8);
                let used = if choice && dear.binary_search(&arm).is_ok() {
                    arms.blocks.push(Block { parent: own, arm, cost: 0, kept: false, depth: 0 });
                    arms.blocks.len() as BlockId - 1
                } else {
                    own
                };
                let place = match arms.place(argument) {
                    NEW => used,
                    other => arms.common(used, other),
                };
                if let Some(slot) = arms.places.get_mut(argument as usize) {
                    *slot = place;
                }
            }
        }
        // A block is newer than the one around it.
        for i in (1..arms.blocks.len()).rev() {
            let Some(&Block { parent, cost, .. }) = arms.blocks.get(i) else { continue };
            if let Some(block) = arms.blocks.get_mut(i) {
                block.kept = cost >= LEAST;
            }
            if let Some(around) = arms.blocks.get_mut(parent as usize) {
                around.cost += cost;
            }
        }
        for i in 1..arms.blocks.len() {
            let around = arms.blocks.get(i).and_then(|block| arms.blocks.get(block.parent as usize)).map_or(0, |block| block.depth);
            if let Some(block) = arms.blocks.get_mut(i) {
                block.kept &= around < MOST_NESTED;
                block.depth = around + u32::from(block.kept);
            }
        }
        let kept = (0..).zip(&arms.blocks).skip(1).filter(|(_, block)| block.kept);
        arms.branches = kept.map(|(i, block)| (block.arm, i)).collect();
        for i in 0..arms.places.len() {
            let kept = arms.places.get(i).map_or(0, |&p| arms.kept(p));
            arms.places.get_mut(i).into_iter().for_each(|place| *place = kept);
        }
        arms
    }

    /// The block in which an expression is computed.
    pub fn place(&self, id: ExprId) -> BlockId {
        self.places.get(id as usize).copied().unwrap_or(0)
    }

    /// The branch in which an argument of a choice is computed, if it has one.
    pub fn branch(&self, choice: ExprId, argument: u8) -> Option<BlockId> {
        self.branches.iter().find(|(arm, _)| *arm == (choice, argument)).map(|(_, block)| *block)
    }

    /// Whether there is a branch at all.
    pub fn any(&self) -> bool {
        !self.branches.is_empty()
    }

    fn parent(&self, block: BlockId) -> BlockId {
        self.blocks.get(block as usize).map_or(0, |b| b.parent)
    }

    /// The innermost block around two.
    fn common(&self, mut a: BlockId, mut b: BlockId) -> BlockId {
        while a != b {
            if a > b { a = self.parent(a) } else { b = self.parent(b) }
        }
        a
    }

    /// The innermost block around one, itself included, that is kept.
    fn kept(&self, mut block: BlockId) -> BlockId {
        while self.blocks.get(block as usize).is_some_and(|b| !b.kept) {
            block = self.parent(block);
        }
        block
    }
}
