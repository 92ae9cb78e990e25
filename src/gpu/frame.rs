//! The frame: uploads, a picture of the surface per method shown, and their comparison.
//!
//! The window and the command line record the same frame. A picture is drawn again only when something it depends on
//! has changed; the truth goes on adding samples until it has enough.

use std::collections::HashMap;
use std::sync::Arc;

use super::passes::compare::{CompareData, ComparePass};
use super::passes::surface::{FrameData, Reads, SurfacePass, Target};
use super::readback::{self, ReadbackError};
use super::rival_textures::RivalTextures;
use super::surface_pipelines::Variant;
use super::textures::MapTextures;
use crate::brdf::{ConvolutionRule, DiffuseRule};
use crate::filter::channels::ChannelPyramid;
use crate::filter::vmf::{Fold, LobePyramid};
use crate::filter::{Method, PlainMip, Rival};
use crate::lit_surface::{LevelChoice, LitSurface};
use crate::normal_map::Addressing;

/// Everything a frame shows.
#[derive(Clone, Copy, Debug)]
pub struct FrameInput<'a> {
    /// The surface.
    pub surface: &'a LitSurface,
    /// The map and its mean normals.
    pub mip: &'a Arc<PlainMip>,
    /// The lobes at hand, of the same map.
    pub lobes: &'a LobePyramid,
    /// How slots are merged before shading.
    pub fold: Fold,
    /// The method left of the wipe.
    pub left: Method,
    /// The method right of the wipe.
    pub right: Method,
    /// The channels of the left and of the right method, where it is a rival that has some and they are built.
    pub channels: [Option<&'a Arc<ChannelPyramid>>; 2],
    /// Where the left side ends, 0 (right side only) to 1 (left side only).
    pub wipe: f32,
    /// Pixels across and down.
    pub size: [u32; 2],
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
    textures: MapTextures,
    surface: SurfacePass,
    compare: ComparePass,
    targets: Option<Targets>,
    rivals: Vec<RivalPicture>,
    truth_samples: u32,
    truth_shown: bool,
    exposure: f32,
}

/// The pictures: two for the truth, which takes turns reading one and writing the other, then one for each way of
/// shading lobes.
#[derive(Debug)]
struct Targets {
    size: [u32; 2],
    truth: [Target; 2],
    /// Which of the two holds the mean so far.
    latest: usize,
    vmf: Target,
    vmf_unaligned: Target,
    drawn: HashMap<Method, Key>,
}

/// A rival on one side of the wipe; kept as long as it is there.
#[derive(Debug)]
struct RivalPicture {
    rival: Rival,
    textures: RivalTextures,
    target: Target,
}

/// What one method's picture depends on.
#[derive(Clone, Debug, PartialEq)]
struct Key {
    surface: LitSurface,
    size: [u32; 2],
    revisions: [u64; 2],
    fold: Fold,
    lods: Option<[f32; 2]>,
}

impl Targets {
    fn new(pass: &SurfacePass, device: &wgpu::Device, size: [u32; 2]) -> Self {
        let target = |label| pass.target(device, label, size);
        let truth = [target("truth, even"), target("truth, odd")];
        let [vmf, vmf_unaligned] = ["vmf", "vmf, unaligned"].map(target);
        Self { size, truth, latest: 0, vmf, vmf_unaligned, drawn: HashMap::new() }
    }

    /// The picture of a method, which is among `rivals` if it is one.
    fn of<'a>(&'a self, method: Method, rivals: &'a [RivalPicture]) -> Option<&'a Target> {
        match method {
            Method::Truth => Some(&self.truth[self.latest]),
            Method::Vmf => Some(&self.vmf),
            Method::VmfUnaligned => Some(&self.vmf_unaligned),
            Method::Rival(rival) => find(rivals, rival).map(|picture| &picture.target),
        }
    }
}

fn find(rivals: &[RivalPicture], rival: Rival) -> Option<&RivalPicture> {
    rivals.iter().find(|picture| picture.rival == rival)
}

