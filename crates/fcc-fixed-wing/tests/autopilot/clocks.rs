//! The plant's clock: that of another simulator, and compared with a loop that
//! is slow or was stopped.

use core::time::Duration;

use fcc_core::flight::PlantState;
use fcc_core::framework::{Controller, Flags, Readings, Time};
use fcc_fixed_wing::flags;
use fcc_guidance::GuidanceConfig;

use crate::cockpit::{Cockpit, DT_S, SENSORS};
use crate::silence::{LINK_LOST, fly, manoeuvring, move_on, noticed, silence};

fn elapsed_s(cockpit: &Cockpit) -> f64 {
    cockpit.autopilot.setpoints().guidance.elapsed_s
}

/// The second simulator's clock may be far before or behind the first one's.
#[test]
fn another_simulators_clock_is_not_compared_with_the_first() {
    for behind_s in [-3_600.0, -0.5, 0.2, 0.5, 5.0, 3_600.0] {
        let mut cockpit = manoeuvring();
        silence(&mut cockpit, 11, true);
        cockpit.plant_source = 1;
        cockpit.stood_s += behind_s;
        for _ in 0..80 {
            fly(&mut cockpit, 1);
            assert!(!cockpit.withholds());
            assert!(!cockpit.engage_inhibits().contains(flags::PLANT_STALLED));
        }
        // And back, without a gap.
        let before_s = elapsed_s(&cockpit);
        cockpit.plant_source = 0;
        cockpit.stood_s -= behind_s;
        for _ in 0..80 {
            fly(&mut cockpit, 1);
            assert_eq!(noticed(&cockpit), None);
        }
        assert!((elapsed_s(&cockpit) - before_s - 80.0 * DT_S).abs() < 1e-6);
    }
}

/// A pause of the first simulator is no time that the second flew.
#[test]
fn a_pause_before_another_simulators_clock_is_no_time() {
    let mut cockpit = manoeuvring();
    let (before_s, time_s) = (elapsed_s(&cockpit), cockpit.measurements.plant.value.time_s);
    for _ in 0..400 {
        cockpit.pause(time_s);
        cockpit.act();
    }
    cockpit.plant_source = 1;
    fly(&mut cockpit, 1);
    assert!(elapsed_s(&cockpit) - before_s < 0.1);
}

/// This program was stopped for 0.4 s; what waited meanwhile was not read, and
/// the next tick followed at once.
#[test]
fn periods_that_this_loop_missed_are_not_the_link_s() {
    for (later_ticks, expected) in [(0, None), (8, Some(LINK_LOST))] {
        let mut cockpit = manoeuvring();
        cockpit.receive_nothing();
        cockpit.tick.missed = 15;
        cockpit.period = Duration::from_millis(400);
        cockpit.tick.woke = cockpit.tick.woke + Duration::from_micros(24_900);
        cockpit.receive_nothing();
        cockpit.tick.missed = 0;
        cockpit.period = Duration::from_micros(100);
        cockpit.receive_nothing();
        cockpit.period = Duration::from_millis(25);
        for _ in 0..later_ticks {
            cockpit.receive_nothing();
        }
        cockpit.observe();
        assert_eq!(noticed(&cockpit).map(|(kind, _)| kind), expected);
        // Of 0.675 s the 0.4 s are not counted.
        let lasted_s = noticed(&cockpit).map_or(0.275, |(_, lasted_s)| lasted_s);
        assert!((lasted_s - 0.275).abs() < 1e-3, "{lasted_s}");
    }
}

/// At 10 ticks a second each tick is a gap of a tenth of a second.
#[test]
fn a_slow_loop_is_no_lost_link() {
    let mut cockpit = Cockpit::new(GuidanceConfig::Hold);
    cockpit.feel.plant = Some(PlantState::Running);
    cockpit.period = Duration::from_millis(100);
    for _ in 0..20 {
        cockpit.observe();
        assert_eq!(noticed(&cockpit), None);
    }
    assert_eq!(cockpit.engage_inhibits(), Flags::NONE);
    cockpit.receive_nothing();
    cockpit.receive_nothing();
    cockpit.observe();
    assert_eq!(noticed(&cockpit).map(|(kind, _)| kind), Some(LINK_LOST));
}

/// A network that holds everything for half a second, and delivers it in order:
/// what arrives was sent half a second ago, by the simulator's own clock.
fn late_ticks(cockpit: &mut Cockpit, ticks: u32, mut assert: impl FnMut(&Cockpit)) {
    const LATE: Duration = Duration::from_millis(500);
    for _ in 0..ticks {
        move_on(cockpit);
        cockpit.observe_with(|measured| {
            measured.plant.value.time_s -= LATE.as_secs_f64();
            measured.each_time(&mut |taken| {
                if !taken.is_never() {
                    *taken = Time::from_nanos(taken.as_nanos() - 500_000_000);
                }
            });
        });
        assert(cockpit);
        cockpit.act();
    }
}

