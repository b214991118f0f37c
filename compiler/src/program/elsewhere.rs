//! What is called otherwise in other tools: whoever writes such a name is told ours.

use super::value::Value;
use super::{Elaborator, Env};
use crate::source::Span;
use crate::syntax::ast::{Argument, BlockKind, ExprKind};
use crate::syntax::words::{self, nearest};

/// A name of another tool, and ours. Those that begin like Quilez' (`sd`, `op`) stand without that beginning, in small letters.
const NAMES: [(&str, &str); 67] = [
    // Shadertoy, Quilez, hg_sdf.
    ("smin", "smooth_union"),
    ("smax", "smooth_intersection"),
    ("roundbox", "rounded_box"),
    ("cappedtorus", "capped_torus"),
    ("boxframe", "box_frame"),
    ("cappedcone", "capped_cone"),
    ("roundcone", "rounded_cone"),
    ("cappedcylinder", "cylinder"),
    ("hexprism", "prism"),
    ("triprism", "prism"),
    ("verticalcapsule", "capsule"),
    ("smoothmin", "smooth_union"),
    ("smoothmax", "smooth_intersection"),
    ("smoothunion", "smooth_union"),
    ("smoothsubtraction", "smooth_difference"),
    ("smoothintersection", "smooth_intersection"),
    ("subtraction", "difference"),
    ("rep", "repeat"),
    ("replim", "repeat"),
    ("limitedrepetition", "repeat"),
    ("repetition", "repeat"),
    ("cheapbend", "bend"),
    ("tx", "translate"),
    ("onion", "shell"),
    ("displacement", "displace"),
    ("extrusion", "extrude"),
    ("revolution", "revolve"),
    ("symx", "symmetry"),
    ("symxz", "symmetry"),
    ("pmod", "repeat"),
    ("pmod1", "repeat"),
    ("pmod2", "repeat"),
    ("pmod3", "repeat"),
    ("pmodpolar", "repeat_polar"),
    ("pr", "rotate"),
    ("fblob", "metaballs"),
    ("itime", "time"),
    ("iglobaltime", "time"),
    ("u_time", "time"),
    ("utime", "time"),
    ("lerp", "mix"),
    ("rsqrt", "inversesqrt"),
    ("m_pi", "pi"),
    ("two_pi", "tau"),
    ("snoise", "simplex"),
    ("cnoise", "perlin"),
    ("worley", "cellular"),
    ("voronoi", "cellular"),
    // OpenSCAD, Curv, Bauble, libfive, and what people say.
    ("cube", "box"),
    ("cuboid", "box"),
    ("ball", "sphere"),
    ("move", "translate"),
    ("linear_extrude", "extrude"),
    ("rotate_extrude", "revolve"),
    ("lathe", "revolve"),
    ("merge", "union"),
    ("subtract", "difference"),
    ("sub", "difference"),
    ("intersect", "intersection"),
    ("hollow", "shell"),
    ("thicken", "shell"),
    ("tile", "repeat"),
    ("kaleidoscope", "repeat_polar"),
    ("rect", "rectangle"),
    ("square", "rectangle"),
    ("line", "segment"),
    ("hexagon", "regular_polygon"),
];

/// What a name of another tool is called here. `known`: the names that a scene can use.
pub fn ours<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    let small = name.to_ascii_lowercase();
    let find = |name: &str| NAMES.iter().find(|(theirs, _)| *theirs == name).map(|(_, ours)| *ours);
    let bare = || ["sd", "op", "f"].iter().filter(|_| small != name).find_map(|begin| small.strip_prefix(begin));
    let wanted = find(&small).or_else(|| bare().map(|bare| find(bare).unwrap_or(bare)))?;
    known.iter().find(|k| **k == wanted).copied()
}

/// A key of a block as others call it, and ours.
const KEYS: [(&str, &str); 21] = [
    ("ao", "ambient_occlusion"),
    ("occlusion", "ambient_occlusion"),
    ("dir", "direction"),
    ("pos", "position"),
    ("strength", "intensity"),
    ("power", "intensity"),
    ("rough", "roughness"),
    ("shininess", "roughness"),
    ("metal", "metallic"),
    ("metalness", "metallic"),
    ("specular", "reflectivity"),
    ("diffuse", "color"),
    ("albedo", "color"),
    ("emissive", "emission"),
    ("from", "eye"),
    ("position", "eye"),
    ("to", "target"),
    ("look_at", "target"),
    ("lookat", "target"),
    ("background", "sky"),
    ("far", "max_distance"),
];

/// Blocks that a key of another one is looked for in: what belongs to the whole scene.
pub const BLOCKS: [BlockKind; 3] = [BlockKind::Render, BlockKind::Environment, BlockKind::Physics];

