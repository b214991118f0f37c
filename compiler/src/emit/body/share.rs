//! What is computed anyway stands for what it holds: a gradient's call for the field, a vector for the numbers that it was made of.

use crate::emit::body::{Body, Sharing};
use crate::emit::code::ExprId;
use crate::emit::plan::Plans;
use crate::graph::Graph;

impl Body {
    /// Lets what is computed anyway stand for what it holds, wherever that is an argument. Nothing may be added after it. The
    /// answer: what stands for the root.
    pub fn share(&mut self, graph: &Graph, plans: &Plans, root: ExprId) -> ExprId {
        if self.fields.is_empty() && self.parts.is_empty() {
            return root;
        }
        let count = self.exprs.len();
        let Sharing { mut shared, mut live, mut wanted, mut stack } = std::mem::take(&mut self.sharing);
        shared.clear();
        shared.extend(0..count as ExprId);
        live.clear();
        live.resize(count, false);
        live.get_mut(root as usize).into_iter().for_each(|slot| *slot = true);
        // Arguments have smaller indices.
        for id in (0..=root).rev() {
            if is_live(&live, id) {
                for &arg in self.arguments(id) {
                    live.get_mut(arg as usize).into_iter().for_each(|slot| *slot = true);
                }
            }
        }
        wanted.clear();
        wanted.resize(count, 0);
        // A field is the fourth component of a gradient's call at the same place.
        let (fields, arguments) = (std::mem::take(&mut self.fields), std::mem::take(&mut self.field_arguments));
        for (field, gradient, range) in &fields {
            let args = arguments.get(range.clone()).unwrap_or(&[]);
            // Only what was computed from the arguments may be read from their call: else it would wait for itself.
            if args.iter().any(|a| a >= field) || !is_live(&live, *field) {
                continue;
            }
            let call = self.call(graph, plans, *gradient, args);
            if is_live(&live, call) {
                let component = self.component(call, 3);
                if let Some(slot) = shared.get_mut(*field as usize) {
                    *slot = component;
                }
            }
        }
        // A number is a component of the vector that was made of it: where that is there anyway, or serves for two numbers.
        // Mostly a vector's parts are newer than those of the vectors inside it; what comes too early is computed once more.
        let mut parts = std::mem::take(&mut self.parts);
        parts.retain(|&id| (id as usize) < count);
        parts.sort_unstable();
        let own = |shared: &[ExprId], id: ExprId| shared.get(id as usize) == Some(&id);
        for &id in &parts {
            if let Some(part) = self.part(id).filter(|p| p.plain)
                && is_live(&live, id)
                && own(&shared, id)
                && let Some(n) = wanted.get_mut(part.vector as usize)
            {
                *n = n.saturating_add(1);
            }
        }
        for &id in parts.iter().rev() {
            let Some(part) = self.part(id) else { continue };
            if !is_live(&live, id) || !own(&shared, id) {
                continue;
            }
            if is_live(&live, part.vector) || wanted.get(part.vector as usize).is_some_and(|n| *n > 1) {
                self.mark(part.vector, &mut live, &mut stack);
                let component = self.component(part.vector, part.index);
                if let Some(slot) = shared.get_mut(id as usize) {
                    *slot = component;
                }
            }
        }
        // Components that were made here stand for themselves.
        let of = |id: ExprId| shared.get(id as usize).copied().unwrap_or(id);
        self.pool.iter_mut().for_each(|arg| *arg = of(*arg));
        let root = of(root);
        (self.fields, self.field_arguments, self.parts) = (fields, arguments, parts);
        self.sharing = Sharing { shared, live, wanted, stack };
        root
    }

    fn mark(&self, root: ExprId, live: &mut [bool], stack: &mut Vec<ExprId>) {
        stack.push(root);
        while let Some(id) = stack.pop() {
            if let Some(live) = live.get_mut(id as usize).filter(|l| !**l) {
                *live = true;
                self.arguments(id).iter().for_each(|&arg| stack.push(arg));
            }
        }
    }
}

fn is_live(live: &[bool], id: ExprId) -> bool {
    live.get(id as usize) == Some(&true)
}
