//! Rules by name, as options have them.

use clap::ValueEnum;

use crate::brdf::{ConvolutionRule, DiffuseRule};
use crate::normal_map::SlopeKernel;
use crate::scene::Reconstruction;
use crate::scene::bump::BumpRule;

/// How a lobe and a BRDF are convolved.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Convolution {
    /// Equation 20 of Han et al. 2007.
    Paper,
    /// The same with s + 1 in the place of s.
    #[default]
    #[value(name = "s+1")]
    ShiftedExponent,
    /// Exact in the first moment.
    Moment,
    /// The convolution itself, a Legendre series.
    Exact,
}

/// How slopes are taken from heights.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Slopes {
    /// Central differences.
    Central,
    /// Sobel's kernels, smoothed across the slope.
    Sobel,
}

impl Slopes {
    /// The kernel of this name.
    pub fn kernel(self) -> SlopeKernel {
        match self {
            Self::Central => SlopeKernel::Central,
            Self::Sobel => SlopeKernel::Sobel,
        }
    }
}

/// How a lobe reflects diffusely.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Diffuse {
    /// The clamped cosine of its mean direction, Algorithm 2 of Han et al. 2007.
    Cosine,
    /// The clamped cosine convolved with the lobe.
    #[default]
    Exact,
}

impl Convolution {
    /// The rule.
    pub fn rule(self) -> ConvolutionRule {
        match self {
            Self::Paper => ConvolutionRule::Paper,
            Self::ShiftedExponent => ConvolutionRule::ShiftedExponent,
            Self::Moment => ConvolutionRule::Moment,
            Self::Exact => ConvolutionRule::Exact,
        }
    }
}

impl Diffuse {
    /// The rule.
    pub fn rule(self) -> DiffuseRule {
        match self {
            Self::Cosine => DiffuseRule::Cosine,
            Self::Exact => DiffuseRule::Exact,
        }
    }
}

/// What is made of the vertices' frames at a pixel between them.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum FramePerPixel {
    /// A rotation: the normal, the tangent in its plane, the bitangent at right angles to both.
    Orthonormal,
    /// Both derivatives in the plane of the normal, by the three steps of Mikkelsen's section 3.4.
    Projected,
    /// The interpolated vectors as they are, section 3.5.
    Interpolated,
}

impl FramePerPixel {
    /// The way of this name.
    pub fn way(self) -> Reconstruction {
        match self {
            Self::Orthonormal => Reconstruction::Orthonormal,
            Self::Projected => Reconstruction::Projected,
            Self::Interpolated => Reconstruction::Interpolated,
        }
    }
}

/// How a map of heights bumps a parametric surface.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Bump {
    /// As on any surface: its slopes count texels.
    Off,
    /// By Blinn's normal.
    Blinn,
    /// By the normal of the displaced surface, Mikkelsen's equation 25.
    Exact,
}

impl Bump {
    /// The rule of this name.
    pub fn rule(self) -> Option<BumpRule> {
        match self {
            Self::Off => None,
            Self::Blinn => Some(BumpRule::Blinn),
            Self::Exact => Some(BumpRule::Exact),
        }
    }
}
