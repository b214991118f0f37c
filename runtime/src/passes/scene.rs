//! The pass that draws the field: one triangle over the screen. Its text is a list of sections, of which only those stand in the
//! module that the scene and the view need; its uniforms are filled from a [`Frame`].

use super::{cones, layers, section};
use crate::images::MOST_TEXTURES;
use crate::sheets::LINEAR;
use bytemuck::{Pod, Zeroable};
use std::borrow::Cow;
use surefoot_compiler::camera::Basis;
use surefoot_compiler::compiled::{Camera, Compiled, Export, Frame, Rounding, Shadow, Tone};
use surefoot_compiler::emit::counted::counted;
use surefoot_compiler::frame::{MAX_LIGHTS, NEAR};
use surefoot_compiler::reference::{area, shade};
use surefoot_compiler::section::Cut;
use surefoot_compiler::shading::{self, Parts, Shading};
use surefoot_compiler::vector::{scale, sub};

pub use surefoot_compiler::reference::View as ViewMode;

/// Looks of fewer operations of the bound cost no more than to read where a ray begins.
const WORTH_CONES: usize = 8;

/// What of the pass is compiled. Each combination is a pipeline of its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Features {
    /// What the picture shows.
    pub view: ViewMode,
    /// Whether a light may throw a shadow.
    pub shadows: bool,
    /// Whether the sky's light is kept from corners.
    pub occlusion: bool,
    /// Whether images stand for the sky.
    pub environment: bool,
    /// How often a mirrored ray is followed through the field, at most; 0: never.
    pub reflections: u32,
    /// Whether the scene itself, drawn into a cubemap, stands for what surfaces mirror: pixels of a side of its faces.
    pub capture: Option<u32>,
    /// Whether the pass draws that cubemap and no picture.
    pub captures: bool,
    /// Textures that lie on the surface.
    pub textures: u32,
    /// Whether balls are drawn.
    pub balls: bool,
    /// Whether meshes are drawn.
    pub meshes: bool,
    /// Whether the depth of the meshes is drawn before the field, so that rays end at them.
    pub meshes_first: bool,
    /// Whether a light sees the field in a shadow map.
    pub field_maps: bool,
    /// How many lights there are.
    pub lights: u32,
    /// How light becomes a screen's colour.
    pub tone: Tone,
    /// Whether there is fog.
    pub fog: bool,
    /// Whether light goes through something.
    pub glass: bool,
    /// Whether light is scattered.
    pub bloom: bool,
    /// Whether a camera has a lens or rays that go side by side.
    pub optics: bool,
    /// Whether a lamp may stand in a solid that emits light.
    pub emitters: bool,
    /// How a plane cuts the picture open, where one does.
    pub section: Option<Cut>,
    /// Whether cones say where rays begin.
    pub cones: bool,
    /// Whether the depth is written though nothing is rasterised: what is drawn beside it has depth.
    pub deep: bool,
}

impl Features {
    /// What a scene needs for any value of its parameters.
    pub fn of(compiled: &Compiled, view: ViewMode) -> Self {
        let constant = |node| compiled.graph.as_constant(node);
        let blocks = &compiled.blocks;
        let shaded = view == ViewMode::Shaded;
        let lit = shaded || view == ViewMode::Shadow;
        // Not where something is shown that the field alone has.
        let solids = matches!(view, ViewMode::Shaded | ViewMode::Normals | ViewMode::Depth);
        let off = blocks.shadows.and_then(constant) == Some(0.0);
        let shading = Shading::of(&compiled.graph, blocks, &compiled.functions);
        Self {
            view,
            shadows: lit && shading.shadows,
            emitters: lit && shading.emitters,
            occlusion: (shaded || view == ViewMode::Occlusion) && shading.occlusion,
            environment: shaded && blocks.environment.is_some(),
            textures: if shaded { compiled.functions.textures().len().min(MOST_TEXTURES) as u32 } else { 0 },
            reflections: if shaded { shading.reflections } else { 0 },
            glass: shaded && shading.glass,
            capture: blocks.capture.filter(|_| shaded).map(|capture| capture.size),
            captures: false,
            balls: compiled.has_balls() && solids,
            meshes: compiled.has_meshes() && solids,
            meshes_first: compiled.has_meshes() && solids,
            lights: shading.lights,
            tone: if shaded { shading.tone } else { Tone::default() },
            fog: shaded && shading.fog,
            bloom: blocks.bloom.is_some_and(|share| shaded && constant(share) != Some(0.0)),
            optics: shading.optics,
            section: None,
            // Looks are what some views show.
            cones: !matches!(view, ViewMode::Steps | ViewMode::Operations | ViewMode::Slice(_)) && compiled.module.operations.1 >= WORTH_CONES,
            deep: false,
            field_maps: shaded && !off && blocks.lights.iter().any(|l| l.shadow.0 == Shadow::Map),
        }
    }

