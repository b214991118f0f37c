//! What light does at a surface, and the film that it falls on.
//!
//! The constants and formulas are those of `shading/*.wgsl`: what changes here changes there. All colours are linear
//! radiance: [`super::film`] makes a screen's colour of it.
//!
//! The model: Cook and Torrance's microfacets with the distribution GGX and Smith's shadowing in the form that correlates both
//! sides (Walter et al., "Microfacet Models for Refraction through Rough Surfaces", 2007; Heitz, "Understanding the Masking-Shadowing
//! Function", 2014) and Schlick's Fresnel term (1994), over Lambert's diffuse term; the fill light is a two-coloured sky above dark
//! ground; the film is a tone curve ([`super::tone`]).

use super::area::Part;
use crate::vector::{Vec3, add, cross, dot, length, mix, mul, scale, smooth, sub, unit};
use crate::blocks::Shadow;
use crate::camera::{Basis, Camera};
use crate::frame::{GROUND, MAX_LIGHTS, PLAIN_SKY, Fog, Frame, Light, LightKind, Sky, default_light};
use crate::images::Cube;
use std::borrow::Cow;
use std::f64::consts::PI;
use std::sync::Arc;

/// The share of the sky's light that a matte surface gets: less than all of it, so that lights model the shapes.
const FILL: f64 = 0.48;

/// What a surface is like at a point, as the scene's materials say.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SurfaceValues {
    /// Linear colour.
    pub color: Vec3,
    /// Light of its own, linear.
    pub emission: Vec3,
    /// 0 mirror to 1 matte.
    pub roughness: f64,
    /// 0 to 1.
    pub metallic: f64,
    /// 0 to 1.
    pub reflectivity: f64,
    /// How much light goes through, 0 to 1.
    pub transmission: f64,
    /// The index of refraction of what is under it; at least 1 where light goes through.
    pub ior: f64,
}

/// A place on a surface that is seen.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seen {
    /// The place, seen from the scene's origin.
    pub point: Vec3,
    /// The surface's normal there; length one.
    pub normal: Vec3,
    /// From the eye to the place; length one.
    pub direction: Vec3,
    /// How far that is.
    pub t: f64,
}

/// A light as the shading wants it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lamp {
    /// The direction toward the light, of length one; or where it is.
    pub vector: Vec3,
    /// Whether it is a position.
    pub position: bool,
    /// Linear colour times intensity.
    pub radiance: Vec3,
    /// Below 0: throws no shadow; 0: a hard one; above: a soft one, sharper the larger it is.
    pub softness: f64,
    /// Whether that is so at a distance of one, and farther away sharper: a lamp of one over this radius.
    pub is_sized: bool,
}

impl Lamp {
    /// How soft its shadow is where it is so far away.
    pub fn softness_from(&self, far: f64) -> f64 {
        if self.is_sized { self.softness * far } else { self.softness }
    }
}

/// A light as it meets a place: the direction toward it, how far it is, and how much arrives where nothing is in between.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arriving {
    /// Toward the light; length one.
    pub direction: Vec3,
    /// How far a shadow's ray goes.
    pub far: f64,
    /// Linear.
    pub radiance: Vec3,
}

/// The lights of a moment as the text has them, or the one of a scene without any.
pub fn lights(frame: &Frame) -> Cow<'_, [Light]> {
    if frame.lights.is_empty() && !frame.has_environment { Cow::Owned(vec![default_light()]) } else { Cow::Borrowed(&frame.lights) }
}

/// The lights of a moment, at most [`MAX_LIGHTS`]. A scene without any is lit by a warm one from the upper left, its shadow soft; one whose
/// sky is an image, by that alone.
pub fn lamps(frame: &Frame) -> Vec<Lamp> {
    lights(frame)
        .iter()
        .take(MAX_LIGHTS)
        .map(|light| {
            let softness = match light.shadow {
                _ if !frame.shadows => -1.0,
                Shadow::None => -1.0,
                Shadow::Hard | Shadow::Map => 0.0,
                Shadow::Soft(k) => k.max(0.0),
                // Half of a lamp of radius r is seen under the angle atan(r / d).
                Shadow::Sized(size) if size <= 0.0 => 0.0,
                Shadow::Sized(radius) if matches!(light.kind, LightKind::Position(_)) => 1.0 / radius,
                Shadow::Sized(angle) => 1.0 / angle.clamp(1e-6, 1.5).tan(),
            };
            let (vector, position) = match light.kind {
                LightKind::Direction(d) => {
                    (unit(d).map_or([0.0, 1.0, 0.0], |d| scale(d, -1.0)), false)
                }
                LightKind::Position(p) => (p, true),
            };
            let is_sized = position && softness > 0.0 && matches!(light.shadow, Shadow::Sized(_));
            Lamp { vector, position, radiance: light.radiance, softness, is_sized }
        })
        .collect()
}

