//! The uniform block: which values of the scene are live, their names and where they stand.

use crate::emit::code::{Outside, Read};
use crate::emit::error::EmitError;
use crate::emit::formulas::{Formulas, call_name};
use crate::emit::names::{Scope, component_name, identifier, split_axis};
use crate::graph::Graph;
use crate::graph::interval::Interval;
use crate::graph::kernel::KERNEL;
use crate::interface::{Parameter, Uniform, UniformSource, ViewField};
use rustc_hash::FxHashMap;

/// A value that a module may read.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// Name in the struct.
    pub name: String,
    /// Where it comes from.
    pub source: UniformSource,
    /// Number of floats, 1 to 4.
    pub components: u8,
    /// All values of each component.
    pub ranges: Vec<Interval>,
    /// Whether a shader reads it.
    pub read: bool,
    /// Whether what the host computes is computed from it.
    pub computes: bool,
    /// Index of the parameter that it is.
    pub parameter: Option<usize>,
}

/// All values that a module may read.
#[derive(Clone, Debug)]
pub struct Candidates {
    /// In the order of the struct: origin, time, the view, parameters, occlusion, factors, what is computed.
    pub all: Vec<Candidate>,
    /// Candidate and component of each component of a parameter in the graph.
    components: Vec<Option<(u32, u8)>>,
    /// Candidate of the first factor.
    factors: u32,
    /// The candidate of each field of [`Formulas`] that is read.
    computed: FxHashMap<u32, u32>,
    names: Scope,
}

const TIME: u32 = 1;

impl Candidates {
    /// Names every live value. The names do not depend on what is read. `view`: what of the view a module is told that draws.
    pub fn new(graph: &Graph, parameters: &[Parameter], view: &[ViewField]) -> Self {
        let mut scope = Scope::default();
        // By these names the library reads what is ours, so nothing else has them.
        let [origin, time, reach, strength] = ["origin", "time", "occlusion_reach", "occlusion_strength"].map(|name| scope.give(name));
        let view_names: Vec<String> = view.iter().map(|field| scope.give(field.name())).collect();
        // A host calls functions by these.
        if !parameters.is_empty() {
            KERNEL.iter().for_each(|row| scope.reserve(call_name(row.op)));
        }
        let mut all = Vec::with_capacity(parameters.len() + graph.factors.len() + 4);
        let mut add = |name, source, components, ranges, parameter| {
            all.push(Candidate { name, source, components, ranges, read: false, computes: false, parameter });
            all.len() as u32 - 1
        };
        add(origin, UniformSource::Origin, 3, vec![Interval::ALL; 3], None);
        add(time, UniformSource::Time, 1, vec![Interval::ALL], None);
        for (&field, name) in view.iter().zip(view_names) {
            let count = field.components();
            add(name, UniformSource::View(field), count, vec![Interval::ALL; count.into()], None);
        }
        let mut components = vec![None; graph.parameters.len()];
        for (index, parameter) in parameters.iter().enumerate() {
            let Some(first) = parameter.first else { continue };
            let count = parameter.default.len().clamp(1, 4);
            let range = |i: usize| match (parameter.min.get(i), parameter.max.get(i)) {
                (Some(&lo), Some(&hi)) => Interval::new(lo, hi),
                _ => Interval::ALL,
            };
            let ranges = (0..count).map(range).collect();
            let source = UniformSource::Parameter(first);
            let name = scope.give(&identifier(&parameter.name));
            let candidate = add(name, source, count as u8, ranges, Some(index));
            for i in 0..count {
                if let Some(slot) = components.get_mut(first as usize + i) {
                    *slot = Some((candidate, i as u8));
                }
            }
        }
        let positive = Interval::new(0.0, f64::INFINITY);
        add(reach, UniformSource::OcclusionReach, 1, vec![positive], None);
        add(strength, UniformSource::OcclusionStrength, 1, vec![positive], None);
        let mut factors = 0;
        for (i, factor) in graph.factors.iter().enumerate() {
            let source = UniformSource::Factor(i as u32);
            let name = factor.name.strip_prefix("step_").unwrap_or(&factor.name);
            let name = scope.give(&identifier(&format!("step_{name}")));
            let candidate = add(name, source, 1, vec![positive], None);
            if i == 0 {
                factors = candidate;
            }
        }
        Self { all, components, factors, computed: FxHashMap::default(), names: scope }
    }

