//! `fccd report` on files.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use fcc_record::Recording;
use fcc_telemetry::FlightMessage;

use super::flown::{Plan, REMARK};
use super::sound;

fn fccd(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_fccd"))
        .arg("report")
        .args(arguments)
        .output()
        .unwrap()
}

#[track_caller]
fn printed(output: &Output) -> String {
    assert!(
        output.status.success(),
        "{}",
        String::from_utf8_lossy(&output.stderr)
    );
    String::from_utf8(output.stdout.clone()).unwrap()
}

#[test]
fn a_file_becomes_tables_a_page_and_json() {
    let folder = tempfile::tempdir().unwrap();
    let file = Plan::seconds(45).record(folder.path());
    let (file, page) = (file.to_str().unwrap(), folder.path().join("flight.html"));
    let text = printed(&fccd(&[file, "--html", page.to_str().unwrap()]));
    for part in [
        "2026-11-20 04:21:33 UTC",
        "SCHED_FIFO 80 was refused",
        "0123456789ab",
        "stop requested",
        "40 Hz thesis",
        "32.593 ms",
        "Every tick from 1 to 1800 is in the file.",
        REMARK,
    ] {
        assert!(text.contains(part), "{part} is not in\n{text}");
    }
    let page = fs::read_to_string(page).unwrap();
    sound(&page);
    assert!(page.contains("fccd &lt;test&gt; &amp;"));
    assert!(page.contains("the wind is &lt;light&gt;"));

    let json: serde_json::Value = serde_json::from_str(&printed(&fccd(&[file, "--json"]))).unwrap();
    assert_eq!(json["continuity"]["ticks"], 1_800);
    assert_eq!(json["timing"]["ticks"], 1_800);
    assert_eq!(json["timing"]["thesis"]["median_ms"], 24.994);
    assert_eq!(json["origin"]["realtime"]["policy"], "SCHED_OTHER");
    assert_eq!(json["end"]["kind"], "finished");
    assert_eq!(json["flight"]["legs"].as_array().unwrap().len(), 1);
}

#[test]
fn a_cut_file_is_reported_up_to_its_cut() {
    let folder = tempfile::tempdir().unwrap();
    let file = Plan::seconds(150).record(folder.path());
    let whole = fs::read(&file).unwrap();
    fs::write(&file, &whole[..whole.len() * 9 / 10]).unwrap();
    let output = fccd(&[file.to_str().unwrap()]);
    assert_eq!(output.status.code(), Some(13));
    let text = String::from_utf8(output.stdout).unwrap();
    assert!(text.contains("The recording is not whole"), "{text}");
    assert!(text.contains("25.0000 ms"), "{text}");
}

#[test]
fn a_file_that_is_not_a_recording_or_would_be_lost_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let other = folder.path().join("other.mcap");
    fs::write(&other, "not a recording").unwrap();
    let other = other.to_str().unwrap();
    for arguments in [vec![other], vec![other, "--html", other]] {
        let output = fccd(&arguments);
        assert_eq!(output.status.code(), Some(2));
        let stderr = String::from_utf8(output.stderr).unwrap();
        assert!(stderr.contains("other.mcap"), "{stderr}");
    }
    assert_eq!(fs::read_to_string(other).unwrap(), "not a recording");
}

/// The page is not written over a table of the same command.
#[test]
fn the_page_is_not_a_table() {
    let folder = tempfile::tempdir().unwrap();
    let file = Plan::seconds(5).record(folder.path());
    let tables = folder.path().join("tables");
    let page = tables.join("records.csv");
    let [file, tables, page] = [&file, &tables, &page].map(|path| path.to_str().unwrap());
    let output = fccd(&[file, "--csv", tables, "--html", page]);
    assert_eq!(output.status.code(), Some(1));
    let stderr = String::from_utf8(output.stderr).unwrap();
    assert!(
        stderr.contains("records.csv: cannot be written"),
        "{stderr}"
    );
    assert!(fs::read_to_string(page).unwrap().starts_with("tick,"));
}

/// Every number in the table parses to the bits in the recording.
#[test]
fn the_csv_is_the_recording() {
    let folder = tempfile::tempdir().unwrap();
    let file = Plan::seconds(5).record(folder.path());
    let tables = folder.path().join("tables");
    let tables = tables.to_str().unwrap();
    printed(&fccd(&[file.to_str().unwrap(), "--csv", tables]));

    let mut reader = csv::Reader::from_path(Path::new(tables).join("records.csv")).unwrap();
    let header = reader.headers().unwrap().clone();
    let rows: Vec<csv::StringRecord> = reader.records().map(Result::unwrap).collect();
    let messages: Vec<_> = Recording::open(&file)
        .unwrap()
        .messages::<FlightMessage>()
        .unwrap()
        .collect();
    let records: Vec<_> = messages
        .iter()
        .filter_map(|message| match message {
            FlightMessage::Tick(record) => Some(record),
            FlightMessage::Event(_) => None,
        })
        .collect();
    assert_eq!(rows.len(), records.len());
    assert_eq!(rows.len(), 200);
    for (row, record) in rows.iter().zip(records) {
        let cell = |name: &str| {
            let place = header.iter().position(|column| column == name).unwrap();
            row.get(place).unwrap()
        };
        let measured = &record.measurements;
        for (name, value) in [
            ("dt_s", record.tick.dt_s),
            ("pitch_rad", measured.attitude.value.pitch_rad),
            ("yaw_rate_radps", measured.body_rates.value.yaw_radps),
            (
                "specific_force_z_mps2",
                measured.specific_force.value.z_mps2,
            ),
            ("altitude_m", measured.altitude_m.value),
            ("longitude_rad", measured.position.value.longitude_rad),
            ("down_mps", measured.velocity.value.down_mps),
            ("plant_time_s", measured.plant.value.time_s),
            ("desired_heading_rad", record.setpoints.heading_rad),
            ("desired_climb_rate_mps", record.setpoints.climb_rate_mps),
            ("commanded_elevator", record.outputs.elevator),
            ("commanded_throttle", record.outputs.throttle),
        ] {
            let read: f64 = cell(name).parse().unwrap();
            assert_eq!(read.to_bits(), value.to_bits(), "{name}");
        }
        assert_eq!(cell("tick"), record.tick.number.to_string());
        assert_eq!(cell("woke_ns"), record.tick.woke.as_nanos().to_string());
        assert_eq!(cell("state"), record.state.to_string());
        assert_eq!(cell("sent"), u8::from(record.sent).to_string());
    }

    let mut events = csv::Reader::from_path(Path::new(tables).join("events.csv")).unwrap();
    let texts: Vec<String> = events
        .records()
        .map(|row| row.unwrap().get(2).unwrap().to_owned())
        .collect();
    assert!(
        texts.contains(&"standby -> engaged".to_owned()),
        "{texts:?}"
    );
    assert_eq!(texts.last().unwrap(), REMARK);
}
