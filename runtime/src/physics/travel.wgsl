// One ball for a part of a step: flight, bounces, rolling, rest. Stands after an emitted module, whose functions it calls.

const LOOKS: u32 = 48u;
const SETTLES: u32 = 4u;
const IMPROVEMENTS: u32 = 10u;
// How fast a ball that is held goes where the hand is, in parts of the way a second.
const PULL: f32 = 16.0;

// The law's; a ball that is held does not bounce.
var<private> restitution: f32;
// A way to the centre that leans by no more than this is upright.
const UPRIGHT: f32 = 0.01;

// The nearest point of the surface, seen from a centre.
struct Touch {
    normal: vec3f,
    distance: f32,
}

// From the estimate at the centre down to the surface by Newton's steps, then along it to where the way to the centre stands upright on
// it. Where it never does, as at an edge, the nearest point that was on the surface is the answer; where none was, the estimate.
fn touch(center: vec3f, r: f32) -> Touch {
    let estimate = sf_distance(center);
    let tolerance = max(5e-5 * r, 4e-7 * (length(center) + 1.0));
    var side = 1.0;
    // From the surface's point to the centre.
    var way = vec3f(0.0);
    var best = Touch(vec3f(0.0, 1.0, 0.0), estimate);
    var least = 1e30;
    var origin = vec3f(0.0);
    var across = vec3f(0.0);
    var stride = 1.0;
    for (var turn = 0u; turn <= IMPROVEMENTS; turn++) {
        let slope = sf_gradient(center - way);
        let steepness = length(slope.xyz);
        var normal = vec3f(0.0, 1.0, 0.0);
        if steepness >= 1e-12 {
            normal = slope.xyz / steepness;
        }
        if turn == 0u {
            side = select(1.0, -1.0, slope.w < 0.0);
            way = normal * estimate;
            best.normal = normal;
            continue;
        }
        if steepness < 1e-12 {
            break;
        }
        let rest = slope.w / steepness;
        if abs(rest) > tolerance {
            way += normal * rest;
            continue;
        }
        let far = length(way);
        let height = dot(way, normal);
        let aside = way - normal * height;
        if length(aside) <= UPRIGHT * far {
            return Touch(normal, height);
        }
        if far < least {
            best = Touch(normal, side * far);
            if far > 1e-3 * r {
                best.normal = way * (side / far);
            }
            least = far;
            origin = way;
            across = aside;
        } else {
            // Too far, past an edge: a shorter step from the nearest point.
            stride *= 0.4;
        }
        way = origin - stride * across;
    }
    return best;
}

// How far a ball is put back out of the solid: wholly where its centre is outside, else a half of its radius at a time.
fn out(found: Touch, r: f32) -> f32 {
    let depth = r - found.distance;
    if found.distance > 0.0 {
        return max(depth, 0.0);
    }
    return min(depth, 0.5 * r);
}

// Friction and the resistance to rolling under an impulse `press` (for each unit of mass) along the normal, on a surface that has a velocity.
fn rub(ball: Ball, n: vec3f, press: f32, surface: vec3f) -> Ball {
    var b = ball;
    if press <= 0.0 {
        return b;
    }
    // The speed with which the ball's lowest point slides.
    let relative = b.v - surface;
    let slide = relative - n * dot(relative, n) - cross(b.spin, n) * b.r;
    let speed = length(slide);
    if speed > 1e-9 {
        // A solid ball: 2/7 of the slide's speed as an impulse ends it.
        let impulse = min(law.friction * press, 2.0 / 7.0 * speed);
        let way = slide / speed;
        b.v -= impulse * way;
        b.spin += 2.5 * impulse / b.r * cross(n, way);
    }
    let turn = length(b.spin);
    if turn > 0.0 {
        let brake = 2.5 * law.rolling * press / b.r;
        b.spin *= max(1.0 - brake / turn, 0.0);
    }
    return b;
}

fn fly(ball: Ball, dt: f32) -> Ball {
    var b = ball;
    b.p += b.v * dt + law.gravity * (0.5 * dt * dt);
    b.v += law.gravity * dt;
    return b;
}

// Puts a ball that moved into a surface back by `depth`, and lets it bounce with the speed that it had on the surface: what gravity gave it
// below is taken again, else it would rise higher than it fell from.
fn put_back(ball: Ball, n: vec3f, depth: f32, surface: vec3f) -> Ball {
    var b = ball;
    b.p += n * depth;
    let across = dot(b.v - surface, n);
    if across >= 0.0 {
        return b;
    }
    let hit = sqrt(max(across * across + 2.0 * dot(law.gravity, n) * depth, 0.0));
    let bounce = select(0.0, restitution, hit > law.rest);
    let press = bounce * hit - across;
    b.v += n * press;
    return rub(b, n, press, surface);
}

