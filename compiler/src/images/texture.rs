//! Images that lie on surfaces: repeated without end, and blurred where many of their pixels fall into one of the picture's.

use super::bitmap::{Bitmap, blend};
use crate::graph::Slot;
use crate::vector::{Vec3, add, cross, dot, scale};

/// The longest side of a texture; larger images are made smaller.
const LARGEST: usize = 2048;

/// What a texture says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum TextureKind {
    /// Colours, in linear light.
    Color,
    /// Numbers, as they stand in the image.
    Data,
    /// How steeply the image's green rises to the right and down, in its own widths; the third component is zero.
    Slope,
}

impl TextureKind {
    /// What an image must say for a use.
    pub fn of(slot: Slot) -> Self {
        match slot {
            Slot::Color => TextureKind::Color,
            Slot::Roughness | Slot::Metallic => TextureKind::Data,
            Slot::Relief => TextureKind::Slope,
        }
    }
}

/// An image with its smaller versions.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    levels: Vec<Bitmap>,
}

impl Texture {
    /// From an image. Of [`TextureKind::Color`] it is in linear light, else as it stands in the file.
    pub fn new(image: &Bitmap, kind: TextureKind) -> Self {
        let mut level = image.clone();
        while level.width.max(level.height) > LARGEST {
            level = level.half();
        }
        if kind == TextureKind::Slope {
            level = slopes(&level);
        }
        let mut levels = Vec::new();
        while level.width.max(level.height) > 1 {
            let next = level.half();
            levels.push(level);
            level = next;
        }
        levels.push(level);
        Self { levels }
    }

    /// What stands for an image that can't be had: the surface is as its other entries say.
    pub fn missing(kind: TextureKind) -> Self {
        let texel = match kind {
            TextureKind::Color => [1.0; 3],
            TextureKind::Data => [0.0, 0.6, 0.0],
            TextureKind::Slope => [0.0; 3],
        };
        Self { levels: vec![Bitmap { width: 1, height: 1, texels: vec![texel] }] }
    }

    /// The image, then each version half as large as the one before.
    pub fn levels(&self) -> &[Bitmap] {
        &self.levels
    }

    /// The colour at a place, in widths of the image to the right and down, where a pixel of the picture is `size` widths wide.
    pub fn sample(&self, u: f64, v: f64, size: f64) -> Vec3 {
        let Some(first) = self.levels.first() else { return [0.0; 3] };
        let last = self.levels.len().saturating_sub(1) as f64;
        let level = (size * first.width as f64).max(1e-9).log2().clamp(0.0, last);
        // The image is as high as it is for its width.
        let down = v * first.width as f64 / first.height.max(1) as f64;
        let at = |level: f64| self.levels.get(level as usize).map_or([0.0; 3], |l| l.repeated(u, down));
        blend(at(level.floor()), at((level.floor() + 1.0).min(last)), level.fract())
    }

    /// The image laid on from three sides at a point, each as far as its share says.
    pub fn lay(&self, point: Vec3, shares: Vec3, size: f64) -> Vec3 {
        let [x, y, z] = point;
        let from = [self.sample(z, -y, size), self.sample(x, z, size), self.sample(x, -y, size)];
        from.iter().zip(shares).fold([0.0; 3], |sum, (c, share)| add(sum, scale(*c, share)))
    }

    /// How steeply the image rises along each axis of the space in which it is laid on. Of [`TextureKind::Slope`].
    pub fn rise(&self, point: Vec3, shares: Vec3, size: f64) -> Vec3 {
        let [x, y, z] = point;
        let [a, b, c] = [self.sample(z, -y, size), self.sample(x, z, size), self.sample(x, -y, size)];
        let from = [[0.0, -a[1], a[0]], [b[0], 0.0, b[1]], [c[0], -c[1], 0.0]];
        from.iter().zip(shares).fold([0.0; 3], |sum, (c, share)| add(sum, scale(*c, share)))
    }
}

/// How much each of the three sides has of a surface: by the squares of its normal's components in the space in which the image lies,
/// to a power. They add up to one. `axes` are the slopes of that space's coordinates.
pub fn sides(axes: [Vec3; 3], normal: Vec3, sharpness: f64) -> Vec3 {
    let [x, y, z] = axes;
    // Normals follow the cofactors of the map that points follow.
    let own = [dot(cross(y, z), normal), dot(cross(z, x), normal), dot(cross(x, y), normal)];
    let squares = own.map(|c| c * c);
    let most = squares.iter().fold(0.0, |most: f64, s| most.max(*s));
    if most <= 0.0 {
        return [1.0 / 3.0; 3];
    }
    // Over the largest first, so that no power vanishes.
    let powers = squares.map(|s| (s / most).max(1e-9).powf(sharpness));
    let sum: f64 = powers.iter().sum();
    powers.map(|p| p / sum)
}

