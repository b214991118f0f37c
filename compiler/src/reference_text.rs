//! The reference of the language as a page of Markdown: the part that people wrote, then everything that comes with the language,
//! taken from the kernel's table and the prelude's own text.

use crate::graph::kernel::KERNEL;
use crate::program::builtin::argument_names;
use crate::source::Sources;
use crate::syntax::ast::{ClaimKind, Function, FunctionKind, Item, ItemKind};
use crate::syntax::parse;
use std::fmt::Write as _;

/// The part that people wrote.
pub const HEAD: &str = include_str!("reference_text/head.md");

/// The files of the prelude, in the order in which the reference shows them: name, title, text.
pub const CHAPTERS: &[(&str, &str, &str)] = &[
    ("primitives", "Solids", include_str!("../prelude/primitives.sdf")),
    ("drawings", "Drawings", include_str!("../prelude/drawings.sdf")),
    ("curves", "Curves and points", include_str!("../prelude/curves.sdf")),
    ("blends", "Combinations", include_str!("../prelude/blends.sdf")),
    ("placement", "Placement", include_str!("../prelude/placement.sdf")),
    ("warps", "Deformations", include_str!("../prelude/warps.sdf")),
    ("noise", "Noise", include_str!("../prelude/noise.sdf")),
    ("numbers", "Numbers", include_str!("../prelude/numbers.sdf")),
];

/// The parts that a scene imports as `std/NAME.sdf`, in the order in which their page shows them: name, title, text.
pub const PARTS: &[(&str, &str, &str)] = &[
    ("threads", "Threads", include_str!("../std/threads.sdf")),
    ("fasteners", "Screws, nuts and washers", include_str!("../std/fasteners.sdf")),
    ("gears", "Gears", include_str!("../std/gears.sdf")),
    ("profiles", "Bars", include_str!("../std/profiles.sdf")),
    ("noise", "Noise", include_str!("../std/noise.sdf")),
    ("fractals", "Fractals", include_str!("../std/fractals.sdf")),
    ("plants", "Plants", include_str!("../std/plants.sdf")),
];

/// A declaration of the prelude or of a part with what its comment says.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// Its name. Several entries may share it.
    pub name: String,
    /// What declares it; none for a material.
    pub kind: Option<FunctionKind>,
    /// Its first line, up to the equals sign, without a claim.
    pub signature: String,
    /// What it is.
    pub text: String,
    /// Conditions on its arguments.
    pub requires: Vec<String>,
    /// Where its formula is from.
    pub source: String,
    /// The body of a scene that shows it.
    pub example: String,
    /// What its value is known to be: `exact`, or `lipschitz` and a formula.
    pub claim: Option<String>,
}

impl Entry {
    /// Whether the reference shows a picture of it.
    pub fn pictured(&self) -> bool {
        self.kind.is_some_and(|k| k != FunctionKind::Fn)
    }
}

/// The pictures of the page: name of the file, and the text of the scene that it shows.
pub fn pictures() -> Vec<(String, String)> {
    let mut all: Vec<(String, String)> = Vec::new();
    for (file, _, text) in CHAPTERS {
        let mut names: Vec<String> = Vec::new();
        for entry in entries(file, text) {
            if entry.pictured() && !names.contains(&entry.name) {
                names.push(entry.name.clone());
                all.push((picture_name(file, &entry.name), picture_scene(&entry.example)));
            }
        }
    }
    all.extend(part_scenes().into_iter().map(|(part, entry, scene)| (part_picture(&part, &entry.name), scene)));
    all
}

/// The entries of the parts that have an example: the name of the part, the entry, and the text of the scene that shows it.
pub fn part_scenes() -> Vec<(String, Entry, String)> {
    let scenes = PARTS.iter().flat_map(|(part, _, text)| entries(part, text).into_iter().map(|entry| (*part, entry)));
    let shown = scenes.filter(|(_, entry)| !entry.example.is_empty());
    let with_scene = |(part, entry): (&str, Entry)| {
        let scene = part_scene(part, &entry.example);
        (part.to_owned(), entry, scene)
    };
    shown.map(with_scene).collect()
}

fn part_scene(part: &str, example: &str) -> String {
    format!("import \"std/{part}.sdf\"\n{}", picture_scene(example))
}

fn part_picture(part: &str, name: &str) -> String {
    format!("std-{part}-{name}.png")
}

