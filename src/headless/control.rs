//! Controls of the window, found by name in the tree that it shows to assistive technology.

use egui::accesskit::{Node, NodeId, Role, TreeUpdate};
use egui::{Pos2, Rect, pos2};

/// Something that has a name.
#[derive(Clone, Debug)]
pub struct Control {
    /// Its place in the tree.
    pub id: NodeId,
    /// What the tree says of it.
    pub node: Node,
}

impl Control {
    /// The one control of this name; a label only where no control has it.
    ///
    /// # Errors
    /// A sentence that names the nearest name there is, or says that there are several.
    pub fn find(tree: &TreeUpdate, name: &str) -> Result<Self, String> {
        let named: Vec<_> = all(tree).filter(|(_, own)| own == name).map(|(control, _)| control).collect();
        let inputs: Vec<_> = named.iter().filter(|control| control.is_input()).cloned().collect();
        let mut found = if inputs.is_empty() { named } else { inputs };
        match found.len() {
            0 => Err(missing(tree, name)),
            1 => Ok(found.remove(0)),
            count => Err(format!("there are {count} controls named '{name}'.")),
        }
    }

    /// Everything of this name, or with this text.
    pub fn with_text(tree: &TreeUpdate, text: &str) -> Vec<Self> {
        all(tree).filter(|(_, own)| own == text).map(|(control, _)| control).collect()
    }

    fn is_input(&self) -> bool {
        egui::accessibility::is_input(self.node.role())
    }

    /// The rectangle it covers, in points.
    pub fn rect(&self) -> Option<Rect> {
        let bounds = self.node.bounds()?;
        let point = |x: f64, y: f64| pos2(x as f32, y as f32);
        Some(Rect::from_min_max(point(bounds.x0, bounds.y0), point(bounds.x1, bounds.y1)))
    }

    /// Its middle, in points.
    pub fn middle(&self) -> Option<Pos2> {
        Some(self.rect()?.center())
    }

    /// Its value as words: a number, a text, a choice, `on` or `off`.
    pub fn value(&self) -> Option<String> {
        use egui::accesskit::Toggled;
        if let Some(toggled) = self.node.toggled() {
            return Some(if toggled == Toggled::True { "on" } else { "off" }.to_owned());
        }
        let number = self.node.numeric_value().map(|number| number.to_string());
        self.node.value().map(str::to_owned).or(number)
    }

    /// True where the value is this one: as words, or as a number to six digits, for sliders hold single precision.
    pub fn has_value(&self, wanted: &str) -> bool {
        let same = |number: f64| wanted.parse().is_ok_and(|wanted: f64| (wanted - number).abs() <= 1e-6 * number.abs());
        self.value().is_some_and(|value| value == wanted) || self.node.numeric_value().is_some_and(same)
    }
}

/// Everything that has a name, with it.
fn all(tree: &TreeUpdate) -> impl Iterator<Item = (Control, String)> {
    tree.nodes.iter().filter_map(|(id, node)| {
        let name = name(tree, node)?;
        Some((Control { id: *id, node: node.clone() }, name))
    })
}

/// The name of its own, the text of a label, or that of the label that names it.
fn name(tree: &TreeUpdate, node: &Node) -> Option<String> {
    let own = node.label().or_else(|| node.value().filter(|_| node.role() == Role::Label));
    let other = |id: &NodeId| {
        let (_, label) = tree.nodes.iter().find(|(other, _)| other == id)?;
        label.label().or(label.value()).map(str::to_owned)
    };
    own.map(str::to_owned).or_else(|| node.labelled_by().first().and_then(other))
}

fn missing(tree: &TreeUpdate, name: &str) -> String {
    let likeness = |other: &str| strsim::jaro_winkler(&name.to_lowercase(), &other.to_lowercase());
    let names = all(tree).filter(|(control, _)| control.is_input()).map(|(_, own)| own);
    let nearest = names.max_by(|a, b| likeness(a).total_cmp(&likeness(b)));
    let hint = nearest.map_or_else(String::new, |nearest| format!("; the nearest is '{nearest}'"));
    format!("there is no control named '{name}'{hint}.")
}
