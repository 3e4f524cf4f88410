//! How much is sent to X-Plane in one of its frames.

use std::time::Duration;

use crate::support::Wire;
use crate::support::bench::SURFACES;
use fcc_core::flight::Measurements;
use fcc_core::framework::{Actuator, Sensor, Tick, Time};
use fcc_xplane::{XPlane, XPlaneConfig};

/// About as many messages are taken in one frame of X-Plane.
const MESSAGES_PER_FRAME: usize = 140;
/// Its longest frame at which its time is not slow.
const FRAME_MS: usize = 50;

/// A loop of 1 kHz with eight engines that subscribes, engages, flies and
/// releases, and subscribes anew each second because nothing arrives.
#[test]
fn no_frame_of_x_plane_gets_more_messages_than_it_takes() {
    let config = XPlaneConfig {
        engines: 8,
        ..XPlaneConfig::default()
    };
    let wire = Wire::default();
    let (mut sensor, mut actuator) = XPlane::over(&config, wire.clone(), None).unwrap();
    let mut measurements = Measurements::default();
    let mut counts = Vec::new();
    for number in 1..=4_000_u64 {
        let now = Time::from_nanos(1_000_000_000_000) + Duration::from_millis(number);
        let tick = Tick {
            number,
            scheduled: now,
            woke: now,
            missed: 0,
            dt_s: 0.001,
        };
        let _ = sensor.sample(&tick, &mut measurements);
        match number {
            1_000..3_500 => drop(actuator.apply(&tick, &SURFACES)),
            3_500 => actuator.release().unwrap(),
            _ => {}
        }
        counts.push(wire.take_sent().len());
    }
    let most = counts
        .windows(FRAME_MS)
        .map(|frame| frame.iter().sum::<usize>())
        .max();
    assert!(most <= Some(MESSAGES_PER_FRAME), "{most:?}");
    // Eleven messages every 10 ms while engaged.
    let engaged: usize = counts[1_100..3_400].iter().sum();
    assert!(engaged > 2_300 / 10 * 11, "{engaged}");
}
