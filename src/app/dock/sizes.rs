//! How panels share the window: those beside the main ones keep their width or height in points, the main ones take
//! what is left.

use egui::Vec2;
use egui_tiles::{Container, Linear, LinearDir, Tile, TileId, Tiles};

use super::preset::Panel;

/// Between two panels, points.
pub const GAP: f32 = 1.0;

/// Width and height of a panel beside the main ones that has come to a place, points.
const USUAL: [f32; 2] = [300.0, 180.0];

/// The most of a row or a column that panels beside the main ones may take.
const MOST_BESIDE: f32 = 0.7;

/// Shares `size` out among what stands in a tile.
pub fn spread(tiles: &mut Tiles<Panel>, id: TileId, size: Vec2) {
    let Some(Tile::Container(container)) = tiles.get(id) else { return };
    let Container::Linear(linear) = container else {
        for child in container.children_vec() {
            spread(tiles, child, size);
        }
        return;
    };
    let dir = linear.dir;
    let wishes: Vec<(TileId, f32)> = linear.children.iter().map(|&child| (child, wish(tiles, linear, child))).collect();
    let (shown, hidden): (Vec<_>, Vec<_>) =
        wishes.into_iter().partition(|&(child, _)| tiles.is_visible_in_layout(child));
    let grow: Vec<bool> = shown.iter().map(|&(child, _)| holds_main(tiles, child)).collect();
    let along = if dir == LinearDir::Horizontal { size.x } else { size.y };
    let room = along - GAP * shown.len().saturating_sub(1) as f32;
    let (sizes, growth) = share_out(room.max(1.0), &shown.iter().map(|&(_, wish)| wish).collect::<Vec<_>>(), &grow);
    // What is out of sight keeps its part of what grows.
    let unseen =
        hidden.into_iter().map(|(child, wish)| (child, if has_main(tiles, child) { wish * growth } else { wish }));
    let unseen: Vec<(TileId, f32)> = unseen.collect();
    let sizes: Vec<(TileId, f32)> = shown.into_iter().map(|(child, _)| child).zip(sizes).collect();
    if let Some(Tile::Container(Container::Linear(linear))) = tiles.get_mut(id) {
        sizes.iter().chain(&unseen).for_each(|&(child, share)| linear.shares.set_share(child, share));
    }
    for (child, share) in sizes {
        let size = if dir == LinearDir::Horizontal { Vec2::new(share, size.y) } else { Vec2::new(size.x, share) };
        spread(tiles, child, size);
    }
}

/// How large a part was, or is to be where it has come just now.
fn wish(tiles: &Tiles<Panel>, linear: &Linear, child: TileId) -> f32 {
    if let Some((_, share)) = linear.shares.iter().find(|(id, _)| **id == child) {
        return share.max(1.0);
    }
    let main = linear.children.iter().filter(|&&other| other != child && has_main(tiles, other));
    let largest = main.map(|&other| linear.shares[other]).fold(1.0, f32::max);
    match (has_main(tiles, child), linear.dir) {
        (true, _) => largest,
        (false, LinearDir::Horizontal) => USUAL[0],
        (false, LinearDir::Vertical) => USUAL[1],
    }
}

/// True where a main panel stands, in sight or not.
fn has_main(tiles: &Tiles<Panel>, id: TileId) -> bool {
    match tiles.get(id) {
        Some(Tile::Pane(panel)) => panel.is_main(),
        Some(Tile::Container(container)) => container.children().any(|&child| has_main(tiles, child)),
        None => false,
    }
}

/// True where a main panel is in sight.
fn holds_main(tiles: &Tiles<Panel>, id: TileId) -> bool {
    match tiles.get(id) {
        Some(Tile::Pane(panel)) => panel.is_main() && tiles.is_visible(id),
        Some(Tile::Container(container)) => container.children().any(|&child| holds_main(tiles, child)),
        None => false,
    }
}

/// Shares `room` out: who does not grow gets what it wishes, within reason, the others the rest; with it, the factor by
/// which these grew.
fn share_out(room: f32, wishes: &[f32], grow: &[bool]) -> (Vec<f32>, f32) {
    let total = |growing: bool| -> f32 {
        let wishes = wishes.iter().zip(grow).filter(|(_, grows)| **grows == growing);
        wishes.map(|(wish, _)| wish.max(1.0)).sum()
    };
    let (fixed, growing) = (total(false), total(true));
    let beside = if growing > 0.0 { fixed.min(MOST_BESIDE * room) } else { room };
    let size = |(wish, grows): (&f32, &bool)| {
        let wish = wish.max(1.0);
        if *grows { wish * (room - beside) / growing } else { wish * beside / fixed }
    };
    let growth = if growing > 0.0 { (room - beside) / growing } else { 1.0 };
    (wishes.iter().zip(grow).map(size).collect(), growth)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_stands_beside_keeps_its_size_while_the_window_grows() {
        let (wishes, grow) = ([272.0, 690.0, 316.0], [false, true, false]);
        assert_eq!(share_out(1278.0, &wishes, &grow).0, [272.0, 690.0, 316.0]);
        assert_eq!(share_out(1918.0, &wishes, &grow).0, [272.0, 1330.0, 316.0]);
    }

    #[test]
    fn a_narrow_window_leaves_room_for_the_main_panels() {
        let (sizes, _) = share_out(500.0, &[272.0, 690.0, 316.0], &[false, true, false]);
        assert!((sizes[1] - 150.0).abs() < 0.1 && (sizes.iter().sum::<f32>() - 500.0).abs() < 0.1, "{sizes:?}");
    }

    #[test]
    fn panels_that_stand_alone_share_all_there_is() {
        assert_eq!(share_out(300.0, &[50.0, 100.0], &[false, false]).0, [100.0, 200.0]);
        assert_eq!(share_out(300.0, &[1.0, 1.0], &[true, true]).0, [150.0, 150.0]);
    }

    #[test]
    fn main_panels_that_come_into_sight_later_are_as_large_as_the_others() {
        let mut tree = super::super::place::tree(&super::super::place::default_place());
        let (surface, map) = (super::super::place::tile(Panel::Surface), super::super::place::tile(Panel::Map));
        let figures = super::super::place::tile(Panel::Figures);
        let root = tree.root().expect("a root");
        for (hidden, width) in [([map, figures], 690.0), ([figures, figures], 344.5)] {
            for tile in [surface, map, figures] {
                tree.set_visible(tile, !hidden.contains(&tile));
            }
            spread(&mut tree.tiles, root, Vec2::new(1280.0, 740.0));
            let row = tree.tiles.parent_of(surface).expect("a row");
            let Some(Container::Linear(row)) = tree.tiles.get_container(row) else { panic!("no row") };
            assert!((row.shares[surface] - width).abs() < 0.1, "{} of {width}", row.shares[surface]);
        }
    }
}
