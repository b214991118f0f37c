//! Tone curves: what of linear light a screen shows, as linear shares of its white. The twins are `compiler/src/shading/tone_*.wgsl`.

use crate::vector::{Vec3, add, mix, scale};
use crate::blocks::Tone;

/// Light as a screen shows it, each component 0 to 1, linear.
pub fn toned(tone: Tone, light: Vec3) -> Vec3 {
    match tone {
        Tone::Aces => light.map(aces),
        Tone::Agx => agx(light),
        Tone::Neutral => neutral(light),
        Tone::None => light,
    }
    .map(|c| c.clamp(0.0, 1.0))
}

/// What light is multiplied by before the filmic curve.
const FILM_SPEED: f64 = 0.8;

/// The filmic curve fitted to the Academy's reference transform: Narkowicz, "ACES Filmic Tone Mapping Curve" (2016).
fn aces(linear: f64) -> f64 {
    let c = FILM_SPEED * linear;
    c * (2.51 * c + 0.03) / (c * (2.43 * c + 0.59) + 0.14)
}

/// Sobotka's AgX as Wrensch fits it by a polynomial of degree six, without a look: "Minimal AgX Implementation" (2023),
/// <https://iolite-engine.com/blog_posts/minimal_agx_implementation>.
fn agx(light: Vec3) -> Vec3 {
    // Columns of the matrix into the space of the curve, and of its inverse.
    const INTO: [Vec3; 3] = [
        [0.842479062253094, 0.0423282422610123, 0.0423756549057051],
        [0.0784335999999992, 0.878468636469772, 0.0784336],
        [0.0792237451477643, 0.0791661274605434, 0.879142973793104],
    ];
    const BACK: [Vec3; 3] = [
        [1.19687900512017, -0.0528968517574562, -0.0529716355144438],
        [-0.0980208811401368, 1.15190312990417, -0.0980434501171241],
        [-0.0990297440797205, -0.0989611768448433, 1.15107367264116],
    ];
    // Stops that the curve covers.
    const LEAST: f64 = -12.47393;
    const MOST: f64 = 4.026069;
    let times = |columns: [Vec3; 3], v: Vec3| columns.iter().zip(v).fold([0.0; 3], |sum, (column, c)| add(sum, scale(*column, c)));
    let curved = times(INTO, light).map(|c| {
        let x = ((c.max(1e-10).log2() - LEAST) / (MOST - LEAST)).clamp(0.0, 1.0);
        let x2 = x * x;
        let x4 = x2 * x2;
        15.5 * x4 * x2 - 40.14 * x4 * x + 31.96 * x4 - 6.868 * x2 * x + 0.4298 * x2 + 0.1191 * x - 0.00232
    });
    // The curve ends in a screen's code of the power 2.2.
    times(BACK, curved).map(|c| c.clamp(0.0, 1.0).powf(2.2))
}

/// Khronos PBR Neutral (Khronos, 2024), <https://github.com/KhronosGroup/ToneMapping>: colours of what is lit well stay what they are.
fn neutral(light: Vec3) -> Vec3 {
    const START: f64 = 0.8 - 0.04;
    const DESATURATION: f64 = 0.15;
    let least = light.into_iter().fold(f64::INFINITY, f64::min);
    let offset = if least < 0.08 { least - 6.25 * least * least } else { 0.04 };
    let color = light.map(|c| c - offset);
    let peak = color.into_iter().fold(0.0, f64::max);
    if peak < START {
        return color;
    }
    let d = 1.0 - START;
    let lower = 1.0 - d * d / (peak + d - START);
    let share = 1.0 - 1.0 / (DESATURATION * (peak - lower) + 1.0);
    mix(scale(color, lower / peak), [lower; 3], share)
}

#[cfg(test)]
#[allow(clippy::unwrap_used, clippy::indexing_slicing)]
mod tests {
    use super::*;

    const ALL: [Tone; 4] = [Tone::Aces, Tone::Agx, Tone::Neutral, Tone::None];

    #[test]
    fn curves_rise_and_end_within_a_screen() {
        for tone in ALL {
            let mut before = [-1e-9; 3];
            for i in 0..400 {
                let c = 1e-4 * 1.04f64.powi(i);
                let seen = toned(tone, [c; 3]);
                assert!(seen.iter().zip(before).all(|(now, before)| *now >= before - 1e-3 && (0.0..=1.0).contains(now)), "{tone:?} at {c}: {seen:?}");
                before = seen;
            }
            assert!(before.iter().all(|c| *c > 0.95), "{tone:?}: {before:?}");
            assert!(toned(tone, [0.0; 3]).iter().all(|c| *c < 0.003), "{tone:?}");
        }
    }

    #[test]
    fn curves_are_those_of_their_sources() {
        let near = |a: Vec3, b: Vec3| a.iter().zip(b).all(|(a, b)| (a - b).abs() < 2e-3);
        assert_eq!(toned(Tone::None, [0.2, 0.5, 3.0]), [0.2, 0.5, 1.0]);
        // Below 0.76 PBR Neutral takes away 0.04, so that what reflects 4 % of white is black; a dark colour keeps a share.
        assert!(near(toned(Tone::Neutral, [0.2, 0.5, 0.3]), [0.16, 0.46, 0.26]));
        // Middle grey of 0.18 is near the middle of AgX' code.
        let grey = toned(Tone::Agx, [0.18; 3]);
        assert!(grey.iter().all(|c| (c.powf(1.0 / 2.2) - 0.5).abs() < 0.03), "{grey:?}");
        // What is very bright and coloured goes to white in AgX, and keeps its hue in each component by itself in the other.
        let red = toned(Tone::Agx, [60.0, 0.1, 0.1]);
        assert!(red[1] > 0.3, "{red:?}");
    }
}
