//! The convex hull of balls, and of discs in the plane: points are those of no radius.
//!
//! The hull is bounded by planes through three balls, cones around two, and balls. Its signed distance at p is the largest n · p - h(n) over all directions n, where h(n), the support
//! function, is the largest n · c + r over the balls. That largest value is at the normal of a plane, at a direction of a cone, or at one from a ball's middle; each is right where no other
//! ball reaches farther in its direction. In the plane, lines that touch two discs stand for planes and cones. (Rockafellar, "Convex Analysis", 1970, § 13, for the support function.)

use crate::vector::{Vec3, add, cross, dot, length, scale, sub, unit};
use std::f64::consts::{PI, TAU};

/// The most balls of which the hull is found, those that lie in another one left out.
const MOST_BALLS: usize = 64;
/// The most discs of which the hull is found, those that lie in another one left out.
const MOST_DISCS: usize = 256;
/// Lengths below this part of the whole size count as none.
const TINY: f64 = 1e-9;
/// By so much of a circle's radius a direction may be beyond what bounds it: 32 bits do not open a gap there, and what it adds is of second order.
const MARGIN: f64 = 1e-4;

/// A ball, or a point where its radius is 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ball {
    /// Its middle.
    pub at: Vec3,
    /// Its radius.
    pub radius: f64,
}

/// Where a part of the hull ends: it is right at q from its middle where `dot(q, way) + by * len >= 0`.
#[derive(Clone, Copy, Debug)]
pub struct End {
    /// What the way from the middle is multiplied by.
    pub way: Vec3,
    /// What the length is multiplied by.
    pub by: f64,
}

/// A part of what bounds the hull. The signed distance is the largest value of those that are right.
#[derive(Clone, Debug)]
pub enum Part {
    /// `dot(p, normal) - height`, right everywhere.
    Plane {
        /// Its direction, of length 1.
        normal: Vec3,
        /// How far it is from the origin.
        height: f64,
    },
    /// `len - radius`, where len is the length of q = p - at.
    Ball {
        /// The ball.
        ball: Ball,
        /// Where it ends.
        ends: Vec<End>,
    },
    /// `rise * dot(q, axis) + run * len - radius`, where q = p - at and len is its distance from the axis.
    Cone {
        /// The ball at its foot.
        foot: Ball,
        /// Its direction, of length 1.
        axis: Vec3,
        /// What of its normal is along the axis, and what is across it.
        rise: f64,
        /// See there.
        run: f64,
        /// Where it ends.
        ends: Vec<End>,
    },
}

/// The parts of the hull of balls; of discs about places of the plane z = 0, if there are two `dimensions`. An error says why there are none.
pub fn parts(balls: &[Ball], dimensions: u8) -> Result<Vec<Part>, String> {
    if let Some(at) = balls.iter().position(|ball| ball.at.iter().chain([&ball.radius]).any(|c| !c.is_finite() || c.abs() > 1e15)) {
        return Err(format!("ball {at} is nowhere: a number of it is too large"));
    }
    let outer = outermost(balls);
    let most = if dimensions == 2 { MOST_DISCS } else { MOST_BALLS };
    if outer.len() > most {
        return Err(format!("there are {} balls and corners, and {most} are the most", outer.len()));
    }
    let Some(first) = outer.first() else { return Err("there is nothing".to_owned()) };
    let size = outer.iter().map(|ball| length(sub(ball.at, first.at)) + ball.radius).fold(first.radius, f64::max);
    let tiny = TINY * size;
    let mut parts = if dimensions == 2 { Vec::new() } else { planes(&outer, tiny) };
    // Which are joined by a part.
    let mut beside: Vec<Vec<usize>> = vec![Vec::new(); outer.len()];
    for (i, foot) in outer.iter().enumerate() {
        for (j, tip) in outer.iter().enumerate().skip(i + 1) {
            let joins = if dimensions == 2 { lines(&outer, (*foot, *tip), tiny) } else { cone(&outer, (*foot, *tip), tiny).into_iter().collect() };
            if !joins.is_empty() {
                beside.get_mut(i).into_iter().for_each(|of| of.push(j));
                beside.get_mut(j).into_iter().for_each(|of| of.push(i));
            }
            parts.extend(joins);
        }
    }
    let on_hull: Vec<usize> = beside.iter().enumerate().filter(|(_, of)| !of.is_empty()).map(|(i, _)| i).collect();
    for ((i, ball), others) in outer.iter().enumerate().zip(&beside) {
        if others.is_empty() && outer.len() > 1 {
            continue;
        }
        let radius = |k: &usize| outer.get(*k).map_or(0.0, |ball| ball.radius);
        // Where none beside it is smaller, its region is an intersection of caps of at most half a sphere, which is in one piece. Else it may be in several.
        let is_one_piece = others.iter().all(|k| radius(k) >= ball.radius);
        let limits = if is_one_piece { others } else { &on_hull };
        let ends = limits.iter().filter(|k| **k != i).filter_map(|k| outer.get(*k)).map(|other| {
            let way = sub(ball.at, other.at);
            End { way, by: ball.radius - other.radius + MARGIN * length(way) }
        });
        parts.push(Part::Ball { ball: *ball, ends: ends.collect() });
    }
    Ok(parts)
}

