//! A flight in Foxglove's well-known messages.
//!
//! Its 3D view has x east, y north, z up, and bodies with x forward, y left, z
//! up. The attitude is the estimated one, its heading magnetic.

use std::f64::consts::FRAC_PI_2;

use fcc_core::flight::{Attitude, Position};
use fcc_core::framework::Reading;
use fcc_fixed_wing::Autopilot;
use fcc_multicopter::Multicopter;
use prost::Message as _;

use super::foxglove::timestamp;
use super::wire::{FrameTransform, LocationFix, Quaternion, Vector3};
use crate::recorded::{Recorded, Views};
use fcc_telemetry::FlightRecord;

/// The frame of reference of the attitude.
const LOCAL_FRAME: &str = "local";
/// The aircraft's body frame.
const BODY_FRAME: &str = "body";
/// Shortest interval between two messages, ns: 50 a second suffice for the eye.
const MIN_SPACING_NS: i64 = 20_000_000;

/// Attitude and position of an aircraft, for Foxglove's panels and maps.
#[derive(Debug, Default)]
pub struct FoxgloveViews {
    attitude: RateLimit,
    position: RateLimit,
    transform: Option<FrameTransform>,
    location: Option<LocationFix>,
}

impl Recorded for Multicopter {
    type Views = ();
}

impl Recorded for Autopilot {
    type Views = FoxgloveViews;
}

impl Views<Autopilot> for FoxgloveViews {
    const TOPICS: &'static [(&'static str, &'static str, &'static [u8])] = &[
        (
            "/fcc/attitude",
            "foxglove.FrameTransform",
            include_bytes!(concat!(env!("OUT_DIR"), "/frame_transform.fds")),
        ),
        (
            "/fcc/position",
            "foxglove.LocationFix",
            include_bytes!(concat!(env!("OUT_DIR"), "/location_fix.fds")),
        ),
    ];

    fn take(&mut self, record: &FlightRecord, unix_ns: u64) {
        self.transform = transform(record, &mut self.attitude, unix_ns);
        self.location = location(record, &mut self.position, unix_ns);
    }

    fn append(&mut self, topic: usize, into: &mut Vec<u8>) -> bool {
        // Encoding into a vector cannot fail.
        match topic {
            0 => self
                .transform
                .take()
                .is_some_and(|view| view.encode(into).is_ok()),
            _ => self
                .location
                .take()
                .is_some_and(|view| view.encode(into).is_ok()),
        }
    }
}

/// Passes new readings, at most 50 a second.
#[derive(Debug)]
struct RateLimit {
    last_ns: i64,
}

impl Default for RateLimit {
    fn default() -> Self {
        Self { last_ns: i64::MIN }
    }
}

impl RateLimit {
    fn passes<T>(&mut self, reading: &Reading<T>) -> bool {
        let taken_ns = reading.taken.as_nanos();
        let passes = !reading.is_never() && taken_ns.saturating_sub(self.last_ns) >= MIN_SPACING_NS;
        if passes {
            self.last_ns = taken_ns;
        }
        passes
    }
}

/// The position of a record, if it is new; stamped with `unix_ns`.
fn location(record: &FlightRecord, limit: &mut RateLimit, unix_ns: u64) -> Option<LocationFix> {
    let reading = &record.measurements.position;
    limit.passes(reading).then(|| {
        let Position {
            latitude_rad,
            longitude_rad,
            altitude_m,
        } = reading.value;
        LocationFix {
            timestamp: Some(timestamp(unix_ns)),
            frame_id: BODY_FRAME.to_owned(),
            latitude: latitude_rad.to_degrees(),
            longitude: longitude_rad.to_degrees(),
            altitude: altitude_m,
        }
    })
}

