//! What is worked out of a model once, numerically: its multipliers, and the Blinn-Phong lobes that stand for it.
//!
//! The multipliers are `rho_l = 2 pi int f(u) P_l(u) du`, by Gauss-Legendre quadrature of four points in each of many
//! equal steps of the angle: P_l turns over once in `2 pi / l` of it.
//!
//! The lobes are for models that no closed form convolves with a von Mises-Fisher lobe. Their exponents are fixed
//! multiples of the one at which Blinn-Phong falls to half its peak at the model's own angle; their weights are the
//! non-negative ones of the least squared error over the sphere, by cyclic coordinate descent (Hildreth 1957), scaled to
//! sum to 1.

use std::cell::{OnceCell, RefCell};
use std::f64::consts::PI;
use std::rc::Rc;

use super::Brdf;
use super::blinn_phong::BlinnPhong;
use crate::sphere::vmf::KAPPA_MAX;

/// Lobes that stand for a model.
pub const LOBES: usize = 8;
/// From one lobe's exponent to the next; more where a measured one has to reach its floor.
const RATIO: f64 = 3.0;
/// The widest lobe's exponent of a measured model: its floor, the diffuse part.
const FLOOR: f64 = 0.5;
/// The sharpest lobe's exponent over that of the same width as the model, and its least: wide models are no power of the
/// cosine.
const SHARPEST: f64 = 2.5;
const LEAST_SHARPEST: f64 = 8.0;
/// The widest lobe there is: all but uniform over the hemisphere.
const LEAST_EXPONENT: f64 = 1e-3;

/// Bands of the few multipliers, as many as harmonics are kept to.
pub const FEW: usize = 23;
/// Steps of the angle from the normal to the far side.
const STEPS: usize = 2048;
/// Nodes and weights of Gauss and Legendre's rule of four points on -1..1.
const NODES: [(f64, f64); 4] = [
    (-0.861_136_311_594_052_6, 0.347_854_845_137_453_9),
    (-0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.339_981_043_584_856_26, 0.652_145_154_862_546_1),
    (0.861_136_311_594_052_6, 0.347_854_845_137_453_9),
];
/// Places at which the lobes are fitted.
const PLACES: usize = 400;
/// Rounds of the descent: the weights' last change is below 1e-6.
const ROUNDS: usize = 2000;

/// A weighted Blinn-Phong lobe of a model.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct PowerLobe {
    /// The share, at least 0; those of a model sum to 1.
    pub weight: f64,
    /// The exponent s.
    pub shininess: f64,
}

/// A model's numbers.
#[derive(Debug)]
pub struct Projection {
    model: Brdf,
    /// The lobes that stand for it.
    pub lobes: [PowerLobe; LOBES],
    few: Vec<f64>,
    all: OnceCell<Vec<f64>>,
}

thread_local! {
    /// The models that were asked for last: every pixel asks for the same, of three channels at most.
    static LATEST: RefCell<Vec<Rc<Projection>>> = const { RefCell::new(Vec::new()) };
}
/// How many of them are kept.
const KEPT: usize = 8;

impl Projection {
    /// The numbers of a model, worked out when this thread first asks for it.
    pub fn of(model: Brdf) -> Rc<Self> {
        LATEST.with_borrow_mut(|latest| {
            if let Some(found) = latest.iter().find(|projection| projection.model == model) {
                return Rc::clone(found);
            }
            let made = Rc::new(Self::new(model));
            latest.truncate(KEPT - 1);
            latest.insert(0, Rc::clone(&made));
            made
        })
    }

    fn new(model: Brdf) -> Self {
        Self { model, lobes: lobes(model), few: multipliers(model, FEW), all: OnceCell::new() }
    }

    /// `rho_l` for `l < bands`, at most [`Projection::most_bands`].
    pub fn multipliers(&self, bands: usize) -> &[f64] {
        if bands <= FEW {
            return &self.few[..bands];
        }
        let all = self.all.get_or_init(|| multipliers(self.model, Self::most_bands()));
        &all[..bands.min(all.len())]
    }

