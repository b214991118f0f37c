//! The forms of each sort of term, as text. See [`super::grammar`] for what the angles mean.

use super::grammar::Sort;

/// The lists of forms that a sort has.
pub fn lists(sort: Sort) -> &'static [&'static [&'static str]] {
    match sort {
        Sort::File => &[FILE],
        Sort::Block => &[BLOCK],
        Sort::Shape => &[SHAPE],
        Sort::Body => &[BODY],
        Sort::Drawing => &[DRAWING],
        Sort::Line => &[LINE],
        Sort::Formula => &[FORMULA, NUMERIC],
        Sort::Flat => &[FLAT, NUMERIC],
        Sort::Free => &[FREE, NUMERIC],
        Sort::Mixed => &[MIXED, NUMERIC],
        Sort::Point => &[POINT],
        Sort::Spot => &[SPOT],
        Sort::Test => &[TEST],
        Sort::Number => &[NUMBER],
        Sort::Size => &[SIZE],
        Sort::Small => &[SMALL],
        Sort::Count => &[COUNT],
        Sort::Whole => &[WHOLE],
        Sort::Angle => &[ANGLE],
        Sort::Axis => &[AXIS],
        Sort::Way => &[WAY],
        Sort::Vector => &[VECTOR],
        Sort::Sizes => &[SIZES],
        Sort::Pair => &[PAIR],
        Sort::Color => &[COLOR],
    }
}

