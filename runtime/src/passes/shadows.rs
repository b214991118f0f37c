//! Shadow maps: what balls and meshes throw, and the field where a light asks for it. A light that is infinitely far has one map, whose frame
//! is the box of all that throws; one that has a place has six, the sides of a cube.

use super::meshes::{CORNERS, Triangles};
use super::scene::Features;
use crate::gpu::{DEPTH, DEPTH_AS_READ, Gpu, PipelineKey, UniformBlock, storage_layout, uniform_layout};
use bytemuck::{Pod, Zeroable};
use surefoot_compiler::compiled::{Compiled, Frame, Shadow};
use surefoot_compiler::mesh::Placed;
use surefoot_compiler::frame::{MAX_LIGHTS, default_light};
use surefoot_compiler::reference::shade::{self, Lamp};
use surefoot_compiler::vector::{Vec3, add, cross, dot, length, scale, sub, unit};

/// The maps of a scene, and what draws them.
#[derive(Debug)]
pub(super) struct Shadows {
    gpu: Gpu,
    features: Features,
    /// First map of each light; none where it throws no shadow.
    first: Vec<Option<u32>>,
    /// Whether the field is in the light's maps.
    field: Vec<bool>,
    lights: UniformBlock,
    boxes: wgpu::Buffer,
    views: UniformBlock,
    layers: Vec<wgpu::TextureView>,
    /// The lights and the boxes, to be written; the same and one map's axes, to be read while it is drawn; the same with the maps.
    measure: wgpu::BindGroup,
    cast: wgpu::BindGroup,
    read: wgpu::BindGroup,
    read_layout: wgpu::BindGroupLayout,
    casters: Casters,
    drawn: Option<Drawn>,
    side: u32,
}

/// What draws into maps.
#[derive(Debug)]
struct Casters {
    bounds: Option<wgpu::ComputePipeline>,
    balls: Option<(wgpu::RenderPipeline, wgpu::BindGroupLayout)>,
    meshes: Option<wgpu::RenderPipeline>,
    field: Option<wgpu::RenderPipeline>,
}

/// What the maps show: where nothing of it changed, they are right.
#[derive(Debug, PartialEq)]
struct Drawn {
    lamps: Vec<Lamp>,
    placed: Vec<[[f64; 3]; 4]>,
    meshes: u64,
    balls: Option<u64>,
    field: Vec<u8>,
    frame: (Vec3, f64),
}

/// Balls that throw shadows.
#[derive(Clone, Copy, Debug)]
pub(super) struct BallsNow<'a> {
    pub buffer: &'a wgpu::Buffer,
    pub count: u32,
    pub version: u64,
}

/// A moment of the scene, as the maps want it.
pub(super) struct Moment<'a> {
    pub frame: &'a Frame,
    /// The scene's point at which the module's `p` is zero.
    pub origin: Vec3,
    pub triangles: Option<&'a Triangles>,
    pub placed: &'a [Placed],
    pub balls: Option<BallsNow<'a>>,
    /// Group 0: the module's uniforms.
    pub module: &'a wgpu::BindGroup,
    /// Their bytes, the origin zero: what the field depends on.
    pub field: Vec<u8>,
}

/// A light, as `shadows/base.wgsl` declares it.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct ShadowLight {
    across: [f32; 3],
    first: i32,
    above: [f32; 3],
    position: u32,
    along: [f32; 3],
    field: u32,
    center: [f32; 3],
    far: f32,
    scene_center: [f32; 3],
    balls: u32,
}

/// A map's axes, as `shadows/cast.wgsl` declares them; as far apart as every device wants.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct ShadowView {
    across: [f32; 3],
    light: u32,
    above: [f32; 3],
    padding_a: u32,
    along: [f32; 3],
    padding_b: u32,
    rest: [[f32; 4]; 13],
}

/// Bytes of the boxes: six numbers for each light.
const BOXES: u64 = 24 * MAX_LIGHTS as u64;

/// Side of a map in pixels where there are so many.
fn side(maps: usize) -> u32 {
    match maps {
        0..=4 => 2048,
        5..=24 => 1024,
        _ => 512,
    }
}

