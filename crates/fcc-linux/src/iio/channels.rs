//! What a device measures.

use super::{Folder, Matrix};
use crate::{DeviceError, RawValues};

/// What can be measured, in the kernel's words and units (Linux,
/// Documentation/ABI/testing/sysfs-bus-iio).
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub enum Quantity {
    /// `in_accel_x` ..., m/s².
    Acceleration,
    /// `in_anglvel_x` ..., rad/s.
    AngularVelocity,
    /// `in_magn_x` ..., gauss.
    MagneticField,
    /// `in_pressure`, kPa.
    Pressure,
    /// `in_temp`, thousandths of a degree Celsius.
    Temperature,
    /// `in_distance`, m.
    Distance,
}

/// µT in a gauss.
const UT_PER_GAUSS: f64 = 100.0;
const PA_PER_KPA: f64 = 1_000.0;
const K_AT_0_C: f64 = 273.15;

impl Quantity {
    const ALL: [Self; 6] = [
        Self::Acceleration,
        Self::AngularVelocity,
        Self::MagneticField,
        Self::Pressure,
        Self::Temperature,
        Self::Distance,
    ];

    const fn prefix(self) -> &'static str {
        match self {
            Self::Acceleration => "in_accel",
            Self::AngularVelocity => "in_anglvel",
            Self::MagneticField => "in_magn",
            Self::Pressure => "in_pressure",
            Self::Temperature => "in_temp",
            Self::Distance => "in_distance",
        }
    }

    const fn axes(self) -> &'static [&'static str] {
        match self {
            Self::Acceleration | Self::AngularVelocity | Self::MagneticField => &["_x", "_y", "_z"],
            Self::Pressure | Self::Temperature | Self::Distance => &[""],
        }
    }

    /// What it is called, for people.
    pub const fn shown(self) -> &'static str {
        match self {
            Self::Acceleration => "acceleration",
            Self::AngularVelocity => "turn rates",
            Self::MagneticField => "magnetic field",
            Self::Pressure => "pressure",
            Self::Temperature => "temperature",
            Self::Distance => "distance",
        }
    }
}

/// One number of a device: (raw + offset) · scale in the kernel's unit.
#[derive(Clone, PartialEq, Debug)]
pub(super) struct Channel {
    /// Such as `in_accel_x`.
    pub(super) name: String,
    quantity: Quantity,
    offset: f64,
    scale: f64,
    /// Whether the driver gives it in the unit already, and no raw number.
    pub(super) is_processed: bool,
}

/// The channels of a device, axis by axis, and how it is mounted.
#[derive(Clone, PartialEq, Debug)]
pub struct Channels {
    pub(super) list: Vec<Channel>,
    mounted: [Matrix; 3],
    is_differential: bool,
}

impl Channels {
    /// The channels that a device has: of a vector all three axes.
    ///
    /// # Errors
    /// When it measures nothing of the [quantities](Quantity), or one of its
    /// files cannot be read.
    pub fn of(folder: &Folder, is_differential: bool) -> Result<Self, DeviceError> {
        Self::known(folder, is_differential)?.ok_or_else(|| DeviceError::Refused {
            device: folder.shown(),
            what: "it measures none of acceleration, turn rates, magnetic field, pressure, \
                   temperature and distance: choose another device"
                .to_owned(),
        })
    }

    /// As [`Channels::of`]; none if it measures nothing of the [quantities](Quantity).
    ///
    /// # Errors
    /// When one of its files cannot be read, or says what cannot be.
    pub fn known(folder: &Folder, is_differential: bool) -> Result<Option<Self>, DeviceError> {
        let mut list = Vec::new();
        for quantity in Quantity::ALL {
            list.extend(channels(folder, quantity)?);
        }
        // The temperature of a chip is not that of the air.
        if list
            .iter()
            .any(|channel| channel.quantity != Quantity::Temperature)
        {
            list.retain(|channel| channel.quantity != Quantity::Temperature);
        }
        if list.is_empty() {
            return Ok(None);
        }
        Ok(Some(Self {
            list,
            mounted: [
                mounted(folder, Quantity::Acceleration)?,
                mounted(folder, Quantity::AngularVelocity)?,
                mounted(folder, Quantity::MagneticField)?,
            ],
            is_differential,
        }))
    }

    /// What it measures, each once.
    pub fn quantities(&self) -> Vec<Quantity> {
        let mut all: Vec<Quantity> = self.list.iter().map(|channel| channel.quantity).collect();
        all.dedup();
        all
    }

