//! Path data, as SVG writes it, as contours.

use super::curve::{Curve, Vec2};
use kurbo::{BezPath, CubicBez, PathEl, Point, Shape};

/// Curves of the third degree and arcs are taken as ones of the second that are off by at most so much of the path's size.
pub const OFF: f64 = 1e-5;

fn place(p: Point) -> Vec2 {
    [p.x, p.y]
}

/// The closed contours of path data (SVG 2, § 9.3); what is open is closed by a straight line. There y points down, and up in these.
pub fn path(data: &str) -> Result<Vec<Vec<Curve>>, String> {
    let path = BezPath::from_svg(data).map_err(|error| error.to_string())?;
    let upright = kurbo::Affine::FLIP_Y * path;
    Ok(contours(&upright))
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
