//! The two rings: what goes in, what comes out, and what happens when nobody
//! reads it.

use crate::bench;
use crate::bench::{Bench, EventKind, change, happened};
use fcc_core::framework::State::{Engaged, Standby, Stopped};
use fcc_core::framework::{ActuatorFault, Flags, SensorFault, Switch};
use fcc_runtime::{CommandsFull, LoopCommand, LoopConfig, Message, StageTimes};

fn small(messages_capacity: usize) -> LoopConfig {
    LoopConfig {
        messages_capacity,
        ..LoopConfig::default()
    }
}

#[test]
#[expect(clippy::float_cmp, reason = "what is handed on is the very same value")]
fn every_tick_has_one_record() {
    let mut bench = Bench::new();
    bench.command(LoopCommand::Engage);
    for _ in 0..20 {
        bench.tick(|_| {});
    }
    let records = bench.records();
    let numbers: Vec<u64> = records.iter().map(|record| record.tick.number).collect();
    assert_eq!(numbers, (1..=20).collect::<Vec<u64>>());
    assert!(records.iter().all(|record| record.state == Engaged));
    assert!(records.iter().all(|record| record.sent));
    assert!(records.iter().all(|record| record.outputs == 0.5));
    assert!(records.iter().all(|record| record.setpoints == 0.025));
}

/// On the bench a call takes 1, 2, 4, 8 or 16 µs, and every other 32 µs.
#[test]
fn every_stage_is_timed() {
    let mut bench = Bench::engaged(&LoopConfig::default());
    bench.tick(|_| {});
    let engaged = StageTimes {
        sensors_ns: 1_000,
        estimate_ns: 2_000,
        guide_ns: 4_000,
        control_ns: 8_000,
        actuators_ns: 16_000,
        total_ns: 31_000,
    };
    assert_eq!(bench.machine.record().stages, engaged);

    // A command to the controller is part of the whole and of no stage.
    bench.command(LoopCommand::Controller(1));
    bench.tick(|_| {});
    let total_ns = 63_000;
    assert_eq!(
        bench.machine.record().stages,
        StageTimes {
            total_ns,
            ..engaged
        }
    );

    bench.tick(|s| s.faults = Flags::bit(0));
    let failsafe = StageTimes {
        guide_ns: 0,
        total_ns: 27_000,
        ..engaged
    };
    assert_eq!(bench.machine.record().stages, failsafe);

    // Released: the release and the controller's disengagement.
    bench.command(LoopCommand::Disengage);
    bench.tick(|_| {});
    let standby = StageTimes {
        sensors_ns: 1_000,
        estimate_ns: 2_000,
        total_ns: 3_000 + 64_000,
        ..StageTimes::default()
    };
    assert_eq!(bench.machine.record().stages, standby);
}

#[test]
fn commands_take_effect_in_their_sequence() {
    let mut bench = Bench::new();
    for command in [
        LoopCommand::Controller(1),
        LoopCommand::Engage,
        LoopCommand::Controller(2),
        LoopCommand::Disengage,
        LoopCommand::Engage,
        LoopCommand::Stop,
    ] {
        bench.command(command);
    }
    assert_eq!(bench.tick(|_| {}), Engaged);
    assert_eq!(bench.stage.log().ordered, [1]);
    assert_eq!(bench.tick(|_| {}), Standby);
    assert_eq!(bench.stage.log().ordered, [1, 2]);
    assert_eq!(bench.tick(|_| {}), Engaged);
    assert_eq!(bench.tick(|_| {}), Stopped);
}

/// With these and its measurements a recording is replayed: each command once,
/// in the tick that read it, before what it led to.
#[test]
fn every_command_is_reported_in_the_tick_that_read_it() {
    let mut bench = Bench::new();
    for command in [
        LoopCommand::Controller(7),
        LoopCommand::Engage,
        LoopCommand::Controller(8),
        LoopCommand::Stop,
    ] {
        bench.command(command);
    }
    bench.tick(|_| {});
    bench.tick(|_| {});
    let told: Vec<(u64, EventKind)> = bench
        .messages()
        .into_iter()
        .filter_map(|message| match message {
            Message::Event(event) => Some((event.tick, event.kind)),
            Message::Tick(_) => None,
        })
        .collect();
    assert_eq!(
        told,
        [
            (1, EventKind::CommandReceived(LoopCommand::Controller(7))),
            (1, EventKind::CommandReceived(LoopCommand::Engage)),
            (1, change(Standby, Engaged)),
            (2, EventKind::CommandReceived(LoopCommand::Controller(8))),
            (2, EventKind::CommandReceived(LoopCommand::Stop)),
            (2, change(Engaged, Stopped)),
            (2, bench::RELEASED),
        ]
    );
}

