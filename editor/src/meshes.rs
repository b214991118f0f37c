//! Meshes as files. All are closed surfaces without normals of their own, so that a reader sees the same corners at both sides of an edge.

use std::borrow::Cow;
use std::fmt::Write;
use std::io::{Cursor, Read, Write as _};
use surefoot_compiler::contour::Mesh;
use surefoot_compiler::srgb::encode;
use surefoot_compiler::unit::Unit;

/// A format, by the end of a file's name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Format {
    /// Triangles by themselves, in 32 bits. Its numbers have no unit, and whoever reads it takes them for millimetres.
    Stl,
    /// Text, with colours behind the places, as most programs write and read them.
    Obj,
    /// Binary, with colours.
    Ply,
    /// Binary glTF, with colours, in metres.
    Glb,
    /// What printers take, with colours. A scene that says no unit is in millimetres.
    ThreeMf,
}

impl Format {
    /// All of them.
    pub const ALL: [Format; 5] = [Format::Stl, Format::Obj, Format::Ply, Format::Glb, Format::ThreeMf];

    /// The end of a file's name.
    pub fn ending(self) -> &'static str {
        match self {
            Format::Stl => "stl",
            Format::Obj => "obj",
            Format::Ply => "ply",
            Format::Glb => "glb",
            Format::ThreeMf => "3mf",
        }
    }

    /// The unit of a file's numbers, where a scene says its own: STL and GLB have one of their own, the others that of the scene.
    pub fn unit(self, of_scene: Unit) -> Unit {
        match self {
            Format::Stl => Unit::Mm,
            Format::Glb => Unit::M,
            Format::Obj | Format::Ply | Format::ThreeMf => of_scene,
        }
    }

    /// The unit of a file's numbers, where that is not the scene's.
    fn other_unit(self, unit: Option<Unit>) -> Option<(Unit, Unit)> {
        unit.map(|unit| (unit, self.unit(unit))).filter(|(own, other)| own != other)
    }

    /// The mesh as the numbers in a file have it, in the scene's space. `unit` is that of the scene, where it says one.
    pub fn rounded(self, mesh: &Mesh, unit: Option<Unit>) -> Mesh {
        let units = self.other_unit(unit);
        let number = |c: f64| match self {
            Format::Stl | Format::Ply | Format::Glb => f64::from(c as f32),
            Format::Obj => format!("{c:.9}").parse().unwrap_or(c),
            Format::ThreeMf => c,
        };
        let read = |c: f64| units.map_or_else(|| number(c), |(own, other)| other.to(own, number(own.to(other, c))));
        Mesh { vertices: mesh.vertices.iter().map(|v| v.map(read)).collect(), ..mesh.clone() }
    }

    /// The bytes of a file. `unit` is that of the scene, where it says one.
    pub fn bytes(self, mesh: &Mesh, unit: Option<Unit>) -> Result<Vec<u8>, String> {
        let scaled = self.other_unit(unit).map(|(own, other)| {
            let vertices = mesh.vertices.iter().map(|v| v.map(|c| own.to(other, c))).collect();
            Mesh { vertices, ..mesh.clone() }
        });
        let mesh = scaled.as_ref().unwrap_or(mesh);
        match self {
            Format::Stl => stl(mesh),
            Format::Obj => Ok(obj(mesh, unit).into_bytes()),
            Format::Ply => ply(mesh, unit),
            Format::Glb => glb(mesh),
            Format::ThreeMf => three_mf(mesh, unit.unwrap_or(Unit::Mm)),
        }
    }
}

/// A linear colour as screens have it.
fn screen(color: &[f32; 3]) -> [u8; 3] {
    color.map(|c| (255.0 * encode(f64::from(c))).round() as u8)
}

fn narrow(mesh: &Mesh) -> Vec<[f32; 3]> {
    mesh.vertices.iter().map(|v| v.map(|c| c as f32)).collect()
}

fn stl(mesh: &Mesh) -> Result<Vec<u8>, String> {
    let triangles: Vec<stl_io::Triangle> = mesh.triangles.iter().map(|t| {
        let [a, b, c] = mesh.corners(t).map(glam::DVec3::from);
        let normal = (b - a).cross(c - a).normalize_or_zero().as_vec3();
        let vertices = [a, b, c].map(|p| stl_io::Vertex::new(p.as_vec3().to_array()));
        stl_io::Triangle { normal: stl_io::Normal::new(normal.to_array()), vertices }
    }).collect();
    let mut bytes = Vec::with_capacity(84 + 50 * triangles.len());
    stl_io::write_stl(&mut bytes, triangles.iter()).map_err(|why| why.to_string())?;
    Ok(bytes)
}

/// A comment, in a format that can't say its unit in another way.
fn comment(unit: Option<Unit>) -> String {
    unit.map_or(String::new(), |unit| format!(", unit: {}", unit.name()))
}

