//! Values on the command line: `--set spin=1.2`, `--set tint=#d08770`, `--set spot=0,1,0`, `--set angle=45deg`, `--set size=10mm`.

use super::console::{Failure, compile_file, show_diagnostics};
use surefoot_compiler::compiled::{Compiled, Parameter};
use surefoot_compiler::syntax::ast::Type;
use surefoot_compiler::unit::Unit;
use surefoot_compiler::{Live, Options, Outcome};

/// `name=value` as written.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// Name of a parameter: `spin`, `column.flutes`.
    pub name: String,
    /// What it shall be.
    pub value: Value,
    /// What it is called where the parameter chooses from a list.
    pub label: String,
}

/// A value as written; which parameter it fits is known only when the scene is compiled.
#[derive(Clone, Debug, PartialEq)]
pub enum Value {
    /// A number, the components of a vector, radians, or 0 and 1 for `false` and `true`.
    Numbers(Vec<f64>),
    /// Lengths, each with its unit.
    Lengths(Vec<(f64, Unit)>),
    /// sRGB, 0 to 1.
    Color([f64; 3]),
    /// Words: one of the names that a parameter chooses among.
    Word(String),
}

/// Reads `name=value`.
pub fn setting(text: &str) -> Result<Setting, String> {
    let (name, value) = text.split_once('=').ok_or("write NAME=VALUE")?;
    let (name, value) = (name.trim(), value.trim());
    if name.is_empty() || value.is_empty() {
        return Err("write NAME=VALUE".to_owned());
    }
    // `8.0` is the same number as `8`.
    let label = value.parse::<f64>().ok().filter(|n| n.is_finite()).map_or(value.to_owned(), |number| number.to_string());
    Ok(Setting { name: name.to_owned(), value: self::value(value)?, label })
}

fn value(text: &str) -> Result<Value, String> {
    if let Some(digits) = text.strip_prefix('#') {
        return color(digits)
            .map(Value::Color)
            .ok_or_else(|| "a colour is #rgb or #rrggbb".to_owned());
    }
    match text {
        "true" | "on" => return Ok(Value::Numbers(vec![1.0])),
        "false" | "off" => return Ok(Value::Numbers(vec![0.0])),
        _ => {}
    }
    let inner = text.strip_prefix('(').and_then(|t| t.strip_suffix(')')).unwrap_or(text);
    let lengths: Option<Vec<(f64, Unit)>> = inner.split(',').map(|part| length(part.trim())).collect();
    if let Some(lengths) = lengths.filter(|lengths| lengths.len() <= 4) {
        return Ok(Value::Lengths(lengths));
    }
    let numbers: Option<Vec<f64>> = inner.split(',').map(|part| number(part.trim())).collect();
    match numbers {
        Some(numbers) if numbers.len() <= 4 => Ok(Value::Numbers(numbers)),
        // A name, one of an import, or what stands in a text.
        None if text.starts_with(char::is_alphabetic) || text.starts_with('_') => {
            Ok(Value::Word(text.to_owned()))
        }
        _ => Err(format!("`{text}` is no number, vector, colour, angle, length, true, false or name")),
    }
}

/// A number right before the unit of a length.
fn length(text: &str) -> Option<(f64, Unit)> {
    // Of two names that end alike the longer one is meant: `mm` and not `m`.
    let units = Unit::ALL.into_iter().filter_map(|unit| Some((text.strip_suffix(unit.name())?, unit)));
    let (digits, unit) = units.min_by_key(|(digits, _)| digits.len())?;
    digits.ends_with(|c: char| c.is_ascii_digit() || c == '.').then(|| number(digits))?.map(|n| (n, unit))
}

/// A finite number, perhaps with the unit of an angle.
fn number(text: &str) -> Option<f64> {
    let (digits, unit) =
        match (text.strip_suffix("deg"), text.strip_suffix("turn"), text.strip_suffix("rad")) {
            (Some(digits), _, _) => (digits, std::f64::consts::PI / 180.0),
            (_, Some(digits), _) => (digits, std::f64::consts::TAU),
            (_, _, Some(digits)) => (digits, 1.0),
            _ => (text, 1.0),
        };
    // Rust reads `inf` and `nan` too; here they are names.
    if digits.starts_with(|c: char| c.is_alphabetic()) {
        return None;
    }
    digits.trim().parse::<f64>().ok().map(|n| n * unit).filter(|n| n.is_finite())
}

fn color(digits: &str) -> Option<[f64; 3]> {
    // Rust would read a sign.
    let digits = Some(digits).filter(|d| !d.starts_with('+'))?;
    let whole = u32::from_str_radix(digits, 16).ok()?;
    let byte = |shift: u32| f64::from(whole >> shift & 0xff) / 255.0;
    let half = |shift: u32| f64::from(whole >> shift & 0xf) / 15.0;
    match digits.len() {
        6 => Some([byte(16), byte(8), byte(0)]),
        3 => Some([half(8), half(4), half(0)]),
        _ => None,
    }
}

/// A scene on disk, compiled with some settings, and its values at time zero; none where it has errors. Shows what the compilation found.
pub fn read(scene: &str, settings: &[Setting], options: &Options) -> Result<(Outcome, Option<Live>), Failure> {
    let outcome = compile_file(scene, &Options { choose: choices(settings), ..options.clone() })?;
    show_diagnostics(&outcome);
    let Some(compiled) = &outcome.compiled else { return Ok((outcome, None)) };
    let mut live = compiled.live();
    apply(settings, compiled, &mut live).map_err(Failure::usage)?;
    Ok((outcome, Some(live)))
}

/// The settings for `Options::choose`, which is asked only where a parameter chooses from a list.
pub fn choices(settings: &[Setting]) -> Vec<(String, String)> {
    settings.iter().map(|s| (s.name.clone(), s.label.clone())).collect()
}