// What the file declares is left out where nothing uses it. Each stands on a line of its own.
const FILE: &[&str] = &["\
param live = 0.4 in 0.05..1.2
param lean = 0.2 in -1..1
param many: int = 3 in 1..5
param on = true
param spot = (0.3, 0, 0.2) in (-1, -1, -1)..(1, 1, 1)
param style = cap_a in [cap_a, cap_b]
let half = live / 2
let seeds = [(0.5, 0, 0, 0.6), (-0.4, 0.3, 0.1, 0.5), (0, -0.5, 0.4, <size>)]
let ring = [for i in 0..5 { (cos(i * 72deg), sin(i * 72deg)) * <size> }]
shape cap_a = <shape>
shape cap_b = <shape>
fn ease(t: float) = <free>
fn knot(n: int, v: vec3) = if n == 0 { length(v) - 0.5 } else { min(knot(n - 1, abs(v) - 0.4), length(v) - 0.3) }
field own(k: float = 1) = <body>
field near(s: shape, k: field) = <formula> * 0.2 + s.at(<point>) - k
field2 sketch(k: float = 1) = <flat>
warp bulge(k: float = 1) = p + (<formula>, <formula>, <formula>) * k
warp2 wave(k: float = 1) = p + (<flat>, <flat>) * k
blend meet(a, b, k: field) = <mixed>
blend skin(a, k: field) = { let b = 1; <mixed> }
shape pair(s: shape, gap: float) = s.translate(gap, 0, 0) | s.translate(-gap, 0, 0)
shape2 mark(size: float = 1) = <drawing>
shape tree(n: int) = if n < 1 { sphere(0.2) } else { (tree(n - 1).scale(0.6).translate(0, 0.6, 0).rotate(z, <angle>) | capsule(0.1, 0.8)) }
material paint_a { color: (<formula>, 0.5, 0.4), roughness: 0.5, bump: 0.01 * <formula> }
material paint_b(t: float) { let u = fract(t * p.y); color: mix(#204060, #f0e0c0, step(0.5, u)) * abs(normal), roughness: <little> }
scene = <shape>
<block>
"];

const BLOCK: &[&str] = &[
    "render { extent: 6 }",
    "render { extent: 6 }",
    "render { extent: 12, max_distance: 50 }",
    "",
    "camera { eye: (4, 3, 5 + time), target: <vector>, fov: 40deg }",
    "light lamp { position: (2, 3, 1), color: <color>, intensity: 20, shadow: soft(8) }",
    "environment { sky: gradient(<color>, <color>) }",
];

const SHAPE: &[&str] = &[
    // Primitives.
    "sphere(<size>)",
    "sphere(<size>)",
    "box(<sizes>)",
    "box(<sizes>)",
    "ellipsoid(<sizes>)",
    "plane(<axis>, <number>)",
    "rounded_box(<sizes>, <small>)",
    "box_frame(<sizes>, <small>)",
    "octahedron(<size>)",
    "pyramid(<size>, <size>)",
    "prism(<count> + 2, <size>, <size>)",
    "torus(<size>, <small>)",
    "capped_torus(<size>, <small>, <angle>)",
    "link(<size>, <size>, <small>)",
    "cylinder(<size>, <size>)",
    "cylinder(<vector>, <vector>, <size>)",
    "capsule(<vector>, <vector>, <small>)",
    "capsule(<size>, <size>)",
    "cone(<size>, <size>)",
    "capped_cone(<size>, <size>, <size>)",
    "rounded_cone(<size>, <size>, <size>)",
    "superquadric(<sizes>, 1 + 3 * <size>)",
    "gyroid(<size>, <small>).within(<shape>)",
    "schwarz_p(<size>, <small>).within(<shape>)",
    "heightfield(<formula>).within(<shape>)",
    "menger_sponge(<size>, <count> % 3)",
    "metaballs(seeds)",
    "metaballs([(<vector>, <size>), (<vector>, <size>), (<vector>, 0.8)], <small>)",
    "metaballs([for i in 0..4 { (cos(i), sin(2 * i), 0.3 * i, <size>) }])",
    "(nothing | <same>)",
    "(<same> - nothing)",
    // Of drawings.
    "<drawing>.extrude(<size>)",
    "<drawing>.extrude(<size>, <small>)",
    "<drawing>.revolve()",
    "<drawing>.translate(<size>, 0).revolve()",
    "<drawing>.loft(<drawing>, <size>)",
    "<drawing>.scale(0.2).sweep_helix(0.3 + <size>, 0.3 + <size>, <size>)",
    // Operators and blends.
    "(<same> | <same>)",
    "(<same> | <same>)",
    "(<same> & <same>)",
    "(<same> - <same>)",
    "(<same> - <same>)",
    "(!<same>)",
    "union(<same>, <same>)",
    "intersection(<same>, <same>)",
    "difference(<same>, <same>)",
    "xor(<same>, <same>)",
    "smooth_union(<same>, <same>, <size>)",
    "smooth_union(<same>, <same>, <small> * (1 + <formula>))",
    "smooth_intersection(<same>, <same>, <small>)",
    "smooth_difference(<same>, <same>, <size>)",
    "round_union(<same>, <same>, <size>)",
    "round_intersection(<same>, <same>, <small>)",
    "round_difference(<same>, <same>, <small>)",
    "chamfer_union(<same>, <same>, <size>)",
    "chamfer_intersection(<same>, <same>, <small>)",
    "chamfer_difference(<same>, <same>, <small>)",
    "stairs_union(<same>, <same>, <size>, <count>)",
    "stairs_intersection(<same>, <same>, <small>, <count>)",
    "stairs_difference(<same>, <same>, <small>)",
    "mix(<same>, <same>, <small>)",
    "mix(<same>, <same>, saturate(<formula>))",
    "<same>.round(<small>)",
    "<same>.shell(<small>)",
    "<same>.offset(<number> / 5)",
    "<same>.displace(<small> * <formula>)",
    "<same>.displace(<formula>)",
    "<same>.within(<same>)",
    "<same>.within(box(<sizes>))",
    "<same>.complement()",
    // Placement.
    "<same>.translate(<vector>)",
    "<same>.translate(<vector>)",
    "<same>.rotate(<axis>, <angle>)",
    "<same>.rotate(<axis>, <angle>)",
    "<same>.scale(<size>)",
    "<same>.stretch(<sizes>)",
    "<same>.shear(<axis>, <axis>, <number>)",
    "<same>.mirror(<axis>)",
    "<same>.symmetry(<axis>)",
    "<same>.fold(<axis>)",
    "<same>.matrix(mat3((1, 0, 0), (<number>, 1, 0), (0, <number>, <size>)))",
    "<same>.matrix(mat4((1, 0, 0, 0), (0.4, 1, 0, 0), (0, <number>, 1.4, 0), (0.2, 0, <number>, 1)))",
    "<same>.repeat(<sizes>).within(<same>)",
    "<same>.scale(0.3).repeat((<size>, 0, <size>))",
    "<same>.repeat(<sizes>, (2, <count>, 1))",
    "<same>.repeat_polar(<axis>, <whole>)",
    // Warps.
    "<same>.twist(<axis>, <number>)",
    "<same>.bend(<axis>, <axis>, <number>)",
    "<same>.bend_ring(<size>)",
    "<same>.taper(<axis>, -0.6, <size>, <size>)",
    "<same>.elongate(<sizes>)",
    "<same>.detail(<count>, <size>)",
    "<same>.carve(<count>, <size>)",
    // Many of one.
    "(for i in 0..many { <same>.translate(0.7 * i - 1, 0, 0).rotate(y, i * <angle>) })",
    "(for i in 0..<count> by smooth_union(<small>) { <same>.translate(0.6 * i, 0.2 * i * i, 0) })",
    "(for i in 0..2 by meet(<formula>) { <same>.translate(0.5 * i, 0, 0) })",
    "(for v in seeds { <same>.scale(v.w).translate(v.xyz) })",
    "(for cell in grid((<size>, 0, <size>)) { <same>.scale(0.2 + 0.3 * hash(cell)).rotate(y, cell.x) })",
    "(for cell in grid((<size>, 0, 0)) { <same>.translate(0, 0.3 * hash(cell, 3), 0) }).within(<same>)",
    "(for cell in grid(<sizes>, (2, 1, many)) { <same>.scale(0.4).translate((hash3(cell) - 0.5) * <small>) })",
    "(for cell in grid(<size>) { if hash(cell) > 0.5 { sphere(0.3 * <size>) } else { box(0.4 * <size>) } })",
    "(for k in polar(<axis>, <count> + 1) { <same>.translate(<vector>).scale(0.5 + 0.1 * k) })",
    "(for it in [<same>, <same>] { it.translate(<vector>) })",
    "[<same>, <same>][<count> % 2].translate(0, 0, 0.2)",
    // Choosing.
    "(if on { <same> } else { <same> })",
    "(if <number> > 0 { <same> } else if lean > 0.2 { <same> } else { sphere(0.4) })",
    "(if sin(time) > 0 { <same> })",
    "style",
    "{ let s = <same>; s.translate(0, -s.low_corner.y, 0) | s.translate(0, -s.high_corner.y, 0) }",
    "{ let s = <same>; s | s.rotate(z, <angle>) }",
    // Of the file's own.
    "own(<number>)",
    "own().within(<same>)",
    "<same>.near(<formula>)",
    "<same>.near(<small>).within(<same>)",
    "<same>.bulge(<small>)",
    "<same>.bulge(<small>).within(<same>)",
    "meet(<same>, <same>, <small>)",
    "meet(<same>, <same>, <formula>).within(<same>)",
    "<same>.skin(<small>)",
    "<same>.pair(<size>)",
    "tree(<count> % 3)",
    "<same>.material(paint_a)",
    "<same>.material(paint_b(<number>))",
    "<same>.material(swatch(<color>, <little>))",
    "<same>.paint(<same>, paint_a)",
];

const BODY: &[&str] = &[
    "length(<point>) - <size>",
    "length(p) - 1 + <small> * <formula>",
    "length(p) - 1 + <small> * <formula>",
    "max(<formula>, length(p) - 2)",
    "<formula>",
    "<formula> - <number>",
    "(<formula> - <number>) * (<formula> + k)",
    "if <test> { length(p) - <size> } else { <formula> }",
    "sqrt(min(dot(p, p), dot(p - y, p - y))) - <size> * k",
    "knot(<count> % 3, <point>)",
    "{ let q = p, s = 1 for i in 0..<count> while length(q) < 8 { let t = abs(q) - <number>; q = 1.5 * t, s = 1.5 * s }; (length(q) - 1) / s }",
    "{ let q = p, s = 0 for i in 0..<count> { q = turn_about(abs(q) - <small>, <axis>, <angle>), s = s + q.x * <small> }; length1(q) - <size> + s }",
    "smooth_union(<formula>, length(p) - <size>, <small>)",
    "box(<sizes>).at(<point>)",
    "<shape>.at(<point>) + <small> * <formula>",
    "(<shape>).at(p) * (<shape>).at(<point>)",
];

const DRAWING: &[&str] = &[
    "circle(<size>)",
    "circle(<size>)",
    "ellipse(<size>, <size>)",
    "plane(<way>, <number>)",
    "rectangle(<size>, <size>)",
    "rounded_rectangle((<size>, <size>), <small>)",
    "regular_polygon(<count> + 2, <size>)",
    "star(<count> + 1, <size>, <small>)",
    "polygon([<pair>, <pair>, <pair>])",
    "polygon([<pair>, <pair>, <pair>, <pair>])",
    "polygon(ring)",
    "<line>.round(<small>)",
    "<line>.round(<small>)",
    "(<same> | <same>)",
    "(<same> & <same>)",
    "(<same> - <same>)",
    "(!<same>)",
    "smooth_union(<same>, <same>, <size>)",
    "chamfer_difference(<same>, <same>, <small>)",
    "stairs_union(<same>, <same>, <small>)",
    "mix(<same>, <same>, <small>)",
    "meet(<same>, <same>, <small>)",
    "<same>.round(<small>)",
    "<same>.shell(<small>)",
    "<same>.offset(<number> / 5)",
    "<same>.displace(<small> * <flat>)",
    "<same>.within(circle(<size>))",
    "<same>.translate(<pair>)",
    "<same>.rotate(<angle>)",
    "<same>.scale(<size>)",
    "<same>.stretch(<size>, <size>)",
    "<same>.shear(<way>, <way>, <number>)",
    "<same>.mirror(<way>)",
    "<same>.symmetry(<way>)",
    "<same>.fold(<way>)",
    "<same>.matrix(mat2((1, <number>), (0, <size>)))",
    "<same>.elongate(<size>, <size>)",
    "<same>.repeat((<size>, <size>)).within(<same>)",
    "<same>.repeat((<size>, 0), (<count>, 1))",
    "<same>.repeat_polar(<whole>)",
    "<same>.wave(<small>)",
    "(for c in grid((<size>, <size>)) { circle(0.1 + 0.3 * hash(c)) })",
    "(for k in polar(<count>) { <same>.translate(<pair>) })",
    "(for i in 0..<count> { <same>.translate(0.5 * i, 0) })",
    "(if on { <same> } else { <same> })",
    "sketch(<number>).within(rectangle(2))",
    "mark(<size>)",
];

const LINE: &[&str] = &["segment(<pair>, <pair>)", "arc(<size>, <angle>, <angle>)", "bezier(<pair>, <pair>, <pair>)"];

// Numbers of any kind: what they see is that of their parts.
const NUMERIC: &[&str] = &[
    "<signed>",
    "<number>",
    "(<same> + <same>)",
    "(<same> + <same>)",
    "(<same> - <same>)",
    "(<same> * <same>)",
    "<little> * <same>",
    "<same> / (1.5 + <same>)",
    "<same> / <size>",
    "<same> % <size>",
    "(-<same>)",
    "min(<same>, <same>)",
    "max(<same>, <same>)",
    "abs(<same>)",
    "abs(<same>)",
    "clamp(<same>, -0.5, <size>)",
    "saturate(<same>)",
    "sin(<same>)",
    "cos(3 * <same>)",
    "tan(clamp(<same>, -1, 1))",
    "asin(<same>)",
    "acos(0.5 * <same>)",
    "atan(<same>)",
    "atan(<same>, <same>)",
    "atan2(<same>, <same>)",
    "sinh(clamp(<same>, -1, 1))",
    "cosh(saturate(<same>))",
    "tanh(<same>)",
    "asinh(<same>)",
    "acosh(1 + abs(<same>))",
    "atanh(clamp(<same>, -0.9, 0.9))",
    "exp(-abs(<same>))",
    "exp2(clamp(<same>, -2, 1))",
    "log(1 + abs(<same>))",
    "log2(1.5 + clamp(<same>, -1, 1))",
    "sqrt(<same> * <same> + 0.01)",
    "sqrt(abs(<same>))",
    "sqrt(min(sq(<same>), sq(<same>)))",
    "inversesqrt(0.5 + abs(<same>))",
    "pow(abs(<same>), <size>)",
    "pow(<same>, 2)",
    "sq(<same>)",
    "cube(<same>)",
    "cube_root(<same>)",
    "floor(3 * <same>) / 3",
    "ceil(<same>)",
    "round(2 * <same>) / 4",
    "trunc(<same>)",
    "fract(<same>)",
    "mod(<same>, 0.7)",
    "sign(<same>)",
    "step(<small>, <same>)",
    "smoothstep(-0.5, <size>, <same>)",
    "smootherstep(-0.5, 0.5, <same>)",
    "fade(saturate(<same>))",
    "triangle_wave(<same>)",
    "mix(<same>, <same>, saturate(<same>))",
    "fma(<same>, 0.5, <same>)",
    "radians(30 * <same>)",
    "degrees(0.01 * <same>)",
    "hash(floor(3 * <same>))",
    "length((<same>, <same>))",
    "length1((<same>, <same>))",
    "length8((<same>, <same>))",
    "length_inf((<same>, <same>))",
    "dot((<same>, <same>), (<same>, 0.5))",
    "distance((<same>, 1), (0, <same>))",
    "(if <same> < <same> { <same> } else { <same> })",
    "(if <same> > 0 && <same> <= 0.5 || <same> == 0 { <same> } else if !(<same> >= 0.3) { <same> } else { 0.2 })",
    "{ let t = <same>; t * <same> + max(t, 0) }",
    "(for i in 0..<count> by + { sin((i + 1) * <same>) / (i + 1) })",
    "(for i in 0..<count> by min { <same> + i / 2 })",
    "(for i in 0..<count> by max { <same> * (1 - i / 3) })",
    "(for i in 1..3 by * { <same> / i })",
    "(for v in [1, 0.5, <signed>] by min { <same> * v })",
    "[0.2, <signed>, 0.7][int(clamp(2 * <same>, 0, 2))]",
    "{ let q = <same>, s = 1 for i in 0..<count> while abs(q) < 3 { q = 1.5 * q + <small>, s = 0.6 * s }; q * s }",
    "ease(<same>)",
    "union(<same>, <same>)",
    "smooth_union(<same>, <same>, <small>)",
    "smooth_difference(<same>, <same>, <size>)",
    "round_intersection(<same>, <same>, <small>)",
    "chamfer_union(<same>, <same>, <small>)",
    "stairs_union(<same>, <same>, <size>)",
    "meet(<same>, <same>, <small>)",
    "length(hash2((floor(<same>), 1)))",
    "determinant(mat2((<same>, 1), (0.3, <same>)))",
    "int(<same>)",
    "float(<count>)",
    "palette(<same>, 0.2, 0.3, 1, (0, 0.33, 0.67)).x",
    "length(hsv(<same>, 0.5, 0.5))",
    "linear(saturate(<same>))",
];

const FORMULA: &[&str] = &[
    "p.x",
    "p.y",
    "p.z",
    "p.x",
    "p.y",
    "p.z",
    "length(p)",
    "length(p.xz)",
    "(length(<point>) - <size>)",
    "(length(<point>) - <size>)",
    "dot(<point>, <axis>)",
    "dot(<point>, <point>)",
    "cross(<point>, <axis>).y",
    "normalize(<point>).x",
    "length1(<point>)",
    "length8(<point>)",
    "length_inf(<point>)",
    "largest(<point>)",
    "smallest(<point>)",
    "corner(abs(<point>) - <sizes>)",
    "corner((length(p.xz) - 1, p.y))",
    "distance(<point>, <vector>)",
    "value_noise(<point>)",
    "value_noise(2 * p.xz)",
    "perlin(2 * <point>)",
    "perlin((p.x, <same>))",
    "simplex(<point>)",
    "simplex(p.xy)",
    "cellular(<point>)",
    "cellular(2 * p.xz)",
    "fbm(<point>, <count>)",
    "fbm(p.xz, 2, 0.6)",
    "random_balls(<point>)",
    "hash(floor(2 * p))",
    "hash3(floor(<point>)).y",
    "influence(<point>, <size>)",
    "ring_distance(p.xz, p.y, <size>)",
    "trapezoid_distance((length(p.xz), p.y), <size>, <size>, <size>)",
    "bezier_distance(p.xy, <pair>, (1, <number>))",
    "bezier_at(p.xy, <pair>, <pair>, saturate(<same>))",
    "edge_gradient(floor(p), <point>)",
    "plane_gradient(floor(p.xz), p.xy)",
    "simplex_corner(floor(p), p - floor(p))",
    "simplex_corner(floor(p.xy), p.xy - floor(p.xy))",
    "<shape>.at(<point>)",
    "<drawing>.at(p.xz)",
    "world.x",
    "sin(4 * world.y)",
    "sin(p.x + time)",
    "(if <test> { <same> } else { <same> })",
    "refract(normalize(<point>), y, 0.7).y",
    "faceforward(<point>, y, <axis>).x",
];

const FLAT: &[&str] = &[
    "p.x",
    "p.y",
    "(length(<spot>) - <size>)",
    "(length(<spot>) - <size>)",
    "dot(<spot>, <way>)",
    "length1(<spot>)",
    "length8(<spot>)",
    "length_inf(<spot>)",
    "largest(<spot>)",
    "smallest(<spot>)",
    "corner(abs(<spot>) - <size>)",
    "value_noise(<spot>)",
    "perlin(<spot>)",
    "simplex(<spot>)",
    "cellular(<spot>)",
    "fbm(<spot>, 2)",
    "<drawing>.at(<spot>)",
];

const FREE: &[&str] = &["t", "t", "t", "t * t * (3 - 2 * t)"];

const MIXED: &[&str] = &["a", "b", "a", "b", "min(a, b)", "max(a, -b)", "(a + b - k)", "(a - k)", "abs(a) - k", "length((max(a, 0), max(b, 0)))"];

const POINT: &[&str] = &[
    "p",
    "p",
    "p",
    "(p - <vector>)",
    "2 * p",
    "p / <sizes>",
    "p.zxy",
    "abs(p)",
    "abs(<same>) - <vector>",
    "p % <size>",
    "fract(p) - 0.5",
    "(p - round(p))",
    "(<formula>, p.y, p.z)",
    "(<formula>, <formula>, <formula>)",
    "rotate(<same>, <axis>, <angle>)",
    "translate(<same>, <vector>)",
    "scale(<same>, <size>)",
    "stretch(<same>, <sizes>)",
    "twist(<same>, <axis>, <number>)",
    "bulge(<same>, <small>)",
    "askew(<same>)",
    "reflect(<same>, y)",
    "vec3(turn(p.xz, <formula>), p.y)",
    "turn_about(<same>, normalize(<axis>), <formula>)",
    "transpose(mat3((1, 0, 0), (<number>, 1, 0), (0, 0, 1))) * <same>",
    "inverse(mat3((1, 0, 0), (<number>, 1, 0), (0, 0, 2))) * <same>",
    "mix(p, <same>, <small>)",
    "min(<same>, <vector>)",
    "clamp(p, -1, <size>)",
    "cross(p, <axis>)",
    "vec3(p.xy, <formula>)",
    "vec4(p, 1).wyx",
    "sin(<same>)",
    "{ let q = p; q + 0.2 * q.yzx }",
    "world",
];

const SPOT: &[&str] = &[
    "p",
    "p",
    "(p - <pair>)",
    "p.yx",
    "abs(p)",
    "2 * p",
    "turn(<same>, <angle>)",
    "rotate(<same>, <flat>)",
    "(<flat>, p.y)",
    "fract(p) - 0.5",
    "askew(<same>)",
    "scale(<same>, <size>)",
    "stretch(<same>, (<size>, 1))",
    "wave(<same>, <small>)",
];

const TEST: &[&str] = &[
    "<formula> < <formula>",
    "p.x > <number>",
    "p.y <= 0 && <formula> > 0",
    "<formula> >= 0 || p.z < 0.1",
    "!(p.x == 0)",
    "length(p) != 1",
    "on",
];

const NUMBER: &[&str] = &[
    "<signed>", "<signed>", "<signed>", "<signed>", "<signed>", "<signed>", "live", "lean", "half", "time", "sin(time)", "(lean * <signed>)",
    "many / 3",
];

const SIZE: &[&str] = &[
    "<positive>",
    "<positive>",
    "<positive>",
    "<positive>",
    "<positive>",
    "<positive>",
    "<positive>",
    "live",
    "half",
    "(1 + lean / 2)",
    "(0.5 + 0.3 * sin(time))",
    "lean",
    "abs(lean)",
];

const SMALL: &[&str] = &["<little>", "<little>", "<little>", "<little>", "<little>", "live", "half", "(0.1 + lean / 10)", "lean", "0"];

const COUNT: &[&str] = &["<integer>"];

const WHOLE: &[&str] = &["<integer>", "many"];

const ANGLE: &[&str] = &["<degrees>deg", "<degrees>deg", "<signed>", "lean", "time", "0.25turn", "pi / 3", "tau * lean"];

const AXIS: &[&str] = &["x", "y", "z", "x", "y", "z", "(1, 1, 0)", "(1, -2, 0.5)", "normalize((1, 2, 3))", "(<vector> + 2)", "-y"];

const WAY: &[&str] = &["(1, 0)", "(0, 1)", "(1, 1)", "(-2, 0.5)"];

const VECTOR: &[&str] = &["(<number>, <number>, <number>)", "(<number>, 0, 0)", "(0, <signed>, 0)", "(<signed>, <signed>, <signed>)", "spot", "spot.zxy"];

const SIZES: &[&str] = &["(<size>, <size>, <size>)", "(<positive>, <positive>, <positive>)", "(<positive>, <positive>, <positive>)", "vec3(<size>)"];

const PAIR: &[&str] = &["(<signed>, <signed>)", "(<signed>, <signed>)", "(<number>, <number>)"];

const COLOR: &[&str] = &["#d08770", "(0.2, 0.4, <little>)", "hsv(<little>, 0.5, 0.8)", "palette(<number>, 0.5, 0.5, 1, (0, 0.33, 0.67))", "#fa0"];