/// The lines that touch two discs of the plane from one side and have none beyond them.
fn lines(discs: &[Ball], (a, b): (Ball, Ball), tiny: f64) -> Vec<Part> {
    let way = sub(b.at, a.at);
    let Some(axis) = unit(way) else { return Vec::new() };
    let rise = (a.radius - b.radius) / length(way);
    let run = (1.0 - rise * rise).max(0.0).sqrt();
    let [x, y, _] = axis;
    let normals = [1.0, -1.0].map(|side| [rise * x - side * run * y, rise * y + side * run * x, 0.0]);
    let planes = normals.map(|normal| (normal, dot(normal, a.at) + a.radius));
    let is_outer = |(normal, height): &(Vec3, f64)| discs.iter().all(|disc| dot(*normal, disc.at) + disc.radius <= height + tiny);
    planes.into_iter().filter(is_outer).map(|(normal, height)| Part::Plane { normal, height }).collect()
}

/// Those that do not lie in another one.
fn outermost(balls: &[Ball]) -> Vec<Ball> {
    let mut outer: Vec<Ball> = Vec::new();
    let holds = |a: &Ball, b: &Ball| length(sub(a.at, b.at)) <= (a.radius - b.radius) * (1.0 + TINY);
    for ball in balls {
        if !outer.iter().any(|other| holds(other, ball)) {
            outer.retain(|other| !holds(ball, other));
            outer.push(*ball);
        }
    }
    outer
}

/// The planes that touch three balls and have none beyond them.
fn planes(balls: &[Ball], tiny: f64) -> Vec<Part> {
    let mut found: Vec<(Vec3, f64)> = Vec::new();
    for (i, a) in balls.iter().enumerate() {
        for (j, b) in balls.iter().enumerate().skip(i + 1) {
            for c in balls.iter().skip(j + 1) {
                for (normal, height) in touching([a, b, c], tiny).into_iter().flatten() {
                    let is_known = found.iter().any(|(n, h)| dot(*n, normal) > 1.0 - TINY && (h - height).abs() < 10.0 * tiny);
                    if !is_known && balls.iter().all(|ball| dot(normal, ball.at) + ball.radius <= height + tiny) {
                        found.push((normal, height));
                    }
                }
            }
        }
    }
    found.into_iter().map(|(normal, height)| Part::Plane { normal, height }).collect()
}

/// The two planes that touch three balls from one side, each by its normal and its height.
fn touching([a, b, c]: [&Ball; 3], tiny: f64) -> Option<[(Vec3, f64); 2]> {
    let (u, v) = (sub(b.at, a.at), sub(c.at, a.at));
    let across = cross(u, v);
    let area = length(across);
    if area <= tiny * length(u).max(length(v)) {
        return None;
    }
    // n · u and n · v are known, and n has length 1.
    let (along_u, along_v) = (a.radius - b.radius, a.radius - c.radius);
    let within = scale(cross(sub(scale(v, along_u), scale(u, along_v)), across), 1.0 / (area * area));
    let rest = 1.0 - dot(within, within);
    let up = scale(across, rest.max(0.0).sqrt() / area);
    let plane = |normal: Vec3| (normal, dot(normal, a.at) + a.radius);
    (rest >= 0.0).then(|| [plane(add(within, up)), plane(sub(within, up))])
}

/// The cone around two balls, if any part of it bounds the hull of all.
fn cone(balls: &[Ball], (foot, tip): (Ball, Ball), tiny: f64) -> Option<Part> {
    let way = sub(tip.at, foot.at);
    let far = length(way);
    let axis = unit(way)?;
    let rise = (foot.radius - tip.radius) / far;
    let run = (1.0 - rise * rise).max(0.0).sqrt();
    // Two directions across the axis, at right angles.
    let [x, y, z] = axis.map(f64::abs);
    let least = if x <= y.min(z) { [1.0, 0.0, 0.0] } else if y <= z { [0.0, 1.0, 0.0] } else { [0.0, 0.0, 1.0] };
    let first = unit(cross(axis, least))?;
    let second = cross(axis, first);
    // Along the circle of normals another ball reaches farther on an arc: its middle, and half its length.
    let mut hidden: Vec<(f64, f64, End)> = Vec::new();
    for other in balls.iter().filter(|other| **other != foot && **other != tip) {
        let off = sub(foot.at, other.at);
        let across = sub(off, scale(axis, dot(off, axis)));
        let by = rise * dot(off, axis) + foot.radius - other.radius;
        let reach = run * length(across);
        if reach <= tiny {
            if by < -tiny {
                return None;
            }
            continue;
        }
        let least = -by / reach;
        if least > 1.0 {
            return None;
        }
        if least > -1.0 {
            let middle = dot(across, second).atan2(dot(across, first)) + PI;
            hidden.push((middle, PI - least.acos(), End { way: scale(across, run), by: by + MARGIN * reach }));
        }
    }
    let holds = |a: &(f64, f64, End), b: &(f64, f64, End)| apart(a.0, b.0) + b.1 <= a.1 + TINY;
    let mut kept: Vec<(f64, f64, End)> = Vec::new();
    for arc in hidden {
        if !kept.iter().any(|other| holds(other, &arc)) {
            kept.retain(|other| !holds(&arc, other));
            kept.push(arc);
        }
    }
    is_seen(&kept).then(|| Part::Cone { foot, axis, rise, run, ends: kept.into_iter().map(|(.., end)| end).collect() })
}

/// How far two angles are apart.
fn apart(a: f64, b: f64) -> f64 {
    let turn = (a - b).rem_euclid(TAU);
    turn.min(TAU - turn)
}

/// Whether arcs leave some of the circle, more than rounding makes.
fn is_seen(arcs: &[(f64, f64, End)]) -> bool {
    const LEAST: f64 = 1e-7;
    // Whatever is left begins where an arc ends.
    let is_left = |angle: f64| arcs.iter().all(|(middle, half, _)| apart(angle, *middle) > half + LEAST);
    arcs.is_empty() || arcs.iter().any(|(middle, half, _)| is_left(middle + half + 2.0 * LEAST))
}
