//! `RPOS`: where the aircraft is, in double precision.
//!
//! The reply is 69 bytes: header, f64 longitude, latitude (deg) and elevation
//! (m above mean sea level), f32 height above ground (m), pitch, true heading,
//! roll (deg), velocity east, up, south (m/s), and P, Q, R (rad/s). It carries
//! no time, so a late old one cannot be distinguished from a new one.

use super::{Kind, Malformed, body, fields};

/// The maximum size of a request: header, five digits, NUL.
pub const REQUEST_BYTES: usize = 11;
/// The size of a reply. Of a longer one only the known fields are read.
pub const REPLY_BYTES: usize = 69;

/// Writes a request for `frequency_hz` replies a second (0 stops them), and
/// returns the part of the buffer to send. The number is sent as ASCII digits.
pub fn request(into: &mut [u8; REQUEST_BYTES], frequency_hz: u16) -> &[u8] {
    let places = [10_000, 1_000, 100, 10, 1];
    let mut digits = [0_u8; 5];
    let mut count = 0;
    for place in places {
        // One digit each: at most 9, so the sum stays within a byte.
        let digit = b'0' + ((frequency_hz / place) % 10) as u8;
        if count > 0 || digit != b'0' || place == 1 {
            if let Some(free) = digits.get_mut(count) {
                *free = digit;
            }
            count += 1;
        }
    }
    fields::fill(into, &[b"RPOS\0", &digits]);
    into.get(..super::HEADER_BYTES + count + 1)
        .unwrap_or_default()
}

/// Where the aircraft is and how it moves, in X-Plane's units and axes.
#[derive(Clone, Copy, PartialEq, Debug)]
pub struct Rpos {
    /// East of Greenwich, -180..180 deg.
    pub longitude_deg: f64,
    /// North of the equator, -90..90 deg.
    pub latitude_deg: f64,
    /// Above mean sea level, m.
    pub elevation_m: f64,
    /// Above the ground, m.
    pub height_m: f32,
    /// Nose above the horizon, deg.
    pub pitch_deg: f32,
    /// Clockwise from true north, deg.
    pub true_heading_deg: f32,
    /// Right wing down, deg.
    pub roll_deg: f32,
    /// Velocity towards east, m/s.
    pub east_mps: f32,
    /// Velocity up, m/s.
    pub up_mps: f32,
    /// Velocity towards **south**, m/s.
    pub south_mps: f32,
    /// P, right wing down, rad/s.
    pub roll_radps: f32,
    /// Q, nose up, rad/s.
    pub pitch_radps: f32,
    /// R, nose right, rad/s.
    pub yaw_radps: f32,
}

/// Reads a reply.
///
/// # Errors
/// When it is another message or too short, or when a field is not finite or
/// the position is not on Earth.
pub fn parse(datagram: &[u8]) -> Result<Rpos, Malformed> {
    let body = body(datagram, Kind::Rpos)?;
    if datagram.len() < REPLY_BYTES {
        return Err(Malformed::Length);
    }
    let reply = fields(body).ok_or(Malformed::Field)?;
    let on_earth = (-180.0..=180.0).contains(&reply.longitude_deg)
        && (-90.0..=90.0).contains(&reply.latitude_deg);
    if on_earth {
        Ok(reply)
    } else {
        Err(Malformed::Field)
    }
}

fn fields(body: &[u8]) -> Option<Rpos> {
    let mut fields = fields::Fields::of(body);
    Some(Rpos {
        longitude_deg: fields.f64()?,
        latitude_deg: fields.f64()?,
        elevation_m: fields.f64()?,
        height_m: fields.f32()?,
        pitch_deg: fields.f32()?,
        true_heading_deg: fields.f32()?,
        roll_deg: fields.f32()?,
        east_mps: fields.f32()?,
        up_mps: fields.f32()?,
        south_mps: fields.f32()?,
        roll_radps: fields.f32()?,
        pitch_radps: fields.f32()?,
        yaw_radps: fields.f32()?,
    })
}
