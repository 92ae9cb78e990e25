//! Exact convolutions as a texture of four layers: the material's model, by channel where it is measured, and the
//! clamped cosine.

use crate::brdf::exact_table::{COLUMNS, ExactTable, ROWS};
use crate::brdf::{Brdf, ConvolutionRule, DiffuseRule, Material};

/// Layers: three channels, and the clamped cosine.
const LAYERS: u32 = 4;

/// Layer by layer: which model each table is of, `None` while nothing has asked for it.
#[derive(Debug)]
pub struct ExactTables {
    texture: wgpu::Texture,
    held: [Option<Brdf>; LAYERS as usize],
}

impl ExactTables {
    /// Tables of nothing yet.
    pub fn new(device: &wgpu::Device) -> Self {
        let texture = device.create_texture(&wgpu::TextureDescriptor {
            label: Some("exact tables"),
            size: wgpu::Extent3d { width: COLUMNS as u32, height: ROWS as u32, depth_or_array_layers: LAYERS },
            mip_level_count: 1,
            sample_count: 1,
            dimension: wgpu::TextureDimension::D2,
            format: wgpu::TextureFormat::R32Float,
            usage: wgpu::TextureUsages::TEXTURE_BINDING | wgpu::TextureUsages::COPY_DST,
            view_formats: &[],
        });
        Self { texture, held: [None; LAYERS as usize] }
    }

    /// The type of the binding: read texel by texel, for not every adapter filters 32-bit floats.
    pub const BINDING: wgpu::BindingType = super::layout::texture(
        wgpu::TextureSampleType::Float { filterable: false },
        wgpu::TextureViewDimension::D2Array,
    );

    /// A view of all tables.
    pub fn view(&self) -> wgpu::TextureView {
        self.texture.create_view(&wgpu::TextureViewDescriptor {
            label: Some("exact tables"),
            dimension: Some(wgpu::TextureViewDimension::D2Array),
            ..Default::default()
        })
    }

    /// Tabulates what the material asks for and is not there: about a millisecond for a new exponent, 0.1 s for a model
    /// whose multipliers are projected.
    pub fn prepare(&mut self, queue: &wgpu::Queue, material: &Material) {
        if material.convolution == ConvolutionRule::Exact {
            for (layer, model) in (0..).zip(material.channels()) {
                // The shader reads the first alone where the channels are one.
                if layer == 0 || model != material.channels()[0] {
                    self.hold(queue, layer, model);
                }
            }
        }
        if material.diffuse_rule == DiffuseRule::Exact {
            self.hold(queue, LAYERS - 1, Brdf::Lambert);
        }
    }

    fn hold(&mut self, queue: &wgpu::Queue, layer: u32, model: Brdf) {
        let held = &mut self.held[layer as usize];
        if *held == Some(model) {
            return;
        }
        *held = Some(model);
        let table = ExactTable::new(model);
        let origin = wgpu::Origin3d { x: 0, y: 0, z: layer };
        let layout = wgpu::TexelCopyBufferLayout {
            offset: 0,
            bytes_per_row: Some((COLUMNS * size_of::<f32>()) as u32),
            rows_per_image: None,
        };
        queue.write_texture(
            wgpu::TexelCopyTextureInfo { origin, ..self.texture.as_image_copy() },
            bytemuck::cast_slice(&table.ratios),
            layout,
            wgpu::Extent3d { depth_or_array_layers: 1, ..self.texture.size() },
        );
    }
}