impl SurfaceFrame {
    /// Compiles everything for final targets of `target_format`, which must not encode sRGB itself.
    pub fn new(device: &wgpu::Device, target_format: wgpu::TextureFormat) -> Self {
        let textures = MapTextures::new(device);
        let surface = SurfacePass::new(device, textures.layout());
        Self {
            budget: FrameBudget::default(),
            surface,
            compare: ComparePass::new(device, target_format),
            textures,
            targets: None,
            rivals: Vec::new(),
            truth_samples: 0,
            truth_shown: false,
            exposure: 1.0,
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
        let size = input.size.map(|pixels| pixels.clamp(1, device.limits().max_texture_dimension_2d));
        let kept = self.targets.take().filter(|targets| targets.size == size);
        if kept.is_none() {
            self.rivals.clear();
        }
        let mut targets = kept.unwrap_or_else(|| Targets::new(&self.surface, device, size));
        self.set_rivals(device, queue, input, &mut targets);
        let (left, right) = shown(input);
        self.exposure = input.surface.exposure();
        self.truth_shown = [left, right].contains(&Method::Truth);
        if self.truth_shown && targets.drawn.get(&Method::Truth) != Some(&self.key(Method::Truth, input, size)) {
            self.truth_samples = 0;
        }
        let both = if left == right { vec![left] } else { vec![left, right] };
        let due: Vec<Method> = both.into_iter().filter(|&method| self.is_due(method, input, &targets)).collect();
        if !due.is_empty() {
            let data = self.frame_data(input, size);
            self.surface.prepare(device, queue, input.surface, &data);
            let variant = Variant::new(self.textures.is_colored(), &input.surface.material);
            self.surface.prepare_methods(device, &due, variant);
        }
        for method in due {
            self.draw_method(encoder, queue, method, input, &mut targets);
        }
        if let (Some(left), Some(right)) = (targets.of(left, &self.rivals), targets.of(right, &self.rivals)) {
            self.compare.prepare(device, queue, [left.view(), right.view()], &self.compare_data(input, size));
        }
        self.targets = Some(targets);
    }

    /// Keeps the rivals on either side, their channels brought up to date, and forgets the others.
    fn set_rivals(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        input: &FrameInput<'_>,
        targets: &mut Targets,
    ) {
        let sides = [input.left.rival(), input.right.rival()];
        self.rivals.retain(|picture| sides.contains(&Some(picture.rival)));
        targets.drawn.retain(|method, _| method.rival().is_none_or(|rival| sides.contains(&Some(rival))));
        for (rival, channels) in sides.into_iter().zip(input.channels) {
            let Some(rival) = rival else { continue };
            if find(&self.rivals, rival).is_none() {
                let textures = self.surface.rival_textures(device);
                let target = self.surface.target(device, rival.kind.name, targets.size);
                self.rivals.push(RivalPicture { rival, textures, target });
            }
            if let Some(picture) = self.rivals.iter_mut().find(|picture| picture.rival == rival) {
                picture.textures.set_channels(channels);
                picture.textures.pump(queue, self.budget.upload_bytes);
            }
        }
    }

    /// Draws the comparison over the pass's viewport.
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        self.compare.draw(pass);
    }

    /// Forgets what is drawn, so that the next frame draws it again.
    pub fn forget_pictures(&mut self) {
        if let Some(targets) = &mut self.targets {
            targets.drawn.clear();
        }
    }

    /// Samples per pixel that the truth has so far.
    pub fn truth_samples(&self) -> u32 {
        self.truth_samples
    }

    /// True while another frame would look better: uploads are under way, or the truth is shown and unfinished.
    pub fn wants_more(&self) -> bool {
        let uploads = self.rivals.iter().map(|picture| picture.textures.pending_bytes());
        let pending = uploads.sum::<u64>() + self.textures.pending_bytes();
        pending > 0 || self.truth_shown && self.truth_samples < self.budget.truth_limit
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
            Method::Rival(rival) => find(&self.rivals, rival)?.textures.lods(&self.textures, rival.kind.has_channels),
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
        let drawn = self.targets.as_ref().filter(|targets| targets.drawn.contains_key(&method));
        let Some(target) = drawn.and_then(|targets| targets.of(method, &self.rivals)) else { return Ok(Vec::new()) };
        let scale = self.exposure;
        let texels = readback::read_rgba32f(device, queue, &target.color)?;
        Ok(texels.into_iter().map(|[r, g, b, a]| [scale * r, scale * g, scale * b, a]).collect())
    }

