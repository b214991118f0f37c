//! What a scene costs grows as its operands do, and no stack does.

#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic, clippy::indexing_slicing)]

use serde_json::Value;
use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

/// Numbers of operands: the second is four times the first.
const COUNTS: [u64; 2] = [400, 1600];
/// How many times as many steps of formulas, and as long a text, four times the operands may take; the square would be sixteen.
const MOST_TIMES: f64 = 8.0;
/// Steps of formulas that the searches with a budget may take beside them, whatever the number.
const BUDGETED: f64 = 8e6;
/// Megabytes.
const MOST_MEMORY: f64 = 250.0;

#[test]
fn every_blend_of_many_takes_time_text_and_memory_as_their_number() {
    let counts = COUNTS.map(|count| count.to_string()).join(",");
    let output = Command::new(env!("CARGO_BIN_EXE_surefoot")).args(["bench", "--operands", "--json", "--counts", &counts]).output().unwrap();
    let text = String::from_utf8(output.stdout).unwrap();
    let mut scenes: BTreeMap<String, Vec<Value>> = BTreeMap::new();
    for line in text.lines() {
        let line: Value = serde_json::from_str(line).unwrap();
        scenes.entry(line["scene"].as_str().unwrap().to_owned()).or_default().push(line);
    }
    assert!(scenes.len() >= 30, "{text}");
    for (scene, rows) in scenes {
        let [few, many] = rows.as_slice() else { panic!("{scene}: {rows:?}") };
        for row in [few, many] {
            let exit = row["exit"].as_str().unwrap();
            assert!(exit == "0" || exit == "too-large", "{scene}: {row}");
            if let Some(megabytes) = row["megabytes"].as_f64() {
                assert!(megabytes < MOST_MEMORY, "{scene}: {row}");
            }
        }
        for (of, beside) in [("steps", BUDGETED), ("text", 0.0)] {
            let (Some(few), Some(many)) = (few[of].as_f64(), many[of].as_f64()) else { continue };
            assert!(many <= MOST_TIMES * few + beside, "{scene}: {of} {few} and {many}");
        }
    }
}

/// Scenes of the corpus with thousands of operands or points, and the commands that read them, each with a stack of 1 MiB.
#[test]
fn no_command_needs_a_stack_that_grows_with_the_operands() {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/corpus/cases");
    let picture = std::env::temp_dir().join(format!("surefoot-operands-{}.png", std::process::id()));
    let render = format!("render -o {} --size 16x12 --samples 1 --device cpu", picture.display());
    let verify = "verify --samples 64 --certified 2 --device cpu".to_owned();
    for scene in ["many_smooth.sdf", "many_chamfer.sdf", "many_points.sdf", "many_in_a_list.sdf", "many_holes.sdf"] {
        for command in ["check", "check --json", "check --factors", "compile", "fmt --check", &verify, &render] {
            let output = Command::new("sh")
                .current_dir(&cases)
                .args(["-c", &format!("ulimit -s 1024; exec \"$0\" {command} {scene}"), env!("CARGO_BIN_EXE_surefoot")])
                .output()
                .unwrap();
            assert_eq!(output.status.code(), Some(0), "{command} {scene}: {}", String::from_utf8_lossy(&output.stderr));
        }
    }
    std::fs::remove_file(picture).ok();
}
