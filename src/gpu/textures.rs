//! The map and its lobes as textures, brought up to date a slice a frame.
//!
//! - `means`: mean normals of every level, MIP level by MIP level.
//! - `base_slots`: the slot of each base texel's only lobe, 8 bits.
//! - `lobes`: one array texture, a layer per slot, whose first MIP level is the map's level 1: the base level as
//!   lobes would be empty but for one slot a texel, so the shader blends the base normals in by hand.
//! - `mean_colors` and `lobe_colors`: the same for colours, half as large again; one texel for a map without colour.
//!
//! Levels too large for the adapter or for the memory set aside are left out, the finest first.

use std::sync::Arc;

use super::map_group::{COLOR_FORMAT, MapGroup, create, first_that_fits, float_format, padded_layers};
use super::upload::{Source, UploadQueue};
use crate::filter::PlainMip;
use crate::filter::vmf::{BaseSlots, ColorLevel, LobePyramid, MixtureLevel};

/// Memory set aside for mean normals: just enough for 8192 x 8192 in 32 bits a channel.
const MEANS_BYTES: u64 = 3 << 29;
/// Memory set aside for lobes: 4096 x 4096 at eight lobes, its level 1 being 2048 x 2048.
const LOBES_BYTES: u64 = 1 << 30;

/// The textures of one map, and what of them is complete.
#[derive(Debug)]
pub struct MapTextures {
    device: wgpu::Device,
    layout: wgpu::BindGroupLayout,
    bind_group: wgpu::BindGroup,
    group: MapGroup,
    uploads: UploadQueue,
    mip: Option<Arc<PlainMip>>,
    slots_held: Option<Arc<BaseSlots>>,
    lobes_held: Vec<Option<HeldLevel>>,
    means_complete: Vec<bool>,
    lobes_complete: Vec<bool>,
    slots: usize,
    lobe_level: usize,
    /// Finest levels of the map that are not shown, because the adapter or the memory set aside is too small.
    pub left_out: usize,
    /// Counts the maps taken up.
    pub map_revision: u64,
    /// Counts changes of the mean normals.
    pub means_revision: u64,
    /// Counts changes of the lobes.
    pub lobes_revision: u64,
}

/// A level's lobes, and their colours once they are fitted; the lobes are white until then.
#[derive(Clone, Debug)]
struct HeldLevel {
    mixtures: Arc<MixtureLevel>,
    colors: Option<Arc<ColorLevel>>,
}

impl HeldLevel {
    fn of(pyramid: &LobePyramid, level: usize) -> Option<Self> {
        let colors = pyramid.colors.get(level - 1).cloned().flatten();
        pyramid.level(level).map(|mixtures| Self { mixtures: Arc::clone(mixtures), colors })
    }

    fn has_lobes_of(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.mixtures, &other.mixtures)
    }

    fn is(&self, other: &Self) -> bool {
        let same = match (&self.colors, &other.colors) {
            (Some(own), Some(other)) => Arc::ptr_eq(own, other),
            (None, None) => true,
            _ => false,
        };
        same && self.has_lobes_of(other)
    }
}

impl MapTextures {
    /// Textures of no map.
    pub fn new(device: &wgpu::Device) -> Self {
        let group = MapGroup::empty(device);
        let layout = MapGroup::layout(device);
        let bind_group = group.bind(device, &layout, Default::default());
        Self {
            device: device.clone(),
            layout,
            bind_group,
            group,
            uploads: UploadQueue::default(),
            mip: None,
            slots_held: None,
            lobes_held: Vec::new(),
            means_complete: Vec::new(),
            lobes_complete: Vec::new(),
            slots: 0,
            lobe_level: 1,
            left_out: 0,
            map_revision: 0,
            means_revision: 0,
            lobes_revision: 0,
        }
    }

    /// The layout of group 1.
    pub fn layout(&self) -> &wgpu::BindGroupLayout {
        &self.layout
    }

    /// Group 1: the textures and their sampler.
    pub fn bind_group(&self) -> &wgpu::BindGroup {
        &self.bind_group
    }

    /// Slots that the lobe texture holds.
    pub fn slots(&self) -> usize {
        self.slots
    }

    /// The map's level that the lobe texture begins with.
    pub fn lobe_level(&self) -> usize {
        self.lobe_level
    }

