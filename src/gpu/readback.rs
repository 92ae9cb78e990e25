//! Textures back to the processor.

use super::layout::texture_2d;

/// Why a texture could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadbackError {
    /// The format has no plain bytes per texel.
    #[error("a texture of format {0:?} cannot be read back")]
    Format(wgpu::TextureFormat),
    /// The device failed while the copy ran.
    #[error("the graphics device failed while a picture was read back: {0}")]
    Device(String),
}

impl ReadbackError {
    fn device(error: impl std::fmt::Display) -> Self {
        Self::Device(error.to_string())
    }
}

/// A texture of one level to draw into and to read back.
pub fn target(device: &wgpu::Device, label: &str, size: [u32; 2], format: wgpu::TextureFormat) -> wgpu::Texture {
    let usage = wgpu::TextureUsages::RENDER_ATTACHMENT | wgpu::TextureUsages::COPY_SRC;
    texture_2d(device, label, size, format, usage)
}

/// A buffer that takes a texture's first level and layer, its rows padded as copies need them.
#[derive(Debug)]
pub struct Staging {
    /// The buffer, which can be mapped for reading.
    pub buffer: wgpu::Buffer,
    /// Texels across and down.
    pub size: [u32; 2],
    /// Bytes of a row.
    pub row: u32,
    /// Bytes from one row to the next.
    padded: u32,
}

impl Staging {
    /// Room for `texture`.
    pub fn new(device: &wgpu::Device, texture: &wgpu::Texture) -> Result<Self, ReadbackError> {
        let texel = texture.format().block_copy_size(None).ok_or(ReadbackError::Format(texture.format()))?;
        let (size, row) = ([texture.width(), texture.height()], texture.width() * texel);
        let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
        let buffer = device.create_buffer(&wgpu::BufferDescriptor {
            label: Some("readback"),
            size: u64::from(padded) * u64::from(size[1]),
            usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
            mapped_at_creation: false,
        });
        Ok(Self { buffer, size, row, padded })
    }

    /// Records the copy of `texture`, which needs `COPY_SRC`.
    pub fn copy(&self, encoder: &mut wgpu::CommandEncoder, texture: &wgpu::Texture) {
        let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(self.padded), rows_per_image: None };
        encoder.copy_texture_to_buffer(
            texture.as_image_copy(),
            wgpu::TexelCopyBufferInfo { buffer: &self.buffer, layout },
            wgpu::Extent3d { width: self.size[0], height: self.size[1], depth_or_array_layers: 1 },
        );
    }
}

/// The bytes of a mapped buffer, row by row without padding.
pub fn staged(staging: &Staging) -> Result<Vec<u8>, ReadbackError> {
    let bytes = staging.buffer.get_mapped_range(..).map_err(ReadbackError::device)?;
    Ok(bytes.chunks(staging.padded as usize).flat_map(|line| &line[..staging.row as usize]).copied().collect())
}

/// The bytes of the first level and layer of `texture`, row by row without padding. Needs `COPY_SRC`; waits.
pub fn read_bytes(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    texture: &wgpu::Texture,
) -> Result<Vec<u8>, ReadbackError> {
    let staging = Staging::new(device, texture)?;
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("readback") });
    staging.copy(&mut encoder, texture);
    queue.submit([encoder.finish()]);
    map(device, &staging.buffer)?;
    staged(&staging)
}

/// The floats of the first level and layer of an `Rgba32Float` texture, or of an `Rgba32Uint` one that holds their
/// bits, row by row.
pub fn read_rgba32f(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    texture: &wgpu::Texture,
) -> Result<Vec<[f32; 4]>, ReadbackError> {
    if !matches!(texture.format(), wgpu::TextureFormat::Rgba32Float | wgpu::TextureFormat::Rgba32Uint) {
        return Err(ReadbackError::Format(texture.format()));
    }
    Ok(bytemuck::pod_collect_to_vec(&read_bytes(device, queue, texture)?))
}

/// Maps a buffer for reading; waits.
fn map(device: &wgpu::Device, buffer: &wgpu::Buffer) -> Result<(), ReadbackError> {
    let (sender, receiver) = std::sync::mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |result| {
        // The receiver waits below; were it gone, nobody would want the answer.
        let _ = sender.send(result);
    });
    device.poll(wgpu::PollType::wait_indefinitely()).map_err(ReadbackError::device)?;
    receiver.recv().map_err(ReadbackError::device)?.map_err(ReadbackError::device)
}
