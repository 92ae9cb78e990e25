//! A measured reflectance as a model: `scale f(theta_h) g(theta_d)` per channel (Han et al. 2007, section 4.3), f
//! normalised to integrate to 1, g of mean 1.
//!
//! f is filtered by its multipliers, or by lobes as [`super::projection`] fits them; the scale and g multiply
//! unfiltered. The scale is in the material's units, in which a white Lambertian has the diffuse strength 1: pi times
//! the BRDF. A measured reflectance holds the diffuse part too, as a floor of f.

use std::f64::consts::PI;
use std::sync::Mutex;

use glam::{DVec3, Vec3};

use super::factors::{self, Factors};
use super::kind::ModelKind;
use super::merl::{Merl, THETA_D, THETA_H};

/// `merl:FILE`.
pub static KIND: ModelKind = ModelKind {
    name: "merl",
    label: "Measured",
    tooltip: "Measured: f(theta_h) g(theta_d) of a file in the format of the MERL database, by channel (Han et al. 2007, \
              section 4.3).",
    parameter: None,
};

/// Weights of the channels where one value stands for all: Rec. 709's luminance.
const LUMINANCE: [f64; 3] = [0.2126, 0.7152, 0.0722];

/// A measured reflectance that was read.
#[derive(Debug, PartialEq)]
pub struct Measurement {
    /// Where it comes from.
    pub name: String,
    /// f by bin of theta_h, of each channel and of their luminance.
    pub f: [[f64; THETA_H]; 4],
    /// g by bin of theta_d, of each channel.
    pub g: [[f64; THETA_D]; 3],
    /// Factor on the product, of each channel.
    pub scale: [f64; 3],
    /// What the product leaves of the values, of each channel: a weighted root of squares over theirs.
    pub residual: [f64; 3],
    /// The exponent of the Blinn-Phong of the same width.
    exponent: f64,
}

/// The measurements read so far. They stay for the program's life, some 7 kB each: a material is copied as freely as its
/// other numbers are, and the same contents are kept once.
static READ: Mutex<Vec<&'static Measurement>> = Mutex::new(Vec::new());

/// Which zonal function of a measurement.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Channel(u8),
    Luminance,
}

/// A measured model: a handle on its measurement.
#[derive(Clone, Copy, Debug)]
pub struct Measured {
    measurement: &'static Measurement,
    part: Part,
}

impl PartialEq for Measured {
    fn eq(&self, other: &Self) -> bool {
        std::ptr::eq(self.measurement, other.measurement) && self.part == other.part
    }
}

impl Measured {
    /// Factors a measured reflectance; `name` says where it comes from.
    pub fn new(name: &str, measured: &Merl) -> Self {
        let measurement = Measurement::new(name, measured);
        // A thread that panicked cannot have left the list half done.
        let mut read = READ.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        let known = read.iter().copied().find(|known| **known == measurement);
        let measurement = known.unwrap_or_else(|| {
            let kept: &'static Measurement = Box::leak(Box::new(measurement));
            read.push(kept);
            kept
        });
        Self { measurement, part: Part::Luminance }
    }

    /// The measurement.
    pub fn measurement(self) -> &'static Measurement {
        self.measurement
    }

    /// The same of each channel alone.
    pub fn channels(self) -> [Self; 3] {
        [0, 1, 2].map(|channel| Self { part: Part::Channel(channel), ..self })
    }

    /// `f(u)`, which integrates to 1 over the sphere.
    pub fn zonal(self, cosine: f64) -> f64 {
        let part = match self.part {
            Part::Channel(channel) => usize::from(channel),
            Part::Luminance => 3,
        };
        factors::of_theta_h(&self.measurement.f[part], cosine.clamp(-1.0, 1.0).acos())
    }

    /// The exponent whose Blinn-Phong falls to half its peak at the same angle as the luminance, at least 1; the same for
    /// every channel.
    pub fn exponent(self) -> f64 {
        self.measurement.exponent
    }

    /// `scale g` per channel where light and half vector are apart by an angle of this cosine.
    pub fn factor(self, difference_cosine: f32) -> Vec3 {
        let angle = f64::from(difference_cosine.clamp(-1.0, 1.0)).acos();
        let channel = |c: usize| self.measurement.scale[c] * factors::of_theta_d(&self.measurement.g[c], angle);
        DVec3::from_array([0, 1, 2].map(channel)).as_vec3()
    }
}

impl Measurement {
    fn new(name: &str, measured: &Merl) -> Self {
        let all = [0, 1, 2].map(|channel| Factors::of_channel(measured, channel));
        let scale = [0, 1, 2].map(|c: usize| factors::integral(&all[c].f));
        let normalised = |c: usize| all[c].f.map(|value| value / scale[c]);
        let [r, g, b] = [0, 1, 2].map(normalised);
        let whole: f64 = (0..3).map(|c| LUMINANCE[c] * scale[c]).sum();
        let luminance = std::array::from_fn(|h| (0..3).map(|c| LUMINANCE[c] * all[c].f[h]).sum::<f64>() / whole);
        Self {
            name: name.to_owned(),
            exponent: exponent(&luminance),
            f: [r, g, b, luminance],
            g: [0, 1, 2].map(|c: usize| all[c].g),
            scale: scale.map(|scale| PI * scale),
            residual: [0, 1, 2].map(|c: usize| all[c].residual),
        }
    }
}

/// The exponent of the same width, at least 1, as f may not fall to half its peak at all.
fn exponent(f: &[f64; THETA_H]) -> f64 {
    let steps = 20_000;
    let angle = |i: i32| (f64::from(i) / f64::from(steps)).powi(2) * std::f64::consts::FRAC_PI_2;
    let half = 0.5 * factors::of_theta_h(f, 0.0);
    let fallen = (1..steps).map(angle).find(|&angle| factors::of_theta_h(f, angle) < half);
    fallen.map_or(1.0, |angle| (-std::f64::consts::LN_2 / angle.cos().ln()).max(1.0))
}
