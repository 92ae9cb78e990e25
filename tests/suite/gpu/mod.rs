//! What the graphics adapter draws, held against the processor's twins.

mod context;
mod frames;
mod layouts;
pub mod maps;
mod twins;

use std::collections::HashMap;
use std::sync::{Arc, OnceLock};

use ndf_inspector::filter::channels::ChannelPyramid;
use ndf_inspector::filter::rival::Source;
use ndf_inspector::filter::vmf::{Fold, LobePyramid, Monitor, Rules};
use ndf_inspector::filter::{Method, PlainMip, Rival, RivalFilter};
use ndf_inspector::gpu::{FrameInput, Gpu};
use ndf_inspector::lit_surface::LitSurface;
use ndf_inspector::normal_map::NormalMap;

/// One device for every test.
fn gpu() -> &'static Gpu {
    static GPU: OnceLock<Gpu> = OnceLock::new();
    GPU.get_or_init(|| Gpu::headless().expect("a graphics adapter, software Vulkan at least"))
}

/// A map with everything that is drawn from it.
struct Scene {
    mip: Arc<PlainMip>,
    lobes: LobePyramid,
    fold: Fold,
    surface: LitSurface,
    size: [u32; 2],
    channels: HashMap<Method, Arc<ChannelPyramid>>,
}

impl Scene {
    fn new(map: Arc<NormalMap>, lobes: usize) -> Self {
        let lobes = maps::mixtures(&map, lobes);
        let mip = Arc::new(PlainMip::new(map));
        Self {
            mip,
            lobes,
            fold: Fold::default(),
            surface: LitSurface::default(),
            size: [192, 144],
            channels: HashMap::new(),
        }
    }

    /// Builds a rival, which the adapter then finds the channels of.
    fn build(&mut self, rival: Rival) -> Arc<dyn RivalFilter> {
        let monitor = Monitor::new(Vec::new());
        let source = Source { mip: &self.mip, rules: Rules::default(), monitor: &monitor };
        let filter = rival.build(&source).expect("nobody cancels");
        if let Some(channels) = filter.channels(&monitor).expect("nobody cancels") {
            self.channels.insert(Method::Rival(rival), Arc::clone(channels));
        }
        filter
    }

    fn map(&self) -> &Arc<NormalMap> {
        &self.mip.map
    }

    fn full_lod_range(&self) -> [f32; 2] {
        [0.0, (self.map().level_sizes().len() - 1) as f32]
    }

    /// `method` alone, over the whole picture.
    fn input(&self, method: Method) -> FrameInput<'_> {
        FrameInput {
            surface: &self.surface,
            mip: &self.mip,
            lobes: &self.lobes,
            fold: self.fold,
            left: method,
            right: method,
            channels: [self.channels.get(&method); 2],
            wipe: 1.0,
            size: self.size,
        }
    }
}
