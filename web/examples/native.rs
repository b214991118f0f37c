//! The requests of a page, answered by the same code as a program of this machine: `tests/speed.mjs` compares the two.
//!
//! Reads lines of JSON: a request, whose texts stand in it. Writes for each the milliseconds that it took, and the bytes of its answer.

use serde_json::Value;
use std::io::BufRead;
use std::time::Instant;
use surefoot::{Parcel, answer};
use surefoot_compiler::Memory;

fn main() -> std::io::Result<()> {
    for line in std::io::stdin().lock().lines() {
        let mut json: Value = serde_json::from_str(&line?)?;
        let texts = json["texts"].take();
        let blobs = texts.as_array().into_iter().flatten().map(|text| text.as_str().unwrap_or_default().as_bytes().to_vec()).collect();
        let asked = Parcel { json, blobs };
        let began = Instant::now();
        // As a page that opens a scene: nothing is remembered.
        let answer = answer(&asked, &mut Memory::default());
        let took = began.elapsed().as_secs_f64() * 1000.0;
        println!("{took} {}", answer.blobs.iter().map(Vec::len).sum::<usize>());
    }
    Ok(())
}
