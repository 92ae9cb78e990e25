//! Group 2 of a rival's picture: its channels as a texture, a layer per four, brought up to date a slice a frame; and
//! which levels are there.

use std::sync::Arc;

use super::layout::{self, bind_group, bind_group_layout, texture, uniform_buffer};
use super::map_group::{create, first_that_fits, float_format, padded_layers};
use super::textures::{MapTextures, complete_run};
use super::upload::{Source, UploadQueue};
use crate::filter::channels::ChannelPyramid;

/// Memory set aside for one rival's channels: 4096 x 4096 at two layers, 1024 x 1024 of 169 harmonics.
const CHANNELS_BYTES: u64 = 1 << 30;

/// The method's constants; `Rival` in the shader.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct RivalData {
    /// Levels that may be read.
    pub lods: [f32; 2],
    /// The map's level that the channels begin with.
    pub first_level: f32,
    /// The number that the method's name carries.
    pub parameter: u32,
}

/// The channels of one rival, and what of them is complete.
#[derive(Debug)]
pub struct RivalTextures {
    device: wgpu::Device,
    layout: wgpu::BindGroupLayout,
    bind_group: wgpu::BindGroup,
    constants: wgpu::Buffer,
    channels: wgpu::Texture,
    uploads: UploadQueue,
    held: Option<Arc<ChannelPyramid>>,
    complete: Vec<bool>,
    first_level: usize,
    /// Counts changes of the channels.
    pub revision: u64,
}

impl RivalTextures {
    /// The group's layout.
    pub fn layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
        let float = wgpu::TextureSampleType::Float { filterable: true };
        let types = [layout::UNIFORM, texture(float, wgpu::TextureViewDimension::D2Array)];
        bind_group_layout(device, "rival", wgpu::ShaderStages::FRAGMENT, &types)
    }

    /// No channels yet.
    pub fn new(device: &wgpu::Device, layout: &wgpu::BindGroupLayout) -> Self {
        let channels = create(device, "channels", (1, 1, 2), 1, float_format(device));
        let constants = uniform_buffer::<RivalData>(device, "rival");
        Self {
            device: device.clone(),
            layout: layout.clone(),
            bind_group: bind(device, layout, &constants, &channels),
            constants,
            channels,
            uploads: UploadQueue::default(),
            held: None,
            complete: Vec::new(),
            first_level: 0,
            revision: 0,
        }
    }

    /// Group 2: the method's constants and its channels.
    pub fn bind_group(&self) -> &wgpu::BindGroup {
        &self.bind_group
    }

    /// Bytes not uploaded yet.
    pub fn pending_bytes(&self) -> u64 {
        self.uploads.pending_bytes()
    }

    /// Takes up other channels, the coarsest level first; nothing happens when they are those that are held.
    pub fn set_channels(&mut self, channels: Option<&Arc<ChannelPyramid>>) {
        let same = match (&self.held, channels) {
            (Some(held), Some(new)) => Arc::ptr_eq(held, new),
            (None, None) => true,
            _ => false,
        };
        if same {
            return;
        }
        self.held = channels.cloned();
        self.uploads = UploadQueue::default();
        self.complete.clear();
        self.revision += 1;
        if let Some(channels) = channels {
            self.make_room(channels);
        }
    }

    fn make_room(&mut self, channels: &Arc<ChannelPyramid>) {
        let (sizes, format) = (channels.level_sizes(), float_format(&self.device));
        let layers = padded_layers(channels.layers);
        self.first_level = first_that_fits(&self.device, &sizes, channels.first_level, layers, CHANNELS_BYTES, format);
        self.complete = vec![false; sizes.len()];
        let (width, height) = sizes[self.first_level];
        let levels = sizes.len() - self.first_level;
        self.channels = create(&self.device, "channels", (width, height, layers), levels, format);
        self.bind_group = bind(&self.device, &self.layout, &self.constants, &self.channels);
        for level in (self.first_level..sizes.len()).rev() {
            let source = Source::Channels { channels: Arc::clone(channels), level };
            self.uploads.push(&self.channels, (level - self.first_level) as u32, source);
        }
    }

    /// Uploads about `budget` bytes.
    pub fn pump(&mut self, queue: &wgpu::Queue, budget: u64) {
        for complete in self.uploads.pump(queue, budget) {
            if let Source::Channels { level, .. } = complete {
                self.complete[level] = true;
                self.revision += 1;
            }
        }
    }

    /// Finest and coarsest level at hand, in the map and in the channels; base texels count with level 1 where the
    /// channels leave them to the mean normals.
    pub fn lods(&self, map: &MapTextures, has_channels: bool) -> Option<[f32; 2]> {
        let [finest_mean, coarsest_mean] = map.mip_lods()?;
        if !has_channels {
            return Some([finest_mean, coarsest_mean]);
        }
        let held = self.held.as_ref()?;
        let [first, last] = complete_run(&self.complete, self.first_level)?;
        let by_hand = held.base_by_hand && first <= 1.0 && map.left_out == 0 && map.base_is_complete();
        let lods = [finest_mean.max(if by_hand { 0.0 } else { first }), coarsest_mean.min(last)];
        (lods[0] <= lods[1]).then_some(lods)
    }

    /// Writes the constants.
    pub fn prepare(&self, queue: &wgpu::Queue, lods: [f32; 2], parameter: u8) {
        let data = RivalData { lods, first_level: self.first_level as f32, parameter: parameter.into() };
        queue.write_buffer(&self.constants, 0, bytemuck::bytes_of(&data));
    }
}

fn bind(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    constants: &wgpu::Buffer,
    channels: &wgpu::Texture,
) -> wgpu::BindGroup {
    let view = channels.create_view(&wgpu::TextureViewDescriptor {
        label: Some("channels"),
        dimension: Some(wgpu::TextureViewDimension::D2Array),
        ..Default::default()
    });
    let resources = [constants.as_entire_binding(), wgpu::BindingResource::TextureView(&view)];
    bind_group(device, "rival", layout, &resources)
}
