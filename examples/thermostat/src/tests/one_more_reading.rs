//! Two controllers of which one declares one reading more: recorder, shared
//! memory, tables, arrays, replay and screen have it with no other change.

use std::io;
use std::path::Path;
use std::time::Duration;

use fcc_live::Info;
use fcc_record::{About, RecorderOf, RecorderSettings, Recording, messages};
use fcc_replay::{Chain, Identity, Replay, run};
use fcc_runtime::{LoopCommand, LoopConfig, Machine, Message, MessageOf, Parts, RecordOf};
use fcc_telemetry::Telemetry;
use fcc_telemetry::schema::{columns, header, read_words, words, write_words};
use fcc_timer::ManualTimer;
use fcc_top::{Picture, json_of};

const TICKS: u64 = 50;
const PERIOD: Duration = Duration::from_millis(25);

/// A tank with a level, and the readings that are named.
macro_rules! tank {
    ($module:ident: $($reading:ident = $number:literal),*) => {
        mod $module {
            use fcc_core::framework::{
                Actuator, ActuatorFault, Controller, Flags, Reading, Sensor, SensorFault, Tick,
            };
            use fcc_core::schema;

            schema! {
                /// The measurements of a tank.
                #[derive(Clone, Copy, PartialEq, Debug, Default)]
                pub(super) struct Measured {
                    /// Level.
                    #[field(1)]
                    pub(super) level_m: Reading<f64>,
                    $(
                        /// One more reading.
                        #[field($number)]
                        pub(super) $reading: Reading<f64>,
                    )*
                }
            }

            fcc_core::readings!(Measured { level_m: "level", $($reading: "one more"),* });

            #[derive(Default)]
            pub(super) struct Tank;

            impl Sensor<Measured> for Tank {
                fn sample(&mut self, tick: &Tick, into: &mut Measured) -> Result<(), SensorFault> {
                    into.level_m = Reading::new(tick.number as f64, tick.woke);
                    $(into.$reading = Reading::new(tick.number as f64 * 0.1, tick.woke);)*
                    Ok(())
                }

                fn name(&self) -> &'static str {
                    "gauge"
                }
            }

            impl Actuator<f64> for Tank {
                fn apply(&mut self, _: &Tick, _: &f64) -> Result<(), ActuatorFault> {
                    Ok(())
                }

                fn release(&mut self) -> Result<(), ActuatorFault> {
                    Ok(())
                }

                fn name(&self) -> &'static str {
                    "valve"
                }
            }

            impl Controller for Tank {
                type Measurements = Measured;
                type Estimate = ();
                type Setpoints = ();
                type Outputs = f64;
                type Command = ();

                fn estimate(&mut self, _: &Tick, _: &Measured) {}

                fn engage_inhibits(&self, _: &Tick, _: &Measured) -> Flags {
                    Flags::NONE
                }

                fn faults(&self, _: &Tick, _: &Measured) -> Flags {
                    Flags::NONE
                }

                fn flag_name(_: u32) -> &'static str {
                    ""
                }

                fn engage(&mut self, _: &Tick, _: &Measured) {}

                fn control(&mut self, _: &Tick, measured: &Measured) -> f64 {
                    measured.level_m.value $(+ measured.$reading.value)*
                }

                fn failsafe(&mut self, _: &Tick, _: &Measured) -> f64 {
                    0.0
                }

                fn setpoints(&self) {}

                fn outputs_are_valid(&self, output: &f64) -> bool {
                    output.is_finite()
                }
            }

            impl fcc_telemetry::Telemetry for Tank {}

            impl fcc_record::Recorded for Tank {
                type Views = ();
            }

            impl fcc_top::Watched for Tank {
                const PROGRAM: &'static str = "tank";
            }
        }
    };
}

tank!(before:);
tank!(after: inflow_mps = 2);

fn names<C: Telemetry>() -> Vec<String> {
    let all = columns::<RecordOf<C>>().into_iter();
    all.map(|column| column.name).collect()
}

/// What `more` has and `less` has not, the order of all others being the same.
fn added(less: &[String], more: &[String]) -> Vec<String> {
    let (new, old): (Vec<_>, Vec<_>) = more.iter().cloned().partition(|name| !less.contains(name));
    assert_eq!(old, less);
    new
}

