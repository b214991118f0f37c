//! Unions of many as tables: copies that differ in numbers alone are rows, and a loop goes through a list of them.

mod form;
mod grid;
pub(super) mod text;

use crate::functions::Functions;
use crate::functions::loop_counters::Turns;
use crate::functions::unions::{FEWEST_ROWS, Join, MOST_CLASSES, Of, Operand, Step, Union};
use crate::graph::interval::Interval;
use crate::graph::kernel::Op;
use crate::graph::{Function, Graph, NodeId};
use crate::kept::Kept;
use crate::figure::Figure;
use crate::outline::Outline;
use form::{Filled, Former};
use rustc_hash::FxHashMap;
use std::collections::BTreeMap;
use std::sync::OnceLock;

pub use form::{Action, Form};
pub use grid::Grid;

/// An entry of a list is its class and, below that, its row; in a list that is read, [`BEGINS`] and [`ENDS`] stand above the class.
pub const CLASS_SHIFT: u32 = 24;
/// Numbers in a union's head, which stands at the beginning of the lists.
pub const HEAD: u32 = 16;
const _: () = assert!(HEAD as usize == crate::kept::HEAD);
/// The class of [`Step::Push`].
pub const PUSH: u32 = 31;
/// Of an entry that sets aside what is there before it joins its operand.
pub const BEGINS: u32 = 1 << 30;
/// Of an entry that joins what was set aside once it has joined its operand.
pub const ENDS: u32 = 1 << 31;
/// The row of what has no number of its own.
const NO_ROW: u32 = 0;

/// What many steps of a union have in common.
#[derive(Clone, Debug)]
pub struct Class {
    /// How they are computed.
    pub filled: Filled,
    /// Where each of the form's numbers stands.
    pub numbers: Vec<Number>,
    /// Whether the step joins what was set aside, not an operand.
    pub pops: bool,
}

/// Where a number of a class stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Number {
    /// It is the same in all rows.
    Same(f64),
    /// In this column of the row.
    Column(u32),
    /// The opposite of what is in this column: a sine that a turn both adds and takes away.
    Opposite(u32),
}

impl Number {
    /// Which column it needs.
    pub fn column(self) -> Option<u32> {
        match self {
            Self::Same(_) => None,
            Self::Column(column) | Self::Opposite(column) => Some(column),
        }
    }
}

/// A union as classes and a list.
#[derive(Clone, Debug)]
pub struct Table {
    /// The classes.
    pub classes: Vec<Class>,
    /// An entry for each of the union's steps.
    pub entries: Vec<u32>,
    /// Whether the forms give the gradient too.
    pub gradient: bool,
    /// How many values are set aside at once.
    pub depth: usize,
    /// The value before anything is joined with it.
    pub start: f64,
    /// What is done where it is no union.
    pub fold: Option<Op>,
    /// How many coordinates a point has: two in a drawing.
    pub dimensions: u8,
    /// How many numbers it is given beside the point. What they may be is not known, so there are no cells then.
    pub variables: usize,
    /// The loops that count its numbers; none where they stand in rows.
    pub turns: Option<Turns>,
    /// That of the [`Union`].
    pub reach: f64,
    /// That of the [`Union`].
    pub influence: f64,
    /// What each step joins; none where that is no operand.
    pub operands: Vec<Option<Operand>>,
    /// Which of all tables it is.
    pub index: u32,
    /// Where the solid lies, if that is known; and the row of [`Tables::rows`] that says so.
    pub region: Option<(Grid, u32)>,
}

/// All tables of a module.
#[derive(Clone, Debug, Default)]
pub struct Tables {
    /// By the function that each one is.
    pub tables: BTreeMap<Of, Table>,
    /// Those of which loops count all numbers, so that they have no row and no list.
    pub counted: BTreeMap<Of, Table>,
    /// The rows of all, four numbers in a piece.
    pub rows: Vec<[f32; 4]>,
    /// The range of each component of the parameters.
    pub parameters: Vec<Interval>,
    /// The grids that formulas read. Their heads stand after those of the tables.
    pub grids: Vec<Kept<crate::sampled::Grid>>,
    /// The outlines that formulas read. Their heads stand after those of the grids.
    pub outlines: Vec<Kept<Outline>>,
    /// The figures that formulas read. Their heads stand after those of the outlines.
    pub figures: Vec<Kept<Figure>>,
}

