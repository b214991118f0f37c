//! A scene's bound put to the test: against quick probes for a sign change within it, against certified balls, and, where a device
//! answers for the emitted module, the module's own numbers against the same.

use crate::certify::{Ball, Claim, Prover, Truth, falsify};
use crate::compiled::Compiled;
use crate::live::Live;
use crate::evaluate::{Evaluator, Tape};
use crate::functions::LONGEST_HAIR;
use crate::graph::interval::Interval;
use crate::graph::{Function, Leaf, Node, NodeId};
use crate::random::Random;
use crate::spread::spread;
use crate::vector::{along as plus, length};
use std::sync::atomic::{AtomicUsize, Ordering};

/// How much is tried.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Points that are probed, over all values of the parameters.
    pub samples: usize,
    /// How many of them are certified.
    pub certified: usize,
    /// Chooses the points.
    pub seed: u64,
    /// About how many operations it may all take, as [`WORK`]; what would take more is not tried, and said to be left.
    pub work: u64,
}

/// What a person waits for: some seconds on two cores. An operation at one point counts as one, one over a box as [`Prover::work`] has it.
pub const WORK: u64 = 4_000_000_000;
/// Operations that it takes to lay open one of a formula.
const LAID_OPEN: u64 = 2000;
/// How often field and bound are computed for a point, with all of its probes.
const LOOKS: u64 = 64;
/// So many balls are certified before it is asked whether there is work left.
const BATCH: usize = 16;
/// No moment gets fewer points.
const FEWEST: usize = 16;

/// What evaluates the emitted module's bound: at these live values, at these points, one number each.
pub type Device<'a> = &'a dyn Fn(&Live, &[[f32; 3]]) -> Result<Vec<f32>, String>;

/// Which numbers were taken for the bound.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// Those of 64 bits on the processor.
    Processor,
    /// Those of the emitted module on the device, less the allowance for rounding.
    Device,
}

/// What is wrong with a bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// The field has another sign at this point, which is nearer than the bound.
    Crossed([f64; 3]),
    /// The bound has another sign than the field.
    Sign,
    /// The field or the bound is no finite number.
    NotFinite,
}

/// A point at which the bound does not hold.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Violation {
    /// Index into [`Report::moments`].
    pub moment: usize,
    /// The point.
    pub point: [f64; 3],
    /// The field there.
    pub field: f64,
    /// The radius that was claimed to be free of the surface.
    pub bound: f64,
    /// Whose claim it was.
    pub side: Side,
    /// What is wrong.
    pub fault: Fault,
}

/// How the device's numbers compare with those of 64 bits.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Compared {
    /// Points.
    pub points: usize,
    /// Those at which the two are within the allowance of each other.
    pub within: usize,
    /// Those at which the device's is larger by more than that, or no number. Where it is smaller a ray takes more steps, and meets the same.
    pub larger: usize,
    /// The largest difference, as a multiple of the allowance.
    pub worst: f64,
}

/// How much of something was not tried.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Left {
    /// Values of time and parameters.
    pub moments: usize,
    /// Points.
    pub points: usize,
    /// Balls.
    pub balls: usize,
}

/// What came of it.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Report {
    /// The values of time and parameters at which the bound was tried.
    pub moments: Vec<Live>,
    /// What was asked for and not tried, as [`Settings::work`] was used up.
    pub left: Left,
    /// Points that were probed, each along [`DIRECTIONS`] directions.
    pub points: usize,
    /// Points of which balls were tried.
    pub balls: usize,
    /// Balls that were proven to be empty.
    pub empty: usize,
    /// Balls of which nothing could be proven with the boxes that were allowed.
    pub undecided: usize,
    /// The bound over the true distance, in ascending order, where the distance could be settled.
    pub tightness: Vec<f64>,
    /// The device's numbers, where there is a device.
    pub device: Option<Compared>,
    /// Where the bound does not hold: one entry for each point and side.
    pub violations: Vec<Violation>,
}

