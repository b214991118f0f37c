//! The film: where the samples of a picture look, how light becomes a screen's colour, and what of that eight bits hold.

use crate::srgb::encode;
use super::tone::toned;
use crate::vector::{Vec3, add, mix, scale};
use super::{Area, View};
use crate::blocks::Tone;

/// Where in its pixels the sample of a number looks, from their middles: -0.5 to 0.5 across and down. The first looks at the middles; all of
/// them together cover the pixels evenly (Roberts, "The Unreasonable Effectiveness of Quasirandom Sequences", 2018).
pub fn sample_offset(index: u32) -> [f64; 2] {
    // One over the plastic number, and its square.
    const STEPS: [f64; 2] = [0.754_877_666_246_692_7, 0.569_840_290_998_053_3];
    STEPS.map(|step| (0.5 + f64::from(index) * step).fract() - 0.5)
}

/// How far a pixel is moved before it is rounded to a level, in levels: from -0.5 to 0.5, another one in each of 8×8 pixels (Bayer, "An
/// Optimum Method for Two-Level Rendition of Continuous-Tone Pictures", 1973). So what changes slowly has no edges where a level ends.
pub fn dither(x: u32, y: u32) -> f64 {
    let mixed = x ^ y;
    let bits = [(mixed, 1, 32), (y, 1, 16), (mixed, 2, 8), (y, 2, 4), (mixed, 4, 2), (y, 4, 1)];
    let rank: u32 = bits.into_iter().map(|(of, bit, worth)| if of & bit != 0 { worth } else { 0 }).sum();
    (f64::from(rank) + 0.5) / 64.0 - 0.5
}

/// The level, of 255, of a screen's colour (0 to 1) that is moved by a part of a level.
pub fn level(encoded: f64, moved: f64) -> u8 {
    // Casts end at the ends of what eight bits hold.
    (255.0 * encoded.clamp(0.0, 1.0) + moved).round() as u8
}

/// Exposed light to a screen's colour, each component 0 to 1, sRGB-encoded.
pub fn develop(tone: Tone, light: Vec3) -> Vec3 {
    toned(tone, light.map(|c| c.max(0.0))).map(encode)
}

/// How often a picture of so many pixels is halved for what is scattered over it: down to some pixels, or seven times.
pub fn glow_levels((width, height): (u32, u32)) -> u32 {
    width.min(height).max(1).ilog2().saturating_sub(2).clamp(1, 7)
}

/// A picture in linear light, of which a share is scattered over the rest: halves of the picture, each blurred, spread over it again, so that the
/// sum stays the same but at the edges. The twin of `runtime/src/passes/bloom`; after Jimenez, "Next Generation Post Processing in Call of Duty:
/// Advanced Warfare" (2014), with B-splines of second degree.
pub fn bloom(light: &[Vec3], size: (u32, u32), share: f64) -> Vec<Vec3> {
    let mut halves = Vec::new();
    let mut last = Sheet { pixels: light.to_vec(), size };
    for _ in 0..glow_levels(size) {
        let half = last.half();
        halves.push(std::mem::replace(&mut last, half));
    }
    // The first is the picture itself.
    for half in halves.iter().skip(1).rev() {
        last = half.mixed(&last, SPREAD);
    }
    halves.first().map_or_else(Vec::new, |picture| picture.mixed(&last, share).pixels)
}

/// How much of a half is what its own half is spread to.
const SPREAD: f64 = 0.75;

/// Pixels row by row.
struct Sheet {
    pixels: Vec<Vec3>,
    size: (u32, u32),
}

impl Sheet {
    /// A pixel; beyond the edges the nearest one.
    fn at(&self, x: i64, y: i64) -> Vec3 {
        let inside = |at: i64, side: u32| at.clamp(0, i64::from(side.max(1)) - 1) as usize;
        let place = inside(y, self.size.1) * self.size.0 as usize + inside(x, self.size.0);
        self.pixels.get(place).copied().unwrap_or([0.0; 3])
    }

    fn of((width, height): (u32, u32), pixel: impl Fn(i64, i64) -> Vec3) -> Self {
        let rows = (0..i64::from(height)).flat_map(|y| (0..i64::from(width)).map(move |x| (x, y)));
        Self { pixels: rows.map(|(x, y)| pixel(x, y)).collect(), size: (width, height) }
    }

