//! The finer texels that a texel's box reaches into, with their lobes.

use super::merge::{Candidates, Criterion};
use super::pyramid::LobePyramid;
use super::selection;
use crate::normal_map::pyramid::Span;
use crate::sphere::StoredLobe;

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
        let sizes = lobes.map.level_sizes();
        let (coarse, fine) = (sizes[level], sizes[level - 1]);
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
        self.each(|stored, _| most = most.max(selection::used(stored)));
        most
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
