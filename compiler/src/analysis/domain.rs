//! Boxes, and where formulas are looked at.

use crate::graph::interval::Interval;
use crate::graph::{ANY_TIME, Graph, Leaf, NodeId, ShapeId};
use smallvec::SmallVec;
use std::rc::Rc;

/// A box: the product of three intervals.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Box3(pub [Interval; 3]);

impl Box3 {
    /// All of space.
    pub const ALL: Self = Self([Interval::ALL; 3]);
    /// Nothing.
    pub const EMPTY: Self = Self([Interval::EMPTY; 3]);

    /// The cube about the origin with this half side.
    pub fn cube(half: f64) -> Self {
        Self([Interval::new(-half, half); 3])
    }

    /// One side; all numbers for an axis that does not exist.
    pub fn axis(&self, i: usize) -> Interval {
        self.0.get(i).copied().unwrap_or(Interval::ALL)
    }

    /// Replaces one side.
    pub fn with_axis(mut self, i: usize, side: Interval) -> Self {
        if let Some(slot) = self.0.get_mut(i) {
            *slot = side;
        }
        self
    }

    /// Whether it holds no point.
    pub fn is_empty(&self) -> bool {
        self.0.iter().any(|i| i.is_empty())
    }

    /// Whether all sides are finite.
    pub fn is_finite(&self) -> bool {
        self.0.iter().all(|i| i.is_finite())
    }

    /// Smallest box that holds both.
    pub fn hull(&self, other: &Self) -> Self {
        if self.is_empty() {
            return *other;
        }
        if other.is_empty() {
            return *self;
        }
        let mut sides = self.0;
        for (a, b) in sides.iter_mut().zip(&other.0) {
            *a = a.hull(*b);
        }
        Self(sides)
    }

    /// What both hold.
    pub fn intersect(&self, other: &Self) -> Self {
        let mut sides = self.0;
        for (a, b) in sides.iter_mut().zip(&other.0) {
            *a = a.intersect(*b);
        }
        Self(sides)
    }

    /// Grown by `amount` on every side.
    pub fn grow(&self, amount: f64) -> Self {
        Self(self.0.map(|i| i.grow(amount)))
    }

    /// The `i`-th of places that are spread over the box evenly: along each axis by another irrational part of it (Roberts, "The unreasonable
    /// effectiveness of quasirandom sequences"), so that no two of them lie on a plane.
    pub fn place(&self, i: usize) -> [f64; 3] {
        const PARTS: [f64; 3] = [0.819_172_513_4, 0.671_043_606_7, 0.549_700_477_9];
        let mut place = PARTS;
        for (at, side) in place.iter_mut().zip(&self.0) {
            *at = side.lo + side.width() * (*at * i as f64).fract();
        }
        place
    }

    /// Length of the longest side.
    pub fn size(&self) -> f64 {
        self.0.iter().map(|i| i.width()).fold(0.0, f64::max)
    }
}

/// The bits of a domain. Most have few variables.
pub type Key = SmallVec<[u64; 12]>;

/// Where a formula is looked at: a box of points, and an interval for each variable.
#[derive(Clone, Debug, PartialEq)]
pub struct Domain {
    /// Points of the own space.
    pub point: Box3,
    /// Variables in ascending order.
    pub variables: Vec<(u32, Interval)>,
    /// Whether what lies beyond the box is of no interest, because something around the formula has a region.
    pub narrowed: bool,
    /// Points farther than this from an axis (its index) are of no interest either.
    pub tube: Option<(usize, f64)>,
    /// Nor are points at which one of these nodes of the own space, which read no variables, is more than its level.
    pub within: Vec<(NodeId, f64)>,
}

impl Domain {
    /// A box, with nothing known of variables.
    pub fn of(point: Box3) -> Self {
        Self { point, variables: Vec::new(), narrowed: false, tube: None, within: Vec::new() }
    }

    /// A number of its own that is anywhere in a range.
    pub fn free_number(&mut self, graph: &mut Graph, range: Interval) -> NodeId {
        let variable = graph.fresh_variable();
        self.variables.push((variable, range));
        graph.leaf(Leaf::Variable(variable))
    }

