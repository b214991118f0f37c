//! What compiling costs, in steps of formulas that the analysis runs: the same on each machine.

use crate::common;
use std::path::Path;
use surefoot_compiler::{Memory, MemoryLoader, Options, compile_remembering};

/// Steps that examples may cost at most.
const MOST: [(&str, u64); 5] = [("borrowed", 350_000), ("gearbox", 400_000), ("chess", 20_000), ("colonnade", 1_200_000), ("gyroid_ring", 330_000)];
/// The same for those that do not stand there.
const OTHERS: u64 = 250_000;

/// And whatever is compiled, unless it is long.
const MOST_OF_ALL: u64 = 4_000_000;

#[test]
fn no_example_costs_more_than_it_did() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples");
    let mut wrong = Vec::new();
    for file in std::fs::read_dir(&folder).unwrap().map(|file| file.unwrap().path()) {
        if file.extension().is_none_or(|e| e != "sdf") {
            continue;
        }
        let name = file.file_stem().unwrap().to_string_lossy().into_owned();
        let mut memory = Memory::default();
        let path = folder.join(format!("{name}.sdf"));
        let outcome = compile_remembering(&common::Disk, &path.to_string_lossy(), &Options::default(), &mut memory, &mut |_| {});
        let most = MOST.iter().find(|(known, _)| *known == name).map_or(OTHERS, |(_, most)| *most);
        println!("{name}: {} of {most}", memory.steps);
        if outcome.compiled.is_none() || memory.steps > most || memory.steps == 0 {
            wrong.push(format!("{name}: {} steps, {most} allowed", memory.steps));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// What grows without a limit from turn to turn is searched no longer than anything else: all searches draw from one account.
#[test]
fn what_folds_again_and_again_keeps_to_the_account() {
    let cases = Path::new(env!("CARGO_MANIFEST_DIR")).join("../tests/corpus/cases");
    let text = |name: &str| std::fs::read_to_string(cases.join(name)).unwrap();
    let deep = text("apollonian.sdf").replace("n: int = 8", "n: int = 35");
    let scenes = ["apollonian.sdf", "mandelbox.sdf", "julia.sdf", "pseudo_kleinian.sdf", "turned_folds.sdf"].map(text);
    for scene in scenes.into_iter().chain([deep]) {
        let first = scene.lines().next().unwrap_or_default().to_owned();
        let loader = MemoryLoader::new().with("main.sdf", scene);
        let mut memory = Memory::default();
        let mut compile = || compile_remembering(&loader, "main.sdf", &Options::default(), &mut memory, &mut |_| {});
        let [cold, warm] = [compile(), compile()];
        println!("{first}: {} steps", memory.steps);
        assert!(memory.steps > 0 && memory.steps < 2 * MOST_OF_ALL, "{first}: {} steps", memory.steps);
        let text = |outcome: surefoot_compiler::Outcome| outcome.compiled.map(|compiled| compiled.module.wgsl);
        // What is remembered changes nothing.
        assert_eq!(text(cold), text(warm), "{first}");
    }
}

/// A shape of which a first look does not say where it ends is looked at closely once, however many copies there are.
#[test]
fn many_copies_are_looked_at_as_one() {
    let hexagon = "field2 hexagon(r: float) = {
        let v = fold(abs(p), (-cos(pi / 3), sin(pi / 3)));
        let q = turn(v, pi / 6);
        let beyond = q.y - r * cos(pi / 6);
        length((max(beyond, 0), max(abs(q.x) - r / 2, 0))) + min(beyond, 0)
      }";
    let steps = |copies: u32| {
        let scene = format!("{hexagon}\nscene = for i in 0..{copies} {{ hexagon(2).extrude(1).translate(7 * i, 0, 0) }}");
        let loader = MemoryLoader::new().with("main.sdf", scene);
        let mut memory = Memory::default();
        let outcome = compile_remembering(&loader, "main.sdf", &Options::default(), &mut memory, &mut |_| {});
        assert!(outcome.compiled.is_some());
        memory.steps
    };
    let (few, many) = (steps(20), steps(200));
    println!("20 copies: {few}, 200 copies: {many}");
    assert!(many < 2 * few, "{few}, {many}");
}

/// What a fold that is no union joins to a live end asks once for what was before, on either side of each choice, and so does `check`.
#[test]
fn a_chain_costs_no_more_than_it_is_long() {
    let module = |most: u32, by: &str| {
        let text = format!("param n: int = 5 in 1..{most}\nscene = for i in 0..n by {by} {{ sphere(0.5).translate(i, 0, 0) }}\n");
        let outcome = compile_remembering(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default(), &mut Memory::default(), &mut |_| {});
        let compiled = outcome.compiled.unwrap_or_else(|| panic!("{by}: {:?}", outcome.diagnostics));
        compiled.module.operations.1
    };
    for by in ["round_union(0.2)", "chamfer_union(0.2)", "smooth_difference(0.2)"] {
        let (few, many) = (module(10, by), module(40, by));
        println!("{by}: {few}, {many}");
        assert!(many < 6 * few, "{by}: {few}, {many}");
    }
    let text = "scene = for i in 0..40 by xor { sphere(0.7).translate(i, 0, 0) }";
    let outcome = compile_remembering(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default(), &mut Memory::default(), &mut |_| {});
    assert!(surefoot_compiler::skipped::unseen(&outcome.compiled.unwrap(), &outcome.sources).is_empty());
}
