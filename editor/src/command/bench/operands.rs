//! `surefoot bench --operands`: whether what a scene costs grows as its operands do. Each scene is compiled, looked at and reported in a process of its own,
//! with a small stack.

use crate::command::console::{Exit, Failure, print};
use crate::command::check;
use serde_json::{Value, json};
use std::fmt::Write;
use std::process::Command;
use surefoot_compiler::{Memory, MemoryLoader, Options, compile_remembering};

/// Stack of each process, in KiB.
const STACK: usize = 1024;

const BALL: &str = "sphere(0.02).translate(i / 100, 0, 0)";
const LARGE: &str = "sphere(200).translate(i / N, 0, 0)";
const BAR: &str = "if i < 1 { box((N / 40, 1, 1)) } else { sphere(0.02).translate(i / 100, 0, 0) }";
const WAVY: &str = "[for i in 0..N { (1 + 0.1 * sin(7 * i * tau / N)) * (cos(i * tau / N), sin(i * tau / N)) }]";

/// Every way to join many: a name, and its text, in which `N` is how many.
fn scenes() -> Vec<(String, String)> {
    let fold = |name: &str, by: &str, body: &str| (name.to_owned(), format!("for i in 0..N by {by} {{ {body} }}"));
    let mut all = vec![("plain union".to_owned(), format!("for i in 0..N {{ {BALL} }}"))];
    for (name, given) in [("union", ""), ("smooth_union", "0.05"), ("round_union", "0.05"), ("chamfer_union", "0.05"), ("stairs_union", "0.05, 3"), ("xor", ""), ("mix", "0.5")] {
        all.push(fold(name, &format!("{name}({given})"), BALL));
    }
    for (kind, given) in [("", ""), ("smooth_", "0.05"), ("round_", "0.05"), ("chamfer_", "0.05"), ("stairs_", "0.05, 3")] {
        for (join, body) in [("intersection", LARGE), ("difference", BAR)] {
            let name = format!("{kind}{join}");
            all.push(fold(&name, &format!("{name}({given})"), body));
        }
    }
    let drawings = [
        ("polygon", format!("polygon({WAVY})")),
        ("segments", "for i in 0..N { segment((i / 100, sin(i / 30)), ((i + 1) / 100, sin((i + 1) / 30))).round(0.01) }".to_owned()),
    ];
    all.extend(drawings.map(|(name, text)| (name.to_owned(), format!("({text}).extrude(0.5)"))));
    let moved: Vec<(String, String)> = ["plain union", "smooth_union", "chamfer_union", "xor", "polygon"]
        .iter()
        .filter_map(|wanted| all.iter().find(|(name, _)| name == wanted))
        .flat_map(|(name, text)| {
            [("twisted", "twist(z, 0.3)"), ("folded", "fold((1, 0.2, 0.3))")].map(|(word, warp)| (format!("{name}, {word}"), format!("({text}).{warp}")))
        })
        .collect();
    all.extend(moved);
    all
}

/// Measures all scenes with each of these numbers of operands, and prints a table, or a JSON object for each on a line of its own. The answer: the table.
pub fn run(counts: &[usize], as_json: bool) -> Result<String, Failure> {
    let mut rows: Vec<(String, Vec<Value>)> = Vec::new();
    for (name, text) in scenes() {
        let mut row = Vec::new();
        for &count in counts {
            let measured = measure(&text, count)?;
            if as_json {
                let mut line = measured.clone();
                line["scene"] = json!(name);
                line["operands"] = json!(count);
                print(format!("{line}\n").as_bytes())?;
            }
            row.push(measured);
        }
        rows.push((name, row));
    }
    let table = table(counts, &rows);
    if !as_json {
        print(table.as_bytes())?;
    }
    Ok(table)
}

/// One scene in a process of its own.
fn measure(text: &str, count: usize) -> Result<Value, Failure> {
    let own = std::env::current_exe().map_err(|e| Failure::usage(format!("can't find this program: {e}")))?;
    let text = format!("scene = {}\n", text.replace('N', &count.to_string()));
    let mut command = Command::new("sh");
    command.args(["-c", &format!("ulimit -s {STACK}; exec \"$0\" bench --operand \"$1\"")]).arg(own).arg(text);
    let output = command.output().map_err(|e| Failure::usage(format!("can't start a process: {e}")))?;
    let told = serde_json::from_slice(&output.stdout).unwrap_or(Value::Null);
    match told {
        Value::Null => Ok(json!({ "exit": output.status.to_string() })),
        told => Ok(told),
    }
}

/// What the process does that [`measure`] starts: all that `check --json` does, without what it prints.
pub fn one(text: &str) -> Result<Exit, Failure> {
    let loader = MemoryLoader::new().with("many.sdf", text);
    let mut memory = Memory::default();
    let mut outcome = compile_remembering(&loader, "many.sdf", &Options::default(), &mut memory, &mut |_| {});
    outcome.look();
    let report = check::in_json("many.sdf", &outcome);
    let code = outcome.diagnostics.iter().find(|_| outcome.has_errors()).map(|d| d.code.row().name);
    let told = json!({
        "exit": code.unwrap_or("0"),
        "seconds": processor_seconds(),
        "megabytes": peak_megabytes(),
        "steps": memory.steps,
        "text": outcome.compiled.as_ref().map(|c| c.module.wgsl.len()),
        "report": report.to_string().len(),
    });
    print(format!("{told}\n").as_bytes())?;
    Ok(Exit::Fine)
}

/// Processor time of this process; none where the system does not say it as Linux does.
fn processor_seconds() -> Option<f64> {
    let stat = std::fs::read_to_string("/proc/self/stat").ok()?;
    let numbers: Vec<f64> = stat.rsplit_once(") ")?.1.split(' ').filter_map(|word| word.parse().ok()).collect();
    // The state is no number; user and system time are the 12th and 13th after it, in hundredths.
    Some((numbers.get(10)? + numbers.get(11)?) / 100.0)
}

/// The most memory that this process had at once.
fn peak_megabytes() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    let kibibytes: f64 = line.split_whitespace().nth(1)?.parse().ok()?;
    Some(kibibytes * 1024.0 / 1e6)
}

fn table(counts: &[usize], rows: &[(String, Vec<Value>)]) -> String {
    let mut text = format!(
        "Each scene compiled, looked at and reported as `check --json` does, in a process of its own with a stack of {STACK} KiB: how it ends, seconds of \
         processor time, and the most memory in MB.\n\n|"
    );
    let mut rule = "|---|".to_owned();
    for count in counts {
        let _ = write!(text, " | {count}: ends | s | MB");
        rule.push_str("---:|---:|---:|");
    }
    let _ = writeln!(text, " |\n{rule}");
    for (name, row) in rows {
        let _ = write!(text, "| {name}");
        for measured in row {
            let number = |of: &str, digits: usize| measured[of].as_f64().map_or("-".to_owned(), |n| format!("{n:.digits$}"));
            let _ = write!(text, " | {} | {} | {}", measured["exit"].as_str().unwrap_or("-"), number("seconds", 2), number("megabytes", 0));
        }
        text.push_str(" |\n");
    }
    text
}