fn machine() -> (Machine<after::Tank>, fcc_runtime::Link<after::Tank>) {
    let parts = Parts {
        timer: Box::new(ManualTimer::new(PERIOD).unwrap()),
        sensors: vec![Box::new(after::Tank)],
        controller: after::Tank,
        actuators: vec![Box::new(after::Tank)],
    };
    let (mut machine, mut link) = Machine::new(parts, &LoopConfig::default()).unwrap();
    machine.start().unwrap();
    link.commands.send(LoopCommand::Engage).unwrap();
    (machine, link)
}

fn record(folder: &Path) -> io::Result<(fcc_record::RecorderStatus, Vec<MessageOf<after::Tank>>)> {
    let about = About {
        rate_hz: 40.0,
        config: "tank = true".to_owned(),
        ..About::default()
    };
    let mut recorder = RecorderOf::<after::Tank>::start(about, RecorderSettings::new(folder))?;
    let (mut machine, mut link) = machine();
    let mut messages = Vec::new();
    for _ in 0..TICKS {
        machine.step();
        while let Some(message) = link.messages.receive() {
            recorder.take(&message);
            messages.push(message);
        }
    }
    Ok((recorder.finish("enough").0, messages))
}

#[test]
fn arrays_tables_and_messages_have_one_reading_more() {
    let new = added(&names::<before::Tank>(), &names::<after::Tank>());
    assert_eq!(new, ["inflow_mps", "inflow_taken_ns", "inflow_source"]);
    let (less, more) = (
        header::<RecordOf<before::Tank>>(),
        header::<RecordOf<after::Tank>>(),
    );
    assert_eq!(added(&less, &more), new);
    let fields = |file: fcc_telemetry::schema::protobuf::File| -> Vec<String> {
        let all = file.messages.into_iter().flat_map(|message| message.fields);
        all.map(|field| field.name).collect()
    };
    let more = fields(messages::<after::Tank>());
    assert!(more.contains(&"inflow_mps".to_owned()));
    assert!(!fields(messages::<before::Tank>()).contains(&"inflow_mps".to_owned()));
}

#[test]
fn the_reading_is_recorded_shared_shown_and_replayed() {
    let folder = tempfile::tempdir().unwrap();
    let (status, mut messages) = record(folder.path()).unwrap();
    let recording = Recording::open(&status.files[0]).unwrap();
    let read = recording.messages::<MessageOf<after::Tank>>().unwrap();
    let records: Vec<_> = read
        .filter_map(|message| match message {
            Message::Tick(record) => Some(record),
            Message::Event(_) => None,
        })
        .collect();
    assert_eq!(records.len() as u64, TICKS);
    let last = records.last().unwrap();
    assert_eq!(last.measurements.inflow_mps.value, TICKS as f64 * 0.1);

    let mut shared = vec![0; words::<RecordOf<after::Tank>>()];
    write_words(last, &mut shared);
    assert_eq!(read_words::<RecordOf<after::Tank>>(&shared).unwrap(), *last);

    let mut picture = Picture::<after::Tank>::of(&Info::of_this_process());
    picture.record(last);
    let shown = json_of(&picture).to_string();
    assert!(shown.contains("inflow_mps"), "{shown}");

    let replay = || Replay::new(after::Tank, PERIOD, &LoopConfig::default()).unwrap();
    let mut same = Identity::of::<after::Tank>();
    let chain = Chain::open::<after::Tank>(&status.files).unwrap();
    let replayed = chain.replay(
        &mut replay(),
        |recorded, again| same.take(recorded, again),
        |_| {},
    );
    assert!(replayed.is_complete() && same.is_identical());
    assert_eq!(replayed.run.ticks, TICKS);

    // The replay flies by the reading: another value gives another output.
    if let Some(Message::Tick(record)) = messages
        .iter_mut()
        .rev()
        .find(|message| matches!(message, Message::Tick(_)))
    {
        record.measurements.inflow_mps.value += 1.0;
    }
    let mut other = Identity::of::<after::Tank>();
    run(&mut replay(), messages, |recorded, again| {
        other.take(recorded, again);
    });
    assert_eq!(other.first.unwrap().tick, TICKS);
}
