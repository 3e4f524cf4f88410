//! The plan is replaced in flight.

use fcc_conformance::allocator_calls;
use fcc_core::framework::{EventKind, LoopCommand, Message, State};
use fcc_fixed_wing::{Autopilot, AutopilotCommand, PlanReplacement};
use fcc_flight::config::PreparedPlan;
use fcc_flight::flight::about;
use fcc_flight::replay::{recorded_config, replay};
use fcc_guidance::Mode;
use fcc_plan::{Item, Place, Plan};
use fcc_record::{Recorder, RecorderSettings, RecordingPace};
use fcc_replay::{Chain, Identity};
use fcc_telemetry::{FlightMessage, FlightRecord};

use crate::plan::battery::there_and_back;
use crate::plan::flight::{Flight, HOME, legs, line};

/// Numbers that are drawn: Knuth's MMIX generator (TAOCP 2, 3.3.4).
struct Draws(u64);

impl Draws {
    /// From 0 to 1.
    fn next(&mut self) -> f64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, least: f64, most: f64) -> f64 {
        least + (most - least) * self.next()
    }
}

/// A plan with places around home, and an item of it.
fn drawn(draws: &mut Draws) -> (String, u16) {
    let mut text = format!("QGC WPL 110\n{}", line(0, 16, [0.0; 4], HOME));
    let items = 3 + (draws.next() * 4.0) as u16;
    for number in 1..=items {
        let at = HOME.ahead(draws.between(0.0, 360.0), draws.between(500.0, 9_000.0));
        let circles = draws.next() < 0.3;
        text += &if circles {
            line(number.into(), 18, [1.0, 0.0, 900.0, 0.0], at)
        } else {
            line(number.into(), 16, [0.0; 4], at)
        };
    }
    (text, 1 + (draws.next() * f64::from(items)) as u16)
}

fn drawn_and_valid(flight: &Flight, draws: &mut Draws, uploaded_s: u64) -> PreparedPlan {
    loop {
        let (text, item) = drawn(draws);
        if let Some(plan) = flight.prepared(&text, item, uploaded_s) {
            return plan;
        }
    }
}

/// To a waypoint it is as far as the record says: straight, or along and beside the leg.
fn leads_to_its_item(plan: &Plan, record: &FlightRecord) {
    let (setpoints, estimate) = (&record.setpoints, &record.estimate);
    let item = plan.item(setpoints.guidance.item as usize);
    if let (Mode::Plan, Some(Item::Waypoint { place, .. })) = (setpoints.guidance.mode, item) {
        let here = Place {
            latitude_deg: estimate.latitude_rad.to_degrees(),
            longitude_deg: estimate.longitude_rad.to_degrees(),
        };
        let away_m = here.to(*place).0;
        let along_leg_m = setpoints.to_go_m.hypot(setpoints.cross_track_m);
        let off_m = [setpoints.to_go_m, along_leg_m].map(|to_go_m| (to_go_m - away_m).abs());
        let tick = record.tick.number;
        assert!(
            off_m.iter().any(|off_m| *off_m < 5.0 + 0.01 * away_m),
            "tick {tick}: {away_m}, {off_m:?}"
        );
    }
}

/// Records it, and replays the recording.
fn is_replayed_in_every_bit(flight: &Flight, plans: &[PreparedPlan], messages: &[FlightMessage]) {
    let folder = flight.folder.path().join("recorded");
    let settings = RecorderSettings {
        pace: RecordingPace::Lockstep,
        ..RecorderSettings::new(folder)
    };
    let mut recorder = Recorder::start(about(&flight.config, None), settings).unwrap();
    for plan in plans {
        recorder.document(plan.document());
    }
    for message in messages {
        recorder.take(message);
    }
    let (status, _) = recorder.finish("over");
    let chain = Chain::open::<Autopilot>(&status.files).unwrap();
    let mut again = replay(&recorded_config(&chain).unwrap()).unwrap();
    let mut identity = Identity::of::<Autopilot>();
    let replayed = chain.replay(&mut again, |one, other| identity.take(one, other), |_| {});
    assert!(replayed.is_complete(), "{}", replayed.missing());
    assert_eq!(identity.differing, 0, "{}", identity.to_text());
}