/// What a key of a block is called here that others call so, or that is nearest to it.
pub fn key<'a>(name: &str, known: &[&'a str]) -> Option<&'a str> {
    let small = name.to_ascii_lowercase();
    let ours = KEYS.iter().find(|(theirs, ours)| *theirs == small && known.contains(ours)).map(|(_, ours)| *ours);
    known.iter().copied().find(|k| ours == Some(*k)).or_else(|| nearest(name, known.iter().copied()))
}

/// Names of colours.
const COLORS: [(&str, &str); 14] = [
    ("red", "#ff0000"),
    ("green", "#00ff00"),
    ("blue", "#0000ff"),
    ("yellow", "#ffff00"),
    ("orange", "#ff8000"),
    ("white", "#ffffff"),
    ("black", "#000000"),
    ("purple", "#8000ff"),
    ("pink", "#ff80c0"),
    ("brown", "#804000"),
    ("cyan", "#00ffff"),
    ("magenta", "#ff00ff"),
    ("grey", "#808080"),
    ("gray", "#808080"),
];

/// How a colour is written that has a name elsewhere.
pub fn color(name: &str) -> Option<&'static str> {
    let small = name.to_ascii_lowercase();
    COLORS.iter().find(|(known, _)| *known == small).map(|(_, written)| *written)
}

/// What to write instead of a type before a name.
const LET: &str = "write `let name = value`: a type need not be said, and a name keeps its value";

/// What to write instead of a word of other languages that is no name here.
pub fn instead(word: &str) -> Option<&'static str> {
    let small = word.to_ascii_lowercase();
    Some(match small.as_str() {
        "up" | "down" | "left" | "right" | "forward" | "back" => "write `.translate(0, 1, 0)`: x is to the right, y up, z toward the eye",
        "translatex" | "movex" => "write `.translate(1, 0, 0)`",
        "translatey" | "movey" => "write `.translate(0, 1, 0)`",
        "translatez" | "movez" => "write `.translate(0, 0, 1)`",
        "rotatex" => "write `.rotate(x, 45deg)`",
        "rotatey" => "write `.rotate(y, 45deg)`",
        "rotatez" => "write `.rotate(z, 45deg)`",
        "scalex" | "scaley" | "scalez" | "resize" => "write `.stretch(2, 1, 1)`; the same along all axes is `.scale(2)`",
        "gold" => "declare it: `material gold { color: #d4af37, metallic: 1, roughness: 0.3 }`",
        "silver" | "steel" | "chrome" => "declare it: `material steel { color: #c0c4c8, metallic: 1, roughness: 0.2 }`, and write `steel`",
        "metal" => "declare it: `material metal(c: color) { color: c, metallic: 1, roughness: 0.3 }`, and write `metal(#cccccc)`",
        "plastic" => "declare it: `material plastic(c: color) { color: c, roughness: 0.4 }`, and write `plastic(#cc0000)`",
        "wood" | "stone" | "clay" => "declare it: `material clay { color: #b0785a, roughness: 0.8 }`, and write `clay`",
        "rot" | "rot2" | "rot2d" | "rotate2d" | "rotate2" | "r2" => "a turn is not of a matrix: write `rotate(p, y, 0.5)` for a point, `.rotate(y, 0.5)` for a shape",
        "and" => "write `a && b`",
        "or" => "write `a || b`",
        "not" => "write `!a`",
        "lambda" => "write `fn name(a: float) = …` outside, and its name here",
        "range" => "write `for i in 0..5 { … }`",
        "vec2f" | "vector2" => "write `vec2(x, y)`, or `(x, y)` alone",
        "vec3f" | "vector3" | "float3" => "write `vec3(x, y, z)`, or `(x, y, z)` alone",
        "vec4f" | "vector4" | "float4" => "write `vec4(x, y, z, w)`, or `(x, y, z, w)` alone",
        "math" | "np" | "numpy" => "write the function alone: `sin(a)`, `sqrt(a)`, `pi`",
        "polyhedron" => "write a solid of its planes, `plane(…) & plane(…)`, or a `mesh`",
        "color" | "colour" | "colored" => "write `.material(swatch(#ff0000))`; what has a name is declared, `material red { color: #ff0000 }`",
        "minkowski" | "inflate" | "dilate" | "grow" => "what a ball makes thicker is `.round(0.1)`; there is no sum of two other shapes",
        "render" | "draw" | "show" => "write `scene = ` and the shape",
        "noise" | "snoise" => "write `perlin(p)`, `simplex(p)`, `value_noise(p)`, or `fbm(p)` for several of it",
        "random" | "rand" | "rnd" => "write `hash(i)`, a number from 0 to 1 that is another for each `i`",
        "roundedcylinder" | "round_cylinder" => "write `rounded_cylinder(radius, height, 0.1)`",
        "letter" | "font" | "label" => "write `text(\"Surefoot\", size: 1)`, a drawing of words; `font: \"Name.ttf\"` names a font",
        "len" => "write `length(v)` for a vector, `list.count` for a list",
        "texture2d" | "texture" | "sampler2d" | "ichannel0" | "ichannel1" => "an image is laid on by a material: `material m { texture: \"image.png\" }`",
        "t" => "write `time`, in seconds, or declare it: `let t = …`",
        "return" => words::NO_RETURN,
        "uniform" => "write `param name = 1 in 0..2`, which makes a slider",
        "rgb" | "rgba" => "write `(r, g, b)` with each of them from 0 to 1, or a colour like `#ff8000`",
        "int" | "float" | "bool" => LET,
        _ if words::TYPES_ELSEWHERE.contains(&word) => LET,
        _ => return None,
    })
}

