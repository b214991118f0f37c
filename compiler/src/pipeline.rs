//! The list of passes, on one screen: text → trees → graph → functions → module.

use crate::analysis::Facts;
use crate::analysis::analysis_cache::Memory;
use crate::compiled::{Compiled, Outcome};
use crate::interface::{Entry, Export, Options};
use crate::loader::Loader;
use crate::diagnostic::{Code, Diagnostic, Severity, tidy};
use crate::camera::Home;
use crate::source::Sources;
use crate::program::Grids;
use crate::program::load::Loaded;
use crate::{emit, functions, program};

/// A stage of the pipeline, in their order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Stage {
    /// Texts read and parsed.
    Read,
    /// Names, types and calls: trees to graph.
    Elaborate,
    /// Regions, constants, and the functions made with them.
    Analyse,
    /// The graph as WGSL.
    Emit,
}

impl Stage {
    /// Its name in tables.
    pub fn name(self) -> &'static str {
        match self {
            Stage::Read => "read",
            Stage::Elaborate => "elaborate",
            Stage::Analyse => "analyse",
            Stage::Emit => "emit",
        }
    }
}

/// Compiles the scene at `path`.
pub fn compile(loader: &dyn Loader, path: &str, options: &Options) -> Outcome {
    compile_observed(loader, path, options, &mut |_| {})
}

/// Compiles the scene at `path`; `finished` is told of each stage's end.
pub fn compile_observed(
    loader: &dyn Loader,
    path: &str,
    options: &Options,
    finished: &mut dyn FnMut(Stage),
) -> Outcome {
    compile_remembering(loader, path, options, &mut Memory::default(), finished)
}

/// The same, with what earlier compilations found: only what an edit changed is searched again. The outcome does not depend on it.
pub fn compile_remembering(
    loader: &dyn Loader,
    path: &str,
    options: &Options,
    memory: &mut Memory,
    finished: &mut dyn FnMut(Stage),
) -> Outcome {
    // A program may nest deeper than the caller's thread has room for.
    stacker::maybe_grow(STACK / 2, STACK, || {
        // What a search may cost depends on what those before it did, which is less where their numbers are remembered: where that
        // matters all is found anew.
        if memory.fell_short {
            memory.forget();
        }
        let is_new = memory.is_empty();
        let loaded = program::load::load(loader, path);
        finished(Stage::Read);
        let grids = Grids::new(loader);
        let mut made = run(&loaded, &grids, options, memory, finished);
        if !is_new && memory.fell_short {
            memory.forget();
            made = run(&loaded, &grids, options, memory, finished);
        }
        let (mut diagnostics, compiled) = made;
        tidy(&mut diagnostics);
        Outcome { sources: loaded.sources, diagnostics, files: loaded.files, compiled }
    })
}

/// More operations than these in one look, and a picture takes minutes. Of a union of many a look takes an operand or a few.
const COSTLY: usize = 50_000;

/// More shapes than these are entered by one look, and no picture is ever done: each is worth some operations.
const MOST_ENTERED: f64 = 1e8;

/// Room for the deepest nesting that is read, in a build without optimisation.
const STACK: usize = 256 << 20;

