//! The squared distance of [`super::phi`] for one material as a function of the stored channels, a place a lane.
//!
//! A lobe `(alpha, m = alpha r)` looks like `alpha v(w; a r)` under a material of mean cosine a ([`super::looks`]). With
//! `rho = |r|`, `mu = r / rho`, `u = mu_j.mu_k` and `V = v(u; K)`, `A(K) = a^2 rho_j rho_k`, the integral of two such
//! lobes' product is `alpha_j alpha_k V`, and of a lobe and the true look `alpha sum_i w_i v(n_i.mu; K)`,
//! `A(K) = a^2 rho`. What is linear in the channels of both is found by the operators `1 - rho d/drho` for alpha and
//! `d/dr` for m, on either side; since `alpha v` is homogeneous of degree one in the channels x, products H of
//! derivatives give the mixture's square as `x'Hx` and half its gradient as `Hx`.

#![expect(clippy::needless_range_loop, reason = "lanes of several arrays are walked by one index, which vectorises")]

use std::f32::consts::LOG2_E;

use multiversion::multiversion;
use multiversion::target::target_cfg_f;

use super::channel_lobes::ChannelLobes;
use super::crowd_system::{CrowdSystem, EACH, Part, Tile};
use super::lane_width::LaneWidth;
use super::lanes::{LANES, Lanes, exp_of_negative, exp2_of_negative, mul_add, window};
use super::looks::MEAN_COSINE;
use super::phi::pair_index;
use crate::sphere::mixture::MAX_LOBES;

const ZERO: Lanes = Lanes::splat(0.0);

/// a^2.
const MOMENT: f32 = (MEAN_COSINE * MEAN_COSINE) as f32;

/// `1 - a^2`.
const REST: f32 = (1.0 - MEAN_COSINE * MEAN_COSINE) as f32;

/// `1 - a^2 rho_j rho_k`, of terms that are all positive: it keeps the digits that a product near 1 has lost.
#[inline(always)]
fn shortfall(rho_j: f32, rho_k: f32) -> f32 {
    REST + MOMENT * ((1.0 - rho_j) + rho_j * (1.0 - rho_k))
}

/// Normals beside each other: the first of the place in every lane, then the second; `stride` apart.
#[derive(Clone, Copy, Debug)]
pub struct NormalWindow<'a> {
    /// By axis, then weights, which sum to 1 in every lane.
    pub columns: [&'a [f32]; 4],
    /// From one normal of a place to the next.
    pub stride: usize,
    /// Where the first lane is.
    pub start: usize,
}

/// Phi of the places and the equations of a step.
#[derive(Clone, Debug, Default)]
pub struct ChannelPhi {
    /// The squared distance, up to the true look's square.
    pub phi: Lanes,
    /// Half its gradient, and the products of derivatives.
    pub system: CrowdSystem,
    data: [Part; MAX_LOBES],
    model: [Part; MAX_LOBES],
}

impl ChannelPhi {
    /// Evaluates the squared distance of `lobes` from the mean look of the windows' normals.
    pub fn move_to(&mut self, lobes: &ChannelLobes, windows: &[NormalWindow]) {
        self.system.count = lobes.count;
        self.phi = ZERO;
        data_terms(self, lobes, windows);
        products(self, lobes);
    }
}

