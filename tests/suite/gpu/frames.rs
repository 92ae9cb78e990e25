//! What a frame does from one to the next: uploads in slices, a truth that grows, and no work without a change.

use glam::Vec3;
use ndf_inspector::color::srgb8_from_linear;
use ndf_inspector::comparison::{Arrangement, Difference, DifferenceKind};
use ndf_inspector::filter::LevelChoice;
use ndf_inspector::filter::Method;
use ndf_inspector::gpu::pass_timer::PassTimer;
use ndf_inspector::gpu::snapshots::Snapshots;
use ndf_inspector::gpu::{FrameBudget, FrameInput, PICTURE_FORMAT, SurfaceFrame, render_to_rgba8};
use ndf_inspector::normal_map::Addressing;

use super::{Scene, gpu, maps};

fn frame(truth_limit: u32, truth_batch: u32) -> SurfaceFrame {
    let mut frame = SurfaceFrame::new(&gpu().device, PICTURE_FORMAT);
    frame.budget = FrameBudget { truth_limit, truth_batch, upload_bytes: 1 << 30 };
    frame
}

/// One frame, as the window records it.
fn step(frame: &mut SurfaceFrame, input: &FrameInput<'_>) {
    let label = wgpu::CommandEncoderDescriptor { label: Some("test frame") };
    let mut encoder = gpu().device.create_command_encoder(&label);
    frame.prepare(&gpu().device, &gpu().queue, &mut encoder, input);
    gpu().queue.submit([encoder.finish()]);
}

/// The picture by lobes, in one frame.
fn by_lobes(scene: &Scene) -> Vec<[f32; 4]> {
    let mut frame = frame(16, 16);
    step(&mut frame, &scene.input(Method::Vmf));
    linear(&frame, Method::Vmf)
}

fn at_a_wipe(scene: &Scene, methods: [Method; 2], wipe: f32) -> FrameInput<'_> {
    let arrangement = Arrangement::Wipe(wipe);
    FrameInput { methods: methods.map(Into::into).into(), arrangement, ..scene.input(methods[0]) }
}

fn linear(frame: &SurfaceFrame, method: Method) -> Vec<[f32; 4]> {
    frame.linear(&gpu().device, &gpu().queue, method).expect("readable")
}

#[test]
fn the_truth_of_two_frames_of_32_samples_is_that_of_one_of_64() {
    let scene = Scene::new(maps::rough(64, 64, Addressing::Wrap), 2);
    let picture = |batch| {
        let mut frame = frame(64, batch);
        frame.complete(gpu(), &scene.input(Method::Truth)).expect("the device works");
        assert_eq!(frame.truth_samples(), 64);
        linear(&frame, Method::Truth)
    };
    // The two means are rounded once more than the one.
    for (two, one) in picture(32).iter().zip(picture(64)) {
        assert!((0..3).all(|c| (two[c] - one[c]).abs() <= 2e-6 * one[c]), "{two:?} and {one:?}");
    }
}

#[test]
fn the_truth_starts_again_for_another_light_but_not_for_another_fit_exposure_or_wipe() {
    let mut scene = Scene::new(maps::rough(16, 16, Addressing::Wrap), 2);
    let mut frame = frame(1024, 16);
    let both = |scene: &Scene, frame: &mut SurfaceFrame, wipe| {
        step(frame, &at_a_wipe(scene, [Method::Truth, Method::Vmf], wipe));
    };
    both(&scene, &mut frame, 0.5);
    both(&scene, &mut frame, 0.7);
    assert_eq!(frame.truth_samples(), 32);
    scene.lobes = maps::mixtures(scene.map(), 4);
    both(&scene, &mut frame, 0.5);
    scene.surface.exposure_stops = 1.0;
    both(&scene, &mut frame, 0.5);
    assert_eq!(frame.truth_samples(), 64);
    scene.surface.lights.as_mut_slice()[0].azimuth_deg += 1.0;
    both(&scene, &mut frame, 0.5);
    assert_eq!(frame.truth_samples(), 16);
    let other = Scene::new(maps::rough(16, 16, Addressing::Clamp), 2);
    both(&Scene { surface: scene.surface, ..other }, &mut frame, 0.5);
    assert_eq!(frame.truth_samples(), 16, "another map");
}

