//! The factors of a measured reflectance as a texture: f by bin of theta_h in the first row, scale times g by bin of
//! theta_d in the second.

use crate::brdf::merl::THETA_H;
use crate::brdf::{Brdf, Material, Measured};

/// The texture, and of what it is; `None` while nothing has asked for it.
#[derive(Debug)]
pub struct MeasuredTable {
    texture: wgpu::Texture,
    held: Option<Measured>,
}

impl MeasuredTable {
    /// A table of nothing yet.
    pub fn new(device: &wgpu::Device) -> Self {
        let usage = wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST;
        let (size, format) = ([THETA_H as u32, 2], wgpu::TextureFormat::Rgba32Float);
        Self { texture: super::layout::texture_2d(device, "measured factors", size, format, usage), held: None }
    }

    /// The type of the binding: read texel by texel, for not every adapter filters 32-bit floats.
    pub const BINDING: wgpu::BindingType =
        super::layout::texture(wgpu::TextureSampleType::Float { filterable: false }, wgpu::TextureViewDimension::D2);

    /// A view of the table.
    pub fn view(&self) -> wgpu::TextureView {
        let label = Some("measured factors");
        self.texture.create_view(&wgpu::TextureViewDescriptor { label, ..Default::default() })
    }

    /// Uploads what the material asks for and is not there.
    pub fn prepare(&mut self, queue: &wgpu::Queue, material: &Material) {
        let Brdf::Measured(measured) = material.brdf() else { return };
        if self.held == Some(measured) {
            return;
        }
        self.held = Some(measured);
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some((THETA_H * size_of::<[f32; 4]>()) as u32),
            rows_per_image: None,
        };
        let texels = texels(measured);
        queue.write_texture(self.texture.as_image_copy(), bytemuck::cast_slice(&texels), layout, self.texture.size());
    }
}

fn texels(measured: Measured) -> Vec<[f32; 4]> {
    let of = measured.measurement();
    let f = (0..THETA_H).map(|h| [of.f[0][h], of.f[1][h], of.f[2][h], 0.0]);
    let g = (0..THETA_H).map(|d| [0, 1, 2].map(|c: usize| of.scale[c] * of.g[c][d])).map(|[r, g, b]| [r, g, b, 0.0]);
    f.chain(g).map(|texel| texel.map(|value: f64| value as f32)).collect()
}
