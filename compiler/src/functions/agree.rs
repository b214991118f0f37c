//! Jumps whose two sides agree at all places where one looks, though nothing proves that they do: in the nearest of several points, in hexagons by two
//! grids, in tiles whose curves meet at their edges.
//!
//! A place at a jump is found by halving a way from one side of it to the other, until the formula can change by no more than a jump that does no harm.

use crate::analysis::Domain;
use crate::evaluate::{LANES, Lanes, Tape};
use crate::functions::builder::Builder;
use crate::functions::jumps::{Site, jump_epsilon};
use crate::functions::trial::{Places, get, halved, number, places, values, weight};
use crate::graph::kernel::Op;
use crate::graph::{Node, NodeId};
use crate::random::Random;
use crate::rules::Rule;
use crate::vector::{Vec3, length, mix, sub};
use std::array::from_fn;

/// At so many places both sides must agree, and at more where that costs less than so many operations.
const FEWEST: usize = 1024;
const PLACES: usize = 4096;
const CHEAP: u64 = 10_000_000;
/// So often a way is tried in each lane to find them.
const TURNS: usize = 4096;
/// A way is halved so often.
const HALVINGS: usize = 46;
/// What costs more than that is not looked at to the end: at first, and where nothing else of the formula jumps.
const QUICK: u64 = 15_000_000;
const LONGEST: u64 = 100_000_000;
/// No more is looked for once so many operations were computed.
const MOST: u64 = 800_000_000;
/// What is so small there is zero between both sides.
const NOTHING: f64 = 1e-6;
/// What is apart by less than this part of a ray's step across a jump agrees.
const SAME: f64 = 0.25;
/// How far away the formula is looked at once more to see how steep it is, as a part of the way to another place.
const BESIDE: f64 = 1e-3;
/// How long the ways are, one after the other, as parts of the way between two places.
const LONG: [f64; 5] = [1.0, 0.1, 0.01, 0.3, 0.03];
/// A condition that is met at fewer of the places in one of its states is looked for: so often in each lane, until there are so many, and from there on
/// so many ways.
const MET: usize = 64;
const SEARCHES: usize = 4096;
const POOL: usize = 256;
const FROM_POOL: usize = 64;
/// So often each lane looks how steep the formula is.
const USUAL: usize = 8;

