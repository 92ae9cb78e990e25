//! The damped Gauss-Newton steps of [`super::gauss_newton`] for a crowd, a texel a lane: each lane has its own damping
//! and keeps the steps that lower its own Phi.

#![expect(clippy::needless_range_loop, reason = "lanes of several arrays are walked by one index, which vectorises")]

use std::cell::RefCell;
use std::f32::consts::{LN_10, LOG2_E};

use multiversion::multiversion;
use multiversion::target::target_cfg_f;

use super::crowd::{CrowdLobes, CrowdSamples, Mask};
use super::crowd_phi::{CrowdParameters, CrowdPhi};
use super::crowd_system::{CrowdSystem, EACH};
use super::gauss_newton::{DAMPING, EASED, FLOOR, RAISED, TURN_LIMIT};
use super::kernel::ReadLobes;
use super::lane_width::LaneWidth;
use super::lanes::{LANES, Lanes, exp_of_negative};
use super::phi::{KAPPA_MIN, pair_index};
use crate::sphere::mixture::EMPTY_WEIGHT;
use crate::sphere::vmf::{KAPPA_DELTA, KAPPA_MAX};

/// What Phi must fall by in proportion, some ten roundings of it: a step that gains less is a step at random.
const LEAST_GAIN: f32 = 1e-6;

/// Room for the steps of one crowd.
#[derive(Default)]
struct Room {
    at: CrowdParameters,
    next: CrowdParameters,
    here: CrowdPhi,
    there: CrowdPhi,
    damped: CrowdSystem,
}

thread_local! {
    /// One for each thread: 400 KiB, of which a crowd fills what it needs.
    static ROOM: RefCell<Box<Room>> = RefCell::default();
}

/// Takes `steps` steps of the texels in `mask`.
pub fn refine(samples: &CrowdSamples, lobes: &mut CrowdLobes, steps: usize, mask: &Mask) {
    if steps == 0 || *mask == [false; LANES] {
        return;
    }
    ROOM.with_borrow_mut(|room| {
        let mut moved = [false; LANES];
        let mut damping = Lanes::splat(DAMPING as f32);
        read(lobes, &mut room.at);
        let weights = room.here.weights(&room.at);
        room.here.move_to(samples, &room.at, &weights);
        for left in (0..steps).rev() {
            room.damped.copy_from(&room.here.system);
            damp(&mut room.damped, &damping);
            let solved = room.damped.solve();
            step(&room.at, &room.here, &room.damped, &mut room.next);
            room.there.move_to(samples, &room.next, &weights);
            let lower = |i: usize| room.there.phi.0[i] < room.here.phi.0[i] - LEAST_GAIN * room.here.phi.0[i].abs();
            let better: Mask = std::array::from_fn(|i| mask[i] && solved[i] && lower(i));
            for i in 0..LANES {
                damping.0[i] *= if better[i] { EASED as f32 } else { RAISED as f32 };
                moved[i] |= better[i];
            }
            take(room, &better);
            if left > 0 {
                take_equations(&mut room.here, &room.there, &better);
            }
        }
        store(&room.at, &moved, lobes);
    });
}

/// The lobes of the last E-step as parameters.
fn read(lobes: &CrowdLobes, at: &mut CrowdParameters) {
    at.count = lobes.count();
    for j in 0..at.count {
        let lobe = lobes.lobe(j);
        at.mu[j] = lobe.mu;
        for i in 0..LANES {
            let alpha = lobes.alpha[j].0[i];
            at.alpha[j].0[i] = if alpha > EMPTY_WEIGHT { alpha } else { 0.0 };
            let kappa = lobe.factor.0[i] * (-2.0 / LOG2_E);
            // What the E-step caps is equal normals, which stay a delta.
            let delta = kappa > 0.999 * KAPPA_MAX as f32;
            at.kappa[j].0[i] = if delta { KAPPA_DELTA as f32 } else { kappa.max(KAPPA_MIN as f32) };
        }
    }
}

