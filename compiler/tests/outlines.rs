//! Drawings with outlines of curves: distances, sides, letters and paths.

use surefoot_compiler::diagnostic::Severity;
use surefoot_compiler::outline::{Align, Curve, Fill, Nearest, Outline, Typesetting, Vec2, boundary, path, svg, typeset};
use surefoot_compiler::random::Random;
use surefoot_compiler::{Compiled, MemoryLoader, Options, Outcome, compile};

const SETTING: Typesetting = Typesetting { size: 1.0, align: Align::Left, spacing: 0.0, leading: 1.2 };

fn outcome(text: &str) -> Outcome {
    compile(&MemoryLoader::new().with("main.sdf", text), "main.sdf", &Options::default())
}

fn compiled(text: &str) -> Compiled {
    let outcome = outcome(text);
    assert!(!outcome.has_errors(), "{text}: {:?}", outcome.diagnostics);
    outcome.compiled.expect("it has no error")
}

fn number(random: &mut Random, from: f64, to: f64) -> f64 {
    from + (to - from) * random.next()
}

fn within(random: &mut Random, [low, high]: [Vec2; 2], margin: f64) -> Vec2 {
    [0, 1].map(|i| number(random, low[i] - margin, high[i] + margin))
}

fn distance(a: Vec2, b: Vec2) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

/// The least way to many points of some curves: too long by at most what lies between two of them.
fn plain<'a>(curves: impl Iterator<Item = &'a Curve>, q: Vec2) -> f64 {
    let points = curves.flat_map(|curve| (0..=400).map(move |i| curve.at(f64::from(i) / 400.0)));
    points.fold(f64::INFINITY, |least, p| least.min(distance(p, q)))
}

fn outline(contours: &[Vec<Curve>], fill: Fill) -> Outline {
    Outline::new(boundary(contours, fill).unwrap()).expect("it has an outline")
}

/// Distances, sides and slopes against the plain method at random places.
fn holds(name: &str, contours: &[Vec<Curve>], fill: Fill, count: usize) {
    let outline = outline(contours, fill);
    let bounds = outline.bounds();
    let size = distance(bounds[0], bounds[1]);
    let mut random = Random(7);
    let boundary: Vec<Curve> = boundary(contours, fill).unwrap().iter().map(|piece| piece.curve).collect();
    let mut places = Vec::new();
    for _ in 0..count {
        // Within the cells.
        let q = within(&mut random, bounds, 0.4 * (bounds[1][0] - bounds[0][0]).min(bounds[1][1] - bounds[0][1]));
        let winding: i32 = contours.iter().flatten().map(|curve| curve.winding(q)).sum();
        let inside = if fill == Fill::NonZero { winding != 0 } else { winding % 2 != 0 };
        let near = outline.at(q);
        let way = plain(boundary.iter(), q);
        assert!((near.value.abs() - way).abs() < 1e-3 * size, "{name}: {q:?} is {way} away, not {}", near.value);
        assert!(near.value.abs() <= way + 1e-6 * size, "{name}: {q:?} is {way} away, not {}", near.value);
        // Places are rounded to a four-millionth of the drawing.
        if near.value.abs() > 2e-6 * size {
            assert_eq!(near.value < 0.0, inside, "{name}: the side of {q:?}, at {}", near.value);
            assert!((near.gradient[0].hypot(near.gradient[1]) - 1.0).abs() < 1e-5, "{name}: {q:?} {near:?}");
        }
        places.push((q, near.value));
    }
    for pair in places.windows(2) {
        let way = distance(pair[0].0, pair[1].0);
        assert!((pair[0].1 - pair[1].1).abs() <= way + 1e-6 * size, "{name}: {pair:?}");
    }
    // Beyond the cells too, values change no faster than the way, and are no longer than it.
    for _ in 0..count {
        let (a, b) = (within(&mut random, bounds, 5.0 * size), within(&mut random, bounds, 5.0 * size));
        let (at, to) = (outline.at(a), outline.at(b));
        assert!((at.value - to.value).abs() <= distance(a, b) * (1.0 + 1e-6), "{name}: {a:?} {b:?}");
        let turn = [1e-6 * size, 0.0];
        let beside = outline.at([a[0] + turn[0], a[1]]);
        assert!((beside.value - at.value - turn[0] * at.gradient[0]).abs() < 1e-8 * size || at.value < 0.2 * size, "{name}: the slope at {a:?}");
        // What is certain of a rectangle.
        let (low, high) = ([a[0].min(b[0]), a[1].min(b[1])], [a[0].max(b[0]), a[1].max(b[1])]);
        let [least, most] = outline.value_within(low, high);
        let q = [number(&mut random, low[0], high[0]), number(&mut random, low[1], high[1])];
        let Nearest { value, .. } = outline.at(q);
        assert!(least <= value && value <= most, "{name}: {value} at {q:?} is not in {least}..{most}");
    }
}