    /// The same of a picture that is cut open. A slice is a plane of its own, and nothing is before it.
    pub fn with_section(self, section: Option<Cut>) -> Self {
        Self { section: section.filter(|_| !matches!(self.view, ViewMode::Slice(_))), ..self }
    }

    /// Which parts of the shading it has.
    fn parts(&self) -> Shading {
        let Self { shadows, emitters, occlusion, reflections, lights, tone, fog, glass, optics, captures, .. } = *self;
        Shading { shadows, emitters, occlusion, reflections, lights, tone, fog, glass, optics: optics && !captures }
    }

    /// Of what draws the cubemap of a scene that has these: the same light, seen from one place. What is mirrored there is the field and
    /// the sky.
    pub(super) fn of_capture(self) -> Self {
        Self { capture: None, captures: true, meshes_first: false, section: None, cones: false, deep: false, ..self }
    }

    /// Whether shadows are looked up in maps.
    pub fn maps(&self) -> bool {
        self.shadows && (self.balls || self.meshes || self.field_maps)
    }

    /// Whether the depth is written too: something is rasterised, in it or beside it.
    pub fn depth(&self) -> bool {
        self.balls || self.meshes || self.deep
    }

    /// Whether the field's pass reads of passes before it.
    pub(super) fn reads_before(&self) -> bool {
        self.meshes_first || self.cones
    }

    /// The functions of the module that the pass calls.
    pub fn exports(&self) -> Vec<Export> {
        let mut exports = vec![Export::Trace];
        if self.section.is_some() || !matches!(self.view, ViewMode::Steps | ViewMode::Operations | ViewMode::Depth) {
            exports.push(Export::Gradient);
        }
        if self.view == ViewMode::Factor {
            exports.extend([Export::Bound, Export::Distance]);
        }
        if matches!(self.view, ViewMode::Shaded | ViewMode::Shadow) {
            exports.push(Export::Surface);
        }
        if self.shadows {
            exports.push(Export::Shadow);
        }
        if self.occlusion {
            exports.push(Export::Occlusion);
        }
        if self.capture.is_some() || self.glass || self.emitters || self.cones {
            exports.push(Export::Bound);
        }
        exports
    }

