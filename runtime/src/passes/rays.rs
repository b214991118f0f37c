//! Many rays through a scene, followed on the GPU by a function that can be chosen: what tracers are measured with.

use crate::gpu::{Gpu, UniformBlock, in_and_out_layout, uniform_layout};
use crate::module::{self, ModuleGroup};
use crate::readback::{read, wait};
use bytemuck::{Pod, Zeroable};
use std::time::{Duration, Instant};
use surefoot_compiler::compiled::{Compiled, Live, UniformSource};
use surefoot_compiler::reference::march::Ray;
use surefoot_compiler::vector::{Vec3, add, sub};

/// A ray, as the pass reads it.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct GpuRay {
    /// Where `t` is zero.
    pub origin: [f32; 3],
    /// It begins here.
    pub t_min: f32,
    /// Length one.
    pub direction: [f32; 3],
    /// It ends here.
    pub t_max: f32,
}

impl GpuRay {
    /// A ray from a point in a direction, as the GPU gets it: in 32 bits, and counted from `origin`. It ends at `reach`.
    pub fn narrowed(from: Vec3, direction: Vec3, origin: Vec3, reach: f64) -> Self {
        let narrow = |v: Vec3| v.map(|c| c as f32);
        Self { origin: narrow(sub(from, origin)), t_min: 0.0, direction: narrow(direction), t_max: reach as f32 }
    }

    /// The same ray in 64 bits, with nothing rounded again.
    pub fn widened(&self, origin: Vec3) -> Ray {
        let wide = |v: [f32; 3]| v.map(f64::from);
        Ray { origin: add(wide(self.origin), origin), direction: wide(self.direction), t_min: self.t_min.into(), t_max: self.t_max.into() }
    }
}

/// The point from which the origins of rays are counted that begin at an eye: in 32 bits, and zero where the module can't be moved.
pub fn counted_from(scene: &Compiled, eye: Vec3) -> Vec3 {
    let moves = scene.module.uniforms.iter().any(|u| u.source == UniformSource::Origin);
    if moves { eye.map(|c| f64::from(c as f32)) } else { [0.0; 3] }
}

/// What a tracer may evaluate.
pub const FUNCTIONS: [&str; 6] = ["field", "bound", "distance", "rest_bound", "rest_distance", "ahead"];

/// What came of a ray.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub struct Traced {
    /// Where it ended.
    pub t: f32,
    /// 1 where it met the surface.
    pub hit: u32,
    /// Steps, as the tracer counts them.
    pub steps: u32,
    /// How often it evaluated each of [`FUNCTIONS`]; zeros where they are not counted.
    pub looks: [u32; FUNCTIONS.len()],
}

/// What follows rays.
#[derive(Clone, Copy, Debug)]
pub struct Follower<'a> {
    /// Text that stands after the scene's module, whose functions it may call; empty for the module's own tracer.
    pub wgsl: &'a str,
    /// The function that follows a ray, with arguments and result of `sf_trace`.
    pub name: &'a str,
    /// Whether its looks are counted, which costs time. Those of functions of the module that it calls are not.
    pub count: bool,
}

/// The rays of a picture.
#[derive(Clone, Debug)]
pub struct RayPicture {
    /// Columns, a multiple of 8, and rows.
    pub size: (u32, u32),
    /// A ray for each pixel, row by row.
    pub rays: Vec<GpuRay>,
    /// The scene's point from which the origins of the rays are counted; zero where the module can't be moved.
    pub origin: [f64; 3],
    /// Width of a pixel at distance one.
    pub footprint: f32,
}

/// Rays, a tracer, and the room for what comes of them.
pub struct Rays<'g> {
    gpu: &'g Gpu,
    pipeline: wgpu::ComputePipeline,
    module: ModuleGroup,
    settings: UniformBlock,
    group: wgpu::BindGroup,
    output: wgpu::Buffer,
    answers: wgpu::Buffer,
    /// Rays in a row, and rows: neighbours in a picture are neighbours on the GPU.
    size: (u32, u32),
}


