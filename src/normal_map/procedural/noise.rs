//! Random numbers that are a function of a place, and smooth noise made of them that repeats over the tile.

use std::f64::consts::TAU;

/// 64 well-mixed bits for a cell of a lattice: the finaliser of SplitMix64 (G. Steele, D. Lea and C. Flood, *Fast
/// Splittable Pseudorandom Number Generators*, 2014), applied once to each coordinate.
pub fn hash(x: i64, y: i64, seed: u64) -> u64 {
    mix(mix(mix(seed) ^ x.cast_unsigned()) ^ y.cast_unsigned())
}

fn mix(bits: u64) -> u64 {
    let bits = bits.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let bits = (bits ^ (bits >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let bits = (bits ^ (bits >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    bits ^ (bits >> 31)
}

/// A number from 0 (included) to 1 (excluded) for a cell.
pub fn uniform(x: i64, y: i64, seed: u64) -> f64 {
    // The top 53 bits are what an f64 holds exactly.
    (hash(x, y, seed) >> 11) as f64 / (1_u64 << 53) as f64
}

/// Two independent normally distributed numbers of variance 1 for a cell (G. Box and M. Muller, 1958).
pub fn gaussian_pair(x: i64, y: i64, seed: u64) -> (f64, f64) {
    // From 0 (excluded) to 1, so that the logarithm is finite.
    let radius = (-2.0 * (1.0 - uniform(x, y, seed)).ln()).sqrt();
    let angle = TAU * uniform(x, y, seed ^ 0xa5a5);
    (radius * angle.cos(), radius * angle.sin())
}

/// Smooth noise within about -1..1 with `cells.0` by `cells.1` lattice cells to the tile; its mean is 0. Value noise
/// with the quintic fade of K. Perlin, *Improving Noise* (2002): slope and curvature are 0 at the lattice points.
pub fn smooth(s: f64, t: f64, cells: (i64, i64), seed: u64) -> f64 {
    let (x, y) = (s * cells.0 as f64, t * cells.1 as f64);
    let (column, row) = (x.floor(), y.floor());
    let (u, v) = (fade(x - column), fade(y - row));
    let value = |dx: i64, dy: i64| {
        let (column, row) = (column as i64 + dx, row as i64 + dy);
        2.0 * uniform(column.rem_euclid(cells.0), row.rem_euclid(cells.1), seed) - 1.0
    };
    mix_between(mix_between(value(0, 0), value(1, 0), u), mix_between(value(0, 1), value(1, 1), u), v)
}

/// Octaves of [`smooth`], each twice as fine and half as strong as the one before: a rough surface.
pub fn rough(s: f64, t: f64, cells: (i64, i64), octaves: u32, seed: u64) -> f64 {
    (0..octaves)
        .map(|octave| {
            let finer = (cells.0 << octave, cells.1 << octave);
            smooth(s, t, finer, seed.wrapping_add(octave.into())) / f64::from(1_u32 << octave)
        })
        .sum()
}

/// A point of a jittered lattice over the tile.
pub struct NearestPoint {
    /// The point's lattice column and row within the tile.
    pub column: i64,
    pub row: i64,
    /// Its distance, in lattice cells.
    pub distance: f64,
}

/// The nearest point to `(s, t)` of a lattice of `cells` by `cells`, one point to a cell at a random place in it
/// (S. Worley, *A Cellular Texture Basis Function*, 1996; the eight cells around are searched, which may rarely miss
/// a nearer point further off).
pub fn nearest_point(s: f64, t: f64, cells: i64, seed: u64) -> NearestPoint {
    let (x, y) = (s * cells as f64, t * cells as f64);
    let (column, row) = (x.floor() as i64, y.floor() as i64);
    let mut nearest = NearestPoint { column, row, distance: f64::INFINITY };
    for (dx, dy) in (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy))) {
        let (in_tile_x, in_tile_y) = ((column + dx).rem_euclid(cells), (row + dy).rem_euclid(cells));
        let place = |cell: i64, seed: u64| cell as f64 + uniform(in_tile_x, in_tile_y, seed);
        let distance = (place(column + dx, seed) - x).hypot(place(row + dy, seed ^ 0x5a5a) - y);
        if distance < nearest.distance {
            nearest = NearestPoint { column: in_tile_x, row: in_tile_y, distance };
        }
    }
    nearest
}

/// `6 u^5 - 15 u^4 + 10 u^3`.
fn fade(u: f64) -> f64 {
    u * u * u * (u * (u * 6.0 - 15.0) + 10.0)
}

/// 0 below `low`, 1 above `high`, and between them a curve that is level at both ends.
pub fn smooth_step(low: f64, high: f64, value: f64) -> f64 {
    fade(((value - low) / (high - low)).clamp(0.0, 1.0))
}

/// `a` at 0, `b` at 1.
pub fn mix_between(a: f64, b: f64, share: f64) -> f64 {
    a + (b - a) * share
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn uniform_numbers_have_the_mean_and_variance_of_their_kind() {
        let count = 10_000;
        let (mut sum, mut squares) = (0.0, 0.0);
        for cell in 0..count {
            let value = uniform(cell % 100, cell / 100, 1) - 0.5;
            assert!((-0.5..0.5).contains(&value));
            sum += value;
            squares += value * value;
        }
        // Four standard errors: 0.289 / 100 for the mean, 0.0745 / 100 for the variance.
        assert!((sum / count as f64).abs() < 0.012);
        assert!((squares / count as f64 - 1.0 / 12.0).abs() < 0.003);
    }

    #[test]
    fn noise_repeats_over_the_tile() {
        for (s, t) in [(0.0, 0.0), (0.31, 0.99), (0.5, 0.25)] {
            let there = rough(s, t, (3, 5), 4, 9);
            assert!((rough(s + 1.0, t - 1.0, (3, 5), 4, 9) - there).abs() < 1e-9);
        }
    }
}
