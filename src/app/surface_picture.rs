//! The lit surface as a picture of its own, with or without its settings below it.

use egui::{CentralPanel, Frame, Label, RichText};
use serde_json::Value;

use super::theme::{self, Theme};
use crate::gpu::readback::ReadbackError;
use crate::gpu::{FrameInput, Gpu, render_to_rgba8};
use crate::headless::{Canvas, Screenshot};
use crate::session::Session;

/// Pixels of the caption's height: two lines of small text.
const CAPTION_HEIGHT: u32 = 44;

/// Passes until the text is laid out.
const PASSES: usize = 2;

/// Draws what the session compares, by the lobes at hand and to the full count of the truth's samples. Waits for the
/// channels of its methods.
///
/// # Errors
/// A sentence of the device.
pub fn surface_picture(gpu: &Gpu, session: &mut Session, size: [u32; 2]) -> Result<Screenshot, ReadbackError> {
    session.wait_for_channels();
    let input = FrameInput {
        surface: &session.surface,
        mip: session.mip(),
        lobes: session.lobes(),
        fold: session.fitting().fold(),
        methods: session.shown_methods(),
        arrangement: session.comparison.arrangement(false),
        size,
    };
    let rgba = render_to_rgba8(gpu, &input, session.truth_samples)?;
    Ok(Screenshot { size, rgba })
}

/// The picture with what it shows written below it; its own pixels stay as they are.
///
/// # Errors
/// A sentence of the device.
pub fn captioned(gpu: &Gpu, picture: Screenshot, session: &Session) -> Result<Screenshot, ReadbackError> {
    let Screenshot { size: [width, height], mut rgba } = picture;
    let mut canvas = Canvas::new(gpu, [width, CAPTION_HEIGHT]);
    for _ in 0..PASSES {
        canvas.pass(Vec::new(), |ui| {
            theme::apply(ui.ctx(), Theme::Dark);
            let frame = Frame::new().fill(theme::of(ui).panel).inner_margin(6);
            CentralPanel::no_frame().frame(frame).show(ui, |ui| {
                for line in caption(session) {
                    ui.add(Label::new(RichText::new(line).small().color(theme::of(ui).text)).truncate());
                }
            });
        })?;
    }
    rgba.extend(canvas.picture()?.rgba);
    Ok(Screenshot { size: [width, height + CAPTION_HEIGHT], rgba })
}

/// What is shown, and of what material.
fn caption(session: &Session) -> [String; 2] {
    let map = session.map();
    let methods: Vec<String> = session.comparison.methods_seen().iter().map(ToString::to_string).collect();
    let fit = session.fit_settings();
    let shown = format!(
        "{} {} × {} · {} · J {}, {} · {} samples",
        map.name(),
        map.width,
        map.height,
        methods.join(", "),
        fit.lobes,
        fit.align,
        session.truth_samples
    );
    let material = serde_json::to_value(session.surface.material).unwrap_or_default();
    [shown, words(&material)]
}

/// A value as words: names before what they stand for, separated by commas.
fn words(value: &Value) -> String {
    match value {
        Value::Object(fields) => {
            let field = |(name, value): (&String, &Value)| format!("{} {}", name.replace('_', " "), words(value));
            fields.iter().map(field).collect::<Vec<_>>().join(", ")
        }
        Value::Array(values) => values.iter().map(words).collect::<Vec<_>>().join(" "),
        Value::Number(number) => {
            let digits = number.as_f64().map(|number| format!("{number:.3}")).unwrap_or_default();
            digits.trim_end_matches('0').trim_end_matches('.').to_owned()
        }
        Value::String(text) => text.clone(),
        other => other.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn settings_are_words() {
        let value = serde_json::json!({"shininess": 64.0, "specular_color": [1, 0.25, 0.5]});
        assert_eq!(words(&value), "shininess 64, specular color 1 0.25 0.5");
    }
}
