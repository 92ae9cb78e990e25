//! Directions drawn by the sky's brightness, for supersampling.
//!
//! A row, then a texel of it, then a point in it are found by inverting the running sums of luminance times solid
//! angle at two numbers of a Kronecker sequence (Roberts 2018, of dimension four), whose every run is spread evenly. A
//! point is uniform over its texel's solid angle, so the density is the texel's luminance over the sky's.

use glam::Vec3;

use super::environment::LatLong;
use crate::color::luminance;

/// How many are drawn: as many as 128 x 128 texels hold.
pub const SAMPLES: usize = 16384;

/// `1 / p` and `1 / p^2` for the p with `p^5 = p + 1`; the truth's other numbers take further powers.
const STEP: [f64; 2] = [0.856_674_883_854_502_9, 0.733_891_856_627_126];

/// Of each texel the density per steradian; they integrate to 1 over the sphere.
pub fn density(grid: LatLong, radiance: &[Vec3]) -> Vec<f32> {
    let of_color = |color: &Vec3| f64::from(luminance(*color));
    let rows = radiance.chunks(grid.width).enumerate();
    let whole: f64 = rows.map(|(y, row)| grid.solid_angle(y) * row.iter().map(of_color).sum::<f64>()).sum();
    radiance.iter().map(|color| (of_color(color) / whole) as f32).collect()
}

/// [`SAMPLES`] unit vectors of that density.
pub fn draw(grid: LatLong, density: &[f32]) -> Vec<Vec3> {
    let rows: Vec<Running> = density.chunks(grid.width).map(Running::new).collect();
    let weights = rows.iter().enumerate().map(|(y, row)| grid.solid_angle(y) * row.total());
    let weights: Vec<f32> = weights.map(|weight| weight as f32).collect();
    let all = Running::new(&weights);
    let sample = |index: usize| {
        let [down, across] = STEP.map(|step| (0.5 + step * index as f64).fract());
        let (row, within) = all.invert(down);
        let (column, along) = rows[row].invert(across);
        let edges = [row, row + 1].map(|row| grid.edge_cosine(row));
        let polar = (edges[0] + within * (edges[1] - edges[0])).acos();
        let y = polar / std::f64::consts::PI * grid.height as f64;
        grid.direction(column as f64 + along, y).as_vec3()
    };
    (0..SAMPLES).map(sample).collect()
}

/// Running sums of weights.
struct Running(Vec<f64>);

impl Running {
    fn new(weights: &[f32]) -> Self {
        let mut sum = 0.0;
        let add = |weight: &f32| {
            sum += f64::from(*weight);
            sum
        };
        Self(weights.iter().map(add).collect())
    }

    fn total(&self) -> f64 {
        self.0.last().copied().unwrap_or(0.0)
    }

    /// The place that a share of the whole falls on, and how far into it, both by weight.
    fn invert(&self, share: f64) -> (usize, f64) {
        let wanted = share * self.total();
        let index = self.0.partition_point(|&sum| sum <= wanted).min(self.0.len() - 1);
        let before = if index == 0 { 0.0 } else { self.0[index - 1] };
        let weight = self.0[index] - before;
        (index, if weight > 0.0 { ((wanted - before) / weight).clamp(0.0, 1.0) } else { 0.5 })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_density_integrates_to_one_and_as_many_samples_fall_into_each_texel() {
        let grid = LatLong { width: 8, height: 4 };
        let radiance: Vec<Vec3> = (0..32).map(|index| Vec3::splat((index % 5) as f32)).collect();
        let density = density(grid, &radiance);
        let whole: f64 = grid.texels().map(|(_, angle, index)| angle * f64::from(density[index])).sum();
        assert!((whole - 1.0).abs() < 1e-6);
        let mut counts = [0.0; 32];
        for direction in draw(grid, &density) {
            counts[grid.texel(direction)] += 1.0 / SAMPLES as f64;
        }
        for (_, solid_angle, index) in grid.texels() {
            let expected = solid_angle * f64::from(density[index]);
            assert!((counts[index] - expected).abs() < 2e-3, "texel {index}: {} for {expected}", counts[index]);
        }
    }
}
