//! A hand without a plan: ten thousand events, the same in every run.

use std::time::{Duration, Instant};

use egui::{Event, Key, Modifiers, MouseWheelSource, MouseWheelUnit, PointerButton, Pos2, TouchPhase, pos2, vec2};
use ndf_inspector::filter::vmf::FitSettings;

use super::{QUICK, Window, session, window};

const EVENTS: usize = 10_000;
/// As many come in one pass of the window, as they do from a quick hand.
const IN_A_PASS: usize = 5;
/// No pass may take longer.
const PATIENCE: Duration = Duration::from_secs(5);

/// Marsaglia's xorshift: small, and the same everywhere.
struct Random(u64);

impl Random {
    fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0
    }

    fn below(&mut self, count: usize) -> usize {
        (self.next() >> 11) as usize % count
    }

    fn unit(&mut self) -> f32 {
        (self.next() >> 40) as f32 / (1_u32 << 24) as f32
    }

    fn of<T: Copy>(&mut self, among: &[T]) -> T {
        among[self.below(among.len())]
    }

    fn modifiers(&mut self) -> Modifiers {
        let held = [Modifiers::SHIFT, Modifiers::COMMAND, Modifiers::ALT, Modifiers::COMMAND | Modifiers::SHIFT];
        if self.below(4) == 0 { self.of(&held) } else { Modifiers::NONE }
    }
}

/// What the hand holds.
#[derive(Default)]
struct Hand {
    at: Pos2,
    pressed: Option<PointerButton>,
    held: Option<(Key, Modifiers)>,
}

impl Hand {
    /// The next movement. Keys that end the program, open the system's dialogs or write files are left alone.
    fn event(&mut self, random: &mut Random) -> Event {
        if let Some((key, modifiers)) = self.held.take() {
            return Event::Key { key, physical_key: None, pressed: false, repeat: false, modifiers };
        }
        match random.below(20) {
            0..6 => self.press(random),
            6..14 => {
                // Now across the whole window, now a little way.
                let far = random.below(2) == 0;
                let (x, y) = (random.unit(), random.unit());
                let near = self.at + 60.0 * vec2(x - 0.5, y - 0.5);
                self.at = if far { pos2(1280.0 * x, 800.0 * y) } else { near };
                Event::PointerMoved(self.at)
            }
            14..16 => Event::MouseWheel {
                unit: MouseWheelUnit::Point,
                delta: vec2(0.0, 120.0 * (random.unit() - 0.5)),
                phase: TouchPhase::Move,
                source: MouseWheelSource::Wheel,
                modifiers: Modifiers::NONE,
            },
            16 => Event::Text(random.of(&["7", "0.5", "-", "e", "map", "λ"]).to_owned()),
            17 if random.below(8) == 0 => Event::PointerGone,
            _ => {
                let modifiers = random.modifiers();
                let key = random.of(Key::ALL);
                let is_left_alone = modifiers.command && matches!(key, Key::Q | Key::S | Key::O | Key::E);
                let key = if is_left_alone || key == Key::Copy { Key::Escape } else { key };
                self.held = Some((key, modifiers));
                Event::Key { key, physical_key: None, pressed: true, repeat: false, modifiers }
            }
        }
    }

    fn press(&mut self, random: &mut Random) -> Event {
        let (button, pressed) = match self.pressed.take() {
            Some(button) => (button, false),
            None => {
                let button = random.of(&[PointerButton::Primary; 6]);
                let button = if random.below(8) == 0 { PointerButton::Secondary } else { button };
                self.pressed = Some(button);
                (button, true)
            }
        };
        Event::PointerButton { pos: self.at, button, pressed, modifiers: random.modifiers() }
    }
}

/// Keeps the fit as small as the map, whatever was chosen: its time is not what is tested.
fn calm(window: &mut Window) {
    let session = &mut window.state_mut().inspector.session;
    session.truth_samples = session.truth_samples.min(64);
    if session.map().width > 64 || session.fit_settings().iterations > 20 || session.fit_settings().lobes > 3 {
        session.set_fit_settings(FitSettings { ..QUICK });
    }
}

fn kind(event: &Event) -> usize {
    match event {
        Event::Key { .. } => 0,
        Event::PointerButton { .. } => 1,
        Event::PointerMoved(_) => 2,
        _ => 3,
    }
}

#[test]
fn ten_thousand_random_events_end_without_a_panic_and_none_takes_long() {
    let mut window = window(|wake| {
        let mut session = session("pyramid5", 16, wake);
        session.begin(QUICK);
        session
    });
    let (mut random, mut hand) = (Random(0x9e37_79b9_7f4a_7c15), Hand::default());
    let (mut slowest, mut kinds) = (Duration::ZERO, [0_usize; 4]);
    for pass in 0..EVENTS / IN_A_PASS {
        let events: Vec<Event> = (0..IN_A_PASS).map(|_| hand.event(&mut random)).collect();
        for event in &events {
            kinds[kind(event)] += 1;
        }
        let words = format!("{events:?}");
        window.input_mut().events.extend(events);
        let began = Instant::now();
        window.step();
        slowest = slowest.max(began.elapsed());
        assert!(began.elapsed() < PATIENCE, "pass {pass} took {:?}: {words}", began.elapsed());
        if pass % 100 == 0 {
            calm(&mut window);
            window.render().expect("a picture");
        }
    }
    assert_eq!(kinds.iter().sum::<usize>(), EVENTS);
    assert!(kinds.iter().all(|&count| count > 400), "too few of a kind: {kinds:?}");
    eprintln!("keys, buttons, moves, others: {kinds:?}; the slowest took {slowest:?}");
}
