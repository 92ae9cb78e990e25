//! How a pixel's footprint is read from the levels: which level of detail, and how many probes of it.
//!
//! The truth weighs the map evenly over the pixel, a square on the screen that `uv_dx` and `uv_dy` take to a
//! parallelogram of covariance `(dx dx^T + dy dy^T) / 12`, here in base texels. A trilinear probe at level `l` weighs
//! it by a box, the texel's own footprint, and a tent, the interpolation: `4^l (1/12 + 1/6)` along each axis on the
//! average. Two kernels of equal variance blur alike to the first order, which puts a square pixel `p` texels wide at
//! `log2(p) - log2(3) / 2`; hardware reads `log2(p)`, whose variance is three times the pixel's.
//!
//! A long footprint is read by several probes side by side along its long axis, each as wide as the short one; each is
//! shaded, and the mean is shown: the NDF of the whole is the mean of its parts', and shading is linear in the NDF
//! (Han et al. 2007, eq. 4).

use glam::Vec2;

/// Which MIP level a pixel reads.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum LevelChoice {
    /// The level at which a probe blurs as much as the pixel does, between two levels by trilinear interpolation.
    #[default]
    Auto,
    /// The level whose texels are as wide as the pixel is long, as samplers in hardware take it (Williams 1983).
    Hardware,
    /// This level, everywhere.
    Fixed(f32),
}

/// How the levels are read: the choice of level, and how many probes a long footprint may take.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LevelRule {
    /// The level.
    pub choice: LevelChoice,
    /// Most probes along the long axis, at least 1.
    pub most_probes: u32,
}

/// Most probes that may be asked for.
pub const MOST_PROBES: u32 = 16;

/// The probes of one pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Probes {
    /// Level of detail of each, within the levels there are.
    pub lod: f32,
    /// How many.
    pub count: u32,
    /// From one to the next, in texture coordinates; they stand evenly around the pixel's centre.
    pub step: Vec2,
}

impl Probes {
    /// The probes of a pixel over which texture coordinates change by `uv_dx` to the right and `uv_dy` down, of a base
    /// level of `base` texels, at levels within `range`.
    pub fn new(rule: LevelRule, uv_dx: Vec2, uv_dy: Vec2, base: (usize, usize), range: [f32; 2]) -> Self {
        let size = Vec2::new(base.0 as f32, base.1 as f32);
        let (dx, dy) = (uv_dx * size, uv_dy * size);
        let probes = match rule.choice {
            LevelChoice::Auto => matched(dx, dy, rule.most_probes, range[0]),
            LevelChoice::Hardware => hardware(dx, dy, rule.most_probes, range[0]),
            LevelChoice::Fixed(lod) => Self { lod, count: 1, step: Vec2::ZERO },
        };
        Self { lod: probes.lod.clamp(range[0], range[1]), step: probes.step / size, ..probes }
    }

    /// Where each probe stands from the pixel's centre, in texture coordinates.
    pub fn offsets(self) -> impl Iterator<Item = Vec2> {
        let middle = 0.5 * (self.count - 1) as f32;
        (0..self.count).map(move |index| (index as f32 - middle) * self.step)
    }
}

/// Below this a length in base texels counts as none.
const LEAST_LENGTH: f32 = 1e-12;

/// Probes whose kernels have the pixel's variance along both axes; the step in base texels.
fn matched(dx: Vec2, dy: Vec2, most: u32, finest: f32) -> Probes {
    let covariance = [dx.x * dx.x + dy.x * dy.x, dx.x * dx.y + dy.x * dy.y, dx.y * dx.y + dy.y * dy.y];
    let [xx, xy, yy] = covariance.map(|entry| entry / 12.0);
    let (mean, half) = (0.5 * (xx + yy), 0.5 * (xx - yy));
    let apart = (half * half + xy * xy).sqrt();
    let (long, short) = ((mean + apart).max(LEAST_LENGTH), (mean - apart).max(LEAST_LENGTH));
    let lod_of = |variance: f32| 0.5 * (4.0 * variance).log2();
    let count = probes_for((long / short).sqrt(), most, lod_of(long) > finest);
    let of_each = if count == 1 { long } else { short.max(long / (count * count) as f32) };
    // Evenly spaced points a step apart have variance (count^2 - 1) / 12 step^2.
    let step = (12.0 * (long - of_each).max(0.0) / (count * count - 1).max(1) as f32).sqrt();
    Probes { lod: lod_of(of_each), count, step: step * Vec2::from_angle(0.5 * xy.atan2(half)) }
}

