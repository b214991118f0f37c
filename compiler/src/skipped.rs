//! What of a scene is not computed and not drawn, and why.

mod absorbed;

use crate::blocks::Shadow;
use crate::camera::Projection;
use crate::compiled::Compiled;
use crate::graph::{Function, Leaf, Node, Shape};
use crate::reference::shade;
use crate::source::{Sources, Span};
use std::collections::BTreeMap;

/// Of a longer text the beginning is shown.
const LONGEST: usize = 60;

/// What was left out, each in one line: functions and parameters of the module, declarations without a use, calls that change nothing, and
/// parts of a frame, as the scene stands at the defaults.
pub fn skipped(scene: &Compiled, sources: &Sources) -> Vec<String> {
    let mut lines = scene.module.skipped.clone();
    for (name, span) in &scene.unused {
        lines.push(format!("{name} at {}: nothing uses it", place(sources, *span)));
    }
    // By its place: a copy of a `for` may stand where it is by what moves the others.
    let mut places: BTreeMap<(u32, u32, u32), bool> = BTreeMap::new();
    for (id, function) in scene.functions.formulas.keys() {
        if let (Some(shape), Function::Field) = (scene.graph.shape(*id), function) {
            let key = (shape.span.file.0, shape.span.start, shape.span.end);
            *places.entry(key).or_insert(true) &= passes_on(scene, shape);
        }
    }
    for ((file, start, end), _) in places.into_iter().filter(|p| p.1) {
        let span = Span { file: crate::source::FileId(file), start, end };
        let text = words(sources, span);
        if !text.is_empty() {
            lines.push(format!("{text} at {}: it changes nothing", place(sources, span)));
        }
    }
    lines.extend(absorbed::left_out(scene, sources).iter().map(|a| format!("{}; only the field looks at it", said(a, sources))));
    let ways = scene.module.ways;
    if ways.planes {
        lines.push("looks for planes: rays meet them where their formulas say".to_owned());
    }
    if ways.region {
        let but = if ways.planes { "but planes nothing is" } else { "nothing is" };
        lines.push(format!("looks beyond the box about what is solid: {but} solid there"));
    }
    lines.extend(parts(scene).map(|(part, why)| format!("{part}: {why}")));
    lines
}

/// What is computed though nothing of it is to be seen, each in one line: holes beside the solid, parts inside others, cuts that cut nothing
/// off, wherever sliders stand and at any time, as far as bound and distance do not do without. Without them the picture is the same and costs less.
pub fn unseen(scene: &Compiled, sources: &Sources) -> Vec<String> {
    absorbed::absorbed(scene, sources).iter().map(|a| said(a, sources)).collect()
}

fn said(absorbed: &absorbed::Absorbed, sources: &Sources) -> String {
    format!("{} at {}: {}", words(sources, absorbed.span), place(sources, absorbed.span), absorbed.why.words())
}

/// The text of a place, on one line.
fn words(sources: &Sources, span: Span) -> String {
    let text = sources.text(span).split_whitespace().collect::<Vec<_>>().join(" ");
    match text.char_indices().nth(LONGEST) {
        Some((end, _)) => format!("{}…", text.get(..end).unwrap_or_default()),
        None => text,
    }
}

fn place(sources: &Sources, span: Span) -> String {
    let (file, line, column) = sources.position(span.file, span.start);
    format!("{}:{line}:{column}", file.rsplit(['/', '\\']).next().unwrap_or(file))
}

/// Whether a shape is another one, at the same point, and nothing more.
fn passes_on(scene: &Compiled, shape: &Shape) -> bool {
    if shape.name.is_some() || shape.material.is_some() || !shape.paints.is_empty() {
        return false;
    }
    let Node::Call(_, Function::Field, args) = scene.graph.node(shape.value) else { return false };
    args.iter().take(usize::from(shape.dimensions)).zip(0..).all(|(&a, i)| *scene.graph.node(a) == Node::Leaf(Leaf::P(i)))
}

/// Parts of a frame, and why a scene does without each.
pub const PARTS: [(&str, &str); 12] = [
    ("meshes", "the scene has none"),
    ("balls", "the scene has none"),
    ("shadows", "no light throws any, or `shadows` is off"),
    ("shadow maps", "no mesh and no ball throws a shadow, and no light has `shadow: map`"),
    ("occlusion", "its reach or its strength is 0"),
    ("reflections", "`reflections` is 0"),
    ("capture", "the environment has no `capture`"),
    ("images of the sky", "the sky is a colour or a gradient"),
    ("fog", "`render` has no `fog`, or its density is 0"),
    ("glass", "no material has a `transmission`"),
    ("bloom", "`render` has no `bloom`, or it is 0"),
    ("lens and parallel rays", "every camera sees from one point"),
];

