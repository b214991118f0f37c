//! `surefoot bench --light`: how much of a light's disc, and of the sky, is seen from the places of a picture, beside the truth.
//!
//! The truth of a shadow is the share of the points of the disc that are seen: a ray goes to each, in 64 bits. Some of these rays are followed by
//! certified tracing too. The truth of occlusion is the share of rays, weighted by the cosine, that meet nothing within its reach.

use crate::command::bar::LateBar;
use crate::command::console::{Exit, Failure, compile_file, print};
use crate::command::page;
use crate::picture::write_png;
use rayon::prelude::*;
use std::fmt::Write;
use std::path::Path;
use surefoot_compiler::Options;
use surefoot_compiler::certify::{Hit, Truth};
use surefoot_compiler::compiled::{Compiled, Frame, Live};
use surefoot_compiler::reference::Reference;
use surefoot_compiler::reference::area::{Part, on_disc, toward};
use surefoot_compiler::camera::Basis;
use surefoot_compiler::reference::march::Ray;
use surefoot_compiler::reference::shade::{Lamp, Seen, Shading};
use surefoot_compiler::vector::{add, scale};

/// Width and height of the pictures.
const SIZE: (u32, u32) = (128, 72);
/// Points of a disc, and rays to the sky, that make the truth.
const POINTS: u32 = 256;
/// Pictures that make a still.
const STILL: u32 = 256;
/// One of so many of the truth's rays is followed by certified tracing, with at most so many boxes.
const CERTIFIED: usize = 997;
const BOXES: usize = 5_000;
/// Rays that are led together.
const TOGETHER: usize = 256;
/// The half side of the square whose mean is no ripple.
const AROUND: i64 = 4;

/// An estimate beside the truth.
#[derive(Clone, Copy, Debug, Default)]
struct Apart {
    /// The mean difference, without its sign.
    mean: f64,
    /// The root mean square of the difference less its mean over 9 × 9 pixels.
    ripple: f64,
}

/// A light of a scene, judged.
struct Row {
    live: Apart,
    still: Apart,
    /// The root mean square of half the difference between the two halves of the truth's rays.
    noise: f64,
    /// Rays of which certified tracing knows what becomes of them, and those of which the truth says something else.
    certified: (usize, usize),
    places: usize,
}

/// Measures and prints; with a page, writes the table there and the pictures into a folder `light` beside it.
pub fn run(scenes: &[String], page: Option<&Path>) -> Result<Exit, Failure> {
    let bar = LateBar::new();
    let mut table = String::from(
        "| scene, light | places | live: mean | ripple | still: mean | ripple | noise of the truth | certified rays, of them otherwise |\n|---|---|---|---|---|---|---|---|\n",
    );
    let mut corners = String::from("| scene | occlusion: mean | ripple |\n|---|---|---|\n");
    let mut rows = Vec::new();
    let mut occluded = Vec::new();
    for (i, path) in scenes.iter().enumerate() {
        let outcome = compile_file(path, &Options::default())?;
        let compiled = outcome.compiled.ok_or_else(|| Failure::usage(format!("{path} does not compile")))?;
        let name = Path::new(path).file_stem().and_then(|name| name.to_str()).unwrap_or(path);
        let live = compiled.live();
        let scene = Scene::new(&compiled, &live).map_err(Failure::usage)?;
        for (number, lamp) in scene.shading.lamps.iter().enumerate().filter(|(_, lamp)| lamp.softness > 0.0) {
            let Some((row, pictures)) = scene.shadow(&compiled, &live, lamp).map_err(Failure::usage)? else { continue };
            let _ = writeln!(
                table,
                "| {name}, {} | {} | {:.3} | {:.3} | {:.4} | {:.4} | {:.4} | {}, {} |",
                number + 1,
                row.places,
                row.live.mean,
                row.live.ripple,
                row.still.mean,
                row.still.ripple,
                row.noise,
                row.certified.0,
                row.certified.1
            );
            if let Some(page) = page.filter(|_| path.contains("corpus/light/")) {
                let folder = page.with_file_name("light");
                std::fs::create_dir_all(&folder).map_err(|e| Failure::usage(e.to_string()))?;
                let (width, bytes) = beside(&pictures);
                write_png(&folder.join(format!("{name}.png")), width, SIZE.1, &bytes).map_err(Failure::usage)?;
            }
            rows.push(row);
        }
        if let Some(apart) = scene.occlusion() {
            let _ = writeln!(corners, "| {name} | {:.3} | {:.3} |", apart.mean, apart.ripple);
            occluded.push(apart);
        }
        bar.show((i + 1) as f64 / scenes.len() as f64);
    }
    bar.finish();
    let mean = |of: &dyn Fn(&Row) -> f64| rows.iter().map(of).sum::<f64>() / rows.len().max(1) as f64;
    let most = |of: &dyn Fn(&Row) -> f64| rows.iter().map(of).fold(0.0, f64::max);
    let _ = writeln!(
        table,
        "| **mean** | | {:.3} | {:.3} | {:.4} | {:.4} | {:.4} | |\n| **most** | | {:.3} | {:.3} | {:.4} | {:.4} | {:.4} | |",
        mean(&|r| r.live.mean),
        mean(&|r| r.live.ripple),
        mean(&|r| r.still.mean),
        mean(&|r| r.still.ripple),
        mean(&|r| r.noise),
        most(&|r| r.live.mean),
        most(&|r| r.live.ripple),
        most(&|r| r.still.mean),
        most(&|r| r.still.ripple),
        most(&|r| r.noise)
    );
    let count = occluded.len().max(1) as f64;
    let of_corners = occluded.iter().fold(Apart::default(), |sum, a| Apart { mean: sum.mean + a.mean / count, ripple: sum.ripple + a.ripple / count });
    let _ = writeln!(corners, "| **mean** | {:.3} | {:.3} |", of_corners.mean, of_corners.ripple);
    print(format!("{table}\n{corners}").as_bytes())?;
    if let Some(file) = page {
        page::put(file, "light", &text(&table, &corners))?;
    }
    Ok(Exit::Fine)
}