    /// What is known of a variable.
    pub fn variable(&self, v: u32) -> Interval {
        match self.variables.binary_search_by_key(&v, |(v, _)| *v) {
            Ok(i) => self.variables.get(i).map_or(Interval::ALL, |(_, r)| *r),
            Err(_) => Interval::ALL,
        }
    }

    /// The same with another box.
    pub fn at(&self, point: Box3) -> Self {
        Self { point, ..self.clone() }
    }

    /// Smallest domain that holds both.
    pub fn hull(&self, other: &Self) -> Self {
        let mut variables = self.variables.clone();
        for (v, r) in &other.variables {
            match variables.binary_search_by_key(v, |(v, _)| *v) {
                Ok(i) => {
                    if let Some(slot) = variables.get_mut(i) {
                        slot.1 = slot.1.hull(*r);
                    }
                }
                Err(i) => variables.insert(i, (*v, *r)),
            }
        }
        Self {
            point: self.point.hull(&other.point),
            variables,
            narrowed: self.narrowed && other.narrowed,
            tube: None,
            within: if self.within == other.within { self.within.clone() } else { Vec::new() },
        }
    }

    /// The variables of which something is known.
    pub fn ids(&self) -> Vec<u32> {
        self.variables.iter().map(|(v, _)| *v).collect()
    }

    /// Its bits, to look things up by in one graph.
    pub fn key(&self) -> Key {
        let mut key = self.plain_key();
        key.extend(self.within.iter().flat_map(|(node, level)| [u64::from(node.0), level.to_bits()]));
        key
    }

    /// The same without what nodes say.
    pub fn plain_key(&self) -> Key {
        let bits = |i: &Interval| [i.lo.to_bits(), i.hi.to_bits()];
        let mut key: Key =
            self.point.0.iter().chain(self.variables.iter().map(|(_, r)| r)).flat_map(bits).collect();
        key.extend(self.tube.iter().flat_map(|(axis, radius)| [*axis as u64, radius.to_bits()]));
        key
    }

    /// Whether no point of a box is of interest.
    pub fn leaves_out(&self, part: &Box3) -> bool {
        self.tube.is_some_and(|(axis, radius)| {
            let near = |i: usize| part.axis((axis + i) % 3).mignitude();
            near(1).hypot(near(2)) > radius * (1.0 + 1e-12)
        })
    }
}

/// All that the variables of a repetition's body can be.
pub fn cell_ranges(graph: &Graph, shape: ShapeId, cells: &dyn Fn(u32) -> Option<(f64, f64)>) -> Vec<(u32, Interval)> {
    let variables = graph.shape(shape).map(|s| s.variables.clone()).unwrap_or_default();
    variables.iter().map(|&v| (v, cells(v).map_or(Interval::ALL, |(lo, hi)| Interval::new(lo, hi)))).collect()
}

/// The domain of a shape's own formula, from the intervals of a call's arguments.
pub fn call_domain(variables: &[u32], args: &[Interval]) -> Domain {
    let arg = |i: usize| args.get(i).copied().unwrap_or(Interval::ALL);
    Domain {
        variables: variables.iter().enumerate().map(|(i, &v)| (v, arg(3 + i))).collect(),
        ..Domain::of(Box3([arg(0), arg(1), arg(2)]))
    }
}

/// Parameters that stand at one value, where the facts are not meant for their whole range: components by their index, and behind them
/// the time, where that stands too.
pub type Pinned = Rc<[f64]>;

/// All values of a leaf.
pub fn leaf_range(graph: &Graph, pinned: &[f64], leaf: Leaf, domain: &Domain) -> Interval {
    match leaf {
        Leaf::P(i) => domain.point.axis(usize::from(i)),
        Leaf::Normal(_) => Interval::new(-1.0, 1.0),
        Leaf::Time => pinned.get(graph.parameters.len()).map_or(ANY_TIME, |t| Interval::point(*t)),
        Leaf::Parameter(i) => match (pinned.get(i as usize), graph.parameters.get(i as usize)) {
            (Some(value), _) => Interval::point(*value),
            (None, Some(p)) => Interval::new(p.min, p.max),
            (None, None) => Interval::ALL,
        },
        Leaf::Variable(v) => domain.variable(v),
    }
}
