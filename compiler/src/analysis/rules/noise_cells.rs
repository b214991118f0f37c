//! Constants of noise, cell by cell.
//!
//! A claim speaks of every value that a noise may have at the corners of its cells; in the region of a solid there are but a few cells, and
//! in each of them noise is a polynomial. Its derivatives lie between the least and the largest of their coefficients in Bernstein's form
//! (Farouki 2012, "The Bernstein polynomial basis: a centennial retrospective"), which halving a box brings together with the square of its
//! size; and where a norm is largest it does not change in the first order.

// Axes are three, and the coefficients of a polynomial as many as its degrees say, so every index is in range.
#![allow(clippy::indexing_slicing)]

use crate::analysis::tape::{Step, Tape};
use crate::analysis::{Domain, Facts, leaf_range};
use crate::graph::interval::Interval;
use crate::graph::kernel::{self, Op};
use crate::graph::{Claim, Graph, Leaf, NodeId};
use crate::rules::{Rule, RuleSet};
use std::cmp::Ordering;
use std::collections::BinaryHeap;

/// More coefficients than these are too many to be quick.
const MOST_COEFFICIENTS: usize = 1_000;
/// More cells than these are left to the claim.
const MOST_CELLS: usize = 4_096;
/// As near to the steepest place found a constant is as good as that.
const NEAR: f64 = 1.01;
/// What the arithmetic of polynomials may lose, relative.
const ROUNDING: f64 = 1e-9;
/// A number that is known to this, relative, is one.
const NARROW: f64 = 1e-12;
/// The axes of each second derivative.
const PAIRS: [(usize, usize); 6] = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)];
/// Where the second derivative by two axes is kept.
const PLACE: [[usize; 3]; 3] = [[0, 3, 4], [3, 1, 5], [4, 5, 2]];

/// A polynomial over the unit cube: its degree along each axis, and its coefficients, the last axis first.
#[derive(Clone, Debug)]
struct Polynomial {
    degree: [usize; 3],
    of: Vec<f64>,
}

impl Polynomial {
    fn zero(degree: [usize; 3]) -> Option<Self> {
        let size = degree.iter().map(|n| n + 1).product();
        (size <= MOST_COEFFICIENTS).then(|| Self { degree, of: vec![0.0; size] })
    }

    /// Along an axis from a number on, so much in all.
    fn along(axis: usize, from: f64, way: f64) -> Self {
        let degree = [0, 1, 2].map(|i| usize::from(i == axis));
        Self { degree, of: vec![from, way] }
    }

    fn at(&self, [i, j, k]: [usize; 3]) -> usize {
        (i * (self.degree[1] + 1) + j) * (self.degree[2] + 1) + k
    }

    fn places(degree: [usize; 3]) -> impl Iterator<Item = [usize; 3]> {
        let [a, b, c] = degree;
        (0..=a).flat_map(move |i| (0..=b).flat_map(move |j| (0..=c).map(move |k| [i, j, k])))
    }

    fn add(&self, b: &Self, times: f64) -> Option<Self> {
        let mut sum = Self::zero([0, 1, 2].map(|i| self.degree[i].max(b.degree[i])))?;
        for (from, times) in [(self, 1.0), (b, times)] {
            for (place, c) in Self::places(from.degree).zip(&from.of) {
                let at = sum.at(place);
                sum.of[at] += times * c;
            }
        }
        Some(sum)
    }

    fn mul(&self, b: &Self) -> Option<Self> {
        let mut product = Self::zero([0, 1, 2].map(|i| self.degree[i] + b.degree[i]))?;
        for (p, x) in Self::places(self.degree).zip(&self.of).filter(|(_, x)| **x != 0.0) {
            for (q, y) in Self::places(b.degree).zip(&b.of) {
                let at = product.at([0, 1, 2].map(|i| p[i] + q[i]));
                product.of[at] += x * y;
            }
        }
        Some(product)
    }