/// The section of a page.
fn text(table: &str, corners: &str) -> String {
    format!(
        "# Light beside the truth\n\n`surefoot bench --light examples/*.sdf tests/corpus/light/*.sdf tests/corpus/cases/emission.sdf \
         tests/corpus/cases/steep_neighbour.sdf --page docs/accuracy.md`\nwrites this page.\n\n\
         A light of `soft(k)` is a disc that is seen under the half-angle atan(1/k). The truth is the share of its points that are seen: {POINTS} rays from each\n\
         of {} × {} pixels, in 64 bits; one of {CERTIFIED} is followed by certified tracing too. *Live* is the picture's estimate, *still* the mean of {STILL}\n\
         pictures, each of which looks at a place of its own. *Ripple* is the root mean square of the difference less its mean over 9 × 9 pixels. Of places\n\
         that face the light all count.\n\n{table}\n\
         The truth, live and still of each scene of `tests/corpus/light`:\n\n{}\n\
         ## Occlusion\n\n\
         The truth is the share of {POINTS} rays, weighted by the cosine, that meet nothing within the reach. Stills have the same estimate as live pictures.\n\n{corners}",
        SIZE.0,
        SIZE.1,
        pictures()
    )
}

/// Links to the pictures.
fn pictures() -> String {
    let names = [
        "open_box", "courtyard", "grille", "overhang", "thin_rods", "steep_bodies", "holes", "low_light", "lamp_in_room", "stairs", "twisted", "carved",
    ];
    names.iter().fold(String::new(), |text, name| text + &format!("![{name}: truth, live, still](light/{name}.png)\n"))
}

/// What a picture of a scene sees.
struct Scene {
    reference: Reference,
    frame: Frame,
    shading: Shading,
    footprint: f64,
    /// Of pixels, by their numbers.
    seen: Vec<(usize, Seen)>,
}

impl Scene {
    fn new(compiled: &Compiled, live: &Live) -> Result<Self, String> {
        let reference = Reference::new(compiled, live).map_err(|e| e.to_string())?;
        let frame = compiled.frame(live);
        let camera = frame.cameras.first().map(|(_, camera)| *camera).ok_or("there is no camera")?;
        let basis = Basis::of(&camera);
        let places = (0..SIZE.1).flat_map(|y| (0..SIZE.0).map(move |x| (f64::from(x) + 0.5, f64::from(y) + 0.5)));
        let ray = |at| Ray { origin: basis.start(camera.eye, at, SIZE), direction: basis.direction(at, SIZE), t_min: 0.0, t_max: frame.max_distance };
        let rays: Vec<Ray> = places.map(ray).collect();
        let footprint = basis.footprint(SIZE.1);
        let seen = reference.seen(&rays, footprint, frame.extent);
        Ok(Self { shading: Shading::of(&frame, None), reference, frame, footprint, seen })
    }

