//! Where EM starts: the children's lobes, or the footprint's own normals, that lie farthest apart, then one hard
//! assignment of the normals.
//!
//! The greedy farthest-point form of Hochbaum and Shmoys (1985), a 2-approximation of the k-centre problem
//! (Gonzalez 1985), deterministic: ties take the lowest index.

use glam::{DVec3, Vec3};

use super::em::TexelLobes;
use super::kernel::KernelLobes;
use super::samples::FootprintSamples;
use crate::normal_map::NormalMap;
use crate::normal_map::pyramid::Footprint;
use crate::sphere::mixture::{EMPTY_WEIGHT, MAX_LOBES};

/// Most candidates a texel has: a box reaches into at most 4 by 4 children.
const MAX_CANDIDATES: usize = 16 * MAX_LOBES;

/// Squared chord below which two directions are the same.
const SAME: f32 = 1e-10;

/// Concentration at which an E-step assigns a normal to its nearest centre and to no other, ties apart.
pub const HARD_KAPPA: f32 = 1e4;

/// Directions to choose seeds from, kept on the stack.
#[derive(Clone, Debug)]
pub struct Candidates {
    directions: [Vec3; MAX_CANDIDATES],
    count: usize,
}

impl Default for Candidates {
    fn default() -> Self {
        Self { directions: [Vec3::ZERO; MAX_CANDIDATES], count: 0 }
    }
}

impl Candidates {
    /// Forgets all of them.
    pub fn clear(&mut self) {
        self.count = 0;
    }

    /// Adds the direction of a resultant vector; one without direction, or beyond the room there is, is left out.
    pub fn push(&mut self, resultant: Vec3) {
        if let (Some(direction), true) = (resultant.try_normalize(), self.count < MAX_CANDIDATES) {
            self.directions[self.count] = direction;
            self.count += 1;
        }
    }

    /// Adds every lobe of a stored mixture.
    pub fn push_stored(&mut self, stored: &[[f32; 4]]) {
        stored.iter().filter(|s| s[0] > EMPTY_WEIGHT).for_each(|s| self.push(Vec3::new(s[1], s[2], s[3])));
    }

    /// At most `wanted` of the candidates, each as far as can be from those before it; the first is the one nearest
    /// to `mean`. Fewer where fewer are distinct.
    pub fn farthest_apart(&self, wanted: usize, mean: Vec3) -> ([Vec3; MAX_LOBES], usize) {
        let mut nearest = [f32::INFINITY; MAX_CANDIDATES];
        farthest(&self.directions[..self.count], &mut nearest[..self.count], wanted, mean)
    }
}

/// The greedy farthest-point choice; `nearest` starts infinite and keeps each direction's squared chord to the chosen.
fn farthest(directions: &[Vec3], nearest: &mut [f32], wanted: usize, mean: Vec3) -> ([Vec3; MAX_LOBES], usize) {
    let mut centres = [Vec3::Z; MAX_LOBES];
    let mut chosen = index_of_max(directions.iter().map(|direction| direction.dot(mean)));
    let mut count = 0;
    while let Some(index) = chosen {
        centres[count] = directions[index];
        count += 1;
        for (distance, direction) in nearest.iter_mut().zip(directions) {
            *distance = distance.min(direction.distance_squared(directions[index]));
        }
        let next = index_of_max(nearest.iter().copied());
        chosen = next.filter(|&i| count < wanted.min(MAX_LOBES) && nearest[i] > SAME);
    }
    (centres, count)
}

/// Most normals that are searched for extremes; a larger footprint is searched in even strides.
const SEARCHED: usize = 65_536;

/// At most `wanted` of the footprint's own normals, each as far as can be from those before it; the first is the one
/// nearest to the mean.
pub fn farthest_normals(map: &NormalMap, footprint: &Footprint, wanted: usize) -> ([Vec3; MAX_LOBES], usize) {
    let stride = footprint.len().div_ceil(SEARCHED).max(1);
    let texels = footprint.texels().step_by(stride);
    let normals: Vec<Vec3> = texels.filter_map(|(x, y, _)| map.normal(y * map.width + x)).collect();
    let mut nearest = vec![f32::INFINITY; normals.len()];
    let mean: DVec3 = normals.iter().map(|normal| normal.as_dvec3()).sum();
    farthest(&normals, &mut nearest, wanted, mean.as_vec3())
}

