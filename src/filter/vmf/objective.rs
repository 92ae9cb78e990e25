//! What a texel's own fit strives for, by name: likelihood and appearance are not won by one fit.

use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// What a texel's own fit strives for.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub enum Objective {
    /// The papers' way: the children's lobes that lie farthest apart, then EM to its tolerance.
    Em,
    /// The shaded look: the children's lobes merged as a material blurs them, a few EM iterations, then steps that
    /// lower the squared distance between the shaded mixture and the shaded truth.
    Appearance {
        /// Gauss-Newton steps after EM.
        steps: u8,
    },
    /// The likelihood, with moves that split and merge lobes to leave a poor optimum.
    Likelihood,
}

impl Objective {
    /// Gauss-Newton steps that [`Objective::Appearance`] takes unless told.
    pub const DEFAULT_STEPS: u8 = 3;

    /// Most Gauss-Newton steps that may be asked for; twenty gain nothing over ten worth seeing.
    pub const MOST_STEPS: u8 = 50;

    /// The shaded look, with the usual number of steps.
    pub const APPEARANCE: Self = Self::Appearance { steps: Self::DEFAULT_STEPS };
}

impl Default for Objective {
    fn default() -> Self {
        Self::APPEARANCE
    }
}

/// Why an objective's name could not be read.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
#[error("'{0}' is not an objective: write em, appearance, appearance:STEPS with STEPS from 0 to 50, or likelihood")]
pub struct ParseObjectiveError(String);

impl FromStr for Objective {
    type Err = ParseObjectiveError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "em" => Some(Self::Em),
            "appearance" => Some(Self::APPEARANCE),
            "likelihood" => Some(Self::Likelihood),
            _ => text
                .strip_prefix("appearance:")
                .and_then(|steps| steps.parse().ok())
                .filter(|&steps| steps <= Self::MOST_STEPS)
                .map(|steps| Self::Appearance { steps }),
        }
        .ok_or_else(|| ParseObjectiveError(text.to_owned()))
    }
}

impl std::fmt::Display for Objective {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Em => formatter.write_str("em"),
            Self::Appearance { steps: Self::DEFAULT_STEPS } => formatter.write_str("appearance"),
            Self::Appearance { steps } => write!(formatter, "appearance:{steps}"),
            Self::Likelihood => formatter.write_str("likelihood"),
        }
    }
}

impl From<Objective> for String {
    fn from(objective: Objective) -> Self {
        objective.to_string()
    }
}

impl TryFrom<String> for Objective {
    type Error = ParseObjectiveError;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        text.parse()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_objective_reads_as_it_is_written() {
        let all = [Objective::Em, Objective::APPEARANCE, Objective::Appearance { steps: 0 }, Objective::Likelihood];
        for objective in all {
            assert_eq!(objective.to_string().parse(), Ok(objective));
        }
        for wrong in ["", "EM", "appearance:", "appearance:51", "appearance:-1"] {
            assert!(wrong.parse::<Objective>().is_err(), "{wrong}");
        }
    }
}
