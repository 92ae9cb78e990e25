//! What a part says of the fit beside its lobes: the attribute `fit`, as JSON in ASCII.

use serde::{Deserialize, Serialize};

use super::FittedLobes;
use crate::filter::vmf::{FitSettings, LevelStats};
use crate::image_io::exr_parts::Notes;
use crate::normal_map::Addressing;

const NAME: &str = "fit";

/// The contents of the attribute; unknown keys are passed over, missing ones take their defaults.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(default)]
pub(super) struct Note {
    /// The program's version.
    pub version: String,
    /// The fitted map's name.
    pub source: String,
    /// How it was fitted.
    pub settings: FitSettings,
    /// What the level came to.
    pub level: Option<LevelStats>,
}

/// The notes of one level.
pub(super) fn notes_of(fit: &FittedLobes, level: usize) -> Notes {
    let note = Note {
        version: env!("CARGO_PKG_VERSION").to_owned(),
        source: fit.lobes.map.name(),
        settings: fit.settings,
        // The time it took differs from run to run; the file should not.
        level: fit.stats.get(level).copied().flatten().map(|stats| LevelStats { seconds: 0.0, ..stats }),
    };
    let json = serde_json::to_string(&note).unwrap_or_default();
    Notes {
        software: format!("ndf-inspector {}", env!("CARGO_PKG_VERSION")),
        wrap_mode: match fit.lobes.map.options.addressing {
            Addressing::Wrap => "periodic",
            Addressing::Clamp => "clamp",
        }
        .to_owned(),
        own: [(NAME.to_owned(), in_ascii(&json))].into(),
    }
}

/// What a part's notes say; the defaults where they say nothing that can be read.
pub(super) fn note_of(notes: &Notes) -> (Note, Addressing) {
    let note = notes.own.get(NAME).and_then(|json| serde_json::from_str(json).ok()).unwrap_or_default();
    let addressing = if notes.wrap_mode.starts_with("clamp") { Addressing::Clamp } else { Addressing::Wrap };
    (note, addressing)
}

/// JSON with every character beyond ASCII escaped.
fn in_ascii(json: &str) -> String {
    let escape = |c: char| {
        let mut units = [0; 2];
        c.encode_utf16(&mut units).iter().map(|unit| format!("\\u{unit:04x}")).collect::<String>()
    };
    json.chars().map(|c| if c.is_ascii() { c.to_string() } else { escape(c) }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn json_in_ascii_says_the_same() {
        let text = "naïve 法線 🙂 \"q\"";
        let json = in_ascii(&serde_json::to_string(text).expect("a string"));
        assert!(json.is_ascii());
        assert_eq!(serde_json::from_str::<String>(&json).expect("JSON"), text);
    }
}
