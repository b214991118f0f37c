//! What the fills of an SVG file cover, as one boundary.

use super::clean::{Fill, MOST_CURVES, Piece, boundary};
use super::curve::Curve;
use super::path::{arc, contours, data};
use kurbo::{Affine, BezPath, Point, Shape};
use roxmltree::{Document, Node, ParsingOptions};
use simplecss::{AttributeOperator, Declaration, DeclarationTokenizer, PseudoClass, StyleSheet};
use std::str::FromStr;
use svgtypes::{Align, AspectRatio, Length, LengthUnit, PointsParser, Transform, ViewBox};

/// Bytes of the largest file that is read.
pub const MOST_SVG: u64 = 8 << 20;
/// The most nodes of a file: elements, texts and comments.
const MOST_NODES: u32 = 200_000;
/// The most elements that are drawn, each time that one is.
const MOST_DRAWN: usize = 20_000;
/// The most curves that are joined, each as often as that happens: with each clip, what it clips is joined again.
const MOST_JOINED: usize = 10 * MOST_CURVES;
/// The most rules of style.
const MOST_RULES: usize = 1_000;
/// How deep elements are in each other at most, with those that are used.
const DEEPEST: usize = 100;

/// A drawing of a file.
#[derive(Clone, Debug)]
pub struct Logo {
    /// What bounds its fills together.
    pub pieces: Vec<Piece>,
    /// Where its first shape is that has a stroke and no fill, and is therefore not in it: line and column.
    pub line_only: Option<(u32, u32)>,
}

/// Why there is no drawing.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Refused {
    /// Line and column of the file, from 1 on; none where it is no place of it.
    pub at: Option<(u32, u32)>,
    /// What is wrong.
    pub message: String,
    /// What to do instead.
    pub help: &'static str,
}

type Read<T> = Result<T, Refused>;

const AS_PATHS: &str = "turn it into paths in the program that drew it (in Inkscape: Path, Object to Path)";
const SIMPLER: &str = "save a simpler drawing";
const NO_FILES: &str = "an SVG is read alone: put what it needs into the file";

/// The fills of an SVG (SVG 1.1, and of SVG 2 what drawing programs write), with y upward and the middle of its page at the origin. `height`: that of the page;
/// without one, lengths are those of its `viewBox`.
///
/// Colours, strokes, gradients and filters do not matter. What clips, clips. No other file is read.
pub fn svg(bytes: &[u8], height: Option<f64>) -> Read<Logo> {
    let whole = |message: &str, help| Refused { at: None, message: message.to_owned(), help };
    if bytes.starts_with(&[0x1f, 0x8b]) {
        return Err(whole("it is packed", "unpack it first: `gunzip < logo.svgz > logo.svg`"));
    }
    let text = std::str::from_utf8(bytes).map_err(|_| whole("it is no text in UTF-8", "save it as a plain SVG"))?;
    let options = ParsingOptions { allow_dtd: true, nodes_limit: MOST_NODES, ..ParsingOptions::default() };
    let document = Document::parse_with_options(text, options).map_err(|error| {
        let place = error.pos();
        Refused { at: Some((place.row, place.col)), message: format!("it is no XML: {error}"), help: "save it as a plain SVG" }
    })?;
    let root = document.root_element();
    if !is_svg(root) || root.tag_name().name() != "svg" {
        return Err(refused(root, format!("it begins with `{}`, and an SVG with `svg`", root.tag_name().name()), "save it as a plain SVG"));
    }
    let mut style = StyleSheet::new();
    for node in document.descendants().filter(|node| is_svg(*node) && node.tag_name().name() == "style") {
        node.children().filter_map(|child| child.text()).for_each(|text| style.parse_more(text));
    }
    if style.rules.len() > MOST_RULES {
        return Err(whole(&format!("it has {} rules of style, and {MOST_RULES} are read at most", style.rules.len()), SIMPLER));
    }
    let ids = document.descendants().filter_map(|node| Some((node.attribute("id")?, node))).rev().collect();
    let page = page(root)?;
    let size = page.map_or([100.0, 100.0], |page| [page.w, page.h]);
    let mut reader = Reader { style, ids, size, drawn: 0, curves: 0, joined: 0, used: Vec::new(), line_only: None };
    let mut fills = Vec::new();
    let start = State { place: Affine::FLIP_Y, is_filled: true, is_even_odd: false, is_seen: true, is_stroked: false, is_clip: false };
    let start = reader.styled(root, &start)?.map(|(state, _)| state);
    if let Some(state) = start {
        reader.children(root, &state, &mut fills, 0)?;
    }
    if fills.is_empty() {
        let (message, help) = match reader.line_only {
            Some(_) => ("it has strokes and no fill", "turn strokes into paths (in Inkscape: Path, Stroke to Path), or write `path(\"…\").stroke(0.1)`"),
            None => ("it has no fill", "only what is filled is read: draw shapes or paths with a fill"),
        };
        return Err(Refused { at: reader.line_only, message: message.to_owned(), help });
    }
    let drawn = reader.joined(&fills, Fill::NonZero)?;
    let corners = || drawn.iter().flat_map(|curve| curve.bounds());
    let page = page.unwrap_or_else(|| {
        let of = |pick: fn(f64, f64) -> f64, i: usize| corners().map(|corner| corner.get(i).copied().unwrap_or(0.0)).reduce(pick).unwrap_or(0.0);
        let (low, high) = ([of(f64::min, 0), of(f64::min, 1)], [of(f64::max, 0), of(f64::max, 1)]);
        ViewBox { x: low[0], y: -high[1], w: high[0] - low[0], h: high[1] - low[1] }
    });
    let scale = height.map_or(1.0, |height| height / page.h);
    let middle = [page.x + 0.5 * page.w, -page.y - 0.5 * page.h];
    let place = |p: [f64; 2]| [(p[0] - middle[0]) * scale, (p[1] - middle[1]) * scale];
    let placed = drawn.iter().map(|curve| Curve { a: place(curve.a), b: place(curve.b), c: place(curve.c) }).collect();
    Ok(Logo { pieces: bounded(&[placed], Fill::NonZero)?, line_only: reader.line_only })
}

