//! `surefoot check`: what is wrong with scenes, and what the compiler knows of them.

use super::shaders::{Stepped, stepped};
use super::console::{Exit, Failure, all_read, colored, count, print};
use crate::files::{self, FileLoader};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use surefoot_compiler::compiled::Compiled;
use surefoot_compiler::diagnostic::{self, Diagnostic, Severity};
use surefoot_compiler::factors::{self, Explained, Ranged};
use surefoot_compiler::graph::{Baked, Proof};
use surefoot_compiler::sampled::Off;
use surefoot_compiler::rules::{RULES, Row, RuleSet};
use surefoot_compiler::skipped::{skipped, unseen};
use surefoot_compiler::solid::SolidBox;
use surefoot_compiler::source::Sources;
use surefoot_compiler::{Options, Outcome};
use surefoot_hosts::parameter_json;

/// What to check.
#[derive(Debug, clap::Args)]
pub struct Args {
    /// The scenes.
    #[arg(required = true, value_name = "SCENE")]
    scenes: Vec<String>,
    /// Write one JSON object for each scene, on a line of its own.
    #[arg(long)]
    json: bool,
    /// Say for each factor where it comes from, how it is known, what it costs and what would lower it.
    #[arg(long)]
    factors: bool,
    /// Make it an error where a factor is measured and not proven.
    #[arg(long)]
    strict: bool,
    /// Draw what the step of a shader's own loop misses, in red, beside the same without holes: of the first shader that a scene reads.
    #[arg(long, value_name = "FILE.png")]
    holes: Option<PathBuf>,
    /// Do without a rule for bounds (docs/rules.md lists them): what it gains is seen in the factors.
    #[arg(long, value_name = "RULE", value_parser = rule)]
    without_rule: Vec<&'static Row>,
}

/// The rule of a name.
fn rule(id: &str) -> Result<&'static Row, String> {
    Row::named(id).ok_or_else(|| format!("no rule has this name; the rules are {}", RULES.iter().map(|row| row.id).collect::<Vec<_>>().join(", ")))
}

/// Checks every scene.
pub fn run(args: &Args) -> Result<Exit, Failure> {
    let rules = args.without_rule.iter().fold(RuleSet::default(), |rules, row| rules.without(row.rule));
    let options = Options { strict: args.strict, rules, ..Options::default() };
    let mut exit = Exit::Fine;
    for scene in &args.scenes {
        let readable = files::read(Path::new(scene));
        let mut outcome = surefoot_compiler::compile(&FileLoader, scene, &options);
        outcome.look();
        let broken = outcome.compiled.as_ref().map_or_else(Vec::new, crate::picture::broken_meshes);
        outcome.diagnostics.extend(broken);
        let report = Report::of(scene, &outcome, (args.json || args.factors, args.factors));
        let text = match args.json {
            true => format!("{}\n", report.in_json()),
            false => report.in_words(colored(&std::io::stdout())),
        };
        print(text.as_bytes())?;
        if let (Some(path), Some(known)) = (&args.holes, &report.known) {
            let first = known.shaders.first().ok_or_else(|| Failure::usage(format!("{scene} reads no shader whose `map` could be stepped by")))?;
            first.draw(path).map_err(|why| Failure::usage(format!("can't write {}: {why}", path.display())))?;
        }
        exit = exit.max(match (&readable, outcome.has_errors()) {
            (Err(_), _) => Exit::Usage,
            (Ok(_), true) => Exit::Errors,
            (Ok(_), false) => Exit::Fine,
        });
    }
    Ok(exit)
}

/// What `check --json` says of a scene.
pub(super) fn in_json(scene: &str, outcome: &Outcome) -> Value {
    Report::of(scene, outcome, (true, false)).in_json()
}

/// All that is said of a scene: what a person reads and what a machine reads are both written from it.
struct Report<'a> {
    scene: &'a str,
    outcome: &'a Outcome,
    known: Option<Known<'a>>,
}

/// The rules that a factor was found by, and what it would be without each; none where that was not asked.
type Rules = Option<Vec<(&'static Row, f64)>>;

/// What is known of a scene without errors.
struct Known<'a> {
    compiled: &'a Compiled,
    /// Why each factor is what it is; none where that was not asked.
    factors: Option<Vec<(Explained, Rules)>>,
    solid: Option<SolidBox>,
    skipped: Vec<String>,
    unseen: Vec<String>,
    shaders: Vec<Stepped>,
}

