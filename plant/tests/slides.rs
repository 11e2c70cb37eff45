//! The slides behind a tracker board.

use plant::{Slide, SlidePlant};
use plant_file::{DEFAULT_MACHINE, PlantFile};
use shared::io::{DacCode, SLIDES, SlideCommand};

/// Control tick \[s\].
const TICK: f64 = 1e-3;
const VELOCITY_AT_10V: f64 = 100.0;
/// Slides at power-up \[mm\].
const POWER_UP: [f64; SLIDES] = [1.3, -0.8, -1.1, 0.9];

fn shipped() -> PlantFile {
    PlantFile::shipped(DEFAULT_MACHINE).unwrap()
}

fn plant() -> SlidePlant {
    shipped().slides()
}

fn command(mm_s: f64) -> SlideCommand {
    SlideCommand {
        enable: true,
        dac: [DacCode::from_ratio(mm_s, VELOCITY_AT_10V); SLIDES],
        ..SlideCommand::SAFE
    }
}

#[test]
fn a_step_command_gives_dead_time_and_a_first_order_lag() {
    let mut config = shipped().plant.slides[0].clone().unwrap();
    config.power_up = 0.0;
    let mut slide = Slide::new(&config);
    slide.advance(Some(10.0 / VELOCITY_AT_10V));
    slide.advance(Some(10.0 / VELOCITY_AT_10V));
    assert_eq!(slide.position(), 0.0);
    for k in 1..60 {
        slide.advance(Some(10.0 / VELOCITY_AT_10V));
        let t = f64::from(k) * TICK;
        let position = 10.0 * (t - 8e-3 * (1.0 - libm::exp(-t / 8e-3)));
        assert!(
            (slide.position() - position).abs() < 1e-3,
            "{k} ms: {}",
            slide.position()
        );
    }
}

#[test]
fn encoders_agree_with_the_truth_within_a_count_and_find_their_marks() {
    let mut plant = plant();
    let mut marks = [[None; SLIDES]; 2];
    for k in 0..900 {
        let speed = if k < 300 { -10.0 } else { 10.0 };
        let feedback = plant.advance(&command(speed));
        for i in 0..SLIDES {
            let moved = (plant.truth()[i] - POWER_UP[i]) * 2000.0;
            assert!((feedback.counts[i] as f64 - moved).abs() <= 1.0 + 1e-9);
            if let Some(mark) = feedback.mark[i] {
                marks[usize::from(speed > 0.0)][i] = Some(mark);
            }
        }
    }
    assert_eq!(marks[1], [Some(-2600), Some(1600), Some(2200), Some(-1800)]);
    // Those that started above their mark passed it downwards as well, at the same count.
    assert_eq!((marks[0][0], marks[0][3]), (marks[1][0], marks[1][3]));
}

#[test]
fn switches_close_outside_the_travel() {
    let mut plant = plant();
    let mut feedback = plant.advance(&command(100.0));
    for _ in 0..200 {
        feedback = plant.advance(&command(100.0));
    }
    assert_eq!((feedback.limit_minus.0, feedback.limit_plus.0), (0, 0b1111));
    for _ in 0..400 {
        feedback = plant.advance(&command(-100.0));
    }
    assert_eq!((feedback.limit_minus.0, feedback.limit_plus.0), (0b1111, 0));
}

#[test]
fn disabled_slides_stop_at_once_and_ignore_commands() {
    let mut plant = plant();
    for _ in 0..100 {
        plant.advance(&command(50.0));
    }
    let moving = plant.truth();
    let ignored = SlideCommand {
        enable: false,
        ..command(50.0)
    };
    for _ in 0..100 {
        plant.advance(&ignored);
    }
    for (rest, moving) in plant.truth().iter().zip(moving) {
        // v·τ = 0.1 mm
        assert!((rest - moving).abs() < 0.11);
    }
}
