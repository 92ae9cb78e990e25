//! What the adapter itself takes for a pass, by its own clock: timestamps at the beginning and the end (WebGPU's
//! `timestamp-query`), which come back some frames later. Nothing is timed where the adapter has none.

use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

use crate::filter::Method;

/// Passes that one frame times at most.
const PASSES: u32 = 32;
/// Bytes of a timestamp.
const TIMESTAMP: u64 = 8;

/// Times the passes of each method.
#[derive(Debug)]
pub struct PassTimer {
    queries: wgpu::QuerySet,
    resolved: wgpu::Buffer,
    /// Nanoseconds of a tick.
    period: f32,
    /// The methods of the passes recorded in this frame, in the order of their queries.
    recorded: Vec<Method>,
    awaited: Option<Awaited>,
    milliseconds: HashMap<Method, f64>,
}

/// Timestamps on their way back.
#[derive(Debug)]
struct Awaited {
    methods: Vec<Method>,
    buffer: wgpu::Buffer,
    copied: Arc<OnceLock<bool>>,
}

impl PassTimer {
    /// `None` where the device has no timestamps.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Option<Self> {
        if !device.features().contains(wgpu::Features::TIMESTAMP_QUERY) {
            return None;
        }
        let queries = device.create_query_set(&wgpu::QuerySetDescriptor {
            label: Some("pass times"),
            ty: wgpu::QueryType::Timestamp,
            count: 2 * PASSES,
        });
        let resolved = buffer(device, wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC);
        let period = queue.get_timestamp_period();
        let (recorded, awaited, milliseconds) = (Vec::new(), None, HashMap::new());
        Some(Self { queries, resolved, period, recorded, awaited, milliseconds })
    }

    /// Where a pass of `method` is to write its timestamps; `None` while those of an earlier frame are awaited.
    pub fn writes(&mut self, method: Method) -> Option<wgpu::RenderPassTimestampWrites<'_>> {
        let index = self.recorded.len() as u32;
        if self.awaited.is_some() || index >= PASSES {
            return None;
        }
        self.recorded.push(method);
        Some(wgpu::RenderPassTimestampWrites {
            query_set: &self.queries,
            beginning_of_pass_write_index: Some(2 * index),
            end_of_pass_write_index: Some(2 * index + 1),
        })
    }

    /// Takes what has come back, and sends for what this frame recorded.
    pub fn end_frame(&mut self, device: &wgpu::Device, encoder: &mut wgpu::CommandEncoder) {
        self.receive();
        if self.recorded.is_empty() {
            return;
        }
        let methods = std::mem::take(&mut self.recorded);
        let count = 2 * methods.len() as u32;
        let buffer = buffer(device, wgpu::BufferUsages::MAP_READ | wgpu::BufferUsages::COPY_DST);
        encoder.resolve_query_set(&self.queries, 0..count, &self.resolved, 0);
        encoder.copy_buffer_to_buffer(&self.resolved, 0, &buffer, 0, u64::from(count) * TIMESTAMP);
        let copied = Arc::new(OnceLock::new());
        let told = Arc::clone(&copied);
        encoder.map_buffer_on_submit(&buffer, wgpu::MapMode::Read, .., move |result| {
            // The adapter answers once.
            let _ = told.set(result.is_ok());
        });
        self.awaited = Some(Awaited { methods, buffer, copied });
    }

    /// Milliseconds of the method's last timed pass.
    pub fn milliseconds(&self, method: Method) -> Option<f64> {
        self.milliseconds.get(&method).copied()
    }

    /// True while timestamps are on their way.
    pub fn is_waiting(&self) -> bool {
        self.awaited.is_some()
    }

    /// Takes the timestamps that have come back.
    pub fn receive(&mut self) {
        let Some(copied) = self.awaited.as_ref().and_then(|awaited| awaited.copied.get().copied()) else { return };
        let Some(Awaited { methods, buffer, .. }) = self.awaited.take() else { return };
        let Some(bytes) = copied.then(|| buffer.get_mapped_range(..).ok()).flatten() else { return };
        let ticks: Vec<u64> = bytemuck::pod_collect_to_vec(&bytes);
        for (method, ticks) in methods.into_iter().zip(ticks.chunks_exact(2)) {
            let nanoseconds = ticks[1].wrapping_sub(ticks[0]) as f64 * f64::from(self.period);
            // A clock that is reset between the two says nothing.
            if nanoseconds < 1e12 {
                self.milliseconds.insert(method, 1e-6 * nanoseconds);
            }
        }
    }
}

fn buffer(device: &wgpu::Device, usage: wgpu::BufferUsages) -> wgpu::Buffer {
    let size = u64::from(2 * PASSES) * TIMESTAMP;
    device.create_buffer(&wgpu::BufferDescriptor { label: Some("pass times"), size, usage, mapped_at_creation: false })
}
