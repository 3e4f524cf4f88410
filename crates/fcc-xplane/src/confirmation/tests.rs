use super::*;

const TICK: Duration = Duration::from_millis(25);

/// Writes a moving elevator for `ticks` ticks; the simulator's readback is
/// `readback` applied to what was written 4 ticks earlier.
fn overdue_after(ticks: u32, readback: impl Fn(f32) -> Option<[f32; 3]>) -> Vec<bool> {
    let link = SharedState::new(None);
    let mut now = Time::from_nanos(1_000_000_000);
    let mut confirmation = Confirmation::begin(now);
    let mut written = vec![0.0; 4];
    (0..ticks)
        .map(|tick| {
            now = now + TICK;
            if let Some([joystick, throttles, pitch]) = readback(written[tick as usize]) {
                link.read_back
                    .show(Quantity::OverrideJoystick, f64::from(joystick), now);
                link.read_back
                    .show(Quantity::OverrideThrottles, f64::from(throttles), now);
                link.read_back
                    .show(Quantity::YokePitch, f64::from(pitch), now);
            }
            let elevator = (tick as f32 * 0.1).sin();
            written.push(elevator);
            confirmation.wrote(now, [Some(elevator), Some(0.0), Some(0.0)]);
            confirmation.is_overdue(now, &link)
        })
        .collect()
}

#[test]
fn a_delayed_readback_is_confirmed() {
    let overdue = overdue_after(400, |written| Some([1.0, 1.0, written]));
    assert!(!overdue.contains(&true));
}

#[test]
fn no_readback_is_overdue_after_a_second_and_not_before() {
    let overdue = overdue_after(60, |_| None);
    assert_eq!(overdue.iter().position(|overdue| *overdue), Some(40));
}

#[test]
fn an_override_that_stays_off_is_not_confirmed() {
    assert_eq!(
        overdue_after(60, |v| Some([0.0, 1.0, v])).last(),
        Some(&true)
    );
    assert_eq!(
        overdue_after(60, |v| Some([1.0, 0.0, v])).last(),
        Some(&true)
    );
}

#[test]
fn a_yoke_held_by_another_program_is_not_confirmed() {
    assert_eq!(
        overdue_after(400, |_| Some([1.0, 1.0, 1.5])).last(),
        Some(&true)
    );
}

/// Whether another program is found to write the yoke, at the end of ticks
/// in which the yoke is read back as `readback` of the tick's number and of
/// what was written.
fn contested(ticks: u32, override_joystick: f64, readback: impl Fn(u32, f32) -> f32) -> bool {
    let link = SharedState::new(None);
    let mut now = Time::from_nanos(1_000_000_000);
    let mut confirmation = Confirmation::begin(now);
    let mut contested = false;
    for tick in 0..ticks {
        now = now + TICK;
        let elevator = (f64::from(tick) * 0.1).sin() as f32 * 0.2;
        confirmation.wrote(now, [Some(elevator), Some(0.0), Some(0.0)]);
        link.read_back
            .show(Quantity::OverrideJoystick, override_joystick, now);
        link.read_back.show(
            Quantity::YokePitch,
            f64::from(readback(tick, elevator)),
            now,
        );
        contested = confirmation.is_contested(now, &link);
    }
    contested
}

#[test]
fn a_program_that_writes_the_yoke_now_and_then_is_found() {
    // Every fifth frame is the other's: 8 a second.
    assert!(contested(100, 1.0, |tick, ours| if tick % 5 == 0 {
        0.7
    } else {
        ours
    }));
    assert!(contested(100, 1.0, |_, _| 0.7));
    // Within what was written, but not written.
    assert!(contested(400, 1.0, |tick, ours| if tick % 3 == 0 {
        0.1234
    } else {
        ours
    }));
}

/// Up to 1 s each way, and a network that lets through a readback every 0.4 s.
#[test]
fn a_slow_or_lossy_network_is_not_another_program() {
    let written = |tick: u32| (f64::from(tick) * 0.1).sin() as f32 * 0.2;
    let delayed = |ticks: u32| move |tick: u32, _| written(tick.saturating_sub(ticks));
    assert!(!contested(400, 1.0, delayed(32)));
    assert!(!contested(400, 1.0, delayed(38)));
    assert!(!contested(400, 1.0, delayed(80)));
    let link = SharedState::new(None);
    let mut now = Time::from_nanos(1_000_000_000);
    let mut confirmation = Confirmation::begin(now);
    for tick in 0..400 {
        now = now + TICK;
        confirmation.wrote(now, [Some(written(tick)), Some(0.0), Some(0.0)]);
        if tick % 16 == 0 {
            link.read_back.show(Quantity::OverrideJoystick, 1.0, now);
            let shown = written(tick.saturating_sub(30));
            link.read_back.show(Quantity::YokePitch, shown.into(), now);
        }
        assert!(!confirmation.is_contested(now, &link), "tick {tick}");
    }
}

/// From 2.5 s on nothing arrives any more, of small movements.
#[test]
fn a_yoke_that_stays_where_it_was_put_is_a_cut_link_and_not_another_program() {
    let written = |tick: u32| (f64::from(tick) * 0.1).sin() as f32 * 0.01;
    let link = SharedState::new(None);
    let mut now = Time::from_nanos(1_000_000_000);
    let mut confirmation = Confirmation::begin(now);
    let mut cut = Vec::new();
    for tick in 0..800 {
        now = now + TICK;
        confirmation.wrote(now, [Some(written(tick)), Some(0.0), Some(0.0)]);
        link.read_back.show(Quantity::OverrideJoystick, 1.0, now);
        let shown = match tick {
            0..700 => written(tick.saturating_sub(4).min(100)),
            _ => 0.7,
        };
        link.read_back.show(Quantity::YokePitch, shown.into(), now);
        let contested = confirmation.is_contested(now, &link);
        // Another program that moves it then is found.
        assert_eq!(contested, tick >= 700 + 60, "tick {tick}");
        cut.push(confirmation.is_cut());
    }
    // A second until the last value is too old, and one and a half; meanwhile
    // what is written passes where the yoke stands.
    let first = cut.iter().position(|cut| *cut).unwrap();
    assert!((100 + 100..100 + 140).contains(&first), "{first}");
    assert!(cut[first..700].iter().all(|cut| *cut));
    assert!(!cut[720]);
}

#[test]
fn neither_a_dead_link_nor_a_burst_of_old_values_is_another_program() {
    // Input switched off: the override is not set either.
    assert!(!contested(400, 0.0, |_, _| 0.7));
    // A second of old values after a freeze.
    assert!(!contested(60, 1.0, |tick, ours| if tick < 40 {
        0.7
    } else {
        ours
    }));
    assert!(!contested(400, 1.0, |_, ours| ours));
    // A simulator that stores hundredths shows nothing as written.
    assert!(!contested(400, 1.0, |_, ours| (ours * 100.0).round() / 100.0));
}