/// Every lobe on the normals: the data's share of the gradient, and of the squared distance.
#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
fn data_terms(own: &mut ChannelPhi, lobes: &ChannelLobes, windows: &[NormalWindow]) {
    const FMA: bool = target_cfg_f!(any(target_feature = "fma", target_arch = "aarch64"));
    let share = 1.0 / windows.len() as f32;
    for j in 0..lobes.count {
        let mut factor = ZERO;
        for i in 0..LANES {
            factor.0[i] = -0.5 * LOG2_E * LaneWidth::of_shortfall::<FMA>(shortfall(lobes.rho[j].0[i], 1.0)).kappa;
        }
        let mut sums = [ZERO; 4];
        for window in windows {
            sum_densities::<FMA>(window, &lobes.mu[j], &factor, &mut sums);
        }
        let ([mx, my, mz], [value, dx, dy, dz], part) = (&lobes.mu[j], &sums, &mut own.data[j]);
        for i in 0..LANES {
            let rho = lobes.rho[j].0[i];
            let width = LaneWidth::of_shortfall::<FMA>(shortfall(rho, 1.0));
            let used = lobes.channels[j][0].0[i] > 0.0;
            let scale = if used { share * width.peak } else { 0.0 };
            let value = scale * value.0[i];
            let (dx, dy, dz) = (scale * dx.0[i], scale * dy.0[i], scale * dz.0[i]);
            let along = dx * mx.0[i] + dy * my.0[i] + dz * mz.0[i];
            // dv/dK = v (n.mu - A), and n.mu = 1 + (n - mu).mu.
            let by_rho = MOMENT / width.slope * (width.shortfall * value + along);
            let turn = width.kappa / rho;
            let radial = by_rho - turn * along;
            part[0].0[i] = value - rho * by_rho;
            part[1].0[i] = radial * mx.0[i] + turn * dx;
            part[2].0[i] = radial * my.0[i] + turn * dy;
            part[3].0[i] = radial * mz.0[i] + turn * dz;
            own.phi.0[i] -= 2.0 * lobes.channels[j][0].0[i] * value;
        }
    }
}

/// Adds `sum_i w_i e_i` and `sum_i w_i e_i (n_i - mu)`, with `e = exp(-K |n - mu|^2 / 2)`.
#[inline(always)]
fn sum_densities<const FMA: bool>(
    normals: &NormalWindow<'_>,
    [mx, my, mz]: &[Lanes; 3],
    factor: &Lanes,
    sums: &mut [Lanes; 4],
) {
    let mut acc = *sums;
    let (mx, my, mz, factor) = (*mx, *my, *mz, *factor);
    let [xs, ys, zs, ws] = normals.columns;
    for at in (normals.start..xs.len()).step_by(normals.stride) {
        let (x, y, z, w) = (window(xs, at), window(ys, at), window(zs, at), window(ws, at));
        for i in 0..LANES {
            let (dx, dy, dz) = (x[i] - mx.0[i], y[i] - my.0[i], z[i] - mz.0[i]);
            let chord = mul_add::<FMA>(dz, dz, mul_add::<FMA>(dy, dy, dx * dx));
            let value = w[i] * exp2_of_negative::<FMA>(factor.0[i] * chord);
            acc[0].0[i] += value;
            acc[1].0[i] = mul_add::<FMA>(value, dx, acc[1].0[i]);
            acc[2].0[i] = mul_add::<FMA>(value, dy, acc[2].0[i]);
            acc[3].0[i] = mul_add::<FMA>(value, dz, acc[3].0[i]);
        }
    }
    *sums = acc;
}

/// The products of all lobes' derivatives, and what they make of the gradient and the squared distance.
#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
fn products(own: &mut ChannelPhi, lobes: &ChannelLobes) {
    const FMA: bool = target_cfg_f!(any(target_feature = "fma", target_arch = "aarch64"));
    let count = lobes.count;
    own.model[..count].fill([ZERO; EACH]);
    for k in 0..count {
        for j in 0..=k {
            let tile = pair_products::<FMA>(lobes, (j, k));
            add_times::<FMA, false>(&tile, &lobes.channels[k], &mut own.model[j]);
            if j < k {
                add_times::<FMA, true>(&tile, &lobes.channels[j], &mut own.model[k]);
            }
            own.system.tiles[pair_index(j, k)] = tile;
        }
    }
    for j in 0..count {
        let (model, data, channels) = (&own.model[j], &own.data[j], &lobes.channels[j]);
        let (mut phi, mut right) = (own.phi, [ZERO; EACH]);
        for i in 0..LANES {
            for p in 0..EACH {
                right[p].0[i] = model[p].0[i] - data[p].0[i];
                phi.0[i] += model[p].0[i] * channels[p].0[i];
            }
        }
        (own.phi, own.system.right[j]) = (phi, right);
    }
}

