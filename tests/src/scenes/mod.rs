//! Random scenes that mean something: trees that print to programs, for looking for holes in what the compiler proves.

pub mod check;
mod forms;
pub mod grammar;
pub mod shrink;

use crate::mutations::Random;
use grammar::{Form, Literal, Piece, Sort, forms};

/// A term of a scene: the form in which it is written, and what stands in the holes of that form.
#[derive(Clone, Debug, PartialEq)]
pub struct Term {
    /// What it is.
    pub sort: Sort,
    /// Which of the sort's forms.
    pub form: usize,
    /// One for each hole, in their order.
    pub parts: Vec<Part>,
}

/// What stands in a hole.
#[derive(Clone, Debug, PartialEq)]
pub enum Part {
    /// A term.
    Term(Term),
    /// A number; of which kind the form says.
    Number(f64),
}

/// The scene of a seed.
pub fn scene(seed: u64) -> Term {
    let mut random = Random::new(seed);
    // Most scenes are small: what they find is easier to understand, and there are more of them.
    let depth = 2 + random.below(4).min(random.below(4));
    Maker { random: &mut random }.term(Sort::File, depth + 1)
}

struct Maker<'a> {
    random: &'a mut Random,
}

impl Maker<'_> {
    fn term(&mut self, sort: Sort, depth: usize) -> Term {
        let all = forms(sort);
        let ends = depth == 0 || depth < 3 && self.random.once_in(4);
        let fits = |form: &Form| sort == Sort::File || !ends || form.ends;
        let many = all.iter().filter(|form| fits(form)).count();
        let chosen = self.random.below(many);
        let (index, form) = all.iter().enumerate().filter(|(_, form)| fits(form)).nth(chosen).unwrap();
        let holes = form.pieces.iter().filter_map(|piece| match piece {
            Piece::Text(_) => None,
            Piece::Hole(sort) => Some(Part::Term(self.term(*sort, depth.saturating_sub(1)))),
            Piece::Literal(literal) => Some(Part::Number(self.number(*literal))),
        });
        Term { sort, form: index, parts: holes.collect() }
    }

    fn number(&mut self, literal: Literal) -> f64 {
        let fine = self.random.below(1001) as f64 / 1000.0;
        let hundredths = |low: f64, high: f64| ((low + (high - low) * fine) * 100.0).round() / 100.0;
        let odd = self.random.below(60);
        match literal {
            Literal::Signed if odd < 4 => [0.0, 4.0, -9.0, 0.001][odd],
            Literal::Signed => hundredths(-1.5, 1.5),
            Literal::Positive if odd < 6 => [0.0, 0.002, 4.0, 12.0, -0.3, 0.01][odd],
            Literal::Positive => hundredths(0.1, 1.6),
            Literal::Small if odd < 2 => [0.0, -0.1][odd],
            Literal::Small => hundredths(0.02, 0.4),
            Literal::Whole => 1.0 + self.random.below(5) as f64,
            Literal::Degrees => self.random.below(400) as f64,
        }
    }
}

impl Term {
    /// The program: of a file, without the declarations that nothing uses.
    pub fn text(&self) -> String {
        let mut text = String::new();
        self.print(&mut text);
        if self.sort == Sort::File { without_unused(&text) } else { text }
    }

    fn print(&self, out: &mut String) {
        let mut parts = self.parts.iter();
        for piece in &self.pieces().pieces {
            match piece {
                Piece::Text(text) => out.push_str(text),
                _ => match parts.next() {
                    Some(Part::Term(term)) => term.print(out),
                    // Below zero a number needs brackets after an operator.
                    Some(Part::Number(n)) if *n < 0.0 => out.push_str(&format!("({n})")),
                    Some(Part::Number(n)) => out.push_str(&n.to_string()),
                    None => {}
                },
            }
        }
    }

    fn pieces(&self) -> &'static Form {
        &forms(self.sort)[self.form]
    }

    /// Number of terms in it, itself included.
    pub fn size(&self) -> usize {
        let of = |part: &Part| if let Part::Term(term) = part { term.size() } else { 1 };
        1 + self.parts.iter().map(of).sum::<usize>()
    }
}

/// The lines of a file that declare nothing, or something that the lines which are kept use.
fn without_unused(text: &str) -> String {
    let name = |line: &str| {
        let mut words = line.split(|c: char| !(c.is_alphanumeric() || c == '_')).filter(|w| !w.is_empty());
        let keyword = words.next()?;
        let own = ["scene", "render", "camera", "light", "environment"].contains(&keyword);
        if own { None } else { words.next().map(str::to_owned) }
    };
    let uses = |line: &str, name: &str| line.split(|c: char| !(c.is_alphanumeric() || c == '_')).filter(|w| *w == name).count();
    let lines: Vec<(Option<String>, &str)> = text.lines().filter(|l| !l.is_empty()).map(|l| (name(l), l)).collect();
    let mut kept: Vec<bool> = lines.iter().map(|(name, _)| name.is_none()).collect();
    loop {
        let before = kept.clone();
        for i in 0..lines.len() {
            let used = |name: &String| (0..lines.len()).any(|j| j != i && kept[j] && uses(lines[j].1, name) > 0);
            kept[i] = kept[i] || lines[i].0.as_ref().is_some_and(used);
        }
        if kept == before {
            break;
        }
    }
    let lines = lines.iter().zip(kept).filter(|(_, kept)| *kept).map(|((_, line), _)| format!("{line}\n"));
    lines.collect()
}
