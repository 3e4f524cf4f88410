//! A simulator that freezes, is cut off, shows a map or a replay, and is loaded
//! anew: the whole loop on X-Plane's protocol, in lockstep.

mod datarefs;
mod flight;
mod world;

use fcc_core::framework::State::{Engaged, Failsafe, Standby};
use fcc_core::framework::{EventKind, Notice};
use fcc_fixed_wing::flags::{NOT_FOLLOWED, SOURCE_CLOCK};
use flight::{Flight, PERIOD_NS};
use world::Manner;

const STOOD_STILL: u8 = 1;
const LINK_LOST: u8 = 2;
const GAPS: usize = 30;

/// Lengths of 0.1 to 3 s, and how long is flown before each, s.
fn gaps(seed: u64) -> impl Iterator<Item = (f64, f64)> {
    let mut state = seed;
    let mut draw = move || {
        state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (state >> 11) as f64 / (1_u64 << 53) as f64
    };
    (0..GAPS).map(move |_| (0.1 + 2.9 * draw(), 1.0 + 5.0 * draw()))
}

fn notices(flight: &mut Flight) -> Vec<Notice> {
    flight
        .events()
        .into_iter()
        .filter_map(|kind| match kind {
            EventKind::Noticed(notice) => Some(notice),
            _ => None,
        })
        .collect()
}

#[track_caller]
fn assert_reported(flight: &mut Flight, kind: u8, lasted_s: f64) {
    let noticed = notices(flight);
    let [notice] = noticed[..] else {
        panic!("{lasted_s:.3} s: {noticed:?}");
    };
    assert_eq!(notice.kind, kind, "{lasted_s:.3} s: {notice:?}");
    let off_s = notice.lasted_s() - lasted_s;
    assert!(off_s.abs() < 0.1, "{lasted_s:.3} s: {notice:?}");
}

/// Frames a second, and the seed of their jitter.
const FRAMES: [(f64, u64); 2] = [(60.0, 0), (25.0, 5)];

#[test]
fn thirty_freezes_are_reported_and_the_pattern_is_flown_as_without() {
    let undisturbed = Flight::engaged(60.0, 0).flown(200.0);
    for (frame_hz, jitter) in FRAMES {
        let mut flight = Flight::engaged(frame_hz, jitter);
        for (length_s, before_s) in gaps(frame_hz as u64) {
            flight.fly(before_s);
            flight.during(Manner::Frozen, length_s);
            flight.fly(0.5);
            assert_reported(&mut flight, STOOD_STILL, length_s);
        }
        let frozen = flight.flown(200.0);
        let pairs = [
            (frozen.heading_settle_s, undisturbed.heading_settle_s),
            (frozen.altitude_settle_s, undisturbed.altitude_settle_s),
        ];
        for (ours, without) in pairs {
            assert!(ours.unwrap() < 1.5 * without.unwrap(), "{frozen:?}");
        }
        // The suite's limits for a Cessna 172, times 1.5.
        assert!(frozen.heading_overshoot_deg < 0.75, "{frozen:?}");
        assert!(frozen.altitude_overshoot_ft < 2.4, "{frozen:?}");
        assert!(frozen.turn_loss_ft < 2.4, "{frozen:?}");
        assert!(frozen.altitude_rms_ft < 1.5, "{frozen:?}");
    }
}

#[test]
fn thirty_cuts_are_distinguished_from_freezes_and_the_bank_command_never_steps() {
    for (index, (frame_hz, jitter)) in FRAMES.into_iter().enumerate() {
        let hears = index % 2 == 0;
        let mut flight = Flight::engaged(frame_hz, jitter);
        for (length_s, before_s) in gaps(frame_hz as u64 + 1) {
            flight.fly(before_s);
            flight.cut(hears);
            flight.fly(length_s);
            // An aircraft that hears nothing either keeps its last surfaces.
            let bank_deg = flight.true_bank_deg();
            assert!(!hears || bank_deg.abs() < 60.0, "{length_s} s: {bank_deg}°");
            flight.restore();
            flight.fly(0.5);
            assert_reported(&mut flight, LINK_LOST, length_s);
        }
        let step_deg = flight.largest_bank_step_deg();
        assert!(step_deg <= 5.0, "{step_deg}°");
        flight.fly(20.0);
        assert!(flight.true_bank_deg().abs() < 35.0);
    }
}

