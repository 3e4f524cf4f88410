//! What is connected to a board.

mod live;
mod spi;

use std::io;
use std::path::{Path, PathBuf};

use embedded_hal::i2c::I2c;
use linux_embedded_hal::{I2CError, I2cdev};
use nix::errno::Errno;

use crate::chip::{BusError, ChipKind, Wiring, sdp3x};
use crate::iio::{Channels, Quantity, Roots};

pub use spi::{spi, spi_chip};

/// Something that was found.
#[derive(Clone, PartialEq, Debug)]
pub enum Found {
    /// A chip that answers on a bus.
    Chip {
        /// Which it is.
        kind: ChipKind,
        /// Where it is.
        wiring: Wiring,
        /// Whether it said which it is; otherwise something answers at an
        /// address that such a chip has.
        is_certain: bool,
    },
    /// A device that the kernel has a driver for.
    Iio {
        /// `iio:device0`.
        node: String,
        /// What its driver calls it.
        name: String,
        /// What it measures.
        quantities: Vec<Quantity>,
        /// Whether that name says which it is: no other device has it, and it can be
        /// written in a configuration.
        is_unique: bool,
    },
    /// An address that a driver of the kernel has: it is read by that.
    Taken {
        /// Where.
        wiring: Wiring,
    },
    /// A bus or a device of the kernel that cannot be read.
    Unreadable {
        /// Which.
        path: PathBuf,
        /// Why, and what to do.
        why: String,
    },
}

impl Found {
    /// The entry of a configuration that reads it; none if it cannot be read.
    pub fn entry(&self) -> Option<String> {
        match self {
            Self::Chip { kind, wiring, .. } => {
                let place = match wiring {
                    Wiring::I2c { path, address } => {
                        format!("i2c = \"{}\"\naddress = {address:#04x}\n", path.display())
                    }
                    Wiring::Spi { path } => format!("spi = \"{}\"\n", path.display()),
                };
                Some(format!("[[sensor]]\nkind = \"{}\"\n{place}", kind.key()))
            }
            Self::Iio {
                node,
                name,
                is_unique,
                ..
            } => {
                let device = if *is_unique { name } else { node };
                Some(format!(
                    "[[sensor]]\nkind = \"iio\"\ndevice = \"{device}\"\n"
                ))
            }
            Self::Taken { .. } | Self::Unreadable { .. } => None,
        }
    }
}

/// Looks at the kernel's devices and at all I²C buses.
///
/// Chips that have a number are asked for it, and nothing is written to a chip
/// but which register is read. What is on SPI is found by [`spi`], and not here:
/// a chip there has no address, so another one may misunderstand a question.
pub fn probe(roots: &Roots) -> Vec<Found> {
    let mut found = devices(roots);
    for path in numbered(&roots.dev, "i2c-") {
        match I2cdev::new(&path) {
            Ok(mut bus) => found.extend(chips(&mut bus, &path)),
            Err(error) => {
                let error = I2CError::from(error).into_io();
                let source = crate::DeviceError::Open {
                    device: path.display().to_string(),
                    source: error,
                };
                found.push(Found::Unreadable {
                    path,
                    why: source.to_string(),
                });
            }
        }
    }
    found
}

/// The devices of the kernel that measure something known, or cannot be read.
pub fn devices(roots: &Roots) -> Vec<Found> {
    let all = roots.devices().unwrap_or_default();
    let of_name = |name: &str| all.iter().filter(|one| one.name == name).count();
    let measuring =
        all.iter().filter_map(
            |device| match Channels::known(&roots.folder(&device.node), false) {
                Ok(channels) => Some(Found::Iio {
                    node: device.node.clone(),
                    name: device.name.clone(),
                    quantities: channels?.quantities(),
                    is_unique: of_name(&device.name) == 1 && is_plain(&device.name),
                }),
                Err(error) => Some(Found::Unreadable {
                    path: roots.sysfs.join(&device.node),
                    why: error.to_string(),
                }),
            },
        );
    measuring.collect()
}

/// Whether a name can stand in a configuration as it is.
fn is_plain(name: &str) -> bool {
    let is_plain = |c: char| c.is_ascii_graphic() && !matches!(c, '"' | '\\');
    !name.is_empty() && name.chars().all(is_plain)
}

/// Devices with this name and a number, in the order of their numbers.
fn numbered(dev: &Path, prefix: &str) -> Vec<PathBuf> {
    let entries = dev.read_dir().into_iter().flatten().flatten();
    let numbered = entries.filter_map(|entry| {
        let name = entry.file_name().into_string().ok()?;
        // Of SPI those of the bus and of the chip select.
        let numbers = name.strip_prefix(prefix)?.split('.');
        let numbers: Vec<u32> = numbers.map(|one| one.parse().ok()).collect::<Option<_>>()?;
        Some((numbers, entry.path()))
    });
    let mut all: Vec<(Vec<u32>, PathBuf)> = numbered.collect();
    all.sort();
    all.into_iter().map(|(_, path)| path).collect()
}

/// The known chips on a bus; `path` is its own.
pub fn chips<B: I2c<Error: BusError>>(bus: &mut B, path: &Path) -> Vec<Found> {
    let mut addresses: Vec<u8> = ChipKind::ALL
        .iter()
        .flat_map(|kind| kind.addresses())
        .copied()
        .collect();
    addresses.sort_unstable();
    addresses.dedup();
    let at = |address: u8| Wiring::I2c {
        path: path.to_owned(),
        address,
    };
    let answers = addresses.into_iter().filter_map(|address| {
        let kinds = ChipKind::ALL.into_iter();
        let kinds = kinds.filter(|kind| kind.addresses().contains(&address));
        for kind in kinds {
            match is_there(bus, kind, address) {
                Ok(None) => {}
                Ok(Some(is_certain)) => {
                    return Some(Found::Chip {
                        kind,
                        wiring: at(address),
                        is_certain,
                    });
                }
                Err(error) if error.raw_os_error() == Some(Errno::EBUSY as i32) => {
                    return Some(Found::Taken {
                        wiring: at(address),
                    });
                }
                // Nothing there.
                Err(_) => return None,
            }
        }
        None
    });
    answers.collect()
}

/// Whether a kind of chip is at an address, and whether it said so.
fn is_there<B: I2c<Error: BusError>>(
    bus: &mut B,
    kind: ChipKind,
    address: u8,
) -> io::Result<Option<bool>> {
    if let Some((register, known)) = kind.identification() {
        let mut found = [0];
        bus.write_read(address, &[register], &mut found)
            .map_err(BusError::into_io)?;
        let [found] = found;
        return Ok(known.contains(&found).then_some(true));
    }
    if kind == ChipKind::Sdp3x {
        // One that measures sends values with checksums; another one has to be
        // asked.
        let mut read = [0; 9];
        if bus.read(address, &mut read).is_ok() && sdp3x::pressure_pa(&read).is_some() {
            return Ok(Some(true));
        }
        return sdp3x::is_identified(bus, address).map(|is_it| is_it.then_some(true));
    }
    // The others have no number.
    let read = bus.read(address, &mut [0; 4]);
    read.map_err(BusError::into_io)?;
    Ok(Some(false))
}
