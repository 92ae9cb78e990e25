//! Where the cells of an arrangement lie in the window.

use egui::{Pos2, Rect, Vec2, vec2};

use crate::comparison::Arrangement;

/// The cells of a picture: one, or as many as the grid has.
#[derive(Clone, Copy, Debug)]
pub struct Cells {
    /// How methods share the picture.
    pub arrangement: Arrangement,
    /// The picture, in points.
    pub picture: Rect,
    /// The picture, in pixels.
    pub size: [u32; 2],
}

impl Cells {
    /// The cells of a picture in this rectangle.
    pub fn new(arrangement: Arrangement, picture: Rect, px_per_point: f32) -> Self {
        let size = (picture.size() * px_per_point).round().max(Vec2::splat(1.0));
        Self { arrangement, picture, size: [size.x as u32, size.y as u32] }
    }

    /// Pixels of a cell, across and down.
    pub fn cell_size(&self) -> [u32; 2] {
        self.arrangement.cell_size(self.size)
    }

    /// Where each cell lies, row by row; the last ones may reach past the picture's edge.
    pub fn rects(&self) -> impl Iterator<Item = Rect> {
        let cell = self.cell_size();
        let cells = *self;
        self.arrangement
            .cell_origins(self.size)
            .map(move |origin| Rect::from_min_size(cells.picture.min + cells.points(origin), cells.points(cell)))
    }

    /// The cell under a position.
    pub fn at(&self, position: Pos2) -> Option<Rect> {
        self.rects().find(|cell| cell.contains(position)).filter(|_| self.picture.contains(position))
    }

    /// The pixel of `cell` at a position in it.
    pub fn pixel(&self, cell: Rect, position: Pos2) -> [u32; 2] {
        let (inside, size) = ((position - cell.min) / cell.size(), self.cell_size());
        [inside.x * size[0] as f32, inside.y * size[1] as f32].map(|v| v.max(0.0) as u32)
    }

    fn points(&self, pixels: [u32; 2]) -> Vec2 {
        let relative = vec2(pixels[0] as f32 / self.size[0] as f32, pixels[1] as f32 / self.size[1] as f32);
        relative * self.picture.size()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use egui::pos2;

    #[test]
    fn the_same_place_in_every_cell_is_the_same_pixel() {
        let picture = Rect::from_min_size(pos2(100.0, 40.0), vec2(301.0, 200.0));
        let cells = Cells::new(Arrangement::Grid { side: 3 }, picture, 2.0);
        assert_eq!((cells.size, cells.cell_size()), ([602, 400], [201, 134]));
        let rects: Vec<Rect> = cells.rects().collect();
        for rect in &rects {
            let position = rect.min + vec2(30.25, 10.25);
            assert_eq!(cells.at(position), Some(*rect));
            assert_eq!(cells.pixel(*rect, position), [60, 20]);
        }
        assert_eq!((rects.len(), cells.at(pos2(99.0, 100.0))), (9, None));
        assert_eq!(cells.at(pos2(402.0, 100.0)), None, "past the picture's edge, though the last cell reaches there");
    }
}
