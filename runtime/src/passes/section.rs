//! A picture that a plane cuts open: how the texts of the passes over it change. Where there is no such plane none of this is in a module.

use std::borrow::Cow;
use surefoot_compiler::reference::View;
use surefoot_compiler::section::{Across, Cut};

/// What every pass over such a picture has: the plane, and how the view shows what is cut.
pub(super) fn sections(view: View) -> [&'static str; 2] {
    let cut = match view {
        View::Shaded => include_str!("section/light.wgsl"),
        View::Normals => include_str!("section/normals.wgsl"),
        View::Depth => include_str!("section/depth.wgsl"),
        _ => include_str!("section/plain.wgsl"),
    };
    [PLANE, cut]
}

/// The plane alone.
pub(super) const PLANE: &str = include_str!("section/base.wgsl");

/// Values of the plane's `override` constants.
pub(super) fn constants(cut: Cut) -> [(&'static str, f64); 2] {
    let across = Across::ALL.iter().position(|across| *across == cut.across).unwrap_or(0);
    [("scene_across", across as f64), ("scene_keeps_above", f64::from(u8::from(cut.keeps_above)))]
}

/// The field's part of the pass: the view's rays, and where the plane lets them begin.
pub(super) fn pixel(view: View, text: &str) -> String {
    let rays = replaced(text, &[("fn scene_pixel(", "fn scene_kept(")]);
    let color = if view == View::Shaded { include_str!("section/color.wgsl") } else { include_str!("section/no_color.wgsl") };
    [&rays, color, include_str!("section/pixel.wgsl")].join("\n")
}

/// The depth of meshes, but for what is taken away.
pub(super) fn before(text: &str) -> String {
    replaced(text, &[("if length(in.way) > scene.max_distance {", "if (length(in.way) > scene.max_distance) | (scene_section_height(scene.eye + in.way) > 0.0) {")])
}

/// Meshes, but for what is taken away.
pub(super) fn meshes(text: &str) -> String {
    let cut = replaced(
        text,
        &[
            ("if t > scene.max_distance ||", "if scene_section_height(scene.eye + in.way) > 0.0 || t > scene.max_distance ||"),
            (
                "mesh_color(scene.eye + in.way, n, facet, direction, t)",
                "mesh_cut(scene.eye + in.way, n, facet, direction, t, dot(smooth_normal, facet) < 0.0)",
            ),
        ],
    );
    [&cut, include_str!("section/meshes.wgsl")].join("\n")
}

/// Balls, each with a flat face where it is cut.
pub(super) fn balls(text: &str) -> String {
    let cut = replaced(
        text,
        &[
            ("if t <= 0.0 || t > scene.max_distance {", "if t <= 0.0 || t > scene.max_distance || ball_is_removed(start, direction, t, along + half) {"),
            ("ball_color(start + t * direction, n, direction, t, look)", "ball_cut(start, n, direction, t, look)"),
            ("scene_depth(t * ", "scene_depth(ball_begin(start, direction, t) * "),
        ],
    );
    [&cut, include_str!("section/balls.wgsl")].join("\n")
}

/// A text with other words in the place of some, which it has.
fn replaced(text: &str, pairs: &[(&str, &str)]) -> String {
    let mut text = Cow::Borrowed(text);
    for (old, new) in pairs {
        debug_assert!(text.contains(old), "{old}");
        text = text.replace(old, new).into();
    }
    text.into_owned()
}