/// Raises the diagonals as [`super::gauss_newton`] does.
#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
fn damp(system: &mut CrowdSystem, damping: &Lanes) {
    let mut largest = Lanes::splat(f32::MIN_POSITIVE);
    for j in 0..system.count {
        let tile = &system.tiles[pair_index(j, j)];
        for p in 0..EACH {
            for i in 0..LANES {
                largest.0[i] = largest.0[i].max(tile[p][p].0[i]);
            }
        }
    }
    for j in 0..system.count {
        let tile = &mut system.tiles[pair_index(j, j)];
        for i in 0..LANES {
            let floor = FLOOR as f32 * largest.0[i];
            let tangents = 0.5 * (tile[1][1].0[i].max(0.0) + tile[2][2].0[i].max(0.0));
            tile[0][0].0[i] += damping.0[i] * tile[0][0].0[i].max(0.0) + floor;
            tile[1][1].0[i] += damping.0[i] * tangents + floor;
            tile[2][2].0[i] += damping.0[i] * tangents + floor;
            tile[3][3].0[i] += damping.0[i] * tile[3][3].0[i].max(0.0) + floor;
        }
    }
}

/// The parameters after the step that solves the equations.
#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
fn step(at: &CrowdParameters, here: &CrowdPhi, solved: &CrowdSystem, next: &mut CrowdParameters) {
    const FMA: bool = target_cfg_f!(any(target_feature = "fma", target_arch = "aarch64"));
    next.count = at.count;
    let mut total = Lanes::splat(f32::MIN_POSITIVE);
    for j in 0..at.count {
        let ([first, second], solution) = (&here.frames[j], &solved.right[j]);
        let [x, y, z] = &at.mu[j];
        for i in 0..LANES {
            let alpha = at.alpha[j].0[i];
            let scale = if alpha > 0.0 { -1.0 / alpha } else { 0.0 };
            let factor = |log: f32| 10.0 * exp_of_negative::<FMA>(log.clamp(-LN_10, LN_10) - LN_10);
            let moved = alpha * factor(scale * solution[0].0[i]);
            next.alpha[j].0[i] = moved;
            total.0[i] += moved;
            next.kappa[j].0[i] =
                (at.kappa[j].0[i] * factor(scale * solution[3].0[i])).clamp(KAPPA_MIN as f32, KAPPA_DELTA as f32);
            let (a, b) = (scale * solution[1].0[i], scale * solution[2].0[i]);
            let shortened = (TURN_LIMIT as f32 / (a * a + b * b).sqrt().max(f32::MIN_POSITIVE)).min(1.0);
            let (a, b) = (a * shortened, b * shortened);
            let x = x.0[i] + a * first[0].0[i] + b * second[0].0[i];
            let y = y.0[i] + a * first[1].0[i] + b * second[1].0[i];
            let z = z.0[i] + a * first[2].0[i] + b * second[2].0[i];
            // A unit vector and something at right angles to it: never short.
            let inverse = 1.0 / (x * x + y * y + z * z).sqrt();
            let mu = &mut next.mu[j];
            (mu[0].0[i], mu[1].0[i], mu[2].0[i]) = (x * inverse, y * inverse, z * inverse);
        }
    }
    for alpha in &mut next.alpha[..at.count] {
        for i in 0..LANES {
            alpha.0[i] /= total.0[i];
        }
    }
}

/// Goes to the next place where it is better.
#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
fn take(room: &mut Room, better: &Mask) {
    let count = room.at.count;
    select(std::slice::from_mut(&mut room.here.phi), std::slice::from_ref(&room.there.phi), better);
    select(&mut room.at.alpha[..count], &room.next.alpha, better);
    select(room.at.mu[..count].as_flattened_mut(), room.next.mu.as_flattened(), better);
    select(&mut room.at.kappa[..count], &room.next.kappa, better);
}

