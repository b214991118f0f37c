//! Pictures without a window: on the graphics adapter where there is one, else on the processor's cores.

use crate::files;
use std::path::Path;
use surefoot_compiler::compiled::{Camera, Compiled, Live};
use surefoot_compiler::diagnostic::Diagnostic;
use surefoot_compiler::reference::View;
use surefoot_compiler::section::Cut;
#[cfg(feature = "gpu")]
use surefoot_runtime::Showing;

/// What a picture shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Mode {
    /// The scene in its light.
    #[default]
    Shaded,
    /// The surface's normals, as colours.
    Normals,
    /// How many steps a ray takes.
    Steps,
    /// How many operations a ray takes, by the logarithm: dark is few. On the processor each look counts as all of the formula.
    Operations,
    /// How far the surface is.
    Depth,
    /// How steep the field is at the surface: grey as a distance, red steeper, blue flatter.
    Gradient,
    /// What of the distance a ray may go right above the surface: grey all of it, red and dark less.
    Factor,
    /// How much of the sky's light arrives.
    Occlusion,
    /// How much of the lights arrives.
    Shadow,
}

impl From<Mode> for View {
    fn from(mode: Mode) -> Self {
        match mode {
            Mode::Shaded => Self::Shaded,
            Mode::Normals => Self::Normals,
            Mode::Steps => Self::Steps,
            Mode::Operations => Self::Operations,
            Mode::Depth => Self::Depth,
            Mode::Gradient => Self::Gradient,
            Mode::Factor => Self::Factor,
            Mode::Occlusion => Self::Occlusion,
            Mode::Shadow => Self::Shadow,
        }
    }
}

/// What draws.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Device {
    /// The graphics adapter where there is one, else the processor.
    #[default]
    Auto,
    /// The processor.
    Cpu,
    /// The graphics adapter.
    Gpu,
}

/// One picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shot {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// The first row that is drawn, and the one after the last.
    pub rows: [u32; 2],
    /// From where.
    pub camera: Camera,
}

impl Shot {
    /// All of a picture.
    pub fn new((width, height): (u32, u32), camera: Camera) -> Self {
        Self { width, height, rows: [0, height], camera }
    }
}

/// Something that draws a scene again and again.
pub enum Painter {
    /// The graphics adapter.
    #[cfg(feature = "gpu")]
    Gpu(Box<gpu::Painter>),
    /// The processor.
    Cpu(cpu::Painter),
}

/// Why there is no painter.
#[derive(Debug)]
pub enum NoPainter {
    /// No graphics adapter, and the processor is not wanted.
    NoGraphics(String),
    /// The adapter refuses the scene's shader.
    #[cfg_attr(not(feature = "gpu"), expect(dead_code, reason = "the processor takes every scene"))]
    Refused(String),
}

impl Painter {
    /// A painter on the wanted device, and what a person should know about it. `section`: how a plane cuts its pictures open, whose place is of
    /// each moment. A picture is made of so many samples; left out, of as many as are soon drawn.
    pub fn new(
        device: Device,
        compiled: &Compiled,
        view: View,
        section: Option<Cut>,
        samples: Option<u32>,
    ) -> Result<(Self, Option<String>), NoPainter> {
        #[cfg(not(feature = "gpu"))]
        let _ = section;
        if device == Device::Cpu {
            let left_out = [(compiled.has_meshes(), "meshes"), (compiled.has_balls(), "balls")];
            let left_out: Vec<&str> = left_out.into_iter().filter_map(|(has, what)| has.then_some(what)).collect();
            let note = (!left_out.is_empty()).then(|| format!("on the processor a picture leaves out {}", left_out.join(" and ")));
            return Ok((Self::Cpu(cpu::Painter::new(compiled, view, samples)), note));
        }
        #[cfg(feature = "gpu")]
        let missing = match surefoot_runtime::Gpu::headless() {
            Ok(gpu) => match gpu::Painter::new(gpu, compiled, Showing { view, section, beside: None }, samples) {
                Ok(painter) => {
                    let note = painter.is_software().then(|| format!("the adapter is a program: {}", painter.name()));
                    return Ok((Self::Gpu(Box::new(painter)), note));
                }
                Err(words) if device == Device::Gpu => return Err(NoPainter::Refused(words)),
                Err(words) => format!("the adapter refuses this scene: {words}"),
            },
            Err(missing) => missing.to_string(),
        };
        #[cfg(not(feature = "gpu"))]
        let missing = {
            "this program was built without graphics".to_owned()
        };
        match device {
            Device::Gpu => Err(NoPainter::NoGraphics(missing)),
            _ => {
                let left_out = "such a picture leaves out meshes and balls";
                Ok((
                    Self::Cpu(cpu::Painter::new(compiled, view, samples)),
                    Some(format!("{missing}; drawing on the processor ({left_out})")),
                ))
            }
        }
    }

