//! Lipschitz factors for where the parameters stand: no larger than those for their whole ranges, and proven in the same way.

use crate::analysis::search::Search;
use crate::compiled::Compiled;
use crate::live::{Followed, Live};
use crate::graph::Proof;
use std::rc::Rc;

/// A factor above this is worth a longer look.
const STEEP: f64 = 4.0;
/// So many boxes each of these may cost, and so many of them are looked at.
const SETTLED: usize = 2_048;
const MOST_SETTLED: usize = 16;

impl Compiled {
    /// Boxes for [`Compiled::follow`] that take no longer than a frame.
    pub const QUICK: usize = 64;

    /// Finds the factors for the values at hand, where they depend on parameters, with at most so many boxes each. They are no larger than
    /// those for the whole ranges, and proven in the same way. Answers whether there was anything to find.
    pub fn follow(&self, live: &mut Live, boxes: usize) -> bool {
        let known = live.followed.as_ref().is_some_and(|f| f.components == live.components);
        let any = self.functions.searches.iter().flatten().any(Search::is_live);
        if known || !any {
            return false;
        }
        let pinned = self.pinned(live);
        let factors = self
            .graph
            .factors
            .iter()
            .zip(&self.functions.searches)
            .map(|(factor, search)| match search {
                Some(search) if search.is_live() => {
                    search.run(&self.graph, pinned.clone(), boxes).min(factor.lipschitz)
                }
                _ => factor.lipschitz,
            })
            .collect();
        live.followed = Some(Followed { components: live.components.clone(), factors, settled: false });
        true
    }

    /// Finds the factors for the values at hand as [`Compiled::follow`] does, and looks longer for those that still are steep: well under a second.
    pub fn settle(&self, live: &mut Live) {
        self.follow(live, Self::QUICK);
        let pinned = self.pinned(live);
        let Some(followed) = live.followed.as_mut().filter(|f| !f.settled) else { return };
        followed.settled = true;
        let mut steep: Vec<(usize, &Search, f64)> = Vec::new();
        for (i, (search, &factor)) in self.functions.searches.iter().zip(&followed.factors).enumerate() {
            if let Some(search) = search.as_ref().filter(|s| factor > STEEP && s.is_live()) {
                steep.push((i, search, factor));
            }
        }
        steep.sort_by(|a, b| b.2.total_cmp(&a.2));
        for (i, search, factor) in steep.into_iter().take(MOST_SETTLED) {
            let found = search.run(&self.graph, pinned.clone(), SETTLED);
            followed.factors.get_mut(i).into_iter().for_each(|slot| *slot = found.min(factor));
        }
    }

    /// The values of parameters as 32 bits hold them: that is what the shader reads.
    fn pinned(&self, live: &Live) -> Rc<[f64]> {
        (0..self.graph.parameters.len() as u32).map(|i| f64::from(live.component(&self.graph, i) as f32)).collect()
    }

    /// Whether more can be found for the values at hand than [`Compiled::follow`] finds.
    pub fn can_settle(&self, live: &Live) -> bool {
        let Some(followed) = live.followed.as_ref().filter(|f| !f.settled && f.components == live.components) else { return false };
        let any = |(search, &factor): (&Option<Search>, &f64)| factor > STEEP && search.as_ref().is_some_and(Search::is_live);
        self.functions.searches.iter().zip(&followed.factors).any(any)
    }

    /// Whether a factor is another one where the parameters stand elsewhere.
    pub fn is_live(&self, factor: usize) -> bool {
        self.functions.searches.get(factor).is_some_and(|search| search.as_ref().is_some_and(Search::is_live))
    }

    /// Whether a longer search can make a factor for the whole ranges smaller.
    pub fn can_tighten(&self, factor: usize) -> bool {
        let searched = self.graph.factors.get(factor).is_some_and(|f| matches!(f.proof, Proof::Derived | Proof::Claimed));
        searched && self.functions.searches.get(factor).is_some_and(Option::is_some)
    }

    /// A factor for the whole ranges of the parameters, looked for with at most so many boxes: a number for [`Live::tightened`]. It is never
    /// above the one that the compiler found at once.
    pub fn tighten(&self, factor: usize, boxes: usize) -> f64 {
        let first = self.graph.factors.get(factor).map_or(1.0, |f| f.lipschitz);
        match self.functions.searches.get(factor) {
            Some(Some(search)) if self.can_tighten(factor) => search.run(&self.graph, Rc::new([]), boxes).min(first),
            _ => first,
        }
    }

    /// How steep what a factor was found from is at the steepest place found, from so many samples uphill: no constant is smaller.
    pub fn sampled_factor(&self, factor: usize, samples: usize) -> f64 {
        let search = self.functions.searches.get(factor).and_then(Option::as_ref);
        search.map_or(1.0, |s| s.sample(&self.graph, samples))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::indexing_slicing)]
mod tests {
    use crate::{Compiled, MemoryLoader, Options, compile};

    #[test]
    fn what_is_steep_where_the_sliders_stand_is_looked_at_longer() {
        let text = "param curl = 2.8 in 0..3\nscene = capsule((0, 0, 0), (0, 1.6, 0), 0.14).taper(y, 0, 1.6, 0.2).bend(z, y, curl)\n";
        let scene = compile(&MemoryLoader::new().with("a.sdf", text), "a.sdf", &Options::default()).compiled.unwrap();
        let largest = |live: &crate::Live| (0..scene.graph.factors.len() as u32).map(|i| live.factor(&scene.graph, i)).fold(0.0, f64::max);
        let mut quick = scene.live();
        // So few boxes that all of them are steep.
        assert!(scene.follow(&mut quick, 1) && scene.can_settle(&quick));
        let mut settled = quick.clone();
        scene.settle(&mut settled);
        assert!(!scene.can_settle(&settled) && settled.followed != quick.followed);
        assert!(largest(&settled) <= largest(&quick), "{} {}", largest(&settled), largest(&quick));
        // What was found for other values is not taken.
        let mut elsewhere = scene.live();
        elsewhere.components[0] = 2.0;
        elsewhere.take(settled.followed.unwrap());
        assert_eq!(elsewhere.followed, None);
        assert!(!scene.follow(&mut quick, Compiled::QUICK), "known already");
    }
}