#[test]
fn a_finished_frame_wants_no_more() {
    let scene = Scene::new(maps::rough(16, 16, Addressing::Wrap), 2);
    let mut frame = frame(40, 16);
    let input = scene.input(Method::Truth);
    for expected in [16, 32, 40, 40] {
        step(&mut frame, &input);
        assert_eq!(frame.truth_samples(), expected);
        assert_eq!(frame.wants_more(), expected < 40);
    }
}

#[test]
fn uploads_in_slices_end_in_the_picture_of_one_upload_and_show_coarse_levels_meanwhile() {
    let map = maps::rough(64, 64, Addressing::Wrap);
    slices_end_in_the_whole(&Scene::new(map.clone(), 5));
    slices_end_in_the_whole(&Scene::new(maps::with_color(map, maps::any_color), 5));
}

fn slices_end_in_the_whole(scene: &Scene) {
    let input = scene.input(Method::Vmf);
    let (mut whole, mut sliced) = (frame(16, 16), frame(16, 16));
    whole.complete(gpu(), &input).expect("the device works");
    sliced.budget.upload_bytes = 5000;
    let (mut frames, mut ranges) = (0, Vec::new());
    while frames == 0 || sliced.wants_more() {
        step(&mut sliced, &input);
        ranges.extend(sliced.lod_range(Method::Vmf));
        frames += 1;
    }
    assert!(frames > 20, "{frames} frames");
    assert!(ranges.windows(2).all(|pair| pair[1][0] <= pair[0][0]), "finer and finer: {ranges:?}");
    assert_eq!(ranges.last(), Some(&[0.0, 6.0]));
    assert_eq!(linear(&sliced, Method::Vmf), linear(&whole, Method::Vmf));
}

#[test]
fn lobes_are_white_until_their_colours_are_fitted() {
    let plain = maps::rough(64, 64, Addressing::Wrap);
    let mut scene = Scene::new(maps::with_color(plain.clone(), maps::any_color), 5);
    scene.surface.level = LevelChoice::Fixed(2.5);
    let colors = std::mem::replace(&mut scene.lobes.colors, vec![None; 6]);
    let mut frame = frame(16, 16);
    step(&mut frame, &scene.input(Method::Vmf));
    let white = linear(&frame, Method::Vmf);
    scene.lobes.colors = colors;
    step(&mut frame, &scene.input(Method::Vmf));
    let colored = linear(&frame, Method::Vmf);
    assert!(!frame.wants_more());
    let at_once = by_lobes(&scene);
    assert!(colored == at_once, "colours that come later shade as those that come along");
    let without = Scene { surface: scene.surface, ..Scene::new(plain, 5) };
    let worst = white.iter().zip(by_lobes(&without)).map(|(a, b)| (a[0] - b[0]).abs());
    // Half precision of the weights.
    assert!(worst.fold(0.0, f32::max) < 1e-3);
    assert_ne!(white, colored);
}

#[test]
fn levels_that_are_not_fitted_are_not_read() {
    let mut scene = Scene::new(maps::rough(64, 64, Addressing::Wrap), 5);
    scene.lobes.coarse[0] = None;
    scene.lobes.coarse[1] = None;
    let mut frame = frame(16, 16);
    step(&mut frame, &scene.input(Method::Vmf));
    assert_eq!(frame.lod_range(Method::Vmf), Some([3.0, 6.0]));
    assert!(linear(&frame, Method::Vmf).iter().any(|texel| texel[0] > 0.1));
    scene.lobes.coarse.fill(None);
    step(&mut frame, &scene.input(Method::Vmf));
    assert_eq!(frame.lod_range(Method::Vmf), None);
    assert!(linear(&frame, Method::Vmf).iter().all(|texel| *texel == [0.0; 4]), "nothing is fitted, nothing is drawn");
}

