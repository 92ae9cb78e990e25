//! Puts one or two pictures of the surface beside each other at a wipe, exposes them, and encodes sRGB, once.

use crate::gpu::layout::{self, bind_group, bind_group_layout, texture, uniform_buffer};

/// The shader's parts, in order.
pub const SHADER: [&str; 2] = [layout::SRGB, include_str!("../../../shaders/compare.wgsl")];

/// The pass's constants; `Compare` in the shader.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct CompareData {
    /// What the left picture is multiplied by.
    pub left_scale: f32,
    /// What the right picture is multiplied by.
    pub right_scale: f32,
    /// Where the left side ends, in pixels.
    pub wipe: f32,
    /// Half the divider's width in pixels; 0 for none.
    pub divider: f32,
}

/// Pipeline, constants and the two pictures.
#[derive(Debug)]
pub struct ComparePass {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    constants: wgpu::Buffer,
    pictures: Option<wgpu::BindGroup>,
}

impl ComparePass {
    /// Compiles the pipeline for targets of `format`, which must not encode sRGB itself.
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let picture = texture(wgpu::TextureSampleType::Uint, wgpu::TextureViewDimension::D2);
        let types = [layout::UNIFORM, picture, picture];
        let layout = bind_group_layout(device, "compare", wgpu::ShaderStages::FRAGMENT, &types);
        let pipeline = pipeline(device, &layout, format);
        Self { pipeline, layout, constants: uniform_buffer::<CompareData>(device, "compare"), pictures: None }
    }

    /// Sets the pictures and the constants.
    pub fn prepare(
        &mut self,
        device: &wgpu::Device,
        queue: &wgpu::Queue,
        [left, right]: [&wgpu::TextureView; 2],
        data: &CompareData,
    ) {
        queue.write_buffer(&self.constants, 0, bytemuck::bytes_of(data));
        let resources = [
            self.constants.as_entire_binding(),
            wgpu::BindingResource::TextureView(left),
            wgpu::BindingResource::TextureView(right),
        ];
        self.pictures = Some(bind_group(device, "compare", &self.layout, &resources));
    }

    /// Draws over the pass's viewport; nothing before the first [`Self::prepare`].
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        let Some(pictures) = &self.pictures else { return };
        pass.set_pipeline(&self.pipeline);
        pass.set_bind_group(0, pictures, &[]);
        pass.draw(0..3, 0..1);
    }
}

fn pipeline(device: &wgpu::Device, group: &wgpu::BindGroupLayout, format: wgpu::TextureFormat) -> wgpu::RenderPipeline {
    let shader = layout::shader(device, "compare", &SHADER);
    let layout = device.create_pipeline_layout(&wgpu::PipelineLayoutDescriptor {
        label: Some("compare"),
        bind_group_layouts: &[Some(group)],
        immediate_size: 0,
    });
    device.create_render_pipeline(&wgpu::RenderPipelineDescriptor {
        label: Some("compare"),
        layout: Some(&layout),
        vertex: wgpu::VertexState {
            module: &shader,
            entry_point: Some("vertex"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            buffers: &[],
        },
        primitive: wgpu::PrimitiveState::default(),
        depth_stencil: None,
        multisample: wgpu::MultisampleState::default(),
        fragment: Some(wgpu::FragmentState {
            module: &shader,
            entry_point: Some("fragment"),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            targets: &[Some(format.into())],
        }),
        multiview_mask: None,
        cache: None,
    })
}
