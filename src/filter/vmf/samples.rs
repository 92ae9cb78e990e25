//! Gathering a footprint's normals for the E-step, chunk by chunk.
//!
//! A chunk is a fixed part of the footprint, so the sums over it do not depend on how many threads share the work;
//! partial sums are always added in chunk order.

use std::cell::RefCell;
use std::ops::AddAssign;

use rayon::prelude::*;

use super::kernel::{self, KernelLobes, SampleSlices, Sums};
use super::lanes::LANES;
use crate::normal_map::NormalMap;
use crate::normal_map::pyramid::Footprint;

/// Most samples in a chunk.
pub const CHUNK: usize = 4096;

/// Sums over a part of the samples, which add up to those over all.
pub trait Partial: Default + Copy + Send + for<'a> AddAssign<&'a Self> {}

impl<S: Default + Copy + Send + for<'a> AddAssign<&'a S>> Partial for S {}

/// Weighted normals that a fit may sum over as often as it likes.
pub trait Samples: Sync {
    /// Shows every sample to `visit`, a batch at a time and in parallel where there are many; the partial sums are
    /// added in an order that no number of threads changes.
    fn sum<S: Partial>(&self, visit: impl Fn(&SampleSlices, &mut S) + Sync) -> S;
}

/// Room for one chunk, placed so that no group of lanes straddles two cache lines.
#[repr(align(64))]
struct Scratch {
    x: [f32; CHUNK],
    y: [f32; CHUNK],
    z: [f32; CHUNK],
    w: [f32; CHUNK],
}

thread_local! {
    static SCRATCH: RefCell<Box<Scratch>> =
        RefCell::new(Box::new(Scratch { x: [0.0; CHUNK], y: [0.0; CHUNK], z: [0.0; CHUNK], w: [0.0; CHUNK] }));
}

/// The normals of one footprint.
#[derive(Clone, Copy, Debug)]
pub struct FootprintSamples<'a> {
    map: &'a NormalMap,
    footprint: Footprint,
}

/// A rectangle of a footprint that fits the scratch memory: base columns and rows, half open.
#[derive(Clone, Copy, Debug)]
struct Part {
    columns: (usize, usize),
    rows: (usize, usize),
}

impl<'a> FootprintSamples<'a> {
    /// The samples of `footprint` over `map`.
    pub fn new(map: &'a NormalMap, footprint: Footprint) -> Self {
        Self { map, footprint }
    }

    /// The map they are read from.
    pub fn map(&self) -> &'a NormalMap {
        self.map
    }

    /// The base texels they cover.
    pub fn footprint(&self) -> &Footprint {
        &self.footprint
    }

    /// Base texels touched.
    pub fn len(&self) -> usize {
        self.footprint.len()
    }

    /// Never true: a footprint always touches a texel.
    pub fn is_empty(&self) -> bool {
        self.footprint.is_empty()
    }

    /// The E-step over the whole footprint, in parallel where it is large.
    pub fn e_step(&self, lobes: &KernelLobes) -> Sums {
        self.sum(|slices, sums| kernel::accumulate(slices, lobes, sums))
    }

    /// Parts across a row, and rows in a part.
    fn layout(&self) -> (usize, usize) {
        let width = self.footprint.columns.len();
        if width > CHUNK { (width.div_ceil(CHUNK), 1) } else { (1, (CHUNK / width).max(1)) }
    }

    fn part(&self, index: usize, across: usize, rows_per_part: usize) -> Part {
        let (columns, rows) = (&self.footprint.columns, &self.footprint.rows);
        let left = columns.start + index % across * CHUNK;
        let top = rows.start + index / across * rows_per_part;
        Part { columns: (left, (left + CHUNK).min(columns.end)), rows: (top, (top + rows_per_part).min(rows.end)) }
    }

    fn visit_part<S: Partial>(&self, part: Part, visit: &impl Fn(&SampleSlices, &mut S)) -> S {
        SCRATCH.with_borrow_mut(|scratch| {
            let count = self.gather(part, scratch);
            let samples = SampleSlices {
                x: &scratch.x[..count],
                y: &scratch.y[..count],
                z: &scratch.z[..count],
                w: &scratch.w[..count],
                spread: &[],
            };
            let mut sums = S::default();
            visit(&samples, &mut sums);
            sums
        })
    }

    /// Copies a part into `scratch` and pads it; returns the padded count.
    fn gather(&self, part: Part, scratch: &mut Scratch) -> usize {
        let (left, right) = part.columns;
        let mut count = 0;
        for y in part.rows.0..part.rows.1 {
            let row = y * self.map.width;
            let (from, to) = (row + left, row + right);
            let next = count + right - left;
            scratch.x[count..next].copy_from_slice(&self.map.x[from..to]);
            scratch.y[count..next].copy_from_slice(&self.map.y[from..to]);
            scratch.z[count..next].copy_from_slice(&self.map.z[from..to]);
            scratch.w[count..next].fill(self.footprint.rows.weight(y));
            if !self.footprint.columns.is_whole() {
                for x in left..right {
                    scratch.w[count + x - left] *= self.footprint.columns.weight(x);
                }
            }
            count = next;
        }
        if self.map.invalid > 0 {
            for i in 0..count {
                if scratch.x[i] == 0.0 && scratch.y[i] == 0.0 && scratch.z[i] == 0.0 {
                    scratch.w[i] = 0.0;
                }
            }
        }
        let padded = count.next_multiple_of(LANES);
        for array in [&mut scratch.x, &mut scratch.y, &mut scratch.z, &mut scratch.w] {
            array[count..padded].fill(0.0);
        }
        padded
    }
}

impl Samples for FootprintSamples<'_> {
    fn sum<S: Partial>(&self, visit: impl Fn(&SampleSlices, &mut S) + Sync) -> S {
        let (across, rows_per_part) = self.layout();
        let parts = across * self.footprint.rows.len().div_ceil(rows_per_part);
        let partial = |index: usize| self.visit_part(self.part(index, across, rows_per_part), &visit);
        if parts == 1 {
            return partial(0);
        }
        // Batches bound the memory for partial sums; their order is the chunks' order.
        const BATCH: usize = 64;
        let mut sums = S::default();
        let mut batch = [S::default(); BATCH];
        for first in (0..parts).step_by(BATCH) {
            let count = BATCH.min(parts - first);
            batch[..count].par_iter_mut().enumerate().for_each(|(i, slot)| *slot = partial(first + i));
            batch[..count].iter().for_each(|partial| sums += partial);
        }
        sums
    }
}
