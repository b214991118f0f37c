//! Buffers of the balls: their state twice, the grid, and the lists of neighbours.

use crate::gpu::Gpu;
use crate::physics::state::{BALL_SIZE, Cell, Step};
use surefoot_compiler::physics::NEIGHBOURS;

/// What the passes over balls are bound to: group 1 of each of them.
#[derive(Debug)]
pub struct Layout(wgpu::BindGroupLayout);

impl Layout {
    pub fn new(gpu: &Gpu) -> Self {
        let entry = |binding, ty| wgpu::BindGroupLayoutEntry {
            binding,
            visibility: wgpu::ShaderStages::COMPUTE,
            ty: wgpu::BindingType::Buffer { ty, has_dynamic_offset: false, min_binding_size: None },
            count: None,
        };
        let storage = |read_only| wgpu::BufferBindingType::Storage { read_only };
        let mut entries = vec![entry(0, wgpu::BufferBindingType::Uniform), entry(1, storage(true))];
        entries.extend((2..7).map(|binding| entry(binding, storage(false))));
        Self(gpu.device().create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
            label: Some("surefoot balls"),
            entries: &entries,
        }))
    }

    pub fn balls(&self) -> &wgpu::BindGroupLayout {
        &self.0
    }
}

/// The balls on the device.
#[derive(Debug)]
pub struct Balls {
    count: u32,
    /// The largest radius.
    most: f32,
    buckets: u32,
    step: wgpu::Buffer,
    /// The balls before and after a pass, by turns.
    states: [wgpu::Buffer; 2],
    counts: wgpu::Buffer,
    groups: [wgpu::BindGroup; 2],
    /// Which of the two is now.
    turn: usize,
}

impl Balls {
    pub fn new(gpu: &Gpu, layout: &Layout, cells: &[Cell]) -> Self {
        use wgpu::BufferUsages as Use;
        let count = cells.len() as u32;
        // No buffer is empty.
        let room = u64::from(count.max(1));
        let buckets = (2 * count).next_power_of_two().max(256);
        let buffer = |label, size, usage| {
            gpu.device().create_buffer(&wgpu::BufferDescriptor { label: Some(label), size, usage, mapped_at_creation: false })
        };
        let state = Use::STORAGE | Use::COPY_SRC | Use::COPY_DST | Use::VERTEX;
        let states = [(); 2].map(|()| buffer("surefoot balls", BALL_SIZE * room, state));
        for state in &states {
            gpu.queue().write_buffer(state, 0, bytemuck::cast_slice(cells));
        }
        let step = buffer("surefoot balls, step", size_of::<Step>() as u64, Use::UNIFORM | Use::COPY_DST);
        let counts = buffer("surefoot balls, counts", 4 * u64::from(buckets), Use::STORAGE | Use::COPY_DST);
        let sums = buffer("surefoot balls, sums", u64::from(buckets / 64), Use::STORAGE);
        let order = buffer("surefoot balls, order", 4 * room, Use::STORAGE);
        let lists = buffer("surefoot balls, neighbours", 4 * room * (NEIGHBOURS as u64 + 1 + 3), Use::STORAGE);
        let group = |source: usize| {
            let parts = [&step, &states[source], &states[1 - source], &counts, &sums, &order, &lists];
            let entries: Vec<_> = (0u32..)
                .zip(parts)
                .map(|(binding, part)| wgpu::BindGroupEntry { binding, resource: part.as_entire_binding() })
                .collect();
            gpu.device().create_bind_group(&wgpu::BindGroupDescriptor {
                label: Some("surefoot balls"),
                layout: layout.balls(),
                entries: &entries,
            })
        };
        let groups = [group(0), group(1)];
        let most = cells.iter().map(|c| c.radius).fold(1e-9, f32::max);
        Self { count, most, buckets, step, states, counts, groups, turn: 0 }
    }

    pub fn count(&self) -> u32 {
        self.count
    }

    /// The largest radius.
    pub fn most(&self) -> f32 {
        self.most
    }

    /// Buckets of the grid, a power of two.
    pub fn buckets(&self) -> u32 {
        self.buckets
    }

    pub fn counts(&self) -> &wgpu::Buffer {
        &self.counts
    }

    pub fn current(&self) -> &wgpu::Buffer {
        &self.states[self.turn]
    }

    /// From what is now to what is next.
    pub fn group(&self) -> &wgpu::BindGroup {
        &self.groups[self.turn]
    }

    /// What was next is now.
    pub fn trade(&mut self) {
        self.turn = 1 - self.turn;
    }

    pub fn write_step(&self, queue: &wgpu::Queue, bytes: &[u8]) {
        queue.write_buffer(&self.step, 0, bytes);
    }
}