    /// What is wrong with the scene's meshes: those are not drawn.
    pub fn broken(&self) -> &[Diagnostic] {
        match self {
            #[cfg(feature = "gpu")]
            Self::Gpu(painter) => painter.broken(),
            Self::Cpu(painter) => painter.broken(),
        }
    }

    /// What a picture is made of, as a table for people.
    pub fn explain(&mut self, compiled: &Compiled, live: &Live, shot: &Shot) -> Result<String, String> {
        match self {
            #[cfg(feature = "gpu")]
            Self::Gpu(painter) => painter.explain(compiled, live, shot),
            Self::Cpu(_) => {
                let _ = (compiled, live, shot);
                Err("on the processor a picture has no passes to explain".to_owned())
            }
        }
    }

    /// Rows of pixels from the top: red, green, blue (sRGB), opacity. `progress` hears the parts of the picture as they are done.
    pub fn paint(
        &mut self,
        compiled: &Compiled,
        live: &Live,
        shot: &Shot,
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Vec<u8>, String> {
        match self {
            #[cfg(feature = "gpu")]
            Self::Gpu(painter) => {
                let pixels = painter.paint(compiled, live, shot, progress);
                progress(1.0);
                pixels
            }
            Self::Cpu(painter) => painter.paint(compiled, live, shot, progress),
        }
    }
}

/// What is wrong with the meshes of a scene, at its places in the text. Nothing is known where the program is built without graphics.
pub fn broken_meshes(compiled: &Compiled) -> Vec<Diagnostic> {
    #[cfg(feature = "gpu")]
    return surefoot_runtime::mesh::Assets::checking().load(&files::FileLoader, compiled, &|_, _, _| {});
    #[cfg(not(feature = "gpu"))]
    {
        let _ = compiled;
        Vec::new()
    }
}

/// So many samples make a picture where nobody says how many: many where they are soon drawn, four times as many through a lens, one where the
/// picture is a measurement.
fn samples(compiled: &Compiled, view: View, quick: bool) -> u32 {
    let through = if compiled.blocks.cameras.iter().any(|camera| camera.lens.is_some()) { 4 } else { 1 };
    match (view, quick) {
        (View::Shaded, true) => 16 * through,
        (View::Shaded, false) => 4 * through,
        _ => 1,
    }
}

/// Writes a PNG file, to stdout where its path is `-`.
pub fn write_png(path: &Path, width: u32, height: u32, rgba: &[u8]) -> Result<(), String> {
    use image::ImageEncoder;
    use std::io::Write;
    let mut bytes = Vec::new();
    image::codecs::png::PngEncoder::new(&mut bytes)
        .write_image(rgba, width, height, image::ExtendedColorType::Rgba8)
        .map_err(|error| error.to_string())?;
    if path.as_os_str() == "-" {
        return std::io::stdout().write_all(&bytes).map_err(|error| error.to_string());
    }
    files::write(path, &bytes)
}

#[cfg(feature = "gpu")]
mod gpu {
    //! On the graphics adapter.

    use super::{Compiled, Diagnostic, Live, Shot, Showing, files};
    use surefoot_runtime::headless;
    use surefoot_runtime::mesh::Assets;
    use surefoot_runtime::physics::{Physics, STEP};
    use surefoot_runtime::{Gpu, Picture};

    /// A device with a scene's pipeline.
    pub struct Painter {
        gpu: Gpu,
        picture: Picture,
        balls: Option<Balls>,
        broken: Vec<Diagnostic>,
        samples: u32,
    }

    /// The balls at a moment of the scene's clock, which begins with them.
    struct Balls {
        physics: Physics,
        time: f64,
    }

