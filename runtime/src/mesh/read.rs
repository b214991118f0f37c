//! The formats: OBJ, STL, PLY, glTF and GLB.

use crate::mesh::raw::{LARGEST_FILE, MOST_TRIANGLES, MOST_VERTICES, Raw};
use base64::Engine;
use glam::{Mat4, Vec3};
use gltf::accessor::{DataType, Dimensions};
use gltf::mesh::Mode;
use std::collections::HashMap;
use std::io::{BufReader, Cursor};
use surefoot_compiler::compiled::Loader;
use surefoot_compiler::program::load::join;

/// What the bytes of a file say. `loader` reads what else it names.
pub(super) fn read(loader: &dyn Loader, path: &str, bytes: &[u8]) -> Result<Raw, String> {
    if bytes.is_empty() {
        return Err("the file is empty".to_owned());
    }
    let end = path.rsplit_once('.').map(|(_, end)| end.to_ascii_lowercase());
    match end.as_deref() {
        Some("obj") => obj(bytes),
        Some("stl") => stl(bytes),
        Some("ply") => ply(bytes),
        Some("gltf" | "glb") => gltf(loader, path, bytes),
        _ => Err("its format is not known: write a file whose name ends in .obj, .gltf, .glb, .stl or .ply".to_owned()),
    }
}

fn threes(numbers: &[f32]) -> Vec<[f32; 3]> {
    numbers.chunks_exact(3).map(|c| [c[0], c[1], c[2]]).collect()
}

impl Raw {
    /// Adds another part of the same mesh.
    fn add(&mut self, part: Raw) -> Result<(), String> {
        let first = self.positions.len();
        if first + part.positions.len() > MOST_VERTICES || (self.indices.len() + part.indices.len()) / 3 > MOST_TRIANGLES {
            return Err("it has too many vertices".to_owned());
        }
        // What only some parts have is made for the others: a zero normal is none.
        let total = first + part.positions.len();
        if !part.normals.is_empty() || !self.normals.is_empty() {
            self.normals.resize(first, [0.0; 3]);
            self.normals.extend(part.normals);
            self.normals.resize(total, [0.0; 3]);
        }
        if !part.coordinates.is_empty() || !self.coordinates.is_empty() {
            self.coordinates.resize(first, [0.0; 2]);
            self.coordinates.extend(part.coordinates);
            self.coordinates.resize(total, [0.0; 2]);
        }
        self.positions.extend(part.positions);
        for index in part.indices {
            let index = u64::from(index) + first as u64;
            // One beyond the part is found out later as one beyond the whole.
            self.indices.push(if index < total as u64 { index as u32 } else { u32::MAX });
        }
        Ok(())
    }
}

fn obj(bytes: &[u8]) -> Result<Raw, String> {
    let options = tobj::LoadOptions { single_index: true, triangulate: true, ignore_points: true, ignore_lines: true };
    // Its materials are the scene's.
    let (models, _) = tobj::load_obj_buf(&mut BufReader::new(bytes), &options, |_| Ok((Vec::new(), Default::default())))
        .map_err(|why| format!("it is no OBJ file: {why}"))?;
    let mut raw = Raw::default();
    for tobj::Model { mesh, .. } in models {
        let positions = threes(&mesh.positions);
        let normals = threes(&mesh.normals);
        // An image's rows begin at the top, and OBJ's at the bottom.
        let coordinates: Vec<[f32; 2]> = mesh.texcoords.chunks_exact(2).map(|c| [c[0], 1.0 - c[1]]).collect();
        let complete = |length: usize| length == positions.len();
        raw.add(Raw {
            normals: if complete(normals.len()) { normals } else { Vec::new() },
            coordinates: if complete(coordinates.len()) { coordinates } else { Vec::new() },
            positions,
            indices: mesh.indices,
        })?;
    }
    Ok(raw)
}

