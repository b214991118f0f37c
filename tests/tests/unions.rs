//! Unions of many: their tables and cells give the field that the formulas give, everywhere.

use crate::common::gpu;
use surefoot_compiler::compiled::{Compiled, Export, Live};
use surefoot_compiler::evaluate::Tape;
use surefoot_compiler::graph::Function;
use surefoot_compiler::random::Random;
use surefoot_compiler::{MemoryLoader, Options, compile};
use surefoot_runtime::{Gpu, evaluate};

const POINTS: usize = 20_000;

fn scene(text: &str) -> Compiled {
    let outcome = compile(&MemoryLoader::new().with("scene.sdf", text), "scene.sdf", &Options::default());
    assert!(!outcome.has_errors(), "{:?}", outcome.diagnostics);
    outcome.compiled.unwrap()
}

fn corpus(name: &str) -> Compiled {
    let path = format!("{}/corpus/large/{name}.sdf", env!("CARGO_MANIFEST_DIR"));
    scene(&std::fs::read_to_string(path).unwrap())
}

/// Points near the origin, farther out, and far beyond all cells.
fn points(half: f64) -> Vec<[f32; 3]> {
    let mut random = Random(7);
    let scales = [1.0, 1.0, 2.0, 30.0];
    (0..POINTS).map(|i| random.within(half * scales[i % 4]).map(|c| c as f32)).collect()
}

/// A function's values in 64 bits.
fn values(compiled: &Compiled, live: &Live, function: Function, points: &[[f32; 3]]) -> Vec<f64> {
    let formula = compiled.functions.formulas[&(compiled.root, function)];
    let tape = Tape::new(&compiled.graph, &compiled.functions.formulas, &[formula], live, 8_000_000).unwrap();
    let wide: Vec<[f64; 3]> = points.iter().map(|p| p.map(f64::from)).collect();
    let mut all = vec![0.0; points.len()];
    tape.evaluator().at(&wide, &[], |i, values| all[i] = values[0]);
    all
}

/// From a factor like this on the distance is estimated by its slope alone, also from so far away, where it is a guess.
const STEEP: f64 = 7.5;
const FAR: f64 = 0.5;

/// The device's field, distance and gradient are those of the formulas, and its bound is no more than that.
fn agrees(gpu: &Gpu, compiled: &Compiled, half: f64) {
    agrees_at(gpu, compiled, &compiled.live(), half);
}

fn agrees_at(gpu: &Gpu, compiled: &Compiled, live: &Live, half: f64) {
    let points = points(half);
    let field = values(compiled, live, Function::Field, &points);
    let distance = values(compiled, live, Function::Distance, &points);
    let of = |export| evaluate(gpu, compiled, live, [0.0; 3], export, &points).unwrap();
    let gradients: Vec<f32> = of(Export::Gradient).chunks(4).map(|g| g[3]).collect();
    let found = [of(Export::Field), gradients, of(Export::Distance)];
    // The estimate of the distance divides by a slope, which is off by as much as it changes over what a point is off: of waves as the square of how steep
    // they are. Far from what is steep it goes by slopes of whichever is the least there, and is a guess.
    let steepest = compiled.graph.factors.iter().map(|f| f.lipschitz).fold(1.0, f64::max);
    for (i, point) in points.iter().enumerate() {
        for ((name, formula), values) in [("field", &field), ("gradient", &field), ("distance", &distance)].iter().zip(&found) {
            let off = (f64::from(values[i]) - formula[i]).abs();
            let allowed = match *name {
                "distance" if steepest > STEEP && formula[i].abs() > FAR => 0.5 * formula[i].abs(),
                "distance" if steepest > STEEP => steepest * steepest * room(point),
                _ => room(point),
            };
            assert!(off < allowed, "{name} at {point:?}: {} and not {}", values[i], formula[i]);
        }
    }
    bounds(gpu, compiled, live, &points);
}

/// What 32 bits may lose at a point.
fn room(point: &[f32; 3]) -> f64 {
    1e-5 * point.iter().fold(1.0, |m: f64, c| m.max(f64::from(c.abs())))
}

