//! Curves as chains of bows: what a person writes, in straight pieces and arcs that join without a kink where the curve has none.

use super::bow::{Bow, aside, turned};
use crate::vector::{Vec3, add, cross, dot, length, mix, scale, sub, unit};
use std::f64::consts::TAU;
use std::hash::{Hash, Hasher};

/// The most bows of a curve.
pub const MOST_BOWS: usize = 20_000;
/// A chain lies no farther from the curve that it stands for than this share of that one's size. Half of what is promised.
const OFF: f64 = 5e-6;
/// A curve is halved no more often than this.
const DEEPEST: u32 = 12;
/// Places of a part of a curve that are compared with its arcs.
const COMPARED: usize = 9;
/// Arcs that turn farther than this are taken in halves first.
const WIDEST: f64 = 1.2;

/// A curve: bows, each of which begins where the one before it ends.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// The pieces, in order. At least one.
    pub bows: Vec<Bow>,
    /// Whether it ends where it begins.
    pub is_closed: bool,
}

impl Eq for Line {}

impl Hash for Line {
    fn hash<H: Hasher>(&self, state: &mut H) {
        self.is_closed.hash(state);
        self.bows.iter().flat_map(|bow| bow.numbers()).for_each(|number| number.to_bits().hash(state));
    }
}

/// A place of a curve with its directions: where a drawing's x and y point, and where the curve goes. They have length one and are at right angles.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// The place.
    pub at: Vec3,
    /// Where x points.
    pub x: Vec3,
    /// Where y points.
    pub y: Vec3,
    /// Where the curve goes.
    pub forth: Vec3,
}

/// What of a sweep one bow makes: a drawing that is carried along it, between two planes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// The bow.
    pub bow: Bow,
    /// By how much the drawing's place is turned in it, where x is across and y is `out`.
    pub turn: f64,
    /// The way along the curve to the bow's middle.
    pub way: f64,
    /// How far the curve goes on beyond the bow's ends, at most.
    pub past: f64,
    /// How far a mitre reaches beyond an end, for each unit of the drawing's reach; 0 where none is.
    pub mitre: f64,
    /// The planes where it begins and where it ends: the direction away from it, and how far from the origin along that.
    pub ends: [(Vec3, f64); 2],
}

/// A place and how the curve moves there, of any length; zero where that is not known.
type Moving = (Vec3, Vec3);

impl Line {
    /// Straight pieces from point to point. An error says what is wrong with them.
    pub fn polyline(points: &[Vec3], is_closed: bool) -> Result<Self, String> {
        let points = apart(points, is_closed)?;
        let last = points.first().filter(|_| is_closed).into_iter();
        let ends = points.iter().skip(1).chain(last);
        Self::of(points.iter().zip(ends).filter_map(|(a, b)| Bow::straight(*a, *b)).collect(), is_closed)
    }

    /// A circle's arc from a point through another to a third.
    pub fn arc(from: Vec3, by: Vec3, to: Vec3) -> Result<Self, String> {
        apart(&[from, by, to], false)?;
        if from == by || by == to || from == to {
            return Err("two of its three points are at one place".to_owned());
        }
        let bow = Bow::through(from, by, to).ok_or("its three points lie in a line, and the one between is not between the others")?;
        Self::of(bow.parts(), false)
    }

    /// Curves of the third degree, one after the other: each third point is passed, those between them draw it (Bézier). Three points are one curve of the
    /// second degree.
    pub fn bezier(points: &[Vec3], is_closed: bool) -> Result<Self, String> {
        check(points)?;
        let mut points = points.to_vec();
        if let &[a, b, c] = &points[..] {
            points = vec![a, mix(a, b, 2.0 / 3.0), mix(c, b, 2.0 / 3.0), c];
        }
        if is_closed && points.len().is_multiple_of(3) {
            points.extend(points.first().copied());
        }
        if points.len() < 4 || points.len() % 3 != 1 {
            let wanted = if is_closed { "3 for each curve: closed curves have 3, 6, 9 …" } else { "3 for each curve and one more: 4, 7, 10 …; or just 3" };
            return Err(format!("it has {} points, and needs {wanted}", points.len()));
        }
        let ends = points.windows(4).step_by(3).filter_map(|four| <[Vec3; 4]>::try_from(four).ok());
        Self::cubics(ends.collect(), is_closed && points.first() == points.last())
    }

