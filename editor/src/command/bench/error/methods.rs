//! The ways to follow a ray that are compared: WGSL texts over the same emitted functions.

use surefoot_compiler::Compiled;
use surefoot_compiler::analysis::{Box3, Domain, Facts};
use surefoot_compiler::emit::tracer::{Tracer, Ways};

/// A way to follow a ray.
#[derive(Clone, Debug)]
pub struct Method {
    /// Its name on the command line and in tables.
    pub name: String,
    /// What it is, in a few words.
    pub about: &'static str,
    /// The function `traced`, with arguments and result of `sf_trace`.
    pub wgsl: String,
}

/// Names and descriptions, in the order of the tables. All that stop before the surface stop as near to it as ours, unless they say so.
pub const METHODS: [(&str, &str); 13] = [
    ("ours", "what the module holds"),
    ("no-planes", "ours that meets planes as it meets everything else"),
    ("no-region", "ours without a box about the scene"),
    ("whole-steps", "ours without relaxation"),
    ("no-leap", "ours without leaps, and the hit is where the ray stopped: auto-relaxation alone (Bálint and Valasek 2023), with our factors and tolerance, over the whole bound"),
    ("half-pixel", "the same that stops half a pixel before the surface, as auto-relaxation is published"),
    ("half-factors", "ours with half of each factor: nothing is proven, and rays pass through what is thin"),
    ("relaxed-1.2", "over-relaxation 1.2, same factors (Keinert 2014)"),
    ("relaxed-1.6", "over-relaxation 1.6, same factors (Keinert 2014)"),
    ("root", "one proven factor for the whole field"),
    ("hand", "the field times 0.7, as demos do"),
    ("plain", "the field as it is, taken for a distance"),
    ("fixed", "256 equal steps"),
];

/// Shared head: `span` is the part of the ray that is looked at.
const HEAD: &str = include_str!("head.wgsl");

/// The field times a number is the step, and says when the ray is there.
const SCALED: &str = include_str!("scaled.wgsl");

/// A step is the bound times OMEGA as long as the spheres overlap, else the bound.
const RELAXED: &str = include_str!("relaxed.wgsl");

/// As long as the field stays above zero, all steps are the same.
const FIXED: &str = include_str!("fixed.wgsl");

/// Our tracer with other numbers.
fn ours(tracer: Tracer, scene: &Compiled) -> String {
    with_ways(tracer, scene, scene.module.ways)
}

/// The same that is told other things of the scene.
fn with_ways(tracer: Tracer, scene: &Compiled, ways: Ways) -> String {
    tracer.wgsl(ways, scene.module.rounding).replace("fn sf_trace(", "fn traced(")
}

/// A method by its name; none where there is no such method, and a reason where the scene has none.
pub fn method(name: &str, scene: &Compiled) -> Option<Result<Method, &'static str>> {
    let (_, about) = METHODS.iter().find(|(known, _)| *known == name)?;
    let whole = Tracer::DEFAULT;
    // The box is about everything but the planes.
    let of_planes = scene.module.ways.planes;
    let alone = Ways { one: scene.module.one, ..Ways::default() };
    let no_planes = Ways { region: scene.module.ways.region && !of_planes, ..alone };
    let other = |text: &str| format!("{HEAD}{}", text.replace("TOLERANCE", &format!("{:?}", whole.tolerance)));
    let scaled = |scale: f64| other(&SCALED.replace("SCALE", &format!("{scale:?}")));
    let wgsl = match name {
        "ours" => ours(whole, scene),
        "whole-steps" => ours(Tracer { relaxation: 0.0, ..whole }, scene),
        "no-planes" => with_ways(whole, scene, no_planes),
        "no-region" => with_ways(whole, scene, Ways { region: false, ..scene.module.ways }),
        "no-leap" => with_ways(Tracer { leap: 0.0, ..whole }, scene, alone),
        "half-pixel" => with_ways(Tracer { tolerance: 0.5, leap: 0.0, ..whole }, scene, alone),
        "half-factors" => ours(Tracer { factor: 2.0, ..whole }, scene),
        "relaxed-1.2" | "relaxed-1.6" => other(&RELAXED.replace("OMEGA", &name[8..])),
        "root" => match root_constant(scene) {
            Some(constant) => scaled(1.0 / constant),
            None => return Some(Err("the whole field has no finite constant")),
        },
        "hand" => scaled(0.7),
        "plain" => scaled(1.0),
        _ => other(FIXED),
    };
    Some(Ok(Method { name: name.to_owned(), about, wgsl }))
}

/// Ours with one number changed at a time, for the curves.
pub fn sweep(scene: &Compiled) -> Vec<Method> {
    let whole = Tracer::DEFAULT;
    let mut all = Vec::new();
    let mut add = |name: String, about, tracer| all.push(Method { name, about, wgsl: ours(tracer, scene) });
    for times in [4.0, 2.0, 0.5, 0.25, 0.0625, 0.015625] {
        let tolerance = times * whole.tolerance;
        add(format!("tolerance x{times:?}"), "ours with another tolerance", Tracer { tolerance, ..whole });
    }
    for budget in [32, 64, 128, 256, 512] {
        add(format!("budget {budget}"), "ours with fewer looks", Tracer { budget, ..whole });
    }
    for relaxation in [0.1, 0.2, 0.5, 0.7, 1.0] {
        add(format!("relaxation {relaxation}"), "ours that learns the slope faster or slower", Tracer { relaxation, ..whole });
    }
    for leap in [0.125, 2.0, 8.0] {
        add(format!("leap {leap}"), "ours whose leaps leave less or more unproven, in pixels", Tracer { leap, ..whole });
    }
    for factor in [0.25, 0.5, 4.0] {
        add(format!("bound x{factor:?}"), "ours with another bound: above 1 nothing is proven", Tracer { factor, ..whole });
    }
    all
}

/// A Lipschitz constant of the whole field within the scene's extent.
fn root_constant(scene: &Compiled) -> Option<f64> {
    let value = scene.graph.shape(scene.root)?.value;
    let domain = Domain::of(Box3::cube(scene.blocks.extent));
    let found = Facts::default().constant(&scene.graph, value, &domain, 4096).lipschitz;
    (found.is_finite() && found > 0.0).then_some(found.max(1e-6))
}
