//! `alike FIRST.png SECOND.png [SHARE]`: whether two pictures show the same. At most SHARE of the pixels (0.02 where it is left out) may
//! differ by more than 12 of 255 in a channel, and neither picture may be blank.

use std::process::ExitCode;

fn main() -> ExitCode {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let compared = match arguments.as_slice() {
        [first, second] => compare(first, second, "0.02"),
        [first, second, share] => compare(first, second, share),
        _ => Err("usage: alike FIRST.png SECOND.png [SHARE]".to_owned()),
    };
    match compared {
        Ok(words) => {
            println!("{words}");
            ExitCode::SUCCESS
        }
        Err(words) => {
            eprintln!("alike: {words}");
            ExitCode::FAILURE
        }
    }
}

fn compare(first: &str, second: &str, share: &str) -> Result<String, String> {
    let share: f64 = share.parse().map_err(|_| format!("{share} is no share"))?;
    let read = |path: &str| image::open(path).map(|i| i.to_rgb8()).map_err(|e| format!("{path}: {e}"));
    let (a, b) = (read(first)?, read(second)?);
    if a.dimensions() != b.dimensions() {
        return Err(format!("{first} is {:?}, {second} is {:?}", a.dimensions(), b.dimensions()));
    }
    for (path, picture) in [(first, &a), (second, &b)] {
        // A picture of a scene has more than a gradient's worth of values on a line through its middle.
        let row = picture.rows().nth(picture.height() as usize / 2).ok_or_else(|| format!("{path} is empty"))?;
        let mut colors: Vec<[u8; 3]> = row.map(|p| p.0).collect();
        colors.sort();
        colors.dedup();
        if colors.len() < 8 {
            return Err(format!("{path} is blank"));
        }
    }
    let apart = a.pixels().zip(b.pixels()).filter(|(a, b)| a.0.iter().zip(b.0).any(|(a, b)| a.abs_diff(b) > 12)).count();
    let apart = apart as f64 / f64::from(a.width() * a.height());
    let words = format!("{first} and {second}: {:.2} % of the pixels differ", 100.0 * apart);
    if apart <= share { Ok(words) } else { Err(words) }
}