/// `out += tile x`, or with the tile transposed.
#[inline(always)]
fn add_times<const FMA: bool, const TRANSPOSED: bool>(tile: &Tile, x: &Part, out: &mut Part) {
    let mut sums = *out;
    for i in 0..LANES {
        for p in 0..EACH {
            for q in 0..EACH {
                let entry = if TRANSPOSED { tile[q][p].0[i] } else { tile[p][q].0[i] };
                sums[p].0[i] = mul_add::<FMA>(entry, x[q].0[i], sums[p].0[i]);
            }
        }
    }
    *out = sums;
}

/// V's derivatives by lobe j's channels (rows) and lobe k's (columns); zeros where either slot is empty.
#[inline(always)]
fn pair_products<const FMA: bool>(lobes: &ChannelLobes, (j, k): (usize, usize)) -> Tile {
    let mut tile = [[ZERO; EACH]; EACH];
    let (mu_j, mu_k, rho_j, rho_k) = (lobes.mu[j], lobes.mu[k], lobes.rho[j], lobes.rho[k]);
    let (alpha_j, alpha_k) = (lobes.channels[j][0], lobes.channels[k][0]);
    for i in 0..LANES {
        let (a, b) = ([mu_j[0].0[i], mu_j[1].0[i], mu_j[2].0[i]], [mu_k[0].0[i], mu_k[1].0[i], mu_k[2].0[i]]);
        let (rho_j, rho_k) = (rho_j.0[i], rho_k.0[i]);
        let (dx, dy, dz) = (a[0] - b[0], a[1] - b[1], a[2] - b[2]);
        let chord = dx * dx + dy * dy + dz * dz;
        let u = 1.0 - 0.5 * chord;
        let width = LaneWidth::of_shortfall::<FMA>(shortfall(rho_j, rho_k));
        let density = width.peak * exp_of_negative::<FMA>(-0.5 * width.kappa * chord);
        let v = if alpha_j.0[i] > 0.0 && alpha_k.0[i] > 0.0 { density } else { 0.0 };
        let (kappa, inverse, off) = (width.kappa, 1.0 / width.slope, width.shortfall - 0.5 * chord);
        // dK / drho on either side, and by both.
        let (in_j, in_k) = (MOMENT * rho_k * inverse, MOMENT * rho_j * inverse);
        let in_both = inverse * (MOMENT - width.curvature * in_j * in_k);
        let (v_j, v_k) = (v * off * in_j, v * off * in_k);
        let v_jk = v * ((off * off - width.slope) * in_j * in_k + off * in_both);
        let v_u = v * kappa;
        let mixed = v * (1.0 + kappa * off);
        let (turn_j, turn_k) = (1.0 / rho_j, 1.0 / rho_k);
        // By rho and by the turn of the other side, over that side's rho.
        let (ju, ku) = (mixed * in_j * turn_k, mixed * in_k * turn_j);
        let (u_j, u_k) = (v_u * turn_j, v_u * turn_k);
        let both = v_u * turn_j * turn_k;
        tile[0][0].0[i] = v - rho_j * v_j - rho_k * v_k + rho_j * rho_k * v_jk;
        // In the directions mu_j, mu_k and across them: t_j = mu_k - u mu_j, t_k = mu_j - u mu_k.
        let (row_b, row_t) = (v_k - rho_j * v_jk, u_k - rho_j * ju);
        let (column_a, column_t) = (v_j - rho_k * v_jk, u_j - rho_k * ku);
        for axis in 0..3 {
            let (t_j, t_k) = (b[axis] - u * a[axis], a[axis] - u * b[axis]);
            tile[0][1 + axis].0[i] = row_b * b[axis] + row_t * t_k;
            tile[1 + axis][0].0[i] = column_a * a[axis] + column_t * t_j;
            // The row's factors of mu_k and of t_k.
            let of_b = (v_jk + both * u) * a[axis] + ku * t_j - both * b[axis];
            let of_t = ju * a[axis] + both * kappa * t_j;
            for other in 0..3 {
                let t = a[other] - u * b[other];
                let along = of_b * b[other] + of_t * t - both * a[axis] * a[other];
                tile[1 + axis][1 + other].0[i] = if axis == other { along + both } else { along };
            }
        }
    }
    tile
}

