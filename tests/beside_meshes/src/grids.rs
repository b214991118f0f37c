//! Meshes to grids: ours and that of `mesh_to_sdf`, of the same triangles.

use super::{Failure, median, timed};
use mesh_to_sdf::{Grid as TheirGrid, SignMethod, Topology, generate_grid_sdf};
use std::fmt::Write;
use surefoot_compiler::sampled::{Grid, Settings, Sign, Surface, bake};

/// Rounds, ours and theirs in turn.
const ROUNDS: usize = 3;
/// Rings of a torus, and corners of each; twice as many triangles as corners.
const MODELS: [[u32; 2]; 3] = [[32, 16], [100, 50], [400, 200]];
const RESOLUTIONS: [usize; 3] = [32, 64, 128];
/// What theirs takes beyond is minutes.
const MOST_OF_THEIRS: usize = 128;
/// Every so many samples are compared with the plain search through all triangles.
const COMPARED: usize = 400;

struct Model {
    places: Vec<[f64; 3]>,
    triangles: Vec<[u32; 3]>,
}

/// A torus about y that is turned out of all axes.
fn torus([rings, around]: [u32; 2]) -> Model {
    let turn = |part: u32, of: u32| (f64::from(part) / f64::from(of) * std::f64::consts::TAU).sin_cos();
    let (sin, cos) = 0.6f64.sin_cos();
    let places = (0..rings * around).map(|i| {
        let ((s, c), (u, v)) = (turn(i / around, rings), turn(i % around, around));
        let [x, y, z] = [(1.0 + 0.4 * v) * c, 0.4 * u, (1.0 + 0.4 * v) * s];
        [x * cos - y * sin, x * sin + y * cos, z]
    });
    let corner = |ring: u32, at: u32| ring % rings * around + at % around;
    let triangles = (0..rings * around).flat_map(|i| {
        let (ring, at) = (i / around, i % around);
        let [a, b, c, d] = [corner(ring, at), corner(ring, at + 1), corner(ring + 1, at + 1), corner(ring + 1, at)];
        [[a, b, c], [a, c, d]]
    });
    Model { places: places.collect(), triangles: triangles.collect() }
}

/// Models and resolutions as a table.
pub fn section() -> Result<String, Failure> {
    let mut text = format!(
        "## Meshes to grids\n\n\
         A torus of so many triangles, sampled at so many places along its longest side. *plain* is every triangle for every sample, from \
         {COMPARED} samples and their share; *one core* and *all cores* are `mesh_field` and `surefoot bake`, whose samples stand in bricks near the surface \
         and are coarse elsewhere; *all samples* are all of the grid by the same search. Theirs is `generate_grid_sdf` with parity of rays, whose samples are \
         all of the grid, too. Seconds of {ROUNDS} rounds, the hierarchy included. *off* is the largest difference of {COMPARED} samples from the plain method, and *wrong* \
         how many have the wrong sign.\n\n\
         | triangles | samples | plain | one core | all cores | all samples | off | wrong | theirs | off | wrong | theirs / all cores | theirs / all samples |\n\
         |---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n"
    );
    for model in MODELS {
        let model = torus(model);
        for resolution in RESOLUTIONS {
            eprintln!("{} triangles, {resolution} samples", model.triangles.len());
            row(&mut text, &model, resolution)?;
        }
    }
    Ok(text)
}

fn row(text: &mut String, model: &Model, resolution: usize) -> Result<(), Failure> {
    let settings = Settings { resolution: resolution as u32, ..Settings::default() };
    let surface = || Surface::new(&model.places, &model.triangles, Sign::Auto);
    let ours = || -> Result<Grid, String> { bake(&surface()?, settings, &|_| {}) };
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build()?;
    // The box that both sample.
    let known = surface()?;
    let [low, high] = known.bounds();
    let side = (0..3).map(|i| high[i] - low[i]).fold(0.0, f64::max);
    let room = 0.05 * side;
    let (low, high) = (low.map(|c| (c - room) as f32), high.map(|c| (c + room) as f32));
    let cell = (side + 2.0 * room) / resolution as f64;
    let counts = [0, 1, 2].map(|i| ((f64::from(high[i] - low[i]) / cell).ceil() as usize).max(1));
    let grid = TheirGrid::from_bounding_box(&low, &high, counts);
    let all = || -> Result<Vec<f32>, String> {
        let surface = surface()?;
        use rayon::prelude::*;
        let rows = 0..counts[0] * counts[1];
        Ok(rows.into_par_iter().flat_map_iter(|row| {
            let (surface, grid) = (&surface, &grid);
            let mut hint = 0;
            (0..counts[2]).map(move |k| {
                let at = grid.get_cell_center(&[row / counts[1], row % counts[1], k]);
                surface.signed(at.map(f64::from), &mut hint) as f32
            })
        }).collect())
    };
    let corners: Vec<[f32; 3]> = model.places.iter().map(|p| p.map(|c| c as f32)).collect();
    let indices: Vec<u32> = model.triangles.iter().flatten().copied().collect();
    let theirs = || generate_grid_sdf(&corners, Topology::TriangleList(Some(&indices)), &grid, SignMethod::Raycast);
    let asked = resolution <= MOST_OF_THEIRS;
    let (mut alone, mut together, mut whole, mut other) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    let (mut our_samples, mut their_samples) = (Vec::new(), Vec::new());
    for _ in 0..ROUNDS {
        let (made, time) = timed(|| one.install(ours));
        made?;
        alone.push(time);
        let (made, time) = timed(ours);
        made?;
        together.push(time);
        let (made, time) = timed(all);
        our_samples = made?;
        whole.push(time);
        if asked {
            let (made, time) = timed(theirs);
            their_samples = made;
            other.push(time);
        }
    }
    let total = counts.iter().product::<usize>();
    let compared: Vec<usize> = (0..total).step_by((total / COMPARED).max(1) | 1).collect();
    let place = |i: usize| grid.get_cell_center(&[i / (counts[1] * counts[2]), i / counts[2] % counts[1], i % counts[2]]).map(f64::from);
    let (right, plain) = timed(|| {
        let value = |i: &usize| { let (distance, winding) = known.plain(place(*i)); if winding.abs() >= 0.5 { -distance } else { distance } };
        compared.iter().map(value).collect::<Vec<f64>>()
    });
    let off = |samples: &[f32]| compared.iter().zip(&right).map(|(i, right)| (f64::from(samples[*i]) - right).abs()).fold(0.0, f64::max);
    let wrong = |samples: &[f32]| compared.iter().zip(&right).filter(|(i, right)| (samples[**i] < 0.0) != (**right < 0.0)).count();
    let [alone, together, whole] = [alone, together, whole].map(median);
    let beside = if asked {
        let other = median(other);
        let (off, wrong) = (off(&their_samples), wrong(&their_samples));
        format!("{other:.2} | {off:.1e} | {wrong} | {:.1} | {:.1}", other / together, other / whole)
    } else {
        "– | – | – | – | –".to_owned()
    };
    writeln!(
        text,
        "| {} | {resolution} | {:.0} | {alone:.2} | {together:.2} | {whole:.2} | {:.1e} | {} | {beside} |",
        model.triangles.len(),
        plain * total as f64 / compared.len() as f64,
        off(&our_samples),
        wrong(&our_samples),
    )?;
    Ok(())
}
