//! A level of the map as a picture: what part of it a view shows, and the colours of its texels.

use egui::{Color32, ColorImage, Pos2, Rect, TextureHandle, TextureId, TextureOptions, Vec2, pos2, vec2};

use super::level_colors::LevelColors;
use super::map_shading::MapShading;
use super::texel_values::TexelValues;
use super::view_state::MapView;
use crate::normal_map::pyramid::Texel;

/// The largest zoom, in points per texel of the finest level that is shown.
const MAX_POINTS_PER_TEXEL: f32 = 256.0;

/// The geometry of a map view: which point of the map lies under which point of the window.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MapProjection {
    view: Rect,
    center: Vec2,
    /// Points across and down that the whole map takes.
    extent: Vec2,
}

impl MapProjection {
    /// The projection of a picture of `size` base texels into `view`.
    pub fn new(view: Rect, size: Vec2, map_view: &MapView) -> Self {
        let fitted = (view.width() / size.x).min(view.height() / size.y);
        Self { view, center: map_view.center.into(), extent: size * fitted * map_view.zoom }
    }

    /// The projection of a part of the picture, `0..1` across and down, into the same view.
    pub fn part(&self, part: Rect) -> Self {
        let center = (self.center - part.min.to_vec2()) / part.size();
        Self { center, extent: self.extent * part.size(), ..*self }
    }

    /// Where a point of the map, `0..1` across and down, is shown.
    pub fn place(&self, uv: Vec2) -> Pos2 {
        self.view.center() + (uv - self.center) * self.extent
    }

    /// The point of the map that is shown at `position`.
    pub fn uv(&self, position: Pos2) -> Vec2 {
        (position - self.view.center()) / self.extent + self.center
    }

    /// The whole map's place, cut off at the view.
    pub fn visible(&self) -> Rect {
        self.whole().intersect(self.view)
    }

    /// The whole map's place, in sight or not.
    pub fn whole(&self) -> Rect {
        Rect::from_min_max(self.place(Vec2::ZERO), self.place(Vec2::splat(1.0)))
    }

    /// The place of a texel of a level of `size`.
    pub fn texel_rect(&self, (x, y): (usize, usize), size: (usize, usize)) -> Rect {
        let scale = vec2(1.0 / size.0 as f32, 1.0 / size.1 as f32);
        let corner = |x: usize, y: usize| self.place(vec2(x as f32, y as f32) * scale);
        Rect::from_min_max(corner(x, y), corner(x + 1, y + 1))
    }

    /// The texel of a level of `size` at `position`; `None` beside the map.
    pub fn texel(&self, position: Pos2, level: usize, size: (usize, usize)) -> Option<Texel> {
        let uv = self.uv(position);
        let inside = (0.0..1.0).contains(&uv.x) && (0.0..1.0).contains(&uv.y);
        inside.then_some(Texel { level, x: (uv.x * size.0 as f32) as usize, y: (uv.y * size.1 as f32) as usize })
    }

    /// Points that a texel takes where so many lie across the whole map.
    pub fn points_per_texel(&self, across: f32) -> f32 {
        self.extent.x / across
    }

    /// Zooms by `factor` around `position` and returns the view that shows it; `across` is how many of the finest texels
    /// lie across the whole map.
    pub fn zoomed(&self, map_view: MapView, factor: f32, position: Pos2, across: f32) -> MapView {
        let most = MAX_POINTS_PER_TEXEL / (self.points_per_texel(across) / map_view.zoom);
        let zoom = (map_view.zoom * factor).clamp(0.5, most.max(1.0));
        let held = self.uv(position);
        let center = held - (position - self.view.center()) / (self.extent * zoom / map_view.zoom);
        MapView { zoom, center: clamped(center), ..map_view }
    }

    /// Moves the map by a drag.
    pub fn dragged(&self, map_view: MapView, by: Vec2) -> MapView {
        MapView { center: clamped(self.center - by / self.extent), ..map_view }
    }
}

fn clamped(center: Vec2) -> [f32; 2] {
    center.clamp(Vec2::ZERO, Vec2::splat(1.0)).into()
}

/// Levels as textures, made anew when what they show changes.
#[derive(Default)]
pub struct MapTextures {
    thumbnails: Vec<Option<(PictureKey, TextureHandle)>>,
    views: Vec<Option<LevelView>>,
}

/// What a view shows of a level.
struct LevelView {
    colors: LevelColors,
    shown: ViewKey,
    texture: TextureHandle,
}

/// What a level's picture depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PictureKey {
    revisions: [u64; 3],
    shading: MapShading,
    level: usize,
}

/// Where the level lies, the part of the window that it covers, and the pixels of that.
type ViewKey = (MapProjection, Rect, [usize; 2]);

impl PictureKey {
    /// Of a level's values.
    pub fn new(values: &TexelValues<'_>, level: usize) -> Self {
        Self { revisions: values.revisions(), shading: values.shading(), level }
    }
}

