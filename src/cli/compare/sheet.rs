//! The contact sheet: a block for each cell, the truth first, each picture labelled by its method and figure. Drawn as
//! the window is, for its letters.

use egui::{Align2, Color32, ColorImage, FontId, Pos2, Rect, TextureHandle, TextureOptions, Vec2, pos2, vec2};

use super::table::figure;
use crate::gpu::Gpu;
use crate::headless::{Canvas, Screenshot};
use crate::measure::{Cell, Shown};

/// A cell with its pictures: the truth's, then each method's; none where they are not wanted.
#[derive(Debug)]
pub struct Row {
    /// The figures.
    pub cell: Cell,
    /// The pictures.
    pub pictures: Vec<Shown>,
}

/// Pixels between pictures and around them.
const GAP: f32 = 8.0;
/// Height of a row's title, and of the line under a picture.
const LINE: f32 = 20.0;
/// Height of the letters.
const LETTERS: f32 = 13.0;
/// Behind everything.
const BACKGROUND: Color32 = Color32::from_gray(24);
/// The letters' colour.
const INK: Color32 = Color32::from_gray(230);
/// Most pictures side by side: a cell's others go on below.
const MOST_COLUMNS: usize = 5;
/// Narrowest picture that is still worth drawing.
const LEAST_WIDTH: f32 = 16.0;

/// How the pictures are laid out: all of one size.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Layout {
    columns: usize,
    rows: usize,
    picture: Vec2,
}

impl Layout {
    /// Pictures of `size` pixels, made smaller where the sheet would have a side beyond `limit`; `None` where nothing
    /// would be left of them.
    fn new(columns: usize, rows: usize, size: [u32; 2], limit: f32) -> Option<Self> {
        let whole = Self { columns, rows, picture: vec2(size[0] as f32, size[1] as f32) };
        let around = Self { picture: Vec2::ZERO, ..whole }.sheet();
        let room = (Vec2::splat(limit) - around) / (whole.sheet() - around);
        let picture = (whole.picture * room.min_elem().min(1.0)).floor();
        (picture.min_elem() >= 1.0 && picture.x >= LEAST_WIDTH.min(whole.picture.x))
            .then_some(Self { picture, ..whole })
    }

    /// The sheet's size.
    fn sheet(self) -> Vec2 {
        Vec2::splat(GAP) + vec2(self.columns as f32, self.rows as f32) * self.cell()
    }

    /// From one picture to the next across, and from one row to the next.
    fn cell(self) -> Vec2 {
        vec2(self.picture.x + GAP, self.picture.y + 2.0 * LINE + GAP)
    }

    /// Top left of a picture with its lines, by its place in a block of so many rows; a block's title goes to the first.
    fn corner(self, index: usize, block: usize, rows: usize) -> Pos2 {
        let (column, row) = (index % self.columns, block * rows + index / self.columns);
        pos2(GAP, GAP) + vec2(column as f32, row as f32) * self.cell()
    }
}

/// Draws the sheet of everything that was measured.
///
/// # Errors
/// One sentence that says what is too large, or that the adapter failed.
pub fn draw(gpu: &Gpu, measured: &[Row]) -> anyhow::Result<Screenshot> {
    let most = measured.iter().map(|row| row.pictures.len()).max().unwrap_or(0);
    let columns = most.clamp(1, MOST_COLUMNS);
    let rows = most.div_ceil(columns);
    let size = measured.iter().flat_map(|row| &row.pictures).next().map_or([1, 1], |picture| picture.size);
    let limit = gpu.device.limits().max_texture_dimension_2d as f32;
    let layout = Layout::new(columns, measured.len() * rows, size, limit).ok_or_else(|| {
        anyhow::anyhow!("A sheet of {} by {columns} pictures is too large: compare fewer.", measured.len() * rows)
    })?;
    let sheet = layout.sheet();
    let mut canvas = Canvas::new(gpu, [sheet.x as u32, sheet.y as u32]);
    let mut textures = Vec::new();
    // Letters are laid out in the first pass and stand in the second.
    for _ in 0..2 {
        canvas.pass(Vec::new(), |ui| {
            if textures.is_empty() {
                textures = measured.iter().map(|row| row.pictures.iter().map(|p| texture(ui, p)).collect()).collect();
            }
            paint(ui.painter(), layout, rows, measured, &textures);
        })?;
    }
    Ok(canvas.picture()?)
}

fn texture(ui: &egui::Ui, picture: &Shown) -> TextureHandle {
    let image = ColorImage::from_rgb(picture.size.map(|side| side as usize), &picture.rgb);
    ui.ctx().load_texture("picture", image, TextureOptions::LINEAR)
}

fn paint(painter: &egui::Painter, layout: Layout, rows: usize, measured: &[Row], textures: &[Vec<TextureHandle>]) {
    painter.rect_filled(Rect::EVERYTHING, 0.0, BACKGROUND);
    for (block, (measured, textures)) in measured.iter().zip(textures).enumerate() {
        let cell = &measured.cell;
        write(painter, layout.corner(0, block, rows), &cell.title());
        let standard_error = figure(cell.reference.standard_error);
        let methods = cell.methods.iter().map(|found| (&found.method[..], figure(found.normalised_color_error)));
        let labels = std::iter::once(("truth, standard error", standard_error)).chain(methods);
        for (index, (texture, (name, figure))) in textures.iter().zip(labels).enumerate() {
            let place = Rect::from_min_size(layout.corner(index, block, rows) + vec2(0.0, LINE), layout.picture);
            let whole = Rect::from_min_max(Pos2::ZERO, pos2(1.0, 1.0));
            painter.image(texture.id(), place, whole, Color32::WHITE);
            let clipped = painter.with_clip_rect(Rect::from_min_size(place.left_bottom(), vec2(place.width(), LINE)));
            write(&clipped, place.left_bottom(), &format!("{name} {figure}"));
        }
    }
}

fn write(painter: &egui::Painter, corner: Pos2, text: &str) {
    let middle = corner + vec2(0.0, LINE / 2.0);
    painter.text(middle, Align2::LEFT_CENTER, text, FontId::proportional(LETTERS), INK);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_sheet_holds_its_pictures_and_shrinks_them_to_fit() {
        let roomy = Layout::new(3, 2, [100, 50], 8192.0).expect("fits");
        assert_eq!(roomy.picture, vec2(100.0, 50.0));
        assert_eq!(roomy.sheet(), vec2(8.0 + 3.0 * 108.0, 8.0 + 2.0 * 98.0));
        let tight = Layout::new(9, 2, [960, 600], 4096.0).expect("fits");
        assert!(tight.sheet().max_elem() <= 4096.0 && tight.picture.x > 400.0, "{tight:?}");
        assert_eq!(Layout::new(9, 1000, [960, 600], 4096.0), None);
    }
}
