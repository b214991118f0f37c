//! Factors: never below the steepest sample, near to it, the same on every run, and alive with the sliders.

use crate::common::Disk;
use surefoot_compiler::evaluate::Tape;
use surefoot_compiler::functions::bounds;
use surefoot_compiler::graph::{Function, Proof};
use surefoot_compiler::random::Random;
use surefoot_compiler::{Compiled, Memory, MemoryLoader, Options, compile, compile_remembering};

/// Formulas of which the edit's factor is over a fifth above the samples of this test, and why.
const LOOSE: &[(&str, &str)] = &[
    ("poles", "around a pole each term is limited by itself: 1.3 times the steepest place"),
    ("noise_by_hand", "steepest where all eight corners of a cell are extreme"),
    ("noise_multiplied_out", "steepest where all four corners of a cell are extreme"),
    ("cells_of_bumps", "steepest where bumps of four cells lie as badly as they may"),
    ("noise_warp", "steepest in cells that so few samples do not find: 1.18 times what a long search attains"),
];

fn scene(text: &str) -> Compiled {
    let outcome = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default());
    let said = surefoot_compiler::diagnostic::render(&outcome.sources, &outcome.diagnostics, false);
    outcome.compiled.unwrap_or_else(|| panic!("{said}"))
}

fn files(folder: &str) -> Vec<(String, String)> {
    let folder = format!("{}/../{folder}", env!("CARGO_MANIFEST_DIR"));
    let mut all: Vec<(String, String)> = std::fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().path())
        .filter(|p| p.extension().is_some_and(|e| e == "sdf"))
        .map(|p| (p.file_stem().unwrap().to_str().unwrap().to_owned(), p.to_str().unwrap().to_owned()))
        .collect();
    all.sort();
    all
}

