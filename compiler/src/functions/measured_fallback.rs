//! Factors that are proven and of no use: so many times as large as at the steepest place that rays would spend all of their steps before they get
//! anywhere, as those of noise at places that noise moves.

use crate::analysis::Domain;
use crate::analysis::search::{Search, Target};
use crate::diagnostic::{Code, Diagnostic};
use crate::evaluate::{LANES, Lanes, Tape};
use crate::functions::bound_strategy::{BoundStrategy, Over};
use crate::functions::builder::Builder;
use crate::functions::domains::LONGER;
use crate::functions::limits::BUDGET;
use crate::functions::made::Kind;
use crate::functions::trial::{Places, halved, number, places, values, weight};
use crate::graph::{NodeId, Proof, ShapeId};
use crate::random::Random;
use crate::vector::{Vec3, add, length, scale};
use std::array::from_fn;

/// A proven constant above this may be such a one.
pub(super) const DEAR: f64 = 50.0;
/// Above this a map's is one.
const HOPELESS: f64 = 250.0;
/// It costs too much where it is so many times what it is drawn with, which is so much more than at the steepest place found.
const TIMES_STEEPEST: f64 = 8.0;
const MARGIN: f64 = 1.25;
/// That is looked for so often in each lane, anywhere and at the surface, and uphill from the steepest place of each set of values in so many rounds, each
/// of which looks at most so many times as near as the one before.
const TURNS: usize = 128;
/// No more than so many additions are spent on that, and what would be looked at less often than so in each lane is not.
const MOST: usize = 300_000_000;
const FEWEST: usize = 32;
const ROUNDS: usize = 32;
const NEARER: f64 = 0.75;
/// The first of them looks as far as this part of the domain's size.
const FIRST: f64 = 0.05;
/// So often a way from inside to outside is halved to find the surface.
const HALVINGS: usize = 24;
/// Slopes are differences over this part of the domain's size.
const DIFFERENCE: f64 = 1e-7;