/// Whether a name is one of Quilez' distances, which take the point first.
pub fn is_of_point(name: &str) -> bool {
    name.strip_prefix("sd").is_some_and(|rest| rest.starts_with(|c: char| c.is_ascii_uppercase()))
}

impl Elaborator<'_> {
    /// What to write instead of a call that other tools know, with its arguments filled in.
    pub(super) fn filled_in(&self, name: &str, known: &[(Value, Span)], args: &[Argument], env: &Env) -> Option<String> {
        let text = |span: Span| self.sources.text(span);
        let first = known.first().map(|(_, at)| *at).or(args.first().map(|a| a.value.span));
        match name.to_ascii_lowercase().as_str() {
            "cube" => {
                // A list stands for a vector; `center` and what else is named is left out.
                let sizes = args.iter().filter(|a| a.name.as_ref().is_none_or(|n| &*n.text == "size")).map(|a| match &a.value.kind {
                    ExprKind::List(_) => format!("({})", text(a.value.span).trim_matches(['[', ']'])),
                    _ => text(a.value.span).to_owned(),
                });
                let given: Vec<String> = known.iter().map(|(_, at)| text(*at).to_owned()).chain(sizes).filter(|size| size != "true" && size != "false").collect();
                let given = if given.is_empty() { "1".to_owned() } else { given.join(", ") };
                Some(match env.point {
                    Some(_) => format!("the third power is `cubed({given})`; a shape is `box({given})`"),
                    None => format!("write `box({given})`"),
                })
            }
            "fillet" | "chamfer" | "bevel" => {
                let rounds = name.eq_ignore_ascii_case("fillet");
                let by = args.last().filter(|_| known.len() + args.len() > 1).map_or("0.1", |a| text(a.value.span));
                let (boxes, drawings, amount) = if rounds { ("rounded_box", "rounded_rectangle", "radius") } else { ("chamfered_box", "", "chamfer") };
                let shape = first.map_or("", text);
                let of = |theirs: &str, ours: &str| {
                    let sizes = inside_parentheses(shape.strip_prefix(theirs)?)?;
                    let amount = if sizes.contains(':') { format!("{amount}: ") } else { String::new() };
                    Some(format!("write `{ours}({sizes}, {amount}{by})`, which is as large as `{theirs}({sizes})`"))
                };
                let instead = of("box", boxes).or_else(|| of("rectangle", drawings).filter(|_| rounds));
                let kind = if rounds { "round" } else { "chamfer" };
                Some(instead.unwrap_or_else(|| {
                    let whole = match rounds {
                        true => format!("a cylinder is `rounded_rectangle((2 * radius, height), {by}).revolve()`"),
                        false => format!("of a drawing it is `.extrude(height, {by})`"),
                    };
                    format!("a box is `{boxes}(size, {by})`, {whole}; where two shapes meet write `{kind}_union(a, b, {by})` or `{kind}_intersection(a, b, {by})`")
                }))
            }
            _ => None,
        }
    }
}

/// What stands in the parentheses with which a text begins.
fn inside_parentheses(text: &str) -> Option<&str> {
    let mut depth = 0;
    let end = text.find(|c| {
        depth += match c {
            '(' => 1,
            ')' => -1,
            _ => 0,
        };
        depth <= 0
    })?;
    text.get(..end)?.strip_prefix('(')
}

#[cfg(test)]
mod tests {
    use super::{NAMES, instead, ours};
    use crate::diagnostic::Code;
    use crate::{MemoryLoader, Options, compile};

    /// Whether a name is nothing that a scene can use.
    fn is_unknown(name: &str) -> bool {
        let loader = MemoryLoader::new().with("scene.sdf", format!("scene = sphere({name}(1))\n"));
        let found = compile(&loader, "scene.sdf", &Options::default()).diagnostics;
        found.iter().any(|d| d.code == Code::UnknownName)
    }

    #[test]
    fn names_of_others_are_free_and_lead_to_ours() {
        for (theirs, ours) in NAMES {
            assert!(is_unknown(theirs), "`{theirs}` is a name of ours");
            assert!(!is_unknown(ours), "`{ours}` is no name of ours");
        }
    }

