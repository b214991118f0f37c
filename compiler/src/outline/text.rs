//! Words as contours: a font's glyphs, shaped and set in lines.

use super::clean::{Fill, Piece, boundary};
use super::curve::{Curve, Vec2};
use super::path::contours;
use harfrust::{ShaperData, UnicodeBuffer};
use kurbo::{BezPath, Point};
use skrifa::instance::{LocationRef, Size};
use skrifa::outline::{DrawSettings, OutlinePen};
use skrifa::{FontRef, GlyphId, MetadataProvider};
use std::collections::BTreeMap;

/// The font that comes along: DejaVu Sans Bold, with fewer characters.
const FONT: &[u8] = include_bytes!("../../fonts/DejaVuSans-Bold.ttf");

/// The most characters of one text.
pub const MOST_CHARACTERS: usize = 4_000;

/// Which place of each line stands at x = 0.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    /// Its start.
    Left,
    /// Its middle.
    Center,
    /// Its end.
    Right,
}

/// How words are set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Typesetting {
    /// The height of the font: from the top of its tallest letters to below its lowest, about 1.4 capitals.
    pub size: f64,
    /// Which place of each line stands at x = 0.
    pub align: Align,
    /// What stands between two letters beside what the font has there, as a share of the size.
    pub spacing: f64,
    /// From one line to the next, as a share of the size.
    pub leading: f64,
}

/// Takes a glyph's outline.
struct Pen(BezPath);

impl OutlinePen for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.0.move_to(point(x, y));
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.0.line_to(point(x, y));
    }

    fn quad_to(&mut self, cx: f32, cy: f32, x: f32, y: f32) {
        self.0.quad_to(point(cx, cy), point(x, y));
    }

    fn curve_to(&mut self, ax: f32, ay: f32, bx: f32, by: f32, x: f32, y: f32) {
        self.0.curve_to(point(ax, ay), point(bx, by), point(x, y));
    }

    fn close(&mut self) {
        self.0.close_path();
    }
}

fn point(x: f32, y: f32) -> Point {
    Point::new(f64::from(x), f64::from(y))
}

/// The boundary of words in a font, or in the one that comes along: the first line stands on y = 0. An error says what the font lacks.
pub fn typeset(words: &str, font: Option<&[u8]>, setting: &Typesetting) -> Result<Vec<Piece>, String> {
    let font = FontRef::new(font.unwrap_or(FONT)).map_err(|error| format!("it is no font that can be read: {error}"))?;
    let count = words.chars().count();
    if count > MOST_CHARACTERS {
        return Err(format!("a text has {MOST_CHARACTERS} characters at most, and this one has {count}"));
    }
    let missing: String = words.chars().filter(|c| !c.is_control() && font.charmap().map(*c).is_none()).take(8).collect();
    if !missing.is_empty() {
        return Err(format!("the font has no `{missing}`"));
    }
    let data = ShaperData::new(&font);
    let shaper = data.shaper(&font).build();
    let scale = setting.size / f64::from(shaper.units_per_em().max(1));
    let glyphs = font.outline_glyphs();
    let mut drawn: BTreeMap<u32, Vec<Vec<Curve>>> = BTreeMap::new();
    let mut all: Vec<Vec<Curve>> = Vec::new();
    for (line, text) in words.lines().enumerate() {
        let mut buffer = UnicodeBuffer::new();
        buffer.push_str(text);
        buffer.guess_segment_properties();
        let shaped = shaper.shape(buffer, Default::default());
        let gap = setting.spacing / scale * setting.size;
        let (mut x, mut y) = (0.0, 0.0);
        let mut places: Vec<(u32, Vec2)> = Vec::new();
        for (glyph, at) in shaped.glyph_infos().iter().zip(shaped.glyph_positions()) {
            places.push((glyph.glyph_id, [x + f64::from(at.x_offset), y + f64::from(at.y_offset)]));
            x += f64::from(at.x_advance) + gap;
            y += f64::from(at.y_advance);
        }
        let wide = x - if places.is_empty() { 0.0 } else { gap };
        let start = match setting.align {
            Align::Left => 0.0,
            Align::Center => -0.5 * wide,
            Align::Right => -wide,
        };
        let down = setting.leading * setting.size * line as f64;
        for (glyph, [x, y]) in places {
            let shape = drawn.entry(glyph).or_insert_with(|| {
                let mut pen = Pen(BezPath::new());
                if let Some(outline) = glyphs.get(GlyphId::new(glyph)) {
                    let settings = DrawSettings::unhinted(Size::unscaled(), LocationRef::default());
                    // A glyph that can't be read is empty, as fonts ask.
                    let _ = outline.draw(settings, &mut pen);
                }
                contours(&pen.0)
            });
            let place = |p: Vec2| [(p[0] + x + start) * scale, (p[1] + y) * scale - down];
            all.extend(shape.iter().map(|contour| contour.iter().map(|curve| Curve { a: place(curve.a), b: place(curve.b), c: place(curve.c) }).collect::<Vec<_>>()));
        }
    }
    boundary(&all, Fill::NonZero)
}
