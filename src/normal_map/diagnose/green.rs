//! Which way the green channel points, from integrability.
//!
//! The slopes `p = -x/z` and `q = -y/z` of a surface have no curl: `a = dp/dt` equals `b = dq/ds`. Under the wrong sign
//! of y it is `-b`, so the squared curls under either sign differ by `(a + b)^2 - (a - b)^2 = 4 a b`, and the sign of
//! the sum of `a b` tells. Both derivatives are taken at the centre of four texels, where those of any height that
//! was differenced evenly agree. The sums over tiles of the map are so many witnesses: their sum over the root of the
//! sum of their squares is what independent ones of either opinion would rarely bring beyond three.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::{Advice, Confidence, FEWEST_TEXELS, Finding, Subject};
use crate::image_io::RasterImage;
use crate::normal_map::decode::Decoder;
use crate::normal_map::{GreenChannel, MapOptions};

/// The most tiles along a side.
const TILES: usize = 16;

/// The fewest texels along a tile's side: closer ones are no witnesses of their own.
const SMALLEST_TILE: usize = 4;

/// The most rows of texels per tile that are looked at.
const ROWS_PER_TILE: usize = 64;

/// z below this is too steep for a slope.
const STEEPEST: f64 = 0.1;

/// Agreement of the tiles that speaks for a sign.
const FOR: f64 = 3.0;

/// Agreement that speaks plainly.
const PLAINLY: f64 = 6.0;

/// What the slopes say of the sign of y.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Curl {
    /// Correlation of `dp/dt` and `dq/ds`: 1 on a surface read the right way, -1 the wrong way, 0 where they are not
    /// of one surface; 0 also where a slope varies along one direction only.
    pub correlation: f64,
    /// Agreement of the tiles, in standard deviations.
    pub agreement: f64,
}

/// Sums over some cells between texels.
#[derive(Clone, Copy, Default)]
struct Sums {
    product: f64,
    squares: [f64; 2],
}

impl Curl {
    /// Of normals read as +Y up; `normal` gives that of a texel, row by row from the top.
    pub fn of((width, height): (usize, usize), normal: impl Fn(usize) -> Option<DVec3> + Sync) -> Self {
        let [across, down] = [width, height].map(|side| side.div_ceil(TILES).max(SMALLEST_TILE));
        let slope = |x: usize, y: usize| normal(y * width + x).and_then(slope_of);
        let tile = |tile: usize| {
            let columns = width.div_ceil(across);
            let [left, top] = [tile % columns * across, tile / columns * down];
            let rows = (top..(top + down).min(height.saturating_sub(1))).step_by(down.div_ceil(ROWS_PER_TILE));
            let cells = rows.flat_map(|y| (left..(left + across).min(width.saturating_sub(1))).map(move |x| (x, y)));
            cells.fold(Sums::default(), |sums, (x, y)| sums.plus(cell(&slope, x, y).unwrap_or_default()))
        };
        let tiles: Vec<Sums> = (0..width.div_ceil(across) * height.div_ceil(down)).into_par_iter().map(tile).collect();
        Self::of_tiles(&tiles)
    }

    fn of_tiles(tiles: &[Sums]) -> Self {
        let whole = tiles.iter().copied().fold(Sums::default(), Sums::plus);
        let ratio = |sum: f64, scale: f64| if scale > 0.0 { sum / scale } else { 0.0 };
        Self {
            correlation: ratio(whole.product, (whole.squares[0] * whole.squares[1]).sqrt()),
            agreement: ratio(whole.product, tiles.iter().map(|tile| tile.product.powi(2)).sum::<f64>().sqrt()),
        }
    }

    /// The convention that they speak for, if any.
    pub fn green(self) -> Option<GreenChannel> {
        let sign = if self.agreement < 0.0 { GreenChannel::Down } else { GreenChannel::Up };
        (self.agreement.abs() >= FOR).then_some(sign)
    }
}

impl Sums {
    fn plus(self, other: Self) -> Self {
        let squares = [0, 1].map(|index| self.squares[index] + other.squares[index]);
        Self { product: self.product + other.product, squares }
    }
}

/// The slope that a normal stands for; the sign of both components is that of the normal and cancels in products.
fn slope_of(normal: DVec3) -> Option<DVec2> {
    (normal.z > STEEPEST).then(|| normal.truncate() / normal.z)
}

/// Both derivatives at the centre of four texels; rows run down and t runs up.
fn cell(slope: &impl Fn(usize, usize) -> Option<DVec2>, x: usize, y: usize) -> Option<Sums> {
    let [top_left, top_right] = [slope(x, y)?, slope(x + 1, y)?];
    let [bottom_left, bottom_right] = [slope(x, y + 1)?, slope(x + 1, y + 1)?];
    let a = (top_left + top_right - bottom_left - bottom_right).x / 2.0;
    let b = (top_right + bottom_right - top_left - bottom_left).y / 2.0;
    Some(Sums { product: a * b, squares: [a * a, b * b] })
}

pub(super) fn finding(image: &RasterImage, options: &MapOptions) -> Finding {
    let subject = Subject::Green;
    if image.texels() < FEWEST_TEXELS || image.width.min(image.height) < 2 {
        let reason = format!("{} x {} texels have no slopes to judge by", image.width, image.height);
        return Finding::unknown(subject, reason);
    }
    let decoder = Decoder::new(image, options);
    let curl = Curl::of((image.width, image.height), |texel| decoder.normal(image, texel));
    let reason = format!(
        "cross derivatives of the slopes correlate by {:.2} as +Y up, where a surface has 1 and its mirror image -1; \
         parts of the map agree to {:.1} standard deviations",
        curl.correlation,
        curl.agreement.abs()
    );
    let Some(green) = curl.green() else { return Finding::unknown(subject, reason) };
    let confidence = if curl.agreement.abs() < PLAINLY { Confidence::Likely } else { Confidence::Certain };
    let answer = if green == GreenChannel::Down { "+Y down" } else { "+Y up" };
    Finding::new(subject, answer, confidence, reason).advising(Advice::Green(green))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Normals of a bump whose slopes are exact.
    fn bumps(y_sign: f64) -> impl Fn(usize) -> Option<DVec3> {
        move |texel| {
            let (s, t) = ((texel % 64) as f64 * 0.3, (texel / 64) as f64 * -0.2);
            Some(DVec3::new(-(s + t).cos(), -y_sign * (s + t).cos() * 0.7, 1.0).normalize())
        }
    }

    #[test]
    fn a_surface_correlates_fully_and_its_mirror_image_the_other_way() {
        for (sign, green) in [(1.0, GreenChannel::Up), (-1.0, GreenChannel::Down)] {
            let curl = Curl::of((64, 64), bumps(sign));
            // The mean over a cell is that of a sine, a little shorter along s than along t.
            assert!((curl.correlation - sign).abs() < 1e-9, "{curl:?}");
            assert_eq!(curl.green(), Some(green));
        }
    }

    #[test]
    fn a_groove_a_row_and_a_texel_do_not_tell() {
        let groove = |texel: usize| Some(DVec3::new((texel as f64).sin(), 0.0, 1.0).normalize());
        let none = Curl { correlation: 0.0, agreement: 0.0 };
        for (size, curl) in [
            ((8, 8), Curl::of((8, 8), |texel| groove(texel % 8))),
            ((64, 1), Curl::of((64, 1), groove)),
            ((1, 1), Curl::of((1, 1), groove)),
        ] {
            assert_eq!(curl, none, "{size:?}");
            assert_eq!(curl.green(), None);
        }
    }
}
