//! What of the view is worth saving: nothing here changes the fit or a picture's values, only what is seen of them.

use serde::{Deserialize, Serialize};

use super::dock::{DockView, Panel, Preset};
use super::dolly::Dolly;
use super::drying_view::DryingView;
use super::export_view::ExportView;
use super::level_places::MapLevels;
use super::light_view::LightView;
use super::map_shading::MapShading;
use crate::comparison::Comparison;
use crate::filter::{Method, Rival};
use crate::gpu::passes::sphere::SphereLayers;
use crate::measure::{Axis, Metric};
use crate::reference::Region;
use crate::scene::SphereOrbit;

/// Which of the main panels are in sight.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Layout {
    /// The lit surface.
    #[default]
    Surface,
    /// The lit surface and the map beside each other.
    Split,
    /// The map.
    Map,
    /// Figures of every method, measured and plotted.
    Figures,
    /// The lit surface and the figures beside each other.
    SurfaceFigures,
}

impl Layout {
    /// Every layout with its name, in the order they are offered.
    pub const ALL: [(Self, &'static str); 5] = [
        (Self::Surface, "Surface"),
        (Self::Split, "Split"),
        (Self::Map, "Map"),
        (Self::Figures, "Figures"),
        (Self::SurfaceFigures, "Surface and figures"),
    ];
    /// Those that stand above the main panels; the others come by presets and from the menu.
    pub const OFFERED: [(Self, &'static str); 4] = [Self::ALL[0], Self::ALL[1], Self::ALL[2], Self::ALL[3]];

    /// True where it shows this main panel.
    pub fn shows(self, panel: Panel) -> bool {
        match panel {
            Panel::Surface => matches!(self, Self::Surface | Self::Split | Self::SurfaceFigures),
            Panel::Map => matches!(self, Self::Map | Self::Split),
            Panel::Figures => matches!(self, Self::Figures | Self::SurfaceFigures),
            Panel::Controls | Panel::Texel | Panel::Levels => false,
        }
    }
}

/// Where the map view looks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct MapView {
    /// The point of the picture in the middle of the view, `0..1` across and down.
    pub center: [f32; 2],
    /// Size over the size at which the whole picture fits the view.
    pub zoom: f32,
    /// Which levels are shown.
    pub levels: MapLevels,
    /// What is shown of the texels.
    pub shading: MapShading,
}

impl Default for MapView {
    fn default() -> Self {
        Self { center: [0.5, 0.5], zoom: 1.0, levels: MapLevels::Selected, shading: MapShading::Normal }
    }
}

/// Which figures are measured and shown.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct FiguresView {
    /// The quantity that is varied.
    pub axis: Axis,
    /// The figure that is plotted.
    pub metric: Metric,
    /// The methods that are measured.
    pub methods: Vec<Method>,
    /// The path that is being typed.
    #[serde(skip)]
    pub typed_path: String,
}

impl Default for FiguresView {
    fn default() -> Self {
        let named = ["mip", "toksvig", "lean"].into_iter().filter_map(Rival::parse).map(Method::Rival);
        Self {
            axis: Axis::default(),
            metric: Metric::default(),
            methods: named.chain([Method::Vmf]).collect(),
            typed_path: String::new(),
        }
    }
}

/// What lies over the window.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Overlay {
    /// Nothing.
    #[default]
    None,
    /// The search for an action.
    Palette,
    /// Keys and gestures.
    Keys,
    /// What was said so far.
    Log,
    /// The question where the session is saved to.
    SaveSession,
    /// What is exported, how and where to.
    Export,
}

/// The search for an action.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct PaletteView {
    /// What was typed.
    pub text: String,
    /// Which of the actions found Enter takes.
    pub chosen: usize,
}

/// A region of pictures: of the surface, whose figures are shown, or of the map, whose numbers are counted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RegionView {
    /// The region, of every picture; the whole where there is none.
    pub chosen: Option<Region>,
    /// The cell in which it is being drawn, and the corner where that began.
    pub drawn_from: Option<(egui::Rect, [f32; 2])>,
}

/// Needles on the surface: its frames, and both normals of a relief.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct NeedlesView {
    /// Whether the mesh's frames are drawn.
    pub frames: bool,
    /// Whether both normals are drawn.
    pub shown: bool,
    /// What a height of 1 is, in the surface's own units.
    pub scale: f32,
}

