//! Steps of all texels of a level together that mend what hardware interpolation shows between them.
//!
//! `E = sum_texels w |look(x_t) - L_t|^2 / |L_t|^2 + sum_corners |look(x_c) - L_c|^2 / |L_c|^2`
//!
//! x are the stored channels, L the true looks ([`super::looks`]); at a corner, where four texels meet, both are the
//! mean of the four. For Gauss-Newton's quadratic model of a corner, Jensen's inequality gives
//! `(sum d_t/4)' H_c (sum d_t/4) <= sum d_t' H_c d_t / 4`: a bound that falls apart into texels, so all of them move
//! at once, each by `(w H_t + sum H_c/4) d_t = -(w g_t + sum g_c/4)`, `sum d_alpha = 0`, and no order matters. Weights
//! are kept at 0 or above and `|alpha r| <= alpha`. A round is kept only if E falls.
//!
//! Footprints of few normals give the equations in closed form ([`super::joint_rows`]), which measures as well as
//! directions and costs a fraction; at coarse levels, where directions cost less than normals, closed forms also
//! measure worse, by 2 and 9 % ([`super::joint_looks`]).
//!
//! Twenty smooth passes alone err 3.1 times as much half way between texels as unaligned shading (2.6 times half way
//! between levels), as mean over six maps at s = 64; ten and these rounds 2.3 and 2.0 times, at a little more time.
//! Coarse levels pay most, for the finer ones are seeded from them. Places half way to the coarser level as a third
//! term gained nothing; texels refined alone make the corners worse; 4x4 blocks in place of whole matrices gain half as
//! much in four rounds. Only s = 64 is looked at: at s = 400 texels err more, corners as before. The mean normal is no
//! longer exact, as in every fit for the shaded look.

use rayon::prelude::*;

use super::alignment::Alignment;
use super::cholesky::MOST;
use super::fit::FitSettings;
use super::joint_looks::JointLooks;
use super::joint_rows::JointRows;
use super::looks::Looks;
use super::monitor::{Cancelled, Monitor};
use super::objective::Objective;
use super::pyramid::MixtureLevel;
use super::residual::EACH;
use crate::normal_map::{Addressing, NormalMap};
use crate::sphere::StoredLobe;
use crate::sphere::mixture::MAX_LOBES;

/// What a texel's centre counts against a corner.
pub const CENTRE: f32 = 0.5;

/// The finest level that takes steps: a level-1 texel's four normals fit its lobes.
const FINEST: usize = 2;

/// Rounds of level 2, doubled from level to level: a level has a quarter of the finer one's texels.
const FEWEST_ROUNDS: usize = 2;

/// Most rounds of a level.
const MOST_ROUNDS: usize = 32;

/// Marquardt's damping of level 2 at first, in proportion to the diagonal; a thirtieth from level to level: few normals
/// make sharp lobes, of which the quadratic model knows little.
const DAMPING: f64 = 1e-1;

/// The least damping of a first round.
const FIRST_DAMPING: f64 = 1e-4;

/// Factor on the damping after a round that is kept, down to [`LEAST_DAMPING`].
const EASED: f64 = 0.5;

/// The least damping: single precision knows the matrix no better.
const LEAST_DAMPING: f64 = 1e-5;

/// Factor on the damping after a round that is not.
const RAISED: f64 = 8.0;

/// What E must fall by in proportion: less is rounding, and a step at random.
const LEAST_GAIN: f64 = 1e-6;

/// The mean length up to which a step may sharpen a lobe, kappa 2000: what is sharper looks the same at s = 64, and would
/// be a glint that is not there under a sharper material.
const LONGEST: f64 = 1.0 - 1.0 / 2000.0;

/// What an unknown's share of the largest on the diagonal is to count as one.
pub const IDLE: f64 = 1e-6;

/// True where a fit takes these steps: with one lobe there is nothing to align.
pub fn refines(settings: &FitSettings) -> bool {
    let aligns = matches!(settings.align, Alignment::Smooth { .. }) && settings.lobes > 1;
    aligns && matches!(settings.objective, Objective::Appearance { steps } if steps > 0)
}

/// Rounds that a level gets.
pub fn rounds(settings: &FitSettings, level: usize) -> usize {
    if !refines(settings) || level < FINEST {
        return 0;
    }
    (FEWEST_ROUNDS << (level - FINEST).min(8)).min(MOST_ROUNDS)
}

