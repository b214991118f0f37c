//! A module's functions at many points, computed by the GPU as a ray would compute them.

use crate::gpu::{Gpu, in_and_out_layout};
use crate::module::{self, ModuleGroup};
use crate::readback::read;
use surefoot_compiler::compiled::{Compiled, Export, Live};

/// The passes' texts, and how many numbers each answers for a point.
const PASSES: [(Export, &str, usize); 4] = [
    (Export::Field, include_str!("evaluate/field.wgsl"), 1),
    (Export::Bound, include_str!("evaluate/bound.wgsl"), 1),
    (Export::Distance, include_str!("evaluate/distance.wgsl"), 1),
    (Export::Gradient, include_str!("evaluate/gradient.wgsl"), 4),
];

/// Points of one dispatch: within what every device offers.
const BATCH: usize = 1 << 20;

/// A function of the module at points of the module's `p` (that is the scene's point where `origin` is zero): one number for each
/// point, or four of [`Export::Gradient`]. `origin` is the scene's point at which `p` is zero.
pub fn evaluate(
    gpu: &Gpu,
    compiled: &Compiled,
    live: &Live,
    origin: [f64; 3],
    export: Export,
    points: &[[f32; 3]],
) -> Result<Vec<f32>, String> {
    let Some((_, text, numbers)) = PASSES.iter().find(|(e, ..)| *e == export) else {
        return Err(format!("`{}` is no function of a point alone", export.name()));
    };
    if !compiled.module.exports.contains(&export) {
        return Err(format!("the module has no function `{}`", export.name()));
    }
    let label = "surefoot evaluate";
    let stage = wgpu::ShaderStages::COMPUTE;
    let wgsl = format!("{}\n{text}", compiled.module.code());
    let program = gpu.catch(|| {
        let module_layout = module::layout(gpu, &compiled.module, stage);
        let points_layout = in_and_out_layout(gpu, label);
        let layouts = [Some(&module_layout), Some(&points_layout)];
        let pipeline = gpu.compute_pipeline(label, &wgsl, "main", &layouts)?;
        let mut module = ModuleGroup::new(gpu, compiled, &module_layout);
        module.write(gpu.queue(), &compiled.uniform_bytes(live, origin));
        Ok::<_, String>(Program { pipeline, points_layout, module })
    })??;
    let mut answers = Vec::with_capacity(points.len() * numbers);
    for batch in points.chunks(BATCH) {
        let padded: Vec<[f32; 4]> = batch.iter().map(|&[x, y, z]| [x, y, z, 0.0]).collect();
        answers.extend(program.run(gpu, &padded, *numbers)?);
    }
    Ok(answers)
}

struct Program {
    pipeline: wgpu::ComputePipeline,
    points_layout: wgpu::BindGroupLayout,
    module: ModuleGroup,
}

impl Program {
    fn run(&self, gpu: &Gpu, points: &[[f32; 4]], numbers: usize) -> Result<Vec<f32>, String> {
        let device = gpu.device();
        let buffer = |size: u64, usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("surefoot evaluate"),
                size,
                usage,
                mapped_at_creation: false,
            })
        };
        let bytes: &[u8] = bytemuck::cast_slice(points);
        let answer_size = 4 * (points.len() * numbers) as u64;
        let (answers, submitted) = gpu.catch(|| {
            use wgpu::BufferUsages as Use;
            let input = buffer(bytes.len() as u64, Use::STORAGE | Use::COPY_DST);
            let output = buffer(answer_size, Use::STORAGE | Use::COPY_SRC);
            let answers = buffer(answer_size, Use::COPY_DST | Use::MAP_READ);
            gpu.queue().write_buffer(&input, 0, bytes);
            let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
                label: None,
                layout: &self.points_layout,
                entries: &[
                    wgpu::BindGroupEntry { binding: 0, resource: input.as_entire_binding() },
                    wgpu::BindGroupEntry { binding: 1, resource: output.as_entire_binding() },
                ],
            });
            let mut encoder = device.create_command_encoder(&Default::default());
            let mut pass = encoder.begin_compute_pass(&Default::default());
            pass.set_pipeline(&self.pipeline);
            pass.set_bind_group(0, self.module.group(), &[]);
            pass.set_bind_group(1, &group, &[]);
            pass.dispatch_workgroups((points.len() as u32).div_ceil(64), 1, 1);
            drop(pass);
            encoder.copy_buffer_to_buffer(&output, 0, &answers, 0, answer_size);
            (answers, gpu.queue().submit([encoder.finish()]))
        })?;
        let bytes = read(gpu, &answers, submitted)?;
        Ok(bytemuck::pod_collect_to_vec(&bytes))
    }
}
