//! Recordings: sequence and sizes are those of MAVLink's `common.xml`.

use fcc_mavlink::{LinkOptions, Log, LogWanted};
use mavlink::dialects::common::{
    LOG_REQUEST_DATA_DATA, LOG_REQUEST_END_DATA, LOG_REQUEST_LIST_DATA, MavMessage,
};

use crate::world::{QUIET, Weather, World};

const TARGET: (u8, u8) = (1, 1);

fn list(world: &mut World) {
    let (target_system, target_component) = TARGET;
    let wanted = LOG_REQUEST_LIST_DATA {
        start: 0,
        end: u16::MAX,
        target_system,
        target_component,
    };
    world.send(1, &MavMessage::LOG_REQUEST_LIST(wanted));
}

fn data(world: &mut World, link: u16, (id, ofs, count): (u16, u32, u32)) {
    let (target_system, target_component) = TARGET;
    let wanted = LOG_REQUEST_DATA_DATA {
        ofs,
        count,
        id,
        target_system,
        target_component,
    };
    world.send(link, &MavMessage::LOG_REQUEST_DATA(wanted));
}

/// Steps, with the files of the vehicle, until nothing comes any more.
fn pieces(world: &mut World, files: &[Vec<u8>]) -> Vec<MavMessage> {
    let mut came = Vec::new();
    for _ in 0..200 {
        let wanted = world.protocol.wanted_log();
        if wanted == Some(LogWanted::List) {
            // The disk is busy.
            came.extend(world.all(100));
        }
        match wanted {
            Some(LogWanted::List) => {
                let log = |file: &Vec<u8>| Log {
                    utc_s: 1_795_900_000,
                    bytes: file.len() as u32,
                };
                world.protocol.set_logs(files.iter().map(log).collect());
            }
            Some(LogWanted::Data { log, at, bytes }) => {
                let file = files.get(usize::from(log) - 1).cloned().unwrap_or_default();
                let read = file.into_iter().skip(at as usize).take(bytes as usize);
                world.protocol.set_log_data(log, at, read.collect());
            }
            None => {}
        }
        came.extend(world.all(10));
    }
    came
}

fn file(bytes: usize) -> Vec<u8> {
    (0..bytes).map(|n| (n * 31 % 251) as u8).collect()
}

/// Puts pieces into their places; returns the bytes, and those that are missing.
fn assembled(came: &[MavMessage], bytes: &mut [Option<u8>]) {
    for message in came {
        if let MavMessage::LOG_DATA(piece) = message {
            let data = piece.data.iter().take(piece.count.into());
            for (n, byte) in data.enumerate() {
                bytes[piece.ofs as usize + n] = Some(*byte);
            }
        }
    }
}

#[test]
fn recordings_are_listed_and_none_is_an_entry_without_a_number() {
    for count in [0_usize, 3] {
        let mut world = World::new();
        let files: Vec<_> = (0..count).map(|n| file(100 * n)).collect();
        list(&mut world);
        let entries: Vec<_> = pieces(&mut world, &files)
            .into_iter()
            .filter_map(|message| match message {
                MavMessage::LOG_ENTRY(entry) => Some((entry.id, entry.num_logs, entry.size)),
                _ => None,
            })
            .collect();
        let expected = match count {
            0 => vec![(0, 0, 0)],
            _ => vec![(1, 3, 0), (2, 3, 100), (3, 3, 200)],
        };
        assert_eq!(entries, expected);
    }
}

#[test]
fn a_recording_passes_a_lossy_link_by_asking_again_for_what_is_missing() {
    for length in [0, 89, 90, 91, 11_520, 30_007] {
        let mut world = World::with(None, QUIET);
        world.weather = Weather {
            loss: 0.25,
            delay_ms: (100, 300),
        };
        let files = [file(10), file(length)];
        let mut bytes = vec![None; length];
        for _ in 0..100 {
            let Some(first) = bytes.iter().position(Option::is_none) else {
                break;
            };
            data(&mut world, 1, (2, first as u32, (length - first) as u32));
            assembled(&pieces(&mut world, &files), &mut bytes);
        }
        let bytes: Option<Vec<u8>> = bytes.into_iter().collect();
        assert_eq!(bytes.as_ref(), Some(&files[1]), "{length} bytes");
    }
}

#[test]
fn the_last_piece_is_not_full_and_one_station_reads_at_a_time() {
    let mut world = World::new();
    let files = [file(180)];
    data(&mut world, 1, (1, 0, u32::MAX));
    let counts = |came: Vec<MavMessage>| -> Vec<u8> {
        let piece = |message| match message {
            MavMessage::LOG_DATA(piece) => Some(piece.count),
            _ => None,
        };
        came.into_iter().filter_map(piece).collect()
    };
    assert_eq!(counts(pieces(&mut world, &files)), [90, 90, 0]);
    data(&mut world, 1, (9, 0, 90));
    assert_eq!(counts(pieces(&mut world, &files)), [0], "there is no such");

    data(&mut world, 1, (1, 0, 180));
    world.step();
    data(&mut world, 2, (1, 0, 90));
    let texts = |came: &[MavMessage]| {
        let is_text = |message: &&MavMessage| matches!(message, MavMessage::STATUSTEXT(_));
        came.iter().filter(is_text).count()
    };
    let came = pieces(&mut world, &files);
    assert_eq!(texts(&came), 1);
    assert_eq!(counts(came), [90, 90]);
    data(&mut world, 1, (1, 0, 180));
    let end = LOG_REQUEST_END_DATA {
        target_system: 1,
        target_component: 1,
    };
    world.step();
    world.send(1, &MavMessage::LOG_REQUEST_END(end));
    assert!(counts(pieces(&mut world, &files)).is_empty());
}

/// Half of 5,760 bytes a second, at 109 bytes for a piece.
#[test]
fn telemetry_goes_on_beside_a_recording() {
    let line = LinkOptions {
        bytes_per_s: 5_760.0,
        is_datagram: false,
        is_high_latency: false,
    };
    let mut world = World::with(None, line);
    let _ = world.all(3_000);
    data(&mut world, 1, (1, 0, u32::MAX));
    let came = pieces(&mut world, &[file(100_000)]);
    let count = |is: fn(&MavMessage) -> bool| came.iter().filter(|message| is(message)).count();
    // In 2 s and what an idle second has left, of three links with the same telemetry.
    let of_data = count(|message| matches!(message, MavMessage::LOG_DATA(_)));
    assert!((52..=80).contains(&of_data), "{of_data}");
    let attitudes = count(|message| matches!(message, MavMessage::ATTITUDE(_)));
    assert!(attitudes >= 3 * 15, "{attitudes}");
}
