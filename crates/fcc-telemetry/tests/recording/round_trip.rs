//! What is recorded comes back with the very same bits.

use fcc_core::flight::{
    Attitude, BodyRates, Measurements, Order as Command, Plant, PlantState, Position, Setpoints,
    SpecificForce, Surfaces, Velocity,
};
use fcc_core::framework::{
    ActuatorFault, Cause, EventKind, Flags, Message, Order, Reading, SensorFault, Stage,
    StageTimes, State, Switch, Tick, Time,
};
use fcc_telemetry::recording::{Compression, Recorder, RecorderSettings, Recording};
use fcc_telemetry::{FlightMessage, FlightRecord};
use proptest::prelude::*;

use crate::flight::{
    STARTED_UNIX_NS, about, event, flight, only_file, record, record_all, settings,
};

/// Records, reads, and gives what came back from a file that must be whole.
fn there_and_back(messages: &[FlightMessage], settings: RecorderSettings) -> Vec<FlightMessage> {
    let folder = settings.folder.clone();
    let recorder = Recorder::start(about(), settings).unwrap();
    let news = record_all(recorder, messages);
    assert_eq!(news.len(), 1, "{news:?}");
    let recording = Recording::open(only_file(&folder)).unwrap();
    assert!(recording.is_whole());
    let mut read = recording.messages().unwrap();
    let back = read.by_ref().collect();
    assert_eq!(read.cut(), None);
    back
}

/// Every bit of a record, where a comparison of floats would take -0 for 0 and
/// nothing for NaN: its `Debug` output with each float as its bits would be
/// long; its fields, one by one, are exact.
fn bits(record: &FlightRecord) -> Vec<u64> {
    let m = &record.measurements;
    let floats = [
        record.tick.dt_s,
        m.attitude.value.pitch_rad,
        m.attitude.value.roll_rad,
        m.heading_rad.value,
        m.body_rates.value.roll_radps,
        m.body_rates.value.pitch_radps,
        m.body_rates.value.yaw_radps,
        m.specific_force.value.x_mps2,
        m.specific_force.value.y_mps2,
        m.specific_force.value.z_mps2,
        m.airspeed_mps.value,
        m.altitude_m.value,
        m.angle_of_attack_rad.value,
        m.position.value.latitude_rad,
        m.position.value.longitude_rad,
        m.position.value.altitude_m,
        m.velocity.value.north_mps,
        m.velocity.value.east_mps,
        m.velocity.value.down_mps,
        m.surfaces.value.throttle,
        m.surfaces.value.elevator,
        m.surfaces.value.aileron,
        m.surfaces.value.rudder,
        m.plant.value.time_s,
        record.setpoints.airspeed_mps,
        record.setpoints.heading_rad,
        record.setpoints.altitude_m,
        record.setpoints.roll_rad,
        record.setpoints.climb_rate_mps,
        record.setpoints.pitch_rad,
        record.outputs.throttle,
        record.outputs.elevator,
        record.outputs.aileron,
        record.outputs.rudder,
    ];
    let times = [
        record.tick.scheduled,
        record.tick.woke,
        m.attitude.taken,
        m.heading_rad.taken,
        m.body_rates.taken,
        m.specific_force.taken,
        m.airspeed_mps.taken,
        m.altitude_m.taken,
        m.angle_of_attack_rad.taken,
        m.position.taken,
        m.velocity.taken,
        m.surfaces.taken,
        m.engage_switch.taken,
        m.plant.taken,
    ];
    let counts = [
        record.tick.number,
        record.tick.missed,
        record.stages.sensors_ns,
        record.stages.navigation_ns,
        record.stages.guidance_ns,
        record.stages.control_ns,
        record.stages.actuators_ns,
        record.stages.total_ns,
        record.sensor_faults,
        record.actuator_faults,
        record.records_dropped,
        record.overruns,
        record.page_faults,
        record.early_wake_ns,
        u64::from(record.state.phase()),
        u64::from(record.state.cause()),
        u64::from(record.state.flags().bits()),
        u64::from(record.blockers.bits()),
        u64::from(record.faults.bits()),
        u64::from(record.sent),
        m.engage_switch.value as u64,
        m.plant.value.state as u64,
    ];
    let floats = floats.into_iter().map(f64::to_bits);
    let times = times.into_iter().map(|time| time.as_nanos() as u64);
    floats.chain(times).chain(counts).collect()
}

