//! Writes `docs/side-by-side-fidget.md`: how long a picture of a large union takes by Surefoot, and by the crate `fidget`.
//!
//! `cargo run --release --manifest-path tests/beside_fidget/Cargo.toml docs/side-by-side-fidget.md [FOLDER]`
//!
//! Both draw the same formula: the graph that our compiler makes of the scene is handed over node by node. With a folder, the pictures too.

use fidget::jit::JitShape;
use fidget::raster::voxel::RenderConfig;
use nalgebra::{Matrix4, Rotation3, Vector3};
use std::fmt::Write;
use std::path::Path;
use std::time::Instant;
use surefoot_compiler::compiled::Compiled;
use surefoot_compiler::{MemoryLoader, Options, compile};
use surefoot_runtime::headless::{self, FORMAT, Shot};
use surefoot_runtime::{Gpu, Picture, ViewMode};

/// Side of the pictures, and of the cube of voxels.
const SIDE: u32 = 512;
/// Rounds, ours and theirs in turn; medians count.
const ROUNDS: usize = 5;
/// Half the height of what theirs shows: the cube of the scene, turned.
const HALF: f64 = 1.6;
/// Where our eye is; theirs looks from there too, without perspective.
const EYE: [f64; 3] = [2.4, 1.6, 2.8];

mod tree;

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let mut arguments = std::env::args().skip(1);
    let page = arguments.next().ok_or("which file to write?")?;
    let folder = arguments.next();
    let gpu = Gpu::headless()?;
    let scenes = [
        ("1,001 spheres, smoothly joined", include_str!("../../corpus/large/spheres.sdf")),
        ("186 rounded boxes in a tree of smooth unions", include_str!("../../corpus/large/boxes.sdf")),
    ];
    let mut rows = String::new();
    for (name, text) in scenes {
        let mut times = vec![Times::default(); ROUNDS];
        for (round, time) in times.iter_mut().enumerate() {
            eprintln!("{name}: round {} of {ROUNDS}", round + 1);
            let pictures = folder.as_deref().filter(|_| round == 0).map(|f| (Path::new(f), name));
            *time = measure(&gpu, text, pictures)?;
        }
        let median = |of: fn(&Times) -> f64| {
            let mut found: Vec<f64> = times.iter().map(of).collect();
            found.sort_by(f64::total_cmp);
            found[ROUNDS / 2]
        };
        let (first, rays) = (median(|t| t.first), median(|t| t.rays));
        let (whole, theirs) = (median(|t| t.their_whole), median(|t| t.their_picture));
        let _ = writeln!(
            rows,
            "| {name} | {first:.0} | {rays:.0} | {whole:.0} | {theirs:.0} | {:.1} | {:.1} |",
            whole / first,
            theirs / rays
        );
    }
    let text = format!(
        "# Side by side with fidget\n\n\
         Written by `cargo run --release --manifest-path tests/beside_fidget/Cargo.toml {page}`, with `fidget` 0.5.0.\n\n\
         Both draw the same formula on the same machine with {} threads, {ROUNDS} rounds in turn; medians in milliseconds. Ours: {SIDE}×{SIDE} pixels on {}, \
         *first* from the text to the picture with a soft shadow and occlusion, *rays* the eye's rays and the normals alone once the scene \
         is there. Theirs: {SIDE}×{SIDE}×{SIDE} voxels with depth and normals, by machine code (`JitShape`), from the same side without perspective; \
         *whole* from the tree of the formula on, *picture* once the shape is there.\n\n\
         | scene | first | rays | theirs, whole | theirs, picture | whole / first | picture / rays |\n|---|---:|---:|---:|---:|---:|---:|\n{rows}",
        std::thread::available_parallelism().map_or(1, usize::from),
        gpu.name()
    );
    print!("{text}");
    std::fs::write(page, text)?;
    Ok(())
}

/// Milliseconds.
#[derive(Clone, Copy, Default)]
struct Times {
    first: f64,
    rays: f64,
    their_whole: f64,
    their_picture: f64,
}

fn milliseconds(since: Instant) -> f64 {
    1e3 * since.elapsed().as_secs_f64()
}

fn measure(gpu: &Gpu, text: &str, pictures: Option<(&Path, &str)>) -> Result<Times, Failure> {
    let mut times = Times::default();
    let start = Instant::now();
    let scene = compiled(text)?;
    let ours = draw(gpu, &mut Picture::prepare(gpu, &scene, FORMAT, ViewMode::Shaded)?, &scene)?;
    times.first = milliseconds(start);
    let bare = compiled(&text.replace("soft(16)", "none").replace("camera", "render { ambient_occlusion: (0, 0) }\ncamera"))?;
    let mut picture = Picture::prepare(gpu, &bare, FORMAT, ViewMode::Shaded)?;
    draw(gpu, &mut picture, &bare)?;
    let start = Instant::now();
    draw(gpu, &mut picture, &bare)?;
    times.rays = milliseconds(start);

    let tree = tree::tree(&scene.graph, scene.root)?;
    let start = Instant::now();
    let shape = JitShape::from(tree);
    let none = Default::default();
    let bound = shape.bind(&none)?;
    let built = milliseconds(start);
    let start = Instant::now();
    let config = RenderConfig { world_to_model: view(), ..RenderConfig::from_size(SIDE.into()) };
    let theirs = config.run(bound).ok_or("fidget drew nothing")?;
    times.their_picture = milliseconds(start);
    times.their_whole = built + times.their_picture;
    if let Some((folder, name)) = pictures {
        std::fs::create_dir_all(folder)?;
        let name = name.replace([' ', ','], "-");
        image::save_buffer(folder.join(format!("{name}-ours.png")), &ours, SIDE, SIDE, image::ColorType::Rgba8)?;
        let colors: Vec<u8> = theirs.iter().flat_map(|pixel| if pixel.depth > 0 { pixel.to_color() } else { [0; 3] }).collect();
        image::save_buffer(folder.join(format!("{name}-theirs.png")), &colors, SIDE, SIDE, image::ColorType::Rgb8)?;
    }
    Ok(times)
}

fn compiled(text: &str) -> Result<Compiled, Failure> {
    let loader = MemoryLoader::new().with("scene.sdf", text);
    compile(&loader, "scene.sdf", &Options::default()).compiled.ok_or_else(|| "the scene does not compile".into())
}

fn draw(gpu: &Gpu, picture: &mut Picture, scene: &Compiled) -> Result<Vec<u8>, Failure> {
    Ok(headless::render_with(gpu, picture, scene, &scene.live(), &Shot::new(SIDE, SIDE))?.rgba)
}

/// From what theirs draws, −1 to 1 and seen along −z, to the scene.
fn view() -> Matrix4<f32> {
    let toward = Vector3::from(EYE.map(|c| c as f32));
    let turned = Rotation3::face_towards(&toward, &Vector3::y());
    turned.to_homogeneous() * Matrix4::new_scaling(HALF as f32)
}