/// Moves the lobes of a level by so many rounds; returns E before and after, which may be short of a constant.
pub fn refine(
    map: &NormalMap,
    looks: &Looks<'_>,
    level: usize,
    mixtures: &mut MixtureLevel,
    rounds: usize,
    monitor: &Monitor,
) -> Result<(f64, f64), Cancelled> {
    let size = (mixtures.width, mixtures.height);
    let addressing = map.options.addressing;
    let own = Level { level, size, slots: mixtures.lobes, addressing, monitor };
    let visit = || monitor.visited(level, map.len() as u64);
    match JointRows::new(map, own) {
        Some(joint) => take_rounds(&joint, &own, &mut mixtures.stored, rounds, visit),
        None => take_rounds(&JointLooks { level: own, looks }, &own, &mut mixtures.stored, rounds, visit),
    }
}

fn take_rounds<J: Joint>(
    joint: &J,
    level: &Level<'_>,
    kept: &mut Vec<StoredLobe>,
    rounds: usize,
    visit: impl Fn(),
) -> Result<(f64, f64), Cancelled> {
    let (mut trial, mut next) = (kept.clone(), kept.clone());
    let mut damping = (DAMPING / 30.0_f64.powi((level.level - FINEST) as i32)).max(FIRST_DAMPING);
    let first = pass(joint, level, kept, Some(damping), &mut trial)?;
    let mut least = first;
    for left in (0..rounds).rev() {
        let eased = (damping * EASED).max(LEAST_DAMPING);
        let here = pass(joint, level, &trial, (left > 0).then_some(eased), &mut next)?;
        if here < least - LEAST_GAIN * least.abs() {
            least = here;
            damping = eased;
            std::mem::swap(kept, &mut trial);
            std::mem::swap(&mut trial, &mut next);
        } else if left > 0 {
            damping *= RAISED;
            pass(joint, level, kept, Some(damping), &mut trial)?;
        }
        visit();
    }
    Ok((first, least))
}

/// A level, and how it is refined.
#[derive(Clone, Copy)]
pub struct Level<'a> {
    /// Which one.
    pub level: usize,
    /// Texels across and down.
    pub size: (usize, usize),
    /// Slots of a texel.
    pub slots: usize,
    /// What lies beyond the edges.
    pub addressing: Addressing,
    /// Where it may be cancelled.
    pub monitor: &'a Monitor,
}

/// A level whose texels move together, worked through strip by strip.
pub trait Joint: Sync {
    /// What one thread needs.
    type Room;

    /// Room for one thread.
    fn room(&self) -> Self::Room;

    /// Rows of a strip.
    fn rows(&self) -> usize;

    /// Works through the rows from `top` that `to` holds; returns their part of E at `from`. With a damping, `to`
    /// becomes the lobes a step on.
    fn strip(
        &self,
        from: &[StoredLobe],
        top: usize,
        damping: Option<f64>,
        to: &mut [StoredLobe],
        room: &mut Self::Room,
    ) -> Result<f64, Cancelled>;
}

/// E at `from`; with a damping, `to` becomes the lobes a step on.
fn pass<J: Joint>(
    joint: &J,
    level: &Level<'_>,
    from: &[StoredLobe],
    damping: Option<f64>,
    to: &mut [StoredLobe],
) -> Result<f64, Cancelled> {
    let rows = joint.rows();
    let strips = to.par_chunks_mut(rows * level.size.0 * level.slots).enumerate();
    let strip = |room: &mut J::Room, (index, to): (usize, &mut [StoredLobe])| {
        joint.strip(from, index * rows, damping, to, room)
    };
    let energies: Result<Vec<f64>, Cancelled> = strips.map_init(|| joint.room(), strip).collect();
    Ok(energies?.iter().sum())
}

/// The lobes a step on: weights at least 0, of sum 1; no lobe becomes sharper than the material shows.
pub fn moved(from: &[StoredLobe], step: &[f64; MOST], to: &mut [StoredLobe]) {
    let mut total = 0.0;
    let mut lobes = [glam::DVec4::ZERO; MAX_LOBES];
    for (j, (lobe, &stored)) in lobes.iter_mut().zip(from).enumerate() {
        *lobe = glam::Vec4::from(stored).as_dvec4() + glam::DVec4::from_slice(&step[EACH * j..]);
        lobe.x = lobe.x.max(0.0);
        let [alpha, x, y, z] = stored.map(f64::from);
        let longest = (glam::DVec3::new(x, y, z).length() / alpha.max(f64::MIN_POSITIVE)).clamp(LONGEST, 1.0);
        let vector = glam::DVec3::new(lobe.y, lobe.z, lobe.w).clamp_length_max(longest * lobe.x);
        *lobe = glam::DVec4::new(lobe.x, vector.x, vector.y, vector.z);
        total += lobe.x;
    }
    if total > 0.0 {
        to.iter_mut().zip(lobes).for_each(|(to, lobe)| *to = (lobe / total).as_vec4().to_array());
    }
}
