//! A row of texels as lanes read it: columns of normals and of channels, a value for every texel beside the next.

use super::channel_phi::NormalWindow;
use super::crowd;
use super::lanes::LANES;
use crate::normal_map::pyramid::Footprint;
use crate::normal_map::{Addressing, NormalMap};
use crate::sphere::StoredLobe;

/// A row of texels: value `x + 1` of each column is texel x's, those before and behind are the ends' neighbours'.
pub struct TexelRow {
    /// Texels across and down the level.
    size: (usize, usize),
    addressing: Addressing,
    /// Slots of a texel.
    slots: usize,
    /// By axis, then weights, of sum 1; the first normal of every texel before the second of any.
    normals: [Vec<f32>; 4],
    /// Channel by channel of every slot.
    pub channels: Vec<f32>,
}

impl TexelRow {
    /// From one column of a row of `width` texels to the next: a window on the last texel's neighbour ends within.
    pub fn stride(width: usize) -> usize {
        width + 2 + LANES
    }

    /// Room for a row of a level of size `size`.
    pub fn empty(map: &NormalMap, size: (usize, usize), slots: usize, addressing: Addressing) -> Self {
        let stride = Self::stride(size.0);
        let normals = crowd::most_normals(map, size) * stride;
        let normals = std::array::from_fn(|_| vec![0.0; normals]);
        Self { size, addressing, slots, normals, channels: vec![0.0; 4 * slots * stride] }
    }

    /// Takes in row `y` of a level's lobes, and its normals.
    pub fn read(&mut self, map: &NormalMap, from: &[StoredLobe], y: usize) {
        self.read_normals(map, y);
        let ((width, _), stride) = (self.size, Self::stride(self.size.0));
        let row = &from[y * width * self.slots..(y + 1) * width * self.slots];
        for (x, texel) in row.chunks_exact(self.slots).enumerate() {
            for (channel, value) in texel.iter().flatten().enumerate() {
                self.channels[channel * stride + x + 1] = *value;
            }
        }
        let mut channels = std::mem::take(&mut self.channels);
        channels.chunks_mut(stride).for_each(|column| self.close(column));
        self.channels = channels;
    }

    /// Takes in the normals of row `y`; a texel without a valid one is flat.
    pub fn read_normals(&mut self, map: &NormalMap, y: usize) {
        let stride = Self::stride(self.size.0);
        let mut normals = std::mem::take(&mut self.normals);
        for column in &mut normals {
            column.fill(0.0);
        }
        for x in 0..self.size.0 {
            let footprint = Footprint::new((map.width, map.height), self.size, (x, y));
            let mut total = 0.0;
            crowd::each_normal(map, &footprint, |n, [nx, ny, nz], weight| {
                let at = n * stride + x + 1;
                normals.iter_mut().zip([nx, ny, nz, weight]).for_each(|(column, value)| column[at] = value);
                total += weight;
            });
            if total > 0.0 {
                normals[3][x + 1..].iter_mut().step_by(stride).for_each(|weight| *weight /= total);
            } else {
                normals.iter_mut().zip([0.0, 0.0, 1.0, 1.0]).for_each(|(column, value)| column[x + 1] = value);
            }
        }
        normals.iter_mut().flat_map(|column| column.chunks_mut(stride)).for_each(|column| self.close(column));
        self.normals = normals;
    }

    /// Copies the ends of a column to where their neighbours are.
    pub fn close(&self, column: &mut [f32]) {
        let width = self.size.0;
        let (before, behind) = match self.addressing {
            Addressing::Wrap => (column[width], column[1]),
            Addressing::Clamp => (column[1], column[width]),
        };
        (column[0], column[width + 1]) = (before, behind);
    }

    /// The normals of the texels, or of their neighbours, from value `start` of each column on.
    pub fn normals(&self, start: usize) -> NormalWindow<'_> {
        let columns = std::array::from_fn(|axis| &self.normals[axis][..]);
        NormalWindow { columns, stride: Self::stride(self.size.0), start }
    }
}
