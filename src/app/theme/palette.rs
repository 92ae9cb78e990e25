//! The colours of each theme.

use egui::Color32;

/// Every colour that panels use.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Palette {
    /// The one accent: selection, sliders, progress.
    pub accent: Color32,
    /// Panels.
    pub panel: Color32,
    /// What lies behind pictures.
    pub canvas: Color32,
    /// What lies behind text that is typed.
    pub field: Color32,
    /// Menus and windows over the panels.
    pub window: Color32,
    /// The shadow that these cast.
    pub shadow: Color32,
    /// Every other row of a table.
    pub faint: Color32,
    /// Lines between panels.
    pub line: Color32,
    /// The edge of a control that nothing points at.
    pub edge: Color32,
    /// Text that is read.
    pub text: Color32,
    /// Text that explains.
    pub weak: Color32,
    /// Headings.
    pub strong: Color32,
    /// Something to know.
    pub warning: Color32,
    /// Something that failed; not red alone, the sentence says it.
    pub error: Color32,
    /// Behind labels that lie on pictures.
    pub badge: Color32,
    /// Behind what is selected.
    pub selection: Color32,
    /// Text that is selected.
    pub selected: Color32,
    /// Controls at rest, pointed at, pressed, opened.
    pub widgets: [Color32; 4],
}

const fn rgb(hex: u32) -> Color32 {
    let [_, r, g, b] = hex.to_be_bytes();
    Color32::from_rgb(r, g, b)
}

pub(super) const DARK: Palette = Palette {
    accent: rgb(0x6ea8fe),
    panel: rgb(0x191b20),
    canvas: rgb(0x0f1014),
    field: rgb(0x0f1014),
    window: rgb(0x1f2228),
    shadow: Color32::from_black_alpha(110),
    faint: rgb(0x1e2127),
    line: rgb(0x2c3038),
    edge: Color32::TRANSPARENT,
    text: rgb(0xd3d8e0),
    weak: rgb(0x8b93a1),
    strong: rgb(0xf0f3f8),
    warning: rgb(0xf0be5a),
    error: rgb(0xff8c69),
    badge: Color32::from_rgba_premultiplied(10, 11, 14, 205),
    selection: rgb(0x2a4e82),
    selected: rgb(0xd6e6ff),
    widgets: [rgb(0x2b2f38), rgb(0x373d49), rgb(0x404857), rgb(0x323742)],
};

pub(super) const LIGHT: Palette = Palette {
    accent: rgb(0x1b62c8),
    panel: rgb(0xf4f5f7),
    canvas: rgb(0xd4d7dc),
    field: rgb(0xffffff),
    window: rgb(0xfcfcfd),
    shadow: Color32::from_black_alpha(50),
    faint: rgb(0xeaecef),
    line: rgb(0xc9cdd4),
    edge: Color32::TRANSPARENT,
    text: rgb(0x252a33),
    weak: rgb(0x58606d),
    strong: rgb(0x0c0f14),
    warning: rgb(0x8a5200),
    error: rgb(0xb3320a),
    badge: Color32::from_rgba_premultiplied(222, 224, 228, 226),
    selection: rgb(0xbcd6fa),
    selected: rgb(0x0b3778),
    widgets: [rgb(0xdfe2e7), rgb(0xd1d5dc), rgb(0xc2c8d2), rgb(0xd8dce2)],
};

pub(super) const HIGH_CONTRAST: Palette = Palette {
    accent: rgb(0x5cd6ff),
    panel: rgb(0x000000),
    canvas: rgb(0x000001),
    field: rgb(0x1a1a1a),
    window: rgb(0x0a0a0a),
    shadow: Color32::TRANSPARENT,
    faint: rgb(0x161616),
    line: rgb(0x8c8c8c),
    edge: rgb(0x9a9a9a),
    text: rgb(0xffffff),
    weak: rgb(0xe0e0e0),
    strong: rgb(0xffffff),
    warning: rgb(0xffd83d),
    error: rgb(0xffa07a),
    badge: Color32::from_rgba_premultiplied(0, 0, 0, 240),
    selection: rgb(0x00528a),
    selected: rgb(0xffffff),
    widgets: [rgb(0x141414), rgb(0x2e2e2e), rgb(0x444444), rgb(0x242424)],
};

#[cfg(test)]
mod tests {
    use super::*;
    use crate::app::theme::Theme;

    /// Relative luminance (WCAG 2.2).
    fn luminance(color: Color32) -> f64 {
        let linear = |byte: u8| {
            let c = f64::from(byte) / 255.0;
            if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
        };
        0.2126 * linear(color.r()) + 0.7152 * linear(color.g()) + 0.0722 * linear(color.b())
    }

    fn contrast(a: Color32, b: Color32) -> f64 {
        let (a, b) = (luminance(a), luminance(b));
        (a.max(b) + 0.05) / (a.min(b) + 0.05)
    }

    /// WCAG asks for 4.5 of text, and for 7 where contrast is wanted.
    #[test]
    fn all_text_stands_out_from_what_lies_behind_it() {
        for (theme, name) in Theme::ALL {
            let least = if theme == Theme::HighContrast { 7.0 } else { 4.5 };
            let p = theme.palette();
            for back in [p.panel, p.window, p.faint] {
                for (text, what) in [p.text, p.weak, p.strong, p.warning, p.error, p.accent].iter().zip(0..) {
                    let contrast = contrast(*text, back);
                    assert!(contrast >= least, "{name}: colour {what} on {back:?} has {contrast:.2}");
                }
            }
            for back in p.widgets {
                assert!(contrast(p.text, back) >= least, "{name}: text on {back:?}");
            }
            assert!(contrast(p.selected, p.selection) >= least, "{name}: what is selected");
        }
    }
}
