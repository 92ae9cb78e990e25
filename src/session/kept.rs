//! Finished fits of recent settings, kept while they fit a budget of memory, so that turning a knob back costs nothing.

use std::collections::VecDeque;
use std::sync::Arc;

use crate::export::lobes_exr::FittedLobes;
use crate::filter::vmf::{FitSettings, LobePyramid, MixtureLevel};

/// Memory that may go to fits which are not shown, bytes.
pub const BUDGET: usize = 512 << 20;

/// The fits, the latest used last.
#[derive(Default)]
pub struct KeptFits {
    fits: VecDeque<FittedLobes>,
}

impl KeptFits {
    /// The fit of these settings, which then counts as the latest used.
    pub fn recall(&mut self, settings: &FitSettings) -> Option<FittedLobes> {
        let index = self.fits.iter().position(|fit| fit.settings == *settings)?;
        let fit = self.fits.remove(index)?;
        self.fits.push_back(fit.clone());
        Some(fit)
    }

    /// Keeps a fit; those used longest ago go when `room` bytes do not hold all.
    pub fn keep(&mut self, fit: FittedLobes, room: usize) {
        self.forget(&fit.settings);
        self.fits.push_back(fit);
        while self.bytes() > room && self.fits.pop_front().is_some() {}
    }

    /// Forgets the fit of these settings.
    pub fn forget(&mut self, settings: &FitSettings) {
        self.fits.retain(|fit| fit.settings != *settings);
    }

    /// How many there are.
    pub fn len(&self) -> usize {
        self.fits.len()
    }

    /// True when there is none.
    pub fn is_empty(&self) -> bool {
        self.fits.is_empty()
    }

    /// Memory that they hold.
    pub fn bytes(&self) -> usize {
        self.fits.iter().map(|fit| pyramid_bytes(&fit.lobes)).sum()
    }
}

/// Memory of the lobes, colours and slots of a pyramid; the map is not counted.
fn pyramid_bytes(lobes: &LobePyramid) -> usize {
    let levels: usize = lobes.coarse.iter().flatten().map(level_bytes).sum();
    let colors: usize = lobes.colors.iter().flatten().map(|colors| size_of_val(&colors.stored[..])).sum();
    levels + colors + lobes.base.as_ref().map_or(0, |base| base.slots.len())
}

/// Memory of a level's lobes.
pub fn level_bytes(level: &Arc<MixtureLevel>) -> usize {
    size_of_val(&level.stored[..])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::normal_map::procedural;

    fn fit(lobes: usize) -> FittedLobes {
        let map = Arc::new(procedural::find("waves").expect("bundled").make(16));
        let mut pyramid = LobePyramid::unfitted(map);
        pyramid.coarse[0] = Some(Arc::new(MixtureLevel::empty((8, 8), lobes)));
        FittedLobes {
            lobes: Arc::new(pyramid),
            settings: FitSettings { lobes, ..FitSettings::default() },
            stats: Vec::new(),
        }
    }

    #[test]
    fn the_fit_used_longest_ago_goes_first() {
        let mut kept = KeptFits::default();
        let room = 64 * 16 * (1 + 2 + 3);
        (1..=3).for_each(|lobes| kept.keep(fit(lobes), room));
        assert_eq!((kept.len(), kept.bytes()), (3, room));
        assert!(kept.recall(&fit(1).settings).is_some());
        kept.keep(fit(4), room);
        assert!(kept.recall(&fit(2).settings).is_none() && kept.recall(&fit(3).settings).is_none());
        assert!(kept.recall(&fit(1).settings).is_some() && kept.bytes() <= room);
        kept.keep(fit(16), room);
        assert!(kept.is_empty(), "a fit larger than the room is not kept");
    }
}
