//! The exact convolution of a model and a von Mises-Fisher lobe as a table, small enough to be rebuilt while a
//! parameter is dragged; shaders read the same one.
//!
//! What is kept is the ratio of the Legendre series to a reference that is nearly it, of the concentration
//! `K = kappa (s+1) / (kappa + s + 1)`, s the model's equivalent exponent: the ratio is smooth where both are large, and
//! at most of order 1 where both vanish. The reference is a von Mises-Fisher lobe, or `(1 + K (1-u))^-2` of the same
//! peak for a model with a tail. Rows are equal steps of `ln(1 + sqrt(s+2) x)`, `x = 1/sqrt(1 + kappa)`, from a delta
//! (x = 0) to the uniform lobe (x = 1): steps of the lobe's width where it is below Blinn-Phong's, as what happens at
//! the horizon is as wide as the lobe, and of its logarithm above. Columns are equal steps of `ln(1 + K (1-u))` from the
//! peak to the horizon `u = 0`, where every row has a column so that the kink of a delta is kept, then equal steps of
//! `sqrt(-u)` down to -1. Interpolation is bilinear.

use std::f64::consts::PI;

use rayon::prelude::*;

use super::{Brdf, ConvolutionRule, Convolved};
use crate::sphere::harmonics::zonal_series_at;
use crate::sphere::vmf::KAPPA_MAX;

/// Rows of a table.
pub const ROWS: usize = 64;
/// Columns from the peak to the horizon, both counted.
const LIT: usize = 128;
/// Columns beyond the horizon.
const DARK: usize = 32;
/// Columns of a table.
pub const COLUMNS: usize = LIT + DARK;

/// Of the peak; below it the series of a model without a tail is rounding, and the ratio goes on as it was.
const LEAST: f64 = 1e-7;

/// The convolutions of one model with lobes of every width.
#[derive(Clone, Debug, PartialEq)]
pub struct ExactTable {
    /// The model.
    pub model: Brdf,
    /// [`ROWS`] rows of [`COLUMNS`] ratios.
    pub ratios: Vec<f32>,
}

impl ExactTable {
    /// Tabulates a model.
    pub fn new(model: Brdf) -> Self {
        let rows = (0..ROWS).into_par_iter().map(|row| ratios(row, model));
        Self { model, ratios: rows.flatten().collect() }
    }

    /// [`ConvolutionRule::Exact`] of the table's model: the twin of the shader's.
    pub fn convolved(&self, kappa: f64, cosine: f64) -> f64 {
        if kappa > KAPPA_MAX {
            return self.model.convolved(ConvolutionRule::Exact, kappa, cosine);
        }
        let (s1, u) = (self.model.exponent() + 1.0, cosine.clamp(-1.0, 1.0));
        let width = kappa * s1 / (kappa + s1);
        let ratio_of_widths = ((s1 + 1.0) / (kappa + 1.0)).sqrt();
        let row = (ROWS - 1) as f64 * (1.0 + ratio_of_widths).ln() / (1.0 + (s1 + 1.0).sqrt()).ln();
        let horizon = (LIT - 1) as f64;
        let column = if u < 0.0 {
            horizon + (-u).sqrt() * DARK as f64
        } else if width < 1e-3 {
            horizon * (1.0 - u)
        } else {
            horizon * (1.0 + width * (1.0 - u)).ln() / (1.0 + width).ln()
        };
        self.ratio(row, column) * reference(self.model, width, u)
    }

    fn ratio(&self, row: f64, column: f64) -> f64 {
        let (y, x) = ((row as usize).min(ROWS - 2), (column as usize).min(COLUMNS - 2));
        let (v, h) = (row - y as f64, column - x as f64);
        let at = |y: usize, x: usize| f64::from(self.ratios[y * COLUMNS + x]);
        let line = |y: usize| at(y, x) * (1.0 - h) + at(y, x + 1) * h;
        line(y) * (1.0 - v) + line(y + 1) * v
    }
}

/// What the convolution is nearly, per steradian: a lobe, or a tail from the same peak.
fn reference(model: Brdf, kappa: f64, cosine: f64) -> f64 {
    let peak = if kappa < 1e-3 { 0.5 + 0.5 * kappa } else { kappa / -(-2.0 * kappa).exp_m1() };
    peak / (2.0 * PI) * falloff(model, kappa, cosine)
}

/// That over its peak.
fn falloff(model: Brdf, kappa: f64, cosine: f64) -> f64 {
    let fall = kappa * (1.0 - cosine);
    if model.has_tail() { (1.0 + fall).powi(-2) } else { (-fall).exp() }
}

/// The concentration that a row stands for; of the first, which is a delta's, one as good as infinite.
fn concentration(row: usize, shininess: f64) -> f64 {
    let most = (shininess + 2.0).sqrt();
    let x = (row as f64 / (ROWS - 1) as f64 * (1.0 + most).ln()).exp_m1() / most;
    ((1.0 - x * x) / (x * x).max(1e-12)).max(0.0)
}

