//! Group 3 of the surface pass: the sky's picture, its samples and its harmonics as textures, and how it lights.

use std::sync::Arc;

use super::layout::{self, bind_group, bind_group_layout, texture, uniform_buffer};
use super::map_group::{create, float_format};
use crate::brdf::Material;
use crate::filter::sky_light;
use crate::lighting::sky_harmonics::{DIFFUSE_BAND, MOST_BANDS, VIEWS, Views};
use crate::lighting::{Environment, Sky};

/// Samples to a row of their texture.
const SAMPLE_COLUMNS: usize = 128;

/// How the sky lights; `Sky` in the shader.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct SkyData {
    /// Cosine and sine of the sky's rotation.
    pub turn: [f32; 2],
    /// Factor on its radiance.
    pub intensity: f32,
    /// The last band of the specular light in use.
    pub last_band: u32,
    /// What a band of the specular light becomes, linear RGB.
    pub specular_bands: [[f32; 4]; MOST_BANDS + 1],
    /// What a band of the diffuse light becomes, linear RGB.
    pub diffuse_bands: [[f32; 4]; DIFFUSE_BAND + 1],
}

impl SkyData {
    /// The sky over a material.
    pub fn new(sky: &Sky, material: &Material) -> Self {
        let (sin, cos) = sky.rotation_deg.to_radians().sin_cos();
        let [diffuse, specular] = sky_light::bands(sky, material);
        Self {
            turn: [cos, sin],
            intensity: sky.intensity,
            last_band: sky.last_band() as u32,
            specular_bands: std::array::from_fn(|l| specular[l].as_vec3().extend(0.0).to_array()),
            diffuse_bands: std::array::from_fn(|l| diffuse[l].as_vec3().extend(0.0).to_array()),
        }
    }
}

/// The textures of one sky.
#[derive(Debug)]
pub struct SkyTextures {
    device: wgpu::Device,
    layout: wgpu::BindGroupLayout,
    constants: wgpu::Buffer,
    /// Linear RGB by latitude and longitude; the density of the samples.
    texels: wgpu::Texture,
    bind_group: wgpu::BindGroup,
    held: Option<(Arc<Environment>, bool)>,
}

impl SkyTextures {
    /// Textures of no sky.
    pub fn new(device: &wgpu::Device) -> Self {
        use wgpu::TextureViewDimension::{D2, D2Array};
        let read = wgpu::TextureSampleType::Float { filterable: false };
        let filtered = wgpu::TextureSampleType::Float { filterable: true };
        let types = [
            texture(read, D2),
            texture(read, D2),
            texture(read, D2),
            texture(filtered, D2Array),
            wgpu::BindingType::Sampler(wgpu::SamplerBindingType::Filtering),
            layout::UNIFORM,
        ];
        let layout = bind_group_layout(device, "sky", wgpu::ShaderStages::FRAGMENT, &types);
        let constants = uniform_buffer::<SkyData>(device, "sky");
        let one = || create(device, "sky", (1, 1, 1), 1, TEXELS);
        let views = create(device, "sky views", (1, 1, 2), 1, float_format(device));
        let texels = one();
        let bind_group = bind(device, &layout, [&texels, &one(), &one()], &views, &constants);
        Self { device: device.clone(), layout, constants, texels, bind_group, held: None }
    }

    /// The group's layout.
    pub fn layout(&self) -> &wgpu::BindGroupLayout {
        &self.layout
    }

    /// The group itself.
    pub fn bind_group(&self) -> &wgpu::BindGroup {
        &self.bind_group
    }

    /// The sky's picture.
    pub fn texels(&self) -> &wgpu::Texture {
        &self.texels
    }

    /// Takes up the sky, if there is one; true where it is another than before.
    pub fn prepare(&mut self, queue: &wgpu::Queue, sky: &Sky, material: &Material) -> bool {
        let Some(environment) = &sky.environment else { return false };
        queue.write_buffer(&self.constants, 0, bytemuck::bytes_of(&SkyData::new(sky, material)));
        let is_held = |(held, is_sun_apart): &(Arc<Environment>, bool)| {
            Arc::ptr_eq(held, environment) && *is_sun_apart == sky.is_sun_apart
        };
        let same = self.held.as_ref().is_some_and(is_held);
        if !same {
            self.upload(queue, environment, sky.views(environment));
            self.held = Some((Arc::clone(environment), sky.is_sun_apart));
        }
        !same
    }