/// Slopes within small rectangles, which may lie on the outline and at its corners.
fn slopes_hold(name: &str, outline: &Outline) {
    let mut random = Random(5);
    let bounds = outline.bounds();
    let size = distance(bounds[0], bounds[1]);
    let mut narrow = 0;
    for _ in 0..2000 {
        let half = size * 10f64.powf(-1.0 - 4.0 * random.next());
        let middle = within(&mut random, bounds, 0.0);
        let (low, high) = (middle.map(|c| c - half), middle.map(|c| c + half));
        let slopes = outline.gradient_within(low, high);
        narrow += usize::from(slopes.iter().any(|[a, b]| b - a < 0.5));
        for _ in 0..5 {
            let q = [number(&mut random, low[0], high[0]), number(&mut random, low[1], high[1])];
            let near = outline.at(q);
            // At the outline itself its direction is rounded.
            let holds = (0..2).all(|i| slopes[i][0] - 1e-4 <= near.gradient[i] && near.gradient[i] <= slopes[i][1] + 1e-4);
            assert!(holds || near.value.abs() < 1e-5 * size, "{name}: {near:?} at {q:?} is not in {slopes:?} of {low:?} {high:?}");
        }
    }
    assert!(narrow > 500, "{name}: something is known of {narrow} rectangles");
}

#[test]
fn slopes_lie_within_their_intervals() {
    let star = path("M 0 -1 L 0.588 0.809 L -0.951 -0.309 L 0.951 -0.309 L -0.588 0.809 Z").unwrap();
    slopes_hold("star", &outline(&star, Fill::NonZero));
    let curves = path("M 0 0 C 1 2 3 -2 4 0 S 6 3 4 4 Q 2 6 0 4 T 0 0 Z").unwrap();
    slopes_hold("curves", &outline(&curves, Fill::EvenOdd));
    slopes_hold("words", &Outline::new(typeset("Sure", None, &SETTING).unwrap()).unwrap());
}

#[test]
fn the_nearest_place_of_a_gentle_curve_is_found() {
    let mut random = Random(3);
    let mut worst: f64 = 0.0;
    for _ in 0..1000 {
        let [a, b, c] = [0; 3].map(|_| [number(&mut random, -1.0, 1.0), number(&mut random, -1.0, 1.0)]);
        for part in (Curve { a, b, c }).gentle() {
            for _ in 0..3 {
                let q = [number(&mut random, -2.0, 2.0), number(&mut random, -2.0, 2.0)];
                let (t, squared) = part.nearest(q);
                assert!((distance(part.at(t), q) - squared.sqrt()).abs() < 1e-9);
                worst = worst.max(squared.sqrt() - plain([part].iter(), q));
            }
        }
    }
    assert!(worst < 1e-6, "a place was taken that is {worst} farther than the nearest");
}

#[test]
fn paths_bound_what_they_fill() {
    let shapes = [
        ("square", "M 0 0 H 1 V 1 H 0 Z"),
        ("ring", "M 0 0 H 4 V 4 H 0 Z M 1 1 V 3 H 3 V 1 Z"),
        ("curves", "M 0 0 C 1 2 3 -2 4 0 S 6 3 4 4 Q 2 6 0 4 T 0 0 Z"),
        ("arcs", "M 0 0 A 2 1 30 1 1 3 1 A 1 1 0 0 0 0 0 Z"),
        ("star", "M 0 -1 L 0.588 0.809 L -0.951 -0.309 L 0.951 -0.309 L -0.588 0.809 Z"),
        ("two that overlap", "M 0 0 H 2 V 2 H 0 Z M 1 1 H 3 V 3 H 1 Z"),
        ("two that share a side", "M 0 0 H 2 V 2 H 0 Z M 2 0.5 H 3 V 1.5 H 2 Z"),
        ("one that is there twice", "M 0 0 H 2 V 2 H 0 Z M 0 0 H 2 V 2 H 0 Z"),
        ("needle", "M 0 0 L 3 0.05 L 0 0.1 L 2 1 Z"),
    ];
    for (name, data) in shapes {
        let contours = path(data).unwrap();
        for fill in [Fill::NonZero, Fill::EvenOdd] {
            if name == "one that is there twice" && fill == Fill::EvenOdd {
                assert!(boundary(&contours, fill).unwrap().is_empty());
                continue;
            }
            holds(&format!("{name}, {fill:?}"), &contours, fill, 300);
        }
    }
}

