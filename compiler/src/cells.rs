//! Which operands of a large union matter where: space is cut into cells, and each has a list of its own.
//!
//! In a cell of radius R about c an operand of Lipschitz constant L has values between f(c) - L R and f(c) + L R. Where it reads parameters or
//! the time, its values are those over the parameters' ranges and at any time. So a list holds wherever a slider stands.
//!
//! The union's steps are followed with these ranges, and what no blend reaches is left out (`Kept`). No value changes by that. A union of
//! smooth unions also leaves out operands that are far larger than the least (`Union::influence`). They change a value by less than 2e-5 of
//! the reach. Lists are found from those of the block around, so most of a thousand operands are looked at in few blocks.
//!
//! Of a fold that is no union a list leaves out what changes nothing: of the least or the greatest of many what surely is neither, and of a sum or a product what is nought or one all over the
//! cell, by intervals.

use crate::kept::Data;
use crate::emit::table::{Action, CLASS_SHIFT, Class, Grid, HEAD, ModuleTables, Number, PUSH, Table, Tables};
use crate::graph::{ANY_TIME, narrow};
use crate::graph::interval::Interval;
use crate::graph::joint::lowest_blend;
use crate::graph::kernel::{self, Op};
use crate::spread::spread;
use rustc_hash::FxHashMap;

/// Lanes of one walk over a form.
const LANES: usize = 16;
/// Cells along each axis of the boxes around it.
const OUTER: usize = 8;
/// Boxes, each twice as wide as the one before.
const LEVELS: usize = 4;
/// The innermost box is looked at in so many slabs, each by itself, on all of the processor's cores.
const SLABS: usize = 8;
/// Places at which a fold is looked at before its cells are: four along each axis.
const PLACES: usize = 64;
/// What 32 bits may lose of a value, for each unit of the coordinates.
const ROUNDING: f64 = 4e-6;

impl ModuleTables {
    /// The same without cells: whole lists count everywhere. What the cells are worth is measured against it.
    pub fn whole(&self) -> Self {
        let lists = self::lists(&self.tables, false);
        Self { tables: self.tables.clone(), code: self.code.clone(), lists: lists.into() }
    }

    /// What the second buffer holds: near a point only what matters there is looked at. Found when it is first asked for, which may take a
    /// tenth of a second.
    pub fn lists(&self) -> &[u32] {
        self.lists.get_or_init(|| self::lists(&self.tables, true))
    }
}

/// What a module's `sf_lists` holds: for each table a head, the whole list, and the lists of its cells; then the grids, the outlines and the figures. `cells`: whether there are
/// cells; without them the whole lists count everywhere.
///
/// The head: first and last entry of the whole list; levels; the first cell of level 0; the center; one over half the innermost box's sides; the
/// cells along its axes; those along an axis of other levels; where the cells' spans begin.
pub fn lists(tables: &Tables, cells: bool) -> Vec<u32> {
    let mut lists = vec![0; HEAD as usize * (tables.tables.len() + tables.grids.len() + tables.outlines.len() + tables.figures.len())];
    let mut ordered: Vec<&Table> = tables.tables.values().collect();
    ordered.sort_unstable_by_key(|t| t.index);
    for table in ordered {
        let first = lists.len() as u32;
        lists.extend(table.fused(table.entries.iter().copied()));
        let mut head = [0u32; HEAD as usize];
        head[0] = first;
        head[1] = lists.len() as u32;
        if let Some(grid) = Grid::around(&table.operands).filter(|grid| cells && table.variables == 0 && is_worth_cells(grid, table, tables)) {
            let spans = spans(&grid, table, tables, &mut lists);
            head[2] = LEVELS as u32;
            let [x, y, z] = grid.center.map(|c| (c as f32).to_bits());
            let [a, b, c] = grid.half.map(|h| (1.0 / h as f32).to_bits());
            let [i, j, k] = grid.counts.map(|n| n as u32);
            let found = [x, y, z, a, b, c, i, j, k, OUTER as u32, lists.len() as u32];
            for (slot, value) in head.iter_mut().skip(4).zip(found) {
                *slot = value;
            }
            lists.extend(spans.iter().flat_map(|s| [s.0, s.1]));
        }
        let at = (HEAD * table.index) as usize;
        if let Some(slot) = lists.get_mut(at..at + HEAD as usize) {
            slot.copy_from_slice(&head);
        }
    }
    tables.grids.iter().zip(tables.tables.len()..).for_each(|(kept, at)| put(&*kept.data, at, &mut lists));
    tables.outlines.iter().zip(tables.tables.len() + tables.grids.len()..).for_each(|(kept, at)| put(&*kept.data, at, &mut lists));
    tables.figures.iter().zip(tables.tables.len() + tables.grids.len() + tables.outlines.len()..).for_each(|(kept, at)| put(&*kept.data, at, &mut lists));
    lists
}