fn obj(mesh: &Mesh, unit: Option<Unit>) -> String {
    let mut text = String::with_capacity(68 * mesh.vertices.len() + 24 * mesh.triangles.len());
    let _ = writeln!(text, "# written by surefoot mesh{}", comment(unit));
    for ([x, y, z], color) in mesh.vertices.iter().zip(&mesh.colors) {
        let [r, g, b] = color.map(|c| encode(f64::from(c)));
        let _ = writeln!(text, "v {x:.9} {y:.9} {z:.9} {r:.4} {g:.4} {b:.4}");
    }
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|v| v + 1);
        let _ = writeln!(text, "f {a} {b} {c}");
    }
    text
}

fn ply(mesh: &Mesh, unit: Option<Unit>) -> Result<Vec<u8>, String> {
    use ply_rs_bw::ply::{Addable, DefaultElement, ElementDef, Encoding, Ply, Property, PropertyDef, PropertyType, ScalarType};
    let mut ply = Ply::<DefaultElement>::new();
    ply.header.encoding = Encoding::BinaryLittleEndian;
    ply.header.comments.push(format!("written by surefoot mesh{}", comment(unit)));
    let mut vertex = ElementDef::new("vertex".to_owned());
    let mut face = ElementDef::new("face".to_owned());
    let scalars = [(["x", "y", "z"], ScalarType::Float), (["red", "green", "blue"], ScalarType::UChar)];
    for (names, scalar) in &scalars {
        for name in names {
            vertex.properties.add(PropertyDef::new((*name).to_owned(), PropertyType::Scalar(scalar.clone())));
        }
    }
    let list = PropertyType::List(ScalarType::UChar, ScalarType::UInt);
    face.properties.add(PropertyDef::new("vertex_indices".to_owned(), list));
    ply.header.elements.add(vertex);
    ply.header.elements.add(face);
    let vertices = narrow(mesh).into_iter().zip(&mesh.colors).map(|(place, color)| {
        let mut element = DefaultElement::new();
        for (name, c) in ["x", "y", "z"].into_iter().zip(place) {
            element.insert(name.to_owned(), Property::Float(c));
        }
        for (name, c) in ["red", "green", "blue"].into_iter().zip(screen(color)) {
            element.insert(name.to_owned(), Property::UChar(c));
        }
        element
    });
    ply.payload.insert("vertex".to_owned(), vertices.collect());
    let faces = mesh.triangles.iter().map(|t| {
        let mut element = DefaultElement::new();
        element.insert("vertex_indices".to_owned(), Property::ListUInt(t.to_vec()));
        element
    });
    ply.payload.insert("face".to_owned(), faces.collect());
    let mut bytes = Vec::new();
    ply_rs_bw::writer::Writer::new().write_ply(&mut bytes, &mut ply).map_err(|why| why.to_string())?;
    Ok(bytes)
}

fn glb(mesh: &Mesh) -> Result<Vec<u8>, String> {
    use gltf::json::accessor::{ComponentType, GenericComponentType, Type};
    use gltf::json::buffer::Target;
    use gltf::json::mesh::{Mode, Primitive, Semantic};
    use gltf::json::validation::Checked::Valid;
    use gltf::json::{self, validation::USize64};
    let places = narrow(mesh);
    let fold = |pick: fn(f32, f32) -> f32, start: f32| places.iter().fold([start; 3], |[x, y, z], [a, b, c]| [pick(x, *a), pick(y, *b), pick(z, *c)]);
    let bounds = [fold(f32::min, f32::INFINITY), fold(f32::max, f32::NEG_INFINITY)];
    let floats = |all: &[[f32; 3]]| all.iter().flatten().flat_map(|c| c.to_le_bytes()).collect::<Vec<u8>>();
    let parts = [
        (floats(&places), mesh.vertices.len(), Type::Vec3, ComponentType::F32, Target::ArrayBuffer),
        (floats(&mesh.colors), mesh.colors.len(), Type::Vec3, ComponentType::F32, Target::ArrayBuffer),
        (
            mesh.triangles.iter().flatten().flat_map(|i| i.to_le_bytes()).collect(),
            3 * mesh.triangles.len(),
            Type::Scalar,
            ComponentType::U32,
            Target::ElementArrayBuffer,
        ),
    ];
    let mut root = json::Root::default();
    let length = parts.iter().map(|part| part.0.len()).sum::<usize>();
    let buffer = root.push(json::Buffer { byte_length: USize64::from(length), uri: None, extensions: None, extras: Default::default() });
    let mut bin = Vec::with_capacity(length);
    let mut accessors = Vec::new();
    for (bytes, count, type_, component, target) in parts {
        let view = root.push(json::buffer::View {
            buffer,
            byte_length: USize64::from(bytes.len()),
            byte_offset: Some(USize64::from(bin.len())),
            byte_stride: None,
            target: Some(Valid(target)),
            extensions: None,
            extras: Default::default(),
        });
        let [min, max] = bounds.map(|corner| accessors.is_empty().then(|| json::Value::from(corner.to_vec())));
        bin.extend(bytes);
        accessors.push(root.push(json::Accessor {
            buffer_view: Some(view),
            byte_offset: None,
            count: USize64::from(count),
            component_type: Valid(GenericComponentType(component)),
            type_: Valid(type_),
            min,
            max,
            normalized: false,
            sparse: None,
            extensions: None,
            extras: Default::default(),
        }));
    }
    let primitive = Primitive {
        attributes: [(Valid(Semantic::Positions), accessors[0]), (Valid(Semantic::Colors(0)), accessors[1])].into(),
        indices: Some(accessors[2]),
        material: None,
        mode: Valid(Mode::Triangles),
        targets: None,
        extensions: None,
        extras: Default::default(),
    };
    let mesh = root.push(json::Mesh { primitives: vec![primitive], weights: None, extensions: None, extras: Default::default() });
    let node = root.push(json::Node { mesh: Some(mesh), ..Default::default() });
    let scene = root.push(json::Scene { nodes: vec![node], extensions: None, extras: Default::default() });
    root.scene = Some(scene);
    let json = json::serialize::to_string(&root).map_err(|why| why.to_string())?;
    let header = gltf::binary::Header { magic: *b"glTF", version: 2, length: 0 };
    let file = gltf::binary::Glb { header, json: Cow::Owned(json.into_bytes()), bin: Some(Cow::Owned(bin)) };
    file.to_vec().map_err(|why| why.to_string())
}