/// Only what it sends is lost, on the way into a turn with a climb at full throttle and in
/// it: the aircraft hears the last controls, and flies on with them. Wings that keep the
/// turn's 30° and what they roll on in the quarter of a second before a loss is noticed (10°
/// at 40 °/s) are below 60°. Without the power of the climb a turn of 45° needs, at 100 kt,
/// 3.5 % of the weight more thrust: a sink of 350 ft/min, 160 ft in 28 s. 1,000 ft are those
/// and an airspeed that swings by 35 kt.
#[test]
fn a_cut_in_a_turn_leaves_the_aircraft_flying() {
    for jitter in [11, 12, 13] {
        for turned_s in [21.0, 21.7, 22.0, 22.5, 23.0, 24.0] {
            let mut flight = Flight::engaged(60.0, jitter);
            flight.fly(turned_s);
            let before_m = flight.true_altitude_m();
            flight.cut(true);
            for after_s in 1..=28 {
                flight.fly(1.0);
                let bank_deg = flight.true_bank_deg();
                let lost_ft = (before_m - flight.true_altitude_m()) / 0.304_8;
                let at = format!("{turned_s} s, seed {jitter}, {after_s} s later");
                assert!(bank_deg.abs() < 60.0, "{at}: {bank_deg}°");
                assert!(lost_ft < 1_000.0, "{at}: {lost_ft} ft");
            }
            flight.restore();
            flight.fly(20.0);
            assert!(flight.true_bank_deg().abs() < 35.0);
        }
    }
}

/// Turbulence rolls and yaws the aircraft in the moment in which it is heard again: that
/// is none of its trims. With hands off it flies straight, its rudder at 0.
#[test]
fn what_a_cut_ends_with_is_not_taken_for_trim() {
    for seed in [5, 6, 7, 8] {
        let mut flight = Flight::in_turbulence(seed);
        flight.fly(5.0);
        let mut rudder = Vec::new();
        for _ in 0..10 {
            flight.cut(false);
            flight.fly(3.0);
            flight.restore();
            flight.fly(1.5);
            for _ in 0..20 {
                flight.fly(0.1);
                rudder.push(flight.rudder());
            }
        }
        let mean = rudder.iter().sum::<f64>() / rudder.len() as f64;
        assert!(mean.abs() < 0.1, "seed {seed}: {mean}");
    }
}

#[test]
fn maps_pauses_and_replays_at_any_moment_are_waited_out() {
    let manners = [
        Manner::Stopped,
        Manner::StoppedSilently,
        Manner::Paused,
        Manner::Replaying,
    ];
    let mut flight = Flight::engaged(60.0, 9);
    for ((length_s, before_s), manner) in gaps(11).zip(manners.into_iter().cycle()) {
        flight.fly(before_s);
        flight.wire.world().writes.clear();
        // Up to 24 s of silence.
        let times = if manner == Manner::StoppedSilently {
            8.0
        } else {
            2.0
        };
        flight.during(manner, times * length_s);
        if manner == Manner::Replaying {
            let written = flight.wire.world().writes.len();
            // Of the tick in which it began.
            assert!(written < 15, "{written} writes");
        }
    }
    assert!(flight.wire.world().is_overridden());
    let worst = flight.flown(200.0);
    assert!(worst.heading_overshoot_deg < 0.75, "{worst:?}");
    assert!(worst.altitude_overshoot_ft < 2.4, "{worst:?}");
}

