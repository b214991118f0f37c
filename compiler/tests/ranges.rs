//! The ranges that the prelude claims of its noises: the most that any choice at the corners of a cell gives, at the best of its places.

use surefoot_compiler::reference_text::{CHAPTERS, entries};
use surefoot_compiler::random::Random;
use surefoot_compiler::{MemoryLoader, Options, compile};

fn fade(t: f64) -> f64 {
    t * t * t * (t * (6.0 * t - 15.0) + 10.0)
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    (0..3).map(|i| a[i] * b[i]).sum()
}

fn minus(a: [f64; 3], b: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| a[i] - b[i])
}

/// The most that a gradient from the middle of a cube to that of an edge gives: the two longest components.
fn edge(d: [f64; 3]) -> f64 {
    let sizes = d.map(f64::abs);
    sizes.iter().sum::<f64>() - sizes.into_iter().fold(f64::INFINITY, f64::min)
}

/// The most that a unit gradient gives in the plane.
fn plane(d: [f64; 3]) -> f64 {
    d[0].hypot(d[1])
}

fn perlin(v: [f64; 3], dimensions: usize, most: fn([f64; 3]) -> f64) -> f64 {
    let f = [0, 1, 2].map(|i| if i < dimensions { v[i] - v[i].floor() } else { 0.0 });
    let corners = (0..1 << dimensions).map(|c: usize| [0, 1, 2].map(|i| f64::from(u8::from(c >> i & 1 == 1))));
    let weight = |c: [f64; 3]| -> f64 { (0..dimensions).map(|i| if c[i] > 0.0 { fade(f[i]) } else { 1.0 - fade(f[i]) }).product() };
    corners.map(|c| weight(c) * most(minus(f, c))).sum()
}

fn bell(d: [f64; 3], most: fn([f64; 3]) -> f64) -> f64 {
    (0.5 - dot(d, d)).max(0.0).powi(4) * most(d)
}

fn simplex3(v: [f64; 3]) -> f64 {
    let skew = v.iter().sum::<f64>() / 3.0;
    let i = v.map(|x| (x + skew).floor());
    let back = i.iter().sum::<f64>() / 6.0;
    let a = [0, 1, 2].map(|k| v[k] - i[k] + back);
    let mut order = [0, 1, 2];
    order.sort_by(|&x: &usize, &y: &usize| a[y].total_cmp(&a[x]));
    let corner = |n: usize| [0, 1, 2].map(|k| f64::from(u8::from(order[..n].contains(&k))) - n as f64 / 6.0);
    (0..4).map(|n| bell(minus(a, corner(n)), edge)).sum()
}

fn simplex2(v: [f64; 3]) -> f64 {
    let (skew, back) = ((3f64.sqrt() - 1.0) / 2.0, (3.0 - 3f64.sqrt()) / 6.0);
    let i = [v[0], v[1]].map(|x| (x + (v[0] + v[1]) * skew).floor());
    let a = [0, 1].map(|k| v[k] - i[k] + (i[0] + i[1]) * back);
    let first = if a[0] >= a[1] { [1.0, 0.0] } else { [0.0, 1.0] };
    let corners = [[0.0, 0.0], [first[0] - back, first[1] - back], [1.0 - 2.0 * back; 2]];
    corners.iter().map(|c| bell([a[0] - c[0], a[1] - c[1], 0.0], plane)).sum()
}

/// The largest value found: from many places uphill.
fn largest(value: impl Fn([f64; 3]) -> f64) -> f64 {
    let mut random = Random(7);
    let mut best: Vec<(f64, [f64; 3])> = (0..40_000).map(|_| random.within(2.0)).map(|v| (value(v), v)).collect();
    best.sort_by(|a, b| b.0.total_cmp(&a.0));
    best.truncate(40);
    for (most, at) in &mut best {
        let mut stride = 0.1;
        for _ in 0..4_000 {
            let by = random.within(1.0);
            let next = [0, 1, 2].map(|i| at[i] + stride * by[i]);
            if value(next) > *most {
                (*most, *at) = (value(next), next);
            } else {
                stride = f64::max(0.995 * stride, 1e-9);
            }
        }
    }
    best.into_iter().map(|(most, _)| most).fold(0.0, f64::max)
}

#[test]
fn no_noise_can_leave_the_range_that_it_claims() {
    let found = [
        ("perlin in space", 0.964 * largest(|v| perlin(v, 3, edge))),
        ("perlin in the plane", 2f64.sqrt() * largest(|v| perlin(v, 2, plane))),
        ("simplex in space", 76.8 * largest(simplex3)),
        ("simplex in the plane", 99.2 * largest(simplex2)),
    ];
    for (name, most) in found {
        println!("{name} {most:.9}");
        assert!(most <= 1.0 + 1e-9 && most > 0.99, "{name} reaches {most}");
    }
}

/// Every claim of a range is one that is known here, and what is drawn with it has a box that is hardly larger than it is.
#[test]
fn what_is_made_of_noise_has_a_box() {
    // The two steps are polynomials that rise from 0 to 1 over a number kept between these.
    let claiming = |name: &str| ["perlin", "value_noise", "simplex", "cellular", "random_balls", "smoothstep", "smootherstep"].contains(&name);
    for entry in CHAPTERS.iter().flat_map(|(name, _, text)| entries(name, text)) {
        let claims = entry.claim.as_deref().is_some_and(|c| c.contains(".."));
        assert_eq!(claims, claiming(&entry.name), "{}", entry.name);
    }
    for noise in ["perlin(3 * p)", "value_noise(3 * p)", "simplex(3 * p)", "cellular(3 * p)", "fbm(3 * p)", "perlin(3 * p.xy)", "simplex(3 * p.xy)", "random_balls(3 * p)"] {
        let loader = MemoryLoader::new().with("main.sdf", format!("scene = sphere(0.8).displace(0.15 * {noise})\n"));
        let scene = compile(&loader, "main.sdf", &Options::default()).compiled.unwrap();
        let [low, high] = scene.bounds().expect(noise);
        assert!(low.iter().all(|x| (-1.1..=-0.7).contains(x)) && high.iter().all(|x| (0.7..=1.1).contains(x)), "{noise}: {low:?} {high:?}");
    }
}

/// What one shape becomes another by is a share of both, so it is where they are.
#[test]
fn what_is_mixed_by_a_step_is_where_its_parts_are() {
    for step in ["smoothstep(-1, 1, p.y)", "smootherstep(-1, 1, p.y + 0.3 * sin(p.x))"] {
        let loader = MemoryLoader::new().with("main.sdf", format!("scene = mix(sphere(1), box(1.5), {step})\n"));
        let scene = compile(&loader, "main.sdf", &Options::default()).compiled.unwrap();
        let factors: Vec<f64> = scene.graph.factors.iter().map(|f| f.lipschitz).collect();
        assert!(!factors.is_empty() && factors.iter().all(|f| *f < 3.0), "{step}: {factors:?}");
        let [low, high] = scene.bounds().expect(step);
        assert!(low.iter().all(|x| (-1.1..=-0.7).contains(x)) && high.iter().all(|x| (0.7..=1.1).contains(x)), "{step}: {low:?} {high:?}");
    }
}
