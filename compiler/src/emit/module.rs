//! An emitted module, as text and as data.

use super::Formulas;
use super::table::ModuleTables;
use super::tracer::Ways;
use crate::graph::NodeId;
use crate::interface::{Export, Options, Rounding, Uniform};
use crate::source::Span;
use std::sync::Arc;

/// An emitted module.
#[derive(Clone, Debug)]
pub struct Module {
    /// The text.
    pub wgsl: String,
    /// Which shape of the source a line of the text computes: the line, counted from 1, and the shape's place.
    /// They are sorted by line.
    /// Shapes of the prelude have no place.
    pub places: Vec<(u32, Span)>,
    /// The functions in it that were asked for or are needed by them.
    pub exports: Vec<Export>,
    /// Name of the uniform block's struct and variable, empty where there is none.
    pub uniform_name: String,
    /// How its text reads the scene's point at which `p` is zero; that is there where anything reads it.
    pub origin: String,
    /// Fields of the uniform block.
    pub uniforms: Vec<Uniform>,
    /// What the host computes for them once a frame.
    pub formulas: Arc<Formulas>,
    /// The same for people and other hosts, as the comment at the module's head has it: a line each, in their order, `of_melt = melt * 0.25`;
    /// then what the operations in them are that not every language has, `in which square(a) is: …`.
    pub computed: Vec<String>,
    /// Size of the uniform block in bytes, a multiple of 16; 0 where there is none.
    pub uniform_size: u32,
    /// Operations of the kernel in one evaluation of the field, and of the bound.
    pub operations: (usize, usize),
    /// What was left out of the module, and why.
    pub skipped: Vec<String>,
    /// What rounding in 32 bits grows with.
    pub rounding: Rounding,
    /// Where large numbers cancel each other, where they make the unit of rounding more than 1 and that is known.
    pub cancels: Option<NodeId>,
    /// More text, for what draws meshes: a function `sf_mesh_a(p: vec3f, normal: vec3f) -> sf_Surface` and so on for each of
    /// [`Functions::meshes`], and `sf_mesh_layers_a` with its struct for one that is layered. `p` is in the mesh's own space.
    pub meshes: String,
    /// Whether the bound is the estimate of the distance itself.
    pub one: bool,
    /// What its tracer is told.
    pub ways: Ways,
    /// Whether it draws the scene by itself.
    pub draws: bool,
    /// Whether it reads what is too large for a text, grids or outlines of many curves: then its text has buffers too.
    pub needs_buffers: bool,
    /// The unions of many operands, which are tables, the grids and the outlines; none in most modules.
    pub tables: Option<Arc<ModuleTables>>,
}

impl Module {
    /// The text for a device of our own: without the comment at its head, which names places in the source, and with tables as buffers
    /// ([`ModuleTables`]).
    pub fn code(&self) -> &str {
        if let Some(tables) = &self.tables {
            return tables.code();
        }
        self.wgsl.get(self.head().len()..).unwrap_or(&self.wgsl)
    }

    /// The comment at its head.
    pub fn head(&self) -> &str {
        let head: usize = self.wgsl.split_inclusive('\n').take_while(|line| line.starts_with("//")).map(str::len).sum();
        self.wgsl.get(..head).unwrap_or("")
    }

    /// The module with its tables as storage buffers, which its comment names, and the bytes of the two; nothing where it has no tables. `options`: those
    /// that it was emitted with.
    pub fn with_buffers(&self, options: &Options) -> Option<(Module, [Vec<u8>; 2])> {
        let tables = self.tables.as_ref()?;
        let mut rows: Vec<u8> = tables.tables.rows.iter().flatten().flat_map(|number| number.to_le_bytes()).collect();
        // No buffer may be empty.
        rows.resize(rows.len().max(16), 0);
        let lists = tables.lists().iter().flat_map(|word| word.to_le_bytes()).collect::<Vec<u8>>();
        let (group, binding) = (options.group, u64::from(options.first_buffer(self.uniforms.len())));
        let wgsl = format!(
            "{}//\n// The tables of its unions and the grids and outlines that it reads are two storage buffers of group {group}, read only, little-endian:\n//\n\
             //   binding {}: array<vec4f>, {} bytes\n//   binding {}: array<u32>, {} bytes\n{}",
            self.head(),
            binding,
            rows.len(),
            binding + 1,
            lists.len(),
            tables.code(),
        );
        Some((Module { wgsl, ..self.clone() }, [rows, lists]))
    }
}
