//! What a scene's camera sees before anything is drawn: of a picture that would be black or empty a person is told why.

use crate::analysis::Box3;
use crate::blocks::{CameraNodes, Shadow};
use crate::camera::Camera;
use crate::compiled::{Compiled, Outcome};
use crate::frame::{Frame, LightKind};
use crate::live::Live;
use crate::diagnostic::{Code, Diagnostic, tidy};
use crate::graph::FAR;
use crate::camera::{EYE, SMALLEST};
use crate::camera::Basis;
use crate::reference::follow::TRACER;
use crate::reference::march::{Ray, at_points};
use crate::vector::{Vec3, add, along, dot, length, scale, sub, unit};
use crate::reference::{Hit, Reference};
use crate::source::{FileId, Span};

/// Pictures through which is looked, coarse ones first, in pixels.
const PICTURES: [(u32, u32); 4] = [(5, 3), (20, 12), (60, 36), (140, 84)];
/// What is nearer to a ray than a pixel of a picture of this height counts as met.
const PIXELS: u32 = 720;
/// Most operations that a look at all pixels of a picture may take, once.
const MOST: usize = 3_000_000;
/// What takes more operations by itself is not looked at.
const LONGEST: usize = 10_000;
/// And where a ray is lost, so that others look as often as they may.
const MOST_AFTER_LOST: usize = MOST / 25;
/// And where it is told which rays are lost.
const MOST_LOST: usize = MOST / 10;
/// So many times farther away than it is wide one sees something well.
const AWAY: f64 = 2.5;
/// So much of the extent one sees; the rest fades into the sky.
const FADED: f64 = 0.99;
/// Where such a share of rays is lost it is seen; fewer are where a plane ends in the distance.
const HOLES: f64 = 0.1;
/// What is farther from a place than so many pixels is not there.
const NEAR: f64 = 8.0;
/// Nor is it where the field is still this share of itself after a step that should end it.
const STILL: f64 = 0.5;
/// Where no ray of this picture is lost, few are.
const SMALL: (u32, u32) = (10, 6);
/// So much of the unit of rounding is lost, where it is more than 1.
const LOST: f64 = 8.0 / (1 << 23) as f64;
/// Where so many rays of one of these pictures meet anything, it is not under a pixel.
const FEW: [((u32, u32), usize); 2] = [((20, 12), 8), ((60, 36), 24)];
/// Of what is met so many places are looked at.
const MOST_PLACES: usize = 8;
/// The height of a picture of which a pixel is meant, and of how many depths up to that one is looked at.
const COARSE: u32 = 240;
const DEPTHS: i32 = 40;
/// So many times as far as it is thick does one stand who sees it well.
const NEARBY: f64 = 20.0;
/// So often a place comes nearer to the surface, and so near.
const MOST_NEARER: usize = 64;
const CLOSE: f64 = 1e-9;
/// What helps rays on.
const EVENLY: &str = "say where the shape lies with `.within(box(…))`, or write its formula so that it grows more evenly";
/// The seconds after which a camera that moves is looked at.
const SECONDS: std::ops::RangeInclusive<u32> = 1..=60;
/// So many other cameras are looked through.
const MOST_TRIED: usize = 6;

/// A camera that is moved by time and leaves the scene within a minute, where what is solid goes on beyond.
fn leaves(compiled: &Compiled, live: &Live, which: usize) -> Option<Diagnostic> {
    let known = compiled.functions.ahead;
    if known.home.or(known.region).is_some() || !compiled.reads_time() {
        return None;
    }
    let is_out = |seconds: f64| {
        let frame = compiled.frame(&Live { time: live.time + seconds, ..live.clone() });
        frame.cameras.get(which).is_some_and(|(_, camera)| length(camera.eye).min(length(camera.target)) > frame.extent)
    };
    let seconds = SECONDS.map(f64::from).find(|seconds| is_out(*seconds))?;
    let extent = short(compiled.frame(live).extent);
    let at = short(live.time + seconds);
    let message = format!("after {at} seconds the camera has left the scene, which ends {extent} from the origin: from there on nothing is seen");
    let help = "set `render { extent: … }` to more, or let the camera come back: `time % 4` begins anew every four seconds";
    Some(Diagnostic::new(Code::NothingSeen, place(compiled, compiled.blocks.cameras.get(which)), message, help))
}

