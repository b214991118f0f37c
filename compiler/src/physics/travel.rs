//! One ball for a part of a step: flight, bounces, rolling, rest.

use super::ground::near;
use super::{Ball, Ground, LOOKS, Law, PATIENCE, PLACE, SETTLES, State, Touch};
use crate::vector::{Vec3, add, along, cross, dot, length, scale, sub};

/// A wall that a hand puts elsewhere, by a slider or another text, moves where it goes no farther in one part of a step than this part of the
/// radius of a ball; farther, it jumps.
const JUMP: f64 = 0.5;
/// The same of a wall that time alone moves: that is on its way.
const JUMP_OF_TIME: f64 = 4.0;
/// A ball that turns faster than this does not sleep, in radians a second.
const IDLE: f64 = 4.0;

/// How fast a ball that is held goes where the hand is, in parts of the way a second.
const PULL: f64 = 16.0;

/// Moves a ball that the others have pushed, for `h` seconds.
pub fn travel(ball: &mut Ball, law: &Law, ground: &impl Ground, h: f64) {
    match ball.state {
        State::Gone => return,
        State::Asleep if stays(ball, ground) => return,
        State::Asleep => wake(ball),
        State::Awake => {}
    }
    ball.grounded = false;
    go(ball, law, ground, h);
    walls(ball, law, h);
    let far = length(ball.position);
    // A number that is none is not less than anything.
    let here = far <= law.extent + ball.radius;
    if !here {
        ball.state = State::Gone;
        ball.velocity = [0.0; 3];
        ball.spin = [0.0; 3];
        return;
    }
    rest(ball, h);
}

/// Moves a ball that a hand holds towards a place: by and by, and what stands in the way stops it.
pub fn pull(ball: &mut Ball, place: Vec3) {
    wake(ball);
    ball.velocity = scale(sub(place, ball.position), PULL);
    ball.spin = [0.0; 3];
}

/// Wakes a ball.
pub fn wake(ball: &mut Ball) {
    ball.state = State::Awake;
    ball.quiet = 0.0;
    ball.anchor = ball.position;
}

/// Whether a ball that sleeps goes on: nothing near it moves.
fn stays(ball: &Ball, ground: &impl Ground) -> bool {
    let Some(before) = ground.before(ball.position) else { return true };
    let now = ground.distance(ball.position);
    let still = 1e-5 * ball.radius;
    now.min(before) > 1.1 * ball.radius || (now - before).abs() <= still && length(ground.carried(ball.position)) <= still
}

/// The velocity of the surface, where it moves; what jumps does not push.
fn surface_velocity(ball: &Ball, touch: &Touch, ground: &impl Ground, h: f64) -> Vec3 {
    let n = touch.normal;
    let foot = sub(ball.position, scale(n, touch.distance));
    let most = ball.radius * if ground.is_moved_by_time() { JUMP_OF_TIME } else { JUMP };
    let short = |way: f64| if way.abs() > most { 0.0 } else { way };
    let moved = ground.before(foot).map_or(0.0, short);
    let carried = ground.carried(foot);
    let aside = sub(carried, scale(n, dot(carried, n)));
    let aside = if short(length(aside)) == 0.0 { [0.0; 3] } else { aside };
    scale(add(aside, scale(n, moved)), 1.0 / h)
}

/// How far a ball is put back out of the solid: wholly where its centre is outside, else a half of its radius at a time.
fn out(touch: &Touch, radius: f64) -> f64 {
    let depth = radius - touch.distance;
    if touch.distance > 0.0 { depth.max(0.0) } else { depth.min(0.5 * radius) }
}

/// Friction and the resistance to rolling under an impulse `press` (for each unit of mass) along the normal, on a surface that has a velocity.
pub fn rub(ball: &mut Ball, law: &Law, normal: Vec3, press: f64, surface: Vec3) {
    if press <= 0.0 {
        return;
    }
    let r = ball.radius;
    // The speed with which the ball's lowest point slides.
    let relative = sub(ball.velocity, surface);
    let along_surface = sub(relative, scale(normal, dot(relative, normal)));
    let slide = sub(along_surface, scale(cross(ball.spin, normal), r));
    let speed = length(slide);
    if speed > 1e-12 {
        // A solid ball: 2/7 of the slide's speed as an impulse ends it.
        let impulse = (law.friction * press).min(2.0 / 7.0 * speed);
        let way = scale(slide, 1.0 / speed);
        ball.velocity = along(ball.velocity, way, -impulse);
        ball.spin = along(ball.spin, cross(normal, way), 2.5 * impulse / r);
    }
    let turn = length(ball.spin);
    if turn > 0.0 {
        let brake = 2.5 * law.rolling * press / r;
        ball.spin = scale(ball.spin, (1.0 - brake / turn).max(0.0));
    }
}

