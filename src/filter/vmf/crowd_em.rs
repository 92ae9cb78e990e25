//! Each texel's own fit by EM for small footprints, a crowd of texels at a time: the same seeds, the same race and the
//! same stop as one texel's alone ([`super::unaligned`]).

use std::cell::RefCell;

use super::crowd::{CrowdLobes, CrowdOutcome, CrowdSamples, CrowdStop, MOST_NORMALS};
use super::em::{TexelFit, TexelLobes};
use super::lanes::LANES;
use super::seed::{self, Candidates, HARD_KAPPA};
use super::unaligned::{LevelFit, RACE, RACED};
use crate::normal_map::pyramid::Footprint;

/// Room for one crowd.
#[derive(Default)]
struct Room {
    samples: CrowdSamples,
    candidates: Candidates,
}

thread_local! {
    static ROOM: RefCell<Room> = RefCell::default();
}

/// True where the footprints are small enough.
pub fn serves(footprints: &[Footprint]) -> bool {
    footprints.iter().all(|footprint| footprint.len() <= MOST_NORMALS)
}

/// Fits the texels from `first` on, one for each footprint, and shows each to `keep` with its place among them.
pub fn fit(job: &LevelFit<'_>, first: usize, footprints: &[Footprint], keep: &mut dyn FnMut(usize, &TexelFit)) {
    ROOM.with_borrow_mut(|room| {
        room.samples.gather(&job.lobes.map, footprints);
        let (lobes, outcome) = room.fit(job, first, footprints);
        for lane in 0..footprints.len() {
            let texel = if outcome.total[lane] > 0.0 { lobes.texel(lane) } else { TexelLobes::flat(lobes.count) };
            let fit = TexelFit {
                lobes: texel.settled(job.settings.kappa),
                mean_log_likelihood: f64::from(outcome.mean_log_likelihood[lane]),
                iterations: outcome.iterations[lane],
            };
            keep(lane, &fit);
        }
    });
}

impl Room {
    /// Seeds and fits what was gathered.
    fn fit(&mut self, job: &LevelFit<'_>, first: usize, footprints: &[Footprint]) -> (CrowdLobes, CrowdOutcome) {
        let settings = job.settings;
        let mut lobes = CrowdLobes::empty(settings.lobes, settings.kappa);
        let mut searched = [false; LANES];
        for (lane, footprint) in footprints.iter().enumerate() {
            let small = footprint.len() <= settings.lobes;
            let exact = if small { seed::exact(&job.lobes.map, footprint, settings.lobes) } else { None };
            searched[lane] = exact.is_none();
            if let Some(exact) = exact {
                (0..settings.lobes).for_each(|j| lobes.set(lane, j, exact.alpha[j] as f32, exact.resultant[j].as_vec3()));
            }
        }
        lobes.prepare();
        let stop = CrowdStop {
            iterations: searched.map(|searched| if searched { settings.iterations } else { 0 }),
            tolerance: settings.tolerance as f32,
        };
        if searched == [false; LANES] {
            let outcome = self.samples.fit(&mut lobes, &stop);
            return (lobes, outcome);
        }
        let mut rival = lobes.clone();
        for lane in (0..footprints.len()).filter(|&lane| searched[lane]) {
            let (centres, count) = job.children(first + lane).farthest_apart(settings.lobes, &mut self.candidates);
            lobes.set_centres(lane, &centres[..count], HARD_KAPPA);
        }
        self.samples.step(&mut lobes, &searched);
        let raced = footprints.iter().any(|footprint| footprint.len() >= RACED) && settings.iterations > RACE;
        if !raced {
            let outcome = self.samples.fit(&mut lobes, &stop);
            return (lobes, outcome);
        }
        for lane in (0..footprints.len()).filter(|&lane| searched[lane]) {
            let (centres, count) = seed::farthest_normals(&job.lobes.map, &footprints[lane], settings.lobes);
            rival.set_centres(lane, &centres[..count], HARD_KAPPA);
        }
        self.samples.step(&mut rival, &searched);
        let outcome = self.race(&mut lobes, rival, &stop);
        (lobes, outcome)
    }

    /// Runs both seeds for a while and each texel's better one to the end.
    fn race(&mut self, lobes: &mut CrowdLobes, mut rival: CrowdLobes, stop: &CrowdStop) -> CrowdOutcome {
        let short = CrowdStop { iterations: stop.iterations.map(|most| most.min(RACE)), ..*stop };
        let mut so_far = self.samples.fit(lobes, &short);
        let second = self.samples.fit(&mut rival, &short);
        for lane in 0..LANES {
            if second.mean_log_likelihood[lane] > so_far.mean_log_likelihood[lane] {
                lobes.take(&rival, lane);
                so_far.iterations[lane] = second.iterations[lane];
            }
        }
        let left = |lane: usize| if so_far.iterations[lane] < RACE { 0 } else { stop.iterations[lane] - RACE };
        let mut outcome = self.samples.fit(lobes, &CrowdStop { iterations: std::array::from_fn(left), ..*stop });
        outcome.iterations.iter_mut().zip(so_far.iterations).for_each(|(rest, before)| *rest += before);
        outcome
    }
}