/// What is wrong with what a camera sees at one moment, if anything: that of this name, or the first.
pub fn outlook(compiled: &Compiled, live: &Live, name: Option<&str>) -> Option<Diagnostic> {
    let cameras = compiled.frame(live).cameras;
    through(compiled, live, cameras.iter().position(|(known, _)| name.is_none_or(|name| name == known))?)
}

/// The same of the camera with a number.
pub fn through(compiled: &Compiled, live: &Live, which: usize) -> Option<Diagnostic> {
    let frame = compiled.frame(live);
    if compiled.is_vast() {
        return None;
    }
    let (camera, nodes) = (frame.cameras.get(which)?.1, compiled.blocks.cameras.get(which));
    let who = called(compiled, nodes);
    // By the factors that hold where the sliders stand, as a picture goes.
    let mut followed = live.clone();
    compiled.settle(&mut followed);
    let reference = Reference::new(compiled, &followed).ok()?;
    let field = |place: Vec3| field_at(&reference, place);
    let known = compiled.functions.ahead;
    let region = known.home.or(known.region).filter(|region| region.size() > SMALLEST);
    let empty = compiled.graph.shape(compiled.root).is_some_and(|s| compiled.graph.as_constant(s.value).is_some());
    // Another camera that sees something.
    let better = || {
        let places = outside(&camera, region).filter(|place| field(*place) > 0.0);
        let cameras = places.map(|eye| Camera { eye, target: ahead(eye, target(&camera, region)), ..camera });
        let finds = |other: &Camera| sees(compiled, &reference, other, &frame, FAR) == Some(Sight::Solid);
        cameras.take(MOST_TRIED).find(finds).map(|other| written(nodes, &other))
    };
    if field(camera.eye) < 0.0 && length(camera.eye) < frame.extent {
        let message = format!("{who} stands inside the solid, where nothing can be seen rightly");
        let help = better().unwrap_or_else(|| "move its `eye` to where the field is above zero".to_owned());
        return Some(Diagnostic::new(Code::InsideSolid, place(compiled, nodes), message, help));
    }
    // A lamp in its own bulb.
    let lamp = || {
        let lights = frame.lights.iter().zip(&compiled.blocks.lights).filter(|(light, _)| frame.shadows && light.shadow != Shadow::None);
        let mut within = lights.filter(|(light, _)| matches!(light.kind, LightKind::Position(place) if length(place) < frame.extent && field(place) < 0.0));
        let (light, nodes) = within.next()?;
        let message = format!("the light `{}` stands inside the solid, whose shadow lies on everything", light.name);
        Some(Diagnostic::new(Code::InsideSolid, nodes.span, message, "move it out, or write `shadow: none` in it: then it shines through all that is solid"))
    };
    // Whoever writes `nothing` means it where there are meshes or balls.
    let has_others = !compiled.blocks.meshes.is_empty() || compiled.has_balls();
    if has_others {
        return lamp();
    }
    let sight = sees(compiled, &reference, &camera, &frame, frame.max_distance)?;
    if matches!(sight, Sight::Solid | Sight::Empty)
        && nodes.is_none_or(|nodes| nodes.eye.or(nodes.target).is_none())
        && let Some((thick, near)) = too_thin(&reference, &camera, &frame)
    {
        let near = Some(near).filter(|near| sees(compiled, &reference, near, &frame, FAR) == Some(Sight::Solid));
        let message = format!("what is solid is {} thick, which is less than a pixel from where the camera stands that is chosen for this scene", short(thick));
        let help = near.map_or_else(|| "say where a camera stands that is nearer, or make it thicker".to_owned(), |near| written(nodes, &near));
        return Some(Diagnostic::new(Code::UnderAPixel, place(compiled, nodes), message, help));
    }
    match sight {
        Sight::Solid => {
            return lamp().or_else(|| {
                let lost = share_lost(compiled, &reference, &camera, &frame).filter(|lost| *lost > HOLES)?;
                let message = format!("{:.0} of 100 rays that meet anything spend their steps before they get there, so the picture is wrong in places", 100.0 * lost);
                Some(Diagnostic::new(Code::RaysLost, place(compiled, nodes), message, EVENLY))
            })
            .or_else(|| leaves(compiled, live, which));
        }
        Sight::Lost => {
            let message = "rays spend all of their steps before they meet anything solid";
            return Some(Diagnostic::new(Code::NothingSeen, place(compiled, nodes), message, EVENLY));
        }
        Sight::Cut => {
            let message = format!("what is solid reaches beyond the scene's extent of {}, and nothing of it is seen", short(frame.extent));
            let help = format!("set `render {{ extent: … }}` to more{}", if compiled.blocks.says_extent { ", or leave it out" } else { "" });
            return Some(Diagnostic::new(Code::NothingSeen, place(compiled, nodes), message, help));
        }
        Sight::Empty => {}
    }
    let out = length(camera.eye).min(length(camera.target)) > frame.extent;
    let help = if out {
        format!("the camera has left the scene, which ends {} from the origin: set `render {{ extent: … }}` to more", short(frame.extent))
    } else if empty {
        "write a shape as the scene, for example `scene = sphere(1)`".to_owned()
    } else if sees(compiled, &reference, &camera, &frame, FAR)? == Sight::Solid {
        format!("it is farther away than `max_distance`, which is {}: set `render {{ max_distance: … }}` to more", short(frame.max_distance))
    } else {
        better().unwrap_or_else(|| "look for an `&` of shapes that do not meet, a `-` that takes all away, or a formula that is nowhere below zero".to_owned())
    };
    Some(Diagnostic::new(Code::NothingSeen, place(compiled, nodes), format!("nothing solid is in sight of {who}"), help))
}

