//! An adapter too small for the map: the finest levels are left out, said, and drawn from the coarser ones.

use std::sync::Arc;

use glam::Vec3;
use ndf_inspector::app::viewport::SurfaceReport;
use ndf_inspector::filter::vmf::{Fold, Rules};
use ndf_inspector::filter::{Filter, Method, Truth, UnalignedVmf, VmfFilter};
use ndf_inspector::gpu::context::device_descriptor;
use ndf_inspector::gpu::{FrameBudget, FrameInput, Gpu, PICTURE_FORMAT, SurfaceFrame};
use ndf_inspector::normal_map::{Addressing, NormalMap};
use ndf_inspector::reference::{self, Picture};
use ndf_inspector::scene::{Shape, ShapeKind};

use super::twins::{SAMPLES, assert_alike};
use super::{Scene, gpu, maps};

/// The adapter of the other tests, with textures of `side` texels at most.
fn small(side: u32) -> Gpu {
    let Gpu { instance, adapter, choice, .. } = gpu();
    let mut descriptor = device_descriptor(adapter);
    descriptor.required_limits.max_texture_dimension_2d = side;
    let (device, queue) = pollster::block_on(adapter.request_device(&descriptor)).expect("a device of low limits");
    Gpu { instance: instance.clone(), adapter: adapter.clone(), device, queue, choice: choice.clone() }
}

fn picture(gpu: &Gpu, scene: &Scene, method: Method) -> (SurfaceFrame, Picture) {
    let mut frame = SurfaceFrame::new(&gpu.device, PICTURE_FORMAT);
    frame.budget = FrameBudget { truth_limit: SAMPLES, truth_batch: 64, upload_bytes: 1 << 30 };
    frame.complete(gpu, &scene.input(method)).expect("the device works");
    let texels = frame.linear(&gpu.device, &gpu.queue, method).expect("readable");
    let picture = Picture {
        size: scene.size,
        rgb: texels.iter().map(|t| Vec3::new(t[0], t[1], t[2])).collect(),
        covered: texels.iter().map(|t| t[3] > 0.5).collect(),
    };
    (frame, picture)
}

/// A level of a map as a map of its own: mean normals and mean colours.
fn level_as_map(scene: &Scene, level: usize) -> Arc<NormalMap> {
    let (width, height) = scene.map().level_sizes()[level];
    let at = |x: usize, y: usize| scene.mip.levels[level][y * width + x];
    let map = maps::map(width, height, scene.map().options.addressing, at);
    maps::with_color(map, |index| scene.mip.colors[level][index])
}

#[test]
fn levels_beyond_the_adapters_limit_are_left_out_and_the_others_drawn_right() {
    let gpu = small(192);
    // 400x300, 200x150, 100x75: the first that fits is level 2.
    let map = maps::with_color(maps::rough(400, 300, Addressing::Wrap), maps::any_color);
    for (kind, distance) in [(ShapeKind::Plane, 1.2), (ShapeKind::Torus, 3.2)] {
        let mut scene = Scene::new(map.clone(), 3);
        scene.surface.shape = Shape { tiling: [1.0, 1.0], ..Shape::of_kind(kind) };
        scene.surface.camera.distance = distance;
        let coarsest = scene.full_lod_range()[1];
        let vmf = VmfFilter { lobes: Arc::new(scene.lobes.clone()), fold: Fold::default(), rules: Rules::default() };
        let filters: [(Method, Box<dyn Filter>); 4] = [
            (Method::Truth, Box::new(Truth { map: level_as_map(&scene, 2), samples: SAMPLES })),
            (Method::MIP, Box::new((*scene.mip).clone())),
            (Method::Vmf, Box::new(vmf.clone())),
            (Method::VmfUnaligned, Box::new(UnalignedVmf(vmf))),
        ];
        for (method, filter) in filters {
            let (frame, adapter) = picture(&gpu, &scene, method);
            assert_eq!((frame.left_out(), frame.lobes_left_out()), (2, 2));
            if method != Method::Truth {
                assert_eq!(frame.lod_range(method), Some([2.0, coarsest]));
            }
            let processor = reference::render(&scene.surface, &*filter, scene.size, [2.0, coarsest], (400, 300));
            assert_alike(&adapter, &processor, &format!("{method} without two levels, {kind:?}"));
        }
    }
}

#[test]
fn a_map_that_just_fits_is_whole() {
    let scene = Scene::new(maps::rough(192, 64, Addressing::Clamp), 2);
    let (frame, _) = picture(&small(192), &scene, Method::Vmf);
    assert_eq!((frame.left_out(), frame.lobes_left_out()), (0, 0));
    assert_eq!(frame.lod_range(Method::Vmf), Some(scene.full_lod_range()));
}

#[test]
fn a_picture_larger_than_a_texture_is_drawn_as_large_as_one() {
    let scene = Scene { size: [300, 100], ..Scene::new(maps::rough(16, 16, Addressing::Wrap), 2) };
    let gpu = small(192);
    let mut frame = SurfaceFrame::new(&gpu.device, PICTURE_FORMAT);
    frame.complete(&gpu, &FrameInput { ..scene.input(Method::MIP) }).expect("the device works");
    let texels = frame.linear(&gpu.device, &gpu.queue, Method::MIP).expect("readable");
    assert_eq!(texels.len(), 192 * 100);
}

#[test]
fn what_is_left_out_is_said() {
    let sentence = |left_out, lobes_left_out| {
        SurfaceReport { left_out, lobes_left_out, ..SurfaceReport::default() }.left_out_sentence()
    };
    assert_eq!(sentence(0, 0), None);
    assert_eq!(sentence(1, 1).as_deref(), Some("the finest level exceeds the adapter and is left out"));
    assert_eq!(sentence(2, 2).as_deref(), Some("the finest 2 levels exceed the adapter and are left out"));
    assert_eq!(sentence(0, 2).as_deref(), Some("lobes of the finest 2 levels exceed the memory set aside"));
}
