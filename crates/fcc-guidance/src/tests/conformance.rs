//! Conformance suite for all modes.

use std::format;

use super::{
    ActiveMode, Guidance, GuidanceConfig, Hold, Mode, Progress, Targets, TimedPattern,
    TimedPatternConfig,
};
use fcc_navigation::Estimate;

const TICK_S: f64 = 0.025;
/// 10 minutes.
const TICKS: u32 = 24_000;

const CAPTURED: Targets = Targets {
    airspeed_mps: 51.4,
    heading_rad: 6.1,
    altitude_m: 914.4,
};

/// Runs the suite on a mode.
fn conforms<G: Guidance>(config: G::Config) {
    begins_with_the_captured_targets::<G>(config);
    a_step_of_zero_seconds_changes_nothing::<G>(config);
    can_be_resumed_from_any_tick::<G>(config);
    a_refined_altitude_shifts_the_targets::<G>(config);
    targets_stay_finite::<G>(config);
}

fn begins_with_the_captured_targets<G: Guidance>(config: G::Config) {
    let begins = Progress {
        mode: G::MODE,
        item: G::enter(config, CAPTURED).progress().item,
        elapsed_s: 0.0,
        captured: CAPTURED,
    };
    assert_eq!(G::enter(config, CAPTURED).progress(), begins);
    assert_ne!(G::MODE, Mode::None);
}

fn a_step_of_zero_seconds_changes_nothing<G: Guidance>(config: G::Config) {
    let mut mode = G::enter(config, CAPTURED);
    for n in 0..TICKS {
        if n % 100 == 0 {
            let (progress, targets) = (mode.progress(), mode.targets());
            mode.advance(&Estimate::default(), 0.0);
            assert_eq!((mode.progress(), mode.targets()), (progress, targets));
        }
        mode.advance(&Estimate::default(), TICK_S);
    }
    let flown_s = f64::from(TICKS) * TICK_S;
    assert!((mode.progress().elapsed_s - flown_s).abs() < 1e-6);
}

/// The progress is sufficient to continue.
fn can_be_resumed_from_any_tick<G: Guidance>(config: G::Config) {
    let mut mode = G::enter(config, CAPTURED);
    let mut again = G::enter(config, CAPTURED);
    for n in 0..TICKS {
        if n % 777 == 0 {
            again = G::resume(config, &mode.progress());
        }
        assert_eq!(mode.targets(), again.targets(), "in tick {n}");
        assert_eq!(mode.progress(), again.progress(), "in tick {n}");
        mode.advance(&Estimate::default(), TICK_S);
        again.advance(&Estimate::default(), TICK_S);
    }
}

fn a_refined_altitude_shifts_the_targets<G: Guidance>(config: G::Config) {
    let mut mode = G::enter(config, CAPTURED);
    for _ in 0..TICKS {
        let before = mode.targets();
        mode.shift_altitude(0.125);
        let after = mode.targets();
        assert!((after.altitude_m - before.altitude_m - 0.125).abs() < 1e-9);
        assert_eq!(after.airspeed_mps, before.airspeed_mps);
        assert_eq!(after.heading_rad, before.heading_rad);
        mode.shift_altitude(-0.125);
        mode.advance(&Estimate::default(), TICK_S);
    }
}

fn targets_stay_finite<G: Guidance>(config: G::Config) {
    for elapsed_s in [0.0, 1e-9, 1e3, 1e9, 1e18] {
        let progress = Progress {
            mode: G::MODE,
            elapsed_s,
            captured: CAPTURED,
            ..Progress::default()
        };
        assert!(progress.is_valid());
        let mut mode = G::resume(config, &progress);
        for _ in 0..100 {
            assert!(mode.targets().is_finite(), "after {elapsed_s} s");
            assert!(mode.progress().is_valid(), "after {elapsed_s} s");
            mode.advance(&Estimate::default(), TICK_S);
        }
    }
}

#[test]
fn hold_conforms() {
    conforms::<Hold>(());
}

#[test]
fn the_timed_pattern_conforms() {
    conforms::<TimedPattern>(TimedPatternConfig::default());
    conforms::<TimedPattern>(TimedPatternConfig {
        hold_s: 0.0,
        leg_s: 1.0,
        turn_rad: -3.0,
        climb_m: -100.0,
    });
}

/// A mode that is in the table but not in the enum could never be active.
#[test]
fn the_active_mode_is_the_one_that_was_entered() {
    let config = GuidanceConfig::TimedPattern(TimedPatternConfig::default());
    for mode in [Mode::None, Mode::Hold, Mode::TimedPattern] {
        let active = ActiveMode::enter(mode, &config, CAPTURED);
        assert_eq!(active.mode(), mode);
        assert_eq!(active.targets().is_some(), mode != Mode::None);
    }
    let unknown = ActiveMode::enter(Mode::TimedPattern, &GuidanceConfig::Hold, CAPTURED);
    assert_eq!(unknown, ActiveMode::None);
}

/// The spelling in a configuration, for a log or a display.
#[test]
fn modes_have_names() {
    let names = Mode::ALL.map(|mode| format!("{mode}"));
    let expected = [
        "none",
        "hold",
        "timed-pattern",
        "plan",
        "loiter",
        "go-to",
        "return",
        "take-off",
        "land",
        "go-around",
        "glide",
    ];
    assert_eq!(names, expected);
}