impl MapTextures {
    /// A level, at most `side` pixels across and down.
    pub fn thumbnail(&mut self, ctx: &egui::Context, values: &TexelValues<'_>, level: usize, side: usize) -> TextureId {
        if self.thumbnails.len() <= level {
            self.thumbnails.resize_with(level + 1, || None);
        }
        let key = PictureKey::new(values, level);
        if let Some((made, texture)) = &self.thumbnails[level]
            && *made == key
        {
            return texture.id();
        }
        let image = thumbnail(values, level, side);
        let texture = ctx.load_texture(format!("level {level}"), image, TextureOptions::NEAREST);
        self.thumbnails[level].insert((key, texture)).1.id()
    }

    /// The part of a level that a view shows.
    pub fn view(&mut self, ctx: &egui::Context, values: &TexelValues<'_>, level: usize, shown: ViewKey) -> TextureId {
        if self.views.len() <= level {
            self.views.resize_with(level + 1, || None);
        }
        let kept = &mut self.views[level];
        if kept.as_ref().is_some_and(|view| !view.colors.are_of(values)) {
            *kept = None;
        }
        if let Some(view) = kept
            && view.shown == shown
        {
            return view.texture.id();
        }
        let mut colors = kept.take().map_or_else(|| LevelColors::new(values, level), |view| view.colors);
        let image = image(&mut |x, y| colors.get(values, x, y), values.session().map().level_size(level), shown);
        let texture = ctx.load_texture(format!("map view, level {level}"), image, TextureOptions::NEAREST);
        kept.insert(LevelView { colors, shown, texture }).texture.id()
    }
}

/// The part of a level of `size` that a projection shows, a pixel per physical pixel of the area, each the colour of the
/// texel under its centre.
fn image(
    color: &mut dyn FnMut(usize, usize) -> Color32,
    (width, height): (usize, usize),
    (projection, area, px): ViewKey,
) -> ColorImage {
    let index = |uv: f32, count: usize| ((uv * count as f32) as usize).min(count - 1);
    let step = vec2(area.width() / px[0] as f32, area.height() / px[1] as f32);
    let columns: Vec<usize> = (0..px[0])
        .map(|i| index(projection.uv(pos2(area.min.x + (i as f32 + 0.5) * step.x, area.min.y)).x, width))
        .collect();
    let rows =
        (0..px[1]).map(|i| index(projection.uv(pos2(area.min.x, area.min.y + (i as f32 + 0.5) * step.y)).y, height));
    let mut pixels = Vec::with_capacity(px[0] * px[1]);
    for y in rows {
        pixels.extend(columns.iter().map(|&x| color(x, y)));
    }
    ColorImage::new(px, pixels)
}

/// A whole level, shrunk to at most `side` pixels across and down.
pub fn thumbnail(values: &TexelValues<'_>, level: usize, side: usize) -> ColorImage {
    let (width, height) = values.session().map().level_size(level);
    let shrink = (width.max(height)).div_ceil(side).max(1);
    let px = [(width / shrink).max(1), (height / shrink).max(1)];
    let texel = |i: usize| Texel { level, x: (i % px[0]) * width / px[0], y: (i / px[0]) * height / px[1] };
    let pixels = (0..px[0] * px[1]).map(|i| values.color(texel(i))).collect();
    ColorImage::new(px, pixels)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn projection(map_view: &MapView) -> MapProjection {
        MapProjection::new(Rect::from_min_size(pos2(10.0, 20.0), vec2(400.0, 200.0)), vec2(64.0, 32.0), map_view)
    }

    #[test]
    fn the_texel_under_its_own_middle_is_itself() {
        let map_view = MapView { zoom: 3.0, center: [0.4, 0.6], ..Default::default() };
        let projection = projection(&map_view);
        let rect = projection.texel_rect((13, 9), (32, 16));
        assert_eq!(projection.texel(rect.center(), 1, (32, 16)), Some(Texel { level: 1, x: 13, y: 9 }));
    }

    #[test]
    fn zooming_holds_the_point_under_the_pointer() {
        let map_view = MapView::default();
        let position = pos2(150.0, 90.0);
        let before = projection(&map_view).uv(position);
        let zoomed = projection(&map_view).zoomed(map_view, 2.5, position, 64.0);
        assert!((projection(&zoomed).uv(position) - before).length() < 1e-5);
    }
    #[test]
    fn a_part_is_shown_where_the_whole_has_it() {
        let whole = projection(&MapView { zoom: 3.0, center: [0.4, 0.6], ..Default::default() });
        let part = Rect::from_min_max(pos2(0.25, 0.5), pos2(0.75, 0.625));
        for uv in [vec2(0.0, 0.0), vec2(1.0, 1.0), vec2(0.3, 0.9)] {
            let in_whole = part.min.to_vec2() + uv * part.size();
            assert!((whole.part(part).place(uv) - whole.place(in_whole)).length() < 1e-3, "{uv:?}");
        }
    }
}
