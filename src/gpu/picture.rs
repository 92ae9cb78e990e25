//! The frame without a window: finished pictures, read back.

use std::time::{Duration, Instant};

use super::context::Gpu;
use super::frame::{FrameBudget, FrameInput, SurfaceFrame};
use super::readback::{self, ReadbackError};

/// The format of pictures that are read back.
pub const PICTURE_FORMAT: wgpu::TextureFormat = wgpu::TextureFormat::Rgba8Unorm;

impl SurfaceFrame {
    /// Records and submits frames until nothing more is to come: every upload, every sample of the truth.
    pub fn complete(&mut self, gpu: &Gpu, input: &FrameInput<'_>) -> Result<(), ReadbackError> {
        loop {
            self.step(gpu, input)?;
            if !self.wants_more() {
                return Ok(());
            }
        }
    }

    /// Records and submits one frame, and waits for it.
    fn step(&mut self, gpu: &Gpu, input: &FrameInput<'_>) -> Result<(), ReadbackError> {
        let label = wgpu::CommandEncoderDescriptor { label: Some("surface frame") };
        let mut encoder = gpu.device.create_command_encoder(&label);
        self.prepare(&gpu.device, &gpu.queue, &mut encoder, input);
        gpu.queue.submit([encoder.finish()]);
        // Waiting keeps the copies of a large map from piling up.
        let waited = gpu.device.poll(wgpu::PollType::wait_indefinitely());
        waited.map(drop).map_err(|error| ReadbackError::Device(error.to_string()))
    }

    /// What a frame of `input` takes from its recording to its end, where everything is uploaded: the median of
    /// `frames` of them. The truth would begin anew with each.
    pub fn time_per_frame(
        &mut self,
        gpu: &Gpu,
        input: &FrameInput<'_>,
        frames: usize,
    ) -> Result<Duration, ReadbackError> {
        let mut times = Vec::new();
        for _ in 0..frames.max(1) {
            self.forget_pictures();
            let start = Instant::now();
            self.step(gpu, input)?;
            times.push(start.elapsed());
        }
        times.sort_unstable();
        Ok(times[times.len() / 2])
    }

    /// The final picture as last prepared, sRGB, four bytes a pixel. The frame must be for [`PICTURE_FORMAT`].
    pub fn picture(&self, gpu: &Gpu, size: [u32; 2]) -> Result<Vec<u8>, ReadbackError> {
        let texture = readback::target(&gpu.device, "picture", size, PICTURE_FORMAT);
        let named = wgpu::TextureViewDescriptor { label: Some("picture"), ..Default::default() };
        let view = texture.create_view(&named);
        let mut encoder = gpu.device.create_command_encoder(&wgpu::CommandEncoderDescriptor { label: Some("picture") });
        let mut pass = encoder.begin_render_pass(&wgpu::RenderPassDescriptor {
            label: Some("picture"),
            color_attachments: &[Some(wgpu::RenderPassColorAttachment {
                view: &view,
                depth_slice: None,
                resolve_target: None,
                ops: wgpu::Operations::default(),
            })],
            ..Default::default()
        });
        self.draw(&mut pass);
        drop(pass);
        gpu.queue.submit([encoder.finish()]);
        readback::read_bytes(&gpu.device, &gpu.queue, &texture)
    }
}

/// The finished picture of `input`, sRGB, four bytes a pixel, with `truth_samples` samples per pixel where the truth
/// is shown.
pub fn render_to_rgba8(gpu: &Gpu, input: &FrameInput<'_>, truth_samples: u32) -> Result<Vec<u8>, ReadbackError> {
    let mut frame = SurfaceFrame::new(&gpu.device, PICTURE_FORMAT);
    frame.budget = FrameBudget { truth_limit: truth_samples, truth_batch: 64, upload_bytes: 256 << 20 };
    frame.complete(gpu, input)?;
    frame.picture(gpu, input.size)
}
