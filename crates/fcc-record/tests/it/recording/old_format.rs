//! A recording in the first format is refused, with what can be done.

use std::collections::BTreeMap;
use std::fs::File;

use fcc_record::Recording;
use mcap::WriteOptions;

#[test]
fn a_recording_in_the_first_format_is_refused_with_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("old.mcap");
    let mut writer = WriteOptions::new()
        .profile("fcc")
        .library("fccd 0.0.9")
        .create(File::create(&path).unwrap())
        .unwrap();
    let schema = writer.add_schema("fcc.v1.Record", "protobuf", b"").unwrap();
    let channel = writer
        .add_channel(schema, "/fcc/record", "protobuf", &BTreeMap::new())
        .unwrap();
    let header = mcap::records::MessageHeader {
        channel_id: channel,
        sequence: 0,
        log_time: 1,
        publish_time: 1,
    };
    writer.write_to_known_channel(&header, &[8, 0]).unwrap();
    writer.finish().unwrap();

    let refused = Recording::open(&path).map(drop).unwrap_err().to_string();
    assert!(refused.contains("fccd 0.0.9 wrote it"), "{refused}");
    assert!(refused.contains("older than fcc.v2"), "{refused}");
    assert!(refused.contains("read it with that version"), "{refused}");
}
