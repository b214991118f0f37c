// Shadow maps: depths seen from lights. A light that is infinitely far has one, whose frame is a box along the light's own axes; one that
// has a place has six, the sides of a cube about it.

struct ShadowLight {
    // The axes of a light that is infinitely far: `along` is how it travels.
    across: vec3f,
    // Its first map; below 0: it has none.
    first: i32,
    above: vec3f,
    // 1 where it has a place.
    position: u32,
    along: vec3f,
    // 1 where the field is in its maps too.
    field: u32,
    // What its maps are drawn around, in the space of the module's `p`; a light with a place is there.
    center: vec3f,
    // Of a light with a place: the distance at which the depth is 1.
    far: f32,
    // The same place in the scene's space.
    scene_center: vec3f,
    // How many balls there are.
    balls: u32,
}

@group(3) @binding(0) var<uniform> shadow_lights: array<ShadowLight, 16>;

// A cube's side is seen through a little more than a right angle, so that what is looked up beside a place is on the same side.
const SHADOW_BORDER: f32 = 1.02;

// Whole numbers in the order of the numbers that they stand for.
fn shadow_order(x: f32) -> u32 {
    let bits = bitcast<u32>(x);
    return select(bits | 0x80000000u, ~bits, (bits & 0x80000000u) != 0u);
}

fn shadow_number(order: u32) -> f32 {
    return bitcast<f32>(select(~order, order & 0x7fffffffu, (order & 0x80000000u) != 0u));
}

// A way from the centre in axes.
fn shadow_axes(way: vec3f, across: vec3f, above: vec3f, along: vec3f) -> vec3f {
    return vec3f(dot(way, across), dot(way, above), dot(way, along));
}
