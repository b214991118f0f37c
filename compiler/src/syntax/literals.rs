//! Numbers, colours and strings: from their characters to their values.

use super::ast::AngleUnit;
use crate::unit::Unit;

/// A number as it is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Number {
    /// Without point, exponent and unit.
    Int(i64),
    /// With a point or an exponent.
    Float(f64),
    /// With the unit of an angle.
    Angle(f64, AngleUnit),
    /// With the unit of a length.
    Length(f64, Unit),
}

/// Reads a number; what is wrong and what to write instead where it can't be read. The digits on one side of the point may be left out.
pub fn read_number(text: &str) -> Result<Number, (String, String)> {
    if let Some(before) = text.strip_suffix('.').filter(|before| !before.bytes().all(|c| c.is_ascii_digit())) {
        return Err(("the point of a number stands between its digits".to_string(), format!("write `{before}`")));
    }
    let digits = |from: usize| text.bytes().skip(from).take_while(u8::is_ascii_digit).count();
    let mut length = digits(0);
    let mut whole = true;
    if text.as_bytes().get(length) == Some(&b'.') {
        whole = false;
        length += 1 + digits(length + 1);
    }
    if matches!(text.as_bytes().get(length), Some(b'e' | b'E')) {
        let sign = usize::from(matches!(text.as_bytes().get(length + 1), Some(b'+' | b'-')));
        let exponent = digits(length + 1 + sign);
        if exponent > 0 {
            whole = false;
            length += 1 + sign + exponent;
        }
    }
    let (number, unit) = text.split_at_checked(length).unwrap_or((text, ""));
    let length = Unit::named(unit);
    let unit = match unit {
        _ if length.is_some() => None,
        "" => None,
        "deg" => Some(AngleUnit::Deg),
        "turn" => Some(AngleUnit::Turn),
        "rad" => Some(AngleUnit::Rad),
        _ => {
            let message = format!("`{unit}` is not a unit");
            let help = match unit {
                _ if number == "0" && unit.strip_prefix('x').is_some_and(|d| matches!(d.len(), 3 | 6) && d.bytes().all(|b| b.is_ascii_hexdigit())) => {
                    format!("a colour is written `#{}`", unit.trim_start_matches('x'))
                }
                "degrees" | "degree" | "d" => format!("write `{number}deg`"),
                "turns" => format!("write `{number}turn`"),
                "radians" | "r" => format!("write `{number}rad`"),
                "f" | "F" | "lf" | "u" => {
                    format!("write `{number}`: numbers have no suffix for their type")
                }
                "e" | "E" => "an exponent needs digits: `1e-3`".to_string(),
                _ if unit.starts_with('_') => "write the digits without `_`".to_string(),
                _ if unit.starts_with(['x', 'X']) => {
                    "numbers are written with decimal digits".to_string()
                }
                _ => {
                    format!("units are deg, turn and rad, and {}; a product is written `{number} * {unit}`", Unit::NAMES)
                }
            };
            return Err((message, help));
        }
    };
    if whole && unit.is_none() && length.is_none() {
        return number
            .parse()
            .map(Number::Int)
            .map_err(|_| too_large("whole numbers go up to 9223372036854775807"));
    }
    let value: f64 = number.parse().unwrap_or(f64::INFINITY);
    let turned = if unit == Some(AngleUnit::Turn) { value * std::f64::consts::TAU } else { value };
    if !(turned as f32).is_finite() {
        return Err(too_large("numbers go up to 3.4e38, as those of the GPU do"));
    }
    Ok(match (unit, length) {
        (Some(unit), _) => Number::Angle(value, unit),
        (None, Some(unit)) => Number::Length(value, unit),
        (None, None) => Number::Float(value),
    })
}

fn too_large(help: &str) -> (String, String) {
    ("this number is too large".to_string(), help.to_string())
}

/// Reads `#rrggbb` or `#rgb`.
pub fn read_color(text: &str) -> Option<[u8; 3]> {
    let digits = text.strip_prefix('#')?;
    let mut values = [0u8; 6];
    let mut count = 0;
    for c in digits.chars() {
        *values.get_mut(count)? = c.to_digit(16)? as u8;
        count += 1;
    }
    let [a, b, c, d, e, f] = values;
    match count {
        3 => Some([a * 17, b * 17, c * 17]),
        6 => Some([a * 16 + b, c * 16 + d, e * 16 + f]),
        _ => None,
    }
}

/// Why a string can't be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StringError {
    /// It has no closing quote.
    Open,
    /// An unknown escape: its first byte within the token, and its length.
    Escape(usize, usize),
}

/// Reads a string with its quotes; the answer is its text with the escapes resolved.
pub fn read_string(text: &str) -> Result<String, StringError> {
    let mut out = String::new();
    let mut chars = text.char_indices().skip(1);
    let mut wrong = None;
    while let Some((at, c)) = chars.next() {
        match c {
            '"' => return wrong.map_or(Ok(out), Err),
            '\\' => match chars.next() {
                Some((_, '"')) => out.push('"'),
                Some((_, '\\')) => out.push('\\'),
                Some((_, 'n')) => out.push('\n'),
                Some((_, 't')) => out.push('\t'),
                Some((_, other)) => {
                    wrong = wrong.or(Some(StringError::Escape(at, 1 + other.len_utf8())));
                }
                None => return Err(StringError::Open),
            },
            _ => out.push(c),
        }
    }
    Err(StringError::Open)
}
