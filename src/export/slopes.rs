//! Anisotropic moments of slope for each MIP level, as LEAN mapping takes them (M. Olano and D. Baker, I3D 2010).
//!
//! A normal is the slope `b = (n_x / n_z, n_y / n_z)`. One OpenEXR part per level, `level.NN`, holds six f32 channels
//! in two layers, which image tools show as colours: `mean.R` and `.G` are the mean of b, `mean.B` the length of the
//! mean normal; `moment.R`, `.G` and `.B` are the means of `b_x^2`, `b_y^2` and `b_x b_y`. All interpolate linearly;
//! the covariance is the moments less the products of the means. Slopes are as steep as LEAN's at most.

use std::io::ErrorKind;
use std::path::Path;

use super::roughness::notes;
use crate::filter::PlainMip;
use crate::filter::channels::ChannelPyramid;
use crate::filter::lean::{CHANNELS, encode};
use crate::filter::vmf::Monitor;
use crate::image_io::WriteImageError;
use crate::image_io::exr_parts::{Part, write_parts};

/// The channels, in the alphabet's order as the format asks, and the moment each holds; `None` is the length.
const LAYOUT: [(&str, Option<usize>); 6] = [
    ("mean.B", None),
    ("mean.G", Some(1)),
    ("mean.R", Some(0)),
    ("moment.B", Some(4)),
    ("moment.G", Some(3)),
    ("moment.R", Some(2)),
];

/// Writes the moments of every level; of a map too large for memory, of the coarser ones. `-` is standard output.
///
/// # Errors
/// One sentence that names the target and the cause; see [`WriteImageError`].
pub fn write(path: &Path, mip: &PlainMip) -> Result<(), WriteImageError> {
    let map = &mip.map;
    let monitor = Monitor::new(vec![0; map.level_sizes().len()]);
    let moments = ChannelPyramid::average(map, false, CHANNELS, &encode, &monitor);
    let name = || path.display().to_string();
    let moments = moments.map_err(|_| WriteImageError::System { name: name(), cause: ErrorKind::Interrupted })?;
    let part = |level: usize| Part {
        name: format!("level.{level:02}"),
        size: map.level_size(level),
        channels: LAYOUT.iter().map(|(name, _)| (*name).to_owned()).collect(),
        notes: notes(mip, std::collections::BTreeMap::new()),
    };
    let parts: Vec<Part> = (moments.first_level..mip.levels.len()).map(part).collect();
    write_parts(path, &parts, &|place, row| {
        let level = moments.first_level + place.part;
        let first = place.y * parts[place.part].size.0 + place.x;
        for (index, value) in (first..).zip(row) {
            *value = match LAYOUT[place.channel].1 {
                Some(moment) => moments.texel(level, index)[moment / 4][moment % 4],
                None => mip.levels[level][index].length(),
            };
        }
    })
}