    fn scaled(mut self, by: f64) -> Self {
        self.of.iter_mut().for_each(|c| *c *= by);
        self
    }

    fn plus(mut self, number: f64) -> Self {
        self.of[0] += number;
        self
    }

    fn value(&self, t: [f64; 3]) -> f64 {
        let power = |i: usize, n: usize| t[i].powi(n as i32);
        Self::places(self.degree).zip(&self.of).map(|([i, j, k], c)| c * power(0, i) * power(1, j) * power(2, k)).sum()
    }

    /// Runs along an axis: where each begins, and how far its coefficients lie from each other.
    fn lines(&self, axis: usize) -> (Vec<usize>, usize) {
        let stride = (axis + 1..3).map(|i| self.degree[i] + 1).product();
        let mut across = self.degree;
        across[axis] = 0;
        (Self::places(across).map(|place| self.at(place)).collect(), stride)
    }

    /// The coefficients in Bernstein's form.
    fn in_bernstein_form(mut self) -> Self {
        for axis in 0..3 {
            let n = self.degree[axis];
            let (lines, stride) = self.lines(axis);
            for from in lines {
                let power: Vec<f64> = (0..=n).map(|i| self.of[from + i * stride]).collect();
                for j in 0..=n {
                    self.of[from + j * stride] = (0..=j).map(|i| choose(j, i) / choose(n, i) * power[i]).sum();
                }
            }
        }
        self
    }

    /// Of a Bernstein form: that of a part of an axis (de Casteljau).
    fn part(mut self, axis: usize, from: f64, to: f64) -> Self {
        let n = self.degree[axis];
        let stride: usize = (axis + 1..3).map(|i| self.degree[i] + 1).product();
        for lines in self.of.chunks_exact_mut((n + 1) * stride) {
            // What is left of its upper end, then of the lower one of that.
            for round in 1..=n {
                for at in (round * stride..(n + 1) * stride).rev() {
                    lines[at] = (1.0 - to) * lines[at - stride] + to * lines[at];
                }
            }
            for round in 1..=n {
                for at in 0..(n + 1 - round) * stride {
                    lines[at] += from / to * (lines[at + stride] - lines[at]);
                }
            }
        }
        self
    }

    /// Of a Bernstein form: that of its derivative along an axis of a box of this width.
    fn derivative(&self, axis: usize, width: f64) -> Option<Self> {
        let n = self.degree[axis];
        let mut degree = self.degree;
        degree[axis] = n.checked_sub(1)?;
        let stride: usize = (axis + 1..3).map(|i| self.degree[i] + 1).product();
        let times = n as f64 / width;
        let mut of = Vec::with_capacity(self.of.len());
        for lines in self.of.chunks_exact((n + 1) * stride) {
            of.extend(lines.iter().zip(&lines[stride..]).map(|(a, b)| times * (b - a)));
        }
        Some(Self { degree, of })
    }

    /// Of a Bernstein form: between the least and the largest coefficient it lies everywhere.
    fn range(&self) -> Interval {
        let wider = |(lo, hi): (f64, f64), c: &f64| (if *c < lo { *c } else { lo }, if *c > hi { *c } else { hi });
        let ends = self.of.iter().fold((f64::INFINITY, f64::NEG_INFINITY), wider);
        Interval::new(ends.0, ends.1)
    }

    /// Of a Bernstein form: its value in the middle.
    fn middle(&self) -> f64 {
        let weights = self.degree.map(|n| (0..=n).map(|i| choose(n, i) / 2f64.powi(n as i32)).collect::<Vec<f64>>());
        let [x, y, z] = &weights;
        let line = |of: &[f64]| of.iter().zip(z).map(|(c, w)| c * w).sum::<f64>();
        let sheet = |of: &[f64]| of.chunks_exact(z.len()).zip(y).map(|(of, w)| line(of) * w).sum::<f64>();
        self.of.chunks_exact(z.len() * y.len()).zip(x).map(|(of, w)| sheet(of) * w).sum()
    }
}

