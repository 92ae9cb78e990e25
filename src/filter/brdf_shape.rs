//! What an effective BRDF looks like: where it is highest, how it falls off along a half circle through there, and its
//! values over the hemisphere seen from above.

use std::f64::consts::FRAC_PI_2;

use glam::{DVec2, DVec3};

use super::EffectiveBrdf;
use super::vmf::{Cancelled, Monitor};

/// A climb ends with steps of about a hundredth of a degree.
const FINEST_STEP: f64 = 2e-4;
/// A climb starts with steps of about five degrees: half the width of a highlight of s = 64 that nothing blurs.
const FIRST_STEP: f64 = 0.09;

/// From how many places climbs start, the highest that are so far from each other: where places are farther apart than
/// the highest peak is wide, the highest of them may stand on another.
const STARTS: usize = 16;
const APART: f64 = 2.0 * FIRST_STEP;

/// Where a function over the hemisphere is highest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Peak {
    /// A unit vector in tangent space.
    pub direction: DVec3,
    /// The value there, per steradian.
    pub height: f64,
}

impl Peak {
    /// The highest peak that climbs from some `places` come to; `None` where there are no places.
    pub fn new(brdf: &EffectiveBrdf<'_>, places: impl Iterator<Item = DVec3>) -> Option<Self> {
        let mut starts: Vec<Self> = places.map(|direction| Self { direction, height: brdf(direction) }).collect();
        starts.sort_by(|a, b| b.height.total_cmp(&a.height));
        let mut apart: Vec<Self> = Vec::new();
        for start in starts {
            if apart.len() < STARTS && apart.iter().all(|other| other.direction.distance(start.direction) > APART) {
                apart.push(start);
            }
        }
        apart.into_iter().map(|start| start.climbed(brdf)).max_by(|a, b| a.height.total_cmp(&b.height))
    }

    /// Steps to the highest place around until none is higher, then makes the steps shorter.
    fn climbed(mut self, brdf: &EffectiveBrdf<'_>) -> Self {
        let mut step = FIRST_STEP;
        while step > FINEST_STEP {
            let at = |direction: DVec3| Self { direction, height: brdf(direction) };
            let highest = around(self.direction, step).map(at).max_by(|a, b| a.height.total_cmp(&b.height));
            match highest.filter(|highest| highest.height > self.height) {
                Some(higher) => self = higher,
                None => step *= 0.5,
            }
        }
        self
    }
}

/// Eight directions a step away, those below the horizon left out.
fn around(direction: DVec3, step: f64) -> impl Iterator<Item = DVec3> {
    let (side, other) = direction.any_orthonormal_pair();
    let turned = move |eighth: u32| {
        let (sin, cos) = (f64::from(eighth) * std::f64::consts::FRAC_PI_4).sin_cos();
        (direction + step * (cos * side + sin * other)).normalize()
    };
    (0..8).map(turned).filter(|direction| direction.z >= 0.0)
}

/// The half circle over the pole `+z` that goes through a direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slice {
    /// Where the side lies whose angles are positive, from `+x` towards `+y`.
    pub azimuth_rad: f64,
    /// The direction's angle from the pole.
    pub theta_rad: f64,
}

impl Slice {
    /// Steps from horizon to horizon, half a degree each.
    const STEPS: i32 = 360;

    /// The slice through a direction of the hemisphere; through the pole, along x.
    pub fn through(direction: DVec3) -> Self {
        let across = direction.truncate();
        Self { azimuth_rad: across.y.atan2(across.x), theta_rad: across.length().atan2(direction.z) }
    }

    /// The direction at a signed angle from the pole.
    pub fn direction(&self, theta_rad: f64) -> DVec3 {
        let (sin, cos) = theta_rad.sin_cos();
        (sin * DVec2::from_angle(self.azimuth_rad)).extend(cos)
    }

    /// Signed angle from the pole in degrees and value, from horizon to horizon; the slice's own direction is among them.
    pub fn values(&self, brdf: &EffectiveBrdf<'_>) -> Vec<[f64; 2]> {
        let angle = |step: i32| FRAC_PI_2 * f64::from(2 * step - Self::STEPS) / f64::from(Self::STEPS);
        let mut angles: Vec<f64> = (0..=Self::STEPS).map(angle).chain([self.theta_rad]).collect();
        angles.sort_by(f64::total_cmp);
        angles.into_iter().map(|theta| [theta.to_degrees(), brdf(self.direction(theta))]).collect()
    }
}

