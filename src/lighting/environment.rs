//! Light from everywhere: a picture of the sky by latitude and longitude.
//!
//! The first row looks up along `+z`; the middle column looks along `+y`, the columns right of it towards `+x`. The sky
//! is constant over each texel, so sums over texels with their solid angles
//! `2 pi / width (cos theta_top - cos theta_bottom)` are its integrals. What shading needs of it beside the picture is
//! worked out once: harmonics, the table of views and directions drawn by its brightness.

use std::f64::consts::PI;

use glam::{DVec3, Vec3};

use super::sky_harmonics::SkyHarmonics;
use super::sky_samples;
use super::sky_source::{SkyError, SkySource};
use super::sun::Sun;

/// The most texels across that are kept of a sky; a wider one is averaged down.
pub const MOST_COLUMNS: usize = 1024;

/// The largest radiance that is read: a thousand suns, of which sums over the sky and their products stay finite.
pub const MOST_RADIANCE: f32 = 1e12;

/// A sky, ready to light.
#[derive(Clone, Debug)]
pub struct Environment {
    /// Where it comes from.
    pub source: SkySource,
    /// Texels across, twice those down.
    pub width: usize,
    /// Texels down.
    pub height: usize,
    /// Linear RGB of each texel, row by row from the top.
    pub radiance: Vec<Vec3>,
    /// Of each texel the density, per steradian, with which [`Self::samples`] fall into it: as its luminance.
    pub density: Vec<f32>,
    /// Unit vectors drawn with that density, in an order of which every run is spread as evenly.
    pub samples: Vec<Vec3>,
    /// The sun, if it has one.
    pub sun: Option<Sun>,
    /// What is shaded with.
    pub harmonics: SkyHarmonics,
}

impl Environment {
    /// A sky of `width` columns and half as many rows.
    ///
    /// # Errors
    /// A sentence on what is wrong with it.
    pub fn new(source: SkySource, width: usize, radiance: Vec<Vec3>) -> Result<Self, SkyError> {
        let height = radiance.len() / width.max(1);
        let name = || source.to_string();
        if width == 0 || width != 2 * height || width * height != radiance.len() {
            return Err(SkyError::NotTwiceAsWide { name: name(), width, height });
        }
        if let Some(index) = radiance.iter().position(|color| !color.is_finite()) {
            return Err(SkyError::NotFinite { name: name(), x: index % width, y: index / width });
        }
        if let Some(index) = radiance.iter().position(|color| color.max_element() > MOST_RADIANCE) {
            return Err(SkyError::TooBright { name: name(), x: index % width, y: index / width });
        }
        // Filters of other programs leave values a little below zero.
        let radiance: Vec<Vec3> = radiance.into_iter().map(|color| color.max(Vec3::ZERO)).collect();
        if radiance.iter().all(|color| *color == Vec3::ZERO) {
            return Err(SkyError::Black { name: name() });
        }
        let radiance = reduced(radiance, width, width.div_ceil(MOST_COLUMNS));
        let height = ((radiance.len() / 2) as f64).sqrt() as usize;
        let grid = LatLong { width: 2 * height, height };
        let density = sky_samples::density(grid, &radiance);
        let samples = sky_samples::draw(grid, &density);
        let mut rest = radiance.clone();
        let sun = Sun::take(grid, &mut rest);
        let harmonics = SkyHarmonics::new(grid, &rest, sun.as_ref());
        Ok(Self { source, width: grid.width, height, radiance, density, samples, sun, harmonics })
    }

    /// Its texels.
    pub fn grid(&self) -> LatLong {
        LatLong { width: self.width, height: self.height }
    }

    /// Linear RGB between the texels around a direction, for the eye.
    pub fn seen(&self, direction: Vec3) -> Vec3 {
        let [u, v] = lat_long(direction);
        let (x, y) = (u * self.width as f32 - 0.5, v * self.height as f32 - 0.5);
        let (column, row) = (x.floor(), y.floor());
        let at = |dx: i64, dy: i64| {
            let column = (column as i64 + dx).rem_euclid(self.width as i64) as usize;
            let row = (row as i64 + dy).clamp(0, self.height as i64 - 1) as usize;
            self.radiance[row * self.width + column]
        };
        let (fx, fy) = (x - column, y - row);
        at(0, 0).lerp(at(1, 0), fx).lerp(at(0, 1).lerp(at(1, 1), fx), fy)
    }
}

/// Where a direction stands in the picture, both coordinates in `0..=1`.
pub fn lat_long(direction: Vec3) -> [f32; 2] {
    let turn = direction.x.atan2(direction.y) / std::f32::consts::TAU;
    [turn + 0.5, direction.z.clamp(-1.0, 1.0).acos() / std::f32::consts::PI]
}

/// The texels of a sky.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct LatLong {
    /// Across.
    pub width: usize,
    /// Down.
    pub height: usize,
}

impl LatLong {
    /// The unit vector at a point of the picture, in texels from the upper left corner.
    pub fn direction(self, x: f64, y: f64) -> DVec3 {
        let (turn, polar) = (2.0 * PI * (x / self.width as f64 - 0.5), PI * y / self.height as f64);
        DVec3::new(polar.sin() * turn.sin(), polar.sin() * turn.cos(), polar.cos())
    }