fn choose(n: usize, k: usize) -> f64 {
    (0..k).fold(1.0, |all, i| all * (n - i) as f64 / (i + 1) as f64)
}

/// What a step is within a cell.
#[derive(Clone, Debug)]
enum Value {
    Number(f64),
    Of(Polynomial),
    /// Nothing that is followed.
    Other,
}

/// Walls between cells, all of one step: where so much of an axis, and a number more, is whole.
struct Wall {
    step: usize,
    axis: usize,
    from: f64,
    way: f64,
}

/// Where steps are looked at: from a corner so far along each axis.
struct Place {
    corner: [f64; 3],
    width: [f64; 3],
}

/// The steps of a tape over a box: one within a cell, if the walls are known, else one in which they are found.
fn run(tape: &Tape, leaf: &dyn Fn(Leaf) -> Interval, place: &Place, known: Option<&[Wall]>, found: &mut Vec<Wall>) -> Vec<Value> {
    let mut values: Vec<Value> = Vec::with_capacity(tape.steps.len());
    for (i, step) in tape.steps.iter().enumerate() {
        let value = match step {
            Step::Constant(value) => Value::Number(*value),
            Step::Leaf(Leaf::P(i)) => {
                let i = usize::from(*i);
                Value::Of(Polynomial::along(i, place.corner[i], place.width[i]))
            }
            Step::Leaf(other) => {
                let range = leaf(*other);
                let middle = range.middle();
                if range.width() <= NARROW * (1.0 + middle.abs()) { Value::Number(middle) } else { Value::Other }
            }
            Step::Claim(_, args) => values[args[0]].clone(),
            Step::Op(op, args) => {
                let args: Vec<&Value> = args.iter().map(|a| &values[*a]).collect();
                let value = match (op, args.as_slice(), known) {
                    // Only of what has its walls a box is within one cell.
                    (Op::Floor, [Value::Of(a)], Some(walls)) => {
                        walls.iter().any(|w| w.step == i).then(|| Value::Number(a.value([0.5; 3]).floor()))
                    }
                    (Op::Floor, [Value::Of(a)], None) => {
                        let axis = (0..3).find(|&axis| a.degree == [0, 1, 2].map(|k| usize::from(k == axis)));
                        found.extend(axis.map(|axis| Wall { step: i, axis, from: a.of[0], way: a.of[1] }));
                        None
                    }
                    (op, args, _) => operation(*op, args),
                };
                value.unwrap_or(Value::Other)
            }
            Step::Call(..) => Value::Other,
        };
        values.push(value);
    }
    values
}

fn operation(op: Op, args: &[&Value]) -> Option<Value> {
    let numbers: Option<Vec<f64>> = args.iter().map(|a| if let Value::Number(n) = a { Some(*n) } else { None }).collect();
    if let Some(numbers) = numbers {
        return Some(Value::Number(kernel::value(op, &numbers)));
    }
    let of = |polynomial| Some(Value::Of(polynomial));
    match (op, args) {
        (Op::Neg, [Value::Of(a)]) => of(a.clone().scaled(-1.0)),
        (Op::Square, [Value::Of(a)]) => of(a.mul(a)?),
        (Op::Add, [Value::Of(a), Value::Of(b)]) => of(a.add(b, 1.0)?),
        (Op::Add, [Value::Of(a), Value::Number(n)] | [Value::Number(n), Value::Of(a)]) => of(a.clone().plus(*n)),
        (Op::Sub, [Value::Of(a), Value::Of(b)]) => of(a.add(b, -1.0)?),
        (Op::Sub, [Value::Of(a), Value::Number(n)]) => of(a.clone().plus(-n)),
        (Op::Sub, [Value::Number(n), Value::Of(a)]) => of(a.clone().scaled(-1.0).plus(*n)),
        (Op::Mul, [Value::Of(a), Value::Of(b)]) => of(a.mul(b)?),
        (Op::Mul, [Value::Of(a), Value::Number(n)] | [Value::Number(n), Value::Of(a)]) => of(a.clone().scaled(*n)),
        (Op::Div, [Value::Of(a), Value::Number(n)]) if *n != 0.0 => of(a.clone().scaled(1.0 / n)),
        (Op::Select, [Value::Number(c), a, b]) => Some(if *c == 0.0 { (*b).clone() } else { (*a).clone() }),
        _ => None,
    }
}

