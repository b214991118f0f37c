//! How the window looks: dark and quiet, so that the picture is what shines.

use egui::{Color32, CornerRadius, FontFamily, FontId, Stroke, TextStyle, Visuals};

/// Behind everything.
pub const GROUND: Color32 = Color32::from_rgb(0x14, 0x16, 0x1a);
/// Panels.
pub const PANEL: Color32 = Color32::from_rgb(0x1b, 0x1e, 0x23);
/// What text is written in, and sliders' rails.
pub const WELL: Color32 = Color32::from_rgb(0x11, 0x13, 0x16);
/// Lines between panels.
pub const LINE: Color32 = Color32::from_rgb(0x2c, 0x31, 0x39);
/// Text.
pub const TEXT: Color32 = Color32::from_rgb(0xc9, 0xcf, 0xd8);
/// Text that matters less.
pub const WEAK: Color32 = Color32::from_rgb(0x80, 0x89, 0x96);
/// What is chosen or moved.
pub const ACCENT: Color32 = Color32::from_rgb(0xe0, 0x9f, 0x4a);
/// Errors.
pub const ERROR: Color32 = Color32::from_rgb(0xf0, 0x6a, 0x60);
/// Warnings.
pub const WARNING: Color32 = Color32::from_rgb(0xe5, 0xc0, 0x5a);

/// Colours of the source.
pub mod code {
    use super::Color32;
    /// `let`, `for`.
    pub const KEYWORD: Color32 = Color32::from_rgb(0xd7, 0x8f, 0xc8);
    /// `shape`, `float`.
    pub const KIND: Color32 = Color32::from_rgb(0x6f, 0xb7, 0xd9);
    /// Names.
    pub const NAME: Color32 = Color32::from_rgb(0xd3, 0xd8, 0xe0);
    /// Numbers.
    pub const NUMBER: Color32 = Color32::from_rgb(0xe3, 0xb0, 0x6c);
    /// Strings.
    pub const TEXT: Color32 = Color32::from_rgb(0xa5, 0xc6, 0x7f);
    /// Comments.
    pub const COMMENT: Color32 = Color32::from_rgb(0x6b, 0x74, 0x82);
    /// Documentation.
    pub const DOC: Color32 = Color32::from_rgb(0x86, 0xa0, 0x90);
    /// Operators.
    pub const OPERATOR: Color32 = Color32::from_rgb(0x9a, 0xa3, 0xb2);
}

/// The font of the source.
pub const CODE: FontId = FontId::new(13.0, FontFamily::Monospace);

/// Puts the look on.
pub fn apply(ctx: &egui::Context) {
    ctx.set_theme(egui::Theme::Dark);
    ctx.all_styles_mut(|style| {
        style.visuals = visuals();
        style.spacing.item_spacing = egui::vec2(8.0, 5.0);
        style.spacing.button_padding = egui::vec2(7.0, 3.0);
        style.spacing.interact_size.y = 20.0;
        style.spacing.slider_rail_height = 4.0;
        style.spacing.scroll = egui::style::ScrollStyle::thin();
        style.text_styles.insert(TextStyle::Body, FontId::proportional(13.0));
        style.text_styles.insert(TextStyle::Button, FontId::proportional(13.0));
        style.text_styles.insert(TextStyle::Small, FontId::proportional(11.0));
        style.text_styles.insert(TextStyle::Heading, FontId::proportional(15.0));
        style.text_styles.insert(TextStyle::Monospace, CODE);
    });
}

fn visuals() -> Visuals {
    let mut visuals = Visuals::dark();
    visuals.panel_fill = PANEL;
    visuals.window_fill = PANEL;
    visuals.window_stroke = Stroke::new(1.0, LINE);
    visuals.extreme_bg_color = WELL;
    visuals.faint_bg_color = Color32::from_rgb(0x20, 0x24, 0x2a);
    visuals.error_fg_color = ERROR;
    visuals.warn_fg_color = WARNING;
    visuals.hyperlink_color = ACCENT;
    visuals.weak_text_color = Some(WEAK);
    visuals.slider_trailing_fill = true;
    visuals.selection.bg_fill = Color32::from_rgb(0x6a, 0x4c, 0x26);
    visuals.selection.stroke = Stroke::new(1.0, Color32::from_rgb(0xff, 0xe3, 0xbd));
    visuals.menu_corner_radius = CornerRadius::same(4);
    visuals.window_corner_radius = CornerRadius::same(6);
    let widgets = &mut visuals.widgets;
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, LINE);
    widgets.noninteractive.fg_stroke = Stroke::new(1.0, TEXT);
    let shades = [
        (&mut widgets.inactive, 0x2a_2f_37, TEXT),
        (&mut widgets.hovered, 0x35_3b_45, Color32::WHITE),
        (&mut widgets.active, 0x41_48_54, Color32::WHITE),
        (&mut widgets.open, 0x30_36_40, Color32::WHITE),
    ];
    for (widget, shade, text) in shades {
        let [_, r, g, b] = u32::to_be_bytes(shade);
        widget.bg_fill = Color32::from_rgb(r, g, b);
        widget.weak_bg_fill = widget.bg_fill;
        widget.bg_stroke = Stroke::NONE;
        widget.fg_stroke = Stroke::new(1.0, text);
        widget.corner_radius = CornerRadius::same(4);
        widget.expansion = 0.0;
    }
    visuals
}
