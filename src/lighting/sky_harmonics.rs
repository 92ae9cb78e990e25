//! The sky as spherical harmonics: what lobes are shaded with (Han et al. 2007, section 8).
//!
//! Diffusely `B(mu) = sum_lm A_l rho_l L_lm Y_lm(mu)` (eq. 25, with Lambda_l taken into the zonal multipliers), where
//! `L_lm = int L Y_lm`. Specularly the same holds over half vectors (eq. 26): for a fixed direction o to the eye,
//! `L'_lm = int L(w_i) (w_i . w_h) Y_lm(w_h) dw_i`, which is the paper's integral over `w_h` with its factor
//! `4 (w_i . w_h)` taken back into `dw_i`, so that it is a sum over texels; the cosine is that of the facet that
//! mirrors, `n . w_i = w_h . w_i`, for only normals near `w_h` reflect.
//!
//! The view is fixed, so L' is kept for 16 x 16 directions to the eye, by polar angle and azimuth, and blended between
//! them; turning the sky turns the direction. Each is kept in a frame of its own, turned half way from `+z` to o: there
//! the half vectors of the plane through `+z` and o, hence what they mirror, stay where they are while o moves along
//! it. Between entries the blend is then within a percent for eyes above the horizon, where in one frame for all it
//! errs by more than ten; towards `-z` the half-way frame is torn apart, and the error grows to some percent.
//!
//! What bands are worth: how far lobes of kappa 60 are off the truth at s = 64, in the mean square, with the clear sky's
//! sun in the bands. With it apart ([`Sun`]) a plate on a sphere at s = 40 is off by a root mean square of 0.097 at
//! l* = 8 where it was off by 0.292.
//!
//! | l* | 2 | 4 | 6 | 8 | 10 | 12 |
//! | --- | --- | --- | --- | --- | --- | --- |
//! | clear | 0.697 | 0.503 | 0.323 | 0.186 | 0.116 | 0.080 |
//! | overcast | 0.291 | 0.049 | 0.035 | 0.032 | 0.032 | 0.032 |
//! | studio | 0.606 | 0.373 | 0.207 | 0.101 | 0.058 | 0.047 |

use std::f64::consts::PI;

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::environment::{LatLong, reduced};
use super::sun::Sun;
use crate::sphere::harmonics::{each_harmonic, harmonics_to};

/// The last band that is kept of the diffuse light: the Lambertian's next is `rho_10 = 7/1536`.
pub const DIFFUSE_BAND: usize = 8;
/// The last band that is kept of the specular light.
pub const MOST_BANDS: usize = 12;
/// Polar angles, and azimuths, of the table.
pub const VIEWS: usize = 16;
/// Rows of the sky that the sums run over.
const ROWS: usize = 64;

/// The harmonics of a sky, in the order of [`each_harmonic`].
#[derive(Clone, Debug, PartialEq)]
pub struct SkyHarmonics {
    /// `L_lm` to [`DIFFUSE_BAND`].
    pub diffuse: Vec<Vec3>,
    /// `L'_lm` of the sky without its sun.
    pub rest: Views,
    /// `L'_lm` of the whole sky, where it has a sun.
    pub whole: Option<Views>,
}

/// `L'_lm` to [`MOST_BANDS`] of every view: `[(row * VIEWS + column) * harmonics + lm]`.
#[derive(Clone, Debug, PartialEq)]
pub struct Views(pub Vec<Vec3>);

/// A part of the sky as a far light.
#[derive(Clone, Copy, Debug)]
pub struct Part {
    direction: DVec3,
    solid_angle: f64,
    radiance: DVec3,
}

impl From<&Sun> for Part {
    fn from(sun: &Sun) -> Self {
        Self { direction: sun.direction_in_sky.as_dvec3(), solid_angle: 1.0, radiance: sun.irradiance.as_dvec3() }
    }
}

/// The sky averaged down to `ROWS` rows.
pub fn parts(grid: LatLong, radiance: &[Vec3]) -> Vec<Part> {
    let radiance = reduced(radiance.to_vec(), grid.width, grid.height.div_ceil(ROWS));
    let height = ((radiance.len() / 2) as f64).sqrt() as usize;
    let part = |(direction, solid_angle, index): (DVec3, f64, usize)| {
        let radiance: Vec3 = radiance[index];
        Part { direction, solid_angle, radiance: radiance.as_dvec3() }
    };
    LatLong { width: 2 * height, height }.texels().map(part).collect()
}

