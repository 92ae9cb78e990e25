//! Plays scripts on a window without a window: every step becomes the events that a hand would make.

use std::path::Path;
use std::time::{Duration, Instant};

use egui::accesskit::{Action, ActionData, ActionRequest, Role, TreeId};
use egui::{
    Event, KeyboardShortcut, Modifiers, MouseWheelSource, MouseWheelUnit, PointerButton, Pos2, TouchPhase, Vec2, vec2,
};

use super::Headless;
use super::control::Control;
use super::script::{Script, ScriptError, Step};
use crate::app::dock::Panel;
use crate::app::{Command, actions};
use crate::image_io::write_png_rgba8;

/// Passes after which the layout has followed what a step did.
const PASSES: usize = 3;
/// Seconds between two clicks of different steps, which are no double click.
const PAUSE: f64 = 1.0;
/// Seconds that a pass takes while a tooltip is waited for.
const TOOLTIP_STEP: f64 = 0.5;
/// How long a step may wait.
const PATIENCE: Duration = Duration::from_secs(600);
/// Height of the bars at the top and the bottom of the window, under which nothing that scrolls can be seen.
const BAR: f32 = 32.0;

impl Headless<'_> {
    /// Plays a script to its end. Pictures wait until nothing is under way.
    ///
    /// # Errors
    /// The line that could not be done, and why.
    pub fn play(&mut self, script: &Script) -> Result<(), ScriptError> {
        self.canvas.ctx.enable_accesskit();
        let mut start = || self.rest(PASSES).and_then(|()| self.wait_until_settled());
        start().map_err(|cause| ScriptError { script: script.name.clone(), line: 1, cause })?;
        for (line, step) in &script.steps {
            self.step(step).map_err(|cause| ScriptError { script: script.name.clone(), line: *line, cause })?;
        }
        Ok(())
    }

    fn step(&mut self, step: &Step) -> Result<(), String> {
        match step {
            Step::Click(name, times) => self.click(name, *times)?,
            Step::Hover(name) => self.hover(name)?,
            Step::Drag(name, by) => self.drag(name, *by)?,
            Step::Scroll(name, points) => self.scroll(name, *points)?,
            Step::Set(name, value) => self.set(name, value)?,
            Step::Type(text) => self.events([Event::Text(text.clone())])?,
            Step::Key(keys) => {
                self.events([key(*keys, true)])?;
                self.events([key(*keys, false)])?;
            }
            Step::Hold(keys, pressed) => self.events([key(*keys, *pressed)])?,
            Step::Do(name) => self.act(name)?,
            Step::Open(path) => self.command(Command::OpenPath(path.clone()))?,
            Step::Save(path) => self.command(Command::SaveSession(path.clone()))?,
            Step::Wait => self.wait_until_settled()?,
            Step::Picture(path, panel) => self.picture(path, *panel)?,
            Step::Expect(name, value) => return self.expect(name, value.as_deref()),
        }
        self.rest(PASSES)
    }

    fn rest(&mut self, passes: usize) -> Result<(), String> {
        (0..passes).try_for_each(|_| self.events([]))
    }

    fn events(&mut self, events: impl IntoIterator<Item = Event>) -> Result<(), String> {
        self.pass(events.into_iter().collect()).map_err(|error| error.to_string())
    }

    /// Waits for jobs and unfinished pictures. Time stands still, so that what comes after does not depend on how long
    /// it took.
    fn wait_until_settled(&mut self) -> Result<(), String> {
        let start = Instant::now();
        self.still(|window| {
            loop {
                window.events([])?;
                if window.is_settled() {
                    return Ok(());
                }
                if start.elapsed() > PATIENCE {
                    return Err("nothing came to rest in ten minutes.".to_owned());
                }
                window.let_jobs_run();
            }
        })
    }

    fn control(&self, name: &str) -> Result<Control, String> {
        let tree = self.canvas.tree.as_ref().ok_or("the window has no tree of controls.")?;
        Control::find(tree, name)
    }

    /// The middle of a control, scrolled into sight where need be.
    fn middle(&mut self, name: &str) -> Result<Pos2, String> {
        let window = self.canvas.ctx.content_rect().shrink2(vec2(0.0, BAR));
        let seen = |control: &Control| control.middle().is_some_and(|middle| window.contains(middle));
        let mut control = self.control(name)?;
        if !seen(&control) {
            self.request(&control, Action::ScrollIntoView, None)?;
            self.rest(PASSES)?;
            control = self.control(name)?;
        }
        let middle = control.middle().filter(|&middle| self.canvas.ctx.content_rect().contains(middle));
        middle.ok_or_else(|| format!("'{name}' is out of sight."))
    }

    fn request(&mut self, control: &Control, action: Action, data: Option<ActionData>) -> Result<(), String> {
        let request = ActionRequest { action, target_tree: TreeId::ROOT, target_node: control.id, data };
        self.events([Event::AccessKitActionRequest(request)])
    }

    fn click(&mut self, name: &str, times: usize) -> Result<(), String> {
        let at = self.middle(name)?;
        self.canvas.clock += PAUSE;
        self.events([Event::PointerMoved(at)])?;
        for _ in 0..times {
            self.events([button(at, true)])?;
            self.events([button(at, false)])?;
        }
        Ok(())
    }

    fn hover(&mut self, name: &str) -> Result<(), String> {
        let at = self.middle(name)?;
        self.events([Event::PointerMoved(at)])?;
        self.canvas.clock += TOOLTIP_STEP;
        self.rest(1)?;
        self.canvas.clock += TOOLTIP_STEP;
        self.rest(1)
    }

    fn drag(&mut self, name: &str, by: Vec2) -> Result<(), String> {
        let from = self.middle(name)?;
        self.canvas.clock += PAUSE;
        self.events([Event::PointerMoved(from)])?;
        self.events([button(from, true)])?;
        for quarter in 1..=4 {
            self.events([Event::PointerMoved(from + by * (quarter as f32 / 4.0))])?;
        }
        self.events([button(from + by, false)])
    }

    fn scroll(&mut self, name: &str, points: f32) -> Result<(), String> {
        let at = self.middle(name)?;
        self.events([Event::PointerMoved(at)])?;
        let wheel = Event::MouseWheel {
            unit: MouseWheelUnit::Point,
            delta: vec2(0.0, points),
            phase: TouchPhase::Move,
            source: MouseWheelSource::Wheel,
            modifiers: Modifiers::NONE,
        };
        self.events([wheel])?;
        // The toolkit spreads a turn of the wheel over a fraction of a second.
        self.rest(30)
    }

    fn set(&mut self, name: &str, value: &str) -> Result<(), String> {
        let control = self.control(name)?;
        match control.node.role() {
            Role::Slider | Role::SpinButton => self.set_number(&control, name, value),
            Role::TextInput | Role::MultilineTextInput => {
                self.request(&control, Action::SetValue, Some(ActionData::Value(value.into())))
            }
            Role::ComboBox => self.choose(name, value),
            _ if control.node.toggled().is_some() => match value {
                "on" | "off" if control.has_value(value) => Ok(()),
                "on" | "off" => self.click(name, 1),
                _ => Err(format!("'{name}' is on or off, not '{value}'.")),
            },
            _ => Err(format!("'{name}' has no value to be set.")),
        }
    }

    fn set_number(&mut self, control: &Control, name: &str, value: &str) -> Result<(), String> {
        let number = value.parse().map_err(|_| format!("'{value}' is not a number."))?;
        let (low, high) = (control.node.min_numeric_value(), control.node.max_numeric_value());
        if let (Some(low), Some(high)) = (low, high)
            && !(low..=high).contains(&number)
        {
            return Err(format!("'{name}' goes from {low} to {high}, and {value} is beyond."));
        }
        self.request(control, Action::SetValue, Some(ActionData::NumericValue(number)))
    }

    fn choose(&mut self, name: &str, choice: &str) -> Result<(), String> {
        self.click(name, 1)?;
        self.rest(PASSES)?;
        let found = self.middle(choice).map_err(|_| format!("'{name}' offers no '{choice}'."))?;
        self.events([Event::PointerMoved(found)])?;
        self.events([button(found, true)])?;
        self.events([button(found, false)])
    }

    fn act(&mut self, name: &str) -> Result<(), String> {
        let action =
            actions::find(name).ok_or_else(|| format!("there is no action '{name}'; the key list has all."))?;
        let command = action.command(&self.inspector.facts());
        self.command(command.ok_or_else(|| format!("'{name}' cannot be done now."))?)
    }

    fn command(&mut self, command: Command) -> Result<(), String> {
        let before = self.inspector.messages().len();
        self.inspector.run(command, &self.canvas.ctx);
        self.wait_until_opened()?;
        let error = self.inspector.messages().iter().skip(before).find(|message| message.is_error);
        error.map_or(Ok(()), |message| Err(message.text.clone()))
    }

    /// A map and a session file are worth waiting for: no step can mean the time before.
    fn wait_until_opened(&mut self) -> Result<(), String> {
        let start = Instant::now();
        let is_busy = |window: &Self| {
            let session = &window.inspector.session;
            (session.is_opening() || session.is_saving()) && start.elapsed() < PATIENCE
        };
        self.still(|window| {
            while is_busy(window) {
                window.let_jobs_run();
                window.events([])?;
            }
            window.events([])
        })
    }

    fn picture(&mut self, path: &Path, panel: Option<Panel>) -> Result<(), String> {
        let picture = self.screenshot_of(panel).map_err(|error| error.to_string())?;
        let [width, height] = picture.size.map(|side| side as usize);
        write_png_rgba8(path, width, height, &picture.rgba).map_err(|error| error.to_string())
    }

    fn expect(&mut self, name: &str, value: Option<&str>) -> Result<(), String> {
        let tree = self.canvas.tree.as_ref().ok_or("the window has no tree of controls.")?;
        let found = Control::with_text(tree, name);
        let Some(value) = value else {
            return if found.is_empty() { Control::find(tree, name).map(drop) } else { Ok(()) };
        };
        let control = Control::find(tree, name)?;
        let own = control.value().unwrap_or_else(|| "nothing".to_owned());
        if control.has_value(value) { Ok(()) } else { Err(format!("'{name}' is {own}, not {value}.")) }
    }
}

fn button(pos: Pos2, pressed: bool) -> Event {
    Event::PointerButton { pos, button: PointerButton::Primary, pressed, modifiers: Modifiers::NONE }
}

fn key(keys: KeyboardShortcut, pressed: bool) -> Event {
    let KeyboardShortcut { modifiers, logical_key } = keys;
    Event::Key { key: logical_key, physical_key: None, pressed, repeat: false, modifiers }
}
