//! Which column of which row of Data Output is which quantity.
//!
//! Where versions differ or sources conflict, the configuration decides
//! ([`DataRows`]). Prefer RREF, which is unambiguous.
//!
//! - Row 16, the rates: Q, P, R in rad/s up to X-Plane 11, P, Q, R in deg/s in
//!   12. X-Plane 9 has rates, attitude and air angles one row further down.
//! - Row 17, attitude: magnetic heading in column 3, or in 4 according to one
//!   capture.
//! - Row 4, load factors in g: normal (column 4) is positive upwards, so it is
//!   -z of the body; side (6) is +y, as two independent programs take it; on the
//!   sign of axial (5) they disagree ([`axial_load`](crate::axial_load)).
//! - Row 1, times: column 2 is the time of this flight, which does not advance
//!   while paused and is reset when a flight is loaded.
//! - Row 20: latitude and longitude are f32 here and lose about a metre.

use fcc_core::flight::Position;

use crate::config::{DataRows, RowsVersion};
use crate::protocol::data::Row;
use crate::quantity::Quantity;
use crate::units::FOOT_M;

const TIMES: i32 = 1;
const SPEEDS: i32 = 3;
const LOADS: i32 = 4;
const POSITION: i32 = 20;
const VELOCITY: i32 = 21;

/// The column of the flight's time in [`TIMES`].
const FLIGHT_TIME: usize = 2;

/// Passes every quantity of a row to `found`, in the unit it has in RREF. Rows
/// that are not used are left out.
pub(crate) fn quantities(rows: DataRows, row: &Row, mut found: impl FnMut(Quantity, f64)) {
    let mut give = |quantity, column: usize, scale: f64| {
        if let Some(value) = row.columns.get(column).copied().flatten() {
            found(quantity, f64::from(value) * scale);
        }
    };
    let (rates, attitude, angles) = match rows.version {
        RowsVersion::XPlane9 => (17, 18, 19),
        RowsVersion::XPlane10 | RowsVersion::XPlane12 => (16, 17, 18),
    };
    match row.index {
        TIMES => give(Quantity::FlightTime, FLIGHT_TIME, 1.0),
        SPEEDS => give(Quantity::Airspeed, 0, 1.0),
        LOADS => {
            give(Quantity::LoadNormal, 4, 1.0);
            give(Quantity::LoadAxial, 5, 1.0);
            give(Quantity::LoadSide, 6, 1.0);
        }
        POSITION => {
            give(Quantity::OnGround, 4, 1.0);
            give(Quantity::Altitude, 5, 1.0);
        }
        VELOCITY => {
            give(Quantity::VelocityEast, 3, 1.0);
            give(Quantity::VelocityUp, 4, 1.0);
            give(Quantity::VelocitySouth, 5, 1.0);
        }
        index if index == rates => {
            let (roll, pitch, scale) = match rows.version {
                RowsVersion::XPlane9 | RowsVersion::XPlane10 => (1, 0, 1.0),
                RowsVersion::XPlane12 => (0, 1, 1.0_f64.to_radians()),
            };
            give(Quantity::RollRate, roll, scale);
            give(Quantity::PitchRate, pitch, scale);
            give(Quantity::YawRate, 2, scale);
        }
        index if index == attitude => {
            give(Quantity::Pitch, 0, 1.0);
            give(Quantity::Roll, 1, 1.0);
            let magnetic = usize::from(rows.magnetic_heading_column);
            give(Quantity::MagneticHeading, magnetic, 1.0);
        }
        index if index == angles => give(Quantity::AngleOfAttack, 0, 1.0),
        _ => {}
    }
}

/// The row that has a quantity; `None` if none has. For messages, not for a
/// tick.
pub(crate) fn row_of(rows: DataRows, quantity: Quantity) -> Option<i32> {
    (TIMES..=VELOCITY).find(|index| {
        let row = Row {
            index: *index,
            columns: [Some(0.0); 8],
        };
        let mut is_there = false;
        quantities(rows, &row, |found, _| is_there |= found == quantity);
        is_there
    })
}

/// The position in a row, if it is the one that has it.
pub(crate) fn position(row: &Row) -> Option<Position> {
    let [Some(latitude), Some(longitude), Some(feet), ..] = row.columns else {
        return None;
    };
    let on_earth = latitude.abs() <= 90.0 && longitude.abs() <= 180.0;
    (row.index == POSITION && on_earth).then(|| Position {
        latitude_rad: f64::from(latitude).to_radians(),
        longitude_rad: f64::from(longitude).to_radians(),
        altitude_m: f64::from(feet) * FOOT_M,
    })
}

/// The flight's time in a row, if it is the one that has it.
pub(crate) fn flight_time(row: &Row) -> Option<f64> {
    let time = row.columns.get(FLIGHT_TIME).copied().flatten()?;
    (row.index == TIMES)
        .then(|| Quantity::FlightTime.validate(f64::from(time)))
        .flatten()
}