    /// The cosine of the polar angle at a row's upper edge.
    pub fn edge_cosine(self, row: usize) -> f64 {
        (PI * row as f64 / self.height as f64).cos()
    }

    /// Steradians of each texel of a row.
    pub fn solid_angle(self, row: usize) -> f64 {
        2.0 * PI / self.width as f64 * (self.edge_cosine(row) - self.edge_cosine(row + 1))
    }

    /// The texel in a direction.
    pub fn texel(self, direction: Vec3) -> usize {
        let [u, v] = lat_long(direction);
        let column = ((u * self.width as f32) as usize).min(self.width - 1);
        ((v * self.height as f32) as usize).min(self.height - 1) * self.width + column
    }

    /// Every texel as its centre's direction, its solid angle and its index.
    pub fn texels(self) -> impl Iterator<Item = (DVec3, f64, usize)> {
        (0..self.width * self.height).map(move |index| {
            let (x, y) = (index % self.width, index / self.width);
            (self.direction(x as f64 + 0.5, y as f64 + 0.5), self.solid_angle(y), index)
        })
    }
}

/// The sky averaged over blocks of `side` by `side` texels, each weighted by its solid angle; blocks differ by a texel
/// where the sky's sides are no multiples.
pub fn reduced(radiance: Vec<Vec3>, width: usize, side: usize) -> Vec<Vec3> {
    if side <= 1 {
        return radiance;
    }
    let fine = LatLong { width, height: width / 2 };
    let rows = fine.height / side;
    let coarse = LatLong { width: 2 * rows, height: rows };
    let mut sums = vec![(DVec3::ZERO, 0.0); coarse.width * coarse.height];
    for (index, color) in radiance.iter().enumerate() {
        let (x, y) = (index % width, index / width);
        let target = (y * rows / fine.height) * coarse.width + x * coarse.width / width;
        let weight = fine.solid_angle(y);
        sums[target].0 += weight * color.as_dvec3();
        sums[target].1 += weight;
    }
    sums.into_iter().map(|(sum, weight)| (sum / weight).as_vec3()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lighting::ProceduralSky;

    const SOURCE: SkySource = SkySource::Bundled(ProceduralSky::Clear);

    #[test]
    fn a_direction_and_its_texel_name_each_other_and_solid_angles_sum_to_the_sphere() {
        let grid = LatLong { width: 32, height: 16 };
        for (direction, _, index) in grid.texels() {
            assert_eq!(grid.texel(direction.as_vec3()), index, "{direction}");
        }
        let whole: f64 = grid.texels().map(|(_, solid_angle, _)| solid_angle).sum();
        assert!((whole - 4.0 * PI).abs() < 1e-12);
        assert!((grid.direction(16.0, 8.0) - DVec3::Y).length() < 1e-12, "the middle looks along +y");
        assert!(grid.direction(17.0, 8.0).x > 0.0, "right of it lies +x");
        assert!((grid.direction(3.0, 0.0) - DVec3::Z).length() < 1e-12, "the first row looks up");
    }

    #[test]
    fn a_sky_that_is_averaged_down_keeps_its_power() {
        let fine = LatLong { width: 60, height: 30 };
        let radiance: Vec<Vec3> = fine.texels().map(|(d, ..)| Vec3::splat((2.0 + d.x + d.z * d.y) as f32)).collect();
        let coarse = LatLong { width: 14, height: 7 };
        let small = reduced(radiance.clone(), 60, 4);
        let power = |grid: LatLong, sky: &[Vec3]| -> f64 {
            grid.texels().map(|(_, solid_angle, index)| solid_angle * f64::from(sky[index].x)).sum()
        };
        assert_eq!(small.len(), 14 * 7);
        // Blocks of 4 and of 5 texels stand for blocks of one size.
        assert!((power(fine, &radiance) / power(coarse, &small) - 1.0).abs() < 2e-2);
        let whole = reduced(radiance.clone(), 60, 5);
        assert!((power(fine, &radiance) / power(LatLong { width: 12, height: 6 }, &whole) - 1.0).abs() < 1e-6);
    }

    #[test]
    fn a_bad_sky_has_a_sentence() {
        let sentence = |width, radiance| Environment::new(SOURCE, width, radiance).expect_err("bad").to_string();
        assert_eq!(sentence(3, vec![Vec3::ONE; 6]), "'clear' is 3x2 texels; a sky is twice as wide as high");
        assert!(sentence(0, Vec::new()).contains("0x0"));
        let mut radiance = vec![Vec3::ONE; 8];
        radiance[6].y = f32::NAN;
        assert_eq!(sentence(4, radiance.clone()), "'clear' holds a value that is no number, at texel (2, 1)");
        radiance[6].y = 1e38;
        assert_eq!(sentence(4, radiance), "'clear' holds a radiance above 1e12, at texel (2, 1)");
        assert_eq!(sentence(4, vec![Vec3::NEG_ONE; 8]), "'clear' is black everywhere: it lights nothing");
    }
}
