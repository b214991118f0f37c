//! `surefoot bench --window`: how soon a key is seen, and what a caret costs.

use super::timing::percentile;
use crate::command::console::{Exit, Failure, print};
use crate::window;
use std::time::Duration;

/// Opens a window on a scene, types into it, and prints what was measured.
pub fn run(scene: &str) -> Result<Exit, Failure> {
    crate::files::read(std::path::Path::new(scene)).map_err(|why| Failure::usage(format!("can't read {scene}: {why}")))?;
    if !window::has_display() {
        return Err(Failure::usage("there is no display: a window is measured on one (`xvfb-run` gives one that is none)"));
    }
    let measured = window::measure(scene).map_err(|why| Failure::usage(format!("the window can't be measured: {why}")))?;
    print(table(scene, &measured).as_bytes())?;
    Ok(Exit::Fine)
}

fn table(scene: &str, measured: &window::Measured) -> String {
    let window::Measured { adapter, size: (width, height), echoes, pictures, blinking, still, .. } = measured;
    let ms = |time: Duration| format!("{:.1} ms", time.as_secs_f64() * 1e3);
    let at = |percent| ms(percentile(echoes, percent));
    let share = |known: &Option<(f64, Duration)>| match known {
        Some((share, time)) => format!("{:.1} % of a core over {:.0} s", 100.0 * share, time.as_secs_f64()),
        None => "not known on this system".to_owned(),
    };
    format!(
        "{scene}, a picture of {width} × {height} on {adapter}\n  \
         a key, to the end of the frame that shows it   {} at the median, {} at p95, {} at worst, of {} keys while {pictures} pictures were drawn\n  \
         a caret at rest, soon after a key              {}\n  \
         a caret at rest, later                         {}\n",
        at(50),
        at(95),
        at(100),
        echoes.len(),
        share(blinking),
        share(still),
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_measured_is_printed() {
        let measured = window::Measured {
            adapter: "an adapter".to_owned(),
            size: (640, 480),
            echoes: (1..=100).map(Duration::from_millis).collect(),
            pictures: 7,
            blinking: Some((0.0125, Duration::from_secs(8))),
            ..window::Measured::default()
        };
        let text = table("a.sdf", &measured);
        assert!(text.contains("50.0 ms at the median, 95.0 ms at p95, 100.0 ms at worst, of 100 keys while 7 pictures"), "{text}");
        assert!(text.contains("1.2 % of a core over 8 s") && text.contains("not known"), "{text}");
    }
}
