//! Files of meshes: every format says the same, and what is broken is an error at its place that takes little memory.

// Counting what a file allocates needs an allocator, whose calls are unsafe by nature.
#![allow(unsafe_code)]

use std::alloc::{GlobalAlloc, Layout, System};
use std::cell::Cell;
use surefoot_compiler::diagnostic::{Code, render};
use surefoot_compiler::{Compiled, MemoryLoader, Options, compile};
use surefoot_runtime::mesh::{Assets, Mesh};
use surefoot_tests::solids::{Solid, cuboid, knot, sphere};

struct Counting;

thread_local! {
    static HELD: Cell<usize> = const { Cell::new(0) };
    static MOST: Cell<usize> = const { Cell::new(0) };
}

// SAFETY: every call goes to the system's allocator as it came.
unsafe impl GlobalAlloc for Counting {
    unsafe fn alloc(&self, layout: Layout) -> *mut u8 {
        let held = HELD.get() + layout.size();
        HELD.set(held);
        MOST.set(MOST.get().max(held));
        unsafe { System.alloc(layout) }
    }

    unsafe fn dealloc(&self, at: *mut u8, layout: Layout) {
        HELD.set(HELD.get().saturating_sub(layout.size()));
        unsafe { System.dealloc(at, layout) }
    }
}

#[global_allocator]
static ALLOCATOR: Counting = Counting;

/// The most that may be allocated while a small file is read.
const MOST_MEMORY: usize = 32 << 20;

const SCENE: &str = "scene = sphere(1)\nmesh m \"parts/";

fn scene(file: &str) -> (Compiled, surefoot_compiler::source::Sources) {
    let text = format!("{SCENE}{file}\" {{ }}\n");
    let outcome = compile(&MemoryLoader::new().with("a/s.sdf", text), "a/s.sdf", &Options::default());
    assert!(outcome.diagnostics.is_empty(), "{:?}", outcome.diagnostics);
    (outcome.compiled.unwrap(), outcome.sources)
}

/// What is said of a file; nothing where it is good.
fn said(file: &str, bytes: Option<&[u8]>) -> Option<String> {
    let (compiled, sources) = scene(file);
    let mut loader = MemoryLoader::new();
    if let Some(bytes) = bytes {
        loader = loader.with(&format!("a/parts/{file}"), bytes);
    }
    let mut assets = Assets::new();
    MOST.set(HELD.get());
    let before = HELD.get();
    let found = assets.load(&loader, &compiled, &|_, _, _| {});
    let took = MOST.get() - before;
    assert!(took < MOST_MEMORY, "{file}: {took} bytes");
    let [mesh] = &assets.meshes(&compiled)[..] else { panic!("one mesh is one mesh") };
    assert_eq!(mesh.is_some(), found.is_empty());
    let found = found.first()?;
    assert_eq!(found.code, Code::BrokenFile);
    let (name, line, column) = sources.position(found.span.file, found.span.start);
    assert_eq!((name, line, column), ("a/s.sdf", 2, 8));
    Some(render(&sources, std::slice::from_ref(found), false))
}

/// A file of each format.
fn formats(solid: &Solid) -> Vec<(&'static str, Vec<u8>)> {
    vec![
        ("a.obj", solid.obj()),
        ("b.stl", solid.stl()),
        ("t.stl", solid.stl_text()),
        ("b.ply", solid.ply()),
        ("t.ply", solid.ply_text()),
        ("a.glb", solid.glb()),
    ]
}

