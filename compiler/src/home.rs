//! Where a camera stands of which the text says nothing: what is solid and ends fills most of the picture, and the eye is free.

use crate::analysis::Box3;
use crate::camera::{EYE, FOV, Home, SMALLEST};
use crate::compiled::Compiled;
use crate::live::Live;
use crate::evaluate::Tape;
use crate::graph::interval::Interval;
use crate::graph::{Function, NodeId};
use crate::reference::march::at_points;
use crate::vector::{Vec3, add, length, mul, scale, sub, unit};
use std::f64::consts::TAU;

/// So many times farther away may the eye stand for one that is.
const FARTHER: [f64; 8] = [1.2, 1.4, 1.7, 2.0, 2.5, 3.2, 4.0, 5.0];
/// What moves is looked at so many times, the second time after so many seconds…
const LOOKS: u32 = 32;
const SOON: f64 = 0.19;
/// …and each time later by this much: for five minutes.
const LATER: f64 = 1.2;
/// …where that is no more operations in all.
const MOST: usize = 20_000_000;
/// Places about a box, a side.
const PLACES: i32 = 5;
/// They are moved by no more than this part of their way to its middle: just more than a ball needs.
const NEARER: f64 = 0.45;
/// A place is free where nothing solid is nearer than this share of the way to the target.
const FREE: f64 = 0.2;
/// Where else an eye may stand: how steeply above the target, and turned how far about it, in turns; and how much farther away.
const STEEP: [f64; 3] = [22.6, 45.0, 70.0];
const TURNS: [f64; 6] = [0.0, 0.125, -0.125, 0.25, -0.25, 0.5];
const TIMES: [f64; 6] = [1.0, 2.0, 4.0, 0.5, 0.25, 0.125];
/// The most operations of what is asked at one point.
const LIMIT: usize = 2_000_000;

impl Home {
    /// That of a scene, with its parameters as the text gives them.
    pub fn of(compiled: &Compiled) -> Self {
        let way = unit(EYE).unwrap_or([0.0, 0.0, 1.0]);
        let usual = Self { target: [0.0; 3], way, about: Vec::new(), room: 1.0 };
        let is_vast = compiled.is_vast();
        let framed = compiled.functions.ahead.home.filter(|region| region.size() > SMALLEST).map(|region| {
            let rest = compiled.functions.ahead.planes.map(|planes| planes.rest_distance).or(own(compiled, Function::Distance));
            let distances = |at: &[Vec3]| wherever_it_goes(compiled, rest.filter(|_| !is_vast)?, at);
            let target = region.0.map(Interval::middle);
            Self { target, about: places(&region, target, distances), ..usual.clone() }
        });
        let mut homes = framed.into_iter().chain([usual.clone()]);
        let about = if is_vast { None } else { About::of(compiled) };
        let home = homes.find_map(|home| home.free(about.as_ref())).unwrap_or(usual);
        Self { room: home.free_times(about.as_ref()), ..home }
    }

    /// The same from a way on which the eye is free, if there is one.
    fn free(&self, about: Option<&About>) -> Option<Self> {
        let from = |ways: &[Vec3]| {
            let others: Vec<Self> = ways.iter().map(|way| Self { way: *way, ..self.clone() }).collect();
            let eyes: Vec<Vec3> = others.iter().map(|other| other.camera(FOV).eye).collect();
            let found = about.map(|about| about.rooms(&eyes)).unwrap_or_default();
            let shares = eyes.iter().zip(found).map(|(eye, room)| room / length(sub(*eye, self.target)));
            others.into_iter().zip(shares.collect::<Vec<f64>>())
        };
        if from(&[self.way]).next().is_none_or(|(_, room)| room >= FREE) {
            return Some(self.clone());
        }
        let ways = TIMES.iter().flat_map(|times| TURNS.map(|turn| STEEP.map(|steep| scale(turned(self.way, turn, steep), *times))));
        let others: Vec<(Self, f64)> = from(&ways.flatten().collect::<Vec<Vec3>>()).collect();
        let widest = || others.iter().filter(|(_, room)| *room > 0.0).max_by(|a, b| a.1.total_cmp(&b.1));
        others.iter().find(|(_, room)| *room >= FREE).or_else(widest).map(|(other, _)| other.clone())
    }

