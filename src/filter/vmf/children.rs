//! The finer texels that a texel's box reaches into, with their lobes.

use glam::Vec3;

use super::merge::{Candidates, Criterion};
use super::pyramid::LobePyramid;
use super::seed;
use crate::normal_map::pyramid::Span;
use crate::sphere::StoredLobe;
use crate::sphere::mixture::{MAX_LOBES, used};

/// The children of one texel.
#[derive(Clone, Copy, Debug)]
pub struct Children<'a> {
    lobes: &'a LobePyramid,
    level: usize,
    columns: Span,
    rows: Span,
}

impl<'a> Children<'a> {
    /// The children of texel `(x, y)` of `level`; the finer level must be fitted.
    pub fn new(lobes: &'a LobePyramid, level: usize, (x, y): (usize, usize)) -> Self {
        let (coarse, fine) = (lobes.map.level_size(level), lobes.map.level_size(level - 1));
        Self { lobes, level: level - 1, columns: Span::new(fine.0, coarse.0, x), rows: Span::new(fine.1, coarse.1, y) }
    }

    /// Shows the lobes of each child and the area of it inside the box, in children.
    pub fn each(&self, mut visit: impl FnMut(&[StoredLobe], f32)) {
        for y in self.rows.start..self.rows.end {
            for x in self.columns.start..self.columns.end {
                let area = self.columns.weight(x) * self.rows.weight(y);
                match self.lobes.level(self.level) {
                    Some(finer) => visit(finer.texel(x, y), area),
                    None => visit(&[self.lobes.base_lobe(y * self.lobes.map.width + x)], area),
                }
            }
        }
    }

    /// The lobes in use of the child that has most of them.
    pub fn most_lobes(&self) -> usize {
        let mut most = 0;
        self.each(|stored, _| most = most.max(used(stored)));
        most
    }

    /// At most `slots` of the directions of their lobes, each as far as can be from those before it; `candidates` is
    /// room for the choice.
    pub fn farthest_apart(&self, slots: usize, candidates: &mut seed::Candidates) -> ([Vec3; MAX_LOBES], usize) {
        let mut mean = Vec3::ZERO;
        candidates.clear();
        self.each(|stored, _| {
            candidates.push_stored(stored);
            mean += seed::mean_of(stored.iter().copied());
        });
        candidates.farthest_apart(slots, mean)
    }

    /// Adds every child's lobes, their weights times the child's area.
    pub fn add_to(&self, candidates: &mut Candidates, criterion: &impl Criterion) {
        self.each(|stored, area| {
            for &[alpha, x, y, z] in stored.iter().filter(|stored| stored[0] > 0.0) {
                let resultant = glam::DVec3::new(f64::from(x), f64::from(y), f64::from(z)) / f64::from(alpha);
                candidates.push(criterion.candidate(f64::from(alpha * area), resultant));
            }
        });
    }
}
