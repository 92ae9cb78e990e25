//! Which light is selected, and its sweep: a turn around the surface that plays until it is stopped.

use serde::{Deserialize, Serialize};

use crate::lighting::Lights;

/// The view of the lights.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct LightView {
    /// The selected light; of a number that there is not, the last.
    pub selected: usize,
    /// How fast the sweep turns it, degrees per second.
    pub sweep_deg_per_s: f32,
    /// True while the sweep plays.
    #[serde(skip)]
    pub is_sweeping: bool,
}

impl Default for LightView {
    fn default() -> Self {
        Self { selected: 0, sweep_deg_per_s: Self::SWEEP_DEG_PER_S, is_sweeping: false }
    }
}

impl LightView {
    /// A turn in twelve seconds.
    pub const SWEEP_DEG_PER_S: f32 = 30.0;

    /// The selected light among `lights`; `None` without lights.
    pub fn index(&self, lights: &Lights) -> Option<usize> {
        lights.as_slice().len().checked_sub(1).map(|last| self.selected.min(last))
    }

    /// Turns the selected light by what the last frame took, and asks for the next frame, while the sweep plays.
    pub fn sweep(&self, lights: &mut Lights, ctx: &egui::Context) {
        let Some(index) = self.index(lights).filter(|_| self.is_sweeping) else { return };
        let light = &mut lights.as_mut_slice()[index];
        let turned = light.azimuth_deg + self.sweep_deg_per_s * ctx.input(|input| input.stable_dt);
        light.azimuth_deg = (turned + 180.0).rem_euclid(360.0) - 180.0;
        ctx.request_repaint();
    }
}