fn bounded(all: &[Vec<Curve>], fill: Fill) -> Read<Vec<Piece>> {
    boundary(all, fill).map_err(|message| Refused { at: None, message, help: SIMPLER })
}

fn refused(node: Node, message: impl Into<String>, help: &'static str) -> Refused {
    Refused { at: Some(place(node)), message: message.into(), help }
}

fn place(node: Node) -> (u32, u32) {
    let place = node.document().text_pos_at(node.range().start);
    (place.row, place.col)
}

fn is_svg(node: Node) -> bool {
    node.is_element() && node.tag_name().namespace().is_none_or(|name| name == "http://www.w3.org/2000/svg")
}

/// The rectangle that an `svg` or a `symbol` shows, in its own lengths: its `viewBox`, or its width and height; none where it has neither.
fn page(node: Node) -> Read<Option<ViewBox>> {
    let page = match node.attribute("viewBox") {
        Some(said) => Some(ViewBox::from_str(said).map_err(|error| refused(node, format!("its `viewBox` can't be read: {error}"), "write `viewBox=\"0 0 24 24\"`"))?),
        None => {
            let side = |name| node.attribute(name).and_then(|said| Length::from_str(said).ok()).filter(|length| length.unit != LengthUnit::Percent).map(|length| absolute(length, 0.0));
            side("width").zip(side("height")).map(|(w, h)| ViewBox { x: 0.0, y: 0.0, w, h })
        }
    };
    let is_one = |page: &ViewBox| page.w > 0.0 && page.h > 0.0 && [page.x, page.y, page.w, page.h].iter().all(|c| c.is_finite());
    match page {
        Some(page) if !is_one(&page) => Err(refused(node, "its page has no size", "write `viewBox=\"0 0 24 24\"`")),
        page => Ok(page),
    }
}

/// A length, 96 of which are an inch; `whole`: that of which it is a share.
fn absolute(length: Length, whole: f64) -> f64 {
    length.number
        * match length.unit {
            LengthUnit::None | LengthUnit::Px => 1.0,
            LengthUnit::Em => 16.0,
            LengthUnit::Ex => 8.0,
            LengthUnit::In => 96.0,
            LengthUnit::Cm => 96.0 / 2.54,
            LengthUnit::Mm => 96.0 / 25.4,
            LengthUnit::Pt => 96.0 / 72.0,
            LengthUnit::Pc => 16.0,
            LengthUnit::Percent => whole / 100.0,
        }
}

/// What an element has from those around it.
#[derive(Clone, Copy)]
struct State {
    /// From its lengths to those of the drawing.
    place: Affine,
    is_filled: bool,
    is_even_odd: bool,
    is_seen: bool,
    is_stroked: bool,
    /// In a clip, fills and rules of fills are others.
    is_clip: bool,
}

