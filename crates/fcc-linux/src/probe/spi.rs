//! Chips on SPI.

use std::path::Path;

use embedded_hal::spi::SpiDevice;

use super::{Found, numbered};
use crate::chip::{BusError, ChipKind, Registers, SpiBus, Wiring, bmp3, open_spi};

/// Asks each SPI device who it is, as each of the known kinds is asked: a read of
/// a register, which another chip may take for something else.
pub fn spi(dev: &Path) -> Vec<Found> {
    let found = numbered(dev, "spidev").into_iter().filter_map(|path| {
        // As slow as the slowest of them needs it.
        let slowest = ChipKind::ALL
            .iter()
            .filter_map(|kind| kind.spi_hz())
            .min()?;
        match open_spi(&path, slowest) {
            Ok(mut device) => spi_chip(&mut device, &path),
            Err(error) => Some(Found::Unreadable {
                why: error.to_string(),
                path,
            }),
        }
    });
    found.collect()
}

/// The known chip that an SPI device is, if it is one; `path` is its own.
pub fn spi_chip<S: SpiDevice<Error: BusError>>(spi: &mut S, path: &Path) -> Option<Found> {
    let kinds = ChipKind::ALL.into_iter();
    let is_it = |kind: &ChipKind| {
        let Some((register, known)) = kind.identification().filter(|_| kind.spi_hz().is_some())
        else {
            return false;
        };
        let dummy_bytes = match kind {
            ChipKind::Bmp388 => bmp3::SPI_DUMMY_BYTES,
            _ => 0,
        };
        let mut bus = SpiBus::new(&mut *spi, "").with_dummy_bytes(dummy_bytes);
        // The first access tells some chips that they are on SPI.
        let _ = bus.value(register);
        bus.value(register)
            .is_ok_and(|found| known.contains(&found))
    };
    kinds.into_iter().find(is_it).map(|kind| Found::Chip {
        kind,
        wiring: Wiring::Spi {
            path: path.to_owned(),
        },
        is_certain: true,
    })
}