/// The cosine that a column stands for.
fn cosine(column: usize, width: f64) -> f64 {
    if column >= LIT {
        return -((column + 1 - LIT) as f64 / DARK as f64).powi(2);
    }
    let t = column as f64 / (LIT - 1) as f64;
    if width < 1e-3 { 1.0 - t } else { 1.0 - (t * (1.0 + width).ln()).exp_m1() / width }
}

fn ratios(row: usize, model: Brdf) -> Vec<f32> {
    let s1 = model.exponent() + 1.0;
    let kappa = concentration(row, model.exponent());
    let width = kappa * s1 / (kappa + s1);
    let cosines: Vec<f64> = (0..COLUMNS).map(|column| cosine(column, width)).collect();
    let values = match model.convolved_with(ConvolutionRule::Exact, kappa) {
        Convolved::Series(coefficients) => zonal_series_at(&coefficients, &cosines),
        closed => cosines.iter().map(|&u| closed.at(u)).collect(),
    };
    let mut last = 0.0;
    let ratio = |(value, &u): (f64, &f64)| {
        if model.has_tail() || falloff(model, width, u) > LEAST {
            last = value.max(0.0) / reference(model, width, u);
        }
        last as f32
    };
    values.into_iter().zip(&cosines).map(ratio).collect()
}

#[cfg(test)]
mod tests {
    use super::super::BlinnPhong;
    use super::super::tests::some_models;
    use super::*;
    use crate::color::srgb_from_linear;

    fn assert_is_series(model: Brdf, most: f64) {
        let table = ExactTable::new(model);
        let (mut worst, mut worst_code) = (0.0_f64, 0.0_f64);
        let near_step = |u: f64| model.has_tail() && u.abs() < 0.15;
        for (kappa, u) in everywhere(model.exponent()).filter(|&(_, u)| !near_step(u)) {
            let exact = model.convolved_with(ConvolutionRule::Exact, kappa);
            let (found, peak, exact) = (table.convolved(kappa, u), exact.at(1.0), exact.at(u));
            worst = worst.max((found - exact).abs() / peak);
            // As the default light and material show it, or a little brighter.
            let code = |value: f64| 255.0 * f64::from(srgb_from_linear(0.3 * value as f32));
            worst_code = worst_code.max((code(found) - code(exact)).abs());
        }
        println!("{model}: {worst:.1e} of the peak, {worst_code:.2} / 255 on the screen");
        assert!(worst < most, "{model}: {worst}");
        assert!(worst_code < 0.5, "{model}: {worst_code}");
    }

    /// Measured: 8e-4 of the peak at s = 1, where a sharp lobe rounds off the kink of the clamped cosine; 3e-4 at most
    /// from s = 1.5 on, 1e-6 at s = 4000.
    #[test]
    fn the_table_is_the_series_to_a_thousandth_of_its_peak() {
        for shininess in [1.0, 1.5, 2.0, 3.0, 10.0, 64.0, 400.0, 4000.0, 1e5] {
            let most = if shininess == 1.0 { 1e-3 } else { 4e-4 };
            assert_is_series(Brdf::BlinnPhong(BlinnPhong { shininess }), most);
        }
    }

    /// Measured: 4.4e-3 for sharp GGX, whose table is coarse where a lobe as wide as itself blurs it. Wide GGX ends with
    /// a step at the horizon, which columns round off: what is nearer than 0.15 to it is left aside.
    #[test]
    fn so_it_is_of_the_other_models_to_half_a_percent_of_one_with_a_tail() {
        for model in some_models() {
            assert_is_series(model, if model.has_tail() { 6e-3 } else { 1e-3 });
        }
    }

    /// Lobes of every width, directions from the peak to the far side, densest where something happens.
    fn everywhere(shininess: f64) -> impl Iterator<Item = (f64, f64)> {
        (0..=70).flat_map(move |i| {
            let kappa = 10.0_f64.powf(f64::from(i) / 10.0 - 2.0);
            let width = kappa * (shininess + 1.0) / (kappa + shininess + 1.0);
            let around_peak =
                (0..120).map(move |j| 1.0 - ((1.0 + 2.0 * width).powf(f64::from(j) / 119.0) - 1.0) / width);
            around_peak.chain((-20..20).map(|j| f64::from(j) * 0.003)).map(move |u| (kappa, u.max(-1.0)))
        })
    }

    #[test]
    fn beyond_the_sharpest_lobe_of_the_series_the_closed_form_goes_on_where_it_ends() {
        for shininess in [1.0, 10.0, 400.0, 4000.0] {
            let model = Brdf::BlinnPhong(BlinnPhong { shininess });
            let mut worst = 0.0_f64;
            let [below, above] =
                [0.999_999, 1.000_001].map(|at| model.convolved_with(ConvolutionRule::Exact, at * KAPPA_MAX));
            for u in [1.0, 0.9999, 0.999, 0.99, 0.9, 0.3, 0.0, -0.5] {
                worst = worst.max((below.at(u) - above.at(u)).abs() / below.at(1.0));
            }
            println!("s = {shininess}: a step of {worst:.1e} of the peak");
            assert!(worst < 2e-3, "s {shininess}: {worst}");
        }
    }
}
