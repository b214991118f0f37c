//! Path data, as SVG writes it, as contours.

use super::curve::{Curve, Vec2};
use kurbo::{Arc, BezPath, CubicBez, PathEl, Point, Shape, SvgArc};
use svgtypes::{PathParser, PathSegment};

/// Curves of the third degree and arcs are taken as ones of the second that are off by at most so much of the path's size.
pub const OFF: f64 = 1e-5;

fn place(p: Point) -> Vec2 {
    [p.x, p.y]
}

/// The closed contours of path data (SVG 2, § 9.3); what is open is closed by a straight line. There y points down, and up in these.
pub fn path(data: &str) -> Result<Vec<Vec<Curve>>, String> {
    Ok(contours(&(kurbo::Affine::FLIP_Y * self::data(data)?)))
}

/// Path data as a path, y downward.
pub(super) fn data(said: &str) -> Result<BezPath, String> {
    let mut path = BezPath::new();
    let (mut first, mut at) = (Point::ZERO, Point::ZERO);
    // Where a curve came from, for a smooth one that follows: of the third degree, and of the second.
    let (mut cubic, mut quadratic) = (Point::ZERO, Point::ZERO);
    for segment in PathParser::from(said) {
        let segment = segment.map_err(|error| error.to_string())?;
        let from = |abs: bool| if abs { Point::ZERO } else { at };
        let place = |abs: bool, x: f64, y: f64| from(abs) + kurbo::Vec2::new(x, y);
        let mirrored = |by: Point| at + (at - by);
        if path.elements().last() == Some(&PathEl::ClosePath) && !matches!(segment, PathSegment::MoveTo { .. } | PathSegment::ClosePath { .. }) {
            path.move_to(at);
        }
        let (mut by, mut and) = (None, None);
        let to = match segment {
            PathSegment::MoveTo { abs, x, y } => {
                first = place(abs, x, y);
                path.move_to(first);
                first
            }
            PathSegment::LineTo { abs, x, y } => line(&mut path, place(abs, x, y)),
            PathSegment::HorizontalLineTo { abs, x } => line(&mut path, Point::new(from(abs).x + x, at.y)),
            PathSegment::VerticalLineTo { abs, y } => line(&mut path, Point::new(at.x, from(abs).y + y)),
            PathSegment::CurveTo { abs, x1, y1, x2, y2, x, y } => {
                let (start, end, to) = (place(abs, x1, y1), place(abs, x2, y2), place(abs, x, y));
                path.curve_to(start, end, to);
                by = Some(end);
                to
            }
            PathSegment::SmoothCurveTo { abs, x2, y2, x, y } => {
                let (end, to) = (place(abs, x2, y2), place(abs, x, y));
                path.curve_to(mirrored(cubic), end, to);
                by = Some(end);
                to
            }
            PathSegment::Quadratic { abs, x1, y1, x, y } => {
                let (corner, to) = (place(abs, x1, y1), place(abs, x, y));
                path.quad_to(corner, to);
                and = Some(corner);
                to
            }
            PathSegment::SmoothQuadratic { abs, x, y } => {
                let (corner, to) = (mirrored(quadratic), place(abs, x, y));
                path.quad_to(corner, to);
                and = Some(corner);
                to
            }
            PathSegment::EllipticalArc { abs, rx, ry, x_axis_rotation, large_arc, sweep, x, y } => {
                let to = place(abs, x, y);
                arc(&mut path, at, to, [rx, ry], x_axis_rotation.to_radians(), [large_arc, sweep]);
                to
            }
            PathSegment::ClosePath { .. } => {
                path.close_path();
                first
            }
        };
        at = to;
        (cubic, quadratic) = (by.unwrap_or(at), and.unwrap_or(at));
    }
    Ok(path)
}

fn line(path: &mut BezPath, to: Point) -> Point {
    path.line_to(to);
    to
}

/// Goes on along an arc of an ellipse, turned by an angle (SVG 2, § 9.5.1): the larger one or not, with the angles or against them. Where there is none, straight.
pub(super) fn arc(path: &mut BezPath, from: Point, to: Point, [rx, ry]: [f64; 2], turned: f64, [large_arc, sweep]: [bool; 2]) {
    let said = SvgArc { from, to, radii: kurbo::Vec2::new(rx, ry), x_rotation: turned, large_arc, sweep };
    let Some(arc) = Arc::from_svg_arc(&said).filter(|arc| arc.center.is_finite() && arc.radii.is_finite()) else { return path.line_to(to) };
    // It ends where it is said to, not where the last sine of an angle is.
    let mut curves: Vec<[Point; 3]> = Vec::new();
    arc.to_cubic_beziers(0.1 * OFF * arc.radii.x.max(arc.radii.y), |a, b, c| curves.push([a, b, c]));
    if let Some([_, _, end]) = curves.last_mut() {
        *end = to;
    }
    curves.into_iter().for_each(|[a, b, c]| path.curve_to(a, b, c));
}

/// The closed contours of a path.
pub fn contours(path: &BezPath) -> Vec<Vec<Curve>> {
    let bounds = path.bounding_box();
    let off = OFF * bounds.width().max(bounds.height());
    let mut all: Vec<Vec<Curve>> = Vec::new();
    let mut contour: Vec<Curve> = Vec::new();
    let (mut first, mut at) = (Point::ZERO, Point::ZERO);
    let mut close = |contour: &mut Vec<Curve>, at: Point, first: Point| {
        if at != first {
            contour.push(Curve::line(place(at), place(first)));
        }
        if !contour.is_empty() {
            all.push(std::mem::take(contour));
        }
    };
    for element in path.elements() {
        match *element {
            PathEl::MoveTo(to) => {
                close(&mut contour, at, first);
                (first, at) = (to, to);
            }
            PathEl::LineTo(to) => {
                contour.push(Curve::line(place(at), place(to)));
                at = to;
            }
            PathEl::QuadTo(by, to) => {
                contour.push(Curve { a: place(at), b: place(by), c: place(to) });
                at = to;
            }
            PathEl::CurveTo(by, and, to) => {
                let cubic = CubicBez::new(at, by, and, to);
                contour.extend(cubic.to_quads(off).map(|(_, _, part)| Curve { a: place(part.p0), b: place(part.p1), c: place(part.p2) }));
                at = to;
            }
            PathEl::ClosePath => {
                close(&mut contour, at, first);
                at = first;
            }
        }
    }
    close(&mut contour, at, first);
    all
}
