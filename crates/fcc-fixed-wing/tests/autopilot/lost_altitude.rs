//! A failsafe without a plausible altitude, and its return.

use fcc_core::flight::SpecificForce;
use fcc_core::framework::{Controller, Flags};
use fcc_fixed_wing::flags;
use fcc_guidance::GuidanceConfig;

use crate::cockpit::{Cockpit, DT_S, LEVEL};

const TICKS_PER_S: i32 = 40;

/// In failsafe, for so many seconds, with accelerometers that feel a push up.
fn hold(cockpit: &mut Cockpit, passed_s: i32, push_mps2: f64, mut feels_m: impl FnMut(i32) -> f64) {
    for tick in 0..TICKS_PER_S * passed_s {
        cockpit.feel.altitude_m = feels_m(tick);
        cockpit.observe_with(|measured| {
            let force = &mut measured.specific_force.value;
            *force = SpecificForce {
                z_mps2: force.z_mps2 - push_mps2,
                ..*force
            };
        });
        cockpit.failsafe();
    }
}

/// 25 m of noise for 15 s, then perfect: what was flown is flown on within 20 s.
#[test]
fn an_altitude_that_was_noisy_is_used_again() {
    let mut cockpit = Cockpit::engaged(GuidanceConfig::Hold);
    cockpit.step();
    let mut last = 1_u32;
    hold(&mut cockpit, 15, 0.3, |_| {
        // Park and Miller 1988.
        last = (u64::from(last) * 48_271 % 2_147_483_647) as u32;
        LEVEL.altitude_m + 87.0 * (f64::from(last) / 2_147_483_647.0 - 0.5)
    });
    hold(&mut cockpit, 20, 0.3, |_| LEVEL.altitude_m);
    assert_eq!(cockpit.faults(), Flags::NONE);
    assert!(cockpit.autopilot.has_recovered());
    let altitude_m = cockpit.autopilot.estimated().altitude_m;
    assert!((altitude_m - LEVEL.altitude_m).abs() < 3.0, "{altitude_m}");
}

/// Every sample is 600 m off, and accelerometers are wrong by 0.5 m/s²: by them alone
/// 2,500 m in 100 s, and an airspeed that is 13 % faster by the standard atmosphere.
#[test]
fn an_altitude_that_is_not_measured_does_not_run_away() {
    let mut cockpit = Cockpit::engaged(GuidanceConfig::Hold);
    cockpit.step();
    let true_by_indicated = |cockpit: &Cockpit| {
        let estimate = cockpit.autopilot.estimated();
        estimate.true_airspeed_mps / estimate.airspeed_mps
    };
    let before = true_by_indicated(&cockpit);
    hold(&mut cockpit, 100, 0.5, |tick| {
        LEVEL.altitude_m + 600.0 * f64::from(1 - tick % 2 * 2)
    });
    assert!(cockpit.faults().contains(flags::ALTITUDE | flags::REJECTED));
    let estimate = cockpit.autopilot.estimated();
    let off_m = estimate.altitude_m - LEVEL.altitude_m;
    assert!(off_m.abs() < 150.0, "{off_m}");
    assert!(estimate.climb_rate_mps.abs() < 0.1);
    assert!((true_by_indicated(&cockpit) / before - 1.0).abs() < 0.001);
}

/// The barometer returns with an aircraft that sinks by 3 m/s, 60 m below.
#[test]
fn a_returning_altitude_may_have_changed_meanwhile() {
    let mut cockpit = Cockpit::engaged(GuidanceConfig::Hold);
    cockpit.step();
    hold(&mut cockpit, 20, 0.0, |tick| {
        LEVEL.altitude_m + 300.0 * f64::from(1 - tick % 2 * 2)
    });
    let sinking_m = |tick| LEVEL.altitude_m - 60.0 - 3.0 * DT_S * f64::from(tick);
    hold(&mut cockpit, 20, 0.0, sinking_m);
    assert_eq!(cockpit.faults(), Flags::NONE);
    let altitude_m = cockpit.autopilot.estimated().altitude_m;
    let by_m = altitude_m - sinking_m(20 * TICKS_PER_S);
    assert!(by_m.abs() < 3.0, "{by_m}");
}
