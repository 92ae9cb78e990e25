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

/// The bytes of the first level and layer of `texture`, row by row without padding. Needs `COPY_SRC`; waits.
pub fn read_bytes(
    device: &wgpu::Device,
    queue: &wgpu::Queue,
    texture: &wgpu::Texture,
) -> Result<Vec<u8>, ReadbackError> {
    let texel = texture.format().block_copy_size(None).ok_or(ReadbackError::Format(texture.format()))?;
    let row = texture.width() * texel;
    let padded = row.next_multiple_of(wgpu::COPY_BYTES_PER_ROW_ALIGNMENT);
    let buffer = device.create_buffer(&wgpu::BufferDescriptor {
        label: Some("readback"),
        size: u64::from(padded) * u64::from(texture.height()),
        usage: wgpu::BufferUsages::COPY_DST | wgpu::BufferUsages::MAP_READ,
        mapped_at_creation: false,
    });
    copy(device, queue, texture, &buffer, padded);
    let bytes = map(device, &buffer)?;
    Ok(bytes.chunks(padded as usize).flat_map(|line| &line[..row as usize]).copied().collect())
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

fn copy(device: &wgpu::Device, queue: &wgpu::Queue, texture: &wgpu::Texture, buffer: &wgpu::Buffer, padded: u32) {
    let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("readback") });
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(padded), rows_per_image: None };
    encoder.copy_texture_to_buffer(
        texture.as_image_copy(),
        wgpu::TexelCopyBufferInfo { buffer, layout },
        wgpu::Extent3d { width: texture.width(), height: texture.height(), depth_or_array_layers: 1 },
    );
    queue.submit([encoder.finish()]);
}

fn map(device: &wgpu::Device, buffer: &wgpu::Buffer) -> Result<Vec<u8>, ReadbackError> {
    let (sender, receiver) = std::sync::mpsc::channel();
    buffer.map_async(wgpu::MapMode::Read, .., move |result| {
        // The receiver waits below; were it gone, nobody would want the answer.
        let _ = sender.send(result);
    });
    device.poll(wgpu::PollType::wait_indefinitely()).map_err(ReadbackError::device)?;
    receiver.recv().map_err(ReadbackError::device)?.map_err(ReadbackError::device)?;
    Ok(buffer.get_mapped_range(..).map_err(ReadbackError::device)?.to_vec())
}
