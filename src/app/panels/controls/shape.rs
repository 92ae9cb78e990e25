//! The controls of what wears the map: shape, mesh, and how the map lies on it.

use std::path::PathBuf;

use egui::{RichText, TextEdit, Ui};

use super::parameters as p;
use super::{OPEN_WIDTH, PanelContext};
use crate::app::panels::needles;
use crate::app::parameter::{Parameter, checkbox, choice, label};
use crate::app::view_state::NeedlesView;
use crate::app::{Command, theme};
use crate::scene::bump::BumpRule;
use crate::scene::{FrameRule, Reconstruction, Shape, ShapeKind};

/// Shows the shape, its own parameters and those of the map on it.
pub fn show(ui: &mut Ui, context: &mut PanelContext<'_>, shape: &mut Shape) {
    let mut kinds = ShapeKind::BUILT_IN.map(|kind| (kind, kind.label().to_owned())).to_vec();
    if let Some(model) = &shape.model {
        kinds.push((ShapeKind::Mesh, model.name()));
    }
    let kinds: Vec<(ShapeKind, &str)> = kinds.iter().map(|(kind, name)| (*kind, name.as_str())).collect();
    if let Some(kind) = choice(ui, "Shape", p::SHAPE, shape.kind, &kinds) {
        shape.kind = kind;
    }
    mesh(ui, context, shape);
    if shape.kind == ShapeKind::Mesh {
        frames(ui, &mut shape.frames);
    }
    if shape.kind == ShapeKind::Mesh || shape.reconstruction != Reconstruction::default() {
        let ways = Reconstruction::ALL.map(|way| (way, way.label()));
        let chosen = choice(ui, "Frame per pixel", p::RECONSTRUCTION, shape.reconstruction, &ways);
        shape.reconstruction = chosen.unwrap_or(shape.reconstruction);
    }
    if shape.kind == ShapeKind::Torus {
        radii(ui, &mut shape.radii);
    }
    texture(ui, shape);
    let has_relief = needles::can_show(context);
    if has_relief {
        bump(ui, shape);
    }
    draw_needles(ui, &mut context.view.needles, has_relief);
}

/// What is drawn over the surface: its frames and, of a relief, both normals.
fn draw_needles(ui: &mut Ui, view: &mut NeedlesView, has_relief: bool) {
    ui.horizontal(|ui| {
        label(ui, "Needles");
        checkbox(ui, &mut view.frames, NeedlesView::DEFAULT.frames, "frames", p::FRAME_NEEDLES);
        if has_relief {
            checkbox(ui, &mut view.shown, NeedlesView::DEFAULT.shown, "both normals", p::NEEDLES);
        }
    });
    if has_relief && view.shown {
        p::NEEDLE_SCALE.show_f32(ui, &mut view.scale);
    }
}

/// What the heights of a map are on the surface.
const BUMP: &str = "How the heights bump the surface. As a map of normals: their slopes count texels, whatever a texel \
                    covers. Blinn's normal and the exact one of the displaced surface (Mikkelsen's equation 25) take \
                    them in the surface's own units.";
const BUMP_SCALE: Parameter =
    Parameter { name: "Bump lambda", tooltip: "What a height of 1 is, in the surface's own units.", ..p::NEEDLE_SCALE };

/// How a relief bumps the surface.
fn bump(ui: &mut Ui, shape: &mut Shape) {
    let rules =
        [(None, "as a map of normals"), (Some(BumpRule::Blinn), "Blinn's normal"), (Some(BumpRule::Exact), "exact")];
    if let Some(rule) = choice(ui, "Bump", BUMP, shape.bump, &rules) {
        shape.bump = rule;
    }
    if shape.bump.is_some() {
        BUMP_SCALE.show_f32(ui, &mut shape.bump_scale);
    }
}

/// The rule of the mesh's frames.
fn frames(ui: &mut Ui, frames: &mut FrameRule) {
    let grouped = match *frames {
        FrameRule::Grouped { .. } => *frames,
        FrameRule::File | FrameRule::MikkTSpace => FrameRule::Grouped { threshold_deg: 180.0 },
    };
    let rules = [
        (FrameRule::File, "the file's own"),
        (FrameRule::MikkTSpace, "MikkTSpace"),
        (grouped, "groups (Mikkelsen 3.3)"),
    ];
    if let Some(rule) = choice(ui, "Frames", p::FRAMES, *frames, &rules) {
        *frames = rule;
    }
    if let FrameRule::Grouped { threshold_deg } = frames {
        p::FRAME_THRESHOLD.show_f32(ui, threshold_deg);
    }
}

/// Opens a mesh, and says what is odd about the one that is shown.
fn mesh(ui: &mut Ui, context: &mut PanelContext<'_>, shape: &Shape) {
    ui.horizontal(|ui| {
        let width = ui.available_width() - OPEN_WIDTH - ui.spacing().item_spacing.x;
        let field = TextEdit::singleline(&mut context.view.typed_mesh_path).hint_text("Path of a mesh, or drop one");
        let response = ui.add_sized([width, theme::ROW], field).accessible_name("Path of a mesh");
        let entered = response.lost_focus() && ui.input(|input| input.key_pressed(egui::Key::Enter));
        if entered && !context.view.typed_mesh_path.trim().is_empty() {
            context.push(Command::OpenMesh(PathBuf::from(context.view.typed_mesh_path.trim())));
        }
        let open = egui::Button::new("Open…");
        if ui.add_sized([OPEN_WIDTH, theme::ROW], open).accessible_name("Open a mesh").on_hover_text(p::MESH).clicked()
        {
            context.push(Command::OpenMeshDialog);
        }
    });
    let Some(model) = shape.model.as_ref().filter(|_| shape.kind == ShapeKind::Mesh) else { return };
    let (mesh, splits) = (model.mesh(shape.frames), model.splits(shape.frames));
    let (triangles, vertices) = (mesh.indices.len() / 3, mesh.vertices.len());
    let figures = format!("{triangles} triangles · {vertices} vertices · {splits} split frames");
    ui.label(RichText::new(figures).small().color(theme::of(ui).weak)).on_hover_text(p::SPLITS);
    for warning in &model.warnings {
        let text = RichText::new(format!("{warning}.")).small().color(theme::of(ui).warning);
        ui.add(egui::Label::new(text).wrap());
    }
}

/// The torus's radii; the tube stays thinner than the ring.
fn radii(ui: &mut Ui, radii: &mut [f32; 2]) {
    let [ring, tube] = radii;
    let ring_moved = p::RING_RADIUS.show_f32(ui, ring);
    let tube_moved = p::TUBE_RADIUS.show_f32(ui, tube);
    if ring_moved {
        *tube = tube.min(0.99 * *ring);
    } else if tube_moved {
        *ring = ring.max(*tube / 0.99);
    }
}

fn texture(ui: &mut Ui, shape: &mut Shape) {
    let [mut across, mut down] = shape.tiling;
    if p::TILING_U.show_f32(ui, &mut across) | p::TILING_V.show_f32(ui, &mut down) {
        shape.tiling = [across, down];
    }
    p::SHEAR.show_f32(ui, &mut shape.shear);
    p::TURN.show_f32(ui, &mut shape.turn_deg);
    ui.horizontal(|ui| {
        label(ui, "Orientation");
        checkbox(ui, &mut shape.mirrored, false, "mirrored", p::MIRRORED);
    });
}
