//! Scripts that drive the window without a display: one step a line, `#` begins a comment, names with blanks stand in
//! quotes.
//!
//! ```text
//! open bark.png
//! set "Lobes J" 3
//! wait
//! drag "Surface view" 80 -20
//! picture bark-3-lobes.png
//! ```

use std::path::PathBuf;

use egui::{Key, KeyboardShortcut, Modifiers, Vec2, vec2};

use crate::app::dock::Panel;

/// What a script does, step by step.
#[derive(Clone, Debug, PartialEq)]
pub struct Script {
    /// The name that errors give.
    pub name: String,
    /// The steps, each with its line, counted from 1.
    pub steps: Vec<(usize, Step)>,
}

/// One step.
#[derive(Clone, Debug, PartialEq)]
pub enum Step {
    /// Click the control of this name, so many times.
    Click(String, usize),
    /// Leave the pointer on it until its tooltip shows.
    Hover(String),
    /// Drag from its middle by so many points.
    Drag(String, Vec2),
    /// Turn the wheel on it by so many points; up is positive.
    Scroll(String, f32),
    /// Give it a value: a number, a text, `on` or `off`, or a choice by name.
    Set(String, String),
    /// Type a text into what has the focus.
    Type(String),
    /// Press and release keys.
    Key(KeyboardShortcut),
    /// Press keys, or release them.
    Hold(KeyboardShortcut, bool),
    /// Carry out the action of this name.
    Do(String),
    /// Open a map or a session.
    Open(PathBuf),
    /// Save the session.
    Save(PathBuf),
    /// Wait until nothing is under way.
    Wait,
    /// Write a picture of the window, or of one panel.
    Picture(PathBuf, Option<Panel>),
    /// Fail unless something of this name, or with this text, is there; and has this value.
    Expect(String, Option<String>),
}

/// What a script or a step of it is wrong in: the script, the line, the cause.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("'{script}', line {line}: {cause}")]
pub struct ScriptError {
    /// The script.
    pub script: String,
    /// The line, counted from 1.
    pub line: usize,
    /// A sentence.
    pub cause: String,
}

/// How each step is written.
const USAGES: [&str; 15] = [
    "click NAME",
    "double-click NAME",
    "hover NAME",
    "drag NAME DX DY",
    "scroll NAME POINTS",
    "set NAME VALUE",
    "type TEXT",
    "key KEYS",
    "hold KEYS",
    "release KEYS",
    "do ACTION",
    "open FILE",
    "save FILE",
    "picture FILE [PANEL]",
    "expect NAME [VALUE]",
];

impl Script {
    /// Reads a script.
    ///
    /// # Errors
    /// The first line that is no step, and why.
    pub fn parse(name: &str, text: &str) -> Result<Self, ScriptError> {
        let mut steps = Vec::new();
        for (index, line) in text.lines().enumerate() {
            let error = |cause: String| ScriptError { script: name.to_owned(), line: index + 1, cause };
            let words = shlex::split(line).ok_or_else(|| error("a quote is not closed.".to_owned()))?;
            if !words.is_empty() {
                steps.push((index + 1, Step::parse(&words).map_err(error)?));
            }
        }
        Ok(Self { name: name.to_owned(), steps })
    }
}

impl Step {
    fn parse(words: &[String]) -> Result<Self, String> {
        let words: Vec<&str> = words.iter().map(String::as_str).collect();
        Ok(match words[..] {
            ["click", name] => Self::Click(name.to_owned(), 1),
            ["double-click", name] => Self::Click(name.to_owned(), 2),
            ["hover", name] => Self::Hover(name.to_owned()),
            ["drag", name, dx, dy] => Self::Drag(name.to_owned(), vec2(number(dx)?, number(dy)?)),
            ["scroll", name, points] => Self::Scroll(name.to_owned(), number(points)?),
            ["set", name, value] => Self::Set(name.to_owned(), value.to_owned()),
            ["type", text] => Self::Type(text.to_owned()),
            ["key", keys] => Self::Key(shortcut(keys)?),
            ["hold", keys] => Self::Hold(shortcut(keys)?, true),
            ["release", keys] => Self::Hold(shortcut(keys)?, false),
            ["do", action] => Self::Do(action.to_owned()),
            ["open", file] => Self::Open(file.into()),
            ["save", file] => Self::Save(file.into()),
            ["wait"] | ["wait", "for", "fit"] => Self::Wait,
            ["picture", file] => Self::Picture(file.into(), None),
            ["picture", file, panel] => Self::Picture(file.into(), Some(panel.parse()?)),
            ["expect", name] => Self::Expect(name.to_owned(), None),
            ["expect", name, value] => Self::Expect(name.to_owned(), Some(value.to_owned())),
            _ => return Err(usage(words[0])),
        })
    }
}

