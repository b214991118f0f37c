//! Files as the compiler's tests read them: texts, and meshes as grids.

use std::sync::Arc;
use surefoot_compiler::Loader;
use surefoot_compiler::sampled::{Grid, Settings, Sign, Surface, bake};

/// Files on the disk.
pub struct Disk;

impl Loader for Disk {
    fn read(&self, path: &str) -> Result<Vec<u8>, String> {
        std::fs::read(path).map_err(|e| e.to_string())
    }

    fn grid(&self, path: &str, settings: Settings) -> Result<Arc<Grid>, String> {
        grid(self, path, settings)
    }
}

/// The grid of an OBJ file that holds vertices and triangles alone, as `surefoot mesh` writes it.
pub fn grid(loader: &dyn Loader, path: &str, settings: Settings) -> Result<Arc<Grid>, String> {
    let text = String::from_utf8(loader.read(path)?).map_err(|e| e.to_string())?;
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for line in text.lines() {
        let words: Vec<&str> = line.split_whitespace().collect();
        match words[..] {
            ["v", x, y, z] => vertices.push([x, y, z].map(|c| c.parse().unwrap())),
            ["f", a, b, c] => triangles.push([a, b, c].map(|corner| corner.split('/').next().unwrap().parse::<u32>().unwrap() - 1)),
            _ => {}
        }
    }
    bake(&Surface::new(&vertices, &triangles, Sign::Auto)?, settings, &|_| {}).map(Arc::new)
}
