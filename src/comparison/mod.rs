//! Which methods are seen, and how they stand beside each other: at a wipe, in turns, as their difference, or in a
//! grid. One camera, one light and one exposure serve all of them.

pub mod arrangement;
pub mod difference;
pub mod view;

use std::sync::Arc;

use serde::{Deserialize, Deserializer, Serialize};

use crate::filter::channels::ChannelPyramid;
use crate::filter::{Method, Rival, gmm, harmonics, lean, plain_mip, toksvig};
pub use arrangement::Arrangement;
pub use difference::{Difference, DifferenceKind};
pub use view::View;

/// The most methods seen at once.
pub const MOST_METHODS: usize = 9;

/// What is compared on the lit surface.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Comparison {
    /// The left one of two methods: left of the wipe, first in turns, what the difference is taken from.
    pub left: Method,
    /// The right one of two methods.
    pub right: Method,
    /// Where the wipe stands, `0..=1` from the left; 0 shows only the right method.
    pub wipe: f32,
    /// How methods stand beside each other.
    pub view: View,
    /// The scale of the difference.
    pub difference: Difference,
    /// The methods of a grid, row by row from the top; a grid of four shows the first four.
    #[serde(deserialize_with = "read_grid")]
    pub grid: [Method; MOST_METHODS],
}

impl Default for Comparison {
    fn default() -> Self {
        Self {
            left: Method::Truth,
            right: Method::Vmf,
            wipe: 0.5,
            view: View::default(),
            difference: Difference::default(),
            grid: DEFAULT_GRID,
        }
    }
}

/// The truth, the lobes and the two rivals that are known best come first: they are a grid of four.
const DEFAULT_GRID: [Method; MOST_METHODS] = [
    Method::Truth,
    Method::MIP,
    Method::Rival(Rival::plain(&toksvig::KIND)),
    Method::Vmf,
    Method::Rival(Rival::plain(&lean::KIND)),
    Method::Rival(Rival { kind: &gmm::KIND, parameter: 4 }),
    Method::Rival(Rival { kind: &harmonics::KIND, parameter: 7 }),
    Method::VmfUnaligned,
    Method::Rival(Rival::plain(&plain_mip::UNNORMALISED)),
];

/// As many methods as the file names, and the usual ones for the rest.
fn read_grid<'de, D: Deserializer<'de>>(reader: D) -> Result<[Method; MOST_METHODS], D::Error> {
    let named = Vec::<Method>::deserialize(reader)?;
    let mut grid = DEFAULT_GRID;
    grid.iter_mut().zip(named).for_each(|(method, named)| *method = named);
    Ok(grid)
}

impl Comparison {
    /// One method over the whole picture.
    pub fn alone(method: Method) -> Self {
        Self { left: method, right: method, ..Self::default() }
    }

    /// The methods of the view, in the order of its cells: two, or as many as the grid has.
    pub fn methods(&self) -> Vec<Method> {
        match self.view.grid_side() {
            Some(side) => self.grid[..side * side].to_vec(),
            None => vec![self.left, self.right],
        }
    }

    /// The methods that are in sight, of which some may be the same.
    pub fn methods_seen(&self) -> Vec<Method> {
        let arrangement = self.arrangement(false);
        let methods = self.methods().into_iter().enumerate();
        methods.filter_map(|(index, method)| arrangement.shows(index).then_some(method)).collect()
    }

    /// How the methods are arranged in the picture; `flipped` shows the right one of two over all of it.
    pub fn arrangement(&self, flipped: bool) -> Arrangement {
        match (self.view, self.view.grid_side()) {
            (_, Some(side)) => Arrangement::Grid { side },
            (View::Flip, _) => Arrangement::Flip { to_right: flipped },
            _ if flipped => Arrangement::Flip { to_right: true },
            (View::Difference, _) => Arrangement::Difference(self.difference),
            _ => Arrangement::Wipe(self.wipe),
        }
    }
}

/// A method to be drawn, and what it needs beside the mean normals and the lobes.
#[derive(Clone, Debug)]
pub struct ShownMethod {
    /// The method.
    pub method: Method,
    /// Its channels, where it is a rival that has some and they are built.
    pub channels: Option<Arc<ChannelPyramid>>,
}

impl From<Method> for ShownMethod {
    fn from(method: Method) -> Self {
        Self { method, channels: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_comparison_reads_as_it_is_written() {
        for (view, _) in View::ALL {
            let mut comparison = Comparison { view, wipe: 0.25, ..Comparison::default() };
            comparison.grid.swap(0, 8);
            comparison.difference = Difference { kind: DifferenceKind::Signed, range: 0.5 };
            let json = serde_json::to_string(&comparison).expect("serialises");
            assert_eq!(serde_json::from_str::<Comparison>(&json).expect("reads"), comparison);
        }
    }

    #[test]
    fn a_comparison_of_the_first_versions_is_a_wipe_and_a_short_grid_is_filled_up() {
        let old = r#"{"left": "mip", "right": "vmf", "wipe": 0.3}"#;
        let read: Comparison = serde_json::from_str(old).expect("reads");
        assert_eq!(read, Comparison { left: Method::MIP, wipe: 0.3, ..Comparison::default() });
        let short: Comparison = serde_json::from_str(r#"{"grid": ["vmf"]}"#).expect("reads");
        assert_eq!((short.grid[0], &short.grid[1..]), (Method::Vmf, &DEFAULT_GRID[1..]));
    }

    #[test]
    fn what_is_no_view_is_told_which_there_are() {
        let error = serde_json::from_str::<Comparison>(r#"{"view": "onion"}"#).expect_err("no view").to_string();
        assert!(error.contains("'onion' is not a view") && error.contains("grid-2x2"), "{error}");
    }

    #[test]
    fn two_methods_are_flipped_whatever_their_view_and_a_grid_is_not() {
        for (view, _) in View::ALL {
            let comparison = Comparison { view, ..Comparison::default() };
            let flipped = comparison.arrangement(true);
            match view.grid_side() {
                Some(side) => assert_eq!(flipped, Arrangement::Grid { side }),
                None => assert_eq!(flipped, Arrangement::Flip { to_right: true }),
            }
        }
    }

    #[test]
    fn what_the_wipe_covers_is_not_seen() {
        let seen = |wipe| Comparison { wipe, ..Comparison::default() }.methods_seen();
        assert_eq!(seen(0.5), [Method::Truth, Method::Vmf]);
        assert_eq!((seen(0.0), seen(1.0)), (vec![Method::Vmf], vec![Method::Truth]));
    }
}