/// Where 32 bits leave too little of what a camera sees, since large numbers cancel each other.
pub fn few_digits(compiled: &Compiled, live: &Live) -> Option<Diagnostic> {
    let lost = LOST * compiled.module.rounding.unit;
    let is_seen = |camera: &Camera| lost > Basis::of(camera).footprint(PIXELS) * length(sub(camera.target, camera.eye));
    let frame = compiled.frame(live);
    frame.cameras.iter().find(|(_, camera)| compiled.module.rounding.unit > 1.0 && is_seen(camera))?;
    let at = compiled.module.cancels.and_then(|node| compiled.graph.location(node)).unwrap_or_else(|| place(compiled, None));
    let message = format!("large numbers cancel each other here, and the 24 bits that are computed with leave surfaces off by about {}", short(lost));
    let help = "make the scene smaller; of a radius that is only moved and turned nothing is lost, and of one that is warped it is";
    Some(Diagnostic::new(Code::FewDigits, at, message, help))
}

/// Whether what is solid is thinner than a pixel where it is seen, and hardly any ray meets it: how thick it is, and a camera that is nearer.
fn too_thin(reference: &Reference, camera: &Camera, frame: &Frame) -> Option<(f64, Camera)> {
    let mut met = Vec::new();
    for (picture, many) in FEW {
        let hits = look(reference, camera, frame, frame.max_distance, picture);
        met = hits.into_iter().filter(|(hit, _)| hit.hit).map(|(hit, ray)| ray.at(hit.t)).collect();
        if met.len() >= many {
            return None;
        }
    }
    // What no ray meets is looked for from elsewhere.
    let around = [0.0, 0.1, 1.0].map(|share| along(camera.target, sub(camera.eye, camera.target), share));
    let places: Vec<Vec3> = met.into_iter().take(MOST_PLACES).chain(around).collect();
    let (mut least, mut thin, mut thicker): (Option<(f64, Vec3)>, usize, usize) = (None, 0, 0);
    for start in places {
        let Some((place, inward)) = surface_near(reference, start).filter(|(place, _)| length(*place) < frame.extent) else { continue };
        let pixel = Basis::of(camera).footprint(COARSE) * length(sub(place, camera.eye));
        let depths: Vec<f64> = (0..DEPTHS).map(|i| pixel * 2f64.powi(i + 1 - DEPTHS)).collect();
        let fields = fields_at(reference, &depths.iter().map(|depth| add(place, scale(inward, *depth))).collect::<Vec<Vec3>>());
        // It has to be solid somewhere, and to end again within a pixel: not so from the end of a needle.
        let mut ways = depths.iter().zip(&fields).skip_while(|(_, field)| **field >= 0.0);
        let Some(last) = ways.clone().take_while(|(_, field)| **field < 0.0).last() else { continue };
        let Some(beyond) = ways.find(|(_, field)| **field >= 0.0) else {
            thicker += 1;
            continue;
        };
        thin += 1;
        let thick = last.0 + (beyond.0 - last.0) * last.1 / (last.1 - beyond.1);
        if least.is_none_or(|(known, _)| thick > known) {
            least = Some((thick, place));
        }
    }
    let (thick, place) = least.filter(|_| thin > thicker)?;
    let way = unit(EYE)?;
    let [eye, target] = [add(place, scale(way, NEARBY * thick)), place].map(|place| place.map(rounded));
    Some((thick, Camera { eye, target, ..*camera }))
}