impl SkyHarmonics {
    /// Projects a sky: its radiance without the sun, and that.
    pub fn new(grid: LatLong, rest: &[Vec3], sun: Option<&Sun>) -> Self {
        let parts = parts(grid, rest);
        let (mut diffuse, rest) = (diffuse(&parts), Views::new(&parts));
        let whole = sun.map(|sun| {
            let sun = Part::from(sun);
            let of_sun = project([(sun.direction, sun.solid_angle * sun.radiance)].into_iter(), DIFFUSE_BAND);
            diffuse.iter_mut().zip(of_sun).for_each(|(sum, value)| *sum += value);
            Views(rest.0.iter().zip(Views::new(&[sun]).0).map(|(rest, sun)| *rest + sun).collect())
        });
        Self { diffuse, rest, whole }
    }
}

impl Views {
    /// Projects a sky for every view.
    pub fn new(parts: &[Part]) -> Self {
        let views = (0..VIEWS * VIEWS).into_par_iter();
        Self(views.flat_map_iter(|index| specular(parts, view(index))).collect())
    }

    /// `L'_lm` for a direction to the eye, blended between the four views around it, to be read in [`half_way`]'s
    /// frame.
    pub fn towards(&self, to_eye: Vec3) -> Vec<Vec3> {
        let [column, row] =
            [to_eye.y.atan2(to_eye.x) / std::f32::consts::TAU, to_eye.z.clamp(-1.0, 1.0).acos() / std::f32::consts::PI]
                .map(|turn| turn * VIEWS as f32 - 0.5);
        let count = harmonics_to(MOST_BANDS);
        let mut sums = vec![Vec3::ZERO; count];
        for (dy, dx) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let share = |at: f32, step: usize| if step == 0 { 1.0 - (at - at.floor()) } else { at - at.floor() };
            let y = (row.floor() as i64 + dy as i64).clamp(0, VIEWS as i64 - 1) as usize;
            let x = (column.floor() as i64 + dx as i64).rem_euclid(VIEWS as i64) as usize;
            let weight = share(row, dy) * share(column, dx);
            let entry = &self.0[(y * VIEWS + x) * count..][..count];
            sums.iter_mut().zip(entry).for_each(|(sum, value)| *sum += weight * value);
        }
        sums
    }
}

/// The direction to the eye that an entry of the table stands for.
fn view(index: usize) -> DVec3 {
    let [column, row] = [index % VIEWS, index / VIEWS].map(|place| (place as f64 + 0.5) / VIEWS as f64);
    let ((sin_a, cos_a), (sin_p, cos_p)) = ((2.0 * PI * column).sin_cos(), (PI * row).sin_cos());
    DVec3::new(sin_p * cos_a, sin_p * sin_a, cos_p)
}

/// `direction` in the frame that is turned half way from `+z` to `to_eye`.
pub fn half_way(to_eye: DVec3, direction: DVec3) -> DVec3 {
    let axis = (to_eye + DVec3::Z).try_normalize().unwrap_or(DVec3::X);
    // The turn that takes the axis to +z: by the cross product of both, of length sin, and their cosine axis.z >= 0.
    let turn = DVec3::new(axis.y, -axis.x, 0.0);
    let moved = turn.cross(direction);
    direction + moved + turn.cross(moved) / (1.0 + axis.z)
}

/// `L'_lm` for one direction to the eye.
pub fn specular(parts: &[Part], to_eye: DVec3) -> Vec<Vec3> {
    let reflected = |part: &Part| {
        let half = (part.direction + to_eye).try_normalize()?;
        Some((half_way(to_eye, half), half.dot(to_eye) * part.solid_angle * part.radiance))
    };
    project(parts.iter().filter_map(reflected), MOST_BANDS)
}

/// `L_lm`. The mean radiance is left out of the sums and put in at the end, so that a constant sky has nothing above
/// band 0 but zeros.
fn diffuse(parts: &[Part]) -> Vec<Vec3> {
    let mean = parts.iter().map(|part| part.solid_angle * part.radiance).sum::<DVec3>() / (4.0 * PI);
    let rest = |part: &Part| (part.direction, part.solid_angle * (part.radiance - mean));
    let mut sums = project(parts.iter().map(rest), DIFFUSE_BAND);
    sums[0] += ((4.0 * PI).sqrt() * mean).as_vec3();
    sums
}

