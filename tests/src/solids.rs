//! Meshes whose form is known by a formula, as files of each format.

/// Corners and triangles, seen from outside against the clock.
#[derive(Clone, Debug, Default)]
pub struct Solid {
    /// The corners.
    pub corners: Vec<[f32; 3]>,
    /// Indices of three corners each.
    pub triangles: Vec<[u32; 3]>,
}

/// A sphere of radius 1: `rows` from pole to pole, twice as many around. No point of a triangle is further inside than
/// [`sphere_error`].
pub fn sphere(rows: u32) -> Solid {
    let around = 2 * rows;
    let mut solid = Solid::default();
    for row in 0..=rows {
        for turn in 0..around {
            let (a, b) = (std::f64::consts::PI * f64::from(row) / f64::from(rows), std::f64::consts::TAU * f64::from(turn) / f64::from(around));
            // The corners at a pole are at one place, to the last digit.
            let out = if row == 0 || row == rows { 0.0 } else { a.sin() };
            solid.corners.push([out * b.cos(), a.cos(), -out * b.sin()].map(|c| c as f32));
        }
    }
    for row in 0..rows {
        for turn in 0..around {
            let next = (turn + 1) % around;
            let [a, b] = [turn, next].map(|t| row * around + t);
            let [c, d] = [turn, next].map(|t| (row + 1) * around + t);
            if row > 0 {
                solid.triangles.push([a, c, b]);
            }
            if row + 1 < rows {
                solid.triangles.push([b, c, d]);
            }
        }
    }
    solid
}

/// How far the flat sides of [`sphere`] lie within the true one at most: a chord of two steps across.
pub fn sphere_error(rows: u32) -> f64 {
    1.0 - (std::f64::consts::PI / f64::from(rows) / std::f64::consts::SQRT_2).cos()
}

/// A cuboid about the origin.
pub fn cuboid(size: [f32; 3]) -> Solid {
    let corners = (0..8).map(|i| [0, 1, 2].map(|axis| size[axis] * (if i >> axis & 1 == 1 { 0.5 } else { -0.5 }))).collect();
    let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    Solid { corners, triangles: sides.iter().flat_map(|[a, b, c, d]| [[*a, *b, *c], [*a, *c, *d]]).collect() }
}

