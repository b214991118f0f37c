//! What a rule gains: a scene is compiled with it and without it, and what each costs is compared.

use crate::compiled::Outcome;
use crate::diagnostic::Code;
use crate::graph::Proof;
use crate::random::Random;
use crate::reference::Reference;
use crate::reference::march::Ray;
use crate::vector::{Vec3, add, length, scale, sub};

/// Rays that are followed, each from outside towards a point of the solid's box.
const RAYS: usize = 256;
/// Width of a pixel at distance one.
const FOOTPRINT: f64 = 1e-3;
/// Boxes of the longer search for a factor.
const BOXES: usize = 2_048;
/// Half the side of the cube that counts where nothing is known of the solid.
const UNKNOWN: f64 = 4.0;
/// A number that grows by less is the same.
const SAME: f64 = 1.005;

/// What a scene costs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Price {
    /// The largest Lipschitz factor; infinite where the scene is refused.
    pub factor: f64,
    /// The same after a longer search.
    pub tightened: f64,
    /// Factors that are measured and not proven.
    pub measured: usize,
    /// Warnings of formulas that jump.
    pub jumps: usize,
    /// The largest side of the solid's box; infinite where none is known.
    pub size: f64,
    /// How often a ray looks at the bound, on average.
    pub looks: f64,
    /// Operations of one look at the bound.
    pub operations: usize,
}

impl Price {
    /// What a compiled scene costs. Rays go through `about`, a box with its least and greatest corner.
    pub fn of(outcome: &Outcome, about: [Vec3; 2]) -> Self {
        let jumps = outcome.diagnostics.iter().filter(|d| d.code == Code::Jump).count();
        let Some(compiled) = &outcome.compiled else {
            return Self { factor: f64::INFINITY, tightened: f64::INFINITY, measured: 0, jumps, size: f64::INFINITY, looks: f64::INFINITY, operations: 0 };
        };
        let factors = &compiled.graph.factors;
        let tightened = (0..factors.len()).map(|i| compiled.tighten(i, BOXES)).fold(1.0, f64::max);
        let sides = compiled.solid_box().map(|solid| sub(solid.high, solid.low));
        Self {
            factor: compiled.summary.factor,
            tightened,
            measured: factors.iter().filter(|f| f.proof == Proof::Measured).count(),
            jumps,
            size: sides.map_or(f64::INFINITY, |sides| sides.into_iter().fold(0.0, f64::max)),
            looks: looks(outcome, about).unwrap_or(f64::INFINITY),
            operations: compiled.module.operations.1,
        }
    }

    /// In what this is worse than another price, in words: from the better one to this one.
    pub fn worse_than(&self, better: &Self) -> Vec<String> {
        let mut worse = Vec::new();
        let grows = |from: f64, to: f64| to > SAME * from;
        if grows(better.factor, self.factor) {
            worse.push(match self.factor.is_finite() {
                true => format!("factor ×{:.2} → ×{:.2}", better.factor, self.factor),
                false => "refused".to_owned(),
            });
        }
        if grows(better.tightened, self.tightened) && !grows(better.factor, self.factor) {
            worse.push(format!("factor after a longer search ×{:.2} → ×{:.2}", better.tightened, self.tightened));
        }
        if self.measured > better.measured {
            worse.push("proven → measured".to_owned());
        }
        if self.jumps > better.jumps {
            worse.push("rays stop at a jump".to_owned());
        }
        if grows(better.size, self.size) {
            worse.push(match self.size.is_finite() {
                true => format!("box {:.2} → {:.2}", better.size, self.size),
                false => format!("box {:.2} → none", better.size),
            });
        }
        if grows(better.looks, self.looks) && self.looks.is_finite() {
            worse.push(format!("looks {:.1} → {:.1}", better.looks, self.looks));
        }
        if grows(better.operations as f64, self.operations as f64) && worse.is_empty() {
            worse.push(format!("operations {} → {}", better.operations, self.operations));
        }
        worse
    }
}

/// The box of a scene's solid, through which rays go; a cube where none is known.
pub fn about(outcome: &Outcome) -> [Vec3; 2] {
    let solid = outcome.compiled.as_ref().and_then(|compiled| compiled.solid_box());
    solid.map_or([[-UNKNOWN; 3], [UNKNOWN; 3]], |solid| [solid.low, solid.high])
}

/// How often a ray through a box looks at the bound, on average. None where the scene is too large to follow on the processor.
fn looks(outcome: &Outcome, [low, high]: [Vec3; 2]) -> Option<f64> {
    let compiled = outcome.compiled.as_ref()?;
    let reference = Reference::new(compiled, &compiled.live()).ok()?;
    let mut random = Random(1);
    let size = length(sub(high, low)).max(1e-3);
    let middle = scale(add(low, high), 0.5);
    let rays: Vec<Ray> = (0..RAYS)
        .map(|_| {
            let mut next = |from: f64, to: f64| from + (to - from) * random.next();
            let (up, turn) = (next(-1.0, 1.0), next(0.0, std::f64::consts::TAU));
            let out = (1.0 - up * up).sqrt();
            let origin = add(middle, scale([out * turn.cos(), up, out * turn.sin()], size));
            let ([x, y, z], [right, top, front]) = (low, high);
            let way = sub([next(x, right), next(y, top), next(z, front)], origin);
            Ray { origin, direction: scale(way, 1.0 / length(way).max(1e-9)), t_min: 0.0, t_max: 4.0 * size }
        })
        .collect();
    let hits = reference.trace(&rays, FOOTPRINT, length(middle) + 8.0 * size);
    Some(hits.iter().map(|hit| f64::from(hit.steps)).sum::<f64>() / RAYS as f64)
}