    /// The candidate of what the host computes. Its name is that of the source, or of what it is computed from.
    pub fn computed(&mut self, formulas: &Formulas, field: u32, name: Option<&str>) -> u32 {
        if let Some(&known) = self.computed.get(&field) {
            return known;
        }
        let (time, parameters) = formulas.reads(field);
        let mut from: Vec<u32> = if time { vec![TIME] } else { Vec::new() };
        from.extend(parameters.iter().filter_map(|&i| self.components.get(i as usize).copied().flatten()).map(|c| c.0));
        for &index in &from {
            if let Some(candidate) = self.all.get_mut(index as usize) {
                candidate.computes = true;
            }
        }
        let components = formulas.components(field);
        // A vector is named after its first component.
        let name = match name.map(|n| (n, split_axis(n))) {
            Some((_, Some((vector, _)))) if components > 1 => identifier(vector),
            Some((name, _)) => identifier(name),
            None => {
                let first = from.first().and_then(|&i| self.all.get(i as usize));
                format!("of_{}", first.map_or("nothing", |c| &c.name))
            }
        };
        let name = self.names.give(&name);
        let ranges = (0..components).map(|i| formulas.range(field, i)).collect();
        let source = UniformSource::Formula(field);
        self.all.push(Candidate { name, source, components, ranges, read: false, computes: false, parameter: None });
        let index = self.all.len() as u32 - 1;
        self.computed.insert(field, index);
        index
    }

    /// What a component of a parameter is called: its name, or that of a vector and a component.
    pub fn component_name(&self, parameter: u32) -> String {
        let Some((index, i)) = self.components.get(parameter as usize).copied().flatten() else { return String::new() };
        let Some(candidate) = self.get(index) else { return String::new() };
        match (candidate.components, i) {
            (1, _) => candidate.name.clone(),
            (_, i) => format!("{}{}", candidate.name, component_name(i)),
        }
    }

    /// A candidate.
    pub fn get(&self, index: u32) -> Option<&Candidate> {
        self.all.get(index as usize)
    }

    /// Marks what comes from `source` as read.
    pub fn read(&mut self, source: UniformSource) {
        for candidate in self.all.iter_mut().filter(|c| c.source == source) {
            candidate.read = true;
        }
    }

    /// Marks a candidate as read.
    pub fn mark(&mut self, index: u32) {
        if let Some(candidate) = self.all.get_mut(index as usize) {
            candidate.read = true;
        }
    }

    /// The fields that are read, and the size of the block.
    pub fn layout(&self) -> (Vec<Uniform>, u32) {
        let mut end = 0;
        let mut fields = Vec::new();
        for candidate in self.all.iter().filter(|c| c.read) {
            let components = u32::from(candidate.components);
            // WGSL § 14.4.1: a vec2 starts at a multiple of 8 bytes, a vec3 or vec4 of 16; what follows a vec3 may fill its rest.
            let align = match components {
                1 => 4,
                2 => 8,
                _ => 16,
            };
            let offset = u32::next_multiple_of(end, align);
            end = offset + 4 * components;
            let (name, source) = (candidate.name.clone(), candidate.source);
            fields.push(Uniform { name, source, components, offset });
        }
        (fields, end.next_multiple_of(16))
    }
}

impl Outside for Candidates {
    fn uniform(&self, read: Read) -> Result<(u32, u8, u8), EmitError> {
        let (index, i) = match read {
            Read::Time => (TIME, 0),
            Read::Parameter(component) => {
                let known = self.components.get(component as usize).copied().flatten();
                known.ok_or(EmitError::NoParameter(component))?
            }
            Read::Factor(i) => (self.factors + i, 0),
        };
        let candidate = self.all.get(index as usize).ok_or(EmitError::NoParameter(index))?;
        Ok((index, candidate.components, i))
    }

    fn range(&self, field: u32, component: u8) -> Interval {
        self.get(field).and_then(|f| f.ranges.get(usize::from(component))).copied().unwrap_or(Interval::ALL)
    }
}
