//! The base level of a fit while it is read: one normal a texel, found in one slot.

use std::sync::Arc;

use glam::Vec3;

use super::read::{TOLERANCE, no_mixture, not_finite};
use super::{PLAIN, ReadLobesError};
use crate::filter::vmf::BaseSlots;
use crate::image_io::exr_parts::Place;
use crate::normal_map::albedo::Albedo;
use crate::normal_map::{MapOptions, MapSource, NormalMap};

/// A base normal further than this from unit length is normalised; f32 normals as they are written are closer.
const UNIT_TOLERANCE: f32 = 1e-6;

/// The slot of a base texel that has no lobe yet.
const NO_SLOT: u8 = u8::MAX;

/// The base level while it is read: one normal a texel, and the slot it was found in.
pub(super) struct Base {
    size: (usize, usize),
    slots: Vec<u8>,
    normals: [Vec<f32>; 3],
    rgb: Option<Vec<[f32; 3]>>,
    /// A texel with lobes in two slots, or with a weight other than 1.
    odd: Option<usize>,
    finite: bool,
}

impl Base {
    pub fn new(size: (usize, usize), colored: bool) -> Self {
        let texels = size.0 * size.1;
        let normals = std::array::from_fn(|_| vec![0.0; texels]);
        let rgb = colored.then(|| vec![[0.0; 3]; texels]);
        Self { size, slots: vec![NO_SLOT; texels], normals, rgb, odd: None, finite: true }
    }

    /// Stores a run of one component of one slot. The format keeps channels in the alphabet's order, so a lobe's
    /// weight comes before its direction; what comes in another order finds no slot.
    pub fn store(&mut self, place: Place, (slot, component): (usize, usize), row: &[f32]) {
        let first = place.y * self.size.0 + place.x;
        self.finite &= row.iter().all(|value| value.is_finite());
        for (index, &value) in (first..self.slots.len()).zip(row) {
            if component > 0 && usize::from(self.slots[index]) == slot {
                match (component.checked_sub(PLAIN), &mut self.rgb) {
                    (None, _) => self.normals[component - 1][index] = value,
                    (Some(channel), Some(rgb)) => rgb[index][channel] = value,
                    (Some(_), None) => {}
                }
            } else if value != 0.0 {
                let fits = component == 0 && self.slots[index] == NO_SLOT && (value - 1.0).abs() <= TOLERANCE;
                self.odd = self.odd.or((!fits).then_some(index));
                self.slots[index] = slot as u8;
            }
        }
    }

    /// The map and the slots, once every texel is known to hold one unit normal or none.
    pub fn finish(
        mut self,
        name: &str,
        source: MapSource,
        options: MapOptions,
    ) -> Result<(NormalMap, BaseSlots), ReadLobesError> {
        if !self.finite {
            return Err(not_finite(name, 0));
        }
        if let Some(texel) = self.odd.or_else(|| self.normalise()) {
            return Err(no_mixture(name, 0, texel, self.size.0));
        }
        for slot in self.slots.iter_mut().filter(|slot| **slot == NO_SLOT) {
            *slot = 0;
        }
        let mut map = NormalMap::from_unit_normals(self.size, self.normals, source, options);
        if map.invalid == map.len() {
            return Err(ReadLobesError::NoNormals { name: name.to_owned() });
        }
        map.albedo = self.rgb.map(|rgb| Arc::new(Albedo { rgb }));
        Ok((map, BaseSlots { slots: self.slots }))
    }

    /// Brings normals that another program rounded back to unit length; the first texel of another length, if any.
    fn normalise(&mut self) -> Option<usize> {
        let [x, y, z] = &mut self.normals;
        (0..x.len()).find(|&index| {
            let normal = Vec3::new(x[index], y[index], z[index]);
            let off = (normal.length() - 1.0).abs();
            if self.slots[index] == NO_SLOT || off <= UNIT_TOLERANCE {
                return false;
            }
            [x[index], y[index], z[index]] = normal.normalize_or_zero().to_array();
            off > 2.0 * TOLERANCE
        })
    }
}