    /// Whether all are raw numbers, as they are in a buffer.
    pub(super) fn are_raw(&self) -> bool {
        !self.list.iter().any(|channel| channel.is_processed)
    }

    /// The values in SI units from the numbers of all channels, in their order.
    pub(super) fn values(&self, numbers: &[f64]) -> RawValues {
        let in_unit = |quantity: Quantity| {
            let mut of_it = self
                .list
                .iter()
                .zip(numbers)
                .filter(move |(channel, _)| channel.quantity == quantity)
                .map(|(channel, number)| (number + channel.offset) * channel.scale);
            move || of_it.next()
        };
        let one = |quantity: Quantity| in_unit(quantity)();
        let three = |quantity: Quantity| {
            let mut next = in_unit(quantity);
            Some([next()?, next()?, next()?])
        };
        let [acceleration, angular_velocity, magnetic_field] = &self.mounted;
        let pressure_pa = one(Quantity::Pressure).map(|kpa| kpa * PA_PER_KPA);
        let (static_pressure_pa, differential_pressure_pa) = if self.is_differential {
            (None, pressure_pa)
        } else {
            (pressure_pa, None)
        };
        RawValues {
            specific_force_mps2: three(Quantity::Acceleration).map(|v| acceleration.applied(v)),
            rates_radps: three(Quantity::AngularVelocity).map(|v| angular_velocity.applied(v)),
            field_ut: three(Quantity::MagneticField)
                .map(|v| magnetic_field.applied(v).map(|gauss| gauss * UT_PER_GAUSS)),
            static_pressure_pa,
            differential_pressure_pa,
            air_temperature_k: one(Quantity::Temperature).map(|mc| mc * 1e-3 + K_AT_0_C),
            range_m: one(Quantity::Distance),
            samples: 1,
        }
    }
}

/// All channels of a quantity, none if it has none of them.
fn channels(folder: &Folder, quantity: Quantity) -> Result<Vec<Channel>, DeviceError> {
    let prefix = quantity.prefix();
    let mut all = Vec::new();
    let mut missing = None;
    for axis in quantity.axes() {
        let name = format!("{prefix}{axis}");
        let is_raw = folder.has(&format!("{name}_raw"));
        if !is_raw && !folder.has(&format!("{name}_input")) {
            missing = Some(name);
            continue;
        }
        let number = |what: &str, default: f64| {
            let own = format!("{name}_{what}");
            let shared = format!("{prefix}_{what}");
            folder.number_or(&[&own, &shared], default)
        };
        // The temperature of a chip is not used, and a thermistor's scale is negative.
        let is_free = quantity == Quantity::Temperature;
        let (offset, scale) = if is_raw {
            let unknown = if is_free { 1.0 } else { 0.0 };
            (number("offset", 0.0)?, number("scale", unknown)?)
        } else {
            (0.0, 1.0)
        };
        if scale <= 0.0 && !is_free {
            return Err(DeviceError::Refused {
                device: folder.shown(),
                what: format!(
                    "the scale of {name} ({prefix}_scale) is missing or not above 0, so the unit \
                     of its numbers is not known: check the driver, or choose another device"
                ),
            });
        }
        all.push(Channel {
            name,
            quantity,
            offset,
            scale,
            is_processed: !is_raw,
        });
    }
    match missing {
        // One that lost an axis must not be taken for a device without the quantity.
        Some(name) if !all.is_empty() => Err(DeviceError::Refused {
            device: folder.shown(),
            what: format!(
                "it has {} but not {name}_raw or {name}_input: check the driver, or choose another \
                 device",
                all.iter()
                    .map(|channel| channel.name.as_str())
                    .collect::<Vec<_>>()
                    .join(" and ")
            ),
        }),
        _ => Ok(all),
    }
}

fn mounted(folder: &Folder, quantity: Quantity) -> Result<Matrix, DeviceError> {
    let own = format!("{}_mount_matrix", quantity.prefix());
    for name in [own.as_str(), "in_mount_matrix", "mount_matrix"] {
        if let Ok(text) = folder.text(name) {
            return text.parse().map_err(|_| DeviceError::Malformed {
                device: format!("{}/{name}", folder.shown()),
                what: "is no rotation as a matrix like 1, 0, 0; 0, 1, 0; 0, 0, 1: correct the \
                       board's description",
            });
        }
    }
    Ok(Matrix::IDENTITY)
}