    /// True for a map with colour.
    pub fn is_colored(&self) -> bool {
        self.mip.as_ref().is_some_and(|mip| !mip.colors.is_empty())
    }

    /// Bytes not uploaded yet.
    pub fn pending_bytes(&self) -> u64 {
        self.uploads.pending_bytes()
    }

    /// Takes up another map; nothing happens when it is the one that is held.
    pub fn set_map(&mut self, mip: &Arc<PlainMip>) {
        if self.mip.as_ref().is_some_and(|held| Arc::ptr_eq(held, mip)) {
            return;
        }
        let sizes = mip.map.level_sizes();
        let format = float_format(&self.device);
        self.mip = Some(mip.clone());
        self.left_out = first_that_fits(&self.device, &sizes, 0, 1, MEANS_BYTES, format);
        if self.left_out > 0 {
            log::warn!("the graphics adapter cannot hold the map's finest {} levels: left out", self.left_out);
        }
        let (w, h) = sizes[self.left_out];
        let levels = sizes.len() - self.left_out;
        self.group.means = create(&self.device, "mean normals", (w, h, 1), levels, format);
        let slots_size = if self.left_out == 0 { (w, h, 1) } else { (1, 1, 1) };
        self.group.base_slots = create(&self.device, "base slots", slots_size, 1, wgpu::TextureFormat::R8Uint);
        let (color_size, color_levels) = if self.is_colored() { ((w, h, 1), levels) } else { ((1, 1, 1), 1) };
        self.group.mean_colors = create(&self.device, "mean colours", color_size, color_levels, COLOR_FORMAT);
        self.upload_means(mip);
        self.slots_held = None;
        self.means_complete = vec![false; sizes.len()];
        self.map_revision += 1;
        self.means_revision += 1;
        self.set_slot_count(0);
    }

    fn upload_means(&mut self, mip: &Arc<PlainMip>) {
        self.uploads = UploadQueue::default();
        for level in (self.left_out..mip.levels.len()).rev() {
            let target = (level - self.left_out) as u32;
            self.uploads.push(&self.group.means, target, Source::Means { mip: mip.clone(), level });
            if self.is_colored() {
                self.uploads.push(&self.group.mean_colors, target, Source::MeanColors { mip: mip.clone(), level });
            }
        }
    }

    /// Takes up the lobes at hand: levels that are not yet held are uploaded, the coarsest first.
    /// They must belong to the map that is held.
    pub fn set_lobes(&mut self, pyramid: &LobePyramid) {
        if !self.mip.as_ref().is_some_and(|mip| Arc::ptr_eq(&mip.map, &pyramid.map)) {
            return;
        }
        if pyramid.lobes() != self.slots {
            self.set_slot_count(pyramid.lobes());
        }
        for level in (self.lobe_level..pyramid.levels()).rev() {
            self.set_level(level, HeldLevel::of(pyramid, level));
        }
        let same = match (&self.slots_held, &pyramid.base) {
            (Some(held), Some(base)) => Arc::ptr_eq(held, base),
            (None, None) => true,
            _ => false,
        };
        if !same && self.left_out == 0 {
            self.slots_held.clone_from(&pyramid.base);
            self.uploads.push(&self.group.base_slots, 0, Source::Slots(pyramid.base.clone()));
        }
    }

    fn set_level(&mut self, level: usize, lobes: Option<HeldLevel>) {
        let held = self.lobes_held[level].take();
        match (&lobes, &held) {
            (None, None) => {}
            (None, Some(_)) => {
                self.lobes_complete[level] = false;
                self.uploads.forget(|source| source.is_lobes_of(level));
                self.lobes_revision += 1;
            }
            (Some(new), Some(held)) if new.is(held) => {}
            (Some(new), held) => {
                let same_lobes = held.as_ref().is_some_and(|held| new.has_lobes_of(held));
                self.upload_lobes(level, new, same_lobes);
            }
        }
        self.lobes_held[level] = lobes;
    }

    /// Colours follow their lobes, so that a level is complete with its colours.
    fn upload_lobes(&mut self, level: usize, new: &HeldLevel, only_colors: bool) {
        let target = (level - self.lobe_level) as u32;
        if !only_colors {
            let source = Source::Lobes { mixtures: new.mixtures.clone(), level };
            self.uploads.push(&self.group.lobes, target, source);
        }
        if self.is_colored() {
            let source = Source::LobeColors { mixtures: new.mixtures.clone(), colors: new.colors.clone(), level };
            self.uploads.push(&self.group.lobe_colors, target, source);
        }
    }

