//! A texel's NDF as something to look at: at most a few thousand weighted points, and a smooth density made of them.
//!
//! The density is a kernel estimate on the sphere, `sum_q weight_q k(|n - n_q|)` (Hall, Watson and Cabrera 1987),
//! held in an octahedral grid (Cigolle et al. 2014). It is a picture of the data, not a fit: the kernel is as narrow
//! as the grid and the number of normals allow.

use glam::{DVec2, DVec3, Vec3};

/// Cells along each side of the density's octahedral grid; one spans about 0.7 degrees at the pole.
pub const DENSITY_SIZE: usize = 256;

/// The most points a picture holds; larger footprints are merged cell by cell.
pub const MAX_POINTS: usize = 8192;

/// Standard deviations of the kernel, in degrees: no narrower than a grid can hold, no wider than is of use.
const KERNEL_DEG: [f64; 2] = [1.6, 9.0];

/// Where a direction falls in the octahedral square `0..1` by `0..1`; `+z` is its centre.
pub fn octahedral_from_direction(direction: DVec3) -> DVec2 {
    let flat = direction / (direction.x.abs() + direction.y.abs() + direction.z.abs());
    let sign = DVec2::new(1.0_f64.copysign(flat.x), 1.0_f64.copysign(flat.y));
    let folded = DVec2::new(1.0 - flat.y.abs(), 1.0 - flat.x.abs()) * sign;
    let square = if flat.z >= 0.0 { flat.truncate() } else { folded };
    square * 0.5 + 0.5
}

/// The unit direction of a point of the octahedral square.
pub fn direction_from_octahedral(point: DVec2) -> DVec3 {
    let square = point * 2.0 - 1.0;
    let z = 1.0 - square.x.abs() - square.y.abs();
    let fold = (-z).max(0.0);
    let unfolded = square - DVec2::new(fold.copysign(square.x), fold.copysign(square.y));
    unfolded.extend(z).normalize()
}

/// A texel's NDF, ready to be drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct NdfPicture {
    /// Unit directions with weights that sum to 1; every normal of a small footprint, merged neighbours of a large one.
    pub points: Vec<(DVec3, f64)>,
    /// Density per steradian at the cell centres, row by row, [`DENSITY_SIZE`] squared.
    pub density: Vec<f32>,
    /// The largest of them.
    pub peak: f32,
    /// Concentration of the kernel.
    pub kernel_kappa: f64,
}

impl NdfPicture {
    /// Prepares the picture of unit normals whose weights sum to 1, such as [`Ndf::samples`](crate::ndf::Ndf::samples).
    pub fn new(samples: impl IntoIterator<Item = (DVec3, f64)>) -> Self {
        let mut tally = Tally::default();
        let points = merge(samples.into_iter().inspect(|sample| tally.add(*sample)));
        let kernel_kappa = tally.kernel_kappa();
        let density = splat(&points, kernel_kappa);
        let peak = density.iter().copied().fold(f32::MIN_POSITIVE, f32::max);
        Self { points, density, peak, kernel_kappa }
    }

    /// The smooth density in one direction, per steradian, by the whole sum.
    pub fn density_at(&self, direction: DVec3) -> f64 {
        let chord = |point: &DVec3| (direction - *point).length_squared() as f32;
        let kernel = |point: &DVec3| f64::from(kernel(self.kernel_kappa as f32, chord(point)));
        self.points.iter().map(|(point, weight)| weight * kernel(point)).sum()
    }

    /// Standard deviation of the kernel, in degrees.
    pub fn kernel_deg(&self) -> f64 {
        self.kernel_kappa.sqrt().recip().to_degrees()
    }
}

/// What the kernel's width depends on.
#[derive(Default)]
struct Tally {
    mean: DVec3,
    squared_weights: f64,
}

impl Tally {
    fn add(&mut self, (normal, weight): (DVec3, f64)) {
        self.mean += weight * normal;
        self.squared_weights += weight * weight;
    }

    /// Half of Silverman's width for two dimensions, `sigma n^(-1/6)`, because an NDF has several modes as a rule.
    fn kernel_kappa(&self) -> f64 {
        let spread = (1.0 - self.mean.length()).max(0.0).sqrt();
        let width = 0.5 * spread * self.squared_weights.powf(1.0 / 6.0);
        width.clamp(KERNEL_DEG[0].to_radians(), KERNEL_DEG[1].to_radians()).powi(-2)
    }
}

