//! How far a comparison is, on a terminal; and what it has found.

use std::io::IsTerminal;

use indicatif::{ProgressBar, ProgressStyle};

use super::sheet::Row;
use crate::filter::MethodChoice;
use crate::measure::{Finding, Findings, Follower, MeasureSettings, Point, Shown};
use crate::session::Session;

/// Follows a comparison of several maps: a bar on a terminal, nothing in a pipe.
pub struct Bar {
    bar: ProgressBar,
    methods: usize,
    map: String,
    at: String,
    findings: Findings,
    /// `pictures[point]`: the truth's, then each method's.
    pictures: Vec<Vec<Option<Shown>>>,
}

impl Bar {
    /// A bar over so many points of all maps.
    pub fn new(points: usize, settings: &MeasureSettings) -> Self {
        let methods = settings.methods.len();
        let steps = (points * methods) as u64;
        let bar = if std::io::stderr().is_terminal() { ProgressBar::new(steps) } else { ProgressBar::hidden() };
        if let Ok(style) = ProgressStyle::with_template("comparing {bar:32} {percent:>3} % {msg}") {
            bar.set_style(style);
        }
        let (map, at) = (String::new(), String::new());
        Self { bar, methods, map, at, findings: Findings::default(), pictures: Vec::new() }
    }

    /// Goes on to the map of this name, with so many points.
    pub fn map(&mut self, name: &str, points: usize) {
        name.clone_into(&mut self.map);
        self.findings = Findings::new(points, self.methods);
        self.pictures = vec![vec![None; self.methods + 1]; points];
    }

    /// What was found of the map.
    pub fn rows(&mut self, points: &[Point]) -> Vec<Row> {
        let pictures = std::mem::take(&mut self.pictures).into_iter().map(|all| all.into_iter().flatten().collect());
        let cells = points.iter().enumerate().map(|(index, point)| self.findings.cell(&self.map, index, point));
        cells.zip(pictures).filter_map(|(cell, pictures)| Some(Row { cell: cell?, pictures })).collect()
    }

    /// Takes the bar away.
    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }
}

impl Follower for Bar {
    fn begins(&mut self, method: MethodChoice, _point: usize) {
        self.at = format!("{}, {method}", self.map);
        self.bar.set_message(self.at.clone());
    }

    fn waits(&mut self, session: &Session) {
        if let Some(progress) = session.fitting().progress() {
            self.bar.set_message(format!("{}, fit {:.0} %", self.at, 100.0 * progress.fraction));
        }
    }

    fn finds(&mut self, finding: Finding) {
        self.findings.take(&finding);
        match finding {
            Finding::Truth { point, picture, .. } => self.pictures[point][0] = picture,
            Finding::Method { point, method, picture, .. } => {
                self.bar.inc(1);
                self.pictures[point][method + 1] = picture;
            }
        }
    }
}
