//! The table of rules: each rule stands where its row says, and its own scene gets worse without it.

use std::collections::BTreeSet;
use std::path::Path;
use surefoot_compiler::ablation::{Price, about};
use surefoot_compiler::rules::{RULES, RuleSet};
use surefoot_compiler::{MemoryLoader, Options, compile};

#[test]
fn without_a_rule_its_scene_gets_worse() {
    let mut vain = Vec::new();
    for row in RULES {
        let loader = MemoryLoader::new().with("scene.sdf", row.scene);
        let whole = compile(&loader, "scene.sdf", &Options::default());
        assert!(whole.compiled.is_some(), "{}: {:?}", row.id, whole.diagnostics);
        let less = Options { rules: RuleSet::default().without(row.rule), ..Options::default() };
        let without = compile(&loader, "scene.sdf", &less);
        let about = about(&whole);
        if Price::of(&without, about).worse_than(&Price::of(&whole, about)).is_empty() {
            vain.push(row.id);
        }
    }
    assert!(vain.is_empty(), "these rules gain nothing in their own scenes: {vain:?}");
}

#[test]
fn each_rule_stands_where_its_row_says() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut ids = BTreeSet::new();
    for row in RULES {
        assert!(ids.insert(row.id), "two rules are named {}", row.id);
        assert!(source.join(row.file).is_file(), "{}: there is no {}", row.id, row.file);
    }
    let mut files = vec![source.clone()];
    let mut texts = String::new();
    while let Some(file) = files.pop() {
        match file.is_dir() {
            true => files.extend(std::fs::read_dir(&file).unwrap().map(|entry| entry.unwrap().path())),
            false if file != source.join("rules.rs") => texts += &std::fs::read_to_string(&file).unwrap(),
            false => {}
        }
    }
    for row in RULES {
        let is_asked = [')', ','].iter().any(|end| texts.contains(&format!("Rule::{:?}{end}", row.rule)));
        assert!(is_asked, "nothing asks whether {} is switched on", row.id);
    }
    let page = std::fs::read_to_string(source.join("../../docs/rules.md")).unwrap();
    for id in ids {
        assert!(page.contains(&format!("| `{id}` |")), "docs/rules.md does not name {id}");
    }
}