#[test]
fn every_format_says_the_same() {
    let solid = sphere(12);
    for (file, bytes) in formats(&solid) {
        let mesh = Mesh::load(&MemoryLoader::new().with(file, bytes), file).unwrap();
        assert_eq!(mesh.indices.len(), 3 * solid.triangles.len(), "{file}");
        // A sphere's normals are its places.
        for (corner, triangle) in mesh.indices.iter().zip(solid.triangles.iter().flatten()) {
            let (vertex, wanted) = (mesh.vertices[*corner as usize], solid.corners[*triangle as usize]);
            let near = |a: [f32; 3], b: [f32; 3], by: f32| a.iter().zip(b).all(|(a, b)| (a - b).abs() < by);
            assert!(near(vertex.position, wanted, 1e-6), "{file}: {vertex:?}");
            assert!(near(vertex.normal, wanted, 0.02), "{file}: {vertex:?}");
        }
    }
    // The numbers beside the text, and within it.
    let buffer = solid.gltf_buffer();
    let loader = MemoryLoader::new().with("m/a b.bin", buffer).with("m/a.gltf", solid.gltf(Some("a%20b.bin")));
    assert_eq!(Mesh::load(&loader, "m/a.gltf").unwrap().indices.len(), 3 * solid.triangles.len());
    let inline = r#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"translation":[0,2,0]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],"buffers":[{"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA","byteLength":36}],"bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3","min":[0,0,0],"max":[1,1,0]}]}"#;
    let mesh = Mesh::load(&MemoryLoader::new().with("a.gltf", inline), "a.gltf").unwrap();
    assert_eq!(mesh.bounds, [[0.0, 2.0, 0.0], [1.0, 3.0, 0.0]]);
}

/// A cube's edges are to be seen, and its file has eight corners.
#[test]
fn a_crease_stays_one() {
    let mesh = Mesh::load(&MemoryLoader::new().with("a.obj", cuboid([1.0; 3]).obj()), "a.obj").unwrap();
    assert_eq!(mesh.vertices.len(), 24);
    assert!(mesh.vertices.iter().all(|v| v.normal.iter().filter(|c| c.abs() > 0.999).count() == 1), "{:?}", mesh.vertices);
}

/// Bytes in place of others, all along.
fn replaced(bytes: &[u8], from: &str, to: &str) -> Vec<u8> {
    let text = String::from_utf8(bytes.to_vec()).unwrap();
    assert!(text.contains(from), "no {from}");
    text.replace(from, to).into_bytes()
}

fn with_u32(mut bytes: Vec<u8>, at: usize, value: u32) -> Vec<u8> {
    bytes[at..at + 4].copy_from_slice(&value.to_le_bytes());
    bytes
}