fn layout(gpu: &Gpu, visibility: wgpu::ShaderStages, types: &[wgpu::BindingType]) -> wgpu::BindGroupLayout {
    let entry = |(binding, &ty): (u32, &wgpu::BindingType)| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None };
    let entries: Vec<_> = (0u32..).zip(types).map(entry).collect();
    gpu.device().create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(LABEL), entries: &entries })
}

fn uniform(moves: bool, size: u64) -> wgpu::BindingType {
    wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Uniform,
        has_dynamic_offset: moves,
        min_binding_size: wgpu::BufferSize::new(size),
    }
}

fn storage(read_only: bool) -> wgpu::BindingType {
    wgpu::BindingType::Buffer { ty: wgpu::BufferBindingType::Storage { read_only }, has_dynamic_offset: false, min_binding_size: None }
}

const LABEL: &str = "surefoot shadows";
const LIGHTS: u64 = (size_of::<ShadowLight>() * MAX_LIGHTS) as u64;

impl Shadows {
    /// Builds the maps of a scene.
    pub fn new(gpu: &Gpu, compiled: &Compiled, features: Features) -> Result<Self, String> {
        use wgpu::ShaderStages as On;
        // As the lamps of a moment are: a scene without lights has one that is infinitely far.
        let blocks = &compiled.blocks.lights;
        let kinds: Vec<(bool, Shadow)> = match blocks.is_empty() {
            true => vec![(false, default_light().shadow)],
            false => blocks.iter().take(MAX_LIGHTS).map(|light| (light.position, light.shadow.0)).collect(),
        };
        let mut maps = 0;
        let mut first = Vec::new();
        for (position, shadow) in &kinds {
            let field = *shadow == Shadow::Map;
            let needed = *shadow != Shadow::None && (features.balls || features.meshes || field);
            first.push(needed.then_some(maps));
            maps += if needed { if *position { 6 } else { 1 } } else { 0 };
        }
        let maps = maps.max(1);
        let side = side(maps as usize);
        let device = gpu.device();
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some(LABEL),
            size: wgpu::Extent3d { width: side, height: side, depth_or_array_layers: gpu.array_layers(maps) },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: DEPTH,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::TEXTURE_BINDING,
            view_formats: &[],
        });
        let view = |first, count, dimension| {
            texture.create_view(&wgpu::TextureViewDescriptor {
                dimension: Some(dimension),
                base_array_layer: first,
                array_layer_count: Some(count),
                ..Default::default()
            })
        };
        let layers = (0..maps).map(|layer| view(layer, 1, wgpu::TextureViewDimension::D2)).collect();
        let all = view(0, maps, wgpu::TextureViewDimension::D2Array);
        let depths = wgpu::BindingType::Texture {
            sample_type: DEPTH_AS_READ,
            view_dimension: wgpu::TextureViewDimension::D2Array,
            multisampled: false,
        };
        let stride = size_of::<ShadowView>() as u64;
        let measure_layout = layout(gpu, On::COMPUTE, &[uniform(false, LIGHTS), storage(false)]);
        let cast_layout = layout(gpu, On::VERTEX_FRAGMENT, &[uniform(false, LIGHTS), storage(true), uniform(true, stride)]);
        let read_layout = layout(gpu, On::VERTEX_FRAGMENT, &[uniform(false, LIGHTS), storage(true), depths]);
        let block = |size| UniformBlock::new(gpu, LABEL, &uniform_layout(gpu, LABEL, size, On::VERTEX_FRAGMENT), size);
        let (lights, views) = (block(LIGHTS), block(stride * u64::from(maps)));
        let boxes = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some(LABEL),
            size: BOXES,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let (Some(light_buffer), Some(view_buffer)) = (lights.buffer(), views.buffer()) else {
            return Err("the shadows have no blocks".to_owned());
        };
        let one = wgpu::BufferBinding { buffer: view_buffer, offset: 0, size: wgpu::BufferSize::new(stride) };
        let group = |layout: &wgpu::BindGroupLayout, last: Option<wgpu::BindingResource<'_>>| {
            let parts = [Some(light_buffer.as_entire_binding()), Some(boxes.as_entire_binding()), last];
            let entry = |(binding, resource)| wgpu::BindGroupEntry { binding, resource };
            let entries: Vec<_> = (0u32..).zip(parts.into_iter().flatten()).map(entry).collect();
            device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(LABEL), layout, entries: &entries })
        };
        let measure = group(&measure_layout, None);
        let cast = group(&cast_layout, Some(wgpu::BindingResource::Buffer(one)));
        let read = group(&read_layout, Some(wgpu::BindingResource::TextureView(&all)));
        let casters = Casters::new(gpu, compiled, features, &measure_layout, &cast_layout, side)?;
        let field = kinds.iter().map(|(_, shadow)| *shadow == Shadow::Map).collect();
        let (gpu, drawn) = (gpu.clone(), None);
        Ok(Self { gpu, features, first, field, lights, boxes, views, layers, measure, cast, read, read_layout, casters, drawn, side })
    }

    /// What passes are bound to that look the shadows up: group 3.
    pub fn group(&self) -> &wgpu::BindGroup {
        &self.read
    }

    /// Its layout.
    pub fn layout(&self) -> &wgpu::BindGroupLayout {
        &self.read_layout
    }

    /// How many maps there are, and the pixels of their sides.
    pub fn size(&self) -> (usize, u32) {
        (self.layers.len(), self.side)
    }

    /// Draws the maps with the next update, though nothing moved.
    pub fn forget(&mut self) {
        self.drawn = None;
    }

    /// Draws the maps where what they show is not what it was. Answers whether anything changed.
    pub fn update(&mut self, moment: &Moment) -> bool {
        let lamps = shade::lamps(moment.frame);
        let (middle, radius) = self.region(moment);
        let balls = moment.balls.filter(|b| b.count > 0);
        // A mesh that is not read yet throws nothing.
        let meshes = moment.triangles.filter(|t| self.features.meshes && t.shown().next().is_some());
        let queue = self.gpu.queue();
        let mut lights = [ShadowLight { first: -1, ..ShadowLight::zeroed() }; MAX_LIGHTS];
        let mut boxes = [[u32::MAX, u32::MAX, u32::MAX, 0, 0, 0]; MAX_LIGHTS];
        let mut views: Vec<ShadowView> = Vec::new();
        let nothing = balls.is_none() && meshes.is_none();
        let narrow = |v: Vec3| v.map(|c| c as f32);
        for (i, lamp) in lamps.iter().enumerate().take(self.first.len()) {
            let field = self.field[i];
            let Some(first) = self.first[i].filter(|_| lamp.softness >= 0.0 && (field || !nothing)) else { continue };
            let [across, above, along] = axes(lamp);
            let center = if lamp.position { lamp.vector } else { middle };
            lights[i] = ShadowLight {
                across: narrow(across),
                first: first as i32,
                above: narrow(above),
                position: u32::from(lamp.position),
                along: narrow(along),
                field: u32::from(field),
                center: narrow(sub(center, moment.origin)),
                far: (4.0 * moment.frame.extent + length(center)) as f32,
                scene_center: narrow(center),
                balls: balls.map_or(0, |b| b.count),
            };
            let view = |[across, above, along]: [Vec3; 3]| ShadowView {
                across: narrow(across),
                light: i as u32,
                above: narrow(above),
                padding_a: 0,
                along: narrow(along),
                padding_b: 0,
                rest: [[0.0; 4]; 13],
            };
            match lamp.position {
                true => views.extend(sides().map(view)),
                false => {
                    views.push(view([across, above, along]));
                    boxes[i] = frame_box([across, above, along], center, meshes, moment, field.then_some(radius));
                }
            }
        }
        let changed = self.lights.write(queue, bytemuck::cast_slice(&lights));
        let placed = moment.placed.iter().map(|p| [p.axes[0], p.axes[1], p.axes[2], p.origin]).collect();
        let drawn = Drawn {
            lamps,
            placed,
            meshes: meshes.map_or(0, |m| m.version),
            balls: balls.map(|b| b.version),
            field: if self.field.contains(&true) { moment.field.clone() } else { Vec::new() },
            frame: (middle, radius),
        };
        if self.drawn.as_ref() == Some(&drawn) {
            return changed;
        }
        self.drawn = Some(drawn);
        self.views.write(queue, bytemuck::cast_slice(&views));
        queue.write_buffer(&self.boxes, 0, bytemuck::cast_slice(&boxes));
        self.draw(moment, balls, meshes, &views, &lights);
        true
    }

    fn draw(&self, moment: &Moment, balls: Option<BallsNow>, meshes: Option<&Triangles>, views: &[ShadowView], lights: &[ShadowLight]) {
        let device = self.gpu.device();
        let balls = balls.zip(self.casters.balls.as_ref()).map(|(balls, (pipeline, layout))| {
            let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout,
                entries: &[wgpu::BindGroupEntry { binding: 0, resource: balls.buffer.as_entire_binding() }],
            });
            (pipeline, group, balls.count)
        });
        let mut encoder = device.create_command_encoder(&Default::default());
        if let (Some((_, group, count)), Some(bounds)) = (&balls, &self.casters.bounds) {
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(bounds);
            pass.set_bind_group(2, group, &[]);
            pass.set_bind_group(3, &self.measure, &[]);
            pass.dispatch_workgroups(count.div_ceil(64), self.first.len() as u32, 1);
        }
        for (i, view) in views.iter().enumerate() {
            let light = lights[view.light as usize];
            // The maps of a light stand one after another, as its views do.
            let before = views.iter().take(i).filter(|v| v.light == view.light).count();
            let Some(layer) = self.layers.get(light.first.max(0) as usize + before) else { continue };
            let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
                label: Some(LABEL),
                depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                    view: layer,
                    depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(1.0), store: wgpu::StoreOp::Store }),
                    stencil_ops: None,
                }),
                ..Default::default()
            });
            pass.set_bind_group(3, &self.cast, &[(i * size_of::<ShadowView>()) as u32]);
            if let (Some(pipeline), Some(meshes)) = (&self.casters.meshes, meshes) {
                pass.set_pipeline(pipeline);
                meshes.draw(&mut pass);
            }
            if let Some((pipeline, group, count)) = &balls {
                pass.set_pipeline(pipeline);
                pass.set_bind_group(2, group, &[]);
                pass.draw(0..6, 0..*count);
            }
            if let Some(pipeline) = self.casters.field.as_ref().filter(|_| light.field == 1) {
                pass.set_pipeline(pipeline);
                pass.set_bind_group(0, moment.module, &[]);
                pass.draw(0..3, 0..1);
            }
        }
        self.gpu.queue().submit([encoder.finish()]);
    }

    /// What the maps of lights that are infinitely far are drawn around: where the scene's own camera looks, as far as it is from there.
    /// Beyond, the field's shadows are traced.
    fn region(&self, moment: &Moment) -> (Vec3, f64) {
        let far = moment.frame.extent;
        let (target, radius) = moment.frame.cameras.first().map_or(([0.0; 3], far), |(_, camera)| {
            (camera.target, length(sub(camera.eye, camera.target)))
        });
        (target, radius.min(far).max(1e-3))
    }
}

