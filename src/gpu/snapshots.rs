//! The pictures that figures are worked out from: of the methods and of the truth, read back without waiting.
//!
//! The truth is read back at stops: at 64 samples per pixel, whenever their number has doubled, and at its end. Its
//! picture at the stop before tells how sure it is of itself. Once it is there, the methods' pictures are read back too,
//! once for every time that they are drawn.

use std::sync::Arc;

use super::method_picture::{Key, MethodPicture};
use super::picture_readback::PictureReadback;
use crate::filter::Method;

/// Samples per pixel at the first stop: fewer say little.
const FIRST_STOP: u32 = 64;

/// The stop that follows `samples`, at most `limit`.
pub fn next_stop(samples: u32, limit: u32) -> u32 {
    (samples + 1).next_power_of_two().max(FIRST_STOP).min(limit)
}

/// True where so many samples are a stop of a truth that ends at `limit`.
fn is_stop(samples: u32, limit: u32) -> bool {
    samples >= limit || samples >= FIRST_STOP && samples.is_power_of_two()
}

/// One picture, on its way or here.
#[derive(Clone, Debug)]
pub struct Snapshot {
    /// Whose.
    pub method: Method,
    /// Samples per pixel, of the truth.
    pub samples: u32,
    /// The picture.
    pub readback: Arc<PictureReadback>,
    drawn: Key,
}

impl PartialEq for Snapshot {
    fn eq(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.readback, &other.readback)
    }
}

impl Snapshot {
    fn record(
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        picture: &MethodPicture,
        samples: u32,
    ) -> Option<Self> {
        let readback = PictureReadback::record(device, encoder, &picture.target.color)?;
        Some(Self { method: picture.method, samples, readback: Arc::new(readback), drawn: picture.drawn.clone()? })
    }

    /// True while the picture is drawn from the same and as large.
    fn is_of(&self, picture: &MethodPicture) -> bool {
        let size = [picture.target.color.width(), picture.target.color.height()];
        self.method == picture.method && picture.drawn.as_ref() == Some(&self.drawn) && size == self.readback.size()
    }
}

/// The latest pictures of what is drawn at present.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapshots {
    /// The truth at the last stop.
    pub truth: Option<Snapshot>,
    /// The truth at a stop before, with half as many samples or so.
    pub earlier_truth: Option<Snapshot>,
    /// The methods beside the truth.
    pub methods: Vec<Snapshot>,
}

impl Snapshots {
    /// Forgets what is drawn no longer, and records with `encoder` the copies of what is due; `samples` of `limit` are
    /// in the truth.
    pub fn update(
        &mut self,
        device: &wgpu::Device,
        encoder: &mut wgpu::CommandEncoder,
        pictures: &[MethodPicture],
        [samples, limit]: [u32; 2],
    ) {
        self.forget_stale(pictures, samples);
        let truth = pictures.iter().find(|picture| picture.method == Method::Truth);
        if let Some(truth) = truth.filter(|_| is_stop(samples, limit) && self.samples() != Some(samples)) {
            self.take_truth(Snapshot::record(device, encoder, truth, samples));
        }
        if self.truth.is_none() {
            return;
        }
        for picture in pictures.iter().filter(|picture| picture.method != Method::Truth) {
            if self.methods.iter().all(|held| held.method != picture.method) {
                self.methods.extend(Snapshot::record(device, encoder, picture, 0));
            }
        }
    }

    /// Samples per pixel of the truth at the last stop.
    pub fn samples(&self) -> Option<u32> {
        self.truth.as_ref().map(|truth| truth.samples)
    }

    /// True once every picture is here.
    pub fn are_ready(&self) -> bool {
        let mut all = self.truth.iter().chain(&self.earlier_truth).chain(&self.methods);
        all.all(|snapshot| snapshot.readback.is_ready())
    }

    fn forget_stale(&mut self, pictures: &[MethodPicture], samples: u32) {
        let is_drawn = |held: &Snapshot| pictures.iter().any(|picture| held.is_of(picture)) && held.samples <= samples;
        self.truth.take_if(|held| !is_drawn(held));
        self.earlier_truth.take_if(|held| !is_drawn(held));
        self.methods.retain(is_drawn);
    }

    fn take_truth(&mut self, taken: Option<Snapshot>) {
        let Some(taken) = taken else { return };
        if let Some(before) = self.truth.replace(taken.clone())
            && (self.earlier_truth.is_none() || 2 * before.samples <= taken.samples)
        {
            self.earlier_truth = Some(before);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stops_double_and_the_last_is_the_end() {
        let stops = |limit| {
            let more = move |&samples: &u32| (samples < limit).then(|| next_stop(samples, limit));
            std::iter::successors(Some(0), more).skip(1).collect::<Vec<u32>>()
        };
        assert_eq!(stops(16), [16]);
        assert_eq!(stops(300), [64, 128, 256, 300]);
        assert_eq!(stops(4096), [64, 128, 256, 512, 1024, 2048, 4096]);
        assert!(stops(300).into_iter().all(|samples| is_stop(samples, 300)));
        assert!(![0, 32, 65, 299].into_iter().any(|samples| is_stop(samples, 300)));
    }
}
