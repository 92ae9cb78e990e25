//! About the choices of the material.

use super::{About, HAN, OURS};
use crate::brdf::{ConvolutionRule, DiffuseRule};

/// How a lobe and the material are convolved.
pub fn convolution(rule: ConvolutionRule) -> About {
    match rule {
        ConvolutionRule::ShiftedExponent => About {
            title: "Convolution: s + 1",
            text: "A Blinn-Phong lobe blurred by the normals' lobe is taken as a wider Blinn-Phong lobe, both measured \
                   by s + 1, which is what their harmonics depend on. It costs no more than the paper's form and \
                   measures best of the closed ones.",
            equation: "s' + 1 = kappa (s + 1) / (kappa + s + 1)",
            source: OURS,
        },
        ConvolutionRule::Moment => About {
            title: "Convolution: moment",
            text: "The exponent whose first moment is that of the convolution. It is exact there, and worse for wide \
                   lobes elsewhere.",
            equation: "s' = (2 m - 1) / (1 - m),   m = A(kappa) (s + 1) / (s + 2)",
            source: OURS,
        },
        ConvolutionRule::Paper => About {
            title: "Convolution: paper",
            text: "Adds the inverse widths of material and lobe, as if both were Gaussians. The peak of wide lobes \
                   comes out too bright, by a quarter at kappa = 5 and s = 10.",
            equation: "s' = kappa s / (kappa + s)   (eq. 20)",
            source: HAN,
        },
        ConvolutionRule::Exact => About {
            title: "Convolution: exact",
            text: "The convolution itself: the harmonics of both are multiplied band by band, and the series is kept \
                   as a table. It is what the closed rules are measured by.",
            equation: "rho(u) = sum_l (2l + 1) / (4 pi) rho_l A_l(kappa) P_l(u)",
            source: HAN,
        },
    }
}

/// How a lobe reflects diffusely.
pub fn diffuse(rule: DiffuseRule) -> About {
    match rule {
        DiffuseRule::Cosine => About {
            title: "Diffuse rule: cosine",
            text: "Clamps the cosine of each lobe's mean direction, as the paper's shader does. Wide lobes near the \
                   horizon keep too little light, for part of their normals still faces it.",
            equation: "max(mu . w, 0)   (Algorithm 2)",
            source: HAN,
        },
        DiffuseRule::Exact => About {
            title: "Diffuse rule: exact",
            text: "Convolves the clamped cosine with the lobe. It differs where a lobe is wide and the light is low.",
            equation: "sum_l (2l + 1) / 4 rho_l A_l(kappa) P_l(mu . w),   rho_l = 1, 2/3, 1/4, 0, -1/24, ...",
            source: HAN,
        },
    }
}
