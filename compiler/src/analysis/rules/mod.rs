//! Rules that look at a formula more closely than step by step: a file a rule or a family. Their table is [`crate::rules`].

pub mod algebraic_enclosures;
pub mod angle_periodicity;
pub mod blend_sublevel_set;
pub mod claims;
pub mod continuous_select;
pub mod isometry;
pub mod isometry_chain;
pub mod jacobian_norm;
pub mod multilinear;
pub mod noise_cells;
pub mod normalized_vector;
pub mod period;
pub mod polar;
pub mod polar_rotation;
pub mod polytope;
pub mod radial;
pub mod rotated_distance;
pub mod soft;
pub mod sum_terms;

/// What a scene comes to with all rules, and without one.
#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::panic)]
mod tried {
    use crate::analysis::analysis_cache::Memory;
    use crate::analysis::{Box3, Facts};
    use crate::compiled::Compiled;
    use crate::rules::{Rule, RuleSet};
    use crate::{MemoryLoader, Options, compile};

    fn each<T>(rule: Rule, scene: &str, what: impl Fn(&Compiled, RuleSet) -> T) -> [T; 2] {
        [RuleSet::default(), RuleSet::default().without(rule)].map(|rules| {
            let outcome = compile(&MemoryLoader::new().with("main.sdf", scene), "main.sdf", &Options { rules, ..Options::default() });
            let compiled = outcome.compiled.unwrap_or_else(|| panic!("{scene}: {:?}", outcome.diagnostics));
            what(&compiled, rules)
        })
    }

    /// The largest factors, each no less than what the field attains.
    pub fn factors(rule: Rule, scene: &str) -> [f64; 2] {
        each(rule, scene, |compiled, _| {
            let factors = compiled.graph.factors.iter().map(|factor| factor.lipschitz);
            for (i, factor) in factors.clone().enumerate() {
                assert!(compiled.sampled_factor(i, 2_000) <= factor, "{scene}: ×{factor} is less than what is attained");
            }
            factors.fold(1.0, f64::max)
        })
    }

    /// The widest sides of the boxes that are found at once about the solid.
    pub fn sides(rule: Rule, scene: &str) -> [f64; 2] {
        each(rule, scene, |compiled, rules| {
            let facts = &mut Facts::with(Memory::default(), rules);
            facts.body_region(&mut compiled.graph.clone(), compiled.root, &|_| None, Box3::cube(1e6)).size()
        })
    }
}
