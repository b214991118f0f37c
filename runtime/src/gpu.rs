//! The graphics device: found here, or handed over by a program that has one. Everything that builds a pipeline goes through it, so
//! that each one is counted and each error comes back as text.

use crate::copied_block::with_copied_block;
use std::borrow::Cow;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

/// There is no graphics adapter, or it gives no device; the text says which and why.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct NoAdapter(pub String);

impl std::fmt::Display for NoAdapter {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "no graphics adapter: {}", self.0)
    }
}

impl std::error::Error for NoAdapter {}

/// What was built so far on one [`Gpu`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stats {
    /// Shader modules that were read, checked and translated.
    pub modules: u64,
    /// Pipelines built.
    pub pipelines: u64,
    /// Pipelines that were wanted again and were still there.
    pub reused: u64,
    /// Time that all of it took.
    pub building: Duration,
}

#[derive(Debug, Default)]
struct Counters {
    modules: AtomicU64,
    pipelines: AtomicU64,
    reused: AtomicU64,
    nanoseconds: AtomicU64,
}

/// A pipeline that is kept in case the same one is wanted again.
#[derive(Debug)]
struct Kept {
    key: PipelineKey,
    pipeline: wgpu::RenderPipeline,
}

/// All that decides what a pipeline over the screen does.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct PipelineKey {
    /// The whole text.
    pub wgsl: String,
    /// Values of the text's `override` constants.
    pub constants: Vec<(&'static str, f64)>,
    /// What it draws on; nothing where it draws depth alone.
    pub format: Option<wgpu::TextureFormat>,
    /// Names of the entry points.
    pub entries: [&'static str; 2],
    /// How its depth is compared with what is there, where there is depth at all.
    pub depth: Option<wgpu::CompareFunction>,
    /// How what it draws lies in its buffer: corners, where they come out of one.
    pub corners: Option<wgpu::VertexBufferLayout<'static>>,
}

/// Format of the depth that passes share: 1 at the near plane, 0 at infinity.
pub(crate) const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// How a shader reads such a depth: as numbers, one texel at a time. OpenGL has no such reading of what is bound as a depth.
pub(crate) const DEPTH_AS_READ: wgpu::TextureSampleType = wgpu::TextureSampleType::Float { filterable: false };

/// How many pipelines are kept: enough to switch a choice back and forth, few enough to forget what was typed a minute ago.
const KEPT: usize = 32;

/// A device with its queue. Copies share the device, the counters and what is kept.
#[derive(Clone, Debug)]
pub struct Gpu {
    device: wgpu::Device,
    queue: wgpu::Queue,
    name: Arc<str>,
    software: bool,
    counters: Arc<Counters>,
    kept: Arc<Mutex<Vec<Kept>>>,
}

impl Gpu {
    /// A device of its own, without a window. The environment variables of wgpu (`WGPU_BACKEND`, …) choose among several.
    pub fn headless() -> Result<Self, NoAdapter> {
        pollster::block_on(Self::headless_later())
    }

    /// As [`Gpu::headless`], for programs that must not block.
    pub async fn headless_later() -> Result<Self, NoAdapter> {
        let instance =
            wgpu::Instance::new(wgpu::InstanceDescriptor::new_without_display_handle_from_env());
        let options = wgpu::RequestAdapterOptions {
            power_preference: wgpu::PowerPreference::HighPerformance,
            ..Default::default()
        };
        let adapter =
            instance.request_adapter(&options).await.map_err(|e| NoAdapter(e.to_string()))?;
        let (device, queue) = adapter
            .request_device(&Self::device_descriptor(&adapter))
            .await
            .map_err(|e| NoAdapter(e.to_string()))?;
        Ok(Self::from_parts(device, queue))
    }

    /// What to ask of an adapter: the limits that every WebGPU offers where it has them, and timestamps where it has them.
    pub fn device_descriptor(adapter: &wgpu::Adapter) -> wgpu::DeviceDescriptor<'static> {
        let best = adapter.limits();
        let limits = if wgpu::Limits::default().check_limits(&best) {
            wgpu::Limits::default()
        } else {
            wgpu::Limits::downlevel_defaults()
        };
        wgpu::DeviceDescriptor {
            label: Some("surefoot"),
            required_features: adapter.features() & wgpu::Features::TIMESTAMP_QUERY,
            required_limits: limits.using_resolution(best.clone()).using_alignment(best),
            ..Default::default()
        }
    }

    /// A device that another program made: a window's, an engine's.
    pub fn from_parts(device: wgpu::Device, queue: wgpu::Queue) -> Self {
        let info = device.adapter_info();
        Self {
            name: info.name.into(),
            software: info.device_type == wgpu::DeviceType::Cpu,
            device,
            queue,
            counters: Arc::default(),
            kept: Arc::default(),
        }
    }

    /// The device.
    pub fn device(&self) -> &wgpu::Device {
        &self.device
    }

    /// Its queue.
    pub fn queue(&self) -> &wgpu::Queue {
        &self.queue
    }

    /// The adapter's name, for people.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Its name, what it is driven through, and the driver's version, for people.
    pub fn described(&self) -> String {
        let info = self.device.adapter_info();
        let driver = [info.driver, info.driver_info].join(" ");
        format!("{}, {:?}, {}", info.name, info.backend, if driver.trim().is_empty() { "an unnamed driver" } else { driver.trim() })
    }

    /// What makes its machine code: adapter and driver with their versions, for comparison.
    pub(crate) fn driver(&self) -> (wgpu::Backend, String, String) {
        let info = self.device.adapter_info();
        (info.backend, info.name, info.driver_info)
    }

    /// Whether it is OpenGL, where wgpu fixes what a texture can be read as by the number of its layers, and can't read a cube as its faces.
    pub(crate) fn is_gl(&self) -> bool {
        self.driver().0 == wgpu::Backend::Gl
    }

    /// How many layers a square texture needs that is read as an array of so many.
    pub(crate) fn array_layers(&self, wanted: u32) -> u32 {
        match (self.is_gl(), wanted) {
            (true, 0 | 1) => 2,
            // Six are taken for a cube.
            (true, cubes) if cubes.is_multiple_of(6) => cubes + 1,
            _ => wanted,
        }
    }

    /// Whether it is a program and no hardware: its times say nothing about graphics cards.
    pub fn is_software(&self) -> bool {
        self.software
    }

    /// What was built so far.
    pub fn stats(&self) -> Stats {
        let read = |counter: &AtomicU64| counter.load(Ordering::Relaxed);
        Stats {
            modules: read(&self.counters.modules),
            pipelines: read(&self.counters.pipelines),
            reused: read(&self.counters.reused),
            building: Duration::from_nanos(read(&self.counters.nanoseconds)),
        }
    }

    /// A pipeline that draws triangles: a mesh's, one over the screen, or two for each instance. One that was built before is taken again.
    pub(crate) fn screen_pipeline(
        &self,
        label: &str,
        key: PipelineKey,
        layouts: &[Option<&wgpu::BindGroupLayout>],
    ) -> Result<wgpu::RenderPipeline, String> {
        if let Some(pipeline) = self.kept(&key) {
            self.counters.reused.fetch_add(1, Ordering::Relaxed);
            return Ok(pipeline);
        }
        let targets: Vec<_> = key.format.iter().map(|format| Some((*format).into())).collect();
        let pipeline = self.build(|| {
            let module = self.module(label, &key.wgsl);
            let compilation_options = wgpu::PipelineCompilationOptions {
                constants: &key.constants,
                ..Default::default()
            };
            self.device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
                label: Some(label),
                layout: Some(&self.layout(label, layouts)),
                vertex: wgpu::VertexState {
                    module: &module,
                    entry_point: Some(key.entries[0]),
                    compilation_options: compilation_options.clone(),
                    buffers: if key.corners.is_some() { std::slice::from_ref(&key.corners) } else { &[] },
                },
                primitive: wgpu::PrimitiveState::default(),
                depth_stencil: key.depth.map(|compare| wgpu::DepthStencilState {
                    format: DEPTH,
                    depth_write_enabled: Some(true),
                    depth_compare: Some(compare),
                    stencil: Default::default(),
                    bias: Default::default(),
                }),
                multisample: wgpu::MultisampleState::default(),
                fragment: Some(wgpu::FragmentState {
                    module: &module,
                    entry_point: Some(key.entries[1]),
                    compilation_options,
                    targets: &targets,
                }),
                multiview_mask: None,
                cache: None,
            })
        })?;
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        if kept.len() >= KEPT {
            kept.remove(0);
        }
        kept.push(Kept { key, pipeline: pipeline.clone() });
        Ok(pipeline)
    }

    /// A compute pipeline.
    pub(crate) fn compute_pipeline(
        &self,
        label: &str,
        wgsl: &str,
        entry_point: &str,
        layouts: &[Option<&wgpu::BindGroupLayout>],
    ) -> Result<wgpu::ComputePipeline, String> {
        self.build(|| {
            let module = self.module(label, wgsl);
            self.device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
                label: Some(label),
                layout: Some(&self.layout(label, layouts)),
                module: &module,
                entry_point: Some(entry_point),
                compilation_options: Default::default(),
                cache: None,
            })
        })
    }

    /// Does something with the device; what the device finds wrong in it comes back as text. Nothing reaches the handler of
    /// uncaptured errors, which would end the program.
    pub fn catch<T>(&self, work: impl FnOnce() -> T) -> Result<T, String> {
        let memory = self.device.push_error_scope(wgpu::ErrorFilter::OutOfMemory);
        let internal = self.device.push_error_scope(wgpu::ErrorFilter::Internal);
        let validation = self.device.push_error_scope(wgpu::ErrorFilter::Validation);
        let result = work();
        // They end in the reverse order. Natively the answers are there at once.
        let errors = [validation, internal, memory].map(|scope| pollster::block_on(scope.pop()));
        match errors.into_iter().flatten().next() {
            None => Ok(result),
            Some(error) => Err(error.to_string()),
        }
    }

    /// The pipeline of a key if it is still there; it becomes the newest.
    fn kept(&self, key: &PipelineKey) -> Option<wgpu::RenderPipeline> {
        let mut kept = self.kept.lock().unwrap_or_else(PoisonError::into_inner);
        let at = kept.iter().position(|k| k.key == *key)?;
        let found = kept.remove(at);
        let pipeline = found.pipeline.clone();
        kept.push(found);
        Some(pipeline)
    }

    fn build<T>(&self, work: impl FnOnce() -> T) -> Result<T, String> {
        let start = Instant::now();
        let built = self.catch(work);
        let took = u64::try_from(start.elapsed().as_nanos()).unwrap_or(u64::MAX);
        self.counters.nanoseconds.fetch_add(took, Ordering::Relaxed);
        if built.is_ok() {
            self.counters.pipelines.fetch_add(1, Ordering::Relaxed);
        }
        built
    }

    fn layout(
        &self,
        label: &str,
        layouts: &[Option<&wgpu::BindGroupLayout>],
    ) -> wgpu::PipelineLayout {
        self.device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
            label: Some(label),
            bind_group_layouts: layouts,
            immediate_size: 0,
        })
    }

    fn module(&self, label: &str, wgsl: &str) -> wgpu::ShaderModule {
        self.counters.modules.fetch_add(1, Ordering::Relaxed);
        let wgsl = if self.software { with_copied_block(wgsl) } else { Cow::Borrowed(wgsl) };
        let descriptor = wgpu::ShaderModuleDescriptor { label: Some(label), source: wgpu::ShaderSource::Wgsl(wgsl) };
        let checks = wgpu::ShaderRuntimeChecks {
            force_loop_bounding: false,
            ..wgpu::ShaderRuntimeChecks::checked()
        };
        // SAFETY: of all checks only the counter in each loop is left out. Every loop in an emitted module and in a fixed pass counts
        // up to a bound that is fixed before it begins; so none is infinite, which is what the caller must promise.
        #[allow(unsafe_code)]
        unsafe {
            self.device.create_shader_module_trusted(descriptor, checks)
        }
    }
}