#[test]
fn a_flood_of_commands_is_read_in_portions() {
    let mut bench = Bench::new();
    for n in 0..40 {
        bench.command(LoopCommand::Controller(n));
    }
    let read: Vec<usize> = (0..4)
        .map(|_| {
            bench.tick(|_| {});
            bench.stage.log().ordered.len()
        })
        .collect();
    assert_eq!(read, [16, 32, 40, 40]);
    assert_eq!(bench.stage.log().ordered, (0..40).collect::<Vec<u32>>());
}

#[test]
fn a_command_that_finds_no_room_is_returned() {
    let mut bench = Bench::with(&LoopConfig {
        commands_capacity: 2,
        ..LoopConfig::default()
    });
    assert_eq!(bench.link.commands.room(), 2);
    bench.command(LoopCommand::Controller(1));
    bench.command(LoopCommand::Controller(2));
    assert_eq!(bench.link.commands.room(), 0);
    assert_eq!(
        bench.link.commands.send(LoopCommand::Stop),
        Err(CommandsFull(LoopCommand::Stop))
    );
    bench.tick(|_| {});
    bench.command(LoopCommand::Stop);
    assert_eq!(bench.tick(|_| {}), Stopped);
}

#[test]
fn commands_to_a_loop_that_has_ended_are_returned() {
    let bench = Bench::new();
    let mut link = bench.link;
    drop(bench.machine);
    assert_eq!(link.commands.room(), 0);
    assert_eq!(
        link.commands.send(LoopCommand::Engage),
        Err(CommandsFull(LoopCommand::Engage))
    );
}

#[test]
fn the_last_messages_can_be_received_after_the_loop_has_ended() {
    let bench = Bench::engaged(&LoopConfig::default());
    let mut link = bench.link;
    assert!(!link.messages.is_over());
    drop(bench.machine);
    assert!(!link.messages.is_over());
    let Some(Message::Event(event)) = link.messages.receive() else {
        panic!("the end was not told");
    };
    assert_eq!(event.kind, change(Engaged, Stopped));
    assert!(link.messages.receive().is_some());
    assert!(link.messages.receive().is_none());
    assert!(link.messages.is_over());
}

#[test]
fn the_lost_records_are_counted_and_reported() {
    let mut bench = Bench::with(&small(10));
    for _ in 0..25 {
        bench.tick(|_| {});
    }
    assert_eq!(bench.records().len(), 10, "ticks 1 to 10 found room");
    bench.tick(|_| {});
    let messages = bench.messages();
    let [Message::Event(event), Message::Tick(record)] = messages[..] else {
        panic!("{messages:?}");
    };
    assert_eq!(
        event.kind,
        EventKind::RecordsDropped {
            count: 15,
            first: 11,
            last: 25
        }
    );
    assert_eq!(event.tick, 26);
    assert_eq!(record.tick.number, 26);
    assert_eq!(record.records_dropped, 15);
    // Reported once; the next gap is reported separately.
    for _ in 0..12 {
        bench.tick(|_| {});
    }
    assert_eq!(bench.records().len(), 10);
    bench.tick(|_| {});
    assert_eq!(
        bench.events(),
        [EventKind::RecordsDropped {
            count: 2,
            first: 37,
            last: 38
        }]
    );
    assert_eq!(bench.machine.finish().records_dropped, 17);
}

#[test]
fn events_get_through_a_ring_full_of_records() {
    let mut bench = Bench::with(&small(10));
    for _ in 0..1_000 {
        bench.tick(|_| {});
    }
    bench.command(LoopCommand::Engage);
    bench.tick(|_| {});
    bench.command(LoopCommand::Stop);
    bench.tick(|_| {});
    let Bench {
        machine, mut link, ..
    } = bench;
    let report = machine.finish();
    let messages = std::iter::from_fn(|| link.messages.receive()).collect();
    assert_eq!(
        happened(messages),
        [
            change(Standby, Engaged),
            change(Engaged, Stopped),
            bench::RELEASED,
            EventKind::RecordsDropped {
                count: 992,
                first: 11,
                last: 1_002
            }
        ]
    );
    assert_eq!(report.records_dropped, 992);
    assert_eq!(report.events_dropped, 0);
}

