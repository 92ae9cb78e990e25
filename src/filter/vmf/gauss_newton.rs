//! Damped Gauss-Newton steps on [`super::phi`]: they lower the squared distance between the shaded mixture and the
//! shaded truth itself.
//!
//! The residual is a function on the sphere, so the inner products of its derivatives are integrals; for blurred lobes
//! they are mixed derivatives of `v(mu_j.mu_k; K_jk)`, in closed form. A lobe moves by `ln alpha` (weights keep their
//! sum and stay above 0), two tangents of mu, and `ln kappa`; every derivative of lobe j carries a factor alpha_j,
//! which is taken out of the equations and divided out of the step. Damping is Marquardt's (1963), in proportion to
//! the diagonal. A step is kept only if Phi falls.

use std::cell::{Cell, RefCell};

use glam::DVec3;

use super::cholesky::{self, MOST, Matrix};
use super::em::TexelLobes;
use super::phi::{Evaluation, LobeStep, MOMENTS, Pair, Parameters, pair_index};
use super::samples::Samples;
use super::shaded::MATERIALS;
use crate::sphere::mixture::MAX_LOBES;

/// Parameters of a lobe: weight, two tangents, concentration.
const EACH: usize = 4;

/// The first step's damping; it falls by [`EASED`] where a step is kept and rises by [`RAISED`] where it is not.
pub const DAMPING: f64 = 3e-2;

/// Factor on the damping after a step that is kept.
pub const EASED: f64 = 0.2;

/// Factor on the damping after a step that is not.
pub const RAISED: f64 = 10.0;

/// Added to the whole diagonal, of its largest entry: an unknown that no material sees, such as the kappa of a lobe far
/// sharper than any, stays where it is rather than follow the rounding of the sums.
pub const FLOOR: f64 = 1e-6;

/// Most that a weight or a concentration changes in a step, as a logarithm: a factor of 10.
const LOG_LIMIT: f64 = std::f64::consts::LN_10;

/// Most that a direction turns in a step, as a tangent's length.
pub const TURN_LIMIT: f64 = 0.5;

/// Takes `steps` steps from `lobes`, keeping those that lower Phi; `proceed` returns false to stop early.
pub fn refine(samples: &impl Samples, lobes: &mut TexelLobes, steps: usize, proceed: &mut dyn FnMut() -> bool) {
    if steps == 0 {
        return;
    }
    // Taken while they are in use: summing in parallel, a thread may meanwhile begin with another texel.
    let mut places = PLACES.take().unwrap_or_else(|| {
        let empty = || Evaluation::empty(Parameters::of(lobes));
        Box::new([empty(), empty()])
    });
    refine_with(&mut places, samples, lobes, steps, proceed);
    PLACES.set(Some(places));
}

/// As [`refine`]; the two places change roles where a step is kept.
fn refine_with(
    [here, there]: &mut [Evaluation; 2],
    samples: &impl Samples,
    lobes: &mut TexelLobes,
    steps: usize,
    proceed: &mut dyn FnMut() -> bool,
) {
    let (mut here, mut there) = (here, there);
    if !here.move_to(samples, Parameters::of(lobes)) {
        return;
    }
    let weights = here.weights();
    let mut phi = here.phi(&weights);
    let mut damping = DAMPING;
    for _ in 0..steps {
        if !proceed() {
            return;
        }
        let moved = step(here, &weights, damping).is_some_and(|step| there.move_to(samples, here.at.moved(&step)));
        let phi_there = if moved { there.phi(&weights) } else { f64::INFINITY };
        if phi_there < phi {
            phi = phi_there;
            std::mem::swap(&mut here, &mut there);
            here.at.store(lobes);
            damping *= EASED;
        } else {
            damping *= RAISED;
        }
    }
}

/// The equations of a step: a symmetric matrix and the gradient, each without its lobes' factors alpha.
struct Equations {
    unknowns: usize,
    /// Row by row, the part on and above the diagonal; rows [`MOST`] apart.
    matrix: Matrix,
    /// Half of Phi's gradient.
    gradient: [f64; MOST],
}

thread_local! {
    /// Two for each thread, 48 KiB, of which a texel fills what it needs.
    static PLACES: Cell<Option<Box<[Evaluation; 2]>>> = const { Cell::new(None) };

    /// One for each thread, 32 KiB, of which a step fills what it needs.
    static EQUATIONS: RefCell<Box<Equations>> =
        RefCell::new(Box::new(Equations { unknowns: 0, matrix: [[0.0; MOST]; MOST], gradient: [0.0; MOST] }));
}

/// Tangent directions of every lobe.
type Frames = [(DVec3, DVec3); MAX_LOBES];

