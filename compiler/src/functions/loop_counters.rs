//! Numbers that loops count through: what differs between cells is mostly which of its neighbours a cell is.

use crate::graph::narrow;

/// Loops within each other, the outermost first, and the columns of numbers that they count.
#[derive(Clone, Debug, PartialEq)]
pub struct Turns {
    /// How many turns each loop takes.
    pub counts: Vec<u32>,
    /// Each column: the loop that it goes by, its number in the first turn, and what a turn adds.
    pub columns: Vec<(usize, f32, f32)>,
}

impl Turns {
    /// Of columns of so many numbers, in the order of the innermost turns. None where they are not counted, or some loop counts none of them.
    pub fn of(columns: &[Vec<f64>], rows: usize) -> Option<Self> {
        // Each column: its number at first, what a turn adds, after how many rows, and how many turns there are until it begins anew.
        let mut found: Vec<(f32, f32, usize, usize)> = Vec::with_capacity(columns.len());
        for column in columns {
            let column: Vec<f32> = column.iter().map(|&number| narrow(number)).collect();
            let (&first, rest) = column.split_first()?;
            let every = 1 + rest.iter().position(|&number| number != first)?;
            let turn = column.get(every)? - first;
            let turns = (1..).take_while(|n| column.get(n * every).is_some_and(|&number| number != first)).count() + 1;
            let counted = |at: usize| first + turn * (at / every % turns) as f32;
            if column.len() != rows || !column.iter().enumerate().all(|(at, &number)| counted(at) == number) {
                return None;
            }
            found.push((first, turn, every, turns));
        }
        let mut loops: Vec<(usize, usize)> = found.iter().map(|&(.., every, turns)| (every, turns)).collect();
        loops.sort_unstable();
        loops.dedup();
        let mut inside = 1;
        for &(every, turns) in &loops {
            if every != inside {
                return None;
            }
            inside = every * turns;
        }
        if inside != rows {
            return None;
        }
        loops.reverse();
        let place = |every: usize| loops.iter().position(|l| l.0 == every);
        let columns = found.iter().map(|&(first, turn, every, _)| Some((place(every)?, first, turn))).collect::<Option<_>>()?;
        Some(Self { counts: loops.iter().map(|l| l.1 as u32).collect(), columns })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_loops_count_is_found_and_nothing_else() {
        let row = |f: fn(usize) -> f64| (0..12).map(f).collect::<Vec<f64>>();
        let (x, y) = (row(|i| (i / 4) as f64 - 1.0), row(|i| 0.5 * (i % 4) as f64));
        let turns = Turns::of(&[y.clone(), x.clone()], 12).unwrap();
        assert_eq!(turns, Turns { counts: vec![3, 4], columns: vec![(1, 0.0, 0.5), (0, -1.0, 1.0)] });
        // One loop counts nothing; a number is another; a row is missing.
        assert_eq!(Turns::of(std::slice::from_ref(&x), 12), None);
        let other: Vec<f64> = y.iter().enumerate().map(|(i, n)| if i == 7 { 3.0 } else { *n }).collect();
        assert_eq!(Turns::of(&[other, x.clone()], 12), None);
        assert_eq!(Turns::of(&[y[..11].to_vec(), x[..11].to_vec()], 11), None);
        assert_eq!(Turns::of(&[], 12), None);
    }
}
