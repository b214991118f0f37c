//! The picture in 64 bits: the twin of what the emitted module and the pass over the screen do on a GPU.
//!
//! Tracing, shadow and occlusion are step for step those of `compiler/src/emit/library.rs`, the light is that of
//! `compiler/src/shading/*.wgsl`. A picture is made tile by tile; tiles may be made on as many threads as there are.

mod ahead;
pub mod area;
pub mod film;
pub(crate) mod follow;
mod glass;
mod layers;
mod light;
pub mod march;
mod scene;
mod section;
pub mod shade;
mod shadow;
pub mod steps;
pub mod tone;
mod views;

pub use follow::Kind;
pub use scene::{Area, Hit, Reference, View};
use scene::{BLOCK, LIMIT, Rest, numbered};

use crate::camera::Camera;
use crate::compiled::Compiled;
use crate::frame::Frame;
use crate::interface::Rounding;
use crate::live::Live;
use crate::evaluate::{Tape, TooLarge};
use crate::section::Plane;
use crate::graph::{Function, NodeId};
use crate::functions::Planes;
use crate::images::{Images, Texture};
use ahead::PlanesApart;
use area::Part;
use crate::camera::Basis;
use follow::{Follow, Small, TRACER, Turn};
use march::{Look, Ray, Scene, at_points, march, sizes};
use section::Opened;
use shade::{Seen, Shading, SurfaceValues};
use std::cell::Cell;
use std::sync::Arc;
use crate::vector::{Vec3, along, length, only, scale, unit};

pub use film::{rgb8, sample_offset};

impl Reference {
    /// The functions of a scene with parameters and time as they are at one moment.
    pub fn new(compiled: &Compiled, live: &Live) -> Result<Self, TooLarge> {
        let functions = &compiled.functions;
        let own = |f: Function| functions.formulas.get(&(compiled.root, f)).copied();
        let value = compiled.graph.shape(compiled.root).map_or(NodeId(0), |s| s.value);
        let field = own(Function::Field).unwrap_or(value);
        let bound = own(Function::Bound).unwrap_or(field);
        let distance = own(Function::Distance).unwrap_or(field);
        let tape = |roots: &[NodeId]| Tape::new(&compiled.graph, &functions.formulas, roots, live, LIMIT);
        let slopes: Option<Vec<NodeId>> = (0..3).map(|i| own(Function::Gradient(i))).collect();
        let s = &functions.surface;
        let ahead = &functions.ahead;
        let (rest_bound, rest_distance) = ahead.planes.map_or((bound, distance), |p| (p.rest_bound, p.rest_distance));
        let planes = |p: Planes| Ok(PlanesApart { distance: tape(&[p.distance])?, way: tape(&[p.way])? });
        Ok(Self {
            field: tape(&[field])?,
            bound: tape(&[bound])?,
            distance: tape(&[distance])?,
            rest: Rest { bound: tape(&[rest_bound])?, distance: tape(&[rest_distance])?, both: tape(&[rest_bound, rest_distance])? },
            planes: ahead.planes.map(planes).transpose()?,
            region: ahead.region,
            gradient: slopes.map(|slopes| tape(&slopes)).transpose()?,
            surface: tape(&s.look())?,
            layers: s.is_layered().then(|| tape(&s.layer_nodes()).map(|tape| (s.clone(), tape))).transpose()?,
            glass: s.glass.map(|glass| tape(&glass)).transpose()?,
            images: Images {
                environment: compiled.blocks.environment.as_ref().map(|_| Arc::new(shade::plain_sky())),
                textures: functions.textures().into_iter().map(|(_, kind)| Arc::new(Texture::missing(kind))).collect(),
            },
            loose: functions.loose,
            lamps: compiled.blocks.has_lamps(),
            rounding: compiled.module.rounding,
        })
    }

    /// The same with the images that the scene names.
    pub fn with_images(mut self, images: &Images) -> Self {
        if images.environment.is_some() {
            self.images.environment = images.environment.clone();
        }
        if images.textures.len() == self.images.textures.len() {
            self.images.textures = images.textures.clone();
        }
        self
    }

    /// What the formulas say: negative inside.
    pub fn field(&self) -> &Tape {
        &self.field
    }

    /// How far a ray may step.
    pub fn bound(&self) -> &Tape {
        &self.bound
    }

