//! Imports go down: no circle among the files of a crate, and none from a lower floor to a higher one.

use crate::common::root;
use petgraph::algo::tarjan_scc;
use petgraph::graph::DiGraph;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use syn::visit::{self, Visit};

/// Crates, and the floors of their rooms from the ground up. A room is a folder or a file of the crate; what stands on one floor may import each other,
/// as long as no circle comes of it.
const FLOORS: [(&str, &[&str]); 4] = [
    (
        "compiler",
        &[
            "figure kept loader outline prelude random rules sampled shader source spread srgb unit vector",
            "diagnostic",
            "graph syntax",
            "live interface images camera section",
            "blocks evaluate",
            "analysis frame",
            "functions",
            "shading",
            "emit",
            "cells compiled",
            "followed physics",
            "mesh reference",
            "ablation by_hand certify contour factors home measure outlook pick skipped solid verify",
            "program",
            "pipeline reference_text",
            "language_service",
            "lib",
        ],
    ),
    ("hosts", &["digest fields fill parameter", "drawn glsl", "bevy engine godot page shader shadertoy three wgpu_py", "lib"]),
    ("runtime", &["copied_block images mesh view", "gpu", "module readback sheets", "passes physics", "frame", "film", "headless", "explain live tighten", "stage", "lib"]),
    ("editor", &["animation files marched measures meshes texts", "picture window", "command", "main"]),
];

type Module = Vec<String>;

/// The files of a crate, by module, and what each makes known of others under names of its own.
struct Crate {
    files: BTreeMap<Module, (PathBuf, syn::File)>,
    handed_on: BTreeMap<(Module, String), Module>,
}

/// Whether an item is there for tests alone.
fn is_test(attributes: &[syn::Attribute]) -> bool {
    attributes.iter().any(|attribute| attribute.path().is_ident("cfg") && attribute.parse_args::<syn::Ident>().is_ok_and(|ident| ident == "test"))
}

impl Crate {
    fn read(folder: &Path) -> Self {
        let mut found = Self { files: BTreeMap::new(), handed_on: BTreeMap::new() };
        let top = ["lib.rs", "main.rs"].map(|name| folder.join(name)).into_iter().find(|path| path.exists()).unwrap();
        found.read_module(Vec::new(), &top, folder);
        for (module, (_, file)) in &found.files {
            for (path, name) in uses(&file.items) {
                let target = absolute(module, &path, &found.files);
                found.handed_on.extend(target.map(|target| ((module.clone(), name), target)));
            }
        }
        found
    }

    /// Reads a module's file, and those that it declares, which stand in `inner`.
    fn read_module(&mut self, module: Module, path: &Path, inner: &Path) {
        let file = syn::parse_file(&std::fs::read_to_string(path).unwrap()).unwrap();
        for item in &file.items {
            let syn::Item::Mod(declared) = item else { continue };
            if is_test(&declared.attrs) || declared.content.is_some() {
                continue;
            }
            let name = declared.ident.to_string();
            let below = inner.join(&name);
            let path = [inner.join(format!("{name}.rs")), below.join("mod.rs")].into_iter().find(|path| path.exists());
            let path = path.unwrap_or_else(|| panic!("no file of {name} in {inner:?}"));
            self.read_module([&module[..], &[name]].concat(), &path, &below);
        }
        self.files.insert(module, (path.to_owned(), file));
    }

    /// The module in which what a path names is defined, as far as this crate's files tell.
    fn defining(&self, path: &[String]) -> Option<Module> {
        let mut path = path.to_vec();
        for _ in 0..8 {
            let module = (0..=path.len()).rev().map(|n| path[..n].to_vec()).find(|module| self.files.contains_key(module))?;
            let Some(name) = path.get(module.len()) else { return Some(module) };
            let Some(target) = self.handed_on.get(&(module.clone(), name.clone())) else { return Some(module) };
            path = [target, &path[module.len() + 1..]].concat();
        }
        None
    }

    /// Which file imports which, as paths below the crate's `src`.
    fn imports(&self, folder: &Path) -> BTreeSet<(String, String)> {
        let name = |module: &Module| self.files[module].0.strip_prefix(folder).unwrap().to_str().unwrap().to_owned();
        let mut imports = BTreeSet::new();
        for (module, (_, file)) in &self.files {
            let mut paths = Paths::default();
            paths.visit_file(file);
            let named = paths.found.iter().filter_map(|path| absolute(module, path, &self.files)).filter_map(|path| self.defining(&path));
            imports.extend(named.filter(|target| target != module).map(|target| (name(module), name(&target))));
        }
        imports
    }
}

/// What a path that is written in a module names, from the crate's top; none for what is of another crate or of the module itself.
fn absolute(module: &Module, path: &[String], files: &BTreeMap<Module, (PathBuf, syn::File)>) -> Option<Module> {
    let ups = path.iter().take_while(|part| *part == "super").count();
    match path.first().map(String::as_str)? {
        "crate" => Some(path[1..].to_vec()),
        "self" => Some([module, &path[1..]].concat()),
        "super" => Some([&module[..module.len().checked_sub(ups)?], &path[ups..]].concat()),
        first => files.contains_key(&[&module[..], &[first.to_owned()]].concat()).then(|| [module, path].concat()),
    }
}