/// Puts a ball that moved into a surface back by `depth`, and lets it bounce with the speed that it had on the surface: what gravity gave it
/// below is taken again, else it would rise higher than it fell from.
fn put_back(ball: &mut Ball, law: &Law, normal: Vec3, depth: f64, surface: Vec3, rest: f64) {
    ball.position = along(ball.position, normal, depth);
    let across = dot(sub(ball.velocity, surface), normal);
    if across >= 0.0 {
        return;
    }
    let hit = (across * across + 2.0 * dot(law.gravity, normal) * depth).max(0.0).sqrt();
    let bounce = if hit > rest { law.restitution } else { 0.0 };
    let press = bounce * hit - across;
    ball.velocity = along(ball.velocity, normal, press);
    rub(ball, law, normal, press, surface);
}

/// Looks along the way until the time is up. No piece of it is longer than what the bound allows the centre, so nothing is passed. At
/// the end the ball is put back out of the surface that it moved into; in a groove it has two to leave.
fn go(ball: &mut Ball, law: &Law, ground: &impl Ground, h: f64) {
    let g = law.gravity;
    let rest = law.rest(h);
    let mut left = h;
    let mut settled = 0;
    for _ in 0..LOOKS + SETTLES {
        let near = near(ball.position, ball.radius);
        let free = ground.free(ball.position);
        let ends = left <= 0.0;
        if ends && (free >= ball.radius || settled == SETTLES) {
            return;
        }
        let speed = length(ball.velocity) + length(g) * left + 1e-12;
        if !ends && free >= ball.radius + near {
            let dt = left.min((free - ball.radius) / speed);
            fly(ball, g, dt);
            left -= dt;
            continue;
        }
        let touch = ground.touch(ball.position, ball.radius);
        let gap = touch.distance - ball.radius;
        if ends && gap >= 0.0 {
            return;
        }
        if gap > near {
            // The bound sees less than there is.
            let reach = (0.9 * gap).min(0.9 * free).max(0.5 * near);
            let dt = left.min(reach / speed);
            fly(ball, g, dt);
            left -= dt;
            continue;
        }
        ball.grounded = true;
        let n = touch.normal;
        let surface = surface_velocity(ball, &touch, ground, h);
        let push = dot(surface, n);
        let depth = out(&touch, ball.radius);
        let across = dot(ball.velocity, n) - push;
        // At the end it bounces too: in a corner the next part may find the other surface first each time, and the speed into this one would
        // grow while the ball lies still.
        if ends || across < -rest {
            settled += u32::from(ends);
            put_back(ball, law, n, depth, surface, rest);
            continue;
        }
        ball.position = along(ball.position, n, depth);
        let inside = touch.distance <= 0.0;
        let reach = if inside { 0.25 * ball.radius } else { (0.5 * free).max(0.5 * near) };
        let dt = left.min(reach / speed);
        left -= dt;
        if across > 1e-3 * rest {
            fly(ball, g, dt);
            continue;
        }
        // It lies on the surface: what presses it there is taken up, and it moves along.
        ball.velocity = along(ball.velocity, n, -across);
        let pull = dot(g, n).min(0.0);
        let before = ball.velocity;
        ball.velocity = along(ball.velocity, sub(g, scale(n, pull)), dt);
        rub(ball, law, n, (-across).max(0.0) - pull * dt, surface);
        let mean = scale(add(before, ball.velocity), 0.5);
        // The surface is where it will be at the step's end already.
        ball.position = along(ball.position, sub(mean, scale(n, push)), dt);
    }
}

fn fly(ball: &mut Ball, g: Vec3, dt: f64) {
    ball.position = along(along(ball.position, ball.velocity, dt), g, 0.5 * dt * dt);
    ball.velocity = along(ball.velocity, g, dt);
}

/// Keeps a ball within the walls.
fn walls(ball: &mut Ball, law: &Law, h: f64) {
    let Some([low, high]) = law.walls else { return };
    for (normal, end) in [([1.0, 0.0, 0.0], low), ([0.0, 1.0, 0.0], low), ([0.0, 0.0, 1.0], low)]
        .into_iter()
        .chain([([-1.0, 0.0, 0.0], high), ([0.0, -1.0, 0.0], high), ([0.0, 0.0, -1.0], high)])
    {
        let depth = ball.radius - dot(sub(ball.position, end), normal);
        if depth <= 0.0 {
            continue;
        }
        ball.grounded = true;
        put_back(ball, law, normal, depth, [0.0; 3], law.rest(h));
    }
}

/// Lets a ball that has long kept its place sleep.
fn rest(ball: &mut Ball, h: f64) {
    let moved = length(sub(ball.position, ball.anchor));
    let idle = moved <= PLACE * ball.radius && length(ball.spin) <= IDLE;
    if !idle || !(ball.grounded || ball.touching > 0) {
        ball.anchor = ball.position;
        ball.quiet = 0.0;
        return;
    }
    ball.quiet += h;
    if ball.quiet > PATIENCE {
        ball.state = State::Asleep;
        ball.velocity = [0.0; 3];
        ball.spin = [0.0; 3];
    }
}