#[test]
fn a_bump_lit_from_the_top_left_is_bright_at_its_top_left() {
    let mut scene = Scene::new(maps::bump(), 1);
    scene.surface.camera.elevation_deg = 89.9;
    scene.surface.shape.tiling = [1.0, 1.0];
    scene.surface.lights.as_mut_slice()[0].azimuth_deg = 135.0;
    for method in [Method::Truth, Method::MIP] {
        let mut frame = frame(16, 16);
        step(&mut frame, &scene.input(method));
        let picture = linear(&frame, method);
        let at = |x: usize, y: usize| Vec3::from_slice(&picture[y * 192 + x][..3]).element_sum();
        assert!(at(84, 60) > 3.0 * at(108, 84), "{method}: {} and {}", at(84, 60), at(108, 84));
        assert!(at(96, 72) > at(108, 84));
    }
}

#[test]
fn the_wipe_shows_the_left_method_on_its_left_and_the_right_one_on_its_right() {
    let scene = Scene::new(maps::rough(64, 64, Addressing::Wrap), 4);
    let picture =
        |left, right, wipe| render_to_rgba8(gpu(), &at_a_wipe(&scene, [left, right], wipe), 16).expect("readable");
    let (mip, vmf) = (picture(Method::MIP, Method::MIP, 0.5), picture(Method::Vmf, Method::MIP, 1.0));
    assert_ne!(mip, vmf);
    let both = picture(Method::MIP, Method::Vmf, 0.5);
    for (i, pixel) in both.chunks(4).enumerate() {
        let expected = match i % 192 {
            95 | 96 => &[231, 231, 231, 255][..],
            x if x < 95 => &mip[4 * i..4 * i + 4],
            _ => &vmf[4 * i..4 * i + 4],
        };
        assert_eq!(pixel, expected, "pixel {i}");
    }
}

#[test]
fn a_cell_of_a_grid_is_the_picture_of_its_method_alone() {
    let scene = Scene { size: [191, 143], ..Scene::new(maps::rough(64, 64, Addressing::Wrap), 4) };
    let methods = [Method::Truth, Method::MIP, Method::Vmf, Method::VmfUnaligned];
    let arrangement = Arrangement::Grid { side: 2 };
    let grid = FrameInput { methods: methods.map(Into::into).into(), arrangement, ..scene.input(methods[0]) };
    let whole = render_to_rgba8(gpu(), &grid, 16).expect("readable");
    let cell = Scene { size: arrangement.cell_size(scene.size), ..scene };
    for (method, [left, top]) in methods.into_iter().zip(arrangement.cell_origins([191, 143])) {
        let alone = render_to_rgba8(gpu(), &cell.input(method), 16).expect("readable");
        // Two pixels part it from its neighbours; a row and a column reach past the edge.
        for (x, y) in (2..71).flat_map(|y| (2..95).map(move |x| (x, y))) {
            let pixel =
                |picture: &[u8], width: u32, x: u32, y: u32| picture[4 * (y * width + x) as usize..][..4].to_vec();
            let expected = pixel(&alone, cell.size[0], x, y);
            assert_eq!(pixel(&whole, 191, left + x, top + y), expected, "{method} at ({x}, {y})");
        }
    }
}

#[test]
fn a_difference_has_the_colour_of_its_scale() {
    let mut scene = Scene::new(maps::rough(64, 64, Addressing::Wrap), 4);
    scene.surface.exposure_stops = 0.5;
    for (kind, _) in DifferenceKind::ALL {
        let difference = Difference { kind, range: 0.1 };
        let arrangement = Arrangement::Difference(difference);
        let input = FrameInput { arrangement, ..at_a_wipe(&scene, [Method::MIP, Method::Vmf], 0.5) };
        let mut frame = frame(1, 1);
        step(&mut frame, &input);
        let [left, right] = [Method::MIP, Method::Vmf].map(|method| linear(&frame, method));
        let bytes = render_to_rgba8(gpu(), &input, 1).expect("readable");
        let mut colors = std::collections::BTreeSet::new();
        for (i, pixel) in bytes.chunks(4).enumerate().filter(|(i, _)| left[*i][3] > 0.5) {
            let value = kind.of(Vec3::from_slice(&left[i][..3]), Vec3::from_slice(&right[i][..3]));
            // Both round to a code, after sums in another order.
            let expected = difference.color(value);
            assert!((0..3).all(|c| pixel[c].abs_diff(expected[c]) <= 1), "{pixel:?} against {expected:?} of {value}");
            colors.insert(expected);
        }
        assert!(colors.len() > 50, "only {} colours", colors.len());
    }
}

