//! Writes `docs/side-by-side-meshes.md`: a part for a printer, meshes of fields by Surefoot and by the crate `fidget`, and grids of meshes by Surefoot and by the
//! crate `mesh_to_sdf`.
//!
//! `cargo run --release --manifest-path tests/beside_meshes/Cargo.toml docs/side-by-side-meshes.md`

mod fields;
mod grids;
#[path = "../../beside_fidget/src/tree.rs"]
mod tree;

use std::time::Instant;

type Failure = Box<dyn std::error::Error>;

fn main() -> Result<(), Failure> {
    let page = std::env::args().nth(1).ok_or("which file to write?")?;
    let text = format!(
        "# Meshes and grids side by side\n\n\
         Written by `cargo run --release --manifest-path tests/beside_meshes/Cargo.toml {page}`, with `fidget` 0.5.0 and `mesh_to_sdf` 0.4.0, \
         on a machine with {} threads. What is compared runs in turn; times are medians.\n\n{}\n{}\n{}",
        std::thread::available_parallelism().map_or(1, usize::from),
        fields::part()?,
        fields::section()?,
        grids::section()?,
    );
    print!("{text}");
    std::fs::write(page, text)?;
    Ok(())
}

/// What is made, and how many seconds it takes.
fn timed<T>(make: impl FnOnce() -> T) -> (T, f64) {
    let start = Instant::now();
    let made = make();
    (made, start.elapsed().as_secs_f64())
}

fn median(mut times: Vec<f64>) -> f64 {
    times.sort_by(f64::total_cmp);
    times.get(times.len() / 2).copied().unwrap_or(f64::NAN)
}