fn stl(bytes: &[u8]) -> Result<Raw, String> {
    let why = |why: std::io::Error| format!("it is no STL file: {why}");
    // The binary form begins with 80 bytes of anything, even with the word that the text begins with.
    let count = bytes.get(80..84).map_or(0, |c| u32::from_le_bytes([c[0], c[1], c[2], c[3]]) as usize);
    let binary = count > 0 && bytes.len() == 84 + 50 * count;
    if !binary && !bytes.trim_ascii_start().starts_with(b"solid") {
        return Err(format!("it says that it has {count} triangles, and has {}", bytes.len().saturating_sub(84) / 50));
    }
    let mut raw = Raw::default();
    // Corners at one place are one.
    let mut known: HashMap<[u32; 3], u32> = HashMap::new();
    let mut corner = |position: [f32; 3]| {
        let next = raw.positions.len() as u32;
        let index = *known.entry(position.map(|c| (c + 0.0).to_bits())).or_insert(next);
        if index == next {
            raw.positions.push(position);
        }
        raw.indices.push(index);
    };
    if binary {
        // The crate would take a name in the header for the word `solid` of the text.
        let mut plain = bytes.to_vec();
        plain[..80].fill(b' ');
        for triangle in stl_io::create_stl_reader(&mut Cursor::new(plain)).map_err(why)? {
            triangle.map_err(why)?.vertices.into_iter().for_each(|v| corner(v.0));
        }
    } else {
        let start = bytes.len() - bytes.trim_ascii_start().len();
        // The name may be left out; the crate wants at least a space.
        let mut text = b"solid ".to_vec();
        text.extend_from_slice(&bytes[start + 5..]);
        for triangle in stl_io::create_stl_reader(&mut Cursor::new(text)).map_err(why)? {
            triangle.map_err(why)?.vertices.into_iter().for_each(|v| corner(v.0));
        }
    }
    Ok(raw)
}

/// A vertex or a face of a PLY file.
#[derive(Default)]
struct Element {
    position: [f32; 3],
    normal: [f32; 3],
    coordinates: [f32; 2],
    corners: Vec<u32>,
}

impl ply_rs_bw::ply::PropertyAccess for Element {
    fn new() -> Self {
        Self::default()
    }

    fn set_property(&mut self, name: &str, value: ply_rs_bw::ply::Property) -> ply_rs_bw::ply::PropertyAccessResult {
        let number = value.to_f32_lossy();
        let slot = match name {
            "x" => &mut self.position[0],
            "y" => &mut self.position[1],
            "z" => &mut self.position[2],
            "nx" => &mut self.normal[0],
            "ny" => &mut self.normal[1],
            "nz" => &mut self.normal[2],
            "s" | "u" | "texture_u" => &mut self.coordinates[0],
            "t" | "v" | "texture_v" => &mut self.coordinates[1],
            "vertex_indices" | "vertex_index" => {
                // A list of whole numbers of any kind; a negative one is beyond every vertex.
                self.corners = match value {
                    ply_rs_bw::ply::Property::ListInt(list) => list.into_iter().map(|i| u32::try_from(i).unwrap_or(u32::MAX)).collect(),
                    other => other.to_u32_list().unwrap_or_default(),
                };
                return ply_rs_bw::ply::PropertyAccessResult::Set;
            }
            _ => return ply_rs_bw::ply::PropertyAccessResult::Ignored,
        };
        if let Some(number) = number {
            *slot = number;
        }
        ply_rs_bw::ply::PropertyAccessResult::Set
    }
}

