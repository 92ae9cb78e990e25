//! Group 1 of the surface pass: a map's textures, how they are made, bound and sampled, and what of a map fits.

use super::layout::{bind_group, bind_group_layout, texture};
use crate::normal_map::Addressing;

/// The format of colours: 16-bit floats, which every adapter filters; a colour may exceed 1.
pub const COLOR_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba16Float;

/// The textures of one map, in the order of their bindings; the sampler follows.
#[derive(Debug)]
pub struct MapGroup {
    /// Mean normals of every level.
    pub means: wgpu::Texture,
    /// The slot of each base texel's only lobe.
    pub base_slots: wgpu::Texture,
    /// Stored lobes, a layer per slot.
    pub lobes: wgpu::Texture,
    /// Mean colours of every level; one texel for a map without colour.
    pub mean_colors: wgpu::Texture,
    /// Stored colours of the lobes, a layer per slot; one texel for a map without colour.
    pub lobe_colors: wgpu::Texture,
}

impl MapGroup {
    /// Textures of no map, one texel each.
    pub fn empty(device: &wgpu::Device) -> Self {
        let one = |label, layers, format| create(device, label, (1, 1, layers), 1, format);
        Self {
            means: one("mean normals", 1, float_format(device)),
            base_slots: one("base slots", 1, wgpu::TextureFormat::R8Uint),
            lobes: one("lobes", 2, float_format(device)),
            mean_colors: one("mean colours", 1, COLOR_FORMAT),
            lobe_colors: one("lobe colours", 2, COLOR_FORMAT),
        }
    }

    /// The group's layout.
    pub fn layout(device: &wgpu::Device) -> wgpu::BindGroupLayout {
        use wgpu::{TextureSampleType as Sample, TextureViewDimension as View};
        let float = Sample::Float { filterable: true };
        let types = [
            texture(float, View::D2),
            texture(Sample::Uint, View::D2),
            texture(float, View::D2Array),
            texture(float, View::D2),
            texture(float, View::D2Array),
            wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
        ];
        bind_group_layout(device, "map", wgpu::ShaderStages::FRAGMENT, &types)
    }

    /// The group itself.
    pub fn bind(
        &self,
        device: &wgpu::Device,
        layout: &wgpu::BindGroupLayout,
        addressing: Addressing,
    ) -> wgpu::BindGroup {
        let view = |label, texture: &wgpu::Texture, dimension| {
            let descriptor =
                wgpu::TextureViewDescriptor { label: Some(label), dimension: Some(dimension), ..Default::default() };
            texture.create_view(&descriptor)
        };
        use wgpu::TextureViewDimension::{D2, D2Array};
        let resources = [
            wgpu::BindingResource::TextureView(&view("mean normals", &self.means, D2)),
            wgpu::BindingResource::TextureView(&view("base slots", &self.base_slots, D2)),
            wgpu::BindingResource::TextureView(&view("lobes", &self.lobes, D2Array)),
            wgpu::BindingResource::TextureView(&view("mean colours", &self.mean_colors, D2)),
            wgpu::BindingResource::TextureView(&view("lobe colours", &self.lobe_colors, D2Array)),
            wgpu::BindingResource::Sampler(&sampler(device, addressing)),
        ];
        bind_group(device, "map", layout, &resources)
    }
}

/// Layers for `slots`: at least 2 and never a multiple of 6, because GL takes such an array for a cube map.
pub fn padded_layers(slots: usize) -> usize {
    let layers = slots.max(2);
    if layers.is_multiple_of(6) { layers + 1 } else { layers }
}

/// The first level from `finest` on that the adapter's textures and `bytes` of memory can hold with all coarser ones.
pub fn first_that_fits(
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
pub fn float_format(device: &wgpu::Device) -> wgpu::TextureFormat {
    if device.features().contains(wgpu::Features::FLOAT32_FILTERABLE) {
        wgpu::TextureFormat::Rgba32Float
    } else {
        wgpu::TextureFormat::Rgba16Float
    }
}

/// An empty texture of `levels` MIP levels that is uploaded to and sampled.
pub fn create(
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
}