/// Takes the equations of the next place where that is better: for another step from there.
#[multiversion(targets(
    "x86_64+avx+avx2+bmi1+bmi2+fma+avx512f+avx512bw+avx512dq+avx512vl",
    "x86_64+avx+avx2+bmi1+bmi2+fma",
    "x86_64+sse4.1"
))]
fn take_equations(here: &mut CrowdPhi, there: &CrowdPhi, better: &Mask) {
    let frames = here.frames[..here.system.count].as_flattened_mut().as_flattened_mut();
    select(frames, there.frames.as_flattened().as_flattened(), better);
    for (own, other) in here.system.parts_mut().into_iter().zip(there.system.parts()) {
        select(own, other, better);
    }
}

/// Replaces the lanes in `mask`.
#[inline(always)]
fn select(own: &mut [Lanes], other: &[Lanes], mask: &Mask) {
    let mut taken = Lanes::splat(0.0);
    for i in 0..LANES {
        taken.0[i] = if mask[i] { 1.0 } else { 0.0 };
    }
    for (own, other) in own.iter_mut().zip(other) {
        let (mut chosen, other) = (*own, *other);
        for i in 0..LANES {
            chosen.0[i] = if taken.0[i] > 0.0 { other.0[i] } else { chosen.0[i] };
        }
        *own = chosen;
    }
}

/// Writes the lobes of the texels that moved.
fn store(at: &CrowdParameters, moved: &Mask, lobes: &mut CrowdLobes) {
    for j in 0..at.count {
        for i in (0..LANES).filter(|&i| moved[i]) {
            lobes.alpha[j].0[i] = at.alpha[j].0[i];
            let length = LaneWidth::of_kappa::<false>(at.kappa[j].0[i]).length;
            for axis in 0..3 {
                lobes.resultant[j][axis].0[i] = length * at.mu[j][axis].0[i];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::vmf::crowd::{self, CrowdStop};
    use crate::filter::vmf::gauss_newton;
    use crate::filter::vmf::phi::{Evaluation, Parameters};
    use crate::filter::vmf::samples::FootprintSamples;
    use crate::filter::vmf::seed;
    use crate::normal_map::procedural;
    use crate::sphere::vmf::KappaRule;

    #[test]
    fn a_crowd_lowers_phi_as_far_as_each_texel_alone() {
        let map = procedural::find("bricks").expect("bundled").make(64);
        for level in [2, 3] {
            crowd::with_crowd(&map, map.level_size(level), 3, LANES, |samples, footprints| {
                let mut lobes = CrowdLobes::empty(4, KappaRule::Exact);
                for (lane, footprint) in footprints.iter().enumerate() {
                    let (centres, count) = seed::farthest_normals(&map, footprint, 4);
                    lobes.set(lane, &seed::assign(&FootprintSamples::new(&map, *footprint), &centres[..count], 4));
                }
                lobes.prepare();
                let stop = CrowdStop { iterations: [3; LANES], tolerance: f32::NEG_INFINITY };
                let total = samples.fit(&mut lobes, &stop).total;
                let before = lobes.clone();
                refine(samples, &mut lobes, 3, &[true; LANES]);
                for (lane, footprint) in footprints.iter().enumerate() {
                    let of = FootprintSamples::new(&map, *footprint);
                    let mut alone = before.texel(lane, total[lane]);
                    let start = Evaluation::new(&of, Parameters::of(&alone)).expect("valid normals");
                    let weights = start.weights();
                    gauss_newton::refine(&of, &mut alone, 3, &mut || true);
                    let phi = |lobes| Evaluation::new(&of, Parameters::of(lobes)).expect("valid normals").phi(&weights);
                    let (alone, crowd) = (phi(&alone), phi(&lobes.texel(lane, total[lane])));
                    let start = start.phi(&weights);
                    // Single precision may decide otherwise where a step gains next to nothing.
                    assert!(crowd <= start + 1e-5, "level {level}, lane {lane}: {crowd} after {start}");
                    assert!(
                        crowd < alone + 1e-4 + 0.05 * (start - alone),
                        "level {level}, lane {lane}: {crowd}, {alone}"
                    );
                }
            })
            .expect("small footprints");
        }
    }
}