/// A name that two chapters have is told apart by the chapter.
fn picture_name(chapter: &str, name: &str) -> String {
    let taken = CHAPTERS.iter().take_while(|(file, ..)| *file != chapter).any(|(file, _, text)| {
        entries(file, text).iter().any(|e| e.name == name && e.pictured())
    });
    if taken { format!("{name}-{chapter}.png") } else { format!("{name}.png") }
}

/// An example in the light in which the page shows it.
fn picture_scene(example: &str) -> String {
    format!(
        "material clay {{ color: #d9a273, roughness: 0.6 }}\n\
         scene = ({example}).material(clay)\n\
         camera {{ eye: (2.2, 1.8, 3), fov: 40deg }}\n\
         light key {{ direction: (-0.6, -1.1, -0.7), color: #fff1e0, intensity: 3, shadow: soft(12) }}\n\
         environment {{ sky: gradient(#b9c7d6, #f4f1ea) }}\n\
         render {{ extent: 20 }}\n"
    )
}

/// The entries of one file of the prelude, in the order of its text.
pub fn entries(name: &str, text: &str) -> Vec<Entry> {
    let mut sources = Sources::default();
    let id = sources.add(name, text);
    let (file, _) = parse(id, text);
    file.items.iter().filter_map(|item| entry(&sources, item)).collect()
}

fn entry(sources: &Sources, item: &Item) -> Option<Entry> {
    let whole = sources.text(item.span);
    let (name, kind, signature, claim) = match &item.kind {
        ItemKind::Function(f) => {
            let (signature, claim) = signature(sources, item, f);
            (f.name.text.to_string(), Some(f.kind), signature, claim)
        }
        ItemKind::Material { name, .. } => {
            let signature = whole.split('{').next().unwrap_or(whole).trim().to_owned();
            (name.text.to_string(), None, signature, None)
        }
        _ => return None,
    };
    let mut entry = Entry {
        name,
        kind,
        signature,
        text: String::new(),
        requires: Vec::new(),
        source: String::new(),
        example: String::new(),
        claim,
    };
    // A source may go on in the next line.
    let mut sourced = false;
    for line in item.doc.as_deref().unwrap_or("").lines().map(str::trim) {
        let goes_on = std::mem::take(&mut sourced);
        if let Some(rest) = line.strip_prefix("Source:") {
            entry.source = rest.trim().to_owned();
            sourced = true;
        } else if let Some(rest) = line.strip_prefix("Example:") {
            entry.example = rest.trim().to_owned();
        } else if ["Reach:", "Bounds:", "Flush:"].iter().any(|of| line.starts_with(of)) {
            // For the compiler: the text says it in words.
        } else if let Some(rest) = line.strip_prefix("Requires:") {
            entry.requires.extend(rest.split(',').map(|r| r.trim().to_owned()));
        } else {
            sourced = goes_on;
            let text = if goes_on { &mut entry.source } else { &mut entry.text };
            if !text.is_empty() {
                text.push(' ');
            }
            text.push_str(line);
        }
    }
    Some(entry)
}

/// The text of a function up to its equals sign, and its claim.
fn signature(sources: &Sources, item: &Item, f: &Function) -> (String, Option<String>) {
    let mut head = item.span;
    head.end = f.body.span.start;
    let mut claimed = None;
    if let Some(claim) = &f.claim {
        head.end = claim.span.start;
        claimed = Some(match &claim.kind {
            ClaimKind::Exact => "exact".to_owned(),
            ClaimKind::Lipschitz(e, range) => {
                let range = range.as_ref().map_or(String::new(), |r| format!(" in {}", sources.text(r.span)));
                format!("lipschitz {}{range}", sources.text(e.span))
            }
        });
    }
    let words: Vec<&str> = sources.text(head).split_whitespace().collect();
    // What is laid out on several lines is told on one.
    let text = words.join(" ").replace("( ", "(").replace(", )", ")");
    (text.trim_end_matches('=').trim_end().to_owned(), claimed)
}

