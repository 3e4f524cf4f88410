//! Additions to a flight's report: the plots of pilots and of the thesis, the
//! score along a timed pattern, and the ground track.

mod altimeter;
mod ground_track;
mod legs;
mod navigation;
mod plan_items;
mod plan_page;
mod replaced_plans;
mod track;

use comfy_table::Table;
use fcc_core::framework::{EventKind, EventOf, RecordOf};
use fcc_fixed_wing::Autopilot;
use fcc_guidance::TimedPatternConfig;
use fcc_multicopter::Multicopter;
use fcc_telemetry::units::{AVIATION, M_FT, MPS_KT, PA_HPA};
use fcc_telemetry::{FlightScore, PatternScorer, Sample, ScoredBy};
use serde::Serialize;

use super::plot::Figure;
use super::plots::{Panel, Plot, Quantities, Scale};
use super::report::{Report, RunReport};
use super::reported::{Addition, Reported};
use super::survey::Survey;
use super::terms::Terms;
pub use altimeter::AltimeterSettings;
pub use legs::flight_table;
pub use navigation::{Difference, MethodResult, NavigationReplay, SourceConsistency};
pub use plan_items::{FlownItem, FlownPlan, TouchDown};
pub use plan_page::{GroundPoint, PlanFence, PlanLine, PlanPlace, PlanRow, plan_page, plan_table};
pub use replaced_plans::{ReplacedPlan, ReplacedPlans};
use track::Track;
pub use track::{GroundLine, PlanLines};

/// The report on a flight.
pub type FlightReport = Report<FlightAddition>;

/// Takes the messages of a flight's recording.
pub type FlightSurvey = Survey<Autopilot>;

/// At most this many legs are shown.
const MOST_LEGS: usize = 16;

/// Additions to a flight's report.
#[derive(Clone, Debug, Default, Serialize)]
pub struct FlightAddition {
    /// Score of the timed pattern, by measurements; `None` without a whole leg.
    pub flight: Option<FlightScore>,
    /// Why a part of the flight has no score.
    pub not_scored: Option<String>,
    /// The altimeter settings, each once, in their order, hPa.
    pub altimeter_settings_hpa: AltimeterSettings,
    /// Which flight plan was flown, if there was one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub plan: Option<String>,
    /// The plans that replaced it in flight.
    #[serde(skip_serializing_if = "ReplacedPlans::is_empty")]
    pub replaced_plans: ReplacedPlans,
    /// The items of the plan as they were flown.
    #[serde(skip_serializing_if = "FlownPlan::is_empty")]
    pub flown_plan: FlownPlan,
    /// Navigation by other methods, if it was wanted.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub navigation: Option<NavigationReplay>,
    #[serde(skip)]
    scorer: Option<PatternScorer>,
    #[serde(skip)]
    track: Track,
    #[serde(skip)]
    planned: PlanLines,
}

impl FlightAddition {
    /// Scores the flight if `pattern` is given.
    pub fn new(pattern: Option<TimedPatternConfig>) -> Self {
        Self {
            scorer: pattern.map(PatternScorer::new),
            ..Self::default()
        }
    }

    /// Says which flight plan was flown, and draws it.
    #[must_use]
    pub fn with_plan(self, plan: Option<(String, PlanLines)>) -> Self {
        let (plan, planned) = plan.unzip();
        Self {
            plan,
            planned: planned.unwrap_or_default(),
            ..self
        }
    }

    /// Runs the raw readings through navigation as well.
    #[must_use]
    pub fn with_navigation(self, navigation: NavigationReplay) -> Self {
        Self {
            navigation: Some(navigation),
            ..self
        }
    }
}

impl Addition for FlightAddition {
    fn finish(&mut self) {
        if let Some(scorer) = &self.scorer {
            let (score, failed) = scorer.result();
            self.flight = Some(score).filter(|score| !score.legs.is_empty());
            self.not_scored = failed.map(|error| error.to_string());
        }
        self.track.finish();
        if let Some(navigation) = &mut self.navigation {
            navigation.finish();
        }
    }

    fn findings(&self) -> Vec<String> {
        let unscored = self.not_scored.as_ref();
        let unscored =
            unscored.map(|why| format!("A part of the flight could not be scored: {why}."));
        let nowhere = "No position was measured: there is no ground track.";
        let nowhere = self.track.places().is_empty().then(|| nowhere.to_owned());
        let altimeter = self.altimeter_settings_hpa.finding();
        self.plan
            .clone()
            .into_iter()
            .chain(self.replaced_plans.findings())
            .chain(self.flown_plan.finding())
            .chain(unscored)
            .chain(nowhere)
            .chain(altimeter)
            .collect()
    }