/// How steeply an image's green rises to the right and down, in its own widths, between its neighbours around the edge.
fn slopes(image: &Bitmap) -> Bitmap {
    let (width, height) = (image.width, image.height);
    let green = |x: usize, y: usize| image.get(x, y)[1];
    let by = 0.5 * width as f32;
    let slope = |x: usize, y: usize| {
        let (left, right) = ((x + width - 1) % width, (x + 1) % width);
        let (above, below) = ((y + height - 1) % height, (y + 1) % height);
        [by * (green(right, y) - green(left, y)), by * (green(x, below) - green(x, above)), 0.0]
    };
    let texels = (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| slope(x, y)).collect();
    Bitmap { width, height, texels }
}

#[cfg(test)]
#[allow(clippy::indexing_slicing)]
mod tests {
    use super::*;

    const AXES: [Vec3; 3] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]];

    #[test]
    fn the_shares_of_the_sides_add_up_to_one() {
        let mut state = 3u32;
        let mut chance = move || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state >> 8) / f64::from(1 << 23) - 1.0
        };
        for _ in 0..10_000 {
            let normal = [chance(), chance(), chance()];
            let axes = AXES.map(|axis| add(axis, [0.4 * chance(), 0.4 * chance(), 0.4 * chance()]));
            let sharpness = 8.0 * chance().abs() + 0.1;
            let shares = sides(axes, normal, sharpness);
            assert!((shares.iter().sum::<f64>() - 1.0).abs() < 1e-12 && shares.iter().all(|s| (0.0..=1.0).contains(s)), "{shares:?}");
        }
        assert_eq!(sides(AXES, [0.0; 3], 2.0), [1.0 / 3.0; 3]);
        // With a power of one they are the squares themselves.
        for (share, want) in sides(AXES, [0.6, 0.0, 0.8], 1.0).iter().zip([0.36, 0.0, 0.64]) {
            assert!((share - want).abs() < 1e-8);
        }
    }

    #[test]
    fn what_two_sides_share_has_no_step() {
        // Around the edge at 45°, and around the corner.
        for (a, b) in [([1.0, 1.0, 0.0], [1e-6, -1e-6, 0.0]), ([1.0, 1.0, 1.0], [1e-6, 0.0, -1e-6])] {
            let (near, far) = (sides(AXES, add(a, b), 4.0), sides(AXES, add(a, scale(b, -1.0)), 4.0));
            assert!(near.iter().zip(far).all(|(n, f)| (n - f).abs() < 1e-4), "{near:?} {far:?}");
        }
    }

    #[test]
    fn turned_axes_turn_the_sides() {
        // The image's x runs along the scene's y.
        let turned = [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
        let shares = sides(turned, [0.0, 1.0, 0.0], 2.0);
        assert!(shares[0] > 0.999, "{shares:?}");
    }

    #[test]
    fn an_image_repeats_and_is_blurred_far_away() {
        let texels = (0..16).map(|i| if (i % 4 + i / 4) % 2 == 0 { [1.0; 3] } else { [0.0; 3] }).collect();
        let texture = Texture::new(&Bitmap { width: 4, height: 4, texels }, TextureKind::Color);
        assert_eq!(texture.levels().len(), 3);
        assert_eq!(texture.sample(0.125, 0.125, 0.0)[0], 1.0);
        assert_eq!(texture.sample(-0.875, 5.125, 0.0)[0], 1.0);
        assert_eq!(texture.sample(0.375, 0.125, 0.0)[0], 0.0);
        assert_eq!(texture.sample(0.4, 0.7, 1.0)[0], 0.5);
    }

    #[test]
    fn a_relief_rises_as_its_image_does() {
        // A ramp of 8 pixels, whose step back is one of its pixels.
        let texels = (0..64).map(|i| [(i % 8) as f32 / 8.0; 3]).collect();
        let texture = Texture::new(&Bitmap { width: 8, height: 8, texels }, TextureKind::Slope);
        assert_eq!(texture.sample(0.5, 0.3, 0.0), [1.0, 0.0, 0.0]);
        assert_eq!(texture.rise([0.5, 0.3, 0.2], [0.0, 0.0, 1.0], 0.0), [1.0, 0.0, 0.0]);
        assert_eq!(texture.rise([0.2, 0.3, 0.5], [1.0, 0.0, 0.0], 0.0), [0.0, 0.0, 1.0]);
    }
}
