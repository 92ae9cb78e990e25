//! What Rust and WGSL share: shader modules put together from their parts, and the plain resources passes need.

use std::borrow::Cow;

/// sRGB encoding, the twin of `color.rs`.
pub const SRGB: &str = include_str!("../../shaders/shared/srgb.wgsl");
/// Where on a colour map a value lies, the twin of `color.rs`.
pub const COLOR_SCALE: &str = include_str!("../../shaders/shared/color_scale.wgsl");
/// The von Mises-Fisher lobe, the twin of `sphere/vmf.rs`.
pub const VMF: &str = include_str!("../../shaders/shared/vmf.wgsl");
/// Blinn-Phong, the twin of `brdf/blinn_phong.rs`.
pub const BLINN_PHONG: &str = include_str!("../../shaders/shared/blinn_phong.wgsl");
/// The Torrance-Sparrow form, the twin of `brdf/torrance_sparrow.rs`.
pub const TORRANCE_SPARROW: &str = include_str!("../../shaders/shared/torrance_sparrow.wgsl");
/// GGX, the twin of `brdf/ggx.rs`.
pub const GGX: &str = include_str!("../../shaders/shared/ggx.wgsl");
/// Measured reflectance, the twin of `brdf/measured.rs` and `brdf/factors.rs`.
pub const MEASURED: &str = include_str!("../../shaders/shared/measured.wgsl");
/// The rules of convolution, the twin of `brdf/convolution.rs`.
pub const CONVOLUTION: &str = include_str!("../../shaders/shared/convolution.wgsl");
/// The material, the twin of `brdf/material.rs`.
pub const MATERIAL: &str = include_str!("../../shaders/shared/material.wgsl");
/// The exact convolution from a table, the twin of `brdf/exact_table.rs`.
pub const EXACT_TABLE: &str = include_str!("../../shaders/shared/exact_table.wgsl");
/// Lookup and reflection, the twin of `filter/mod.rs`.
pub const FILTER: &str = include_str!("../../shaders/shared/filter.wgsl");
/// The choice of level and of probes, the twin of `filter/probes.rs`.
pub const PROBES: &str = include_str!("../../shaders/shared/probes.wgsl");
/// Interpolation by hand, the twin of `filter/sampling.rs`.
pub const SAMPLING: &str = include_str!("../../shaders/shared/sampling.wgsl");
/// The truth's jitter, the twin of `filter/truth.rs`.
pub const TRUTH: &str = include_str!("../../shaders/shared/truth.wgsl");

/// The frame at a pixel, the twin of `scene/reconstruction.rs`.
pub const RECONSTRUCTION: &str = include_str!("../../shaders/shared/reconstruction.wgsl");

/// The bump-mapped surface, the twin of `scene/bump.rs`.
pub const BUMP: &str = include_str!("../../shaders/shared/bump.wgsl");

/// A direction in a picture by latitude and longitude, the twin of `lighting/environment.rs`.
pub const LAT_LONG: &str = include_str!("../../shaders/shared/lat_long.wgsl");
/// What lobes and samples reflect of the sky, the twin of `filter/sky_light.rs`.
pub const SKY: &str = include_str!("../../shaders/shared/sky.wgsl");

/// The entry points of lobes, aligned and unaligned, the twin of `filter/vmf/mod.rs`.
pub const LOBES: &str = include_str!("../../shaders/shared/lobes.wgsl");

/// The entry point of every rival, the twin of `filter/rival.rs` and `filter/channels.rs`.
pub const RIVAL: &str = include_str!("../../shaders/shared/rival.wgsl");

/// A two-dimensional texture of one level.
pub fn texture_2d(
    device: &wgpu::Device,
    label: &str,
    [width, height]: [u32; 2],
    format: wgpu::TextureFormat,
    usage: wgpu::TextureUsages,
) -> wgpu::Texture {
    device.create_texture(&wgpu::TextureDescriptor {
        label: Some(label),
        size: wgpu::Extent3d { width, height, depth_or_array_layers: 1 },
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format,
        usage,
        view_formats: &[],
    })
}

/// A shader module of `parts`, one after the other.
pub fn shader(device: &wgpu::Device, label: &str, parts: &[&str]) -> wgpu::ShaderModule {
    device.create_shader_module(wgpu::ShaderModuleDescriptor {
        label: Some(label),
        source: wgpu::ShaderSource::Wgsl(Cow::Owned(parts.concat())),
    })
}

/// A uniform buffer for a `T`.
pub fn uniform_buffer<T: bytemuck::Pod>(device: &wgpu::Device, label: &str) -> wgpu::Buffer {
    device.create_buffer(&wgpu::BufferDescriptor {
        label: Some(label),
        size: size_of::<T>() as u64,
        usage: wgpu::BufferUsages::UNIFORM | wgpu::BufferUsages::COPY_DST,
        mapped_at_creation: false,
    })
}

/// A bind group layout whose bindings are numbered in order.
pub fn bind_group_layout(
    device: &wgpu::Device,
    label: &str,
    visibility: wgpu::ShaderStages,
    types: &[wgpu::BindingType],
) -> wgpu::BindGroupLayout {
    let entry = |(binding, &ty): (usize, &wgpu::BindingType)| wgpu::BindGroupLayoutEntry {
        binding: binding as u32,
        visibility,
        ty,
        count: None,
    };
    let entries: Vec<_> = types.iter().enumerate().map(entry).collect();
    device.create_bind_group_layout(&wgpu::BindGroupLayoutDescriptor { label: Some(label), entries: &entries })
}

/// A bind group whose bindings are numbered in order.
pub fn bind_group(
    device: &wgpu::Device,
    label: &str,
    layout: &wgpu::BindGroupLayout,
    resources: &[wgpu::BindingResource<'_>],
) -> wgpu::BindGroup {
    let numbered = resources.iter().zip(0..);
    let entries: Vec<_> =
        numbered.map(|(resource, binding)| wgpu::BindGroupEntry { binding, resource: resource.clone() }).collect();
    device.create_bind_group(&wgpu::BindGroupDescriptor { label: Some(label), layout, entries: &entries })
}

/// A uniform buffer's binding.
pub const UNIFORM: wgpu::BindingType = wgpu::BindingType::Buffer {
    ty: wgpu::BufferBindingType::Uniform,
    has_dynamic_offset: false,
    min_binding_size: None,
};

/// A texture's binding.
pub const fn texture(
    sample_type: wgpu::TextureSampleType,
    view_dimension: wgpu::TextureViewDimension,
) -> wgpu::BindingType {
    wgpu::BindingType::Texture { sample_type, view_dimension, multisampled: false }
}
