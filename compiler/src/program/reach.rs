//! Ranges of sliders that reach what cannot be: a radius below zero, a scale of zero.

use super::Elaborator;
use super::bind::Requirement;
use super::blocks::short;
use crate::live::Live;
use crate::diagnostic::{Code, Diagnostic};
use crate::graph::{Leaf, Node, NodeId};
use crate::source::Span;
use crate::syntax::ast::ItemKind;

impl Elaborator<'_> {
    /// Warns where a slider at an end of its range, and all others at their defaults, makes a number that is ruled out.
    pub(super) fn warn_of_reach(&mut self, name: &str, requirement: &Requirement, nodes: &[NodeId], at: Span) {
        // A long formula is not looked at: a slider seldom goes through one.
        let Some(found) = self.graph.reachable_few(nodes) else { return };
        let reads_parameters_alone = found.iter().all(|id| match self.graph.node(*id) {
            Node::Leaf(leaf) => matches!(leaf, Leaf::Parameter(_) | Leaf::Time),
            Node::Call(..) => false,
            _ => true,
        });
        if !reads_parameters_alone {
            return;
        }
        let start = Live::start(&self.graph);
        for id in found {
            let Node::Leaf(Leaf::Parameter(component)) = *self.graph.node(id) else { continue };
            let Some(known) = self.graph.parameters.get(component as usize) else { continue };
            let ends = [known.min, known.max];
            let Some((parameter, span)) = self.written_range(component) else { continue };
            if self.is_known(Code::RangeReach, span) {
                continue;
            }
            for end in ends {
                let mut live = start.clone();
                live.components.iter_mut().skip(component as usize).take(1).for_each(|c| *c = end);
                let Some(bad) = live.values(&self.graph, nodes).into_iter().find(|c| !requirement.holds(*c)) else { continue };
                let (of, words) = (&requirement.parameter, requirement.words());
                let warning = Diagnostic::new(
                    Code::RangeReach,
                    span,
                    format!("the range of `{parameter}` reaches {}, where the `{of}` of `{name}` is {}", short(end), short(bad)),
                    format!("let the range end where the `{of}` is {words}; beyond that it is kept there"),
                );
                self.report(warning.label(at, format!("the `{of}` of `{name}`")));
                break;
            }
        }
    }

    /// The name of the parameter that has a component, and where its range is written, if it is.
    fn written_range(&self, component: u32) -> Option<(String, Span)> {
        let parameter = self.parameters.iter().find(|p| p.components().contains(&component))?;
        let modules = self.modules;
        modules.with_parameters().into_iter().flat_map(|module| modules.items(module)).find_map(|(_, item)| match &item.kind {
            ItemKind::Param { name, domain: Some(range), .. } if name.span == parameter.span => Some((parameter.name.clone(), range.span)),
            _ => None,
        })
    }
}