/// How a step that was not understood is written.
fn usage(first: &str) -> String {
    let known = USAGES.iter().find(|usage| usage.split(' ').next() == Some(first));
    let known = known.copied().or((first == "wait").then_some("wait"));
    known.map_or_else(
        || format!("'{first}' is no step; there are: {}, wait.", USAGES.join(", ")),
        |usage| format!("write it as: {usage}"),
    )
}

fn number(text: &str) -> Result<f32, String> {
    let number = text.parse().ok().filter(|number: &f32| number.is_finite());
    number.ok_or_else(|| format!("'{text}' is not a number."))
}

/// Keys as menus write them: `Ctrl+Shift+S`, `F2`, `+`.
fn shortcut(text: &str) -> Result<KeyboardShortcut, String> {
    let (before, key) = match text.strip_suffix("++") {
        Some(before) => (before, "+"),
        None if text == "+" => ("", "+"),
        None => text.rsplit_once('+').unwrap_or(("", text)),
    };
    let mut modifiers = Modifiers::NONE;
    for name in before.split('+').filter(|name| !name.is_empty()) {
        modifiers |= match name {
            "Ctrl" | "Cmd" => Modifiers::CTRL | Modifiers::COMMAND,
            "Shift" => Modifiers::SHIFT,
            "Alt" => Modifiers::ALT,
            _ => return Err(format!("'{name}' is no modifier; there are Ctrl, Shift and Alt.")),
        };
    }
    let key = Key::from_name(key).ok_or_else(|| format!("there is no key '{key}'."))?;
    Ok(KeyboardShortcut::new(modifiers, key))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn steps(text: &str) -> Vec<(usize, Step)> {
        Script::parse("a.txt", text).expect("a script").steps
    }

    fn error(text: &str) -> String {
        Script::parse("a.txt", text).expect_err("no script").to_string()
    }

    #[test]
    fn steps_keep_their_lines_and_comments_are_none() {
        let text = "# a tour\n\nset \"Lobes J\" 3 # fewer\nwait for fit\ndrag 'Surface view' 80 -20\n";
        let expected = [
            (3, Step::Set("Lobes J".to_owned(), "3".to_owned())),
            (4, Step::Wait),
            (5, Step::Drag("Surface view".to_owned(), vec2(80.0, -20.0))),
        ];
        assert_eq!(steps(text), expected);
    }

    #[test]
    fn keys_are_written_as_menus_write_them() {
        let keys = |text| shortcut(text).expect("keys");
        let ctrl = Modifiers::CTRL | Modifiers::COMMAND;
        assert_eq!(keys("Ctrl+Shift+S"), KeyboardShortcut::new(ctrl | Modifiers::SHIFT, Key::S));
        assert_eq!(keys("+"), KeyboardShortcut::new(Modifiers::NONE, Key::Plus));
        assert_eq!(keys("Ctrl++"), KeyboardShortcut::new(ctrl, Key::Plus));
        assert!(shortcut("Hyper+S").is_err() && shortcut("Ctrl+").is_err());
    }

    #[test]
    fn an_error_names_the_line_and_the_way_to_write_it() {
        assert_eq!(error("wait\nset Lobes"), "'a.txt', line 2: write it as: set NAME VALUE");
        assert!(error("dance").contains("line 1: 'dance' is no step; there are: click NAME"));
        assert!(error("click \"Lobes").contains("a quote is not closed"));
        assert!(error("drag X 1 far").contains("'far' is not a number"));
    }
}
