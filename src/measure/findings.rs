//! What was found so far: points by methods.

use super::figures::{Cell, MethodFigures, Reference};
use super::follower::Finding;
use super::measurer::Point;

/// A grid of figures that fills as they are found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Findings {
    /// The truth of each point.
    pub references: Vec<Option<Reference>>,
    /// `methods[point][method]`.
    pub methods: Vec<Vec<Option<MethodFigures>>>,
}

impl Findings {
    /// Nothing found yet.
    pub fn new(points: usize, methods: usize) -> Self {
        Self { references: vec![None; points], methods: vec![vec![None; methods]; points] }
    }

    /// Takes what was found; pictures are left.
    pub fn take(&mut self, finding: &Finding) {
        match finding {
            Finding::Truth { point, reference, .. } => self.references[*point] = Some(*reference),
            Finding::Method { point, method, figures, .. } => self.methods[*point][*method] = Some(figures.clone()),
        }
    }

    /// The figures of one method at one point.
    pub fn figures(&self, point: usize, method: usize) -> Option<&MethodFigures> {
        self.methods.get(point)?.get(method)?.as_ref()
    }

    /// What is known of a point of the map of this name; methods that are not measured yet are left out.
    pub fn cell(&self, map: &str, index: usize, point: &Point) -> Option<Cell> {
        Some(Cell {
            map: map.to_owned(),
            distance: point.surface.camera.distance,
            exponent: point.surface.material.exponent(),
            brdf: point.surface.material.brdf_name(),
            reference: self.references[index]?,
            methods: self.methods[index].iter().flatten().cloned().collect(),
        })
    }
}