    /// A smooth curve through points, which does not swing where they lie close together (Catmull and Rom, with the centripetal parameters of Yuksel,
    /// Schaefer and Keyser, "Parameterization and Applications of Catmull-Rom Curves", 2011).
    pub fn catmull_rom(points: &[Vec3], is_closed: bool) -> Result<Self, String> {
        let points = apart(points, is_closed)?;
        let count = points.len();
        if count == 2 {
            return Self::polyline(&points, false);
        }
        // Beyond an end the line goes on as it came.
        let at = |i: isize| -> Vec3 {
            let get = |i: usize| points.get(i).copied().unwrap_or_default();
            match usize::try_from(i) {
                _ if is_closed => get(i.rem_euclid(count as isize) as usize),
                Ok(i) if i < count => get(i),
                Ok(_) => sub(scale(get(count - 1), 2.0), get(count - 2)),
                Err(_) => sub(scale(get(0), 2.0), get(1)),
            }
        };
        let spans = if is_closed { count } else { count - 1 };
        let cubic = |i: isize| {
            let [a, b, c, d] = [-1, 0, 1, 2].map(|k| at(i + k));
            let [before, own, after] = [(a, b), (b, c), (c, d)].map(|(from, to)| length(sub(to, from)).sqrt());
            // How fast the curve passes b and c, for a parameter that grows by 1 between them (Barry and Goldman).
            let speed = |from: Vec3, mid: Vec3, to: Vec3, s: f64, t: f64| {
                let [first, second] = [scale(sub(mid, from), 1.0 / s), scale(sub(to, mid), 1.0 / t)];
                scale(add(scale(first, t), scale(second, s)), own / (s + t))
            };
            [b, add(b, scale(speed(a, b, c, before, own), 1.0 / 3.0)), sub(c, scale(speed(b, c, d, own, after), 1.0 / 3.0)), c]
        };
        Self::cubics((0..spans as isize).map(cubic).collect(), is_closed)
    }

    /// A helix about y, as much above as below the origin: so far from the axis, so far up each turn, so many turns.
    pub fn helix(radius: f64, pitch: f64, turns: f64) -> Result<Self, String> {
        if [radius, pitch, turns].iter().any(|c| !c.is_finite() || c.abs() > FARTHEST) {
            return Err("its numbers are not finite, or too large".to_owned());
        }
        if radius <= 0.0 || turns <= 0.0 {
            let which = if radius <= 0.0 { format!("its radius is {radius}") } else { format!("it has {turns} turns") };
            return Err(format!("{which}, and must have more than 0"));
        }
        if turns > 1000.0 {
            return Err(format!("it has {turns} turns, and 1000 are the most"));
        }
        let end = 0.5 * TAU * turns;
        let rise = pitch / TAU;
        let moving = |t: f64| -> Moving {
            let (sine, cosine) = t.sin_cos();
            ([radius * sine, rise * t, radius * cosine], [radius * cosine, rise, -radius * sine])
        };
        let size = (2.0 * radius).max(pitch.abs() * turns);
        let mut bows = Vec::new();
        let steps = (8.0 * turns).ceil().max(1.0) as usize;
        let place = |i: usize| -end + 2.0 * end * i as f64 / steps as f64;
        for i in 0..steps {
            fit(&moving, [place(i), place(i + 1)], OFF * size, 0, &mut bows)?;
        }
        Self::of(bows, pitch == 0.0 && turns == 1.0)
    }

    fn cubics(curves: Vec<[Vec3; 4]>, is_closed: bool) -> Result<Self, String> {
        let all = || curves.iter().flatten();
        let low = all().copied().reduce(|a, b| both(a, b, f64::min)).unwrap_or_default();
        let high = all().copied().reduce(|a, b| both(a, b, f64::max)).unwrap_or_default();
        let size = sub(high, low).into_iter().fold(0.0, f64::max);
        if size == 0.0 {
            return Err("all its points are at one place".to_owned());
        }
        let mut bows = Vec::new();
        for four in &curves {
            let [a, b, c, d] = *four;
            if a == d && b == a && c == a {
                continue;
            }
            let moving = |t: f64| -> Moving {
                let s = 1.0 - t;
                let weighed = |by: [f64; 4]| four.iter().zip(by).fold([0.0; 3], |sum, (point, by)| add(sum, scale(*point, by)));
                let place = weighed([s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t]);
                let slope = [(a, b), (b, c), (c, d)].into_iter().zip([s * s, 2.0 * s * t, t * t]).fold([0.0; 3], |sum, ((from, to), by)| add(sum, scale(sub(to, from), by)));
                (place, slope)
            };
            // At an end that its neighbour stands on, the next one draws it.
            let ends = |t: f64| {
                let (place, slope) = moving(t);
                let small = length(slope) < 1e-9 * size;
                let other = match (small, t == 0.0, t == 1.0) {
                    (true, true, _) => unit(sub(c, a)).or_else(|| unit(sub(d, a))).unwrap_or_default(),
                    (true, _, true) => unit(sub(d, b)).or_else(|| unit(sub(d, a))).unwrap_or_default(),
                    (true, ..) => [0.0; 3],
                    _ => slope,
                };
                (place, other)
            };
            fit(&ends, [0.0, 1.0], OFF * size, 0, &mut bows)?;
        }
        Self::of(bows, is_closed)
    }

