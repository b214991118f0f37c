//! A scene whose module is written by hand, so that it can be told what is right.
#![allow(dead_code)]

use surefoot_compiler::compiled::*;
use surefoot_compiler::diagnostic;
use surefoot_runtime::Gpu;

/// The device, or the test fails: there is always a software adapter where these tests run.
pub fn gpu() -> Gpu {
    match Gpu::headless() {
        Ok(gpu) => gpu,
        Err(error) => panic!("{error}. The tests need one: apt-get install mesa-vulkan-drivers"),
    }
}

pub const WGSL: &str = include_str!("sphere.wgsl");
pub const EYE: [f64; 3] = [1.0, 2.0, 4.0];

/// A sphere with a parameter `radius` in 0.5..2.
pub fn sphere(radius: f64) -> Compiled {
    sphere_in(WGSL, radius, (0.5, 2.0))
}

/// The same with another text of the module and another range.
pub fn sphere_in(wgsl: &str, radius: f64, (min, max): (f64, f64)) -> Compiled {
    let [x, y, z] = EYE;
    let text = format!(
        "param radius = {radius:?} in {min:?}..{max:?}\nscene = sphere(radius)\ncamera {{ eye: ({x}, {y}, {z}), target: (0, 0, 0), fov: 0.8 }}"
    );
    let loader = MemoryLoader::new().with("ball.sdf", text);
    let outcome = surefoot_compiler::compile(&loader, "ball.sdf", &Options::default());
    let words = diagnostic::render(&outcome.sources, &outcome.diagnostics, false);
    let mut compiled = outcome.compiled.unwrap_or_else(|| panic!("{words}"));
    let uniform = |name: &str, source, components, offset| Uniform {
        name: name.to_owned(),
        source,
        components,
        offset,
    };
    use Export::*;
    // Its text has no box about what is solid.
    compiled.functions.ahead.region = None;
    compiled.module = Module {
        wgsl: wgsl.to_owned(),
        places: Vec::new(),
        exports: vec![Field, Bound, Distance, Gradient, Trace, Shadow, Occlusion, Surface],
        uniform_name: "sf_uniforms".to_owned(),
        origin: "sf_uniforms.origin".to_owned(),
        uniforms: vec![
            uniform("origin", UniformSource::Origin, 3, 0),
            uniform("radius", UniformSource::Parameter(0), 1, 12),
        ],
        formulas: Default::default(),
        computed: Vec::new(),
        uniform_size: 16,
        operations: (8, 8),
        skipped: Vec::new(),
        meshes: String::new(),
        tables: None,
        rounding: surefoot_compiler::compiled::Rounding { reads_scene: [true; 3], unit: 1.0 },
        cancels: None,
        one: false,
        draws: false,
        ways: Default::default(),
        needs_buffers: false,
    };
    compiled
}