/// Directions along which each point is probed.
pub const DIRECTIONS: usize = 8;
/// The allowance for rounding in 32 bits is this many times 2⁻²⁴ (|p| + size of the scene).
pub const ALLOWANCE: f64 = 64.0;
/// Parts of the bound at which a probe looks.
const PARTS: [f64; 4] = [0.3, 0.6, 0.9, 0.995];
/// Part of the bound that is certified: what 64 bits lose is less than the rest.
const CERTIFIED: f64 = 0.99;
/// Boxes that a ball or a distance may cost.
const BOXES: usize = 3000;
/// Operations of a field or bound once every call is replaced by its formula.
const LARGEST: usize = 4_000_000;
/// Of about so many of the certified points the distance is settled too: that costs several times as much, and these do for a median and a p5.
const DISTANCES: usize = 500;
/// Steps by which points are walked to the surface.
const WALK: usize = 32;
/// A walk ends with a step that is so small beside the scene; what has come as near as the other has met a surface.
const ARRIVED: f64 = 1e-4;
const NEAR: f64 = 1e-3;
/// Points that one thread makes and probes at once, and how often it makes more for those that fell away.
const SHARE: usize = 4096;
const ROUNDS: usize = 4;
/// Radii that differ by no more than this part are probed as one: the outermost place that is looked at lies in both balls.
const ALIKE: f64 = 0.999;

/// The part of a moment after which its points are probed, as far as a person is told.
const PROBED: f64 = 0.3;

/// Values of time and parameters at which a scene is tried that has any.
const MOMENTS: usize = 8;

/// Points about a scene, and how large it is.
#[derive(Clone, Copy)]
struct Room {
    centre: [f64; 3],
    size: f64,
    extent: f64,
}

/// A point with what is claimed there.
#[derive(Clone, Copy)]
struct Tried {
    point: [f64; 3],
    field: f64,
    bound: f64,
    /// The device's bound, and the allowance for its rounding.
    device: Option<(f64, f64)>,
}

/// A scene on trial.
struct Trial<'a> {
    compiled: &'a Compiled,
    room: Room,
    device: Option<Device<'a>>,
    /// Of every so many of the certified points the distance is settled.
    apart: usize,
    random: Random,
    report: Report,
}

/// Tries a scene's bound at points near and far, inside and outside, at several values of its parameters and times. `progress` hears the
/// part that is done. Fails where the scene is too large to be laid open, or the device fails.
pub fn verify(
    compiled: &Compiled,
    settings: Settings,
    device: Option<Device>,
    progress: &(dyn Fn(f64) + Sync),
) -> Result<Report, String> {
    let mut random = Random(settings.seed);
    let moments = moments(compiled, &mut random);
    let count = moments.len();
    let report = Report { device: device.map(|_| Compared::default()), ..Report::default() };
    // An odd step meets all kinds of points.
    let apart = settings.certified.div_ceil(DISTANCES) | 1;
    let mut trial = Trial { compiled, room: Room::of(compiled), device, apart, random, report };
    let mut spent = 0;
    for (moment, live) in moments.into_iter().enumerate() {
        let share = |all: usize| (all * (moment + 1)).div_ceil(count) - (all * moment).div_ceil(count);
        let share = Settings { samples: share(settings.samples), certified: share(settings.certified), ..settings };
        if spent >= settings.work {
            let left = &mut trial.report.left;
            *left = Left { moments: left.moments + 1, points: left.points + share.samples, balls: left.balls + share.certified };
            continue;
        }
        let work = (settings.work - spent) / (count - moment) as u64;
        spent += trial.at(&live, Settings { work, ..share }, &|done: f64| progress((moment as f64 + done) / count as f64))?;
        trial.report.moments.push(live);
    }
    trial.report.tightness.sort_by(f64::total_cmp);
    Ok(trial.report)
}

impl Report {
    /// The tightness that so many of a hundred points do not exceed; none where no distance was settled.
    pub fn tightness(&self, percent: usize) -> Option<f64> {
        let rank = (self.tightness.len() * percent).div_ceil(100).max(1);
        self.tightness.get(rank - 1).copied()
    }
}