    /// The estimate of the distance that light and contact use.
    pub fn distance(&self) -> &Tape {
        &self.distance
    }

    /// Operations of a function of the module that its tracer calls, by its name without the prefix; 0 where the scene has none of that name.
    pub fn operations(&self, name: &str) -> usize {
        let tape = match name {
            "field" => &self.field,
            "bound" => &self.bound,
            "distance" => &self.distance,
            "rest_bound" => &self.rest.bound,
            "rest_distance" => &self.rest.distance,
            "ahead" => return self.planes.as_ref().map_or(0, |planes| planes.way.operations()),
            _ => return 0,
        };
        tape.operations()
    }

    /// What rounding in 32 bits grows with, at a point so far along a ray.
    fn rounded(&self, point: Vec3, t: f64) -> f64 {
        let Rounding { reads_scene, unit } = self.rounding;
        let read = length(only(point, reads_scene));
        unit + if reads_scene == [true; 3] { read } else { read.hypot(t) }
    }

    /// The field's gradients at points that lie close together.
    pub fn gradients(&self, points: &[Vec3]) -> Vec<Vec3> {
        let mut all = vec![[0.0; 3]; points.len()];
        if let Some(tape) = &self.gradient {
            at_points(tape, points, &[], |i, values| {
                if let (Some(slot), &[x, y, z]) = (all.get_mut(i), values) {
                    *slot = [x, y, z];
                }
            });
            return all;
        }
        // Where there is no formula: by differences.
        for axis in 0..3 {
            for side in [-1.0, 1.0] {
                let step = |p: &Vec3| 1e-6 * (self.rounding.unit.min(1.0) + length(*p));
                let moved: Vec<Vec3> = points
                    .iter()
                    .map(|p| {
                        let mut q = *p;
                        q.iter_mut().skip(axis).take(1).for_each(|c| *c += side * step(p));
                        q
                    })
                    .collect();
                at_points(&self.field, &moved, &[], |i, values| {
                    let by = points.get(i).map_or(1.0, |p| 2.0 * step(p));
                    let slot = all.get_mut(i).and_then(|g| g.get_mut(axis));
                    if let (Some(slot), Some(value)) = (slot, values.first()) {
                        *slot += side * value / by;
                    }
                });
            }
        }
        all
    }

    /// First hits along rays. `footprint` is the width of a pixel at distance one; beyond `extent` from the scene's origin there is
    /// nothing.
    pub fn trace(&self, rays: &[Ray], footprint: f64, extent: f64) -> Vec<Hit> {
        self.traced(rays, footprint, extent, |_, _, _, _, _, _| {})
    }