    fn upload(&mut self, queue: &wgpu::Queue, sky: &Environment, specular: &Views) {
        let device = &self.device;
        let texels = sky.radiance.iter().zip(&sky.density).map(|(color, &density)| color.extend(density).to_array());
        let samples = sky.samples.iter().map(|direction| direction.extend(0.0).to_array());
        let diffuse = sky.harmonics.diffuse.iter().map(|light| light.extend(0.0).to_array());
        self.texels = made(device, queue, "sky", sky.width, texels);
        let samples = made(device, queue, "sky samples", SAMPLE_COLUMNS, samples);
        let diffuse = made(device, queue, "diffuse sky", sky.harmonics.diffuse.len(), diffuse);
        let views = views(device, queue, specular);
        self.bind_group = bind(device, &self.layout, [&self.texels, &samples, &diffuse], &views, &self.constants);
    }
}

/// The format of what is read texel by texel.
const TEXELS: wgpu::TextureFormat = wgpu::TextureFormat::Rgba32Float;

/// A texture of these texels, `width` to a row.
fn made(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    label: &str,
    width: usize,
    texels: impl Iterator<Item = [f32; 4]>,
) -> wgpu::Texture {
    let texels: Vec<[f32; 4]> = texels.collect();
    let texture = create(device, label, (width, texels.len() / width, 1), 1, TEXELS);
    write(queue, &texture, bytemuck::cast_slice(&texels), size_of::<[f32; 4]>());
    texture
}

/// The table of views, a harmonic to a layer.
fn views(device: &wgpu::Device, queue: &wgpu::Queue, Views(views): &Views) -> wgpu::Texture {
    let layers = views.len() / (VIEWS * VIEWS);
    let format = float_format(device);
    let texture = create(device, "sky views", (VIEWS, VIEWS, layers), 1, format);
    let texel = |index: usize| {
        let (layer, view) = (index / (VIEWS * VIEWS), index % (VIEWS * VIEWS));
        views[view * layers + layer].extend(0.0).to_array()
    };
    let texels: Vec<[f32; 4]> = (0..layers * VIEWS * VIEWS).map(texel).collect();
    if format == TEXELS {
        write(queue, &texture, bytemuck::cast_slice(&texels), size_of::<[f32; 4]>());
    } else {
        let halves: Vec<half::f16> = texels.iter().flatten().map(|&value| half::f16::from_f32(value)).collect();
        write(queue, &texture, bytemuck::cast_slice(&halves), size_of::<[half::f16; 4]>());
    }
    texture
}

/// Writes a whole texture of texels so large.
fn write(queue: &wgpu::Queue, texture: &wgpu::Texture, bytes: &[u8], texel: usize) {
    let layout = wgpu::TexelCopyBufferLayout {
        offset: 0,
        bytes_per_row: Some(texture.width() * texel as u32),
        rows_per_image: Some(texture.height()),
    };
    queue.write_texture(texture.as_image_copy(), bytes, layout, texture.size());
}

fn bind(
    device: &wgpu::Device,
    layout: &wgpu::BindGroupLayout,
    textures: [&wgpu::Texture; 3],
    views: &wgpu::Texture,
    constants: &wgpu::Buffer,
) -> wgpu::BindGroup {
    let view = |texture: &wgpu::Texture, dimension| {
        texture.create_view(&wgpu::TextureViewDescriptor {
            label: Some("sky"),
            dimension: Some(dimension),
            ..Default::default()
        })
    };
    let [texels, samples, diffuse] = textures.map(|texture| view(texture, wgpu::TextureViewDimension::D2));
    let views = view(views, wgpu::TextureViewDimension::D2Array);
    // Azimuths go round, polar angles end at the poles.
    let sampler = device.create_sampler(&wgpu::SamplerDescriptor {
        label: Some("sky views"),
        address_mode_u: wgpu::AddressMode::Repeat,
        address_mode_v: wgpu::AddressMode::ClampToEdge,
        mag_filter: wgpu::FilterMode::Linear,
        min_filter: wgpu::FilterMode::Linear,
        ..Default::default()
    });
    let resources = [
        wgpu::BindingResource::TextureView(&texels),
        wgpu::BindingResource::TextureView(&samples),
        wgpu::BindingResource::TextureView(&diffuse),
        wgpu::BindingResource::TextureView(&views),
        wgpu::BindingResource::Sampler(&sampler),
        constants.as_entire_binding(),
    ];
    bind_group(device, "sky", layout, &resources)
}
