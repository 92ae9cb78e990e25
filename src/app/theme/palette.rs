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
    accent: rgb(0x6e_a8_fe),
    panel: rgb(0x19_1b_20),
    canvas: rgb(0x0f_10_14),
    field: rgb(0x0f_10_14),
    window: rgb(0x1f_22_28),
    shadow: Color32::from_black_alpha(110),
    faint: rgb(0x1e_21_27),
    line: rgb(0x2c_30_38),
    edge: Color32::TRANSPARENT,
    text: rgb(0xd3_d8_e0),
    weak: rgb(0x8b_93_a1),
    strong: rgb(0xf0_f3_f8),
    warning: rgb(0xf0_be_5a),
    error: rgb(0xff_8c_69),
    badge: Color32::from_rgba_premultiplied(10, 11, 14, 205),
    selection: rgb(0x2a_4e_82),
    selected: rgb(0xd6_e6_ff),
    widgets: [rgb(0x2b_2f_38), rgb(0x37_3d_49), rgb(0x40_48_57), rgb(0x32_37_42)],
};

pub(super) const LIGHT: Palette = Palette {
    accent: rgb(0x1b_62_c8),
    panel: rgb(0xf4_f5_f7),
    canvas: rgb(0xd4_d7_dc),
    field: rgb(0xff_ff_ff),
    window: rgb(0xfc_fc_fd),
    shadow: Color32::from_black_alpha(50),
    faint: rgb(0xea_ec_ef),
    line: rgb(0xc9_cd_d4),
    edge: Color32::TRANSPARENT,
    text: rgb(0x25_2a_33),
    weak: rgb(0x58_60_6d),
    strong: rgb(0x0c_0f_14),
    warning: rgb(0x8a_52_00),
    error: rgb(0xb3_32_0a),
    badge: Color32::from_rgba_premultiplied(222, 224, 228, 226),
    selection: rgb(0xbc_d6_fa),
    selected: rgb(0x0b_37_78),
    widgets: [rgb(0xdf_e2_e7), rgb(0xd1_d5_dc), rgb(0xc2_c8_d2), rgb(0xd8_dc_e2)],
};

pub(super) const HIGH_CONTRAST: Palette = Palette {
    accent: rgb(0x5c_d6_ff),
    panel: rgb(0x00_00_00),
    canvas: rgb(0x00_00_01),
    field: rgb(0x1a_1a_1a),
    window: rgb(0x0a_0a_0a),
    shadow: Color32::TRANSPARENT,
    faint: rgb(0x16_16_16),
    line: rgb(0x8c_8c_8c),
    edge: rgb(0x9a_9a_9a),
    text: rgb(0xff_ff_ff),
    weak: rgb(0xe0_e0_e0),
    strong: rgb(0xff_ff_ff),
    warning: rgb(0xff_d8_3d),
    error: rgb(0xff_a0_7a),
    badge: Color32::from_rgba_premultiplied(0, 0, 0, 240),
    selection: rgb(0x00_52_8a),
    selected: rgb(0xff_ff_ff),
    widgets: [rgb(0x14_14_14), rgb(0x2e_2e_2e), rgb(0x44_44_44), rgb(0x24_24_24)],
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
