//! What images lay on surfaces: the twin of `runtime/src/passes/layers`.

use super::march::at_points;
use super::shade::{Seen, SurfaceValues};
use crate::vector::{Vec3, add, dot, length, mul, scale, sub, unit};
use crate::evaluate::Tape;
use crate::functions::Surface;
use crate::graph::Slot;
use crate::images::{Images, Texture, TextureKind, sides};

/// Lays the layers of a surface, of which `tape` computes the numbers, on places: changes how they answer light, and leans their normals as their
/// relief says.
pub fn lay(surface: &Surface, tape: &Tape, images: &Images, footprint: f64, places: &mut [Seen], surfaces: &mut [SurfaceValues]) {
    let textures = surface.textures();
    let points: Vec<Vec3> = places.iter().map(|s| s.point).collect();
    let normals: Vec<Vec3> = places.iter().map(|s| s.normal).collect();
    at_points(tape, &points, &normals, |i, values| {
        let (Some(seen), Some(values_of)) = (places.get_mut(i), surfaces.get_mut(i)) else { return };
        let three = |at: usize| [0, 1, 2].map(|i| values.get(at + i).copied().unwrap_or(0.0));
        let first = if surface.relief.is_some() { 3 } else { 0 };
        let mut rise = if first == 3 { three(0) } else { [0.0; 3] };
        for (at, layer) in (first..).step_by(16).zip(&surface.layers) {
            let (weight, point) = (three(at), three(at + 3));
            let axes = [three(at + 6), three(at + 9), three(at + 12)];
            let kind = TextureKind::of(layer.slot);
            let texture = textures.iter().position(|t| *t == (layer.image, kind)).and_then(|t| images.textures.get(t));
            let Some(texture) = texture.filter(|_| weight != [0.0; 3]) else { continue };
            let shares = sides(axes, seen.normal, values.get(at + 15).copied().unwrap_or(1.0));
            let size = footprint * seen.t * axes.iter().map(|a| length(*a)).fold(0.0, f64::max);
            let color = |texture: &Texture| mul(weight, texture.lay(point, shares, size));
            match layer.slot {
                Slot::Color => values_of.color = add(values_of.color, color(texture)),
                Slot::Roughness => values_of.roughness += color(texture)[1],
                Slot::Metallic => values_of.metallic += color(texture)[2],
                Slot::Relief => {
                    let own = texture.rise(point, shares, size);
                    let along = axes.iter().zip(own).fold([0.0; 3], |sum, (axis, g)| add(sum, scale(*axis, g)));
                    rise = add(rise, mul(weight, along));
                }
            }
        }
        let n = seen.normal;
        let aside = sub(rise, scale(n, dot(rise, n)));
        seen.normal = unit(sub(n, aside)).unwrap_or(n);
    });
}