/// The device's bound is no more than that of the formulas.
fn bounds(gpu: &Gpu, compiled: &Compiled, live: &Live, points: &[[f32; 3]]) {
    let bound = values(compiled, live, Function::Bound, points);
    let found = evaluate(gpu, compiled, live, [0.0; 3], Export::Bound, points).unwrap();
    for ((point, bound), device) in points.iter().zip(bound).zip(found) {
        let (device, room) = (f64::from(device), room(point));
        assert!(device < bound + room, "bound at {point:?}: {device} above {bound}");
        // A ray outside gets on, and one inside knows that it is.
        assert!(device > 0.0 || bound < room, "bound at {point:?}: {device} and not {bound}");
    }
}

#[test]
fn the_device_agrees_with_the_formulas() {
    let gpu = gpu();
    for (name, half) in [("spheres", 1.2), ("boxes", 1.4), ("city", 18.0), ("urchin", 1.6)] {
        let compiled = corpus(name);
        assert!(compiled.module.tables.is_some(), "{name} has no table");
        agrees(&gpu, &compiled, half);
    }
}

/// Lists of a drawing, of a sum, of a product and of the greatest of many: cells hold fewer of their operands, and the device agrees everywhere.
#[test]
fn folds_and_drawings_are_tables() {
    let gpu = gpu();
    let star = "[for i in 0..60 { let a = tau * i / 60; (1 + 0.2 * sin(5 * a) - 0.08 * (i % 2)) * (cos(a), sin(a)) }]";
    let normal = "let z = 1 - (2 * i + 1) / 40; let a = 2.4 * i; let r = sqrt(1 - z * z);";
    let place = "2 * (hash(i), hash(i, 1), hash(i, 2)) - 1";
    let strokes = "for i in 0..30 { bezier((hash(i), hash(i, 1)), (hash(i, 2), hash(i, 3)), (hash(i, 4), hash(i, 5))) }";
    let hills = "for i in 0..40 by + { let d = (p.x, p.z) - (4 * hash(i) - 2, 4 * hash(i, 1) - 2); max(0.25 - dot(d, d), 0) }";
    let scenes = [
        // The edges of an outline, and the product of their sides.
        ("polygon", format!("scene = polygon({star}).extrude(0.3)"), 1.4, 2),
        ("ring", format!("scene = polygon({star}).translate(1.6, 0).revolve().rotate(x, 30deg)"), 2.8, 2),
        ("strokes", format!("scene = ({strokes}).round(0.02).extrude(0.3)"), 1.2, 1),
        ("few strokes", format!("scene = ({}).round(0.02).extrude(0.3)", strokes.replace("30", "9")), 1.2, 1),
        ("gem", format!("field gem = (for i in 0..40 by max {{ {normal} dot(p, (r * cos(a), z, r * sin(a))) }}) - 1\nscene = gem"), 1.4, 1),
        ("balls", format!("field dots = for i in 0..40 by min {{ length(p - ({place})) - 0.1 - 0.1 * hash(i, 3) }}\nscene = dots"), 1.4, 1),
        ("hills", format!("field hills = p.y - ({hills})\nscene = hills.within(box((4, 2, 4)))"), 2.4, 1),
        // Numbers are no distances: the least of many may be as large as it likes.
        ("large", "field large = p.y + 1e-12 * (for i in 0..30 by min { 2e12 + 1e12 * sin(i * p.x + p.z) })\nscene = large.within(box((4, 2, 4)))".to_owned(), 2.4, 1),
        // Of a fold in another point than the shape's own, with something beside it that is not alike.
        ("waves", format!("field sea = p.y + (for i in 0..30 by + {{ 0.01 * sin(dot(2 * p.xz + 1, (i, 3 - i)) + time) }}) + 0.1 * sin(p.x)\nscene = sea.within(box((4, 2, 4)))"), 2.4, 1),
    ];
    for (name, text, half, tables) in scenes {
        let compiled = scene(&text);
        let found = compiled.module.tables.as_ref().map_or(0, |tables| tables.tables.tables.len());
        assert_eq!(found, tables, "tables of {name}");
        let live = Live { time: 0.7, ..compiled.live() };
        agrees_at(&gpu, &compiled, &live, half);
        let whole = compiled.module.tables.as_ref().unwrap().whole().lists().len();
        let lists = compiled.module.tables.as_ref().unwrap().lists().len();
        assert!(["waves", "large"].contains(&name) || lists > whole, "{name} has no cells");
    }
}

