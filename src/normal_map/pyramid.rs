//! MIP levels and footprints: which base texels a texel of a coarser level covers, and by how much.
//!
//! Level `k` has `max(1, floor(width / 2^k))` by `max(1, floor(height / 2^k))` texels, as GPUs have them. A texel
//! owns its box in texture space; for a size that is no power of two the box cuts base texels, which then count by
//! the area inside. Nothing is dropped or counted twice: over a level the areas sum to the whole map.

use std::str::FromStr;

/// Width and height of every level from the base to the 1x1 top.
pub fn level_sizes(width: usize, height: usize) -> Vec<(usize, usize)> {
    let mut sizes = vec![(width, height)];
    let (mut w, mut h) = (width, height);
    while (w, h) != (1, 1) {
        (w, h) = ((w / 2).max(1), (h / 2).max(1));
        sizes.push((w, h));
    }
    sizes
}

/// A texel's address: MIP level (0 is the base), column from the left, row from the top.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub struct Texel {
    /// MIP level, 0 the base.
    pub level: usize,
    /// Column from the left.
    pub x: usize,
    /// Row from the top.
    pub y: usize,
}

/// Why a texel's address could not be read.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
#[error("'{0}' is not a texel: write LEVEL,X,Y, for example 5,3,11")]
pub struct ParseTexelError(String);

impl FromStr for Texel {
    type Err = ParseTexelError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let fields: Option<Vec<usize>> = text.split(',').map(|field| field.trim().parse().ok()).collect();
        match fields.as_deref() {
            Some(&[level, x, y]) => Ok(Self { level, x, y }),
            _ => Err(ParseTexelError(text.to_owned())),
        }
    }
}

impl std::fmt::Display for Texel {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "{},{},{}", self.level, self.x, self.y)
    }
}

/// The base texels `start..end` along one axis that a box covers; the first and last may count in part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Span {
    /// First base texel touched.
    pub start: usize,
    /// One past the last base texel touched.
    pub end: usize,
    first: f32,
    last: f32,
}

impl Span {
    /// The span of texel `index` out of `count` over `base` base texels.
    pub fn new(base: usize, count: usize, index: usize) -> Self {
        // Exact integers: the box runs from index*base/count to (index+1)*base/count.
        let (from, to) = (index * base, (index + 1) * base);
        let (start, end) = (from / count, to.div_ceil(count));
        let part = |units: usize| units as f32 / count as f32;
        let single = end - start == 1;
        let first = if single { part(to - from) } else { part((start + 1) * count - from) };
        let last = if single { first } else { part(to - (end - 1) * count) };
        Self { start, end, first, last }
    }

    /// Base texels touched.
    pub fn len(&self) -> usize {
        self.end - self.start
    }

    /// Never true: a box always touches a texel.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The length of base texel `index` (in `start..end`) inside the box, in base texels, at most 1.
    pub fn weight(&self, index: usize) -> f32 {
        if index == self.start {
            self.first
        } else if index + 1 == self.end {
            self.last
        } else {
            1.0
        }
    }

    /// True when every base texel counts whole.
    pub fn is_whole(&self) -> bool {
        self.first == 1.0 && self.last == 1.0
    }
}

/// A texel's box over the base level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint {
    /// Base columns covered.
    pub columns: Span,
    /// Base rows covered.
    pub rows: Span,
}

impl Footprint {
    /// The footprint of texel `(x, y)` of a level of size `level` over a base of size `base`.
    pub fn new(base: (usize, usize), level: (usize, usize), (x, y): (usize, usize)) -> Self {
        Self { columns: Span::new(base.0, level.0, x), rows: Span::new(base.1, level.1, y) }
    }

    /// Base texels touched, in whole or in part.
    pub fn len(&self) -> usize {
        self.columns.len() * self.rows.len()
    }

    /// Never true: a footprint always touches a texel.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// True when every base texel counts whole, so all weights are equal.
    pub fn is_whole(&self) -> bool {
        self.columns.is_whole() && self.rows.is_whole()
    }

    /// The area of base texel `(x, y)` inside the box, in base texels.
    pub fn weight(&self, x: usize, y: usize) -> f32 {
        self.columns.weight(x) * self.rows.weight(y)
    }

    /// Every base texel touched as `(x, y, area)`, row by row.
    pub fn texels(&self) -> impl Iterator<Item = (usize, usize, f32)> + '_ {
        (self.rows.start..self.rows.end)
            .flat_map(move |y| (self.columns.start..self.columns.end).map(move |x| (x, y, self.weight(x, y))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn footprints_of_a_level_cover_every_base_texel_exactly_once() {
        for (w, h) in [(5, 3), (1, 7), (10, 6), (37, 1), (8, 8)] {
            let sizes = level_sizes(w, h);
            for &size in &sizes {
                let mut area = vec![0.0_f64; w * h];
                for y in 0..size.1 {
                    for x in 0..size.0 {
                        for (bx, by, weight) in Footprint::new((w, h), size, (x, y)).texels() {
                            area[by * w + bx] += f64::from(weight);
                        }
                    }
                }
                assert!(area.iter().all(|a| (a - 1.0).abs() < 1e-6), "{w}x{h} at {size:?}: {area:?}");
            }
        }
    }

    #[test]
    fn a_texel_reads_as_level_x_y_and_nothing_else() {
        assert_eq!("5,3,11".parse(), Ok(Texel { level: 5, x: 3, y: 11 }));
        assert!("5,3".parse::<Texel>().is_err());
        assert!("5,-3,1".parse::<Texel>().is_err());
    }
}