/// Half of Phi's gradient by every parameter, with the lobes' factors alpha, in the frames of [`frames`]:
/// by `ln alpha`, two tangents and `ln kappa`.
pub fn half_gradient(here: &Evaluation, weights: &[f64; MATERIALS.len()]) -> [[f64; EACH]; MAX_LOBES] {
    EQUATIONS.with_borrow_mut(|equations| {
        equations.fill(here, weights, &frames(&here.at));
        std::array::from_fn(|j| std::array::from_fn(|p| here.at.alpha[j] * equations.gradient[EACH * j + p]))
    })
}

/// Two tangents at each lobe's direction.
pub fn frames(at: &Parameters) -> [(DVec3, DVec3); MAX_LOBES] {
    at.mu.map(DVec3::any_orthonormal_pair)
}

/// One step from here; `None` where the equations have no answer.
fn step(here: &Evaluation, weights: &[f64; MATERIALS.len()], damping: f64) -> Option<[LobeStep; MAX_LOBES]> {
    let frames = frames(&here.at);
    let solution = EQUATIONS.with_borrow_mut(|equations| {
        equations.fill(here, weights, &frames);
        equations.damp(damping);
        equations.solve()
    })?;
    let mut steps = [LobeStep::default(); MAX_LOBES];
    for j in 0..here.at.count {
        let [log_alpha, first, second, log_kappa] = [0, 1, 2, 3].map(|p| -solution[EACH * j + p] / here.at.alpha[j]);
        steps[j] = LobeStep {
            log_alpha: log_alpha.clamp(-LOG_LIMIT, LOG_LIMIT),
            tangent: (first * frames[j].0 + second * frames[j].1).clamp_length_max(TURN_LIMIT),
            log_kappa: log_kappa.clamp(-LOG_LIMIT, LOG_LIMIT),
        };
    }
    Some(steps)
}

impl Equations {
    /// Becomes the equations at one place: every entry that counts is written.
    fn fill(&mut self, here: &Evaluation, weights: &[f64; MATERIALS.len()], frames: &Frames) {
        let count = here.at.count;
        self.unknowns = EACH * count;
        self.gradient = [0.0; MOST];
        let mut model = [0.0; MOST];
        for k in 0..count {
            for j in 0..=k {
                let block = self.block(here, weights, frames, (j, k));
                for p in 0..EACH {
                    model[EACH * j + p] += here.at.alpha[k] * block[p][0];
                    if j < k {
                        model[EACH * k + p] += here.at.alpha[j] * block[0][p];
                    }
                }
            }
        }
        self.centre(here, weights, frames, &model);
    }

    /// The inner products of lobe j's derivatives with lobe k's, `j <= k`.
    fn block(
        &mut self,
        here: &Evaluation,
        weights: &[f64; MATERIALS.len()],
        frames: &Frames,
        (j, k): (usize, usize),
    ) -> [[f64; EACH]; EACH] {
        let (mu_j, mu_k) = (here.at.mu[j], here.at.mu[k]);
        let (frame_j, frame_k) = (frames[j], frames[k]);
        let geometry = Geometry {
            cosine: 1.0 - 0.5 * mu_j.distance_squared(mu_k),
            along_j: [frame_j.0.dot(mu_k), frame_j.1.dot(mu_k)],
            along_k: [frame_k.0.dot(mu_j), frame_k.1.dot(mu_j)],
            between: [
                [frame_j.0.dot(frame_k.0), frame_j.0.dot(frame_k.1)],
                [frame_j.1.dot(frame_k.0), frame_j.1.dot(frame_k.1)],
            ],
            length: [here.own[j].length, here.own[k].length],
            slope: [here.own[j].slope * here.own[j].kappa, here.own[k].slope * here.own[k].kappa],
        };
        let mut block = [[0.0; EACH]; EACH];
        for (material, (&weight, moment)) in weights.iter().zip(MOMENTS).enumerate() {
            geometry.add_products(&here.pairs[material][pair_index(j, k)], weight, moment, &mut block);
        }
        for (p, row) in block.iter().enumerate() {
            self.matrix[EACH * j + p][EACH * k..EACH * (k + 1)].copy_from_slice(row);
        }
        block
    }

