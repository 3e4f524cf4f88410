//! What is recorded is read back bit for bit.

use fcc_core::flight::{AltitudeReference, Position, Surfaces};
use fcc_core::framework::{
    ActuatorFault, Cause, EventKind, Flags, LoopCommand, Message, Notice, SensorFault, Stage,
    State, Time,
};
use fcc_fixed_wing::{AutopilotCommand, Resume};
use fcc_guidance::route::TookOff;
use fcc_guidance::{Mode, Progress, Targets};
use fcc_record::{Compression, Item, Recorder, RecorderSettings, Recording};
use fcc_telemetry::FlightMessage;
use proptest::prelude::*;

use crate::recording::any::{any_record, bits};
use crate::recording::flight::{
    STARTED_UNIX_NS, about, event, flight, only_file, record, record_all, settings,
};

const RESUME: Resume = Resume {
    progress: Progress {
        mode: Mode::TimedPattern,
        item: 3,
        elapsed_s: 65.0,
        captured: Targets {
            airspeed_mps: 51.4,
            heading_rad: -0.0,
            altitude_m: 914.4,
        },
    },
    surfaces: Surfaces {
        throttle: 0.7,
        elevator: -0.1,
        aileron: 1e-300,
        rudder: 0.3,
        ..Surfaces::IDLE
    },
    altimeter_setting_pa: Some(102_000.0),
    altitude_reference: AltitudeReference::Field,
    took_off: TookOff {
        latitude_rad: 0.82,
        longitude_rad: -0.0,
        course_rad: 1e-300,
        elevation_m: 431.5,
    },
};

