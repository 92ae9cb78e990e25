//! What the graphics adapter draws, held against the processor's twins.

mod bump;
mod context;
mod frames;
mod frames_per_pixel;
mod groove;
mod layouts;
mod limits;
pub mod maps;
mod models;
mod pictures;
mod probes;
mod sky;
mod truth;
mod twins;

use std::sync::{Arc, OnceLock};

use ndf_inspector::comparison::Arrangement;
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
}

impl Scene {
    fn new(map: Arc<NormalMap>, lobes: usize) -> Self {
        let lobes = maps::mixtures(&map, lobes);
        let mip = Arc::new(PlainMip::new(map));
        Self { mip, lobes, fold: Fold::default(), surface: LitSurface::default(), size: [192, 144] }
    }

    /// Builds a rival.
    fn rival(&self, rival: Rival) -> Arc<dyn RivalFilter> {
        let monitor = Monitor::new(Vec::new());
        let source = Source { mip: &self.mip, rules: Rules::default(), monitor: &monitor };
        rival.build(&source).expect("nobody cancels")
    }

    /// What the adapter samples of a method, where it is a rival that has channels.
    fn channels(&self, method: Method) -> Option<Arc<ChannelPyramid>> {
        let rival = self.rival(method.rival()?);
        rival.channels(&Monitor::new(Vec::new())).expect("nobody cancels").cloned()
    }

    fn map(&self) -> &Arc<NormalMap> {
        &self.mip.map
    }

    fn full_lod_range(&self) -> [f32; 2] {
        [0.0, (self.map().level_sizes().len() - 1) as f32]
    }

    /// `method` alone, over the whole picture, without channels.
    fn input(&self, method: Method) -> FrameInput<'_> {
        FrameInput {
            surface: &self.surface,
            mip: &self.mip,
            lobes: &self.lobes,
            fold: self.fold,
            methods: vec![method.into()],
            arrangement: Arrangement::Grid { side: 1 },
            size: self.size,
        }
    }
}