    #[test]
    fn words_of_others_are_free_and_what_is_said_of_them_is_right() {
        for word in ["return", "var", "const", "uniform", "rgb"] {
            assert!(is_unknown(word) && instead(word).is_some(), "`{word}`");
        }
        let errors = |text: &str| {
            let loader = MemoryLoader::new().with("scene.sdf", text.to_owned());
            compile(&loader, "scene.sdf", &Options::default()).diagnostics.into_iter().map(|d| d.help).collect::<Vec<_>>()
        };
        assert!(errors("field f = { return (length(p) - 1) }\nscene = f\n")[0].contains("without `return`"));
        assert!(errors("field f = length(p) - 1\nfn g(p: vec3) = 1\nscene = g(p)\n")[0].contains("`field f = …`, and write `f` here"));
        assert!(errors("field f = { let q = abs(p); sdBox(q, (1, 1, 1)) }\nscene = f\n")[0].contains("`box(…).at(q)`"));
        assert!(errors("field f = { let q = abs(p); box((2, 2, 2)).at(q) }\nscene = f\n").is_empty());
        assert!(errors("scene = sphere(1).translate(0, 1)\n")[0].contains("`translate(x, y, z)`"));
        assert!(errors("scene = sphere(1).material(#f00)\n")[0].contains("`swatch(#f00)`"));
        assert!(errors("scene = sphere(1).material(swatch(#f00))\n").is_empty());
        assert!(errors("scene = for c in grid((2, 0, 2)) { sphere(0.2 + 0.5 * hash(c + 1)) }\n").is_empty());
        // Each is told what works when it is followed.
        for (wrong, told, right) in [
            ("scene = cube(1)\n", "`box(1)`", "scene = box(1)\n"),
            ("scene = sphere(1).translateX(1)\n", "`.translate(1, 0, 0)`", "scene = sphere(1).translate(1, 0, 0)\n"),
            ("scene = box(1).rotateY(45deg)\n", "`.rotate(y, 45deg)`", "scene = box(1).rotate(y, 45deg)\n"),
            ("scene = box(1).rotate(0, 45, 0)\n", "`.rotate(y, 45deg)`", "scene = box(1).rotate(y, 45deg)\n"),
            ("scene = sphere(1).scale(1, 2, 1)\n", "`.stretch(1, 2, 1)`", "scene = sphere(1).stretch(1, 2, 1)\n"),
            ("scene = box(1).rotate(45deg, y)\n", "`rotate(axis, angle)`", "scene = box(1).rotate(y, 45deg)\n"),
            ("scene = translate([1, 0, 0], sphere(1))\n", "`shape.translate(v)`", "scene = sphere(1).translate((1, 0, 0))\n"),
            ("scene = sphere(1).displace(0.1 * noise(p))\n", "`fbm(p)`", "scene = sphere(1).displace(0.1 * fbm(p))\n"),
            ("scene = sphere(0.5 + 0.1 * random(3))\n", "`hash(i)`", "scene = sphere(0.5 + 0.1 * hash(3))\n"),
            ("scene = sphere(1).repeat()\n", "`.repeat(size)`", "scene = sphere(1).repeat(4)\n"),
            ("field map(p: vec3) = length(p) - 1\nscene = map\n", "`field map = …`", "field map = length(p) - 1\nscene = map\n"),
            ("scene = sphere(1).material(gold)\n", "material gold {", "material gold { color: #d4af37, metallic: 1, roughness: 0.3 }\nscene = sphere(1).material(gold)\n"),
            ("translate([1, 2, 3]) sphere(1)\n", "`scene = sphere(1).translate(1, 2, 3)`", "scene = sphere(1).translate(1, 2, 3)\n"),
            ("const float R = 1.0\nscene = sphere(R)\n", "`let R = …`", "let R = 1.0\nscene = sphere(R)\n"),
            ("#define R 1.5\nscene = sphere(1)\n", "`let R = 1.5`", "let R = 1.5\nscene = sphere(R)\n"),
            ("# a ball\nscene = sphere(1)\n", "`// a ball`", "// a ball\nscene = sphere(1)\n"),
            ("light { dir: (0, -1, 0) }\nscene = sphere(1)\n", "`direction`", "light { direction: (0, -1, 0) }\nscene = sphere(1)\n"),
            ("let sphere = 2\nscene = sphere(1)\n", "another name", "let size = 2\nscene = sphere(1)\n"),
            ("field f = p.x ** 2 + length(p) - 1\nscene = sphere(1)\n", "`pow(a, b)`", "field f = pow(p.x, 2) + length(p) - 1\nscene = sphere(1)\n"),
            ("field f = p.x ** 2 + length(p) - 1\nscene = sphere(1)\n", "`sq(a)`", "field f = sq(p.x) + length(p) - 1\nscene = sphere(1)\n"),
            ("scene = for c in grid((2, 2)) { sphere(0.5) }\n", "`grid((2, 0, 2))`", "scene = for c in grid((2, 0, 2)) { sphere(0.5) }\n"),
            ("scene = for k in polar(6) { sphere(0.3).translate(1, 0, 0) }\n", "`polar(y, 6)`", "scene = for k in polar(y, 6) { sphere(0.3).translate(1, 0, 0) }\n"),
            ("scene = max(sphere(1), box(1))\n", "`a & b`", "scene = sphere(1) & box(1)\n"),
            ("scene = min(sphere(1), box(1))\n", "`a | b`", "scene = sphere(1) | box(1)\n"),
            ("scene = max(-sphere(1), box(1.7))\n", "`b - a`", "scene = box(1.7) - sphere(1)\n"),
            ("scene = heightfield(sin(x) * cos(z))\n", "`p.x`", "scene = heightfield(sin(p.x) * cos(p.z))\n"),
            ("field f = x * x + y * y - 1\nscene = f\n", "`p.x`", "field f = p.x * p.x + p.y * p.y - 1\nscene = f.within(box(2))\n"),
            ("scene = polygon((0, 1), (1, 2), (0, 2)).extrude(1)\n", "`polygon([(0, 0), (1, 0), (0, 1)])`", "scene = polygon([(0, 0), (1, 0), (0, 1)]).extrude(1)\n"),
            ("scene = sphere(1).material({ color: #f00 })\n", "`swatch(#ff0000)`", "scene = sphere(1).material(swatch(#ff0000))\n"),
            ("scene = sphere(1).red\n", "`.material(swatch(#ff0000))`", "scene = sphere(1).material(swatch(#ff0000))\n"),
            ("scene = sphere(1).material(metal(#ccc))\n", "`material metal(c: color) {", "material metal(c: color) { color: c, metallic: 1, roughness: 0.3 }\nscene = sphere(1).material(metal(#ccc))\n"),
            ("param a = 1, 0..2\nscene = sphere(a)\n", "`param height = 2 in 1..5`", "param a = 1 in 0..2\nscene = sphere(a)\n"),
            ("param a: 0..2 = 1\nscene = sphere(a)\n", "`param height = 2 in 1..5`", "param a = 1 in 0..2\nscene = sphere(a)\n"),
            ("scene = for (i in 0..3) { sphere(1).translate(i, 0, 0) }\n", "`for i in 0..n { … }`", "scene = for i in 0..3 { sphere(1).translate(i, 0, 0) }\n"),
            ("sun { direction: (0, -1, 0) }\nscene = sphere(1)\n", "`light sun { … }`", "light sun { direction: (0, -1, 0) }\nscene = sphere(1)\n"),
            ("sky { color: #f00 }\nscene = sphere(1)\n", "`environment { sky:", "environment { sky: #f00 }\nscene = sphere(1)\n"),
            ("scene = sphere(1) | ground\n", "declare it", "shape ground = plane(y, -1)\nscene = sphere(1) | ground\n"),
            ("scene = sphere(i)\n", "declare it", "let i = 1\nscene = sphere(i)\n"),
            ("field f = lenght(p) - 1\nscene = f\n", "`length`", "field f = length(p) - 1\nscene = f\n"),
            ("render { ao: off }\nscene = sphere(1)\n", "`ambient_occlusion`", "render { ambient_occlusion: off }\nscene = sphere(1)\n"),
            ("field f = { p.xz *= rot(0.5); length(p) - 1 }\nscene = f\n", "`let p2 = rotate(p, y, 0.5);`", "field f = { let p2 = rotate(p, y, 0.5); length(p2) - 1 }\nscene = f\n"),
            ("field f = { let q = rot(0.5) * p; length(q) - 1 }\nscene = f\n", "`rotate(p, y, 0.5)`", "field f = { let q = rotate(p, y, 0.5); length(q) - 1 }\nscene = f\n"),
            ("let a = [1, 2]\nscene = for i in 0..a.length { sphere(a[i]) }\n", "`.count`", "let a = [1, 2]\nscene = for i in 0..a.count { sphere(a[i]) }\n"),
            ("field f = { let q = abs(p); q.y -= 0.5; length(q) - 1 }\nscene = f\n", "`let q2 = q - … * (0, 1, 0);`", "field f = { let q = abs(p); let q2 = q - 0.5 * (0, 1, 0); length(q2) - 1 }\nscene = f\n"),
            ("scene = sphere(1).translate(x: 1)\n", "`(1, 0, 0)`", "scene = sphere(1).translate(1, 0, 0)\n"),
            ("scene = box(1).fillet(0.1)\n", "`rounded_box(1, 0.1)`", "scene = rounded_box(1, 0.1)\n"),
            ("scene = fillet(box(1, 2, 3), 0.1)\n", "`rounded_box(1, 2, 3, 0.1)`", "scene = rounded_box(1, 2, 3, 0.1)\n"),
            ("scene = box(size: 2).translate(x).fillet(0.1)\n", "`rounded_box(size: 2, radius: 0.1)`", "scene = rounded_box(size: 2, radius: 0.1)\n"),
            ("scene = rectangle(1).fillet(0.1).extrude(1)\n", "`rounded_rectangle(1, 0.1)`", "scene = rounded_rectangle(1, 0.1).extrude(1)\n"),
            ("let a = cylinder(1, 2)\nscene = a.fillet(0.2)\n", "`round_union(a, b, 0.2)`", "scene = round_union(box(1), sphere(1).translate(x), 0.2)\n"),
            ("scene = cylinder(0.5, 2).fillet(0.2)\n", "`rounded_rectangle((2 * radius, height), 0.2).revolve()`", "scene = rounded_rectangle((1, 2), 0.2).revolve()\n"),
            ("scene = chamfer(sphere(1) & box(1.5), 0.1)\n", "`chamfer_intersection(a, b, 0.1)`", "scene = chamfer_intersection(sphere(1), box(1.5), 0.1)\n"),
            ("scene = box(1).chamfer(0.1)\n", "`chamfered_box(1, 0.1)`", "scene = chamfered_box(1, 0.1)\n"),
            ("scene = star(5, 1, 0.5).extrude(1).bevel(0.1)\n", "`.extrude(height, 0.1)`", "scene = star(5, 1, 0.5).extrude(1, 0.1)\n"),
            ("let s = 2\nscene = cube(s)\n", "`box(s)`", "let s = 2\nscene = box(s)\n"),
            ("scene = cube((1, 2, 3)).translate(x)\n", "`box((1, 2, 3))`", "scene = box((1, 2, 3)).translate(x)\n"),
            ("scene = cube(1, 2, 3)\n", "`box(1, 2, 3)`", "scene = box(1, 2, 3)\n"),
            ("scene = cube(size: [1, 2, 3], center: true)\n", "`box((1, 2, 3))`", "scene = box((1, 2, 3))\n"),
            ("scene = cube()\n", "`box(1)`", "scene = box(1)\n"),
            ("scene = heightfield(cube(p.x)).within(box(2))\n", "`cubed(p.x)`", "scene = heightfield(cubed(p.x)).within(box(2))\n"),
            ("scene = heightfield(p.x.cube()).within(box(2))\n", "`cubed(p.x)`", "scene = heightfield(cubed(p.x)).within(box(2))\n"),
            ("scene = sphere(1).material(red)\n", "`swatch(#ff0000)`", "scene = sphere(1).material(swatch(#ff0000))\n"),
            ("scene = sphere(0.5).at((1, 0, 0))\n", "`.translate(1, 2, 3)`", "scene = sphere(0.5).translate(1, 2, 3)\n"),
            ("scene = sphere(1) and box(1.7)\n", "`a & b`", "scene = sphere(1) & box(1.7)\n"),
            ("scene = sphere(1) or box(1.7)\n", "`a | b`", "scene = sphere(1) | box(1.7)\n"),
            ("scene = box(1) translate(1, 0, 0)\n", "behind a dot", "scene = box(1).translate(1, 0, 0)\n"),
            ("scene = sphere(1).color(#f00)\n", "`.material(swatch(#ff0000))`", "scene = sphere(1).material(swatch(#ff0000))\n"),
            ("scene = minkowski(box(1), sphere(0.1))\n", "`.round(0.1)`", "scene = box(1).round(0.1)\n"),
            ("scene = sphere(1) * 2\n", "`.scale(2)`", "scene = sphere(1).scale(2)\n"),
            ("scene = for i in 0..10 step 2 { sphere(0.5).translate(i, 0, 0) }\n", "`2 * i`", "scene = for i in 0..5 { sphere(0.5).translate(2 * i, 0, 0) }\n"),
            ("scene = translate([1, 2, 3]) sphere(1)\n", "`sphere(1).translate(1, 2, 3)`", "scene = sphere(1).translate(1, 2, 3)\n"),
            ("scene = translate([1, 2, 3]) rotate([0, 0, 45]) cube([1, 2, 3])\n", "`box((1, 2, 3)).rotate(z, 45deg).translate(1, 2, 3)`", "scene = box((1, 2, 3)).rotate(z, 45deg).translate(1, 2, 3)\n"),
            ("translate([1, 2, 3]) sphere(1);\n", "`scene = sphere(1).translate(1, 2, 3)`", "scene = sphere(1).translate(1, 2, 3)\n"),
            ("scene = hull() { sphere(1); translate([2, 0, 0]) sphere(1); }\n", "`hull(a, b)`", "scene = hull(sphere(1), sphere(1).translate(2, 0, 0))\n"),
            ("hull() { sphere(1); translate([2, 0, 0]) sphere(1); }\n", "`scene = hull(a, b)`", "scene = hull(sphere(1), sphere(1).translate(2, 0, 0))\n"),
            ("scene = difference() { sphere(1); cube(2); }\n", "`(a - b)`", "scene = sphere(1) - box(2)\n"),
            ("scene = linear_extrude(height = 5) square(2);\n", "`rectangle(2).extrude(5)`", "scene = rectangle(2).extrude(5)\n"),
            ("scene = scale([1, 2, 1]) union() { sphere(1); cube(2); }\n", "`(a | b).stretch(1, 2, 1)`", "scene = (sphere(1) | box(2)).stretch(1, 2, 1)\n"),
            ("module foo(a) { sphere(a); }\nscene = sphere(1)\n", "`shape foo(…) = …`", "shape foo(a) = sphere(a)\nscene = foo(1)\n"),
            ("param b: bool = true\nscene = if b then sphere(1) else box(1)\n", "`if condition { a } else { b }`", "param b: bool = true\nscene = if b { sphere(1) } else { box(1) }\n"),
            ("scene = sphere(1)\nenvironment { ambient_occlusion: off }\n", "`render { ambient_occlusion: … }`", "scene = sphere(1)\nrender { ambient_occlusion: off }\n"),
            ("material m { color: 0xf00 }\nscene = sphere(1).material(m)\n", "`#f00`", "material m { color: #f00 }\nscene = sphere(1).material(m)\n"),
            ("light a { direction: (1, -1, 0), shadows: soft(8) }\nscene = sphere(1)\n", "`shadow`", "light a { direction: (1, -1, 0), shadow: soft(8) }\nscene = sphere(1)\n"),
            ("material m { color: 0xff0000 }\nscene = sphere(1).material(m)\n", "`#ff0000`", "material m { color: #ff0000 }\nscene = sphere(1).material(m)\n"),
            ("scene = translate((1, 0, 0), sphere(1))\n", "`shape.translate(v)`", "scene = sphere(1).translate((1, 0, 0))\n"),
            ("scene = cube([1, 2, 3])\n", "`box((1, 2, 3))`", "scene = box((1, 2, 3))\n"),
            ("scene = circle(1).extrude(z, 2)\n", "`.extrude(height)`", "scene = circle(1).extrude(2)\n"),
            ("scene = for k in polar(6, y) { sphere(0.3).translate(1, 0, 0) }\n", "`polar(y, 6)`", "scene = for k in polar(y, 6) { sphere(0.3).translate(1, 0, 0) }\n"),
            ("scene = sphere(0.3).translate(1, 0, 0).polar(6)\n", "`.repeat_polar(y, 6)`", "scene = sphere(0.3).translate(1, 0, 0).repeat_polar(y, 6)\n"),
            ("light(direction: (0, -1, 0))\nscene = sphere(1)\n", "`light sun {", "light sun { direction: (-1, -2, -1), intensity: 3 }\nscene = sphere(1)\n"),
            ("let paint = swatch(#f00)\nscene = sphere(1).paint(box(1), paint)\n", "another name", "let red = swatch(#f00)\nscene = sphere(1).paint(box(1), red)\n"),
            ("fn f(x: float): float = x * 2\nscene = sphere(f(1))\n", "leave the type out", "fn f(x: float) = x * 2\nscene = sphere(f(1))\n"),
            ("field f = { let d = length(p) - 1; return d; }\nscene = f\n", "without `return`", "field f = { let d = length(p) - 1; d }\nscene = f\n"),
            ("scene = sphere(1) |> translate(1, 0, 0)\n", "`sphere(1).translate(1, 2, 3)`", "scene = sphere(1).translate(1, 0, 0)\n"),
            ("scene = sphere(1) >> move [1, 0, 0]\n", "`sphere(1).translate(1, 2, 3)`", "scene = sphere(1).translate(1, 0, 0)\n"),
            ("scene = rectangle(1, 2).rotate(z, 1).extrude(1)\n", "`rotate(angle)`", "scene = rectangle(1, 2).rotate(1).extrude(1)\n"),
            ("scene = [sphere(1), box(1)]\n", "`for s in [a, b] { s }`", "scene = for s in [sphere(1), box(1)] { s }\n"),
            ("(sphere 1)\nscene = sphere(1)\n", "`scene = sphere(1) | box(1).translate(2, 0, 0)`", "scene = sphere(1) | box(1).translate(2, 0, 0)\n"),
            ("fn smin(a, b, k) = min(a, b) - k * 0.1\nscene = smin(sphere(1), box(1.7), 0.2)\n", "`blend name(a, b, k: float) = …`", "blend smin(a, b, k: float) = min(a, b) - k * 0.1\nscene = sphere(1).smin(box(1.7), 0.2)\n"),
            ("fn smin(a, b, k) = a + b - k\nscene = smin(sphere(1), box(1.7), 0.2)\n", "`blend name(a, b, k: float) = …`", "blend sum(a, b, k: float) = min(a, b) - k * 0.1\nscene = sphere(1).sum(box(1.7), 0.2)\n"),
            ("blend b(a: shape, b: shape, k: float) = min(a, b) - k\nscene = sphere(1).b(box(1.7), 0.1)\n", "have no type", "blend b(a, b, k: float) = min(a, b) - k\nscene = sphere(1).b(box(1.7), 0.1)\n"),
            ("scene = sphere(1).extrude(2)\n", "`.elongate((0, 1, 0))`", "scene = sphere(1).elongate((0, 1, 0))\n"),
            ("scene = sphere(hash(1.5))\n", "`hash(floor(a))`", "scene = sphere(hash(floor(1.5)))\n"),
            ("param r: 1 in 0..2\nscene = sphere(r)\n", "`param height = 2 in 1..5`", "param r = 1 in 0..2\nscene = sphere(r)\n"),
            ("param r = 1, 0, 2\nscene = sphere(r)\n", "`param height = 2 in 1..5`", "param r = 1 in 0..2\nscene = sphere(r)\n"),
            ("param r = 1 min 0 max 2\nscene = sphere(r)\n", "`param height = 2 in 1..5`", "param r = 1 in 0..2\nscene = sphere(r)\n"),
            ("scene = for i in 0..3 by smooth_union { sphere(1).translate(i, 0, 0) }\n", "by smooth_union(k)", "scene = for i in 0..3 by smooth_union(0.1) { sphere(1).translate(i, 0, 0) }\n"),
            ("material m { color: #f00 }\nscene = sphere(1).m\n", "`.material(m)`", "material m { color: #f00 }\nscene = sphere(1).material(m)\n"),
            ("material m { color: #f00 }\nscene = m(sphere(1))\n", "`.material(m)`", "material m { color: #f00 }\nscene = sphere(1).material(m)\n"),
            ("material m { opacity: 0.5 }\nscene = sphere(1).material(m)\n", "`transmission: 1`", "material m { }\nscene = sphere(1).material(m)\n"),
            ("scene = box(1, center=true)\n", "leave it out", "scene = box(1)\n"),
            ("scene = cylinder(h=1, radius: 2)\n", "`height: …`", "scene = cylinder(height: 1, radius: 2)\n"),
            ("scene = cylinder(height=1, radius: 2)\n", "`height: …`", "scene = cylinder(height: 1, radius: 2)\n"),
            ("let balls = sphere(1)\nscene = balls | balls.translate(3, 0, 0)\n", "`my_balls`", "let my_balls = sphere(1)\nscene = my_balls | my_balls.translate(3, 0, 0)\n"),
            ("scene = sphere(1)\ncamera { lookAt: (0, 0, 0) }\n", "`target`", "scene = sphere(1)\ncamera { target: (0, 0, 0) }\n"),
            ("scene = for i in 0..10..2 { sphere(0.5).translate(i, 0, 0) }\n", "`2 * i`", "scene = for i in 0..5 { sphere(0.5).translate(2 * i, 0, 0) }\n"),
            ("scene = box((1, 1, 1), 0.1)\n", "`rounded_box(size, radius)`", "scene = rounded_box((1, 1, 1), 0.1)\n"),
            ("scene = sphere(1).up(3)\n", "`.translate(0, 1, 0)`", "scene = sphere(1).translate(0, 3, 0)\n"),
            ("scene = smoothmin(sphere(1), box(1.7), 0.2)\n", "`smooth_union`", "scene = smooth_union(sphere(1), box(1.7), 0.2)\n"),
            ("module leg(h) { sphere(h); }\nscene = leg(1)\n", "`shape leg(…) = …`", "shape leg(h) = sphere(h)\nscene = leg(1)\n"),
            ("fn f(x) { return x * 2 }\nscene = sphere(f(1))\n", "`fn double(t: float) = 2 * t`", "fn f(x) = { x * 2 }\nscene = sphere(f(1))\n"),
            ("param b: bool = true\nscene = if b sphere(1) else box(1)\n", "`if condition { a } else { b }`", "param b: bool = true\nscene = if b { sphere(1) } else { box(1) }\n"),
        ] {
            let found = errors(wrong);
            assert!(found.len() == 1 && found[0].contains(told), "{wrong}{found:?}");
            assert!(errors(right).is_empty(), "{right}{:?}", errors(right));
        }
    }

    #[test]
    fn their_beginnings_are_left_out() {
        let known = ["box", "smooth_union", "rounded_box", "repeat", "repeat_polar", "time"];
        let names = ["sdBox", "opSmoothUnion", "sdRoundBox", "opRep", "pModPolar", "iTime", "lerp", "fog"];
        let found = names.map(|name| ours(name, &known));
        let wanted = ["box", "smooth_union", "rounded_box", "repeat", "repeat_polar", "time"].map(Some);
        assert_eq!((&found[..6], &found[6..]), (&wanted[..], &[None, None][..]));
    }
}
