//! Which formulas are needed, which of them become functions of the module, and in which order.

use crate::emit::error::EmitError;
use crate::emit::names::named_vectors;
use crate::emit::table::{Table, Tables};
use crate::functions::{Functions, outline_beside};
use crate::graph::kernel::Op;
use crate::graph::{Function, Graph, Leaf, Node, NodeId, ShapeId};
use rustc_hash::FxHashMap;
use std::sync::Arc;

/// What one function of the module computes of a shape. The components of a gradient come together, with the field.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Group {
    /// [`Function::Field`]
    Field,
    /// [`Function::Bound`]
    Bound,
    /// [`Function::Distance`]
    Distance,
    /// The three components of [`Function::Gradient`], then the field.
    Gradient,
}

impl Group {
    fn of(function: Function) -> (Group, Option<u8>) {
        match function {
            Function::Field => (Group::Field, None),
            Function::Bound => (Group::Bound, None),
            Function::Distance => (Group::Distance, None),
            Function::Gradient(i) => (Group::Gradient, Some(i)),
        }
    }

    /// The formulas that it is made of.
    fn functions(self) -> &'static [Function] {
        match self {
            Group::Field => &[Function::Field],
            Group::Bound => &[Function::Bound],
            Group::Distance => &[Function::Distance],
            Group::Gradient => &[
                Function::Gradient(0),
                Function::Gradient(1),
                Function::Gradient(2),
                Function::Field,
            ],
        }
    }

    /// The value among them.
    pub fn value(self) -> Function {
        match self {
            Group::Field | Group::Gradient => Function::Field,
            Group::Bound => Function::Bound,
            Group::Distance => Function::Distance,
        }
    }

    /// What the function's name ends in.
    pub fn suffix(self) -> &'static str {
        match self {
            Group::Field => "",
            Group::Bound => "_bound",
            Group::Distance => "_distance",
            Group::Gradient => "_gradient",
        }
    }
}

/// Index of a [`Target`].
pub type TargetId = u32;

/// One step of a formula; arguments are earlier steps of the same plan.
#[derive(Clone, Copy, Debug)]
pub enum Action {
    /// A number.
    Constant(f64),
    /// From outside, variables excepted.
    Leaf(Leaf),
    /// The shape's variable with this number; `position` is its place among the shape's variables.
    Variable {
        /// Its number in the graph.
        number: u32,
        /// Its place.
        position: Option<u32>,
    },
    /// A factor's multiple.
    Factor(u32),
    /// An operation.
    Op(Op),
    /// Another function.
    Call(TargetId),
    /// A component of the call before.
    Component(u8),
}

/// A step with where its arguments stand in [`Plan::arguments`].
#[derive(Clone, Copy, Debug)]
pub struct Step {
    /// What is done.
    pub action: Action,
    /// First argument.
    pub start: u32,
    /// Number of arguments.
    pub count: u32,
    /// The node, where it has a name in the source.
    pub named: Option<NodeId>,
}

/// Formulas over one space, in an order in which they can be computed.
#[derive(Clone, Debug, Default)]
pub struct Plan {
    /// The steps.
    pub steps: Vec<Step>,
    /// Arguments of the steps: indices of steps.
    pub arguments: Vec<u32>,
    /// The steps that are the results.
    pub results: Vec<u32>,
    /// Variables of the space, in ascending order.
    pub variables: Arc<[u32]>,
    /// Steps that are the components of a vector with a name in the source: 2 to 4.
    pub vectors: Vec<Vec<u32>>,
}

impl Plan {
    fn push(
        &mut self,
        action: Action,
        arguments: impl IntoIterator<Item = u32>,
        named: Option<NodeId>,
    ) -> u32 {
        let start = self.arguments.len() as u32;
        self.arguments.extend(arguments);
        let count = self.arguments.len() as u32 - start;
        self.steps.push(Step { action, start, count, named });
        self.steps.len() as u32 - 1
    }