struct Reader<'a, 'input> {
    style: StyleSheet<'a>,
    ids: std::collections::BTreeMap<&'a str, Node<'a, 'input>>,
    /// Width and height of the page.
    size: [f64; 2],
    drawn: usize,
    curves: usize,
    joined: usize,
    /// The elements that are being used, from outside inward.
    used: Vec<Node<'a, 'input>>,
    line_only: Option<(u32, u32)>,
}

struct Styled<'a, 'input>(Node<'a, 'input>);

impl simplecss::Element for Styled<'_, '_> {
    fn parent_element(&self) -> Option<Self> {
        self.0.parent_element().map(Styled)
    }

    fn prev_sibling_element(&self) -> Option<Self> {
        self.0.prev_sibling_element().map(Styled)
    }

    fn has_local_name(&self, name: &str) -> bool {
        self.0.tag_name().name() == name
    }

    fn attribute_matches(&self, name: &str, operator: AttributeOperator) -> bool {
        self.0.attribute(name).is_some_and(|value| operator.matches(value))
    }

    fn pseudo_class_matches(&self, class: PseudoClass) -> bool {
        class == PseudoClass::FirstChild && self.prev_sibling_element().is_none()
    }
}

impl<'a, 'input> Reader<'a, 'input> {
    /// What an element has and how it is clipped; none where it is not drawn.
    fn styled(&mut self, node: Node<'a, 'input>, around: &State) -> Read<Option<(State, Option<Node<'a, 'input>>)>> {
        let mut state = *around;
        let (mut clip, mut drawn, mut mask) = (None, true, None);
        let mut set = |name: &str, value: &'a str| match (name, value.trim()) {
            (_, "inherit") => {}
            ("fill", value) => state.is_filled = !matches!(value, "none" | "transparent"),
            ("fill-opacity", value) => state.is_filled &= !matches!(value, "0" | "0%" | "0.0"),
            ("fill-rule", value) if !around.is_clip => state.is_even_odd = value == "evenodd",
            ("clip-rule", value) if around.is_clip => state.is_even_odd = value == "evenodd",
            ("stroke", value) => state.is_stroked = !matches!(value, "none" | "transparent"),
            ("visibility", value) => state.is_seen = value == "visible",
            ("display", value) => drawn &= value != "none",
            ("opacity", value) => drawn &= !matches!(value, "0" | "0%" | "0.0"),
            ("clip-path", value) => clip = (value != "none").then_some(value),
            ("mask", value) => mask = (value != "none").then_some(value),
            _ => {}
        };
        node.attributes().for_each(|attribute| set(attribute.name(), attribute.value()));
        let matched: Vec<Declaration> = self.style.rules.iter().filter(|rule| rule.selector.matches(&Styled(node))).flat_map(|rule| rule.declarations.iter().copied()).collect();
        let own: Vec<Declaration> = node.attribute("style").map(DeclarationTokenizer::from).into_iter().flatten().collect();
        for important in [false, true] {
            matched.iter().chain(&own).filter(|one| one.important == important).for_each(|one| set(one.name, one.value));
        }
        if !drawn {
            return Ok(None);
        }
        if mask.is_some() {
            return Err(refused(node, "it has a mask, which is not read", "cut the drawing in the program that drew it, or clip it"));
        }
        if let Some(said) = node.attribute("transform") {
            let t = Transform::from_str(said).map_err(|error| refused(node, format!("its `transform` can't be read: {error}"), "write it as SVG has it: `translate(10 20) rotate(30)`"))?;
            state.place *= Affine::new([t.a, t.b, t.c, t.d, t.e, t.f]);
        }
        let clip = match clip {
            Some(said) => {
                let id = said.strip_prefix("url(").and_then(|rest| rest.strip_suffix(')')).map(|name| name.trim_matches(['"', '\'', ' ']));
                Some(self.named(node, id.unwrap_or(said))?)
            }
            None => None,
        };
        Ok(Some((state, clip)))
    }

    /// The curves that bound what several boundaries cover together, or all of them.
    fn joined(&mut self, all: &[Vec<Curve>], fill: Fill) -> Read<Vec<Curve>> {
        self.joined += all.iter().map(Vec::len).sum::<usize>();
        if self.joined > MOST_JOINED {
            return Err(Refused { at: None, message: "it has too many curves that are clipped".to_owned(), help: SIMPLER });
        }
        Ok(bounded(all, fill)?.into_iter().map(|piece| piece.curve).collect())
    }

    /// The element that `#id` names.
    fn named(&self, node: Node, name: &str) -> Read<Node<'a, 'input>> {
        let Some(id) = name.strip_prefix('#') else {
            return Err(refused(node, format!("it names another file, `{name}`"), NO_FILES));
        };
        self.ids.get(id).copied().ok_or_else(|| refused(node, format!("there is no element `{name}`"), "name an element that has this `id`"))
    }

    fn children(&mut self, node: Node<'a, 'input>, state: &State, fills: &mut Vec<Vec<Curve>>, depth: usize) -> Read<()> {
        node.children().filter(|child| is_svg(*child)).try_for_each(|child| self.element(child, state, fills, depth + 1))
    }

    /// Draws an element.
    fn element(&mut self, node: Node<'a, 'input>, around: &State, fills: &mut Vec<Vec<Curve>>, depth: usize) -> Read<()> {
        self.drawn += 1;
        if self.drawn > MOST_DRAWN {
            return Err(refused(node, format!("more than {MOST_DRAWN} elements are drawn, some of them often"), SIMPLER));
        }
        if depth > DEEPEST {
            return Err(refused(node, format!("elements are more than {DEEPEST} deep in each other"), SIMPLER));
        }
        let name = node.tag_name().name();
        let is_drawn = matches!(name, "g" | "a" | "svg" | "switch" | "use" | "path" | "rect" | "circle" | "ellipse" | "polygon" | "polyline" | "line" | "image" | "text" | "foreignObject");
        if !is_drawn {
            return Ok(());
        }
        let Some((state, clip)) = self.styled(node, around)? else { return Ok(()) };
        let Some(clip) = clip else { return self.drawn(node, &state, fills, depth) };
        let mut own = Vec::new();
        self.drawn(node, &state, &mut own, depth)?;
        if own.is_empty() {
            return Ok(());
        }
        let own = self.joined(&own, Fill::NonZero)?;
        let shown = self.clip(node, clip, &state, depth)?;
        let clipped = self.joined(&[own, shown], Fill::Both)?;
        if !clipped.is_empty() {
            fills.push(clipped);
        }
        Ok(())
    }

    /// What a `clipPath` shows.
    fn clip(&mut self, node: Node, clip: Node<'a, 'input>, state: &State, depth: usize) -> Read<Vec<Curve>> {
        if clip.tag_name().name() != "clipPath" || clip.attribute("clipPathUnits") == Some("objectBoundingBox") {
            return Err(refused(node, "what clips it is not read", "cut the drawing in the program that drew it"));
        }
        self.enter(node, clip)?;
        let inside = State { is_filled: true, is_even_odd: false, is_seen: true, is_stroked: false, is_clip: true, ..*state };
        let mut shown = Vec::new();
        let styled = self.styled(clip, &inside)?;
        if let Some((inside, outer)) = styled {
            self.children(clip, &inside, &mut shown, depth)?;
            shown = vec![self.joined(&shown, Fill::NonZero)?];
            if let Some(outer) = outer {
                shown.push(self.clip(clip, outer, state, depth + 1)?);
                shown = vec![self.joined(&shown, Fill::Both)?];
            }
        }
        self.used.pop();
        Ok(shown.concat())
    }

    /// Notes that an element is used, unless it is within itself.
    fn enter(&mut self, node: Node, used: Node<'a, 'input>) -> Read<()> {
        if self.used.contains(&used) || node.ancestors().any(|around| around == used) {
            let id = used.attribute("id").unwrap_or_default();
            return Err(refused(node, format!("`#{id}` uses itself"), "name an element that does not hold this one"));
        }
        self.used.push(used);
        Ok(())
    }

    /// Draws an element that has its style.
    fn drawn(&mut self, node: Node<'a, 'input>, state: &State, fills: &mut Vec<Vec<Curve>>, depth: usize) -> Read<()> {
        match node.tag_name().name() {
            "g" | "a" => self.children(node, state, fills, depth),
            "switch" => match node.children().find(|child| is_svg(*child) && child.tag_name().name() != "foreignObject") {
                Some(child) => self.element(child, state, fills, depth + 1),
                None => Ok(()),
            },
            "svg" => self.framed(node, node, state, fills, depth),
            "use" => {
                let href = node.attribute("href").or_else(|| node.attribute(("http://www.w3.org/1999/xlink", "href")));
                let Some(href) = href else { return Ok(()) };
                let used = self.named(node, href)?;
                self.enter(node, used)?;
                let state = State { place: state.place * Affine::translate((self.length(node, "x", 0)?.unwrap_or(0.0), self.length(node, "y", 1)?.unwrap_or(0.0))), ..*state };
                match used.tag_name().name() {
                    "symbol" | "svg" => {
                        if let Some((state, _)) = self.styled(used, &state)? {
                            self.framed(node, used, &state, fills, depth)?;
                        }
                    }
                    _ => self.element(used, &state, fills, depth + 1)?,
                }
                self.used.pop();
                Ok(())
            }
            "image" => Err(refused(node, "it shows an image, and only outlines are read", "trace the image in a drawing program (in Inkscape: Path, Trace Bitmap)")),
            "text" => Err(refused(node, "it has letters, which are not read", AS_PATHS)),
            "foreignObject" => Err(refused(node, "it has parts that are no SVG", "save it as a plain SVG")),
            name => {
                if !state.is_seen {
                    return Ok(());
                }
                if !state.is_filled || name == "line" {
                    if state.is_stroked && self.line_only.is_none() {
                        self.line_only = Some(place(node));
                    }
                    return Ok(());
                }
                let path = state.place * self.shape(node)?;
                if !path.elements().iter().all(|element| element.is_finite()) || path.bounding_box().width().max(path.bounding_box().height()) > 1e15 {
                    return Err(refused(node, "its places are too far away", "draw it nearer to the origin"));
                }
                let drawn = contours(&path);
                self.curves += drawn.iter().map(Vec::len).sum::<usize>();
                if self.curves > MOST_CURVES {
                    return Err(refused(node, format!("the drawing has more than {MOST_CURVES} curves"), SIMPLER));
                }
                let bound = self.joined(&drawn, if state.is_even_odd { Fill::EvenOdd } else { Fill::NonZero })?;
                if !bound.is_empty() {
                    fills.push(bound);
                }
                Ok(())
            }
        }
    }

    /// Draws what an inner `svg`, or a `symbol` that is used, shows in its rectangle. `placed`: the element that says where that is.
    fn framed(&mut self, placed: Node<'a, 'input>, node: Node<'a, 'input>, state: &State, fills: &mut Vec<Vec<Curve>>, depth: usize) -> Read<()> {
        let own = |at: usize, name: &str| self.length(node, name, at);
        let side = |at: usize, name: &str| Ok(self.length(placed, name, at)?.or(own(at, name)?));
        // A `use` has moved what it uses.
        let corner = if placed == node { [own(0, "x")?.unwrap_or(0.0), own(1, "y")?.unwrap_or(0.0)] } else { [0.0; 2] };
        let (wide, tall) = (side(0, "width")?, side(1, "height")?);
        let view = if node.attribute("viewBox").is_some() { page(node)? } else { None };
        let ratio = node.attribute("preserveAspectRatio").and_then(|said| AspectRatio::from_str(said).ok()).unwrap_or_default();
        let size = [wide.unwrap_or(self.size[0]), tall.unwrap_or(self.size[1])];
        let inner = view.map_or(Affine::IDENTITY, |view| fitted(view, size, ratio));
        let frame = state.place * Affine::translate((corner[0], corner[1]));
        let mut shown = Vec::new();
        self.children(node, &State { place: frame * inner, ..*state }, &mut shown, depth)?;
        let is_open = matches!(node.attribute("overflow"), Some("visible" | "auto"));
        if shown.is_empty() || is_open || (wide.is_none() && tall.is_none() && view.is_none()) {
            fills.append(&mut shown);
            return Ok(());
        }
        let window = frame * kurbo::Rect::new(0.0, 0.0, size[0], size[1]).to_path(1e-9);
        let both = [self.joined(&shown, Fill::NonZero)?, self.joined(&contours(&window), Fill::NonZero)?];
        let shown = self.joined(&both, Fill::Both)?;
        if !shown.is_empty() {
            fills.push(shown);
        }
        Ok(())
    }

    /// A length of an element; along x, along y or neither.
    fn length(&self, node: Node, name: &str, axis: usize) -> Read<Option<f64>> {
        let Some(said) = node.attribute(name).filter(|said| said.trim() != "auto") else { return Ok(None) };
        let [wide, tall] = self.size;
        let whole = [wide, tall].get(axis).copied().unwrap_or(wide.hypot(tall) / std::f64::consts::SQRT_2);
        let length = Length::from_str(said).map_err(|error| refused(node, format!("its `{name}` can't be read: {error}"), "write a number"))?;
        Ok(Some(absolute(length, whole)))
    }

    /// The path that an element draws.
    fn shape(&self, node: Node) -> Read<BezPath> {
        let of = |name: &str, axis: usize| self.length(node, name, axis).map(|length| length.unwrap_or(0.0));
        let radii = |x: &str, y: &str| {
            let [rx, ry] = [self.length(node, x, 0)?, self.length(node, y, 1)?];
            Ok([rx.or(ry).unwrap_or(0.0).max(0.0), ry.or(rx).unwrap_or(0.0).max(0.0)])
        };
        match node.tag_name().name() {
            "path" => data(node.attribute("d").unwrap_or_default()).map_err(|why| refused(node, format!("its path can't be read: {why}"), "write path data as SVG has it: `M 0 0 H 1 V 1 Z`")),
            "rect" => {
                let (x, y, w, h) = (of("x", 0)?, of("y", 1)?, of("width", 0)?, of("height", 1)?);
                let [rx, ry] = radii("rx", "ry")?;
                Ok(rectangle([x, y], [w, h], [rx.min(0.5 * w), ry.min(0.5 * h)]))
            }
            "circle" => {
                let r = of("r", 2)?;
                Ok(ellipse([of("cx", 0)?, of("cy", 1)?], [r, r]))
            }
            "ellipse" => Ok(ellipse([of("cx", 0)?, of("cy", 1)?], radii("rx", "ry")?)),
            "polygon" | "polyline" => {
                let points: Vec<Point> = PointsParser::from(node.attribute("points").unwrap_or_default()).map(Point::from).collect();
                let mut path = BezPath::new();
                for (at, point) in points.into_iter().enumerate() {
                    if at == 0 { path.move_to(point) } else { path.line_to(point) }
                }
                Ok(path)
            }
            _ => Ok(BezPath::new()),
        }
    }
}