/// Nobody reads anything, and a sensor fails and recovers: the events that find no
/// room are counted, and reported as soon as there is room.
#[test]
fn no_event_is_lost_without_a_report() {
    let mut bench = Bench::with(&small(10));
    for n in 0..1_000 {
        bench.tick(|s| {
            s.sample = if n % 2 == 0 {
                Err(SensorFault::Silent)
            } else {
                Ok(())
            };
        });
    }
    // A ring of 10 + 64: 5 ticks take a record and an event each, then 64
    // events more go in, and 64 wait for room.
    let kept = 5 + 64 + 64;
    assert_eq!(bench.messages().len(), 10 + 64);
    bench.tick(|_| {});
    let events = bench.events();
    assert_eq!(events.len(), 64 + 1);
    assert_eq!(
        events[64],
        EventKind::EventsDropped {
            count: 1_000 - kept,
            first: kept + 1,
            last: 1_000
        }
    );
    // Those 65 left no room for the record beside the slots kept for events.
    bench.tick(|_| {});
    assert_eq!(
        bench.events(),
        [EventKind::RecordsDropped {
            count: 996,
            first: 6,
            last: 1_001
        }]
    );
    assert_eq!(bench.machine.finish().events_dropped, 1_000 - kept);
}

/// The same flight twice, once with a reader and once without.
#[test]
fn a_hung_consumer_changes_nothing_in_the_loop() {
    let fly = |fetches: bool| {
        let mut bench = Bench::with(&small(10));
        let mut states = Vec::new();
        for n in 0_u32..2_000 {
            let state = bench.tick(|s| {
                s.switch = Some(if n % 50 < 25 { Switch::Off } else { Switch::On });
                s.faults = Flags::NONE.with(Flags::bit(0), n % 70 == 0);
                s.output = f64::from(n) / 2_000.0;
            });
            states.push((state, bench.machine.record().outputs));
            if fetches {
                bench.messages();
            }
        }
        let log = bench.stage.log();
        (states, log.calls, log.applied)
    };
    let fetched = fly(true);
    assert!(fetched.0.iter().any(|(state, _)| *state == Engaged));
    assert_eq!(fetched, fly(false));
}

#[test]
fn faults_are_reported_when_they_change_and_counted_each_time() {
    let mut bench = Bench::engaged(&LoopConfig::default());
    let fault = ActuatorFault::Unconfirmed;
    let script = [
        (Err(SensorFault::Silent), Ok(())),
        (Err(SensorFault::Silent), Err(fault)),
        (Err(SensorFault::Malformed), Err(fault)),
        (Ok(()), Err(fault)),
        (Ok(()), Ok(())),
    ];
    for (sample, apply) in script {
        let state = bench.tick(|s| {
            s.sample = sample;
            s.apply = apply;
        });
        assert_eq!(state, Engaged, "faults alone decide nothing");
    }
    let record = *bench.machine.record();
    assert_eq!((record.sensor_faults, record.actuator_faults), (3, 3));
    let sensor_fault = |fault| EventKind::SensorFault { index: 0, fault };
    assert_eq!(
        bench.events(),
        [
            sensor_fault(SensorFault::Silent),
            EventKind::ActuatorFault { index: 0, fault },
            sensor_fault(SensorFault::Malformed),
            EventKind::SensorRecovered { index: 0 },
            EventKind::ActuatorRecovered { index: 0 }
        ]
    );
}

#[test]
fn events_are_described_as_text() {
    let words = |kind: EventKind| kind.description::<bench::Stub>().to_string();
    let engage_inhibits = Flags::bit(0) | Flags::bit(1);
    assert_eq!(
        words(EventKind::EngageRefused { engage_inhibits }),
        "not engaged: nobody home, too cold"
    );
    let cause = fcc_core::framework::Cause::Faults(Flags::bit(1));
    assert_eq!(
        words(change(Engaged, fcc_core::framework::State::Failsafe(cause))),
        "engaged -> failsafe: too cold"
    );
    assert_eq!(
        words(EventKind::SensorFault {
            index: 2,
            fault: SensorFault::Silent
        }),
        "sensor 2: nothing arrives"
    );
}