fn three_mf(mesh: &Mesh, unit: Unit) -> Result<Vec<u8>, String> {
    use threemf2::model::builder::{self, ModelBuilder};
    use threemf2::model::{Color, OptionalResourceId, OptionalResourceIndex};
    /// The number of the group of colours. The crate counts groups and objects from 1 each, and no two may have the same.
    const GROUP: u32 = 2;
    let mut colors: Vec<[u8; 3]> = mesh.colors.iter().map(screen).collect();
    let of_corner = colors.clone();
    colors.sort_unstable();
    colors.dedup();
    let index = |v: u32| of_corner.get(v as usize).and_then(|color| colors.binary_search(color).ok()).map_or(0, |at| at as u32);
    let mut builder = ModelBuilder::new(
        match unit {
            Unit::Um => builder::Unit::Micron,
            Unit::Mm => builder::Unit::Millimeter,
            Unit::Cm => builder::Unit::Centimeter,
            Unit::M => builder::Unit::Meter,
            Unit::In => builder::Unit::Inch,
            Unit::Ft => builder::Unit::Foot,
        },
        true,
    );
    builder.add_metadata("Application", Some("surefoot mesh"));
    let object = builder.add_mesh_object(|object| {
        object.pid(GROUP).pindex(0);
        object.add_vertices(&mesh.vertices);
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|v| OptionalResourceIndex::new(index(v)));
            object.add_triangle_with_properties(&t.map(|v| v as usize), a, b, c, OptionalResourceId::new(GROUP));
        }
        Ok(())
    });
    let object = object.map_err(|why| why.to_string())?;
    builder.add_build(None).and_then(|builder| builder.add_build_item(object)).map_err(|why| why.to_string())?;
    builder.add_color_group(|group| {
        for [r, g, b] in &colors {
            group.add_color(Color { r: *r, g: *g, b: *b, a: 255 });
        }
    });
    let mut model = builder.build().map_err(|why| why.to_string())?;
    model.resources.colorgroup.iter_mut().for_each(|group| group.id = GROUP);
    let mut package = threemf2::package::ThreemfPackageBuilder::new();
    package.set_root_model(model);
    let package = package.build().map_err(|why| why.to_string())?;
    let mut file = Cursor::new(Vec::new());
    package.write(&mut file).map_err(|why| why.to_string())?;
    colors_first(file).map_err(|why| why.to_string())
}

/// The same file with colours before the object that names them: the crate writes them behind it, where readers do not find them.
fn colors_first(file: Cursor<Vec<u8>>) -> zip::result::ZipResult<Vec<u8>> {
    let mut package = zip::ZipArchive::new(file)?;
    let mut out = zip::ZipWriter::new(Cursor::new(Vec::new()));
    for i in 0..package.len() {
        let name = package.by_index_raw(i)?.name().to_owned();
        if !name.ends_with(".model") {
            out.raw_copy_file(package.by_index_raw(i)?)?;
            continue;
        }
        let mut text = String::new();
        package.by_index(i)?.read_to_string(&mut text)?;
        out.start_file(name, zip::write::SimpleFileOptions::default())?;
        let group = text.find("colorgroup ").and_then(|at| text[..at].rfind('<'));
        let end = text.rfind("colorgroup>").map(|at| at + "colorgroup>".len());
        match (text.find("<object "), group, end) {
            (Some(object), Some(group), Some(end)) if object < group && group < end => {
                for part in [&text[..object], &text[group..end], &text[object..group], &text[end..]] {
                    out.write_all(part.as_bytes())?;
                }
            }
            _ => out.write_all(text.as_bytes())?,
        }
    }
    Ok(out.finish()?.into_inner())
}