fn ply(bytes: &[u8]) -> Result<Raw, String> {
    let why = |why: &dyn std::fmt::Display| format!("it is no PLY file: {why}");
    let parser = ply_rs_bw::parser::Parser::<Element>::new();
    let mut reader = ply_rs_bw::parser::Reader::new(BufReader::new(bytes));
    let header = parser.read_header(&mut reader).map_err(|e| why(&e))?;
    let mut raw = Raw::default();
    for (name, element) in &header.elements {
        // Each takes at least a byte; more than there are bytes would be memory for nothing.
        if element.count > bytes.len() {
            return Err(format!("it says that it has {} of `{name}`, and is {} bytes long", element.count, bytes.len()));
        }
        let has = |property: &str| element.properties.contains_key(property);
        let list = parser.read_payload_for_element(&mut reader, element, &header).map_err(|e| why(&e))?;
        match name.as_str() {
            "vertex" => {
                if !(has("x") && has("y") && has("z")) {
                    return Err("its vertices have no `x`, `y` and `z`".to_owned());
                }
                raw.positions = list.iter().map(|e| e.position).collect();
                if has("nx") {
                    raw.normals = list.iter().map(|e| e.normal).collect();
                }
                if ["s", "u", "texture_u"].into_iter().any(has) {
                    raw.coordinates = list.iter().map(|e| [e.coordinates[0], 1.0 - e.coordinates[1]]).collect();
                }
            }
            "face" => {
                for face in list {
                    let Some((&first, rest)) = face.corners.split_first() else { continue };
                    raw.indices.extend(rest.windows(2).flat_map(|pair| [first, pair[0], pair[1]]));
                }
            }
            _ => {}
        }
    }
    Ok(raw)
}

/// How deep nodes of a glTF file may stand in each other.
const DEEPEST: u32 = 256;

fn gltf(loader: &dyn Loader, path: &str, bytes: &[u8]) -> Result<Raw, String> {
    let why = |why: gltf::Error| format!("it is no glTF file: {why}");
    let gltf::Gltf { document, mut blob } = gltf::Gltf::from_slice(bytes).map_err(why)?;
    let mut buffers = Vec::new();
    for buffer in document.buffers() {
        let data = match buffer.source() {
            gltf::buffer::Source::Bin => blob.take().ok_or("its binary part is missing")?,
            gltf::buffer::Source::Uri(uri) => match uri.strip_prefix("data:") {
                Some(inline) => {
                    let (_, text) = inline.split_once(";base64,").ok_or("a buffer within its text is not base64")?;
                    base64::engine::general_purpose::STANDARD.decode(text).map_err(|e| format!("a buffer within its text is broken: {e}"))?
                }
                None => {
                    let name = join(path, &unescape(uri));
                    loader.read_up_to(&name, LARGEST_FILE).map_err(|why| format!("its buffer `{name}` can't be read: {why}"))?
                }
            },
        };
        if data.len() < buffer.length() {
            return Err(format!("a buffer should have {} bytes and has {}", buffer.length(), data.len()));
        }
        buffers.push(data);
    }
    let mut raw = Raw::default();
    let scene = document.default_scene().or_else(|| document.scenes().next()).ok_or("it has no scene")?;
    let mut visited = 0;
    for node in scene.nodes() {
        gltf_node(&node, Mat4::IDENTITY, DEEPEST, &mut visited, &buffers, &mut raw)?;
    }
    Ok(raw)
}

