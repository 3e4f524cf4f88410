//! A disk that is too slow: the flight does not wait for it, and the loss is
//! reported.

use std::sync::{Arc, Condvar, Mutex};

use fcc_core::framework::{EventKind, Message};
use fcc_record::{Recorder, RecorderSettings, Recording};
use fcc_telemetry::FlightMessage;

use crate::recording::disks::{StuckDisk, set, wait_for_ticks};
use crate::recording::flight::{about, only_file, record};

#[test]
fn the_loss_from_a_slow_disk_is_counted_and_reported_with_its_ticks() {
    let folder = tempfile::tempdir().unwrap();
    let gate = Arc::new((Mutex::new(false), Condvar::new()));
    let disk = StuckDisk {
        gate: Arc::clone(&gate),
    };
    let capacity = 16;
    let mut recorder = Recorder::start_on(
        Box::new(disk),
        about(),
        RecorderSettings {
            capacity,
            ..RecorderSettings::new(folder.path())
        },
    )
    .unwrap();
    // The disk hangs in the file's first sync: the recorder's thread takes
    // nothing, and 16 messages fit into the queue. A recorder that waited would
    // hang here.
    for number in 1..=1_000 {
        recorder.take(&Message::Tick(record(number)));
    }
    let dropped = recorder.status().not_recorded;
    assert_eq!(dropped, 1_000 - capacity as u64);
    set(&gate, true);
    wait_for_ticks(&recorder, capacity as u64);
    recorder.take(&Message::Tick(record(1_001)));
    let (status, _) = recorder.finish("stopped by command");
    assert_eq!((status.ticks, status.stopped), (17, None));

    let path = only_file(folder.path());
    let messages: Vec<FlightMessage> = Recording::open(&path)
        .unwrap()
        .messages::<FlightMessage>()
        .unwrap()
        .skip(capacity)
        .collect();
    let [Message::Event(gap), Message::Tick(last)] = messages[..] else {
        panic!("{messages:?}");
    };
    assert_eq!(
        gap.kind,
        EventKind::NotRecorded {
            count: 984,
            first: 17,
            last: 1_000
        }
    );
    assert_eq!((gap.tick, last.tick.number), (1_001, 1_001));
    assert_eq!(
        Recording::open(&path).unwrap().end().unwrap().not_recorded,
        984
    );
}
