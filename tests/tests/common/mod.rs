//! What the end-to-end tests share.
#![allow(dead_code)]

pub mod alike;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use surefoot_compiler::compiled::{Compiled, Export, Loader, Options};
use surefoot_compiler::reference_text::{CHAPTERS, entries, part_scenes};
use surefoot_compiler::{MemoryLoader, compile, diagnostic};
use surefoot_compiler::sampled::{Grid, Settings};
use surefoot_runtime::Gpu;

/// Files on the disk.
pub struct Disk;

impl Loader for Disk {
    fn read(&self, path: &str) -> Result<Vec<u8>, String> {
        std::fs::read(path).map_err(|e| e.to_string())
    }

    fn grid(&self, path: &str, settings: Settings) -> Result<Arc<Grid>, String> {
        surefoot_runtime::mesh::field::grid(self, path, settings, &|_| {})
    }
}

/// The device, or the test fails: there is always a software adapter where these tests run.
pub fn gpu() -> Gpu {
    match Gpu::headless() {
        Ok(gpu) => gpu,
        Err(error) => panic!("{error}. The tests need one: apt-get install mesa-vulkan-drivers"),
    }
}

/// The repository's folder.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("..")
}

/// The examples by name, with their paths.
pub fn examples() -> Vec<(String, String)> {
    let mut found: Vec<(String, String)> = std::fs::read_dir(root().join("examples"))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "sdf"))
        .map(|path| {
            let name = path.file_stem().unwrap().to_str().unwrap().to_owned();
            (name, path.to_str().unwrap().to_owned())
        })
        .collect();
    found.sort();
    assert!(!found.is_empty());
    found
}

/// The scene of a file, or what the compiler says of it.
pub fn compile_file(path: &str) -> Result<Compiled, String> {
    let outcome = compile(&Disk, path, &Options::default());
    let words = diagnostic::render(&outcome.sources, &outcome.diagnostics, false);
    outcome.compiled.ok_or(words)
}

/// The scenes that document the prelude and the parts, each once, by the name of what they document, with modules of these exports.
pub fn prelude(exports: &[Export]) -> Vec<(String, Compiled)> {
    let mut seen = Vec::new();
    let mut scenes = Vec::new();
    let of_prelude = CHAPTERS.iter().flat_map(|(file, _, text)| entries(file, text)).map(|entry| (String::new(), entry));
    let of_parts = part_scenes().into_iter().map(|(part, entry, _)| (format!("import \"std/{part}.sdf\"\n"), entry));
    for (import, entry) in of_prelude.chain(of_parts) {
        if seen.contains(&entry.example) {
            continue;
        }
        let loader = MemoryLoader::new().with("main.sdf", format!("{import}scene = {}\n", entry.example));
        let options = Options { exports: exports.to_vec(), ..Options::default() };
        let outcome = compile(&loader, "main.sdf", &options);
        let compiled = outcome.compiled.unwrap_or_else(|| panic!("{}: {:?}", entry.example, outcome.diagnostics));
        scenes.push((entry.name, compiled));
        seen.push(entry.example);
    }
    scenes
}

/// A folder for what a person may want to look at.
pub fn pictures() -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("pictures");
    std::fs::create_dir_all(&folder).unwrap();
    folder
}
