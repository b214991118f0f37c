//! Balls among each other: who is near whom, and what they do to each other. Each ball gathers what its neighbours do to it, from the same
//! numbers as they; so what one gives is what the other takes.

use super::travel::wake;
use super::{Ball, Law, NEAR_BALLS, NEIGHBOURS, State};
use crate::vector::{Vec3, add, along, cross, dot, length, scale, sub};
use rustc_hash::FxHashMap;

/// A ball with so many neighbours lies in a heap.
const HEAP: usize = 3;

/// Side of the grid's cells for balls up to some radius.
pub fn cell_side(most: f64) -> f64 {
    2.0 * NEAR_BALLS * most
}

/// The neighbours of each ball, at most [`NEIGHBOURS`], cell after cell and in each by their indices. A ball that sleeps wakes where one of
/// them has left.
pub fn neighbours(balls: &mut [Ball]) -> Vec<Vec<usize>> {
    let most = balls.iter().map(|b| b.radius).fold(0.0, f64::max).max(1e-9);
    let side = cell_side(most);
    let cell = |p: Vec3| p.map(|c| (c / side).floor() as i64);
    let mut cells: FxHashMap<[i64; 3], Vec<usize>> = FxHashMap::default();
    for (i, ball) in balls.iter().enumerate().filter(|(_, b)| b.state != State::Gone) {
        cells.entry(cell(ball.position)).or_default().push(i);
    }
    let lists: Vec<Vec<usize>> = balls
        .iter()
        .enumerate()
        .map(|(i, ball)| {
            let mut list = Vec::new();
            if ball.state == State::Gone {
                return list;
            }
            let [x, y, z] = cell(ball.position);
            for at in 0..27 {
                let place = [x + at % 3 - 1, y + at / 3 % 3 - 1, z + at / 9 - 1];
                for &other in cells.get(&place).into_iter().flatten().filter(|o| **o != i) {
                    let Some(b) = balls.get(other) else { continue };
                    let near = NEAR_BALLS * (ball.radius + b.radius);
                    if length(sub(b.position, ball.position)) < near && list.len() < NEIGHBOURS {
                        list.push(other);
                    }
                }
            }
            list
        })
        .collect();
    for (ball, list) in balls.iter_mut().zip(&lists) {
        let count = list.len() as u32;
        match ball.state {
            State::Asleep if count >= ball.touching => continue,
            State::Asleep => wake(ball),
            _ => {}
        }
        ball.touching = count;
    }
    lists
}

/// One meeting of all balls with their neighbours. `arrivals` are the velocities that they had before the first one: two part with the speed
/// that the law leaves of that with which they came, through however many meetings it takes (Newton's law of impact, for all at once).
pub fn meet(balls: &[Ball], lists: &[Vec<usize>], arrivals: &[Vec3], law: &Law, h: f64) -> Vec<Ball> {
    (0..balls.len()).filter_map(|index| gather(index, lists.get(index)?, balls, arrivals, law, h)).collect()
}

/// From the first to the second of two balls that are in one place, one way for each pair.
fn one_way(first: usize, second: usize) -> Vec3 {
    let turn = 2.4 * ((first + second) % 1024) as f64;
    let side = if first < second { 1.0 } else { -1.0 };
    scale([0.8 * turn.cos(), 0.6, 0.8 * turn.sin()], side)
}

fn gather(index: usize, list: &[usize], balls: &[Ball], arrivals: &[Vec3], law: &Law, h: f64) -> Option<Ball> {
    let (ball, arrival) = (balls.get(index)?, *arrivals.get(index)?);
    let mut met = *ball;
    let mut push = [0.0; 3];
    let rest = law.rest(h);
    let sleeps = ball.state == State::Asleep;
    let mut bounces = false;
    for (at, other, came) in list.iter().filter_map(|i| Some((*i, balls.get(*i)?, arrivals.get(*i)?))) {
        let apart = sub(other.position, ball.position);
        let far = length(apart);
        let overlap = ball.radius + other.radius - far;
        if overlap <= 0.0 || sleeps && other.state == State::Asleep {
            continue;
        }
        let n = if far > 1e-9 { scale(apart, 1.0 / far) } else { one_way(index, at) };
        let relative = sub(other.velocity, ball.velocity);
        let across = dot(relative, n);
        let hit = across < -2.0 * rest;
        if sleeps && !hit {
            continue;
        }
        if sleeps {
            wake(&mut met);
        }
        // What sleeps and is not hit is as good as a wall.
        let wall = other.state == State::Asleep && !hit;
        let share = if wall { 1.0 } else { other.mass() / (ball.mass() + other.mass()) };
        let crowd = f64::from(ball.touching.max(other.touching).max(1));
        let gain = share / (1.0 + 0.5 * (crowd - 1.0));
        push = along(push, n, -gain * overlap);
        let came = -dot(sub(*came, arrival), n);
        let leaves = if came > rest { law.restitution * came } else { 0.0 };
        bounces |= leaves > 0.0;
        if across >= leaves {
            continue;
        }
        let press = leaves - across;
        met.velocity = along(met.velocity, n, -gain * press);
        let turning = add(scale(ball.spin, ball.radius), scale(other.spin, other.radius));
        let slide = sub(sub(relative, scale(n, across)), cross(turning, n));
        let speed = length(slide);
        if speed > 1e-12 {
            let way = scale(slide, 1.0 / speed);
            let impulse = gain * (law.friction * press).min(2.0 / 7.0 * speed);
            met.velocity = along(met.velocity, way, impulse);
            met.spin = along(met.spin, cross(n, way), 2.5 * impulse / ball.radius);
        }
    }
    // The centre stays on its side of the surface: what is pushed here is less than what the field puts back.
    let far = length(push);
    let most = 0.05 * ball.radius;
    let way = far.min(most);
    if way > 0.0 {
        let out = scale(push, 1.0 / far);
        met.position = along(met.position, out, way);
        // In a heap what is pushed back stops, if it does not bounce: the blows of so many do not reach through it within a step.
        if list.len() >= HEAP && !bounces {
            met.velocity = along(met.velocity, out, (-dot(met.velocity, out)).clamp(0.0, way / h));
        }
    }
    Some(met)
}
