//! A session that is fitted over and over: only what changed is fitted anew.

use std::sync::Arc;
use std::time::Duration;

use ndf_inspector::filter::vmf::fit::{FitEvent, Stage, Start, expected_visits, fit, fit_from};
use ndf_inspector::filter::vmf::{Alignment, FitSettings, LobePyramid, Monitor, Objective};
use ndf_inspector::normal_map::procedural;
use ndf_inspector::session::Session;

const PAPER: Alignment = Alignment::Paper { c: 0.5 };

fn session() -> Session {
    let mut session = Session::with_map(procedural::find("bricks").expect("bundled").make(64), Arc::new(|| {}));
    session.begin(FitSettings { lobes: 4, ..FitSettings::default() });
    finish(&mut session);
    session
}

fn finish(session: &mut Session) {
    while !session.fitting().is_complete() {
        session.wait(Duration::from_millis(20));
    }
}

fn fitted_afresh(session: &Session) -> LobePyramid {
    let (map, settings) = (session.map(), session.fit_settings());
    fit(map, settings, &Monitor::new(expected_visits(map, settings)), &mut |_| {}).expect("nobody cancels")
}

#[test]
fn another_alignment_keeps_the_unaligned_levels_and_comes_to_the_same() {
    let mut session = session();
    session.set_fit_settings(FitSettings { align: PAPER, ..*session.fit_settings() });
    finish(&mut session);
    assert_eq!(session.lobes().coarse, fitted_afresh(&session).coarse);
}

#[test]
fn only_the_aligned_pass_visits_normals_when_the_unaligned_levels_are_there() {
    let map = Arc::new(procedural::find("waves").expect("bundled").make(32));
    let settings = FitSettings { lobes: 3, ..FitSettings::default() };
    let mut own = Vec::new();
    let monitor = || Monitor::new(expected_visits(&map, &settings));
    let first = fit(&map, &settings, &monitor(), &mut |event| {
        if let FitEvent::Level { mixtures, stats, stage: Stage::Own, .. } = event {
            own.push((mixtures, stats));
        }
    });
    let taken = own.clone();
    let mut shown = Vec::new();
    let again = fit_from(&map, &settings, &Start { own, ..Start::default() }, &monitor(), &mut |event| {
        if let FitEvent::Level { level, mixtures, stage: Stage::Own, .. } = event {
            shown.push((level, mixtures));
        }
    });
    assert!(
        shown.iter().all(|(level, mixtures)| Arc::ptr_eq(mixtures, &taken[level - 1].0)),
        "nothing is fitted twice"
    );
    assert_eq!(first.expect("done").coarse, again.expect("done").coarse);
}

#[test]
fn a_kept_fit_comes_back_at_once_and_refit_starts_afresh() {
    let mut session = session();
    let before = Arc::clone(session.lobes());
    let settings = *session.fit_settings();
    session.set_fit_settings(FitSettings { lobes: 2, ..settings });
    finish(&mut session);
    assert_eq!(session.fitting().kept().0, 2);
    session.set_fit_settings(settings);
    assert!(session.fitting().is_complete(), "no fit runs");
    assert!(Arc::ptr_eq(&before, session.lobes()));
    assert!(session.fitting().kept().1 > 0);
    session.refit();
    assert!(!session.fitting().is_complete());
    finish(&mut session);
    assert_eq!(session.lobes().coarse, before.coarse);
}

#[test]
fn another_map_forgets_what_was_kept() {
    let mut session = session();
    let request = ndf_inspector::session::MapRequest::Bundled {
        name: "waves".to_owned(),
        options: ndf_inspector::normal_map::MapOptions::default(),
    };
    session.open(request);
    while session.is_opening() {
        session.wait(Duration::from_millis(20));
    }
    assert_eq!(session.fitting().kept().0, 0);
}

#[test]
fn the_selected_texel_is_fitted_before_its_level() {
    let map = Arc::new(procedural::find("bricks").expect("bundled").make(64));
    let settings = FitSettings { lobes: 4, ..FitSettings::default() };
    let texel = ndf_inspector::normal_map::pyramid::Texel { level: 3, x: 5, y: 2 };
    let mut order = Vec::new();
    let start = Start { first: Some(texel), ..Start::default() };
    let monitor = Monitor::new(expected_visits(&map, &settings));
    fit_from(&map, &settings, &start, &monitor, &mut |event| match event {
        FitEvent::First { texel: found, stored } => order.push((found.level, stored)),
        FitEvent::Level { level: 3, mixtures, stage: Stage::Own, .. } => order.push((3, mixtures.texel(5, 2).to_vec())),
        FitEvent::Level { level, .. } => order.push((level, Vec::new())),
        FitEvent::Color { .. } | FitEvent::Base(_) => {}
    })
    .expect("nobody cancels");
    assert_eq!(order[0].0, 3);
    assert_eq!(order[0].1, order.iter().skip(1).find(|(_, stored)| !stored.is_empty()).expect("the level").1);
}

#[test]
fn one_lobe_more_grows_from_the_fit_at_hand_and_is_about_as_likely_as_a_fit_from_the_start() {
    for objective in [Objective::Em, Objective::Likelihood] {
        let mut session = Session::with_map(procedural::find("bricks").expect("bundled").make(64), Arc::new(|| {}));
        session.begin(FitSettings { lobes: 4, objective, align: Alignment::None, ..FitSettings::default() });
        finish(&mut session);
        let fewer = log_likelihood(&session);
        session.set_fit_settings(FitSettings { lobes: 5, ..*session.fit_settings() });
        assert!(session.fitting().is_grown());
        finish(&mut session);
        let grown = log_likelihood(&session);
        session.refit();
        assert!(!session.fitting().is_grown());
        finish(&mut session);
        let afresh = log_likelihood(&session);
        assert_eq!(session.lobes().coarse, fitted_afresh(&session).coarse);
        assert!(grown > fewer + 0.05 && grown > afresh - 0.1, "{objective}: {fewer} {grown} {afresh}");
    }
}

/// The mean over levels 2 and up.
fn log_likelihood(session: &Session) -> f64 {
    let levels = &session.fitting().levels()[2..];
    levels.iter().filter_map(|level| level.stats).map(|stats| stats.mean_log_likelihood).sum::<f64>()
        / levels.len() as f64
}
