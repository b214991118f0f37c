//! What a function is written with: what is known of the module, and of the function so far.

use crate::emit::arms::{Arm, Arms, BlockId};
use crate::emit::body::Body;
use crate::emit::code::ExprId;
use crate::emit::library::{FIGURES, GRIDS, Helpers, OUTLINES};
use crate::emit::names::Scope;
use crate::emit::plan::{Plans, TargetId};
use crate::emit::table::Tables;
use crate::emit::uniforms::Candidates;
use crate::graph::interval::Interval;
use crate::graph::{Graph, NodeId, ShapeId};
use crate::interface::Rounding;
use rustc_hash::FxHashMap;
use std::ops::Range;

/// Lists of more bytes do not stand in a text: browsers take no larger constant (65,536 bytes, by Tint).
const MOST_WRITTEN: usize = 60_000;

/// What writing a function needs to know of the module.
pub struct Context<'a> {
    /// The graph, for names.
    pub graph: &'a Graph,
    /// The functions of shapes.
    pub plans: &'a Plans<'a>,
    /// Name of each function that stands alone, by target.
    pub functions: FxHashMap<TargetId, String>,
    /// Operations in one call of each, as far as they are written.
    pub operations: FxHashMap<TargetId, usize>,
    /// Names of the module.
    pub module: Scope,
    /// Before every name of the module.
    pub prefix: &'a str,
    /// Name of the uniform block's variable.
    pub uniform_name: String,
    /// Live values; those that are read are marked.
    pub uniforms: Candidates,
    /// Helpers; those that are called are marked.
    pub helpers: Helpers,
    /// Texts of numbers, by their bits: most stand in several functions.
    pub numbers: FxHashMap<u32, String>,
    /// Room that each function is written with.
    pub room: Room,
    /// What rounding grows with: so far the axes of which the point of the scene is read as it is, and not only as the way from a place far out.
    pub rounding: Rounding,
    /// The largest number that is added to another, as it counts in the result, and the sum's place in the graph.
    pub sums: (f64, Option<NodeId>),
    /// The same of each function of a shape that is written.
    pub called: FxHashMap<TargetId, (f64, Option<NodeId>)>,
    /// The unions that are tables.
    pub tables: &'a Tables,
    /// The places of a text at which a line begins that is computed for a shape, in their order.
    pub places: Vec<(usize, ShapeId)>,
    /// What the function that is written calls [`crate::graph::Leaf::Normal`].
    pub facing: &'static str,
}

impl Context<'_> {
    /// How many operations a function is written in: what is a loop itself is as long as one of its turns.
    pub(super) fn written(&self, target: TargetId) -> usize {
        let operations = self.operations.get(&target).copied().unwrap_or(0);
        let turns = self.plans.get(target).and_then(|t| self.plans.table(t)).map_or(1, |table| table.entries.len());
        operations / turns.max(1)
    }

    /// Whether a function that is written reads a grid.
    pub fn has_grids(&self) -> bool {
        self.helpers.pieces().any(|piece| piece.name == GRIDS)
    }

    /// Whether a function that is written reads an outline.
    pub fn has_outlines(&self) -> bool {
        self.helpers.pieces().any(|piece| piece.name == OUTLINES)
    }

    /// Whether a function that is written reads a figure.
    pub fn has_figures(&self) -> bool {
        self.helpers.pieces().any(|piece| piece.name == FIGURES)
    }

    /// Whether one reads an outline or a figure, which may stand in a text.
    pub fn has_shapes(&self) -> bool {
        self.has_outlines() || self.has_figures()
    }

    /// Whether what is read is too large for a text: grids, and outlines and figures of many pieces.
    pub fn needs_buffers(&self) -> bool {
        let Tables { outlines, figures, .. } = self.tables;
        let shapes = || outlines.iter().map(|kept| kept.data.bytes()).sum::<usize>() + figures.iter().map(|kept| kept.data.bytes()).sum::<usize>();
        let entries = || self.tables.tables.values().map(|table| size_of::<u32>() * table.entries.len()).sum::<usize>();
        self.has_grids() || (self.has_shapes() && shapes() + entries() > MOST_WRITTEN)
    }

    /// Whether a function that is written reads a table, a grid, an outline or a figure.
    pub fn has_tables(&self) -> bool {
        self.has_grids() || self.has_shapes() || self.functions.keys().filter_map(|id| self.plans.get(*id)).any(|t| self.plans.table(t).is_some_and(|table| table.turns.is_none()))
    }
}

/// What is written of a function so far. It is kept for the next one's sake, empty.
#[derive(Debug, Default)]
pub struct Room {
    pub(super) scratch: String,
    pub(super) states: Vec<State>,
    pub(super) ranges: Vec<Interval>,
    pub(super) order: Vec<ExprId>,
    pub(super) stack: Vec<(ExprId, u32, usize)>,
    pub(super) locals: Scope,
}

/// What is known of an expression while its function is written.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct State {
    pub(super) text: Text,
    /// How often it is used.
    pub(super) uses: u32,
    /// Whether it can't be negative, however it is rounded.
    pub(super) not_negative: bool,
    /// Whether it is a vector of which components are read.
    pub(super) taken_apart: bool,
    /// Whether it is a root, or the least or largest of roots that nothing else reads.
    pub(super) rooted: bool,
    /// Whether its square is written instead, of which another one takes the root.
    pub(super) squared: bool,
    /// Whether its range matters: something below a division is made of it.
    pub(super) ranged: bool,
}

/// Text of an expression, in the scratch of its writer.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Text {
    pub(super) start: u32,
    pub(super) length: u32,
    /// How strongly it binds: 9 for names and calls.
    pub(super) strength: u8,
    /// Whether it is as short as it can be: a name, a number.
    pub(super) atom: bool,
}

impl Text {
    pub(super) fn range(self) -> Range<usize> {
        self.start as usize..(self.start + self.length) as usize
    }
}

/// What a function holds at all.
#[derive(Debug, Default)]
pub(super) struct Seen {
    /// The point of the scene.
    pub(super) scene: bool,
    /// A least or a largest value.
    pub(super) extremum: bool,
    /// The arms of choices that may be worth a branch.
    pub(super) dear: Vec<Arm>,
}

/// A function that is being written.
pub(super) struct Writer<'c, 'a> {
    pub(super) context: &'c mut Context<'a>,
    pub(super) body: &'c Body,
    pub(super) out: &'c mut String,
    pub(super) scratch: String,
    pub(super) states: Vec<State>,
    /// All values, where a division needs to know; else empty.
    pub(super) ranges: Vec<Interval>,
    pub(super) locals: Scope,
    pub(super) operations: usize,
    /// What is computed in which branch, and which one is being written, so far in.
    pub(super) arms: Arms,
    pub(super) block: BlockId,
    pub(super) depth: usize,
    /// The results of each loop of calls.
    pub(super) results: Vec<(ExprId, Vec<Text>)>,
}