    /// The same. `record` hears of each look: the part of its ray that is looked at, how near is near enough there, where the ray is in its search before
    /// and after, what comes of it, and whether its looks are spent.
    fn traced(
        &self,
        rays: &[Ray],
        footprint: f64,
        extent: f64,
        mut record: impl FnMut(&Look, &Ray, f64, [&Follow; 2], &Turn, bool),
    ) -> Vec<Hit> {
        let whole: Vec<Option<Ray>> = rays.iter().map(|ray| ray.clip(extent)).collect();
        // The first plane ends the search for everything else.
        let planes = self.planes.as_ref().map_or_else(|| vec![f64::INFINITY; rays.len()], |planes| planes.ahead(&whole));
        let clipped: Vec<Option<Ray>> = whole
            .iter()
            .zip(&planes)
            .map(|(ray, &plane)| {
                let ray = Ray { t_max: ray.as_ref()?.t_max.min(plane), ..(*ray)? };
                self.region.as_ref().map_or(Some(ray), |region| ray.within(region, self.rounding.unit))
            })
            .collect();
        let at_plane = |ray: usize| planes.get(ray).copied().filter(|t| whole.get(ray).copied().flatten().is_some_and(|r| *t <= r.t_max));
        let mut hits: Vec<Hit> = (0..)
            .zip(rays)
            .map(|(i, r)| match at_plane(i) {
                Some(t) => Hit { t, hit: true, steps: 0 },
                None => Hit { t: r.t_max, ..Hit::default() },
            })
            .collect();
        let states = vec![Cell::new(Follow::START); rays.len()];
        let state = |look: &Look| states.get(look.ray).map_or(Follow::START, Cell::get);
        let size = sizes(rays, self.rounding);
        let small = |look: &Look| Small { pixel: footprint * look.t, rounding: 4e-7 * (size(look) + look.t) };
        // Only a hit asks for the distance; where it costs next to nothing it comes along.
        let Rest { bound, distance, both } = &self.rest;
        let scene = match both.operations() * 5 <= bound.operations() * 6 {
            true => Scene::Both(both),
            false => Scene::Apart(bound, distance),
        };
        march(
            scene,
            &clipped,
            |look| look.free <= state(look).tolerance(&small(look)),
            |look, distance| {
                let hit = hits.get_mut(look.ray)?;
                let ray = clipped.get(look.ray).copied().flatten()?;
                let end = rays.get(look.ray)?.t_max;
                let before = state(look);
                let mut follow = before;
                let turn = follow.turn(look, distance, &small(look), &ray);
                record(look, &ray, before.tolerance(&small(look)), [&before, &follow], &turn, follow.steps >= TRACER.budget);
                states.get(look.ray)?.set(follow);
                *hit = Hit { t: look.t, hit: false, steps: follow.steps };
                match turn {
                    Turn::Hit(t) => *hit = Hit { t, hit: true, ..*hit },
                    Turn::Go(t) if follow.steps < TRACER.budget => return Some(t),
                    Turn::Missed => {
                        hit.t = end;
                        if let Some(t) = at_plane(look.ray) {
                            *hit = Hit { t, hit: true, ..*hit };
                        }
                    }
                    Turn::Go(_) => {}
                }
                None
            },
        );
        hits
    }

    /// How much light comes along rays: 1 lit, 0 dark. Of `softness` 0 is a sharp edge; else the light is a disc that is seen under the half-angle
    /// atan(1 / softness), of which the share that is seen is estimated.
    pub fn shadow(&self, rays: &[Ray], softness: f64, extent: f64) -> Vec<f64> {
        self.shadows(rays, &vec![softness; rays.len()], extent)
    }

    /// The same, each ray of its own softness.
    fn shadows(&self, rays: &[Ray], softness: &[f64], extent: f64) -> Vec<f64> {
        shadow::shares(self, rays, softness, extent)
    }

    /// How open the surroundings of a surface are: 1 open, 0 closed; at strength 1 the edge of a wedge gets the share of the sky that it sees,
    /// weighted by the cosine. `reach` is how far is looked.
    pub fn occlusion(&self, places: &[Seen], reach: f64, strength: f64) -> Vec<f64> {
        let mut sums = vec![0.0; places.len()];
        if reach <= 0.0 || strength <= 0.0 {
            return vec![1.0; places.len()];
        }
        let mut weight = 1.0;
        for i in 1..=5 {
            let height = reach * f64::from(i) / 5.0;
            let points: Vec<Vec3> =
                places.iter().map(|s| along(s.point, s.normal, height)).collect();
            at_points(&self.distance, &points, &[], |i, values| {
                let free = values.first().map_or(height, |d| d.clamp(-height, height));
                if let Some(sum) = sums.get_mut(i) {
                    *sum += weight * (height - free) / height;
                }
            });
            weight *= 0.5;
        }
        // The weights add up to 31 / 16.
        sums.iter().map(|sum| (1.0 - strength * sum / 3.875).clamp(0.0, 1.0)).collect()
    }

    /// How surfaces answer light.
    pub fn surfaces(&self, places: &[Seen]) -> Vec<SurfaceValues> {
        let points: Vec<Vec3> = places.iter().map(|s| s.point).collect();
        let normals: Vec<Vec3> = places.iter().map(|s| s.normal).collect();
        let mut all = vec![SurfaceValues::default(); places.len()];
        at_points(&self.surface, &points, &normals, |i, values| {
            if let (Some(slot), &[r, g, b, er, eg, eb, roughness, metallic, reflectivity]) =
                (all.get_mut(i), values)
            {
                let (color, emission) = ([r, g, b], [er, eg, eb]);
                *slot = SurfaceValues { color, emission, roughness, metallic, reflectivity, ..SurfaceValues::default() };
            }
        });
        if let Some(tape) = &self.glass {
            at_points(tape, &points, &normals, |i, values| {
                if let (Some(slot), &[transmission, ior]) = (all.get_mut(i), values) {
                    (slot.transmission, slot.ior) = (transmission.clamp(0.0, 1.0), ior.max(1.0));
                }
            });
        }
        all
    }