/// What loops over cells say of each is written once, with no table: the device agrees on both sides of walls. Numbers that stand beside them, as the cell's own, are given to it.
#[test]
fn cells_are_a_loop() {
    let gpu = gpu();
    let scenes = [
        // All 27 are alike, though of most some numbers are nought and not written.
        ("nearest", "let c = floor(p); let d = for x in -1..2 by min { for y in -1..2 by min { for z in -1..2 by min {
            let cell = c + (x, y, z); length(cell + hash3(cell) - p) } } }; length(p) - 1 + 0.1 * min(d, 1)", true),
        // Of a part of the cell; what a frame computes once is no number of theirs.
        ("ripples", "let c = floor(p.xz); let f = p.xz - c; p.y - 0.05 * (for x in -2..3 by + { for y in -2..3 by + {
            let d = length((x, y) + hash2(c + (x, y)) - f); sin(9 * d - 2 * time) * smoothstep(2, 0.5, d) } })", true),
        // In steps that are not whole, three by four.
        ("steps", "let c = floor(p.xz); p.y - 0.1 * (for x in 0..3 by + { for y in 0..4 by + {
            let o = p.xz - c - (0.5 * x - 0.5, 0.25 * y); exp(-9 * dot(o, o)) * hash(c.x + 0.5 * x, c.y + 0.25 * y) } })", true),
        // The middle is left out, so that no loop counts the rest; a list of many numbers is no loop either.
        ("ring", "let c = round(p.xz); let d = for x in -1..2 by min { for y in -1..2 by min {
            let o = p.xz - c - (x, y); if x == 0 && y == 0 { 1 } else { length(o) - 0.2 * hash(c.x + x, c.y + y) } } }; max(abs(p.y) - 0.3, d)", false),
    ];
    for (name, formula, is_loop) in scenes {
        let compiled = scene(&format!("field cells = {{ {formula} }}\nscene = cells.within(box((3, 2, 3)))"));
        assert!(compiled.module.tables.is_none(), "{name} has a table");
        let functions: Vec<&str> = compiled.module.wgsl.split("\nfn ").filter(|function| function.contains("hash(")).collect();
        let turns = compiled.module.wgsl.matches("for (var i = first; i < ").count();
        assert_eq!(turns, if is_loop { 2 } else { 0 }, "{name}: the loops of value and gradient");
        // The hash itself, and the value and the gradient of a cell.
        assert!(!is_loop || functions.len() == 3, "{name}: hashes in {} functions", functions.len());
        let live = Live { time: 0.7, ..compiled.live() };
        agrees_at(&gpu, &compiled, &live, 1.7);
    }
}

/// Thousands of corners are no warning: only a few of them are looked at.
#[test]
fn a_long_outline_is_not_costly() {
    let text = "scene = polygon([for i in 0..2000 { (1 + 0.1 * sin(tau * i / 50)) * (cos(tau * i / 2000), sin(tau * i / 2000)) }]).extrude(0.3)";
    let outcome = compile(&MemoryLoader::new().with("scene.sdf", text), "scene.sdf", &Options::default());
    assert!(outcome.diagnostics.is_empty(), "{:?}", outcome.diagnostics);
    assert!(outcome.compiled.unwrap().functions.operands() > 2000);
}

