//! A picture that is drawn again and again takes no more memory than once: nothing that a shader reads lets a driver build it anew for each draw.

#![cfg(target_os = "linux")]

mod common;

use common::gpu;
use surefoot_compiler::compiled::Options;
use surefoot_compiler::{MemoryLoader, compile, diagnostic};
use surefoot_runtime::headless::{self, Shot};

const SCENES: [(&str, &str); 3] = [
    ("plain", "scene = sphere(1)"),
    (
        "lights",
        "scene = sphere(1) | plane(y, -1)
        light sun { direction: (-1, -2, -1), shadow: none }
        light lamp { position: (2, 3, 1), intensity: 20, shadow: soft(8) }
        light cold { direction: (1, -1, 0), shadow: hard }",
    ),
    (
        "mirrors",
        "param often: int = 2 in 0..4
        material chrome { metallic: 1, roughness: 0.1 }
        scene = sphere(1).material(chrome) | box(1).translate(2, 0, 0)
        render { reflections: often }",
    ),
];

/// Bytes of memory that this process holds.
fn resident() -> u64 {
    let said = std::fs::read_to_string("/proc/self/status").unwrap();
    let line = said.lines().find_map(|line| line.strip_prefix("VmRSS:")).unwrap();
    line.trim().trim_end_matches("kB").trim().parse::<u64>().unwrap() * 1024
}

#[test]
fn a_thousand_draws_take_no_more_memory_than_a_few() {
    let gpu = gpu();
    for (name, text) in SCENES {
        let outcome = compile(&MemoryLoader::new().with("s.sdf", text), "s.sdf", &Options::default());
        let words = diagnostic::render(&outcome.sources, &outcome.diagnostics, false);
        let compiled = outcome.compiled.unwrap_or_else(|| panic!("{name}: {words}"));
        let draw = |samples| {
            let shot = Shot { samples, ..Shot::new(16, 16) };
            headless::render(&gpu, &compiled, &compiled.live(), &shot).unwrap();
        };
        draw(16);
        let before = resident();
        (0..4).for_each(|_| draw(256));
        let grown = resident().saturating_sub(before) >> 20;
        println!("{name}: {grown} MiB more after 1,024 draws");
        assert!(grown < 64, "{name}: {grown} MiB more after 1,024 draws");
    }
}
