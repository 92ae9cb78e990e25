//! About the choices that the window offers: each in two sentences, with its equation and the paper it is from.

mod fit;
mod methods;
mod shading;

pub use fit::{alignment, e_step, kappa, objective, selection};
pub use methods::method;
pub use shading::{convolution, diffuse};

/// What there is to know about a choice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct About {
    /// Its name.
    pub title: &'static str,
    /// What it does, and when it serves.
    pub text: &'static str,
    /// The equation.
    pub equation: &'static str,
    /// Where it is from.
    pub source: &'static str,
}

const HAN: &str = "Han, Sun, Ramamoorthi, Grinspun: Frequency domain normal map filtering. SIGGRAPH 2007";
const MIKKELSEN: &str = "Mikkelsen: Simulation of wrinkled surfaces revisited. Thesis, University of Copenhagen, 2008";
const BANERJEE: &str = "Banerjee, Dhillon, Ghosh, Sra: Clustering on the unit hypersphere using von Mises-Fisher \
                        distributions. JMLR 6, 2005";
const OURS: &str = "This program's own; the lobes are those of Han et al. 2007";

#[cfg(test)]
mod tests {
    use super::*;
    use crate::brdf::{ConvolutionRule, DiffuseRule};
    use crate::filter::Method;
    use crate::filter::vmf::{Alignment, EStep, Objective, Selection};
    use crate::sphere::vmf::KappaRule;

    #[test]
    fn every_choice_has_two_sentences_an_equation_and_a_source() {
        let mut all: Vec<About> = Method::offered().map(method).collect();
        all.extend([Objective::APPEARANCE, Objective::Em, Objective::Likelihood].map(objective));
        let aligned = [Alignment::default(), Alignment::Paper { c: 1.0 }, Alignment::Map { c: 1.0 }, Alignment::None];
        all.extend(aligned.map(alignment));
        all.extend([Selection::Fixed, Selection::AUTO, Selection::Bic].map(selection));
        all.extend([EStep::WithAlpha, EStep::AsPrinted].map(e_step));
        all.extend([KappaRule::Exact, KappaRule::Banerjee].map(kappa));
        all.extend(ConvolutionRule::ALL.map(convolution));
        all.extend(DiffuseRule::ALL.map(diffuse));
        for About { title, text, equation, source } in all {
            let sentences = text.split_inclusive(['.', '?']).filter(|part| part.ends_with('.')).count();
            assert!(text.ends_with('.') && sentences >= 2, "{title}: {text}");
            assert!(!equation.is_empty() && !source.is_empty() && !title.is_empty(), "{title}");
        }
    }
}