/// The defaults, the ends of the ranges, and values within; every other one with the factors found for just these values, as a window
/// draws it. One is enough where nothing can change.
fn moments(compiled: &Compiled, random: &mut Random) -> Vec<Live> {
    let start = compiled.live();
    let graph = &compiled.graph;
    let still = !(0..graph.len()).any(|i| matches!(graph.node(NodeId(i as u32)), Node::Leaf(Leaf::Time)));
    if still && graph.parameters.is_empty() {
        return vec![start];
    }
    (0..MOMENTS)
        .map(|i| {
            let mut live = start.clone();
            if i >= 2 {
                live.time = f64::from((20.0 * random.next()) as f32);
                for (value, p) in live.components.iter_mut().zip(&graph.parameters) {
                    *value = match i {
                        2 => p.min,
                        3 => p.max,
                        _ => p.min + (p.max - p.min) * random.next(),
                    };
                }
            }
            if i % 2 == 1 {
                compiled.settle(&mut live);
            }
            live
        })
        .collect()
}

impl Trial<'_> {
    /// So much at one moment, as far as the work allows. The answer: how much work it was.
    fn at(&mut self, live: &Live, settings: Settings, progress: &(dyn Fn(f64) + Sync)) -> Result<u64, String> {
        let Self { compiled, room, device, apart, random, report } = self;
        let moment = report.moments.len();
        let formula = |f| compiled.functions.formulas.get(&(compiled.root, f)).copied().ok_or("the scene has no bound");
        let roots = [formula(Function::Field)?, formula(Function::Bound)?];
        let tape = Tape::new(&compiled.graph, &compiled.functions.formulas, &roots, live, LARGEST).map_err(|e| e.to_string())?;
        let truth = Truth::new(compiled, live, LARGEST).map_err(|e| e.to_string())?;
        let operations = tape.operations().max(1) as u64;
        let opened = LAID_OPEN * operations;
        let for_points = settings.work.saturating_sub(opened) / 2;
        let asked = settings.samples;
        let settings = Settings { samples: asked.min((for_points / (LOOKS * operations)) as usize).max(asked.min(FEWEST)), ..settings };
        report.left.points += asked - settings.samples;
        let probing = LOOKS * operations * settings.samples as u64;
        let for_balls = settings.work.saturating_sub(opened + probing);
        // Each share has random numbers of its own, so that nothing depends on how many threads there are.
        let shares = settings.samples.div_ceil(SHARE);
        let seeds: Vec<Random> = (0..2 * shares).map(|_| random.fork()).collect();
        let of = |i: usize| seeds.get(i).cloned().unwrap_or(Random(0));
        let made = spread(shares, &|| tape.evaluator(), &|evaluator, i| {
            points(evaluator, (settings.samples - i * SHARE).min(SHARE), *room, &mut of(i))
        });
        progress(0.3 * PROBED);
        let mut tried: Vec<Tried> = made.into_iter().flatten().collect();
        if let (Some(device), Some(compared)) = (device, &mut report.device) {
            let narrow: Vec<[f32; 3]> = tried.iter().map(|t| t.point.map(|c| c as f32)).collect();
            for (one, got) in tried.iter_mut().zip(device(live, &narrow)?) {
                let allowance = ALLOWANCE * 2f64.powi(-24) * (length(one.point) + room.size);
                let more = (f64::from(got) - one.bound) / allowance;
                let off = more.abs();
                compared.points += 1;
                compared.within += usize::from(off <= 1.0);
                compared.larger += usize::from(more > 1.0 || more.is_nan());
                compared.worst = if off.is_nan() { f64::INFINITY } else { compared.worst.max(off) };
                one.device = Some((f64::from(got), allowance));
            }
        }
        report.points += tried.len();
        let shares: Vec<&[Tried]> = tried.chunks(SHARE).collect();
        let make = || (tape.evaluator(), truth.prover());
        let done = AtomicUsize::new(0);
        let probed = spread(shares.len(), &make, &|(evaluator, jury), i| {
            let found = shares.get(i).map_or(Vec::new(), |share| probe(evaluator, share, room.extent, &mut of(seeds.len() / 2 + i), jury));
            let part = (done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / shares.len() as f64;
            progress(PROBED * (0.3 + 0.7 * part));
            found
        });
        report.violations.extend(probed.into_iter().flatten().map(|v| Violation { moment, ..v }));
        progress(PROBED);
        // A few of all kinds of points: their kinds stand in turn, so the step is odd.
        let every = match tried.len() / settings.certified.max(1) {
            0 | 1 => 1,
            n => (n - 1) | 1,
        };
        let chosen: Vec<Tried> = tried.iter().step_by(every).take(settings.certified).copied().collect();
        let (certain, certifying) = certify(&truth, &chosen, (*apart, room.extent), for_balls, &|part| progress(PROBED + (1.0 - PROBED) * part));
        report.left.balls += chosen.len() - certain.len();
        report.balls += certain.len();
        for found in certain {
            report.empty += found.empty;
            report.undecided += found.undecided;
            report.tightness.extend(found.tightness);
            for violation in found.violations {
                let same = |v: &Violation| v.moment == moment && v.point == violation.point && v.side == violation.side;
                if !report.violations.iter().any(same) {
                    report.violations.push(Violation { moment, ..violation });
                }
            }
        }
        progress(1.0);
        Ok(opened + probing + certifying)
    }
}