    /// How many times as far away the eye may stand and be free, and everywhere between.
    fn free_times(&self, about: Option<&About>) -> f64 {
        let near = self.camera(FOV).eye;
        let from = sub(near, self.target);
        let eyes: Vec<Vec3> = FARTHER.iter().map(|times| add(self.target, scale(from, *times))).collect();
        let found = about.map(|about| about.rooms(&eyes)).unwrap_or_default();
        let free = FARTHER.iter().zip(found).take_while(|(times, room)| *room >= FREE * **times * length(from));
        free.map(|(times, _)| *times).last().unwrap_or(1.0)
    }
}

/// The way turned about the vertical, and as steep as that, in degrees.
fn turned(way: Vec3, turn: f64, steep: f64) -> Vec3 {
    let (yaw, pitch) = (way[0].atan2(way[2]) + turn * TAU, steep.to_radians());
    [yaw.sin() * pitch.cos(), pitch.sin(), yaw.cos() * pitch.cos()]
}

/// Places all over a box, from its middle, each as much nearer to that as nothing solid is about it: a ball in its box is no larger than it is.
fn places(region: &Box3, middle: Vec3, distances: impl Fn(&[Vec3]) -> Option<Vec<f64>>) -> Vec<Vec3> {
    let steps = || 0..PLACES;
    let all = steps().flat_map(|x| steps().flat_map(move |y| steps().map(move |z| [x, y, z])));
    let outer = all.filter(|at| at.iter().any(|i| *i == 0 || *i == PLACES - 1));
    let half = region.0.map(|side| 0.5 * side.width());
    let from: Vec<Vec3> = outer.map(|at| mul(at.map(|i| f64::from(2 * i) / f64::from(PLACES - 1) - 1.0), half)).collect();
    let at: Vec<Vec3> = from.iter().map(|place| add(middle, *place)).collect();
    let Some(found) = distances(&at) else { return from };
    let pulled = |(place, distance): (&Vec3, f64)| scale(*place, 1.0 - (distance / length(*place)).clamp(0.0, NEARER));
    from.iter().zip(found).map(pulled).collect()
}

/// The least distance from some places as time goes by; none where that takes too long.
fn wherever_it_goes(compiled: &Compiled, distance: NodeId, at: &[Vec3]) -> Option<Vec<f64>> {
    let looks = if compiled.reads_time() { LOOKS } else { 1 };
    let mut least = vec![f64::INFINITY; at.len()];
    let times = std::iter::successors(Some(0.0), |time| Some(LATER * time + SOON));
    for time in times.take(looks as usize) {
        let live = Live { time, ..compiled.live() };
        let tape = Tape::new(&compiled.graph, &compiled.functions.formulas, &[distance], &live, LIMIT).ok()?;
        if looks > 1 && tape.operations() * at.len() * looks as usize > MOST {
            return None;
        }
        for (least, [distance, ..]) in least.iter_mut().zip(values(&tape, at)) {
            *least = least.min(distance);
        }
    }
    Some(least)
}

/// What tells how near what is solid is: the field and its gradient, and a box that holds it.
struct About {
    tape: Tape,
    region: Option<Box3>,
}

impl About {
    /// That of a scene; none where its formulas are too long.
    fn of(compiled: &Compiled) -> Option<Self> {
        let all = [Function::Field, Function::Gradient(0), Function::Gradient(1), Function::Gradient(2)].map(|function| own(compiled, function));
        let all: Vec<NodeId> = all.into_iter().collect::<Option<_>>()?;
        let tape = Tape::new(&compiled.graph, &compiled.functions.formulas, &all, &compiled.live(), LIMIT).ok()?;
        let ahead = &compiled.functions.ahead;
        Some(Self { tape, region: if ahead.planes.is_none() { ahead.home } else { None } })
    }

    /// How far from some places what is solid is. Far from it a polynomial over its slope is no measure of that, and the box is.
    fn rooms(&self, at: &[Vec3]) -> Vec<f64> {
        let from_box = |place: &Vec3| self.region.map_or(0.0, |region| length(from_outside(&region, *place)));
        let slope = |[field, x, y, z]: [f64; 4]| field / length([x, y, z]).max(1.0);
        let found = values(&self.tape, at).into_iter().map(slope);
        found.zip(at).map(|(room, place)| if from_box(place) > 0.0 { room.max(from_box(place)) } else { room }).collect()
    }
}

