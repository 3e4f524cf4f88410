//! Limits the lines about a fault that comes and goes, for people.
//!
//! Of each part's events the first few are passed on. If more follow within ten
//! seconds, they are counted, and one line in ten seconds gives the last of
//! them with their number. The recording contains all of them.

use fcc_core::framework::EventKind;

/// Events of one part that are passed on in [`OVER_S`]: a fault that ends, and
/// comes and ends again.
const AT_ONCE: u32 = 4;
const OVER_S: f64 = 10.0;

/// The lines about faults that come and go.
#[derive(Debug, Default)]
pub struct Flapping(Vec<FaultSource>);

/// A sensor, an actuator, readings that change their source, conditions, or
/// what is noticed once it is over.
#[derive(Debug)]
struct FaultSource {
    name: String,
    since_s: f64,
    passed: u32,
    counted: u32,
    last: String,
}

impl Flapping {
    /// Whether an event's line is to be shown now; otherwise it is counted.
    pub fn passes<O>(&mut self, kind: &EventKind<O>, line: &str, time_s: f64) -> bool {
        if !matches!(
            kind,
            EventKind::SensorFault { .. }
                | EventKind::SensorRecovered { .. }
                | EventKind::ActuatorFault { .. }
                | EventKind::ActuatorRecovered { .. }
                | EventKind::SourceChanged(_)
                | EventKind::ConditionsChanged { .. }
                | EventKind::Noticed(_)
        ) {
            return true;
        }
        let name = match kind {
            // Each condition by itself.
            EventKind::ConditionsChanged { .. } => line,
            // All of a kind: `link lost for 0.4 s`.
            EventKind::Noticed(_) => line.split_once(" for ").map_or(line, |(name, _)| name),
            _ => line.split_once(": ").map_or(line, |(name, _)| name),
        };
        let Some(part) = self.0.iter_mut().find(|part| part.name == name) else {
            self.0.push(FaultSource {
                name: name.to_owned(),
                since_s: time_s,
                passed: 1,
                counted: 0,
                last: String::new(),
            });
            return true;
        };
        if part.counted == 0 && time_s - part.since_s >= OVER_S {
            part.since_s = time_s;
            part.passed = 0;
        }
        if part.passed < AT_ONCE {
            part.passed += 1;
            return true;
        }
        part.counted += 1;
        part.last.clear();
        part.last.push_str(line);
        false
    }

    /// A line for each part whose events were counted for ten seconds, or, at
    /// the end of a flight, for any time.
    pub fn summaries(&mut self, time_s: f64, at_the_end: bool) -> impl Iterator<Item = String> {
        self.0.iter_mut().filter_map(move |part| {
            let for_s = time_s - part.since_s;
            if part.counted == 0 || !(at_the_end || for_s >= OVER_S) {
                return None;
            }
            let counted = std::mem::take(&mut part.counted);
            part.since_s = time_s;
            let last = &part.last;
            Some(format!(
                "{last} (the last of {counted} such events in {for_s:.0} s)"
            ))
        })
    }
}

#[cfg(test)]
mod tests {
    use fcc_core::framework::{Notice, SensorFault};

    use super::*;

    #[test]
    fn a_flapping_fault_is_reported_then_counted() {
        let mut flapping = Flapping::default();
        let mut lines = Vec::new();
        // A fault and its end in each half second, for 25 s; then none.
        for tick in 0..160 {
            let time_s = f64::from(tick) * 0.25;
            if tick < 100 {
                let (kind, line) = if tick % 2 == 0 {
                    let fault = SensorFault::Malformed;
                    (EventKind::SensorFault { index: 0, fault }, "a: invalid")
                } else {
                    (EventKind::SensorRecovered { index: 0 }, "a: works again")
                };
                if flapping.passes::<()>(&kind, line, time_s) {
                    lines.push(line.to_owned());
                }
                assert!(flapping.passes::<()>(&EventKind::Panicked, "a: other", time_s));
            }
            lines.extend(flapping.summaries(time_s, false));
        }
        assert_eq!(
            lines,
            [
                "a: invalid",
                "a: works again",
                "a: invalid",
                "a: works again",
                "a: invalid (the last of 37 such events in 10 s)",
                "a: invalid (the last of 40 such events in 10 s)",
                "a: works again (the last of 19 such events in 10 s)",
            ]
        );
        // Long after, a fault is reported at once; what was counted at the end.
        let fault = EventKind::SensorRecovered { index: 0 };
        for passes in [true, true, true, true, false] {
            assert_eq!(
                flapping.passes::<()>(&fault, "a: works again", 60.0),
                passes
            );
        }
        assert_eq!(flapping.summaries(61.0, true).count(), 1);
    }
    #[test]
    fn interruptions_of_different_lengths_are_counted_together() {
        let mut flapping = Flapping::default();
        let mut shown = 0;
        // A cut link of another length in each second.
        for second in 0..20_u32 {
            let lasted_ns = 300_000_000 + u64::from(second) * 10_000_000;
            let kind = EventKind::Noticed(Notice {
                kind: 2,
                lasted_ns,
                ..Notice::default()
            });
            let line = format!("link lost for 0.{} s", 30 + second);
            shown += usize::from(flapping.passes::<()>(&kind, &line, second.into()));
        }
        assert_eq!(shown, 4);
        // Another kind is shown at once.
        let stood_still = EventKind::Noticed(Notice {
            kind: 1,
            lasted_ns: 400_000_000,
            ..Notice::default()
        });
        let line = "simulator stood still for 0.4 s";
        assert!(flapping.passes::<()>(&stood_still, line, 20.0));
        let summary: Vec<_> = flapping.summaries(20.0, false).collect();
        assert_eq!(
            summary,
            ["link lost for 0.49 s (the last of 16 such events in 20 s)"]
        );
    }
}