/// What the ground, wherever it is, throws back of the light from above: a little of the horizon's, and of that of the lamps that are
/// infinitely far.
pub fn ground(frame: &Frame, lamps: &[Lamp]) -> Vec3 {
    let far = lamps.iter().filter(|lamp| !lamp.position);
    far.fold(scale(frame.sky.horizon, GROUND.0), |sum, lamp| {
        add(sum, scale(lamp.radiance, GROUND.1 * lamp.vector[1].max(0.0)))
    })
}

/// The same as an image, for a scene whose own can't be had.
pub fn plain_sky() -> Cube {
    Cube::of_directions(16, |d| gradient(&PLAIN_SKY, d))
}

/// The radiance of a sky of two colours: flat at the horizon, so that it is soft.
fn gradient(sky: &Sky, direction: Vec3) -> Vec3 {
    let s = direction[1].max(0.0);
    mix(sky.horizon, sky.zenith, 1.2 * s * s / (s * s + 0.2))
}

/// A surface's answer to light.
#[derive(Clone, Copy, Debug)]
struct Answer {
    /// The share that is scattered, by colour.
    diffuse: Vec3,
    /// The share that is mirrored head-on, by colour.
    mirrored: Vec3,
    roughness: f64,
}

impl Answer {
    fn of(surface: &SurfaceValues) -> Self {
        let metallic = surface.metallic.clamp(0.0, 1.0);
        let reflectivity = surface.reflectivity.clamp(0.0, 1.0);
        let color = surface.color.map(|c| c.clamp(0.0, 1.0));
        let plain = mix([0.04; 3], color, metallic);
        let polished = scale(mix([1.0; 3], color, metallic), reflectivity);
        Self {
            diffuse: scale(color, (1.0 - metallic) * (1.0 - 0.9 * reflectivity)),
            mirrored: [0, 1, 2].map(|i| component(plain, i).max(component(polished, i))),
            roughness: (surface.roughness * (1.0 - 0.6 * reflectivity)).clamp(0.06, 1.0),
        }
    }

    /// The share of a light's radiance from `l` that leaves toward `v`, the cosine included.
    fn reflect(&self, n: Vec3, v: Vec3, l: Vec3) -> Vec3 {
        let nl = dot(n, l).max(0.0);
        let nv = dot(n, v).max(1e-3);
        let sum = add(l, v);
        let h = scale(sum, 1.0 / length(sum).max(1e-6));
        let nh = dot(n, h).max(0.0);
        let vh = dot(v, h).clamp(0.0, 1.0);
        // The square of roughness is the width (Burley, "Physically Based Shading at Disney", 2012).
        let width = self.roughness * self.roughness;
        let width2 = width * width;
        // 1 - nh², without its cancellation.
        let across = cross(n, h);
        let below = nh * nh * width2 + dot(across, across);
        let distribution = width2 / (PI * below * below);
        let smith = nl * (nv * nv * (1.0 - width2) + width2).sqrt()
            + nv * (nl * nl * (1.0 - width2) + width2).sqrt();
        let visible = 0.5 / smith.max(1e-6);
        let grazing = (1.0 - vh).max(1e-6).powi(5);
        [0, 1, 2].map(|i| {
            let (mirrored, diffuse) = (component(self.mirrored, i), component(self.diffuse, i));
            let fresnel = mirrored + (1.0 - mirrored) * grazing;
            (fresnel * (distribution * visible) + (1.0 - fresnel) * diffuse / PI) * nl
        })
    }

    /// How much of the surroundings is mirrored, by angle and roughness: Karis, "Physically Based Shading on Mobile" (2014).
    fn mirror_share(&self, nv: f64) -> Vec3 {
        let r = self.roughness;
        let x = 1.0 - r;
        let y = 0.0425 - 0.0275 * r;
        let z = 1.04 - 0.572 * r;
        let w = 0.022 * r - 0.04;
        let a = (x * x).min((-9.28 * nv).exp2()) * x + y;
        self.mirrored.map(|m| m * (z - 1.04 * a) + (1.04 * a + w))
    }
}

fn component(v: Vec3, i: usize) -> f64 {
    v.get(i).copied().unwrap_or(0.0)
}

