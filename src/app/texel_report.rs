//! What the selected texel holds: its NDF as a picture, its lobes, and the figures beside them.
//!
//! Gathered once per change of what it depends on: at once for a small footprint, in a job for a large one.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use crate::filter::vmf::{Fold, LobePyramid, fold};
use crate::jobs::{Job, JobEvent, Wake};
use crate::ndf::Ndf;
use crate::normal_map::NormalMap;
use crate::normal_map::pyramid::Texel;
use crate::reference::NdfPicture;
use crate::session::Session;
use crate::sphere::Mixture;
use crate::sphere::mixture::{EMPTY_WEIGHT, MAX_LOBES};

/// Footprints up to this many base texels are gathered between two frames.
const AT_ONCE: usize = 1 << 17;

/// The data of a texel, independent of any fit.
#[derive(Clone, Debug)]
pub struct TexelData {
    /// Which texel.
    pub texel: Texel,
    /// Its normals, ready to be drawn.
    pub picture: NdfPicture,
    /// Valid base texels that the footprint touches.
    pub normals: usize,
    /// Length of the mean normal.
    pub mean_length: f64,
}

/// What the lobes make of it.
#[derive(Clone, Debug)]
pub struct TexelFit {
    /// Slot and lobe; empty while the level is not fitted.
    pub mixture: Mixture,
    /// The lobes' colours y, linear RGB, in the order of the mixture; `None` for a map without colour and while they
    /// are not fitted.
    pub colors: Option<Vec<Vec3>>,
    /// Weighted mean over the normals of the natural log of the mixture's density.
    pub mean_log_likelihood: f64,
}

/// The report on the selected texel, kept up to date by [`TexelReport::update`].
#[derive(Default)]
pub struct TexelReport {
    data: Option<Arc<TexelData>>,
    data_key: Option<(u64, Texel)>,
    data_revision: u64,
    fit: Option<TexelFit>,
    fit_key: Option<FitKey>,
    job: Option<Job<TexelData>>,
}

#[derive(Clone, Copy, Debug, PartialEq)]
struct FitKey {
    data_revision: u64,
    lobes_revision: u64,
    texel: Texel,
}

impl TexelReport {
    /// The selected texel's data; an earlier texel's while a large footprint is gathered, `None` at the start.
    pub fn data(&self) -> Option<&Arc<TexelData>> {
        self.data.as_ref()
    }

    /// Grows whenever the data change.
    pub fn data_revision(&self) -> u64 {
        self.data_revision
    }

    /// What the lobes make of it; `None` while its level is not fitted.
    pub fn fit(&self) -> Option<&TexelFit> {
        self.fit.as_ref()
    }

    /// True while a large footprint is gathered in the background.
    pub fn is_gathering(&self) -> bool {
        self.job.is_some()
    }

    /// Follows the session. Call once per frame.
    pub fn update(&mut self, session: &Session, wake: &Wake) {
        let key = (session.map_revision(), session.selected());
        if self.data_key != Some(key) {
            self.data_key = Some(key);
            self.gather(Arc::clone(session.map()), key.1, wake);
        }
        self.poll();
        self.update_fit(session);
    }

    fn gather(&mut self, map: Arc<NormalMap>, texel: Texel, wake: &Wake) {
        self.job = None;
        let (width, height) = map.level_sizes()[texel.level];
        if map.len() / (width * height) <= AT_ONCE {
            self.take(gather(&map, texel));
            return;
        }
        let work = move |outbox: &crate::jobs::Outbox<TexelData>| outbox.send(gather(&map, texel));
        match Job::spawn("gather-ndf", Arc::clone(wake), work) {
            Ok(job) => self.job = Some(job),
            Err(error) => log::warn!("the texel's normals cannot be gathered: {error}"),
        }
    }

    fn poll(&mut self) {
        match self.job.as_ref().and_then(Job::next) {
            Some(JobEvent::News(data)) => self.take(data),
            Some(JobEvent::Panicked(text)) => log::warn!("the texel's normals were not gathered: {text}"),
            None => return,
        }
        self.job = None;
    }

    fn take(&mut self, data: TexelData) {
        self.data = Some(Arc::new(data));
        self.data_revision += 1;
    }

