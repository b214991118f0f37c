//! A scene made by hand, as the compiler would hand it over.
#![allow(dead_code)]

use std::sync::Arc;
use surefoot_compiler::compiled::*;
use surefoot_compiler::functions::{Functions, Kind};
use surefoot_compiler::graph::kernel::Op;
use surefoot_compiler::graph::{Exactness, Graph, Leaf, ParameterComponent, Shape};
use surefoot_compiler::source::{FileId, Span};
use surefoot_compiler::syntax::ast::Type;
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

/// The same with another text and another range.
pub fn sphere_in(wgsl: &str, radius: f64, (min, max): (f64, f64)) -> Compiled {
    let span = Span::new(FileId(0), 0, 0);
    let mut graph = Graph::new();
    graph.parameters.push(ParameterComponent {
        parameter: 0,
        component: 0,
        default: radius,
        min,
        max,
    });
    let point = graph.point();
    let mut sum = graph.constant(0.0);
    for c in point {
        let square = graph.op(Op::Mul, &[c, c]);
        sum = graph.op(Op::Add, &[sum, square]);
    }
    let length = graph.op(Op::Sqrt, &[sum]);
    let r = graph.leaf(Leaf::Parameter(0));
    let value = graph.op(Op::Sub, &[length, r]);
    let root = graph.add_shape(Shape {
        name: Some(Arc::from("ball")),
        dimensions: 3,
        value,
        variables: Arc::new([]),
        exactness: Exactness::Exact,
        material: None,
        paints: Arc::new([]),
        span,
    });
    let eye = EYE.map(|c| graph.constant(c));
    let zero = graph.constant(0.0);
    let fov = graph.constant(0.8);
    let blocks = SceneBlocks {
        cameras: vec![("camera".to_owned(), eye, [zero; 3], fov)],
        extent: 100.0,
        ..SceneBlocks::default()
    };
    let uniform = |name: &str, source, components, offset| Uniform {
        name: name.to_owned(),
        source,
        components,
        offset,
    };
    use Export::*;
    Compiled {
        graph,
        root,
        functions: Functions::default(),
        kind: Kind::Exact,
        parameters: vec![Parameter {
            name: "radius".to_owned(),
            ty: Type::Float,
            degrees: false,
            default: vec![radius],
            min: vec![min],
            max: vec![max],
            choices: Vec::new(),
            description: None,
            span,
            first: Some(0),
        }],
        blocks,
        module: Module {
            wgsl: wgsl.to_owned(),
            exports: vec![Field, Bound, Distance, Gradient, Trace, Shadow, Occlusion, Surface],
            uniform_name: "sf_uniforms".to_owned(),
            uniforms: vec![
                uniform("origin", UniformSource::Origin, 3, 0),
                uniform("radius", UniformSource::Parameter(0), 1, 12),
            ],
            uniform_size: 16,
            operations: (8, 8),
            skipped: Vec::new(),
        },
    }
}