/// The integral of the mean look's square, by lane: sums over pairs of a window's normals.
#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
pub fn energy(normals: &NormalWindow, out: &mut Lanes) {
    const FMA: bool = target_cfg_f!(any(target_feature = "fma", target_arch = "aarch64"));
    let width = LaneWidth::of_shortfall::<FMA>(REST);
    let factor = -0.5 * LOG2_E * width.kappa;
    let [xs, ys, zs, ws] = normals.columns;
    let mut sum = ZERO;
    for first in (normals.start..xs.len()).step_by(normals.stride) {
        let (x, y, z, w) = (window(xs, first), window(ys, first), window(zs, first), window(ws, first));
        let mut half = ZERO;
        for i in 0..LANES {
            half.0[i] = 0.5 * w[i];
        }
        for second in (first + normals.stride..xs.len()).step_by(normals.stride) {
            let (ox, oy, oz, ow) = (window(xs, second), window(ys, second), window(zs, second), window(ws, second));
            for i in 0..LANES {
                let (dx, dy, dz) = (x[i] - ox[i], y[i] - oy[i], z[i] - oz[i]);
                let chord = mul_add::<FMA>(dz, dz, mul_add::<FMA>(dy, dy, dx * dx));
                half.0[i] = mul_add::<FMA>(ow[i], exp2_of_negative::<FMA>(factor * chord), half.0[i]);
            }
        }
        for i in 0..LANES {
            sum.0[i] = mul_add::<FMA>(2.0 * w[i], half.0[i], sum.0[i]);
        }
    }
    for i in 0..LANES {
        out.0[i] = width.peak * sum.0[i];
    }
}

/// The plain form of what is worked out here.
#[cfg(test)]
pub mod plain {
    use glam::DVec3;

    use super::MEAN_COSINE;
    use crate::sphere::vmf;

    /// The integral of two lobes' product, or of a lobe's and a normal's, which is a lobe of weight and length 1.
    pub fn product(a: [f64; 4], b: [f64; 4]) -> f64 {
        let of = |x: [f64; 4]| DVec3::new(x[1], x[2], x[3]) / x[0];
        let (a_r, b_r) = (of(a), of(b));
        let kappa = vmf::concentration(1.0 - MEAN_COSINE * MEAN_COSINE * a_r.length() * b_r.length());
        let chord = a_r.normalize().distance_squared(b_r.normalize());
        a[0] * b[0] * (vmf::log_peak(kappa) - 0.5 * kappa * chord).exp()
    }
}

#[cfg(test)]
mod tests {
    use super::plain::product;
    use super::*;
    use crate::sphere::StoredLobe;
    use glam::DVec3;

    const STORED: [StoredLobe; 4] =
        [[0.5, 0.1, 0.05, 0.4], [0.3, -0.1, 0.1, 0.22], [0.2, 0.0, -0.02, 0.19], [0.0, 0.0, 0.0, 0.0]];

    /// Six normals of each of sixteen places, all with the lobes above.
    fn normals() -> [Vec<f32>; 4] {
        let normal = |i: usize| DVec3::new((i as f64 * 0.7).sin() * 0.5, (i as f64 * 1.3).cos() * 0.4, 1.0).normalize();
        let weight = |i: usize| [0.1, 0.2, 0.15, 0.25, 0.05, 0.25][i / LANES];
        let column = |of: &dyn Fn(usize) -> f64| (0..6 * LANES).map(|i| of(i) as f32).collect();
        [column(&|i| normal(i).x), column(&|i| normal(i).y), column(&|i| normal(i).z), column(&weight)]
    }

