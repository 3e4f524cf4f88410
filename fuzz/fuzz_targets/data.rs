//! Rows of Data Output: any bytes; what is read and written again is the same.
#![no_main]

use fcc_xplane::protocol::data::{self, Row};

libfuzzer_sys::fuzz_target!(|datagram: &[u8]| {
    let Ok(rows) = data::parse(datagram) else {
        return;
    };
    let rows: Vec<Row> = rows.collect();
    assert_eq!(data::size(rows.len()), datagram.len());
    for column in rows.iter().flat_map(|row| row.columns).flatten() {
        assert!(column.is_finite());
    }
    let mut buffer = vec![0; datagram.len()];
    let written = data::write(&mut buffer, &rows).expect("it is as long as what was read");
    assert!(data::parse(written).expect("just written").eq(rows));
});