/// At most [`MAX_POINTS`] points: the samples themselves, or else merged by the smallest octahedral cells that serve.
fn merge(samples: impl Iterator<Item = (DVec3, f64)>) -> Vec<(DVec3, f64)> {
    let mut samples = samples.peekable();
    let points: Vec<_> = samples.by_ref().take(MAX_POINTS).collect();
    if samples.peek().is_none() {
        return points;
    }
    let mut cells = Cells::of(512, points.into_iter().chain(samples));
    while cells.used() > MAX_POINTS {
        cells = cells.coarser();
    }
    cells.points()
}

/// Sums of weight and of weighted normals by octahedral cell, `side` squared of them.
struct Cells {
    side: usize,
    sums: Vec<(DVec3, f64)>,
}

impl Cells {
    fn of(side: usize, points: impl IntoIterator<Item = (DVec3, f64)>) -> Self {
        let mut cells = Self { side, sums: vec![(DVec3::ZERO, 0.0); side * side] };
        for (direction, weight) in points {
            let position = (octahedral_from_direction(direction) * side as f64).floor();
            let limit = side - 1;
            let index = (position.y as usize).min(limit) * side + (position.x as usize).min(limit);
            cells.add(index, (weight * direction, weight));
        }
        cells
    }

    fn add(&mut self, index: usize, (sum, weight): (DVec3, f64)) {
        self.sums[index].0 += sum;
        self.sums[index].1 += weight;
    }

    fn coarser(&self) -> Self {
        let side = self.side / 2;
        let mut coarse = Self { side, sums: vec![(DVec3::ZERO, 0.0); side * side] };
        for (index, &cell) in self.sums.iter().enumerate() {
            coarse.add(index / self.side / 2 * side + index % self.side / 2, cell);
        }
        coarse
    }

    fn used(&self) -> usize {
        self.sums.iter().filter(|cell| cell.1 > 0.0).count()
    }

    fn points(&self) -> Vec<(DVec3, f64)> {
        let used = self.sums.iter().filter(|cell| cell.1 > 0.0);
        used.map(|&(sum, weight)| (sum.try_normalize().unwrap_or(DVec3::Z), weight)).collect()
    }
}

/// The kernel `9 kappa / (16 pi) max(1 - kappa d^2 / 16, 0)^8` of squared chord `d^2`: `exp(-kappa d^2 / 2)` with an
/// end, at four standard deviations. It integrates to 1 over the sphere for kappa >= 4, since `d^2 = 2 - 2 cos`.
fn kernel(kappa: f32, squared_chord: f32) -> f32 {
    let base = (1.0 - kappa * squared_chord / 16.0).max(0.0);
    let fourth = (base * base) * (base * base);
    9.0 * kappa / (16.0 * std::f32::consts::PI) * (fourth * fourth)
}

/// Cell centres, an array per component so that a row of kernels is evaluated several cells at a time.
struct CellCentres {
    x: Vec<f32>,
    y: Vec<f32>,
    z: Vec<f32>,
}

impl CellCentres {
    fn new() -> Self {
        let directions = cell_directions();
        let component = |pick: fn(&DVec3) -> f64| directions.iter().map(|d| pick(d) as f32).collect();
        Self { x: component(|d| d.x), y: component(|d| d.y), z: component(|d| d.z) }
    }

    fn squared_chord(&self, index: usize, point: Vec3) -> f32 {
        let (x, y, z) = (self.x[index] - point.x, self.y[index] - point.y, self.z[index] - point.z);
        x * x + y * y + z * z
    }
}

/// Adds every point's kernel to the cells it reaches. Points much closer than the kernel is wide are merged first.
fn splat(points: &[(DVec3, f64)], kappa: f64) -> Vec<f32> {
    let cells_per_sigma = 3.0 / 2.0 * kappa.sqrt();
    let side = (cells_per_sigma.log2().ceil().exp2() as usize).clamp(16, 512);
    let merged = Cells::of(side, points.iter().copied()).points();
    let centres = CellCentres::new();
    let mut density = vec![0.0_f32; DENSITY_SIZE * DENSITY_SIZE];
    // A radian spans at most size / sqrt(2) cells along either side of the octahedral square.
    let reach = (4.0 / kappa.sqrt() * DENSITY_SIZE as f64 * 0.75).ceil() as i64;
    for (point, weight) in merged {
        splat_point(&mut density, &centres, reach, kappa as f32, (point, weight as f32));
    }
    density
}