impl<'a> Report<'a> {
    /// With its factors, and with their rules, where these are asked for.
    fn of(scene: &'a str, outcome: &'a Outcome, (factors, rules): (bool, bool)) -> Self {
        let sources = &outcome.sources;
        let known = outcome.compiled.as_ref().map(|compiled| Known {
            compiled,
            factors: factors.then(|| explained(compiled, sources, rules)),
            solid: compiled.solid_box(),
            skipped: skipped(compiled, sources),
            unseen: unseen(compiled, sources),
            shaders: stepped(compiled, outcome),
        });
        Self { scene, outcome, known }
    }

    /// For a person: the diagnostics, then one line, then what is known.
    fn in_words(&self, color: bool) -> String {
        let mut text = diagnostic::render(&self.outcome.sources, &self.outcome.diagnostics, color);
        let counted = count(&self.outcome.diagnostics);
        let counted = if counted.is_empty() { "fine".to_owned() } else { counted };
        text.push_str(&format!("{}: {counted}\n", self.scene));
        let Some(known) = &self.known else { return text };
        if let Some(factors) = &known.factors {
            text.push_str(&factors_text(factors, color));
        }
        let solid = known.solid.iter().map(SolidBox::words).collect();
        let baked = known.compiled.graph.baked.iter().map(|baked| self.baked_words(baked)).collect();
        let shaders = known.shaders.iter().map(Stepped::words).collect();
        for (title, lines) in [("left out", &known.skipped), ("never seen", &known.unseen), ("solid", &solid), ("baked", &baked), ("shaders", &shaders)] {
            if !lines.is_empty() {
                text.push_str(&format!("  {title}:\n    {}\n", lines.join("\n    ")));
            }
        }
        text
    }

    /// What became of a shape that is baked.
    fn baked_words(&self, baked: &Baked) -> String {
        let (file, line, column) = self.outcome.sources.position(baked.span.file, baked.span.start);
        let [x, y, z] = baked.bricks.map(|bricks| bricks * 8);
        let Off { largest, mean } = baked.off;
        format!(
            "{file}:{line}:{column}: {x} × {y} × {z} cells for {} operations; off by {largest:.2e} at most, {mean:.2e} in the mean, at 20,000 places about the surface",
            baked.operations
        )
    }

    /// For a machine.
    fn in_json(&self) -> Value {
        let known = self.known.as_ref();
        json!({
            "ok": !self.outcome.has_errors(),
            "file": self.scene,
            "diagnostics": self.outcome.diagnostics.iter().map(|d| diagnostic_json(&self.outcome.sources, d)).collect::<Vec<_>>(),
            "scene": known.map(scene_json),
            "parameters": known.map_or_else(Vec::new, |k| k.compiled.parameters.iter().map(parameter_json).collect()),
            "functions": known.map_or_else(Vec::new, |k| k.compiled.module.exports.iter().map(|e| e.name()).collect()),
            "skipped": known.map_or(&[][..], |k| &k.skipped),
            "unseen": known.map_or(&[][..], |k| &k.unseen),
            "shaders": known.map_or_else(Vec::new, |k| k.shaders.iter().map(Stepped::in_json).collect()),
            "files": all_read(self.outcome),
        })
    }
}

fn diagnostic_json(sources: &Sources, diagnostic: &Diagnostic) -> Value {
    let (file, line, column) = sources.position(diagnostic.span.file, diagnostic.span.start);
    let (_, end_line, end_column) = sources.position(diagnostic.span.file, diagnostic.span.end);
    let labels = diagnostic.labels.iter().map(|(span, words)| {
        let (file, line, column) = sources.position(span.file, span.start);
        json!({ "message": words, "file": file, "line": line, "column": column })
    });
    json!({
        "severity": match diagnostic.severity { Severity::Error => "error", Severity::Warning => "warning" },
        "code": diagnostic.code.row().name,
        "message": diagnostic.message,
        "file": file,
        "line": line,
        "column": column,
        "end_line": end_line,
        "end_column": end_column,
        "help": diagnostic.help,
        "labels": labels.collect::<Vec<_>>(),
    })
}

fn scene_json(known: &Known) -> Value {
    let summary = &known.compiled.summary;
    let factors = known.factors.iter().flatten();
    json!({
        "nodes": summary.nodes,
        "primitives": summary.primitives,
        "operations": known.compiled.module.operations.0,
        "bound_operations": known.compiled.module.operations.1,
        "kind": summary.kind.name(),
        "factor": summary.factor,
        "factors": factors.map(factor_json).collect::<Vec<_>>(),
        "bounds": known.solid.map(|solid| json!({
            "min": solid.low,
            "max": solid.high,
            "at_most": solid.at_most,
            "without_planes": solid.but_planes,
        })),
    })
}