/// Puts data at the end of the lists, and its head where it belongs.
fn put<T: Data>(data: &T, at: usize, lists: &mut Vec<u32>) {
    let (head, words) = data.words(lists.len() as u32);
    lists.extend(words);
    let at = HEAD as usize * at;
    if let Some(slot) = lists.get_mut(at..at + head.len()) {
        slot.copy_from_slice(&head);
    }
}

/// The span of each cell's list: those of the innermost box, x first, then those of the others.
fn spans(grid: &Grid, table: &Table, tables: &Tables, lists: &mut Vec<u32>) -> Vec<(u32, u32)> {
    let all: Vec<u32> = (0..table.entries.len() as u32).collect();
    let levels: Vec<Level> = (0..LEVELS)
        .map(|level| {
            let counts = if level == 0 { grid.counts } else { [OUTER; 3] };
            let scale = f64::from(1u32 << level);
            let half = grid.half.map(|h| h * scale);
            let cell = with(half, counts.map(|n| n as f64), |h, n| 2.0 * h / n);
            let low = with(grid.center, half, |c, h| c - h);
            Level { low, cell, counts, inner: (level > 0).then_some((grid.center, half.map(|h| 0.5 * h))) }
        })
        .collect();
    // The slabs of all levels, each by itself: where it begins along z, and where it ends.
    let slabs: Vec<(&Level, usize, usize)> = levels
        .iter()
        .flat_map(|level| {
            let ([_, _, deep], slabs) = (level.counts, if level.inner.is_none() { SLABS } else { 1 });
            (0..slabs).map(move |i| (level, i * deep / slabs, (i + 1) * deep / slabs)).filter(|(_, first, end)| first < end)
        })
        .collect();
    let parts = spread(slabs.len(), &|| Evaluator::new(table, tables), &|evaluator, i| {
        let Some(&(level, first, end)) = slabs.get(i) else { return Default::default() };
        let [across, up, _] = level.counts;
        let mut spans = vec![(0, 0); across * up * (end - first)];
        let mut finder = Finder { table, evaluator, level, before: across * up * first, lists: Vec::new(), known: FxHashMap::default() };
        finder.block([0, 0, first], [across, up, end - first], &all, &mut spans);
        (finder.lists, spans)
    });
    let mut spans = Vec::new();
    for (own, part) in parts {
        let before = lists.len() as u32;
        spans.extend(part.into_iter().map(|(first, end): (u32, u32)| (before + first, before + end)));
        lists.extend(own);
    }
    spans
}

/// An operation on two vectors, component by component.
fn with([a, b, c]: [f64; 3], [x, y, z]: [f64; 3], f: impl Fn(f64, f64) -> f64) -> [f64; 3] {
    [f(a, x), f(b, y), f(c, z)]
}

/// The coordinates of a box.
fn with_ranges([a, b, c]: [f64; 3], [x, y, z]: [f64; 3]) -> [Interval; 3] {
    [(a, x), (b, y), (c, z)].map(|(middle, half)| Interval::new(middle - half, middle + half))
}

/// A box in cells.
struct Level {
    low: [f64; 3],
    cell: [f64; 3],
    counts: [usize; 3],
    /// Center and half sides of the box that another level answers for.
    inner: Option<([f64; 3], [f64; 3])>,
}

struct Finder<'a, 'e> {
    table: &'a Table,
    evaluator: &'e mut Evaluator<'a>,
    level: &'a Level,
    /// Cells of the level before those that are looked at.
    before: usize,
    lists: Vec<u32>,
    known: FxHashMap<Vec<u32>, (u32, u32)>,
}