/// The values over the hemisphere, seen from above as the sphere is: `+x` right, `+y` up.
#[derive(Clone, Debug, PartialEq)]
pub struct Disc {
    /// Pixels across and down.
    pub side: usize,
    /// Row by row from the top, per steradian; NaN outside the disc.
    pub values: Vec<f32>,
}

impl Disc {
    /// The direction in the middle of a pixel; `None` outside the disc.
    pub fn direction(side: usize, x: usize, y: usize) -> Option<DVec3> {
        let centred = |index: usize| (2 * index + 1) as f64 / side as f64 - 1.0;
        let point = DVec2::new(centred(x), -centred(y));
        let height = 1.0 - point.length_squared();
        (height >= 0.0).then(|| point.extend(height.sqrt()))
    }

    /// The function in every pixel.
    ///
    /// # Errors
    /// When it is cancelled.
    pub fn new(brdf: &EffectiveBrdf<'_>, side: usize, monitor: &Monitor) -> Result<Self, Cancelled> {
        let value = |index: usize| {
            monitor.check()?;
            let direction = Self::direction(side, index % side, index / side);
            Ok(direction.map_or(f32::NAN, |direction| brdf(direction) as f32))
        };
        Ok(Self { side, values: (0..side * side).map(value).collect::<Result<_, _>>()? })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sphere::direction::hemisphere;

    /// A narrow lobe and a lower, wide one.
    fn two_lobes(narrow: DVec3) -> EffectiveBrdf<'static> {
        Box::new(move |w| w.dot(narrow).max(0.0).powi(400) + 0.6 * w.dot(DVec3::new(0.0, -0.6, 0.8)).max(0.0).powi(8))
    }

    #[test]
    fn the_climb_ends_at_the_peak() {
        for narrow in [DVec3::new(0.3, 0.5, 0.7), DVec3::new(-0.9, 0.1, 0.05), DVec3::Z].map(DVec3::normalize) {
            let peak = Peak::new(&two_lobes(narrow), hemisphere(600)).expect("places");
            // Places are twice as far apart as the narrow lobe is wide. The wide one under it pulls its peak aside, by less
            // than a tenth of its width.
            assert!(peak.direction.distance(narrow) < 0.005, "{narrow}: {peak:?}");
            let higher = hemisphere(20_000).map(|w| two_lobes(narrow)(w)).fold(0.0, f64::max);
            assert!(peak.height >= higher && peak.direction.z >= 0.0);
        }
        assert_eq!(Peak::new(&two_lobes(DVec3::Z), std::iter::empty()), None);
    }

    #[test]
    fn the_slices_peak_is_the_peak_of_the_values() {
        let brdf = two_lobes(DVec3::new(0.3, 0.5, 0.7).normalize());
        let peak = Peak::new(&brdf, hemisphere(600)).expect("places");
        let slice = Slice::through(peak.direction);
        assert!(slice.direction(slice.theta_rad).distance(peak.direction) < 1e-12);
        let values = slice.values(&brdf);
        assert!(values.is_sorted_by(|a, b| a[0] <= b[0]) && values[0][0] == -90.0 && values[361][0] == 90.0);
        let highest = values.iter().fold([0.0; 2], |a, b| if b[1] > a[1] { *b } else { a });
        assert!((highest[1] - peak.height).abs() < 1e-12 * peak.height, "{highest:?} {peak:?}");
        assert!((highest[0] - slice.theta_rad.to_degrees()).abs() < 1e-9);
    }

    #[test]
    fn the_disc_shows_plus_x_right_and_plus_y_up() {
        let monitor = Monitor::new(Vec::new());
        for (axis, [x, y]) in [(DVec3::X, [62, 32]), (DVec3::Y, [32, 1]), (DVec3::Z, [32, 32])] {
            let disc = Disc::new(&(Box::new(move |w: DVec3| w.dot(axis)) as EffectiveBrdf<'_>), 64, &monitor);
            let disc = disc.expect("nobody cancels");
            assert!(disc.values[y * 64 + x] > 0.95, "{axis}: {}", disc.values[y * 64 + x]);
            assert!(disc.values[0].is_nan() && disc.values[64 * 64 - 1].is_nan());
        }
        monitor.cancel();
        assert_eq!(Disc::new(&two_lobes(DVec3::Z), 64, &monitor), Err(Cancelled));
    }
}