/// What is flatter than a distance stands out of a blend by many times its reach: the box about it holds all of that, so no step of the device's bound
/// leads through the surface.
#[test]
fn what_is_flat_is_in_its_box() {
    let (gpu, compiled) = (gpu(), corpus("disks"));
    assert!(compiled.module.tables.is_some());
    let (points, live) = (points(3.0), compiled.live());
    let bounds = evaluate(&gpu, &compiled, &live, [0.0; 3], Export::Bound, &points).unwrap();
    let mut random = Random(11);
    let ends: Vec<[f32; 3]> = points
        .iter()
        .zip(&bounds)
        .map(|(point, bound)| {
            let (way, step) = (random.direction(), 0.99 * f64::from(bound.abs()));
            [0, 1, 2].map(|i| (f64::from(point[i]) + step * way[i]) as f32)
        })
        .collect();
    let [here, there] = [&points, &ends].map(|at| values(&compiled, &live, Function::Field, at));
    let crossed: Vec<usize> = (0..points.len()).filter(|&i| here[i] * there[i] < 0.0 && there[i].abs() > room(&ends[i])).collect();
    assert!(crossed.is_empty(), "{} steps lead through the surface, as from {:?} by {}", crossed.len(), points[crossed[0]], bounds[crossed[0]]);
    let solid = here.iter().filter(|field| **field < 0.0).count();
    assert!(solid > 100, "{solid} points are in the solid");
}

/// Groups in groups, joined in one way or in two, and what begins or ends more than one of them at once.
#[test]
fn groups_begin_and_end_with_their_operands() {
    let gpu = gpu();
    let ball = "sphere(0.1 + 0.1 * hash(i + 10 * j + 100 * k)).translate(2 * hash(i + 10 * j, k) - 1, 2 * hash(i, j) - 1, 2 * hash(k, i) - 1)";
    let spheres = |inner: &str, outer: &str| {
        format!(
            "scene = for k in 0..5 by smooth_union(0.04) {{
  for j in 0..4 by smooth_union({outer}) {{ for i in 0..6 by smooth_union({inner}) {{ {ball} }} }}
}}"
        )
    };
    // Whether all joins of what waits are one.
    for (inner, outer, one) in [("0.02", "0.04", true), ("0.02", "0.07", false)] {
        let compiled = scene(&spheres(inner, outer));
        let tables = &compiled.module.tables.as_ref().unwrap().tables.tables;
        let found: Vec<(usize, bool)> = tables.values().map(|t| (t.depth, t.join().is_some())).collect();
        assert!(!found.is_empty() && found.iter().all(|t| *t == (2, one)), "{inner} in {outer}: {found:?}");
        agrees(&gpu, &compiled, 1.4);
    }
    // Each entry is an operand: a box has no more than it.
    let boxes = corpus("boxes");
    let mean = mean_list(&boxes);
    assert!(mean < 16.0, "{mean} entries in a list on average");
    assert!(!boxes.module.code().contains("waiting[top]"));
}

/// Copies that are alike but for their factors: one table, whose rows hold them. And where a bound has too many forms for a table, it is not
/// the field's that stands in its place.
#[test]
fn each_copy_has_its_own_factor() {
    let gpu = gpu();
    let row = |join: &str, copy: &str| scene(&format!("param r = 1 in 0.5..1.5\nscene = for i in 0..30 {join} {{ {copy}.translate(0.06 * i - 0.9, 0, 0) }}"));
    let tabled = |compiled: &Compiled, function: Function| {
        let tables = compiled.module.tables.as_ref().map(|t| &t.tables.tables);
        tables.is_some_and(|t| t.contains_key(&(compiled.root, function)))
    };
    for copy in [
        "box(0.3).twist(y, 0.05 * i)",
        "box(0.3).twist(y, 0.05 * i * r)",
        "sphere(0.2).displace(0.004 * i * sin(9 * p.x))",
    ] {
        let compiled = row("", copy);
        assert!([Function::Field, Function::Bound].into_iter().all(|f| tabled(&compiled, f)), "{copy} is written out");
        bounds(&gpu, &compiled, &compiled.live(), &points(1.0));
    }
    // Each bound is another formula.
    let copy = "(if i % 2 == 0 { box(0.3).twist(y, 0.05 * i) } else { sphere(0.2).displace(0.004 * i * sin(9 * p.x)) })";
    for compiled in [row("", copy), row("by smooth_union(0.1)", "box(0.3).twist(y, 0.05 * i)")] {
        bounds(&gpu, &compiled, &compiled.live(), &points(1.0));
    }
}