/// The aircraft's attitude in the local frame, if it is new; stamped with
/// `unix_ns`. The translation is zero: the map shows the position.
fn transform(record: &FlightRecord, limit: &mut RateLimit, unix_ns: u64) -> Option<FrameTransform> {
    let measured = &record.measurements;
    if measured.heading_rad.is_never() || !limit.passes(&measured.attitude) {
        return None;
    }
    let estimate = &record.estimate;
    let attitude = Attitude {
        pitch_rad: estimate.pitch_rad,
        roll_rad: estimate.roll_rad,
    };
    Some(FrameTransform {
        timestamp: Some(timestamp(unix_ns)),
        parent_frame_id: LOCAL_FRAME.to_owned(),
        child_frame_id: BODY_FRAME.to_owned(),
        translation: Some(Vector3::default()),
        rotation: Some(orientation(attitude, estimate.heading_rad)),
    })
}

/// Yaw, pitch and roll about axes that point left and up: there a nose-up pitch
/// is negative, and east is a yaw of zero.
fn orientation(attitude: Attitude, heading_rad: f64) -> Quaternion {
    let (sin_yaw, cos_yaw) = ((FRAC_PI_2 - heading_rad) / 2.0).sin_cos();
    let (sin_pitch, cos_pitch) = (-attitude.pitch_rad / 2.0).sin_cos();
    let (sin_roll, cos_roll) = (attitude.roll_rad / 2.0).sin_cos();
    Quaternion {
        x: cos_yaw * cos_pitch * sin_roll - sin_yaw * sin_pitch * cos_roll,
        y: cos_yaw * sin_pitch * cos_roll + sin_yaw * cos_pitch * sin_roll,
        z: sin_yaw * cos_pitch * cos_roll - cos_yaw * sin_pitch * sin_roll,
        w: cos_yaw * cos_pitch * cos_roll + sin_yaw * sin_pitch * sin_roll,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Where a body axis points: the rotation matrix of a unit quaternion
    /// (Diebel 2006, eq. 125), column by column.
    fn axes(q: &Quaternion) -> [[f64; 3]; 3] {
        let Quaternion { x, y, z, w } = *q;
        [
            [
                1.0 - 2.0 * (y * y + z * z),
                2.0 * (x * y + w * z),
                2.0 * (x * z - w * y),
            ],
            [
                2.0 * (x * y - w * z),
                1.0 - 2.0 * (x * x + z * z),
                2.0 * (y * z + w * x),
            ],
            [
                2.0 * (x * z + w * y),
                2.0 * (y * z - w * x),
                1.0 - 2.0 * (x * x + y * y),
            ],
        ]
    }

    fn pointing(pitch_deg: f64, roll_deg: f64, heading_deg: f64) -> [[f64; 3]; 3] {
        let attitude = Attitude {
            pitch_rad: pitch_deg.to_radians(),
            roll_rad: roll_deg.to_radians(),
        };
        axes(&orientation(attitude, heading_deg.to_radians()))
    }

    /// As seen on a model held by hand; x east, y north, z up.
    #[test]
    fn the_model_points_where_the_aircraft_does() {
        let (forward, left, up) = (0, 1, 2);
        let cases = [
            (pointing(0.0, 0.0, 90.0), forward, [1.0, 0.0, 0.0]),
            (pointing(0.0, 0.0, 0.0), forward, [0.0, 1.0, 0.0]),
            (pointing(0.0, 0.0, 0.0), left, [-1.0, 0.0, 0.0]),
            (pointing(90.0, 0.0, 0.0), forward, [0.0, 0.0, 1.0]),
            // Northbound, right wing straight down: the left one is up, and the
            // roof points east.
            (pointing(0.0, 90.0, 0.0), left, [0.0, 0.0, 1.0]),
            (pointing(0.0, 90.0, 0.0), up, [1.0, 0.0, 0.0]),
        ];
        for (n, (axes, axis, expected)) in cases.into_iter().enumerate() {
            for (found, expected) in axes[axis].into_iter().zip(expected) {
                assert!((found - expected).abs() < 1e-12, "case {n}: {axes:?}");
            }
        }
    }
}