/// The nearest place of the surface, about, and the way in.
fn surface_near(reference: &Reference, start: Vec3) -> Option<(Vec3, Vec3)> {
    let mut place = start;
    for _ in 0..MOST_NEARER {
        let field = field_at(reference, place);
        let slope = reference.gradients(&[place]).first().copied()?;
        let inward = unit(scale(slope, -1.0))?;
        let on = field / length(slope);
        if on.abs() <= CLOSE * length(place).max(SMALLEST) {
            return Some((place, inward));
        }
        place = add(place, scale(inward, on));
    }
    None
}

/// What a camera is called in a message.
fn called(compiled: &Compiled, nodes: Option<&CameraNodes>) -> String {
    match nodes.filter(|nodes| compiled.blocks.cameras.len() > 1 && !nodes.name.is_empty()) {
        Some(nodes) => format!("the camera `{}`", nodes.name),
        None => "the camera".to_owned(),
    }
}

/// Whether a camera stands inside the solid, or sees nothing of it as far as is soon told.
pub fn is_blind(compiled: &Compiled, live: &Live, camera: &Camera) -> bool {
    let Ok(reference) = Reference::new(compiled, live) else { return false };
    let frame = compiled.frame(live);
    let has_others = !compiled.blocks.meshes.is_empty() || compiled.has_balls();
    field_at(&reference, camera.eye) < 0.0
        || !has_others && sees(compiled, &reference, camera, &frame, frame.max_distance).is_some_and(|sight| sight != Sight::Solid)
}

fn field_at(reference: &Reference, place: Vec3) -> f64 {
    fields_at(reference, &[place]).first().copied().unwrap_or(f64::NAN)
}

fn fields_at(reference: &Reference, places: &[Vec3]) -> Vec<f64> {
    let mut found = vec![f64::NAN; places.len()];
    at_points(reference.field(), places, &[], |i, values| {
        if let (Some(slot), Some(value)) = (found.get_mut(i), values.first()) {
            *slot = *value;
        }
    });
    found
}

/// What a camera sees.
#[derive(Clone, Copy, PartialEq)]
enum Sight {
    /// Something solid.
    Solid,
    /// What is solid is cut off by the extent, and fades there before it is seen.
    Cut,
    /// Nothing, and most rays spent all of their steps on the way.
    Lost,
    /// Nothing.
    Empty,
}

/// What is in sight, up to so far away. None where that takes too long to tell.
fn sees(compiled: &Compiled, reference: &Reference, camera: &Camera, frame: &Frame, far: f64) -> Option<Sight> {
    let (mut sight, mut most) = (Sight::Empty, MOST);
    for (width, height) in PICTURES {
        let cost = compiled.module.operations.1.max(1);
        if cost > LONGEST || (width * height) as usize * cost > most {
            // What is lost so far may be said to be.
            return (sight == Sight::Lost).then_some(sight);
        }
        let hits = look(reference, camera, frame, far, (width, height));
        let mut met = hits.iter().filter(|(hit, _)| hit.hit).map(|(hit, ray)| length(ray.at(hit.t))).peekable();
        let is_cut = met.peek().is_some();
        if met.any(|out| out < FADED * frame.extent) {
            return Some(Sight::Solid);
        }
        let lost = hits.iter().filter(|(hit, _)| hit.steps >= TRACER.budget).count();
        if lost > 0 {
            most = MOST_AFTER_LOST;
        }
        sight = match 2 * lost > hits.len() {
            _ if is_cut => Sight::Cut,
            true => Sight::Lost,
            false => Sight::Empty,
        };
    }
    Some(sight)
}