/// The whole page.
pub fn language_reference() -> String {
    let mut page = String::from(
        "<!-- Written by `surefoot reference` from compiler/src/reference_text/head.md, the kernel and the prelude. Do not edit. -->\n\n",
    );
    page.push_str(HEAD);
    page.push_str("\n## Functions of the language\n\n");
    page.push_str(
        "These operations are the compiler's own; everything further down is written in the language, and its formulas can be \
         read in `compiler/prelude/`. On a vector they work component by component.\n\n| | |\n|---|---|\n",
    );
    for row in KERNEL.iter().filter(|row| row.callable) {
        let arguments = argument_names(row.name, row.arity.into()).join(", ");
        let _ = writeln!(page, "| `{}({arguments})` | {} |", row.name, row.doc);
    }
    for (file, title, text) in CHAPTERS {
        let _ = write!(page, "\n## {title}\n\n{}\n", head_comment(text));
        let entries = entries(file, text);
        let mut names: Vec<&str> = Vec::new();
        for entry in &entries {
            if !names.contains(&entry.name.as_str()) {
                names.push(&entry.name);
            }
        }
        let links: Vec<String> = names.iter().map(|n| format!("[{n}](#{n})")).collect();
        let _ = write!(page, "\n{}\n", links.join(" · "));
        for name in names {
            let same: Vec<&Entry> = entries.iter().filter(|e| e.name == name).collect();
            write_entries(&mut page, file, name, &same);
        }
    }
    page
}

/// The page of the parts. `steepest` says of the text of a scene how steep what it shows is.
pub fn parts_reference(steepest: &dyn Fn(&str) -> String) -> String {
    let mut page = String::from(
        "<!-- Written by `surefoot reference` from compiler/std/. Do not edit. -->\n\n# Parts\n\nThese files come with the language, and a scene \
         imports what it needs:\n\n```\nimport \"std/fasteners.sdf\"\n\nscene = hex_screw(8, 30) | nut(8).translate(0, -20, 0)\n```\n\nThey are \
         written in the language, in `compiler/std/`, and proven as everything else is. The factor is that of the example: how many times steeper \
         than a distance its formulas are at most, ×1 where they are none.\n\n",
    );
    for (part, title, _) in PARTS {
        let _ = writeln!(page, "- [{title}](#{}): `import \"std/{part}.sdf\"`", title.to_lowercase().replace(' ', "-").replace(',', ""));
    }
    for (part, title, text) in PARTS {
        let _ = write!(page, "\n## {title}\n\n`import \"std/{part}.sdf\"`\n\n{}\n", head_comment(text));
        for entry in entries(part, text) {
            let name = &entry.name;
            let _ = write!(page, "\n### {name}\n\n");
            if entry.example.is_empty() {
                write_entry(&mut page, &entry);
                page.push('\n');
                continue;
            }
            let _ = write!(page, "<img align=\"right\" width=\"160\" height=\"120\" alt=\"{name}\" src=\"pictures/{}\">\n\n", part_picture(part, name));
            write_entry(&mut page, &entry);
            let _ = write!(page, " Factor {}.\n\n```\nscene = {}\n```\n", steepest(&part_scene(part, &entry.example)), entry.example);
        }
    }
    page
}

/// The `//!` lines of a file, as one paragraph.
fn head_comment(text: &str) -> String {
    let lines: Vec<&str> =
        text.lines().map_while(|l| l.strip_prefix("//!")).map(str::trim).collect();
    lines.join(" ")
}

fn write_entries(page: &mut String, chapter: &str, name: &str, entries: &[&Entry]) {
    let _ = write!(page, "\n### {name}\n\n");
    if entries.iter().any(|e| e.pictured()) {
        let file = picture_name(chapter, name);
        let _ = write!(
            page,
            "<img align=\"right\" width=\"160\" height=\"120\" alt=\"{name}\" src=\"pictures/{file}\">\n\n"
        );
    }
    for entry in entries {
        write_entry(page, entry);
        page.push_str("\n\n");
        if !entry.example.is_empty() && (entry.pictured() || entries.len() == 1) {
            let _ = write!(page, "```\nscene = {}\n```\n\n", entry.example);
        }
    }
    while page.ends_with("\n\n") {
        page.pop();
    }
}

/// What an entry is, in one paragraph below its signature.
fn write_entry(page: &mut String, entry: &Entry) {
    let _ = write!(page, "`{}`\n\n{}", entry.signature, entry.text);
    if !entry.requires.is_empty() {
        let conditions: Vec<String> = entry.requires.iter().map(|r| format!("`{r}`")).collect();
        let _ = write!(page, " Needs {}.", conditions.join(", "));
    }
    match entry.claim.as_deref() {
        Some("exact") => page.push_str(" The value is the exact distance."),
        // What is computed in a block is read where it is written.
        Some(claim) if claim.contains('{') => page.push_str(" How steep it is, is claimed of its arguments."),
        Some(claim) => {
            let _ = write!(page, " Claim: `{claim}`.");
        }
        None => {}
    }
    if !entry.source.is_empty() {
        let _ = write!(page, " *{}*", entry.source);
    }
}
