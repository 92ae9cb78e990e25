//! Where panels stand, as a session file has it: rows, columns and tabs of panels.

use egui_tiles::{Container, Linear, LinearDir, Tabs, Tile, TileId, Tiles, Tree};
use serde::{Deserialize, Serialize};

use super::preset::Panel;

/// A panel, or several of them and how they share their place.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Place {
    /// One panel.
    Panel(Panel),
    /// From left to right.
    Row(Vec<Part>),
    /// From top to bottom.
    Column(Vec<Part>),
    /// Behind each other.
    Tabs {
        /// Which is in front, counted from 0.
        front: usize,
        /// What stands there.
        places: Vec<Place>,
    },
}

/// A part of a row or a column.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Part {
    /// Points along the row or column, at the size the window had.
    pub size: f32,
    /// What stands there.
    pub place: Place,
}

/// The sizes that are believed, points.
const SIZES: [f32; 2] = [1.0, 16_384.0];

/// Where the panels stand unless they are moved.
pub fn default_place() -> Place {
    let part = |size, place| Part { size, place };
    let panel = |size, panel| part(size, Place::Panel(panel));
    let main = [Panel::Surface, Panel::Map, Panel::Figures].map(|main| panel(1.0, main));
    let middle = vec![part(600.0, Place::Row(main.into())), panel(156.0, Panel::Levels)];
    Place::Row(vec![panel(272.0, Panel::Controls), part(690.0, Place::Column(middle)), panel(316.0, Panel::Texel)])
}

/// The tile of a panel, the same in every tree.
pub fn tile(panel: Panel) -> TileId {
    TileId::from_u64(1 + panel as u64)
}

/// A tree of these places. Every panel stands in it once, whatever `place` says: one that is doubled keeps its first
/// place, one that is missing stands at the end.
pub fn tree(place: &Place) -> Tree<Panel> {
    let mut tiles = Tiles::default();
    for panel in Panel::ALL {
        tiles.insert(tile(panel), Tile::Pane(panel));
    }
    let mut left = Panel::ALL.to_vec();
    let root = insert(&mut tiles, place, &mut left);
    let missing = left.into_iter().map(tile);
    let children: Vec<TileId> = root.into_iter().chain(missing).collect();
    let root = match children[..] {
        [only] => only,
        _ => tiles.insert_horizontal_tile(children),
    };
    Tree::new(egui::Id::unique("dock"), root, tiles)
}

/// Puts what is `left` of the panels where `place` has them; `None` where it has none.
fn insert(tiles: &mut Tiles<Panel>, place: &Place, left: &mut Vec<Panel>) -> Option<TileId> {
    match place {
        Place::Panel(panel) => {
            let index = left.iter().position(|other| other == panel)?;
            Some(tile(left.remove(index)))
        }
        Place::Row(parts) => insert_linear(tiles, LinearDir::Horizontal, parts, left),
        Place::Column(parts) => insert_linear(tiles, LinearDir::Vertical, parts, left),
        Place::Tabs { front, places } => {
            let placed: Vec<Option<TileId>> = places.iter().map(|place| insert(tiles, place, left)).collect();
            let active = placed.get(*front).copied().flatten();
            let mut tabs = Tabs::new(placed.into_iter().flatten().collect());
            tabs.active = active.or(tabs.active);
            (!tabs.children.is_empty()).then(|| tiles.insert_container(tabs))
        }
    }
}

fn insert_linear(tiles: &mut Tiles<Panel>, dir: LinearDir, parts: &[Part], left: &mut Vec<Panel>) -> Option<TileId> {
    let mut linear = Linear { dir, ..Linear::default() };
    for Part { size, place } in parts {
        if let Some(child) = insert(tiles, place, left) {
            linear.add_child(child);
            let size = if size.is_finite() { size.clamp(SIZES[0], SIZES[1]) } else { SIZES[0] };
            linear.shares.set_share(child, size);
        }
    }
    (!linear.children.is_empty()).then(|| tiles.insert_container(linear))
}

/// The places of a tree.
pub fn read(tree: &Tree<Panel>) -> Option<Place> {
    place(tree, tree.root()?)
}

fn place(tree: &Tree<Panel>, id: TileId) -> Option<Place> {
    let linear = match tree.tiles.get(id)? {
        Tile::Pane(panel) => return Some(Place::Panel(*panel)),
        Tile::Container(Container::Linear(linear)) => linear,
        Tile::Container(container) => {
            let children = container.children_vec();
            let in_front = container.active_children(&tree.tiles).next();
            let front = children.iter().position(|child| Some(*child) == in_front).unwrap_or_default();
            let mut places: Vec<Place> = children.into_iter().filter_map(|child| place(tree, child)).collect();
            let only = if places.len() == 1 { places.pop() } else { None };
            return Some(only.unwrap_or(Place::Tabs { front, places }));
        }
    };
    let part = |&child: &TileId| Some(Part { size: linear.shares[child].round(), place: place(tree, child)? });
    let parts = linear.children.iter().filter_map(part).collect();
    Some(if linear.dir == LinearDir::Horizontal { Place::Row(parts) } else { Place::Column(parts) })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_come_back_from_their_tree_and_from_json() {
        let mut place = default_place();
        assert_eq!(read(&tree(&place)), Some(place.clone()));
        if let Place::Row(parts) = &mut place {
            let [levels, texel] = [Panel::Levels, Panel::Texel].map(Place::Panel);
            parts[1].place = Place::Tabs { front: 1, places: vec![parts[1].place.clone(), levels, texel] };
            // Both stand in the middle by now, the levels among the main panels first.
            parts.truncate(2);
        }
        let read_back = read(&tree(&place)).expect("panels");
        let json = serde_json::to_string(&read_back).expect("serialises");
        assert_eq!(serde_json::from_str::<Place>(&json).expect("reads"), read_back);
        assert_eq!(read(&tree(&read_back)), Some(read_back));
    }

    #[test]
    fn every_panel_has_one_place_whatever_a_file_says() {
        let odd = [
            r#"{"row": []}"#,
            r#"{"panel": "map"}"#,
            r#"{"tabs": {"front": 9, "places": [{"panel": "map"}, {"panel": "map"}, {"column": []}]}}"#,
            r#"{"column": [{"size": -1e30, "place": {"panel": "texel"}}, {"size": 1e30, "place": {"panel": "map"}}]}"#,
        ];
        for json in odd {
            let tree = tree(&serde_json::from_str(json).expect("a place"));
            let panes = tree.tiles.tiles().filter(|tile| tile.is_pane()).count();
            let reached = read(&tree).map(|place| format!("{place:?}").matches("Panel(").count());
            assert_eq!((panes, reached), (Panel::ALL.len(), Some(Panel::ALL.len())), "{json}");
        }
    }
}
