//! One frame is a list of passes. A pass that a scene does not need is not in it: nothing of it is compiled and it has no buffers.

use crate::gpu::{DEPTH, Gpu};
use crate::mesh::Mesh;
use crate::passes::scene::{Features, ViewMode};
use crate::passes::{Bloom, ScenePipeline};
use crate::physics::Physics;
use crate::sheets::LINEAR;
use crate::view::{Showing, View};
use std::ops::Range;
use std::sync::{Arc, Mutex, PoisonError};
use surefoot_compiler::compiled::{Compiled, Live};
use surefoot_compiler::images::Images;

/// A pass by its name.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum PassKind {
    /// What throws shadows, into the lights' maps; drawn only where something of it moved.
    Shadows,
    /// The scene from one place, into the cubemap of what is mirrored; drawn only where something of it moved.
    Capture,
    /// A cone for each tile of pixels, up to where the tile's rays begin; marched only where something moved.
    Cones,
    /// Rays through the field, over the whole screen.
    Scene,
    /// Meshes over it, with its depth.
    Meshes,
    /// Balls over it, with its depth.
    Balls,
    /// Light that is scattered over all of it, on film.
    Bloom,
}

/// A pass of a frame, and why it is there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PlannedPass {
    /// Which.
    pub kind: PassKind,
    /// Its name, for people.
    pub name: &'static str,
    /// Why the frame needs it.
    pub reason: String,
}

/// The passes that a view of a scene needs, in the order in which they run.
pub fn plan(compiled: &Compiled, mode: ViewMode) -> Vec<PlannedPass> {
    planned(&Features::of(compiled, mode))
}

fn planned(features: &Features) -> Vec<PlannedPass> {
    let parts = [
        (features.shadows, "a light throws shadows"),
        (features.occlusion, "corners are kept from the sky's light"),
        (features.environment, "images stand for the sky"),
        (features.reflections > 0, "mirrored rays are followed"),
        (features.glass, "rays go on inside of glass"),
        (features.fog, "fog is in between"),
        (features.optics, "a camera has a lens or parallel rays"),
        (features.section.is_some(), "a plane cuts it open"),
        (features.meshes_first, "it ends at the meshes, whose depth is drawn before"),
        (features.depth(), "its depth is written, for what is rasterised"),
    ];
    let reasons: Vec<&str> = parts.into_iter().filter(|(on, _)| *on).map(|(_, why)| why).collect();
    let mut passes = Vec::new();
    if features.maps() {
        let casters = [(features.meshes, "meshes"), (features.balls, "balls"), (features.field_maps, "the field where a light asks for `map`")];
        let casters: Vec<&str> = casters.into_iter().filter_map(|(on, what)| on.then_some(what)).collect();
        let reason = format!("{} throw shadows; drawn where something moved", casters.join(", "));
        passes.push(PlannedPass { kind: PassKind::Shadows, name: "shadow maps", reason });
    }
    if features.capture.is_some() {
        let reason = "what surfaces mirror, seen from one place; drawn where something moved".to_owned();
        passes.push(PlannedPass { kind: PassKind::Capture, name: "capture", reason });
    }
    if features.cones {
        let reason = "one for each tile of pixels, whose rays begin where it ends; marched where something moved".to_owned();
        passes.push(PlannedPass { kind: PassKind::Cones, name: "cones", reason });
    }
    passes.push(PlannedPass {
        kind: PassKind::Scene,
        name: "scene",
        reason: match reasons.is_empty() {
            true => "a ray for each pixel".to_owned(),
            false => format!("a ray for each pixel; {}", reasons.join(", ")),
        },
    });
    if features.meshes {
        passes.push(PlannedPass { kind: PassKind::Meshes, name: "meshes", reason: "the scene has meshes".to_owned() });
    }
    if features.balls {
        passes.push(PlannedPass { kind: PassKind::Balls, name: "balls", reason: "the scene has balls".to_owned() });
    }
    if features.bloom {
        passes.push(PlannedPass { kind: PassKind::Bloom, name: "bloom", reason: "light is scattered; on film alone".to_owned() });
    }
    passes
}

/// A compiled scene, ready to be drawn.
#[derive(Debug)]
pub struct Picture {
    gpu: Gpu,
    mode: ViewMode,
    format: wgpu::TextureFormat,
    passes: Vec<PlannedPass>,
    scene: ScenePipeline,
    /// What draws the other view, right of the divider, where there are two.
    beside: Option<ScenePipeline>,
    /// Where the divider is, in parts of the picture's width; and the width in pixels.
    divider: (f32, f32),
    /// What scatters its light, where it falls on film.
    bloom: Option<Bloom>,
    /// The depth of the newest size, where there is depth.
    depth: Mutex<Depth>,
}

/// What a picture with depth keeps beside its colour.
#[derive(Debug, Default)]
struct Depth {
    texture: Option<wgpu::Texture>,
    /// The depth of the meshes, where it was drawn before the field; and that of the other view.
    before: [Option<wgpu::BindGroup>; 2],
}

