//! Random programs that keep to the grammar, so that the stages behind the parser have something to do.

use crate::mutations::Random;

/// A number as the language writes it: mostly ordinary, sometimes one that hurts.
pub fn number(random: &mut Random) -> String {
    match random.below(12) {
        0 => random.pick(HARD).to_owned(),
        1 => format!("{}deg", random.below(400)),
        2..=5 => format!("{}", random.below(12)),
        _ => format!("{:.2}", random.below(300) as f64 / 100.0),
    }
}

const HARD: &[&str] = &[
    "0", "-1", "1e-30", "1e30", "1e38", "3.5e38", "1e300", "1e-300", "-0", "0.0000001", "16777217", "2147483648", "4294967296",
    "9007199254740993", "1turn", "0deg", "90deg", "1e15", "(1 / 0)", "(0 / 0)", "sqrt(-1)", "0.5", "1000000",
];

/// A whole file.
pub fn program(random: &mut Random) -> String {
    let mut text = String::new();
    let mut maker = Maker { random, depth: 0, names: Vec::new(), shapes: false };
    for i in 0..maker.random.below(4) {
        let range = maker.pick(&["0..2", "-1..1", "0.1..0.9", "1..6", "0..0", "0..1e6", "2..1"]);
        let default = maker.pick(&["0.5", "1", "0.1", "2"]);
        let integer = maker.pick(&["", "", "", ": int"]);
        text += &format!("param n{i}{integer} = {default} in {range}\n");
        maker.names.push(format!("n{i}"));
    }
    if maker.random.once_in(3) {
        let value = maker.number_of(false);
        text += &format!("let l = {value}\n");
        maker.names.push("l".to_owned());
    }
    let formula = maker.formula();
    text += &format!("field f(k: float = {}) = {formula}\n", number(maker.random));
    let (x, y, z) = (maker.formula(), maker.formula(), maker.formula());
    text += &format!("warp w(k: float = 1) = p + ({x}, {y}, {z}) * k\n");
    let blend = maker.pick(&["min(a, b) - k", "a * k + b", "max(a, -b)", "sqrt(a * a + b * b) - k", "a + b", "if a < b { a } else { b + k }", "a * b"]);
    text += &format!("blend m(a, b, k: field) = {blend}\n");
    let color = maker.formula();
    text += &format!("material c {{ color: ({color}, 0.5, 0.5), roughness: {}, reflectivity: 0.5 }}\n", number(maker.random));
    let drawing = maker.drawing();
    text += &format!("shape2 d = {drawing}\n");
    let inner = maker.shape();
    text += &format!("shape g(k: float = 1) = {inner}\n");
    maker.shapes = true;
    let scene = maker.shape();
    text += &format!("scene = {scene}\n");
    if maker.random.once_in(3) {
        let (eye, fov) = (maker.vector(false), number(maker.random));
        text += &format!("camera {{ eye: {eye}, target: (0, 0, 0), fov: {fov} }}\n");
    }
    if maker.random.once_in(3) {
        let (direction, shadow) = (maker.vector(false), maker.pick(&["none", "hard", "soft(8)", "soft(0)", "map"]));
        text += &format!("light s {{ direction: {direction}, intensity: {}, shadow: {shadow} }}\n", number(maker.random));
    }
    if maker.random.once_in(3) {
        text += &format!("render {{ extent: {}, max_distance: {} }}\n", number(maker.random), number(maker.random));
    }
    text
}

struct Maker<'a> {
    random: &'a mut Random,
    depth: usize,
    names: Vec<String>,
    /// Whether the shape `g` may be called.
    shapes: bool,
}

