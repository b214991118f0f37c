//! A pixel of a scene's picture, as commands are told it, and its ray.

use super::console::{Exit, Failure};
use super::render::{camera, size};
use super::values::{self, Setting};
use surefoot_compiler::camera::Basis;
use surefoot_compiler::compiled::Camera;
use surefoot_compiler::reference::Reference;
use surefoot_compiler::reference::march::Ray;
use surefoot_compiler::{Compiled, Live, Options, Outcome};

/// A pixel of a scene's picture.
#[derive(Debug, clap::Args)]
pub struct Pixel {
    /// The scene.
    pub scene: String,
    /// The pixel's column, from the left; the first is 0.
    x: f64,
    /// The pixel's row, from the top; the first is 0.
    y: f64,
    /// Width and height of the picture in pixels.
    #[arg(long, default_value = "1280x720", value_parser = size, value_name = "WxH")]
    size: (u32, u32),
    /// The camera to use; the scene's first one if this is left out.
    #[arg(long, value_name = "NAME")]
    camera: Option<String>,
    /// The time, in seconds.
    #[arg(long, default_value_t = 0.0, allow_negative_numbers = true, value_name = "SECONDS")]
    time: f64,
    /// Set a parameter.
    #[arg(long, value_parser = values::setting, value_name = "NAME=VALUE")]
    set: Vec<Setting>,
}

/// A scene and the ray through one of its pixels.
pub struct Aimed {
    /// The compilation.
    pub outcome: Outcome,
    /// Its values and its moment.
    pub live: Live,
    /// The ray.
    pub ray: Ray,
    /// The camera.
    pub camera: Camera,
    /// The width of a pixel at distance one.
    pub footprint: f64,
    /// The scene in 64 bits.
    pub reference: Reference,
}

impl Aimed {
    /// The scene.
    pub fn compiled(&self) -> Option<&Compiled> {
        self.outcome.compiled.as_ref()
    }
}

/// Compiles the scene and finds the pixel's ray. None where the scene has errors.
pub fn aim(args: &Pixel) -> Result<Option<Aimed>, Failure> {
    let (outcome, live) = values::read(&args.scene, &args.set, &Options::default())?;
    let (Some(compiled), Some(mut live)) = (&outcome.compiled, live) else { return Ok(None) };
    live.time = args.time;
    compiled.settle(&mut live);
    let frame = compiled.frame(&live);
    let (size, at) = (args.size, (args.x + 0.5, args.y + 0.5));
    let camera = compiled.camera_in(camera(&frame, args.camera.as_deref())?, f64::from(size.0) / f64::from(size.1));
    let basis = Basis::of(&camera);
    let ray = Ray { origin: basis.start(camera.eye, at, size), direction: basis.direction(at, size), t_min: 0.0, t_max: frame.max_distance };
    let reference = Reference::new(compiled, &live).map_err(|why| Failure { exit: Exit::Errors, words: format!("{}: {why}", args.scene) })?;
    Ok(Some(Aimed { live, ray, camera, footprint: basis.footprint(size.1), reference, outcome }))
}
