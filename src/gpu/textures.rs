//! The map and its lobes as textures, brought up to date a slice a frame.
//!
//! - `means`: mean normals of every level, MIP level by MIP level.
//! - `base_slots`: the slot of each base texel's only lobe, 8 bits.
//! - `lobes`: one array texture, a layer per slot, whose first MIP level is the map's level 1: the base level as
//!   lobes would be empty but for one slot a texel, so the shader blends the base normals in by hand.
//!
//! Levels too large for the adapter or for the memory set aside are left out, the finest first.

use std::sync::Arc;

use super::layout::{bind_group, bind_group_layout, texture};
use super::upload::{Source, UploadQueue};
use crate::filter::PlainMip;
use crate::filter::vmf::{BaseSlots, LobePyramid, MixtureLevel};
use crate::normal_map::Addressing;

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
    means: wgpu::Texture,
    base_slots: wgpu::Texture,
    lobes: wgpu::Texture,
    uploads: UploadQueue,
    mip: Option<Arc<PlainMip>>,
    slots_held: Option<Arc<BaseSlots>>,
    lobes_held: Vec<Option<Arc<MixtureLevel>>>,
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

impl MapTextures {
    /// Textures of no map.
    pub fn new(device: &wgpu::Device) -> Self {
        let means = create(device, "mean normals", (1, 1, 1), 1, float_format(device));
        let base_slots = create(device, "base slots", (1, 1, 1), 1, wgpu::TextureFormat::R8Uint);
        let lobes = create(device, "lobes", (1, 1, 2), 1, float_format(device));
        let layout = map_layout(device);
        let bind_group = bind(device, &layout, [&means, &base_slots, &lobes], Addressing::Wrap);
        Self {
            device: device.clone(),
            layout,
            bind_group,
            means,
            base_slots,
            lobes,
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

    /// Group 1: means, base slots, lobes, sampler.
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
        self.left_out = first_that_fits(&self.device, &sizes, 0, 1, MEANS_BYTES, format);
        let (w, h) = sizes[self.left_out];
        self.means = create(&self.device, "mean normals", (w, h, 1), sizes.len() - self.left_out, format);
        let slots_size = if self.left_out == 0 { (w, h, 1) } else { (1, 1, 1) };
        self.base_slots = create(&self.device, "base slots", slots_size, 1, wgpu::TextureFormat::R8Uint);
        self.uploads = UploadQueue::default();
        for level in (self.left_out..sizes.len()).rev() {
            let source = Source::Means { mip: mip.clone(), level };
            self.uploads.push(&self.means, (level - self.left_out) as u32, source);
        }
        self.mip = Some(mip.clone());
        self.slots_held = None;
        self.means_complete = vec![false; sizes.len()];
        self.map_revision += 1;
        self.means_revision += 1;
        self.set_slot_count(0);
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
            self.set_level(level, pyramid.coarse[level - 1].as_ref());
        }
        let same = match (&self.slots_held, &pyramid.base) {
            (Some(held), Some(base)) => Arc::ptr_eq(held, base),
            (None, None) => true,
            _ => false,
        };
        if !same && self.left_out == 0 {
            self.slots_held.clone_from(&pyramid.base);
            self.uploads.push(&self.base_slots, 0, Source::Slots(pyramid.base.clone()));
        }
    }

