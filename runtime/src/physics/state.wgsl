// Balls and the numbers of a step: what every pass over balls shares. The step's twin in 64 bits is compiler/src/physics.

struct Ball {
    p: vec3f,
    r: f32,
    v: vec3f,
    // Its group in the lower 16 bits, and what it does.
    word: u32,
    spin: vec3f,
    // Since when it has kept its place, in seconds.
    quiet: f32,
    anchor: vec3f,
    // How many balls touch it; of one that sleeps, how many did when it fell asleep.
    touching: u32,
}

const ASLEEP: u32 = 0x10000u;
const GONE: u32 = 0x20000u;
const GROUNDED: u32 = 0x40000u;

struct Step {
    gravity: vec3f,
    // Seconds of a part of the step.
    h: f32,
    low: vec3f,
    restitution: f32,
    high: vec3f,
    friction: f32,
    rolling: f32,
    // The speed across a surface below which a ball does not bounce.
    rest: f32,
    // Radius about the origin beyond which a ball is gone.
    extent: f32,
    // Side of the grid's cells.
    side: f32,
    count: u32,
    // Number of the grid's buckets, less one.
    mask: u32,
    // 1: the box from `low` to `high` has walls.
    walls: u32,
    // 1: the field is not as it was before this step; 2: it is another field, and every ball wakes.
    moves: u32,
}

@group(1) @binding(0) var<uniform> law: Step;
@group(1) @binding(1) var<storage, read> source: array<Ball>;
@group(1) @binding(2) var<storage, read_write> goal: array<Ball>;

fn wake(ball: Ball) -> Ball {
    var b = ball;
    b.word &= ~ASLEEP;
    b.quiet = 0.0;
    b.anchor = b.p;
    return b;
}