/// A layout of one uniform block for the fragments, or of nothing where a module has no block.
pub(crate) fn uniform_layout(
    gpu: &Gpu,
    label: &str,
    size: u64,
    visibility: wgpu::ShaderStages,
) -> wgpu::BindGroupLayout {
    let entry = wgpu::BindGroupLayoutEntry {
        binding: 0,
        visibility,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Uniform,
            has_dynamic_offset: false,
            min_binding_size: wgpu::BufferSize::new(size),
        },
        count: None,
    };
    gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some(label),
        entries: if size == 0 { &[] } else { std::slice::from_ref(&entry) },
    })
}

/// A layout of so many storage buffers that are read.
pub(crate) fn storage_layout(gpu: &Gpu, label: &str, visibility: wgpu::ShaderStages, count: u32) -> wgpu::BindGroupLayout {
    let ty = wgpu::BindingType::Buffer {
        ty: wgpu::BufferBindingType::Storage { read_only: true },
        has_dynamic_offset: false,
        min_binding_size: None,
    };
    let entries: Vec<_> = (0..count).map(|binding| wgpu::BindGroupLayoutEntry { binding, visibility, ty, count: None }).collect();
    gpu.device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

/// A uniform block on the GPU, its bind group, and the bytes that were written last.
#[derive(Debug)]
pub(crate) struct UniformBlock {
    buffer: Option<wgpu::Buffer>,
    group: wgpu::BindGroup,
    written: Vec<u8>,
}

impl UniformBlock {
    /// A block of so many bytes; of none where a module has no block.
    pub fn new(gpu: &Gpu, label: &str, layout: &wgpu::BindGroupLayout, size: u64) -> Self {
        let buffer = (size > 0).then(|| {
            gpu.device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size,
                usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
                mapped_at_creation: false,
            })
        });
        let entry = buffer
            .as_ref()
            .map(|b| wgpu::BindGroupEntry { binding: 0, resource: b.as_entire_binding() });
        let group = gpu.device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(label),
            layout,
            entries: entry.as_slice(),
        });
        Self { buffer, group, written: Vec::new() }
    }

    /// Writes the bytes unless they are there already; answers whether they were new.
    pub fn write(&mut self, queue: &wgpu::Queue, bytes: &[u8]) -> bool {
        let Some(buffer) = &self.buffer else { return false };
        // Never more than the buffer holds: that would be an error of the device.
        let bytes = bytes.get(..buffer.size() as usize).unwrap_or(bytes);
        if self.written == bytes {
            return false;
        }
        queue.write_buffer(buffer, 0, bytes);
        self.written = bytes.to_vec();
        true
    }

    /// The buffer, where there is one.
    pub fn buffer(&self) -> Option<&wgpu::Buffer> {
        self.buffer.as_ref()
    }

    /// Its bind group.
    pub fn group(&self) -> &wgpu::BindGroup {
        &self.group
    }
}

/// The layout of a group for a compute pass that reads the storage buffer at binding 0 and writes the one at 1.
pub(crate) fn in_and_out_layout(gpu: &Gpu, label: &str) -> wgpu::BindGroupLayout {
    let entry = |binding, read_only| wgpu::BindGroupLayoutEntry {
        binding,
        visibility: wgpu::ShaderStages::COMPUTE,
        ty: wgpu::BindingType::Buffer {
            ty: wgpu::BufferBindingType::Storage { read_only },
            has_dynamic_offset: false,
            min_binding_size: None,
        },
        count: None,
    };
    gpu.device().create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor {
        label: Some(label),
        entries: &[entry(0, true), entry(1, false)],
    })
}

/// What a pass with depth is begun with: nothing is nearer than infinity, and nobody needs it after.
pub fn depth_attachment(view: &wgpu::TextureView) -> wgpu::RenderPassDepthStencilAttachment<'_> {
    wgpu::RenderPassDepthStencilAttachment {
        view,
        depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.0), store: wgpu::StoreOp::Discard }),
        stencil_ops: None,
    }
}