/// Whether nodes are known by claims over the cells of noise.
pub fn has_cells(graph: &Graph, nodes: &[NodeId]) -> bool {
    let tape = Tape::new(graph, nodes, RuleSet::default());
    let any = |what: fn(&Step) -> bool| tape.steps.iter().any(what);
    any(|s| matches!(s, Step::Claim(Claim::Lipschitz(..), _))) && any(|s| matches!(s, Step::Op(Op::Floor, _)))
}

/// A cell: the rows of a map, or a value, in Bernstein's form, and how wide it is.
struct Cell {
    rows: Vec<Polynomial>,
    width: [f64; 3],
}

/// Part of a cell that waits to be halved; the one with the largest norm comes first.
struct Part {
    most: f64,
    /// The axis along which the norm changes most.
    axis: usize,
    cell: usize,
    /// From where to where of the cell along each axis.
    sides: [(f64, f64); 3],
    /// So that the order of equals depends on nothing else.
    number: usize,
}

impl Facts {
    /// A constant, at most `most`, of what is known by claims over the cells of noise: looked for cell by cell, with so many boxes. None where it
    /// has none, or too many, or is no polynomial in each.
    pub(in crate::analysis) fn by_cells(&mut self, graph: &Graph, nodes: &[NodeId], domain: &Domain, most: f64, boxes: usize) -> Option<f64> {
        if !self.rules.has(Rule::NoiseCells) || !domain.point.is_finite() || nodes.len() > 3 || !has_cells(graph, nodes) {
            return None;
        }
        let tape = Tape::new(graph, nodes, self.rules);
        let pinned = self.pinned.clone();
        let leaf = |leaf| leaf_range(graph, &pinned, leaf, domain);
        let whole = Place { corner: domain.point.0.map(|s| s.lo), width: domain.point.0.map(|s| s.hi - s.lo) };
        let mut walls = Vec::new();
        run(&tape, &leaf, &whole, None, &mut walls);
        let mut cuts = [0, 1, 2].map(|_| vec![0.0, 1.0]);
        for &Wall { axis, from, way, .. } in &walls {
            let (first, last) = (from.min(from + way).ceil(), from.max(from + way).floor());
            if last - first > MOST_CELLS as f64 {
                return None;
            }
            let inside = (0..=(last - first).max(0.0) as usize).map(|n| (first + n as f64 - from) / way);
            cuts[axis].extend(inside.filter(|t| *t > NARROW && *t < 1.0 - NARROW));
        }
        for cuts in &mut cuts {
            cuts.sort_by(f64::total_cmp);
            cuts.dedup_by(|a, b| *a - *b <= NARROW);
        }
        let cells: usize = cuts.iter().map(|c| c.len() - 1).product();
        if cells > MOST_CELLS.min(boxes) {
            return None;
        }
        let mut search = Search { cells: Vec::with_capacity(cells), open: BinaryHeap::new(), least: 1.0, left_out: 0.0, boxes: 0 };
        for [i, j, k] in Polynomial::places(cuts.each_ref().map(|c| c.len() - 2)) {
            let ends = [(0, i), (1, j), (2, k)].map(|(axis, n)| (cuts[axis][n], cuts[axis][n + 1]));
            let corner = [0, 1, 2].map(|a| whole.corner[a] + ends[a].0 * whole.width[a]);
            let width = [0, 1, 2].map(|a| (ends[a].1 - ends[a].0) * whole.width[a]);
            let values = run(&tape, &leaf, &Place { corner, width }, Some(&walls), &mut Vec::new());
            let rows: Option<Vec<Polynomial>> = tape
                .roots()
                .map(|r| match &values[r] {
                    Value::Of(polynomial) => Some(polynomial.clone().in_bernstein_form()),
                    Value::Number(n) => Some(Polynomial { degree: [0; 3], of: vec![*n] }),
                    Value::Other => None,
                })
                .collect();
            search.cells.push(Cell { rows: rows?, width });
            search.look(search.cells.len() - 1, [(0.0, 1.0); 3], most);
        }
        let found = search.run(boxes);
        self.account.boxes += search.boxes as u64;
        Some(found.min(most))
    }
}