/// What the texts come to: diagnostics, and the scene where none is an error.
fn run(loaded: &Loaded, grids: &Grids, options: &Options, memory: &mut Memory, finished: &mut dyn FnMut(Stage)) -> (Vec<Diagnostic>, Option<Compiled>) {
    let mut diagnostics = loaded.diagnostics.clone();
    let mut made = None;
    let has_errors = |diagnostics: &[Diagnostic]| diagnostics.iter().any(|d| d.severity == Severity::Error);
    let facts = Facts::with(std::mem::take(memory), options.rules);
    let mut elaboration = program::elaborate(&loaded.modules, &loaded.sources, grids, options, facts);
    diagnostics.append(&mut elaboration.diagnostics);
    finished(Stage::Elaborate);
    if let (Some(root), false) = (elaboration.root, has_errors(&diagnostics)) {
        let mut graph = elaboration.graph;
        let facts = &mut elaboration.facts;
        facts.account.open(graph.len());
        let root = functions::bind_world(&mut graph, root);
        let entered = graph.entered(root);
        if entered > MOST_ENTERED {
            diagnostics.push(Diagnostic::new(
                Code::TooLarge,
                loaded.modules.head(loaded.modules.main),
                format!("one look at this scene enters {entered:.1e} shapes, and no picture would ever be done"),
                "let what calls itself do so less often, or join fewer copies of copies",
            ));
            return (diagnostics, None);
        }
        let is_free = options.extent.is_none() && !elaboration.blocks.says_extent;
        if let Some(extent) = is_free.then(|| functions::ample_extent(&mut graph, facts, root, &elaboration.blocks)).flatten() {
            // All is proven within the extent, so that with another one it is another scene.
            *memory = elaboration.facts.memory;
            return run(loaded, grids, &Options { extent: Some(extent), ..options.clone() }, memory, finished);
        }
        let (functions, summary, found) =
            functions::build(&mut graph, facts, root, &elaboration.blocks, options.strict, Vec::new());
        diagnostics.extend(found);
        diagnostics.extend(crate::factors::too_many_together(&graph, root, &functions));
        finished(Stage::Analyse);
        if !has_errors(&diagnostics) {
            let (blocks, parameters) = (&elaboration.blocks, &elaboration.parameters);
            match emit::emit(&graph, root, &functions, blocks, parameters, options, &loaded.sources, None) {
                Ok(module) => {
                    if module.operations.1 / functions.operands().max(1) > COSTLY {
                        diagnostics.push(Diagnostic::new(
                            Code::Costly,
                            loaded.modules.head(loaded.modules.main),
                            format!("one look at this scene takes {} operations; a picture may take minutes", module.operations.1),
                            "join many copies by one `for`, or repeat one with `.repeat(…)`: then only what is near is looked at",
                        ));
                    }
                    let mut compiled = Compiled {
                        graph,
                        root,
                        functions,
                        summary,
                        parameters: elaboration.parameters,
                        blocks: elaboration.blocks,
                        module,
                        unused: elaboration.unused,
                        home: None,
                        apart: None,
                    };
                    compiled.home = compiled.blocks.is_framed().then(|| Home::of(&compiled).into());
                    // A module that draws is told where the camera stands, which is known only now.
                    if options.entry == Entry::Draw {
                        let frame = compiled.frame(&compiled.live());
                        let Compiled { graph, functions, blocks, parameters, .. } = &compiled;
                        if let Ok(module) = emit::emit(graph, root, functions, blocks, parameters, options, &loaded.sources, Some(&frame)) {
                            compiled.module = module;
                        }
                    }
                    compiled.apart = ground(&compiled, facts, options, &loaded.sources).map(Box::new);
                    made = Some(compiled);
                }
                Err(error) => {
                    let span = loaded.modules.head(loaded.modules.main);
                    diagnostics.push(Diagnostic::new(
                        Code::TooLarge,
                        span,
                        format!("the scene can't be written as WGSL: {error}"),
                        "use fewer or smaller parts",
                    ));
                }
            }
            finished(Stage::Emit);
        }
    }
    let fell_short = elaboration.facts.account.fell_short();
    *memory = elaboration.facts.memory;
    memory.fell_short = fell_short;
    memory.steps += elaboration.facts.account.ran;
    (diagnostics, made)
}

/// The scene as balls meet it, where that is not as it is seen. Its factors begin with those of the scene, so that live values hold for both.
fn ground(seen: &Compiled, facts: &mut Facts, options: &Options, sources: &Sources) -> Option<Compiled> {
    if !seen.has_balls() {
        return None;
    }
    let mut graph = seen.graph.clone();
    let firm = functions::firm(&mut graph, seen.root);
    let root = firm.unwrap_or(seen.root);
    let carry = functions::carry(&mut graph, root);
    if firm.is_none() && carry.is_none() {
        return None;
    }
    let (mut functions, mut summary) = (seen.functions.clone(), seen.summary);
    if firm.is_some() {
        let searches = std::mem::take(&mut functions.searches);
        // What is wrong with a shape was said when all of them were looked at.
        (functions, summary, _) = functions::build(&mut graph, facts, root, &seen.blocks, false, searches);
    }
    functions.carry = carry;
    let options = Options { exports: vec![Export::Bound, Export::Distance, Export::Gradient], entry: Entry::None, ..options.clone() };
    let (blocks, parameters) = (seen.blocks.clone(), seen.parameters.clone());
    // What can't be written is met as it is seen.
    let module = emit::emit(&graph, root, &functions, &blocks, &parameters, &options, sources, None).ok()?;
    Some(Compiled { graph, root, functions, summary, parameters, blocks, module, unused: Vec::new(), home: None, apart: None })
}
