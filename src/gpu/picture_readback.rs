//! Pictures on their way back to the processor. Nobody waits: the copy is recorded with the frame, and the adapter says
//! when it has been made.

use std::sync::{Arc, OnceLock};

use glam::Vec3;

use super::readback::{Staging, staged};
use crate::reference::Picture;

/// One picture, being copied or already here.
#[derive(Debug)]
pub struct PictureReadback {
    staging: Staging,
    copied: Arc<OnceLock<Result<(), String>>>,
    picture: OnceLock<Result<Arc<Picture>, String>>,
}

impl PictureReadback {
    /// Records the copy of a texture of four floats, or of their bits, with `encoder`. `None` for any other format.
    pub fn record(device: &wgpu::Device, encoder: &mut wgpu::CommandEncoder, texture: &wgpu::Texture) -> Option<Self> {
        let staging = Staging::new(device, texture).ok().filter(|staging| staging.row == 16 * texture.width())?;
        staging.copy(encoder, texture);
        let copied = Arc::new(OnceLock::new());
        let told = Arc::clone(&copied);
        encoder.map_buffer_on_submit(&staging.buffer, wgpu::MapMode::Read, .., move |result| {
            // The adapter answers once.
            let _ = told.set(result.map_err(|error| error.to_string()));
        });
        Some(Self { staging, copied, picture: OnceLock::new() })
    }

    /// Pixels across and down.
    pub fn size(&self) -> [u32; 2] {
        self.staging.size
    }

    /// True once the adapter has answered, which it does while it is polled.
    pub fn is_ready(&self) -> bool {
        self.copied.get().is_some()
    }

    /// The picture in linear light, before exposure; worked out on the first call, on any thread.
    ///
    /// # Errors
    /// What the adapter said, or that it has not answered yet.
    pub fn picture(&self) -> Result<Arc<Picture>, String> {
        self.copied.get().cloned().unwrap_or_else(|| Err("the copy is under way".to_owned()))?;
        self.picture.get_or_init(|| self.decode().map(Arc::new)).clone()
    }

    fn decode(&self) -> Result<Picture, String> {
        let bytes = staged(&self.staging).map_err(|error| error.to_string())?;
        let texels: Vec<[f32; 4]> = bytemuck::pod_collect_to_vec(&bytes);
        Ok(Picture {
            size: self.staging.size,
            rgb: texels.iter().map(|texel| Vec3::from_slice(&texel[..3])).collect(),
            covered: texels.iter().map(|texel| texel[3] > 0.5).collect(),
        })
    }
}