// Looks along the way until the time is up. No piece of it is longer than what the bound allows the centre, so nothing is passed. At the
// end the ball is put back out of the surface that it moved into; in a groove it has two to leave.
fn go(ball: Ball) -> Ball {
    var b = ball;
    var left = law.h;
    var settled = 0u;
    let g = law.gravity;
    for (var look = 0u; look < LOOKS + SETTLES; look++) {
        let near = max(2e-4 * b.r, 1e-6 * (length(b.p) + 1.0));
        let free = sf_bound(b.p);
        let ends = left <= 0.0;
        if ends && (free >= b.r || settled == SETTLES) {
            break;
        }
        let speed = length(b.v) + length(g) * left + 1e-12;
        if !ends && free >= b.r + near {
            let dt = min(left, (free - b.r) / speed);
            b = fly(b, dt);
            left -= dt;
            continue;
        }
        let found = touch(b.p, b.r);
        let gap = found.distance - b.r;
        if ends && gap >= 0.0 {
            break;
        }
        if gap > near {
            // The bound sees less than there is.
            let reach = max(min(0.9 * gap, 0.9 * free), 0.5 * near);
            let dt = min(left, reach / speed);
            b = fly(b, dt);
            left -= dt;
            continue;
        }
        b.word |= GROUNDED;
        let n = found.normal;
        let surface = surface_velocity(b.p - n * found.distance, n, b.r);
        let push = dot(surface, n);
        let depth = out(found, b.r);
        let across = dot(b.v, n) - push;
        // At the end it bounces too: in a corner the next part may find the other surface first each time, and the speed into this one would
        // grow while the ball lies still.
        if ends || across < -law.rest {
            settled += u32(ends);
            b = put_back(b, n, depth, surface);
            continue;
        }
        b.p += n * depth;
        var reach = max(0.5 * free, 0.5 * near);
        if found.distance <= 0.0 {
            reach = 0.25 * b.r;
        }
        let dt = min(left, reach / speed);
        left -= dt;
        if across > 1e-3 * law.rest {
            b = fly(b, dt);
            continue;
        }
        // It lies on the surface: what presses it there is taken up, and it moves along.
        b.v -= n * across;
        let pull = min(dot(g, n), 0.0);
        let before = b.v;
        b.v += (g - n * pull) * dt;
        b = rub(b, n, max(-across, 0.0) - pull * dt, surface);
        // The surface is where it will be at the step's end already.
        b.p += (0.5 * (before + b.v) - n * push) * dt;
    }
    return b;
}

// Keeps a ball within a wall through `end` whose inner side is `n`.
fn wall(ball: Ball, n: vec3f, end: vec3f) -> Ball {
    var b = ball;
    let depth = b.r - dot(b.p - end, n);
    if depth <= 0.0 {
        return b;
    }
    b.word |= GROUNDED;
    return put_back(b, n, depth, vec3f(0.0));
}

// Lets a ball that has long kept its place sleep.
fn rest(ball: Ball) -> Ball {
    var b = ball;
    let idle = distance(b.p, b.anchor) <= 0.02 * b.r && length(b.spin) <= 4.0;
    if !idle || ((b.word & GROUNDED) == 0u && b.touching == 0u) {
        b.anchor = b.p;
        b.quiet = 0.0;
        return b;
    }
    b.quiet += law.h;
    if b.quiet > 0.5 {
        b.word |= ASLEEP;
        b.v = vec3f(0.0);
        b.spin = vec3f(0.0);
    }
    return b;
}

@compute @workgroup_size(64)
fn travel(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= law.count {
        return;
    }
    begin();
    var b = source[id.x];
    if (b.word & GONE) != 0u {
        goal[id.x] = b;
        return;
    }
    restitution = law.restitution;
    if id.x == law.held {
        restitution = 0.0;
        b = wake(b);
        b.v = (law.place - b.p) * PULL;
        b.spin = vec3f(0.0);
    }
    if (b.word & ASLEEP) != 0u {
        if stays(b) {
            goal[id.x] = b;
            return;
        }
        b = wake(b);
    }
    b.word &= ~GROUNDED;
    b = go(b);
    if law.walls != 0u {
        b = wall(b, vec3f(1.0, 0.0, 0.0), law.low);
        b = wall(b, vec3f(0.0, 1.0, 0.0), law.low);
        b = wall(b, vec3f(0.0, 0.0, 1.0), law.low);
        b = wall(b, vec3f(-1.0, 0.0, 0.0), law.high);
        b = wall(b, vec3f(0.0, -1.0, 0.0), law.high);
        b = wall(b, vec3f(0.0, 0.0, -1.0), law.high);
    }
    // A number that is none is not less than anything.
    let here = length(b.p) <= law.extent + b.r;
    if here {
        b = rest(b);
    } else {
        b.word |= GONE;
        b.v = vec3f(0.0);
        b.spin = vec3f(0.0);
    }
    goal[id.x] = b;
}
