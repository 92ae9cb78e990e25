//! A camera that moves away, frame by frame, and what changes in its pictures.
//!
//! A method whose highlights hold still in every single picture may still shimmer from one to the next: Tan et al.
//! (2005, figure 4) show three consecutive frames of a camera zooming out. Here that figure is a number. Each pixel
//! that is covered in two consecutive frames changes by the Euclidean distance of its colours, over the mean length of
//! the truth's colours there, as in the normalised colour error; the mean over pixels, then over pairs of frames, is
//! the temporal change. The truth itself changes, for the surface moves: a method is as steady as it can be where its
//! change is the truth's.

use crate::reference::{Picture, temporal_change};

/// From one frame to the next, a dolly's distance grows by this factor: 24 frames reach four times the first one.
pub const STEP: f32 = 17.0 / 16.0;

/// The distances of a dolly of so many frames, beginning at `distance`.
pub fn distances(distance: f32, frames: usize) -> impl Iterator<Item = f32> {
    std::iter::successors(Some(distance), |distance| Some(distance * STEP)).take(frames)
}

/// The mean change from frame to frame, the truth's frames giving the colours' lengths. `None` of fewer than two
/// frames, or where no pixel is seen in both of any two.
pub fn mean_change(frames: &[Picture], truth: &[Picture]) -> Option<f64> {
    let pairs = frames.windows(2).zip(truth.windows(2));
    let changes = pairs.filter_map(|(frames, truth)| temporal_change([&frames[0], &frames[1]], [&truth[0], &truth[1]]));
    let (sum, count) = changes.fold((0.0, 0_u32), |(sum, count), change| (sum + change, count + 1));
    (count > 0).then(|| sum / f64::from(count))
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    fn frame(grey: f32) -> Picture {
        Picture { size: [2, 1], rgb: vec![Vec3::splat(grey); 2], covered: vec![true, false] }
    }

    #[test]
    fn what_stands_still_changes_by_nothing_and_the_truth_by_what_it_changes() {
        let truth = [frame(1.0), frame(3.0), frame(1.0)];
        assert_eq!(mean_change(&[frame(2.0), frame(2.0), frame(2.0)], &truth), Some(0.0));
        assert_eq!(mean_change(&truth, &truth), Some(1.0));
        assert_eq!(mean_change(&truth[..1], &truth[..1]), None);
    }

    #[test]
    fn twenty_four_frames_reach_four_times_the_distance() {
        let frames: Vec<f32> = distances(3.0, 24).collect();
        assert_eq!((frames.len(), frames[0]), (24, 3.0));
        assert!((frames[23] / 12.0 - 1.0).abs() < 0.01, "{}", frames[23]);
    }
}