/// Issue: replaced a hundred times at random moments: the commanded bank within its rate
/// limit, never a half-old plan, the hash right in every record; without a call of the
/// allocator; and a replay of the recording is the same in every bit. In 15 kt.
#[test]
fn a_plan_is_replaced_a_hundred_times_at_drawn_moments() {
    let keys = "wind_kt = 15\n[built-in]\nwind_from_deg = 200\nwind_kt = 15\n";
    let mut flight = Flight::warmed_up(&legs(&[0.0, 60.0], 8_000.0, 0.0), keys, |sensor| sensor);
    let mut draws = Draws(2_026);
    let plans: Vec<_> = (0..100)
        .map(|n| drawn_and_valid(&flight, &mut draws, 1_790_000_001 + n))
        .collect();
    let moments: Vec<_> = plans.iter().map(|_| draws.between(0.1, 9.0)).collect();
    // What follows soon after: of a third a pause and the plan again, of a third the plan.
    let after: Vec<_> = plans.iter().map(|_| draws.next()).collect();

    let mut messages: Vec<FlightMessage> = Vec::with_capacity(200_000);
    let mut calls = 0;
    let mut fly = |flight: &mut Flight, ticks: u64, messages: &mut Vec<FlightMessage>| {
        for _ in 0..ticks {
            calls += allocator_calls(|| {
                let _ = flight.machine.step();
            })
            .1;
            while let Some(message) = flight.link.messages.receive() {
                messages.push(message);
            }
        }
    };
    fly(&mut flight, 400, &mut messages);
    for ((plan, moment_s), after) in plans.iter().zip(moments).zip(&after) {
        fly(&mut flight, (moment_s * 40.0) as u64, &mut messages);
        flight.command(plan.command());
        fly(&mut flight, 80, &mut messages);
        if *after < 0.33 {
            flight.command(AutopilotCommand::Pause);
            fly(&mut flight, 80, &mut messages);
        }
        if *after < 0.66 {
            flight.command(AutopilotCommand::Plan(0));
            fly(&mut flight, 1, &mut messages);
        }
    }
    fly(&mut flight, 800, &mut messages);
    assert_eq!(calls, 0);

    let own = flight.config.plan.identity().unwrap();
    let (mut hash, mut uploaded_s) = (own.hash.first_64_bits(), own.uploaded_s);
    let mut expected = plans.iter();
    let mut flown = None;
    let (mut replaced, mut bank_rad, mut worst_rad) = (0, None, 0.0_f64);
    for message in &messages {
        match message {
            Message::Event(event) => {
                let text = event.kind.description::<Autopilot>().to_string();
                assert!(!text.contains("not replaced"), "{text}");
                if let EventKind::CommandReceived(LoopCommand::Controller(
                    AutopilotCommand::ReplacePlan(with),
                )) = event.kind
                {
                    assert_eq!(Some(with), expected.next().map(|plan| plan.replacement));
                    (hash, uploaded_s) = (with.plan_hash, with.plan_uploaded_unix_s);
                    let plan = plans.get(replaced).unwrap();
                    flown = Some(fcc_plan::read(&plan.content).unwrap());
                    replaced += 1;
                }
            }
            Message::Tick(record) => {
                let setpoints = &record.setpoints;
                assert_eq!(setpoints.plan_hash, hash, "tick {}", record.tick.number);
                assert_eq!(setpoints.plan_uploaded_unix_s, uploaded_s);
                if let Some(plan) = &flown {
                    leads_to_its_item(plan, record);
                }
                if record.state.state() == State::Engaged {
                    let before_rad = bank_rad.replace(setpoints.roll_rad);
                    let by_rad = before_rad.map_or(0.0, |before| setpoints.roll_rad - before);
                    worst_rad = worst_rad.max(by_rad.abs());
                }
            }
        }
    }
    let engaged = flight.machine.record();
    assert_eq!(engaged.state.state(), State::Engaged);
    assert_eq!(engaged.setpoints.guidance.mode, Mode::Plan);
    assert_eq!(replaced, 100);
    let rate_degps = worst_rad.to_degrees() * 40.0;
    println!(
        "{} records, bank at most {rate_degps:.3} °/s",
        messages.len()
    );
    assert!(
        rate_degps < 15.0 + 1e-6,
        "plan.bank_rate_degps is 15: {rate_degps}"
    );

    is_replayed_in_every_bit(&flight, &plans, &messages);
}