/// Puts the settings into a scene's live values, or says which of them does not fit.
fn apply(settings: &[Setting], compiled: &Compiled, live: &mut Live) -> Result<(), String> {
    for setting in settings {
        let name = &setting.name;
        let parameter = compiled.parameters.iter().find(|p| p.name == *name).ok_or_else(|| {
            let known: Vec<_> = compiled.parameters.iter().map(|p| p.name.as_str()).collect();
            match known.is_empty() {
                true => format!("--set {name}: the scene has no parameter"),
                false => format!(
                    "--set {name}: the scene has no such parameter; it has {}",
                    known.join(", ")
                ),
            }
        })?;
        let wrong = |why: String| format!("--set {name}: {why}");
        match (&setting.value, parameter.first) {
            (_, None) if parameter.choices.contains(&setting.label) => {}
            (_, None) => {
                return Err(wrong(format!("choose one of {}", parameter.choices.join(", "))));
            }
            (Value::Word(word), Some(_)) => return Err(wrong(format!("`{word}` is no number"))),
            (Value::Numbers(numbers), Some(first)) => {
                write(parameter, first, numbers, live).map_err(wrong)?;
            }
            (Value::Lengths(lengths), Some(first)) => {
                let Some(of_scene) = compiled.blocks.unit else {
                    return Err(wrong("the scene does not say what its unit is: write the number alone, or `render { unit: mm }` in the scene".to_owned()));
                };
                let numbers: Vec<f64> = lengths.iter().map(|(value, unit)| unit.to(of_scene, *value)).collect();
                write(parameter, first, &numbers, live).map_err(wrong)?;
            }
            (Value::Color(srgb), Some(first)) => {
                write(parameter, first, &srgb.map(linear), live).map_err(wrong)?;
            }
        }
    }
    Ok(())
}

/// Writes a parameter's components, checked against its type and range.
fn write(
    parameter: &Parameter,
    first: u32,
    numbers: &[f64],
    live: &mut Live,
) -> Result<(), String> {
    let count = parameter.default.len();
    if numbers.len() != count {
        let of = |n| if n == 1 { "1 number".to_owned() } else { format!("{n} numbers") };
        return Err(format!("it takes {}, not {}", of(count), numbers.len()));
    }
    if matches!(parameter.ty, Type::Int) && numbers.iter().any(|n| n.fract() != 0.0) {
        return Err("it takes a whole number".to_owned());
    }
    for (i, &number) in numbers.iter().enumerate() {
        if let (Some(&min), Some(&max)) = (parameter.min.get(i), parameter.max.get(i))
            && !(min..=max).contains(&number)
        {
            let shown = |n: f64| format!("{}{}", round(n / parameter.unit()), parameter.suffix());
            let degrees = parameter.degrees && (min..=max).contains(&number.to_radians());
            let hint = if degrees { format!("; write {}deg", round(number)) } else { String::new() };
            return Err(format!(
                "{} is outside of {} to {}{hint}",
                shown(number),
                shown(min),
                shown(max)
            ));
        }
        if let Some(component) = live.components.get_mut(first as usize + i) {
            *component = number;
        }
    }
    Ok(())
}

/// A number without the last digits that arithmetic has added to it.
fn round(number: f64) -> String {
    format!("{}", (number * 1e9).round() / 1e9)
}

/// The linear value of an sRGB component (IEC 61966-2-1).
fn linear(srgb: f64) -> f64 {
    if srgb <= 0.04045 { srgb / 12.92 } else { ((srgb + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Value {
        setting(&format!("a={text}")).unwrap().value
    }

    #[test]
    fn reads_what_the_language_writes() {
        assert_eq!(read("1.5"), Value::Numbers(vec![1.5]));
        assert_eq!(read("-2e-1"), Value::Numbers(vec![-0.2]));
        assert_eq!(read("0, 1,0"), Value::Numbers(vec![0.0, 1.0, 0.0]));
        assert_eq!(read("(0,1)"), Value::Numbers(vec![0.0, 1.0]));
        assert_eq!(read("true"), Value::Numbers(vec![1.0]));
        assert_eq!(read("180deg"), Value::Numbers(vec![std::f64::consts::PI]));
        assert_eq!(read("0.5turn"), Value::Numbers(vec![std::f64::consts::PI]));
        assert_eq!(read("10mm"), Value::Lengths(vec![(10.0, Unit::Mm)]));
        assert_eq!(read("(-1.5in, 2m,.5um)"), Value::Lengths(vec![(-1.5, Unit::In), (2.0, Unit::M), (0.5, Unit::Um)]));
        assert_eq!(read("min"), Value::Word("min".to_owned()));
        assert_eq!(read("#f00"), Value::Color([1.0, 0.0, 0.0]));
        assert_eq!(read("ionic"), Value::Word("ionic".to_owned()));
        assert_eq!(read("inf"), Value::Word("inf".to_owned()));
    }

    #[test]
    fn numbers_choose_from_lists_too() {
        let label = |text: &str| setting(&format!("a={text}")).unwrap().label;
        assert_eq!([label("8"), label("8.0"), label("0.50"), label("30deg"), label("ionic"), label("sky.dusk")], ["8", "8", "0.5", "30deg", "ionic", "sky.dusk"]);
    }

    #[test]
    fn refuses_the_rest() {
        for wrong in ["a", "=1", "a=", "a=1,2,3,4,5", "a=#12", "a=1..2", "a=10mm,1", "a=10 mm", "a=10km", "a=1e999mm", "a=#+1234f"] {
            assert!(setting(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn white_stays_white() {
        assert_eq!(linear(0.0), 0.0);
        assert!((linear(1.0) - 1.0).abs() < 1e-12);
    }
}