impl NeedlesView {
    /// Mikkelsen's middle scale.
    pub const DEFAULT: Self = Self { frames: false, shown: false, scale: 0.0625 };
}

impl Default for NeedlesView {
    fn default() -> Self {
        Self::DEFAULT
    }
}

/// The whole view.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ViewState {
    /// The main panels in sight.
    pub layout: Layout,
    /// The panels beside them, and where all of them stand.
    pub dock: DockView,
    /// The map view.
    pub map: MapView,
    /// The figures.
    pub figures: FiguresView,
    /// The lights.
    pub light: LightView,
    /// What is exported.
    pub export: ExportView,
    /// How the sphere is turned.
    pub sphere_orbit: SphereOrbit,
    /// What the sphere shows.
    pub sphere_layers: SphereLayers,
    /// Which repeat of the map carries the selected texel's outline on the surface, counted across and down.
    pub pinned_repeat: [i32; 2],
    /// Whether the methods' figures are hidden; the truth is then drawn only where it is seen.
    pub hides_figures: bool,
    /// The region whose figures are shown.
    #[serde(skip)]
    pub region: RegionView,
    /// The region of the map that the histogram counts.
    #[serde(skip)]
    pub map_region: RegionView,
    /// Whether the camera runs away and back.
    #[serde(skip)]
    pub dolly: Dolly,
    /// Needles on the surface.
    pub needles: NeedlesView,
    /// Whether the trace of the selected texel's fit is shown.
    pub show_trace: bool,
    /// Whether all findings of the import doctor are shown, or the doubtful ones only.
    pub show_findings: bool,
    /// Whether the selected texel's effective BRDF is shown.
    pub show_brdf: bool,
    /// The method whose effective BRDFs are held against the truth; without one, a method of the comparison.
    pub judged: Option<Method>,
    /// The drying that the material may follow.
    pub drying: DryingView,
    /// The path of a measured reflectance that is being typed.
    #[serde(skip)]
    pub typed_measured: String,
    /// The path that is being typed.
    #[serde(skip)]
    pub typed_path: String,
    /// The path of a mesh that is being typed.
    #[serde(skip)]
    pub typed_mesh_path: String,
    /// The path of a session that is being typed.
    #[serde(skip)]
    pub session_path: String,
    /// What lies over the window.
    #[serde(skip)]
    pub overlay: Overlay,
    /// The search for an action.
    #[serde(skip)]
    pub palette: PaletteView,
}

impl MapView {
    /// The whole picture of the same.
    pub fn whole(self) -> Self {
        Self { center: [0.5, 0.5], zoom: 1.0, ..self }
    }
}

impl ViewState {
    /// Shows what a preset has, where it has it.
    pub fn choose(&mut self, preset: Preset) {
        self.layout = preset.layout();
        self.dock = DockView { preset, sides: preset.sides(), place: None };
    }

    /// True where a panel is in sight, or would be were it not behind another.
    pub fn shows(&self, panel: Panel) -> bool {
        let mut sides = self.dock.sides;
        sides.switch(panel).map_or_else(|| self.layout.shows(panel), |shown| *shown)
    }

    /// True while a light or the camera moves by itself.
    pub fn is_playing(&self) -> bool {
        self.light.is_sweeping || self.dolly.is_playing || self.drying.is_playing
    }

    /// The method that is held against the truth: the `chosen` one, else the right or the left one of the comparison,
    /// whichever is not the truth itself.
    pub fn judged_of(comparison: &Comparison, chosen: Option<Method>) -> Method {
        let compared = [comparison.right, comparison.left].into_iter().find(|method| *method != Method::Truth);
        chosen.or(compared).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_truth_is_not_held_against_itself() {
        let between = |left, right| Comparison { left, right, ..Comparison::default() };
        let judged = |left, right| ViewState::judged_of(&between(left, right), None);
        assert_eq!(judged(Method::MIP, Method::Vmf), Method::Vmf);
        assert_eq!(judged(Method::MIP, Method::Truth), Method::MIP);
        assert_eq!(judged(Method::Truth, Method::Truth), Method::Vmf);
        assert_eq!(ViewState::judged_of(&Comparison::default(), Some(Method::MIP)), Method::MIP);
    }
}