/// It is a freeze of 0.5 s by the simulator's time, but not by when it was sent.
#[test]
fn a_queue_in_the_network_is_a_loss_with_its_name_and_no_freeze() {
    let mut cockpit = manoeuvring();
    silence(&mut cockpit, 20, true);
    let lost = SENSORS.into_iter().fold(Flags::NONE, |all, one| all | one);
    late_ticks(&mut cockpit, 60, |cockpit| {
        assert_eq!(cockpit.faults(), lost | flags::SOURCE_CLOCK);
        assert!(cockpit.conditions().contains(flags::SOURCE_CLOCK));
        assert_eq!(noticed(cockpit), None);
        assert_eq!(cockpit.must_release(), Flags::NONE);
    });
    // The queue has emptied: half a second of the aircraft's flight was not seen.
    move_on(&mut cockpit);
    cockpit.observe();
    assert_eq!(noticed(&cockpit).map(|(kind, _)| kind), Some(LINK_LOST));
    assert_eq!(cockpit.faults(), Flags::NONE);
    fly(&mut cockpit, 80);
    assert_eq!(cockpit.conditions(), Flags::NONE);
}

/// Of a simulator that does not say that it is paused, and an aircraft that stands
/// still with it: the default of 30 s is 1,200 ticks.
#[test]
fn a_clock_that_stands_still_while_running_is_a_fault_of_every_source() {
    for state in [PlantState::Running, PlantState::Slow, PlantState::Stalled] {
        let mut cockpit = manoeuvring();
        cockpit.feel.plant = Some(state);
        let first = |cockpit: &mut Cockpit, seen: fn(&Cockpit) -> bool| {
            (1..2_000).find(|_| {
                cockpit.stood_s += DT_S;
                cockpit.step();
                seen(cockpit)
            })
        };
        let reported = first(&mut cockpit, |cockpit| {
            cockpit.conditions().contains(flags::PLANT_STALLED)
        });
        assert_eq!(reported, Some(11), "after 250 ms");
        let lost = first(&mut cockpit, |cockpit| cockpit.faults() != Flags::NONE);
        assert_eq!(lost, Some(1_190), "after 30 s");
        assert_eq!(cockpit.faults(), flags::PLANT_STALLED);
        cockpit.feel.plant = Some(PlantState::Running);
        fly(&mut cockpit, 40);
        assert_eq!(cockpit.conditions(), Flags::NONE);
    }
    // A pause may last for any time.
    let mut cockpit = manoeuvring();
    let time_s = cockpit.measurements.plant.value.time_s;
    for _ in 0..2_000 {
        cockpit.pause(time_s);
        assert_eq!(cockpit.faults(), Flags::NONE);
        assert_eq!(cockpit.conditions(), Flags::NONE);
    }
}

/// The clock is lost alone, or is no number; 250 ms are 10 ticks. It is flown on by
/// our time, and taken again without a jump.
#[test]
fn a_clock_that_alone_is_missing_has_not_stopped() {
    for is_silent in [true, false] {
        let mut cockpit = manoeuvring();
        let before_s = elapsed_s(&cockpit);
        let last = cockpit.measurements.plant;
        let mut noticed_kinds = Vec::new();
        for tick in 0..80 {
            move_on(&mut cockpit);
            cockpit.observe_with(|measured| {
                measured.plant = last;
                if !is_silent {
                    measured.plant.taken = measured.attitude.taken;
                    measured.plant.value.time_s = f64::NAN;
                }
            });
            cockpit.act();
            let noticed = cockpit.autopilot.notices().iter();
            noticed_kinds.extend(noticed.map(|notice| (tick, notice.kind)));
            assert_eq!(cockpit.faults(), Flags::NONE);
            assert!(!cockpit.engage_inhibits().contains(flags::PLANT_STALLED));
        }
        assert_eq!(noticed_kinds.len(), 1, "{noticed_kinds:?}");
        assert!((10..13).contains(&noticed_kinds[0].0));
        assert!((elapsed_s(&cockpit) - before_s - 80.0 * DT_S).abs() < 0.31);
        for _ in 0..80 {
            fly(&mut cockpit, 1);
            assert_eq!(noticed(&cockpit), None);
        }
    }
}

#[test]
fn another_autopilot_and_time_more_than_twice_as_fast_prevent_engaging_only() {
    let mut cockpit = Cockpit::new(GuidanceConfig::Hold);
    cockpit.feel.plant = Some(PlantState::Fast);
    cockpit.other_control.autopilot = true;
    cockpit.observe();
    let both = flags::PLANT_FAST | flags::OTHER_AUTOPILOT;
    assert_eq!(cockpit.engage_inhibits(), both);
    assert_eq!(cockpit.conditions(), both);
    assert_eq!(cockpit.faults(), Flags::NONE);
    cockpit.feel.plant = Some(PlantState::Running);
    cockpit.other_control.autopilot = false;
    cockpit.observe();
    assert_eq!(cockpit.engage_inhibits(), Flags::NONE);
}
