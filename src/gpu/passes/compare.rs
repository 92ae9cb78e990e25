//! Puts pictures of the surface beside each other, exposes them, and encodes sRGB, once: two at a wipe, two as their
//! difference in false colour, or one; in as many cells as there are.

use crate::color::color_stops;
use crate::comparison::{Arrangement, DifferenceKind};
use crate::gpu::layout::{self, bind_group, bind_group_layout, texture, uniform_buffer};

/// The shader's parts, in order.
pub const SHADER: [&str; 3] = [layout::SRGB, layout::COLOR_SCALE, include_str!("../../../shaders/compare.wgsl")];

/// Pixels from one cell's picture to the next.
const BORDER: f32 = 2.0;

/// The constants of one cell; `Compare` in the shader.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
pub struct CompareData {
    /// The cell's top left corner, `0..1` of the viewport, y down.
    pub origin: [f32; 2],
    /// The cell's size in viewports.
    pub extent: [f32; 2],
    /// What the left picture is multiplied by.
    pub left_scale: f32,
    /// What the right picture is multiplied by.
    pub right_scale: f32,
    /// Where the left side ends, in pixels.
    pub wipe: f32,
    /// Half the divider's width in pixels; 0 for none.
    pub divider: f32,
    /// Pixels of the cell's left and upper edge that part it from its neighbours.
    pub border: [f32; 2],
    /// The differences at both ends of the scale.
    pub ends: [f32; 2],
    /// What is shown, by the shader's number.
    pub shown: u32,
    /// Nothing.
    pub padding: u32,
    /// Nothing.
    pub more_padding: [u32; 2],
    /// The scale's stops, sRGB.
    pub scale: [[f32; 4]; 9],
}

impl CompareData {
    /// The cell with its top left pixel at `origin` in a picture of `size`. What its pictures are multiplied by is
    /// left 0.
    pub fn of_cell(arrangement: Arrangement, size: [u32; 2], origin: [u32; 2]) -> Self {
        let cell = arrangement.cell_size(size);
        let relative = |pixels: [u32; 2]| [0, 1].map(|axis| pixels[axis] as f32 / size[axis].max(1) as f32);
        let mut data = Self {
            origin: relative(origin),
            extent: relative(cell),
            border: origin.map(|pixels| if pixels > 0 { BORDER } else { 0.0 }),
            ..Self::default()
        };
        match arrangement {
            Arrangement::Wipe(at) => {
                data.wipe = (at * cell[0] as f32).round();
                data.divider = 1.0;
            }
            Arrangement::Difference(difference) => {
                data.shown = match difference.kind {
                    DifferenceKind::Absolute => 1,
                    DifferenceKind::Signed => 2,
                };
                data.ends = difference.ends();
                data.scale = color_stops(|t| difference.kind.color(t));
            }
            Arrangement::Flip { .. } | Arrangement::Grid { .. } => {}
        }
        data
    }
}

/// What one cell shows.
#[derive(Debug)]
pub struct ComparedPictures {
    /// The left and the right picture.
    pub pictures: [wgpu::TextureView; 2],
    /// The constants.
    pub data: CompareData,
}

/// Pipeline, and constants and pictures of every cell.
#[derive(Debug)]
pub struct ComparePass {
    pipeline: wgpu::RenderPipeline,
    layout: wgpu::BindGroupLayout,
    constants: Vec<wgpu::Buffer>,
    cells: Vec<wgpu::BindGroup>,
}

impl ComparePass {
    /// Compiles the pipeline for targets of `format`, which must not encode sRGB itself.
    pub fn new(device: &wgpu::Device, format: wgpu::TextureFormat) -> Self {
        let picture = texture(wgpu::TextureSampleType::Uint, wgpu::TextureViewDimension::D2);
        let types = [layout::UNIFORM, picture, picture];
        let layout = bind_group_layout(device, "compare", wgpu::ShaderStages::VERTEX_FRAGMENT, &types);
        let pipeline = pipeline(device, &layout, format);
        Self { pipeline, layout, constants: Vec::new(), cells: Vec::new() }
    }

    /// Sets what the cells show.
    pub fn prepare(&mut self, device: &wgpu::Device, queue: &wgpu::Queue, cells: &[ComparedPictures]) {
        while self.constants.len() < cells.len() {
            self.constants.push(uniform_buffer::<CompareData>(device, "compare"));
        }
        let bind = |(cell, constants): (&ComparedPictures, &wgpu::Buffer)| {
            queue.write_buffer(constants, 0, bytemuck::bytes_of(&cell.data));
            let [left, right] = cell.pictures.each_ref().map(wgpu::BindingResource::TextureView);
            bind_group(device, "compare", &self.layout, &[constants.as_entire_binding(), left, right])
        };
        self.cells = cells.iter().zip(&self.constants).map(bind).collect();
    }

    /// Draws every cell into its part of the pass's viewport; nothing before the first [`Self::prepare`].
    pub fn draw(&self, pass: &mut wgpu::RenderPass<'_>) {
        pass.set_pipeline(&self.pipeline);
        for cell in &self.cells {
            pass.set_bind_group(0, cell, &[]);
            pass.draw(0..4, 0..1);
        }
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
        primitive: wgpu::PrimitiveState { topology: wgpu::PrimitiveTopology::TriangleStrip, ..Default::default() },
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
