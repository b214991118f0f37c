//! Meshes over the field: triangles that share its uniforms, its light and its depth.

use super::layers;
use super::scene::{Features, ViewMode};
use super::section;
use super::surroundings;
use crate::gpu::{Gpu, PipelineKey, storage_layout};
use crate::mesh::{Mesh, Vertex};
use bytemuck::{Pod, Zeroable};
use std::borrow::Cow;
use std::sync::Arc;
use surefoot_compiler::compiled::Compiled;
use surefoot_compiler::mesh::Placed;
use surefoot_compiler::shading;
use surefoot_compiler::vector::sub;
use wgpu::util::DeviceExt;

const LABEL: &str = "surefoot meshes";

/// Draws meshes.
#[derive(Debug)]
pub struct MeshesPipeline {
    pipeline: wgpu::RenderPipeline,
    /// What draws their depth alone, where it is drawn before the field.
    before: Option<wgpu::RenderPipeline>,
    pub(super) triangles: Triangles,
}

/// The meshes of a scene on the device, and where they stand.
#[derive(Debug)]
pub(super) struct Triangles {
    /// What passes over meshes are bound to: where they stand.
    pub layout: wgpu::BindGroupLayout,
    pub group: wgpu::BindGroup,
    places: wgpu::Buffer,
    written: Vec<Place>,
    /// Of each mesh of the text its material, where that is not the same everywhere.
    materials: Vec<Option<u32>>,
    /// One for each mesh of the text; none where its file is broken.
    uploaded: Vec<Option<Arc<Uploaded>>>,
    /// Grows with each change of the meshes themselves.
    pub version: u64,
}

/// A mesh on the device.
#[derive(Debug)]
struct Uploaded {
    mesh: Arc<Mesh>,
    vertices: wgpu::Buffer,
    indices: wgpu::Buffer,
}

/// Where a mesh stands and what it is made of, as `mesh.wgsl` declares it.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
struct Place {
    x: [f32; 3],
    roughness: f32,
    y: [f32; 3],
    metallic: f32,
    z: [f32; 3],
    reflectivity: f32,
    origin: [f32; 3],
    material: u32,
    color: [f32; 3],
    mapped: u32,
    emission: [f32; 3],
    padding: u32,
}

impl Place {
    /// `origin` is the scene's point at which the module's `p` is zero; `material` is a place among those that are not the same everywhere.
    fn of(placed: &Placed, origin: [f64; 3], material: Option<u32>, mapped: bool) -> Self {
        let narrow = |v: [f64; 3]| v.map(|c| c as f32);
        let [x, y, z] = placed.axes.map(narrow);
        let [r, g, b, er, eg, eb, roughness, metallic, reflectivity] = placed.look.map(|c| c as f32);
        let origin = narrow(sub(placed.origin, origin));
        let (color, emission) = ([r, g, b], [er, eg, eb]);
        let (material, mapped) = (material.unwrap_or(u32::MAX), u32::from(mapped));
        Self { x, roughness, y, metallic, z, reflectivity, origin, material, color, mapped, emission, padding: 0 }
    }
}

impl MeshesPipeline {
    /// Builds what draws the meshes of a scene. `shadows` is group 3, where the pass looks shadows up.
    pub(super) fn prepare(
        gpu: &Gpu,
        compiled: &Compiled,
        format: wgpu::TextureFormat,
        features: Features,
        shadows: Option<&wgpu::BindGroupLayout>,
    ) -> Result<Self, String> {
        let (depth, plane, constants) = match features.section {
            Some(cut) => (section::before(include_str!("meshes/before.wgsl")).into(), section::PLANE, section::constants(cut).to_vec()),
            None => (Cow::Borrowed(include_str!("meshes/before.wgsl")), "", Vec::new()),
        };
        // No formula of the scene is asked: the same for all scenes.
        let before = [
            "fn sf_gradient(p: vec3f) -> vec4f { return vec4f(p, 0.0); }",
            shading::BASE,
            include_str!("scene/bindings.wgsl"),
            features.eye(),
            include_str!("meshes/place.wgsl"),
            include_str!("meshes/vertex.wgsl"),
            &depth,
            plane,
        ];
        let before_key = PipelineKey { format: None, entries: ["mesh_vertex", "mesh_before"], ..key(before.join("\n"), constants, format) };
        gpu.catch(|| {
            let triangles = Triangles::new(gpu, compiled);
            let pipeline = pipeline(gpu, compiled, format, features, &triangles.layout, shadows)?;
            // A pipeline is known by its text: its layout may not depend on more.
            let scene = surroundings::plain_layout(gpu);
            let before = match features.meshes_first {
                true => Some(gpu.screen_pipeline(LABEL, before_key, &[None, Some(&scene), Some(&triangles.layout)])?),
                false => None,
            };
            Ok(Self { pipeline, before, triangles })
        })?
    }

