//! The figures on the picture: they are those of the pictures that are shown, of the whole or of a region.

use egui::{Event, Key, Modifiers, PointerButton, Pos2, vec2};
use egui_kittest::kittest::Queryable;
use glam::Vec3;
use ndf_inspector::comparison::{Arrangement, Comparison};
use ndf_inspector::filter::Method;
use ndf_inspector::gpu::{FrameBudget, FrameInput, Gpu, PICTURE_FORMAT, SurfaceFrame};
use ndf_inspector::reference::{Compared, Figures, Picture, standard_error};

use super::behaviour::press;
use super::{Window, fitted, settle, window};

/// What the window shows of each method, drawn on its own, with so many samples of the truth.
fn pictures<const N: usize>(window: &Window, methods: [Method; N], samples: u32) -> [Picture; N] {
    let gpu = Gpu::headless().expect("an adapter");
    let (session, rect) = (&window.state().inspector.session, window.get_by_label("Surface view").rect());
    let size = [rect.width().round() as u32, rect.height().round() as u32];
    methods.map(|method| {
        let input = FrameInput {
            surface: &session.surface,
            mip: session.mip(),
            lobes: session.lobes(),
            fold: session.fitting().fold(),
            methods: vec![session.shown_method(method)],
            arrangement: Arrangement::Grid { side: 1 },
            size,
        };
        let mut frame = SurfaceFrame::new(&gpu.device, PICTURE_FORMAT);
        frame.budget = FrameBudget { truth_limit: samples, ..FrameBudget::default() };
        frame.complete(&gpu, &input).expect("the device works");
        let texels = frame.linear(&gpu.device, &gpu.queue, method).expect("readable");
        Picture {
            size,
            rgb: texels.iter().map(|texel| Vec3::from_slice(&texel[..3])).collect(),
            covered: texels.iter().map(|texel| texel[3] > 0.5).collect(),
        }
    })
}

fn figures(window: &Window, method: Method) -> Figures {
    let live = window.state().inspector.live_figures();
    assert!(live.is_current(), "the figures are stale");
    live.of(method).expect("worked out")
}

pub(super) fn shift_drag(window: &mut Window, from: Pos2, to: Pos2) {
    let button = |pos, pressed| Event::PointerButton {
        pos,
        button: PointerButton::Primary,
        pressed,
        modifiers: Modifiers::SHIFT,
    };
    for event in [
        Event::PointerMoved(from),
        button(from, true),
        Event::PointerMoved(from.lerp(to, 0.5)),
        Event::PointerMoved(to),
    ] {
        window.event_modifiers(event, Modifiers::SHIFT);
        window.step();
    }
    window.event_modifiers(button(to, false), Modifiers::SHIFT);
    window.run();
}

#[test]
fn figures_are_those_of_the_pictures_shown_and_of_the_region_that_is_drawn() {
    let mut window = window(fitted("plate", 64));
    window.state_mut().inspector.session.surface.exposure_stops = 0.5;
    settle(&mut window);
    let [truth, vmf] = pictures(&window, [Method::Truth, Method::Vmf], 16);
    let compared = Compared::new(vmf, truth);
    let whole = figures(&window, Method::Vmf);
    // One adapter draws both: the same to the last digit.
    assert_eq!(whole, compared.figures(None));
    let picture = window.get_by_label("Surface view").rect();
    let camera = window.state().inspector.session.surface.camera;
    shift_drag(&mut window, picture.min + 0.7 * picture.size(), picture.min + vec2(0.4, 0.5) * picture.size());
    settle(&mut window);
    let region = window.state().inspector.view.region.chosen.expect("a region is drawn");
    assert_eq!(window.state().inspector.session.surface.camera, camera, "drawing a region orbits");
    let close = |a: [f32; 2], b: [f32; 2]| (0..2).all(|axis| (a[axis] - b[axis]).abs() < 0.01);
    assert!(close(region.min, [0.4, 0.5]) && close(region.max, [0.7, 0.7]), "{region:?}");
    let of_region = figures(&window, Method::Vmf);
    assert_eq!(of_region, compared.figures(Some(region)));
    assert_ne!(of_region, whole);
    window.key_press(Key::Escape);
    settle(&mut window);
    assert_eq!((window.state().inspector.view.region.chosen, figures(&window, Method::Vmf)), (None, whole));
}

#[test]
fn the_truth_states_the_error_that_its_halves_tell() {
    let mut window = window(fitted("plate", 64));
    window.state_mut().inspector.session.truth_samples = 128;
    settle(&mut window);
    let ([whole], [half]) = (pictures(&window, [Method::Truth], 128), pictures(&window, [Method::Truth], 64));
    let stated = window.state().inspector.live_figures().standard_error().expect("two halves");
    let expected = standard_error(&half, &whole).expect("seen");
    // The means are taken in other batches.
    assert!((stated / expected - 1.0).abs() < 1e-3, "{stated}, not {expected}");
}

#[test]
fn a_method_alone_has_figures_until_they_are_hidden() {
    let mut window = window(fitted("plate", 64));
    window.state_mut().inspector.session.comparison = Comparison::alone(Method::MIP);
    settle(&mut window);
    let first = figures(&window, Method::MIP);
    let label = |window: &Window| window.query_by_label_contains("Figures of plain mip").is_some();
    assert!(label(&window) && first.normalised_color_error > Some(0.0), "{first:?}");
    window.state_mut().inspector.session.surface.material.shininess = 10.0;
    // The next picture is to be of this material, not of what the window had before.
    window.run();
    settle(&mut window);
    assert_ne!(figures(&window, Method::MIP), first, "figures of another material");
    let button = window.get_by_label("Figures").rect().center();
    press(&mut window, button, PointerButton::Primary, true);
    press(&mut window, button, PointerButton::Primary, false);
    settle(&mut window);
    assert!(!label(&window) && !window.state().inspector.live_figures().is_current());
}
