//! The tour of the window in five steps. It blocks nothing: the window can be used while it is shown.

use super::dock::Panel;

/// How far the tour is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tour {
    step: Option<usize>,
}

/// What a step points at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// A panel.
    Panel(Panel),
    /// The bar at the top.
    TopBar,
}

/// A step: what it points at, a heading, what there is to say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Step {
    /// What it points at.
    pub target: Target,
    /// The heading.
    pub title: &'static str,
    /// What there is to say.
    pub text: &'static str,
}

/// Every step.
pub const STEPS: [Step; 5] = [
    Step {
        target: Target::Panel(Panel::Controls),
        title: "Your map, its fit, its light",
        text: "Open a normal or height map here, or drop one on the window. Below stand fit, material and lights: each \
               change shows at once, and a double click takes it back.",
    },
    Step {
        target: Target::Panel(Panel::Surface),
        title: "The truth beside an estimate",
        text: "Left of the wipe every normal under a pixel is shaded, right of it the fitted lobes. Drag the handle, \
               drag the surface to turn it, click it to select a texel.",
    },
    Step {
        target: Target::Panel(Panel::Texel),
        title: "What a texel holds",
        text: "The normals under the selected texel, on the sphere of directions, with the lobes that stand for them \
               and how far these are from the truth.",
    },
    Step {
        target: Target::Panel(Panel::Levels),
        title: "Every level",
        text: "All MIP levels at once; a click selects the texel under it. They show normals, slopes, lobes, or where a \
               method errs.",
    },
    Step {
        target: Target::TopBar,
        title: "Ways to work",
        text: "Presets arrange the panels, and a tab can be dragged elsewhere. Ctrl+P finds every action, ? lists the \
               keys, and the small ? beside a choice tells about it.",
    },
];

impl Tour {
    /// Shows the first step.
    pub fn start(&mut self) {
        self.step = Some(0);
    }

    /// Shows no step any more.
    pub fn end(&mut self) {
        self.step = None;
    }

    /// The step that is shown, counted from 0; `None` where none is.
    pub fn step(&self) -> Option<(usize, Step)> {
        let index = self.step?;
        Some((index, *STEPS.get(index)?))
    }

    /// The next step; after the last one, none.
    pub fn next(&mut self) {
        self.step = self.step.map(|step| step + 1).filter(|step| *step < STEPS.len());
    }

    /// The step before.
    pub fn back(&mut self) {
        self.step = self.step.map(|step| step.saturating_sub(1));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_tour_goes_through_every_step_and_ends() {
        let mut tour = Tour::default();
        assert_eq!(tour.step(), None);
        tour.start();
        tour.next();
        tour.back();
        for (index, step) in STEPS.into_iter().enumerate() {
            assert_eq!(tour.step(), Some((index, step)));
            tour.next();
        }
        assert_eq!(tour.step(), None);
    }
}
