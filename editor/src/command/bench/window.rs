//! `surefoot bench --window`: how soon a key is seen, how soon the picture after it, and what a caret costs.

use super::timing::percentile;
use crate::command::console::{Exit, Failure, print};
use crate::window;
use std::time::Duration;

/// The lines of the scene that is made where none is given.
const LINES: usize = 1000;
/// So many of its houses are drawn.
const DRAWN: usize = 6;

/// Opens a window on a scene, types into it, and prints what was measured. Without a path the scene is a town of [`LINES`] lines.
pub fn run(scene: &str) -> Result<Exit, Failure> {
    if !window::has_display() {
        return Err(Failure::usage("there is no display: a window is measured on one (`xvfb-run` gives one that is none)"));
    }
    if !scene.is_empty() {
        crate::files::read(std::path::Path::new(scene)).map_err(|why| Failure::usage(format!("can't read {scene}: {why}")))?;
        return measure(scene, scene);
    }
    let file = std::env::temp_dir().join(format!("surefoot-town-{}.sdf", std::process::id()));
    std::fs::write(&file, town(LINES)).map_err(|why| Failure::usage(format!("can't write {}: {why}", file.display())))?;
    let done = measure("a town", &file.to_string_lossy());
    // One that stays there is only a small file.
    let _ = std::fs::remove_file(&file);
    done
}

fn measure(name: &str, scene: &str) -> Result<Exit, Failure> {
    let measured = window::measure(scene).map_err(|why| Failure::usage(format!("the window can't be measured: {why}")))?;
    print(table(name, &measured).as_bytes())?;
    Ok(Exit::Fine)
}

/// A text of so many lines: houses of a few shapes each. Every line is compiled, and a few houses are drawn: the text is what is measured.
pub fn town(lines: usize) -> String {
    let count = lines.saturating_sub(3) / 5;
    let mut text = String::new();
    for i in 0..count {
        let (x, half) = (2.5 * (i % DRAWN) as f64 - 7.5, 0.5 + 0.05 * (i % 5) as f64);
        text.push_str(&format!(
            "// House {i}\nshape walls_{i} = box(0.6, {half:.2}, 0.7).round(0.03)\nshape roof_{i} = box(0.6, 0.4, 0.4).rotate(x, 45deg).translate(0, {half:.2}, 0)\n\
             shape house_{i} = (walls_{i} | roof_{i}).translate({x:.2}, {half:.2}, 0)\n\n"
        ));
    }
    let houses: Vec<String> = (0..count.min(DRAWN)).map(|i| format!("house_{i}")).collect();
    let rest = "\n".repeat(lines.saturating_sub(5 * count + 2));
    format!("{text}{rest}scene = plane(y) | {}\ncamera {{ eye: (4, 5, 10), target: (0, 0.5, 0), fov: 45deg }}\n", houses.join(" | "))
}

fn table(scene: &str, measured: &window::Measured) -> String {
    let window::Measured { adapter, size: (width, height), lines, typed, meanwhile, blinking, still, .. } = measured;
    let ms = |time: Duration| format!("{:.1} ms", time.as_secs_f64() * 1e3);
    let of = |times: &[Duration]| match times {
        [] => "not known on this system".to_owned(),
        times => format!("{} at the median, {} at p95, {} at worst", ms(percentile(times, 50)), ms(percentile(times, 95)), ms(percentile(times, 100))),
    };
    let rest = |known: &Option<window::Rested>| match known {
        Some(rested) => format!("{} frames and {:.1} % of a core over {:.0} s", rested.frames, 100.0 * rested.share, rested.time.as_secs_f64()),
        None => "not known on this system".to_owned(),
    };
    let keys = |window::Typed { echoes, own, picture: [first, sharp], pictures }: &window::Typed| {
        format!(
            "    a key, to the end of the frame that shows it  {}, of {} keys while {pictures} pictures were drawn\n    \
             the window's thread, for such a frame         {}\n    \
             the last key, to the picture of its text      {} with some pixels, {} with all\n",
            of(echoes),
            echoes.len(),
            of(own),
            ms(*first),
            ms(*sharp),
        )
    };
    let [paused, refined] = typed;
    let [frame, compiler] = meanwhile;
    format!(
        "{scene}, {lines} lines, a picture of {width} × {height} on {adapter}\n  \
         while the picture is not refined\n{}  \
         while it is refined\n{}  \
         while the compiler works, for up to {}: the longest frame of the window's thread is {}\n  \
         a caret at rest, soon after a key: {}\n  \
         a caret at rest, later: {}\n",
        keys(paused),
        keys(refined),
        ms(*compiler),
        ms(*frame),
        rest(blinking),
        rest(still),
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use surefoot_compiler::{MemoryLoader, Options, compile};

    #[test]
    fn what_was_measured_is_printed() {
        let echoes = (1..=100).map(Duration::from_millis).collect();
        let measured = window::Measured {
            adapter: "an adapter".to_owned(),
            size: (640, 480),
            lines: 1000,
            typed: [window::Typed { echoes, pictures: 7, ..window::Typed::default() }, window::Typed::default()],
            blinking: Some(window::Rested { share: 0.0125, time: Duration::from_secs(8), frames: 16 }),
            ..window::Measured::default()
        };
        let text = table("a.sdf", &measured);
        assert!(text.contains("50.0 ms at the median, 95.0 ms at p95, 100.0 ms at worst, of 100 keys while 7 pictures"), "{text}");
        assert!(text.contains("16 frames and 1.2 % of a core over 8 s") && text.contains("not known"), "{text}");
    }

    #[test]
    fn a_town_has_its_lines_and_is_a_scene() {
        let text = town(LINES);
        assert_eq!(text.lines().count(), LINES);
        let outcome = compile(&MemoryLoader::new().with("town.sdf", text), "town.sdf", &Options::default());
        assert!(outcome.compiled.is_some(), "{:?}", outcome.diagnostics.first());
    }
}