fn factor_json((factor, rules): &(Explained, Rules)) -> Value {
    let (file, line, column) = &factor.place;
    let parameter = |p: &Ranged| json!({ "name": p.name, "degrees": p.degrees, "min": p.range[0], "max": p.range[1] });
    // JSON has no infinity: a side without an end is null.
    let region = factor.region.map(|[min, max]| json!({ "min": min, "max": max }));
    json!({
        "file": file,
        "line": line,
        "column": column,
        "operation": factor.operation,
        "text": factor.text,
        "factor": factor.factor,
        "live": factor.live,
        "depth": factor.depth,
        "product": factor.product,
        "region": region,
        "proof": factor.proof.name(),
        "form": factor.form,
        "uniform": factor.uniform,
        "parameters": factor.parameters.iter().map(parameter).collect::<Vec<_>>(),
        "reason": factor.reason,
        "advice": factor.advice,
        "rules": rules.as_ref().map(|rules| rules.iter().map(|(row, without)| json!({ "id": row.id, "without": without.is_finite().then_some(without) })).collect::<Vec<_>>()),
    })
}

/// For a person: a factor and what is known of it, those within it set in. Of those of one place, as copies in a loop have them, the steepest.
fn factors_text(explained: &[(Explained, Rules)], color: bool) -> String {
    if explained.is_empty() {
        return "  no factor: every step is a whole distance\n".to_owned();
    }
    let mut text = String::new();
    // Those within one that is left out are left out too.
    let mut left_out = None;
    for (i, (factor, rules)) in explained.iter().enumerate() {
        if left_out.is_some_and(|depth| factor.depth > depth) {
            continue;
        }
        let is_alike = |other: &Explained| (&other.operation, &other.place, other.depth, other.proof) == (&factor.operation, &factor.place, factor.depth, factor.proof);
        let alike = || explained.iter().map(|(other, _)| other).enumerate().filter(|(_, other)| is_alike(other));
        let steepest = alike().rev().max_by(|a, b| a.1.factor.total_cmp(&b.1.factor)).map(|(at, _)| at);
        if steepest != Some(i) {
            left_out = Some(factor.depth);
            continue;
        }
        left_out = None;
        let of = match alike().count() {
            1 => String::new(),
            count => format!(", the steepest of {count}"),
        };
        let indent = "  ".repeat(factor.depth + 1);
        let (red, plain) = if color && factor.proof == Proof::Measured { ("\u{1b}[31m", "\u{1b}[0m") } else { ("", "") };
        text.push_str(&format!("{indent}{red}{}{of}{plain}\n", factor.headline()));
        let known = format!("{red}{}{plain}: {}", factor.knowledge(), factor.reason);
        let following = factor.following("at the defaults");
        let lower = format!("lower it with {}", factor.advice);
        for line in [known, rules_text(rules), following, factor.cost(), lower] {
            if !line.is_empty() {
                text.push_str(&format!("{indent}  {line}\n"));
            }
        }
    }
    text
}

/// Each factor, with its rules where they are asked for: each of them is a search.
fn explained(compiled: &Compiled, sources: &Sources, rules: bool) -> Vec<(Explained, Rules)> {
    let rules_of = |factor: &Explained| rules.then(|| factors::rules_of(compiled, factor.index));
    factors::explain(compiled, sources).into_iter().map(|factor| (rules_of(&factor), factor)).map(|(rules, factor)| (factor, rules)).collect()
}

/// The rules that gain most, and what the factor would be without each.
fn rules_text(rules: &Rules) -> String {
    let one = |(row, without): &(&Row, f64)| match *without {
        without if without < STEEPEST => format!("{} (without it ×{without:.2})", row.id),
        _ => format!("{} (without it none)", row.id),
    };
    let rules = rules.as_deref().unwrap_or_default();
    match rules.get(..MOST_RULES).unwrap_or(rules) {
        [] => String::new(),
        [only] => format!("found by the rule {}", one(only)),
        most => format!("found by the rules {}", most.iter().map(one).collect::<Vec<_>>().join(", ")),
    }
}

/// A factor that is larger is none that a ray could go by.
const STEEPEST: f64 = 1e4;
/// No more rules of one factor are named.
const MOST_RULES: usize = 3;
