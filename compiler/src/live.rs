//! Values of what is live.

use crate::graph::algebra::Reals;
use crate::graph::{Graph, Leaf, NodeId};
use crate::section::Section;

/// Values of what is live: time and the parameters' components.
#[derive(Clone, Debug, PartialEq)]
pub struct Live {
    /// Seconds.
    pub time: f64,
    /// A value for each of [`Graph::parameters`].
    pub components: Vec<f64>,
    /// Factors found for values of the parameters; they count only while the parameters still have these values.
    pub followed: Option<Followed>,
    /// Factors for the whole ranges that a longer search found, one for each of [`Graph::factors`]; or none.
    pub tightened: Vec<f64>,
    /// Where along its axis the plane of a slice is: of [`View::Slice`](crate::reference::View::Slice) alone.
    pub slice: f64,
    /// The plane that cuts the picture open, where one does.
    pub section: Option<Section>,
}

impl Live {
    /// Time zero and every parameter of a graph at its default.
    pub fn start(graph: &Graph) -> Self {
        Self { time: 0.0, components: graph.parameters.iter().map(|p| p.default).collect(), followed: None, tightened: Vec::new(), slice: 0.0, section: None }
    }

    /// Values of nodes that read nothing but parameters and time.
    pub fn values(&self, graph: &Graph, nodes: &[NodeId]) -> Vec<f64> {
        graph.evaluate(
            &mut Reals,
            nodes,
            |_, leaf| match leaf {
                Leaf::Time => self.time,
                Leaf::Parameter(i) => self.component(graph, i),
                _ => 0.0,
            },
            |_, _, _, _| 0.0,
        )
    }

    /// A component of a parameter, clamped to its range; its default where there is none.
    pub fn component(&self, graph: &Graph, index: u32) -> f64 {
        let Some(known) = graph.parameters.get(index as usize) else { return 0.0 };
        let value = self.components.get(index as usize).copied().unwrap_or(known.default);
        if value.is_finite() { value.clamp(known.min, known.max) } else { known.default }
    }
}

/// Lipschitz factors for some values of the parameters, found by [`Compiled::follow`].
#[derive(Clone, Debug, PartialEq)]
pub struct Followed {
    pub(crate) components: Vec<f64>,
    pub(crate) factors: Vec<f64>,
    /// Whether a longer look was taken at those that are steep.
    pub(crate) settled: bool,
}

impl Live {
    /// Takes factors that were found for the values at hand; those for others are left.
    pub fn take(&mut self, followed: Followed) {
        if followed.components == self.components {
            self.followed = Some(followed);
        }
    }

    /// A factor for the values at hand where it was found, else for the whole ranges.
    pub fn factor(&self, graph: &Graph, index: u32) -> f64 {
        let index = index as usize;
        let first = graph.factors.get(index).map_or(1.0, |f| f.lipschitz);
        let whole = self.tightened.get(index).map_or(first, |f| f.min(first));
        match &self.followed {
            Some(followed) if followed.components == self.components => {
                followed.factors.get(index).map_or(whole, |f| f.min(whole))
            }
            _ => whole,
        }
    }
}