/// What the shading needs of a moment.
#[derive(Clone, Debug, PartialEq)]
pub struct Shading {
    /// The sky.
    pub sky: Sky,
    /// What stands for it, where it is an image.
    pub cube: Option<Arc<Cube>>,
    /// The lights.
    pub lamps: Vec<Lamp>,
    /// What the ground throws back of the light from above.
    pub ground: Vec3,
    /// What is looked at of the lights' discs.
    pub part: Part,
    /// What light is multiplied by.
    pub exposure: f64,
    /// What it comes through.
    pub fog: Option<Fog>,
    /// Beyond this distance from the eye nothing is drawn.
    pub max_distance: f64,
    /// Beyond this distance from the origin nothing is drawn.
    pub extent: f64,
    /// The value from one line of a slice to the next.
    pub spacing: f64,
}

/// What leaves a surface toward the eye.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Leaving {
    /// But for what it mirrors of its surroundings.
    pub light: Vec3,
    /// The share of its surroundings that it mirrors.
    pub share: Vec3,
    /// How much of the sky's light arrives.
    pub occlusion: f64,
    /// Where what it mirrors comes from.
    pub mirror: Vec3,
    /// As a mirror's.
    pub roughness: f64,
}

impl Shading {
    /// Of a moment. `cube` stands for the sky of a scene that names images.
    pub fn of(frame: &Frame, cube: Option<Arc<Cube>>) -> Self {
        let lamps = lamps(frame);
        Self {
            sky: frame.sky,
            cube: cube.filter(|_| frame.has_environment),
            ground: ground(frame, &lamps),
            lamps,
            part: Part::WHOLE,
            exposure: frame.exposure.exp2(),
            fog: frame.fog,
            max_distance: frame.max_distance,
            extent: frame.extent,
            spacing: 1.0,
        }
    }

    /// The sky's radiance in a direction.
    pub fn sky(&self, direction: Vec3) -> Vec3 {
        if let Some(cube) = &self.cube {
            return cube.sharp(direction);
        }
        gradient(&self.sky, direction)
    }

    /// The mean of sky and ground over the half of all directions about one, weighted toward it.
    fn around(&self, direction: Vec3) -> Vec3 {
        let above = smooth(-0.8, 0.8, direction[1]);
        let sky = mix(self.sky.horizon, self.sky.zenith, 0.25 + 0.5 * above);
        mix(self.ground, sky, above)
    }

    /// What a matte surface sees of the sky.
    fn matte(&self, normal: Vec3) -> Vec3 {
        match &self.cube {
            Some(cube) => cube.matte(normal),
            None => scale(self.around(normal), FILL),
        }
    }

    /// What a mirror of some roughness sees in a direction where it is known that nothing stands there.
    pub fn beyond(&self, direction: Vec3, roughness: f64) -> Vec3 {
        match &self.cube {
            Some(cube) => cube.glossy(direction, roughness),
            None => self.sky(direction),
        }
    }

    /// What a mirror of some roughness sees in a direction, where nothing is known of what stands there.
    pub fn mirror(&self, direction: Vec3, roughness: f64) -> Vec3 {
        if let Some(cube) = &self.cube {
            return cube.glossy(direction, roughness);
        }
        let width = 0.1 + 0.7 * roughness;
        let above = smooth(-width, 0.6 * width, direction[1]);
        let sharp = mix(self.ground, self.sky(direction), above);
        mix(sharp, self.around(direction), roughness)
    }

    /// A light as it meets a place; none where the surface is turned away from it.
    pub fn arriving(&self, lamp: &Lamp, point: Vec3, normal: Vec3) -> Option<Arriving> {
        let arriving = if lamp.position {
            let way = sub(lamp.vector, point);
            let far = length(way).max(1e-9);
            Arriving {
                direction: scale(way, 1.0 / far),
                far,
                radiance: scale(lamp.radiance, 1.0 / (far * far)),
            }
        } else {
            Arriving { direction: lamp.vector, far: 4.0 * self.extent, radiance: lamp.radiance }
        };
        (dot(normal, arriving.direction) > 0.0).then_some(arriving)
    }