impl Tried {
    /// The radius that a side claims to be free of the surface.
    fn radius(&self, side: Side) -> f64 {
        match (side, self.device) {
            (Side::Processor, _) => self.bound.abs(),
            (Side::Device, Some((bound, allowance))) => bound.abs() - allowance,
            (Side::Device, None) => 0.0,
        }
    }

    /// What is wrong with the numbers themselves.
    fn fault(&self, side: Side) -> Option<Fault> {
        let (bound, allowance) = match (side, self.device) {
            (Side::Processor, _) => (self.bound, 1e-9),
            (Side::Device, Some(known)) => known,
            (Side::Device, None) => return None,
        };
        if !self.field.is_finite() || !bound.is_finite() {
            return Some(Fault::NotFinite);
        }
        let apart = self.field.signum() != bound.signum() && self.field.abs() > 1e-7 && bound.abs() > allowance;
        apart.then_some(Fault::Sign)
    }

    fn violation(&self, side: Side, bound: f64, fault: Fault) -> Violation {
        Violation { moment: 0, point: self.point, field: self.field, bound, side, fault }
    }
}

/// Quick: the first sign change within the claimed radius of each point, of each side, if any is met.
fn probe(evaluator: &mut Evaluator<'_>, tried: &[Tried], extent: f64, random: &mut Random, jury: &mut Prover<'_>) -> Vec<Violation> {
    let mut violations = Vec::new();
    // Of each claim whose it is: the index of its point, and the radii of the sides that are on trial by it.
    let mut claims = Vec::with_capacity(tried.len());
    let mut whose = Vec::with_capacity(tried.len());
    for (i, t) in tried.iter().enumerate() {
        let mut radii = [Side::Processor, Side::Device].map(|side| (side, t.radius(side)));
        for (side, radius) in &mut radii {
            if let Some(fault) = t.fault(*side) {
                violations.push(t.violation(*side, *radius, fault));
                *radius = 0.0;
            }
        }
        radii.sort_by(|a, b| b.1.total_cmp(&a.1));
        let [(_, larger), (_, smaller)] = radii;
        let apart = smaller < ALIKE * larger;
        for (k, (_, radius)) in radii.iter().enumerate() {
            if *radius > 0.0 && (k == 0 || apart) {
                claims.push(Claim { point: t.point, radius: *radius, field: t.field });
                whose.push(i);
            }
        }
    }
    for found in falsify(evaluator, &claims, || random.direction(), DIRECTIONS, &PARTS, extent) {
        let Some(t) = whose.get(found.claim).and_then(|i| tried.get(*i)) else { continue };
        let away = length(plus(found.at, t.point, -1.0));
        for side in [Side::Processor, Side::Device] {
            let radius = t.radius(side);
            let known = |v: &Violation| v.point == t.point && v.side == side;
            if t.fault(side).is_none() && away < radius && !violations.iter().any(known) && !across_a_jump(jury, t.point, radius) {
                violations.push(t.violation(side, radius, Fault::Crossed(found.at)));
            }
        }
    }
    violations
}

