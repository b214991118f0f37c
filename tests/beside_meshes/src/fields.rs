//! Fields to meshes: ours and that of `fidget`, of the same formulas.

use super::{Failure, median, timed, tree};
use fidget::jit::JitShape;
use fidget::mesh::{Octree, Settings as TheirSettings};
use nalgebra::Matrix4;
use std::fmt::Write;
use surefoot_compiler::compiled::Compiled;
use surefoot_compiler::contour::{Detail, Settings, contour};
use surefoot_compiler::evaluate::Tape;
use surefoot_compiler::graph::Function;
use surefoot_compiler::{MemoryLoader, Options, compile};

/// Half the side of the cube in which theirs searches.
const HALF: f32 = 1.6;
/// Rounds, ours and theirs in turn.
const ROUNDS: usize = 3;
const DEPTHS: [u8; 2] = [6, 7];
/// Cells along the longest side, of which ours takes the first that is no worse.
const CELLS: [u32; 9] = [24, 32, 48, 64, 96, 128, 192, 256, 384];
/// Places of a mesh at which its error is asked for, at most; they are spread evenly over it.
const PLACES: usize = 40_000;

const PART: &str = "scene = (box(2.2, 0.6, 1.4) | cylinder(0.5, 1.6)) - cylinder(0.3, 4) - box(0.5).rotate(y, 45deg).translate(0.8, 0.3, 0)";

/// How far a mesh is from the surface at its vertices, at the middles of its edges and of its triangles.
#[derive(Clone, Copy)]
struct Error {
    mean: f64,
    largest: f64,
}

/// Scenes as a table.
pub fn section() -> Result<String, Failure> {
    let scenes = [
        ("a part with holes", PART.to_owned()),
        ("1,001 spheres, smoothly joined", include_str!("../../corpus/large/spheres.sdf").to_owned()),
        ("186 rounded boxes in a tree of smooth unions", include_str!("../../corpus/large/boxes.sdf").to_owned()),
    ];
    let mut text = format!(
        "## Fields to meshes\n\n\
         Theirs is `fidget::mesh::Octree` on machine code (`JitShape`) in a cube of side {}; ours is `surefoot mesh` with sharp edges, at the \
         least number of cells that is no farther from the surface in the mean. The error is that of vertices, middles of edges and middles of triangles, \
         {PLACES} of them at most, by the value of the field over its slope. Seconds of {ROUNDS} rounds, from the formula to the mesh; *torn* are edges that are not in two triangles.\n\n\
         | scene | their depth | triangles | torn | mean error | largest | seconds | our cells | triangles | torn | mean error | largest | seconds | theirs / ours |\n\
         |---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n",
        2.0 * HALF
    );
    for (name, scene) in scenes {
        let loader = MemoryLoader::new().with("scene.sdf", scene);
        let scene = compile(&loader, "scene.sdf", &Options::default()).compiled.ok_or("the scene does not compile")?;
        for depth in DEPTHS {
            eprintln!("{name}, depth {depth}");
            row(&mut text, name, &scene, depth)?;
        }
    }
    Ok(text)
}

/// A part for a printer, by ours alone. Called first: the memory is the most that the program has taken so far.
pub fn part() -> Result<String, Failure> {
    let loader = MemoryLoader::new().with("bracket.sdf", include_str!("../../corpus/large/bracket.sdf"));
    let scene = compile(&loader, "bracket.sdf", &Options::default()).compiled.ok_or("the scene does not compile")?;
    let mut text = "## A part for a printer\n\n\
         `surefoot mesh tests/corpus/large/bracket.sdf --tolerance …`: an angle bracket of 100 × 60 × 40 mm with two ribs and twelve holes. *memory* is the most \
         that the program took until then.\n\n\
         | tolerance, mm | cells along the longest side | triangles | farthest found, mm | seconds | memory, MiB |\n|---:|---:|---:|---:|---:|---:|\n".to_owned();
    for tolerance in [0.1, 0.05, 0.02] {
        let settings = Settings { detail: Detail::Tolerance(tolerance), sharp: true, within: None };
        let (mesh, time) = timed(|| contour(&scene, &scene.live(), &settings, &|_| {}));
        let mesh = mesh.map_err(|why| why.to_string())?;
        let (triangles, found) = (mesh.triangles.len(), mesh.deviation);
        writeln!(text, "| {tolerance} | {} | {triangles} | {found:.4} | {time:.1} | {} |", mesh.cells, memory()?)?;
    }
    Ok(text)
}

