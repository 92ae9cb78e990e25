//! Measured reflectance in the format of the MERL database (Matusik, Pfister, Brand and McMillan 2003).
//!
//! Three little-endian 32-bit integers, 90, 90 and 180, then a plane of doubles each for red, green and blue, theta_h
//! slowest and phi_d fastest. A plane's values times 1/1500, 1.15/1500 or 1.66/1500 are the BRDF per steradian; negative
//! ones were not measured. Bins of theta_h, the angle between normal and half vector, are equal steps of its square
//! root up to 90 degrees; theta_d, between half vector and light, goes in degrees; phi_d, the light's turn about the half
//! vector, in degrees up to 180, beyond which light and eye change places.

use std::f64::consts::{FRAC_PI_2, PI};

use super::Brdf;
use super::fresnel::fresnel;

/// Bins of theta_h.
pub const THETA_H: usize = 90;
/// Bins of theta_d.
pub const THETA_D: usize = 90;
/// Bins of phi_d.
pub const PHI_D: usize = 180;
/// Values of one channel.
pub const PLANE: usize = THETA_H * THETA_D * PHI_D;
/// Bytes of a file.
pub const FILE_BYTES: usize = 3 * size_of::<i32>() + 3 * PLANE * size_of::<f64>();
/// The largest value per steradian that is read: a mirror's peak is some thousands, and sums of squares stay finite.
pub const MOST: f64 = 1e12;
/// What a plane's values are multiplied by.
pub const SCALES: [f64; 3] = [1.0 / 1500.0, 1.15 / 1500.0, 1.66 / 1500.0];

/// Why bytes are no measured material. `name` is the file as the user gave it.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[expect(missing_docs, reason = "each field stands in the message")]
pub enum MerlError {
    /// The header names other sizes.
    #[error("'{name}' is not a MERL file: it should begin with the sizes 90, 90 and 180")]
    Header { name: String },
    /// The data ends early.
    #[error("'{name}' is cut short: a MERL file has {FILE_BYTES} bytes, this one {bytes}")]
    Truncated { name: String, bytes: usize },
    /// There is more data than the sizes account for.
    #[error("'{name}' is too long for a MERL file: {bytes} bytes in place of {FILE_BYTES}")]
    Oversized { name: String, bytes: usize },
    /// A value is infinite or no number.
    #[error("'{name}' is damaged: it holds values that are not finite")]
    NotFinite { name: String },
    /// A value is beyond all reflectance.
    #[error("'{name}' is damaged: it holds values above {MOST:e} per steradian")]
    TooLarge { name: String },
    /// A channel holds nothing that was measured.
    #[error("'{name}' holds no measured reflectance: a channel has no value above 0 where light and eye are above it")]
    Nothing { name: String },
}

/// A measured reflectance: three planes of BRDF values per steradian, negative where nothing was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Merl {
    /// Red, green and blue, [`PLANE`] values each.
    pub planes: [Vec<f64>; 3],
}

/// The middle of bin i of theta_h.
pub fn theta_h(bin: usize) -> f64 {
    ((bin as f64 + 0.5) / THETA_H as f64).powi(2) * FRAC_PI_2
}

/// The middle of bin i of theta_d.
pub fn theta_d(bin: usize) -> f64 {
    (bin as f64 + 0.5) / THETA_D as f64 * FRAC_PI_2
}

/// The middle of bin i of phi_d.
pub fn phi_d(bin: usize) -> f64 {
    (bin as f64 + 0.5) / PHI_D as f64 * PI
}

/// Cosines of light and eye with the normal in a bin's middle; below 0 the surface hides one from the other.
pub fn cosines(h: usize, d: usize, k: usize) -> [f64; 2] {
    let ((sin_h, cos_h), (sin_d, cos_d)) = (theta_h(h).sin_cos(), theta_d(d).sin_cos());
    let across = sin_h * sin_d * phi_d(k).cos();
    [cos_h * cos_d - across, cos_h * cos_d + across]
}

/// True where a plane holds a value above 0 that can be seen.
fn is_seen(plane: &[f64]) -> bool {
    let is_lit = |index: usize| {
        let (h, rest) = (index / (THETA_D * PHI_D), index % (THETA_D * PHI_D));
        cosines(h, rest / PHI_D, rest % PHI_D).iter().all(|&cosine| cosine > 0.0)
    };
    plane.iter().enumerate().any(|(index, &value)| value > 0.0 && is_lit(index))
}

impl Merl {
    /// Fills the bins of every channel with `value(theta_h, theta_d)` at their middles.
    pub fn of_angles(value: impl Fn(f64, f64) -> [f64; 3]) -> Self {
        let mut planes = [const { Vec::new() }; 3];
        for h in 0..THETA_H {
            for d in 0..THETA_D {
                let values = value(theta_h(h), theta_d(d));
                for (plane, value) in planes.iter_mut().zip(values) {
                    plane.extend(std::iter::repeat_n(value, PHI_D));
                }
            }
        }
        Self { planes }
    }