    /// What every pass that shades has: the view, and light where it is shown.
    pub(super) fn shading(&self, compiled: &Compiled) -> Vec<Cow<'static, str>> {
        let shading = self.parts();
        let mut sections: Vec<Cow<'static, str>> = vec![shading::BASE.into(), include_str!("scene/bindings.wgsl").into(), shading.eye().into()];
        if self.section.is_some() {
            sections.extend(section::sections(self.view).map(Cow::Borrowed));
        }
        if !matches!(self.view, ViewMode::Shaded | ViewMode::Shadow) {
            sections.extend([shading::DITHER, shading::TARGET].map(Cow::Borrowed));
            if self.view == ViewMode::Occlusion {
                sections.push(shading.occlusion().into());
            }
            return sections;
        }
        sections.extend(shading.sections(Parts {
            film: match self.captures {
                true => vec![include_str!("capture/film.wgsl")],
                false if self.bloom => vec![shading::LIGHT_FILM],
                false => vec![shading.tone(), shading::FILM, shading::DITHER, shading::TARGET],
            },
            sky: if self.environment { include_str!("scene/sky_images.wgsl") } else { shading::SKY },
            mirror: if self.capture.is_some() { include_str!("capture/read.wgsl") } else { shading::MIRROR },
            lit: self.maps().then(|| vec![include_str!("shadows/base.wgsl"), include_str!("shadows/box.wgsl"), include_str!("shadows/lit.wgsl")]),
            met: layers::text(&compiled.functions, self.textures),
        }));
        sections
    }

    /// The text of what a camera's rays are.
    pub(super) fn eye(&self) -> &'static str {
        self.parts().eye()
    }

    /// The text of the tone curve.
    pub(crate) fn tone_text(&self) -> &'static str {
        self.parts().tone()
    }

    /// Values of the `override` constants of what every pass that shades has, on targets of a format.
    pub(super) fn constants(&self, format: wgpu::TextureFormat) -> Vec<(&'static str, f64)> {
        let linear = format.is_srgb() || format == LINEAR;
        let eight_bits = matches!(format.remove_srgb_suffix(), wgpu::TextureFormat::Rgba8Unorm | wgpu::TextureFormat::Bgra8Unorm);
        // Of what is no light the levels are numbers to read.
        let level = if eight_bits && self.view == ViewMode::Shaded { 1.0 / 255.0 } else { 0.0 };
        let axis = if let ViewMode::Slice(axis) = self.view { Some(("scene_axis", f64::from(axis.min(2)))) } else { None };
        let all = [
            ("scene_lights", self.lights.into()),
            ("scene_bounces", self.reflections.into()),
            ("scene_linear", f64::from(u8::from(linear))),
            ("scene_step", level),
        ];
        let cut = self.section.map(section::constants);
        all.into_iter().chain(axis).chain(cut.into_iter().flatten()).collect()
    }

    /// The scene's module as this pass has it: one that counts its operations, where the view shows them.
    pub fn module<'m>(&self, compiled: &'m Compiled) -> Result<Cow<'m, str>, String> {
        match self.view {
            ViewMode::Operations => counted(compiled.module.code()).map(Cow::Owned),
            _ => Ok(compiled.module.code().into()),
        }
    }

    /// The pass's text, to stand after the scene's module. Entry points: `vertex`, `fragment`; uniforms: group 1, binding 0.
    pub fn wgsl(&self, compiled: &Compiled) -> String {
        let mut sections = self.shading(compiled);
        let mut push = |text: Cow<'static, str>| sections.push(text);
        push(shading::TRIANGLE.into());
        if matches!(self.view, ViewMode::Steps | ViewMode::Operations) {
            push(include_str!("scene/ramp.wgsl").into());
        }
        let view = match self.view {
            ViewMode::Shaded if self.captures => include_str!("capture/view.wgsl"),
            ViewMode::Shaded => shading::VIEW,
            ViewMode::Normals => include_str!("scene/view_normals.wgsl"),
            ViewMode::Steps => include_str!("scene/view_steps.wgsl"),
            ViewMode::Operations => include_str!("scene/view_operations.wgsl"),
            ViewMode::Depth => include_str!("scene/view_depth.wgsl"),
            ViewMode::Gradient => include_str!("scene/view_gradient.wgsl"),
            ViewMode::Factor => include_str!("scene/view_factor.wgsl"),
            ViewMode::Occlusion => include_str!("scene/view_occlusion.wgsl"),
            ViewMode::Shadow => include_str!("scene/view_shadow.wgsl"),
            ViewMode::Slice(_) => include_str!("scene/view_slice.wgsl"),
        };
        push(match self.section {
            Some(_) => section::pixel(self.view, view).into(),
            None => view.into(),
        });
        push(match self.cones {
            true => cones::begin().into(),
            false => include_str!("scene/begin.wgsl").into(),
        });
        push(Cow::Borrowed(match self.depth() {
            true if self.meshes_first => include_str!("scene/color_behind.wgsl"),
            true => include_str!("scene/color_and_depth.wgsl"),
            false => include_str!("scene/color.wgsl"),
        }));
        sections.join("\n")
    }
}