    /// Places with what lies on them: how they answer light, their normals leant as their relief says.
    fn dressed(&self, places: &[Seen], footprint: f64) -> (Vec<Seen>, Vec<SurfaceValues>) {
        let mut surfaces = self.surfaces(places);
        let mut dressed = places.to_vec();
        if let Some((surface, tape)) = &self.layers {
            layers::lay(surface, tape, &self.images, footprint, &mut dressed, &mut surfaces);
        }
        (dressed, surfaces)
    }

    /// A part of a picture of `size` pixels: for each pixel, row by row from the top, the colour as a screen wants it (red, green, blue,
    /// sRGB-encoded, 0 to 1), and how far the surface is, below 0 where there is none.
    pub fn tile(
        &self,
        frame: &Frame,
        camera: &Camera,
        size: (u32, u32),
        view: View,
        area: Area,
    ) -> Vec<[f32; 4]> {
        self.tile_at(frame, camera, size, view, area, 0)
    }

    /// The same for the picture of a film with a number: it looks at places of its own in the pixels and on the lights. Of a scene whose light is
    /// scattered it is as if none were: see [`Reference::light_at`].
    pub fn tile_at(
        &self,
        frame: &Frame,
        camera: &Camera,
        size: (u32, u32),
        view: View,
        area: Area,
        sample: u32,
    ) -> Vec<[f32; 4]> {
        let mut pixels = self.light_at(frame, camera, size, view, area, sample);
        if view == View::Shaded {
            for [r, g, b, _] in &mut pixels {
                [*r, *g, *b] = film::develop(frame.tone, [*r, *g, *b].map(f64::from)).map(|c| c as f32);
            }
        }
        pixels
    }

    /// The same where the scene is seen in its light, as that light, exposed and linear: what [`film::bloom`] scatters and [`film::develop`] makes
    /// a screen's colour of.
    pub fn light_at(
        &self,
        frame: &Frame,
        camera: &Camera,
        size: (u32, u32),
        view: View,
        area: Area,
        sample: u32,
    ) -> Vec<[f32; 4]> {
        let shading = Shading { part: Part::of(sample), spacing: shade::slice_spacing(camera), ..Shading::of(frame, self.images.environment.clone()) };
        let offset = sample_offset(sample);
        let basis = Basis::of(camera);
        let plane = frame.section.map(|section| section.plane(camera));
        let mut pixels = vec![[0.0; 4]; area.width as usize * area.height as usize];
        for top in (0..area.height).step_by(BLOCK as usize) {
            for left in (0..area.width).step_by(BLOCK as usize) {
                let width = BLOCK.min(area.width - left);
                let height = BLOCK.min(area.height - top);
                let places: Vec<(u32, u32)> = (0..height)
                    .flat_map(|y| (0..width).map(move |x| (left + x, top + y)))
                    .collect();
                let rays: Vec<Ray> = places
                    .iter()
                    .map(|&(x, y)| {
                        let at = (f64::from(area.left + x) + 0.5 + offset[0], f64::from(area.top + y) + 0.5 + offset[1]);
                        let direction = basis.direction(at, size);
                        Ray { origin: basis.start(camera.eye, at, size), direction, t_min: 0.0, t_max: frame.max_distance }
                    })
                    .collect();
                let colors = self.block(frame, &shading, plane.as_ref(), view, &rays, basis.footprint(size.1));
                for (&(x, y), color) in places.iter().zip(colors) {
                    let at = y as usize * area.width as usize + x as usize;
                    if let Some(pixel) = pixels.get_mut(at) {
                        *pixel = color;
                    }
                }
            }
        }
        pixels
    }