struct Search {
    cells: Vec<Cell>,
    open: BinaryHeap<Part>,
    /// The steepest place found.
    least: f64,
    /// What was left out as near enough is at most this.
    left_out: f64,
    boxes: usize,
}

impl Search {
    fn look(&mut self, cell: usize, sides: [(f64, f64); 3], before: f64) {
        self.boxes += 1;
        let Cell { rows, width } = &self.cells[cell];
        let part = |row: &Polynomial| (0..3).fold(row.clone(), |row, i| if sides[i] == (0.0, 1.0) { row } else { row.part(i, sides[i].0, sides[i].1) });
        let rows: Vec<Polynomial> = rows.iter().map(part).collect();
        let norm = norm(&rows, &[0, 1, 2].map(|i| width[i] * (sides[i].1 - sides[i].0)));
        self.least = self.least.max(norm.middle);
        let most = norm.most.min(before);
        if most <= NEAR * self.least {
            self.left_out = self.left_out.max(most);
        } else {
            self.open.push(Part { most, axis: norm.axis, cell, sides, number: self.boxes });
        }
    }

    fn run(&mut self, boxes: usize) -> f64 {
        while let Some(worst) = self.open.pop() {
            if worst.most <= NEAR * self.least || self.boxes >= boxes {
                return worst.most.max(self.left_out);
            }
            let (from, to) = worst.sides[worst.axis];
            let middle = 0.5 * (from + to);
            for half in [(from, middle), (middle, to)] {
                let mut sides = worst.sides;
                sides[worst.axis] = half;
                self.look(worst.cell, sides, worst.most);
            }
        }
        self.left_out
    }
}

/// What a box tells of the norm of a gradient, or of a map's Jacobian.
struct Norm {
    most: f64,
    middle: f64,
    axis: usize,
}

/// A row of a Jacobian: in the middle of a box, and with its derivatives over all of it.
#[derive(Clone, Copy)]
struct Row {
    middle: [f64; 3],
    first: [Interval; 3],
    second: [Interval; 6],
}

impl Row {
    fn of(polynomial: &Polynomial, width: &[f64; 3]) -> Self {
        let slopes = [0, 1, 2].map(|axis| polynomial.derivative(axis, width[axis]));
        let range = |p: &Option<Polynomial>| p.as_ref().map_or(Interval::ZERO, Polynomial::range);
        let second = PAIRS.map(|(i, j)| range(&slopes[i].as_ref().and_then(|slope| slope.derivative(j, width[j]))));
        let middle = slopes.each_ref().map(|slope| slope.as_ref().map_or(0.0, Polynomial::middle));
        Self { middle, first: slopes.each_ref().map(range), second }
    }