/// Declares a struct of plain data and the list of its fields, which a test compares with what the shader's text says.
macro_rules! uniforms {
    ($(#[$doc:meta])* $visibility:vis struct $name:ident { $($field:ident: $ty:ty,)* }) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
        #[repr(C)]
        $visibility struct $name { $($field: $ty,)* }

        impl $name {
            /// Name, offset and size in bytes of each field.
            pub const FIELDS: &[(&str, usize, usize)] =
                &[$((stringify!($field), std::mem::offset_of!($name, $field), size_of::<$ty>()),)*];
        }
    };
}

uniforms! {
    /// A light, as `compiler/src/shading/base.wgsl` declares it.
    pub struct SceneLight {
        vector: [f32; 3],
        position: u32,
        radiance: [f32; 3],
        softness: f32,
    }
}

uniforms! {
    /// Uniforms of the pass, as `compiler/src/shading/base.wgsl` declares them.
    pub struct SceneUniforms {
        eye: [f32; 3],
        tan_half_fov: f32,
        right: [f32; 3],
        aspect: f32,
        up: [f32; 3],
        footprint: f32,
        forward: [f32; 3],
        exposure: f32,
        center: [f32; 3],
        extent: f32,
        zenith: [f32; 3],
        max_distance: f32,
        horizon: [f32; 3],
        reflections: u32,
        ground: [f32; 3],
        near: f32,
        corner: [f32; 2],
        size: [f32; 2],
        rounding: [f32; 3],
        away: f32,
        fog: [f32; 3],
        density: f32,
        lean: [f32; 2],
        unit: f32,
        slice: f32,
        part: [f32; 3],
        spacing: f32,
        lights: [SceneLight; MAX_LIGHTS],
    }
}

impl SceneUniforms {
    /// The same for a module that rounds so.
    pub fn rounded(self, rounding: Rounding) -> Self {
        Self { rounding: rounding.reads_scene.map(|read| f32::from(u8::from(read))), unit: rounding.unit as f32, ..self }
    }

    /// The same for the picture of a film with a number ([`area::Part`]).
    pub fn of_sample(self, sample: u32) -> Self {
        let area::Part { place: [x, y], narrower } = area::Part::of(sample);
        Self { part: [x, y, narrower].map(|c| c as f32), ..self }
    }

    /// The same of a picture that a plane cuts open, which is at this place along what it is square to.
    pub fn cut_at(self, place: f64) -> Self {
        Self { slice: place as f32, ..self }
    }

    /// Through a camera. `origin` is the scene's point at which the module's `p` is zero; `size` is that of the whole picture and `corner` its upper left
    /// corner on the target, both in pixels.
    pub fn new(
        frame: &Frame,
        camera: &Camera,
        origin: [f64; 3],
        size: [f32; 2],
        corner: [f32; 2],
    ) -> Self {
        let basis = Basis::of(camera);
        let spacing = shade::slice_spacing(camera) as f32;
        Self { corner, spacing, ..Self::seen(frame, camera.eye, &basis, origin, size) }
    }

    /// From a place along axes, on a target of this size.
    pub(super) fn seen(frame: &Frame, eye: [f64; 3], basis: &Basis, origin: [f64; 3], size: [f32; 2]) -> Self {
        let narrow = |v: [f64; 3]| v.map(|c| c as f32);
        let mut lights = [SceneLight::zeroed(); MAX_LIGHTS];
        let lamps = shade::lamps(frame);
        let fog = frame.fog.unwrap_or_default();
        for (light, lamp) in lights.iter_mut().zip(&lamps) {
            let vector = if lamp.position { sub(lamp.vector, origin) } else { lamp.vector };
            *light = SceneLight {
                vector: narrow(vector),
                position: u32::from(lamp.position) + u32::from(lamp.is_sized),
                radiance: narrow(lamp.radiance),
                softness: lamp.softness as f32,
            };
        }
        Self {
            eye: narrow(sub(eye, origin)),
            tan_half_fov: basis.tan_half_fov as f32,
            right: narrow(basis.right),
            aspect: size[0] / size[1].max(1.0),
            up: narrow(basis.up),
            footprint: (2.0 * basis.tan_half_fov) as f32 / size[1].max(1.0),
            forward: narrow(basis.forward),
            exposure: frame.exposure.exp2() as f32,
            center: narrow(scale(origin, -1.0)),
            extent: frame.extent as f32,
            zenith: narrow(frame.sky.zenith),
            max_distance: frame.max_distance as f32,
            horizon: narrow(frame.sky.horizon),
            reflections: frame.reflections,
            ground: narrow(shade::ground(frame, &lamps)),
            near: NEAR as f32,
            corner: [0.0; 2],
            size,
            rounding: [1.0; 3],
            away: basis.parallel.unwrap_or(0.0) as f32,
            fog: narrow(fog.color),
            density: fog.density as f32,
            lean: basis.lean.map(|c| c as f32),
            unit: 1.0,
            slice: frame.slice as f32,
            part: [0.0, 0.0, 1.0],
            spacing: 1.0,
            lights,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use wgpu::naga;

    /// The fields of a struct in the shader's text: name, offset, size in bytes.
    fn declared(module: &naga::Module, name: &str) -> Vec<(String, usize, usize)> {
        let gctx = module.to_ctx();
        let found = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some(name));
        let Some((_, naga::Type { inner: naga::TypeInner::Struct { members, .. }, .. })) = found
        else {
            panic!("there is no struct {name}");
        };
        let size = |m: &naga::StructMember| module.types[m.ty].inner.size(gctx) as usize;
        members.iter().map(|m| (m.name.clone().unwrap(), m.offset as usize, size(m))).collect()
    }

    #[test]
    fn host_and_shader_agree_on_every_field() {
        let stub = "fn sf_gradient(p: vec3f) -> vec4f { return vec4f(p, 0.0); }";
        let text = format!("{stub}\n{}", shading::BASE);
        let module = naga::front::wgsl::parse_str(&text).unwrap();
        let host = |fields: &[(&str, usize, usize)]| -> Vec<(String, usize, usize)> {
            fields.iter().map(|&(name, at, size)| (name.to_owned(), at, size)).collect()
        };
        assert_eq!(declared(&module, "SceneLight"), host(SceneLight::FIELDS));
        assert_eq!(declared(&module, "SceneUniforms"), host(SceneUniforms::FIELDS));
    }
}