impl Finder<'_, '_> {
    /// Finds the lists of a block of cells. `steps`: what matters around it.
    fn block(&mut self, first: [usize; 3], size: [usize; 3], steps: &[u32], spans: &mut [(u32, u32)]) {
        let level = self.level;
        let half = with(level.cell, size.map(|n| n as f64), |c, n| 0.5 * c * n);
        let corner = with(level.cell, first.map(|n| n as f64), |c, n| c * n);
        let center = with(with(level.low, corner, |a, b| a + b), half, |a, b| a + b);
        // A hair of each cell belongs to its neighbours too, as 32 bits see it.
        if let Some((middle, inside)) = level.inner
            && with(with(center, middle, |a, b| (a - b).abs()), half, |a, b| a + b).iter().zip(inside).all(|(far, h)| *far < 0.999 * h)
        {
            return;
        }
        let kept = self.kept(steps, center, half);
        let divisible = (0..3).zip(size).zip(half).filter(|((_, n), _)| *n > 1);
        match divisible.max_by(|(_, a), (_, b)| a.total_cmp(b)) {
            None => {
                let ([x, y, z], [across, up, _]) = (first, level.counts);
                let at = (z * up + y) * across + x - self.before;
                let span = self.list(&kept);
                if let Some(slot) = spans.get_mut(at) {
                    *slot = span;
                }
            }
            Some(((axis, count), _)) => {
                let left = count / 2;
                let with_axis = |mut v: [usize; 3], value: usize| {
                    v.get_mut(axis).into_iter().for_each(|slot| *slot = value);
                    v
                };
                let (a, b) = (with_axis(size, left), with_axis(size, count - left));
                let start = with_axis(first, first.get(axis).map_or(left, |f| f + left));
                self.block(first, a, &kept, spans);
                self.block(start, b, &kept, spans);
            }
        }
    }

    /// The steps that matter in a box.
    fn kept(&mut self, steps: &[u32], center: [f64; 3], half: [f64; 3]) -> Vec<u32> {
        let radius = 1.001 * half.iter().map(|h| h * h).sum::<f64>().sqrt();
        let reach = center.iter().fold(0.0, |m: f64, c| m.max(c.abs())) + radius;
        let slack = ROUNDING * reach;
        match self.table.fold {
            Some(Op::Max) => self.matter_to_greatest(steps, center, radius, slack),
            Some(Op::Add | Op::Mul) => self.evaluator.changing(steps, center, half.map(|h| 1.001 * h + slack)),
            _ => self.matter(steps, center, radius, slack),
        }
    }

    fn list(&mut self, steps: &[u32]) -> (u32, u32) {
        let entries = self.table.fused(steps.iter().filter_map(|&s| self.table.entries.get(s as usize).copied()));
        if let Some(&span) = self.known.get(&entries) {
            return span;
        }
        let first = self.lists.len() as u32;
        self.lists.extend_from_slice(&entries);
        let span = (first, self.lists.len() as u32);
        self.known.insert(entries, span);
        span
    }

    /// The steps that matter in a ball where the greatest of all operands is asked for.
    fn matter_to_greatest(&mut self, steps: &[u32], center: [f64; 3], radius: f64, slack: f64) -> Vec<u32> {
        let values = self.evaluator.values(steps, center);
        let all = || steps.iter().zip(&values).map(|(&step, value)| (step, value, radius * steepness(self.table, step)));
        let least = all().map(|(_, value, change)| value.lo - change).fold(f64::NEG_INFINITY, f64::max) - slack;
        all().filter(|(_, value, change)| value.hi + change >= least || !value.is_finite()).map(|(step, ..)| step).collect()
    }

