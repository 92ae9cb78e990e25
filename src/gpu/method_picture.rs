//! The picture of one method: where it is drawn, what the method reads beside the map, and what it was drawn from.

use super::passes::surface::{SurfacePass, Target};
use super::rival_textures::RivalTextures;
use crate::comparison::ShownMethod;
use crate::filter::Method;
use crate::filter::vmf::Fold;
use crate::lit_surface::LitSurface;

/// A method's picture, kept as long as the method is at hand.
#[derive(Debug)]
pub struct MethodPicture {
    /// The method.
    pub method: Method,
    /// The picture; of the truth, the sum so far.
    pub target: Target,
    /// Where the truth puts its next sum, while it reads the one before.
    pub spare: Option<Target>,
    /// A rival's channels.
    pub channels: Option<RivalTextures>,
    /// What the picture was drawn from; `None` before it is drawn.
    pub drawn: Option<Key>,
}

/// What one method's picture depends on.
#[derive(Clone, Debug, PartialEq)]
pub struct Key {
    /// The surface, without what the method or the picture does not depend on.
    pub surface: LitSurface,
    /// Revisions of the textures that the method reads.
    pub revisions: [u64; 2],
    /// How slots are merged.
    pub fold: Fold,
    /// Finest and coarsest level at hand; `None` where there is nothing to read.
    pub lods: Option<[f32; 2]>,
}

impl MethodPicture {
    /// Nothing drawn yet.
    pub fn new(pass: &SurfacePass, device: &wgpu::Device, method: Method, size: [u32; 2]) -> Self {
        let target = || pass.target(device, &method.to_string(), size);
        Self {
            method,
            target: target(),
            spare: (method == Method::Truth).then(target),
            channels: method.rival().map(|_| pass.rival_textures(device)),
            drawn: None,
        }
    }

    /// Makes the picture of another size, to be drawn anew; the channels stay.
    pub fn resize(&mut self, pass: &SurfacePass, device: &wgpu::Device, size: [u32; 2]) {
        let channels = self.channels.take();
        *self = Self { channels, ..Self::new(pass, device, self.method, size) };
    }

    /// Takes up the method's channels and uploads about `budget` bytes of them.
    pub fn pump(&mut self, queue: &wgpu::Queue, shown: &ShownMethod, budget: u64) {
        if let Some(channels) = &mut self.channels {
            channels.set_channels(shown.channels.as_ref());
            channels.pump(queue, budget);
        }
    }

    /// Bytes of channels not uploaded yet.
    pub fn pending_bytes(&self) -> u64 {
        self.channels.as_ref().map_or(0, RivalTextures::pending_bytes)
    }
}