/// Frames until nothing is drawn any more and nothing is on its way.
fn finish(frame: &mut SurfaceFrame, input: &FrameInput<'_>) {
    for _ in 0..100 {
        step(frame, input);
        gpu().device.poll(wgpu::PollType::wait_indefinitely()).expect("the device works");
        if !frame.wants_more() && !frame.is_waiting() {
            return;
        }
    }
    panic!("the frame does not end");
}

#[test]
fn pictures_come_back_as_they_were_drawn_with_a_truth_that_nobody_sees() {
    let mut scene = Scene::new(maps::rough(64, 64, Addressing::Wrap), 2);
    let mut frame = frame(150, 16);
    frame.against_truth = true;
    finish(&mut frame, &scene.input(Method::MIP));
    let snapshots = frame.snapshots().clone();
    let (truth, earlier) = (snapshots.truth.expect("read back"), snapshots.earlier_truth.expect("read back"));
    assert_eq!((truth.samples, earlier.samples, snapshots.methods.len()), (150, 64, 1));
    for snapshot in [&truth, &snapshots.methods[0]] {
        let picture = snapshot.readback.picture().expect("here");
        let drawn = linear(&frame, snapshot.method);
        assert!(picture.rgb.iter().zip(&drawn).all(|(back, texel)| back.to_array() == texel[..3]));
        assert!(picture.covered.iter().zip(&drawn).all(|(covered, texel)| *covered == (texel[3] > 0.5)));
    }
    step(&mut frame, &scene.input(Method::MIP));
    assert_eq!(frame.snapshots().truth, Some(truth), "nothing has changed");
    scene.surface.lights.as_mut_slice()[0].azimuth_deg += 1.0;
    step(&mut frame, &scene.input(Method::MIP));
    assert_eq!(*frame.snapshots(), Snapshots::default(), "all has changed");
}

#[test]
fn the_passes_of_methods_are_timed_where_the_adapter_has_a_clock() {
    let scene = Scene::new(maps::rough(64, 64, Addressing::Wrap), 2);
    let mut frame = frame(16, 16);
    frame.timer = PassTimer::new(&gpu().device, &gpu().queue);
    let Some(_) = &frame.timer else { return };
    finish(&mut frame, &at_a_wipe(&scene, [Method::Truth, Method::Vmf], 0.5));
    let milliseconds = |method| frame.timer.as_ref().and_then(|timer| timer.milliseconds(method));
    assert!(milliseconds(Method::Vmf).is_some_and(|time| (1e-4..1e4).contains(&time)));
    assert_eq!(milliseconds(Method::Truth), None, "samples of a picture are no picture");
}

#[test]
fn the_picture_is_exposed_and_encoded_once() {
    let mut scene = Scene::new(maps::rough(64, 64, Addressing::Wrap), 4);
    scene.surface.exposure_stops = 0.7;
    let mut frame = frame(1, 1);
    step(&mut frame, &scene.input(Method::MIP));
    let linear = linear(&frame, Method::MIP);
    let bytes = render_to_rgba8(gpu(), &scene.input(Method::MIP), 1).expect("readable");
    for (i, pixel) in bytes.chunks(4).enumerate().filter(|(i, _)| linear[*i][3] > 0.5) {
        let expected = srgb8_from_linear(Vec3::from_slice(&linear[i][..3]));
        assert!((0..3).all(|c| pixel[c].abs_diff(expected[c]) <= 1), "{pixel:?} against {expected:?}");
    }
}