/// The trefoil knot about z, as a tube: its middle runs along ((2 + cos 3t) cos 2t, (2 + cos 3t) sin 2t, sin 3t), `along` points of it, `around` about
/// each.
pub fn knot(radius: f64, along: u32, around: u32) -> Solid {
    let middle = |t: f64| {
        let out = 2.0 + (3.0 * t).cos();
        [out * (2.0 * t).cos(), out * (2.0 * t).sin(), (3.0 * t).sin()]
    };
    let minus = |a: [f64; 3], b: [f64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let cross = |a: [f64; 3], b: [f64; 3]| [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
    let unit = |a: [f64; 3]| a.map(|c| c / (a[0] * a[0] + a[1] * a[1] + a[2] * a[2]).sqrt());
    let mut solid = Solid::default();
    for i in 0..along {
        let t = std::f64::consts::TAU * f64::from(i) / f64::from(along);
        let p = middle(t);
        let forward = unit(minus(middle(t + 1e-4), middle(t - 1e-4)));
        // Out of the circle that it winds about: it never runs that way.
        let out = unit(minus(p, [2.0 * (2.0 * t).cos(), 2.0 * (2.0 * t).sin(), 0.0]));
        let side = unit(cross(forward, out));
        let up = cross(side, forward);
        for k in 0..around {
            let a = std::f64::consts::TAU * f64::from(k) / f64::from(around);
            let corner = [0, 1, 2].map(|j| p[j] + radius * (a.cos() * up[j] + a.sin() * side[j]));
            // As many digits as are written.
            solid.corners.push(corner.map(|c| ((c * 1e3).round() / 1e3) as f32));
            let [a, b] = [k, (k + 1) % around].map(|k| i * around + k);
            let [c, d] = [k, (k + 1) % around].map(|k| (i + 1) % along * around + k);
            solid.triangles.extend([[a, b, c], [b, d, c]]);
        }
    }
    solid
}

impl Solid {
    /// As an OBJ file.
    pub fn obj(&self) -> Vec<u8> {
        let mut text = String::from("# a solid\n");
        for [x, y, z] in &self.corners {
            text += &format!("v {x} {y} {z}\n");
        }
        for t in &self.triangles {
            let [a, b, c] = t.map(|i| i + 1);
            text += &format!("f {a} {b} {c}\n");
        }
        text.into_bytes()
    }

    /// As a binary STL file.
    pub fn stl(&self) -> Vec<u8> {
        let mut bytes = b"solid but binary".to_vec();
        bytes.resize(80, 0);
        bytes.extend((self.triangles.len() as u32).to_le_bytes());
        for t in &self.triangles {
            bytes.extend([0u8; 12]);
            for i in t {
                bytes.extend(self.corners[*i as usize].iter().flat_map(|c| c.to_le_bytes()));
            }
            bytes.extend([0u8; 2]);
        }
        bytes
    }

    /// As an STL file of text.
    pub fn stl_text(&self) -> Vec<u8> {
        let mut text = String::from("solid\n");
        for t in &self.triangles {
            text += "facet normal 0 0 0\nouter loop\n";
            for i in t {
                let [x, y, z] = self.corners[*i as usize];
                text += &format!("vertex {x} {y} {z}\n");
            }
            text += "endloop\nendfacet\n";
        }
        (text + "endsolid\n").into_bytes()
    }

    fn ply_head(&self, format: &str) -> String {
        let (corners, faces) = (self.corners.len(), self.triangles.len());
        format!(
            "ply\nformat {format} 1.0\nelement vertex {corners}\nproperty float x\nproperty float y\nproperty float z\n\
             element face {faces}\nproperty list uchar int vertex_indices\nend_header\n"
        )
    }

    /// As a PLY file of text.
    pub fn ply_text(&self) -> Vec<u8> {
        let mut text = self.ply_head("ascii");
        for [x, y, z] in &self.corners {
            text += &format!("{x} {y} {z}\n");
        }
        for [a, b, c] in &self.triangles {
            text += &format!("3 {a} {b} {c}\n");
        }
        text.into_bytes()
    }

    /// As a binary PLY file.
    pub fn ply(&self) -> Vec<u8> {
        let mut bytes = self.ply_head("binary_little_endian").into_bytes();
        bytes.extend(self.corners.iter().flatten().flat_map(|c| c.to_le_bytes()));
        for t in &self.triangles {
            bytes.push(3);
            bytes.extend(t.iter().flat_map(|i| i.to_le_bytes()));
        }
        bytes
    }

    /// The numbers of a glTF file: corners, then indices.
    pub fn gltf_buffer(&self) -> Vec<u8> {
        let mut bytes: Vec<u8> = self.corners.iter().flatten().flat_map(|c| c.to_le_bytes()).collect();
        bytes.extend(self.triangles.iter().flatten().flat_map(|i| i.to_le_bytes()));
        bytes
    }

    /// The text of a glTF file. `uri` says where the numbers are; a GLB file has them itself.
    pub fn gltf(&self, uri: Option<&str>) -> String {
        let bound = |pick: fn(f32, f32) -> f32| {
            let first = self.corners.first().copied().unwrap_or_default();
            self.corners.iter().fold(first, |m, c| [pick(m[0], c[0]), pick(m[1], c[1]), pick(m[2], c[2])])
        };
        let (low, high) = (bound(f32::min), bound(f32::max));
        let (corners, indices) = (self.corners.len(), 3 * self.triangles.len());
        let (split, end) = (12 * corners, 12 * corners + 4 * indices);
        let uri = uri.map_or(String::new(), |uri| format!("\"uri\":\"{uri}\","));
        format!(
            "{{\"asset\":{{\"version\":\"2.0\"}},\"scene\":0,\"scenes\":[{{\"nodes\":[0]}}],\"nodes\":[{{\"mesh\":0}}],\
             \"meshes\":[{{\"primitives\":[{{\"attributes\":{{\"POSITION\":0}},\"indices\":1}}]}}],\
             \"buffers\":[{{{uri}\"byteLength\":{end}}}],\
             \"bufferViews\":[{{\"buffer\":0,\"byteLength\":{split}}},{{\"buffer\":0,\"byteOffset\":{split},\"byteLength\":{}}}],\
             \"accessors\":[{{\"bufferView\":0,\"componentType\":5126,\"count\":{corners},\"type\":\"VEC3\",\"min\":{low:?},\"max\":{high:?}}},\
             {{\"bufferView\":1,\"componentType\":5125,\"count\":{indices},\"type\":\"SCALAR\"}}]}}",
            4 * indices
        )
    }

    /// As a GLB file.
    pub fn glb(&self) -> Vec<u8> {
        let mut text = self.gltf(None).into_bytes();
        text.resize(text.len().next_multiple_of(4), b' ');
        let buffer = self.gltf_buffer();
        let mut bytes = b"glTF".to_vec();
        let length = 12 + 8 + text.len() + 8 + buffer.len();
        for part in [2, length as u32, text.len() as u32] {
            bytes.extend(part.to_le_bytes());
        }
        bytes.extend(b"JSON");
        bytes.extend(text);
        bytes.extend((buffer.len() as u32).to_le_bytes());
        bytes.extend(b"BIN\0");
        bytes.extend(buffer);
        bytes
    }
}