/// The most MiB that the program has held.
fn memory() -> Result<u64, Failure> {
    let status = std::fs::read_to_string("/proc/self/status")?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:")).ok_or("the system does not say")?;
    Ok(line.trim().trim_end_matches(" kB").parse::<u64>()? >> 10)
}

fn row(text: &mut String, name: &str, scene: &Compiled, depth: u8) -> Result<(), Failure> {
    let theirs = || -> Result<fidget::mesh::Mesh, Failure> {
        let shape = JitShape::from(tree::tree(&scene.graph, scene.root)?);
        let none = Default::default();
        let settings = TheirSettings { depth, world_to_model: Matrix4::new_scaling(HALF), ..Default::default() };
        Ok(Octree::build(&shape.bind(&none)?, &settings).ok_or("fidget made nothing")?.walk_dual())
    };
    let ours = |cells: u32| {
        let settings = Settings { detail: Detail::Cells(cells), sharp: true, within: None };
        contour(scene, &scene.live(), &settings, &|_| {}).map_err(|why| why.to_string())
    };
    let their_mesh = theirs()?;
    let vertices: Vec<[f64; 3]> = their_mesh.vertices.iter().map(|v| [v.x, v.y, v.z].map(f64::from)).collect();
    let triangles: Vec<[u32; 3]> = their_mesh.triangles.iter().map(|t| [t.x, t.y, t.z].map(|i| i as u32)).collect();
    let their_error = error(scene, &vertices, &triangles)?;
    let torn = surefoot_compiler::contour::Mesh { triangles: triangles.clone(), ..Default::default() }.torn_edges();
    let mut found = None;
    for cells in CELLS {
        let mesh = ours(cells)?;
        let our_error = error(scene, &mesh.vertices, &mesh.triangles)?;
        let enough = our_error.mean <= their_error.mean;
        found = Some((cells, mesh, our_error));
        if enough {
            break;
        }
    }
    let (cells, our_mesh, our_error) = found.ok_or("no mesh of ours")?;
    let (mut their_times, mut our_times) = (Vec::new(), Vec::new());
    for _ in 0..ROUNDS {
        let (made, time) = timed(theirs);
        made?;
        their_times.push(time);
        let (made, time) = timed(|| ours(cells));
        made?;
        our_times.push(time);
    }
    let (their_time, our_time) = (median(their_times), median(our_times));
    writeln!(
        text,
        "| {name} | {depth} | {} | {torn} | {:.1e} | {:.1e} | {their_time:.2} | {cells} | {} | {} | {:.1e} | {:.1e} | {our_time:.2} | {:.1} |",
        triangles.len(),
        their_error.mean,
        their_error.largest,
        our_mesh.triangles.len(),
        our_mesh.torn_edges(),
        our_error.mean,
        our_error.largest,
        their_time / our_time,
    )?;
    Ok(())
}

fn error(scene: &Compiled, vertices: &[[f64; 3]], triangles: &[[u32; 3]]) -> Result<Error, Failure> {
    let formula = scene.functions.formulas.get(&(scene.root, Function::Field)).ok_or("no field")?;
    let tape = Tape::new(&scene.graph, &scene.functions.formulas, &[*formula], &scene.live(), 10_000_000).map_err(|_| "the field is too long")?;
    let middle = |of: &[u32]| [0, 1, 2].map(|i| of.iter().map(|v| vertices[*v as usize][i]).sum::<f64>() / of.len() as f64);
    let mut points = vertices.to_vec();
    for [a, b, c] in triangles {
        points.extend([middle(&[*a, *b]), middle(&[*b, *c]), middle(&[*c, *a]), middle(&[*a, *b, *c])]);
    }
    let points: Vec<[f64; 3]> = points.iter().step_by(points.len().div_ceil(PLACES).max(1)).copied().collect();
    // The value, and that at a small step along each axis.
    const STEP: f64 = 1e-6;
    let around: Vec<[f64; 3]> = points.iter().flat_map(|p| {
        let moved = |axis: usize| { let mut q = *p; q[axis] += STEP; q };
        [*p, moved(0), moved(1), moved(2)]
    }).collect();
    let mut values = vec![0.0; around.len()];
    tape.evaluator().at(&around, &[], |i, v| values[i] = v[0]);
    let errors: Vec<f64> = values.chunks_exact(4).map(|v| {
        let slope = v[1..].iter().map(|moved| ((moved - v[0]) / STEP).powi(2)).sum::<f64>().sqrt();
        v[0].abs() / slope.max(0.5)
    }).collect();
    Ok(Error { mean: errors.iter().sum::<f64>() / errors.len() as f64, largest: errors.iter().copied().fold(0.0, f64::max) })
}