    /// The calls from a step on: step and target.
    fn calls_after(&self, from: usize) -> impl Iterator<Item = (usize, TargetId)> + '_ {
        // Not `skip`, which would walk there.
        let rest = self.steps.get(from..).unwrap_or(&[]);
        (from..).zip(rest).filter_map(|(at, step)| match step.action {
            Action::Call(target) => Some((at, target)),
            _ => None,
        })
    }

    /// The targets that it calls.
    pub fn callees(&self) -> impl Iterator<Item = TargetId> + '_ {
        self.calls_after(0).map(|(_, id)| id)
    }

    /// Steps that compute something.
    fn work(&self) -> u64 {
        self.steps.iter().filter(|s| matches!(s.action, Action::Op(_))).count() as u64
    }

    /// Arguments of a step.
    pub fn arguments(&self, step: &Step) -> &[u32] {
        self.arguments.get(step.start as usize..(step.start + step.count) as usize).unwrap_or(&[])
    }
}

/// A function of a shape that the module needs.
#[derive(Clone, Debug)]
pub struct Target {
    /// Whose.
    pub shape: ShapeId,
    /// Which.
    pub group: Group,
    /// Whether it is a bound that computes the same as the field.
    is_field: bool,
    /// How it is computed.
    pub plan: Plan,
    /// Whether it becomes a function of the module; else it is opened where it is called.
    pub stands_alone: bool,
    /// How often it is computed, over the text of the module.
    uses: u64,
    /// Steps, with those of what it calls and opens.
    size: u64,
}

/// A body above this many steps, if opened twice, is a function instead.
const LARGE: u64 = 14;

/// A body of one call and at most so many other steps is opened wherever it is called.
const SMALL: u64 = 8;

/// More shapes of one name than this are opened where they are used once: so many functions bury the reader.
const MANY: u32 = 24;

/// All functions of shapes that the module needs.
pub struct Plans<'a> {
    graph: &'a Graph,
    functions: &'a Functions,
    tables: &'a Tables,
    /// The functions, callers and callees mixed.
    pub targets: Vec<Target>,
    /// For each shape and group the target, if there is one.
    index: Vec<[Option<TargetId>; 4]>,
    /// For each node of the plan that is being made, the step that computes it; room that is kept.
    places: Vec<u32>,
    /// The nodes of that plan; room too.
    nodes: Vec<NodeId>,
    /// Pairs of formulas that were compared, and whether they compute the same.
    compared: FxHashMap<(NodeId, NodeId), bool>,
}

/// Formulas that are nested deeper than this are not compared.
const DEEPEST: u32 = 200;

impl<'a> Plans<'a> {
    /// No function yet.
    pub fn new(graph: &'a Graph, functions: &'a Functions, tables: &'a Tables) -> Self {
        let places = vec![0; graph.len()];
        let shapes = graph.shapes().len();
        let (targets, index) = (Vec::with_capacity(shapes), vec![[None; 4]; shapes]);
        let mut plans = Self { graph, functions, tables, targets, index, places, nodes: Vec::new(), compared: FxHashMap::default() };
        // Those that many others stand around are compared before them, so that the depth does not follow their number.
        for (shape, _) in graph.shapes().filter(|_| shapes > DEEPEST as usize / 2) {
            plans.same(shape, Group::Distance, 0);
            plans.same(shape, Group::Bound, 0);
        }
        plans
    }

    /// Whether a shape has the formulas of a group.
    pub fn has(&self, shape: ShapeId, group: Group) -> bool {
        group.functions().iter().all(|f| self.functions.formulas.contains_key(&(shape, *f)))
    }