#[test]
fn random_paths_bound_what_they_fill() {
    let mut random = Random(11);
    for i in 0..60 {
        let mut contour = Vec::new();
        let count = 3 + (random.next() * 5.0) as usize;
        let points: Vec<Vec2> = (0..2 * count).map(|_| [number(&mut random, -1.0, 1.0), number(&mut random, -1.0, 1.0)]).collect();
        for at in 0..count {
            let (a, b, c) = (points[2 * at], points[2 * at + 1], points[(2 * at + 2) % (2 * count)]);
            contour.push(Curve { a, b, c });
        }
        holds(&format!("path {i}"), &[contour], if i % 2 == 0 { Fill::NonZero } else { Fill::EvenOdd }, 60);
    }
}

#[test]
fn every_letter_of_the_font_has_its_sides() {
    let all: Vec<char> = (0x21..0x17f).chain(0x391..0x3ff).chain(0x400..0x45f).filter_map(char::from_u32).collect();
    let mut set = 0;
    for letter in all {
        let Ok(pieces) = typeset(&letter.to_string(), None, &SETTING) else { continue };
        let Some(outline) = Outline::new(pieces.clone()) else { continue };
        set += 1;
        // Each end of a piece is the start of another one.
        for piece in &pieces {
            assert!(pieces.iter().any(|next| next.curve.a == piece.curve.c), "{letter}: the outline is open at {:?}", piece.curve.c);
        }
        let mut random = Random(u64::from(u32::from(letter)));
        for _ in 0..40 {
            let q = within(&mut random, outline.bounds(), 0.2);
            let winding: i32 = pieces.iter().map(|piece| piece.curve.winding(q)).sum();
            let value = outline.at(q).value;
            assert!(value.abs() < 1e-6 || (value < 0.0) == (winding == 1), "{letter}: {q:?} at {value}, wound around {winding} times");
        }
    }
    assert!(set > 500, "the font has {set} letters");
}

#[test]
fn words_stand_where_they_are_set() {
    let bounds = |words: &str, setting: Typesetting| Outline::new(typeset(words, None, &setting).unwrap()).unwrap().bounds();
    let [low, high] = bounds("Hx", SETTING);
    // Capitals of the font are 0.73 high.
    assert!(low[1].abs() < 1e-3 && (high[1] - 0.73).abs() < 0.01 && low[0] > 0.0, "{low:?} {high:?}");
    let [low, high] = bounds("Hx", Typesetting { align: Align::Center, ..SETTING });
    assert!((low[0] + high[0]).abs() < 0.2 && low[0] < -0.5, "{low:?} {high:?}");
    let [_, high] = bounds("Hx", Typesetting { align: Align::Right, ..SETTING });
    assert!(high[0] <= 0.0 && high[0] > -0.1, "{high:?}");
    let wide = |setting| bounds("Hxx", setting)[1][0];
    assert!((wide(Typesetting { spacing: 0.1, ..SETTING }) - wide(SETTING) - 0.2).abs() < 1e-6);
    assert!((wide(Typesetting { size: 2.0, spacing: 0.1, ..SETTING }) - 2.0 * wide(Typesetting { spacing: 0.1, ..SETTING })).abs() < 1e-6);
    let [low, _] = bounds("H\nH", SETTING);
    assert!((low[1] + 1.2).abs() < 1e-3, "{low:?}");
    // A pair that the font sets closer.
    let [a, v, both] = ["A", "V", "AV"].map(|words| bounds(words, SETTING));
    assert!(both[1][0] - both[0][0] < (a[1][0] - a[0][0]) + (v[1][0] - v[0][0]), "no kerning");
}

#[test]
fn a_book_is_set_in_a_moment() {
    let words = "The quick brown fox jumps over the lazy dog.\n".repeat(60);
    let pieces = typeset(&words, None, &SETTING).unwrap();
    let outline = Outline::new(pieces).unwrap();
    // Few pieces matter for a place, so that little is held for each.
    assert!(outline.pieces() > 40_000 && outline.bytes() < 400 * outline.pieces(), "{} pieces, {} bytes", outline.pieces(), outline.bytes());
}