/// The footprint's normal that lies farthest from the nearest of `centres`; `None` where every one lies on a centre.
pub fn farthest_from(map: &NormalMap, footprint: &Footprint, centres: &[Vec3]) -> Option<Vec3> {
    let stride = footprint.len().div_ceil(SEARCHED).max(1);
    let nearest = |normal: Vec3| centres.iter().map(|c| c.distance_squared(normal)).fold(f32::INFINITY, f32::min);
    let texels = footprint.texels().step_by(stride);
    let normals = texels.filter_map(|(x, y, _)| map.normal(y * map.width + x));
    let farthest = normals.map(|normal| (nearest(normal), normal)).reduce(|a, b| if b.0 > a.0 { b } else { a });
    farthest.filter(|(distance, _)| *distance > SAME).map(|(_, normal)| normal)
}

/// Index of the first largest value.
fn index_of_max(values: impl Iterator<Item = f32>) -> Option<usize> {
    values
        .enumerate()
        .fold(None, |best: Option<(usize, f32)>, (i, v)| match best {
            Some((_, largest)) if v <= largest => best,
            _ => Some((i, v)),
        })
        .map(|(index, _)| index)
}

/// The mixture that a hard assignment of the normals to `centres` gives; `slots` in all.
pub fn assign(samples: &FootprintSamples<'_>, centres: &[Vec3], slots: usize) -> TexelLobes {
    let mut kernel = KernelLobes { count: centres.len(), ..Default::default() };
    for (j, centre) in centres.iter().enumerate() {
        kernel.mu[j] = centre.to_array();
        kernel.neg_half_kappa[j] = -0.5 * HARD_KAPPA;
        kernel.log_scale[j] = 0.0;
    }
    let sums = samples.e_step(&kernel);
    if sums.total <= 0.0 {
        return TexelLobes::flat(slots);
    }
    let mut lobes = TexelLobes::empty(slots);
    lobes.m_step(&kernel, &sums);
    lobes
}

/// Every distinct normal of a small footprint as a delta of its own weight, or `None` if there are more than `slots`.
pub fn exact(map: &NormalMap, footprint: &Footprint, slots: usize) -> Option<TexelLobes> {
    let mut lobes = TexelLobes::empty(slots);
    let (mut used, mut total) = (0, 0.0);
    for (x, y, area) in footprint.texels() {
        let Some(normal) = map.normal(y * map.width + x) else { continue };
        let normal = normal.as_dvec3();
        let slot = (0..used).find(|&j| lobes.resultant[j].distance_squared(normal) < f64::from(SAME));
        let slot = match slot {
            Some(slot) => slot,
            None if used == lobes.count => return None,
            None => {
                lobes.resultant[used] = normal;
                used += 1;
                used - 1
            }
        };
        lobes.alpha[slot] += f64::from(area);
        total += f64::from(area);
    }
    if total == 0.0 {
        return Some(TexelLobes::flat(slots));
    }
    lobes.alpha.iter_mut().for_each(|alpha| *alpha /= total);
    Some(lobes)
}

/// The mean direction of stored lobes weighted by alpha, for the first centre.
pub fn mean_of(stored: impl Iterator<Item = [f32; 4]>) -> Vec3 {
    stored.map(|s| DVec3::new(f64::from(s[1]), f64::from(s[2]), f64::from(s[3]))).sum::<DVec3>().as_vec3()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_centres_are_the_extremes_and_never_repeat() {
        let mut candidates = Candidates::default();
        for x in [0.0_f32, 0.01, 0.8, -0.8, 0.8] {
            candidates.push(Vec3::new(x, 0.0, 1.0));
        }
        let (centres, count) = candidates.farthest_apart(3, Vec3::Z);
        assert_eq!(count, 3);
        assert!(centres[0].x.abs() < 0.02 && centres[1].x.abs() > 0.6 && centres[2].x.abs() > 0.6);
        assert_eq!(candidates.farthest_apart(9, Vec3::Z).1, 4);
    }
}