fn splat_point(density: &mut [f32], centres: &CellCentres, reach: i64, kappa: f32, (point, weight): (DVec3, f32)) {
    let size = DENSITY_SIZE as i64;
    let centre = (octahedral_from_direction(point) * DENSITY_SIZE as f64).floor();
    let around = |cell: f64| cell as i64 - reach..cell as i64 + reach + 1;
    let inside = |cells: &std::ops::Range<i64>| cells.start >= 0 && cells.end <= size;
    // Past an edge the square folds onto itself; the few points near one are added everywhere instead.
    let (columns, rows) = match (around(centre.x), around(centre.y)) {
        (columns, rows) if inside(&columns) && inside(&rows) => (columns, rows),
        _ => (0..size, 0..size),
    };
    let point = point.as_vec3();
    for row in rows {
        let first = (row * size + columns.start) as usize;
        let cells = &mut density[first..(row * size + columns.end) as usize];
        for (offset, cell) in cells.iter_mut().enumerate() {
            *cell += weight * kernel(kappa, centres.squared_chord(first + offset, point));
        }
    }
}

fn cell_directions() -> Vec<DVec3> {
    let size = DENSITY_SIZE as f64;
    let centre =
        |index: usize| DVec2::new((index % DENSITY_SIZE) as f64 + 0.5, (index / DENSITY_SIZE) as f64 + 0.5) / size;
    (0..DENSITY_SIZE * DENSITY_SIZE).map(|index| direction_from_octahedral(centre(index))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::sphere::direction::hemisphere;

    #[test]
    fn the_octahedral_square_holds_every_direction_once() {
        for direction in hemisphere(500).flat_map(|d| [d, -d]) {
            let back = direction_from_octahedral(octahedral_from_direction(direction));
            assert!((back - direction).length() < 1e-12, "{direction}: {back}");
        }
    }

    #[test]
    fn the_grid_holds_the_whole_sum() {
        let samples: Vec<_> = hemisphere(60).map(|d| (d, 1.0 / 60.0)).collect();
        let picture = NdfPicture::new(samples);
        let directions = cell_directions();
        let worst = (0..directions.len())
            .step_by(37)
            .map(|i| (f64::from(picture.density[i]) - picture.density_at(directions[i])).abs())
            .fold(0.0, f64::max);
        // Merging moves a normal by at most a third of a standard deviation, and here it moves none.
        assert!(worst < 1e-4 * f64::from(picture.peak), "{worst} of {}", picture.peak);
    }

    #[test]
    fn the_density_integrates_to_one() {
        let samples: Vec<_> = hemisphere(300).map(|d| (d, 1.0 / 300.0)).collect();
        let picture = NdfPicture::new(samples);
        let count = 20_000;
        let mean = |side: f64| hemisphere(count).map(|d| picture.density_at(side * d)).sum::<f64>() / count as f64;
        let integral = std::f64::consts::TAU * (mean(1.0) + mean(-1.0));
        assert!((integral - 1.0).abs() < 0.01, "{integral}");
    }

    #[test]
    fn merging_keeps_the_weight_and_the_mean() {
        let count = 100_000;
        let merged = merge(hemisphere(count).map(|d| (d, 1.0 / count as f64)));
        assert!(merged.len() <= MAX_POINTS && merged.len() > 1000, "{}", merged.len());
        let mean: DVec3 = merged.iter().map(|(d, weight)| *weight * *d).sum();
        assert!((merged.iter().map(|p| p.1).sum::<f64>() - 1.0).abs() < 1e-9);
        assert!((mean - DVec3::new(0.0, 0.0, 0.5)).length() < 1e-3, "{mean}");
    }

    #[test]
    fn a_single_normal_is_one_sharp_spot() {
        let picture = NdfPicture::new([(DVec3::Z, 1.0)]);
        assert_eq!(picture.points.len(), 1);
        assert!(picture.peak > 100.0);
    }
}