    /// What draws the same meshes on other targets.
    pub(super) fn other(
        &self,
        gpu: &Gpu,
        compiled: &Compiled,
        format: wgpu::TextureFormat,
        features: Features,
        shadows: Option<&wgpu::BindGroupLayout>,
    ) -> Result<wgpu::RenderPipeline, String> {
        pipeline(gpu, compiled, format, features, &self.triangles.layout, shadows)
    }

    /// Takes the meshes of the scene, in the order of the text.
    pub fn put(&mut self, gpu: &Gpu, meshes: &[Option<Arc<Mesh>>]) -> Result<(), String> {
        self.triangles.put(gpu, meshes)
    }

    /// Draws the depth alone; group 1 is the scene's, without images.
    pub(super) fn draw_before(&self, pass: &mut wgpu::RenderPass<'_>) {
        if let Some(before) = &self.before {
            pass.set_pipeline(before);
            self.triangles.draw(pass);
        }
    }

    /// Draws after the field, whose groups 0 and 1 are set.
    pub(super) fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        self.triangles.draw(pass);
    }
}

/// What draws meshes on targets of a format.
fn pipeline(
    gpu: &Gpu,
    compiled: &Compiled,
    format: wgpu::TextureFormat,
    features: Features,
    layout: &wgpu::BindGroupLayout,
    shadows: Option<&wgpu::BindGroupLayout>,
) -> Result<wgpu::RenderPipeline, String> {
    let shading = features.shading(compiled);
    let mut sections = vec![compiled.module.code()];
    sections.extend(shading.iter().map(|s| &**s));
    sections.push(include_str!("meshes/place.wgsl"));
    sections.push(include_str!("meshes/vertex.wgsl"));
    sections.push(include_str!("meshes/own.wgsl"));
    let mesh = match features.section {
        Some(_) => section::meshes(include_str!("meshes/mesh.wgsl")).into(),
        None => Cow::Borrowed(include_str!("meshes/mesh.wgsl")),
    };
    sections.push(&mesh);
    let met = if features.view == ViewMode::Shaded { layers::mesh_text(compiled, features.textures) } else { Vec::new() };
    sections.extend(met.iter().map(|s| &**s));
    sections.push(match features.view {
        ViewMode::Normals => include_str!("meshes/normals.wgsl"),
        ViewMode::Depth => include_str!("meshes/depth.wgsl"),
        _ => include_str!("meshes/shaded.wgsl"),
    });
    let module = crate::module::layout(gpu, &compiled.module, wgpu::ShaderStages::VERTEX_FRAGMENT);
    let scene = surroundings::layout(gpu, features);
    let layouts = [Some(&module), Some(&scene), Some(layout), shadows];
    gpu.screen_pipeline(LABEL, key(sections.join("\n"), features.constants(format), format), if shadows.is_some() { &layouts } else { &layouts[..3] })
}