    /// A quarter of a model's f with a Fresnel factor of this strength, which gives back at most what it gets; of the
    /// Lambertian the constant 1/pi.
    pub fn of_brdf(model: Brdf, strength: f32) -> Self {
        Self::of_angles(|theta_h, theta_d| match model {
            Brdf::Lambert => [1.0 / PI; 3],
            _ => [0.25 * model.zonal(theta_h.cos()) * f64::from(fresnel(strength, theta_d.cos() as f32)); 3],
        })
    }

    /// Reads a whole file; `name` stands in the messages.
    ///
    /// # Errors
    /// One sentence that names the file and the cause.
    pub fn from_bytes(name: &str, bytes: &[u8]) -> Result<Self, MerlError> {
        let owned = || name.to_owned();
        let (header, data) = bytes.split_at(bytes.len().min(3 * size_of::<i32>()));
        let sizes = [THETA_H, THETA_D, PHI_D].map(|size| (size as i32).to_le_bytes());
        // A header that was cut off is a file that was cut short.
        if !sizes.concat().starts_with(header) || header.is_empty() {
            return Err(MerlError::Header { name: owned() });
        }
        match bytes.len() {
            FILE_BYTES => {}
            bytes if bytes < FILE_BYTES => return Err(MerlError::Truncated { name: owned(), bytes }),
            bytes => return Err(MerlError::Oversized { name: owned(), bytes }),
        }
        let (values, _) = data.as_chunks::<8>();
        let plane = |channel: usize| -> Vec<f64> {
            let stored = &values[channel * PLANE..(channel + 1) * PLANE];
            stored.iter().map(|&bytes| SCALES[channel] * f64::from_le_bytes(bytes)).collect()
        };
        let planes = [0, 1, 2].map(plane);
        if planes.iter().flatten().any(|value| !value.is_finite()) {
            return Err(MerlError::NotFinite { name: owned() });
        }
        if planes.iter().flatten().any(|&value| value > MOST) {
            return Err(MerlError::TooLarge { name: owned() });
        }
        if !planes.iter().all(|plane| is_seen(plane)) {
            return Err(MerlError::Nothing { name: owned() });
        }
        Ok(Self { planes })
    }

    /// The file's bytes.
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = Vec::with_capacity(FILE_BYTES);
        bytes.extend([THETA_H, THETA_D, PHI_D].into_iter().flat_map(|size| (size as i32).to_le_bytes()));
        for (plane, scale) in self.planes.iter().zip(SCALES) {
            bytes.extend(plane.iter().flat_map(|value| (value / scale).to_le_bytes()));
        }
        bytes
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn some() -> Merl {
        Merl::of_angles(|theta_h, theta_d| [(-theta_h).exp(), theta_d, 0.5])
    }

    #[test]
    fn a_file_reads_as_it_was_written() {
        let (written, bytes) = (some(), some().to_bytes());
        let read = Merl::from_bytes("a.binary", &bytes).expect("whole");
        for (a, b) in written.planes.iter().flatten().zip(read.planes.iter().flatten()) {
            assert!((a - b).abs() <= 1e-15 * a.abs());
        }
    }

    #[test]
    fn every_bad_file_gets_a_sentence_of_its_own() {
        let bytes = some().to_bytes();
        let refused = |bytes: &[u8]| Merl::from_bytes("a.binary", bytes).expect_err("bad").to_string();
        assert!(refused(&[]).contains("should begin with the sizes"));
        assert!(refused(b"\x89PNG, or so").contains("should begin with the sizes"));
        assert!(refused(&bytes[..7]).contains("cut short"));
        assert!(refused(&bytes[..bytes.len() - 1]).contains("this one 34992011"));
        assert!(refused(&[&bytes[..], &[0]].concat()).contains("too long"));
        let filled = |value: f64| [&bytes[..12], &value.to_le_bytes().repeat(3 * PLANE)].concat();
        assert!(refused(&filled(f64::NAN)).contains("not finite"));
        assert!(refused(&filled(f64::INFINITY)).contains("not finite"));
        assert!(refused(&filled(-1.0)).contains("no value above 0"));
        assert!(refused(&filled(1e300)).contains("above 1e12"));
        // The last bin: half vector and light lie in the surface, the light or the eye below it.
        let mut hidden = filled(0.0);
        for channel in 1..=3 {
            let end = 12 + 8 * channel * PLANE;
            hidden[end - 8..end].copy_from_slice(&1.0_f64.to_le_bytes());
        }
        assert!(refused(&hidden).contains("no value above 0"), "what no light reaches is not measured");
    }
}