    /// The steps that matter in a ball.
    fn matter(&mut self, steps: &[u32], center: [f64; 3], radius: f64, slack: f64) -> Vec<u32> {
        let mut ranges = self.evaluator.values(steps, center);
        let mut least = f64::INFINITY;
        for (&step, range) in steps.iter().zip(&mut ranges) {
            let change = radius * steepness(self.table, step);
            *range = if range.is_finite() { Interval::new(range.lo - change, range.hi + change) } else { Interval::ALL };
            least = least.min(range.hi);
        }
        let limit = least + self.table.influence + slack;
        let mut kept = Kept { steps: Vec::new(), groups: vec![Group::default()], reach: self.table.reach + slack };
        for (&step, range) in steps.iter().zip(&ranges) {
            let class = self.table.entries.get(step as usize).map_or(PUSH, |e| e >> CLASS_SHIFT);
            if class == PUSH {
                kept.begin(step);
            } else if self.table.classes.get(class as usize).is_some_and(|c| c.pops) {
                kept.end(step);
            } else if range.lo <= limit {
                kept.operand(step, *range);
            }
        }
        kept.steps
    }
}

/// The steps of a union that matter where the values of operands are known as ranges.
///
/// Where two values differ by more than a blend's reach, the blend is the lesser. So the larger one and its steps are left out.
struct Kept {
    steps: Vec<u32>,
    /// The group that is being joined, and before it those whose values are set aside.
    groups: Vec<Group>,
    /// That of the widest blend.
    reach: f64,
}

/// What is joined between two steps.
#[derive(Clone, Copy, Default)]
struct Group {
    /// Its first kept step.
    first: usize,
    /// The values that it may have; none while nothing is joined.
    range: Option<Interval>,
}

impl Kept {
    /// Joins the group's value with an operand.
    fn operand(&mut self, step: u32, range: Interval) {
        let at = self.steps.len();
        self.steps.push(step);
        self.join(at, at, range);
    }

    /// Begins a group: `step` sets aside the value before it.
    fn begin(&mut self, step: u32) {
        self.steps.push(step);
        self.groups.push(Group { first: self.steps.len(), range: None });
    }

    /// Ends a group: `step` joins its value with what was set aside.
    fn end(&mut self, step: u32) {
        let Some(Group { first, range }) = self.groups.pop() else { return };
        let begins = first.saturating_sub(1);
        match range {
            None => self.steps.truncate(begins),
            Some(range) => {
                self.steps.push(step);
                self.join(begins, first, range);
            }
        }
    }

    /// Joins the group's value with that of the last steps, from `first` on.
    ///
    /// An inner group has a step before them, at `begins`, that sets the group's value aside. Its last step joins both. An operand has neither.
    fn join(&mut self, begins: usize, first: usize, range: Interval) {
        let Some(group) = self.groups.last_mut() else { return };
        let replaces = match group.range {
            None => true,
            Some(known) if range.lo >= known.hi + self.reach => return self.steps.truncate(begins),
            Some(known) => range.hi + self.reach <= known.lo,
        };
        if replaces {
            if first > begins {
                self.steps.pop();
            }
            self.steps.drain(group.first..first);
        }
        let joined = |known: Interval| Interval::new(lowest_blend(known.lo, range.lo, self.reach), known.hi.min(range.hi));
        group.range = Some(group.range.filter(|_| !replaces).map_or(range, joined));
    }
}

/// The Lipschitz constant of a step's operand.
fn steepness(table: &Table, step: u32) -> f64 {
    table.operands.get(step as usize).and_then(|o| *o).map_or(f64::INFINITY, |o| o.steepness)
}

/// Whether lists of its cells are shorter than the whole: some places are looked at, so that no time is lost where they are not, as where each operand of
/// a union may move through all of its box.
fn is_worth_cells(grid: &Grid, table: &Table, tables: &Tables) -> bool {
    let mut evaluator = Evaluator::new(table, tables);
    if evaluator.still.iter().all(|still| *still) && !matches!(table.fold, Some(Op::Add | Op::Mul)) {
        return true;
    }
    let all: Vec<u32> = (0..table.entries.len() as u32).collect();
    let cell = with(grid.half, grid.counts.map(|n| n as f64), |h, n| 2.0 * h / n);
    let level = Level { low: with(grid.center, grid.half, |c, h| c - h), cell, counts: grid.counts, inner: None };
    let mut finder = Finder { table, evaluator: &mut evaluator, level: &level, before: 0, lists: Vec::new(), known: FxHashMap::default() };
    let mut kept = 0;
    for i in 0..PLACES {
        let shares = [i & 3, i >> 2 & 3, i >> 4].map(|n| 0.5 * n as f64 - 0.75);
        let center = with(grid.center, with(grid.half, shares, |h, s| h * s), |a, b| a + b);
        kept += finder.kept(&all, center, cell.map(|side| 0.5 * side)).len();
    }
    3 * kept < 2 * PLACES * all.len()
}