impl Builder<'_> {
    /// Those of some jumps of a formula whose sides agree at all of many places, and those whose sides do not as far as is known. Where any do not,
    /// rays stop anyway, and the others are not worth a long look.
    pub(super) fn agreeing(&mut self, root: NodeId, sites: Vec<Site>, near: &Domain) -> (Vec<Site>, Vec<Site>) {
        if self.scene.strict || !self.facts.rules.has(Rule::Agreement) {
            return (Vec::new(), sites);
        }
        let first: Vec<Option<bool>> = sites.iter().map(|site| self.agrees(root, site, near, QUICK)).collect();
        let jumps = first.contains(&Some(false));
        let mut first = first.into_iter();
        sites.into_iter().partition(|site| match first.next().flatten() {
            Some(known) => known,
            None => !jumps && self.agrees(root, site, near, LONGEST) == Some(true),
        })
    }

    /// Whether both sides of all of some jumps agree at all places that are looked at about the formula's solid.
    pub(super) fn all_agree(&mut self, root: NodeId, sites: &[Site], near: &Domain) -> bool {
        let Some((region, _)) = self.region_of(root, near).filter(|_| !self.scene.strict) else { return false };
        let about = near.at(region.grow(region.size()).intersect(&near.point));
        sites.iter().all(|site| self.agrees(root, site, &about, LONGEST) == Some(true))
    }

    /// Whether a formula comes to the same on both sides of where this operation of it jumps, at all of many places. None where that is not known
    /// after so many operations.
    fn agrees(&mut self, root: NodeId, site: &Site, near: &Domain, most: u64) -> Option<bool> {
        if self.found.looked > MOST || self.facts.account.is_spent() {
            return None;
        }
        let most = most.min(self.facts.account.numbers());
        let place = (root, site.node, near.key(), most);
        if let Some(&agrees) = self.found.agreements.get(&place) {
            return agrees;
        }
        let (key, known) = self.facts.agreement(self.graph, [root, site.node], near, most);
        let (agrees, cost) = known.unwrap_or_else(|| {
            let before = std::mem::take(&mut self.found.looked);
            let agrees = self.look_whether_agrees(root, site, near, most);
            let cost = std::mem::replace(&mut self.found.looked, before);
            self.facts.keep_agreement(key, (agrees, cost));
            (agrees, cost)
        });
        self.facts.account.spend_on_numbers(cost);
        self.found.looked += cost;
        self.found.agreements.insert(place, agrees);
        agrees
    }

    fn look_whether_agrees(&mut self, root: NodeId, site: &Site, near: &Domain, longest: u64) -> Option<bool> {
        let zero = self.graph.constant(0.0);
        let is_angle = site.op == Op::Atan2;
        // Across its cut an angle is another one, where its second argument is below zero.
        let (jumping, of) = match site.args.as_slice() {
            &[across, ahead] if is_angle => (self.graph.op(Op::Lt, &[across, zero]), ahead),
            &[of, ..] => (site.node, of),
            [] => return None,
        };
        // Just where it changes, a sign is neither of its sides.
        let between = match site.op {
            Op::Sign => self.rebuilt(root, &mut |_, id, _| Some((id == site.node).then_some(zero)))?,
            _ => root,
        };
        let conditions = self.conditions(root);
        let most = SAME * jump_epsilon(near) * self.usual_slope(root, near)?;
        let mut lives: Vec<Option<Jump>> = (0..self.lives(root)).map(|_| None).collect();
        let (many, mut found) = (lives.len(), 0);
        let mut met = vec![Met::default(); conditions.len()];
        let mut known: Vec<Vec3> = Vec::new();
        for turn in 0..TURNS {
            let place = lives.get_mut(turn % many)?;
            let jump = match place {
                Some(jump) => jump,
                None => place.insert(Jump {
                    at: self.tape_of(near, &[jumping, of], turn)?,
                    formula: self.tape_of(near, &[root, between], turn)?,
                    conditions: self.tape_of(near, &conditions, turn)?,
                    is_angle,
                }),
            };
            let mut random = Random(turn as u64);
            let [mut from, ends] = [0, 1].map(|_| places(near, turn, &mut random));
            let mut to = toward(&from, &ends, turn);
            // Every other time about places that are known.
            if turn % 2 == 1 && !known.is_empty() {
                let middle: Places = from_fn(|_| known.get((random.next() * known.len() as f64) as usize).copied().unwrap_or_default());
                [from, to] = [from, ends].map(|ends| toward(&middle, &ends, turn / 2));
            }
            let seen = jump.look(&from, &to, &mut met, &mut self.found.looked);
            if seen.apart > most || seen.apart.is_nan() {
                return Some(false);
            }
            found += seen.places.len();
            known.extend(seen.places.iter().take(POOL.saturating_sub(known.len())));
            if self.found.looked > longest {
                return None;
            }
            if found >= PLACES || found >= FEWEST && self.found.looked > CHEAP && turn >= many {
                break;
            }
        }
        // Of what is rare little is known.
        if found < FEWEST {
            return None;
        }
        // What holds at few of them, as in one cell of many, is looked for.
        let jumps: Vec<Jump> = lives.into_iter().flatten().collect();
        for (condition, state) in (0..conditions.len()).flat_map(|condition| [(condition, false), (condition, true)]) {
            let times = met.get(condition).map_or(0, |met| met.times(state));
            if times >= MET {
                continue;
            }
            for jump in &jumps {
                if jump.is_apart_where(condition, state, near, most, &mut met, &mut self.found.looked) {
                    return Some(false);
                }
                if self.found.looked > longest {
                    return None;
                }
            }
        }
        Some(true)
    }

    /// The conditions in a formula that are not the same everywhere.
    fn conditions(&self, root: NodeId) -> Vec<NodeId> {
        let varies = |id: &NodeId| matches!(self.graph.node(*id), Node::Op(Op::Lt | Op::Le | Op::Eq, _)) && !self.is_uniform(*id);
        self.graph.reachable(&[root]).into_iter().filter(varies).collect()
    }

    /// How steep a formula is at most places.
    fn usual_slope(&mut self, root: NodeId, near: &Domain) -> Option<f64> {
        let key = (root, near.key());
        if let Some(&known) = self.found.slopes.get(&key) {
            return Some(known);
        }
        let tape = self.tape_of(near, &[root], 0)?;
        let (mut evaluator, mut random, mut slopes) = (tape.evaluator(), Random(1), Vec::new());
        for turn in 0..USUAL {
            let [here, there] = [0, 1].map(|_| places(near, turn, &mut random));
            let beside: Places = from_fn(|lane| mix(get(&here, lane), get(&there, lane), BESIDE));
            let [a, b] = [&here, &beside].map(|places| values(&mut evaluator, places)[0]);
            let slope = |lane: usize| (number(&a, lane) - number(&b, lane)).abs() / length(sub(get(&here, lane), get(&beside, lane)));
            slopes.extend((0..LANES).map(slope).filter(|slope| slope.is_finite()));
        }
        slopes.sort_by(f64::total_cmp);
        let usual = slopes.get(slopes.len() / 2).copied().unwrap_or(0.0);
        self.found.slopes.insert(key, usual);
        Some(usual)
    }
}

