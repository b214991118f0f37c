//! What is hard for a field and for the rays through it.

use surefoot_compiler::vector::Vec3;

/// Something hard.
pub struct Case {
    /// Its name in the table.
    pub name: String,
    /// The scene.
    pub text: String,
    /// The rays that are sent.
    pub rays: Rays,
    /// Why some cell is red, where one is: a sentence.
    pub known: Option<&'static str>,
}

/// Rays of a case.
pub enum Rays {
    /// Those of the scene's camera, on a picture so many times smaller than others, each way.
    Camera(u32),
    /// The same, where nothing is certain of where rays end: the camera stands in the solid or on it, or proof is too costly. They must only end.
    Uncertain(u32),
    /// These, each from a point in a direction, and whether it is certain enough where they end: they keep a pixel away from what they pass.
    Aimed(Vec<(Vec3, Vec3, bool)>),
}

/// A camera from a place to another.
fn seen(eye: Vec3, target: Vec3) -> String {
    format!("camera {{ eye: {}, target: {}, fov: 40deg }}\n", vector(eye), vector(target))
}

fn vector([x, y, z]: Vec3) -> String {
    format!("({x}, {y}, {z})")
}

/// All cases, in their order.
pub fn cases() -> Vec<Case> {
    let mut all = Vec::new();
    let eye = [2.2, 1.6, 3.0];
    let mut add = |name: &str, scene: &str, smaller: u32| {
        let text = format!("scene = {scene}\n{}", seen(eye, [0.0; 3]));
        all.push(Case { name: name.to_owned(), text, rays: Rays::Camera(smaller), known: None });
    };
    add("thin blade, twist 3", "box((1, 3, 0.16)).twist(y, 3)", 1);
    for rate in [0.1, 0.3, 1.0, 3.0, 10.0, 20.0] {
        add(&format!("twist {rate}"), &format!("box((1, 2.4, 0.5)).twist(y, {rate})"), 1);
    }
    add("bend near its axis", "box((2.6, 1.2, 0.6)).bend(x, y, 1.5)", 1);
    add("bend over its axis", "box((2.6, 2, 0.6)).bend(x, y, 1.5)", 1);
    add("taper to a point", "cylinder(0.8, 2).taper(y, -1, 1, 0)", 1);
    add("taper nearly to a point", "cylinder(0.8, 2).taper(y, -1, 1, 0.001)", 1);
    for k in ["0", "0.000001", "4"] {
        add(&format!("smooth union, radius {k}"), &format!("smooth_union(sphere(0.6).translate(-0.3, 0, 0), box(0.8).translate(0.4, 0, 0), {k})"), 1);
    }
    add("shell 0.0001", "sphere(1).shell(0.0001) - box(2).translate(1, 1, 1)", 1);
    for (name, blend) in [("union", "union"), ("difference", "difference"), ("smooth union", "smooth_union")] {
        let (first, k) = match blend {
            "difference" => ("box(1.2)", ""),
            "smooth_union" => ("sphere(0.5)", ", 0.1"),
            _ => ("sphere(0.5)", ""),
        };
        add(&format!("100:1 ellipsoid, {name}"), &format!("{blend}({first}, ellipsoid((1, 0.01, 1)).rotate(x, 20deg){k})"), 1);
    }
    add("repetition off centre", "sphere(0.25).translate(0.4, 0.3, 0.1).repeat(1).within(sphere(1.4))", 2);
    add(
        "chamfers ten deep",
        "for i in 0..10 by chamfer_union(0.08) { box(0.5 + 0.3 * hash(i, 3)).rotate(y, 25deg * i).translate(hash(i, 0) - 0.5, hash(i, 1) - 0.5, hash(i, 2) - 0.5) }",
        1,
    );
    add("eight octaves", "sphere(1).displace(0.15 * fbm(2 * p, 8))", 4);
    add("a planet as ground", "sphere(1e6).translate(0, -1e6, 0) | sphere(0.7).translate(0, 0.5, 0)", 1);
    add("a hill of a planet", "sphere(2e5).translate(0, -2e5 - 0.4, 0) | smooth_union(sphere(3e6).translate(0, -3e6 - 0.5, 0), sphere(0.7), 0.2)", 1);
    for size in [1e-6, 1e-4, 1e-2, 1.0, 1e2, 1e4] {
        let scene = format!("(box({size}) & sphere({})) - cylinder({}, {})", 0.65 * size, 0.25 * size, 2.0 * size);
        let text = format!(
            "scene = {scene}\n{}render {{ max_distance: {}, extent: {} }}\n",
            seen(eye.map(|c| 0.5 * size * c), [0.0; 3]),
            20.0 * size,
            10.0 * size
        );
        all.push(Case { name: format!("a body of size {size:e}"), text, rays: Rays::Camera(1), known: None });
    }
    for far in [1.0, 1e2, 1e4, 1e6] {
        let place = [far, 0.7 * far, -far];
        let scene = format!("((box(1) & sphere(0.65)) - cylinder(0.25, 2)).translate({}) | torus(0.8, 0.1).translate({})", vector(place), vector(place));
        let from = [place[0] + 1.1, place[1] + 0.8, place[2] + 1.5];
        let text = format!("scene = {scene}\n{}render {{ max_distance: 20, extent: {} }}\n", seen(from, place), 2.0 * far + 10.0);
        all.push(Case { name: format!("moved by {far:e}"), text, rays: Rays::Camera(1), known: None });
    }
    for (name, eye, target) in [
        ("camera on a face", [0.0, 0.1, 0.5], [0.3, 0.2, 1.0]),
        ("camera on a face, along it", [0.0, 0.1, 0.5], [1.0, 0.1, 0.5]),
        ("camera at a corner", [0.5, 0.5, 0.5], [0.0, 0.0, 0.0]),
        ("camera inside", [0.1, 0.2, 0.1], [1.0, 0.0, 0.0]),
    ] {
        let text = format!("scene = box(1) | sphere(0.3).translate(0.9, 0.3, 0.9)\n{}", seen(eye, target));
        all.push(Case { name: name.to_owned(), text, rays: Rays::Uncertain(1), known: None });
    }
    let mut aimed = |name: &str, scene: &str, rays: Vec<(Vec3, Vec3, bool)>| {
        all.push(Case { name: name.to_owned(), text: format!("scene = {scene}\n"), rays: Rays::Aimed(rays), known: None });
    };
    // Exactly along, and beside it to either side, farther than a pixel is wide.
    let clear = |d: f64| d.abs() > 1e-3;
    let beside = || [0.0, 1e-7, -1e-7, 0.02, -0.02].into_iter();
    aimed("rays along faces", "box(1)", beside().flat_map(|d| [0.0, 0.2].map(|z| ([-3.0, 0.5 + d, z], [1.0, 0.0, 0.0], clear(d)))).collect());
    aimed("rays along edges", "box(1)", beside().map(|d| ([-3.0, 0.5 + d, 0.5 + d], [1.0, 0.0, 0.0], clear(d))).collect());
    aimed("rays tangent to a sphere", "sphere(1)", beside().map(|d| ([-3.0, 1.0 + d, 0.0], [1.0, 0.0, 0.0], clear(d))).collect());
    aimed("rays through corners", "box(1)", beside().map(|d| ([-2.0, 2.0 + d, -2.0], [1.0, -1.0, 1.0], clear(d))).collect());
    let grazing = |turn: f64| move |h: f64| ([0.0, h, 0.0], [1.0, -turn.to_radians().tan(), 0.1], true);
    let heights = [0.0005, 0.001, 0.005, 0.01];
    aimed("a plane grazed at 0.01°", "plane(y)", heights.into_iter().flat_map(|h| [grazing(0.01)(h), grazing(-0.01)(h)]).collect());
    let mut add = |name: &str, scene: &str, smaller: u32| {
        let text = format!("scene = {scene}\n{}", seen(eye, [0.0; 3]));
        all.push(Case { name: name.to_owned(), text, rays: Rays::Camera(smaller), known: None });
    };
    add("a - a", "(box(1) - box(1)) | sphere(0.3).translate(0.9, 0.3, 0.9)", 1);
    add("a | a, moved by a rounding", "box(1) | box(1).translate(0.00000006, 0, 0)", 1);
    add("xor(a, a)", "xor(box(1), box(1)) | sphere(0.3).translate(0.9, 0.3, 0.9)", 1);
    add("a capsule of no length", "capsule((0.1, 0, 0), (0.1, 0, 0), 0.5)", 1);
    add("a cylinder of no length", "cylinder((0.1, 0, 0), (0.1, 0, 0), 0.5) | sphere(0.3)", 1);
    add("a box of no height", "box((1, 0, 1)) | sphere(0.3)", 1);
    add("a sphere of no size", "sphere(0) | box(0.5).translate(0.5, 0, 0)", 1);
    let many = "for i in 0..10000 by smooth_union(0.012) { sphere(0.016 + 0.016 * hash(i, 3)).translate(2 * hash(i, 0) - 1, 2 * hash(i, 1) - 1, 2 * hash(i, 2) - 1) }";
    add("a union of 10,000", many, 4);
    if let Some(last) = all.last_mut() {
        last.rays = Rays::Uncertain(4);
    }
    for case in &mut all {
        case.known = case.known.or(KNOWN.iter().find(|(name, _)| *name == case.name).map(|(_, why)| *why));
    }
    all
}

/// What is not as it should be, and why.
const KNOWN: [(&str, &str); 1] = [(
    "taper nearly to a point",
    "near the point space is drawn a thousand times as thin as elsewhere; no bound is found for that, the one that is measured is so small that rays are spent",
)];