/// The formula of one of the scene's functions.
fn own(compiled: &Compiled, function: Function) -> Option<NodeId> {
    compiled.functions.formulas.get(&(compiled.root, function)).copied()
}

/// The way into a box from a place, by the shortest way; nothing within it.
fn from_outside(region: &Box3, place: Vec3) -> Vec3 {
    let [x, y, z] = region.0;
    let [px, py, pz] = place;
    [(x, px), (y, py), (z, pz)].map(|(side, at)| (side.lo - at).max(at - side.hi).max(0.0))
}

/// Up to four formulas at some places.
fn values(tape: &Tape, at: &[Vec3]) -> Vec<[f64; 4]> {
    let mut found = vec![[0.0; 4]; at.len()];
    at_points(tape, at, &[], |i, values| {
        for (slot, value) in found.get_mut(i).into_iter().flatten().zip(values) {
            *slot = *value;
        }
    });
    found
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]
mod tests {
    use crate::camera::{FOV, SHARE, WIDE};
    use crate::camera::Camera;
    use crate::compiled::Compiled;
    use crate::diagnostic::Code;
    use crate::reference::Reference;
    use crate::camera::Basis;
    use crate::reference::march::Ray;
    use crate::vector::{length, sub};
    use crate::{MemoryLoader, Options, compile};

