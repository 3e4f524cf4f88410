//! gpsd's JSON: any bytes, cut anywhere. The first byte says where; the lines that
//! are found do not depend on that, and a fix is on the earth.
#![no_main]

use core::f64::consts::{FRAC_PI_2, PI};

use fcc_linux::gpsd::{Lines, Report};

libfuzzer_sys::fuzz_target!(|input: &[u8]| {
    let Some((cut, bytes)) = input.split_first() else {
        return;
    };
    let (first, second) = bytes.split_at(usize::from(*cut).min(bytes.len()));
    let (mut cut, mut whole) = (Vec::new(), Vec::new());
    let mut lines = Lines::default();
    let by_pieces = lines
        .push(first, |line| cut.push(line.to_vec()))
        .and_then(|()| lines.push(second, |line| cut.push(line.to_vec())));
    let at_once = Lines::default().push(bytes, |line| whole.push(line.to_vec()));
    assert_eq!((cut, by_pieces), (whole.clone(), at_once));
    // The last line has no end yet.
    let last = bytes.rsplit(|byte| *byte == b'\n').next().unwrap_or_default();
    for line in whole.iter().map(Vec::as_slice).chain([last]) {
        if let Ok(Report::Fix { fix: Ok(fix), .. }) = Report::read(line) {
            assert!(fix.position.latitude_rad.abs() <= FRAC_PI_2);
            assert!(fix.position.longitude_rad.abs() <= PI);
            let velocity = fix.velocity;
            let numbers = [
                fix.position.altitude_m,
                velocity.north_mps,
                velocity.east_mps,
                velocity.down_mps,
                fix.horizontal_accuracy_m,
                fix.vertical_accuracy_m,
                fix.speed_accuracy_mps,
            ];
            assert!(numbers.iter().all(|number| number.is_finite()));
        }
    }
});
