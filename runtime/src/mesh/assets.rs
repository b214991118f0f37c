//! The meshes of a scene, read once and kept while their files stay as they are.

use crate::images::Gallery;
use crate::mesh::raw::LARGEST_FILE;
use crate::mesh::triangles::Mesh;
use std::cell::RefCell;
use std::collections::BTreeMap;
use std::hash::{DefaultHasher, Hash, Hasher};
use std::sync::Arc;
use surefoot_compiler::compiled::{Compiled, Loader};
use surefoot_compiler::diagnostic::{Code, Diagnostic};
use surefoot_compiler::images::Images;

/// What was read for a scene, by the names of the files.
#[derive(Debug, Default)]
pub struct Assets {
    meshes: BTreeMap<String, Kept>,
    gallery: Gallery,
    images: Images,
}

/// A file that was read.
#[derive(Debug, Default)]
struct Kept {
    /// What it and those that it names held.
    seen: Seen,
    /// The newest mesh of the name that was good.
    mesh: Option<Arc<Mesh>>,
    /// Why the newest file is not.
    failure: Option<String>,
}

/// Hashes of what files held; none where they could not be read.
type Seen = BTreeMap<String, Option<u64>>;

fn content(bytes: &Result<Vec<u8>, String>) -> Option<u64> {
    let mut hasher = DefaultHasher::new();
    bytes.as_ref().ok()?.hash(&mut hasher);
    Some(hasher.finish())
}

/// A loader that notes what it answers.
struct Noting<'a> {
    loader: &'a dyn Loader,
    seen: RefCell<Seen>,
}

impl Loader for Noting<'_> {
    fn read(&self, path: &str) -> Result<Vec<u8>, String> {
        let bytes = self.loader.read(path);
        self.seen.borrow_mut().insert(path.to_owned(), content(&bytes));
        bytes
    }

    fn read_up_to(&self, path: &str, most: u64) -> Result<Vec<u8>, String> {
        let bytes = self.loader.read_up_to(path, most);
        self.seen.borrow_mut().insert(path.to_owned(), content(&bytes));
        bytes
    }
}

impl Assets {
    /// Nothing yet.
    pub fn new() -> Self {
        Self::default()
    }

    /// For who only asks what is wrong, as [`Gallery::checking`].
    pub fn checking() -> Self {
        Self { gallery: Gallery::checking(), ..Self::default() }
    }

    /// Reads the meshes of a scene whose files are not as they were, and forgets those that it has no more. Answers with what is wrong,
    /// at the places where the text names the files. Where a file was good before and is not now, the mesh of before stays. `begun` is
    /// told of each file before it is read: its name, which one it is, and of how many.
    pub fn load(&mut self, loader: &dyn Loader, compiled: &Compiled, begun: &dyn Fn(&str, usize, usize)) -> Vec<Diagnostic> {
        let blocks = &compiled.blocks.meshes;
        self.meshes.retain(|file, _| blocks.iter().any(|block| block.file == *file));
        let mut diagnostics = Vec::new();
        for (i, block) in blocks.iter().enumerate() {
            let first = blocks.iter().take(i).all(|before| before.file != block.file);
            let kept = self.meshes.entry(block.file.clone()).or_default();
            let as_it_was = |kept: &Kept| {
                let same = |(path, then): (&String, &Option<u64>)| content(&loader.read_up_to(path, LARGEST_FILE)) == *then;
                !kept.seen.is_empty() && kept.seen.iter().all(same)
            };
            if first && !as_it_was(kept) {
                begun(&block.file, i, blocks.len());
                let noting = Noting { loader, seen: RefCell::default() };
                let read = Mesh::load(&noting, &block.file);
                kept.seen = noting.seen.into_inner();
                kept.failure = match read {
                    Ok(mesh) => {
                        kept.mesh = Some(Arc::new(mesh));
                        None
                    }
                    Err(why) => Some(why),
                };
            }
            if let Some(why) = &kept.failure {
                diagnostics.push(Diagnostic::new(
                    Code::BrokenFile,
                    block.span,
                    format!("`{}` can't be drawn: {why}", block.file),
                    "write the path of an OBJ, glTF, GLB, STL or PLY file, relative to this one; the rest of the scene is drawn without it",
                ));
            }
        }
        let loaded = self.gallery.load(compiled, loader);
        self.images = loaded.images;
        diagnostics.extend(loaded.diagnostics);
        diagnostics
    }

    /// The images of the scene that was loaded.
    pub fn images(&self) -> &Images {
        &self.images
    }

    /// The meshes of a scene that was loaded, in the order of the text; none where a file is broken.
    pub fn meshes(&self, compiled: &Compiled) -> Vec<Option<Arc<Mesh>>> {
        compiled.blocks.meshes.iter().map(|block| self.meshes.get(&block.file).and_then(|kept| kept.mesh.clone())).collect()
    }
}