impl<'g> Rays<'g> {
    /// Rays of a picture, and the tracer that follows them.
    ///
    /// # Errors
    /// What the device finds wrong in the text, or rays that are not as many as the pixels.
    pub fn new(
        gpu: &'g Gpu,
        compiled: &Compiled,
        live: &Live,
        tracer: &Follower,
        picture: &RayPicture,
    ) -> Result<Self, String> {
        let (size, rays) = (picture.size, &picture.rays[..]);
        let Follower { wgsl: text, name, count } = *tracer;
        if !size.0.is_multiple_of(8) || rays.len() != size.0 as usize * size.1 as usize || rays.is_empty() {
            return Err("the rays are not those of a picture whose width is a multiple of 8".to_owned());
        }
        let label = "surefoot rays";
        let stage = wgpu::ShaderStages::COMPUTE;
        let mut own = format!("{text}\n{}", include_str!("rays/main.wgsl").replace("TRACE", name));
        if count {
            for (i, function) in FUNCTIONS.iter().enumerate() {
                let (call, counted) = (format!("sf_{function}("), format!("counted_{function}("));
                if own.contains(&call) {
                    own = own.replace(&call, &counted);
                    let (taken, given) = if *function == "ahead" { ("p: vec3f, direction: vec3f", "p, direction") } else { ("p: vec3f", "p") };
                    own.push_str(&format!("fn {counted}{taken}) -> f32 {{ looks[{i}] += 1u; return {call}{given}); }}\n"));
                }
            }
        }
        let wgsl = format!("{}\n{own}", compiled.module.code());
        let device = gpu.device();
        gpu.catch(|| {
            let module_layout = module::layout(gpu, &compiled.module, stage);
            let rays_layout = in_and_out_layout(gpu, label);
            let settings_layout = uniform_layout(gpu, label, 16, stage);
            let layouts = [Some(&module_layout), Some(&rays_layout), Some(&settings_layout)];
            let pipeline = gpu.compute_pipeline(label, &wgsl, "main", &layouts)?;
            let mut module = ModuleGroup::new(gpu, compiled, &module_layout);
            module.write(gpu.queue(), &compiled.uniform_bytes(live, picture.origin));
            let mut settings = UniformBlock::new(gpu, label, &settings_layout, 16);
            settings.write(gpu.queue(), bytemuck::bytes_of(&[picture.footprint, 0.0, 0.0, 0.0]));
            use wgpu::BufferUsages as Use;
            let buffer = |size: usize, usage| {
                let size = size as u64;
                device.create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false })
            };
            let input = buffer(size_of_val(rays), Use::STORAGE | Use::COPY_DST);
            gpu.queue().write_buffer(&input, 0, bytemuck::cast_slice(rays));
            let room = rays.len() * size_of::<Traced>();
            let output = buffer(room, Use::STORAGE | Use::COPY_SRC);
            let answers = buffer(room, Use::COPY_DST | Use::MAP_READ);
            let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some(label),
                layout: &rays_layout,
                entries: &[
                    wgpu::BindGroupEntry { binding: 0, resource: input.as_entire_binding() },
                    wgpu::BindGroupEntry { binding: 1, resource: output.as_entire_binding() },
                ],
            });
            Ok::<_, String>(Self { gpu, pipeline, module, settings, group, output, answers, size })
        })?
    }

    /// Follows all rays once and waits: how long that took.
    pub fn run(&self) -> Result<Duration, String> {
        let began = Instant::now();
        let submitted = self.gpu.catch(|| {
            let mut encoder = self.gpu.device().create_command_encoder(&Default::default());
            self.encode(&mut encoder);
            self.gpu.queue().submit([encoder.finish()])
        })?;
        wait(self.gpu, submitted)?;
        Ok(began.elapsed())
    }

    /// What came of each ray in the last run.
    pub fn read(&self) -> Result<Vec<Traced>, String> {
        let submitted = self.gpu.catch(|| {
            let mut encoder = self.gpu.device().create_command_encoder(&Default::default());
            encoder.copy_buffer_to_buffer(&self.output, 0, &self.answers, 0, self.output.size());
            self.gpu.queue().submit([encoder.finish()])
        })?;
        let bytes = read(self.gpu, &self.answers, submitted)?;
        Ok(bytemuck::pod_collect_to_vec(&bytes))
    }

    fn encode(&self, encoder: &mut wgpu::CommandEncoder) {
        let mut pass = encoder.begin_compute_pass(&Default::default());
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, self.module.group(), &[]);
        pass.set_bind_group(1, &self.group, &[]);
        pass.set_bind_group(2, self.settings.group(), &[]);
        pass.dispatch_workgroups(self.size.0 / 8, self.size.1.div_ceil(8), 1);
    }
}
