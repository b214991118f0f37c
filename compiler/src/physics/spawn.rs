//! Where balls begin: in the cells of a box, shaken by chance, so that none begins within another while there is room.

use super::{Ball, Group};
use crate::vector::Vec3;

/// Cells of a box for balls up to some radius, along each axis.
fn cells(low: Vec3, high: Vec3, radius: f64) -> [f64; 3] {
    // A hair of room between neighbours.
    let side = 2.02 * radius;
    [0, 1, 2].map(|i: usize| {
        let size = high.get(i).zip(low.get(i)).map_or(0.0, |(h, l)| h - l);
        (size / side).floor().clamp(1.0, 1e6)
    })
}

/// How many balls up to some radius find room in a box of centres and their surroundings.
pub fn room(low: Vec3, high: Vec3, radius: f64) -> f64 {
    cells(low, high, radius).iter().product()
}

/// Three whole numbers to a number in 0..1 (Jarzynski and Olano, "Hash Functions for GPU Rendering", 2020: pcg3d).
fn chance(a: u32, b: u32, c: u32) -> f64 {
    let step = |v: u32| v.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
    let (mut x, mut y, mut z) = (step(a), step(b), step(c));
    for round in 0..2 {
        x = x.wrapping_add(y.wrapping_mul(z));
        y = y.wrapping_add(z.wrapping_mul(x));
        z = z.wrapping_add(x.wrapping_mul(y));
        if round == 0 {
            (x, y, z) = (x ^ (x >> 16), y ^ (y >> 16), z ^ (z >> 16));
        }
    }
    f64::from(x >> 8) / 16_777_216.0
}

/// The balls of the groups at the start. Each number is one that 32 bits hold.
pub fn spawn(groups: &[Group]) -> Vec<Ball> {
    groups.iter().enumerate().flat_map(|(index, group)| of_group(index as u32, group)).collect()
}

fn of_group(index: u32, group: &Group) -> Vec<Ball> {
    let [low, high] = group.spawn;
    let [least, most] = group.radius;
    let counts = cells(low, high, most);
    let room: f64 = counts.iter().product();
    let narrow = |v: f64| f64::from(v as f32);
    let ball = |i: u32| {
        let chance = |what| chance(i, group.seed, what);
        let radius = narrow(least + (most - least) * chance(0)).max(f64::from(f32::MIN_POSITIVE));
        // Spread over the whole box; what has no room begins anywhere.
        let crowded = f64::from(group.count) > room;
        // One of the cells that are this ball's alone.
        let share = |i: f64| (i * room / f64::from(group.count)).ceil();
        let (first, end) = (share(f64::from(i)), share(f64::from(i) + 1.0));
        let mut cell = first + (chance(4) * (end - first)).floor();
        let mut position = [0.0; 3];
        let order: [usize; 3] = [0, 2, 1];
        for axis in order {
            let at = |v: &Vec3| v.get(axis).copied().unwrap_or(0.0);
            let count = counts.get(axis).copied().unwrap_or(1.0);
            let size = at(&high) - at(&low);
            let slack = (size / count - 2.02 * radius).max(0.0);
            let shake = chance(1 + axis as u32);
            let along = if crowded {
                size * shake
            } else {
                let place = cell % count;
                cell = (cell / count).floor();
                (place + 0.5) * size / count + (shake - 0.5) * slack
            };
            if let Some(slot) = position.get_mut(axis) {
                *slot = narrow(at(&low) + along);
            }
        }
        Ball { velocity: group.velocity.map(narrow), group: index, anchor: position, ..Ball::at(position, radius) }
    };
    (0..group.count).map(ball).collect()
}
