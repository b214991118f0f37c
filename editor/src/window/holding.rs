//! A number of the text that a hand holds: while it does, the scene is compiled with a slider in the number's place, so that a drag compiles
//! nothing. What is proven is proven for the whole range of that slider. A number that can't be one (it is within the range of a parameter,
//! or must be known) is compiled as it is written.

use std::ops::Range;
use surefoot_compiler::compiled::{Compiled, Parameter};
use surefoot_runtime::live::Words;

/// How the slider is called; a number follows.
const NAME: &str = "held_number_";

/// A number as a text writes it.
#[derive(Clone, Debug, PartialEq)]
pub struct Number {
    /// Its bytes, with a sign that is its own.
    pub range: Range<usize>,
    /// The number before its exponent and unit.
    pub value: f64,
    /// How many digits stand behind its point.
    pub decimals: usize,
    /// Exponent and unit.
    pub tail: String,
}

/// A number that a hand holds.
#[derive(Debug)]
pub struct Holding {
    /// The file whose text it stands in.
    pub file: String,
    /// What is compiled in place of that text.
    pub text: String,
    name: String,
    /// The least and the greatest value of the slider, as the text would write it.
    range: [f64; 2],
    /// Where the number is by now, likewise.
    value: f64,
    /// Whether the scene with the slider is there.
    pub is_live: bool,
}

/// Whether a parameter is such a slider: no text that a person sees declares it.
pub fn is_held(parameter: &Parameter) -> bool {
    parameter.name.rsplit('.').next().is_some_and(|name| name.starts_with(NAME))
}

/// Whether the compiler speaks of a text with such a slider.
pub fn is_of_one(words: &Words) -> bool {
    words.sources.iter().any(|(_, file)| file.text.lines().next_back().is_some_and(|line| line.strip_prefix("param ").is_some_and(|name| name.starts_with(NAME))))
}

/// How far a number is let go: a positive one stays positive, for sizes are.
fn reach(value: f64, decimals: usize) -> [f64; 2] {
    let step = 10f64.powi(-(decimals.min(300) as i32));
    match value {
        0.0 => [-5.0 * step, 5.0 * step],
        value if value > 0.0 => [0.25 * value, (2.5 * value).max(value + 5.0 * step)],
        value => [(2.5 * value).min(value - 5.0 * step), 0.25 * value],
    }
}

impl Holding {
    /// Begins with a number of a text. `count` tells it from those before it.
    pub fn begin(file: &str, text: &str, number: &Number, count: u64) -> Option<Self> {
        let name = format!("{NAME}{count}");
        let range = reach(number.value, number.decimals);
        let decimals = number.decimals + 2;
        let [value, least, greatest] = [number.value, range[0], range[1]].map(|value| format!("{value:.decimals$}{}", number.tail));
        let mut held = text.to_owned();
        held.get(number.range.clone())?;
        held.replace_range(number.range.clone(), &name);
        // Behind the text, so that all before it stays at its place.
        held.push_str(&format!("\nparam {name} = {value} in {least}..{greatest}\n"));
        Some(Self { file: file.to_owned(), text: held, name, range, value: number.value, is_live: false })
    }

    /// Whether the compiler speaks of the text with the slider.
    pub fn is_of(&self, words: &Words) -> bool {
        words.sources.iter().any(|(_, file)| file.name == self.file && *file.text == *self.text)
    }

    /// Moves the number; false where it leaves the slider's range.
    pub fn set(&mut self, value: f64) -> bool {
        self.value = value;
        (self.range[0]..=self.range[1]).contains(&value)
    }

    /// The slider's name in a scene, and its value there. None where the scene has no such slider.
    pub fn at(&self, scene: &Compiled) -> Option<(String, f64)> {
        let is_it = |p: &&Parameter| p.name.rsplit('.').next() == Some(self.name.as_str());
        let parameter = scene.parameters.iter().find(is_it).filter(|p| p.first.is_some())?;
        let (least, greatest) = parameter.min.first().zip(parameter.max.first())?;
        let part = (self.value - self.range[0]) / (self.range[1] - self.range[0]);
        Some((parameter.name.clone(), least + part * (greatest - least)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use surefoot_compiler::{MemoryLoader, Options, compile};

    fn number(text: &str, written: &str, value: f64, decimals: usize, tail: &str) -> Number {
        let start = text.find(written).unwrap();
        Number { range: start..start + written.len(), value, decimals, tail: tail.to_owned() }
    }

    fn compiled(holding: &Holding) -> Option<Compiled> {
        compile(&MemoryLoader::new().with(&holding.file, holding.text.as_str()), &holding.file, &Options::default()).compiled
    }

    #[test]
    fn a_number_becomes_a_slider() {
        let text = "scene = box(1).rotate(y, -30deg)\n// the end";
        let mut holding = Holding::begin("a.sdf", text, &number(text, "-30deg", -30.0, 0, "deg"), 1).unwrap();
        assert_eq!(&*holding.text, "scene = box(1).rotate(y, held_number_1)\n// the end\nparam held_number_1 = -30.00deg in -75.00deg..-7.50deg\n");
        let scene = compiled(&holding).unwrap();
        assert!(scene.parameters.iter().all(is_held));
        for value in [-30.0, -40.0, -7.5] {
            assert!(holding.set(value));
            let (name, radians) = holding.at(&scene).unwrap();
            assert_eq!(name, "held_number_1");
            assert!((radians - f64::to_radians(value)).abs() < 1e-6, "{value}: {radians}");
        }
        assert!(!holding.set(-7.4), "it has left its range");
    }

    #[test]
    fn a_reach_holds_the_number_and_some_steps_of_it() {
        for (value, decimals) in [(0.0, 0), (1.0, 0), (-1.0, 0), (0.25, 2), (-300.0, 1), (0.001, 3)] {
            let [least, greatest] = reach(value, decimals);
            assert!(least < value && value < greatest, "{value}");
            assert!(value == 0.0 || least.signum() == greatest.signum(), "{value} keeps its sign");
        }
    }

    #[test]
    fn what_can_be_no_slider_is_refused() {
        let text = "param a = 0.5 in 0..1\nscene = sphere(a)\n";
        let holding = Holding::begin("a.sdf", text, &number(text, "0.5", 0.5, 1, ""), 1).unwrap();
        assert!(compiled(&holding).is_none_or(|scene| holding.at(&scene).is_none()));
    }
}