/// Those of [`PARTS`] that a scene does without.
fn parts(scene: &Compiled) -> impl Iterator<Item = (&'static str, &'static str)> {
    let frame = scene.frame(&scene.live());
    let (reach, strength) = frame.ambient_occlusion;
    let throws = |wanted: fn(&Shadow) -> bool| frame.shadows && shade::lights(&frame).iter().any(|l| wanted(&l.shadow));
    let shadows = throws(|s| *s != Shadow::None);
    let (meshes, balls) = (scene.has_meshes(), scene.has_balls());
    let there = [
        meshes,
        balls,
        shadows,
        shadows && (meshes || balls) || throws(|s| *s == Shadow::Map),
        reach > 0.0 && strength > 0.0,
        frame.reflections > 0,
        frame.capture.is_some(),
        frame.has_environment,
        frame.fog.is_some_and(|fog| fog.density > 0.0),
        scene.functions.surface.glass.is_some(),
        frame.bloom > 0.0,
        frame.cameras.iter().any(|(_, camera)| camera.lens > 0.0 || camera.projection != Projection::Perspective),
    ];
    PARTS.into_iter().zip(there).filter(|(_, there)| !there).map(|(part, _)| part)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{MemoryLoader, Options, compile};

    fn of(what: fn(&Compiled, &Sources) -> Vec<String>, text: &str) -> Vec<String> {
        let outcome = compile(&MemoryLoader::new().with("scenes/a.sdf", text), "scenes/a.sdf", &Options::default());
        what(outcome.compiled.as_ref().unwrap(), &outcome.sources)
    }

    fn lines(text: &str) -> Vec<String> {
        of(skipped, text)
    }

    #[test]
    fn what_is_left_out_is_said_with_its_place() {
        let said = lines(
            "fn far(t: float) = t * t\n\
             material gold { color: #d4af37 }\n\
             shape part(s: float) = box(s).translate(0, s, 0)\n\
             light sun { direction: (0, -1, 0), shadow: soft(8) }\n\
             scene = part(1).translate(0, 0, 0) | for i in 0..3 { sphere(0.2).translate(i, 0, 0) }",
        );
        let places: Vec<&String> = said.iter().filter(|l| l.contains(" at a.sdf:")).collect();
        assert_eq!(
            places,
            [
                "far at a.sdf:1:4: nothing uses it",
                "gold at a.sdf:2:10: nothing uses it",
                "translate(0, 0, 0) at a.sdf:5:17: it changes nothing"
            ]
        );
        assert!(said.iter().any(|l| l.starts_with("shadow maps: no mesh")), "{said:?}");
        assert!(!said.iter().any(|l| l.starts_with("shadows:")), "{said:?}");
    }

    #[test]
    fn operands_of_which_nothing_is_seen_are_named() {
        let said = of(
            unseen,
            "param r = 0.2 in 0.1..3\n\
             let wall = box((6, 2, 0.2)).rotate(y, 0.7) - sphere(0.4).translate(2, 0, 2)\n\
             scene = (wall & sphere(3.2)) | sphere(r).translate(1, 0, 0.05) | sphere(0.08).rotate(x, 1)\n\
                   | for i in 0..2 { sphere(0.05).translate(0, 0.5 * i, 0) }\n\
                   | for i in 0..2 { sphere(0.04).translate(0, 2 * i, 0) } - sphere(0.6).translate(0.6, 1, 0)",
        );
        assert_eq!(
            said,
            [
                "sphere(0.4).translate(2, 0, 2) at a.sdf:2:46: the hole does not reach the solid",
                "sphere(3.2) at a.sdf:3:17: it cuts nothing off",
                "sphere(0.08).rotate(x, 1) at a.sdf:3:66: nothing of it is seen, as it lies inside of the rest",
                "sphere(0.05).translate(0, 0.5 * i, 0) at a.sdf:4:19: nothing of it is seen, as it lies inside of the rest",
                "sphere(0.6).translate(0.6, 1, 0) at a.sdf:5:59: the hole does not reach the solid",
            ]
        );
    }

    #[test]
    fn a_hole_beside_the_box_of_its_solid_is_left_out() {
        let text = "param far = 3 in 2..4\n\
             let wall = box((6, 2, 0.2)) - sphere(0.4).translate(0, 0, far)\n\
             let hole = sphere(0.3).translate(1, 0, 0)\n\
             scene = (wall & sphere(9)) | (box(1).translate(1, 0, 0) - hole) | (box(1).translate(-1.5, 0, 0) - hole)";
        let said = lines(text).into_iter().filter(|line| line.contains("only the field")).collect::<Vec<_>>();
        assert_eq!(
            said,
            [
                "sphere(0.4).translate(0, 0, far) at a.sdf:2:31: the hole does not reach the solid; only the field looks at it",
                "sphere(9) at a.sdf:4:17: it cuts nothing off; only the field looks at it",
            ]
        );
        assert!(of(unseen, text).is_empty());
    }

    #[test]
    fn what_is_there_is_not_said_to_be_left_out() {
        let said = lines("scene = box(1).rotate(y, 0.3) | sphere(1).translate(0.5, 0, 0)\nrender { reflections: 1, ambient_occlusion: (0, 1) }");
        assert!(!said.iter().any(|l| l.contains(" at a.sdf:") || l.starts_with("reflections")), "{said:?}");
        for text in [
            "scene = box(1).rotate(y, 0.3) | sphere(1).translate(0.5, 0, 0)",
            "scene = box(1) - sphere(0.4).translate(5 * cos(time), 0, 0)",
            "scene = for i in 0..3 { sphere(0.1).translate(i * time, 0, 0) } | box(1)",
            "scene = circle(10).loft(circle(5), 30)",
            "param r = 0.2 in 0.1..3\nscene = box(1) | sphere(r)",
            "param r = 0.2 in 0.1..3\nscene = box(1).translate(r, 0, 0) | sphere(0.2)",
        ] {
            assert!(of(unseen, text).is_empty(), "{text}");
        }
        assert!(!said.iter().any(|l| l.starts_with("shadows:")), "the light of a scene without any throws one: {said:?}");
        assert!(said.contains(&"balls: the scene has none".to_owned()), "{said:?}");
        assert!(said.contains(&"occlusion: its reach or its strength is 0".to_owned()), "{said:?}");
    }
}