    /// The function that computes a group of a shape; where the formula is that of another group of the shape, that one.
    /// Its plan is made by [`Plans::complete`].
    pub fn target(&mut self, shape: ShapeId, group: Group) -> TargetId {
        if let Some(id) = self.known(shape, group) {
            return id;
        }
        let same = self.same(shape, group, 0);
        let id = match self.known(shape, same) {
            Some(id) => id,
            None => {
                let plan = Plan::default();
                let is_field = same == Group::Bound && self.alike(shape, Function::Bound, Function::Field, 0);
                let target = Target { shape, group: same, plan, is_field, stands_alone: false, uses: 0, size: 0 };
                self.targets.push(target);
                self.targets.len() as TargetId - 1
            }
        };
        if let Some(of_shape) = self.index.get_mut(shape.0 as usize) {
            for group in [same, group] {
                of_shape.get_mut(group as usize).into_iter().for_each(|slot| *slot = Some(id));
            }
        }
        id
    }

    fn known(&self, shape: ShapeId, group: Group) -> Option<TargetId> {
        *self.index.get(shape.0 as usize)?.get(group as usize)?
    }

    /// The table that a target is computed from, where it is a union of many.
    pub fn table(&self, target: &Target) -> Option<&'a Table> {
        let table = self.tables.get((target.shape, target.group.value()))?;
        (target.group != Group::Gradient || table.gradient).then_some(table)
    }

    /// The table of a union behind whose region a bound stands: beyond that the distance to the region is enough.
    pub fn region(&self, target: &Target) -> Option<&'a Table> {
        (target.is_field && self.table(target).is_none()).then(|| self.region_of(target.shape))?
    }

    /// The table of a shape's field, where the shape lies in a region.
    fn region_of(&self, shape: ShapeId) -> Option<&'a Table> {
        self.tables.get((shape, Function::Field)).filter(|t| t.region.is_some())
    }

    /// The gradient of a shape, where the module needs it.
    pub fn gradient(&self, shape: ShapeId) -> Option<TargetId> {
        self.known(shape, Group::Gradient)
    }

    /// The gradient's function that gives the field of `target` too, where it stands alone.
    pub fn field_from_gradient(&self, target: &Target) -> Option<TargetId> {
        let id = (target.group == Group::Field).then(|| self.gradient(target.shape))??;
        self.get(id).filter(|t| t.stands_alone).map(|_| id)
    }

    /// A target.
    pub fn get(&self, id: TargetId) -> Option<&Target> {
        self.targets.get(id as usize)
    }

    /// Makes the plans of all targets and of what they call, and decides which become functions. `roots` are computed so often
    /// from outside; `surfaces` call too. The answer: those that stand alone, callees before callers.
    pub fn complete<'s>(
        &mut self,
        roots: &[(TargetId, u64)],
        surfaces: impl Iterator<Item = &'s Plan>,
    ) -> Result<Vec<TargetId>, EmitError> {
        let mut at = 0;
        while let Some(target) = self.targets.get(at) {
            let (shape, group) = (target.shape, target.group);
            at += 1;
            if self.table(target).is_some() {
                continue;
            }
            if self.region(target).is_some() {
                let field = self.target(shape, Group::Field);
                let mut plan = Plan::default();
                let point = [0, 1, 2].map(|i| plan.push(Action::Leaf(Leaf::P(i)), [], None));
                let call = plan.push(Action::Call(field), point, None);
                plan.results.push(call);
                if let Some(target) = self.targets.get_mut(at - 1) {
                    target.plan = plan;
                }
                continue;
            }
            let mut formulas = [NodeId::default(); 4];
            for (slot, &function) in formulas.iter_mut().zip(group.functions()) {
                let formula = self.functions.formulas.get(&(shape, function));
                *slot = *formula.ok_or(EmitError::NoFormula(shape, function))?;
            }
            let formulas = formulas.get(..group.functions().len()).unwrap_or(&formulas);
            let variables =
                self.graph.shape(shape).map(|s| s.variables.clone()).unwrap_or_default();
            let plan = self.plan_of(Some(shape), formulas, variables);
            if let Some(target) = self.targets.get_mut(at - 1) {
                target.plan = plan;
            }
        }
        let order = self.callees_first()?;
        self.decide(&order, roots, surfaces);
        Ok(order.into_iter().filter(|&id| self.get(id).is_some_and(|t| t.stands_alone)).collect())
    }

    fn callees_first(&self) -> Result<Vec<TargetId>, EmitError> {
        #[derive(Clone, Copy, PartialEq)]
        enum State {
            New,
            Open,
            Done,
        }
        let mut state = vec![State::New; self.targets.len()];
        let mut order = Vec::with_capacity(self.targets.len());
        let mut stack = Vec::new();
        for first in 0..self.targets.len() as TargetId {
            stack.push((first, 0usize));
            while let Some((id, from)) = stack.pop() {
                let Some(now) = state.get_mut(id as usize) else { continue };
                if *now == State::Done || (*now == State::Open && from == 0) {
                    continue;
                }
                *now = State::Open;
                let Some(target) = self.get(id) else { continue };
                let next = target.plan.calls_after(from).find_map(|(at, callee)| {
                    let callee_state = state.get(callee as usize).copied();
                    (callee_state != Some(State::Done)).then_some((at, callee, callee_state))
                });
                match next {
                    Some((_, _, Some(State::Open))) => {
                        return Err(EmitError::Cycle(target.shape));
                    }
                    Some((at, callee, _)) => {
                        stack.push((id, at + 1));
                        stack.push((callee, 0));
                    }
                    None => {
                        if let Some(now) = state.get_mut(id as usize) {
                            *now = State::Done;
                        }
                        order.push(id);
                    }
                }
            }
        }
        Ok(order)
    }

    fn decide<'s>(
        &mut self,
        callees_first: &[TargetId],
        roots: &[(TargetId, u64)],
        surfaces: impl Iterator<Item = &'s Plan>,
    ) {
        let mut same_name: FxHashMap<&str, (u32, Option<ShapeId>)> = FxHashMap::default();
        let graph = self.graph;
        for target in &self.targets {
            if let Some(name) = graph.shape(target.shape).and_then(|s| s.name.as_deref()) {
                let (count, last) = same_name.entry(name).or_insert((0, None));
                if *last != Some(target.shape) {
                    *count += 1;
                    *last = Some(target.shape);
                }
            }
        }
        let is_root = |id| roots.iter().any(|r| r.0 == id);
        for &id in callees_first {
            let Some(target) = self.targets.get(id as usize) else { continue };
            let mut size = target.plan.work();
            for (_, callee) in target.plan.calls_after(0) {
                let callee = self.targets.get(callee as usize);
                size = size.saturating_add(callee.map_or(0, |c| if c.stands_alone { 1 } else { c.size }));
            }
            let tabled = self.table(target).is_some() || self.region(target).is_some();
            let name = graph.shape(target.shape).and_then(|s| s.name.as_deref());
            let named = name.is_some_and(|n| same_name.get(n).is_some_and(|c| c.0 <= MANY));
            if let Some(target) = self.targets.get_mut(id as usize) {
                target.size = size;
                target.stands_alone = named && !is_root(id) || tabled;
            }
        }
        let called = surfaces.flat_map(|s| s.calls_after(0)).map(|(_, id)| (id, 1));
        for (id, uses) in roots.iter().copied().chain(called) {
            if let Some(target) = self.targets.get_mut(id as usize) {
                target.uses = target.uses.saturating_add(uses);
            }
        }
        for &id in callees_first.iter().rev() {
            let Some(target) = self.targets.get_mut(id as usize) else { continue };
            // What only calls another shape at a moved point is opened: that one stands alone then, if it is large.
            let wraps = target.plan.work() <= SMALL && target.plan.calls_after(0).count() == 1;
            target.stands_alone |= target.uses > 1 && target.size > LARGE && !wraps;
            let times = if target.stands_alone { 1 } else { target.uses };
            let plan = std::mem::take(&mut target.plan);
            for (_, callee) in plan.calls_after(0) {
                if let Some(callee) = self.targets.get_mut(callee as usize) {
                    callee.uses = callee.uses.saturating_add(times);
                }
            }
            if let Some(target) = self.targets.get_mut(id as usize) {
                target.plan = plan;
            }
        }
    }

    /// Whether a shape's bound is its estimate of the distance.
    pub fn is_one(&mut self, shape: ShapeId) -> bool {
        self.same(shape, Group::Bound, 0) == self.same(shape, Group::Distance, 0)
    }

    /// The first group of a shape whose formula computes the same: the same node, a call that passes everything on, or see [`Plans::computes`].
    fn same(&mut self, shape: ShapeId, group: Group, depth: u32) -> Group {
        let (first, earlier): (Function, &[(Function, Group)]) = match group {
            Group::Bound => (Function::Bound, &[(Function::Field, Group::Field)]),
            Group::Distance => (
                Function::Distance,
                &[(Function::Field, Group::Field), (Function::Bound, Group::Bound)],
            ),
            Group::Field | Group::Gradient => return group,
        };
        for &(function, other) in earlier {
            if self.alike(shape, first, function, depth) {
                if group == Group::Bound && self.region_of(shape).is_some() {
                    return group;
                }
                return self.same(shape, other, depth);
            }
        }
        group
    }

    /// Whether two functions of a shape compute the same.
    fn alike(&mut self, shape: ShapeId, one: Function, other: Function, depth: u32) -> bool {
        let functions = self.functions;
        let formula = |f: Function| functions.formulas.get(&(shape, f)).copied();
        let Some(own) = formula(one) else { return false };
        let union = functions.unions.get(&(shape, one));
        union.is_some_and(|u| u.same == Some(other)) && self.tables.get((shape, other)).is_some()
            || self.passes_on(own, shape, other)
            || formula(other).is_some_and(|f| self.computes(own, f, depth))
    }

    /// Whether two formulas are the same but for calls of functions that are.
    fn computes(&mut self, one: NodeId, other: NodeId, depth: u32) -> bool {
        if one == other || depth >= DEEPEST {
            return one == other;
        }
        if let Some(known) = self.compared.get(&(one, other)) {
            return *known;
        }
        let graph = self.graph;
        let mut all = |a: &[NodeId], b: &[NodeId]| a.len() == b.len() && a.iter().zip(b).all(|(a, b)| self.computes(*a, *b, depth + 1));
        let alike = match (graph.node(one), graph.node(other)) {
            (Node::Op(op, a), Node::Op(other, b)) => op == other && all(a, b),
            (Node::Claim(a, _), Node::Claim(b, _)) => all(a.get(..1).unwrap_or(&[]), b.get(..1).unwrap_or(&[])),
            (Node::Call(s, f, a), Node::Call(t, g, b)) => {
                let slope = |f: &Function| matches!(f, Function::Gradient(_));
                let groups = (Group::of(*f).0, Group::of(*g).0);
                let called = s == t && (f == g || !slope(f) && !slope(g)) && all(a, b);
                called && (f == g || self.same(*s, groups.0, depth + 1) == self.same(*s, groups.1, depth + 1))
            }
            _ => false,
        };
        self.compared.insert((one, other), alike);
        alike
    }

    fn passes_on(&self, node: NodeId, shape: ShapeId, function: Function) -> bool {
        let Node::Call(to, what, args) = self.graph.node(node) else { return false };
        let Some(known) = self.graph.shape(shape) else { return false };
        *to == shape
            && *what == function
            && args.iter().enumerate().all(|(i, &a)| match self.graph.node(a) {
                Node::Leaf(Leaf::P(c)) => usize::from(*c) == i,
                Node::Leaf(Leaf::Variable(v)) => {
                    i >= 3 && known.variables.get(i - 3) == Some(v)
                }
                Node::Constant(0) => i == 2 && known.dimensions == 2,
                _ => false,
            })
    }

    /// The steps of some formulas over a space with these variables. A call's target is found, its plan made later.
    pub fn plan(&mut self, roots: &[NodeId], variables: Arc<[u32]>) -> Plan {
        self.plan_of(None, roots, variables)
    }

    /// The same of functions of a shape.
    fn plan_of(&mut self, shape: Option<ShapeId>, roots: &[NodeId], variables: Arc<[u32]>) -> Plan {
        let graph = self.graph;
        let mut nodes = std::mem::take(&mut self.nodes);
        let outlines = &self.functions.outlines;
        let outline = |id: NodeId| if outlines.is_empty() { None } else { outlines.get(&id).and_then(|all| outline_beside(all, shape)) };
        let operands = |id: NodeId| outline(id).map_or_else(|| graph.operands(id), |outline| &outline.operands[..]);
        graph.computed_from(roots, operands, &mut nodes);
        let mut places = std::mem::take(&mut self.places);
        let mut plan = Plan { variables, ..Plan::default() };
        // Three components of a gradient take four steps.
        plan.steps.reserve(nodes.len() + nodes.len() / 3);
        plan.arguments.reserve(2 * nodes.len());
        // Calls of a gradient at the same arguments are one step.
        let mut gradients: FxHashMap<(TargetId, &[NodeId]), u32> = FxHashMap::default();
        for &id in &nodes {
            let args = operands(id);
            let place = |a: &NodeId| places.get(a.0 as usize).copied().unwrap_or(0);
            let named = graph.node_name(id).map(|_| id);
            let step = match graph.node(id) {
                _ if let Some(outline) = outline(id) => {
                    let target = self.target(outline.shape, Group::Field);
                    let call = plan.push(Action::Call(target), outline.arguments().iter().map(place), named);
                    let fold = |value, other| outline.by.map_or(value, |by| plan.push(Action::Op(by), [value, place(other)], named));
                    outline.beside().iter().fold(call, fold)
                }
                Node::Claim(..) => {
                    let at = args.first().map_or(0, place);
                    // The claim's own name goes to what it speaks of.
                    if let Some(step) = plan.steps.get_mut(at as usize) {
                        step.named = step.named.or(named);
                    }
                    at
                }
                Node::Constant(bits) => plan.push(Action::Constant(f64::from_bits(*bits)), [], named),
                Node::Leaf(Leaf::Variable(number)) => {
                    let position = plan.variables.binary_search(number).ok().map(|i| i as u32);
                    plan.push(Action::Variable { number: *number, position }, [], named)
                }
                Node::Leaf(leaf) => plan.push(Action::Leaf(*leaf), [], named),
                Node::Factor(i) => plan.push(Action::Factor(*i), [], named),
                Node::Op(op, _) => plan.push(Action::Op(*op), args.iter().map(place), named),
                Node::Call(inner, function, list) => {
                    let (group, component) = Group::of(*function);
                    let target = self.target(*inner, group);
                    match component {
                        None => plan.push(Action::Call(target), args.iter().map(place), named),
                        Some(i) => {
                            let call = *gradients.entry((target, &list[..])).or_insert_with(|| {
                                plan.push(Action::Call(target), args.iter().map(place), None)
                            });
                            plan.push(Action::Component(i), [call], named)
                        }
                    }
                }
            };
            if let Some(place) = places.get_mut(id.0 as usize) {
                *place = step;
            }
        }
        plan.vectors = named_vectors(plan.steps.iter().map(|step| graph.node_name(step.named?)));
        plan.results = roots
            .iter()
            .map(|r| places.get(r.0 as usize).copied().unwrap_or(0))
            .collect();
        self.places = places;
        self.nodes = nodes;
        plan
    }
}
