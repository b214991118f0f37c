//! A mesh as a field: its triangles sampled into a grid, once for each content and settings.

use crate::mesh::shelf::Shelf;
use crate::mesh::{LARGEST_FILE, Mesh};
use siphasher::sip128::{Hasher128, SipHasher13};
use std::hash::Hasher;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use surefoot_compiler::compiled::Loader;
use surefoot_compiler::sampled::{self, Grid, MOST_BYTES, Settings, Sign, Surface};

/// What is kept in memory takes no more, but for the newest.
const MOST_KEPT: usize = 512 << 20;

/// Grids of the program so far, the newest last.
static KEPT: Mutex<Vec<(u128, Arc<Grid>)>> = Mutex::new(Vec::new());

/// What is kept on the disk takes no more.
const MOST_ON_DISK: u64 = 1 << 30;
/// Raised with each change of what is made of a mesh: what was kept before is made anew.
const MADE: u32 = 1;

/// The grids on the disk, where a folder was named.
static SHELF: OnceLock<Shelf> = OnceLock::new();

/// Keeps grids in a folder as well, from where a later start reads them. The folder is made where it is needed, holds nothing else, and takes 1 GiB at
/// most: what was of no use for longest is removed. The first folder that is named stays.
pub fn keep_in(folder: PathBuf) {
    SHELF.get_or_init(|| Shelf { folder, most: MOST_ON_DISK });
}

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
    let shelf = SHELF.get().filter(|_| !names_files);
    let grid = match shelf.and_then(|shelf| shelf.find(key)) {
        Some(grid) => Arc::new(grid),
        None => {
            let grid = Arc::new(sample(loader, path, &bytes, settings, progress)?);
            if let Some(shelf) = shelf {
                shelf.put(key, &grid);
            }
            grid
        }
    };
    kept.retain(|(known, _)| *known != key);
    kept.push((key, grid.clone()));
    while kept.len() > 1 && kept.iter().map(|(_, grid)| grid.bytes()).sum::<usize>() > MOST_KEPT {
        kept.remove(0);
    }
    Ok(grid)
}

/// The grid of a file's bytes.
fn sample(loader: &dyn Loader, path: &str, bytes: &[u8], settings: Settings, progress: &(dyn Fn(f64) + Sync)) -> Result<Grid, String> {
    let mesh = Mesh::from_bytes(loader, path, bytes)?;
    let positions: Vec<[f64; 3]> = mesh.vertices.iter().map(|vertex| vertex.position.map(f64::from)).collect();
    let triangles: Vec<[u32; 3]> = mesh.indices.as_chunks().0.to_vec();
    drop(mesh);
    sampled::bake(&Surface::new(&positions, &triangles, Sign::Auto)?, settings, progress)
}

/// A number of a file's bytes and how they are sampled.
fn key(path: &str, bytes: &[u8], settings: Settings) -> u128 {
    let mut hasher = SipHasher13::new();
    hasher.write_u32(MADE);
    // The end of the name says how the bytes are read.
    hasher.write(path.rsplit('.').next().unwrap_or("").to_ascii_lowercase().as_bytes());
    hasher.write(bytes);
    hasher.write_u32(settings.resolution);
    hasher.write_u64(settings.padding.to_bits());
    hasher.finish128().as_u128()
}