/// What a pipeline over meshes is, by its text.
fn key(wgsl: String, constants: Vec<(&'static str, f64)>, format: wgpu::TextureFormat) -> PipelineKey {
    PipelineKey {
        wgsl,
        constants,
        format: Some(format),
        entries: ["mesh_vertex", "mesh_fragment"],
        depth: Some(wgpu::CompareFunction::GreaterEqual),
        corners: Some(CORNERS),
    }
}

impl Triangles {
    fn new(gpu: &Gpu, compiled: &Compiled) -> Self {
        let label = "surefoot meshes";
        let layout = storage_layout(gpu, label, wgpu::ShaderStages::VERTEX_FRAGMENT, 1);
        let places = gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some(label),
            size: (size_of::<Place>() * compiled.blocks.meshes.len().max(1)) as u64,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        let group = gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(label),
            layout: &layout,
            entries: &[wgpu::BindGroupEntry { binding: 0, resource: places.as_entire_binding() }],
        });
        let materials = compiled.functions.mesh_surfaces.clone();
        Self { layout, group, places, written: Vec::new(), materials, uploaded: Vec::new(), version: 0 }
    }

    /// Takes the meshes of the scene, in the order of the text. One that several blocks name is kept once.
    pub fn put(&mut self, gpu: &Gpu, meshes: &[Option<Arc<Mesh>>]) -> Result<(), String> {
        let mut uploaded: Vec<Option<Arc<Uploaded>>> = Vec::new();
        for mesh in meshes {
            let Some(mesh) = mesh else {
                uploaded.push(None);
                continue;
            };
            let same = |u: &&Arc<Uploaded>| Arc::ptr_eq(&u.mesh, mesh);
            let known = self.uploaded.iter().chain(&uploaded).flatten().find(same).cloned();
            let known = match known {
                Some(known) => known,
                None => Arc::new(Uploaded::new(gpu, mesh)?),
            };
            uploaded.push(Some(known));
        }
        self.uploaded = uploaded;
        self.version += 1;
        Ok(())
    }

    /// Writes where the meshes stand. Answers whether anything changed.
    pub fn update(&mut self, queue: &wgpu::Queue, placed: &[Placed], origin: [f64; 3]) -> bool {
        let place = |(i, placed): (usize, &Placed)| {
            let mapped = self.uploaded.get(i).is_some_and(|u| u.as_ref().is_some_and(|u| u.mesh.mapped));
            Place::of(placed, origin, self.materials.get(i).copied().flatten(), mapped)
        };
        let places: Vec<Place> = placed.iter().enumerate().map(place).collect();
        if places == self.written {
            return false;
        }
        queue.write_buffer(&self.places, 0, bytemuck::cast_slice(&places));
        self.written = places;
        true
    }

    /// The meshes that are there, with their places among those of the text.
    pub fn shown(&self) -> impl Iterator<Item = (usize, &Mesh)> {
        self.uploaded.iter().enumerate().filter_map(|(i, u)| u.as_ref().map(|u| (i, &*u.mesh)))
    }

    /// Draws all of them with the pipeline that is set; group 2 is theirs.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_bind_group(2, &self.group, &[]);
        for (i, uploaded) in (0u32..).zip(&self.uploaded) {
            let Some(uploaded) = uploaded else { continue };
            pass.set_vertex_buffer(0, uploaded.vertices.slice(..));
            pass.set_index_buffer(uploaded.indices.slice(..), wgpu::IndexFormat::Uint32);
            pass.draw_indexed(0..uploaded.mesh.indices.len() as u32, 0, i..i + 1);
        }
    }
}

impl Uploaded {
    fn new(gpu: &Gpu, mesh: &Arc<Mesh>) -> Result<Self, String> {
        gpu.catch(|| {
            let buffer = |contents, usage| {
                gpu.device().create_buffer_init(&wgpu::util::BufferInitDescriptor { label: Some("surefoot mesh"), contents, usage })
            };
            Self {
                vertices: buffer(bytemuck::cast_slice(&mesh.vertices), wgpu::BufferUsages::VERTEX),
                indices: buffer(bytemuck::cast_slice(&mesh.indices), wgpu::BufferUsages::INDEX),
                mesh: mesh.clone(),
            }
        })
    }
}

/// How a mesh's corners lie in their buffer.
pub(super) const CORNERS: wgpu::VertexBufferLayout<'static> = wgpu::VertexBufferLayout {
    array_stride: size_of::<Vertex>() as u64,
    step_mode: wgpu::VertexStepMode::Vertex,
    attributes: &wgpu::vertex_attr_array![0 => Float32x3, 1 => Float32x3, 2 => Float32x2],
};
