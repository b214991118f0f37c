//! Every rule for factors: never below what is attained, near to it where it says so, and a mutation of it is found out.

use surefoot_compiler::evaluate::Tape;
use surefoot_compiler::factors::{Judged, RuleScene, judge, rules};
use surefoot_compiler::graph::Function;
use surefoot_compiler::reference_text::{CHAPTERS, entries};
use surefoot_compiler::verify::{Settings, Side, WORK, verify};
use std::sync::atomic::{AtomicUsize, Ordering};
use surefoot_compiler::{Compiled, Live, MemoryLoader, Options, compile};

fn all() -> Vec<RuleScene> {
    rules(include_str!("../../tests/corpus/rules.txt")).unwrap()
}

fn scene(rule: &RuleScene) -> Compiled {
    let outcome = compile(&MemoryLoader::new().with("rule.sdf", rule.text.clone()), "rule.sdf", &Options::default());
    let said = surefoot_compiler::diagnostic::render(&outcome.sources, &outcome.diagnostics, false);
    outcome.compiled.unwrap_or_else(|| panic!("{}: {said}", rule.name))
}

#[test]
fn every_claim_of_the_prelude_is_among_the_rules() {
    let texts = all();
    for entry in CHAPTERS.iter().flat_map(|(name, _, text)| entries(name, text)) {
        if entry.claim.is_some_and(|c| c.contains("lipschitz")) {
            assert!(texts.iter().any(|rule| rule.text.contains(&format!("{}(", entry.name)) || rule.name.starts_with(&entry.name)), "{} claims, and has no rule", entry.name);
        }
    }
}

/// Stands for a device on which the rule's factor is smaller: the bound in 64 bits, rounded to 32, times something.
fn mutated(scene: &Compiled, times: f64) -> impl Fn(&Live, &[[f32; 3]]) -> Result<Vec<f32>, String> {
    move |live, points| {
        let bound = scene.functions.formulas[&(scene.root, Function::Bound)];
        let tape = Tape::new(&scene.graph, &scene.functions.formulas, &[bound], live, 1_000_000).unwrap();
        let points: Vec<[f64; 3]> = points.iter().map(|p| p.map(f64::from)).collect();
        let mut bounds = Vec::new();
        tape.evaluator().at(&points, &[], |_, values| bounds.push((values[0] * times) as f32));
        Ok(bounds)
    }
}

/// What is wrong with a rule: its factor is below what is attained, or well above it; or a third less is not found out.
fn faults(rule: &RuleScene) -> Vec<String> {
    let scene = scene(rule);
    let Judged { factor, attained, at_most } = judge(&scene, rule.half, 600);
    println!("{:<40} factor {factor:.4}  attained {attained:.4}  at most {at_most:?}", rule.name);
    let mut wrong = Vec::new();
    // The certified field is that of 32 bits, whose constants are rounded.
    if attained > factor * (1.0 + 1e-7) {
        wrong.push(format!("{}: {factor} is below {attained}", rule.name));
    }
    if rule.loose.is_none() && factor > 1.05 * attained {
        wrong.push(format!("{}: {factor} is not attained, only {attained}", rule.name));
    }
    let broken = mutated(&scene, 1.3 * scene.summary.factor / attained);
    let found = [2_000, 20_000].iter().any(|&samples| {
        let settings = Settings { samples, certified: samples / 100, seed: 3, work: WORK };
        let report = verify(&scene, settings, Some(&broken), &|_| {}).unwrap();
        if let Some(honest) = report.violations.iter().find(|v| v.side != Side::Device) {
            wrong.push(format!("{}: as it is, it fails: {honest:?}", rule.name));
        }
        !report.violations.is_empty()
    });
    if !found {
        wrong.push(format!("{}: a factor too small by 1.3 is not found out", rule.name));
    }
    wrong
}

#[test]
fn no_rule_is_below_what_is_attained_those_attained_are_near_to_it_and_mutations_are_found_out() {
    let rules = all();
    let next = AtomicUsize::new(0);
    let work = || {
        let mut wrong = Vec::new();
        while let Some(rule) = rules.get(next.fetch_add(1, Ordering::Relaxed)) {
            wrong.extend(faults(rule));
        }
        wrong
    };
    let wrong: Vec<String> = std::thread::scope(|scope| {
        let threads = [scope.spawn(work), scope.spawn(work)];
        threads.into_iter().flat_map(|t| t.join().unwrap()).collect()
    });
    assert!(rules.len() > 70 && wrong.is_empty(), "{}", wrong.join("\n"));
}
