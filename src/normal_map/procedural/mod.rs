//! The program's own maps: made from a few formulas, the same on every machine, tiling, at any size.
//!
//! A map is a height over the tile or a normal per texel. Its normals are rounded to 8 bits and decoded again like a
//! file's, so that a bundled map and the PNG that is written from it hold the same normals.

mod bricks;
mod brushed;
mod flakes;
mod noise;
mod plate;
mod pyramid5;
mod scales;
mod v_groove;
mod waves;

use glam::DVec3;
use rayon::prelude::*;

use super::decode::from_known_normals;
use super::{MapOptions, MapSource, NormalMap};
use crate::image_io::{RasterImage, SampleDepth, Samples};

/// The bundled map that opens where no file is given.
pub const DEFAULT_SAMPLE: &str = "plate";

/// Texels along a side of a bundled map where no size is asked for.
pub const DEFAULT_SIZE: usize = 512;

/// Every bundled map, in the order they are listed.
pub const SAMPLES: &[Sample] = &[
    plate::SAMPLE,
    bricks::SAMPLE,
    pyramid5::SAMPLE,
    v_groove::SAMPLE,
    scales::SAMPLE,
    brushed::SAMPLE,
    waves::SAMPLE,
    flakes::SAMPLE,
];

/// A bundled map.
#[derive(Clone, Copy, Debug)]
pub struct Sample {
    /// What it is called on the command line and in the window.
    pub name: &'static str,
    /// What it shows, in one line without a full stop.
    pub description: &'static str,
    surface: Surface,
}

/// What a bundled map is made from.
#[derive(Clone, Copy, Debug)]
enum Surface {
    /// The height at `(s, t)`, in tile widths; `s` right and `t` up, both of period 1.
    Height(fn(f64, f64) -> f64),
    /// The normal of a texel, of any length above 0, in tangent space.
    Normal(fn(Place) -> DVec3),
}

/// A texel of a square map.
#[derive(Clone, Copy, Debug)]
struct Place {
    /// Column from the left.
    x: usize,
    /// Row from the top.
    y: usize,
    /// Texels along a side.
    size: usize,
}

impl Place {
    /// The texel's centre: `s` right and `t` up, from 0 to 1 over the tile.
    fn centre(self) -> (f64, f64) {
        let size = self.size as f64;
        ((self.x as f64 + 0.5) / size, 1.0 - (self.y as f64 + 0.5) / size)
    }
}

/// The map that opens when none is named.
pub fn default_map() -> NormalMap {
    find(DEFAULT_SAMPLE).unwrap_or(&SAMPLES[0]).make(DEFAULT_SIZE)
}

/// Finds a bundled map by its name.
pub fn find(name: &str) -> Option<&'static Sample> {
    SAMPLES.iter().find(|sample| sample.name == name)
}

impl Sample {
    /// Makes the map with `size` texels along each side (at least 1).
    pub fn make(&self, size: usize) -> NormalMap {
        let source = MapSource::Bundled(self.name);
        from_known_normals(self.image(size), source, &MapOptions::default())
    }

    /// The map as an image of 8-bit red, green and blue, as `sample NAME -o FILE` writes it.
    pub fn image(&self, size: usize) -> RasterImage {
        let size = size.max(1);
        let normals = match self.surface {
            Surface::Height(height) => normals_of_height(height, size),
            Surface::Normal(normal) => each_texel(size, normal),
        };
        RasterImage {
            width: size,
            height: size,
            channels: 3,
            has_alpha: false,
            samples: Samples::U8(normals.into_iter().flat_map(to_rgb8).collect()),
            depth: SampleDepth::Bits8,
            format: "bundled",
            tagged_srgb: false,
        }
    }
}

/// `round((n + 1) / 2 * 255)`, the inverse of the decoding up to rounding.
fn to_rgb8(normal: DVec3) -> [u8; 3] {
    let code = |component: f64| ((component + 1.0) / 2.0 * 255.0).round() as u8;
    normal.normalize().to_array().map(code)
}

/// A value for every texel, row by row from the top.
fn each_texel<T: Send>(size: usize, value: impl Fn(Place) -> T + Sync) -> Vec<T> {
    let place = |texel: usize| Place { x: texel % size, y: texel / size, size };
    (0..size * size).into_par_iter().map(|texel| value(place(texel))).collect()
}

/// Normals of the height's mean slope over each texel, by the trapezium rule along its four edges: only the heights
/// at the corners are needed, and texels share them.
fn normals_of_height(height: fn(f64, f64) -> f64, size: usize) -> Vec<DVec3> {
    let scale = 1.0 / size as f64;
    // The top-left corner of every texel; the tile repeats beyond.
    let corners = each_texel(size, |place| height(place.x as f64 * scale, 1.0 - place.y as f64 * scale));
    each_texel(size, |Place { x, y, .. }| {
        let (right, below) = ((x + 1) % size, (y + 1) % size);
        let h = |x: usize, y: usize| corners[y * size + x];
        let (h_tl, h_tr, h_bl, h_br) = (h(x, y), h(right, y), h(x, below), h(right, below));
        let slope_right = (h_tr + h_br - h_tl - h_bl) / (2.0 * scale);
        let slope_up = (h_tl + h_tr - h_bl - h_br) / (2.0 * scale);
        DVec3::new(-slope_right, -slope_up, 1.0)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_bundled_map_is_valid_at_any_size() {
        for sample in SAMPLES {
            for size in [1, 2, 7, 64, 100] {
                let map = sample.make(size);
                assert_eq!((map.width, map.height, map.invalid), (size, size, 0), "{}", sample.name);
                assert!(map.warnings.is_empty(), "{}: {:?}", sample.name, map.warnings);
            }
        }
    }

    #[test]
    fn names_are_unique_and_the_default_is_one_of_them() {
        for sample in SAMPLES {
            assert_eq!(SAMPLES.iter().filter(|other| other.name == sample.name).count(), 1);
            assert!(!sample.description.ends_with('.'));
        }
        assert!(find(DEFAULT_SAMPLE).is_some());
        assert!(find("no such map").is_none());
    }

    #[test]
    fn a_bundled_map_is_the_same_every_time() {
        for sample in SAMPLES {
            assert_eq!(sample.image(33), sample.image(33));
        }
    }

    #[test]
    fn heights_repeat_over_the_tile() {
        for sample in SAMPLES {
            let Surface::Height(height) = sample.surface else {
                continue;
            };
            for (s, t) in [(0.0, 0.3), (0.7, 0.0), (0.123, 0.456)] {
                let there = height(s, t);
                for (ds, dt) in [(1.0, 0.0), (0.0, 1.0), (-1.0, 1.0)] {
                    let again = height(s + ds, t + dt);
                    assert!((again - there).abs() < 1e-9, "{} at {s}, {t}", sample.name);
                }
            }
        }
    }

    #[test]
    fn a_slope_that_rises_to_the_right_and_up_leans_left_and_down() {
        // A sine's steepest rise at s = 0 lies on the left edge of the tile, and so for t at the bottom edge.
        let height = |s: f64, t: f64| 0.1 * ((std::f64::consts::TAU * s).sin() + (std::f64::consts::TAU * t).sin());
        let normals = normals_of_height(height, 64);
        let bottom_left = normals[63 * 64];
        assert!(bottom_left.x < -0.6 && bottom_left.y < -0.6, "{bottom_left}");
    }
}