impl Builder<'_> {
    /// A measured constant in place of one that is proven, where no ray would get anywhere by that.
    pub(super) fn affordable(&mut self, shape: ShapeId, node: NodeId, domain: &Domain, strategy: BoundStrategy) -> BoundStrategy {
        if self.scene.strict || strategy.proof == Proof::Measured || strategy.constant <= DEAR {
            return strategy;
        }
        let at = strategy.holds_in(domain);
        // What is known beside the constant counts where it is gentler.
        let near_surface = self.uneven(node, &at, strategy.constant).filter(|uneven| !uneven.is_unknown());
        let near_surface = near_surface.map(|uneven| self.usual_divisor(node, &at, strategy.constant, &uneven));
        let proven = strategy.constant.min(near_surface.unwrap_or(f64::INFINITY));
        // What is gentle at its surface ends well.
        if proven <= if near_surface.is_some() { 2.0 * DEAR } else { DEAR } {
            return strategy;
        }
        let Some(steepest) = self.steepest(node, &at).map(|steepest| MARGIN * steepest) else { return strategy };
        if steepest <= 0.0 || proven <= TIMES_STEEPEST * steepest {
            return strategy;
        }
        // Perhaps it takes but a longer look.
        if strategy.over == Over::Region {
            let more = self.aside(|builder| builder.constant_of_more(node, &at, LONGER)).lipschitz;
            if more < strategy.constant && (more <= DEAR || more <= TIMES_STEEPEST * steepest) {
                return BoundStrategy { constant: more, ..strategy };
            }
        }
        let now = self.as_parameters_stand(node, &at, proven);
        if now <= DEAR || now <= TIMES_STEEPEST * steepest {
            return strategy;
        }
        let round = |factor: f64| if factor < 10.0 { format!("{factor:.1}") } else { format!("{factor:.0}") };
        let at = self.graph.location(node).unwrap_or_else(|| self.place(shape, node));
        let [proven, drawn] = [now, steepest].map(round);
        self.diagnostics.push(Diagnostic::new(
            Code::Unproven,
            at,
            format!("the factor ×{proven} that is proven for this formula would cost more steps than a ray has; it is drawn with ×{drawn}, a quarter more than at the steepest place found"),
            "smaller multiples or lower frequencies within it make it gentler; with `--strict` the proven factor stands",
        ));
        self.kind = self.kind.max(Kind::Unproven);
        BoundStrategy { constant: steepest, proof: Proof::Measured, ..strategy }
    }

    /// Whether the factor of a map is of no use for a formula that it moves: no ray gets anywhere by it, and the steepest place that is found is far
    /// gentler.
    pub(super) fn is_dear(&mut self, node: NodeId, at: &Domain, factor: f64) -> bool {
        !self.scene.strict && factor > HOPELESS && self.steepest(node, at).is_some_and(|steepest| steepest > 0.0 && factor > TIMES_STEEPEST * MARGIN * steepest)
    }

    /// A constant over a domain at the defaults of parameters; the one that is known of their ranges where it reads none.
    pub(super) fn as_parameters_stand(&self, node: NodeId, at: &Domain, known: f64) -> f64 {
        let target = Target::Value(node);
        let search = Search { parameters: self.parameters_of(&target), target, domain: at.clone(), rules: self.facts.rules };
        let start: Vec<f64> = self.graph.parameters.iter().map(|p| p.default).collect();
        if search.parameters.is_empty() { known } else { search.run(self.graph, start.into(), BUDGET) }
    }

    /// The slope that such a share of places of a domain do not exceed, by differences.
    pub(super) fn slope_by_differences(&mut self, node: NodeId, at: &Domain, share: f64) -> Option<f64> {
        let lives = self.lives(node);
        let mut slopes = Vec::new();
        for life in 0..lives {
            let tape = self.tape_of(at, &[node], life)?;
            let by = Slopes::of(&tape, at);
            let mut random = Random(life as u64);
            let turns = by.turns()? / lives;
            self.facts.account.spend_on_numbers((turns * by.cost()) as u64);
            for turn in 0..turns {
                slopes.extend(by.at(&places(at, turn, &mut random)).into_iter().filter(|slope| slope.is_finite()));
            }
        }
        slopes.sort_by(f64::total_cmp);
        slopes.get((slopes.len() as f64 * share) as usize).copied()
    }

    /// How steep a formula is at the steepest place found.
    fn steepest(&mut self, node: NodeId, at: &Domain) -> Option<f64> {
        let size = size_of(at);
        let lives = self.lives(node);
        let mut steepest: f64 = 0.0;
        for life in 0..lives {
            let tape = self.tape_of(at, &[node], life)?;
            let slopes = Slopes::of(&tape, at);
            let mut random = Random(life as u64);
            let mut best = (0.0, [0.0; 3]);
            let turns = slopes.turns()? / lives;
            self.facts.account.spend_on_numbers((turns * slopes.cost()) as u64);
            for turn in 0..turns {
                let [here, there] = [0, 1].map(|_| places(at, turn, &mut random));
                best = slopes.steeper(best, &here);
                best = slopes.steeper(best, &slopes.surface(&here, &there));
            }
            let mut reach = FIRST * size;
            for _ in 0..ROUNDS {
                let around = from_fn(|_| within(at, add(best.1, scale(random.direction(), reach * random.next()))));
                best = slopes.steeper(best, &around);
                reach *= NEARER;
            }
            steepest = steepest.max(best.0);
        }
        steepest.is_finite().then_some(steepest)
    }
}

/// The size of a domain; 1 where it has no end.
fn size_of(at: &Domain) -> f64 {
    Some(at.point.size()).filter(|size| size.is_finite()).unwrap_or(1.0)
}

/// The place of a domain that is nearest to another, along each axis.
fn within(at: &Domain, place: Vec3) -> Vec3 {
    let mut place = place;
    for (x, side) in place.iter_mut().zip(&at.point.0) {
        *x = x.max(side.lo).min(side.hi);
    }
    place
}

/// How steep a formula is, by differences.
struct Slopes<'a> {
    tape: &'a Tape,
    apart: f64,
}

impl<'a> Slopes<'a> {
    fn of(tape: &'a Tape, at: &Domain) -> Self {
        Self { tape, apart: DIFFERENCE * size_of(at) }
    }

    /// What a turn costs, in additions.
    fn cost(&self) -> usize {
        (weight(self.tape) * LANES * (HALVINGS + 2 * 4 + 1)).max(1)
    }

