//! Normals where a file has none: the mean of those of the triangles about a corner, weighted by their angles there (Thürmer and Wüthrich,
//! "Computing Vertex Normals from Polygonal Facets", 1998), and none across an edge that is sharper than a crease.

use crate::mesh::raw::{MOST_VERTICES, Raw, Vertex};
use glam::Vec3;
use std::collections::HashMap;

/// Beyond this angle between two triangles an edge is one to be seen: its cosine. 45 degrees.
const CREASE: f32 = 0.707;
/// Where more triangles meet, all count: to compare each with each would take long.
const MOST_AROUND: usize = 64;

/// Vertices with normals. A corner that needs two normals becomes two.
pub(super) fn complete(raw: Raw, mapped: bool) -> Result<(Vec<Vertex>, Vec<u32>), String> {
    let Raw { positions, normals, coordinates, indices } = raw;
    let given = |i: usize| normals.get(i).map(|n| Vec3::from(*n)).and_then(Vec3::try_normalize);
    let image = |i: usize| if mapped { coordinates[i] } else { [0.0; 2] };
    if normals.len() == positions.len() && (0..positions.len()).all(|i| given(i).is_some()) {
        let vertex = |(i, position): (usize, &[f32; 3])| Vertex {
            position: *position,
            normal: given(i).unwrap_or(Vec3::Y).into(),
            coordinates: image(i),
        };
        return Ok((positions.iter().enumerate().map(vertex).collect(), indices));
    }
    let faces = faces(&positions, &indices);
    let around = around(&positions, &indices);
    let mut known: HashMap<(u32, [u32; 3]), u32> = HashMap::new();
    let mut vertices = Vec::with_capacity(positions.len());
    let mut out = Vec::with_capacity(indices.len());
    for (corner, &index) in indices.iter().enumerate() {
        let i = index as usize;
        let own = faces[corner / 3].0;
        let group = &around.corners[around.starts[around.place[i] as usize] as usize..around.starts[around.place[i] as usize + 1] as usize];
        let mut sum = Vec3::ZERO;
        for &other in group {
            let (normal, angles) = faces[other as usize / 3];
            if group.len() > MOST_AROUND || own == Vec3::ZERO || normal.dot(own) > CREASE {
                sum += normal * angles[other as usize % 3];
            }
        }
        let normal = given(i).or(sum.try_normalize()).unwrap_or(if own == Vec3::ZERO { Vec3::Y } else { own });
        let normal: [f32; 3] = normal.into();
        let next = vertices.len() as u32;
        let at = *known.entry((index, normal.map(f32::to_bits))).or_insert(next);
        if at == next {
            if vertices.len() >= MOST_VERTICES {
                return Err("it has too many corners".to_owned());
            }
            vertices.push(Vertex { position: positions[i], normal, coordinates: image(i) });
        }
        out.push(at);
    }
    Ok((vertices, out))
}

/// Normal and angles of each triangle; zero where it has no area.
fn faces(positions: &[[f32; 3]], indices: &[u32]) -> Vec<(Vec3, [f32; 3])> {
    let face = |corners: &[u32]| {
        let [a, b, c] = [0, 1, 2].map(|i| Vec3::from(positions[corners[i] as usize]));
        // In units of its longest side, so that nothing overflows and the smallest triangle has a normal.
        let size = (b - a).abs().max_element().max((c - a).abs().max_element());
        if size == 0.0 {
            return (Vec3::ZERO, [0.0; 3]);
        }
        let [ab, bc, ca] = [(b - a) / size, (c - b) / size, (a - c) / size];
        let normal = ab.cross(-ca).normalize_or_zero();
        (normal, [ab.angle_between(-ca), bc.angle_between(-ab), ca.angle_between(-bc)].map(|a| if a.is_finite() { a } else { 0.0 }))
    };
    indices.chunks_exact(3).map(face).collect()
}

/// Which corners of triangles stand at one place, though a file may number them apart.
struct Around {
    /// The place of each position.
    place: Vec<u32>,
    /// Where each place's corners begin in the list.
    starts: Vec<u32>,
    corners: Vec<u32>,
}

fn around(positions: &[[f32; 3]], indices: &[u32]) -> Around {
    let mut places: HashMap<[u32; 3], u32> = HashMap::with_capacity(positions.len());
    let place: Vec<u32> = positions
        .iter()
        .map(|p| {
            let next = places.len() as u32;
            // `+ 0` makes one zero of both.
            *places.entry(p.map(|c| (c + 0.0).to_bits())).or_insert(next)
        })
        .collect();
    let mut starts = vec![0u32; places.len() + 1];
    for &index in indices {
        starts[place[index as usize] as usize + 1] += 1;
    }
    for i in 1..starts.len() {
        starts[i] += starts[i - 1];
    }
    let mut next = starts.clone();
    let mut corners = vec![0; indices.len()];
    for (corner, &index) in indices.iter().enumerate() {
        let slot = &mut next[place[index as usize] as usize];
        corners[*slot as usize] = corner as u32;
        *slot += 1;
    }
    Around { place, starts, corners }
}