/// Whether a ray may step this far though the surface is nearer: across a jump it steps by a hair.
fn across_a_jump(jury: &mut Prover<'_>, point: [f64; 3], radius: f64) -> bool {
    radius <= 1.1 * LONGEST_HAIR && jury.over(point.map(|c| Interval::outward(c - radius, c + radius))).jump
}

/// What is certain of some points.
#[derive(Default)]
struct Certain {
    empty: usize,
    undecided: usize,
    tightness: Option<f64>,
    violations: Vec<Violation>,
}

/// Certifies points, as many as the work allows; of every so many of them, `apart`, the distance is settled too. The answer: what is certain, and how much
/// work it was.
fn certify(truth: &Truth, tried: &[Tried], (apart, extent): (usize, f64), work: u64, progress: &(dyn Fn(f64) + Sync)) -> (Vec<Certain>, u64) {
    let done = AtomicUsize::new(0);
    let (mut all, mut spent) = (Vec::with_capacity(tried.len()), 0);
    // In batches, so that nothing depends on how many threads there are.
    for (first, batch) in tried.chunks(BATCH).enumerate().map(|(k, batch)| (k * BATCH, batch)) {
        if spent >= work && first > 0 {
            break;
        }
        let found = spread(batch.len(), &|| truth.prover(), &|prover, i| {
            prover.allow(work / BATCH as u64);
            let certain = batch.get(i).map(|t| certain(prover, t, extent, (first + i) % apart == 0)).unwrap_or_default();
            progress((done.fetch_add(1, Ordering::Relaxed) + 1) as f64 / tried.len() as f64);
            (certain, prover.work())
        });
        for (certain, work) in found {
            spent += work;
            all.push(certain);
        }
    }
    (all, spent)
}

fn certain(prover: &mut Prover<'_>, tried: &Tried, extent: f64, settle: bool) -> Certain {
    let mut found = Certain::default();
    // Nothing is claimed beyond the extent.
    let room = extent - length(tried.point);
    let mut radii = [Side::Processor, Side::Device].map(|side| (side, (CERTIFIED * tried.radius(side)).min(room)));
    radii.sort_by(|a, b| b.1.total_cmp(&a.1));
    // What is known to be empty: the larger ball holds the smaller one.
    let mut empty = 0.0;
    for (side, radius) in radii {
        if tried.fault(side).is_some() || radius.is_nan() || radius <= 0.0 {
            continue;
        }
        if radius <= empty {
            found.empty += 1;
            continue;
        }
        match prover.empty_ball(tried.point, radius, BOXES) {
            Ball::Empty => {
                found.empty += 1;
                empty = radius;
            }
            Ball::Unknown(_) => {
                // The other ball is about as large, and the distance takes more boxes still.
                found.undecided += 1;
                return found;
            }
            Ball::Crossed(_) if across_a_jump(prover, tried.point, radius) => found.empty += 1,
            Ball::Crossed(at) => found.violations.push(tried.violation(side, radius, Fault::Crossed(at))),
        }
    }
    let bound = tried.bound.abs();
    if settle && tried.fault(Side::Processor).is_none() && bound > 0.0 && room > 0.0 {
        let distance = prover.distance(tried.point, room, 0.02, BOXES);
        let settled = distance.at_least > 0.0 && distance.at_most <= 1.1 * distance.at_least;
        // A surface is known to be within `at_most`, nearly always on its nearest point.
        found.tightness = settled.then(|| bound / distance.at_most);
    }
    found
}

impl Room {
    fn of(compiled: &Compiled) -> Self {
        let extent = compiled.blocks.extent;
        let (centre, size) = match compiled.bounds() {
            Some([low, high]) => {
                let side = |i: usize| low.get(i).zip(high.get(i)).map_or((0.0, 0.0), |(l, h)| (0.5 * (l + h), h - l));
                ([0, 1, 2].map(|i| side(i).0), [0, 1, 2].map(|i| side(i).1).into_iter().fold(0.0, f64::max))
            }
            // Without an end: what the camera looks at.
            None => {
                let frame = compiled.frame(&compiled.live());
                let camera = frame.cameras.first().map_or(([0.0; 3], [0.0; 3]), |(_, c)| (c.eye, c.target));
                (camera.1, length(plus(camera.0, camera.1, -1.0)))
            }
        };
        Self { centre, size: size.clamp(1e-6, 2.0 * extent), extent }
    }
}

