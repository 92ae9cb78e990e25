//! Uploads that may take several frames: rows of texels, a budget of bytes at a time.

use std::collections::VecDeque;
use std::sync::Arc;

use half::f16;

use crate::filter::PlainMip;
use crate::filter::channels::ChannelPyramid;
use crate::filter::vmf::{BaseSlots, ColorLevel, MixtureLevel};

/// Where the texels come from, and what is complete once they are there.
#[derive(Clone, Debug)]
pub enum Source {
    /// The mean normals of one level of the map; of the base level with the heights, where it has any.
    Means {
        /// The means.
        mip: Arc<PlainMip>,
        /// The map's level.
        level: usize,
    },
    /// The slots of the base level; slot 0 everywhere for `None`.
    Slots(Option<Arc<BaseSlots>>),
    /// The stored lobes of one level of the map, a layer per slot.
    Lobes {
        /// The lobes.
        mixtures: Arc<MixtureLevel>,
        /// The map's level.
        level: usize,
    },
    /// A rival's channels of one level of the map, four to a layer.
    Channels {
        /// The channels.
        channels: Arc<ChannelPyramid>,
        /// The map's level.
        level: usize,
    },
    /// The mean colours of one level of the map.
    MeanColors {
        /// The means.
        mip: Arc<PlainMip>,
        /// The map's level.
        level: usize,
    },
    /// The stored colours `alpha y` of one level's lobes, a layer per slot; `alpha`, for white, for `None`.
    LobeColors {
        /// The lobes.
        mixtures: Arc<MixtureLevel>,
        /// Their colours.
        colors: Option<Arc<ColorLevel>>,
        /// The map's level.
        level: usize,
    },
}

impl Source {
    /// True for the lobes of a level and for their colours.
    pub fn is_lobes_of(&self, of_level: usize) -> bool {
        matches!(self, Self::Lobes { level, .. } | Self::LobeColors { level, .. } if *level == of_level)
    }

    fn is_same_target(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Means { level, .. }, Self::Means { level: other, .. })
            | (Self::MeanColors { level, .. }, Self::MeanColors { level: other, .. })
            | (Self::LobeColors { level, .. }, Self::LobeColors { level: other, .. })
            | (Self::Channels { level, .. }, Self::Channels { level: other, .. })
            | (Self::Lobes { level, .. }, Self::Lobes { level: other, .. }) => level == other,
            (Self::Slots(_), Self::Slots(_)) => true,
            _ => false,
        }
    }

    /// Texel `index` of `layer` as the texture stores it in full precision.
    fn texel(&self, index: usize, layer: usize) -> [f32; 4] {
        match self {
            Self::Means { mip, level: 0 } => mip.levels[0][index].extend(mip.map.height_of(index)).to_array(),
            Self::Means { mip, level } => mip.levels[*level][index].extend(0.0).to_array(),
            Self::Slots(_) => [0.0; 4],
            Self::Lobes { mixtures, .. } if layer < mixtures.lobes => mixtures.stored[index * mixtures.lobes + layer],
            Self::MeanColors { mip, level } => mip.colors[*level][index].extend(1.0).to_array(),
            Self::LobeColors { mixtures, colors, .. } if layer < mixtures.lobes => {
                let at = index * mixtures.lobes + layer;
                let [r, g, b] = colors.as_ref().map_or([mixtures.stored[at][0]; 3], |colors| colors.stored[at]);
                [r, g, b, 0.0]
            }
            Self::Channels { channels, level } if layer < channels.layers => channels.texel(*level, index)[layer],
            Self::Lobes { .. } | Self::LobeColors { .. } | Self::Channels { .. } => [0.0; 4],
        }
    }
}

/// One MIP level of one texture, all layers, on its way.
#[derive(Debug)]
struct Upload {
    texture: wgpu::Texture,
    mip: u32,
    source: Source,
    /// Rows already sent, counted over all layers.
    rows_done: u32,
}

/// Uploads in order.
#[derive(Debug, Default)]
pub struct UploadQueue {
    uploads: VecDeque<Upload>,
}