    fn figures(&self, run: &RunReport) -> Vec<Figure> {
        let figure = ground_track::figure(run, &self.track, &self.planned);
        let navigation = self.navigation.iter();
        figure
            .into_iter()
            .chain(navigation.flat_map(|navigation| navigation.figures(run)))
            .collect()
    }

    fn text(&self) -> String {
        let Some(flight) = &self.flight else {
            return self.flown_plan.text();
        };
        let count = flight.legs.len();
        if count <= MOST_LEGS {
            return flight_table(flight, ScoredBy::Measurement);
        }
        let worst = FlightScore {
            legs: Vec::new(),
            worst: flight.worst,
        };
        let table = flight_table(&worst, ScoredBy::Measurement);
        format!("{table}\nof {count} legs: see the page (--html) for each")
    }

    fn tables(&self) -> Vec<(&'static str, &'static str, Table)> {
        const CAPTION: &str = "By what was measured: time until the heading stays within 2° and \
            the altitude within 10 ft of the set point, how far each goes past it, and the root \
            mean square of what is left; largest errors of a whole leg.";
        let flight = self.flight.iter();
        let legs = flight.map(|flight| ("Legs of the timed pattern", CAPTION, legs::legs(flight)));
        legs.chain(self.flown_plan.tables()).collect()
    }
}

impl Reported for Multicopter {
    type Addition = ();

    const TERMS: Terms = Terms {
        run: "flight",
        plant: "Multicopter",
        controller: "autopilot",
    };
}

impl Reported for Autopilot {
    type Addition = FlightAddition;

    const TERMS: Terms = Terms {
        run: "flight",
        plant: "Aircraft",
        controller: "autopilot",
    };

    const TABLE_OF_VALUES: bool = false;

    fn take(addition: &mut FlightAddition, record: &RecordOf<Self>, time_s: f64) {
        let position = &record.measurements.position;
        if !position.is_never() {
            addition.track.push(time_s, &position.value);
        }
        if let Some(navigation) = &mut addition.navigation {
            navigation.take(record, time_s);
        }
        let tick = record.tick.number;
        addition
            .replaced_plans
            .take(&record.setpoints, tick, time_s);
        let setting_hpa = record.setpoints.altimeter_setting_pa * PA_HPA;
        addition.altimeter_settings_hpa.push(setting_hpa);
        addition.flown_plan.take(record, time_s);
        if let Some(scorer) = &mut addition.scorer {
            let sample = Sample::measured(&record.measurements, time_s);
            // The legs lie around the set points that were captured, not around
            // the first, noisy measurement.
            let captured = Sample {
                heading_deg: record.setpoints.heading_rad.to_degrees(),
                altitude_ft: record.setpoints.altitude_m * M_FT,
                airspeed_kt: record.setpoints.airspeed_mps * MPS_KT,
                ..sample
            };
            let guidance = &record.setpoints.guidance;
            scorer.take(record.state.state(), guidance, Some(captured), Some(sample));
        }
    }

    fn take_event(addition: &mut FlightAddition, event: &EventOf<Self>) {
        if let EventKind::Noticed(notice) = &event.kind {
            addition.flown_plan.notice(notice);
        }
    }

    fn plots(of: &Quantities) -> Vec<Plot> {
        let panel = |name, quantity| of.panel(name, AVIATION).called(quantity);
        let surface = |name| {
            let panel = of.output(name, AVIATION).unscaled();
            panel.sized(64.0, Scale::Together(0.1))
        };
        let plot = |title: &str, caption: &str, panels: Vec<Panel>| Plot {
            title: title.to_owned(),
            caption: caption.to_owned(),
            panels,
        };
        vec![
            plot(
                "Heading",
                "Magnetic heading, desired, and as the navigation estimated it from the \
                 measurements (thesis, figure 6.4).",
                vec![panel("heading_rad", "heading").sized(200.0, Scale::Compass)],
            ),
            plot(
                "Altitude and pitch",
                "Pressure altitude, desired and estimated, and below it the pitch \
                 (thesis, figure 6.5).",
                vec![
                    panel("altitude_m", "altitude").sized(170.0, Scale::Around(20.0)),
                    panel("pitch_rad", "pitch")
                        .sized(90.0, Scale::Around(2.0))
                        .followed_in_failsafe(),
                ],
            ),
            plot(
                "Airspeed and throttle",
                "Indicated airspeed, desired and estimated, and the throttle commanded.",
                vec![
                    panel("airspeed_mps", "airspeed").sized(130.0, Scale::Around(4.0)),
                    of.output("throttle", AVIATION).sized(80.0, Scale::Percent),
                ],
            ),
            plot(
                "Bank and surfaces",
                "Bank, desired and estimated, and the surfaces commanded, all three on the same \
                 scale: 1 is full deflection; positive raises the nose, rolls right, yaws right.",
                vec![
                    panel("roll_rad", "bank")
                        .sized(120.0, Scale::Around(5.0))
                        .followed_in_failsafe(),
                    surface("aileron"),
                    surface("elevator"),
                    surface("rudder"),
                ],
            ),
        ]
    }
}