    /// A sum of rows, each so many times.
    fn sum(rows: &[Self], times: &[f64; 3]) -> Self {
        let mut sum = Self { middle: [0.0; 3], first: [Interval::ZERO; 3], second: [Interval::ZERO; 6] };
        for (row, times) in rows.iter().zip(times) {
            let by = Interval::point(*times);
            (0..3).for_each(|i| sum.middle[i] += times * row.middle[i]);
            (0..3).for_each(|i| sum.first[i] = sum.first[i].add(row.first[i].mul(by)));
            (0..6).for_each(|i| sum.second[i] = sum.second[i].add(row.second[i].mul(by)));
        }
        sum
    }
}

/// The largest singular value over a box, from that in the middle and from how the products of the rows change.
fn norm(polynomials: &[Polynomial], width: &[f64; 3]) -> Norm {
    let rows: Vec<Row> = polynomials.iter().map(|p| Row::of(p, width)).collect();
    let n = rows.len();
    let dot = |x: &[f64; 3], y: &[f64; 3]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f64>();
    // The rows are turned until their products in the middle are diagonal: a turn changes no singular value.
    let mut products = [[0.0; 3]; 3];
    for (i, j) in (0..n).flat_map(|i| (0..n).map(move |j| (i, j))) {
        products[i][j] = dot(&rows[i].middle, &rows[j].middle);
    }
    let turned = diagonal(products).map(|times| Row::sum(&rows, &times));
    let mut p = [[Interval::ZERO; 3]; 3];
    let mut widest = (0, -1.0);
    for (i, j) in (0..3).flat_map(|i| (0..=i).map(move |j| (i, j))) {
        let (a, b) = (&turned[i], &turned[j]);
        let mut way = 0.0;
        for k in 0..3 {
            let slope = (0..3).fold(Interval::ZERO, |sum, l| {
                let place = PLACE[k][l];
                sum.add(a.second[place].mul(b.first[l])).add(a.first[l].mul(b.second[place]))
            });
            let change = slope.magnitude() * width[k] / 2.0;
            way += change;
            if (i, j) == (0, 0) && change > widest.1 {
                widest = (k, change);
            }
        }
        let middle = dot(&a.middle, &b.middle);
        let near = Interval::new(middle - way, middle + way);
        let whole = (0..3).fold(Interval::ZERO, |sum, l| sum.add(a.first[l].mul(b.first[l])));
        let both = whole.intersect(near);
        p[i][j] = if both.is_empty() { near } else { both };
        p[j][i] = p[i][j];
    }
    // Gershgorin's circles, the first row weighed so that no other reaches farther.
    let ends = [p[1][1].hi + p[1][2].magnitude(), p[2][2].hi + p[1][2].magnitude()];
    let off = [p[0][1].magnitude(), p[0][2].magnitude()];
    let mut share: f64 = 1e-9;
    for (end, off) in ends.iter().zip(off) {
        let room = p[0][0].hi - end;
        share = share.max(if room > off { off / room } else { 1.0 });
    }
    let first = p[0][0].hi + (off[0] + off[1]) * share;
    let others = ends.iter().zip(off).map(|(end, off)| end + off / share);
    let most = others.fold(first, f64::max).max(0.0).sqrt() * (1.0 + ROUNDING);
    Norm { most, middle: dot(&turned[0].middle, &turned[0].middle).sqrt(), axis: widest.0 }
}

/// The rows of an orthonormal basis in which a symmetric matrix is nearly diagonal, its largest entry first: Jacobi's method, which turns
/// in one plane after another until no product is left.
fn diagonal(mut a: [[f64; 3]; 3]) -> [[f64; 3]; 3] {
    let mut basis = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];
    for (i, j) in [(0, 1), (0, 2), (1, 2)].into_iter().cycle().take(15) {
        let (sin, cos) = (0.5 * (2.0 * a[i][j]).atan2(a[i][i] - a[j][j])).sin_cos();
        let turn = |x: f64, y: f64| (cos * x + sin * y, cos * y - sin * x);
        for k in 0..3 {
            (a[i][k], a[j][k]) = turn(a[i][k], a[j][k]);
            (basis[i][k], basis[j][k]) = turn(basis[i][k], basis[j][k]);
        }
        for row in &mut a {
            (row[i], row[j]) = turn(row[i], row[j]);
        }
    }
    let mut order = [0, 1, 2];
    order.sort_by(|&x: &usize, &y: &usize| a[y][y].total_cmp(&a[x][x]));
    order.map(|i| basis[i])
}

