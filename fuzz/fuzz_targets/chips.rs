//! What chips and the kernel's files for them give: any bytes. The first chooses
//! which; numbers that are accepted are finite, and have no more than their bits.
#![no_main]

use fcc_linux::chip::bmp3::Bmp3Calibration;
use fcc_linux::chip::bmp180::Bmp180Calibration;
use fcc_linux::chip::{icm42688, sdp3x};
use fcc_linux::iio::{Matrix, ScanLayout, ScanType};

libfuzzer_sys::fuzz_target!(|input: &[u8]| {
    let [kind, bytes @ ..] = input else {
        return;
    };
    match kind % 5 {
        0 => {
            let text = String::from_utf8_lossy(bytes);
            if let Ok(matrix) = text.parse::<Matrix>() {
                let _ = matrix.applied([1.0, -1.0, 0.0]);
            }
            // A type, and what it decodes.
            let (first, rest) = text.split_once('\n').unwrap_or((&text, ""));
            if let Ok(stored) = first.parse::<ScanType>() {
                let layout = ScanLayout::new(vec![(1, 0, stored), (0, 1, stored)]);
                assert_eq!(layout.bytes(), 2 * stored.bytes());
                let is_whole = rest.len() >= stored.bytes();
                assert_eq!(stored.decode(rest.as_bytes()).is_some(), is_whole);
            }
        }
        1 => {
            if let Ok(Some(values)) = icm42688::mean_of(bytes) {
                let rates = values.rates_radps.unwrap_or([f64::NAN; 3]);
                assert!(rates.iter().all(|rate| rate.abs() < 35.0));
            }
        }
        2 => {
            if let Some(pa) = bytes.first_chunk().and_then(sdp3x::pressure_pa) {
                assert!(pa.abs() <= 32_768.0);
            }
        }
        3 => {
            let [calibration @ .., a, b, c, d, e, oss] = bytes else {
                return;
            };
            if let Some(calibration) = calibration.first_chunk().and_then(Bmp180Calibration::of) {
                let temperature = i32::from(u16::from_be_bytes([*a, *b]));
                let pressure = i32::from_be_bytes([0, *c, *d, *e]);
                let _ = calibration.compensated(temperature, pressure, oss % 4);
            }
        }
        _ => {
            let Some((calibration, raw)) = bytes.split_first_chunk() else {
                return;
            };
            let calibration = Bmp3Calibration::of(calibration);
            if let [a, b, c, d, e, f, ..] = *raw {
                let temperature_c = calibration.temperature_c(u32::from_le_bytes([a, b, c, 0]));
                let raw = u32::from_le_bytes([d, e, f, 0]);
                assert!(calibration.pressure_pa(raw, temperature_c).is_finite());
            }
        }
    }
});
