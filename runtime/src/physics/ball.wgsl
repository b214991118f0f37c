// A ball, as every pass over balls and the picture see it.

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