    /// What leaves a surface toward the eye. `lit` says of each lamp how much of it arrives, 0 to 1; `occlusion` says so of the sky.
    pub fn leaving(&self, seen: &Seen, surface: &SurfaceValues, occlusion: f64, lit: &[f64]) -> Leaving {
        let mut answer = Answer::of(surface);
        answer.diffuse = scale(answer.diffuse, 1.0 - surface.transmission);
        let n = seen.normal;
        let v = scale(seen.direction, -1.0);
        let nv = dot(n, v).clamp(1e-3, 1.0);
        let share = answer.mirror_share(nv);
        let mirror = add(seen.direction, scale(n, -2.0 * dot(seen.direction, n)));
        let scattered = mul(sub([1.0; 3], share), mul(answer.diffuse, self.matte(n)));
        let mut light = add(surface.emission, scale(scattered, occlusion));
        for (lamp, &lit) in self.lamps.iter().zip(lit) {
            if let Some(arriving) = self.arriving(lamp, seen.point, n) {
                let share = answer.reflect(n, v, arriving.direction);
                light = add(light, scale(mul(arriving.radiance, share), lit));
            }
        }
        let share = match surface.transmission {
            through if through > 0.0 => mix(share, [fresnel(-dot(seen.direction, n), surface.ior); 3], through),
            _ => share,
        };
        Leaving { light, share, occlusion, mirror, roughness: answer.roughness }
    }

    /// How much of a surface is lost in the air: near the ends of the scene it goes over into the sky, so that an endless plane has no
    /// rim.
    pub fn lost(&self, seen: &Seen) -> f64 {
        let far = smooth(0.5, 1.0, seen.t / self.max_distance);
        let out = smooth(0.85, 1.0, length(seen.point) / self.extent);
        far.max(out)
    }

    /// Light from so far away as it arrives through the fog.
    pub fn fogged(&self, light: Vec3, way: f64) -> Vec3 {
        self.fog.map_or(light, |fog| mix(fog.color, light, fog.clear(way)))
    }

    /// The sky as it is seen where nothing else is.
    pub fn behind(&self, direction: Vec3) -> Vec3 {
        self.fogged(self.sky(direction), self.max_distance)
    }

    /// The light of a surface as the eye sees it through the air.
    pub fn haze(&self, light: Vec3, seen: &Seen) -> Vec3 {
        self.fogged(mix(light, self.sky(seen.direction), self.lost(seen)), seen.t)
    }

    /// Linear light as the film gets it.
    pub fn exposed(&self, light: Vec3) -> Vec3 {
        light.map(|c| c.max(0.0) * self.exposure)
    }
}

/// What a surface between two clear bodies mirrors: Fresnel's equations for light without polarisation. `index` is that of the body beyond over
/// that of the one before.
pub fn fresnel(cosine: f64, index: f64) -> f64 {
    let c = cosine.clamp(0.0, 1.0);
    let squared = 1.0 - (1.0 - c * c) / (index * index);
    if squared <= 0.0 {
        return 1.0;
    }
    let beyond = squared.sqrt();
    let across = (c - index * beyond) / (c + index * beyond);
    let along = (index * c - beyond) / (index * c + beyond);
    0.5 * (across * across + along * along)
}

/// How much of what a surface mirrors is followed: all of a polished one's, nothing of a rough one's or where too little arrives to be
/// seen. `share` is what arrives of it at the eye.
pub fn followed(roughness: f64, share: Vec3) -> f64 {
    let most = share.iter().fold(0.0, |most: f64, s| most.max(*s));
    (1.0 - smooth(0.25, 0.5, roughness)) * smooth(0.01, 0.03, most)
}

/// How far off the surface, along its normal, a ray starts that leaves it. `rounded` is what rounding in 32 bits grows with there, `t` is how far it is
/// from the eye, `footprint` the width of a pixel at distance one.
pub fn shadow_offset(rounded: f64, t: f64, footprint: f64) -> f64 {
    (0.5 * footprint * t).max(12e-6 * rounded)
}

/// The colour of a number of steps, 64 and more the brightest: the colours "inferno" of matplotlib (van der Walt and Smith), as the
/// polynomial by Zucker (<https://www.shadertoy.com/view/WlfXRN>).
pub fn steps_color(steps: u32) -> Vec3 {
    inferno(f64::from(steps) / 64.0)
}

/// Of these numbers of operations the colours are the darkest and the brightest; between them they go by the logarithm.
pub const OPERATIONS: (f64, f64) = (64.0, 1_048_576.0);

/// The colour of a number of operations.
pub fn operations_color(count: f64) -> Vec3 {
    let (least, most) = OPERATIONS;
    inferno((count.max(least) / least).log2() / (most / least).log2())
}