#[test]
fn lists_of_what_moves_hold_wherever_it_is() {
    let text = "param r = 0.1 in 0.05..0.2
param up = 0 in -0.3..0.3
scene = for i in 0..200 by smooth_union(0.02) {
  sphere(r * (0.5 + hash(i, 3))).translate(2 * hash(i, 0) - 1, 2 * hash(i, 1) - 1 + 0.2 * sin(time + i) + up, 2 * hash(i, 2) - 1)
}";
    let compiled = scene(text);
    assert!(mean_list(&compiled) < 100.0, "{} of 200 in a list on average", mean_list(&compiled));
    let gpu = gpu();
    for (time, components) in [(0.0, [0.1, 0.0]), (1.7, [0.05, 0.3]), (97.3, [0.2, -0.3]), (-5.0, [0.2, 0.3])] {
        let live = Live { time, components: components.to_vec(), ..compiled.live() };
        agrees_at(&gpu, &compiled, &live, 1.5);
    }
}

/// Loops to live ends, within each other and by blends: the copies that are there are those of a loop to a constant end.
#[test]
fn copies_that_come_and_go_are_rows_of_a_table() {
    let gpu = gpu();
    for body in [
        "for i in 0..n { for j in 0..n { sphere(0.1).translate(i / 5 - 1, 0.1 * hash(j), j / 5 - 1) } }",
        "for i in 0..n by smooth_union(0.1) { sphere(0.1 + 0.01 * i).translate(2 * hash3(i) - 1) }
| for i in 0..40 { if i < 3 * n { box(0.1).translate(2 * hash3(i, 7) - 1) } else { nothing } }",
        "for i in 0..n by smooth_union(0.05) { for j in 0..n { if j < n - 0.5 { for k in 0..2 { sphere(0.1).translate(i / 5 - 1, k - 0.5, j / 5 - 1) } } else { nothing } } }",
        "for i in 0..n by smooth_intersection(0.05) { sphere(1).translate(0.1 * hash3(i)) }",
        "for i in 0..n by beside { sphere(0.2).translate(hash3(i)) }",
        "for i in 0..n by sink { sphere(0.2).translate(hash3(i)) }",
    ] {
        // What does more than to unite does nothing for a copy that is not there.
        let own = "shape beside(a: shape, b: shape) = a | b | box(0.1)\nshape sink(a: shape, b: shape) = smooth_union(a.translate(0, -0.1, 0), b, 0.05)\n";
        let compiled = scene(&format!("{own}param n = 5 in 1..10\nscene = {body}\n"));
        let unites = !["intersection", "beside", "sink"].iter().any(|other| body.contains(other));
        assert_eq!(compiled.module.tables.is_some(), unites, "{body}");
        for count in [1.0, 4.0, 5.0, 10.0] {
            let live = Live { components: vec![count], ..compiled.live() };
            agrees_at(&gpu, &compiled, &live, 1.5);
            let alone = scene(&format!("{own}let n = {count}\nscene = {body}\n"));
            let points = points(1.5);
            let found = values(&compiled, &live, Function::Field, &points);
            let wanted = values(&alone, &alone.live(), Function::Field, &points);
            for (point, (found, wanted)) in points.iter().zip(found.iter().zip(wanted)) {
                assert!((found - wanted).abs() < 1e-9, "{count} of {body} at {point:?}: {found} and not {wanted}");
            }
        }
    }
}

/// How many operands a list has, on average.
fn mean_list(compiled: &Compiled) -> f64 {
    let tables = compiled.module.tables.as_ref().unwrap();
    let lists = tables.lists();
    let head = &lists[..16];
    let cells = (head[10] * head[11] * head[12]) as usize;
    let spans = &lists[head[14] as usize..][..2 * cells];
    spans.chunks(2).map(|s| f64::from(s[1] - s[0])).sum::<f64>() / cells as f64
}

