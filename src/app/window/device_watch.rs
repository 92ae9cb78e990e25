//! Notices that the graphics device is lost.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};

use egui::Context;

use crate::jobs::Wake;

/// Whether a device is still there.
pub struct DeviceWatch {
    is_lost: Arc<AtomicBool>,
    device: wgpu::Device,
    opened: Instant,
    lose_after: Option<Duration>,
}

impl DeviceWatch {
    /// Watches a device; one that is lost asks for a pass of the window. What fails on a device that is lost is not
    /// said, what fails otherwise goes to the log.
    pub fn new(device: &wgpu::Device, ctx: &Context, lose_after: Option<Duration>) -> Self {
        let is_lost = Arc::new(AtomicBool::new(false));
        let (lost, ctx) = (Arc::clone(&is_lost), ctx.clone());
        device.set_device_lost_callback(move |reason, message| {
            log::warn!("the graphics device is lost ({reason:?}): {message}");
            lost.store(true, Ordering::Release);
            ctx.request_repaint();
        });
        let lost = Arc::clone(&is_lost);
        device.on_uncaptured_error(Arc::new(move |error: wgpu::Error| {
            if !lost.load(Ordering::Acquire) {
                log::error!("{error}");
            }
        }));
        Self { is_lost, device: device.clone(), opened: Instant::now(), lose_after }
    }

    /// True once it is lost.
    pub fn is_lost(&self) -> bool {
        self.is_lost.load(Ordering::Acquire)
    }

    /// Gives the device up when that was asked for and is due.
    pub fn rehearse(&mut self, ctx: &Context) {
        let Some(after) = self.lose_after else { return };
        if self.opened.elapsed() < after {
            ctx.request_repaint_after(after.saturating_sub(self.opened.elapsed()));
            return;
        }
        self.lose_after = None;
        self.device.destroy();
        // The loss is told of while the device is asked how far it is.
        let _ = self.device.poll(wgpu::PollType::Poll);
        ctx.request_repaint();
    }
}

/// Calls whichever window is open, from any thread.
#[derive(Clone, Default)]
pub struct Caller(Arc<Mutex<Option<Context>>>);

impl Caller {
    /// Calls this window from now on.
    pub fn follow(&self, ctx: &Context) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Some(ctx.clone());
    }

    /// The call.
    pub fn wake(&self) -> Wake {
        let called = Arc::clone(&self.0);
        Arc::new(move || {
            let ctx = called.lock().unwrap_or_else(PoisonError::into_inner).clone();
            if let Some(ctx) = ctx {
                ctx.request_repaint();
            }
        })
    }
}
