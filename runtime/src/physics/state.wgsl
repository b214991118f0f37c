// The numbers of a step, and the balls before and after a pass. The step's twin in 64 bits is compiler/src/physics.

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
    // How the field came to be as it is: one of the four below.
    moves: u32,
    // Where a hand pulls a ball to, and which one; more than there are: none.
    place: vec3f,
    held: u32,
}

// It is as it was before this step.
const STILL = 0u;
// A hand has changed it: what goes far has jumped.
const BY_HAND = 1u;
// It is another field, and every ball wakes.
const ANOTHER = 2u;
// Time alone has changed it: what goes far is on its way.
const BY_TIME = 3u;

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
