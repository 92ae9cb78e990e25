//! The frame: uploads, a picture of the surface per method shown, and their comparison.
//!
//! The window and the command line record the same frame. A picture is drawn again only when something it depends on
//! has changed; the truth goes on adding samples until it has enough. In a grid each method's picture is as large as
//! its cell, all under the same camera. Where methods are held against the truth, it is drawn though nobody sees it,
//! and pictures are read back.

use std::sync::Arc;

use super::frame_data::FrameData;
use super::method_picture::{Key, MethodPicture};
use super::pass_timer::PassTimer;
use super::passes::compare::{CompareData, ComparePass, ComparedPictures};
use super::passes::surface::{Reads, SurfacePass};
use super::readback::{self, ReadbackError};
use super::snapshots::{self, Snapshots};
use super::surface_pipelines::Variant;
use super::textures::MapTextures;
use crate::brdf::{ConvolutionRule, DiffuseRule};
use crate::comparison::{Arrangement, ShownMethod};
use crate::filter::vmf::{Fold, LobePyramid};
use crate::filter::{LevelChoice, Method, PlainMip};
use crate::lighting::Sky;
use crate::lit_surface::LitSurface;
use crate::normal_map::Addressing;

/// Everything a frame shows.
#[derive(Clone, Debug)]
pub struct FrameInput<'a> {
    /// The surface.
    pub surface: &'a LitSurface,
    /// The map and its mean normals.
    pub mip: &'a Arc<PlainMip>,
    /// The lobes at hand, of the same map.
    pub lobes: &'a LobePyramid,
    /// How slots are merged before shading.
    pub fold: Fold,
    /// The methods, as many as the arrangement asks for.
    pub methods: Vec<ShownMethod>,
    /// Where in the picture they are seen.
    pub arrangement: Arrangement,
    /// Pixels across and down.
    pub size: [u32; 2],
}

impl FrameInput<'_> {
    /// The methods that are to be drawn, each once.
    fn seen(&self) -> Vec<Method> {
        let mut seen = Vec::new();
        for (index, shown) in self.methods.iter().enumerate() {
            if self.arrangement.shows(index) && !seen.contains(&shown.method) {
                seen.push(shown.method);
            }
        }
        seen
    }
}

/// How much a frame may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FrameBudget {
    /// Samples per pixel after which the truth is finished.
    pub truth_limit: u32,
    /// Samples per pixel that one frame adds.
    pub truth_batch: u32,
    /// Bytes of textures that one frame uploads.
    pub upload_bytes: u64,
}

impl Default for FrameBudget {
    fn default() -> Self {
        Self { truth_limit: 1024, truth_batch: 16, upload_bytes: 32 << 20 }
    }
}

/// The GPU objects of the frame, and what they hold at present.
#[derive(Debug)]
pub struct SurfaceFrame {
    /// How much a frame may do.
    pub budget: FrameBudget,
    /// True where the methods are held against the truth: it is drawn though nobody sees it, and pictures are read
    /// back.
    pub against_truth: bool,
    /// Times the methods' passes, where that is wanted.
    pub timer: Option<PassTimer>,
    textures: MapTextures,
    surface: SurfacePass,
    compare: ComparePass,
    pictures: Vec<MethodPicture>,
    /// Of each picture, in pixels.
    size: [u32; 2],
    truth_samples: u32,
    truth_drawn: bool,
    exposure: f32,
    snapshots: Snapshots,
}

impl SurfaceFrame {
    /// Compiles everything for final targets of `target_format`, which must not encode sRGB itself.
    pub fn new(device: &wgpu::Device, target_format: wgpu::TextureFormat) -> Self {
        let textures = MapTextures::new(device);
        let surface = SurfacePass::new(device, textures.layout());
        Self {
            budget: FrameBudget::default(),
            against_truth: false,
            timer: None,
            surface,
            compare: ComparePass::new(device, target_format),
            textures,
            pictures: Vec::new(),
            size: [1, 1],
            truth_samples: 0,
            truth_drawn: false,
            exposure: 1.0,
            snapshots: Snapshots::default(),
        }
    }

