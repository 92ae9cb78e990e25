//! The texels of which a method is farthest off, over all levels: places worth a look, none of them next to another.

use crate::normal_map::pyramid::Texel;

/// How many there are at most.
pub const MOST_WORST: usize = 10;

/// A texel rules out the eight around it, so a level's worst are among so many of its highest errors.
const CANDIDATES: usize = 9 * MOST_WORST;

/// A texel and the relative L2 error of its effective BRDF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WorstTexel {
    /// Which texel.
    pub texel: Texel,
    /// The error.
    pub error: f32,
}

/// Adds a level's errors, row by row of `width`, to the worst of other levels; NaN is no error. The highest comes first.
pub fn add_level(worst: &mut Vec<WorstTexel>, level: usize, width: usize, errors: &[f32]) {
    let mut indices: Vec<usize> = (0..errors.len()).filter(|&index| !errors[index].is_nan()).collect();
    let higher_first = |a: &usize, b: &usize| errors[*b].total_cmp(&errors[*a]).then(a.cmp(b));
    if indices.len() > CANDIDATES {
        indices.select_nth_unstable_by(CANDIDATES, higher_first);
        indices.truncate(CANDIDATES);
    }
    indices.sort_unstable_by(higher_first);
    let mut chosen: Vec<WorstTexel> = Vec::new();
    for index in indices {
        let texel = Texel { level, x: index % width, y: index / width };
        if !chosen.iter().any(|other| touches(other.texel, texel)) && chosen.len() < MOST_WORST {
            chosen.push(WorstTexel { texel, error: errors[index] });
        }
    }
    worst.extend(chosen);
    worst.sort_by(|a, b| b.error.total_cmp(&a.error));
    worst.truncate(MOST_WORST);
}

fn touches(a: Texel, b: Texel) -> bool {
    a.x.abs_diff(b.x) <= 1 && a.y.abs_diff(b.y) <= 1
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_list_is_sorted_and_starts_with_the_maximum_of_all_levels() {
        let error = |index: usize| ((index as f32 * 0.618_034).fract() * 100.0).round() / 100.0;
        let levels: Vec<(usize, Vec<f32>)> =
            [32, 16, 8, 4].map(|width| (width, (0..width * width).map(|i| error(i + width)).collect())).into();
        let mut worst = Vec::new();
        for (level, (width, errors)) in levels.iter().enumerate().rev() {
            add_level(&mut worst, level, *width, errors);
        }
        let maximum = levels.iter().flat_map(|(_, errors)| errors).copied().fold(0.0, f32::max);
        assert!(worst.len() == MOST_WORST && worst[0].error == maximum);
        assert!(worst.is_sorted_by(|a, b| a.error >= b.error));
        for (index, WorstTexel { texel, error }) in worst.iter().enumerate() {
            let (width, errors) = &levels[texel.level];
            assert_eq!(errors[texel.y * width + texel.x], *error);
            let of_level = worst[..index].iter().filter(|other| other.texel.level == texel.level);
            assert!(of_level.into_iter().all(|other| !touches(other.texel, *texel)), "{worst:?}");
        }
    }

    #[test]
    fn a_texel_without_an_error_is_not_listed_nor_is_one_next_to_a_worse() {
        let mut worst = Vec::new();
        add_level(&mut worst, 2, 4, &[0.5, 0.6, f32::NAN, 0.1, f32::NAN, 0.4, f32::NAN, 0.2]);
        let listed: Vec<_> = worst.iter().map(|worst| (worst.texel.x, worst.texel.y, worst.error)).collect();
        assert_eq!(listed, [(1, 0, 0.6), (3, 1, 0.2)]);
    }
}
