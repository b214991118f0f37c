//! Flat faces of many corners as triangles.

use crate::vector::{Vec3, add, cross, dot, length, scale, sub};
use std::collections::BTreeMap;

/// A corner lies no farther off the plane of its face than this share of the face's size.
const FLAT: f64 = 1e-4;

/// Triangles of flat faces, each a list of corners by their number. An error says which face is none, from 0 on. Edges that are not of two faces are errors too.
pub fn triangles(points: &[Vec3], faces: &[Vec<usize>]) -> Result<Vec<[u32; 3]>, (usize, String)> {
    let mut first_at: BTreeMap<[u64; 3], usize> = BTreeMap::new();
    // Points at one place are one.
    let same: Vec<usize> = points.iter().enumerate().map(|(i, p)| *first_at.entry(p.map(|c| (c + 0.0).to_bits())).or_insert(i)).collect();
    let mut edges: BTreeMap<[usize; 2], (usize, usize)> = BTreeMap::new();
    let mut all = Vec::new();
    for (at, face) in faces.iter().enumerate() {
        let corners: Vec<usize> = face
            .iter()
            .map(|i| same.get(*i).copied().ok_or_else(|| (at, format!("it names point {i}, and there are {}: they are counted from 0", points.len()))))
            .collect::<Result<_, _>>()?;
        let count = corners.len();
        if count < 3 {
            return Err((at, format!("it has {count} corner{}, and needs 3", if count == 1 { "" } else { "s" })));
        }
        for (i, (a, b)) in corners.iter().zip(corners.iter().cycle().skip(1)).enumerate() {
            if corners.iter().skip(i + 1).any(|other| other == a) {
                return Err((at, format!("it comes to point {a} twice")));
            }
            edges.entry([*a.min(b), *a.max(b)]).or_insert((0, at)).0 += 1;
        }
        all.extend(cut(points, &corners).map_err(|why| (at, why))?);
    }
    match edges.into_iter().find(|(_, (count, _))| *count != 2) {
        Some(([a, b], (1, at))) => Err((at, format!("its edge from point {a} to point {b} belongs to no other face, so the solid is open there"))),
        Some(([a, b], (count, at))) => Err((at, format!("its edge from point {a} to point {b} belongs to {count} faces, and an edge has two"))),
        None => Ok(all),
    }
}

/// One face, ear by ear (Meisters, "Polygons have ears", 1975).
fn cut(points: &[Vec3], corners: &[usize]) -> Result<Vec<[u32; 3]>, String> {
    let place = |i: usize| points.get(i).copied().unwrap_or_default();
    let origin = corners.first().map_or([0.0; 3], |i| place(*i));
    let ways: Vec<Vec3> = corners.iter().map(|i| sub(place(*i), origin)).collect();
    let size = ways.iter().map(|way| length(*way)).fold(0.0, f64::max);
    let normal = ways.windows(2).fold([0.0; 3], |sum, pair| match pair {
        [a, b] => add(sum, cross(*a, *b)),
        _ => sum,
    });
    let area = length(normal);
    if area.is_nan() || area <= 1e-12 * size * size {
        return Err("it has no area".to_owned());
    }
    let normal = scale(normal, 1.0 / area);
    let middle = scale(ways.iter().fold([0.0; 3], |sum, way| add(sum, *way)), 1.0 / ways.len() as f64);
    if let Some((way, i)) = ways.iter().zip(corners).find(|(way, _)| dot(sub(**way, middle), normal).abs() > FLAT * size) {
        let off = dot(sub(*way, middle), normal).abs();
        return Err(format!("it is not flat: point {i} lies {off:.2e} off its plane; cut it into triangles"));
    }
    let mut left: Vec<(usize, Vec3)> = corners.iter().copied().zip(ways).collect();
    let turn = |a: Vec3, b: Vec3, c: Vec3| dot(cross(sub(b, a), sub(c, a)), normal);
    let mut all = Vec::new();
    while left.len() > 3 {
        let count = left.len();
        let at = |i: usize| left.get(i % count).copied().unwrap_or_default();
        let is_ear = |i: &usize| {
            let [(a, p), (b, q), (c, r)] = [at(i + count - 1), at(*i), at(i + 1)];
            let is_outside = |&(i, s): &(usize, Vec3)| [a, b, c].contains(&i) || turn(p, q, s) < 0.0 || turn(q, r, s) < 0.0 || turn(r, p, s) < 0.0;
            turn(p, q, r) > 1e-14 * area && left.iter().all(is_outside)
        };
        let Some(ear) = (0..count).find(is_ear) else { return Err("its edges cross each other, or turn back".to_owned()) };
        all.push([at(ear + count - 1), at(ear), at(ear + 1)].map(|(i, _)| i as u32));
        left.remove(ear);
    }
    if let &[(a, p), (b, q), (c, r)] = &left[..] {
        if turn(p, q, r) <= 0.0 {
            return Err("its edges cross each other, or turn back".to_owned());
        }
        all.push([a, b, c].map(|i| i as u32));
    }
    Ok(all)
}