/// The leaves of all `use` among some items, each with the name under which it is known.
fn uses(items: &[syn::Item]) -> Vec<(Vec<String>, String)> {
    fn leaves(tree: &syn::UseTree, before: &[String], found: &mut Vec<(Vec<String>, String)>) {
        let with = |ident: &syn::Ident| [before, &[ident.to_string()]].concat();
        match tree {
            syn::UseTree::Path(path) => leaves(&path.tree, &with(&path.ident), found),
            syn::UseTree::Name(name) if name.ident == "self" => found.push((before.to_vec(), before.last().cloned().unwrap_or_default())),
            syn::UseTree::Name(name) => found.push((with(&name.ident), name.ident.to_string())),
            syn::UseTree::Rename(name) if name.ident == "self" => found.push((before.to_vec(), name.rename.to_string())),
            syn::UseTree::Rename(name) => found.push((with(&name.ident), name.rename.to_string())),
            syn::UseTree::Glob(_) => found.push((before.to_vec(), "*".to_owned())),
            syn::UseTree::Group(group) => group.items.iter().for_each(|tree| leaves(tree, before, found)),
        }
    }
    let mut found = Vec::new();
    for item in items {
        if let syn::Item::Use(item) = item
            && !is_test(&item.attrs)
        {
            leaves(&item.tree, &[], &mut found);
        }
    }
    found
}

/// All paths of a file but those of its tests.
#[derive(Default)]
struct Paths {
    found: Vec<Vec<String>>,
    /// How many modules without a file of their own are around.
    within: usize,
}

impl Paths {
    /// A path as it would be written outside of modules that have no file.
    fn add(&mut self, path: Vec<String>) {
        let ups = path.iter().take_while(|part| *part == "super").count().min(self.within);
        let from = if ups > 0 && path.get(ups).is_none_or(|part| part != "super") { vec!["self".to_owned()] } else { Vec::new() };
        self.found.push([&from, &path[ups..]].concat());
    }
}

impl<'ast> Visit<'ast> for Paths {
    fn visit_item(&mut self, item: &'ast syn::Item) {
        let attributes: &[syn::Attribute] = match item {
            syn::Item::Mod(item) => &item.attrs,
            syn::Item::Fn(item) => &item.attrs,
            syn::Item::Impl(item) => &item.attrs,
            syn::Item::Use(item) => &item.attrs,
            _ => &[],
        };
        if !is_test(attributes) {
            visit::visit_item(self, item);
        }
    }

    fn visit_item_mod(&mut self, item: &'ast syn::ItemMod) {
        self.within += 1;
        visit::visit_item_mod(self, item);
        self.within -= 1;
    }

    /// How far a name is seen says nothing of what the file imports.
    fn visit_vis_restricted(&mut self, _: &'ast syn::VisRestricted) {}

    fn visit_item_use(&mut self, item: &'ast syn::ItemUse) {
        for (path, _) in uses(&[syn::Item::Use(item.clone())]) {
            self.add(path);
        }
    }

    fn visit_path(&mut self, path: &'ast syn::Path) {
        if path.segments.len() > 1 {
            self.add(path.segments.iter().map(|segment| segment.ident.to_string()).collect());
        }
        visit::visit_path(self, path);
    }
}

/// The floor of a file's room, from the ground up.
fn floor(floors: &[&str], file: &str) -> usize {
    let room = file.split('/').next().unwrap().trim_end_matches(".rs");
    floors.iter().position(|floor| floor.split(' ').any(|name| name == room)).unwrap_or_else(|| panic!("{file} stands on no floor: say on which in tests/tests/imports.rs"))
}

/// Files that import each other in a circle, those of each together.
fn circles<'a>(imports: &[(&'a str, &'a str)]) -> Vec<BTreeSet<&'a str>> {
    let files: BTreeSet<&str> = imports.iter().flat_map(|(from, to)| [*from, *to]).collect();
    let mut graph = DiGraph::<&str, ()>::new();
    let places: BTreeMap<&str, _> = files.into_iter().map(|file| (file, graph.add_node(file))).collect();
    for (from, to) in imports {
        graph.add_edge(places[from], places[to], ());
    }
    let circles = tarjan_scc(&graph).into_iter().filter(|circle| circle.len() > 1);
    let mut circles: Vec<BTreeSet<&str>> = circles.map(|circle| circle.into_iter().map(|at| graph[at]).collect()).collect();
    circles.sort();
    circles
}

#[test]
fn imports_go_down() {
    let mut says = Vec::new();
    for (name, floors) in FLOORS {
        let folder = root().join(name).join("src");
        let named = |file: &str| format!("{name}/src/{file}");
        let found = Crate::read(&folder).imports(&folder);
        let least = if name == "hosts" { 15 } else { 50 };
        assert!(found.len() > least, "{name}: {} imports", found.len());
        let goes_up = |(from, to): &&(String, String)| floor(floors, from) < floor(floors, to);
        says.extend(found.iter().filter(goes_up).map(|(from, to)| format!("{} imports {}, which stands on a higher floor", named(from), named(to))));
        let imports: Vec<(&str, &str)> = found.iter().map(|(from, to)| (from.as_str(), to.as_str())).collect();
        for circle in circles(&imports) {
            let within = imports.iter().filter(|(from, to)| circle.contains(from) && circle.contains(to));
            let within: Vec<String> = within.map(|(from, to)| format!("  {} -> {}", named(from), named(to))).collect();
            says.push(format!("these imports form a circle:\n{}", within.join("\n")));
        }
    }
    assert!(says.is_empty(), "{}", says.join("\n"));
}
