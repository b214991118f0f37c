//! What is hard, at a size that a machine for tests affords: every cell of `surefoot stress` is green, or red with its reason.
#![cfg(feature = "gpu")]

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Stdio};

#[test]
fn every_cell_is_green_or_has_a_reason() {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("stress");
    std::fs::create_dir_all(&folder).unwrap();
    let (json, page) = (folder.join("stress.json"), folder.join("page.md"));
    let output = Command::new(env!("CARGO_BIN_EXE_surefoot"))
        .args(["stress", "--size", "32", "--balls", "300", "--seconds", "20", "--json"])
        .arg(&json)
        .arg("--page")
        .arg(&page)
        .stdin(Stdio::null())
        .output()
        .unwrap();
    let text = String::from_utf8_lossy(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{text}{}", String::from_utf8_lossy(&output.stderr));
    let report: Value = serde_json::from_str(&std::fs::read_to_string(json).unwrap()).unwrap();
    let cases = report["cases"].as_array().unwrap();
    assert!(cases.len() >= 45, "{text}");
    let mut numbers = 0;
    for case in cases {
        for machine in ["exact", "device"] {
            numbers += case[machine]["numbers"].as_u64().unwrap();
            assert_eq!(case[machine]["not_finite"], 0, "{case:#}");
        }
    }
    assert!(numbers > 1_000_000, "only {numbers} numbers");
    let page = std::fs::read_to_string(page).unwrap();
    assert!(page.contains("## Stress") && page.lines().filter(|l| l.contains("🟢")).count() >= cases.len() - 6, "{page}");
}