impl Picture {
    /// Builds what the scene's passes need. May take a while: `live` does it on another thread.
    pub fn prepare(
        gpu: &Gpu,
        compiled: &Compiled,
        format: wgpu::TextureFormat,
        showing: impl Into<Showing>,
    ) -> Result<Self, String> {
        let Showing { view, section, beside } = showing.into();
        let features = |view| Features::of(compiled, view).with_section(section);
        let Some(beside) = beside.map(features) else { return Self::prepare_with(gpu, compiled, format, features(view)) };
        // Light that is scattered would fall from one view on the other; and one pass draws both.
        let first = Features { bloom: false, ..features(view) };
        let beside = Features { bloom: false, ..beside };
        let deep = first.depth() || beside.depth();
        let mut new = Self::prepare_with(gpu, compiled, format, Features { deep, ..first })?;
        new.beside = Some(ScenePipeline::prepare_with(gpu, compiled, format, Features { deep, ..beside })?);
        Ok(new)
    }

    /// The same with other features than the scene's own: to measure what they are worth.
    pub fn prepare_with(gpu: &Gpu, compiled: &Compiled, format: wgpu::TextureFormat, features: Features) -> Result<Self, String> {
        // Light is scattered before the tone curve, so the picture has to be light.
        let features = Features { bloom: features.bloom && format == LINEAR, ..features };
        let bloom = if features.bloom { Some(Bloom::new(gpu, features.tone_text())?) } else { None };
        let scene = std::thread::scope(|scope| {
            // What large unions look at, and where, is found while the driver builds; who needs it waits.
            if let Some(tables) = &compiled.module.tables {
                _ = std::thread::Builder::new().spawn_scoped(scope, || _ = tables.lists());
            }
            ScenePipeline::prepare_with(gpu, compiled, format, features)
        })?;
        let passes = planned(&Features::of(compiled, features.view).with_section(features.section));
        Ok(Self { gpu: gpu.clone(), mode: features.view, format, passes, scene, beside: None, divider: (0.5, 0.0), bloom, depth: Mutex::default() })
    }

    /// What it shows.
    pub fn mode(&self) -> ViewMode {
        self.mode
    }

    /// The format of the targets that it draws on.
    pub fn format(&self) -> wgpu::TextureFormat {
        self.format
    }

    /// The device that it is built on.
    pub fn gpu(&self) -> &Gpu {
        &self.gpu
    }

    /// The passes of each frame, in their order.
    pub fn passes(&self) -> &[PlannedPass] {
        &self.passes
    }

    /// Whether it draws with depth: then that of its meshes is drawn before each pass.
    pub fn has_depth(&self) -> bool {
        self.scene.has_depth()
    }

    /// How many shadow maps there are, and how many pixels a side of one has.
    pub(crate) fn maps(&self) -> (usize, u32) {
        self.scene.maps()
    }

    /// Draws the shadow maps again with the next update, though nothing moved.
    pub(crate) fn forget_maps(&mut self) {
        self.scene.forget_maps();
    }

    /// Tiles of pixels that have a cone, across and down, where there are any.
    pub(crate) fn tiles(&self) -> Option<[u32; 2]> {
        self.scene.tiles()
    }

    /// Marches the cones again with the next update, though nothing moved.
    pub(crate) fn forget_cones(&mut self) {
        self.scene.forget_cones();
    }

    /// Pixels of a side of the cubemap's faces that the scene itself is drawn into, where it is.
    pub(crate) fn capture_side(&mut self) -> u32 {
        self.scene.capture().map_or(0, |capture| capture.side())
    }

    /// Draws everything again with the next update, though nothing moved: shadow maps, the scene's own cubemap and cones too.
    pub fn forget(&mut self) {
        self.forget_maps();
        self.forget_capture();
        self.forget_cones();
    }

    /// Draws that cubemap again with the next update, though nothing moved.
    pub(crate) fn forget_capture(&mut self) {
        if let Some(capture) = self.scene.capture() {
            capture.forget();
        }
    }

    /// How often the scene was drawn into its own cubemap: only where something of it moved.
    pub fn captures(&mut self) -> u64 {
        self.scene.capture().map_or(0, |capture| capture.count())
    }

    /// What the scene's cubemap holds: six faces in the order px, nx, py, ny, pz, nz as cubemaps lie, row by row; red, green, blue of linear
    /// light, and 1 where it is the field's. None where the scene has none, or nothing was drawn yet.
    pub fn captured(&mut self) -> Result<Option<Vec<[f32; 4]>>, String> {
        self.scene.capture().filter(|capture| capture.count() > 0).map(|capture| capture.read()).transpose()
    }

    /// Draws only so many of the passes over the picture from now on, or all of them.
    pub(crate) fn draw_first(&mut self, passes: Option<u32>) {
        self.scene.draw_first(passes);
        let drawn = self.passes.iter().filter(|pass| matches!(pass.kind, PassKind::Scene | PassKind::Meshes | PassKind::Balls)).count();
        if let Some(bloom) = &mut self.bloom {
            bloom.set_idle(passes.is_some_and(|passes| passes as usize <= drawn));
        }
    }

    /// Whether its light is scattered: on film, all of the picture at once.
    pub fn blooms(&self) -> bool {
        self.bloom.is_some()
    }