    /// Makes room for another number of slots and forgets what the old ones held.
    fn set_slot_count(&mut self, slots: usize) {
        let Some(mip) = &self.mip else { return };
        let (sizes, format) = (mip.map.level_sizes(), float_format(&self.device));
        let layers = padded_layers(slots);
        self.slots = slots;
        self.lobe_level = first_that_fits(&self.device, &sizes, 1.max(self.left_out), layers, LOBES_BYTES, format);
        let (w, h) = sizes.get(self.lobe_level).copied().unwrap_or((1, 1));
        let levels = sizes.len().saturating_sub(self.lobe_level).max(1);
        self.group.lobes = create(&self.device, "lobes", (w, h, layers), levels, format);
        let (color_size, color_levels) = if self.is_colored() { ((w, h, layers), levels) } else { ((1, 1, 2), 1) };
        self.group.lobe_colors = create(&self.device, "lobe colours", color_size, color_levels, COLOR_FORMAT);
        self.lobes_held = vec![None; sizes.len()];
        self.lobes_complete = vec![false; sizes.len()];
        self.lobes_revision += 1;
        self.uploads.forget(|source| (0..sizes.len()).any(|level| source.is_lobes_of(level)));
        self.bind_group = self.group.bind(&self.device, &self.layout, mip.map.options.addressing);
    }

    /// Uploads about `budget` bytes and returns how many are left.
    pub fn pump(&mut self, queue: &wgpu::Queue, budget: u64) -> u64 {
        let colored = self.is_colored();
        for complete in self.uploads.pump(queue, budget) {
            match complete {
                // Complete with the colours, which follow.
                Source::Means { .. } | Source::Lobes { .. } if colored => {}
                Source::Means { level, .. } | Source::MeanColors { level, .. } => {
                    self.means_complete[level] = true;
                    self.means_revision += 1;
                }
                Source::Slots(_) => self.lobes_revision += 1,
                // Rivals have queues of their own.
                Source::Channels { .. } => {}
                Source::Lobes { level, .. } | Source::LobeColors { level, .. } => {
                    self.lobes_complete[level] = true;
                    self.lobes_revision += 1;
                }
            }
        }
        self.pending_bytes()
    }

    /// True when the finest level of mean normals is there: what the truth samples.
    pub fn base_is_complete(&self) -> bool {
        self.means_complete.get(self.left_out).copied().unwrap_or(false)
    }

    /// Finest and coarsest level whose mean normals are there.
    pub fn mip_lods(&self) -> Option<[f32; 2]> {
        complete_run(&self.means_complete, self.left_out)
    }

    /// Finest and coarsest level whose lobes are there; the base counts with level 1.
    pub fn vmf_lods(&self) -> Option<[f32; 2]> {
        if self.means_complete.len() == 1 {
            return self.base_is_complete().then_some([0.0, 0.0]);
        }
        let [first, last] = complete_run(&self.lobes_complete, self.lobe_level)?;
        let base_too = first == 1.0 && self.left_out == 0 && self.base_is_complete();
        Some([if base_too { 0.0 } else { first }, last])
    }
}

/// The run of complete levels that ends at the coarsest complete one, not finer than `finest`, as
/// `LobePyramid::shown_levels` has it.
pub fn complete_run(complete: &[bool], finest: usize) -> Option<[f32; 2]> {
    let last = complete.iter().rposition(|&level| level)?;
    let first = (finest..=last).rev().take_while(|&level| complete[level]).last()?;
    Some([first as f32, last as f32])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_levels_shown_are_the_run_up_to_the_coarsest_complete_one() {
        assert_eq!(complete_run(&[true, false, true, true], 0), Some([2.0, 3.0]));
        assert_eq!(complete_run(&[true, true], 0), Some([0.0, 1.0]));
        assert_eq!(complete_run(&[true, true], 1), Some([1.0, 1.0]));
        assert_eq!(complete_run(&[false, true, false], 1), Some([1.0, 1.0]));
        assert_eq!(complete_run(&[false, false], 0), None);
    }
}
