//! A mesh as a field: its triangles sampled into a grid, once for each content and settings.

use crate::mesh::{LARGEST_FILE, Mesh};
use siphasher::sip128::{Hasher128, SipHasher13};
use std::hash::Hasher;
use std::sync::{Arc, Mutex, PoisonError};
use surefoot_compiler::compiled::Loader;
use surefoot_compiler::sampled::{self, Grid, MOST_BYTES, Settings, Sign, Surface};

/// What is kept in memory takes no more, but for the newest.
const MOST_KEPT: usize = 512 << 20;

/// Grids of the program so far, the newest last.
static KEPT: Mutex<Vec<(u128, Arc<Grid>)>> = Mutex::new(Vec::new());

/// The grid of a mesh. `loader` reads the file and those that it names; `progress` hears which part is done, from any thread. What was made before is found
/// by what the file holds. Two who want the same wait for one.
pub fn grid(loader: &dyn Loader, path: &str, settings: Settings, progress: &(dyn Fn(f64) + Sync)) -> Result<Arc<Grid>, String> {
    if path.to_ascii_lowercase().ends_with(".sfgrid") {
        return Grid::from_bytes(&loader.read_up_to(path, MOST_BYTES as u64)?).map(Arc::new);
    }
    let bytes = loader.read_up_to(path, LARGEST_FILE)?;
    let key = key(path, &bytes, settings);
    let mut kept = KEPT.lock().unwrap_or_else(PoisonError::into_inner);
    // What names other files is known by them too, and those are read with it.
    let names_files = path.to_ascii_lowercase().ends_with(".gltf");
    if let Some(at) = kept.iter().position(|(known, _)| *known == key).filter(|_| !names_files) {
        let found = kept.remove(at);
        kept.push(found.clone());
        return Ok(found.1);
    }
    let mesh = Mesh::from_bytes(loader, path, &bytes)?;
    let positions: Vec<[f64; 3]> = mesh.vertices.iter().map(|vertex| vertex.position.map(f64::from)).collect();
    let triangles: Vec<[u32; 3]> = mesh.indices.as_chunks().0.to_vec();
    drop(mesh);
    let surface = Surface::new(&positions, &triangles, Sign::Auto)?;
    let grid = Arc::new(sampled::bake(&surface, settings, progress)?);
    kept.retain(|(known, _)| *known != key);
    kept.push((key, grid.clone()));
    while kept.len() > 1 && kept.iter().map(|(_, grid)| grid.bytes()).sum::<usize>() > MOST_KEPT {
        kept.remove(0);
    }
    Ok(grid)
}

/// A number of a file's bytes and how they are sampled.
fn key(path: &str, bytes: &[u8], settings: Settings) -> u128 {
    let mut hasher = SipHasher13::new();
    // The end of the name says how the bytes are read.
    hasher.write(path.rsplit('.').next().unwrap_or("").to_ascii_lowercase().as_bytes());
    hasher.write(bytes);
    hasher.write_u32(settings.resolution);
    hasher.write_u64(settings.padding.to_bits());
    hasher.finish128().as_u128()
}
