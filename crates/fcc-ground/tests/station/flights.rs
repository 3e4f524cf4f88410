//! Recordings as the page and other programs get them.

use std::path::{Path, PathBuf};

use fcc_core::framework::{Cause, Event, EventKind, LoopCommand, Message, State, Tick, Time};
use fcc_record::{About, Recorder, RecorderSettings, RecordingPace};
use fcc_telemetry::{FlightMessage, FlightRecord};
use serde_json::Value;

use crate::common::Ground;

const RATE_HZ: u64 = 40;
const SPEED_MPS: f64 = 50.0;
const BEGIN_DEG: f64 = 45.0;
/// Of latitude, on WGS-84 at 45°.
const DEGREE_M: f64 = 111_132.0;
/// Of no daemon that runs, nor of one that the station knows.
const CONFIG: &str =
    "[autopilot.envelope]\nstall_airspeed_kt = 50.0\nnever_exceed_airspeed_kt = 180.0\n";
const REMARK: &str = "<script>alert(1)</script>";

fn record(number: u64) -> FlightRecord {
    let time = Time::from_nanos(1_000_000_000 + (number * 25_000_000).cast_signed());
    let tick = Tick {
        number,
        scheduled: time,
        woke: time,
        dt_s: 0.025,
        ..Tick::default()
    };
    let mut record = FlightRecord::new(tick, State::Engaged);
    let way_m = SPEED_MPS * number as f64 / RATE_HZ as f64;
    record.estimate.latitude_rad = (BEGIN_DEG + way_m / DEGREE_M).to_radians();
    record.estimate.longitude_rad = 8.0_f64.to_radians();
    record.estimate.altitude_m = 900.0 + number as f64;
    record.estimate.airspeed_mps = SPEED_MPS;
    record
}

/// To the north for some seconds, in one failsafe at the end if that is wanted.
pub(crate) fn fly(
    ground: &Ground,
    started_unix_s: u64,
    seconds: u64,
    fails: bool,
    finished: bool,
) -> PathBuf {
    let about = About {
        plant: "built-in".to_owned(),
        config: CONFIG.to_owned(),
        rate_hz: RATE_HZ as f64,
        started_unix_ns: started_unix_s * 1_000_000_000,
        clock_offset_ns: (started_unix_s * 1_000_000_000).cast_signed() - 1_000_000_000,
        part: 1,
        ..About::default()
    };
    let settings = RecorderSettings {
        pace: RecordingPace::Lockstep,
        ..RecorderSettings::new(ground.path("recordings"))
    };
    let before = fcc_record::files(&ground.path("recordings")).unwrap_or_default();
    let mut recorder = Recorder::start(about, settings).unwrap();
    for number in 0..=seconds * RATE_HZ {
        if number == 80 {
            let event: FlightMessage = Message::Event(Event {
                tick: number,
                time: record(number).tick.woke,
                kind: EventKind::CommandReceived(LoopCommand::Engage),
            });
            recorder.take(&event);
        }
        let mut record = record(number);
        if fails && number == seconds * RATE_HZ {
            record.state = FlightRecord::new(record.tick, State::Failsafe(Cause::Overrun)).state;
        }
        recorder.take(&Message::Tick(record));
    }
    recorder.remark(REMARK.to_owned());
    if !finished {
        std::mem::forget(recorder);
        // Its thread begins the file.
        loop {
            let files = fcc_record::files(&ground.path("recordings")).unwrap();
            if let Some(begun) = files.into_iter().find(|file| !before.contains(file)) {
                return begun;
            }
            std::thread::sleep(std::time::Duration::from_millis(5));
        }
    }
    let (status, _) = recorder.finish("stop requested");
    status.files[0].clone()
}

pub(crate) fn name(path: &Path) -> String {
    path.file_name().unwrap().to_str().unwrap().to_owned()
}

/// The columns of an answer by their names, and its header.
fn table(bytes: &[u8]) -> (Value, Vec<Vec<f64>>) {
    let length = u32::from_le_bytes(bytes[..4].try_into().unwrap()) as usize;
    let header: Value = serde_json::from_slice(&bytes[4..4 + length]).unwrap();
    let rows = header["rows"].as_u64().unwrap() as usize;
    let values = bytes[(4 + length).next_multiple_of(8)..].chunks(8);
    let values: Vec<f64> = values
        .map(|word| f64::from_le_bytes(word.try_into().unwrap()))
        .collect();
    let columns: Vec<_> = values.chunks(rows).map(<[f64]>::to_vec).collect();
    assert_eq!(columns.len(), header["columns"].as_array().unwrap().len());
    (header, columns)
}

