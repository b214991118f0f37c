//! A union of many operands, as a list of steps.

use crate::analysis::Box3;
use crate::graph::joint::{Of, lowest_blend};
use crate::graph::kernel::Op;
use crate::graph::{FAR, Function, NodeId};

/// An operand stands under so many conditions; a union with more of them is written out.
pub(super) const MOST_CONDITIONS: usize = 4;

/// A union of many operands: a tree, as the steps that compute its value. The value begins as "no solid here".
#[derive(Clone, Debug, Default)]
pub struct Union {
    /// What is done, in order.
    pub steps: Vec<Step>,
    /// The reach of its widest blend.
    pub reach: f64,
    /// An operand does not matter where another one is smaller by more than this: four times the reach of the widest smooth union. A smooth union's
    /// slope by the operand that is larger by a share s of its reach is (1 - s) / 2 at most. So a chain of them that leads over four reaches
    /// passes on less than 2e-5 of a change. Infinite with other blends: the slope of `stairs_union` is 0 or 1.
    pub influence: f64,
    /// How many values are set aside at once.
    pub depth: usize,
    /// Another function of the shape that is the same; then nothing else is here.
    pub same: Option<Function>,
}

impl Union {
    /// What is done where it is no union.
    pub fn fold(&self) -> Option<Op> {
        self.steps.iter().find_map(|step| match step {
            Step::Operand(_, Join::Fold(op)) => Some(*op),
            _ => None,
        })
    }

    /// Where all operands are over this level there is no solid.
    ///
    /// No blend falls as an operand grows. So the level is minus the union's value where all operands are zero.
    pub fn stands_out(&self) -> f64 {
        let joined = |older: f64, newer: f64, join: &Join| match join {
            Join::Blend { .. } => lowest_blend(older, newer, self.reach),
            Join::Least | Join::Fold(_) => older.min(newer),
        };
        let (mut aside, mut value) = (Vec::new(), f64::INFINITY);
        for step in &self.steps {
            value = match step {
                Step::Push => {
                    aside.push(value);
                    f64::INFINITY
                }
                Step::Operand(_, join) => joined(value, 0.0, join),
                Step::Pop(join) => joined(aside.pop().unwrap_or(f64::INFINITY), value, join),
            };
        }
        (-value).max(0.0)
    }

    /// The value before anything is joined with it.
    pub fn start(&self) -> f64 {
        match self.fold() {
            Some(Op::Add) => 0.0,
            Some(Op::Mul) => 1.0,
            Some(Op::Max) => f64::from(f32::MIN),
            Some(_) => f64::from(f32::MAX),
            None => FAR,
        }
    }
}

/// A step of a [`Union`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// Joins the value with an operand. With "no solid here" that is the operand.
    Operand(Operand, Join),
    /// Sets the value aside; the next is "no solid here".
    Push,
    /// Joins the value that was set aside with this one.
    Pop(Join),
}

/// Conditions that are the same at all points; all of them have to hold.
pub type When = [Option<NodeId>; MOST_CONDITIONS];

/// What is united.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Operand {
    /// The function that it is.
    pub of: Of,
    /// The conditions under which it is there.
    pub when: When,
    /// Its Lipschitz constant over all space; infinite where none is known.
    pub steepness: f64,
    /// A box that holds its solid; not finite where none is known.
    pub region: Box3,
}

/// Two values made one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Join {
    /// The lesser of the two.
    Least,
    /// Numbers: their sum, their product, the lesser or the greater of the two. What is no union, but is as long.
    Fold(Op),
    /// A blend.
    Blend {
        /// The function whose formula does it.
        of: Of,
        /// The functions that it calls: of the older value and of the newer one.
        operands: [Of; 2],
    },
}