    fn evaluated(columns: &[Vec<f32>; 4]) -> ChannelPhi {
        let mut lobes = ChannelLobes::empty(4);
        let channels: Vec<f32> = STORED.iter().flatten().flat_map(|&value| [value; LANES]).collect();
        lobes.read(&[(&channels, 0)], LANES);
        let mut phi = ChannelPhi::default();
        let columns = std::array::from_fn(|axis| &columns[axis][..]);
        phi.move_to(&lobes, &[NormalWindow { columns, stride: LANES, start: 0 }]);
        phi
    }

    /// The derivative of `of` by one channel of a lobe.
    fn slope(x: StoredLobe, p: usize, of: impl Fn([f64; 4]) -> f64) -> f64 {
        let at = |h: f64| {
            let mut moved = x.map(f64::from);
            moved[p] += h;
            of(moved)
        };
        (at(3e-4) - at(-3e-4)) / 6e-4
    }

    #[test]
    fn the_equations_are_those_of_the_plain_double_sum() {
        let columns = normals();
        let found = evaluated(&columns);
        for lane in [0, 7, LANES - 1] {
            let data = |a: [f64; 4]| -> f64 {
                let normal = |n: usize| [0, 1, 2, 3].map(|axis| f64::from(columns[axis][n * LANES + lane]));
                (0..6).map(normal).map(|[x, y, z, w]| w * product(a, [1.0, x, y, z])).sum()
            };
            let wide = STORED.map(|x| x.map(f64::from));
            let square: f64 = (0..9).map(|i| product(wide[i / 3], wide[i % 3])).sum();
            let phi = square - 2.0 * (0..3).map(|j| data(wide[j])).sum::<f64>();
            assert!((f64::from(found.phi.0[lane]) - phi).abs() < 1e-4 * square, "{} {phi}", found.phi.0[lane]);
            for (j, p) in (0..3).flat_map(|j| (0..EACH).map(move |p| (j, p))) {
                let model = |a: [f64; 4]| (0..3).map(|k| product(a, wide[k])).sum::<f64>() - data(a);
                let (value, exact) = (f64::from(found.system.right[j][p].0[lane]), slope(STORED[j], p, model));
                // Widths are good to some 1e-4, in either.
                let tolerance = 5e-3 * exact.abs() + 5e-3 * square;
                assert!((value - exact).abs() < tolerance, "gradient {j}, {p}: {value} {exact}");
                for (k, q) in (j..3).flat_map(|k| (0..EACH).map(move |q| (k, q))) {
                    let exact = slope(STORED[j], p, |a| slope(STORED[k], q, |b| product(a, b)));
                    let value = f64::from(found.system.tiles[pair_index(j, k)][p][q].0[lane]);
                    let tolerance = 5e-3 * exact.abs() + 2e-2 * square;
                    assert!((value - exact).abs() < tolerance, "{j}, {p} by {k}, {q}: {value} {exact}");
                }
            }
        }
    }

    #[test]
    fn an_empty_slot_has_no_say() {
        let found = evaluated(&normals());
        let own = found.system.right[3].iter().chain(found.system.tiles[pair_index(0, 3)].as_flattened());
        assert!(own.flat_map(|lanes| lanes.0).all(|value| value == 0.0));
    }

    #[test]
    fn the_energy_is_the_sum_over_all_pairs() {
        let columns = normals();
        let mut found = ZERO;
        energy(
            &NormalWindow { columns: std::array::from_fn(|axis| &columns[axis][..]), stride: LANES, start: 0 },
            &mut found,
        );
        let normal = |n: usize| [0, 1, 2, 3].map(|axis| f64::from(columns[axis][n * LANES + 3]));
        let pairs = (0..36).map(|i| (normal(i / 6), normal(i % 6)));
        let exact: f64 =
            pairs.map(|(a, b)| a[3] * b[3] * product([1.0, a[0], a[1], a[2]], [1.0, b[0], b[1], b[2]])).sum();
        assert!((f64::from(found.0[3]) / exact - 1.0).abs() < 1e-4, "{} {exact}", found.0[3]);
    }
}
