//! The rules of convolution and of slopes by name, as options have them.

use clap::ValueEnum;

use crate::brdf::{ConvolutionRule, DiffuseRule};
use crate::normal_map::SlopeKernel;

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