    /// The pixels of some rays that lie close together.
    fn block(
        &self,
        frame: &Frame,
        shading: &Shading,
        plane: Option<&Plane>,
        view: View,
        rays: &[Ray],
        footprint: f64,
    ) -> Vec<[f32; 4]> {
        if let View::Slice(axis) = view {
            return self.sliced(frame, axis, shading.spacing, rays, footprint);
        }
        let opened = plane.map(|plane| (plane, self.opened(plane, rays, frame.extent)));
        let rays = opened.as_ref().map_or(rays, |(_, opened)| &opened.rays);
        let mut hits = self.trace(rays, footprint, frame.extent);
        let met = numbered(rays, &hits);
        let mut colors: Vec<Vec3> = match view {
            View::Shaded => {
                rays.iter().map(|r| shading.exposed(shading.behind(r.direction))).collect()
            }
            View::Steps => hits.iter().map(|hit| shade::steps_color(hit.steps)).collect(),
            View::Operations => {
                let each = self.rest.bound.operations() as f64;
                hits.iter().map(|hit| shade::operations_color(each * f64::from(hit.steps))).collect()
            }
            View::Depth => vec![[0.0; 3]; rays.len()],
            _ => vec![shade::NOTHING; rays.len()],
        };
        let places = match view {
            View::Steps | View::Operations | View::Depth => Vec::new(),
            _ => self.places(&met),
        };
        let found: Vec<Vec3> = match view {
            View::Shaded => self.light(frame, shading, &places, footprint),
            View::Normals => places.iter().map(|s| shade::normal_color(s.normal)).collect(),
            View::Steps | View::Operations | View::Slice(_) => Vec::new(),
            View::Gradient => self.steepness(&places),
            View::Factor => self.parts_of_distance(&places, footprint),
            View::Occlusion => self.occlusion(&places, frame.ambient_occlusion.0, frame.ambient_occlusion.1).into_iter().map(|open| [open; 3]).collect(),
            View::Shadow => self.lights_arriving(frame, shading, &places, footprint),
            View::Depth => {
                met.iter().map(|(_, _, h)| shade::depth_color(h.t, frame.max_distance)).collect()
            }
        };
        for (&(i, ..), color) in met.iter().zip(found) {
            if let Some(slot) = colors.get_mut(i) {
                *slot = color;
            }
        }
        if let Some((plane, Opened { faces, .. })) = &opened {
            for ((i, seen), color) in faces.iter().zip(self.cut_faces(plane, shading, view, faces)) {
                if let (Some(slot), Some(hit)) = (colors.get_mut(*i), hits.get_mut(*i)) {
                    *slot = color;
                    *hit = Hit { t: seen.t, hit: true, steps: 1 };
                }
            }
        }
        let depth = |hit: &Hit| if hit.hit { hit.t as f32 } else { -1.0 };
        let pixel = |(c, hit): (&Vec3, &Hit)| {
            let [r, g, b] = c.map(|c| c as f32);
            [r, g, b, depth(hit)]
        };
        colors.iter().zip(&hits).map(pixel).collect()
    }

    /// The surface's normals; a gradient that vanishes answers with the way back of the direction from which its place is looked at.
    fn normals(&self, points: &[Vec3], direction: impl Fn(usize) -> Vec3) -> Vec<Vec3> {
        let normal = |(i, gradient): (usize, Vec3)| {
            let usable = Some(gradient).filter(|g| length(*g) > 1e-12);
            usable.and_then(unit).unwrap_or_else(|| scale(direction(i), -1.0))
        };
        self.gradients(points).into_iter().enumerate().map(normal).collect()
    }

    /// Where rays met the surface.
    fn places(&self, met: &[(usize, &Ray, &Hit)]) -> Vec<Seen> {
        let points: Vec<Vec3> = met.iter().map(|(_, ray, hit)| ray.at(hit.t)).collect();
        let normals = self.normals(&points, |i| met.get(i).map_or([0.0; 3], |(_, ray, _)| ray.direction));
        let seen = |(((_, ray, hit), point), normal): ((&(usize, &Ray, &Hit), &Vec3), &Vec3)| {
            Seen { point: *point, normal: *normal, direction: ray.direction, t: hit.t }
        };
        met.iter().zip(&points).zip(&normals).map(seen).collect()
    }

    /// What rays see of a surface, with their numbers.
    pub fn seen(&self, rays: &[Ray], footprint: f64, extent: f64) -> Vec<(usize, Seen)> {
        let hits = self.trace(rays, footprint, extent);
        let met = numbered(rays, &hits);
        met.iter().map(|(i, ..)| *i).zip(self.places(&met)).collect()
    }
}