#[cfg(test)]
mod tests {
    use fcc_core::framework::{Flags, Message, StateCode, Tick, Time};
    use proptest::prelude::*;

    use super::*;
    use crate::{FileEnd, Origin};

    #[test]
    fn settings_are_reported_once_each_and_the_standard_one_is_not() {
        let mut addition = FlightAddition::default();
        for pa in [101_325.0, 101_325.0] {
            addition.altimeter_settings_hpa.push(pa * PA_HPA);
        }
        assert_eq!(addition.altimeter_settings_hpa.finding(), None);
        addition.altimeter_settings_hpa.push(1_020.0);
        assert_eq!(
            addition.altimeter_settings_hpa.finding().unwrap(),
            "The altimeter was set to 1013.25, then 1020.00 hPa: the altitudes below are pressure \
             altitudes."
        );
    }

    /// A record of any values: a damaged file can hold it.
    fn record() -> impl Strategy<Value = RecordOf<Autopilot>> {
        let numbers = || prop::array::uniform8(any::<f64>());
        let times = (any::<i64>(), any::<i64>(), any::<i64>());
        let missed = prop_oneof![0_u64..5, any::<u64>()];
        let counts = (0_u64..50, missed, any::<u64>(), 0_u8..4);
        (times, counts, numbers(), numbers()).prop_map(
            |((due, woke, taken), (step, missed, stage_ns, phase), a, b)| {
                let tick = Tick {
                    number: step,
                    scheduled: Time::from_nanos(due),
                    woke: Time::from_nanos(woke),
                    missed,
                    dt_s: 0.025,
                };
                let mut record = RecordOf::<Autopilot> {
                    tick,
                    ..RecordOf::<Autopilot>::default()
                };
                record.stages.total_ns = stage_ns;
                record.state = StateCode::from_parts(phase, u8::from(phase == 2), Flags::NONE)
                    .unwrap_or_default();
                record.sent = stage_ns % 2 == 0;
                let taken = Time::from_nanos(taken);
                let measured = &mut record.measurements;
                let [
                    roll,
                    pitch,
                    heading,
                    airspeed,
                    altitude,
                    latitude,
                    longitude,
                    side,
                ] = a;
                measured.attitude.value.roll_rad = roll;
                measured.attitude.value.pitch_rad = pitch;
                measured.heading_rad.value = heading;
                measured.airspeed_mps.value = airspeed;
                measured.altitude_m.value = altitude;
                measured.position.value.latitude_rad = latitude;
                measured.position.value.longitude_rad = longitude;
                measured.specific_force.value.y_mps2 = side;
                measured.attitude.taken = taken;
                measured.heading_rad.taken = record.tick.woke;
                measured.airspeed_mps.taken = record.tick.woke;
                measured.altitude_m.taken = taken;
                measured.position.taken = taken;
                let [
                    throttle,
                    elevator,
                    aileron,
                    rudder,
                    speed,
                    aimed,
                    height,
                    bank,
                ] = b;
                record.outputs.throttle = throttle;
                record.outputs.elevator = elevator;
                record.outputs.aileron = aileron;
                record.outputs.rudder = rudder;
                record.setpoints.airspeed_mps = speed;
                record.setpoints.heading_rad = aimed;
                record.setpoints.altitude_m = height;
                record.setpoints.roll_rad = bank;
                record
            },
        )
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        /// No content of a file makes a report panic or grow.
        #[test]
        fn anything_can_be_reported_on(
            records in prop::collection::vec(record(), 0..40),
            in_order in any::<bool>(),
        ) {
            let pattern = TimedPatternConfig::default();
            let addition = FlightAddition::new(Some(pattern));
            let mut survey = FlightSurvey::new(Origin::default(), addition);
            let mut number = 0;
            let mut due_ns = 0_i64;
            for (n, mut record) in records.into_iter().enumerate() {
                if n == 0 {
                    // The first record determines the period; it may be
                    // invalid.
                    record.tick.missed %= 5;
                }
                if in_order {
                    number += record.tick.number;
                    due_ns = due_ns.saturating_add(record.tick.scheduled.as_nanos().abs() >> 20);
                    record.tick.number = number;
                    record.tick.scheduled = Time::from_nanos(due_ns);
                }
                survey.take(&Message::Tick(record)).unwrap();
            }
            let report = survey.finish(FileEnd::Unknown);
            let page = report.to_html();
            prop_assert!(page.len() < 5_000_000);
            prop_assert!(!report.to_text().is_empty());
            prop_assert!(serde_json::to_string(&report).is_ok());
        }
    }
}
