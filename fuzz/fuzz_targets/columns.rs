//! What a watcher reads: any description of columns, and any row of words.
#![no_main]

use fcc_telemetry::FlightRecord;
use fcc_telemetry::schema::{RecordDescription, read_words, words, write_words};

libfuzzer_sys::fuzz_target!(|input: &[u8]| {
    let Some((kind, rest)) = input.split_first() else {
        return;
    };
    if kind % 2 == 0 {
        let text = String::from_utf8_lossy(rest);
        if let Ok(read) = RecordDescription::from_json(&text) {
            for column in &read.columns {
                if let Some((_, bytes)) = column.layout() {
                    assert!(column.offset + bytes <= read.row_bytes);
                }
            }
            assert_eq!(RecordDescription::from_json(&read.to_json()), Ok(read));
        }
        return;
    }
    let row: Vec<u64> = rest
        .chunks(8)
        .map(|chunk| {
            let mut word = [0; 8];
            word[..chunk.len()].copy_from_slice(chunk);
            u64::from_le_bytes(word)
        })
        .chain(std::iter::repeat(0))
        .take(words::<FlightRecord>())
        .collect();
    if let Ok(record) = read_words::<FlightRecord>(&row) {
        let mut again = vec![0; row.len()];
        write_words(&record, &mut again);
        let read = read_words::<FlightRecord>(&again).expect("just written");
        let mut third = vec![0; row.len()];
        write_words(&read, &mut third);
        assert_eq!(third, again);
    }
});