    fn scene(text: &str) -> Compiled {
        compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default()).compiled.unwrap()
    }

    fn camera(scene: &Compiled) -> Camera {
        scene.frame(&scene.live()).cameras[0].1
    }

    /// The farthest above and below the picture's middle, and to its sides, that something solid is seen, as parts of half of the picture's height.
    fn filled(scene: &Compiled) -> [f64; 2] {
        let (camera, live) = (camera(scene), scene.live());
        let basis = Basis::of(&camera);
        const SIZE: (u32, u32) = (200, 100);
        let pixels: Vec<_> = (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (f64::from(x) + 0.5, f64::from(y) + 0.5))).collect();
        let ray = |at: &(f64, f64)| Ray { origin: basis.start(camera.eye, *at, SIZE), direction: basis.direction(*at, SIZE), t_min: 0.0, t_max: 1e9 };
        let rays: Vec<Ray> = pixels.iter().map(ray).collect();
        let hits = Reference::new(scene, &live).unwrap().trace(&rays, basis.footprint(SIZE.1), scene.frame(&live).extent);
        let seen = || pixels.iter().zip(&hits).filter(|(_, hit)| hit.hit).map(|(at, _)| at);
        [seen().map(|at| (at.1 / 50.0 - 1.0).abs()).fold(0.0, f64::max), seen().map(|at| (at.0 / 50.0 - 2.0).abs()).fold(0.0, f64::max)]
    }

    #[test]
    fn what_ends_fills_most_of_the_picture() {
        for text in [
            "sphere(0.01)", "sphere(0.1)", "sphere(0.5)", "sphere(1)", "sphere(30)", "box(1)", "box(0.2, 3, 0.2)", "box(5, 0.1, 1)", "sphere(1).translate(1e3, 0, 0)",
            "box(1) | sphere(0.5).translate(1.2, 0, 0)", "torus(1.5, 0.5)", "torus(1.5, 0.1).rotate(x, 40deg)", "smooth_union(sphere(1), box(1).translate(1, 1, 0), 0.4)",
            "capsule((0, 0, 0), (3, 1, 2), 0.2)", "box_frame((1, 1, 1), 0.05)",
        ] {
            let [high, wide] = filled(&scene(&format!("scene = {text}")));
            let share = high.max(wide / WIDE);
            println!("{text}: {high:.2} {wide:.2}");
            assert!(share > 0.8 * SHARE && share < 1.15 * SHARE, "{text}: {high:.2} {wide:.2}");
        }
        // A row as wide as a slider says, of what has as many flutes as another one says.
        let [high, wide] = filled(&scene(
            "param span = 2 in 1.2..3\nparam flutes: int = 16 in 8..24
            let column = cylinder(0.28, 2) - cylinder(0.05, 3).translate(0.3, 1, 0).repeat_polar(y, flutes)
            let bay = box((span, 4, 0.6)) | (column | box((0.8, 0.2, 0.8)).translate(0, 0.1, 0)).translate((span + 0.8) / 2, 0, 0.6)
            scene = for i in -2..3 { bay.translate(i * (span + 0.8), 0, 0) }",
        ));
        assert!(high < SHARE && wide < WIDE && wide > 0.3, "{high:.2} {wide:.2}");
        // What moves is seen wherever it goes.
        let moving = camera(&scene("scene = sphere(0.3).translate(2 * sin(time), 0, 0)"));
        assert!(length(moving.eye) > 5.0, "{moving:?}");
        // What turns on its own axis goes nowhere, and corners are no larger than they are.
        let distance = |text: &str| length(camera(&scene(&format!("scene = {text}"))).eye);
        let turning = distance("cylinder(1, 1).rotate(y, time)") / distance("cylinder(1, 1)");
        assert!((0.99..1.2).contains(&turning), "{turning}");
        // So does a drawing, whose coordinates may then be anything.
        let turning = distance("star(5, 1, 0.5).rotate(time).extrude(0.3)") / distance("star(5, 1, 0.5).extrude(0.3)");
        assert!((0.99..1.7).contains(&turning), "{turning}");
        // Of a polynomial its slope far away says nothing of how near it is.
        let cubed = distance("polynomial.within(sphere(1.6))\nfield polynomial = cubed(dot(p, p) - 1)") / distance("sphere(1)");
        assert!((0.99..1.6).contains(&cubed), "{cubed}");
        // In an upright picture it stands farther away, and not where the text says where.
        let still = scene("scene = box(4, 1, 1)");
        let (usual, upright) = (camera(&still), still.camera_in(camera(&still), 0.65));
        assert!((1.7..2.1).contains(&(length(upright.eye) / length(usual.eye))), "{upright:?}");
        assert_eq!(still.camera_in(usual, 2.0), usual);
        let said = scene("scene = box(4, 1, 1)\ncamera { eye: (0, 1, 5) }");
        assert_eq!(said.camera_in(camera(&said), 0.65), camera(&said));
        // A wider view is one from nearer.
        let wide = camera(&scene("scene = sphere(1)\ncamera { fov: 80deg }"));
        assert!(length(wide.eye) < 0.6 * length(camera(&scene("scene = sphere(1)")).eye) && wide.fov > FOV, "{wide:?}");
    }

    const JULIA: &str = "let z = vec4(p, 0), d = 1 for i in 0..10 while dot(z, z) < 64 {
        z = vec4(z.x*z.x - dot(z.yzw, z.yzw), 2*z.x*z.yzw) + (-0.2, 0.6, 0.2, 0.2), d = 2 * length(z) * d
      }; 0.5 * length(z) * log(length(z)) / d";

    #[test]
    fn the_eye_is_free() {
        for text in [
            "for c in grid((2, 0, 2)) { let h = 0.5 + 3 * hash(c); box(1.4, h, 1.4).translate(0, h / 2, 0) } | plane(y)",
            "gyroid(1, 0.1)", "heightfield(p.x * p.x)", "plane(y, 5)", "complement(sphere(3))", "julia", "sphere(0.1) | plane(y, 5)",
        ] {
            let scene = scene(&format!("field julia = {{ {JULIA} }}\nscene = {text}"));
            let eye = camera(&scene).eye;
            let room = super::About::of(&scene).unwrap().rooms(&[eye])[0];
            println!("{text}: {eye:.2?}, {room:.2} from what is solid");
            assert!(room > 0.05 * length(eye), "{text}: {eye:?}, {room}");
            let found = crate::outlook::outlook(&scene, &scene.live(), None);
            // A parabola without end is too steep for rays, wherever one stands.
            assert!(found.as_ref().is_none_or(|d| d.code == Code::RaysLost), "{text}: {found:?}");
        }
        // Where nothing is in its way it stands as ever.
        assert_eq!(camera(&scene("scene = plane(y)")).eye, [4.0, 3.0, 6.0]);
    }

    #[test]
    fn a_scene_without_a_camera_is_seen_whole() {
        let seen = |text: &str| {
            let scene = scene(text);
            let frame = scene.frame(&scene.live());
            (frame.cameras[0].1, frame.extent)
        };
        for other in ["scene = box(20)", "scene = sphere(0.01)", "scene = sphere(1).translate(0, 0, 30)", "scene = sphere(400) | plane(y, -400)", "param r = 10 in 1..1000\nscene = box(2 * r)"] {
            let (camera, extent) = seen(other);
            let away = length(sub(camera.eye, camera.target));
            let (middle, radius) = match other {
                o if o.contains("0.01") => ([0.0; 3], 0.01),
                o if o.contains("30)") => ([0.0, 0.0, 30.0], 1.0),
                o if o.contains("400") => ([0.0; 3], 400.0),
                _ => ([0.0; 3], 10.0),
            };
            assert!(length(sub(camera.target, middle)) < 0.1 * radius, "{other}: {camera:?}");
            assert!(away > 2.5 * radius && away < 8.0 * radius, "{other}: {camera:?}");
            assert!(extent > 1.4 * radius, "{other}: {extent}");
        }
        // Of these shapes a first look says next to nothing of where they end.
        for (other, radius) in [
            ("scene = prism(6, 30, 30)", 42.0),
            ("scene = pyramid(300, 300)", 260.0),
            ("scene = superquadric((10, 10, 10), 4)", 12.0),
            ("scene = star(5, 400, 200).extrude(50)", 530.0),
            ("scene = box(30).shear(y, x, 0.3)", 29.0),
            ("scene = cylinder((-60, -60, 0), (60, 60, 5), 4)", 89.0),
            ("scene = (rectangle((300, 200)) - for i in 0..11 { circle(4).translate(80, 0).rotate(i / 11 * 1turn) }).extrude(10)", 180.0),
            ("scene = for i in 0..200 by smooth_union(2) { sphere(3).translate(10 * (i - 100), 0, 0) }", 1000.0),
            ("param n: int = 6 in 3..12\nscene = prism(n, 300, 50)", 400.0),
            ("scene = sphere(3).translate(300, 0, 0).repeat_polar(y, 40)", 430.0),
            ("scene = box(10).translate(150, 0, 0).repeat_polar(y, 12) | sphere(20)", 220.0),
            ("scene = (for c in polar(30) { circle(3).translate(400, 0) }).extrude(4)", 570.0),
            ("scene = sphere(101).repeat(250, (2, 1, 2))", 330.0),
        ] {
            let (camera, extent) = seen(other);
            let away = length(sub(camera.eye, camera.target));
            assert!(length(camera.target) < 0.1 * radius, "{other}: {camera:?}");
            assert!(away > 1.5 * radius && away < 8.0 * radius, "{other}: {camera:?}");
            assert!(extent > 1.4 * radius, "{other}: {extent}");
        }
        // A tree whose branches are turned, again and again: its middle is in the picture.
        let tree = "shape tree(n: int, len: float) = {
  let trunk = capsule((0, 0, 0), (0, len, 0), 0.08 * len);
  if n == 0 { trunk } else {
    trunk
    | tree(n - 1, 0.7 * len).rotate(z, 30deg).translate(0, len, 0)
    | tree(n - 1, 0.7 * len).rotate(z, -25deg).rotate(y, 70deg).translate(0, len, 0)
    | tree(n - 1, 0.6 * len).rotate(x, 35deg).translate(0, len, 0)
  }
}";
        for (branches, height) in [(4, 2.7), (5, 3.0), (7, 3.2)] {
            let (camera, _) = seen(&format!("{tree}\nscene = tree({branches}, 1)"));
            let away = length(sub(camera.eye, camera.target));
            assert!((camera.target[1] - 0.5 * height).abs() < 0.5, "{branches}: {camera:?}");
            assert!(away > 1.2 * height && away < 4.0 * height, "{branches}: {camera:?}");
        }
        // Who says where the camera stands has it there.
        let (camera, extent) = seen("scene = box(20)\ncamera { eye: (0, 0, 50) }\nrender { extent: 30 }");
        assert_eq!((camera.eye, extent), ([0.0, 0.0, 50.0], 30.0));
    }
}