    /// As many multipliers as the sharpest lobe's convolution needs.
    pub fn most_bands() -> usize {
        bands_for(KAPPA_MAX)
    }
}

/// Terms of a series that falls off as a lobe's: they follow `exp(-l^2 / (2 kappa))`.
pub fn bands_for(kappa: f64) -> usize {
    10 + (7.0 * kappa.sqrt()) as usize
}

fn multipliers(model: Brdf, bands: usize) -> Vec<f64> {
    let mut sums = vec![0.0; bands];
    let step = PI / STEPS as f64;
    for i in 0..STEPS {
        for (node, weight) in NODES {
            let (sin, cos) = (step * (i as f64 + 0.5 + 0.5 * node)).sin_cos();
            let share = PI * step * weight * sin * model.zonal(cos);
            if share > 0.0 {
                add_legendre(&mut sums, share, cos);
            }
        }
    }
    sums
}

/// Adds `share P_l(u)` to every sum.
fn add_legendre(sums: &mut [f64], share: f64, u: f64) {
    let (mut previous, mut current) = (0.0, share);
    for (l, sum) in sums.iter_mut().enumerate() {
        *sum += current;
        let l = l as f64;
        (previous, current) = (current, ((2.0 * l + 1.0) * u * current - l * previous) / (l + 1.0));
    }
}

/// Cosines with their solid angles, close together where the model is sharp.
fn places(width: f64) -> impl Iterator<Item = (f64, f64)> {
    let scale = 0.25 * width;
    let most = (0.5 * PI / scale).ln_1p();
    let edge = move |i: usize| (scale * (most * i as f64 / PLACES as f64).exp_m1()).cos();
    (0..PLACES).map(move |i| (0.5 * (edge(i) + edge(i + 1)), 2.0 * PI * (edge(i) - edge(i + 1))))
}

fn lobes(model: Brdf) -> [PowerLobe; LOBES] {
    // Where Blinn-Phong of that exponent falls to half its peak.
    let width = 0.5_f64.powf(1.0 / model.exponent()).acos();
    let sharpest = (SHARPEST * model.exponent()).max(LEAST_SHARPEST);
    let to_floor = (sharpest / FLOOR).powf(1.0 / (LOBES - 1) as f64);
    let ratio = if matches!(model, Brdf::Measured(_)) { to_floor.max(RATIO) } else { RATIO };
    let exponent = |k: usize| (sharpest / ratio.powi(k as i32)).max(LEAST_EXPONENT);
    let exponents: [f64; LOBES] = std::array::from_fn(exponent);
    let (mut gram, mut moments) = ([[0.0; LOBES]; LOBES], [0.0; LOBES]);
    for (cosine, solid_angle) in places(width) {
        let value = model.zonal(cosine);
        let of_lobe = exponents.map(|shininess| BlinnPhong { shininess }.zonal(cosine));
        for j in 0..LOBES {
            moments[j] += solid_angle * value * of_lobe[j];
            (0..LOBES).for_each(|k| gram[j][k] += solid_angle * of_lobe[j] * of_lobe[k]);
        }
    }
    let weights = non_negative(&gram, &moments);
    let total: f64 = weights.iter().sum();
    std::array::from_fn(|k| PowerLobe { weight: weights[k] / total, shininess: exponents[k] })
}

/// The least squares solution that has no negative part.
fn non_negative(gram: &[[f64; LOBES]; LOBES], moments: &[f64; LOBES]) -> [f64; LOBES] {
    let mut weights = [0.0; LOBES];
    for _ in 0..ROUNDS {
        for j in 0..LOBES {
            let fitted: f64 = (0..LOBES).map(|k| gram[j][k] * weights[k]).sum();
            weights[j] = f64::max(0.0, weights[j] + (moments[j] - fitted) / gram[j][j]);
        }
    }
    weights
}