    fn of(bows: Vec<Bow>, is_closed: bool) -> Result<Self, String> {
        if bows.is_empty() {
            return Err("all its points are at one place".to_owned());
        }
        if bows.len() > MOST_BOWS {
            return Err(format!("it takes {} arcs, and {MOST_BOWS} are the most", bows.len()));
        }
        Ok(Self { bows, is_closed })
    }

    /// How long it is.
    pub fn length(&self) -> f64 {
        self.bows.iter().map(|bow| 2.0 * bow.half).sum()
    }

    /// The frame at which each bow begins, and that at its end. From bow to bow they turn as little as they can: along an arc with it, at a kink about what is
    /// at a right angle to both directions (what Wang, Jüttler, Zheng and Liu, "Computation of Rotation Minimizing Frames", 2008, approximate). At the start
    /// y is as far up as it can be. `Self::rest` says by how much the last of a closed curve is turned against the first.
    pub fn frames(&self) -> Vec<[Frame; 2]> {
        let mut all: Vec<[Frame; 2]> = Vec::with_capacity(self.bows.len());
        for bow in &self.bows {
            let (at, forth) = bow.at(-bow.half);
            let y = match all.last() {
                Some([_, before]) => minimal(before.forth, forth, before.y),
                None => aside(forth),
            };
            let (to, onward) = bow.at(bow.half);
            let end = bow.carried(y);
            let frame = |at, forth, y: Vec3| {
                // Rounding adds up along a long chain.
                let y = unit(sub(y, scale(forth, dot(y, forth)))).unwrap_or_else(|| aside(forth));
                Frame { at, x: cross(y, forth), y, forth }
            };
            all.push([frame(at, forth, y), frame(to, onward, end)]);
        }
        all
    }

    /// The angle about the curve that is missing after a whole turn of a closed one, so that the last frame would be the first again.
    pub fn rest(&self, frames: &[[Frame; 2]]) -> f64 {
        let (Some([first, _]), Some([_, last]), true) = (frames.first(), frames.last(), self.is_closed) else { return 0.0 };
        let y = minimal(last.forth, first.forth, last.y);
        dot(cross(y, first.y), first.forth).atan2(dot(y, first.y))
    }