/// The steps of a class's form that its operand needs, in order.
fn needed(class: &Class) -> Vec<u32> {
    let form = &class.filled.form;
    let Some(operand) = form.operand else { return Vec::new() };
    let mut wanted = vec![false; operand as usize + 1];
    if let Some(last) = wanted.last_mut() {
        *last = true;
    }
    for i in (0..wanted.len()).rev() {
        let step = form.steps.get(i).filter(|_| wanted.get(i) == Some(&true));
        if let Some((step, Action::Op(op))) = step.map(|s| (s, s.action)) {
            for &a in step.arguments.iter().take(op.row().arity.into()) {
                if let Some(slot) = wanted.get_mut(a as usize) {
                    *slot = true;
                }
            }
        }
    }
    (0..wanted.len() as u32).filter(|&i| wanted.get(i as usize) == Some(&true)).collect()
}

/// Those of a class's steps that are the same at all places, those that are not, and those of the former that the latter read.
struct Placed {
    same: Vec<u32>,
    moving: Vec<u32>,
    read: Vec<u32>,
}

impl Placed {
    /// Of a class that needs these steps.
    fn of(class: &Class, needed: &[u32]) -> Self {
        let form = &class.filled.form;
        let mut moves = vec![false; form.steps.len()];
        let mut read = vec![false; form.steps.len()];
        for (at, step) in needed.iter().filter_map(|&at| Some((at, form.steps.get(at as usize)?))) {
            let arguments = match step.action {
                Action::Op(op) => step.arguments.get(..op.row().arity.into()).unwrap_or(&step.arguments),
                _ => &[],
            };
            let moved = matches!(step.action, Action::Point(_)) || arguments.iter().any(|&a| moves.get(a as usize) == Some(&true));
            if let (Some(slot), true) = (moves.get_mut(at as usize), moved) {
                *slot = true;
                arguments.iter().for_each(|&a| read.get_mut(a as usize).into_iter().for_each(|slot| *slot = true));
            }
        }
        // What is the same everywhere is read as the result.
        form.operand.and_then(|o| read.get_mut(o as usize)).into_iter().for_each(|slot| *slot = true);
        let (moving, same): (Vec<u32>, Vec<u32>) = needed.iter().partition(|&&at| moves.get(at as usize) == Some(&true));
        let read = same.iter().copied().filter(|&at| read.get(at as usize) == Some(&true)).collect();
        Self { same, moving, read }
    }
}

/// Whether the operands of a class, which need these steps, are the same at all times.
fn is_still(class: &Class, needed: &[u32]) -> bool {
    let live = |a: Action| matches!(a, Action::Time | Action::Parameter(_) | Action::Factor(_));
    let steps = &class.filled.form.steps;
    needed.iter().all(|&at| !steps.get(at as usize).is_some_and(|s| live(s.action)))
}

/// Computes operands at a point, many at once.
struct Evaluator<'a> {
    table: &'a Table,
    tables: &'a Tables,
    /// For each class the steps of its form that its operand needs.
    needed: Vec<Vec<u32>>,
    /// Whether the operands of a class are the same at all times.
    still: Vec<bool>,
    registers: Vec<[f64; LANES]>,
    /// Room: of each class the steps that are looked at, each with its place among all and its row.
    members: Vec<Vec<(usize, u32)>>,
    /// The same for operands that read parameters or the time.
    ranges: Vec<Interval>,
    /// The steps of each class by where they are the same.
    placed: Vec<Placed>,
    /// For a class and a row what its steps say that are read and the same at all places.
    same: FxHashMap<(usize, u32), Vec<Interval>>,
}