    /// How often it is looked at in each lane. None where that takes too long.
    fn turns(&self) -> Option<usize> {
        let turns = MOST / self.cost();
        (turns >= FEWEST).then_some(turns.min(TURNS))
    }

    /// Places of the surface on ways between places; where both ends are on one side of it, an end.
    fn surface(&self, from: &Places, to: &Places) -> Places {
        let mut evaluator = self.tape.evaluator();
        let mut at = |places: &Places| values(&mut evaluator, places)[0];
        let first = at(from);
        let [here, _] = halved(from, to, HALVINGS, |middle| {
            let seen = at(middle);
            from_fn(|lane| (number(&seen, lane) > 0.0) != (number(&first, lane) > 0.0))
        });
        here
    }

    /// How steep it is at each of some places.
    fn at(&self, places: &Places) -> Lanes {
        let mut evaluator = self.tape.evaluator();
        let mut at = |places: &Places| values(&mut evaluator, places)[0];
        let here = at(places);
        let along: [Lanes; 3] = from_fn(|axis| {
            let step = from_fn(|i| if i == axis { self.apart } else { 0.0 });
            at(&places.map(|place| add(place, step)))
        });
        from_fn(|lane| length(along.each_ref().map(|there| (number(there, lane) - number(&here, lane)) / self.apart)))
    }

    /// The steepest of one place with its slope and others.
    fn steeper(&self, best: (f64, Vec3), places: &Places) -> (f64, Vec3) {
        let slopes = self.at(places);
        let others = slopes.into_iter().zip(*places).filter(|(slope, _)| slope.is_finite());
        others.fold(best, |best, other| if other.0 > best.0 { other } else { best })
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]
mod tests {
    use crate::graph::Proof;
    use crate::{MemoryLoader, Options, compile};

    /// The largest factor of a scene, and how it is known.
    fn factor(scene: &str, strict: bool) -> (f64, Proof) {
        let options = Options { strict, ..Options::default() };
        let scene = compile(&MemoryLoader::new().with("main.sdf", scene), "main.sdf", &options).compiled.unwrap();
        let largest = scene.graph.factors.iter().max_by(|a, b| a.lipschitz.total_cmp(&b.lipschitz)).unwrap();
        (largest.lipschitz, largest.proof)
    }

    #[test]
    fn what_no_ray_can_follow_is_measured() {
        let warped = "fn n(q: vec2) = fbm((q.x, 0, q.y), octaves: 4)
            field land = { let s = 0.5 * p.xz; let q = (n(s), n(s + (5.2, 1.3))); let r = (n(s + 2 * q + (1.7, 9.2)), n(s + 2 * q + (8.3, 2.8)));
              p.y - 0.5 * n(s + 2 * r) }
            scene = land.within(box((8, 2, 8)))";
        let (drawn, proof) = factor(warped, false);
        assert!(proof == Proof::Measured && drawn > 5.0 && drawn < 20.0, "{drawn} {proof:?}");
        let (proven, proof) = factor(warped, true);
        assert!(proof == Proof::Derived && proven > 1000.0, "{proven} {proof:?}");
    }

    #[test]
    fn what_is_steep_stays_proven() {
        for scene in [
            // As steep as that, at a surface that is hard to find, at one end of a slider, and later.
            "field f = p.y - sin(80 * p.x)\nscene = f.within(box(4))",
            "field f = pow(abs(p.x), 40) + pow(abs(p.y), 40) - 1\nscene = f.within(box(4))",
            "param a: float = 1 in 1..90\nfield f = p.y - 0.9 * sin(a * p.x)\nscene = f.within(box(4))",
            "field f = p.y - 0.9 * sin(80 * smoothstep(20, 30, time) * p.x)\nscene = f.within(box(4))",
        ] {
            let (largest, proof) = factor(scene, false);
            assert!(proof != Proof::Measured && largest > 50.0, "{scene}: {largest} {proof:?}");
        }
    }

    #[test]
    fn what_moves_is_measured_by_differences() {
        let gear = "field2 gear = { let a = atan(p.y, p.x); length(p) - 1 - 0.1 * clamp(9 * sin(12 * a), -1, 1) }\nscene = gear.rotate(time).extrude(0.3)";
        let (drawn, proof) = factor(gear, false);
        assert!(proof == Proof::Measured && drawn < 50.0, "{drawn} {proof:?}");
    }
}
