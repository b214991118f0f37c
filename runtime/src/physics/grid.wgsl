// Who is near whom: balls counted into the buckets of a grid (a counting sort), and each ball's neighbours looked up in it. Atomics decide
// only where in its bucket a ball stands first; then each bucket is put in order, so nothing depends on chance.

@group(1) @binding(3) var<storage, read_write> counts: array<atomic<u32>>;
@group(1) @binding(4) var<storage, read_write> sums: array<u32>;
@group(1) @binding(5) var<storage, read_write> order: array<u32>;
// 24 neighbours of each ball, then how many of them there are, then the three components of the velocity with which each ball came.
@group(1) @binding(6) var<storage, read_write> lists: array<u32>;

const NEIGHBOURS: u32 = 24u;
// A ball with so many neighbours lies in a heap.
const HEAP: u32 = 3u;

fn cell_of(p: vec3f) -> vec3i {
    return vec3i(clamp(floor(p / law.side), vec3f(-1e9), vec3f(1e9)));
}

// Cells of a block of 4×4×4 have their buckets side by side, so that what is near lies near in memory; a block's are anywhere. pcg3d: Jarzynski
// and Olano, "Hash Functions for GPU Rendering" (2020).
fn bucket_of(cell: vec3i) -> u32 {
    var v = bitcast<vec3u>(cell >> vec3u(2u)) * 1664525u + 1013904223u;
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    v ^= v >> vec3u(16u);
    v.x += v.y * v.z;
    v.y += v.z * v.x;
    v.z += v.x * v.y;
    let within = bitcast<vec3u>(cell & vec3i(3));
    return ((v.x << 6u) | within.x | (within.y << 2u) | (within.z << 4u)) & law.mask;
}

// The bucket of a ball; one that is gone is in any, and nobody's neighbour.
fn home_of(index: u32) -> u32 {
    if (source[index].word & GONE) != 0u {
        return (index * 2654435769u) & law.mask;
    }
    return bucket_of(cell_of(source[index].p));
}

@compute @workgroup_size(64)
fn count(@builtin(global_invocation_id) id: vec3u) {
    if id.x < law.count {
        atomicAdd(&counts[home_of(id.x)], 1u);
    }
}

var<workgroup> shared_sums: array<u32, 256>;

// The sum of the values of this thread and of those before it in its workgroup.
fn sum_up(value: u32, local: u32) -> u32 {
    shared_sums[local] = value;
    workgroupBarrier();
    for (var reach = 1u; reach < 256u; reach *= 2u) {
        var more = 0u;
        if local >= reach {
            more = shared_sums[local - reach];
        }
        workgroupBarrier();
        shared_sums[local] += more;
        workgroupBarrier();
    }
    return shared_sums[local];
}

// Each bucket's start within its block of 256, and each block's sum.
@compute @workgroup_size(256)
fn scan_blocks(@builtin(global_invocation_id) id: vec3u, @builtin(local_invocation_index) local: u32, @builtin(workgroup_id) block: vec3u) {
    let value = atomicLoad(&counts[id.x]);
    let total = sum_up(value, local);
    atomicStore(&counts[id.x], total - value);
    if local == 255u {
        sums[block.x] = total;
    }
}

// Each block's start.
@compute @workgroup_size(256)
fn scan_sums(@builtin(local_invocation_index) local: u32) {
    let blocks = (law.mask + 1u) / 256u;
    var before = 0u;
    for (var first = 0u; first < blocks; first += 256u) {
        let at = first + local;
        var value = 0u;
        if at < blocks {
            value = sums[at];
        }
        let total = sum_up(value, local);
        if at < blocks {
            sums[at] = before + total - value;
        }
        before += shared_sums[255];
        workgroupBarrier();
    }
}

// Each ball into its bucket. After this `counts` holds the ends of the buckets.
@compute @workgroup_size(64)
fn scatter(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= law.count {
        return;
    }
    let bucket = home_of(id.x);
    let place = atomicAdd(&counts[bucket], 1u) + sums[bucket / 256u];
    order[place] = id.x;
}

fn end_of(bucket: u32) -> u32 {
    return atomicLoad(&counts[bucket]) + sums[bucket / 256u];
}

fn start_of(bucket: u32) -> u32 {
    if bucket == 0u {
        return 0u;
    }
    return end_of(bucket - 1u);
}

// Each bucket in the order of the balls' indices (Shell 1959, with the gaps of Ciura 2001).
@compute @workgroup_size(64)
fn put_in_order(@builtin(global_invocation_id) id: vec3u) {
    if id.x > law.mask {
        return;
    }
    let start = start_of(id.x);
    let end = end_of(id.x);
    var gaps = array<u32, 8>(1u, 4u, 10u, 23u, 57u, 132u, 301u, 701u);
    for (var turn = 0u; turn < 8u; turn++) {
        let gap = gaps[7u - turn];
        for (var i = start + gap; i < end; i++) {
            let ball = order[i];
            var place = i;
            for (var back = i; back >= start + gap; back -= gap) {
                let other = order[back - gap];
                if other <= ball {
                    break;
                }
                order[back] = other;
                place = back - gap;
            }
            order[place] = ball;
        }
    }
}

