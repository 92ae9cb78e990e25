//! A level of the map as a picture: what part of it a view shows, and the colours of its texels.

use egui::{Color32, ColorImage, Pos2, Rect, TextureHandle, TextureId, TextureOptions, Vec2, pos2, vec2};
use glam::Vec3;

use super::view_state::{MapShading, MapView};
use crate::color::{LOBE_COLORS, heat, linear_from_srgb, srgb8_from_linear};
use crate::filter::vmf::{Fold, fold};
use crate::normal_map::pyramid::Texel;
use crate::session::Session;
use crate::sphere::mixture::used;

/// The largest zoom, in points per base texel.
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
    /// The projection of a map of `size` base texels into `view`.
    pub fn new(view: Rect, size: (usize, usize), map_view: &MapView) -> Self {
        let size = vec2(size.0 as f32, size.1 as f32);
        let fitted = (view.width() / size.x).min(view.height() / size.y);
        Self { view, center: map_view.center.into(), extent: size * fitted * map_view.zoom }
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
        Rect::from_min_max(self.place(Vec2::ZERO), self.place(Vec2::splat(1.0))).intersect(self.view)
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

    /// Zooms by `factor` around `position` and returns the view that shows it.
    pub fn zoomed(&self, map_view: MapView, factor: f32, position: Pos2, size: (usize, usize)) -> MapView {
        let most = MAX_POINTS_PER_TEXEL * size.0 as f32 / (self.extent.x / map_view.zoom);
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
    view: Option<(PictureKey, ViewKey, TextureHandle)>,
}

/// What a level's picture depends on.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PictureKey {
    map_revision: u64,
    lobes_revision: u64,
    shading: MapShading,
    level: usize,
}

type ViewKey = (MapProjection, Rect, [usize; 2]);

impl PictureKey {
    fn new(session: &Session, shading: MapShading, level: usize) -> Self {
        let shows_lobes = matches!(shading, MapShading::Lobes | MapShading::Count);
        let lobes = if shows_lobes { session.fitting().revision() } else { 0 };
        Self { map_revision: session.map_revision(), lobes_revision: lobes, shading, level }
    }
}

impl MapTextures {
    /// A level, at most `side` pixels across and down.
    pub fn thumbnail(
        &mut self,
        ctx: &egui::Context,
        session: &Session,
        shading: MapShading,
        level: usize,
        side: usize,
    ) -> TextureId {
        if self.thumbnails.len() <= level {
            self.thumbnails.resize_with(level + 1, || None);
        }
        let key = PictureKey::new(session, shading, level);
        if let Some((made, texture)) = &self.thumbnails[level]
            && *made == key
        {
            return texture.id();
        }
        let image = thumbnail(session, shading, level, side);
        let texture = ctx.load_texture(format!("level {level}"), image, TextureOptions::NEAREST);
        self.thumbnails[level].insert((key, texture)).1.id()
    }

    /// The part of a level that a view shows.
    pub fn view(
        &mut self,
        ctx: &egui::Context,
        session: &Session,
        (shading, level): (MapShading, usize),
        (projection, area, px): ViewKey,
    ) -> TextureId {
        let key = PictureKey::new(session, shading, level);
        if let Some((made, shown, texture)) = &self.view
            && (*made, *shown) == (key, (projection, area, px))
        {
            return texture.id();
        }
        let image = image(session, shading, level, &projection, area, px);
        let texture = ctx.load_texture("map view", image, TextureOptions::NEAREST);
        self.view.insert((key, (projection, area, px), texture)).2.id()
    }
}