    /// A light, judged, and pictures of the truth and of both estimates. None where it lights nothing.
    fn shadow(&self, compiled: &Compiled, live: &Live, lamp: &Lamp) -> Result<Option<(Row, [Picture; 3])>, String> {
        let mut rays = Vec::new();
        let mut of = Vec::new();
        for (pixel, seen) in &self.seen {
            let Some(arriving) = self.shading.arriving(lamp, seen.point, seen.normal) else { continue };
            let off = self.reference.off(seen.point, seen.t, self.footprint);
            let origin = add(seen.point, scale(seen.normal, off));
            rays.push(Ray { origin, direction: arriving.direction, t_min: off, t_max: arriving.far });
            of.push(*pixel);
        }
        if rays.is_empty() {
            return Ok(None);
        }
        let mean = |parts: &(dyn Fn(u32) -> Part + Sync), count: u32| -> Vec<f64> {
            let chunks = rays.par_chunks(TOGETHER).flat_map_iter(|chunk| {
                let mut sum = vec![0.0; chunk.len()];
                for sample in 0..count {
                    let lit = self.reference.lit(lamp, parts(sample), chunk, self.frame.extent);
                    sum.iter_mut().zip(lit).for_each(|(sum, lit)| *sum += lit / f64::from(count));
                }
                sum
            });
            chunks.collect()
        };
        let point = |sample: u32| Part { place: on_disc(sample), narrower: 0.0 };
        let halves = [0, 1].map(|odd| mean(&|sample| point(1 + 2 * sample + odd), POINTS / 2));
        let truth: Vec<f64> = halves[0].iter().zip(&halves[1]).map(|(a, b)| 0.5 * (a + b)).collect();
        let noise = halves[0].iter().zip(&halves[1]).map(|(a, b)| (0.5 * (a - b)).powi(2)).sum::<f64>();
        let noise = (noise / truth.len() as f64).sqrt();
        let now = mean(&|_| Part::WHOLE, 1);
        let still = mean(&Part::of, STILL);
        let pictures = [&truth, &now, &still].map(|values| Picture::of(&of, values));
        let [ideal, now, still] = &pictures;
        let certified = self.certified(compiled, live, lamp, &rays)?;
        let row = Row { live: now.apart(ideal), still: still.apart(ideal), noise, certified, places: rays.len() };
        Ok(Some((row, pictures)))
    }

    /// Some of the truth's rays by certified tracing: of how many it knows what becomes of them, and of how many of those that is something else.
    fn certified(&self, compiled: &Compiled, live: &Live, lamp: &Lamp, rays: &[Ray]) -> Result<(usize, usize), String> {
        let truth = Truth::new(compiled, live, 2_000_000).map_err(|e| e.to_string())?;
        let all = rays.len() * POINTS as usize;
        let asked: Vec<(usize, u32)> = (0..all).step_by(CERTIFIED).map(|i| (i % rays.len(), 1 + (i / rays.len()) as u32)).collect();
        let known = asked.par_iter().map_init(
            || truth.prover(),
            |prover, &(ray, sample)| {
                let ray = rays[ray];
                let softness = lamp.softness_from(ray.t_max);
                let place = on_disc(sample);
                let aimed = Ray {
                    direction: toward(ray.direction, 1.0 / softness, place),
                    t_max: self.reference.end(lamp, &ray, ray.t_min) * (1.0 + (place[0].powi(2) + place[1].powi(2)) / softness.powi(2)).sqrt(),
                    ..ray
                };
                let aimed = aimed.clip(self.frame.extent)?;
                let found = match prover.first_hit(aimed.origin, aimed.direction, 0.0, aimed.t_max, BOXES) {
                    Hit::Miss => 1.0,
                    Hit::Hit(_) => 0.0,
                    Hit::Ambiguous(_) | Hit::Exhausted(_) => return None,
                };
                let part = Part { place, narrower: 0.0 };
                Some(self.reference.lit(lamp, part, &[ray], self.frame.extent).first() == Some(&found))
            },
        );
        let known: Vec<bool> = known.flatten().collect();
        Ok((known.len(), known.iter().filter(|agrees| !**agrees).count()))
    }

