//! What rays miss that step by a fixed share of a field, as people let them who write a field by hand; and which share is proven.

use crate::analysis::{Box3, Domain, Facts};
use crate::camera::Basis;
use crate::compiled::{Compiled, Live};
use crate::diagnostic::{Code, Diagnostic};
use crate::evaluate::TooLarge;
use crate::reference::Reference;
use crate::reference::march::Ray;
use crate::vector::{Vec3, along};

/// Looks of one ray, at most.
const LOOKS: u32 = 2000;
/// Rays that end farther behind the surface than this share of the way to it have passed a part of it.
const OFF: f64 = 0.01;
/// Steps of a search for the constant of the whole field.
const SEARCH: usize = 512;

/// What rays of a camera meet that step by a share of the field.
#[derive(Clone, Debug, PartialEq)]
pub struct ByHand {
    /// The largest share that is proven for the whole field within the scene's extent; none where it has no constant that can be found.
    pub proven: Option<f64>,
    /// How many rays meet the solid.
    pub rays: usize,
    /// Where those that pass through it should have ended, and the pixel of each, from the upper left corner.
    pub holes: Vec<(Vec3, [u32; 2])>,
}

/// Follows the rays of the scene's first camera, one for each pixel of a picture of `size` (width and height).
///
/// Each step is `share` times the field's value. Where such a ray ends is compared with where the scene's own bound ends it. `said` is what the
/// compiler said of the scene: a field that jumps or is unproven has no proven share. The error is a field that is too large to evaluate.
pub fn by_hand(scene: &Compiled, said: &[Diagnostic], live: &Live, share: f64, size: (u32, u32)) -> Result<ByHand, TooLarge> {
    let reference = Reference::new(scene, live)?;
    let frame = scene.frame(live);
    let Some((_, camera)) = frame.cameras.first() else { return Ok(ByHand { proven: proven(scene, said), rays: 0, holes: Vec::new() }) };
    let basis = Basis::of(camera);
    let footprint = basis.footprint(size.1);
    let mut pixels = Vec::new();
    let mut rays = Vec::new();
    for y in 0..size.1 {
        for x in 0..size.0 {
            let at = (f64::from(x) + 0.5, f64::from(y) + 0.5);
            pixels.push([x, y]);
            rays.push(Ray { origin: basis.start(camera.eye, at, size), direction: basis.direction(at, size), t_min: 0.0, t_max: frame.max_distance });
        }
    }
    let met = reference.trace(&rays, footprint, scene.blocks.extent);
    // Those that meet something, until they are as near to it as a pixel is wide.
    let mut going: Vec<(usize, f64, f64)> = met.iter().enumerate().filter(|(_, hit)| hit.hit).map(|(i, hit)| (i, 0.0, hit.t)).collect();
    let count = going.len();
    let mut passed: Vec<usize> = Vec::new();
    let field = reference.field();
    for _ in 0..LOOKS {
        let points: Vec<Vec3> = going.iter().filter_map(|(ray, t, _)| rays.get(*ray).map(|ray| along(ray.origin, ray.direction, *t))).collect();
        let mut values = vec![0.0; points.len()];
        field.evaluator().at(&points, &[], |i, found| {
            if let (Some(slot), Some(value)) = (values.get_mut(i), found.first()) {
                *slot = *value;
            }
        });
        let mut next = Vec::with_capacity(going.len());
        for ((ray, t, end), value) in going.into_iter().zip(values) {
            let is_beyond = t > end * (1.0 + OFF);
            if is_beyond {
                passed.push(ray);
            } else if value > 0.5 * footprint * t {
                next.push((ray, t + share * value, end));
            }
        }
        going = next;
        if going.is_empty() {
            break;
        }
    }
    passed.sort_unstable();
    let hole = |ray: usize| Some((rays.get(ray)?.at(met.get(ray)?.t), *pixels.get(ray)?));
    Ok(ByHand { proven: proven(scene, said), rays: count, holes: passed.into_iter().filter_map(hole).collect() })
}

/// The largest share of the whole field that no ray steps too far with. A field that jumps has none: at a jump it is as steep as a wall.
fn proven(scene: &Compiled, said: &[Diagnostic]) -> Option<f64> {
    if said.iter().any(|said| matches!(said.code, Code::Jump | Code::Unproven)) {
        return None;
    }
    let value = scene.graph.shape(scene.root)?.value;
    let domain = Domain::of(Box3::cube(scene.blocks.extent));
    let constant = Facts::default().constant(&scene.graph, value, &domain, SEARCH).lipschitz;
    (constant.is_finite() && constant > 0.0).then_some(1.0 / constant)
}
