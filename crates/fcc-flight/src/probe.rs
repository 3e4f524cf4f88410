//! What is connected to this machine, and how a configuration reads it.

use std::path::Path;

use fcc_linux::RawValues;
use fcc_linux::iio::{Quantity, Roots};
use fcc_linux::probe::{Found, probe, spi};
use serde::Serialize;

/// Something that is connected, or a reason why that is not known.
#[derive(Clone, PartialEq, Debug, Serialize)]
pub struct Connected {
    /// Where: a bus and an address, or a device of the kernel.
    pub at: String,
    /// What it is.
    pub name: String,
    /// What it measures, or what is to be known of it.
    pub remark: String,
    /// What it measures now, in its own axes; none if it was not read.
    pub values: Option<Values>,
    /// The lines of a configuration that read it; none if it cannot be read.
    pub entry: Option<String>,
}

/// What a sensor measures; only what it has.
#[derive(Clone, PartialEq, Debug, Default, Serialize)]
pub struct Values {
    /// Of an accelerometer, m/s².
    #[serde(skip_serializing_if = "Option::is_none")]
    pub specific_force_mps2: Option<[f64; 3]>,
    /// Of a gyroscope, rad/s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub rates_radps: Option<[f64; 3]>,
    /// Of a magnetometer, µT.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub field_ut: Option<[f64; 3]>,
    /// Pa.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub static_pressure_pa: Option<f64>,
    /// Of a pitot tube, Pa.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub differential_pressure_pa: Option<f64>,
    /// Of the air outside, K.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub air_temperature_k: Option<f64>,
    /// To the ground, m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub range_m: Option<f64>,
    /// How many samples this is the mean of.
    pub samples: u32,
}

/// What is done beyond asking what is connected.
#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
pub struct ProbeRequest {
    /// Chips are set up and read, too: not while another program reads them.
    pub live: bool,
    /// SPI devices are asked who they are.
    pub spi: bool,
}

/// Looks at the devices under a root folder, `/` of this machine. The kernel's are
/// read.
pub fn connected(root: &Path, request: ProbeRequest) -> Vec<Connected> {
    let roots = Roots {
        sysfs: root.join("sys/bus/iio/devices"),
        dev: root.join("dev"),
    };
    let mut all = probe(&roots);
    if request.spi {
        all.extend(spi(&roots.dev));
    }
    let read = |found: &Found| {
        let is_read = request.live || matches!(found, Found::Iio { .. });
        let values = is_read.then(|| found.values(&roots)).flatten();
        let mut described = described(found);
        match values {
            Some(Ok(values)) => described.values = Some(shown(&values)),
            Some(Err(error)) => {
                described.remark = format!("{}; {error}", described.remark);
                described.entry = None;
            }
            None => {}
        }
        described
    };
    all.iter().map(read).collect()
}

fn shown(raw: &RawValues) -> Values {
    Values {
        specific_force_mps2: raw.specific_force_mps2,
        rates_radps: raw.rates_radps,
        field_ut: raw.field_ut,
        static_pressure_pa: raw.static_pressure_pa,
        differential_pressure_pa: raw.differential_pressure_pa,
        air_temperature_k: raw.air_temperature_k,
        range_m: raw.range_m,
        samples: raw.samples,
    }
}

fn described(found: &Found) -> Connected {
    let entry = found.entry();
    let (at, name, remark) = match found {
        Found::Chip {
            kind,
            wiring,
            is_certain,
        } => {
            let measures = kind.measures().to_owned();
            let remark = if *is_certain {
                measures
            } else {
                format!("{measures}, if it is one: something answers at its address")
            };
            (wiring.to_string(), kind.name().to_owned(), remark)
        }
        Found::Iio {
            node,
            name,
            quantities,
            ..
        } => {
            let all: Vec<_> = quantities.iter().copied().map(Quantity::shown).collect();
            (node.clone(), name.clone(), all.join(", "))
        }
        Found::Taken { wiring } => (
            wiring.to_string(),
            "a driver of the kernel has it".to_owned(),
            "is listed as iio:device if it measures".to_owned(),
        ),
        Found::Unreadable { path, why } => (
            path.display().to_string(),
            "cannot be used".to_owned(),
            why.clone(),
        ),
    };
    Connected {
        at,
        name,
        remark,
        values: None,
        entry,
    }
}