#[test]
fn flights_are_listed_with_their_track() {
    let ground = Ground::new();
    assert_eq!(ground.get("/api/flights").json(), serde_json::json!([]));
    let first = fly(&ground, 1_795_148_400, 100, false, true);
    let second = fly(&ground, 1_795_152_000, 120, true, true);
    ground.write("recordings/torn.mcap", b"\x89MCAP0\r\n");
    // On a busy machine some are read for the next list.
    let list = loop {
        let list = ground.get("/api/flights").json();
        let mut flights = list.as_array().unwrap().iter();
        if flights.all(|flight| flight["distance_m"].is_f64() || flight["file"] == "torn.mcap") {
            break list;
        }
    };
    let list = list.as_array().unwrap();
    assert_eq!(list.len(), 3);
    let newest = list
        .iter()
        .find(|flight| flight["file"] == name(&second))
        .unwrap();
    assert!((newest["duration_s"].as_f64().unwrap() - 120.0).abs() < 1e-6);
    assert!(
        (newest["distance_m"].as_f64().unwrap() - 6_000.0).abs() < 20.0,
        "{newest}"
    );
    assert!((newest["start_utc_s"].as_f64().unwrap() - 1_795_152_000.0).abs() < 1e-3);
    assert_eq!(
        (&newest["whole"], &newest["faults"]),
        (&Value::Bool(true), &1.into())
    );
    let track = newest["thumbnail"].as_array().unwrap();
    let (begin, end) = (&track[0], &track[track.len() - 1]);
    // To the north, in the middle.
    assert_eq!((begin[0].as_f64(), end[0].as_f64()), (Some(0.5), Some(0.5)));
    assert!(begin[1].as_f64() < Some(0.01) && end[1].as_f64() > Some(0.99));
    let at = |path: &Path| list.iter().position(|flight| flight["file"] == name(path));
    assert!(at(&second) < at(&first), "the newest first");
    // The second time from what was kept, and the same.
    assert_eq!(ground.get("/api/flights").json().as_array().unwrap(), list);
}

#[test]
fn curves_are_those_of_the_recording() {
    let ground = Ground::new();
    let file = name(&fly(&ground, 1_795_148_400, 100, false, true));
    let path = format!("/api/flights/{file}/data?columns=estimated_altitude_m,tick,state");
    let (header, columns) = table(&ground.get(&path).body);
    assert_eq!(header["columns"][0]["name"], "time_s");
    assert_eq!(header["columns"][3]["names"][1], "engaged");
    assert!((header["start_utc_s"].as_f64().unwrap() - 1_795_148_400.0).abs() < 1e-3);
    assert_eq!(columns[0].len(), 4_001);
    for number in [0, 1, 2_000, 4_000] {
        let expected = [
            number as f64 * 0.025,
            900.0 + number as f64,
            number as f64,
            1.0,
        ];
        let found: Vec<f64> = columns.iter().map(|column| column[number]).collect();
        assert!((found[0] - expected[0]).abs() < 1e-9);
        assert_eq!(found[1..], expected[1..]);
    }
    let (_, few) = table(&ground.get(&format!("{path}&points=100")).body);
    assert_eq!(few[0].len(), 100);
    assert_eq!((few[1][0], few[1][99]), (900.0, 4_900.0));
    let unknown = ground.get(&format!("/api/flights/{file}/data?columns=bogus"));
    assert_eq!(unknown.status, 400);
    let events = ground.get(&format!("/api/flights/{file}/events")).json();
    let engaged = &events[0];
    assert_eq!(
        (&engaged["tick"], &engaged["code"]),
        (&80.into(), &2.into())
    );
    assert!((engaged["time_s"].as_f64().unwrap() - 2.0).abs() < 1e-9);
    assert!(
        events
            .as_array()
            .unwrap()
            .iter()
            .any(|event| event["text"] == REMARK)
    );
}

#[test]
fn the_limits_of_a_flight_are_those_that_it_flew_with() {
    let ground = Ground::new();
    let file = name(&fly(&ground, 1_795_148_400, 10, false, true));
    let limits = ground.get(&format!("/api/flights/{file}/aircraft")).json();
    // A knot is 1,852 m in an hour.
    let is_kt = |limit: &str, kt: f64| {
        let mps = limits[limit].as_f64().unwrap();
        assert!((mps - kt * 1_852.0 / 3_600.0).abs() < 1e-9, "{limits}");
    };
    is_kt("stall_mps", 50.0);
    is_kt("never_exceed_mps", 180.0);
    let none = ground.get("/api/flights/other.mcap/aircraft");
    assert_eq!(none.status, 404);
}

