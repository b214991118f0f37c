//! The parts of the scene, found on the thread that compiles, and which of them are left out of the picture. The file stays as it is: what is compiled
//! has spaces where a part is hidden, and what is said of it has its places in the text that a person sees.

use std::collections::BTreeMap;
use std::mem::take;
use std::sync::{Arc, Mutex};
use surefoot_compiler::compiled::{Loader, Options, Outcome};
use surefoot_compiler::diagnostic::Severity;
use surefoot_compiler::factors::explain;
use surefoot_compiler::language_service::{self as service, Part, Shown, World};
use surefoot_compiler::sampled::{Grid, Settings};
use surefoot_compiler::source::Sources;
use surefoot_compiler::{Memory, compile_remembering};

use super::meter::lock;

/// What the window and the thread that compiles share.
#[derive(Clone, Default)]
pub struct Parts(Arc<Mutex<Shared>>);

#[derive(Default)]
struct Shared {
    /// Whether a person looks at them.
    asked: bool,
    shown: Shown,
    /// Whether rays may go side by side, though no camera of the text has that.
    parallel: bool,
    found: Found,
}

/// What was found of the newest text without errors.
#[derive(Clone, Default)]
pub struct Found {
    /// The scene, and within it all else.
    pub root: Option<Arc<Part>>,
    /// Of how many parts the picture is without.
    pub left_out: usize,
    /// Why something is shown that a person has hidden.
    pub refused: Option<String>,
}

impl Parts {
    /// What was found last.
    pub fn found(&self) -> Found {
        lock(&self.0).found.clone()
    }

    /// What a person has hidden.
    pub fn shown(&self) -> Shown {
        lock(&self.0).shown.clone()
    }

    /// Asks for them from now on, or no longer. Whether that needs another compilation.
    pub fn ask(&self, asked: bool) -> bool {
        let mut shared = lock(&self.0);
        let new = asked && !shared.asked;
        shared.asked = asked;
        new
    }

    /// Hides parts.
    pub fn show(&self, shown: Shown) {
        lock(&self.0).shown = shown;
    }

    /// Whether rays may go side by side. The answer: whether that is new.
    pub fn let_parallel(&self, parallel: bool) -> bool {
        let mut shared = lock(&self.0);
        std::mem::replace(&mut shared.parallel, parallel) != parallel
    }

    /// Compiles a scene without what is hidden, and finds its parts where they are asked for.
    pub fn compile(&self, loader: &dyn Loader, path: &str, options: &Options, memory: &mut Memory) -> Outcome {
        let (asked, shown, parallel) = {
            let shared = lock(&self.0);
            (shared.asked, shared.shown.clone(), shared.parallel)
        };
        let mut outcome = if asked || !shown.is_all() {
            self.look(loader, path, options, memory, &shown)
        } else {
            lock(&self.0).found = Found::default();
            compile_remembering(loader, path, options, memory, &mut |_| {})
        };
        if let Some(compiled) = &mut outcome.compiled {
            compiled.blocks.parallel = parallel;
        }
        outcome
    }

    fn look(&self, loader: &dyn Loader, path: &str, options: &Options, memory: &mut Memory, shown: &Shown) -> Outcome {
        let world = World::read(loader, &[path]);
        let mut root = world.file(path).and_then(|file| service::parts(&world, file));
        let mut found = Found::default();
        let mut outcome = None;
        if let Some(root) = root.as_ref().filter(|_| !shown.is_all()) {
            match service::without(&world, root, shown) {
                Ok(texts) if texts.is_empty() => {}
                Ok(texts) => {
                    let over = Over { loader, texts };
                    let cut = compile_remembering(&over, path, options, memory, &mut |_| {});
                    if cut.compiled.is_some() {
                        found.left_out = root.all().iter().filter(|(_, part)| shown.hidden.contains(&part.id)).count().max(1);
                        outcome = Some(of_whole_texts(cut, &world));
                    } else {
                        let why = cut.diagnostics.iter().find(|said| said.severity == Severity::Error).map(|said| said.message.clone());
                        found.refused = Some(why.unwrap_or_default());
                    }
                }
                Err(why) => found.refused = Some(why),
            }
        }
        let outcome = outcome.unwrap_or_else(|| compile_remembering(loader, path, options, memory, &mut |_| {}));
        let mut shared = lock(&self.0);
        // Of a text with errors nothing is known, and the picture is the last one.
        let Some((compiled, root)) = outcome.compiled.as_ref().zip(root.as_mut()) else { return outcome };
        drop(take(&mut shared.found.refused));
        let before = shared.found.root.clone();
        drop(shared);
        service::tell(root, compiled, &outcome.sources, &explain(compiled, &outcome.sources));
        if let Some(before) = before {
            remember(root, &before);
        }
        found.root = Some(Arc::new(root.clone()));
        lock(&self.0).found = found;
        outcome
    }
}

/// Of what is not in the scene just now it is known what it was when it was.
fn remember(root: &mut Part, before: &Part) {
    let known: BTreeMap<&str, &Part> = before.all().into_iter().map(|(_, part)| (part.id.as_str(), part)).collect();
    let mut stack = vec![root];
    while let Some(part) = stack.pop() {
        if let Some(before) = known.get(part.id.as_str()).filter(|_| part.operations.is_none()) {
            (part.factor, part.operations, part.region) = (before.factor, before.operations, before.region);
        }
        stack.extend(part.within.iter_mut());
    }
}

/// An outcome with the texts that a person sees. What warns is said of a scene that nobody has written.
fn of_whole_texts(mut outcome: Outcome, world: &World) -> Outcome {
    let mut sources = Sources::default();
    for (_, file) in outcome.sources.iter() {
        let whole = world.file(&file.name).filter(|_| world.paths().any(|path| path == file.name)).map(|id| world.text(id));
        sources.add(file.name.clone(), whole.map_or_else(|| file.text.clone(), Arc::from));
    }
    outcome.sources = sources;
    outcome.diagnostics.retain(|said| said.severity == Severity::Error);
    outcome
}

/// Texts that stand before those of a loader.
struct Over<'a> {
    loader: &'a dyn Loader,
    texts: BTreeMap<String, String>,
}

impl Loader for Over<'_> {
    fn read(&self, path: &str) -> Result<Vec<u8>, String> {
        // Read all the same: whoever follows the files hears of this one.
        let bytes = self.loader.read(path);
        self.texts.get(path).map_or(bytes, |text| Ok(text.clone().into_bytes()))
    }

    fn read_up_to(&self, path: &str, most: u64) -> Result<Vec<u8>, String> {
        self.loader.read_up_to(path, most)
    }

    fn grid(&self, path: &str, settings: Settings) -> Result<Arc<Grid>, String> {
        self.loader.grid(path, settings)
    }
}
