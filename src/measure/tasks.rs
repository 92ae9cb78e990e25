//! In which order methods are measured at points: those that read the same fit or the same channels follow each other,
//! so that each is made once.

use super::measurer::Point;
use crate::filter::MethodChoice;
use crate::filter::vmf::FitSettings;

/// One method at one point.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Task {
    /// Which of the methods.
    pub method: usize,
    /// Which of the points.
    pub point: usize,
    /// The method with the lobe count that it stands for at this point.
    pub choice: MethodChoice,
    /// The fit that it reads, where it shows lobes.
    pub fit: Option<FitSettings>,
}

/// Every method at every point: first those without lobes, in the order asked for, then those with lobes by their fit,
/// `fitted` first of all, for it is there already.
pub fn tasks(methods: &[MethodChoice], points: &[Point], fitted: Option<FitSettings>) -> Vec<Task> {
    let mut tasks = Vec::new();
    for (method, &choice) in methods.iter().enumerate() {
        tasks.extend(points.iter().enumerate().map(|(point, at)| task(method, choice, point, at)));
    }
    let mut fits: Vec<Option<FitSettings>> = vec![None];
    fits.extend(fitted.map(Some));
    for task in &tasks {
        if !fits.contains(&task.fit) {
            fits.push(task.fit);
        }
    }
    tasks.sort_by_key(|task| fits.iter().position(|fit| *fit == task.fit));
    tasks
}

fn task(method: usize, choice: MethodChoice, point: usize, at: &Point) -> Task {
    let lobes = choice.method.shows_lobes().then(|| choice.lobes.unwrap_or(at.fit.lobes));
    let fit = lobes.map(|lobes| FitSettings { lobes, ..at.fit });
    Task { method, point, choice: MethodChoice { lobes, ..choice }, fit }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::lit_surface::LitSurface;

    #[test]
    fn a_fit_is_asked_for_once_and_the_one_at_hand_first() {
        let points = [1, 2, 3].map(|lobes| Point {
            surface: LitSurface::default(),
            fit: FitSettings { lobes, ..FitSettings::default() },
        });
        let methods = ["vmf", "toksvig", "vmf:unaligned", "vmf:2"].map(|name| name.parse().expect("a method"));
        let tasks = tasks(&methods, &points, Some(points[1].fit));
        assert_eq!(tasks.len(), 12);
        assert!(tasks[..3].iter().all(|task| task.method == 1 && task.fit.is_none()));
        let lobes: Vec<usize> = tasks[3..].iter().filter_map(|task| Some(task.fit?.lobes)).collect();
        assert_eq!(lobes, [2, 2, 2, 2, 2, 1, 1, 3, 3]);
        assert_eq!(tasks[3].choice.to_string(), "vmf:2");
    }
}