/// The axes of a light's map: to the right, up, and how it travels.
fn axes(lamp: &Lamp) -> [Vec3; 3] {
    let along = scale(lamp.vector, -1.0);
    let upright = if along[1].abs() > 0.9 { [1.0, 0.0, 0.0] } else { [0.0, 1.0, 0.0] };
    let across = unit(cross(along, upright)).unwrap_or([1.0, 0.0, 0.0]);
    [across, cross(across, along), along]
}

/// The axes of a cube's sides, as `shadows/lit.wgsl` finds them: +x, -x, +y, -y, +z, -z.
fn sides() -> [[Vec3; 3]; 6] {
    [0, 1, 2, 3, 4, 5].map(|side| {
        let unit = |axis: usize, length: f64| {
            let mut v = [0.0; 3];
            v[axis % 3] = length;
            v
        };
        let along = unit(side / 2, if side % 2 == 0 { 1.0 } else { -1.0 });
        let above = unit(side / 2 + 1, 1.0);
        [cross(along, above), above, along]
    })
}

/// The box of the meshes in a light's axes about a centre, and of the field's region where that is in the map, as whole numbers in the order
/// of the numbers; balls widen it on the device.
fn frame_box(axes: [Vec3; 3], center: Vec3, meshes: Option<&Triangles>, moment: &Moment, field: Option<f64>) -> [u32; 6] {
    let (mut low, mut high) = ([f64::INFINITY; 3], [f64::NEG_INFINITY; 3]);
    let mut hold = |at: Vec3, around: f64| {
        for i in 0..3 {
            low[i] = low[i].min(at[i] - around);
            high[i] = high[i].max(at[i] + around);
        }
    };
    for (i, mesh) in meshes.into_iter().flat_map(Triangles::shown) {
        let Some(placed) = moment.placed.get(i) else { continue };
        for corner in 0..8 {
            let own = [0, 1, 2].map(|axis| f64::from(mesh.bounds[corner >> axis & 1][axis]));
            let at = (0..3).fold(placed.origin, |at, i| add(at, scale(placed.axes[i], own[i])));
            // A little more than it, so that a flat mesh has a box and its edges are within.
            hold(axes.map(|axis| dot(sub(at, center), axis)), 1e-4 * (1.0 + length(sub(at, center))));
        }
    }
    if let Some(radius) = field {
        // What stands before the region throws shadows into it.
        let deep = (2.0 * moment.frame.extent).min(100.0 * radius);
        hold([0.0; 3], radius);
        hold([0.0, 0.0, -deep], 0.0);
        hold([0.0, 0.0, deep], 0.0);
    }
    if low[0] > high[0] {
        return [u32::MAX, u32::MAX, u32::MAX, 0, 0, 0];
    }
    let order = |c: f64| {
        let bits = (c as f32).to_bits();
        if bits >> 31 == 1 { !bits } else { bits | 1 << 31 }
    };
    let ([a, b, c], [x, y, z]) = (low.map(order), high.map(order));
    [a, b, c, x, y, z]
}