/// The probes of `EXT_texture_filter_anisotropic`; the step in base texels.
fn hardware(dx: Vec2, dy: Vec2, most: u32, finest: f32) -> Probes {
    let (long, short) = if dx.length_squared() >= dy.length_squared() { (dx, dy) } else { (dy, dx) };
    let length = long.length().max(LEAST_LENGTH);
    let count = probes_for(length / short.length().max(LEAST_LENGTH), most, length.log2() > finest);
    Probes { lod: (length / count as f32).log2(), count, step: long / (count + 1) as f32 }
}

/// A probe for each time that the long axis holds the short one; one where the finest level there is suffices.
fn probes_for(ratio: f32, most: u32, is_minified: bool) -> u32 {
    if is_minified { (ratio.ceil().min(most as f32) as u32).max(1) } else { 1 }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BASE: (usize, usize) = (256, 128);
    const RANGE: [f32; 2] = [0.0, 8.0];

    fn probes(choice: LevelChoice, most_probes: u32, dx: Vec2, dy: Vec2) -> Probes {
        let size = Vec2::new(256.0, 128.0);
        Probes::new(LevelRule { choice, most_probes }, dx / size, dy / size, BASE, RANGE)
    }

    /// Covariance of all probes' kernels, in base texels: along x, of x and y, along y.
    fn covariance(probes: Probes) -> [f32; 3] {
        let kernel = 4.0_f32.powf(probes.lod) / 4.0;
        let count = probes.count as f32;
        let mut sums = [kernel, 0.0, kernel];
        for offset in probes.offsets() {
            let at = offset * Vec2::new(256.0, 128.0);
            sums = [sums[0] + at.x * at.x / count, sums[1] + at.x * at.y / count, sums[2] + at.y * at.y / count];
        }
        sums
    }

    #[test]
    fn matched_probes_have_the_pixels_covariance_while_there_are_enough_of_them() {
        let turned = Vec2::from_angle(0.7);
        for (long, short) in [(8.0, 8.0), (9.0, 4.0), (30.0, 3.0), (47.0, 3.0)] {
            let (dx, dy) = (long * turned, short * turned.perp());
            let found = covariance(probes(LevelChoice::Auto, 16, dx, dy));
            let pixel = [dx.x * dx.x + dy.x * dy.x, dx.x * dx.y + dy.x * dy.y, dx.y * dx.y + dy.y * dy.y];
            for (found, pixel) in found.into_iter().zip(pixel.map(|entry| entry / 12.0)) {
                assert!((found - pixel).abs() < 1e-3 * long * long, "{long} x {short}: {found} for {pixel}");
            }
        }
    }

    #[test]
    fn a_skewed_pixel_keeps_its_covariance_too() {
        let (dx, dy) = (Vec2::new(12.0, 3.0), Vec2::new(-5.0, 4.0));
        let [xx, xy, yy] = covariance(probes(LevelChoice::Auto, 16, dx, dy));
        assert!((xx - 169.0 / 12.0).abs() < 1e-2 && (xy - 16.0 / 12.0).abs() < 1e-2 && (yy - 25.0 / 12.0).abs() < 1e-2);
    }

    #[test]
    fn one_probe_takes_the_long_axis_and_hardware_reads_it_coarser_by_half_of_log2_3() {
        let (dx, dy) = (Vec2::new(16.0, 0.0), Vec2::new(0.0, 2.0));
        let auto = probes(LevelChoice::Auto, 1, dx, dy);
        let hardware = probes(LevelChoice::Hardware, 1, dx, dy);
        assert_eq!((hardware.lod, hardware.count), (4.0, 1));
        assert!((hardware.lod - auto.lod - 0.5 * 3.0_f32.log2()).abs() < 1e-5);
        assert_eq!(probes(LevelChoice::Hardware, 4, dx, dy).lod, 2.0);
        assert_eq!(probes(LevelChoice::Hardware, 16, dx, dy).lod, 1.0);
    }

    #[test]
    fn a_magnified_map_and_a_fixed_level_take_one_probe() {
        let close = probes(LevelChoice::Auto, 16, Vec2::new(0.5, 0.0), Vec2::new(0.0, 0.01));
        assert_eq!((close.lod, close.count), (0.0, 1));
        let fixed = probes(LevelChoice::Fixed(2.5), 16, Vec2::new(99.0, 0.0), Vec2::new(0.0, 1.0));
        assert_eq!(fixed, Probes { lod: 2.5, count: 1, step: Vec2::ZERO });
        let nowhere = probes(LevelChoice::Auto, 16, Vec2::ZERO, Vec2::ZERO);
        assert_eq!((nowhere.lod, nowhere.count), (0.0, 1));
    }
}
