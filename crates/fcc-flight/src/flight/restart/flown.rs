//! What is flown, worked out from what the loop tells.

use fcc_core::flight::guidance::{Guidance, Progress, Targets, TimedPattern, TimedPatternConfig};
use fcc_core::flight::{AutopilotCommand, Resume};
use fcc_core::framework::{EventKind, LoopCommand, Message, State};
use fcc_telemetry::{FlightEvent, FlightMessage, FlightRecord};

/// Near a change of legs it is not certain to the tick which one is flown, s.
const NEAR_S: f64 = 0.5;

/// Follows what is flown.
#[derive(Debug)]
pub(super) struct Flown {
    configured: Option<TimedPatternConfig>,
    pattern: Option<Place>,
    plant_s: Option<f64>,
    is_broken: bool,
}

/// The place in the pattern.
#[derive(Clone, Copy, Debug)]
struct Place {
    elapsed_s: f64,
    captured: Option<Targets>,
}

/// What a message means for who wants to take the flight up again.
#[derive(Debug)]
pub(super) enum Matter {
    /// Nothing.
    Nothing,
    /// This is flown.
    Flying(Resume),
    /// The flight ended as it should.
    Over,
}

impl Flown {
    /// Follows flights of this pattern.
    pub(super) const fn new(configured: Option<TimedPatternConfig>) -> Self {
        Self {
            configured,
            pattern: None,
            plant_s: None,
            is_broken: false,
        }
    }

    /// Takes what the loop tells.
    pub(super) fn take(&mut self, message: &FlightMessage) -> Matter {
        match message {
            Message::Event(event) => self.event(event),
            Message::Tick(record) if record.state == State::Engaged => {
                Matter::Flying(self.record(record))
            }
            Message::Tick(_) => Matter::Nothing,
        }
    }

    fn event(&mut self, event: &FlightEvent) -> Matter {
        match event.kind {
            EventKind::StateChanged {
                to: State::Engaged, ..
            } => {
                self.plant_s = None;
                self.pattern = self.configured.map(|_| Place {
                    elapsed_s: 0.0,
                    captured: None,
                });
            }
            // A loop that broke did not end its flight: it was cut off.
            EventKind::StateChanged {
                from: State::Engaged,
                ..
            } if !self.is_broken => return Matter::Over,
            EventKind::Panicked | EventKind::TimerFailed => self.is_broken = true,
            EventKind::CommandReceived(LoopCommand::Controller(AutopilotCommand::Resume(
                resume,
            ))) => {
                self.pattern = resume.pattern_s.map(|elapsed_s| Place {
                    elapsed_s,
                    captured: Some(resume.targets),
                });
            }
            EventKind::CommandReceived(LoopCommand::Controller(command))
                if command.ends_pattern() =>
            {
                self.pattern = None;
            }
            _ => {}
        }
        Matter::Nothing
    }

    fn record(&mut self, record: &FlightRecord) -> Resume {
        let plant = record.measurements.plant;
        let step_s = if plant.is_never() {
            record.tick.dt_s
        } else {
            let before_s = self.plant_s.replace(plant.value.time_s);
            before_s.map_or(0.0, |before_s| (plant.value.time_s - before_s).max(0.0))
        };
        let aims = record.setpoints;
        let mut targets = Targets {
            airspeed_mps: aims.airspeed_mps,
            heading_rad: aims.heading_rad,
            altitude_m: aims.altitude_m,
        };
        let mut pattern_s = None;
        if let Some((place, config)) = self.pattern.as_mut().zip(self.configured) {
            place.elapsed_s += step_s;
            targets = place.captured_by(config, targets);
            pattern_s = Some(place.elapsed_s);
        }
        Resume {
            targets,
            pattern_s,
            surfaces: record.outputs,
        }
    }
}

