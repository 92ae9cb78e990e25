//! Effective BRDFs over the hemisphere as textures, made anew when the report has others.

use std::sync::Arc;

use egui::{Color32, ColorImage, Context, TextureHandle, TextureId, TextureOptions};

use super::brdf_report::BrdfDiscs;
use crate::color::heat;
use crate::filter::brdf_shape::Disc;

/// The textures of the pictures that were shown last.
#[derive(Default)]
pub struct DiscTextures {
    made: Option<(Arc<BrdfDiscs>, [TextureHandle; 2])>,
}

impl DiscTextures {
    /// The truth's picture, then the method's.
    pub fn get(&mut self, ctx: &Context, discs: &Arc<BrdfDiscs>) -> [TextureId; 2] {
        if let Some((of, textures)) = &self.made
            && Arc::ptr_eq(of, discs)
        {
            return textures.each_ref().map(TextureHandle::id);
        }
        let texture = |disc: &Disc| ctx.load_texture("hemisphere", image(disc, discs.highest), TextureOptions::LINEAR);
        let textures = discs.discs.each_ref().map(texture);
        let ids = textures.each_ref().map(TextureHandle::id);
        self.made = Some((Arc::clone(discs), textures));
        ids
    }
}

/// A disc on the scale from 0 to `highest`, transparent outside.
pub fn image(disc: &Disc, highest: f32) -> ColorImage {
    let color = |&value: &f32| {
        let [r, g, b] = heat(value / highest);
        if value.is_nan() { Color32::TRANSPARENT } else { Color32::from_rgb(r, g, b) }
    };
    ColorImage::new([disc.side; 2], disc.values.iter().map(color).collect())
}
