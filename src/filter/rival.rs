//! Rivals: the methods beside the truth and the lobes, each one file that describes itself by a [`RivalKind`].
//!
//! A rival reads the mean normals, and channels of its own if it has any; both interpolate linearly, so hardware may
//! sample them, and the method shades once with the blend. Its file holds the build, the effective BRDF and the
//! shading; its shader, in `shaders/methods/`, the shading's twin. [`RIVALS`] lists them.

use std::sync::Arc;

use super::channels::ChannelPyramid;
use super::vmf::{Cancelled, Monitor, Rules};
use super::{Filter, PlainMip, gmm, harmonics, lean, plain_mip, toksvig};

/// Every rival, in the order they are offered. A new method's last step is a line here.
pub static RIVALS: [&RivalKind; 6] =
    [&plain_mip::KIND, &plain_mip::UNNORMALISED, &toksvig::KIND, &lean::KIND, &gmm::KIND, &harmonics::KIND];

/// What there is to know of a rival before it is built.
#[derive(Debug)]
pub struct RivalKind {
    /// The name on the command line, without the parameter.
    pub name: &'static str,
    /// The name in the window, before the parameter.
    pub label: &'static str,
    /// The number that follows the name and a colon.
    pub parameter: Option<Parameter>,
    /// True where pictures sample channels beside the mean normals.
    pub has_channels: bool,
    /// WGSL of `fn shade(lookup: Lookup, lod: f32, light: LocalLight, material: Material) -> vec3f` and, for the sky, of
    /// `fn ndf_lobe_count() -> u32` and `fn ndf_lobe(lookup: Lookup, lod: f32, index: u32) -> NdfLobe`.
    pub shader: &'static str,
    /// Makes the filter.
    pub build: fn(&Source<'_>, Rival) -> Built,
}

/// A filter that is made, unless nobody wants it any more.
pub type Built = Result<Arc<dyn RivalFilter>, Cancelled>;

/// The number that a rival's name carries.
#[derive(Debug)]
pub struct Parameter {
    /// What the command line's help calls it.
    pub symbol: &'static str,
    /// Smallest and largest value.
    pub range: [u8; 2],
    /// The largest value of which pictures are drawn.
    pub most_drawn: u8,
    /// The value where none is written.
    pub default: u8,
    /// The values that the window offers.
    pub offered: &'static [u8],
}

/// What a rival is built from.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    /// The map and its mean normals.
    pub mip: &'a Arc<PlainMip>,
    /// How effective BRDFs are found where there is a choice; pictures go by their material's.
    pub rules: Rules,
    /// Ends a build that nobody waits for.
    pub monitor: &'a Monitor,
}

/// A rival, ready to shade.
pub trait RivalFilter: Filter + Send + std::fmt::Debug {
    /// The channels that a picture samples beside the mean normals, made when first asked for.
    fn channels(&self, monitor: &Monitor) -> Result<Option<&Arc<ChannelPyramid>>, Cancelled> {
        let _ = monitor;
        Ok(None)
    }
}

/// A rival by its kind and the number that its name carries, 0 where it carries none.
#[derive(Clone, Copy)]
pub struct Rival {
    /// Which.
    pub kind: &'static RivalKind,
    /// The number.
    pub parameter: u8,
}

impl Rival {
    /// A rival whose name carries no number.
    pub const fn plain(kind: &'static RivalKind) -> Self {
        Self { kind, parameter: 0 }
    }

    /// Reads `NAME` or `NAME:NUMBER`.
    pub fn parse(text: &str) -> Option<Self> {
        let (name, number) = text.split_once(':').map_or((text, None), |(name, number)| (name, Some(number)));
        let kind = RIVALS.into_iter().find(|kind| kind.name == name)?;
        let parameter = match (&kind.parameter, number) {
            (None, None) => 0,
            (None, Some(_)) => return None,
            (Some(parameter), None) => parameter.default,
            (Some(parameter), Some(number)) => {
                let [least, most] = parameter.range;
                number.parse().ok().filter(|number| (least..=most).contains(number))?
            }
        };
        Some(Self { kind, parameter })
    }

    /// Every rival with every number that is offered.
    pub fn offered() -> impl Iterator<Item = Self> {
        RIVALS.into_iter().flat_map(|kind| {
            let numbers = kind.parameter.as_ref().map_or(&[0][..], |parameter| parameter.offered);
            numbers.iter().map(move |&parameter| Self { kind, parameter })
        })
    }

    /// The name in the window.
    pub fn label(self) -> String {
        match &self.kind.parameter {
            Some(_) => format!("{} {}", self.kind.label, self.parameter),
            None => self.kind.label.to_owned(),
        }
    }

    /// True where pictures are drawn; effective BRDFs always are found.
    pub fn is_drawn(self) -> bool {
        self.kind.parameter.as_ref().is_none_or(|parameter| self.parameter <= parameter.most_drawn)
    }

    /// Makes the filter, on the current thread pool.
    pub fn build(self, source: &Source<'_>) -> Built {
        (self.kind.build)(source, self)
    }
}

impl PartialEq for Rival {
    fn eq(&self, other: &Self) -> bool {
        (self.kind.name, self.parameter) == (other.kind.name, other.parameter)
    }
}

impl Eq for Rival {}

impl std::hash::Hash for Rival {
    fn hash<H: std::hash::Hasher>(&self, state: &mut H) {
        (self.kind.name, self.parameter).hash(state);
    }
}

impl std::fmt::Debug for Rival {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(formatter, "Rival({self})")
    }
}

impl std::fmt::Display for Rival {
    fn fmt(&self, formatter: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self.kind.parameter {
            Some(_) => write!(formatter, "{}:{}", self.kind.name, self.parameter),
            None => formatter.write_str(self.kind.name),
        }
    }
}

/// The names of all rivals as the command line's help writes them: `toksvig`, `gmm:N`.
pub fn names() -> impl Iterator<Item = String> {
    RIVALS.into_iter().map(|kind| match &kind.parameter {
        Some(parameter) => format!("{}:{}", kind.name, parameter.symbol),
        None => kind.name.to_owned(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rival_reads_as_it_is_written_and_no_two_share_a_name() {
        for rival in Rival::offered() {
            assert_eq!(Rival::parse(&rival.to_string()), Some(rival));
        }
        for (index, kind) in RIVALS.iter().enumerate() {
            assert!(RIVALS[..index].iter().all(|other| other.name != kind.name));
        }
    }

    #[test]
    fn a_number_outside_the_range_or_where_none_belongs_is_refused() {
        for text in ["gmm:0", "gmm:99", "sh:23", "sh:-1", "mip:3", "sh:", "toksvig:"] {
            assert_eq!(Rival::parse(text), None, "{text}");
        }
        assert_eq!(Rival::parse("gmm").map(|rival| rival.parameter), Some(4));
    }
}
