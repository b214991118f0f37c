//! Modules that draw the scene by themselves: a host that binds their uniforms and nothing else gets the picture that the program draws.

use crate::common::alike::{save, share_off};
use crate::common::{Disk, examples, gpu};
use surefoot_compiler::compiled::{Colors, Compiled, Entry, Module, UniformSource, Uniforms, ViewField};
use surefoot_compiler::emit::{Target, translate, validate};
use surefoot_compiler::{Loader, MemoryLoader, Options, compile};
use surefoot_runtime::Gpu;
use surefoot_runtime::headless::{Pixels, Shot, render};
use wgpu::util::DeviceExt;

const SIZE: [u32; 2] = [192, 108];
const COLOR: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;
const DEPTH: wgpu::TextureFormat = wgpu::TextureFormat::Depth32Float;

/// Lights of all kinds, fog, mirrors, a curve and an exposure, some of which follow parameters.
const AROUND: &str = "
param strength = 2 in 0..4
param high = 3 in 1..5
param density = 0.03 in 0..0.1
material glow { color: #ffd080, emission: (4, 3, 1) }
material mirror { color: #c0c8d0, roughness: 0.1, metallic: 1 }
scene = plane(y) | sphere(1).translate(0, 1, 0).material(mirror) | box(1, 1, 1).rotate(y, 0.5).translate(-2, 0.5, 0)
      | sphere(0.2).translate(1.5, 2, 1).material(glow)
light sun { direction: (0.3, -1, -0.4), intensity: strength, shadow: soft(10) }
light lamp { position: (1.5, 2, 1), color: #ffe0a0, intensity: 6, size: 0.2 }
light far { direction: (-1, -high, 0.2), intensity: 0.5, size: 2deg }
light fill { direction: (0, 1, 0), intensity: 0.2, shadow: none }
environment { sky: gradient(#203860, #a0b0c0) }
render { fog: (#c0c8d0, density), reflections: 2, exposure: 0.3, tone: agx }
";

fn drawing() -> Options {
    Options { exports: Vec::new(), entry: Entry::Draw, ..Options::default() }
}

fn compiled(path: &str, options: &Options) -> Compiled {
    compile(&Disk, path, options).compiled.unwrap_or_else(|| panic!("{path} does not compile"))
}

/// A host: the module's text, and the bytes of its uniforms.
fn picture(gpu: &Gpu, module: &Module, bytes: &[u8]) -> (Pixels, Vec<f32>) {
    let device = gpu.device();
    let shader = device.create_shader_module(wgpu::ShaderModuleDescriptor { label: None, source: wgpu::ShaderSource::Wgsl(module.code().into()) });
    let pipeline = device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: None,
        layout: None,
        vertex: wgpu::VertexState { module: &shader, entry_point: Some("sf_vertex"), compilation_options: Default::default(), buffers: &[] },
        primitive: Default::default(),
        depth_stencil: Some(wgpu::DepthStencilState {
            format: DEPTH,
            depth_write_enabled: Some(true),
            depth_compare: Some(wgpu::CompareFunction::Always),
            stencil: Default::default(),
            bias: Default::default(),
        }),
        multisample: Default::default(),
        fragment: Some(wgpu::FragmentState {
            module: &shader,
            entry_point: Some("sf_fragment"),
            compilation_options: Default::default(),
            targets: &[Some(COLOR.into())],
        }),
        multiview_mask: None,
        cache: None,
    });
    let mut contents = vec![(wgpu::BufferUsages::UNIFORM, bytes.to_vec())];
    if let Some(tables) = &module.tables {
        let rows: &[u8] = bytemuck::cast_slice(&tables.tables.rows);
        let mut rows = rows.to_vec();
        rows.resize(rows.len().max(16), 0);
        contents.extend([rows, bytemuck::cast_slice(tables.lists()).to_vec()].map(|bytes| (wgpu::BufferUsages::STORAGE, bytes)));
    }
    let buffers: Vec<wgpu::Buffer> = contents.iter().map(|(usage, contents)| device.create_buffer_init(&wgpu::util::BufferInitDescriptor { label: None, contents, usage: *usage })).collect();
    let entries: Vec<wgpu::BindGroupEntry> = (0..).zip(&buffers).map(|(binding, buffer)| wgpu::BindGroupEntry { binding, resource: buffer.as_entire_binding() }).collect();
    let group = device.create_bind_group(&wgpu::BindGroupDescriptor { label: None, layout: &pipeline.get_bind_group_layout(0), entries: &entries });
    let texture = |format| {
        device.create_texture(&wgpu::TextureDescriptor {
            label: None,
            size: wgpu::Extent3d { width: SIZE[0], height: SIZE[1], depth_or_array_layers: 1 },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format,
            usage: wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC,
            view_formats: &[],
        })
    };
    let (color, depth) = (texture(COLOR), texture(DEPTH));
    let views = [&color, &depth].map(|texture| texture.create_view(&Default::default()));
    let mut encoder = device.create_command_encoder(&Default::default());
    {
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            color_attachments: &[Some(wgpu::RenderPassColorAttachment { view: &views[0], depth_slice: None, resolve_target: None, ops: Default::default() })],
            depth_stencil_attachment: Some(wgpu::RenderPassDepthStencilAttachment {
                view: &views[1],
                depth_ops: Some(wgpu::Operations { load: wgpu::LoadOp::Clear(0.5), store: wgpu::StoreOp::Store }),
                stencil_ops: None,
            }),
            ..Default::default()
        });
        pass.set_pipeline(&pipeline);
        pass.set_bind_group(0, &group, &[]);
        pass.draw(0..3, 0..1);
    }
    let read: Vec<wgpu::Buffer> = [&color, &depth]
        .iter()
        .map(|texture| {
            let buffer = device.create_buffer(&wgpu::BufferDescriptor {
                label: None,
                size: u64::from(4 * SIZE[0] * SIZE[1]),
                usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
                mapped_at_creation: false,
            });
            let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(4 * SIZE[0]), rows_per_image: None };
            encoder.copy_texture_to_buffer(texture.as_image_copy(), wgpu::TexelCopyBufferInfo { buffer: &buffer, layout }, texture.size());
            buffer
        })
        .collect();
    gpu.queue().submit([encoder.finish()]);
    let bytes: Vec<Vec<u8>> = read
        .iter()
        .map(|buffer| {
            buffer.slice(..).map_async(wgpu::MapMode::Read, |result| result.unwrap());
            device.poll(wgpu::PollType::wait_indefinitely()).unwrap();
            buffer.slice(..).get_mapped_range().unwrap().to_vec()
        })
        .collect();
    let depth = bytes[1].chunks(4).map(|c| f32::from_le_bytes(c.try_into().unwrap())).collect();
    (Pixels { width: SIZE[0], height: SIZE[1], rgba: bytes[0].clone() }, depth)
}

/// The bytes of a scene's uniforms at the start, for a picture of our size.
fn bytes(scene: &Compiled, also: &[(ViewField, &[f32])]) -> Vec<u8> {
    let mut bytes = scene.uniform_bytes(&scene.live(), [0.0; 3]);
    let size = [(ViewField::Size, &SIZE.map(|c| c as f32)[..])];
    for (field, values) in size.iter().chain(also) {
        let uniform = scene.module.uniforms.iter().find(|uniform| uniform.source == UniformSource::View(*field)).unwrap();
        for (i, value) in values.iter().enumerate() {
            let at = uniform.offset as usize + 4 * i;
            bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
        }
    }
    bytes
}

/// Rows of such pictures end where buffers want them to.
const _: () = assert!(4 * SIZE[0] % 256 == 0);

#[test]
fn a_module_draws_what_the_program_draws() {
    let gpu = gpu();
    // Lights that move, glass, mirrors, tables, rays side by side; and what examples have only beside what no module draws.
    let names = ["still_life", "csg", "glass", "kaleidoscope", "lighthouse", "repetition"];
    let files = names.map(|name| (name, examples().into_iter().find(|(known, _)| known == name).unwrap_or_else(|| panic!("no {name}")).1));
    let camera = |rest: &str| format!("{AROUND}camera {{ eye: (3, 2.5, 6), target: (0, 0.8, 0), {rest} }}\n");
    let around = MemoryLoader::new().with("around.sdf", camera("fov: 40deg")).with("parallel.sdf", camera("projection: orthographic, height: 5"));
    for (name, path) in files.iter().map(|(name, path)| (*name, path.as_str())).chain([("around", "around.sdf"), ("parallel", "parallel.sdf")]) {
        let loader: &dyn Loader = if matches!(name, "around" | "parallel") { &around } else { &Disk };
        let of = |options: &Options| compile(loader, path, options).compiled.unwrap_or_else(|| panic!("{path} does not compile"));
        let (scene, own) = (of(&drawing()), of(&Options::default()));
        assert!(scene.module.draws, "{:?}", scene.module.skipped);
        let (drawn, depth) = picture(&gpu, &scene.module, &bytes(&scene, &[]));
        let expected = render(&gpu, &own, &own.live(), &Shot::new(SIZE[0], SIZE[1])).unwrap();
        save(&format!("draw-{name}"), &drawn);
        save(&format!("draw-{name}-own"), &expected);
        let off = share_off(&drawn, &expected);
        println!("{name}: {:.2} % off", 100.0 * off);
        // Edges differ, as the program's points are relative to the eye.
        assert!(off < 0.02, "{name}: {off}");
        assert!(depth.iter().all(|d| (0.0..=1.0).contains(d) && *d != 0.5), "{name}");
        assert!(depth.iter().any(|d| *d < 1.0), "{name}");
    }
}

#[test]
fn the_depth_is_that_of_a_projection() {
    let gpu = gpu();
    let loader = MemoryLoader::new().with("main.sdf", "scene = box(2, 2, 2)\ncamera { eye: (0, 0, 5), target: (0, 0, 0), fov: 40deg }");
    let scene = compile(&loader, "main.sdf", &drawing()).compiled.unwrap();
    let middle = (SIZE[0] * SIZE[1] / 2 + SIZE[0] / 2) as usize;
    for (near, far) in [(0.5f32, 50.0f32), (50.0, 0.5)] {
        let (_, depth) = picture(&gpu, &scene.module, &bytes(&scene, &[(ViewField::Near, &[near]), (ViewField::Far, &[far])]));
        // The face is 4 ahead.
        let expected = far * (4.0 - near) / (4.0 * (far - near));
        assert!((depth[middle] - expected).abs() < 1e-4, "{} {expected}", depth[middle]);
        assert_eq!(depth[0], if far > near { 1.0 } else { 0.0 });
    }
}

/// Texts of all forms are valid, and so are their translations.
#[test]
fn every_form_is_valid_in_every_language() {
    for (name, path) in examples() {
        for (uniforms, entry, colors) in [
            (Uniforms::Block, Entry::Draw, Colors::Screen),
            (Uniforms::Private, Entry::Draw, Colors::Linear),
            (Uniforms::Separate, Entry::Draw, Colors::Light),
            (Uniforms::Private, Entry::None, Colors::Screen),
            (Uniforms::Separate, Entry::None, Colors::Screen),
        ] {
            let options = Options { uniforms, entry, colors, prefix: "my_".into(), group: 2, binding: 3, ..Options::default() };
            let scene = compiled(&path, &options);
            let module = &scene.module;
            let what = format!("{name} {uniforms:?} {entry:?}");
            let (parsed, _) = validate(&module.wgsl).unwrap_or_else(|e| panic!("{what}: {e}"));
            assert_eq!(module.draws, entry == Entry::Draw, "{what}");
            assert_eq!(parsed.entry_points.len(), if module.draws { 2 } else { 0 }, "{what}");
            let text = module.with_buffers(&options).map_or(module.wgsl.clone(), |(module, _)| module.wgsl);
            let (parsed, _) = validate(&text).unwrap_or_else(|e| panic!("{what}: {e}"));
            let mut places: Vec<u32> = parsed.global_variables.iter().filter_map(|(_, variable)| Some(variable.binding.as_ref()?.binding)).collect();
            let count = places.len();
            places.sort_unstable();
            places.dedup();
            assert_eq!(places.len(), count, "{what}: {places:?}");
            let expected = match uniforms {
                Uniforms::Block => 1,
                Uniforms::Private => 0,
                Uniforms::Separate => module.uniforms.len(),
            };
            assert_eq!(count, expected + if module.tables.is_some() { 2 } else { 0 }, "{what}");
            for target in [Target::Glsl, Target::Glsl450, Target::Hlsl, Target::Msl, Target::Spirv] {
                if module.needs_buffers && matches!(target, Target::Glsl | Target::Glsl450) {
                    continue;
                }
                let written = translate(module, "my_", target).unwrap_or_else(|e| panic!("{what} {target:?}: {e}"));
                // The capability Linkage, which Vulkan takes none with: OpCapability, 5.
                let words: Vec<u32> = written.chunks(4).map(|w| w.iter().rev().fold(0, |word, byte| word << 8 | u32::from(*byte))).collect();
                let links = target == Target::Spirv && words.windows(2).skip(5).take(20).any(|w| w == [2 << 16 | 17, 5]);
                assert_eq!(links, target == Target::Spirv && !module.draws, "{what}");
            }
        }
    }
}

#[test]
fn a_shader_may_set_what_is_private() {
    let text = "param size = 1 in 0.5..2\nparam melt = 0.3 in 0..1\nscene = sphere(size + 0.5 * melt)";
    let options = Options { uniforms: Uniforms::Private, ..Options::default() };
    let scene = compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &options).compiled.unwrap();
    let wgsl = &scene.module.wgsl;
    assert!(wgsl.contains("var<private> sf_uniforms: sf_Uniforms = sf_Uniforms(vec3f(0.0, 0.0, 0.0), 1.0, 0.3, 0.5, 1.0);"), "{wgsl}");
    assert!(!wgsl.contains("@group"), "{wgsl}");
    // What is computed of them is computed where it is read.
    assert!(!scene.module.uniforms.iter().any(|u| matches!(u.source, UniformSource::Formula(_))), "{wgsl}");
}