impl Place {
    /// What the pattern captured, if `aimed` is what it aims for now.
    fn captured_by(&mut self, config: TimedPatternConfig, aimed: Targets) -> Targets {
        let from_nought = |elapsed_s: f64| {
            let progress = Progress {
                elapsed_s,
                ..Progress::default()
            };
            TimedPattern::resume(config, &progress)
        };
        let is_near = from_nought((self.elapsed_s - NEAR_S).max(0.0)).leg()
            != from_nought(self.elapsed_s + NEAR_S).leg();
        if let Some(captured) = self.captured
            && is_near
        {
            return captured;
        }
        let flown = from_nought(self.elapsed_s).targets();
        let captured = Targets {
            airspeed_mps: aimed.airspeed_mps,
            heading_rad: (aimed.heading_rad - flown.heading_rad).rem_euclid(std::f64::consts::TAU),
            altitude_m: aimed.altitude_m - flown.altitude_m,
        };
        self.captured = Some(captured);
        captured
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fcc_core::flight::{Setpoints, Surfaces};
    use fcc_core::framework::{Event, Tick, Time};

    fn event(kind: EventKind<AutopilotCommand>) -> FlightMessage {
        Message::Event(Event {
            tick: 0,
            time: Time::from_nanos(0),
            kind,
        })
    }

    fn changed(from: State, to: State) -> FlightMessage {
        event(EventKind::StateChanged { from, to })
    }

    /// A tick of 25 ms on which this is aimed for.
    fn tick(heading_deg: f64, altitude_m: f64) -> FlightMessage {
        let tick = Tick {
            dt_s: 0.025,
            ..Tick::default()
        };
        Message::Tick(FlightRecord {
            setpoints: Setpoints {
                airspeed_mps: 50.0,
                heading_rad: heading_deg.to_radians(),
                altitude_m,
                ..Setpoints::default()
            },
            outputs: Surfaces {
                throttle: 0.6,
                ..Surfaces::default()
            },
            ..FlightRecord::new(tick, State::Engaged)
        })
    }

    fn flying(flown: &mut Flown, message: &FlightMessage) -> Resume {
        match flown.take(message) {
            Matter::Flying(resume) => resume,
            other => panic!("{other:?}"),
        }
    }

    /// The thesis' pattern: 45 s after engaging it is in leg 2, which flies
    /// 180° further and as high as in the beginning.
    #[test]
    fn a_pattern_is_known_by_its_start_and_how_long_it_was_flown() {
        let mut flown = Flown::new(Some(TimedPatternConfig::default()));
        flown.take(&changed(State::Standby, State::Engaged));
        for _ in 0..800 {
            flying(&mut flown, &tick(300.0, 900.0));
        }
        for _ in 0..800 {
            flying(&mut flown, &tick(30.0, 945.72));
        }
        let mut resume = flying(&mut flown, &tick(120.0, 900.0));
        for _ in 0..199 {
            resume = flying(&mut flown, &tick(120.0, 900.0));
        }
        assert!((resume.pattern_s.unwrap() - 45.0).abs() < 0.03);
        assert!((resume.targets.heading_rad.to_degrees() - 300.0).abs() < 1e-9);
        assert!((resume.targets.altitude_m - 900.0).abs() < 1e-9);
        assert_eq!(resume.surfaces.throttle, 0.6);
    }

    #[test]
    fn an_order_ends_the_pattern_and_a_flight_taken_up_goes_on() {
        let mut flown = Flown::new(Some(TimedPatternConfig::default()));
        flown.take(&changed(State::Standby, State::Engaged));
        flying(&mut flown, &tick(10.0, 900.0));
        let command = |command| event(EventKind::CommandReceived(LoopCommand::Controller(command)));
        flown.take(&command(AutopilotCommand::Altitude(f64::NAN)));
        assert!(flying(&mut flown, &tick(10.0, 900.0)).pattern_s.is_some());
        flown.take(&command(AutopilotCommand::Altitude(950.0)));
        let held = flying(&mut flown, &tick(10.0, 950.0));
        assert_eq!(held.pattern_s, None);
        assert_eq!(held.targets.altitude_m, 950.0);
        let earlier = Resume {
            pattern_s: Some(45.0),
            ..held
        };
        flown.take(&command(AutopilotCommand::Resume(earlier)));
        let on = flying(&mut flown, &tick(190.0, 950.0));
        assert!((on.pattern_s.unwrap() - 45.025).abs() < 1e-9);
        assert!((on.targets.heading_rad.to_degrees() - 10.0).abs() < 1e-9);
    }

    #[test]
    fn a_flight_that_ends_is_over_and_one_that_breaks_is_not() {
        let mut flown = Flown::new(None);
        flown.take(&changed(State::Standby, State::Engaged));
        let ends = changed(State::Engaged, State::Stopped);
        assert!(matches!(flown.take(&ends), Matter::Over));
        flown.take(&event(EventKind::Panicked));
        assert!(matches!(flown.take(&ends), Matter::Nothing));
    }
}
