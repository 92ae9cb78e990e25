//! The dolly: a camera that runs away from the surface and back, so that popping and shimmer show.

use crate::scene::Camera;

/// The nearest and the farthest distance of the run.
pub const RANGE: [f32; 2] = [1.5, 24.0];
/// Seconds from one end to the other.
const SECONDS: f32 = 8.0;
/// Longest step in seconds: a window that was not drawn for a while goes on where it stopped.
const LONGEST_STEP: f32 = 0.1;

/// Whether the camera runs, and which way.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Dolly {
    /// True while it runs.
    pub is_playing: bool,
    /// True where it comes back.
    pub comes_back: bool,
}

impl Dolly {
    /// Moves the camera by what the last frame took, and asks for the next frame, while it runs.
    pub fn run(&mut self, camera: &mut Camera, ctx: &egui::Context) {
        if self.is_playing {
            self.step(camera, ctx.input(|input| input.stable_dt));
            ctx.request_repaint();
        }
    }

    /// Moves the camera as far as it runs in `seconds`: by equal ratios in equal times, turning at the ends. A camera
    /// beyond an end turns too.
    fn step(&mut self, camera: &mut Camera, seconds: f32) {
        let [near, far] = RANGE;
        let ratio = (far / near).powf(seconds.min(LONGEST_STEP) / SECONDS);
        camera.dolly(if self.comes_back { ratio.recip() } else { ratio });
        if camera.distance >= far {
            self.comes_back = true;
        } else if camera.distance <= near {
            self.comes_back = false;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_runs_there_and_back_within_its_range() {
        let (mut dolly, mut camera) = (Dolly::default(), Camera { distance: RANGE[0], ..Camera::default() });
        let mut farthest: f32 = 0.0;
        for _ in 0..160 {
            dolly.step(&mut camera, LONGEST_STEP);
            farthest = farthest.max(camera.distance);
        }
        // One step may go over an end: a factor of 1.035.
        assert!((RANGE[1]..1.04 * RANGE[1]).contains(&farthest), "{farthest}");
        assert!((RANGE[0] / 1.04..1.1 * RANGE[0]).contains(&camera.distance), "{}", camera.distance);
    }

    #[test]
    fn a_camera_beyond_an_end_comes_back() {
        let (mut dolly, mut camera) = (Dolly::default(), Camera { distance: 50.0, ..Camera::default() });
        dolly.step(&mut camera, 0.05);
        dolly.step(&mut camera, 0.05);
        dolly.step(&mut camera, 0.05);
        assert!(camera.distance < 50.0);
    }
}
