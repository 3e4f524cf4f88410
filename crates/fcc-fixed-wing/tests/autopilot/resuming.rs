//! Continuing an interrupted flight.

use fcc_core::flight::Surfaces;
use fcc_core::framework::Controller;
use fcc_fixed_wing::{AutopilotCommand, AutopilotConfig, Resume};
use fcc_guidance::{GuidanceConfig, Mode, Progress, Targets};

use crate::cockpit::{Cockpit, KNOT_MPS, STANDING};

/// Interrupted 65 s into the pattern, whose start was at 350° and 3,000 ft: in
/// leg 3, which in the thesis is 270° further and 150 ft higher.
#[test]
fn a_pattern_is_continued_where_it_was() {
    let mut cockpit = Cockpit::engaged(AutopilotConfig::default().guidance);
    cockpit.step();
    let resume = Resume {
        progress: Progress {
            mode: Mode::TimedPattern,
            elapsed_s: 65.0,
            captured: Targets {
                airspeed_mps: 95.0 * KNOT_MPS,
                heading_rad: 350.0_f64.to_radians(),
                altitude_m: 914.4,
            },
            ..Progress::default()
        },
        surfaces: STANDING,
        ..Resume::default()
    };
    cockpit.autopilot.command(&AutopilotCommand::Resume(resume));
    let aims_at = |cockpit: &mut Cockpit, heading_deg: f64, altitude_ft: f64| {
        cockpit.step();
        let aims = cockpit.autopilot.setpoints();
        assert!((aims.heading_rad.to_degrees() - heading_deg).abs() < 1e-6);
        assert!((aims.altitude_m / 0.304_8 - altitude_ft).abs() < 1e-6);
        assert!((aims.airspeed_mps / KNOT_MPS - 95.0).abs() < 1e-6);
    };
    aims_at(&mut cockpit, 260.0, 3_150.0);
    // From 30° to 260°: the shorter way is to the left.
    cockpit.steps(40);
    assert!(cockpit.autopilot.setpoints().roll_rad < -0.5);
    // 15 s to the next leg, of which 41 ticks have passed.
    cockpit.steps(15 * 40);
    aims_at(&mut cockpit, 350.0, 3_000.0);
}

#[test]
fn hold_is_continued_with_the_last_surfaces() {
    let mut cockpit = Cockpit::engaged(AutopilotConfig::default().guidance);
    let flew = Surfaces {
        throttle: 0.8,
        elevator: 0.11,
        aileron: 0.03,
        rudder: -0.04,
        ..Surfaces::IDLE
    };
    let resume = Resume {
        progress: Progress {
            mode: Mode::Hold,
            captured: Targets {
                airspeed_mps: 100.0 * KNOT_MPS,
                heading_rad: 30.0_f64.to_radians(),
                altitude_m: 914.4,
            },
            ..Progress::default()
        },
        surfaces: flew,
        ..Resume::default()
    };
    cockpit.autopilot.command(&AutopilotCommand::Resume(resume));
    let first = cockpit.step();
    for (ours, was) in [
        (first.throttle, flew.throttle),
        (first.elevator, flew.elevator),
        (first.aileron, flew.aileron),
        (first.rudder, flew.rudder),
    ] {
        assert!((ours - was).abs() < 1e-6, "{ours} against {was}");
    }
    cockpit.steps(40 * 60);
    let aims = cockpit.autopilot.setpoints();
    assert!((aims.heading_rad.to_degrees() - 30.0).abs() < 1e-6, "held");
}

#[test]
fn an_invalid_progress_is_not_resumed() {
    let sane = Resume {
        progress: Progress {
            mode: Mode::Hold,
            captured: Targets {
                airspeed_mps: 50.0,
                heading_rad: 3.0,
                altitude_m: 2_000.0,
            },
            ..Progress::default()
        },
        surfaces: STANDING,
        ..Resume::default()
    };
    let mut no_altitude = sane;
    no_altitude.progress.captured.altitude_m = f64::NAN;
    let mut too_much_throttle = sane;
    too_much_throttle.surfaces.throttle = 1.5;
    let mut a_pattern = sane;
    a_pattern.progress.mode = Mode::TimedPattern;
    let mut no_mode = sane;
    no_mode.progress.mode = Mode::None;
    let mut before_it_began = sane;
    before_it_began.progress.elapsed_s = -1.0;
    let nonsense = [
        no_altitude,
        too_much_throttle,
        a_pattern,
        no_mode,
        before_it_began,
    ];
    for resume in nonsense {
        let mut cockpit = Cockpit::engaged(GuidanceConfig::Hold);
        cockpit.autopilot.command(&AutopilotCommand::Resume(resume));
        cockpit.step();
        let aims = cockpit.autopilot.setpoints();
        assert!((aims.altitude_m - 914.4).abs() < 1e-6, "{resume:?}");
    }
}
