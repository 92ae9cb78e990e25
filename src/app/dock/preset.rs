//! Which panels are in sight: by presets, and one by one.

use std::str::FromStr;

use serde::{Deserialize, Serialize};

use crate::app::view_state::Layout;

/// A part of the window that docks.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Panel {
    /// Map, fit, material, lights, surface.
    Controls,
    /// The lit surface.
    Surface,
    /// The map, zoomed.
    Map,
    /// Figures of every method.
    Figures,
    /// The selected texel.
    Texel,
    /// Every level.
    Levels,
}

impl Panel {
    /// Every panel, in the order in which they are shown.
    pub const ALL: [Self; 6] = [Self::Controls, Self::Surface, Self::Map, Self::Figures, Self::Texel, Self::Levels];

    /// The name on its tab.
    pub fn title(self) -> &'static str {
        match self {
            Self::Controls => "Controls",
            Self::Surface => "Surface",
            Self::Map => "Map",
            Self::Figures => "Figures",
            Self::Texel => "Texel",
            Self::Levels => "Levels",
        }
    }

    /// True for what the window is opened for, which takes the room that others leave; [`Layout`] chooses among these.
    pub fn is_main(self) -> bool {
        matches!(self, Self::Surface | Self::Map | Self::Figures)
    }
}

impl FromStr for Panel {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let named = Self::ALL.into_iter().find(|panel| panel.title().eq_ignore_ascii_case(text));
        named.ok_or_else(|| "write controls, surface, map, figures, texel or levels".to_owned())
    }
}

/// Which panels are shown beside the main ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Sides {
    /// The controls.
    pub controls: bool,
    /// The selected texel.
    pub texel: bool,
    /// The levels.
    pub levels: bool,
}

impl Default for Sides {
    fn default() -> Self {
        Self { controls: true, texel: true, levels: true }
    }
}

impl Sides {
    /// The switch of a panel; `None` for a main one.
    pub fn switch(&mut self, panel: Panel) -> Option<&mut bool> {
        match panel {
            Panel::Controls => Some(&mut self.controls),
            Panel::Texel => Some(&mut self.texel),
            Panel::Levels => Some(&mut self.levels),
            Panel::Surface | Panel::Map | Panel::Figures => None,
        }
    }
}

/// What the window is used for, and so what it shows.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// The surface and everything about it.
    #[default]
    Inspect,
    /// The surface by several methods beside their figures.
    Compare,
    /// Surface and map beside each other, to see what the fit's settings do to both.
    Tune,
    /// The map and its levels.
    MapOnly,
}

impl Preset {
    /// Every preset with its name, in the order they are offered.
    pub const ALL: [(Self, &'static str); 4] =
        [(Self::Inspect, "Inspect"), (Self::Compare, "Compare"), (Self::Tune, "Tune"), (Self::MapOnly, "Map only")];

    /// The main panels that it shows.
    pub fn layout(self) -> Layout {
        match self {
            Self::Inspect => Layout::Surface,
            Self::Compare => Layout::SurfaceFigures,
            Self::Tune => Layout::Split,
            Self::MapOnly => Layout::Map,
        }
    }

    /// What it shows beside these.
    pub fn sides(self) -> Sides {
        match self {
            Self::Inspect | Self::Tune => Sides::default(),
            Self::Compare => Sides { controls: false, texel: false, levels: false },
            Self::MapOnly => Sides { controls: false, texel: false, levels: true },
        }
    }
}

impl FromStr for Preset {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "inspect" => Ok(Self::Inspect),
            "compare" => Ok(Self::Compare),
            "tune" => Ok(Self::Tune),
            "map-only" => Ok(Self::MapOnly),
            _ => Err("write inspect, compare, tune or map-only".to_owned()),
        }
    }
}
