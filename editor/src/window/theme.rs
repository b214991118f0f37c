//! How the window looks: quiet, so that the picture is what shines; dark, or light.

use egui::{Color32, CornerRadius, FontFamily, FontId, Stroke, TextStyle, ThemePreference, Visuals};
use std::cell::Cell;
use std::ops::Deref;

thread_local! {
    /// Whether the light look is on. A window has one thread.
    static IS_LIGHT: Cell<bool> = const { Cell::new(false) };
}

/// A colour of the look that is on: `*PANEL` is a colour now.
#[derive(Clone, Copy, Debug)]
pub struct Tone {
    dark: Color32,
    light: Color32,
}

impl Tone {
    /// Of the dark look and of the light one, as `0xRRGGBB`.
    pub const fn new(dark: u32, light: u32) -> Self {
        const fn rgb(hex: u32) -> Color32 {
            let [_, r, g, b] = hex.to_be_bytes();
            Color32::from_rgb(r, g, b)
        }
        Self { dark: rgb(dark), light: rgb(light) }
    }
}

impl Deref for Tone {
    type Target = Color32;

    fn deref(&self) -> &Color32 {
        if IS_LIGHT.get() { &self.light } else { &self.dark }
    }
}

impl From<Tone> for Color32 {
    fn from(tone: Tone) -> Self {
        *tone
    }
}

/// Behind everything.
pub const GROUND: Tone = Tone::new(0x14161a, 0xe4e7eb);
/// Panels.
pub const PANEL: Tone = Tone::new(0x1b1e23, 0xf3f4f6);
/// What text is written in, and sliders' rails.
pub const WELL: Tone = Tone::new(0x111316, 0xfdfdfe);
/// Lines between panels.
pub const LINE: Tone = Tone::new(0x2c3139, 0xc9ced6);
/// Text.
pub const TEXT: Tone = Tone::new(0xc9cfd8, 0x242931);
/// Text that matters less.
pub const WEAK: Tone = Tone::new(0x808996, 0x626b78);
/// What is chosen or moved.
pub const ACCENT: Tone = Tone::new(0xe09f4a, 0xa86208);
/// Errors.
pub const ERROR: Tone = Tone::new(0xf06a60, 0xc02a22);
/// Warnings.
pub const WARNING: Tone = Tone::new(0xe5c05a, 0x8f6800);

/// What stands out from the text.
pub const STRONG: Tone = Tone::new(0xffffff, 0x000000);
/// Every other row.
pub const FAINT: Tone = Tone::new(0x20242a, 0xeaecef);
/// Behind what is chosen.
pub const CHOSEN: Tone = Tone::new(0x6a4c26, 0xffdcac);
/// Text on it.
pub const ON_CHOSEN: Tone = Tone::new(0xffe3bd, 0x3d2200);
/// Behind what a person must decide.
pub const ASKS: Tone = Tone::new(0x3a2c14, 0xffecc8);
/// Behind what is wrong.
pub const WRONG: Tone = Tone::new(0x3a1414, 0xffddda);

/// Colours of the source.
pub mod code {
    use super::Tone;
    /// `let`, `for`.
    pub const KEYWORD: Tone = Tone::new(0xd78fc8, 0x952f86);
    /// `shape`, `float`.
    pub const KIND: Tone = Tone::new(0x6fb7d9, 0x166c94);
    /// Names.
    pub const NAME: Tone = Tone::new(0xd3d8e0, 0x242931);
    /// Numbers.
    pub const NUMBER: Tone = Tone::new(0xe3b06c, 0x955500);
    /// Strings.
    pub const TEXT: Tone = Tone::new(0xa5c67f, 0x3f701c);
    /// Comments.
    pub const COMMENT: Tone = Tone::new(0x6b7482, 0x77808d);
    /// Documentation.
    pub const DOC: Tone = Tone::new(0x86a090, 0x456b55);
    /// Operators.
    pub const OPERATOR: Tone = Tone::new(0x9aa3b2, 0x555e6b);
}

/// How large a text is written at first, in points.
pub const TEXT_SIZE: f32 = 13.0;

/// The font of what is code, so large.
pub fn code_font(size: f32) -> FontId {
    FontId::new(size, FontFamily::Monospace)
}

