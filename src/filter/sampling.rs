//! What a GPU's sampler does, on the CPU: bilinear and trilinear interpolation.

use std::ops::{Add, Mul};

use glam::Vec2;

use crate::normal_map::Addressing;

/// The texel that stands at `index` of an axis of `size` texels, beyond its ends too.
pub fn address(index: i64, size: usize, addressing: Addressing) -> usize {
    match addressing {
        Addressing::Wrap => index.rem_euclid(size as i64) as usize,
        Addressing::Clamp => index.clamp(0, size as i64 - 1) as usize,
    }
}

/// The texels of one level.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Grid {
    /// Texels across.
    pub width: usize,
    /// Texels down.
    pub height: usize,
    /// What lies beyond an edge.
    pub addressing: Addressing,
}

impl Grid {
    /// The four texels around `uv` as `(row-major index, weight)`; the weights sum to 1.
    pub fn bilinear(self, uv: Vec2) -> [(usize, f32); 4] {
        let x = uv.x * self.width as f32 - 0.5;
        let y = uv.y * self.height as f32 - 0.5;
        let (fx, fy) = (x - x.floor(), y - y.floor());
        let columns = self.pair(x, self.width);
        let rows = self.pair(y, self.height);
        let index = |row: usize, column: usize| rows[row] * self.width + columns[column];
        [
            (index(0, 0), (1.0 - fx) * (1.0 - fy)),
            (index(0, 1), fx * (1.0 - fy)),
            (index(1, 0), (1.0 - fx) * fy),
            (index(1, 1), fx * fy),
        ]
    }

    fn pair(self, position: f32, size: usize) -> [usize; 2] {
        let first = position.floor() as i64;
        [first, first + 1].map(|index| address(index, size, self.addressing))
    }
}

/// Blends `at_level` of the two levels around `lod`, of `levels` levels in all.
pub fn trilinear<T: Add<Output = T> + Mul<f32, Output = T>>(
    lod: f32,
    levels: usize,
    at_level: impl Fn(usize) -> T,
) -> T {
    let lod = lod.clamp(0.0, (levels - 1) as f32);
    let level = lod as usize;
    let blend = lod - level as f32;
    if blend == 0.0 {
        return at_level(level);
    }
    at_level(level) * (1.0 - blend) + at_level(level + 1) * blend
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_texel_centre_reads_that_texel_alone() {
        let grid = Grid { width: 5, height: 3, addressing: Addressing::Wrap };
        let taps = grid.bilinear(Vec2::new(2.5 / 5.0, 1.5 / 3.0));
        let weight_of = |index: usize| taps.iter().filter(|t| t.0 == index).map(|t| t.1).sum::<f32>();
        assert!((weight_of(7) - 1.0).abs() < 1e-5);
    }

    #[test]
    fn a_wrapped_edge_reads_the_opposite_side_and_a_clamped_one_itself() {
        let at_corner = |addressing| Grid { width: 4, height: 4, addressing }.bilinear(Vec2::ZERO).map(|t| t.0);
        assert_eq!(at_corner(Addressing::Wrap), [15, 12, 3, 0]);
        assert_eq!(at_corner(Addressing::Clamp), [0, 0, 0, 0]);
    }
}
