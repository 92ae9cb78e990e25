//! Each texel's own fit by EM for small footprints, a crowd of texels at a time: the same seeds, the same race and the
//! same stop as one texel's alone ([`super::unaligned`]).

use std::ops::Range;

use super::crowd::{self, CrowdLobes, CrowdOutcome, CrowdSamples, CrowdStop};
use super::em::TexelFit;
use super::lanes::LANES;
use super::seed::{self, Candidates, HARD_KAPPA};
use super::unaligned::{LevelFit, RACE, RACED};
use crate::normal_map::pyramid::Footprint;

/// Fits at most [`LANES`] texels and shows each to `keep` with its place among them. Returns their normals, or `None`
/// where the footprints are too large for a crowd.
pub fn fit(job: &LevelFit<'_>, texels: Range<usize>, keep: &mut dyn FnMut(usize, &TexelFit)) -> Option<usize> {
    let map = job.lobes.map.as_ref();
    crowd::with_crowd(map, map.level_size(job.level), texels.start, texels.len(), |samples, footprints| {
        let (lobes, outcome) = Crowd { samples, footprints, job, first: texels.start }.fit();
        for lane in 0..footprints.len() {
            let fit = TexelFit {
                lobes: lobes.texel(lane, outcome.total[lane]).settled(job.settings.kappa),
                mean_log_likelihood: f64::from(outcome.mean_log_likelihood[lane]),
                iterations: outcome.iterations[lane],
            };
            keep(lane, &fit);
        }
        footprints.iter().map(Footprint::len).sum()
    })
}

/// A crowd whose normals are gathered.
struct Crowd<'a> {
    samples: &'a mut CrowdSamples,
    footprints: &'a [Footprint],
    job: &'a LevelFit<'a>,
    /// The first of its texels.
    first: usize,
}

impl Crowd<'_> {
    /// Seeds and fits the texels.
    fn fit(&mut self) -> (CrowdLobes, CrowdOutcome) {
        let settings = self.job.settings;
        let mut lobes = CrowdLobes::empty(settings.lobes, settings.kappa);
        let searched = self.set_exact(&mut lobes);
        let stop = CrowdStop {
            iterations: searched.map(|searched| if searched { settings.iterations } else { 0 }),
            tolerance: settings.tolerance as f32,
        };
        if searched == [false; LANES] {
            let outcome = self.samples.fit(&mut lobes, &stop);
            return (lobes, outcome);
        }
        let raced = self.footprints.iter().any(|footprint| footprint.len() >= RACED) && settings.iterations > RACE;
        let rival = raced.then(|| self.seeded_by_normals(lobes.clone(), &searched));
        self.seed_by_children(&mut lobes, &searched);
        let outcome = match rival {
            Some(rival) => self.race(&mut lobes, rival, &stop),
            None => self.samples.fit(&mut lobes, &stop),
        };
        (lobes, outcome)
    }

    /// Gives every distinct normal a lobe of its own where there are few; returns the lanes of the other texels.
    fn set_exact(&self, lobes: &mut CrowdLobes) -> [bool; LANES] {
        let (map, slots) = (self.job.lobes.map.as_ref(), self.job.settings.lobes);
        let mut searched = [false; LANES];
        for (lane, footprint) in self.footprints.iter().enumerate() {
            let exact = if footprint.len() <= slots { seed::exact(map, footprint, slots) } else { None };
            searched[lane] = exact.is_none();
            if let Some(exact) = exact {
                lobes.set(lane, &exact);
            }
        }
        lobes.prepare();
        searched
    }

    /// The children's lobes, farthest apart, then one hard assignment.
    fn seed_by_children(&mut self, lobes: &mut CrowdLobes, searched: &[bool; LANES]) {
        let mut candidates = Candidates::default();
        for lane in (0..self.footprints.len()).filter(|&lane| searched[lane]) {
            let children = self.job.children(self.first + lane);
            let (centres, count) = children.farthest_apart(self.job.settings.lobes, &mut candidates);
            lobes.set_centres(lane, &centres[..count], HARD_KAPPA);
        }
        self.samples.step(lobes, searched);
    }

    /// The footprints' own normals, farthest apart, then one hard assignment.
    fn seeded_by_normals(&mut self, mut lobes: CrowdLobes, searched: &[bool; LANES]) -> CrowdLobes {
        let (map, slots) = (self.job.lobes.map.as_ref(), self.job.settings.lobes);
        for (lane, footprint) in self.footprints.iter().enumerate().filter(|&(lane, _)| searched[lane]) {
            let (centres, count) = seed::farthest_normals(map, footprint, slots);
            lobes.set_centres(lane, &centres[..count], HARD_KAPPA);
        }
        self.samples.step(&mut lobes, searched);
        lobes
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