    /// The stretches of a sweep, and the pairs of them that meet at a kink, without the planes that end them there.
    /// At a kink both stretches end at the plane between them. What the two hold in common without that plane belongs to the sweep.
    /// Where there is no kink each stretch reaches a little into the next one, and stays inside of it.
    /// `overlap` limits that, as a part of half the length of the shorter one.
    /// The turn that a closed curve lacks at its end is shared out among its joints.
    pub fn stretches(&self, overlap: f64) -> (Vec<Stretch>, Vec<[Stretch; 2]>) {
        let frames = self.frames();
        let whole = self.length();
        let rate = -self.rest(&frames) / whole;
        let mut way = 0.0;
        let mut all: Vec<Stretch> = Vec::with_capacity(self.bows.len());
        for (bow, [start, _]) in self.bows.iter().zip(&frames) {
            let across = cross(bow.out, bow.forth);
            let turn = dot(across, start.y).atan2(dot(across, start.x)) + rate * (way + bow.half);
            let middle = way + bow.half;
            way += 2.0 * bow.half;
            let plane = |at: f64, sign: f64| {
                let (place, forth) = bow.at(at);
                let out = scale(forth, sign);
                (out, dot(out, place))
            };
            all.push(Stretch { bow: *bow, turn, way: middle, past: 0.0, mitre: 0.0, ends: [plane(-bow.half, -1.0), plane(bow.half, 1.0)] });
        }
        let mut kinks = Vec::new();
        let count = all.len();
        let off = OFF * (0..3).map(|i| self.wide(i)).fold(0.0, f64::max);
        for i in 0..if self.is_closed { count } else { count - 1 } {
            let next = (i + 1) % count;
            let (Some(&one), Some(&other)) = (all.get(i), all.get(next)) else { continue };
            let ((at, end), (_, start)) = (one.bow.at(one.bow.half), other.bow.at(-other.bow.half));
            let cosine = dot(end, start);
            let (mut to, mut from) = (one.ends[1], other.ends[0]);
            let (mut past, mut mitre) = (0.0, 0.0);
            if cosine > 1.0 - 1e-7 {
                // Two arcs that meet come apart by half of the difference of their bends, times the square of the way.
                let apart = length(sub(scale(one.bow.out, one.bow.bend), scale(other.bow.out, other.bow.bend)));
                let reach = (overlap * one.bow.half.min(other.bow.half)).min((2.0 * off / apart.max(f64::MIN_POSITIVE)).sqrt());
                to.1 = beyond(&one.bow, reach, 1.0, &mut to.0);
                from.1 = beyond(&other.bow, reach, -1.0, &mut from.0);
                past = reach;
            } else if cosine > FOLDED && let Some(between) = unit(add(end, start)) {
                mitre = ((1.0 - cosine) / (1.0 + cosine)).max(0.0).sqrt();
                if one.bow.bend == 0.0 {
                    to = (between, dot(between, at));
                }
                if other.bow.bend == 0.0 {
                    from = (scale(between, -1.0), -dot(between, at));
                }
                if one.bow.bend == 0.0 && other.bow.bend == 0.0 {
                    kinks.push([(i, 1), (next, 0)]);
                }
            }
            for i in [i, next] {
                if let Some(stretch) = all.get_mut(i) {
                    (stretch.past, stretch.mitre) = (stretch.past.max(past), stretch.mitre.max(mitre));
                }
            }
            for (i, end, plane) in [(i, 1, to), (next, 0, from)] {
                if let Some(slot) = all.get_mut(i).and_then(|stretch| stretch.ends.get_mut(end)) {
                    *slot = plane;
                }
            }
        }
        let open = |(i, end): (usize, usize)| {
            let mut stretch = *all.get(i)?;
            *stretch.ends.get_mut(end)? = NOWHERE;
            Some(stretch)
        };
        let kinks = kinks.into_iter().filter_map(|[one, other]| Some([open(one)?, open(other)?])).collect();
        (all, kinks)
    }

    /// How far it reaches along an axis.
    fn wide(&self, axis: usize) -> f64 {
        let ends = self.bows.iter().flat_map(Bow::bounds).filter_map(|corner| corner.get(axis).copied());
        let [low, high] = ends.fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], c| [low.min(c), high.max(c)]);
        high - low
    }

    /// The frame at a share of the length, from 0 at its start to 1 at its end.
    pub fn at(&self, share: f64, frames: &[[Frame; 2]]) -> Option<Frame> {
        let whole = self.length();
        let rest = self.rest(frames);
        let mut way = share.clamp(0.0, 1.0) * whole;
        let last = self.bows.len().checked_sub(1)?;
        for (i, (bow, [start, _])) in self.bows.iter().zip(frames).enumerate() {
            if way <= 2.0 * bow.half || i == last {
                let (at, forth) = bow.at(way - bow.half);
                let y = turned(turned(start.y, cross(bow.forth, bow.out), -bow.bend * way), forth, rest * share.clamp(0.0, 1.0));
                return Some(Frame { at, x: cross(y, forth), y, forth });
            }
            way -= 2.0 * bow.half;
        }
        None
    }
}

/// A curve that turns back more sharply than by the angle of this cosine has flat ends there.
const FOLDED: f64 = -0.9;
/// A plane beyond everything.
const NOWHERE: (Vec3, f64) = ([0.0, 1.0, 0.0], 1e9);

/// How far along its own direction a plane stands that cuts a bow `reach` beyond one of its ends: the last for a `sign` above zero, else the first.
/// `out` becomes that direction. The plane of an arc goes through its axis.
fn beyond(bow: &Bow, reach: f64, sign: f64, out: &mut Vec3) -> f64 {
    // No arc goes further than to a right angle from its middle.
    let way = (bow.half + reach).min(if bow.bend > 0.0 { (1.5 / bow.bend).max(bow.half) } else { f64::INFINITY });
    let (place, forth) = bow.at(sign * way);
    *out = scale(forth, sign);
    dot(*out, place)
}