    impl Painter {
        pub fn new(gpu: Gpu, compiled: &Compiled, showing: Showing, samples: Option<u32>) -> Result<Self, String> {
            let view = showing.view;
            let samples = samples.unwrap_or(super::samples(compiled, view, !gpu.is_software()));
            let format = headless::format(compiled, view, samples);
            let mut picture = Picture::prepare(&gpu, compiled, format, showing)?;
            let mut assets = Assets::new();
            let broken = assets.load(&files::FileLoader, compiled, &|_, _, _| {});
            picture.show_meshes(&assets.meshes(compiled))?;
            picture.show_images(assets.images());
            Ok(Self { gpu, picture, balls: None, broken, samples })
        }

        pub fn broken(&self) -> &[Diagnostic] {
            &self.broken
        }

        /// Lets the balls fall until the moment of the picture; from the start, where they are beyond it. `progress` hears how much of that is done.
        fn show_balls(&mut self, compiled: &Compiled, live: &Live, progress: &(dyn Fn(f64) + Sync)) -> Result<(), String> {
            let known = self.balls.take().filter(|balls| balls.time <= live.time);
            let begun = |physics| Balls { physics, time: 0.0 };
            self.balls = match known {
                Some(balls) => Some(balls),
                None => Physics::prepare(&self.gpu, compiled, live)?.map(begun),
            };
            if let Some(Balls { physics, time }) = &mut self.balls {
                let start = *time;
                let steps = ((live.time - start) / STEP + 1e-6).floor() as u32;
                for step in 1..=steps {
                    let now = Live { time: start + f64::from(step) * STEP, ..live.clone() };
                    physics.advance(compiled, &now, STEP, 1)?;
                    // Not more than a few at once are in the queue of a slow device.
                    if step % 16 == 0 {
                        physics.wait()?;
                        progress(f64::from(step) / f64::from(steps));
                    }
                }
                *time = start + f64::from(steps) * STEP;
            }
            let physics = self.balls.as_ref().map(|balls| &balls.physics);
            self.picture.show_balls(compiled, live, physics);
            Ok(())
        }

        pub fn name(&self) -> &str {
            self.gpu.name()
        }

        pub fn is_software(&self) -> bool {
            self.gpu.is_software()
        }

        /// The frame as a table. The balls are those of the picture drawn last.
        pub fn explain(&mut self, compiled: &Compiled, live: &Live, shot: &Shot) -> Result<String, String> {
            let wanted = headless::Shot { camera: Some(shot.camera), ..headless::Shot::new(shot.width, shot.height) };
            let explained = surefoot_runtime::explain::explain(&self.gpu, &mut self.picture, compiled, live, &wanted)?;
            let mut text = format!("adapter      {}\n", self.gpu.described());
            for pass in explained.passes {
                let milliseconds = pass.time.as_secs_f64() * 1e3;
                text += &format!("{:<12}{milliseconds:>9.2} ms  {:<16}{}\n", pass.name, pass.size, pass.reason);
            }
            text += "left out:\n";
            for (what, why) in explained.left_out {
                text += &format!("  {what}: {why}\n");
            }
            Ok(text)
        }

        pub fn paint(
            &mut self,
            compiled: &Compiled,
            live: &Live,
            shot: &Shot,
            progress: &(dyn Fn(f64) + Sync),
        ) -> Result<Vec<u8>, String> {
            self.show_balls(compiled, live, progress)?;
            let wanted = headless::Shot {
                camera: Some(shot.camera),
                samples: self.samples,
                rows: shot.rows,
                ..headless::Shot::new(shot.width, shot.height)
            };
            headless::render_with(&self.gpu, &mut self.picture, compiled, live, &wanted)
                .map(|pixels| pixels.rgba)
        }
    }
}

mod cpu {
    //! On the processor's cores.

    use super::{Compiled, Diagnostic, Live, Shot, View};
    use rayon::prelude::*;
    use std::sync::atomic::{AtomicUsize, Ordering};
    use surefoot_compiler::images::Images;
    use surefoot_compiler::reference::film::{bloom, develop, dither, level};
    use surefoot_compiler::srgb::{decode, encode};
    use surefoot_compiler::reference::{Area, Reference};