fn ellipse([x, y]: [f64; 2], [rx, ry]: [f64; 2]) -> BezPath {
    let mut path = BezPath::new();
    if rx > 0.0 && ry > 0.0 {
        let ends = [Point::new(x + rx, y), Point::new(x - rx, y)];
        path.move_to(ends[0]);
        arc(&mut path, ends[0], ends[1], [rx, ry], 0.0, [false, true]);
        arc(&mut path, ends[1], ends[0], [rx, ry], 0.0, [false, true]);
        path.close_path();
    }
    path
}

fn rectangle([x, y]: [f64; 2], [w, h]: [f64; 2], [rx, ry]: [f64; 2]) -> BezPath {
    let mut path = BezPath::new();
    if w <= 0.0 || h <= 0.0 {
        return path;
    }
    path.move_to((x + rx, y));
    let corners = [((x + w - rx, y), (x + w, y + ry)), ((x + w, y + h - ry), (x + w - rx, y + h)), ((x + rx, y + h), (x, y + h - ry)), ((x, y + ry), (x + rx, y))];
    for (from, to) in corners {
        path.line_to(from);
        if rx > 0.0 && ry > 0.0 {
            arc(&mut path, from.into(), to.into(), [rx, ry], 0.0, [false, true]);
        }
    }
    path.close_path();
    path
}

/// From the lengths of a view to those of a rectangle of this size that shows it (SVG 1.1, § 7.8).
fn fitted(view: ViewBox, size: [f64; 2], ratio: AspectRatio) -> Affine {
    let [x, y] = [size[0] / view.w, size[1] / view.h];
    if ratio.align == Align::None {
        return Affine::scale_non_uniform(x, y) * Affine::translate((-view.x, -view.y));
    }
    let scale = if ratio.slice { x.max(y) } else { x.min(y) };
    let [left, below] = [size[0] - scale * view.w, size[1] - scale * view.h];
    let (along, up) = match ratio.align {
        Align::None | Align::XMinYMin => (0.0, 0.0),
        Align::XMidYMin => (0.5, 0.0),
        Align::XMaxYMin => (1.0, 0.0),
        Align::XMinYMid => (0.0, 0.5),
        Align::XMidYMid => (0.5, 0.5),
        Align::XMaxYMid => (1.0, 0.5),
        Align::XMinYMax => (0.0, 1.0),
        Align::XMidYMax => (0.5, 1.0),
        Align::XMaxYMax => (1.0, 1.0),
    };
    Affine::translate((along * left, up * below)) * Affine::scale(scale) * Affine::translate((-view.x, -view.y))
}