impl<'a> Evaluator<'a> {
    fn new(table: &'a Table, tables: &'a Tables) -> Self {
        let needed: Vec<Vec<u32>> = table.classes.iter().map(needed).collect();
        let still = table.classes.iter().zip(&needed).map(|(class, needed)| is_still(class, needed)).collect();
        let longest = table.classes.iter().map(|c| c.filled.form.steps.len()).max().unwrap_or(0);
        let (registers, ranges) = (vec![[0.0; LANES]; longest], vec![Interval::ALL; longest]);
        let members = vec![Vec::new(); table.classes.len()];
        let placed = table.classes.iter().zip(&needed).map(|(class, needed)| Placed::of(class, needed)).collect();
        Self { table, tables, needed, still, registers, members, ranges, placed, same: FxHashMap::default() }
    }

    /// The values of steps at a point; of those without an operand, infinity.
    fn values(&mut self, steps: &[u32], point: [f64; 3]) -> Vec<Interval> {
        let mut values = vec![Interval::point(f64::INFINITY); steps.len()];
        let mut members = std::mem::take(&mut self.members);
        members.iter_mut().for_each(Vec::clear);
        for (at, &step) in steps.iter().enumerate() {
            let entry = self.table.entries.get(step as usize).copied().unwrap_or(u32::MAX);
            if let Some(list) = members.get_mut((entry >> CLASS_SHIFT) as usize) {
                list.push((at, entry & ((1 << CLASS_SHIFT) - 1)));
            }
        }
        let classes = self.table.classes.iter().zip(&members).enumerate();
        for (class, (known, members)) in classes.filter(|(_, (class, _))| !class.pops) {
            if self.still.get(class) != Some(&true) {
                for &(at, row) in members {
                    let range = self.range(class, known, row, point.map(Interval::point));
                    values.get_mut(at).into_iter().for_each(|slot| *slot = range);
                }
                continue;
            }
            for chunk in members.chunks(LANES) {
                let result = self.run(class, known, chunk, point);
                for (&(at, _), value) in chunk.iter().zip(result) {
                    values.get_mut(at).into_iter().for_each(|slot| *slot = Interval::point(value));
                }
            }
        }
        self.members = members;
        values
    }

    /// The steps of a sum or a product whose operand is not what changes nothing all over a box: nought, or one.
    fn changing(&mut self, steps: &[u32], center: [f64; 3], half: [f64; 3]) -> Vec<u32> {
        let table = self.table;
        let place = with_ranges(center, half);
        let changes = |step: &&u32| {
            let Some(&entry) = table.entries.get(**step as usize) else { return true };
            let index = (entry >> CLASS_SHIFT) as usize;
            let Some(class) = table.classes.get(index) else { return true };
            self.range(index, class, entry & ((1 << CLASS_SHIFT) - 1), place) != Interval::point(table.start)
        };
        steps.iter().filter(changes).copied().collect()
    }

    /// All values of a row's operand at the points of a box.
    fn range(&mut self, index: usize, class: &Class, row: u32, place: [Interval; 3]) -> Interval {
        let placed = std::mem::take(&mut self.placed);
        if let Some(Placed { same, moving, read }) = placed.get(index) {
            let mut known = self.same.remove(&(index, row)).unwrap_or_default();
            if known.len() == read.len() {
                for (&at, &range) in read.iter().zip(&known) {
                    self.ranges.get_mut(at as usize).into_iter().for_each(|slot| *slot = range);
                }
            } else {
                same.iter().for_each(|&at| self.step(class, row, place, at));
                known = read.iter().map(|&at| self.ranges.get(at as usize).copied().unwrap_or(Interval::ALL)).collect();
            }
            self.same.insert((index, row), known);
            moving.iter().for_each(|&at| self.step(class, row, place, at));
        }
        self.placed = placed;
        class.filled.form.operand.and_then(|o| self.ranges.get(o as usize)).copied().unwrap_or(Interval::ALL)
    }