/// Any 64 bits: numbers, infinities, NaN of every payload; more often than
/// chance would, those that formats like to lose.
fn any_f64() -> BoxedStrategy<f64> {
    prop_oneof![
        any::<u64>().prop_map(f64::from_bits),
        prop_oneof![
            Just(0.0),
            Just(-0.0),
            Just(f64::NAN),
            Just(f64::from_bits(0xfff8_0000_dead_beef)),
            Just(f64::from_bits(0x7ff0_0000_0000_0001)),
            Just(f64::INFINITY),
            Just(f64::MIN_POSITIVE / 2.0),
        ],
    ]
    .boxed()
}

fn any_time() -> impl Strategy<Value = Time> {
    prop_oneof![Just(Time::NEVER), any::<i64>().prop_map(Time::from_nanos),]
}

fn reading<T: std::fmt::Debug>(
    value: impl Strategy<Value = T> + 'static,
) -> BoxedStrategy<Reading<T>> {
    (value, any_time())
        .prop_map(|(value, taken)| Reading::new(value, taken))
        .boxed()
}

fn any_state() -> impl Strategy<Value = State> {
    prop_oneof![
        Just(State::Standby),
        Just(State::Engaged),
        Just(State::Stopped),
        Just(State::Failsafe(Cause::InvalidOutput)),
        Just(State::Failsafe(Cause::Overrun)),
        any::<u32>().prop_map(|bits| State::Failsafe(Cause::Faults(Flags::from_bits(bits)))),
    ]
}

fn any_surfaces() -> BoxedStrategy<Surfaces> {
    (any_f64(), any_f64(), any_f64(), any_f64())
        .prop_map(|(throttle, elevator, aileron, rudder)| Surfaces {
            throttle,
            elevator,
            aileron,
            rudder,
        })
        .boxed()
}

fn any_triple() -> BoxedStrategy<[f64; 3]> {
    [any_f64(), any_f64(), any_f64()].boxed()
}

fn any_measurements() -> BoxedStrategy<Measurements> {
    let attitude = (any_f64(), any_f64()).prop_map(|(pitch_rad, roll_rad)| Attitude {
        pitch_rad,
        roll_rad,
    });
    let rates = any_triple().prop_map(|[roll_radps, pitch_radps, yaw_radps]| BodyRates {
        roll_radps,
        pitch_radps,
        yaw_radps,
    });
    let force = any_triple().prop_map(|[x_mps2, y_mps2, z_mps2]| SpecificForce {
        x_mps2,
        y_mps2,
        z_mps2,
    });
    let position = any_triple().prop_map(|[latitude_rad, longitude_rad, altitude_m]| Position {
        latitude_rad,
        longitude_rad,
        altitude_m,
    });
    let velocity = any_triple().prop_map(|[north_mps, east_mps, down_mps]| Velocity {
        north_mps,
        east_mps,
        down_mps,
    });
    let switch = prop_oneof![Just(Switch::Off), Just(Switch::On)];
    let plant_state = prop_oneof![
        Just(PlantState::Running),
        Just(PlantState::Paused),
        Just(PlantState::Stalled),
        Just(PlantState::Slow),
        Just(PlantState::Jumped),
    ];
    let plant = (any_f64(), plant_state).prop_map(|(time_s, state)| Plant { time_s, state });
    (
        (reading(attitude), reading(rates), reading(force)),
        (
            reading(any_f64()),
            reading(any_f64()),
            reading(any_f64()),
            reading(any_f64()),
        ),
        (
            reading(position),
            reading(velocity),
            reading(any_surfaces()),
        ),
        (reading(switch), reading(plant)),
    )
        .prop_map(|(body, scalars, place, rest)| Measurements {
            attitude: body.0,
            body_rates: body.1,
            specific_force: body.2,
            heading_rad: scalars.0,
            airspeed_mps: scalars.1,
            altitude_m: scalars.2,
            angle_of_attack_rad: scalars.3,
            position: place.0,
            velocity: place.1,
            surfaces: place.2,
            engage_switch: rest.0,
            plant: rest.1,
        })
        .boxed()
}

