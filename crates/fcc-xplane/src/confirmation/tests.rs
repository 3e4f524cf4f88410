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
