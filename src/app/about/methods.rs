//! About the methods that are compared.

use super::{About, HAN};
use crate::filter::Method;

const MIP: About = About {
    title: "Plain mip",
    text: "Averages the normals and makes the mean a unit vector again, as most shaders do. How far the normals spread \
           is lost, so that rough surfaces turn glossy in the distance.",
    equation: "N = mean of n,   shaded as N / |N|",
    source: "Williams: Pyramidal parametrics. SIGGRAPH 1983",
};

const UNNORMALISED: About = About {
    title: "Mip, unnormalised",
    text: "Averages the normals and shades with the mean as it is, shorter than a unit vector. Rough texels darken, \
           and their highlights dim without becoming wider.",
    equation: "N = mean of n,   shaded as N",
    source: "Williams: Pyramidal parametrics. SIGGRAPH 1983",
};

const TOKSVIG: About = About {
    title: "Toksvig",
    text: "The shorter the mean normal, the wider the spread below it, and the wider and dimmer the highlight. It \
           costs nothing but the length, and knows one round lobe only.",
    equation: "f = |N| / (|N| + s (1 - |N|)),   exponent f s,   times (1 + f s) / (1 + s)",
    source: "Toksvig: Mipmapping normal maps. Journal of Graphics Tools 10(3), 2005",
};

const LEAN: About = About {
    title: "LEAN",
    text: "Keeps mean and second moments of the slopes, so that one Gaussian may be longer one way than the other. \
           Brushed surfaces keep their streaks, but a texel of several facets becomes one blur.",
    equation: "Sigma = E[s s^T] - E[s] E[s]^T + I / s,   as a Beckmann lobe",
    source: "Olano, Baker: LEAN mapping. I3D 2010",
};

const GMM: About = About {
    title: "GMM",
    text: "Fits a few round Gaussians to the normals' x and y in the plane, aligned between neighbours. It is the lobes' \
           forerunner: the plane distorts normals that lean far.",
    equation: "p(x, y) = sum_j alpha_j G((x, y); mu_j, sigma_j)",
    source: "Tan, Lin, Quan, Guo, Shum: Multiresolution reflectance filtering. EGSR 2005",
};

const HARMONICS: About = About {
    title: "Spherical harmonics",
    text: "Keeps the distribution as harmonics up to a band l*, which average linearly and need no fit. Shiny materials \
           need about sqrt(4 s) bands, with fewer the highlight rings.",
    equation: "rho(w) = sum_l rho_l sum_m gamma_lm Y_lm(w),   gamma_lm = mean of Y_lm(n)",
    source: HAN,
};

const OTHER: About = About {
    title: "A method of your own",
    text: "It stands in the list of rivals, and nothing is written about it here. Its file says what it does.",
    equation: "rho(w) ~ sum_q weight_q f(n_q . w)",
    source: "src/filter",
};

/// A way to estimate a texel's effective BRDF.
pub fn method(method: Method) -> About {
    match method {
        Method::Truth => About {
            title: "Truth",
            text: "Shades every normal under the pixel and averages the results, by many samples of the map at full \
                   size. Every other method is an estimate of it.",
            equation: "rho(w) = sum_q weight_q f(n_q . w)   (eq. 4)",
            source: HAN,
        },
        Method::Vmf => About {
            title: "Von Mises-Fisher lobes",
            text: "Keeps the distribution as J lobes on the sphere, each of which blurs the material in closed form, \
                   so that light and material stay free. Hardware interpolates the aligned lobes: one fetch for each.",
            equation: "p(n) = sum_j alpha_j kappa_j / (2 pi (1 - exp(-2 kappa_j))) exp(kappa_j (n . mu_j - 1))",
            source: HAN,
        },
        Method::VmfUnaligned => About {
            title: "Von Mises-Fisher lobes, unaligned",
            text: "Shades the eight texels around a lookup by their own lobes and blends what they reflect. It costs \
                   eight times as much, and needs no alignment.",
            equation: "rho = sum over 8 texels of weight * rho_texel",
            source: HAN,
        },
        Method::Rival(rival) => {
            let text = rival.to_string();
            let name = text.split(':').next().unwrap_or_default();
            let known = [
                ("mip", MIP),
                ("mip-unnormalised", UNNORMALISED),
                ("toksvig", TOKSVIG),
                ("lean", LEAN),
                ("gmm", GMM),
                ("sh", HARMONICS),
            ];
            known.into_iter().find(|(own, _)| *own == name).map_or(OTHER, |(_, about)| about)
        }
    }
}