#[test]
fn a_loaded_flight_is_released_at_once_and_its_throttle_is_never_moved() {
    for (loads_s, engaged_s) in [
        (0.0, 33.0),
        (0.3, 40.5),
        (4.0, 47.0),
        (25.0, 61.0),
        (50.0, 70.0),
    ] {
        let mut flight = Flight::engaged(60.0, 0);
        flight.fly(engaged_s);
        // Loading takes its time, in which nothing is sent.
        flight.run(Manner::Frozen, loads_s);
        let loaded_tick = flight.ticks();
        {
            let mut world = flight.wire.world();
            world.load_flight();
            world.writes.clear();
        }
        flight.run(Manner::Flying, 1.0);
        assert_eq!(flight.state(), Standby);
        if loads_s < 30.0 {
            let released = flight.released_in_tick().unwrap();
            assert!(
                released <= loaded_tick + 2,
                "{released} after {loaded_tick}"
            );
        }
        {
            let mut world = flight.wire.world();
            assert!(!world.is_overridden());
            // What was sent before it was loaded, and the release.
            let positive = world.writes.iter().filter(|(path, value)| {
                path.contains("throttle") && *value > 0.0 || path.contains("ENGN") && *value > 0.7
            });
            assert!(positive.count() <= 60, "{loads_s} s");
            world.writes.clear();
        }
        // Nothing is written afterwards.
        flight.run(Manner::Flying, 20.0);
        assert_eq!(flight.wire.world().writes, []);
        assert_eq!(flight.state(), Standby);
    }
}

#[test]
fn cleared_overrides_are_released_at_once() {
    let mut flight = Flight::engaged(60.0, 0);
    flight.fly(25.0);
    flight.wire.world().reload();
    let before = flight.ticks();
    flight.run(Manner::Flying, 1.0);
    assert_eq!(flight.state(), Standby);
    assert!(flight.released_in_tick().unwrap() < before + 10);
    assert!(!flight.wire.world().is_overridden());
    flight.wire.world().writes.clear();
    flight.run(Manner::Flying, 20.0);
    assert_eq!(flight.wire.world().writes, []);
}

/// Our process is stopped, and the simulator's datagrams wait in the kernel, the
/// oldest first; those that no longer fit are lost.
#[test]
fn a_stopped_process_flies_on_with_what_arrives_after_it() {
    for stopped_s in [0.1, 0.2, 0.3, 0.45] {
        let mut flight = Flight::engaged(144.0, 0);
        for _ in 0..20 {
            flight.fly(5.0);
            flight.miss((stopped_s * 1e9) as i64 / PERIOD_NS);
            flight.fly(1.0);
            assert_eq!(flight.state(), Engaged);
        }
        let step_deg = flight.largest_bank_step_deg();
        assert!(step_deg <= 5.0, "{step_deg}°");
    }
}

#[test]
fn freezes_in_a_row_and_in_a_pause_are_flown_through() {
    let mut flight = Flight::engaged(20.0, 7);
    for (length_s, _) in gaps(21) {
        flight.fly(3.0);
        for _ in 0..4 {
            flight.during(Manner::Frozen, length_s / 3.0);
            flight.fly(0.1);
        }
        flight.during(Manner::Paused, 1.0);
        flight.during(Manner::Frozen, length_s);
        flight.during(Manner::Paused, 1.0);
        flight.during(Manner::Stopped, 1.0);
        flight.during(Manner::Frozen, length_s);
    }
    let worst = flight.flown(200.0);
    assert!(worst.heading_overshoot_deg < 0.75, "{worst:?}");
}

/// X-Plane's incoming connections are switched off, 7 s after engaging and in a
/// turn: the loops do not wind up what has no effect.
#[test]
fn writes_that_do_not_arrive_wind_nothing_up() {
    for (after_s, length_s) in [(7.0, 15.0), (23.0, 8.0)] {
        let mut flight = Flight::engaged(60.0, 0);
        flight.fly(after_s);
        flight.deafen();
        flight.fly(length_s);
        flight.restore();
        let mut bank_deg: f64 = 0.0;
        for _ in 0..200 {
            flight.fly(0.1);
            bank_deg = bank_deg.max(flight.true_bank_deg().abs());
        }
        // The pattern's turns have 30°.
        assert!(bank_deg < 35.0, "{after_s} s: {bank_deg}°");
        let reported = flight.events().into_iter().any(|kind| match kind {
            EventKind::ConditionsChanged { began, .. } => began.contains(NOT_FOLLOWED),
            _ => false,
        });
        assert!(reported, "{after_s} s");
    }
}

