//! Where levels stand in the map view: one alone, or all of them in a common picture.

use egui::{Rect, Vec2, vec2};
use serde::{Deserialize, Serialize};

use crate::normal_map::NormalMap;
use crate::normal_map::pyramid::Texel;

/// Which levels the map view shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MapLevels {
    /// That of the selected texel.
    #[default]
    Selected,
    /// All, each as large as the base.
    EqualSize,
    /// All, each texel as large as one of the base.
    ActualSize,
}

impl MapLevels {
    /// Every choice with its name and what it means, in the order they are offered.
    pub const ALL: [(Self, &'static str, &'static str); 3] = [
        (Self::Selected, "one level", "The selected texel's level."),
        (Self::EqualSize, "all, equal size", "All levels, each as large as the base."),
        (Self::ActualSize, "all, actual size", "All levels, each texel as large as one of the base."),
    ];
}

/// Room between two levels over the base's width.
const GAP: f32 = 0.02;

/// The places of levels in a common picture.
#[derive(Clone, Debug, PartialEq)]
pub struct LevelPlaces {
    /// Size of the whole, in base texels.
    pub size: Vec2,
    /// Levels and their places, `0..1` across and down the whole.
    pub levels: Vec<(usize, Rect)>,
}

impl LevelPlaces {
    /// The places of the levels that are shown while `selected` is the selected one.
    pub fn new(shown: MapLevels, map: &NormalMap, selected: usize) -> Self {
        let base = vec2(map.width as f32, map.height as f32);
        let count = map.level_sizes().len();
        match shown {
            MapLevels::Selected => Self::of(vec![(selected, Rect::from_min_size(Default::default(), base))]),
            MapLevels::EqualSize => Self::of(equal_size(base, count)),
            MapLevels::ActualSize => Self::of(actual_size(base, count)),
        }
    }

    /// Of places in base texels.
    fn of(places: Vec<(usize, Rect)>) -> Self {
        let size = places.iter().fold(Vec2::ZERO, |size, (_, place)| size.max(place.max.to_vec2()));
        let share = |place: Rect| {
            Rect::from_min_max((place.min.to_vec2() / size).to_pos2(), (place.max.to_vec2() / size).to_pos2())
        };
        Self { size, levels: places.into_iter().map(|(level, place)| (level, share(place))).collect() }
    }

    /// Where a level stands, `0..1` across and down the whole; `None` where it is not shown.
    pub fn place(&self, level: usize) -> Option<Rect> {
        self.levels.iter().find(|(shown, _)| *shown == level).map(|(_, place)| *place)
    }

    /// Where the middle of a texel of a level of `size` stands, `0..1` across and down the whole.
    pub fn middle(&self, texel: Texel, size: (usize, usize)) -> Vec2 {
        let uv = vec2((texel.x as f32 + 0.5) / size.0 as f32, (texel.y as f32 + 0.5) / size.1 as f32);
        self.place(texel.level).map_or(uv, |place| place.min.to_vec2() + uv * place.size())
    }
}

/// Row by row, about as many rows as columns.
fn equal_size(base: Vec2, count: usize) -> Vec<(usize, Rect)> {
    let columns = (count as f32).sqrt().ceil() as usize;
    let step = base + Vec2::splat(GAP * base.x);
    let corner = |level: usize| vec2((level % columns) as f32, (level / columns) as f32) * step;
    (0..count).map(|level| (level, Rect::from_min_size(corner(level).to_pos2(), base))).collect()
}

/// The base on the left, the others below each other beside it.
fn actual_size(base: Vec2, count: usize) -> Vec<(usize, Rect)> {
    let gap = GAP * base.x;
    let mut top = 0.0;
    let place = |level: usize| {
        let size = base / (1_u64 << level) as f32;
        if level == 0 {
            return (level, Rect::from_min_size(Default::default(), size));
        }
        let corner = vec2(base.x + gap, top);
        top += size.y + gap;
        (level, Rect::from_min_size(corner.to_pos2(), size))
    };
    (0..count).map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::normal_map::procedural;

    #[test]
    fn no_two_levels_overlap_and_all_lie_inside_the_whole() {
        let map = procedural::find("waves").expect("bundled").make(64);
        for (shown, ..) in MapLevels::ALL {
            let places = LevelPlaces::new(shown, &map, 3);
            let whole = Rect::from_min_max(egui::pos2(-1e-6, -1e-6), egui::pos2(1.0 + 1e-6, 1.0 + 1e-6));
            for (index, (level, place)) in places.levels.iter().enumerate() {
                assert!(whole.contains_rect(*place) && place.is_positive(), "{shown:?} {level}: {place:?}");
                assert!(places.levels[..index].iter().all(|(_, other)| !other.intersect(*place).is_positive()));
            }
            assert_eq!(places.levels.len(), if shown == MapLevels::Selected { 1 } else { 7 });
        }
    }

    #[test]
    fn a_texel_at_actual_size_is_as_large_as_one_of_the_base() {
        let map = procedural::find("waves").expect("bundled").make(64);
        let places = LevelPlaces::new(MapLevels::ActualSize, &map, 0);
        for (level, place) in &places.levels {
            let texel = place.size() * places.size / vec2((64 >> level) as f32, (64 >> level) as f32);
            assert!((texel - Vec2::splat(1.0)).length() < 1e-4, "{level}: {texel}");
        }
        let alone = LevelPlaces::new(MapLevels::Selected, &map, 3);
        assert_eq!(alone.middle(Texel { level: 3, x: 1, y: 6 }, (8, 8)), vec2(1.5 / 8.0, 6.5 / 8.0));
    }
}