    /// Occlusion, judged. None where the scene has none.
    fn occlusion(&self) -> Option<Apart> {
        let (reach, strength) = self.frame.ambient_occlusion;
        if reach <= 0.0 || strength <= 0.0 || self.seen.is_empty() {
            return None;
        }
        let (of, seen): (Vec<usize>, Vec<Seen>) = self.seen.iter().copied().unzip();
        let now = self.reference.occlusion(&seen, reach, strength);
        let truth: Vec<f64> = seen
            .par_chunks(TOGETHER)
            .flat_map_iter(|chunk| {
                let mut free = vec![0.0; chunk.len()];
                for sample in 0..POINTS {
                    let [x, y] = on_disc(sample + 1);
                    // From a disc up to the half of a ball: as many rays as the cosine is large.
                    let up = (1.0 - x * x - y * y).max(1e-6).sqrt();
                    let ray = |s: &Seen| {
                        let off = self.reference.off(s.point, s.t, self.footprint);
                        let aside = (x * x + y * y).sqrt();
                        let turned = if aside > 0.0 { [x / aside, y / aside] } else { [0.0; 2] };
                        let direction = toward(s.normal, aside / up, turned);
                        Ray { origin: add(s.point, scale(s.normal, off)), direction, t_min: off, t_max: reach }
                    };
                    let rays: Vec<Ray> = chunk.iter().map(ray).collect();
                    let lit = self.reference.shadow(&rays, 0.0, self.frame.extent);
                    free.iter_mut().zip(lit).for_each(|(free, lit)| *free += lit / f64::from(POINTS));
                }
                free.into_iter().map(move |free| (1.0 - strength * (1.0 - free)).clamp(0.0, 1.0)).collect::<Vec<f64>>()
            })
            .collect();
        Some(Picture::of(&of, &now).apart(&Picture::of(&of, &truth)))
    }
}

/// A number for each pixel, where there is one.
struct Picture(Vec<Option<f64>>);

impl Picture {
    fn of(pixels: &[usize], values: &[f64]) -> Self {
        let mut all = vec![None; (SIZE.0 * SIZE.1) as usize];
        pixels.iter().zip(values).for_each(|(pixel, value)| all[*pixel] = Some(*value));
        Self(all)
    }

    fn apart(&self, truth: &Self) -> Apart {
        let (width, height) = (i64::from(SIZE.0), i64::from(SIZE.1));
        let off: Vec<Option<f64>> = self.0.iter().zip(&truth.0).map(|(a, b)| Some((*a)? - (*b)?)).collect();
        let at = |x: i64, y: i64| off.get((y * width + x) as usize).copied().flatten().filter(|_| (0..width).contains(&x) && (0..height).contains(&y));
        let (mut count, mut sum, mut squares) = (0.0, 0.0, 0.0);
        for y in 0..height {
            for x in 0..width {
                let Some(here) = at(x, y) else { continue };
                let near: Vec<f64> =
                    (-AROUND..=AROUND).flat_map(|dy| (-AROUND..=AROUND).map(move |dx| (dx, dy))).filter_map(|(dx, dy)| at(x + dx, y + dy)).collect();
                let mean = near.iter().sum::<f64>() / near.len() as f64;
                count += 1.0;
                sum += f64::abs(here);
                squares += (here - mean).powi(2);
            }
        }
        Apart { mean: sum / f64::max(count, 1.0), ripple: (squares / f64::max(count, 1.0)).sqrt() }
    }
}

/// Pictures side by side, as grey: their width in all and their pixels. Where there is no number it is blue.
fn beside(pictures: &[Picture; 3]) -> (u32, Vec<u8>) {
    let mut bytes = Vec::new();
    for y in 0..SIZE.1 {
        for picture in pictures {
            for x in 0..SIZE.0 {
                let value = picture.0[(y * SIZE.0 + x) as usize];
                bytes.extend(value.map_or([70, 90, 130, 255], |value| {
                    let grey = (255.0 * value.clamp(0.0, 1.0)).round() as u8;
                    [grey, grey, grey, 255]
                }));
            }
        }
    }
    (3 * SIZE.0, bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_off_everywhere_has_no_ripple() {
        let pixels: Vec<usize> = (0..(SIZE.0 * SIZE.1) as usize).collect();
        let flat = |value: f64| Picture::of(&pixels, &vec![value; pixels.len()]);
        let apart = flat(0.75).apart(&flat(0.5));
        assert!((apart.mean - 0.25).abs() < 1e-12 && apart.ripple < 1e-12, "{apart:?}");
        let stripes: Vec<f64> = pixels.iter().map(|i| if i % 2 == 0 { 0.6 } else { 0.4 }).collect();
        let apart = Picture::of(&pixels, &stripes).apart(&flat(0.5));
        assert!(apart.ripple > 0.08, "{apart:?}");
    }
}
