//! Run time against error: scenes through many tracers, judged by certified truth.

mod methods;
mod plot;
mod pixel;
mod report;
mod rows;
mod silhouette;
pub mod truth;

use crate::command::bar::LateBar;
use crate::command::console::{Exit, Failure, compile_file, print, show_diagnostics};
pub use rows::Args;
use rows::{Row, Scene};
use methods::{METHODS, Method};
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::Duration;
use surefoot_compiler::compiled::{Compiled, Live};
use surefoot_compiler::reference::Reference;
use surefoot_compiler::{Export, Options};
use surefoot_runtime::Gpu;
use surefoot_runtime::passes::rays::{FUNCTIONS, Follower, Rays};
use truth::{Answer, BOXES, Errors, View};

/// Measures scenes, prints tables, writes numbers and curves.
pub fn run(paths: &[String], args: &Args, json: Option<&Path>, page: Option<&Path>) -> Result<Exit, Failure> {
    if !args.size.0.is_multiple_of(8) {
        return Err(Failure::usage("the width of --size must be a multiple of 8".to_owned()));
    }
    let gpu = Gpu::headless().map_err(|why| Failure { exit: Exit::NoGraphics, words: why.to_string() })?;
    let bar = LateBar::new();
    let mut scenes = Vec::new();
    let mut wrong = false;
    for (i, path) in paths.iter().enumerate() {
        let outcome = compile_file(path, &Options { exports: EXPORTS.to_vec(), ..Options::default() })?;
        let Some(compiled) = &outcome.compiled else {
            show_diagnostics(&outcome);
            wrong = true;
            continue;
        };
        let show = |part: f64| bar.show((i as f64 + part) / paths.len() as f64);
        let scene = measure(&gpu, path, compiled, args, &show)
            .map_err(|why| Failure::usage(format!("can't measure {path}: {why}")))?;
        bar.hide(|| print(report::table(&scene).as_bytes()))?;
        scenes.push(scene);
    }
    bar.finish();
    if let Some(file) = json {
        report::write_json(file, gpu.name(), args, &scenes)?;
    }
    if let Some(file) = &args.plot {
        plot::write(file, gpu.name(), &scenes)?;
    }
    if let Some(file) = page.filter(|_| !args.methods.is_empty()) {
        report::write_errors(file, gpu.name(), args, &scenes)?;
    } else if let Some(file) = page {
        let curves = file.with_extension("svg");
        plot::write(&curves, gpu.name(), &scenes)?;
        report::write_page(file, &curves, &gpu, args, &scenes)?;
    }
    let methods: Vec<&str> = METHODS.iter().map(|(name, _)| *name).collect();
    print(report::summary(&scenes, &methods).as_bytes())?;
    Ok(if wrong { Exit::Errors } else { Exit::Fine })
}

const EXPORTS: [Export; 5] = [Export::Field, Export::Bound, Export::Distance, Export::Gradient, Export::Trace];

fn measure(gpu: &Gpu, path: &str, scene: &Compiled, args: &Args, show: &(dyn Fn(f64) + Sync)) -> Result<Scene, String> {
    let live = scene.live();
    let reference = Reference::new(scene, &live).map_err(|e| e.to_string())?;
    let cameras = truth::cameras(&scene.frame(&live), reference.field(), args.views);
    let (done, all) = (AtomicUsize::new(0), cameras.len() * args.size.0 as usize * args.size.1 as usize);
    let progress = || {
        let done = done.fetch_add(1, Ordering::Relaxed);
        if done.is_multiple_of(256) {
            // The truth is most of the work.
            show(0.8 * done as f64 / all as f64);
        }
    };
    let views: Vec<View> =
        cameras.iter().map(|camera| View::new(scene, &live, camera, args.size, BOXES, &progress)).collect::<Result<_, _>>()?;
    let mut left_out = Vec::new();
    let mut methods: Vec<Method> = Vec::new();
    for (name, _) in METHODS.iter().filter(|(name, _)| args.methods.is_empty() || args.methods.iter().any(|m| m == name)) {
        match methods::method(name, scene) {
            Some(Ok(method)) => methods.push(method),
            Some(Err(why)) => left_out.push(((*name).to_owned(), why.to_owned())),
            None => {}
        }
    }
    if args.sweep {
        methods.extend(methods::sweep(scene));
    }
    let unknown = views.iter().enumerate().flat_map(|(i, view)| view.unknown(i)).collect();
    let weights = FUNCTIONS.map(|name| reference.operations(name) as f64);
    let mut rows = Vec::new();
    let mut timed: Vec<Vec<Rays>> = Vec::new();
    for method in &methods {
        let mut errors = Errors::default();
        for view in &views {
            let rays = followed(gpu, scene, &live, method, view, true)?;
            rays.run()?;
            let answers: Vec<Answer> = rays.read()?.iter().map(Answer::from).collect();
            view.judge(&reference, &answers, &mut errors);
        }
        let operations: f64 = errors.looks.iter().zip(weights).map(|(n, w)| *n as f64 * w).sum();
        let operations = operations / errors.rays.max(1) as f64;
        rows.push(Row { method: method.name.clone(), about: method.about, time: Duration::ZERO, ratio: 1.0, operations, errors });
        timed.push(views.iter().map(|view| followed(gpu, scene, &live, method, view, false)).collect::<Result<_, _>>()?);
    }
    let mut times: BTreeMap<usize, Vec<Duration>> = BTreeMap::new();
    // The first round makes the machine code and is not counted.
    for round in 0..=args.rounds() {
        show(0.85 + 0.15 * f64::from(round) / f64::from(args.rounds() + 1));
        for (i, views) in timed.iter().enumerate() {
            let mut sum = Duration::ZERO;
            for rays in views {
                sum += rays.run()?;
            }
            if round > 0 {
                times.entry(i).or_default().push(sum);
            }
        }
    }
    let first = times.get(&0).cloned().unwrap_or_default();
    for (i, row) in rows.iter_mut().enumerate() {
        let own = times.remove(&i).unwrap_or_default();
        let ratios: Vec<f64> = own.iter().zip(&first).map(|(a, b)| a.as_secs_f64() / b.as_secs_f64()).collect();
        row.ratio = Errors::percentile(&ratios, 50.0);
        let seconds: Vec<f64> = own.iter().map(Duration::as_secs_f64).collect();
        row.time = Duration::from_secs_f64(Errors::percentile(&seconds, 50.0));
    }
    let factor = scene.graph.factors.iter().map(|f| f.lipschitz).fold(1.0, f64::max);
    Ok(Scene { path: path.to_owned(), factor, rows, unknown, left_out })
}

fn followed<'g>(
    gpu: &'g Gpu,
    scene: &Compiled,
    live: &Live,
    method: &Method,
    view: &View,
    count: bool,
) -> Result<Rays<'g>, String> {
    Rays::new(gpu, scene, live, &Follower { wgsl: &method.wgsl, name: "traced", count }, &view.picture)
}
