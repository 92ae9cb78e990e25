//! About the choices of the fit.

use super::{About, BANERJEE, HAN, MIKKELSEN, OURS};
use crate::filter::vmf::{Alignment, EStep, Objective, Selection};
use crate::sphere::vmf::KappaRule;

/// What a texel's own fit strives for.
pub fn objective(objective: Objective) -> About {
    match objective {
        Objective::Appearance { .. } => About {
            title: "Objective: appearance",
            text: "Merges the children's lobes as a material would blur them, then takes Gauss-Newton steps on the \
                   squared distance between shaded mixture and shaded truth. The distance has a closed form, so it \
                   needs no sampled directions, and exponents that it was not fitted to gain as well.",
            equation: "Phi = sum over s of w_s || f_s * mixture - f_s * NDF ||²,   s = 10, 64, 400",
            source: OURS,
        },
        Objective::Em => About {
            title: "Objective: EM",
            text: "Starts from those of the children's lobes that lie farthest apart, then alternates between sharing \
                   the normals out among the lobes and refitting each lobe to its share. The likelihood never falls, \
                   but one start may end in a poor optimum.",
            equation: "z_ij = alpha_j v_j(n_i) / sum_k alpha_k v_k(n_i),   alpha_j = mean_i z_ij,   r_j = sum_i z_ij n_i / sum_i z_ij",
            source: HAN,
        },
        Objective::Likelihood => About {
            title: "Objective: likelihood",
            text: "Follows EM with moves that merge the two lobes least worth keeping apart and split the lobe that \
                   gains most, and keeps a move if the likelihood has risen. The best density is not the best look: \
                   choose it to study the distribution rather than the picture.",
            equation: "L = sum_i w_i ln sum_j alpha_j v_j(n_i)",
            source: "Runnalls: Kullback-Leibler approach to Gaussian mixture reduction. IEEE TAES 43(3), 2007, for the merges",
        },
    }
}

/// How lobes of neighbours are made to mean the same thing.
pub fn alignment(alignment: Alignment) -> About {
    match alignment {
        Alignment::Smooth { .. } => About {
            title: "Alignment: smooth",
            text: "Neighbours speak in the E-step with share b, and each texel's mean directions follow its own \
                   normals alone. The mean normal stays exact between texels, and interpolated lobes err far less \
                   than by a pull on directions.",
            equation: "mixture of the E-step = (1 - b) own + b mean of neighbours,   blended as (alpha, alpha r)",
            source: OURS,
        },
        Alignment::Paper { .. } => About {
            title: "Alignment: paper",
            text: "Pulls every mean direction towards those of the parent and of the neighbours visited before. The \
                   authors ran C = 2; a tenth of it damages the fit less.",
            equation: "mu_j ~ r_j + C sum_k alpha_jk mu_jk   (eq. 23)",
            source: HAN,
        },
        Alignment::Map { .. } => About {
            title: "Alignment: map",
            text: "The exact M-step of the prior behind the paper's pull, which weighs the texel's own normals by how \
                   concentrated they are. With it, the penalised likelihood never falls.",
            equation: "mu_j ~ kappa_j alpha_j r_j + c sum_k alpha_jk mu_jk   (eq. 113)",
            source: MIKKELSEN,
        },
        Alignment::None => About {
            title: "Alignment: none",
            text: "Every texel keeps its own best fit, its lobes in any order. Hardware then blends lobes that mean \
                   different things, so shade it unaligned: eight texels, and a blend of the results.",
            equation: "rho = sum over 8 texels of weight * rho_texel",
            source: HAN,
        },
    }
}

/// How many lobes a texel gets.
pub fn selection(selection: Selection) -> About {
    match selection {
        Selection::Fixed => About {
            title: "Lobe count: J in every texel",
            text: "Every texel has the same number of lobes, and so has every pixel's loop. Slots that a texel has no \
                   use for stay empty.",
            equation: "p(n) = sum over j = 1..J of alpha_j v(n; mu_j, kappa_j)",
            source: HAN,
        },
        Selection::BrdfError { .. } => About {
            title: "Lobe count: BRDF error",
            text: "Adds lobes until the texel's effective BRDF is near enough to the truth of all its normals. Flat \
                   texels get by with one or two, rough ones take what they need.",
            equation: "sqrt( int (m - t)² / int t² ) <= target,   at s = 64",
            source: OURS,
        },
        Selection::Bic => About {
            title: "Lobe count: BIC",
            text: "Adds lobes while the likelihood gains more than a lobe's four parameters cost. Samples are counted \
                   as occupied cells of direction, for raw texels repeat and would ask for far too many.",
            equation: "BIC = -2 L + (4 J - 1) ln N",
            source: "Schwarz: Estimating the dimension of a model. Annals of Statistics 6(2), 1978",
        },
    }
}

/// How normals are shared between lobes.
pub fn e_step(step: EStep) -> About {
    match step {
        EStep::WithAlpha => About {
            title: "E-step: with alpha",
            text: "A normal belongs to a lobe by the lobe's weight times its density there. This is expectation \
                   maximisation, under which the likelihood never falls.",
            equation: "z_ij = alpha_j v_j(n_i) / sum_k alpha_k v_k(n_i)",
            source: MIKKELSEN,
        },
        EStep::AsPrinted => About {
            title: "E-step: as printed",
            text: "A normal belongs to a lobe by its density alone, as Algorithm 1 was printed. The author has \
                   confirmed that it is an error; it is here to show what it does.",
            equation: "z_ij = v_j(n_i) / sum_k v_k(n_i)",
            source: HAN,
        },
    }
}

/// How a lobe's concentration follows from its mean length.
pub fn kappa(rule: KappaRule) -> About {
    match rule {
        KappaRule::Exact => About {
            title: "Kappa from r: exact",
            text: "Solves for the concentration whose mean length is that of the lobe's normals. Newton steps start \
                   from the closed form and end at the solution.",
            equation: "|r| = A(kappa) = coth(kappa) - 1/kappa",
            source: MIKKELSEN,
        },
        KappaRule::Banerjee => About {
            title: "Kappa from r: Banerjee",
            text: "The closed form that the papers use. It is up to 5 % off, worst near kappa = 5.",
            equation: "kappa = (3 |r| - |r|³) / (1 - |r|²)",
            source: BANERJEE,
        },
    }
}