    fn half(&self) -> Self {
        const WEIGHTS: [f64; 4] = [0.125, 0.375, 0.375, 0.125];
        let places = || (-1..).zip(WEIGHTS);
        Self::of((self.size.0.div_ceil(2), self.size.1.div_ceil(2)), |x, y| {
            places().flat_map(|row| places().map(move |column| (column, row))).fold([0.0; 3], |sum, ((dx, across), (dy, down))| {
                add(sum, scale(self.at(2 * x + dx, 2 * y + dy), across * down))
            })
        })
    }

    /// With a share of a half of it, spread.
    fn mixed(&self, half: &Self, share: f64) -> Self {
        Self::of(self.size, |x, y| {
            let (near, far) = ([x / 2, y / 2], [x, y].map(|c| c / 2 + if c % 2 == 1 { 1 } else { -1 }));
            let beside = add(half.at(far[0], near[1]), half.at(near[0], far[1]));
            let corner = scale(half.at(far[0], far[1]), 0.0625);
            let doubled = add(add(scale(half.at(near[0], near[1]), 0.5625), scale(beside, 0.1875)), corner);
            mix(self.at(x, y), doubled, share)
        })
    }
}

/// The colours of a part of a picture as bytes: red, green, blue of each pixel. Light is dithered; levels of other views are numbers to read.
pub fn rgb8(pixels: &[[f32; 4]], area: Area, view: View) -> Vec<u8> {
    let places = (area.top..area.top + area.height).flat_map(|y| (area.left..area.left + area.width).map(move |x| (x, y)));
    let levels = |(&[r, g, b, _], (x, y)): (&[f32; 4], (u32, u32))| {
        let moved = if view == View::Shaded { dither(x, y) } else { 0.0 };
        [r, g, b].map(|c| level(c.into(), moved))
    };
    pixels.iter().zip(places).flat_map(levels).collect()
}

#[cfg(test)]
#[allow(clippy::indexing_slicing)]
mod tests {
    use super::*;

    #[test]
    fn scattered_light_is_all_there_and_less_the_farther_it_goes() {
        const SIZE: (u32, u32) = (97, 64);
        let at = |x: usize, y: usize| y * 97 + x;
        let mut light = vec![[0.0; 3]; 97 * 64];
        light[at(48, 31)] = [100.0, 10.0, 0.0];
        let seen = bloom(&light, SIZE, 0.3);
        let sum = |light: &[Vec3]| light.iter().fold(0.0, |sum, c| sum + c[0]);
        assert!((sum(&seen) - 100.0).abs() < 3.0, "{}", sum(&seen));
        assert!((69.0..76.0).contains(&seen[at(48, 31)][0]) && seen.iter().all(|c| (c[0] - 10.0 * c[1]).abs() < 1e-9));
        let along: Vec<f64> = (0..24).map(|far| seen[at(48 + far, 31)][0]).collect();
        assert!(along.windows(2).all(|pair| pair[1] <= pair[0] + 1e-12) && along[23] > 0.0, "{along:?}");
        // An even picture stays what it is.
        let even = bloom(&[[0.5; 3]; 97 * 64], SIZE, 0.3);
        assert!(even.iter().flatten().all(|c| (c - 0.5).abs() < 1e-12));
        assert_eq!(bloom(&light, SIZE, 0.0), light);
        // None is too small.
        assert_eq!(bloom(&[[1.0; 3]], (1, 1), 0.5).len(), 1);
        assert!(bloom(&[], (0, 0), 0.5).is_empty());
    }

    #[test]
    fn dithered_levels_are_right_on_the_mean() {
        let mean = |c: f64| (0..64).map(|i| f64::from(level(c / 255.0, dither(i % 8, i / 8)))).sum::<f64>() / 64.0;
        for tenth in 0..=2550 {
            let c = f64::from(tenth) / 10.0;
            assert!((mean(c) - c).abs() <= 1.0 / 64.0, "{c}: {}", mean(c));
        }
        // What eight bits hold stays as it is, in each pixel.
        for whole in 0..=255u8 {
            assert!((0..64).all(|i| level(f64::from(whole) / 255.0, dither(i % 8, i / 8)) == whole));
        }
        // Each place has its own rank.
        let mut ranks: Vec<i64> = (0..64).map(|i| (64.0 * dither(i % 8, i / 8)).floor() as i64).collect();
        ranks.sort_unstable();
        assert_eq!(ranks, (-32..32).collect::<Vec<_>>());
    }
}
