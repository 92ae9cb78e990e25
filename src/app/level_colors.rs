//! The colours of a level's texels, each worked out when it is first seen: a view that is dragged or zoomed asks for most
//! of them again.

use egui::Color32;

use super::map_picture::PictureKey;
use super::texel_values::TexelValues;
use crate::normal_map::pyramid::Texel;

/// The colours of one level.
#[derive(Clone, Debug)]
pub struct LevelColors {
    key: PictureKey,
    level: usize,
    width: usize,
    /// Row by row; transparent while nobody has asked.
    colors: Vec<Color32>,
}

impl LevelColors {
    /// None worked out yet.
    pub fn new(values: &TexelValues<'_>, level: usize) -> Self {
        let (width, height) = values.session().map().level_size(level);
        let colors = vec![Color32::TRANSPARENT; width * height];
        Self { key: PictureKey::new(values, level), level, width, colors }
    }

    /// True while they are still those of `values`.
    pub fn are_of(&self, values: &TexelValues<'_>) -> bool {
        self.key == PictureKey::new(values, self.level)
    }

    /// The colour of a texel, by the values that they are of.
    pub fn get(&mut self, values: &TexelValues<'_>, x: usize, y: usize) -> Color32 {
        let color = &mut self.colors[y * self.width + x];
        if *color == Color32::TRANSPARENT {
            *color = values.color(Texel { level: self.level, x, y });
        }
        *color
    }
}