#[test]
fn no_factor_is_below_a_sample_and_most_are_near_to_it() {
    let mut wrong = Vec::new();
    let formulas = files("tests/corpus/formulas");
    assert!(formulas.len() >= 30);
    for (name, path) in formulas.iter().chain(&files("examples")) {
        let scene = compile(&Disk, path, &Options::default()).compiled.unwrap_or_else(|| panic!("{name}"));
        for (i, factor) in scene.graph.factors.iter().enumerate() {
            if factor.proof == Proof::Measured {
                wrong.push(format!("{name}: only measured"));
                continue;
            }
            let least = scene.sampled_factor(i, 2048);
            let (first, edit) = (factor.lipschitz, scene.tighten(i, 16_384));
            println!("{name:<22}{:<9}sampled {least:>9.4}  at once {first:>9.4}  edit {edit:>9.4}", factor.proof.name());
            if least > edit * (1.0 + 1e-9) || edit > first {
                wrong.push(format!("{name}: sampled {least}, at once {first}, edit {edit}"));
            }
            let formula = formulas.iter().any(|(n, _)| n == name);
            let loose = LOOSE.iter().any(|(n, _)| n == name);
            if formula && !loose && edit > 1.2 * least.max(1.0) {
                wrong.push(format!("{name}: loose, sampled {least}, edit {edit}"));
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// Searches share a budget: what is left of it for the later ones is the same where the earlier ones are remembered.
#[test]
fn what_is_remembered_does_not_change_what_is_searched() {
    let bumps = |i: usize| {
        let terms: Vec<String> = (0..6).map(|k| format!("exp(-{0} * dot(p - ({1}, {2}, {k}), p - ({1}, {2}, {k}))) * sin({0} * p.x)", 4 + i, i, k % 3)).collect();
        format!("field f{i} = 0.4 - ({})\n", terms.join(" + "))
    };
    let fields: String = (0..9).map(bumps).collect();
    let parts: Vec<String> = (0..9).map(|i| format!("f{i}.within(box(9) - box(0.{}))", i + 1)).collect();
    let loader = MemoryLoader::new().with("main.sdf", format!("{fields}scene = {}\n", parts.join(" | ")));
    let mut memory = Memory::default();
    let mut factors = || {
        let outcome = compile_remembering(&loader, "main.sdf", &Options::default(), &mut memory, &mut |_| {});
        outcome.compiled.unwrap().graph.factors.iter().map(|f| f.lipschitz).collect::<Vec<f64>>()
    };
    let (first, second) = (factors(), factors());
    assert!(!first.is_empty() && first == second, "{first:?}\n{second:?}");
}

/// In distance and angle a formula of an angle is searched with few boxes: in x and y a hundred times as many left more.
#[test]
fn formulas_of_an_angle_are_tight_within_an_edit() {
    for name in ["polar_waves", "shell_spiral", "superformula"] {
        let path = format!("{}/../tests/corpus/formulas/{name}.sdf", env!("CARGO_MANIFEST_DIR"));
        let scene = compile(&Disk, &path, &Options::default()).compiled.unwrap_or_else(|| panic!("{name}"));
        let (sampled, found) = (scene.sampled_factor(0, 2048), scene.tighten(0, 16_384));
        assert!(sampled <= found * (1.0 + 1e-9) && found < 1.05 * sampled, "{name}: sampled {sampled}, found {found}");
    }
}

/// Half a period is enough where the other half is the same but for its sign, and only there.
#[test]
fn half_a_period_hides_nothing() {
    for text in [
        "sin(3 * p.x) * cos(p.y) * sin(2 * p.z)",
        "sin(p.x) * sin(3 * p.x) * cos(p.z)",
        "sin(p.x) * sin(2 * p.x) * cos(3 * p.y)",
        "sin(2 * p.x) + 0.7 * sin(p.x) * cos(p.y)",
        "abs(sin(p.x)) * cos(2 * p.x) + cos(p.z)",
        "abs(sin(p.x) - 0.6) * cos(p.z)",
        "sin(p.x + cos(p.y)) * cos(p.z)",
        "sin(p.x + cos(2 * p.y)) / (2 + sin(p.z))",
        "length((sin(p.x), cos(2 * p.y))) * sin(p.z)",
        "max(sin(p.x), 2 * sin(p.x + 1)) * cos(p.z)",
        "turn(vec2(sin(p.x), 2 * cos(p.x)), 2 * p.z).x",
        "turn(vec2(1, 2 * cos(p.x)), p.z).y * sin(p.z)",
    ] {
        let scene = scene(&format!("field waves = 2 * ({text})\nscene = waves & sphere(4)\n"));
        assert!(!scene.graph.factors.is_empty(), "{text}");
        for i in 0..scene.graph.factors.len() {
            let (sampled, found) = (scene.sampled_factor(i, 2048), scene.tighten(i, 16_384));
            println!("{text}: sampled {sampled:.4}, found {found:.4}");
            assert!(sampled <= found * (1.0 + 1e-9), "{text}: sampled {sampled}, found {found}");
        }
    }
}

/// Formulas that are distances are found to be, though nobody says so.
#[test]
fn distances_written_out_need_no_factor() {
    let all = [
        "box_by_hand", "box_frame_by_hand", "capsule_by_hand", "cone_by_hand", "exponential_union", "hexagon_by_hand", "lens",
        "link_by_hand", "octahedron_by_hand", "root_union", "smooth_spheres", "smooth_spheres_mix", "torus_by_hand",
    ];
    for name in all {
        let path = format!("{}/../tests/corpus/formulas/{name}.sdf", env!("CARGO_MANIFEST_DIR"));
        let scene = compile(&Disk, &path, &Options::default()).compiled.unwrap_or_else(|| panic!("{name}"));
        assert!(scene.graph.factors.is_empty(), "{name}: {:?}", scene.graph.factors);
    }
}

/// The field of what is stretched is scaled by the least of the three, wherever their sliders stand.
#[test]
fn a_live_stretch_is_no_steeper_than_its_shape() {
    for text in ["box((3, 1, 1)).stretch(k, 1, 1)", "sphere(1).stretch(1, 1 + 0.5 * sin(time), k)", "star(5, 1, 0.4).stretch(k, 1).extrude(1)"] {
        let scene = scene(&format!("param k = 1 in 0.1..2\nscene = {text}\n"));
        assert!(scene.graph.factors.is_empty(), "{text}: {:?}", scene.graph.factors);
    }
}

/// A drawing made solid has its region under a warp too, so that the warp's constant is that of where the solid is.
#[test]
fn a_warped_drawing_is_as_steep_as_its_own_size_makes_it() {
    for (text, most) in [
        ("prism(6, 1, 2).twist(y, 1)", 2.05),
        ("regular_polygon(5, 1).extrude(0.5).twist(z, 1)", 2.05),
        ("star(7, 1, 0.6).extrude(1).twist(z, 2)", 3.4),
        ("star(5, 1, 0.4).revolve().twist(y, 1)", 2.05),
        ("star(5, 1, 0.5).extrude(0.4).bend(x, y, 0.5)", 1.6),
        ("star(5, 1, 0.45).extrude(2).rotate(x, 90deg).translate(0, 1, 0).taper(y, 0, 2, 0.25)", 11.0),
        ("star(5, 1, 0).loft(circle(1), 1)", 3.2),
        // Far from its axis a twisted distance is no steeper than near it, so a blend with what is wide is as steep as the column.
        ("smooth_union(box(1, 2, 1).round(0.1).twist(y, 2), box(6, 0.3, 6), 0.3)", 2.0),
        ("smooth_union(box(1, 2, 0.4).translate(0.5, 0, 0).bend(x, y, 0.5), box(6, 0.3, 6), 0.3)", 1.8),
        ("smooth_union(box(2, 0.5, 0.5), cylinder(0.25, 2.2), 0.3).twist(y, 1.5)", 2.35),
    ] {
        let scene = scene(&format!("scene = {text}\n"));
        assert!(scene.summary.factor <= most, "{text}: {}", scene.summary.factor);
        for index in 0..scene.graph.factors.len() {
            assert!(scene.sampled_factor(index, 2048) <= scene.graph.factors[index].lipschitz, "{text}");
        }
    }
}

/// Differences of the field itself, near and far, against a factor that is that of all space.
#[test]
fn far_from_its_axis_a_turned_distance_is_no_steeper() {
    for (text, factor) in [
        ("cylinder(0.3, 1).rotate(z, 40deg).round(0.1).translate(0.4, 0, 0).twist(y, 3)", 4.0),
        ("smooth_union(box(1, 2, 1).round(0.1).twist(y, 2), box(6, 0.3, 6), 0.3)", 0.0),
        ("smooth_union(box(1, 2, 0.4).translate(0.5, 0, 0).bend(x, y, 0.5), box(6, 0.3, 6), 0.3)", 0.0),
        ("smooth_union(octahedron(1).translate(0.3, 0, 0.2).twist(y, 4), sphere(0.5), 0.2)", 0.0),
    ] {
        let scene = scene(&format!("scene = {text}\n"));
        let factor = if factor > 0.0 { factor } else { scene.summary.factor };
        let root = scene.functions.formulas[&(scene.root, Function::Field)];
        let tape = Tape::new(&scene.graph, &scene.functions.formulas, &[root], &scene.live(), 1_000_000).unwrap();
        let mut random = Random(9);
        let mut points = Vec::new();
        for _ in 0..20_000 {
            let p = random.within(6.0);
            let d = random.direction();
            points.extend([p, [0, 1, 2].map(|i| p[i] + 1e-5 * d[i])]);
        }
        let mut values = Vec::new();
        tape.evaluator().at(&points, &[], |_, value| values.push(value[0]));
        let steepest = values.chunks(2).map(|v| (v[1] - v[0]).abs() / 1e-5).fold(0.0, f64::max);
        println!("{steepest:.4} of {factor:.4}: {text}");
        assert!(steepest <= factor * (1.0 + 1e-4), "{text}: {steepest} over {factor}");
    }
}

#[test]
fn the_same_text_gives_the_same_factors() {
    let path = format!("{}/../tests/corpus/formulas/schwarz_d.sdf", env!("CARGO_MANIFEST_DIR"));
    let once = || {
        let scene = compile(&Disk, &path, &Options::default()).compiled.unwrap();
        (scene.graph.factors[0].lipschitz.to_bits(), scene.tighten(0, 2048).to_bits(), scene.module.wgsl)
    };
    assert_eq!(once(), once());
}

/// At zero the displaced ball is a ball; the steeper the waves, the larger the factor, and never above that of the whole range.
#[test]
fn a_factor_follows_its_slider() {
    let scene = scene("param waves = 1 in 0..20\nscene = sphere(6).displace(waves * sin(p.x) * sin(p.y) * sin(p.z))");
    let whole = scene.graph.factors[0].lipschitz;
    let mut last = 0.0;
    for amplitude in [0.0, 0.5, 2.0, 8.0, 20.0] {
        let mut live = scene.live();
        live.components[0] = amplitude;
        assert_eq!(live.factor(&scene.graph, 0), whole, "not found for these values yet");
        scene.follow(&mut live, Compiled::QUICK);
        let factor = live.factor(&scene.graph, 0);
        assert!(factor >= last && factor <= whole, "{amplitude}: {factor} of {whole}");
        assert!(factor >= 1.0 + 0.5 * amplitude, "{amplitude}: {factor}");
        if amplitude == 0.0 {
            assert!((factor - 1.0).abs() < 1e-6, "{factor}");
        }
        // A value that the factor was not found for does not get it.
        live.components[0] = 19.0;
        assert_eq!(live.factor(&scene.graph, 0), whole);
        last = factor;
    }
}

/// Between what is attained and a fifth more: noise is looked at cell by cell, not as what its claim allows.
#[test]
fn a_warp_by_noise_is_searched_cell_by_cell() {
    for warp in [
        "0.1 * (perlin(2 * p), perlin(2 * p + 7), perlin(2 * p + 13))",
        "0.1 * (value_noise(1.7 * p.zxy), 0, value_noise(3 * p.yzx + 0.4))",
        "(0, 0.15 * perlin(1.5 * p.xz) + 0.02 * p.x * p.y, 0.1 * perlin(2 * p) * p.x)",
    ] {
        let scene = scene(&format!("warp wander = p + {warp}\nscene = sphere(1).wander()"));
        let (first, attained) = (scene.graph.factors[0].lipschitz, scene.sampled_factor(0, 4_096));
        let found = scene.tighten(0, 16_384);
        println!("{warp}: at once {first:.3}, found {found:.3}, attained {attained:.3}");
        assert!(attained <= found && found <= 1.2 * attained && found < 0.9 * first, "{warp}: {found}, attained {attained}, at once {first}");
        // A hundred boxes are fewer than cells: the claim stands.
        assert_eq!(scene.tighten(0, 100), first);
    }
    // Cells whose walls do not stand across an axis, or that are cells of cells, are left to the claim.
    for warp in ["0.1 * (perlin(askew(2 * p)), 0, 0)", "0.1 * (simplex(2 * p), 0, 0)", "0.02 * perlin(p + 3 * floor(1.5 * (p - 0.3 * floor(p)))) * x", "0.1 * perlin(p * p) * x"] {
        let scene = scene(&format!("warp wander = p + {warp}\nscene = sphere(1).wander()"));
        let (first, attained) = (scene.graph.factors[0].lipschitz, scene.sampled_factor(0, 4_096));
        let found = scene.tighten(0, 4_096);
        println!("{warp}: at once {first:.3}, found {found:.3}, attained {attained:.3}");
        assert!(attained <= found && found <= first, "{warp}: {found}, attained {attained}, at once {first}");
    }
}

#[test]
fn an_edit_searches_only_what_it_changed() {
    let text = |k: &str| {
        format!(
            "warp sway(a: float) = p + (a * sin(p.y * p.y), 0, 0)\nfield wave(a: float) = p.y - a * sin(2 * p.x) * cos(3 * p.z)\n\
             scene = box(1, 3, 1).sway({k}) | wave(0.2).within(box(4)) | sphere(0.4).translate({k}, 5, 0)"
        )
    };
    let mut memory = Memory::default();
    let mut compile = |text: String| {
        let before = memory.searched;
        let loader = MemoryLoader::new().with("main.sdf", text);
        let outcome = compile_remembering(&loader, "main.sdf", &Options::default(), &mut memory, &mut |_| {});
        (memory.searched - before, outcome.compiled.unwrap().module.wgsl)
    };
    let (first, module) = compile(text("0.3"));
    let (again, same) = compile(text("0.3"));
    let (edited, _) = compile(text("0.31"));
    assert!(first >= 3, "{first}");
    assert_eq!((again, same), (0, module), "nothing is searched twice, and the text is the same");
    assert!(edited >= 1 && edited < first, "{edited} of {first}");
}

#[test]
fn what_is_not_proven_says_so() {
    let text = "field f = 1 / p.x - 2\nscene = f.within(box(3))";
    let scene_of = scene(text);
    assert!(scene_of.graph.factors.iter().any(|f| f.proof == Proof::Measured));
    assert_eq!(scene_of.summary.kind.name(), "unproven");
    let strict = Options { strict: true, ..Options::default() };
    let outcome = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &strict);
    assert!(outcome.compiled.is_none() && outcome.has_errors());
}

#[test]
fn a_distance_is_one_as_long_as_it_is_but_moved() {
    use surefoot_compiler::functions::Kind;
    let kind = |end: &str| {
        let text = format!("param a = 20deg in 0deg..90deg\nwarp squash = p * (0.5, 1, 1)\nscene = box(1).{end}");
        scene(&text).summary.kind
    };
    for rigid in ["translate(1, a, 0)", "rotate(y, a)", "rotate((1, 2, 0.5), time + a)", "rotate((1, 1, 1), a).rotate((-1, 0.5, 3), 40deg)", "mirror((1, 1, 0.3))", "rotate(x, 1).translate(0, time, 0)"] {
        assert_eq!(kind(rigid), Kind::Exact, "{rigid}");
    }
    for other in ["fold((1, 1, 0))", "squash()", "translate(2, 0, 0).fold(x).rotate(y, a)"] {
        assert_eq!(kind(other), Kind::Lipschitz, "{other}");
    }
}

#[test]
fn a_factor_is_laid_to_what_is_steep() {
    let wavy = "circle(1).displace(0.2 * sin(8 * p.x))";
    for (text, blamed) in [
        (format!("shape2 wavy = {wavy}\nscene = wavy.extrude(1)"), "displace(0.2 * sin(8 * p.x))"),
        (format!("scene = (rectangle(0.3) | {wavy}.translate(3, 0)).revolve()"), "displace(0.2 * sin(8 * p.x))"),
        // Here it is the sweep itself.
        ("scene = circle(0.1).sweep_helix(0.3, 1, 3)".to_owned(), "sweep_helix(0.3, 1, 3)"),
    ] {
        let scene = scene(&text);
        let spans: Vec<&str> = scene.graph.factors.iter().map(|f| &text[f.span.start as usize..f.span.end as usize]).collect();
        assert_eq!(spans, [blamed], "{text}");
    }
}

#[test]
fn what_has_a_live_number_of_corners_is_no_larger_than_its_radius() {
    let largest = |scene: &Compiled| scene.graph.factors.iter().map(|f| f.lipschitz).fold(1.0, f64::max);
    for (drawing, reach) in [("regular_polygon(n, 0.7)", 0.7), ("star(n, 0.7, 0.55)", 0.7), ("star(n, 0.5, r)", 0.9), ("regular_polygon(n, r).round(0.1)", 1.0)] {
        let text = |shape: &str| format!("param n: int = 6 in 3..12\nparam r = 0.5 in 0.3..0.9\nscene = {drawing}{shape}");
        let flat = scene(&text(".extrude(1)"));
        let [low, high] = bounds(&flat.graph, flat.root, &flat.functions, 100.0).unwrap_or_else(|| panic!("{drawing} has no box"));
        assert!((0..2).all(|i| low[i] >= -1.001 * reach && high[i] <= 1.001 * reach), "{drawing}: {low:?} {high:?}");
        let tapered = scene(&text(".extrude(1).rotate(x, 90deg).taper(y, -0.5, 0.5, 0.5)"));
        assert!(largest(&tapered) < 5.0, "{drawing}: {}", largest(&tapered));
        // And it is there: the solid is not cut off.
        let live = flat.live();
        let tape = Tape::new(&flat.graph, &flat.functions.formulas, &[flat.functions.formulas[&(flat.root, Function::Field)]], &live, 1_000_000).unwrap();
        tape.evaluator().at(&[[0.0, 0.45, 0.0]], &[], |_, values| assert!(values[0] < 0.0, "{drawing}: {}", values[0]));
    }
}

/// Sectors of a turn, counted by `round` or `floor`: both sides of each seam are proven to agree where what lies in a sector is even.
#[test]
fn sectors_that_are_even_have_no_seams() {
    let cases = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/corpus/cases");
    for name in ["sector_by_round", "sector_of_a_slider", "sector_by_floor", "sector_of_odd_teeth"] {
        let text = std::fs::read_to_string(cases.join(format!("{name}.sdf"))).unwrap();
        let outcome = surefoot_compiler::compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default());
        assert!(outcome.diagnostics.is_empty(), "{name}: {:?}", outcome.diagnostics);
        let factor = outcome.compiled.unwrap().summary.factor;
        assert!(factor <= 2.1, "{name}: {factor}");
    }
}

/// The two sides of a choice that meet: it is proven, and nothing is said.
#[test]
fn choices_whose_sides_meet_are_continuous() {
    let cases = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/corpus/cases");
    for (name, most) in [("continuous_if", 1.15), ("continuous_bowl", 1.06), ("continuous_ramp", 1.15), ("continuous_tangent", 5.0)] {
        let text = std::fs::read_to_string(cases.join(format!("{name}.sdf"))).unwrap();
        let outcome = surefoot_compiler::compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default());
        assert!(outcome.diagnostics.is_empty(), "{name}: {:?}", outcome.diagnostics);
        let factor = outcome.compiled.unwrap().summary.factor;
        assert!(factor <= most, "{name}: {factor}");
    }
}
