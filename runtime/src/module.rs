//! What an emitted module reads, as a bind group: its uniform block and, where it has large unions, their tables.

use crate::gpu::Gpu;
use surefoot_compiler::compiled::{Compiled, Module};

/// The layout of a module's group.
pub(crate) fn layout(gpu: &Gpu, module: &Module, visibility: wgpu::ShaderStages) -> wgpu::BindGroupLayout {
    let buffer = |binding, ty, size| wgpu::BindGroupLayoutEntry {
        binding,
        visibility,
        ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: wgpu::BufferSize::new(size) },
        count: None,
    };
    let mut entries = Vec::new();
    if module.uniform_size > 0 {
        entries.push(buffer(0, wgpu::BufferBindingType::Uniform, module.uniform_size.into()));
    }
    if module.tables.is_some() {
        entries.extend(table_entries(visibility));
    }
    gpu.device().create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some("surefoot module"), entries: &entries })
}

/// The entries of a module's tables.
pub(crate) fn table_entries(visibility: wgpu::ShaderStages) -> [wgpu::BindGroupLayoutEntry; 2] {
    [1, 2].map(|binding| wgpu::BindGroupLayoutEntry {
        binding,
        visibility,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only: true },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    })
}

/// The tables of a module in buffers, where it has some: rows and lists.
pub(crate) fn tables(gpu: &Gpu, module: &Module) -> Option<[wgpu::Buffer; 2]> {
    let tables = module.tables.as_ref()?;
    let rows: &[u8] = bytemuck::cast_slice(&tables.tables.rows);
    let lists: &[u8] = bytemuck::cast_slice(tables.lists());
    Some([rows, lists].map(|bytes| {
        let buffer = gpu.device().create_buffer(&wgpu::BufferDescriptor {
            label: Some("surefoot tables"),
            // No buffer may be empty.
            size: bytes.len().max(16) as u64,
            usage: wgpu::BufferUsages::STORAGE | wgpu::BufferUsages::COPY_DST,
            mapped_at_creation: false,
        });
        gpu.queue().write_buffer(&buffer, 0, bytes);
        buffer
    }))
}

/// A module's group, and the bytes of its uniform block that were written last.
#[derive(Debug)]
pub(crate) struct ModuleGroup {
    uniforms: Option<wgpu::Buffer>,
    group: wgpu::BindGroup,
    written: Vec<u8>,
}

impl ModuleGroup {
    /// For a module, with the layout that [`layout`] gives it.
    pub fn new(gpu: &Gpu, compiled: &Compiled, layout: &wgpu::BindGroupLayout) -> Self {
        let module = &compiled.module;
        let uniforms = (module.uniform_size > 0).then(|| {
            gpu.device().create_buffer(&wgpu::BufferDescriptor {
                label: Some("surefoot module"),
                size: module.uniform_size.into(),
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        });
        let tables = tables(gpu, module);
        let uniform = uniforms.iter().map(|buffer| (0, buffer));
        let others = tables.iter().flatten().zip(1..).map(|(buffer, binding)| (binding, buffer));
        let entries: Vec<_> = uniform
            .chain(others)
            .map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() })
            .collect();
        let group = gpu.device().create_bind_group(&wgpu::BindGroupDescriptor { label: Some("surefoot module"), layout, entries: &entries });
        Self { uniforms, group, written: Vec::new() }
    }

    /// Writes the bytes of the uniform block unless they are there already; answers whether they were new.
    pub fn write(&mut self, queue: &wgpu::Queue, bytes: &[u8]) -> bool {
        let Some(buffer) = self.uniforms.as_ref().filter(|_| self.written != bytes) else { return false };
        // Never more than the buffer holds: that would be an error of the device.
        queue.write_buffer(buffer, 0, bytes.get(..buffer.size() as usize).unwrap_or(bytes));
        self.written = bytes.to_vec();
        true
    }

    /// The group.
    pub fn group(&self) -> &wgpu::BindGroup {
        &self.group
    }
}
