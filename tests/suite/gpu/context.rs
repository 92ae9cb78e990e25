//! The choice of the adapter, and reading back.

use ndf_inspector::gpu::{context, readback};

use super::gpu;

#[test]
fn exactly_one_listed_adapter_would_be_used_and_it_is_of_the_best_rank() {
    let adapters = context::list();
    let used: Vec<_> = adapters.iter().filter(|a| a.used).collect();
    assert_eq!(used.len(), 1, "{adapters:?}");
    assert!(adapters.iter().all(|a| used[0].rank <= a.rank));
    assert_eq!(used[0].choice, gpu().choice);
}

#[test]
fn readback_returns_the_rows_of_any_width_without_padding() {
    let size = wgpu::Extent3d { width: 37, height: 3, depth_or_array_layers: 1 };
    let texture = gpu().device.create_texture(&wgpu::TextureDescriptor {
        label: Some("readback test"),
        size,
        mip_level_count: 1,
        sample_count: 1,
        dimension: wgpu::TextureDimension::D2,
        format: wgpu::TextureFormat::Rgba32Float,
        usage: wgpu::TextureUsages::COPY_DST | wgpu::TextureUsages::COPY_SRC,
        view_formats: &[],
    });
    let texels: Vec<[f32; 4]> = (0..37 * 3).map(|i| [i as f32, 0.5, -1.0, 2.0]).collect();
    let layout = wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(37 * 16), rows_per_image: None };
    gpu().queue.write_texture(texture.as_image_copy(), bytemuck::cast_slice(&texels), layout, size);
    let read = readback::read_rgba32f(&gpu().device, &gpu().queue, &texture).expect("readable");
    assert_eq!(read, texels);
}
