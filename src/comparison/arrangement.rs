//! Where in the picture each method is seen.

use super::Difference;

/// How the methods of a frame share its picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Arrangement {
    /// The first method left of a line, the second right of it. The line stands at this part of the width, `0..=1`:
    /// 0 shows the second method only, 1 the first.
    Wipe(f32),
    /// One of two methods over the whole picture; the other is kept at hand.
    Flip {
        /// True for the second.
        to_right: bool,
    },
    /// What the second of two methods differs by from the first.
    Difference(Difference),
    /// Each method in a cell of its own, row by row from the top; one cell shows one method alone.
    Grid {
        /// Cells along each side.
        side: usize,
    },
}

impl Arrangement {
    /// True where the method with this index is seen, or must be at hand at once.
    pub fn shows(self, index: usize) -> bool {
        match self {
            Self::Flip { .. } => index < 2,
            Self::Grid { side } => index < side * side,
            Self::Wipe(_) | Self::Difference(_) => self.methods_in(0).contains(&index),
        }
    }

    /// The indices of the methods in a cell, left and right of its line; twice the same where there is no line.
    pub fn methods_in(self, cell: usize) -> [usize; 2] {
        match self {
            Self::Wipe(at) if at <= 0.0 => [1, 1],
            Self::Wipe(at) if at >= 1.0 => [0, 0],
            Self::Wipe(_) | Self::Difference(_) => [0, 1],
            Self::Flip { to_right } => [usize::from(to_right); 2],
            Self::Grid { .. } => [cell; 2],
        }
    }

    /// Cells along each side of the picture.
    pub fn side(self) -> usize {
        match self {
            Self::Grid { side } => side,
            Self::Wipe(_) | Self::Flip { .. } | Self::Difference(_) => 1,
        }
    }

    /// The size of every cell of a picture of `size`, in pixels. Where the sides do not divide evenly, the last cells
    /// reach past the picture's edge, and all are as large.
    pub fn cell_size(self, size: [u32; 2]) -> [u32; 2] {
        size.map(|pixels| pixels.div_ceil(self.side() as u32).max(1))
    }

    /// The top left pixel of each cell of a picture of `size`, row by row.
    pub fn cell_origins(self, size: [u32; 2]) -> impl Iterator<Item = [u32; 2]> {
        let ([width, height], side) = (self.cell_size(size), self.side() as u32);
        (0..side * side).map(move |index| [index % side * width, index / side * height])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_cover_the_picture_without_a_gap() {
        for side in [2, 3] {
            let (arrangement, size) = (Arrangement::Grid { side }, [101, 64]);
            let [width, height] = arrangement.cell_size(size);
            let origins: Vec<_> = arrangement.cell_origins(size).collect();
            assert_eq!(origins.len(), side * side);
            for y in 0..size[1] {
                for x in 0..size[0] {
                    let holds = |[left, top]: &[u32; 2]| {
                        (*left..left + width).contains(&x) && (*top..top + height).contains(&y)
                    };
                    assert_eq!(origins.iter().filter(|origin| holds(origin)).count(), 1, "({x}, {y})");
                }
            }
        }
    }

    #[test]
    fn two_methods_share_one_cell() {
        let origins: Vec<_> = Arrangement::Wipe(0.5).cell_origins([100, 50]).collect();
        assert_eq!((origins, Arrangement::Wipe(0.5).cell_size([100, 50])), (vec![[0, 0]], [100, 50]));
    }
}