    /// All values of a step for a row at the points of a box.
    fn step(&mut self, class: &Class, row: u32, place: [Interval; 3], at: u32) {
        let Some(step) = class.filled.form.steps.get(at as usize) else { return };
        let range = match step.action {
            Action::Number(i) => class.numbers.get(i as usize).map_or(Interval::ALL, |n| Interval::point(self.number(*n, row))),
            Action::Point(i) => place.get(usize::from(i)).copied().unwrap_or(Interval::ZERO),
            Action::Op(op) => {
                let arguments = step.arguments.map(|a| self.ranges.get(a as usize).copied().unwrap_or(Interval::ALL));
                kernel::interval(op, arguments.get(..op.row().arity.into()).unwrap_or(&arguments))
            }
            Action::Time => ANY_TIME,
            Action::Parameter(i) => self.tables.parameters.get(i as usize).copied().unwrap_or(Interval::ALL),
            Action::Variable(_) | Action::Factor(_) | Action::Older(_) | Action::Newer(_) => Interval::ALL,
        };
        if let Some(slot) = self.ranges.get_mut(at as usize) {
            *slot = range;
        }
    }

    /// A number of a row.
    fn number(&self, number: Number, row: u32) -> f64 {
        let column = |c: u32| {
            let piece = self.tables.rows.get(row.wrapping_add(c / 4) as usize);
            piece.and_then(|p| p.get((c % 4) as usize)).copied().map_or(0.0, f64::from)
        };
        match number {
            Number::Column(c) => column(c),
            Number::Opposite(c) => -column(c),
            Number::Same(number) => f64::from(narrow(number)),
        }
    }

    /// The operands of some rows of a class at a point.
    fn run(&mut self, index: usize, class: &Class, rows: &[(usize, u32)], point: [f64; 3]) -> [f64; LANES] {
        let form = &class.filled.form;
        for &at in self.needed.get(index).map_or(&[][..], Vec::as_slice) {
            let (Some(step), Some((before, [out, ..]))) = (form.steps.get(at as usize), self.registers.split_at_mut_checked(at as usize))
            else {
                continue;
            };
            match step.action {
                Action::Number(i) => match class.numbers.get(i as usize) {
                    Some(number @ (Number::Column(c) | Number::Opposite(c))) => {
                        let sign = if matches!(number, Number::Opposite(_)) { -1.0 } else { 1.0 };
                        let (piece, part) = ((c / 4) as usize, (c % 4) as usize);
                        for (out, &(_, row)) in out.iter_mut().zip(rows) {
                            let numbers = self.tables.rows.get(row as usize + piece).unwrap_or(&[0.0; 4]);
                            *out = numbers.get(part).map_or(0.0, |n| sign * f64::from(*n));
                        }
                    }
                    Some(Number::Same(number)) => *out = [f64::from(narrow(*number)); LANES],
                    None => *out = [0.0; LANES],
                },
                Action::Point(i) => *out = [point.get(usize::from(i)).copied().unwrap_or(0.0); LANES],
                Action::Op(op) => lanes(op, out, step.arguments.map(|a| before.get(a as usize).unwrap_or(&[0.0; LANES]))),
                Action::Variable(_) | Action::Time | Action::Parameter(_) | Action::Factor(_) | Action::Older(_) | Action::Newer(_) => *out = [0.0; LANES],
            }
        }
        form.operand.and_then(|o| self.registers.get(o as usize)).copied().unwrap_or([f64::INFINITY; LANES])
    }
}

/// An operation on each lane; those that are frequent as loops that a compiler makes wide.
fn lanes(op: Op, out: &mut [f64; LANES], [a, b, c, d]: [&[f64; LANES]; 4]) {
    let all = out.iter_mut().zip(a.iter().zip(b));
    match op {
        Op::Add => all.for_each(|(out, (a, b))| *out = a + b),
        Op::Sub => all.for_each(|(out, (a, b))| *out = a - b),
        Op::Mul => all.for_each(|(out, (a, b))| *out = a * b),
        Op::Min => all.for_each(|(out, (a, b))| *out = a.min(*b)),
        Op::Max => all.for_each(|(out, (a, b))| *out = a.max(*b)),
        Op::Abs => all.for_each(|(out, (a, _))| *out = a.abs()),
        Op::Neg => all.for_each(|(out, (a, _))| *out = -a),
        Op::Square => all.for_each(|(out, (a, _))| *out = a * a),
        Op::Length3 => all.zip(c).for_each(|((out, (a, b)), c)| *out = (a * a + b * b + c * c).sqrt()),
        _ => all.zip(c.iter().zip(d)).for_each(|((out, (a, b)), (c, d))| {
            let all = [*a, *b, *c, *d];
            *out = kernel::value(op, all.get(..op.row().arity.into()).unwrap_or(&all));
        }),
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::indexing_slicing)]
mod tests {
    use super::{Group, Interval, Kept, lowest_blend};
    use crate::random::Random;
    use crate::{MemoryLoader, Options, compile};