impl Class {
    /// Finds where the numbers of some rows stand. The answer: for each column a number of the form that stands in it.
    fn find_numbers(&mut self, rows: &[Vec<f64>]) -> Vec<usize> {
        let count = rows.first().map_or(0, Vec::len);
        let column = |i: usize| rows.iter().map(move |row| row.get(i).copied().unwrap_or(0.0));
        let mut columns: Vec<usize> = Vec::new();
        for i in 0..count {
            let first = column(i).next().unwrap_or(0.0);
            let number = if column(i).all(|c| c == first) {
                Number::Same(first)
            } else {
                let at = |f: &dyn Fn(usize) -> bool| columns.iter().position(|&j| f(j)).map(|at| at as u32);
                let known = at(&|j| column(i).eq(column(j))).map(Number::Column);
                known.or_else(|| at(&|j| column(i).eq(column(j).map(|c| -c))).map(Number::Opposite)).unwrap_or_else(|| {
                    columns.push(i);
                    Number::Column(columns.len() as u32 - 1)
                })
            };
            self.numbers.push(number);
        }
        columns
    }
}

impl Table {
    /// The class of the joins of what was set aside, where all of them are one and the same.
    pub fn join(&self) -> Option<u32> {
        let mut joins = self.classes.iter().zip(0..).filter(|(class, _)| class.pops);
        let (class, index) = joins.next()?;
        let same = class.numbers.iter().all(|n| n.column().is_none());
        (joins.next().is_none() && same).then_some(index)
    }

    /// A list as it is read: what begins and ends a group does so in the entries of its first and last operand, as far as that can be.
    pub fn fused(&self, entries: impl Iterator<Item = u32>) -> Vec<u32> {
        let Some(join) = self.join() else { return entries.collect() };
        let mut list: Vec<u32> = Vec::new();
        let (mut begins, mut last) = (0, None);
        for entry in entries {
            let class = entry >> CLASS_SHIFT;
            if class == PUSH {
                list.extend((begins != 0).then_some(entry));
                (begins, last) = (BEGINS, None);
            } else if class != join {
                last = Some(list.len());
                list.push(entry | begins);
                begins = 0;
            } else {
                match last.take().and_then(|last: usize| list.get_mut(last)) {
                    Some(operand) => *operand |= ENDS,
                    None => list.push(entry),
                }
            }
        }
        list
    }
}

impl Tables {
    /// The tables of all unions that are worth one.
    pub fn new(graph: &Graph, functions: &Functions) -> Self {
        let parameters = graph.parameters.iter().map(|p| Interval::new(p.min, p.max)).collect();
        let mut tables = Self { parameters, ..Self::default() };
        (tables.grids, tables.outlines, tables.figures) = read(graph, functions);
        let mut unions: Vec<(&Of, &Union)> = functions.unions.iter().filter(|(_, u)| u.same.is_none()).collect();
        unions.sort_unstable_by_key(|(of, _)| **of);
        for (of, union) in unions {
            let gradients = |of: Of| functions.formulas.contains_key(&(of.0, Function::Gradient(0)));
            let gradient = of.1 == Function::Field && union.functions().all(gradients);
            // Copies whose factors differ are alike with the factors as numbers.
            let variables = graph.shape(of.0).map(|shape| shape.variables.clone()).unwrap_or_default();
            // Where a solid of variables lies is not known.
            if union.fold().is_none() && !variables.is_empty() {
                continue;
            }
            let table = [false, true].into_iter().find_map(|fixed| tables.table(graph, functions, union, gradient, fixed, &variables));
            if let Some(mut table) = table {
                table.dimensions = graph.shape(of.0).map_or(3, |shape| shape.dimensions);
                if table.turns.is_some() {
                    tables.counted.insert(*of, table);
                    continue;
                }
                table.region = tables.region_of(&table);
                table.index = tables.tables.len() as u32;
                tables.tables.insert(*of, table);
            }
        }
        tables
    }