/// Which of the two looks is wanted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Choice {
    /// Dark.
    #[default]
    Dark,
    /// Light.
    Light,
    /// As the desktop has it.
    System,
}

impl Choice {
    /// All of them, with what they are called.
    pub const ALL: [(Self, &str); 3] = [(Self::Dark, "Dark"), (Self::Light, "Light"), (Self::System, "As the desktop")];
}

/// Puts the look on.
pub fn apply(ctx: &egui::Context) {
    ctx.set_theme(egui::Theme::Dark);
    for theme in [egui::Theme::Dark, egui::Theme::Light] {
        ctx.style_mut_of(theme, |style| dress(style, theme == egui::Theme::Light));
    }
    // The text has keys of its own for its size.
    ctx.options_mut(|options| options.zoom_with_keyboard = false);
}

/// Takes the look that is wanted from now on.
pub fn choose(ctx: &egui::Context, choice: Choice) {
    let wanted = match choice {
        Choice::Dark => ThemePreference::Dark,
        Choice::Light => ThemePreference::Light,
        Choice::System => ThemePreference::System,
    };
    if ctx.options(|options| options.theme_preference) != wanted {
        ctx.set_theme(wanted);
    }
    IS_LIGHT.set(ctx.theme() == egui::Theme::Light);
}

/// Whether the look is the light one.
pub fn is_light() -> bool {
    IS_LIGHT.get()
}

fn dress(style: &mut egui::Style, light: bool) {
    let before = IS_LIGHT.replace(light);
    style.visuals = visuals(light);
    IS_LIGHT.set(before);
    style.spacing.item_spacing = egui::vec2(8.0, 5.0);
    style.spacing.button_padding = egui::vec2(7.0, 3.0);
    style.spacing.interact_size.y = 20.0;
    style.spacing.slider_rail_height = 4.0;
    style.spacing.scroll = egui::style::ScrollStyle::thin();
    style.text_styles.insert(TextStyle::Body, FontId::proportional(13.0));
    style.text_styles.insert(TextStyle::Button, FontId::proportional(13.0));
    style.text_styles.insert(TextStyle::Small, FontId::proportional(11.0));
    style.text_styles.insert(TextStyle::Heading, FontId::proportional(15.0));
    style.text_styles.insert(TextStyle::Monospace, code_font(13.0));
}

fn visuals(light: bool) -> Visuals {
    let mut visuals = if light { Visuals::light() } else { Visuals::dark() };
    visuals.panel_fill = *PANEL;
    visuals.window_fill = *PANEL;
    visuals.window_stroke = Stroke::new(1.0, *LINE);
    visuals.extreme_bg_color = *WELL;
    visuals.faint_bg_color = *FAINT;
    visuals.error_fg_color = *ERROR;
    visuals.warn_fg_color = *WARNING;
    visuals.hyperlink_color = *ACCENT;
    visuals.weak_text_color = Some(*WEAK);
    visuals.slider_trailing_fill = true;
    visuals.selection.bg_fill = *CHOSEN;
    visuals.selection.stroke = Stroke::new(1.0, *ON_CHOSEN);
    visuals.menu_corner_radius = CornerRadius::same(4);
    visuals.window_corner_radius = CornerRadius::same(6);
    let widgets = &mut visuals.widgets;
    widgets.noninteractive.bg_stroke = Stroke::new(1.0, *LINE);
    widgets.noninteractive.fg_stroke = Stroke::new(1.0, *TEXT);
    let shades = [
        (&mut widgets.inactive, Tone::new(0x2a2f37, 0xdfe3e8), TEXT),
        (&mut widgets.hovered, Tone::new(0x353b45, 0xd0d6de), STRONG),
        (&mut widgets.active, Tone::new(0x414854, 0xbfc7d2), STRONG),
        (&mut widgets.open, Tone::new(0x303640, 0xd6dbe2), STRONG),
    ];
    for (widget, shade, text) in shades {
        widget.bg_fill = *shade;
        widget.weak_bg_fill = *shade;
        widget.bg_stroke = Stroke::NONE;
        widget.fg_stroke = Stroke::new(1.0, *text);
        widget.corner_radius = CornerRadius::same(4);
        widget.expansion = 0.0;
    }
    visuals
}
