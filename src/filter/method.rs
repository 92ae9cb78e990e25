//! Methods by name, as the command line and session files write them.

use std::str::FromStr;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::rival::{self, Rival, Source};
use super::vmf::{Cancelled, Fold, LobePyramid};
use super::{Filter, Truth, UnalignedVmf, VmfFilter, plain_mip};
use crate::sphere::mixture::MAX_LOBES;

/// A filtering method.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub enum Method {
    /// `truth`: supersampling of the unfiltered map.
    Truth,
    /// `mip`, `toksvig`, `sh:LMAX` and so on: every method beside the truth and the lobes.
    Rival(Rival),
    /// `vmf`: aligned von Mises-Fisher lobes, as many as were fitted.
    #[default]
    Vmf,
    /// `vmf:unaligned`: the same lobes, each texel around shaded on its own and the results blended.
    VmfUnaligned,
}

impl Method {
    /// `mip`: the averaged normal, normalised.
    pub const MIP: Self = Self::Rival(Rival::plain(&plain_mip::KIND));

    /// Every method, with every parameter that is offered, in the order they are offered.
    pub fn offered() -> impl Iterator<Item = Self> {
        let rivals = Rival::offered().map(Self::Rival);
        std::iter::once(Self::Truth).chain(rivals).chain([Self::Vmf, Self::VmfUnaligned])
    }

    /// The name in the window.
    pub fn label(self) -> String {
        match self {
            Self::Truth => "truth".to_owned(),
            Self::Rival(rival) => rival.label(),
            Self::Vmf => "vmf lobes".to_owned(),
            Self::VmfUnaligned => "vmf unaligned".to_owned(),
        }
    }

    /// True for the methods that show fitted lobes.
    pub fn shows_lobes(self) -> bool {
        matches!(self, Self::Vmf | Self::VmfUnaligned)
    }

    /// Makes the filter, for effective BRDFs: a picture of the truth takes more than its one sample. Lobes are those at
    /// hand, their slots merged by `fold`.
    pub fn filter(
        self,
        source: &Source<'_>,
        lobes: &Arc<LobePyramid>,
        fold: Fold,
    ) -> Result<Arc<dyn Filter>, Cancelled> {
        let vmf = || VmfFilter { lobes: Arc::clone(lobes), fold, rules: source.rules };
        Ok(match self {
            Self::Truth => Arc::new(Truth { map: Arc::clone(&source.mip.map), samples: 1 }),
            Self::Rival(rival) => rival.build(source)?,
            Self::Vmf => Arc::new(vmf()),
            Self::VmfUnaligned => Arc::new(UnalignedVmf(vmf())),
        })
    }

    /// The rival, for all but the truth and the lobes.
    pub fn rival(self) -> Option<Rival> {
        match self {
            Self::Rival(rival) => Some(rival),
            Self::Truth | Self::Vmf | Self::VmfUnaligned => None,
        }
    }
}

impl std::fmt::Display for Method {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Truth => formatter.write_str("truth"),
            Self::Rival(rival) => rival.fmt(formatter),
            Self::Vmf => formatter.write_str("vmf"),
            Self::VmfUnaligned => formatter.write_str("vmf:unaligned"),
        }
    }
}

/// Why a method's name could not be read.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
#[error("'{0}' is not a method: write truth, {1}, vmf:J or vmf:J:unaligned with J from 1 to {MAX_LOBES}")]
pub struct ParseMethodError(String, String);

impl ParseMethodError {
    fn new(text: &str) -> Self {
        Self(text.to_owned(), rival::names().collect::<Vec<_>>().join(", "))
    }
}

impl FromStr for Method {
    type Err = ParseMethodError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        match text {
            "truth" => Ok(Self::Truth),
            "vmf" => Ok(Self::Vmf),
            // Session files of the first versions have a hyphen.
            "vmf:unaligned" | "vmf-unaligned" => Ok(Self::VmfUnaligned),
            _ => Rival::parse(text).map(Self::Rival).ok_or_else(|| ParseMethodError::new(text)),
        }
    }
}

impl From<Method> for String {
    fn from(method: Method) -> Self {
        method.to_string()
    }
}

impl TryFrom<String> for Method {
    type Error = ParseMethodError;

    fn try_from(text: String) -> Result<Self, Self::Error> {
        text.parse()
    }
}

/// A method with the lobe count that it asks for, as `METHOD` on the command line: `vmf:J` and `vmf:J:unaligned` beside
/// what a session file may name.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MethodChoice {
    /// The method.
    pub method: Method,
    /// Lobes J, where the method names them.
    pub lobes: Option<usize>,
}

impl FromStr for MethodChoice {
    type Err = ParseMethodError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let counted = || {
            let (count, method) = match text.strip_suffix(":unaligned") {
                Some(count) => (count, Method::VmfUnaligned),
                None => (text, Method::Vmf),
            };
            let lobes = count.strip_prefix("vmf:")?.parse().ok()?;
            (1..=MAX_LOBES).contains(&lobes).then_some(Self { method, lobes: Some(lobes) })
        };
        match text.parse() {
            Ok(method) => Ok(Self { method, lobes: None }),
            Err(error) => counted().ok_or(error),
        }
    }
}

impl std::fmt::Display for MethodChoice {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match (self.lobes, self.method) {
            (Some(lobes), Method::VmfUnaligned) => write!(formatter, "vmf:{lobes}:unaligned"),
            (Some(lobes), method) => write!(formatter, "{method}:{lobes}"),
            (None, method) => write!(formatter, "{method}"),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_method_reads_as_it_is_written() {
        for method in Method::offered() {
            assert_eq!(method.to_string().parse(), Ok(method));
            let json = serde_json::to_string(&method).expect("serialises");
            assert_eq!(serde_json::from_str::<Method>(&json).expect("reads"), method);
        }
        assert_eq!("vmf-unaligned".parse(), Ok(Method::VmfUnaligned));
        for text in ["vmf:6", "vmf:3:unaligned", "gmm:4", "sh:12", "mip-unnormalised"] {
            assert_eq!(text.parse::<MethodChoice>().expect("a method").to_string(), text);
        }
    }

    #[test]
    fn what_is_no_method_is_told_which_there_are() {
        let error = "vmf:17".parse::<MethodChoice>().expect_err("too many").to_string();
        assert!(error.contains("toksvig") && error.contains("sh:LMAX") && error.contains("'vmf:17'"), "{error}");
    }
}