/// Ends of ways toward other places, of another length each turn.
fn toward(from: &Places, ends: &Places, turn: usize) -> Places {
    let part = LONG.get(turn % LONG.len()).copied().unwrap_or(1.0);
    from_fn(|lane| mix(get(from, lane), get(ends, lane), part))
}

/// A jump in a formula, for some values of what else it reads.
struct Jump {
    /// What jumps, and of what; of an angle whether it is below zero, and its second argument.
    at: Tape,
    /// The formula, and what it is just where a sign changes.
    formula: Tape,
    conditions: Tape,
    is_angle: bool,
}

/// At how many places of a jump a condition holds, and fails.
#[derive(Clone, Default)]
struct Met {
    holds: usize,
    fails: usize,
}

impl Met {
    fn times(&self, state: bool) -> usize {
        if state { self.holds } else { self.fails }
    }
}

/// What was seen of a jump.
#[derive(Default)]
struct Seen {
    /// At which places.
    places: Vec<Vec3>,
    /// How far both sides are apart at most.
    apart: f64,
}

impl Jump {
    /// Looks at a jump where it is on ways between places; counts in which states conditions are met there.
    fn look(&self, from: &Places, to: &Places, met: &mut [Met], cost: &mut u64) -> Seen {
        let mut evaluator = self.at.evaluator();
        let mut sites = |places: &Places| values(&mut evaluator, places);
        let [[first, _], [last, _]] = [from, to].map(&mut sites);
        let differs = |a: &Lanes, b: &Lanes, lane: usize| number(a, lane) != number(b, lane);
        *cost += (2 * weight(&self.at) * LANES) as u64;
        if (0..LANES).all(|lane| !differs(&first, &last, lane)) {
            return Seen::default();
        }
        let [here, there] = halved(from, to, HALVINGS, |middle| {
            let [seen, _] = sites(middle);
            from_fn(|lane| differs(&seen, &first, lane))
        });
        let [[_, of_here], [_, of_there]] = [&here, &there].map(&mut sites);
        let lanes: Vec<usize> =
            (0..LANES).filter(|&lane| differs(&first, &last, lane) && (!self.is_angle || number(&of_there, lane) < 0.0)).collect();
        let [mut formula, mut conditions] = [&self.formula, &self.conditions].map(Tape::evaluator);
        let [[a, between], [b, _]] = [&here, &there].map(|places| values(&mut formula, places));
        for places in [&here, &there] {
            values(&mut conditions, places);
            for (i, met) in met.iter_mut().enumerate() {
                let holds = lanes.iter().filter(|&&lane| number(conditions.output(i), lane) != 0.0).count();
                met.holds += holds;
                met.fails += lanes.len() - holds;
            }
        }
        let operations = (HALVINGS + 2) * weight(&self.at) + 2 * weight(&self.formula) + 2 * weight(&self.conditions);
        *cost += (operations * LANES) as u64;
        let apart = |&lane: &usize| {
            let [a, b, between] = [&a, &b, &between].map(|side| number(side, lane));
            // Where what it is of jumps itself, nothing is between.
            let passes = [&of_here, &of_there].iter().all(|of| number(of, lane).abs() <= NOTHING);
            (a - b).abs().max(if passes { (a - between).abs() } else { 0.0 })
        };
        let apart = lanes.iter().map(apart).fold(0.0, |most: f64, apart| if apart > most || apart.is_nan() { apart } else { most });
        Seen { places: lanes.iter().map(|&lane| get(&here, lane)).collect(), apart }
    }

    /// Whether both sides are more than `most` apart on ways from places where a condition is in a state, as far as there are any.
    fn is_apart_where(&self, condition: usize, state: bool, near: &Domain, most: f64, met: &mut [Met], cost: &mut u64) -> bool {
        let (mut evaluator, mut random, mut pool) = (self.conditions.evaluator(), Random(1), Vec::new());
        for turn in 0..SEARCHES {
            let places = places(near, turn, &mut random);
            values(&mut evaluator, &places);
            let holds = evaluator.output(condition);
            pool.extend((0..LANES).filter(|&lane| (number(holds, lane) != 0.0) == state).map(|lane| get(&places, lane)));
            *cost += (weight(&self.conditions) * LANES) as u64;
            if pool.len() >= POOL {
                break;
            }
        }
        let turns = if pool.is_empty() { 0 } else { FROM_POOL };
        for turn in 0..turns {
            let mut next = (0..LANES).map(|lane| pool.get((turn * LANES + lane) % pool.len()).copied());
            let from: Places = from_fn(|_| next.next().flatten().unwrap_or_default());
            let to = toward(&from, &places(near, 0, &mut random), turn);
            let seen = self.look(&from, &to, met, cost);
            if seen.apart > most || seen.apart.is_nan() {
                return true;
            }
        }
        false
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]
mod tests {
    use crate::diagnostic::Code;
    use crate::{MemoryLoader, Options, compile};