#[test]
fn a_text_is_proven_with_a_factor_of_one() {
    let scene = compiled("scene = text(\"Surefoot\").extrude(0.3)");
    assert_eq!(scene.graph.factors.len(), 0, "a text needs no factor");
    let bounds = scene.bounds().unwrap();
    assert!(bounds[0][1] > -0.2 && bounds[1][1] < 0.85 && bounds[1][0] < 6.0 && bounds[0][2] >= -0.16, "{bounds:?}");
    // Nothing to set is nothing.
    compiled("scene = text(\" \").extrude(0.3) | sphere(1)");
}

#[test]
fn what_is_no_text_or_path_is_an_error_with_advice() {
    for (text, words) in [
        ("scene = text(3).extrude(1)", "a text is needed here"),
        ("scene = text(\"a\", align: \"middle\").extrude(1)", "no alignment `middle`"),
        ("scene = text(\"a\", size: 0).extrude(1)", "above zero"),
        ("scene = text(\"a\", font: \"none.ttf\").extrude(1)", "can't be read"),
        ("scene = text(\"\u{6f22}\").extrude(1)", "the font has no"),
        ("scene = path(\"M 0 0 X\").extrude(1)", "no path data"),
        ("scene = path(3).extrude(1)", "a text is needed here"),
    ] {
        let found = outcome(text).diagnostics;
        let says = |d: &surefoot_compiler::diagnostic::Diagnostic| d.severity == Severity::Error && d.message.contains(words) && !d.help.is_empty();
        assert!(found.iter().any(says), "{text}: {found:?}");
    }
}

/// The drawing of an SVG whose page is 40 by 40, with its middle at the origin.
fn logo(inside: &str) -> Outline {
    let file = format!("<svg xmlns='http://www.w3.org/2000/svg' xmlns:xlink='http://www.w3.org/1999/xlink' viewBox='0 0 40 40'>{inside}</svg>");
    let logo = svg(file.as_bytes(), None).unwrap_or_else(|why| panic!("{inside}: {why:?}"));
    Outline::new(logo.pieces).unwrap_or_else(|| panic!("{inside}: nothing is drawn"))
}

#[test]
fn shapes_of_an_svg_have_their_exact_distance() {
    let disc = |[x, y]: Vec2| x.hypot(y) - 10.0;
    let corner = |x: f64, y: f64| x.max(0.0).hypot(y.max(0.0)) + x.max(y).min(0.0);
    let high = |[x, y]: Vec2| corner((x + 10.0).abs() - 6.0, (y - 8.0).abs() - 4.0);
    let round = |[x, y]: Vec2| corner(x.abs() - 6.0, y.abs() - 2.0) - 4.0;
    let cases: [(&str, &dyn Fn(Vec2) -> f64); 19] = [
        ("<circle cx='20' cy='20' r='10'/>", &disc),
        ("<ellipse cx='20' cy='20' rx='10' ry='10'/>", &disc),
        ("<circle cx='50%' cy='50%' r='10px'/>", &disc),
        ("<path d='M 10 20 A 10 10 0 1 1 30 20 A 10 10 0 0 1 10 20 Z'/>", &disc),
        ("<path d='m10 20a10 10 0 1130 0 10 10 0 01-30 0z' transform='translate(5 0) scale(0.6666666666667 1) translate(-2.5 0)' display='none'/><circle cx='20' cy='20' r='10'/>", &disc),
        ("<g transform='translate(20 20)'><g transform='rotate(30) scale(2)'><circle r='5'/></g></g>", &disc),
        ("<defs><circle id='c' r='10'/></defs><use xlink:href='#c' x='20' y='20'/>", &disc),
        ("<symbol id='s' viewBox='0 0 2 2'><circle cx='1' cy='1' r='1'/></symbol><use href='#s' x='10' y='10' width='20' height='20'/>", &disc),
        ("<svg x='10' y='10' width='20' height='20' viewBox='0 0 4 4'><circle cx='2' cy='2' r='2'/></svg>", &disc),
        ("<clipPath id='k'><circle cx='20' cy='20' r='10'/></clipPath><rect width='40' height='40' clip-path='url(#k)'/>", &disc),
        ("<circle cx='20' cy='20' r='10'/><circle cx='22' cy='20' r='7' transform='matrix(-1 0 0 1 40 0)'/>", &disc),
        ("<style>.a { fill: none } circle.b { fill: red }</style><rect class='a' width='9' height='9'/><circle class='b' fill='none' cx='20' cy='20' r='10'/>", &disc),
        ("<g style='fill: none'><rect width='9' height='9'/><circle style='fill: #fff' cx='20' cy='20' r='10'/></g>", &disc),
        ("<rect width='9' height='9' visibility='hidden'/><rect width='9' height='9' opacity='0'/><circle cx='20' cy='20' r='10'/>", &disc),
        ("<rect x='4' y='8' width='12' height='8'/>", &high),
        ("<polygon points='4,8 16,8 16,16 4,16'/>", &high),
        ("<path d='M4 8h12v8H4z'/>", &high),
        ("<path d='M4 8h12v8h-12M10 10h2v2h-2z'/>", &high),
        ("<rect x='10' y='14' width='20' height='12' rx='4'/>", &round),
    ];
    let mut random = Random(3);
    for (inside, exact) in cases {
        let outline = logo(inside);
        for _ in 0..400 {
            let q = within(&mut random, [[-18.0; 2], [18.0; 2]], 0.0);
            let (found, way) = (outline.at(q).value, exact(q));
            // Far outside, and inside of several that lie on each other, it is no more than the distance.
            assert!((found - way).abs() < 4e-4 || way > 3.0 && found > 0.5 * way && found < way + 4e-4, "{inside}: {q:?} is {way} away, not {found}");
        }
    }
}