impl Casters {
    fn new(
        gpu: &Gpu,
        compiled: &Compiled,
        features: Features,
        measure: &wgpu::BindGroupLayout,
        cast: &wgpu::BindGroupLayout,
        side: u32,
    ) -> Result<Self, String> {
        use wgpu::ShaderStages as On;
        const BASE: &str = include_str!("shadows/base.wgsl");
        const BALL: &str = include_str!("../physics/ball.wgsl");
        const CAST: [&str; 3] = [BASE, include_str!("shadows/box.wgsl"), include_str!("shadows/cast.wgsl")];
        let pipeline = |before: &[&str], last: &str, corners, groups: &[Option<&wgpu::BindGroupLayout>], constants| {
            let wgsl = [before, &CAST, &[last]].concat().join("\n");
            let key = PipelineKey {
                wgsl,
                constants,
                format: None,
                entries: ["map_vertex", "map_fragment"],
                depth: Some(wgpu::CompareFunction::Less),
                corners,
            };
            gpu.screen_pipeline(LABEL, key, groups)
        };
        let (mut bounds, mut balls, mut meshes, mut field) = (None, None, None, None);
        if features.balls {
            let layout = storage_layout(gpu, LABEL, On::COMPUTE | On::VERTEX_FRAGMENT, 1);
            let text = [BASE, BALL, include_str!("shadows/bounds.wgsl")].join("\n");
            bounds = Some(gpu.compute_pipeline(LABEL, &text, "bounds", &[None, None, Some(&layout), Some(measure)])?);
            let drawn = pipeline(&[BALL], include_str!("shadows/ball.wgsl"), None, &[None, None, Some(&layout), Some(cast)], Vec::new())?;
            balls = Some((drawn, layout));
        }
        if features.meshes {
            let layout = storage_layout(gpu, LABEL, On::VERTEX_FRAGMENT, 1);
            let place = include_str!("meshes/place.wgsl");
            meshes = Some(pipeline(&[place], include_str!("shadows/mesh.wgsl"), Some(CORNERS), &[None, None, Some(&layout), Some(cast)], Vec::new())?);
        }
        if features.field_maps {
            let stage = On::VERTEX_FRAGMENT;
            let module = crate::module::layout(gpu, &compiled.module, stage);
            let text = include_str!("shadows/field.wgsl");
            let constants = vec![("side", f64::from(side))];
            field = Some(pipeline(&[compiled.module.code()], text, None, &[Some(&module), None, None, Some(cast)], constants)?);
        }
        Ok(Self { bounds, balls, meshes, field })
    }
}
