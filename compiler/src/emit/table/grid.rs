//! Where a union of many lies, and how the space about it is cut into cells.

use crate::functions::unions::Operand;

/// Cells for each operand in the innermost box.
const CELLS: f64 = 64.0;
/// So many where that makes no more of them than [`FEW_CELLS`]: operands that are few are large, and cells as large as they are hold most of them.
const FINE_CELLS: f64 = 128.0;
/// See [`FINE_CELLS`].
const FEW_CELLS: f64 = 65_536.0;
/// Cells in the innermost box.
const MOST_CELLS: f64 = 524_288.0;
/// Cells along an axis of the innermost box.
const MOST_ALONG: f64 = 128.0;
/// How far the innermost box reaches beyond the solid, for each unit of its size: a ray that is outside makes steps of that size at least.
const MARGIN: f64 = 0.05;

/// The innermost box about a union, in cells.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Its middle.
    pub center: [f64; 3],
    /// Half its sides.
    pub half: [f64; 3],
    /// Cells along its axes.
    pub counts: [usize; 3],
    /// Half the sides of a box about the same middle in which the solid lies.
    solid: [f64; 3],
    /// Whether it does: an operand without a region may be anywhere.
    bounded: bool,
}

impl Grid {
    /// About the operands whose regions are known; none where there is none.
    pub fn around(operands: &[Option<Operand>]) -> Option<Self> {
        let mut low = [f64::INFINITY; 3];
        let mut high = [f64::NEG_INFINITY; 3];
        let (mut count, mut bounded) = (0.0, true);
        for operand in operands.iter().flatten().filter(|o| !o.region.is_empty()) {
            if !operand.region.is_finite() {
                bounded = false;
                continue;
            }
            count += 1.0;
            for ((low, high), side) in low.iter_mut().zip(&mut high).zip(&operand.region.0) {
                *low = low.min(side.lo);
                *high = high.max(side.hi);
            }
        }
        if count == 0.0 {
            return None;
        }
        let sides = [(low[0], high[0]), (low[1], high[1]), (low[2], high[2])];
        let center = sides.map(|(low, high)| f64::from((0.5 * (low + high)) as f32));
        let far = sides.iter().fold(0.0, |far: f64, (low, high)| far.max(low.abs()).max(high.abs()));
        // A hair is lost in 32 bits.
        let grown = 4e-6 * far;
        let mut solid = [0.0; 3];
        for ((solid, (low, high)), center) in solid.iter_mut().zip(sides).zip(center) {
            *solid = (high - center).max(center - low) + grown;
        }
        let margin = (MARGIN * 2.0 * solid.iter().fold(0.0, |m: f64, s| m.max(*s))).max(1e-6);
        let half = solid.map(|s| s + margin);
        let cells = (CELLS * count).max((FINE_CELLS * count).min(FEW_CELLS)).clamp(64.0, MOST_CELLS);
        // A drawing has one layer of them.
        let is_flat = sides[2].0 == sides[2].1;
        let [across, up, deep] = half.map(|h| 2.0 * h);
        let side = if is_flat { (across * up / cells).sqrt() } else { (across * up * deep / cells).cbrt() };
        let along = |width: f64| (width / side).ceil().clamp(1.0, MOST_ALONG) as usize;
        let counts = [along(across), along(up), if is_flat { 1 } else { along(deep) }];
        Some(Self { center, half, counts, solid, bounded })
    }

    /// Whether all of the solid lies in it.
    pub fn is_region(&self) -> bool {
        self.bounded
    }

    /// What `sf_away` reads: the middle, half the sides of the solid's box, half those of the innermost box.
    pub fn rows(&self) -> [[f32; 4]; 3] {
        [self.center, self.solid, self.half].map(|[x, y, z]| [x as f32, y as f32, z as f32, 0.0])
    }
}