    fn key(&self, method: Method, input: &FrameInput<'_>, size: [u32; 2]) -> Key {
        // Exposure is put on by the comparison.
        let mut surface = LitSurface { exposure_stops: 0.0, ..*input.surface };
        let mut fold = input.fold;
        if !method.shows_lobes() {
            fold = Fold::default();
            surface.material.diffuse_rule = DiffuseRule::default();
        }
        if method == Method::Truth {
            surface.material.convolution = ConvolutionRule::default();
            surface.level = LevelChoice::default();
        }
        let revisions = match method {
            Method::Truth => [self.textures.map_revision, 0],
            Method::Rival(rival) => {
                let own = find(&self.rivals, rival).map_or(0, |picture| picture.textures.revision);
                [self.textures.means_revision, own]
            }
            Method::Vmf | Method::VmfUnaligned => [self.textures.means_revision, self.textures.lobes_revision],
        };
        Key { surface, size, revisions, fold, lods: self.lod_range(method) }
    }

    fn is_due(&self, method: Method, input: &FrameInput<'_>, targets: &Targets) -> bool {
        let unfinished = method == Method::Truth && self.truth_samples < self.budget.truth_limit;
        unfinished || targets.drawn.get(&method) != Some(&self.key(method, input, targets.size))
    }

    fn frame_data(&self, input: &FrameInput<'_>, size: [u32; 2]) -> FrameData {
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
            ..FrameData::of_surface(input.surface, size)
        };
        data.set_fold(&input.fold);
        data
    }

    fn draw_method(
        &mut self,
        encoder: &mut wgpu::CommandEncoder,
        queue: &wgpu::Queue,
        method: Method,
        input: &FrameInput<'_>,
        targets: &mut Targets,
    ) {
        let key = self.key(method, input, targets.size);
        let what = (input.surface.shape.kind, method);
        let Some(target) = targets.of(method, &self.rivals) else { return };
        match (self.lod_range(method), method) {
            (None, _) => self.surface.clear(encoder, target),
            (Some(_), Method::Truth) => {
                if self.truth_samples == 0 {
                    self.surface.clear(encoder, target);
                }
                let next = 1 - targets.latest;
                self.surface.draw(encoder, what, &self.textures, &targets.truth[next], Reads::Mean(target));
                targets.latest = next;
                self.truth_samples += self.samples_due();
            }
            (Some(lods), Method::Rival(rival)) => {
                let Some(picture) = find(&self.rivals, rival) else { return };
                picture.textures.prepare(queue, lods, rival.parameter);
                self.surface.draw(encoder, what, &self.textures, target, Reads::Channels(&picture.textures));
            }
            (Some(_), Method::Vmf | Method::VmfUnaligned) => {
                self.surface.draw(encoder, what, &self.textures, target, Reads::Nothing);
            }
        }
        targets.drawn.insert(method, key);
    }

    /// Samples of the truth that the next frame adds.
    fn samples_due(&self) -> u32 {
        self.budget.truth_batch.min(self.budget.truth_limit.saturating_sub(self.truth_samples))
    }

    fn compare_data(&self, input: &FrameInput<'_>, size: [u32; 2]) -> CompareData {
        let (left, right) = shown(input);
        CompareData {
            left_scale: self.exposure,
            right_scale: self.exposure,
            wipe: (input.wipe * size[0] as f32).round(),
            divider: if left == right { 0.0 } else { 1.0 },
        }
    }
}

/// The methods that are seen, left and right of the wipe.
fn shown(input: &FrameInput<'_>) -> (Method, Method) {
    if input.wipe >= 1.0 {
        (input.left, input.left)
    } else if input.wipe <= 0.0 {
        (input.right, input.right)
    } else {
        (input.left, input.right)
    }
}