    fn set_level(&mut self, level: usize, mixtures: Option<&Arc<MixtureLevel>>) {
        match (mixtures, &self.lobes_held[level]) {
            (None, None) => {}
            (None, Some(_)) => {
                self.lobes_held[level] = None;
                self.lobes_complete[level] = false;
                self.uploads.forget(|source| matches!(source, Source::Lobes { level: l, .. } if *l == level));
                self.lobes_revision += 1;
            }
            (Some(new), Some(held)) if Arc::ptr_eq(new, held) => {}
            (Some(new), _) => {
                self.lobes_held[level] = Some(new.clone());
                let source = Source::Lobes { mixtures: new.clone(), level };
                self.uploads.push(&self.lobes, (level - self.lobe_level) as u32, source);
            }
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
        self.lobes = create(&self.device, "lobes", (w, h, layers), levels, format);
        self.lobes_held = vec![None; sizes.len()];
        self.lobes_complete = vec![false; sizes.len()];
        self.lobes_revision += 1;
        self.uploads.forget(|source| matches!(source, Source::Lobes { .. }));
        let textures = [&self.means, &self.base_slots, &self.lobes];
        self.bind_group = bind(&self.device, &self.layout, textures, mip.map.options.addressing);
    }

    /// Uploads about `budget` bytes and returns how many are left.
    pub fn pump(&mut self, queue: &wgpu::Queue, budget: u64) -> u64 {
        for complete in self.uploads.pump(queue, budget) {
            match complete {
                Source::Means { level, .. } => {
                    self.means_complete[level] = true;
                    self.means_revision += 1;
                }
                Source::Slots(_) => self.lobes_revision += 1,
                Source::Lobes { level, .. } => {
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
fn complete_run(complete: &[bool], finest: usize) -> Option<[f32; 2]> {
    let last = complete.iter().rposition(|&level| level)?;
    let first = (finest..=last).rev().take_while(|&level| complete[level]).last()?;
    Some([first as f32, last as f32])
}

/// Layers for `slots`: at least 2 and never a multiple of 6, because GL takes such an array for a cube map.
fn padded_layers(slots: usize) -> usize {
    let layers = slots.max(2);
    if layers.is_multiple_of(6) { layers + 1 } else { layers }
}

/// The first level from `finest` on that the adapter's textures and `bytes` of memory can hold with all coarser ones.
fn first_that_fits(
    device: &wgpu::Device,
    sizes: &[(usize, usize)],
    finest: usize,
    layers: usize,
    bytes: u64,
    format: wgpu::TextureFormat,
) -> usize {
    let limit = device.limits().max_texture_dimension_2d as usize;
    let texel = u64::from(format.block_copy_size(None).unwrap_or(16)) * layers as u64;
    let needed = |from: usize| sizes[from..].iter().map(|(w, h)| (w * h) as u64 * texel).sum::<u64>();
    let fits = |level: &usize| sizes[*level].0.max(sizes[*level].1) <= limit && needed(*level) <= bytes;
    (finest..sizes.len()).find(fits).unwrap_or(finest)
}

/// 32-bit floats where they can be filtered, else 16-bit ones.
fn float_format(device: &wgpu::Device) -> wgpu::TextureFormat {
    if device.features().contains(wgpu::Features::FLOAT32_FILTERABLE) {
        wgpu::TextureFormat::Rgba32Float
    } else {
        wgpu::TextureFormat::Rgba16Float
    }
}

fn create(
    device: &wgpu::Device,
    label: &str,
    (width, height, layers): (usize, usize, usize),
    levels: usize,
    format: wgpu::TextureFormat,
) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width: width as u32, height: height as u32, depth_or_array_layers: layers as u32 },
        mip_level_count: levels as u32,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
        view_formats: &[],
    })
}

fn map_layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
    use wgpu::{TextureSampleType as Sample, TextureViewDimension as View};
    let float = Sample::Float { filterable: true };
    let types = [
        texture(float, View::D2),
        texture(Sample::Uint, View::D2),
        texture(float, View::D2Array),
        wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
    ];
    bind_group_layout(device, "map", wgpu::ShaderStages::FRAGMENT, &types)
}

fn bind(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    [means, base_slots, lobes]: [&wgpu::Texture; 3],
    addressing: Addressing,
) -> wgpu::BindGroup {
    let view = |label, texture: &wgpu::Texture, dimension| {
        let descriptor =
            wgpu::TextureViewDescriptor { label: Some(label), dimension: Some(dimension), ..Default::default() };
        texture.create_view(&descriptor)
    };
    let flat = wgpu::TextureViewDimension::D2;
    let resources = [
        wgpu::BindingResource::TextureView(&view("mean normals", means, flat)),
        wgpu::BindingResource::TextureView(&view("base slots", base_slots, flat)),
        wgpu::BindingResource::TextureView(&view("lobes", lobes, wgpu::TextureViewDimension::D2Array)),
        wgpu::BindingResource::Sampler(&sampler(device, addressing)),
    ];
    bind_group(device, "map", layout, &resources)
}

fn sampler(device: &wgpu::Device, addressing: Addressing) -> wgpu::Sampler {
    let mode = match addressing {
        Addressing::Wrap => wgpu::AddressMode::Repeat,
        Addressing::Clamp => wgpu::AddressMode::ClampToEdge,
    };
    device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("trilinear"),
        address_mode_u: mode,
        address_mode_v: mode,
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        mipmap_filter: wgpu::MipmapFilterMode::Linear,
        ..Default::default()
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_array_never_has_the_layers_of_a_cube() {
        for slots in 0..=16 {
            let layers = padded_layers(slots);
            assert!(layers >= slots.max(2) && !layers.is_multiple_of(6), "{slots}: {layers}");
        }
    }

    #[test]
    fn the_levels_shown_are_the_run_up_to_the_coarsest_complete_one() {
        assert_eq!(complete_run(&[true, false, true, true], 0), Some([2.0, 3.0]));
        assert_eq!(complete_run(&[true, true], 0), Some([0.0, 1.0]));
        assert_eq!(complete_run(&[true, true], 1), Some([1.0, 1.0]));
        assert_eq!(complete_run(&[false, true, false], 1), Some([1.0, 1.0]));
        assert_eq!(complete_run(&[false, false], 0), None);
    }
}