#[test]
fn a_flight_is_downloaded_for_other_programs() {
    let ground = Ground::new();
    let path = fly(&ground, 1_795_148_400, 100, false, true);
    let file = name(&path);
    let download = |format: &str| {
        let answer = ground.get(&format!("/api/flights/{file}/download?format={format}"));
        assert_eq!(answer.status, 200);
        let disposition = answer.header("content-disposition").unwrap().to_owned();
        assert!(
            disposition.starts_with("attachment") && disposition.contains(format),
            "{disposition}"
        );
        answer
    };
    assert_eq!(download("mcap").body, std::fs::read(&path).unwrap());
    let csv = download("csv").text();
    let mut lines = csv.lines();
    let head: Vec<&str> = lines.next().unwrap().split(',').collect();
    let altitude = head
        .iter()
        .position(|name| *name == "estimated_altitude_m")
        .unwrap();
    let last: Vec<&str> = lines.next_back().unwrap().split(',').collect();
    assert_eq!(
        (head.len(), last[0], last[altitude]),
        (last.len(), "100", "4900")
    );
    assert_eq!(lines.count(), 3_999 + 1);
    let gpx = download("gpx").text();
    assert_eq!(gpx.matches("<trkpt ").count(), 101);
    assert!(
        gpx.contains("lat=\"45.0000000\" lon=\"8.0000000\""),
        "{gpx}"
    );
    assert!(gpx.trim_end().ends_with("</gpx>"));
    let kml = download("kml").text();
    assert_eq!(kml.matches("8.0000000,45.").count(), 101);
    // A browser asks for it compressed: a gzip ends with the length (RFC 1952).
    let what = format!("GET /api/flights/{file}/download?format=csv");
    let packed = ground.send(&what, &["Accept-Encoding: gzip"], "").body;
    assert!(packed.starts_with(&[0x1f, 0x8b]));
    assert!(packed.ends_with(&(csv.len() as u32).to_le_bytes()));
    assert_eq!(
        ground
            .get(&format!("/api/flights/{file}/download?format=exe"))
            .status,
        400
    );
}

#[test]
fn a_report_may_not_use_the_station() {
    let ground = Ground::new();
    let file = name(&fly(&ground, 1_795_148_400, 10, false, true));
    let report = ground.get(&format!("/api/flights/{file}/report"));
    assert_eq!(report.status, 200, "{}", report.text());
    let policy = report.header("content-security-policy").unwrap();
    assert!(
        policy.starts_with("sandbox allow-scripts; default-src 'none'"),
        "{policy}"
    );
    assert!(!policy.contains("allow-same-origin") && !policy.contains("connect-src"));
    let page = report.text();
    assert!(page.contains("&lt;script&gt;alert(1)") && !page.contains(REMARK));
}

#[test]
fn two_flights_differ_by_what_they_flew() {
    let ground = Ground::new();
    let a = name(&fly(&ground, 1_795_148_400, 100, false, true));
    let b = name(&fly(&ground, 1_795_152_000, 120, true, true));
    let rows = ground.get(&format!("/api/flights/{a}/compare/{b}")).json();
    let row = |what: &str| {
        let mut rows = rows.as_array().unwrap().iter();
        rows.find(|row| row["what"] == what).unwrap().clone()
    };
    let engaged = row("time engaged");
    assert_eq!(
        engaged["sentence"],
        "In the second flight the time engaged is 20 s longer."
    );
    assert_eq!(
        row("failsafes")["sentence"],
        "The second flight has 1 more failsafes."
    );
    assert_eq!(row("highest altitude")["a"], 4_900.0);
    assert_eq!(
        row("greatest airspeed")["sentence"],
        "The greatest airspeed is the same."
    );
    assert_eq!(
        ground
            .get(&format!("/api/flights/{a}/compare/other.mcap"))
            .status,
        404
    );
}

#[test]
fn a_recording_is_deleted_unless_it_is_being_written() {
    let ground = Ground::new();
    let done = fly(&ground, 1_795_148_400, 10, false, true);
    let open = fly(&ground, 1_795_152_000, 10, false, false);
    let delete = |path: &Path| {
        ground
            .change(&format!("DELETE /api/flights/{}", name(path)), &Value::Null)
            .status
    };
    assert_eq!(delete(&open), 409);
    assert_eq!(delete(&done), 204);
    assert_eq!(delete(&done), 404);
    assert!(open.exists() && !done.exists());
}