/// Coordinates beyond are too large.
const FARTHEST: f64 = 1e15;

fn both(a: Vec3, b: Vec3, of: fn(f64, f64) -> f64) -> Vec3 {
    let ([a, b, c], [d, e, f]) = (a, b);
    [of(a, d), of(b, e), of(c, f)]
}

/// A direction across one way, carried to another way by the least turn.
fn minimal(from: Vec3, to: Vec3, across: Vec3) -> Vec3 {
    let axis = cross(from, to);
    match unit(axis).filter(|_| length(axis) > 1e-12) {
        Some(about) => turned(across, about, length(axis).atan2(dot(from, to))),
        None => across,
    }
}

fn check(points: &[Vec3]) -> Result<(), String> {
    if points.len() > 2 * MOST_BOWS {
        return Err(format!("it has {} points, and {} are the most", points.len(), 2 * MOST_BOWS));
    }
    match points.iter().position(|p| p.iter().any(|c| !c.is_finite() || c.abs() > FARTHEST)) {
        Some(at) => Err(format!("point {at} is nowhere: a coordinate is not a number, or too large")),
        None => Ok(()),
    }
}

/// Points without those that stand on the one before.
fn apart(points: &[Vec3], is_closed: bool) -> Result<Vec<Vec3>, String> {
    check(points)?;
    let mut kept = points.to_vec();
    kept.dedup();
    if is_closed && kept.len() > 1 && kept.first() == kept.last() {
        kept.pop();
    }
    let least = if is_closed { 3 } else { 2 };
    if kept.len() < least {
        return Err(match kept.len() {
            1 if points.len() > 1 => "all its points are at one place".to_owned(),
            count => format!("it has {count} point{}, and {} one needs {least}", if count == 1 { "" } else { "s" }, if is_closed { "a closed" } else { "an open" }),
        });
    }
    Ok(kept)
}

/// Two arcs for a part of a curve that leave and arrive as it does, or such pairs for its halves where these lie too far from it (Bolton, "Biarc curves", 1975).
fn fit(moving: &dyn Fn(f64) -> Moving, [from, to]: [f64; 2], off: f64, deep: u32, bows: &mut Vec<Bow>) -> Result<(), String> {
    if bows.len() > MOST_BOWS {
        return Err(format!("it takes more than {MOST_BOWS} arcs"));
    }
    let pair = biarc(moving(from), moving(to));
    let is_near = |pair: &[Bow]| {
        (1..=COMPARED).all(|i| {
            let p = moving(from + (to - from) * i as f64 / (COMPARED + 1) as f64).0;
            pair.iter().any(|bow| length(bow.away(p)) <= off)
        })
    };
    match pair {
        Some(pair) if pair.iter().all(|bow| bow.angle() < WIDEST) && is_near(&pair) => bows.extend(pair),
        _ if deep == DEEPEST => bows.extend(Bow::straight(moving(from).0, moving(to).0)),
        _ => {
            let middle = 0.5 * (from + to);
            fit(moving, [from, middle], off, deep + 1, bows)?;
            fit(moving, [middle, to], off, deep + 1, bows)?;
        }
    }
    Ok(())
}

fn biarc((from, leave): Moving, (to, arrive): Moving) -> Option<[Bow; 2]> {
    let (leave, arrive) = (unit(leave)?, unit(arrive)?);
    let way = sub(to, from);
    let (square, ahead) = (dot(way, way), dot(way, add(leave, arrive)));
    // The arms of both arcs have the same length: the root above zero of d² (2 - 2 leave·arrive) + 2 d ahead = way².
    let root = (ahead * ahead + 2.0 * (1.0 - dot(leave, arrive)).max(0.0) * square).sqrt();
    let arm = square / (ahead + root);
    if !(ahead + root > 1e-12 * square.sqrt() && arm.is_finite()) {
        return None;
    }
    let joint = scale(add(add(from, scale(leave, arm)), sub(to, scale(arrive, arm))), 0.5);
    let first = Bow::leaving(from, leave, joint)?;
    let second = Bow::leaving(joint, first.at(first.half).1, to)?;
    Some([first, second])
}