fn any_record() -> impl Strategy<Value = FlightRecord> {
    let tick = (
        any::<u64>(),
        any_time(),
        any_time(),
        any::<u64>(),
        any_f64(),
    )
        .prop_map(|(number, scheduled, woke, missed, dt_s)| Tick {
            number,
            scheduled,
            woke,
            missed,
            dt_s,
        });
    let setpoints = (any_triple(), any_triple()).prop_map(|(outer, inner)| Setpoints {
        airspeed_mps: outer[0],
        heading_rad: outer[1],
        altitude_m: outer[2],
        roll_rad: inner[0],
        climb_rate_mps: inner[1],
        pitch_rad: inner[2],
    });
    let stages = any::<[u64; 6]>().prop_map(|ns| StageTimes {
        sensors_ns: ns[0],
        navigation_ns: ns[1],
        guidance_ns: ns[2],
        control_ns: ns[3],
        actuators_ns: ns[4],
        total_ns: ns[5],
    });
    (
        (tick, stages, any_measurements(), setpoints, any_surfaces()),
        (
            any::<[u64; 6]>(),
            any_state(),
            any::<[u32; 2]>(),
            any::<bool>(),
        ),
    )
        .prop_map(|((tick, stages, measurements, setpoints, outputs), rest)| {
            let (counts, state, flags, sent) = rest;
            FlightRecord {
                tick,
                stages,
                measurements,
                setpoints,
                outputs,
                sensor_faults: counts[0],
                actuator_faults: counts[1],
                records_dropped: counts[2],
                overruns: counts[3],
                page_faults: counts[4],
                early_wake_ns: counts[5],
                state: state.into(),
                blockers: Flags::from_bits(flags[0]),
                faults: Flags::from_bits(flags[1]),
                sent,
            }
        })
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn every_bit_of_a_record_comes_back(
        records in proptest::collection::vec(any_record(), 1..8),
        compression in prop_oneof![
            Just(Compression::None), Just(Compression::Lz4), Just(Compression::Zstd)
        ],
    ) {
        let folder = tempfile::tempdir().unwrap();
        let messages: Vec<_> = records.iter().copied().map(Message::Tick).collect();
        let back = there_and_back(
            &messages,
            RecorderSettings { compression, ..settings(folder.path()) },
        );
        prop_assert_eq!(back.len(), records.len());
        for (back, record) in back.iter().zip(&records) {
            let Message::Tick(back) = back else {
                panic!("an event came back");
            };
            prop_assert_eq!(bits(back), bits(record));
        }
    }
}

