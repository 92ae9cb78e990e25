//! The drying of the material: which track, where on it, and whether it plays.

use serde::{Deserialize, Serialize};

use crate::brdf::Material;
use crate::brdf::drying::Drying;

/// The view of the drying.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct DryingView {
    /// The track.
    pub track: Drying,
    /// The time on it, 0 wet to 1 dry.
    pub time: f32,
    /// Whether its controls are shown.
    pub is_shown: bool,
    /// True while it plays.
    #[serde(skip)]
    pub is_playing: bool,
}

impl DryingView {
    /// From wet to dry.
    const SECONDS: f32 = 8.0;

    /// Starts from the beginning where the end was reached.
    pub fn start(&mut self) {
        self.is_playing = true;
        if self.time >= 1.0 {
            self.time = 0.0;
        }
    }

    /// Moves on by what the last frame took, and asks for the next frame, while it plays.
    pub fn play(&mut self, material: &mut Material, ctx: &egui::Context) {
        if !self.is_playing {
            return;
        }
        self.time = (self.time + ctx.input(|input| input.stable_dt) / Self::SECONDS).min(1.0);
        material.set_moment(self.track.at(self.time));
        self.is_playing = self.time < 1.0;
        ctx.request_repaint();
    }
}