fn inferno(share: f64) -> Vec3 {
    const INFERNO: [Vec3; 7] = [
        [0.0002189403691192265, 0.001651004631001012, -0.01948089843709184],
        [0.1065134194856116, 0.5639564367884091, 3.932712388889277],
        [11.60249308247187, -3.972853965665698, -15.9423941062914],
        [-41.70399613139459, 17.43639888205313, 44.35414519872813],
        [77.162935699427, -33.40235894210092, -81.80730925738993],
        [-71.31942824499214, 32.62606426397723, 73.20951985803202],
        [25.13112622477341, -12.24266895238567, -23.07032500287172],
    ];
    let s = share.clamp(0.0, 1.0);
    let sum = INFERNO.iter().rev().fold([0.0; 3], |sum, &c| add(c, scale(sum, s)));
    sum.map(|c| c.clamp(0.0, 1.0))
}

/// The nearest of 1, 2 and 5 times a power of ten that is not below a length.
pub fn isolines_spacing(least: f64) -> f64 {
    let least = least.clamp(1e-12, 1e12);
    let power = 10f64.powf(least.log10().floor());
    [1.0, 2.0, 5.0, 10.0].map(|times| times * power).into_iter().find(|spacing| *spacing >= least * (1.0 - 1e-9)).unwrap_or(least)
}

/// The colour of a field's value in a plane: blue outside, orange and hatched inside, darker the farther from the surface, which is a white line; lines
/// where the value is a multiple of `spacing`. `slope`: how much the value changes over a pixel; `across`: the sum of the place's two
/// coordinates in the plane, along which the hatching runs.
pub fn isolines_color(value: f64, slope: f64, spacing: f64, across: f64) -> Vec3 {
    const OUTSIDE: Vec3 = [0.42, 0.62, 0.82];
    const INSIDE: Vec3 = [0.95, 0.62, 0.28];
    let slope = slope.max(1e-6 * spacing);
    let ground = if value < 0.0 { INSIDE } else { OUTSIDE };
    let deep = 1.0 / (1.0 + 0.12 * value.abs() / spacing);
    let stripe = 5.0 * across / spacing;
    let hatched = if value < 0.0 && stripe - stripe.floor() < 0.3 { 0.78 } else { 1.0 };
    let nearest = value - spacing * (value / spacing).round_ties_even();
    // Where lines are closer than they can be told apart, there is none.
    let clear = (0.25 * spacing / slope - 0.5).clamp(0.0, 1.0);
    let line = clear * (1.2 - nearest.abs() / slope).clamp(0.0, 1.0);
    let surface = (1.8 - value.abs() / slope).clamp(0.0, 1.0);
    let color = scale(ground, deep * hatched * (1.0 - 0.45 * line));
    mix(color, [1.0; 3], surface)
}

/// What views show where there is nothing that show no light.
pub const NOTHING: Vec3 = [0.12; 3];
/// Where no light shines on the front of a surface.
pub const UNLIT: Vec3 = [0.16, 0.2, 0.3];

/// The colour of a gradient's length: grey at 1, red above, blue below, the brightest at four times and a quarter.
pub fn gradient_color(steep: f64) -> Vec3 {
    let steep = (0.5 * steep.max(1e-6).log2()).clamp(-1.0, 1.0);
    mix([0.78; 3], if steep > 0.0 { [0.95, 0.2, 0.12] } else { [0.15, 0.35, 0.95] }, steep.abs())
}

/// The colour of the part of the distance that a ray may go: grey where it is all of it, darker and redder the less, black at an eighth.
pub fn factor_color(part: f64) -> Vec3 {
    let part = (1.0 + part.max(1e-6).log2() / 3.0).clamp(0.0, 1.0);
    [part.sqrt(), part, part * part].map(|c| 0.85 * c)
}

/// The value from one line of a slice to the next, seen by a camera: about sixteen fill the picture where it looks at.
pub fn slice_spacing(camera: &Camera) -> f64 {
    isolines_spacing(2.0 * Basis::of(camera).tan_half_fov * length(sub(camera.eye, camera.target)) / 16.0)
}

/// The grey of a distance: white at the eye, falling with the logarithm, black at the far end.
pub fn depth_color(t: f64, max_distance: f64) -> Vec3 {
    let share = (t / max_distance).clamp(0.0, 1.0);
    [1.0 - (1.0 + 63.0 * share).log2() / 6.0; 3]
}

/// The colour of a normal, each component from -1..1 to 0..1.
pub fn normal_color(normal: Vec3) -> Vec3 {
    normal.map(|c| 0.5 + 0.5 * c)
}