/// Which share of the rays that meet anything spend their steps before they come near it. None where few seem to, or that takes too long to tell.
fn share_lost(compiled: &Compiled, reference: &Reference, camera: &Camera, frame: &Frame) -> Option<f64> {
    let [_, more, ..] = PICTURES;
    let share = |picture: (u32, u32)| {
        let hits = look(reference, camera, frame, frame.max_distance, picture);
        // Those that spend many steps take less and less care, so that they end somewhere.
        let ended: Vec<&(Hit, Ray)> = hits.iter().filter(|(hit, _)| hit.hit || hit.steps >= TRACER.budget).collect();
        let places: Vec<Vec3> = ended.iter().map(|(hit, ray)| ray.at(hit.t)).collect();
        let (fields, slopes) = (fields_at(reference, &places), reference.gradients(&places));
        // By its slope it is solid there, unless the formula jumps to and fro.
        let there = places.iter().zip(&fields).zip(&slopes).map(|((at, field), slope)| sub(*at, scale(*slope, field / dot(*slope, *slope).max(SMALLEST))));
        let left = fields_at(reference, &there.collect::<Vec<Vec3>>());
        let found = ended.iter().zip(fields.iter().zip(&left).zip(&slopes));
        let lost = found.filter(|((hit, _), ((field, left), slope))| {
            let near = NEAR * Basis::of(camera).footprint(PIXELS) * hit.t;
            **field > near * length(**slope) || **field > near && **left > STILL * **field
        });
        (!ended.is_empty()).then(|| lost.count() as f64 / ended.len() as f64)
    };
    let is_short = |picture: (u32, u32)| (picture.0 * picture.1) as usize * compiled.module.operations.1.max(1) <= MOST_LOST;
    // Of what is small in the picture these few rays meet nothing, and say nothing.
    let few = is_short(SMALL).then(|| share(SMALL))?;
    if few == Some(0.0) || !is_short(more) { few } else { share(more) }
}

/// What rays meet through the pixels of a picture, up to so far away.
fn look(reference: &Reference, camera: &Camera, frame: &Frame, far: f64, (width, height): (u32, u32)) -> Vec<(Hit, Ray)> {
    let basis = Basis::of(camera);
    let pixels = (0..height).flat_map(|y| (0..width).map(move |x| (f64::from(x) + 0.5, f64::from(y) + 0.5)));
    let ray = |at| Ray { origin: basis.start(camera.eye, at, (width, height)), direction: basis.direction(at, (width, height)), t_min: 0.0, t_max: far };
    let rays: Vec<Ray> = pixels.map(ray).collect();
    let hits = reference.trace(&rays, basis.footprint(PIXELS), frame.extent);
    hits.into_iter().zip(rays).collect()
}

/// The camera's block, or where there is none the scene.
fn place(compiled: &Compiled, nodes: Option<&CameraNodes>) -> Span {
    let scene = || {
        let shape = compiled.graph.shape(compiled.root);
        shape.map(|s| compiled.graph.location(s.value).unwrap_or(s.span))
    };
    nodes.map(|n| n.span).or_else(scene).unwrap_or(Span::new(FileId(0), 0, 0))
}