/// `sum_k power_k Y_lm(direction_k)` for `l <= last_band`.
fn project(powers: impl Iterator<Item = (DVec3, DVec3)>, last_band: usize) -> Vec<Vec3> {
    let mut sums = vec![DVec3::ZERO; harmonics_to(last_band)];
    for (direction, power) in powers {
        let mut next = sums.iter_mut();
        each_harmonic(direction, last_band, |_, value| {
            if let Some(sum) = next.next() {
                *sum += value * power;
            }
        });
    }
    sums.into_iter().map(DVec3::as_vec3).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lighting::{ProceduralSky, SkySource};
    use crate::sphere::harmonics::cosine_power_zonal;

    /// `sum_lm rho_l light_lm Y_lm(direction)` of a normal map that is flat.
    fn shaded(light: &[Vec3], rho: &[f64], direction: DVec3) -> DVec3 {
        let (mut sum, mut next) = (DVec3::ZERO, light.iter());
        each_harmonic(direction, rho.len() - 1, |l, value| {
            sum += next.next().map_or(DVec3::ZERO, |light| rho[l] * value * light.as_dvec3());
        });
        sum
    }

    #[test]
    fn the_half_way_frame_is_a_rotation_that_takes_the_bisector_to_the_pole() {
        for to_eye in (0..VIEWS * VIEWS).map(view) {
            let bisector = (to_eye + DVec3::Z).normalize();
            assert!((half_way(to_eye, bisector) - DVec3::Z).length() < 1e-12, "{to_eye}");
            let [x, y] = [DVec3::X, DVec3::Y].map(|axis| half_way(to_eye, axis));
            assert!((x.length() - 1.0).abs() < 1e-12 && x.dot(y).abs() < 1e-12, "{to_eye}");
            assert!((x.cross(y) - half_way(to_eye, DVec3::Z)).length() < 1e-12, "right-handed");
        }
    }

    #[test]
    fn a_constant_sky_has_its_mean_and_nothing_else() {
        let grid = LatLong { width: 32, height: 16 };
        let harmonics = SkyHarmonics::new(grid, &[Vec3::new(0.5, 1.0, 2.0); 512], None);
        assert!((harmonics.diffuse[0] / (4.0 * PI).sqrt() as f32 - Vec3::new(0.5, 1.0, 2.0)).length() < 1e-6);
        assert!(harmonics.diffuse[1..].iter().all(|light| light.length() < 1e-12));
    }

    /// Of every bundled sky, for eyes from 5 to 85 degrees above the horizon: the largest is 0.7 %.
    #[test]
    fn the_table_of_views_agrees_with_a_fresh_projection_within_two_percent() {
        let grid = LatLong { width: ProceduralSky::WIDTH, height: ProceduralSky::WIDTH / 2 };
        for sky in ProceduralSky::ALL {
            let radiance = sky.radiance();
            let parts = parts(grid, &radiance);
            let views = Views::new(&parts);
            for shininess in [10.0, 64.0] {
                let rho = cosine_power_zonal(shininess, MOST_BANDS + 1);
                let (mut off, mut whole) = (0.0, 0.0);
                for index in 0..16 {
                    let (sin_p, cos_p) = (5.0 + 5.3 * f64::from(index)).to_radians().sin_cos();
                    let (sin_a, cos_a) = (2.4 * f64::from(index)).sin_cos();
                    let to_eye = DVec3::new(sin_p * cos_a, sin_p * sin_a, cos_p);
                    let (blended, fresh) = (views.towards(to_eye.as_vec3()), specular(&parts, to_eye));
                    for normal in (0..64)
                        .map(|k| LatLong { width: 16, height: 8 }.direction(f64::from(k % 16), f64::from(k / 16)))
                    {
                        let normal = half_way(to_eye, normal);
                        let exact = shaded(&fresh, &rho, normal);
                        off += (shaded(&blended, &rho, normal) - exact).length_squared();
                        whole += exact.length_squared();
                    }
                }
                let error = (off / whole).sqrt();
                println!("{} at s {shininess}: {:.2} %", SkySource::Bundled(sky), 100.0 * error);
                assert!(error < 0.02, "{}, s {shininess}: {error}", sky.name());
            }
        }
    }
}