    /// Orders what becomes of its light, `size` pixels in the corner of a texture, and answers on what. None where it was developed pixel by pixel.
    pub(crate) fn develop(&self, encoder: &mut wgpu::CommandEncoder, light: &wgpu::Texture, size: [u32; 2]) -> Option<wgpu::Texture> {
        self.bloom.as_ref().map(|bloom| bloom.develop(encoder, light, size))
    }

    /// Writes what changed since the last call, and answers whether anything did: where nothing did, there is nothing to draw.
    /// `compiled` is the scene that the picture was prepared from.
    pub fn update(
        &mut self,
        queue: &wgpu::Queue,
        compiled: &Compiled,
        live: &Live,
        view: &View,
    ) -> bool {
        let scattered = self.bloom.as_mut().is_some_and(|bloom| bloom.update(compiled.frame(live).bloom));
        let beside = self.beside.as_mut().is_some_and(|beside| beside.update(queue, compiled, live, view));
        self.divider.1 = view.size[0];
        self.scene.update(queue, compiled, live, view) || scattered || beside
    }

    /// Puts the divider of two views to a part of the picture's width. Answers whether the picture is another one then.
    pub fn divide(&mut self, share: f32) -> bool {
        let moves = self.beside.is_some() && self.divider.0 != share;
        self.divider.0 = share;
        moves
    }

    /// What draws its views.
    fn scenes(&mut self) -> impl Iterator<Item = &mut ScenePipeline> {
        std::iter::once(&mut self.scene).chain(&mut self.beside)
    }

    /// Shows the images that the scene names, as far as they could be read; until then it is drawn with the sky of a scene that names none.
    pub fn show_images(&mut self, images: &Images) {
        let gpu = self.gpu.clone();
        self.scenes().for_each(|scene| scene.show_images(&gpu, images));
    }

    /// Shows the scene's balls as they are now, or none. Nothing happens where the scene has none.
    pub fn show_balls(&mut self, compiled: &Compiled, live: &Live, physics: Option<&Physics>) {
        let gpu = self.gpu.clone();
        for balls in self.scenes().filter_map(ScenePipeline::balls_mut) {
            balls.show(&gpu, compiled, live, physics);
        }
    }

    /// Shows the scene's meshes, in the order of the text; a mesh that is none is not drawn. Nothing happens where the scene has none. Fails
    /// where the device has no room.
    pub fn show_meshes(&mut self, meshes: &[Option<Arc<Mesh>>]) -> Result<(), String> {
        let gpu = self.gpu.clone();
        self.scenes().filter_map(ScenePipeline::meshes_mut).try_for_each(|pipeline| pipeline.put(&gpu, meshes))
    }

    /// The depth that a target of so many pixels needs beside its colour, where the frame has any. Where the scene has meshes their depth is
    /// drawn here, before the pass: call it for each pass, after [`Picture::update`]. Its contents need not be kept from one
    /// pass to the next: the field is drawn first, and writes it.
    pub fn depth(&self, size: wgpu::Extent3d) -> Option<wgpu::TextureView> {
        if !self.scene.has_depth() {
            return None;
        }
        let before = [Some(&self.scene), self.beside.as_ref()].map(|scene| scene.and_then(|scene| scene.draw_before(size)));
        let mut kept = self.depth.lock().unwrap_or_else(PoisonError::into_inner);
        kept.before = before;
        let texture = match kept.texture.take().filter(|t| t.size() == size) {
            Some(texture) => texture,
            None => self.gpu.device().create_texture(&wgpu::TextureDescriptor {
                label: Some("surefoot depth"),
                size,
                mip_level_count: 1,
                sample_count: 1,
                dimension: wgpu::TextureDimension::D2,
                format: DEPTH,
                usage: wgpu::TextureUsages::RENDER_ATTACHMENT,
                view_formats: &[],
            }),
        };
        let view = texture.create_view(&Default::default());
        kept.texture = Some(texture);
        Some(view)
    }

    /// Draws the frame, of two views the first. The pass has the depth of [`Picture::depth`], where there is one.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        let [before, _] = self.depth.lock().unwrap_or_else(PoisonError::into_inner).before.clone();
        self.scene.draw(pass, before.as_ref());
    }

    /// Draws so many columns of some rows; of two views each on its side of the divider.
    pub fn draw_rows(&self, pass: &mut wgpu::RenderPass<'_>, width: u32, rows: Range<u32>) {
        let high = rows.end.saturating_sub(rows.start);
        let Some(beside) = &self.beside else {
            pass.set_scissor_rect(0, rows.start, width, high);
            return self.draw(pass);
        };
        let (share, whole) = self.divider;
        let left = ((share * whole).round().max(0.0) as u32).min(width);
        let before = self.depth.lock().unwrap_or_else(PoisonError::into_inner).before.clone();
        for (scene, before, columns) in [(&self.scene, &before[0], 0..left), (beside, &before[1], left..width)] {
            if !columns.is_empty() {
                pass.set_scissor_rect(columns.start, rows.start, columns.end - columns.start, high);
                scene.draw(pass, before.as_ref());
            }
        }
    }
}
