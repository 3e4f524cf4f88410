//! What makes the measured response to a deflection another than the
//! aircraft's own.

use std::ops::RangeInclusive;
use std::time::{Duration, Instant};

use crate::link::Sample;
use crate::watched::Watched;

/// Longer than a frame of a slow X-Plane, and than an uneven one.
const SILENT_AFTER: Duration = Duration::from_millis(700);
/// X-Plane's time per real time. X-Plane's own rates of time are 2, 4 and
/// above; below 20 frames a second its time is slower than real time.
const TIME_RATES: RangeInclusive<f64> = 0.8..=1.2;

/// What is wrong at a time, if anything is.
pub(crate) fn disturbance(last: Option<&Sample>, now: Instant) -> Option<&'static str> {
    let Some(last) = last.filter(|last| now.saturating_duration_since(last.at) < SILENT_AFTER)
    else {
        return Some("nothing arrives from X-Plane: it loads, hangs or has ended");
    };
    [
        (Watched::Paused, "X-Plane is paused: let it run"),
        (
            Watched::InReplay,
            "X-Plane shows a replay: return to the flight",
        ),
        (
            Watched::OnGround,
            "the aircraft is on the ground: fly level first, in calm air",
        ),
        (
            Watched::ServosOn,
            "X-Plane's own autopilot moves the controls: switch its servos off",
        ),
    ]
    .into_iter()
    .find(|(what, _)| last.number(*what) >= 0.5)
    .map(|(_, why)| why)
}

/// Why X-Plane's time was not real time between two samples, if it was not.
pub(crate) fn other_time_rate(first: &Sample, last: &Sample) -> Option<String> {
    let flown_s = last.number(Watched::FlightTime) - first.number(Watched::FlightTime);
    let rate = flown_s / last.at.saturating_duration_since(first.at).as_secs_f64();
    (!TIME_RATES.contains(&rate)).then(|| {
        format!(
            "X-Plane's time ran at {rate:.2} of real time during a deflection: set its rate of \
             time to 1, and have at least 20 frames a second"
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_state_in_which_responses_are_not_the_aircrafts_own_is_named() {
        let now = Instant::now();
        let named = |known: &[(Watched, f32)]| disturbance(Some(&Sample::of(now, known)), now);
        assert_eq!(named(&[]), None);
        assert_eq!(
            named(&[(Watched::Paused, 0.0), (Watched::ServosOn, 0.0)]),
            None
        );
        for (what, word) in [
            (Watched::Paused, "paused"),
            (Watched::InReplay, "replay"),
            (Watched::OnGround, "on the ground"),
            (Watched::ServosOn, "autopilot"),
        ] {
            assert!(named(&[(what, 1.0)]).unwrap().contains(word), "{what:?}");
        }
    }

    #[test]
    fn silence_is_named() {
        let began = Instant::now();
        let last = Sample::of(began, &[]);
        let after = |ms| disturbance(Some(&last), began + Duration::from_millis(ms));
        assert_eq!(after(100), None);
        assert!(after(1_000).unwrap().contains("nothing arrives"));
        assert!(
            disturbance(None, began)
                .unwrap()
                .contains("nothing arrives")
        );
    }

    #[test]
    fn time_that_does_not_run_as_real_time_does_is_named_with_its_rate() {
        let began = Instant::now();
        let after_900_ms = |flown_s: f32| {
            other_time_rate(
                &Sample::of(began, &[(Watched::FlightTime, 100.0)]),
                &Sample::of(
                    began + Duration::from_millis(900),
                    &[(Watched::FlightTime, 100.0 + flown_s)],
                ),
            )
        };
        assert_eq!(after_900_ms(0.9), None);
        // A frame at 20 frames a second earlier or later.
        assert_eq!(after_900_ms(0.85), None);
        assert_eq!(after_900_ms(0.95), None);
        assert!(after_900_ms(1.8).unwrap().contains("2.00"));
        assert!(after_900_ms(0.45).unwrap().contains("0.50"));
        assert!(after_900_ms(f32::NAN).is_some());
    }
}