/// The part of a level that `projection` shows, a pixel per physical pixel of `area`, each the colour of the texel
/// under its centre.
pub fn image(
    session: &Session,
    shading: MapShading,
    level: usize,
    projection: &MapProjection,
    area: Rect,
    px: [usize; 2],
) -> ColorImage {
    let (width, height) = session.map().level_sizes()[level];
    let index = |uv: f32, count: usize| ((uv * count as f32) as usize).min(count - 1);
    let step = vec2(area.width() / px[0] as f32, area.height() / px[1] as f32);
    let columns: Vec<usize> = (0..px[0])
        .map(|i| index(projection.uv(pos2(area.min.x + (i as f32 + 0.5) * step.x, area.min.y)).x, width))
        .collect();
    let rows =
        (0..px[1]).map(|i| index(projection.uv(pos2(area.min.x, area.min.y + (i as f32 + 0.5) * step.y)).y, height));
    let painter = TexelPainter::new(session, shading, level);
    let pixels = rows.flat_map(|y| columns.iter().map(move |&x| (x, y))).map(|(x, y)| painter.color(x, y)).collect();
    ColorImage::new(px, pixels)
}

/// A whole level, shrunk to at most `side` pixels across and down.
pub fn thumbnail(session: &Session, shading: MapShading, level: usize, side: usize) -> ColorImage {
    let (width, height) = session.map().level_sizes()[level];
    let shrink = (width.max(height)).div_ceil(side).max(1);
    let px = [(width / shrink).max(1), (height / shrink).max(1)];
    let painter = TexelPainter::new(session, shading, level);
    let pixels =
        (0..px[0] * px[1]).map(|i| painter.color((i % px[0]) * width / px[0], (i / px[0]) * height / px[1])).collect();
    ColorImage::new(px, pixels)
}

/// The colour of a texel that is not fitted.
const MISSING: [u8; 3] = [24, 26, 31];

/// Colours the texels of one level.
struct TexelPainter<'a> {
    session: &'a Session,
    shading: MapShading,
    level: usize,
    width: usize,
    fold: Fold,
}

impl<'a> TexelPainter<'a> {
    fn new(session: &'a Session, shading: MapShading, level: usize) -> Self {
        let width = session.map().level_sizes()[level].0;
        Self { session, shading, level, width, fold: session.fitting().fold() }
    }

    fn color(&self, x: usize, y: usize) -> Color32 {
        let mean = self.session.mip().levels[self.level][y * self.width + x];
        let [r, g, b] = match self.shading {
            MapShading::Normal => normal_color(mean),
            MapShading::Length => heat(mean.length()),
            MapShading::Lobes => self.lobe_color(x, y),
            MapShading::Count => self.count_color(x, y),
        };
        Color32::from_rgb(r, g, b)
    }

    /// The number of lobes in use beside the most of any texel.
    fn count_color(&self, x: usize, y: usize) -> [u8; 3] {
        let lobes = self.session.lobes();
        match lobes.level(self.level) {
            Some(level) => heat(used(level.texel(x, y)) as f32 / lobes.lobes() as f32),
            None if self.level == 0 => heat(1.0 / lobes.lobes() as f32),
            None => MISSING,
        }
    }

    /// The lobes' colours mixed by weight, in linear light.
    fn lobe_color(&self, x: usize, y: usize) -> [u8; 3] {
        let texel = Texel { level: self.level, x, y };
        let Some(mixture) = fold::mixture(self.session.lobes(), self.fold, texel) else {
            return MISSING;
        };
        let linear = |slot: usize| {
            Vec3::from(LOBE_COLORS[slot % LOBE_COLORS.len()].map(|code| linear_from_srgb(f32::from(code) / 255.0)))
        };
        srgb8_from_linear(mixture.lobes.iter().map(|(slot, lobe)| lobe.weight as f32 * linear(*slot)).sum())
    }
}

/// A normal as maps store it; a texel without one is black.
fn normal_color(mean: Vec3) -> [u8; 3] {
    match mean.try_normalize() {
        Some(normal) => (127.5 * (normal + Vec3::ONE)).round().to_array().map(|code| code as u8),
        None => [0, 0, 0],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn projection(map_view: &MapView) -> MapProjection {
        MapProjection::new(Rect::from_min_size(pos2(10.0, 20.0), vec2(400.0, 200.0)), (64, 32), map_view)
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
        let zoomed = projection(&map_view).zoomed(map_view, 2.5, position, (64, 32));
        assert!((projection(&zoomed).uv(position) - before).length() < 1e-5);
    }
}