#[test]
fn fills_of_an_svg_follow_their_rules() {
    const STAR: &str = "M20 2 L31 36 L2 15 L38 15 L9 36 Z";
    for (inside, middle) in [
        (format!("<path d='{STAR}'/>"), true),
        (format!("<path fill-rule='evenodd' d='{STAR}'/>"), false),
        (format!("<g fill-rule='evenodd'><path d='{STAR}'/><path style='fill-rule:nonzero' d='{STAR}'/></g>"), true),
        // What one path leaves open another one fills, whichever way it goes around.
        (format!("<path fill-rule='evenodd' d='{STAR}'/><circle cx='20' cy='21' r='9' transform='translate(40 0) scale(-1 1)'/>"), true),
        (format!("<clipPath id='k'><path clip-rule='evenodd' d='{STAR}'/></clipPath><rect width='40' height='40' clip-path='url(#k)'/>"), false),
    ] {
        assert_eq!(logo(&inside).at([0.0, -1.0]).value < 0.0, middle, "{inside}");
    }
}

#[test]
fn an_svg_has_the_size_that_is_asked_for() {
    let file = |head: &str| format!("<svg xmlns='http://www.w3.org/2000/svg' {head}><rect x='2' y='2' width='10' height='6'/></svg>");
    for (head, size, low, high) in [
        ("viewBox='0 0 24 12'", None, [-10.0, -2.0], [0.0, 4.0]),
        ("viewBox='0 0 24 12' width='10mm'", Some(2.0), [-10.0 / 6.0, -2.0 / 6.0], [0.0, 4.0 / 6.0]),
        ("width='24' height='12'", None, [-10.0, -2.0], [0.0, 4.0]),
        ("", None, [-5.0, -3.0], [5.0, 3.0]),
        ("", Some(3.0), [-2.5, -1.5], [2.5, 1.5]),
    ] {
        let bounds = Outline::new(svg(file(head).as_bytes(), size).unwrap().pieces).unwrap().bounds();
        assert!(distance(bounds[0], low) + distance(bounds[1], high) < 1e-4, "{head}: {bounds:?}");
    }
}

#[test]
fn an_svg_is_proven_with_a_factor_of_one() {
    let file = "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 2 2'><path d='M0 0C1 3 2 -1 2 2Z'/><path stroke='red' fill='none' d='M0 0H2'/></svg>";
    let loader = MemoryLoader::new().with("art/main.sdf", "scene = svg(\"logo.svg\", size: 1).extrude(0.3)").with("art/logo.svg", file);
    let outcome = compile(&loader, "art/main.sdf", &Options::default());
    assert!(!outcome.has_errors(), "{:?}", outcome.diagnostics);
    let said: Vec<&str> = outcome.diagnostics.iter().map(|d| d.message.as_str()).collect();
    assert!(said.iter().any(|words| words.contains("`art/logo.svg`, line 1, column 89")), "{said:?}");
    assert_eq!(outcome.compiled.unwrap().graph.factors.len(), 0);
}