#[test]
fn the_pilots_stick_releases_the_overrides() {
    let mut flight = Flight::engaged(60.0, 0);
    flight.fly(1.0);
    flight.wire.world().stick += 0.4;
    flight.run(Manner::Flying, 0.15);
    assert_eq!(flight.state(), Engaged);
    flight.run(Manner::Flying, 0.15);
    assert_eq!(flight.state(), Standby);
    assert!(!flight.wire.world().is_overridden());
}

#[test]
fn in_silence_a_command_still_releases() {
    let mut flight = Flight::engaged(60.0, 0);
    flight.fly(21.0);
    // Only what it sends is lost.
    flight.cut(true);
    flight.fly(5.0);
    flight.disengage();
    flight.run(Manner::Flying, 0.1);
    assert_eq!(flight.state(), Standby);
    assert!(!flight.wire.world().is_overridden());
}

/// A queue holds all that X-Plane sends for half a second and delivers it in order.
/// By the flight's time that is a freeze; its network time, which ran on through one
/// before, tells that what arrives is half a second old.
#[test]
fn a_queue_in_the_network_is_failsafe_until_it_is_empty() {
    for frame_hz in [60.0, 25.0] {
        let mut flight = Flight::engaged(frame_hz, 3);
        flight.fly(6.0);
        flight.during(Manner::Frozen, 0.3);
        flight.fly(6.0);
        flight.events();
        flight.wire.world().hold(0.5);
        flight.fly(0.5);
        flight.run(Manner::Flying, 2.5);
        assert!(matches!(flight.state(), Failsafe(_)));
        let named = flight.events().into_iter().any(|kind| match kind {
            EventKind::ConditionsChanged { began, .. } => began.contains(SOURCE_CLOCK),
            _ => false,
        });
        assert!(named);
        flight.wire.world().hold(0.0);
        flight.run(Manner::Flying, 2.5);
        flight.fly(20.0);
        assert!(flight.true_bank_deg().abs() < 35.0);
    }
}

/// Each value that is subscribed, one datagram at a time: nothing of it may end
/// the flight or set a clock.
#[test]
fn no_single_forged_datagram_ends_a_flight() {
    let mut flight = Flight::engaged(60.0, 3);
    let indices = flight.wire.world().indices();
    assert!(indices.len() > 30, "{indices:?}");
    let forged = |pairs: &[(i32, f32)]| {
        let mut datagram = b"RREF,".to_vec();
        for (index, value) in pairs {
            datagram.extend(index.to_le_bytes());
            datagram.extend(value.to_le_bytes());
        }
        datagram
    };
    let values = [-1e6, -1.0, 0.0, 1.0, 3.0, 100.0, 1e6];
    let single = indices
        .iter()
        .flat_map(|index| values.map(|value| forged(&[(*index, value)])));
    let all = values.map(|value| {
        let pairs: Vec<_> = indices.iter().map(|index| (*index, value)).collect();
        forged(&pairs)
    });
    let mut elsewhere = b"RPOS4".to_vec();
    elsewhere.extend([0; 64]);
    for datagram in single.chain(all).chain([elsewhere]) {
        flight.wire.world().forge(datagram);
        // Engaged in every tick of it.
        for _ in 0..12 {
            flight.fly(0.025);
        }
    }
    assert!(flight.true_bank_deg().abs() < 35.0);
    flight.fly(10.0);
    let changed = flight.events().into_iter().find(|kind| {
        matches!(
            kind,
            EventKind::StateChanged { .. } | EventKind::ReleasedAtOnce { .. }
        )
    });
    assert_eq!(changed, None);
}
