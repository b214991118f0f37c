//! What the library's texts take rounding for.

use crate::interface::Rounding;
use std::borrow::Cow;

/// A text in which `COORDINATES` and `UNIT` stand for what rounding grows with, with that in their places.
pub fn with_rounding(text: &str, rounding: Rounding) -> String {
    let unit = rounding.unit as f32;
    let text = if unit == 1.0 { Cow::Owned(text.replace(" * UNIT", "")) } else { Cow::Borrowed(text) };
    text.replace("COORDINATES", &coordinates(rounding.reads_scene)).replace("UNIT", &format!("{unit:?}"))
}

/// The coordinates with which rounding grows where a ray starts at `origin`: those of the scene where it is read as it is, else the way from the
/// module's own origin.
fn coordinates(reads_scene: [bool; 3]) -> Cow<'static, str> {
    match reads_scene {
        [false, false, false] => "origin".into(),
        [true, true, true] => "origin + sf_uniforms.origin".into(),
        axes => {
            let [x, y, z] = axes.map(|read| if read { "1.0" } else { "0.0" });
            format!("origin + sf_uniforms.origin * vec3f({x}, {y}, {z})").into()
        }
    }
}