    fn table(&mut self, graph: &Graph, functions: &Functions, union: &Union, gradient: bool, fixed: bool, variables: &[u32]) -> Option<Table> {
        // The class of each step, and the numbers of the rows of each class.
        let mut classes: Vec<(Class, Vec<Vec<f64>>)> = Vec::new();
        let mut known: FxHashMap<(Form, bool), usize> = FxHashMap::default();
        let mut places: Vec<Option<(usize, usize)>> = Vec::with_capacity(union.steps.len());
        let mut operands = Vec::with_capacity(union.steps.len());
        for step in &union.steps {
            let (operand, join) = match *step {
                Step::Push => {
                    places.push(None);
                    operands.push(None);
                    continue;
                }
                Step::Operand(operand, join) => (Some(operand), join),
                Step::Pop(join) => (None, join),
            };
            let Filled { form, numbers, names } = Former::new(graph, functions, fixed).step(operand, join, gradient, variables)?;
            let key = (form, operand.is_none());
            let class = match known.get(&key) {
                Some(&class) => class,
                None => {
                    let filled = Filled { form: key.0.clone(), numbers: Vec::new(), names };
                    let class = Class { filled, numbers: Vec::new(), pops: key.1 };
                    classes.push((class, Vec::new()));
                    known.insert(key, classes.len() - 1);
                    classes.len() - 1
                }
            };
            if classes.len() > MOST_CLASSES {
                return None;
            }
            let (_, rows) = classes.get_mut(class)?;
            places.push(Some((class, rows.len())));
            operands.push(operand);
            rows.push(numbers);
        }
        if classes.len() * FEWEST_ROWS > union.steps.len() {
            return None;
        }
        let columns: Vec<Vec<usize>> = classes.iter_mut().map(|(class, rows)| class.find_numbers(rows)).collect();
        let turns = match (&classes[..], &columns[..]) {
            // Where there are cells their lists are shorter.
            ([(_, rows)], [columns]) if !variables.is_empty() => {
                let column = |&i: &usize| rows.iter().filter_map(|row| row.get(i).copied()).collect();
                Turns::of(&columns.iter().map(column).collect::<Vec<Vec<f64>>>(), rows.len())
            }
            _ => None,
        };
        let all = classes.iter().zip(&columns);
        let firsts: Vec<(u32, u32)> = all.map(|((_, rows), columns)| if turns.is_some() { (NO_ROW, 0) } else { self.add(columns, rows) }).collect();
        let entry = |place: &Option<(usize, usize)>| match place {
            None => Some(PUSH << CLASS_SHIFT),
            Some((class, row)) => {
                let (first, width) = *firsts.get(*class)?;
                let row = if width == 0 { NO_ROW } else { first + width * *row as u32 };
                (row < 1 << CLASS_SHIFT).then_some((*class as u32) << CLASS_SHIFT | row)
            }
        };
        let entries = places.iter().map(entry).collect::<Option<Vec<u32>>>()?;
        let classes = classes.into_iter().map(|(class, _)| class).collect();
        let (start, fold, &Union { reach, influence, depth, .. }) = (union.start(), union.fold(), union);
        Some(Table { classes, entries, gradient, depth, start, fold, dimensions: 3, variables: variables.len(), turns, reach, influence, operands, index: 0, region: None })
    }

    /// Where the solid of a union of solids lies, and the row that says so.
    fn region_of(&mut self, table: &Table) -> Option<(Grid, u32)> {
        let is_solid = table.dimensions == 3 && table.fold.is_none();
        let grid = Grid::around(&table.operands).filter(|grid| is_solid && grid.is_region())?;
        let row = self.rows.len() as u32;
        self.rows.extend(grid.rows());
        Some((grid, row))
    }

