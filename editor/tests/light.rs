//! Soft light beside the truth: rays to the points of a light's disc.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]

use std::path::Path;
use std::process::Command;

/// Scenes, and the most that the share of light may be off in the mean, and its ripple, in a live picture.
const SCENES: [&str; 6] = ["cases/open_box", "cases/steep_neighbour", "cases/emission", "light/overhang", "light/holes", "light/low_light"];
const LIVE: [f64; 2] = [0.06, 0.04];
/// The most that it may be off in the mean in a still.
const STILL: f64 = 0.01;

#[test]
fn soft_light_is_near_the_truth() {
    let corpus = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/corpus");
    let scenes = SCENES.map(|scene| format!("{scene}.sdf"));
    let output = Command::new(env!("CARGO_BIN_EXE_surefoot")).current_dir(corpus).args(["bench", "--light"]).args(scenes).output().unwrap();
    let table = String::from_utf8(output.stdout).unwrap();
    for scene in SCENES {
        let name = scene.rsplit('/').next().unwrap();
        let row = table.lines().find(|line| line.starts_with(&format!("| {name}, "))).unwrap_or_else(|| panic!("{name} is not in\n{table}"));
        let number = |column: usize| row.split(" | ").nth(column).unwrap().parse::<f64>().unwrap();
        assert!(number(1) > 500.0, "{row}");
        assert!(number(2) <= LIVE[0] && number(3) <= LIVE[1] && number(4) <= STILL, "{row}");
    }
}