/// Where nothing was prepared, as in another program, the recording's document is enough.
#[test]
fn a_recorded_plan_is_prepared_from_the_recording() {
    let plan = legs(&[0.0, 60.0], 8_000.0, 0.0);
    let first = Flight::new(&plan, "[built-in]\n");
    let plan = legs(&[30.0], 7_000.0, 0.0);
    let plan = first.prepared(&plan, 1, 5).unwrap();
    // With another radius of circles another route is flown.
    let keys = "loiter_radius_m = 801\n[built-in]\n";
    let mut other = Flight::new(&legs(&[0.0, 60.0], 8_000.0, 0.0), keys);
    other.fly_until(20.0, |flight| flight.record.state.state() == State::Engaged);
    let refused = answer(&mut other, plan.command());
    assert!(
        refused.ends_with("it was not prepared for this flight"),
        "{refused}"
    );
    other.config.prepare_recorded(&plan.document());
    let done = answer(&mut other, plan.command());
    assert_eq!(done, "the plan is replaced, and flown from item 1");
}

/// What became of a plan that was commanded now, as it is told.
fn answer(flight: &mut Flight, command: AutopilotCommand) -> String {
    flight.events.clear();
    flight.command(command);
    flight.tick();
    let told = flight
        .events
        .iter()
        .find(|event| event.starts_with("the plan is"));
    told.unwrap_or_else(|| panic!("{:#?}", flight.events))
        .clone()
}

/// Not in standby, not on the runway or low over it, not in a landing, and no plan or item
/// that there is not: with the reason, and the flight goes on.
#[test]
fn a_plan_is_not_replaced_where_that_would_be_dangerous() {
    let mut flight = Flight::new(&there_and_back(), "[built-in]\nnoise = false\n");
    let plan = there_and_back()
        .replace(" 300.0 1", " 320.0 1")
        .replace(" 300 1", " 320 1");
    let plan = flight.prepared(&plan, 2, 1_790_000_009).unwrap();
    let before = flight.config.plan.identity().unwrap().hash.first_64_bits();
    assert_ne!(plan.replacement.plan_hash, before);
    let standby = answer(&mut flight, plan.command());
    assert!(
        standby.ends_with("it is accepted only while engaged"),
        "{standby}"
    );
    flight.fly_until(60.0, |flight| {
        flight.mode() == Mode::Takeoff && flight.record.measurements.airspeed_mps.value > 15.0
    });
    let low = "the plan is not replaced: the aircraft is below autopilot.runway.\
               decision_height_ft over its runway, or on it";
    assert_eq!(answer(&mut flight, plan.command()), low);
    flight.fly_until(60.0, |flight| flight.truth.get().altitude_m > 120.0 + 40.0);
    assert_eq!(answer(&mut flight, plan.command()), low);
    assert_eq!(flight.record.setpoints.plan_hash, before);
    assert_eq!(flight.mode(), Mode::Takeoff);
    // 200 ft are 61 m.
    flight.fly_until(60.0, |flight| flight.truth.get().altitude_m > 120.0 + 70.0);
    assert_eq!(flight.mode(), Mode::Takeoff);
    let unknown = PlanReplacement {
        plan_hash: 1,
        ..plan.replacement
    };
    let unknown = answer(&mut flight, AutopilotCommand::ReplacePlan(unknown));
    assert!(
        unknown.ends_with("it was not prepared for this flight"),
        "{unknown}"
    );
    let beyond = PlanReplacement {
        item: 8,
        ..plan.replacement
    };
    let beyond = answer(&mut flight, AutopilotCommand::ReplacePlan(beyond));
    assert!(beyond.ends_with("it has no such item"), "{beyond}");
    let done = answer(&mut flight, plan.command());
    assert_eq!(done, "the plan is replaced, and flown from item 2");
    assert_eq!(
        flight.record.setpoints.plan_hash,
        plan.replacement.plan_hash
    );
    assert_eq!(flight.record.setpoints.guidance.item, 2);
    flight.command(AutopilotCommand::Plan(5));
    flight.fly_until(1_000.0, |flight| flight.mode() == Mode::Land);
    let landing = "the plan is not replaced: the aircraft is landing: give the landing up \
                   first, or wait";
    assert_eq!(answer(&mut flight, plan.command()), landing);
    flight.fly_until(300.0, |flight| flight.truth.get().altitude_m < 120.0 + 5.0);
    assert_eq!(answer(&mut flight, plan.command()), landing);
    flight.fly_until(120.0, |flight| {
        flight.happened("item 7 of the plan is reached")
    });
    assert_eq!(answer(&mut flight, plan.command()), landing);
}
