//! What is proven of a mesh: of good ones that they are near to the surface and it to them, and of bad ones where they are not.

use surefoot_compiler::certify::{Hit, Truth};
use surefoot_compiler::contour::{Certificate, Detail, Mesh, Settings, certify, contour};
use surefoot_compiler::random::Random;
use surefoot_compiler::sampled::{Sign, Surface};
use surefoot_compiler::vector::{Vec3, add, along, length, scale, sub};
use surefoot_compiler::{Compiled, MemoryLoader, Options, compile};

fn scene(text: &str) -> Compiled {
    let loader = MemoryLoader::new().with("main.sdf", format!("scene = {text}\n"));
    let outcome = compile(&loader, "main.sdf", &Options::default());
    outcome.compiled.unwrap_or_else(|| panic!("{text}: {:?}", outcome.diagnostics))
}

fn meshed(scene: &Compiled, cells: u32, within: Option<[Vec3; 2]>) -> Mesh {
    contour(scene, &scene.live(), &Settings { detail: Detail::Cells(cells), sharp: true, within }, &|_| {}).unwrap()
}

fn proven(scene: &Compiled, mesh: &Mesh, within: Option<[Vec3; 2]>, cells: f64) -> Certificate {
    certify(scene, &scene.live(), mesh, within, cells * mesh.cell, &|_| {}).unwrap()
}

/// Shapes, cells along the longest side, and the part of a cell to which both distances are proven at least. At edges less work is done than
/// would prove more than half a cell.
const SHAPES: [(&str, u32, f64); 9] = [
    ("sphere(1)", 16, 0.12),
    ("torus(1, 0.4)", 24, 0.25),
    ("box(1.2, 0.8, 1)", 12, 0.5),
    ("box(1.2, 0.8, 1).rotate(y, 20deg).rotate(x, 31deg)", 12, 0.5),
    ("box(1.2, 0.8, 1) - cylinder(0.3, 4)", 20, 0.5),
    ("sphere(1) & box(1.5).rotate(y, 0.4)", 20, 0.5),
    ("sphere(1) - sphere(0.5)", 16, 0.25),
    ("smooth_union(sphere(0.6), box(0.5).translate(0.7, 0, 0), 0.2)", 20, 0.5),
    ("sphere(0.2).repeat(0.6, (3, 1, 1))", 32, 0.5),
];

#[test]
fn meshes_of_plain_shapes_are_proven_both_ways() {
    for (text, cells, most) in SHAPES {
        let scene = scene(text);
        let mesh = meshed(&scene, cells, None);
        let found = proven(&scene, &mesh, None, 0.5);
        assert!(found.holds(), "{text}: {found:?}");
        assert_eq!(found.to_surface.parts, mesh.triangles.len());
        assert!(found.to_mesh.parts * 4 > mesh.vertices.len() && found.to_mesh.parts < 4 * mesh.vertices.len(), "{text}: {found:?}");
        for way in [found.to_mesh, found.to_surface] {
            assert!(way.proven <= most * mesh.cell && way.proven > 0.0, "{text}: {} of a cell is proven, {way:?}", way.proven / mesh.cell);
        }
    }
}

/// What is cut off at a box has its walls proven too.
#[test]
fn walls_of_a_cut_are_proven() {
    let scene = scene("sphere(1) | plane(y, -0.3)");
    let within = Some([[-1.1, -0.8, -1.1], [1.1, 0.5, 1.1]]);
    let mesh = meshed(&scene, 20, within);
    let found = proven(&scene, &mesh, within, 0.5);
    assert!(found.holds(), "{found:?}");
    // A mesh of which the lid was left out is not near to it.
    let lid = |t: &[u32; 3]| mesh.corners(t).iter().all(|p| p[1] > 0.49);
    let open = Mesh { triangles: mesh.triangles.iter().copied().filter(|t| !lid(t)).collect(), ..mesh.clone() };
    assert!(open.triangles.len() < mesh.triangles.len());
    let found = proven(&scene, &open, within, 0.5);
    assert!(found.to_mesh.farther > 0 && found.to_surface.holds(), "{found:?}");
    assert!((found.to_mesh.wrong.unwrap()[1] - 0.5).abs() < 0.1, "{found:?}");
}