    /// Adds the columns of some rows. The answer: the first piece, and the pieces of a row.
    fn add(&mut self, columns: &[usize], rows: &[Vec<f64>]) -> (u32, u32) {
        let first = self.rows.len() as u32;
        let width = columns.len().div_ceil(4);
        for row in rows {
            for piece in 0..width {
                let number = |i: usize| {
                    let at = columns.get(4 * piece + i).and_then(|&at| row.get(at));
                    at.map_or(0.0, |&c| crate::graph::narrow(c))
                };
                self.rows.push([0, 1, 2, 3].map(number));
            }
        }
        (first, width as u32)
    }

    /// The table that computes a function, if there is one.
    pub fn get(&self, of: Of) -> Option<&Table> {
        self.tables.get(&of).or_else(|| self.counted.get(&of))
    }

    /// Whether there is none.
    pub fn is_empty(&self) -> bool {
        self.tables.is_empty() && self.grids.is_empty() && self.outlines.is_empty() && self.figures.is_empty()
    }
}

/// What functions of a scene read by its number.
type Read = (Vec<Kept<crate::sampled::Grid>>, Vec<Kept<Outline>>, Vec<Kept<Figure>>);

/// The grids, the outlines and the figures that the functions of a scene read, in the order in which its text names them.
fn read(graph: &Graph, functions: &Functions) -> Read {
    if graph.grids.is_empty() && graph.outlines.is_empty() && graph.figures.is_empty() {
        return Default::default();
    }
    let surfaces = std::iter::once(&functions.surface).chain(&functions.meshes);
    let looks = surfaces.flat_map(|surface| surface.look().into_iter().chain(surface.layer_nodes()).chain(surface.glass.into_iter().flatten()));
    let roots: Vec<NodeId> = functions.formulas.values().copied().chain(looks).collect();
    let read: Vec<(Op, f64)> = graph.reachable(&roots).into_iter().filter_map(|id| graph.data_of(id)).collect();
    let is_read = |is_of: fn(Op) -> bool, number: f64| read.iter().any(|(op, read)| is_of(*op) && *read == number);
    (
        graph.grids.iter().filter(|kept| is_read(Op::reads_grid, kept.number)).cloned().collect(),
        graph.outlines.iter().filter(|kept| is_read(Op::reads_outline, kept.number)).cloned().collect(),
        graph.figures.iter().filter(|kept| is_read(Op::reads_figure, kept.number)).cloned().collect(),
    )
}

/// The tables of a module, and how a device reads them.
#[derive(Debug)]
pub struct ModuleTables {
    /// What the tables hold.
    pub tables: Tables,
    /// The module with its tables as storage buffers, at the bindings after the uniform block's: an `array<vec4f>` that holds [`Tables::rows`],
    /// and an `array<u32>` that holds [`ModuleTables::lists`].
    pub(crate) code: String,
    pub(crate) lists: OnceLock<Vec<u32>>,
}

impl ModuleTables {
    /// `code`: the module with buffers.
    pub(crate) fn new(tables: Tables, code: String) -> Self {
        Self { tables, code, lists: OnceLock::new() }
    }

    /// The module's text for a device of our own.
    pub(crate) fn code(&self) -> &str {
        &self.code
    }
}

impl Union {
    /// The functions of which it is made.
    fn functions(&self) -> impl Iterator<Item = Of> + '_ {
        let joined = |join: &Join| match join {
            Join::Least | Join::Fold(_) => None,
            Join::Blend { of, .. } => Some(*of),
        };
        let of = move |step: &Step| match step {
            Step::Operand(operand, join) => [Some(operand.of), joined(join)],
            Step::Push => [None, None],
            Step::Pop(join) => [None, joined(join)],
        };
        self.steps.iter().flat_map(of).flatten()
    }
}
