//! An aircraft that flew on unheard, and is not as it was.

use fcc_core::framework::{Controller, Flags};
use fcc_fixed_wing::flags;

use crate::cockpit::{Cockpit, DT_S, KNOT_MPS};
use crate::silence::{fly, manoeuvring, move_on, silence};

/// Climbing by 3 m/s until the cut, sinking by 1 m/s from then on: the altitude
/// that returns is lower by up to 120 m than predicted.
#[test]
fn after_a_long_cut_neither_a_dive_nor_a_climb_is_estimated() {
    for seconds in [3, 12, 29] {
        let mut cockpit = manoeuvring();
        fly(&mut cockpit, 400);
        let sink = |cockpit: &mut Cockpit| {
            cockpit.feel.altitude_m -= DT_S;
            cockpit.north_deg += 50.0 * DT_S / 111_120.0;
        };
        for _ in 0..seconds * 40 {
            sink(&mut cockpit);
            cockpit.receive_nothing();
            cockpit.act();
        }
        for tick in 0..200 {
            sink(&mut cockpit);
            cockpit.step();
            assert_eq!(cockpit.faults(), Flags::NONE);
            let climb_rate_mps = cockpit.autopilot.estimated().climb_rate_mps;
            assert!(
                (-4.0..2.0).contains(&climb_rate_mps),
                "{climb_rate_mps} m/s in tick {tick} after {seconds} s"
            );
        }
        let estimated = cockpit.autopilot.estimated();
        assert!((estimated.climb_rate_mps + 1.0).abs() < 0.5);
        assert!((estimated.altitude_m - cockpit.feel.altitude_m).abs() < 1.0);
    }
}

/// The pitot tube ices while the link is away.
#[test]
fn an_airspeed_of_zero_after_a_cut_is_not_adopted() {
    for ticks in [12, 20, 400] {
        let mut cockpit = manoeuvring();
        silence(&mut cockpit, ticks, true);
        cockpit.feel.airspeed_kt = 0.0;
        // 250 ms are permitted.
        fly(&mut cockpit, 8);
        for _ in 0..30 {
            move_on(&mut cockpit);
            cockpit.step();
            let airspeed_mps = cockpit.autopilot.estimated().airspeed_mps;
            assert!((45.0..58.0).contains(&airspeed_mps), "{airspeed_mps} m/s");
        }
        assert!(cockpit.faults().contains(flags::AIRSPEED));
    }
}

/// A change that a dive can make.
#[test]
fn an_airspeed_that_changed_in_a_cut_is_adopted() {
    for (ticks, changed_kt) in [(20, 40.0), (20, -40.0), (120, 60.0)] {
        let mut cockpit = manoeuvring();
        silence(&mut cockpit, ticks, true);
        cockpit.feel.airspeed_kt += changed_kt;
        fly(&mut cockpit, 1);
        let off_mps =
            cockpit.autopilot.estimated().airspeed_mps - cockpit.feel.airspeed_kt * KNOT_MPS;
        assert!(off_mps.abs() < 0.1, "{off_mps} m/s");
        fly(&mut cockpit, 40);
    }
}
