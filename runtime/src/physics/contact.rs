//! The contact with a field: an emitted module, and the pass that moves balls by it.

use super::buffers::Layout;
use crate::gpu::Gpu;
use crate::module;
use surefoot_compiler::compiled::{Compiled, Export, Live};
use surefoot_compiler::physics::MOST_SUBSTEPS;

/// Bindings of the module's uniform block as it is now, and as it was before. Those between are the tables'.
const BLOCKS: [u32; 2] = [0, 3];

/// The code of a scene's contact with balls, and the values that it reads at the moments of a step.
#[derive(Debug)]
pub struct Contact {
    pipeline: wgpu::ComputePipeline,
    group: wgpu::BindGroup,
    /// The module's uniform block at each moment; none where the module has no block.
    moments: Option<wgpu::Buffer>,
    /// Bytes from one moment to the next.
    stride: u32,
    /// Whether the field may change.
    moving: bool,
    /// The block as it was at the end of the last step.
    last: Vec<u8>,
}

impl Contact {
    /// Builds the code for a scene. May take a while: a window does it on another thread.
    pub fn prepare(gpu: &Gpu, compiled: &Compiled) -> Result<Self, String> {
        let compiled = compiled.ground();
        for export in [Export::Bound, Export::Distance, Export::Gradient] {
            if !compiled.module.exports.contains(&export) {
                return Err(format!("the module has no function `{}`", export.name()));
            }
        }
        let size = u64::from(compiled.module.uniform_size);
        let moving = compiled.field_moves() && size > 0;
        let wgsl = wgsl(compiled, moving);
        gpu.catch(|| {
            let fields = fields_layout(gpu, compiled, moving);
            let balls = Layout::new(gpu);
            let layouts = [Some(&fields), Some(balls.balls())];
            let pipeline = gpu.compute_pipeline("surefoot contact", &wgsl, "travel", &layouts)?;
            let align = gpu.device().limits().min_uniform_buffer_offset_alignment;
            let stride = (size as u32).next_multiple_of(align.max(16));
            let moments = (size > 0).then(|| {
                gpu.device().create_buffer(&wgpu::BufferDescriptor {
                    label: Some("surefoot contact"),
                    size: u64::from(stride) * u64::from(MOST_SUBSTEPS + 1),
                    usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                    mapped_at_creation: false,
                })
            });
            let block = |binding| {
                let buffer = moments.as_ref()?;
                let resource = wgpu::BindingResource::Buffer(wgpu::BufferBinding {
                    buffer,
                    offset: 0,
                    size: wgpu::BufferSize::new(size),
                });
                Some(wgpu::BindGroupEntry { binding, resource })
            };
            let mut entries: Vec<_> = BLOCKS.into_iter().take(1 + usize::from(moving)).filter_map(block).collect();
            let tables = module::tables(gpu, &compiled.module);
            for (binding, buffer) in (1..).zip(tables.iter().flatten()) {
                entries.push(wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() });
            }
            let group = gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("surefoot contact"),
                layout: &fields,
                entries: &entries,
            });
            Ok(Self { pipeline, group, moments, stride, moving, last: Vec::new() })
        })?
    }

    /// Writes the module's block for each moment from `before` to `now`. Answers whether the field changes within the step.
    pub(super) fn write_moments(&mut self, gpu: &Gpu, compiled: &Compiled, before: &Live, now: &Live, parts: u32) -> bool {
        let Some(moments) = &self.moments else { return false };
        let compiled = compiled.ground();
        let origin = [0.0; 3];
        let last = compiled.uniform_bytes(now, origin);
        let first = compiled.uniform_bytes(before, origin);
        if !self.moving || first == last {
            if self.last != last {
                for part in 0..=MOST_SUBSTEPS {
                    gpu.queue().write_buffer(moments, u64::from(part * self.stride), &last);
                }
                self.last = last;
            }
            return false;
        }
        for part in 0..=parts {
            let live = before.between(now, f64::from(part) / f64::from(parts));
            gpu.queue().write_buffer(moments, u64::from(part * self.stride), &compiled.uniform_bytes(&live, origin));
        }
        self.last.clear();
        true
    }

    /// Sets the pipeline and the moments of a part of a step.
    pub(super) fn bind(&self, pass: &mut wgpu::ComputePass<'_>, part: u32) {
        pass.set_pipeline(&self.pipeline);
        let (now, before) = ((part + 1) * self.stride, part * self.stride);
        let offsets: &[u32] = match (&self.moments, self.moving) {
            (None, _) => &[],
            (Some(_), false) => &[now],
            (Some(_), true) => &[now, before],
        };
        pass.set_bind_group(0, &self.group, offsets);
    }
}

/// The text of the pass. Where the field moves, its functions read a private copy of the block: what is now, or what was.
fn wgsl(compiled: &Compiled, moving: bool) -> String {
    let module = &compiled.module;
    let mut code = module.code().to_owned();
    if moving {
        let name = &module.uniform_name;
        let declared = code.lines().find(|line| line.contains("var<uniform>")).map(str::to_owned);
        if let Some((declared, ty)) = declared.as_ref().and_then(|d| Some((d, d.rsplit(": ").next()?.trim_end_matches(';')))) {
            let three = format!(
                "@group(0) @binding(0) var<uniform> field_now: {ty};\n@group(0) @binding({}) var<uniform> field_before: {ty};\nvar<private> {name}: {ty};",
                BLOCKS[1]
            );
            code = code.replace(declared.as_str(), &three);
        }
    }
    let changes = match (moving, compiled.functions.carry) {
        (true, Some(_)) => [include_str!("moving.wgsl"), include_str!("carry.wgsl")].join("\n"),
        (true, None) => [include_str!("moving.wgsl"), include_str!("uncarried.wgsl")].join("\n"),
        (false, _) => include_str!("still.wgsl").to_owned(),
    };
    [&code, include_str!("ball.wgsl"), include_str!("state.wgsl"), &changes, include_str!("travel.wgsl")].join("\n")
}

fn fields_layout(gpu: &Gpu, compiled: &Compiled, moving: bool) -> wgpu::BindGroupLayout {
    let size = u64::from(compiled.module.uniform_size);
    let stage = wgpu::ShaderStages::COMPUTE;
    let entry = |binding| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: stage,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: true,
            min_binding_size: wgpu::BufferSize::new(size),
        },
        count: None,
    };
    let blocks = if size == 0 { 0 } else { 1 + usize::from(moving) };
    let mut entries: Vec<_> = BLOCKS.into_iter().take(blocks).map(entry).collect();
    if compiled.module.tables.is_some() {
        entries.extend(module::table_entries(stage));
    }
    gpu.device().create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some("surefoot contact"),
        entries: &entries,
    })
}