#[test]
fn near_a_point_few_operands_matter() {
    let compiled = corpus("spheres");
    let mean = mean_list(&compiled);
    assert!(mean < 40.0, "{mean} of 1001 in a list on average");
}

#[test]
fn a_number_that_changes_is_the_same_code() {
    let text = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/corpus/large/spheres.sdf")).unwrap();
    let (a, b) = (scene(&text), scene(&text.replace("hash(i, 3)", "hash(i, 4)")));
    assert_eq!(a.module.code(), b.module.code());
    assert_ne!(a.module.tables.as_ref().unwrap().tables.rows, b.module.tables.as_ref().unwrap().tables.rows);
}

#[test]
fn what_is_beside_a_union_is_no_part_of_it() {
    // Sand without end, of a long formula and of another material.
    let compiled = corpus("urchin");
    let lines = |text: &str| text.lines().count();
    assert!(lines(compiled.module.code()) < 1000, "{} lines", lines(compiled.module.code()));
    let tables = &compiled.module.tables.as_ref().unwrap().tables.tables;
    let found: Vec<(usize, bool)> = tables.values().map(|t| (t.entries.len(), t.region.is_some())).collect();
    assert!(found.iter().all(|t| *t == (1001, true)), "{found:?}");
}

#[test]
fn a_blend_of_a_users_own_is_written_out() {
    // It stands out from its operands by more than any rule for tables allows.
    let text = "blend sticky(a, b, k: field) = min(a, b) - 10 * max(k - abs(a - b), 0)
scene = for i in 0..40 by sticky(0.02) { sphere(0.1).translate(2 * hash(i, 0) - 1, 2 * hash(i, 1) - 1, 2 * hash(i, 2) - 1) }";
    assert!(scene(text).module.tables.is_none());
    // So does one that hands on more than its operands to a blend of the prelude.
    for sticky in ["smooth_union(a - 10 * max(k - abs(a - b), 0), b, k)", "smooth_union(a, b, 10 * max(k - abs(a - b), 0))"] {
        let text = text.replace("min(a, b) - 10 * max(k - abs(a - b), 0)", sticky);
        assert!(scene(&text).module.tables.is_none(), "{sticky}");
    }
}

/// Unions by stairs may hand on all of a change: their slope is 0 or 1. So an operand counts though it is many reaches larger than the least.
#[test]
fn what_is_many_reaches_off_counts_where_stairs_lead_to_it() {
    let mut shapes: Vec<String> = [1.0, 1.3].into_iter().chain((0..9).map(|i| 1.71 + 0.41 * f64::from(i))).map(|r| format!("sphere({r})")).collect();
    shapes.extend((0..20).map(|i| format!("sphere(0.1).translate({}, 0, 0)", 0.02 * f64::from(i))));
    let text = format!("scene = {}", shapes.into_iter().reduce(|all, next| format!("stairs_union({all}, {next}, 0.5, 4)")).unwrap());
    let scene = scene(&text);
    assert!(scene.module.tables.is_some());
    agrees(&gpu(), &scene, 5.5);
}

/// Blends of blends stand out farther than a chain of them: of operands that all but coincide by as much as the tree is deep.
#[test]
fn a_tree_of_blends_stands_out_as_far_as_it_is_deep() {
    fn tree(depth: u32, next: &mut u32) -> String {
        if depth == 0 {
            *next += 1;
            return format!("sphere(1).translate({}, {}, 0)", 0.001 * f64::from(*next), 0.0007 * f64::from(*next * 7 % 13));
        }
        let [a, b] = [tree(depth - 1, next), tree(depth - 1, next)];
        format!("smooth_union({a}, {b}, 0.4)")
    }
    agrees(&gpu(), &scene(&format!("scene = {}", tree(6, &mut 0))), 2.0);
}