    fn update_fit(&mut self, session: &Session) {
        let Some(data) = self.data.clone() else { return };
        let key = FitKey {
            data_revision: self.data_revision,
            lobes_revision: session.fitting().revision(),
            texel: data.texel,
        };
        if self.fit_key == Some(key) || self.job.is_some() {
            return;
        }
        self.fit_key = Some(key);
        let (lobes, fold) = (session.lobes(), session.fitting().fold());
        // A texel fitted ahead of its level has no colours yet.
        let ahead = session.fitting().first(data.texel).map(|stored| (Mixture::from_stored(stored), None));
        let shown = || {
            let mixture = fold::mixture(lobes, fold, data.texel)?;
            let colors = folded_colors(lobes, fold, data.texel, &mixture);
            Some((mixture, colors))
        };
        self.fit = ahead.or_else(shown).map(|(mixture, colors)| TexelFit {
            colors,
            mean_log_likelihood: mean_log_likelihood(session.map(), &data, &mixture),
            mixture,
        });
    }
}

fn gather(map: &NormalMap, texel: Texel) -> TexelData {
    let ndf = Ndf::of_texel(map, texel);
    TexelData { texel, picture: NdfPicture::new(ndf.samples()), normals: ndf.len(), mean_length: ndf.mean().length() }
}

/// The colours of that mixture's lobes: of slots that are merged, the mean by weight.
fn folded_colors(lobes: &LobePyramid, fold: Fold, texel: Texel, mixture: &Mixture) -> Option<Vec<Vec3>> {
    let slots: Vec<(usize, f32)> = if texel.level == 0 {
        vec![(lobes.base_slot(texel.y * lobes.map.width + texel.x), 1.0)]
    } else {
        let stored = lobes.level(texel.level)?.texel(texel.x, texel.y);
        stored.iter().map(|stored| stored[0]).enumerate().filter(|&(_, weight)| weight > EMPTY_WEIGHT).collect()
    };
    let mut sums = [(0.0, Vec3::ZERO); MAX_LOBES];
    for (slot, weight) in slots {
        let (total, sum) = &mut sums[usize::from(fold.0[slot])];
        *total += weight;
        *sum += weight * lobes.lobe_color(texel, slot)?;
    }
    Some(mixture.lobes.iter().map(|&(slot, _)| sums[slot].1 / sums[slot].0).collect())
}

/// Over every normal of a small footprint; over the picture's points, which stand for them, of a large one.
fn mean_log_likelihood(map: &NormalMap, data: &TexelData, mixture: &Mixture) -> f64 {
    let log_density = |normal: DVec3| mixture.density(normal).max(f64::MIN_POSITIVE).ln();
    if data.normals <= AT_ONCE {
        return Ndf::of_texel(map, data.texel).expectation(log_density);
    }
    data.picture.points.iter().map(|&(normal, weight)| weight * log_density(normal)).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::vmf::{ColorLevel, MixtureLevel};
    use crate::normal_map::albedo::Albedo;
    use crate::normal_map::{MapOptions, MapSource};

    #[test]
    fn merged_slots_take_the_mean_colour_by_weight() {
        let normals = [vec![0.0; 4], vec![0.0; 4], vec![1.0; 4]];
        let source = MapSource::Bundled("test");
        let mut map = NormalMap::from_unit_normals((2, 2), normals, source, MapOptions::default());
        map.albedo = Some(Arc::new(Albedo { rgb: vec![[0.5, 0.25, 1.0]; 4] }));
        let mut lobes = LobePyramid::unfitted(Arc::new(map));
        let stored = vec![[0.25, 0.0, 0.0, 0.2], [0.0; 4], [0.75, 0.0, 0.0, 0.7]];
        lobes.coarse[0] = Some(Arc::new(MixtureLevel { width: 1, height: 1, lobes: 3, stored }));
        let top = Texel { level: 1, x: 0, y: 0 };
        let colors = |lobes: &LobePyramid, fold, texel| {
            folded_colors(lobes, fold, texel, &fold::mixture(lobes, fold, texel).expect("fitted"))
        };
        assert_eq!(colors(&lobes, Fold::default(), top), None, "not fitted yet");
        let red_and_blue = vec![[0.25, 0.0, 0.0], [0.0; 3], [0.0, 0.0, 0.75]];
        lobes.colors[0] = Some(Arc::new(ColorLevel { stored: red_and_blue }));
        assert_eq!(colors(&lobes, Fold::default(), top), Some(vec![Vec3::X, Vec3::Z]));
        assert_eq!(colors(&lobes, Fold([0; 16]), top), Some(vec![Vec3::new(0.25, 0.0, 0.75)]));
        let base = Texel { level: 0, x: 1, y: 1 };
        assert_eq!(colors(&lobes, Fold::default(), base), Some(vec![Vec3::new(0.5, 0.25, 1.0)]));
    }
}
