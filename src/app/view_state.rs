//! What of the view is worth saving: nothing here changes the fit or a picture's values, only what is seen of them.

use serde::{Deserialize, Serialize};

use super::dolly::Dolly;
use super::export_view::ExportView;
use super::light_view::LightView;
use crate::filter::{Method, Rival};
use crate::gpu::passes::sphere::SphereLayers;
use crate::measure::{Axis, Metric};
use crate::reference::Region;
use crate::scene::SphereOrbit;

/// What the middle of the window shows.
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
}

impl Layout {
    /// Every layout with its name, in the order they are offered.
    pub const ALL: [(Self, &'static str); 4] =
        [(Self::Surface, "Surface"), (Self::Split, "Split"), (Self::Map, "Map"), (Self::Figures, "Figures")];
}

/// What a level's picture shows of its texels.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum MapShading {
    /// The mean normal, coloured as normal maps are.
    #[default]
    Normal,
    /// The length of the mean normal: 1 where a footprint is flat.
    Length,
    /// The lobes' colours, mixed by their weights.
    Lobes,
    /// How many lobes a texel uses, from none to the most there are.
    Count,
}

impl MapShading {
    /// Every shading with its name, in the order they are offered.
    pub const ALL: [(Self, &'static str); 4] =
        [(Self::Normal, "Normal"), (Self::Length, "Length"), (Self::Lobes, "Lobes"), (Self::Count, "J")];
}

/// Where the map view looks.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct MapView {
    /// The point of the map in the middle of the view, `0..1` across and down.
    pub center: [f32; 2],
    /// Size over the size at which the whole map fits the view.
    pub zoom: f32,
    /// What is shown of the texels.
    pub shading: MapShading,
}

impl Default for MapView {
    fn default() -> Self {
        Self { center: [0.5, 0.5], zoom: 1.0, shading: MapShading::Normal }
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

/// The region of the picture whose figures are shown.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RegionView {
    /// The region, of every method's picture; the whole picture where there is none.
    pub chosen: Option<Region>,
    /// The cell in which it is being drawn, and the corner where that began.
    pub drawn_from: Option<(egui::Rect, [f32; 2])>,
}

/// The whole view.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ViewState {
    /// What the middle shows.
    pub layout: Layout,
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
    pub pinned_repeat: [u32; 2],
    /// Whether the methods' figures are hidden; the truth is then drawn only where it is seen.
    pub hides_figures: bool,
    /// The region whose figures are shown.
    #[serde(skip)]
    pub region: RegionView,
    /// Whether the camera runs away and back.
    #[serde(skip)]
    pub dolly: Dolly,
    /// Whether the trace of the selected texel's fit is shown.
    pub show_trace: bool,
    /// Whether all findings of the import doctor are shown, or the doubtful ones only.
    pub show_findings: bool,
    /// The path that is being typed.
    #[serde(skip)]
    pub typed_path: String,
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

impl ViewState {
    /// True while a light or the camera moves by itself.
    pub fn is_playing(&self) -> bool {
        self.light.is_sweeping || self.dolly.is_playing
    }
}