impl PartialEq for Part {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other).is_eq()
    }
}

impl Eq for Part {}

impl PartialOrd for Part {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

impl Ord for Part {
    fn cmp(&self, other: &Self) -> Ordering {
        self.most.total_cmp(&other.most).then(self.number.cmp(&other.number))
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    /// 3 x² y - 2 y z + x - 1 over the unit cube.
    fn cubic() -> Polynomial {
        let [x, y, z] = [0, 1, 2].map(|axis| Polynomial::along(axis, 0.0, 1.0));
        let first = x.mul(&x).unwrap().mul(&y).unwrap().scaled(3.0);
        first.add(&y.mul(&z).unwrap(), -2.0).unwrap().add(&x, 1.0).unwrap().plus(-1.0)
    }

    fn exact([x, y, z]: [f64; 3]) -> f64 {
        3.0 * x * x * y - 2.0 * y * z + x - 1.0
    }

    #[test]
    fn a_polynomial_is_the_same_in_every_form() {
        let power = cubic();
        assert!((power.value([0.3, 0.7, 0.9]) - exact([0.3, 0.7, 0.9])).abs() < 1e-15);
        let form = power.in_bernstein_form();
        assert!((form.middle() - exact([0.5; 3])).abs() < 1e-15);
        for axis in 0..3 {
            let at = |t: f64| [0, 1, 2].map(|i| if i == axis { t } else { 0.5 });
            for (from, to) in [(0.0, 0.5), (0.5, 1.0), (0.25, 0.375)] {
                let part = form.clone().part(axis, from, to);
                assert!((part.middle() - exact(at(0.5 * (from + to)))).abs() < 1e-15);
                assert_eq!(part.degree, form.degree);
            }
        }
        // By x: 6 x y + 1, in a box twice as wide half of that; by y and z: -2.
        assert!((form.derivative(0, 2.0).unwrap().middle() - 0.5 * (6.0 * 0.25 + 1.0)).abs() < 1e-15);
        let mixed = form.derivative(1, 1.0).unwrap().derivative(2, 1.0).unwrap().range();
        assert!((mixed.lo + 2.0).abs() < 1e-14 && (mixed.hi + 2.0).abs() < 1e-14);
        assert!(form.derivative(2, 1.0).unwrap().derivative(2, 1.0).is_none());
    }

    #[test]
    fn a_range_holds_all_values_and_its_corners_are_values() {
        let range = cubic().in_bernstein_form().range();
        let values = Polynomial::places([4; 3]).map(|p| exact(p.map(|i| i as f64 / 4.0)));
        let (lo, hi) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), v| (lo.min(v), hi.max(v)));
        assert!(range.lo <= lo && range.hi >= hi && range.hi < hi + 1e-12 && range.lo > lo - 1.0, "{range:?} {lo} {hi}");
    }

    #[test]
    fn the_norm_of_a_linear_map_is_its_largest_singular_value() {
        // A turn about z after a stretch of y by 3.
        let [x, y, z] = [0, 1, 2].map(|axis| Polynomial::along(axis, 0.0, 1.0));
        let rows = [x.clone().scaled(0.6).add(&y, -0.8 * 3.0).unwrap(), x.scaled(0.8).add(&y, 0.6 * 3.0).unwrap(), z.scaled(2.0)];
        let rows = rows.map(Polynomial::in_bernstein_form);
        let found = norm(&rows, &[1.0; 3]);
        assert!((found.most - 3.0).abs() < 1e-7 && (found.middle - 3.0).abs() < 1e-12, "{} {}", found.most, found.middle);
    }
}