    /// Records the uploads and pictures that are due into `encoder`. At most once per submission.
    pub fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        encoder: &mut wgpu::CommandEncoder,
        input: &FrameInput<'_>,
    ) {
        self.textures.set_map(input.mip);
        self.textures.set_lobes(input.lobes);
        self.textures.pump(queue, self.budget.upload_bytes);
        self.set_pictures(device, queue, input);
        let mut seen = input.seen();
        if self.against_truth && !seen.contains(&Method::Truth) {
            seen.push(Method::Truth);
        }
        self.exposure = input.surface.exposure();
        self.truth_drawn = seen.contains(&Method::Truth);
        if let Some(truth) = self.find(Method::Truth).filter(|_| self.truth_drawn)
            && truth.drawn != Some(self.key(truth, input))
        {
            self.truth_samples = 0;
        }
        let is_due = |picture: &&MethodPicture| seen.contains(&picture.method) && self.is_due(picture, input);
        let due: Vec<Method> = self.pictures.iter().filter(is_due).map(|picture| picture.method).collect();
        if !due.is_empty() {
            let data = self.frame_data(input);
            self.surface.prepare((device, queue), input.surface, &data, self.size);
            let variant = Variant::new(self.textures.is_colored(), input.surface);
            self.surface.prepare_methods(device, &due, variant);
        }
        for method in due {
            self.draw_method(encoder, queue, method, input);
        }
        self.read_back(device, encoder);
        let cells = input.arrangement.cell_origins(input.size).enumerate();
        let compared: Vec<_> = cells.filter_map(|(cell, origin)| self.compared(input, cell, origin)).collect();
        self.compare.prepare(device, queue, &compared);
    }

    /// Sends for what figures are worked out from, and for the times of the passes.
    fn read_back(&mut self, device: &wgpu::Device, encoder: &mut wgpu::CommandEncoder) {
        if !self.against_truth {
            self.snapshots = Snapshots::default();
        } else if self.pending_bytes() == 0 {
            let samples = [self.truth_samples, self.budget.truth_limit];
            self.snapshots.update(device, encoder, &self.pictures, samples);
        }
        if let Some(timer) = &mut self.timer {
            timer.end_frame(device, encoder);
        }
    }

    /// Keeps the pictures of the methods at hand, their size and channels brought up to date, and forgets the others.
    fn set_pictures(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, input: &FrameInput<'_>) {
        let most = device.limits().max_texture_dimension_2d;
        let size = input.arrangement.cell_size(input.size).map(|pixels| pixels.clamp(1, most));
        let mut methods = input.methods.clone();
        if self.against_truth && methods.iter().all(|shown| shown.method != Method::Truth) {
            methods.push(Method::Truth.into());
        }
        self.pictures.retain(|picture| methods.iter().any(|shown| shown.method == picture.method));
        if self.size != size {
            self.pictures.iter_mut().for_each(|picture| picture.resize(&self.surface, device, size));
            self.size = size;
        }
        for shown in &methods {
            let held = self.pictures.iter().position(|picture| picture.method == shown.method);
            let index = held.unwrap_or_else(|| {
                self.pictures.push(MethodPicture::new(&self.surface, device, shown.method, size));
                self.pictures.len() - 1
            });
            self.pictures[index].pump(queue, shown, self.budget.upload_bytes);
        }
    }

    fn find(&self, method: Method) -> Option<&MethodPicture> {
        self.pictures.iter().find(|picture| picture.method == method)
    }

    /// Draws the comparison over the pass's viewport.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.compare.draw(pass);
    }

    /// Forgets what is drawn, so that the next frame draws it again.
    pub fn forget_pictures(&mut self) {
        self.pictures.iter_mut().for_each(|picture| picture.drawn = None);
    }

    /// Samples per pixel that the truth has so far.
    pub fn truth_samples(&self) -> u32 {
        self.truth_samples
    }

    /// True while another frame would look better: uploads are under way, or the truth is drawn and unfinished.
    pub fn wants_more(&self) -> bool {
        self.pending_bytes() > 0 || self.truth_drawn && self.truth_samples < self.budget.truth_limit
    }

    fn pending_bytes(&self) -> u64 {
        let uploads = self.pictures.iter().map(MethodPicture::pending_bytes);
        uploads.sum::<u64>() + self.textures.pending_bytes()
    }

    /// True while something is on its way back, which arrives with one of the next frames.
    pub fn is_waiting(&self) -> bool {
        !self.snapshots.are_ready() || self.timer.as_ref().is_some_and(PassTimer::is_waiting)
    }

    /// The pictures that figures are worked out from; none but where methods are held against the truth.
    pub fn snapshots(&self) -> &Snapshots {
        &self.snapshots
    }

    /// Finest levels of the map that are not shown because the adapter cannot hold them.
    pub fn left_out(&self) -> usize {
        self.textures.left_out
    }

    /// Finest levels whose lobes are not shown because the adapter, or the memory set aside, cannot hold them.
    pub fn lobes_left_out(&self) -> usize {
        // A texture that begins with level 1 leaves nothing out: the base level is no texture of lobes.
        match self.textures.lobe_level() {
            1 => 0,
            level => level,
        }
    }

    /// Finest and coarsest level that `method` reads at present; `None` while it has nothing to read.
    pub fn lod_range(&self, method: Method) -> Option<[f32; 2]> {
        match method {
            Method::Truth => self.textures.base_is_complete().then_some([0.0, 0.0]),
            Method::Rival(rival) if !rival.is_drawn() => None,
            Method::Rival(rival) => self.find(method)?.channels.as_ref()?.lods(&self.textures, rival.kind.has_channels),
            Method::Vmf | Method::VmfUnaligned => self.textures.vmf_lods(),
        }
    }

    /// The picture of one method as last drawn: exposed linear RGB, and 1 where the surface is seen. Waits.
    pub fn linear(
        &self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        method: Method,
    ) -> Result<Vec<[f32; 4]>, ReadbackError> {
        let Some(picture) = self.find(method).filter(|picture| picture.drawn.is_some()) else {
            return Ok(Vec::new());
        };
        let scale = self.exposure;
        let texels = readback::read_rgba32f(device, queue, &picture.target.color)?;
        Ok(texels.into_iter().map(|[r, g, b, a]| [scale * r, scale * g, scale * b, a]).collect())
    }

    fn key(&self, picture: &MethodPicture, input: &FrameInput<'_>) -> Key {
        let method = picture.method;
        // Exposure is put on by the comparison.
        let mut surface = LitSurface { exposure_stops: 0.0, ..input.surface.clone() };
        let mut fold = input.fold;
        if !method.shows_lobes() {
            fold = Fold::default();
            surface.material.diffuse_rule = DiffuseRule::default();
        }
        if method == Method::Truth {
            surface.material.convolution = ConvolutionRule::default();
            surface.level = LevelChoice::default();
            surface.anisotropy = 1;
            (surface.sky.last_band, surface.sky.is_sun_apart) = (Sky::LAST_BAND, true);
        }
        let revisions = match method {
            Method::Truth => [self.textures.map_revision, 0],
            Method::Rival(_) => {
                let own = picture.channels.as_ref().map_or(0, |channels| channels.revision);
                [self.textures.means_revision, own]
            }
            Method::Vmf | Method::VmfUnaligned => [self.textures.means_revision, self.textures.lobes_revision],
        };
        Key { surface, revisions, fold, lods: self.lod_range(method) }
    }

    fn is_due(&self, picture: &MethodPicture, input: &FrameInput<'_>) -> bool {
        let unfinished = picture.method == Method::Truth && self.truth_samples < self.budget.truth_limit;
        unfinished || picture.drawn != Some(self.key(picture, input))
    }

    fn frame_data(&self, input: &FrameInput<'_>) -> FrameData {
        let map = &input.mip.map;
        let mut data = FrameData {
            base_size: [map.width as f32, map.height as f32],
            vmf_lods: self.textures.vmf_lods().unwrap_or_default(),
            base_level: self.textures.left_out as f32,
            lobe_level: self.textures.lobe_level() as f32,
            lobes: self.textures.slots() as u32,
            wraps: u32::from(map.options.addressing == Addressing::Wrap),
            first_sample: self.truth_samples,
            sample_count: self.samples_due(),
            ..FrameData::of_surface(input.surface, self.size)
        };
        data.set_fold(&input.fold);
        data.set_bump(&input.surface.shape, map);
        data
    }

    fn draw_method(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        queue: &wgpu::Queue,
        method: Method,
        input: &FrameInput<'_>,
    ) {
        let Some(key) = self.find(method).map(|picture| self.key(picture, input)) else { return };
        let samples_due = self.samples_due();
        // The truth's pass adds samples to a picture: its time is none of a picture's.
        let timer = self.timer.as_mut().filter(|_| method != Method::Truth && key.lods.is_some());
        let timestamps = timer.and_then(|timer| timer.writes(method));
        let Some(picture) = self.pictures.iter_mut().find(|picture| picture.method == method) else { return };
        let (surface, map) = (&self.surface, &self.textures);
        let target = &mut picture.target;
        match (key.lods, method, &picture.channels, &mut picture.spare) {
            (None, ..) => surface.clear(encoder, target),
            (Some(_), _, _, Some(next)) => {
                if self.truth_samples == 0 {
                    surface.clear(encoder, target);
                }
                surface.draw(encoder, method, map, next, Reads::Mean(target), None);
                std::mem::swap(next, target);
                self.truth_samples += samples_due;
            }
            (Some(lods), Method::Rival(rival), Some(channels), _) => {
                channels.prepare(queue, lods, rival.parameter);
                surface.draw(encoder, method, map, target, Reads::Channels(channels), timestamps);
            }
            (Some(_), ..) => surface.draw(encoder, method, map, target, Reads::Nothing, timestamps),
        }
        picture.drawn = Some(key);
    }

    /// Samples of the truth that the next frame adds; where it is read back, no more than up to the next stop.
    fn samples_due(&self) -> u32 {
        let limit = self.budget.truth_limit;
        let stop = if self.against_truth { snapshots::next_stop(self.truth_samples, limit) } else { limit };
        self.budget.truth_batch.min(stop.saturating_sub(self.truth_samples))
    }

    /// What a cell shows, once its pictures are there.
    fn compared(&self, input: &FrameInput<'_>, cell: usize, origin: [u32; 2]) -> Option<ComparedPictures> {
        let methods = input.arrangement.methods_in(cell);
        let [left, right] = methods.map(|index| self.find(input.methods.get(index)?.method));
        let (left, right) = (left?, right?);
        let mut data = CompareData::of_cell(input.arrangement, input.size, origin);
        (data.left_scale, data.right_scale) = (self.exposure, self.exposure);
        if left.method == right.method {
            data.divider = 0.0;
        }
        Some(ComparedPictures { pictures: [left, right].map(|picture| picture.target.view().clone()), data })
    }
}