    /// Side of the squares that the cores take one after another.
    const TILE: u32 = 32;

    /// What the pictures show, of how many samples, and with which images.
    pub struct Painter {
        view: View,
        samples: u32,
        images: Images,
        broken: Vec<Diagnostic>,
    }

    impl Painter {
        pub fn new(compiled: &Compiled, view: View, samples: Option<u32>) -> Self {
            let (images, broken) = images(compiled);
            Self { view, samples: samples.unwrap_or(super::samples(compiled, view, false)), images, broken }
        }

        pub fn broken(&self) -> &[Diagnostic] {
            &self.broken
        }

        pub fn paint(
            &self,
            compiled: &Compiled,
            live: &Live,
            shot: &Shot,
            progress: &(dyn Fn(f64) + Sync),
        ) -> Result<Vec<u8>, String> {
            let scene = Reference::new(compiled, live)
                .map_err(|_| "the scene has more operations than the processor takes".to_owned())?
                .with_images(&self.images);
            let frame = compiled.frame(live);
            let Shot { width, height, rows: [first, end], camera } = *shot;
            let rows = (first..end).step_by(TILE as usize);
            let areas: Vec<Area> = rows
                .flat_map(|top| (0..width).step_by(TILE as usize).map(move |left| (left, top)))
                .map(|(left, top)| Area {
                    left,
                    top,
                    width: TILE.min(width - left),
                    height: TILE.min(end - top),
                })
                .collect();
            let (view, samples) = (self.view, self.samples);
            // Light is scattered before the tone curve, and from anywhere in the picture.
            let blooms = view == View::Shaded && frame.bloom > 0.0;
            if blooms && end - first < height {
                return Err("a picture with bloom is drawn as a whole, as light is scattered over all of it".to_owned());
            }
            let done = AtomicUsize::new(0);
            let mut sum = vec![[0.0; 3]; width as usize * (end - first) as usize];
            let mut light = sum.clone();
            for sample in 0..samples {
                let camera = camera.sampled(sample);
                let drawn = areas.par_iter().map(|area| {
                    let seen = scene.light_at(&frame, &camera, (width, height), view, *area, sample);
                    let done = done.fetch_add(1, Ordering::Relaxed) + 1;
                    progress(done as f64 / (areas.len() * samples as usize) as f64);
                    seen
                });
                let tiles: Vec<Vec<[f32; 4]>> = drawn.collect();
                for (area, tile) in areas.iter().zip(tiles) {
                    for (i, [r, g, b, _]) in (0..).zip(tile) {
                        let (x, y) = (i % area.width + area.left, i / area.width + area.top);
                        if let Some(pixel) = light.get_mut(((y - first) * width + x) as usize) {
                            *pixel = [r, g, b].map(f64::from);
                        }
                    }
                }
                if blooms {
                    light = bloom(&light, (width, height), frame.bloom);
                }
                for (sum, light) in sum.iter_mut().zip(&light) {
                    // The mean of light, not of what a screen makes of it.
                    let color = if view == View::Shaded { develop(frame.tone, *light) } else { *light };
                    for (sum, c) in sum.iter_mut().zip(color) {
                        *sum += decode(c) / f64::from(samples);
                    }
                }
            }
            let places = (first..end).flat_map(|y| (0..width).map(move |x| (x, y)));
            let levels = |(color, (x, y)): ([f64; 3], (u32, u32))| {
                let moved = if view == View::Shaded { dither(x, y) } else { 0.0 };
                let [r, g, b] = color.map(|c| level(encode(c), moved));
                [r, g, b, 255]
            };
            Ok(sum.into_iter().zip(places).flat_map(levels).collect())
        }
    }

    /// The images of a scene, and what is wrong with them. Nothing can be read where the program is built without graphics.
    fn images(compiled: &Compiled) -> (Images, Vec<Diagnostic>) {
        #[cfg(feature = "gpu")]
        {
            let loaded = surefoot_runtime::images::Gallery::new().load(compiled, &super::files::FileLoader);
            (loaded.images, loaded.diagnostics)
        }
        #[cfg(not(feature = "gpu"))]
        {
            let _ = compiled;
            (Images::default(), Vec::new())
        }
    }
}