#[test]
fn broken_files_are_errors_at_their_place() {
    let solid = cuboid([1.0, 2.0, 3.0]);
    let mut corpus: Vec<(String, &str, Option<Vec<u8>>)> = Vec::new();
    let mut add = |what: &str, file: &'static str, bytes: Vec<u8>| corpus.push((what.to_owned(), file, Some(bytes)));
    for (file, bytes) in formats(&solid) {
        assert_eq!(said(file, Some(&bytes)), None, "{file} is good");
        add("empty", file, Vec::new());
        add("one byte", file, bytes[..1].to_vec());
        add("cut after a third", file, bytes[..bytes.len() / 3].to_vec());
        add("another format", file, if file.ends_with("obj") { solid.glb() } else { solid.obj() });
        add("zeros", file, vec![0; 4096]);
        add("noise", file, (0..4096u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 13) as u8).collect());
    }
    for (file, bytes) in [("b.stl", solid.stl()), ("b.ply", solid.ply()), ("a.glb", solid.glb()), ("t.ply", solid.ply_text()), ("t.stl", solid.stl_text())] {
        add("the last bytes are missing", file, bytes[..bytes.len() - 16].to_vec());
    }
    let (obj, ply, ply_text, stl, glb) = (solid.obj(), solid.ply(), solid.ply_text(), solid.stl(), solid.glb());
    add("no triangles", "a.obj", b"v 0 0 0\nv 1 0 0\n".to_vec());
    add("a corner that is not there", "a.obj", replaced(&obj, "f 1 5 7", "f 1 5 99"));
    add("corner zero", "a.obj", replaced(&obj, "f 1 5 7", "f 0 5 7"));
    add("a corner before the first", "a.obj", replaced(&obj, "f 1 5 7", "f -99 5 7"));
    add("not a number", "a.obj", replaced(&obj, "v -0.5", "v nan"));
    add("infinity", "a.obj", replaced(&obj, "v -0.5", "v inf"));
    add("too far", "a.obj", replaced(&obj, "v -0.5", "v 1e30"));
    add("a word", "a.obj", replaced(&obj, "v -0.5", "v two"));
    add("a face of one corner", "a.obj", b"v 0 0 0\nf 1\n".to_vec());
    add("an enormous count", "b.stl", with_u32(stl.clone(), 80, u32::MAX));
    add("a count too small", "b.stl", with_u32(stl.clone(), 80, 3));
    add("not a number", "b.stl", with_u32(stl, 96, f32::NAN.to_bits()));
    add("an enormous count", "t.ply", replaced(&ply_text, "vertex 8", "vertex 4000000000"));
    add("an enormous count of faces", "t.ply", replaced(&ply_text, "face 12", "face 999999999999"));
    add("a corner that is not there", "t.ply", replaced(&ply_text, "3 0 4 6", "3 0 4 -6"));
    add("no x", "t.ply", replaced(&ply_text, "float x", "float w"));
    let end = ply.windows(11).position(|w| w == b"end_header\n").unwrap() + 11;
    add("not a number", "b.ply", with_u32(ply.clone(), end + 4, f32::INFINITY.to_bits()));
    let mut long = ply.clone();
    long[end + 8 * 12] = 255;
    add("a list longer than the file", "b.ply", long);
    add("a wrong length", "a.glb", with_u32(glb.clone(), 8, 1 << 31));
    add("an enormous text", "a.glb", with_u32(glb.clone(), 12, u32::MAX));
    let text = solid.gltf(Some("data:application/octet-stream;base64,AAAA"));
    add("a buffer too short", "a.gltf", text.clone().into_bytes());
    add("a buffer that is not base64", "a.gltf", text.replace("AAAA", "????").into_bytes());
    add("a buffer that is nowhere", "a.gltf", solid.gltf(Some("gone.bin")).into_bytes());
    add("an enormous buffer", "a.gltf", text.replace("\"byteLength\":96}", "\"byteLength\":999999999999}").into_bytes());
    add("an enormous count", "a.gltf", text.replace("\"count\":8", "\"count\":4294967295").into_bytes());
    add("nodes in a circle", "a.gltf", br#"{"asset":{"version":"2.0"},"scenes":[{"nodes":[0]}],"nodes":[{"children":[0]}]}"#.to_vec());
    add("a scene of nothing", "a.gltf", br#"{"asset":{"version":"2.0"},"scenes":[{}]}"#.to_vec());
    add("another format by its name", "a.xyz", obj);
    corpus.push(("missing".to_owned(), "a.obj", None));
    assert!(corpus.len() >= 30);
    for (what, file, bytes) in &corpus {
        let said = said(file, bytes.as_deref());
        assert!(said.is_some(), "{what} in {file}: nothing is said");
    }
    println!("{} broken files", corpus.len());
}

/// Bytes changed by chance: whatever comes of it, nothing stops and the memory stays small.
#[test]
fn no_file_stops_the_program() {
    let solid = cuboid([1.0; 3]);
    let mut state = 7u32;
    let mut chance = |below: usize| {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        (state >> 8) as usize % below
    };
    let mut refused = 0;
    for _ in 0..100 {
        for (file, mut bytes) in formats(&solid) {
            for _ in 0..1 + chance(4) {
                let at = chance(bytes.len());
                match chance(3) {
                    0 => bytes[at] = chance(256) as u8,
                    1 => bytes.truncate(at.max(1)),
                    _ => bytes.insert(at, chance(256) as u8),
                }
            }
            refused += u32::from(said(file, Some(&bytes)).is_some());
        }
    }
    println!("{refused} of 600 refused");
    assert!(refused > 100);
}

/// The mesh of the examples is what its formula says. `WRITE=1` writes it.
#[test]
fn the_knot_of_the_examples_is_its_formula() {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/meshes/knot.obj");
    let wanted = knot(0.55, 192, 16).obj();
    if std::env::var_os("WRITE").is_some() {
        std::fs::write(&path, &wanted).unwrap();
    }
    assert!(std::fs::read(&path).unwrap() == wanted, "write it with WRITE=1");
    assert!(wanted.len() < 300_000, "{} bytes", wanted.len());
}