/// Places from which a camera may see what is solid, the best first.
fn outside(camera: &Camera, region: Option<Box3>) -> impl Iterator<Item = Vec3> {
    let middle = target(camera, region);
    let away = unit(sub(camera.eye, middle)).or(unit(EYE)).unwrap_or([0.0, 1.0, 0.0]);
    let wide = region.map_or(0.0, |region| region.0.iter().map(|side| side.width()).fold(0.0, f64::max));
    let far = (AWAY * wide).max(length(sub(camera.eye, middle)));
    let ways = [away, [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [0.0, 0.0, 1.0], scale(away, -1.0)];
    let places = ways.into_iter().flat_map(move |way| [1.0, 2.0, 4.0].map(|times| add(middle, scale(way, far * times))));
    // Of what is hollow one sees most from within.
    places.chain([middle, [0.0; 3]]).map(|place| place.map(rounded))
}

/// What a better camera looks at.
fn target(camera: &Camera, region: Option<Box3>) -> Vec3 {
    region.map_or(camera.target, |region| region.0.map(|side| rounded(side.middle())))
}

/// The target of an eye that may stand just there.
fn ahead(eye: Vec3, target: Vec3) -> Vec3 {
    if length(sub(eye, target)) < SMALLEST { sub(eye, [0.0, 0.0, 1.0]) } else { target }
}

/// With three digits, as one writes it.
fn rounded(value: f64) -> f64 {
    format!("{value:.2e}").parse().unwrap_or(value)
}

fn short(value: f64) -> String {
    // Without the sign of a zero.
    format!("{}", rounded(value) + 0.0)
}

/// What to write for a camera.
fn written(nodes: Option<&CameraNodes>, camera: &Camera) -> String {
    let text = |p: Vec3| p.map(short).join(", ");
    let entries = format!("eye: ({}), target: ({})", text(camera.eye), text(camera.target));
    match nodes {
        Some(_) => format!("write `{entries}` in it, or other places from where something is seen"),
        None => format!("write `camera {{ {entries} }}`, or other places from where something is seen"),
    }
}

impl Outcome {
    /// What is wrong with what a camera sees at one moment: that of this name, or the first. That nothing is solid says why nothing is seen.
    pub fn outlook(&self, live: &Live, name: Option<&str>) -> Option<Diagnostic> {
        let is_said = self.diagnostics.iter().any(|d| d.code == Code::NothingSolid);
        outlook(self.compiled.as_ref()?, live, name).filter(|d| !is_said || d.code != Code::NothingSeen)
    }

    /// Adds what is wrong with what the cameras see: that takes a look at the scene through each, and some milliseconds.
    pub fn look(&mut self) {
        let Some(compiled) = &self.compiled else { return };
        let live = compiled.live();
        let is_said = self.diagnostics.iter().any(|d| d.code == Code::NothingSolid);
        let cameras = 0..compiled.blocks.cameras.len().max(1);
        let found: Vec<Diagnostic> = cameras.filter_map(|which| through(compiled, &live, which)).filter(|d| !is_said || d.code != Code::NothingSeen).collect();
        let coarse = few_digits(compiled, &live);
        self.diagnostics.extend(found.into_iter().chain(coarse));
        tidy(&mut self.diagnostics);
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]
mod tests {
    use crate::diagnostic::{Code, Diagnostic};
    use crate::{MemoryLoader, Options, compile};

    /// What a look at a scene finds, and what it says to write.
    fn found(text: &str) -> Option<(Code, String)> {
        look(text).map(|d| (d.code, d.help.split('`').nth(1).unwrap_or_default().to_owned()))
    }

    fn look(text: &str) -> Option<Diagnostic> {
        let scene = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default()).compiled.unwrap();
        super::outlook(&scene, &scene.live(), None)
    }

    /// What is said of a scene in which nothing is solid.
    fn of_nothing(text: &str) -> String {
        let mut outcome = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default());
        outcome.look();
        let words: Vec<String> = outcome.diagnostics.into_iter().map(|d| d.message).collect();
        words.join("\n")
    }

    #[test]
    fn of_what_is_not_solid_it_is_said_once_why() {
        let said = |text: &str, why: &str| {
            let words = of_nothing(text);
            assert!(words.lines().count() == 1 && words.contains(why), "{text}: {words}");
        };
        said("scene = sphere(1).translate(1e6, 0, 0)", "too coarse");
        said("scene = sphere(1).translate(5e4, 0, 0)", "extent of 100, which grows by itself only for what lies within 20000");
        said("scene = sphere(1).translate(500, 0, 0)\nrender { extent: 100 }", "extent of 100");
        said("scene = sphere(1) & sphere(1).translate(5, 0, 0)", "nothing of this scene is solid");
        said("scene = segment((-1, 0), (1, 0)).extrude(0.1)", "without an inside");
        said("scene = box(1) | (sphere(0.2) | segment((1, 0), (2, 0)).revolve()).translate(3, 0, 0)", "without an inside");
        for text in [
            "scene = segment((-1, 0), (1, 0)).round(0.05).extrude(0.1)",
            "scene = segment((-1, 0), (1, 0)).extrude(0.1).round(0.05)",
            "param w = 0.1 in 0..1\nscene = segment((-1, 0), (1, 0)).round(w).extrude(0.1)",
            "scene = rectangle(2, 1).extrude(0.1) | sphere(1)",
        ] {
            assert_eq!(of_nothing(text), "", "{text}");
        }
    }

    #[test]
    fn who_writes_what_is_said_sees_something() {
        for (scene, camera, code) in [
            ("scene = plane(y, 5)", "eye: (4, 3, 6)", Code::InsideSolid),
            ("scene = box(4)", "eye: (0, 0, 1)", Code::InsideSolid),
            ("scene = box(30) - box(29)", "eye: (14.8, 0, 0)", Code::InsideSolid),
            ("scene = sphere(1)", "eye: (0, 0, 5), target: (0, 0, 9)", Code::NothingSeen),
            ("scene = sphere(1).translate(40, 3, 0)", "eye: (0, 0, 5), target: (0, 0, 0)", Code::NothingSeen),
        ] {
            let block = if camera.is_empty() { String::new() } else { format!("camera {{ {camera} }}") };
            let (what, help) = found(&format!("{scene}\n{block}\n")).unwrap_or_else(|| panic!("{scene}: nothing is said"));
            assert_eq!(what, code, "{scene}");
            let mended = if camera.is_empty() { help } else { format!("camera {{ {help} }}") };
            assert_eq!(found(&format!("{scene}\n{mended}\n")), None, "{scene}\n{mended}");
        }
        assert_eq!(found("scene = sphere(1)"), None);
        // What the extent cuts off fades there.
        let within = |extent: &str| look(&format!("scene = sphere(1)\nrender {{ extent: {extent} }}")).map(|d| d.message);
        assert!(within("0.5").is_some_and(|words| words.contains("extent of 0.5")));
        assert_eq!(within("1.2"), None);
        // A flight that ends where the scene does, after five seconds.
        let flight = |eye: &str| look(&format!("scene = for c in grid((4, 0, 4)) {{ sphere(1) }}\ncamera {{ eye: (0, 3, {eye}), target: (0, 0, {eye} - 5) }}\n"));
        assert!(flight("-20 * time").is_some_and(|d| d.message.contains("after 5 seconds") || d.message.contains("after 6 seconds")));
        assert_eq!(flight("-20 * (time % 4)"), None);
        // A lamp in its bulb.
        let lit = |shadow: &str| found(&format!("scene = plane(y) | sphere(0.2).translate(0, 1, 0)\nlight l {{ position: (0, 1, 0){shadow} }}"));
        assert_eq!(lit(""), Some((Code::InsideSolid, "shadow: none".to_owned())));
        assert_eq!(lit(", shadow: none"), None);
        let julia = "let z = vec4(p, 0), d = 1 for i in 0..10 while dot(z, z) < 64 {
            z = vec4(z.x*z.x - dot(z.yzw, z.yzw), 2*z.x*z.yzw) + (-0.2, 0.6, 0.2, 0.2), d = 2 * length(z) * d
          }; 0.5 * length(z) * log(length(z)) / d";
        assert_eq!(look(&format!("field julia = {{ {julia} }}\nscene = julia")), None);
        let lost = look("field f = p.y + 3 + sin(1000 * p.x * p.z)\nscene = f").unwrap();
        assert!(lost.code == Code::NothingSeen && lost.message.contains("steps"), "{lost:?}");
        // Steps suffice to come into its box, and not to what is solid there.
        let torn = look("field f = length(p) - 1 + 0.5 * fract(1000 * p.x * p.y) * p.x\nscene = f").unwrap();
        assert!(torn.code == Code::RaysLost && torn.message.contains("of 100 rays"), "{torn:?}");
        // A tower of steps, far too steep to be seen over.
        let torn = look("field f = { let r = floor(9 * p.z); p.y - 9 / (1 + abs(floor(9 * p.x + 0.5 * r)) + abs(r)) }\nscene = f").unwrap();
        assert!(torn.code == Code::RaysLost && torn.message.contains("of 100 rays"), "{torn:?}");
        assert_eq!(found("scene = nothing").map(|f| f.0), Some(Code::NothingSeen));
    }
}