#[test]
fn a_corner_that_stands_off_is_found() {
    for text in ["sphere(1)", "box(1.2, 0.8, 1)"] {
        let scene = scene(text);
        let mut mesh = meshed(&scene, 16, None);
        let moved = mesh.vertices.len() / 3;
        let out = mesh.normals[moved].map(f64::from);
        mesh.vertices[moved] = along(mesh.vertices[moved], out, 2.0 * mesh.cell);
        let found = proven(&scene, &mesh, None, 0.5);
        let about = mesh.triangles.iter().filter(|t| t.contains(&(moved as u32))).count();
        assert_eq!((found.to_surface.farther, found.to_surface.undecided), (about, 0), "{text}: {found:?}");
        assert!(length(sub(found.to_surface.wrong.unwrap(), mesh.vertices[moved])) < 2.0 * mesh.cell, "{text}: {found:?}");
        assert!(found.to_surface.proven > 1.9 * mesh.cell && found.to_surface.proven < 4.0 * mesh.cell, "{text}: {found:?}");
    }
}

#[test]
fn a_shell_that_is_left_out_is_found() {
    for (text, inside) in [("sphere(0.5) | sphere(0.25).translate(2, 0, 0)", false), ("sphere(1) - sphere(0.5)", true)] {
        let scene = scene(text);
        let whole = meshed(&scene, 24, None);
        let mut shells = whole.shells();
        assert_eq!(shells.len(), 2);
        shells.sort_by(|a, b| a.area.total_cmp(&b.area));
        let mesh = Mesh { triangles: shells[1].triangles.clone(), ..whole };
        let found = proven(&scene, &mesh, None, 0.5);
        assert!(found.to_surface.holds(), "{text}: {found:?}");
        assert!(found.to_mesh.farther > 40, "{text}: {found:?}");
        // Some point of the smaller ball is so far from the larger.
        let far = if inside { 0.5 } else { 1.75 };
        assert!(found.to_mesh.proven >= far && found.to_mesh.proven < far + mesh.cell, "{text}: {found:?}");
        assert!(found.to_mesh.at_least < far + mesh.cell && found.to_mesh.at_least > 0.8 * far, "{text}: {found:?}");
    }
}

/// No point of a mesh that is tried is farther from the surface than is proven, and none of the surface from the mesh: of good meshes and of bad ones.
#[test]
fn no_point_is_farther_than_what_is_proven() {
    let mut random = Random(5);
    for (i, (text, cells, _)) in SHAPES.into_iter().enumerate() {
        let scene = scene(text);
        let mut mesh = meshed(&scene, cells / 2, None);
        if i % 2 == 1 {
            let by = 0.3 * mesh.cell;
            mesh.vertices.iter_mut().for_each(|p| *p = add(*p, scale(random.direction(), by * random.next())));
        }
        let found = proven(&scene, &mesh, None, 0.5);
        let truth = Truth::new(&scene, &scene.live(), 100_000).unwrap();
        let mut prover = truth.prover();
        let (mut farthest, mut nearest) = (0.0_f64, 0.0_f64);
        for _ in 0..300 {
            let [a, b, c] = mesh.corners(&mesh.triangles[(random.next() * mesh.triangles.len() as f64) as usize]);
            let (u, v) = (random.next().sqrt(), random.next());
            let at = add(scale(a, 1.0 - u), add(scale(b, u * (1.0 - v)), scale(c, u * v)));
            farthest = farthest.max(prover.distance(at, 1.0, 1e-3, 3000).at_least);
        }
        assert!(farthest <= found.to_surface.proven, "{text}: {farthest} {found:?}");
        let triangles = Surface::new(&mesh.vertices, &mesh.triangles, Sign::Auto).unwrap();
        let mut hits = 0;
        for _ in 0..300 {
            let (from, to) = (scale(random.direction(), 4.0), random.within(0.8));
            if let Hit::Hit(t) = prover.first_hit(from, sub(to, from), 0.0, 2.0, 10_000) {
                hits += 1;
                nearest = nearest.max(triangles.closest(along(from, sub(to, from), t), 0).squared.sqrt());
            }
        }
        assert!(hits > 30, "{text}: {hits}");
        assert!(nearest <= found.to_mesh.proven, "{text}: {nearest} {found:?}");
    }
}