impl UploadQueue {
    /// Adds the texels of one MIP level; drops an upload to the same place that has not finished.
    pub fn push(&mut self, texture: &wgpu::Texture, mip: u32, source: Source) {
        self.uploads.retain(|upload| !upload.source.is_same_target(&source));
        self.uploads.push_back(Upload { texture: texture.clone(), mip, source, rows_done: 0 });
    }

    /// Forgets the uploads that `stale` picks.
    pub fn forget(&mut self, stale: impl Fn(&Source) -> bool) {
        self.uploads.retain(|upload| !stale(&upload.source));
    }

    /// Bytes not sent yet.
    pub fn pending_bytes(&self) -> u64 {
        self.uploads.iter().map(Upload::pending_bytes).sum()
    }

    /// Sends about `budget` bytes, at least a row, and returns what became complete.
    pub fn pump(&mut self, queue: &wgpu::Queue, budget: u64) -> Vec<Source> {
        let (mut complete, mut left) = (Vec::new(), budget);
        while let Some(upload) = self.uploads.front_mut().filter(|_| left > 0) {
            left = left.saturating_sub(upload.send_rows(queue, left));
            if upload.pending_bytes() == 0 {
                complete.extend(self.uploads.pop_front().map(|upload| upload.source));
            }
        }
        complete
    }
}

impl Upload {
    fn size(&self) -> wgpu::Extent3d {
        self.texture.size().mip_level_size(self.mip, wgpu::TextureDimension::D2)
    }

    fn bytes_per_row(&self) -> u32 {
        self.size().width * self.texture.format().block_copy_size(None).unwrap_or(1)
    }

    fn rows(&self) -> u32 {
        self.size().height * self.texture.depth_or_array_layers()
    }

    fn pending_bytes(&self) -> u64 {
        u64::from(self.rows() - self.rows_done) * u64::from(self.bytes_per_row())
    }

    /// Sends rows of one layer and returns their bytes.
    fn send_rows(&mut self, queue: &wgpu::Queue, budget: u64) -> u64 {
        let size = self.size();
        let (layer, row) = (self.rows_done / size.height, self.rows_done % size.height);
        let affordable = (budget / u64::from(self.bytes_per_row())).clamp(1, u64::from(size.height - row)) as u32;
        let data = self.bytes(layer, row..row + affordable);
        queue.write_texture(
            wgpu::TexelCopyTextureInfo {
                texture: &self.texture,
                mip_level: self.mip,
                origin: wgpu::Origin3d { x: 0, y: row, z: layer },
                aspect: wgpu::TextureAspect::All,
            },
            &data,
            wgpu::TexelCopyBufferLayout { offset: 0, bytes_per_row: Some(self.bytes_per_row()), rows_per_image: None },
            wgpu::Extent3d { width: size.width, height: affordable, depth_or_array_layers: 1 },
        );
        self.rows_done += affordable;
        data.len() as u64
    }

    fn bytes(&self, layer: u32, rows: std::ops::Range<u32>) -> Vec<u8> {
        let width = self.size().width as usize;
        let texels = rows.start as usize * width..rows.end as usize * width;
        match (&self.source, self.texture.format()) {
            (Source::Slots(slots), _) => {
                slots.as_ref().map_or_else(|| vec![0; texels.len()], |s| s.slots[texels.clone()].to_vec())
            }
            (source, wgpu::TextureFormat::Rgba16Float) => {
                let halves = |i| source.texel(i, layer as usize).map(half_of);
                bytemuck::cast_slice(&texels.map(halves).collect::<Vec<_>>()).to_vec()
            }
            (source, _) => {
                let floats: Vec<[f32; 4]> = texels.map(|i| source.texel(i, layer as usize)).collect();
                bytemuck::cast_slice(&floats).to_vec()
            }
        }
    }
}

/// The nearest half that is finite: infinity times a weight of 0 would be no number.
fn half_of(value: f32) -> f16 {
    f16::from_f32(value.clamp(f16::MIN.to_f32(), f16::MAX.to_f32()))
}