/// A name in which `%20` stands for a space.
fn unescape(uri: &str) -> String {
    let mut bytes = Vec::new();
    let mut rest = uri.as_bytes();
    while let Some((&byte, after)) = rest.split_first() {
        let code = after.get(..2).and_then(|h| std::str::from_utf8(h).ok()).and_then(|h| u8::from_str_radix(h, 16).ok());
        match code {
            Some(code) if byte == b'%' => {
                bytes.push(code);
                rest = &after[2..];
            }
            _ => {
                bytes.push(byte);
                rest = after;
            }
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

fn gltf_node(node: &gltf::Node, above: Mat4, depth: u32, visited: &mut u32, buffers: &[Vec<u8>], raw: &mut Raw) -> Result<(), String> {
    *visited += 1;
    if depth == 0 || *visited > 1 << 20 {
        return Err("its nodes stand in each other without end".to_owned());
    }
    let place = above * Mat4::from_cols_array_2d(&node.transform().matrix());
    if let Some(mesh) = node.mesh() {
        for primitive in mesh.primitives() {
            let mut part = gltf_primitive(&primitive, buffers)?;
            for p in &mut part.positions {
                *p = place.transform_point3(Vec3::from(*p)).into();
            }
            // Normals stay upright on what is stretched.
            let turn = place.inverse().transpose();
            for n in &mut part.normals {
                *n = turn.transform_vector3(Vec3::from(*n)).into();
            }
            if place.determinant() < 0.0 {
                part.indices.chunks_exact_mut(3).for_each(|t| t.swap(1, 2));
            }
            raw.add(part)?;
        }
    }
    for child in node.children() {
        gltf_node(&child, place, depth - 1, visited, buffers, raw)?;
    }
    Ok(())
}

/// Whether all that an accessor speaks of is there.
fn gltf_check(accessor: &gltf::Accessor, buffers: &[Vec<u8>], dimensions: Dimensions, types: &[DataType]) -> Result<(), String> {
    if accessor.dimensions() != dimensions || !types.contains(&accessor.data_type()) {
        return Err("its numbers are of a kind that is not expected there".to_owned());
    }
    if accessor.sparse().is_some() {
        return Err("it has sparse accessors, which are not read".to_owned());
    }
    let view = accessor.view().ok_or("an accessor has no view")?;
    let (size, count) = (accessor.size(), accessor.count());
    let stride = view.stride().unwrap_or(size);
    let needed = count.checked_sub(1).and_then(|c| c.checked_mul(stride)).and_then(|n| n.checked_add(size)).and_then(|n| n.checked_add(accessor.offset()));
    let end = view.offset().checked_add(view.length());
    let held = buffers.get(view.buffer().index()).map_or(0, Vec::len);
    match (needed, end) {
        (Some(needed), Some(end)) if stride >= size && needed <= view.length() && end <= held => Ok(()),
        _ => Err("an accessor goes beyond its buffer".to_owned()),
    }
}

fn gltf_primitive(primitive: &gltf::Primitive, buffers: &[Vec<u8>]) -> Result<Raw, String> {
    let reader = primitive.reader(|buffer| buffers.get(buffer.index()).map(Vec::as_slice));
    let positions = primitive.get(&gltf::Semantic::Positions).ok_or("a part has no positions")?;
    gltf_check(&positions, buffers, Dimensions::Vec3, &[DataType::F32])?;
    let mut raw = Raw { positions: reader.read_positions().into_iter().flatten().collect(), ..Raw::default() };
    if let Some(normals) = primitive.get(&gltf::Semantic::Normals) {
        gltf_check(&normals, buffers, Dimensions::Vec3, &[DataType::F32])?;
        raw.normals = reader.read_normals().into_iter().flatten().collect();
    }
    if let Some(coordinates) = primitive.get(&gltf::Semantic::TexCoords(0)) {
        gltf_check(&coordinates, buffers, Dimensions::Vec2, &[DataType::F32, DataType::U16, DataType::U8])?;
        raw.coordinates = reader.read_tex_coords(0).into_iter().flat_map(|c| c.into_f32()).collect();
    }
    let order: Vec<u32> = match primitive.indices() {
        Some(indices) => {
            gltf_check(&indices, buffers, Dimensions::Scalar, &[DataType::U8, DataType::U16, DataType::U32])?;
            reader.read_indices().into_iter().flat_map(|i| i.into_u32()).collect()
        }
        None => (0..raw.positions.len() as u32).collect(),
    };
    raw.indices = match primitive.mode() {
        Mode::Triangles => order.chunks_exact(3).flatten().copied().collect(),
        Mode::TriangleStrip => {
            // Every other one is turned round.
            let triangle = |(i, w): (usize, &[u32])| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[1], w[0], w[2]] };
            order.windows(3).enumerate().flat_map(triangle).collect()
        }
        Mode::TriangleFan => order.split_first().map_or(Vec::new(), |(first, rest)| rest.windows(2).flat_map(|w| [*first, w[0], w[1]]).collect()),
        Mode::Points | Mode::Lines | Mode::LineLoop | Mode::LineStrip => Vec::new(),
    };
    // A part may lack what others have; an index beyond a part is one beyond all.
    raw.normals.resize(if raw.normals.is_empty() { 0 } else { raw.positions.len() }, [0.0; 3]);
    raw.coordinates.resize(if raw.coordinates.is_empty() { 0 } else { raw.positions.len() }, [0.0; 2]);
    Ok(raw)
}