// From here on balls are worked on in the order of their buckets: threads side by side ask for the same neighbours.
@compute @workgroup_size(64)
fn neighbours(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= law.count {
        return;
    }
    let index = order[id.x];
    let ball = source[index];
    var found = 0u;
    if (ball.word & GONE) == 0u {
        let middle = cell_of(ball.p);
        for (var at = 0; at < 27; at++) {
            let cell = middle + vec3i(at % 3, at / 3 % 3, at / 9) - vec3i(1);
            let bucket = bucket_of(cell);
            let end = end_of(bucket);
            for (var i = start_of(bucket); i < end; i++) {
                let other = order[i];
                let q = source[other].p;
                // Buckets are shared by cells far apart.
                if other == index || any(cell_of(q) != cell) || (source[other].word & GONE) != 0u {
                    continue;
                }
                if distance(q, ball.p) < 1.05 * (ball.r + source[other].r) && found < NEIGHBOURS {
                    lists[index * NEIGHBOURS + found] = other;
                    found += 1u;
                }
            }
        }
    }
    lists[law.count * NEIGHBOURS + index] = found;
    let came = bitcast<vec3u>(ball.v);
    for (var i = 0u; i < 3u; i++) {
        lists[law.count * (NEIGHBOURS + 1u) + index * 3u + i] = came[i];
    }
}

fn touching(index: u32) -> u32 {
    return lists[law.count * NEIGHBOURS + index];
}

fn arrival(index: u32) -> vec3f {
    let at = law.count * (NEIGHBOURS + 1u) + index * 3u;
    return bitcast<vec3f>(vec3u(lists[at], lists[at + 1u], lists[at + 2u]));
}

// A ball that sleeps wakes where a neighbour has left.
fn sleeps(index: u32) -> bool {
    return (source[index].word & ASLEEP) != 0u && touching(index) >= source[index].touching;
}

// From the first to the second of two balls that are in one place, one way for each pair.
fn one_way(first: u32, second: u32) -> vec3f {
    let turn = 2.4 * f32((first + second) % 1024u);
    return select(-1.0, 1.0, first < second) * vec3f(0.8 * cos(turn), 0.6, 0.8 * sin(turn));
}

// What the neighbours do to a ball: each one's gain is the other's loss, number for number. Two part with the speed that the law leaves of
// that with which they came, through however many meetings it takes.
@compute @workgroup_size(64)
fn meet(@builtin(global_invocation_id) id: vec3u) {
    if id.x >= law.count {
        return;
    }
    let index = order[id.x];
    let ball = source[index];
    let mine_came = arrival(index);
    var met = ball;
    let asleep = sleeps(index);
    if (ball.word & ASLEEP) != 0u && !asleep {
        met = wake(met);
    }
    let count = touching(index);
    var push = vec3f(0.0);
    var bounces = false;
    for (var i = 0u; i < count; i++) {
        let at = lists[index * NEIGHBOURS + i];
        let other = source[at];
        let apart = other.p - ball.p;
        let far = length(apart);
        let overlap = ball.r + other.r - far;
        let other_asleep = sleeps(at);
        if overlap <= 0.0 || (asleep && other_asleep) {
            continue;
        }
        var n = one_way(index, at);
        if far > 1e-9 {
            n = apart / far;
        }
        let relative = other.v - ball.v;
        let across = dot(relative, n);
        let hit = across < -2.0 * law.rest;
        if asleep && !hit {
            continue;
        }
        if asleep {
            met = wake(met);
        }
        // What sleeps and is not hit is as good as a wall.
        var share = 1.0;
        if !other_asleep || hit {
            let mine = ball.r * ball.r * ball.r;
            let its = other.r * other.r * other.r;
            share = its / (mine + its);
        }
        let crowd = f32(max(max(count, touching(at)), 1u));
        let gain = share / (1.0 + 0.5 * (crowd - 1.0));
        push -= gain * overlap * n;
        let came = -dot(arrival(at) - mine_came, n);
        let leaves = select(0.0, law.restitution * came, came > law.rest);
        bounces = bounces || leaves > 0.0;
        if across >= leaves {
            continue;
        }
        let press = leaves - across;
        met.v -= gain * press * n;
        let turning = ball.spin * ball.r + other.spin * other.r;
        let slide = relative - n * across - cross(turning, n);
        let speed = length(slide);
        if speed > 1e-9 {
            let way = slide / speed;
            let impulse = gain * min(law.friction * press, 2.0 / 7.0 * speed);
            met.v += impulse * way;
            met.spin += 2.5 * impulse / ball.r * cross(n, way);
        }
    }
    let size = length(push);
    let most = 0.05 * ball.r;
    push *= select(1.0, most / size, size > most);
    met.p += push;
    // In a heap what is pushed back stops, if it does not bounce: the blows of so many do not reach through it within a step.
    let way = min(size, most);
    if count >= HEAP && way > 0.0 && !bounces {
        let out = push / way;
        met.v += out * clamp(-dot(met.v, out), 0.0, way / law.h);
    }
    if (met.word & ASLEEP) == 0u {
        met.touching = count;
    }
    goal[index] = met;
}