    /// How many levels of cells the first table of a scene has.
    fn levels(scene: &str) -> u32 {
        let loader = MemoryLoader::new().with("main.sdf", scene);
        let scene = compile(&loader, "main.sdf", &Options::default()).compiled.unwrap();
        scene.module.tables.unwrap().lists()[2]
    }

    #[test]
    fn what_may_be_anywhere_has_no_cells() {
        let fragments = |moved: &str| format!("let t = time\nscene = for i in 0..40 {{ box(0.2).rotate(normalize(hash3(i, 5) - 0.5), {moved} * hash(i, 9)).translate(3 * (hash3(i) - 0.5) * {moved}) }}");
        assert!(levels(&fragments("4")) > 0);
        assert_eq!(levels(&fragments("(1 + 3 * smoothstep(0, 3, t))")), 0);
    }

    /// What a step of a made-up union does.
    #[derive(Clone, Copy, Debug, PartialEq)]
    enum Does {
        Operand(Interval),
        Begins,
        Ends,
    }

    /// A tree of so many levels.
    fn tree(depth: u32, random: &mut Random, steps: &mut Vec<Does>) {
        for _ in 0..1 + (4.0 * random.next()) as u32 {
            if depth > 0 && random.next() < 0.5 {
                steps.push(Does::Begins);
                tree(depth - 1, random, steps);
                steps.push(Does::Ends);
            } else {
                let middle = 6.0 * random.next();
                steps.push(Does::Operand(Interval::new(middle - 0.3, middle + 0.3)));
            }
        }
    }

    /// The value of some of the steps, joined by smooth unions of reach 1, or by the deepest blend of that reach.
    ///
    /// `shares` says where each operand lies in its range.
    fn value(steps: &[Does], kept: impl IntoIterator<Item = u32>, shares: &[f64], deep: bool) -> f64 {
        let smooth = |a: f64, b: f64| a.min(b) - 0.25 * (1.0 - (a - b).abs()).max(0.0).powi(2);
        let join = |a: f64, b: f64| if deep { lowest_blend(a, b, 1.0) } else { smooth(a, b) };
        let (mut aside, mut value) = (Vec::new(), f64::INFINITY);
        for step in kept {
            match steps[step as usize] {
                Does::Operand(range) => value = join(value, range.lo + shares[step as usize] * (range.hi - range.lo)),
                Does::Begins => aside.push(std::mem::replace(&mut value, f64::INFINITY)),
                Does::Ends => value = join(aside.pop().unwrap(), value),
            }
        }
        assert!(aside.is_empty());
        value
    }

    #[test]
    fn what_a_blend_does_not_reach_is_left_out_and_no_value_changes() {
        let mut random = Random(7);
        let (mut all, mut left) = (0, 0);
        for _ in 0..3000 {
            let mut steps = Vec::new();
            tree(3, &mut random, &mut steps);
            let mut kept = Kept { steps: Vec::new(), groups: vec![Group::default()], reach: 1.0 };
            for (step, does) in (0..).zip(&steps) {
                match does {
                    Does::Operand(range) => kept.operand(step, *range),
                    Does::Begins => kept.begin(step),
                    Does::Ends => kept.end(step),
                }
            }
            all += steps.len();
            left += kept.steps.len();
            for i in 0..10 {
                let shares: Vec<f64> = steps.iter().map(|_| random.next()).collect();
                let [whole, part] = [value(&steps, 0..steps.len() as u32, &shares, i % 2 == 0), value(&steps, kept.steps.iter().copied(), &shares, i % 2 == 0)];
                assert!(whole == part, "{whole} and {part}: {steps:?}, of which {:?}", kept.steps);
            }
        }
        assert!(2 * left < all, "{left} of {all} are kept");
    }
}
