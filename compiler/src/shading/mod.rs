//! How light meets a scene, in WGSL: which parts of the shading a scene needs, and their texts. The runtime's passes and the modules that draw by themselves
//! share it. Its twin in 64 bits is `reference`.

use crate::blocks::{SceneBlocks, Shadow, Tone};
use crate::frame::{MAX_BOUNCES, MAX_LIGHTS};
use crate::functions::Functions;
use crate::graph::Graph;
use std::borrow::Cow;

/// What all that shades reads; each pass declares `scene` itself.
pub const BASE: &str = include_str!("base.wgsl");
/// One triangle over the screen: the entry point `vertex`.
pub const TRIANGLE: &str = include_str!("triangle.wgsl");
/// Light as a screen's colour, after a tone curve: [`Shading::tone`].
pub const FILM: &str = include_str!("film.wgsl");
/// Light as it is.
pub const LIGHT_FILM: &str = include_str!("light_film.wgsl");
/// What a target holds of a screen's colour; reads the constants `scene_linear` and `scene_step`.
pub const TARGET: &str = include_str!("target.wgsl");
/// What a screen's eight bits can't hold, spread over pixels.
pub const DITHER: &str = include_str!("dither.wgsl");
/// The sky as two colours.
pub const SKY: &str = include_str!("sky_gradient.wgsl");
/// The sky is all that surfaces mirror without a ray.
pub const MIRROR: &str = include_str!("mirror.wgsl");
/// The scene in its light: the function `scene_pixel`.
pub const VIEW: &str = include_str!("view_shaded.wgsl");
/// How a place answers light: the struct `SceneMet`.
pub const MET: &str = include_str!("met.wgsl");
/// The function `scene_met` where no image lies on the surface.
pub const MET_PLAIN: &str = include_str!("met_plain.wgsl");
/// The entry points and what fills `scene`, of a module that draws by itself.
pub const DRAW: &str = include_str!("draw.wgsl");
/// How much of a light is seen past the field, where nothing else throws shadows.
const SHADOW: &str = include_str!("shadow.wgsl");
const LIGHT: &str = include_str!("light.wgsl");

/// Surfaces that a ray meets in a scene with glass that does not say it.
const THROUGH_GLASS: u32 = 6;

/// Which parts of the shading a scene needs, for any value of its parameters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shading {
    /// Whether a light may throw a shadow.
    pub shadows: bool,
    /// Whether a lamp may stand in a solid that emits light.
    pub emitters: bool,
    /// Whether the sky's light is kept from corners.
    pub occlusion: bool,
    /// How often a mirrored ray is followed through the field, at most; 0: never.
    pub reflections: u32,
    /// How many lights there are.
    pub lights: u32,
    /// How light becomes a screen's colour.
    pub tone: Tone,
    /// Whether there is fog.
    pub fog: bool,
    /// Whether light goes through something.
    pub glass: bool,
    /// Whether a camera has a lens or rays that go side by side.
    pub optics: bool,
}

/// What stands in the shading's text for what draws it.
pub struct Parts {
    /// How light becomes what a target holds.
    pub film: Vec<&'static str>,
    /// The text of the sky: [`SKY`] or another.
    pub sky: &'static str,
    /// What surfaces mirror without a ray: [`MIRROR`] or another.
    pub mirror: &'static str,
    /// The function `scene_lit` where more than the field throws shadows.
    pub lit: Option<Vec<&'static str>>,
    /// What is there on a surface: [`MET`] and [`MET_PLAIN`], or another `scene_met`.
    pub met: Vec<Cow<'static, str>>,
}

/// How often a ray is followed in a scene that does not say it: not at all, or where there is glass as often as it takes to look through some.
pub fn usual_reflections(functions: &Functions) -> u32 {
    if functions.surface.glass.is_some() { THROUGH_GLASS } else { 0 }
}

impl Shading {
    /// What a scene needs.
    pub fn of(graph: &Graph, blocks: &SceneBlocks, functions: &Functions) -> Self {
        let constant = |node| graph.as_constant(node);
        let off = blocks.shadows.and_then(constant) == Some(0.0);
        // A scene without lights is lit by one that throws a shadow, or by its images.
        let unlit = blocks.lights.is_empty() && blocks.environment.is_none();
        let thrown = unlit || blocks.lights.iter().any(|l| l.shadow.0 != Shadow::None);
        let nothing = |(reach, strength)| constant(reach).is_some_and(|r| r <= 0.0) || constant(strength).is_some_and(|s| s <= 0.0);
        let shadows = thrown && !off;
        let emits = functions.surface.emission.iter().any(|&c| constant(c) != Some(0.0));
        Self {
            shadows,
            emitters: shadows && blocks.has_lamps() && emits,
            occlusion: !blocks.ambient_occlusion.is_some_and(nothing),
            reflections: blocks.reflections.map_or(usual_reflections(functions), |n| constant(n).map_or(MAX_BOUNCES, |n| n as u32)),
            lights: if unlit { 1 } else { blocks.lights.len().min(MAX_LIGHTS) as u32 },
            tone: blocks.tone,
            fog: blocks.fog.is_some_and(|(_, density)| constant(density) != Some(0.0)),
            glass: functions.surface.glass.is_some(),
            optics: blocks.parallel || blocks.cameras.iter().any(|camera| camera.orthographic || camera.lens.is_some_and(|lens| constant(lens) != Some(0.0))),
        }
    }

    /// The text of what a camera's rays are.
    pub fn eye(&self) -> &'static str {
        if self.optics { include_str!("camera.wgsl") } else { include_str!("pinhole.wgsl") }
    }

    /// The text of how much of the sky's light arrives.
    pub fn occlusion(&self) -> &'static str {
        if self.occlusion { include_str!("occlusion.wgsl") } else { include_str!("no_occlusion.wgsl") }
    }

    /// The text of the tone curve.
    pub fn tone(&self) -> &'static str {
        match self.tone {
            Tone::Aces => include_str!("tone_aces.wgsl"),
            Tone::Agx => include_str!("tone_agx.wgsl"),
            Tone::Neutral => include_str!("tone_neutral.wgsl"),
            Tone::None => include_str!("tone_none.wgsl"),
        }
    }

    /// The sections of the shading, to stand after [`BASE`] and [`Shading::eye`], in an order that reads well.
    pub fn sections(&self, parts: Parts) -> Vec<Cow<'static, str>> {
        let mut sections = parts.film;
        sections.extend([parts.sky, parts.mirror, LIGHT]);
        sections.push(if self.fog { include_str!("fog.wgsl") } else { include_str!("no_fog.wgsl") });
        sections.push(match self.reflections {
            _ if self.glass => include_str!("glass.wgsl"),
            0 => include_str!("no_reflections.wgsl"),
            _ => include_str!("reflections.wgsl"),
        });
        if self.shadows {
            sections.push(if self.emitters { include_str!("emitter.wgsl") } else { include_str!("no_emitter.wgsl") });
            sections.push(include_str!("seen.wgsl"));
            sections.extend(parts.lit.unwrap_or(vec![SHADOW]));
        } else {
            sections.push(include_str!("no_shadow.wgsl"));
        }
        sections.push(self.occlusion());
        let mut sections: Vec<Cow<'static, str>> = sections.into_iter().map(Cow::Borrowed).chain(parts.met).collect();
        if self.glass {
            // What throws shadows may be glass.
            let through = LIGHT.replace("scene_lit(", "scene_lit_through(");
            sections.iter_mut().filter(|text| **text == LIGHT).for_each(|text| *text = through.clone().into());
        }
        sections
    }
}