/// Points about the solid, far from it, and at all distances from its surface, as 32 bits hold them, with field and bound there.
fn points(evaluator: &mut Evaluator<'_>, count: usize, room: Room, random: &mut Random) -> Vec<Tried> {
    let mut points = Vec::with_capacity(count);
    for _ in 0..ROUNDS {
        let left = count - points.len();
        points.extend(strewn(evaluator, left + left % 2, room, random).into_iter().take(left));
    }
    let mut tried = Vec::with_capacity(points.len());
    evaluator.at(&points, &[], |i, values| {
        if let (Some(&point), [field, bound]) = (points.get(i), values) {
            tried.push(Tried { point, field: *field, bound: *bound, device: None });
        }
    });
    tried
}

/// So many points less those beyond the extent.
fn strewn(evaluator: &mut Evaluator<'_>, count: usize, room: Room, random: &mut Random) -> Vec<[f64; 3]> {
    let about = |random: &mut Random, half: f64| plus(room.centre, random.within(half), 1.0);
    let mut points: Vec<[f64; 3]> = (0..count).map(|_| about(random, 0.75 * room.size)).collect();
    // Half of them walk toward some other point, until they stand before a surface (or behind it).
    let walked = points.len() / 2;
    let aims: Vec<[f64; 3]> = (0..walked).map(|_| about(random, 0.5 * room.size)).collect();
    let ways: Vec<[f64; 3]> = points.iter().zip(&aims).map(|(p, aim)| unit(plus(*aim, *p, -1.0))).collect();
    let mut walking: Vec<usize> = (0..walked).collect();
    for _ in 0..WALK {
        let stand: Vec<[f64; 3]> = walking.iter().filter_map(|&i| points.get(i).copied()).collect();
        let mut steps = Vec::with_capacity(stand.len());
        evaluator.at(&stand, &[], |_, values| {
            steps.push(0.9 * values.get(1).map_or(0.0, |b| b.abs()).min(room.size));
        });
        let mut next = steps.iter();
        walking.retain(|&i| {
            let (Some(p), Some(way), Some(step)) = (points.get_mut(i), ways.get(i), next.next()) else { return false };
            let ahead = plus(*p, *way, *step);
            // A way that meets nothing ends within the extent.
            let goes_on = length(ahead) < 0.95 * room.extent;
            if goes_on {
                *p = ahead;
            }
            goes_on && *step > ARRIVED * room.size
        });
    }
    let stand = points.get(..walked).unwrap_or(&[]).to_vec();
    let mut met: Vec<[f64; 3]> = Vec::new();
    evaluator.at(&stand, &[], |i, values| {
        let near = values.get(1).is_some_and(|b| b.abs() < NEAR * room.size);
        met.extend(stand.get(i).filter(|_| near));
    });
    // Those that met none gather about what the others met.
    for (i, p) in points.iter_mut().take(walked).enumerate() {
        let from = met.get(i % met.len().max(1)).copied().unwrap_or(*p);
        *p = plus(from, random.direction(), room.size * 10f64.powf(-4.5 + 4.0 * random.next()));
    }
    // A sixth anywhere within the extent.
    for p in points.iter_mut().skip(walked).step_by(3) {
        *p = random.within(room.extent);
    }
    // Both kinds in turn.
    let (near, wide) = points.split_at(walked);
    let all = near.iter().zip(wide).flat_map(|(a, b)| [a, b]).map(|p| p.map(|c| f64::from(c as f32)));
    all.filter(|p| length(*p) < 0.99 * room.extent).collect()
}

fn unit(v: [f64; 3]) -> [f64; 3] {
    let length = length(v).max(1e-300);
    v.map(|c| c / length)
}