impl Maker<'_> {
    fn pick(&mut self, of: &[&'static str]) -> &'static str {
        self.random.pick(of)
    }

    /// A step deeper, where there is room; else the short form.
    fn deeper(&mut self, long: impl FnOnce(&mut Self) -> String, short: impl FnOnce(&mut Self) -> String) -> String {
        if self.depth > 5 || self.random.below(6) < self.depth {
            return short(self);
        }
        self.depth += 1;
        let text = long(self);
        self.depth -= 1;
        text
    }

    fn formula(&mut self) -> String {
        self.number_of(true)
    }

    /// A number; of `p` where there is one.
    fn number_of(&mut self, point: bool) -> String {
        self.deeper(
            |m| match m.random.below(16) {
                0..=4 => {
                    let (a, b) = (m.number_of(point), m.number_of(point));
                    format!("({a} {} {b})", m.pick(&["+", "-", "*", "/", "%"]))
                }
                5..=8 => {
                    let a = m.number_of(point);
                    let function = m.pick(&[
                        "sin", "cos", "tan", "asin", "acos", "atan", "exp", "log", "exp2", "log2", "sqrt", "abs", "sign", "floor", "ceil",
                        "fract", "round", "trunc", "radians", "degrees", "sinh", "tanh",
                    ]);
                    format!("{function}({a})")
                }
                9..=10 => {
                    let (a, b) = (m.number_of(point), m.number_of(point));
                    format!("{}({a}, {b})", m.pick(&["min", "max", "pow", "atan", "step", "smooth_union", "distance"]))
                }
                11 => {
                    let (a, b, c) = (m.number_of(point), m.number_of(point), m.number_of(point));
                    format!("{}({a}, {b}, {c})", m.pick(&["clamp", "mix", "smoothstep"]))
                }
                12 => {
                    let (a, b, c) = (m.number_of(point), m.number_of(point), m.number_of(point));
                    format!("if {a} {} {b} {{ {c} }} else {{ {b} }}", m.pick(&["<", ">", "<=", ">=", "==", "!="]))
                }
                13 => {
                    let a = m.vector(point);
                    format!("{}({a})", m.pick(&["length", "length1", "length8", "length_inf", "perlin", "value_noise", "simplex", "hash"]))
                }
                14 => {
                    let (a, b) = (m.number_of(point), m.number_of(point));
                    format!("{{ let t = {a}; t * {b} + t }}")
                }
                _ => {
                    let (a, by) = (m.number_of(point), m.pick(&["min", "max", "+", "*"]));
                    format!("(for i in 0..{} by {by} {{ {a} + i }})", m.random.below(5))
                }
            },
            |m| match m.random.below(6) {
                0..=2 if point => m.pick(&["p.x", "p.y", "p.z", "length(p)", "p.x"]).to_owned(),
                3 if !m.names.is_empty() => m.names[m.random.below(m.names.len())].clone(),
                4 if point && m.random.once_in(3) => "time".to_owned(),
                _ => number(m.random),
            },
        )
    }

    fn vector(&mut self, point: bool) -> String {
        if point && self.random.once_in(3) {
            return self.pick(&["p", "p.zxy", "2 * p", "abs(p)", "p % 2"]).to_owned();
        }
        self.depth += 2;
        let (a, b, c) = (self.number_of(point), self.number_of(point), self.number_of(point));
        self.depth -= 2;
        format!("({a}, {b}, {c})")
    }

    fn drawing(&mut self) -> String {
        self.deeper(
            |m| {
                let a = m.drawing();
                match m.random.below(6) {
                    0..=1 => {
                        let b = m.drawing();
                        format!("({a} {} {b})", m.pick(&["|", "&", "-"]))
                    }
                    2 => format!("{a}.translate({}, {})", number(m.random), number(m.random)),
                    3 => format!("{a}.rotate({})", number(m.random)),
                    4 => format!("{a}.round({})", number(m.random)),
                    _ => format!("{a}.repeat_polar({})", m.random.below(9)),
                }
            },
            |m| {
                let (a, b, c) = (number(m.random), number(m.random), number(m.random));
                match m.random.below(8) {
                    0 => format!("circle({a})"),
                    1 => format!("rectangle({a}, {b})"),
                    2 => format!("regular_polygon({}, {a})", m.random.below(9)),
                    3 => format!("star({}, {a}, {b})", m.random.below(9)),
                    4 => format!("polygon([({a}, {b}), ({b}, {c}), ({c}, {a})])"),
                    5 => format!("ellipse({a}, {b})"),
                    6 => format!("bezier(({a}, {b}), ({b}, {c}), ({c}, {a})).round(0.1)"),
                    _ => format!("arc({a}, {b}, {c}).round(0.1)"),
                }
            },
        )
    }

    fn shape(&mut self) -> String {
        self.deeper(
            |m| {
                let a = m.shape();
                match m.random.below(24) {
                    0..=3 => {
                        let b = m.shape();
                        format!("({a} {} {b})", m.pick(&["|", "&", "-"]))
                    }
                    4..=6 => {
                        let (b, k) = (m.shape(), m.number_of(false));
                        let blend = m.pick(&[
                            "smooth_union", "smooth_difference", "round_union", "chamfer_intersection", "stairs_union", "mix", "m", "xor",
                        ]);
                        if blend == "xor" { format!("xor({a}, {b})") } else { format!("{blend}({a}, {b}, {k})") }
                    }
                    7..=8 => format!("{a}.translate({})", m.vector(false)),
                    9 => format!("{a}.rotate({}, {})", m.pick(&["x", "y", "z", "(1, 1, 0)", "(0, 0, 0)"]), m.number_of(false)),
                    10 => format!("{a}.scale({})", m.number_of(false)),
                    11 => format!("{a}.stretch({})", m.vector(false)),
                    12 => format!("{a}.{}({}, {})", m.pick(&["twist", "repeat_polar"]), m.pick(&["x", "y", "z"]), number(m.random)),
                    13 => format!("{a}.bend(x, y, {})", number(m.random)),
                    14 => format!("{a}.taper(y, {}, {}, {})", number(m.random), number(m.random), number(m.random)),
                    15 => format!("{a}.displace({})", m.formula()),
                    16 => format!("{a}.{}({})", m.pick(&["round", "shell", "offset", "w"]), number(m.random)),
                    17 => format!("{a}.repeat({})", m.vector(false)),
                    18 => format!("(for i in 0..{} {{ {a}.translate(i, 0, 0) }})", m.random.below(6)),
                    19 => format!("(for c in grid(({}, 0, {})) {{ {a}.scale(0.5 + hash(c)) }})", number(m.random), number(m.random)),
                    20 => format!("{a}.material(c)"),
                    21 => format!("{a}.{}({})", m.pick(&["mirror", "symmetry", "within"]), m.pick(&["x", "y", "box(2)", "sphere(1)"])),
                    22 => {
                        let (b, c) = (m.number_of(false), m.shape());
                        format!("(if {b} > 1 {{ {a} }} else {{ {c} }})")
                    }
                    _ => format!("!({a})"),
                }
            },
            |m| {
                let (a, b, c) = (number(m.random), number(m.random), number(m.random));
                match m.random.below(20) {
                    0..=2 => format!("sphere({})", m.number_of(false)),
                    3..=4 => format!("box({})", m.vector(false)),
                    5 => format!("ellipsoid({})", m.vector(false)),
                    6 => format!("plane(y, {a})"),
                    7 => format!("torus({a}, {b})"),
                    8 => format!("cylinder({a}, {b})"),
                    9 => format!("capsule({}, {}, {c})", m.vector(false), m.vector(false)),
                    10 => format!("cone({a}, {b})"),
                    11 => format!("gyroid({a}, {b}).within(box(2))"),
                    12 => format!("superquadric({}, {a})", m.vector(false)),
                    13 => format!("d.extrude({a}, {b})"),
                    14 => format!("d.translate({a}, 0).revolve()"),
                    15 => format!("f({a})"),
                    16 => format!("heightfield({}).within(box(3))", m.formula()),
                    17 => format!("metaballs([({a}, {b}, {c}, 1), ({c}, {a}, {b}, {a})])"),
                    18 => "nothing".to_owned(),
                    _ if m.shapes => format!("g({a})"),
                    _ => m.pick(&["menger_sponge(1, 2)", "octahedron(1)", "prism(6, 1, 1)", "rounded_box(1, 0.1)"]).to_owned(),
                }
            },
        )
    }
}