#[test]
fn every_event_comes_back() {
    let gap = (3, 5, 1 << 60);
    let (count, first, last) = gap;
    let failsafe = State::Failsafe(Cause::Faults(Flags::bit(31)));
    let mut kinds = vec![
        EventKind::StateChanged {
            from: State::Engaged,
            to: failsafe,
        },
        EventKind::EngageRefused {
            blockers: Flags::from_bits(0x8000_0401),
        },
        EventKind::RecordsDropped { count, first, last },
        EventKind::EventsDropped { count, first, last },
        EventKind::NotRecorded { count, first, last },
        EventKind::Released { ok: true },
        EventKind::Released { ok: false },
        EventKind::Panicked,
        EventKind::TimerFailed,
        EventKind::ToldToStop,
        EventKind::OverrunsOver { count, first, last },
        EventKind::Hung {
            silent_ns: u64::MAX,
        },
        EventKind::SensorRecovered { index: u16::MAX },
        EventKind::ActuatorRecovered { index: 0 },
    ];
    for stage in [
        Stage::Timer,
        Stage::Sensors,
        Stage::Navigation,
        Stage::Guidance,
        Stage::Control,
        Stage::Actuators,
        Stage::Tick,
    ] {
        kinds.push(EventKind::Overrun {
            of: stage,
            took_ns: u64::MAX,
            budget_ns: 1,
            longest: Stage::Control,
        });
    }
    for order in [
        Order::Engage,
        Order::Disengage,
        Order::Stop,
        Order::Controller(Command::Airspeed(-0.0)),
        Order::Controller(Command::Heading(6.1)),
        Order::Controller(Command::Altitude(f64::INFINITY)),
    ] {
        kinds.push(EventKind::Ordered(order));
    }
    for fault in [
        SensorFault::Silent,
        SensorFault::Malformed,
        SensorFault::Io { errno: -5 },
    ] {
        kinds.push(EventKind::SensorFault { index: 7, fault });
    }
    for fault in [
        ActuatorFault::Io { errno: 111 },
        ActuatorFault::Unconfirmed,
        ActuatorFault::NotConnected,
    ] {
        kinds.push(EventKind::ActuatorFault { index: 1, fault });
    }
    let messages: Vec<_> = kinds.iter().map(|kind| event(&record(9), *kind)).collect();
    let folder = tempfile::tempdir().unwrap();
    assert_eq!(there_and_back(&messages, settings(folder.path())), messages);
}

#[test]
fn a_file_says_what_flew_and_how_it_ended() {
    let folder = tempfile::tempdir().unwrap();
    let recorder = Recorder::start(about(), settings(folder.path())).unwrap();
    recorder.remark("the wind is light".to_owned());
    record_all(recorder, &flight(100));
    let path = only_file(folder.path());
    let name = path.file_name().unwrap().to_str().unwrap();
    assert_eq!(name, "2026-11-20T04-21-33.000Z-built-in-01.mcap");

    let recording = Recording::open(&path).unwrap();
    assert_eq!(*recording.about(), about());
    // printf '[built-in]\n' | sha256sum
    assert_eq!(
        recording.about().config_sha256(),
        "262dec3474ff37df2006cab875ed78c2d33acb96d3fcfb18cc0691677768bc05"
    );
    let end = recording.end().unwrap();
    assert_eq!((end.ticks, end.first_tick, end.last_tick), (100, 1, 100));
    assert_eq!(end.worst_lateness_ns, 100_000);
    assert_eq!(end.duration_ns, 99 * 25_001_000);
    assert_eq!(
        (end.state.as_str(), end.ending.as_str()),
        ("engaged", "ordered to stop")
    );

    let entry = fcc_telemetry::recording::entry(&path).unwrap();
    assert_eq!(entry.started, "2026-11-20T04:21:33Z");
}

/// Readers of MCAP search by log time: wall clock at the start plus the loop's
/// time since, and never backwards.
#[test]
fn log_times_follow_the_wall_clock_and_never_go_back() {
    let mut messages = flight(50);
    // A reading of a clock that stepped back, and a time that never was.
    messages.push(Message::Tick(record(2)));
    messages.push(Message::Event(fcc_core::framework::Event {
        tick: 0,
        time: Time::NEVER,
        kind: EventKind::Panicked,
    }));
    let folder = tempfile::tempdir().unwrap();
    let recorder = Recorder::start(about(), settings(folder.path())).unwrap();
    record_all(recorder, &messages);
    let bytes = std::fs::read(only_file(folder.path())).unwrap();
    let times: Vec<u64> = mcap::MessageStream::new(&bytes)
        .unwrap()
        .map(|message| message.unwrap().log_time)
        .collect();
    assert!(times.is_sorted());
    assert_eq!(times[0], STARTED_UNIX_NS + 25_001_000);
    assert_eq!(*times.last().unwrap(), STARTED_UNIX_NS + 50 * 25_001_000);
}