/// Records, reads, and returns what was read from a file that must be finished.
fn there_and_back(messages: &[FlightMessage], settings: RecorderSettings) -> Vec<FlightMessage> {
    let folder = settings.folder.clone();
    let recorder = Recorder::start(about(), settings).unwrap();
    let notices = record_all(recorder, messages);
    assert_eq!(notices.len(), 1, "{notices:?}");
    let recording = Recording::open(only_file(&folder)).unwrap();
    assert!(recording.is_whole());
    let mut read = recording.messages().unwrap();
    let back = read.by_ref().collect();
    assert_eq!(read.cut(), None);
    back
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    #[test]
    fn every_bit_of_a_record_is_restored(
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

fn commands() -> impl Iterator<Item = LoopCommand<AutopilotCommand>> {
    [
        LoopCommand::Engage,
        LoopCommand::Disengage,
        LoopCommand::Stop,
        LoopCommand::Controller(AutopilotCommand::Airspeed(-0.0)),
        LoopCommand::Controller(AutopilotCommand::Heading(6.1)),
        LoopCommand::Controller(AutopilotCommand::Altitude(f64::INFINITY)),
        LoopCommand::Controller(AutopilotCommand::PressureAltitude(1_000.0)),
        LoopCommand::Controller(AutopilotCommand::Height(-3.0)),
        LoopCommand::Controller(AutopilotCommand::AltimeterSetting(99_999.9)),
        LoopCommand::Controller(AutopilotCommand::Plan(1_000)),
        LoopCommand::Controller(AutopilotCommand::Pause),
        LoopCommand::Controller(AutopilotCommand::GoTo(Position {
            latitude_rad: -0.5,
            longitude_rad: 3.1,
            altitude_m: 900.0,
        })),
        LoopCommand::Controller(AutopilotCommand::ReturnHome),
        LoopCommand::Controller(AutopilotCommand::GoAround),
        LoopCommand::Controller(AutopilotCommand::Land),
        LoopCommand::Controller(AutopilotCommand::Resume(RESUME)),
        LoopCommand::Controller(AutopilotCommand::Resume(Resume {
            altimeter_setting_pa: None,
            ..RESUME
        })),
        LoopCommand::Controller(AutopilotCommand::Resume(Resume {
            progress: Progress {
                mode: Mode::Hold,
                elapsed_s: 0.0,
                ..RESUME.progress
            },
            ..RESUME
        })),
    ]
    .into_iter()
}

#[test]
fn every_event_is_restored() {
    let gap = (3, 5, 1 << 60);
    let (count, first, last) = gap;
    let failsafe = State::Failsafe(Cause::Faults(Flags::bit(31)));
    let mut kinds = vec![
        EventKind::StateChanged {
            from: State::Engaged,
            to: failsafe,
        },
        EventKind::EngageRefused {
            engage_inhibits: Flags::from_bits(0x8000_0401),
        },
        EventKind::RecordsDropped { count, first, last },
        EventKind::EventsDropped { count, first, last },
        EventKind::NotRecorded { count, first, last },
        EventKind::Released { ok: true },
        EventKind::Released { ok: false },
        EventKind::Panicked,
        EventKind::TimerFailed,
        EventKind::StopRequested,
        EventKind::SwitchedOnUnseen,
        EventKind::EngageRefusedBySwitch,
        EventKind::OverrunsOver { count, first, last },
        EventKind::Overloaded {
            used_ns: u64::MAX,
            period_ns: 1,
        },
        EventKind::OverloadOver { count, first, last },
        EventKind::StoppedByOverload,
        EventKind::Hung {
            silent_ns: u64::MAX,
        },
        EventKind::ModeChanged {
            from: 0,
            to: u8::MAX,
        },
        EventKind::Noticed(Notice {
            kind: u8::MAX,
            lasted_ns: u64::MAX,
            amount_permille: u16::MAX,
            item: u16::MAX,
        }),
        EventKind::ReleasedAtOnce {
            conditions: Flags::bit(6),
        },
        EventKind::ConditionsChanged {
            began: Flags::from_bits(0x8100_0000),
            ended: Flags::NONE,
        },
        EventKind::SensorRecovered { index: u16::MAX },
        EventKind::ActuatorRecovered { index: 0 },
    ];
    for stage in [
        Stage::Timer,
        Stage::Sensors,
        Stage::Estimate,
        Stage::Guide,
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
    kinds.extend(commands().map(EventKind::CommandReceived));
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
fn a_file_contains_metadata_and_ending() {
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
        ("engaged", "stopped by command")
    );

    let entry = fcc_record::entry(&path).unwrap();
    assert_eq!(entry.started, "2026-11-20T04:21:33Z");
}

/// Stopped for two seconds, the loop serves the 80th period 1,975 ms after the first of them.
#[test]
fn an_outage_counts_as_lateness() {
    let folder = tempfile::tempdir().unwrap();
    let mut messages = flight(10);
    let mut late = record(90);
    late.tick.missed = 79;
    late.tick.dt_s = 2.0;
    messages.push(Message::Tick(late));
    record_all(
        Recorder::start(about(), settings(folder.path())).unwrap(),
        &messages,
    );
    let entry = fcc_record::entry(&only_file(folder.path())).unwrap();
    let own_us = (late.tick.woke - late.tick.scheduled) as f64 * 1e-3;
    assert!((entry.worst_lateness_us - own_us - 1_975_000.0).abs() < 1.0);
}

#[test]
fn remarks_have_the_time_of_the_message_before() {
    let folder = tempfile::tempdir().unwrap();
    let mut recorder = Recorder::start(about(), settings(folder.path())).unwrap();
    for message in &flight(3) {
        recorder.take(message);
    }
    recorder.remark("the wind is light".to_owned());
    recorder.take(&Message::Tick(record(4)));
    recorder.finish("stopped by command");
    let items: Vec<_> = Recording::open(only_file(folder.path()))
        .unwrap()
        .items::<FlightMessage>()
        .unwrap()
        .collect();
    // The event of engaging, three ticks, the remark, a tick. The log line of
    // the event is not a remark.
    let [.., Item::Message(_), Item::Remark(remark), Item::Message(_)] = &items[..] else {
        panic!("{items:?}");
    };
    assert_eq!(items.len(), 6);
    assert_eq!(remark.text, "the wind is light");
    assert_eq!(remark.time, record(3).tick.woke);
}

/// Readers of MCAP search by log time: wall clock at the start plus the loop's
/// time since. It never goes backwards.
#[test]
fn log_times_follow_the_wall_clock_and_never_go_back() {
    let mut messages = flight(50);
    // A clock that stepped back, and a time that was never set.
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
