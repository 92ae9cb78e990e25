//! One texel's own fit before all others: whoever turns a knob looks at the selected texel first.
//!
//! Only the texels under it are fitted, level by level as the whole map will be, so the lobes are those that its own
//! fit comes to.

use std::sync::Arc;

use rayon::prelude::*;

use super::fit::FitSettings;
use super::monitor::Monitor;
use super::pyramid::{LobePyramid, MixtureLevel, turn};
use super::unaligned;
use crate::normal_map::NormalMap;
use crate::normal_map::pose::Pose;
use crate::normal_map::pyramid::{Footprint, Span, Texel};
use crate::sphere::StoredLobe;

/// The largest footprint, base texels, that is fitted ahead: a tenth of a second's work.
const MOST_NORMALS: usize = 1 << 14;

/// The texel's own lobes; `None` for a base texel and for one that would take long. The map is in `pose`, texel and lobes
/// are as it lies.
pub fn fit(map: &Arc<NormalMap>, pose: Pose, texel: Texel, settings: &FitSettings) -> Option<Vec<StoredLobe>> {
    let sizes = map.level_sizes();
    let size = *sizes.get(texel.level).filter(|_| texel.level > 0)?;
    let texel = pose.texel(pose.inverse().size(size), texel);
    if Footprint::new(sizes[0], size, (texel.x, texel.y)).len() > MOST_NORMALS {
        return None;
    }
    let monitor = Monitor::new(vec![0; sizes.len()]);
    let mut lobes = LobePyramid::unfitted(Arc::clone(map));
    for (level, columns, rows) in under(&sizes, texel) {
        let mut mixtures = MixtureLevel::empty(sizes[level], settings.lobes);
        let width = mixtures.width;
        let fits: Vec<_> = rows
            .flat_map(|y| columns.clone().map(move |x| (x, y)))
            .collect::<Vec<_>>()
            .into_par_iter()
            .map(|texel| (texel, unaligned::fit_texel(&lobes, level, texel, settings, &monitor)))
            .collect();
        for ((x, y), fit) in fits {
            let start = (y * width + x) * settings.lobes;
            fit.lobes.store(&mut mixtures.stored[start..start + settings.lobes]);
        }
        lobes.coarse[level - 1] = Some(Arc::new(mixtures));
    }
    let mut stored = lobes.level(texel.level)?.texel(texel.x, texel.y).to_vec();
    turn(&mut stored, pose.inverse());
    Some(stored)
}

type Range = std::ops::Range<usize>;

/// The columns and rows of every level from 1 up to the texel's that its fit rests on, the finest level first.
fn under(sizes: &[(usize, usize)], texel: Texel) -> Vec<(usize, Range, Range)> {
    let (mut columns, mut rows) = (texel.x..texel.x + 1, texel.y..texel.y + 1);
    let mut levels = vec![(texel.level, columns.clone(), rows.clone())];
    for level in (1..texel.level).rev() {
        let (fine, coarse) = (sizes[level], sizes[level + 1]);
        columns = Span::new(fine.0, coarse.0, columns.start).start..Span::new(fine.0, coarse.0, columns.end - 1).end;
        rows = Span::new(fine.1, coarse.1, rows.start).start..Span::new(fine.1, coarse.1, rows.end - 1).end;
        levels.push((level, columns.clone(), rows.clone()));
    }
    levels.reverse();
    levels
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::filter::vmf::Alignment;
    use crate::filter::vmf::fit::{expected_visits, fit as fit_all};
    use crate::normal_map::procedural;

    #[test]
    fn the_texel_alone_gets_the_lobes_it_gets_with_all_others() {
        for (size, texel) in [(64, Texel { level: 4, x: 1, y: 3 }), (37, Texel { level: 3, x: 2, y: 0 })] {
            let map = Arc::new(procedural::find("bricks").expect("bundled").make(size));
            let settings = FitSettings { lobes: 4, align: Alignment::None, ..FitSettings::default() };
            let monitor = Monitor::new(expected_visits(&map, &settings));
            let all = fit_all(&map, &settings, &monitor, &mut |_| {}).expect("nobody cancels");
            let pose = Pose::canonical(&map);
            let alone = fit(&pose.map(&map), pose, texel, &settings).expect("small");
            assert_eq!(alone, all.level(texel.level).expect("fitted").texel(texel.x, texel.y));
        }
    }
}