    /// Subtracts the data from the gradient, and the mixture from the weights' derivatives: with weights of sum 1 a
    /// lobe's derivative by `ln alpha` is `alpha_j (v_j - mixture)`.
    fn centre(&mut self, here: &Evaluation, weights: &[f64; MATERIALS.len()], frames: &Frames, model: &[f64; MOST]) {
        let (count, alpha) = (here.at.count, &here.at.alpha);
        let (mut energy, mut mean) = (0.0, 0.0);
        for j in 0..count {
            let mut data = [0.0; EACH];
            for (term, &weight) in here.data[j].iter().zip(weights) {
                data[0] += weight * term.value;
                data[1] += weight * term.direction.dot(frames[j].0);
                data[2] += weight * term.direction.dot(frames[j].1);
                data[3] += weight * term.log_kappa;
            }
            for p in 0..EACH {
                self.gradient[EACH * j + p] = model[EACH * j + p] - data[p];
            }
            energy += alpha[j] * model[EACH * j];
            mean += alpha[j] * self.gradient[EACH * j];
        }
        for j in 0..count {
            self.gradient[EACH * j] -= mean;
            for k in j..count {
                // The mixture's products with lobe k's derivatives are the model's share of the gradient.
                for p in 0..EACH {
                    self.matrix[EACH * j][EACH * k + p] -= model[EACH * k + p];
                    if k > j || p == 0 {
                        self.matrix[EACH * j + p][EACH * k] -= model[EACH * j + p];
                    }
                }
                self.matrix[EACH * j][EACH * k] += energy;
            }
        }
    }

    /// Raises the diagonal in proportion, and by [`FLOOR`]. Both tangents of a lobe are raised alike: which two they
    /// are must not matter.
    fn damp(&mut self, damping: f64) {
        let largest = (0..self.unknowns).map(|i| self.matrix[i][i]).fold(0.0, f64::max);
        for lobe in (0..self.unknowns).step_by(EACH) {
            let diagonal: [f64; EACH] = std::array::from_fn(|p| self.matrix[lobe + p][lobe + p].max(0.0));
            let tangents = 0.5 * (diagonal[1] + diagonal[2]);
            for (p, raise) in [diagonal[0], tangents, tangents, diagonal[3]].into_iter().enumerate() {
                self.matrix[lobe + p][lobe + p] += damping * raise + FLOOR * largest;
            }
        }
    }

    /// Solves `matrix x = gradient` in place; `None` where the matrix is not positive.
    fn solve(&mut self) -> Option<[f64; MOST]> {
        if !cholesky::factor(&mut self.matrix, self.unknowns) {
            return None;
        }
        let mut x = self.gradient;
        cholesky::solve(&self.matrix, self.unknowns, &mut x);
        x[..self.unknowns].iter().all(|value| value.is_finite()).then_some(x)
    }
}

/// What the products of two lobes' derivatives need beside the material.
struct Geometry {
    cosine: f64,
    /// Lobe j's tangents along mu_k.
    along_j: [f64; 2],
    /// Lobe k's tangents along mu_j.
    along_k: [f64; 2],
    /// Lobe j's tangents along lobe k's.
    between: [[f64; 2]; 2],
    /// `A(kappa)` of both.
    length: [f64; 2],
    /// `dA / d ln kappa` of both.
    slope: [f64; 2],
}

impl Geometry {
    /// Adds the mixed derivatives of `v(u; K)` by lobe j's parameters (rows) and lobe k's (columns).
    ///
    /// `dv/du = K v`, `dv/dK = v (u - A)`, `d2v/du dK = v (1 + K (u - A))`, `d2v/dK2 = v ((u - A)^2 - A')`, and K
    /// follows from `A(K) = a^2 A(kappa_j) A(kappa_k)`.
    fn add_products(&self, pair: &Pair, weight: f64, moment: f64, block: &mut [[f64; EACH]; EACH]) {
        let (v, width) = (weight * pair.value, &pair.width);
        let (k, inverse) = (width.kappa, 1.0 / width.slope);
        let off = self.cosine - width.length;
        let by_j = moment * self.length[1] * self.slope[0] * inverse;
        let by_k = moment * self.length[0] * self.slope[1] * inverse;
        let by_both = moment
            * self.slope[0]
            * self.slope[1]
            * inverse
            * (1.0 - width.length * width.curvature * inverse * inverse);
        let mixed = v * (1.0 + k * off);
        block[0][0] += v;
        block[0][3] += v * off * by_k;
        block[3][0] += v * off * by_j;
        block[3][3] += v * ((off * off - width.slope) * by_j * by_k + off * by_both);
        for a in 0..2 {
            block[0][1 + a] += v * k * self.along_k[a];
            block[1 + a][0] += v * k * self.along_j[a];
            block[1 + a][3] += mixed * self.along_j[a] * by_k;
            block[3][1 + a] += mixed * self.along_k[a] * by_j;
            for b in 0..2 {
                block[1 + a][1 + b] += v * k * (k * self.along_j[a] * self.along_k[b] + self.between[a][b]);
            }
        }
    }
}