    /// Whether rays stop at a jump of a scene, and whether they pass one of which nothing is proven.
    fn stops_and_passes(scene: &str, strict: bool) -> (bool, bool) {
        let options = Options { strict, ..Options::default() };
        let outcome = compile(&MemoryLoader::new().with("main.sdf", scene), "main.sdf", &options);
        assert!(outcome.compiled.is_some(), "{scene}: {:?}", outcome.diagnostics);
        let has = |code| outcome.diagnostics.iter().any(|d| d.code == code);
        (has(Code::Jump), has(Code::Unproven))
    }

    /// The point of the nearest of two lattices, and what is made of that.
    fn hexagons(made: &str) -> String {
        format!(
            "field f = {{ let r = (1, 1.7320508); let a = mod(p.xz, r) - r / 2; let b = mod(p.xz - r / 2, r) - r / 2;
             let g = if dot(a, a) < dot(b, b) {{ a }} else {{ b }}; let id = p.xz - g; {made} }}\nscene = f.within(box((12, 3, 12)))"
        )
    }

    #[test]
    fn rays_pass_where_both_sides_agree() {
        let nearest = "let z = p for i in 0..4 {
              let b = if length(z - (-1, -1, 1)) < length(z - (1, 1, 1)) { (-1, -1, 1) } else { (1, 1, 1) };
              let c = if length(z - (1, -1, -1)) < length(z - b) { (1, -1, -1) } else { b };
              let d = if length(z - (-1, 1, -1)) < length(z - c) { (-1, 1, -1) } else { c };
              z = 2 * z - d }; (length(z) - 2) / 16";
        let shift = "let q = p, s = 1 for i in 0..3 { let a = abs(q);
              let b = if a.x < a.y { a.yxz } else { a };
              let c = if b.x < b.z { b.zyx } else { b };
              let d = if c.y < c.z { c.xzy } else { c };
              let e = 3 * d - 2;
              q = (e.x, e.y, if e.z < -1 { e.z + 2 } else { e.z }), s = 3 * s };
              let m = abs(q) - 1; max(m.x, max(m.y, m.z)) / s";
        let pipes = "let v = p.xz; let c = floor((v.x + k * floor(v.y), v.y)); let f = (fract(v.x + k * floor(v.y)), fract(v.y));
              let g = if hash(c) < 0.5 { (1 - f.x, f.y) } else { f };
              length((min(abs(length(g) - 0.5), abs(length(g - 1) - 0.5)), p.y)) - 0.15";
        let of = |formula: &str| format!("param k: int = 2 in 1..4\nfield f = {{ {formula} + 0 * k }}\nscene = f.within(box(4))");
        let ring = hexagons("length((length(g) - 0.3, p.y)) - 0.1");
        let cells = ring.replace("scene = f.within(box((12, 3, 12)))", "scene = for cell in grid((0, 4, 0)) { f.within(box((12, 3, 12))) }");
        for scene in [of(nearest), of(shift), of(pipes), ring, cells] {
            assert_eq!(stops_and_passes(&scene, false), (false, true), "{scene}");
            assert_eq!(stops_and_passes(&scene, true), (true, false), "{scene}");
        }
    }

    #[test]
    fn rays_stop_at_what_is_rare() {
        let bricks = "0.3 * hash((floor(3 * p.x + floor(3 * p.z)), floor(3 * p.z)))";
        for (before, formula) in [
            // One cell of two hundred, and a few.
            ("", "p.y - (if length(id - (2, 1.732)) < 0.1 { 1 } else { 0.3 })".to_owned()),
            ("", "p.y - (if id.x == 1 && abs(id.y) < 0.1 { 1 } else { 0.3 })".to_owned()),
            ("", "p.y - max(0, 1 - length(id) / 2)".to_owned()),
            // In one place, at one end of a slider, or later.
            ("", format!("p.y - (if max(abs(p.x - 1), abs(p.z + 2)) < 0.4 {{ {bricks} }} else {{ 0 }})")),
            ("param rough: float = 0 in 0..1\n", format!("p.y - smoothstep(0.8, 1, rough) * {bricks}")),
            ("param mode: int = 0 in 0..3\n", format!("p.y - (if mode == 3 {{ {bricks} }} else {{ 0 }})")),
            ("", format!("p.y - smoothstep(20, 30, time) * {bricks}")),
            // Just where it changes.
            ("", "length((sign(p.x), p.y, p.z)) - 0.9".to_owned()),
        ] {
            let scene = format!("{before}{}", hexagons(&formula));
            assert!(stops_and_passes(&scene, false).0, "{scene}");
        }
    }
}
