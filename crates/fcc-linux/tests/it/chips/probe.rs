//! What is found on a bus.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use embedded_hal::i2c::{ErrorType, I2c, Operation};
use fcc_linux::chip::{ChipKind, Wiring};
use fcc_linux::probe::{Found, chips, spi_chip};
use nix::errno::Errno;

use crate::chips::board::{Board, Fault};

/// A bus with chips: what each sends after what was written to it.
#[derive(Default)]
struct Bus {
    chips: BTreeMap<u8, BTreeMap<Vec<u8>, Vec<u8>>>,
    /// An address that a driver of the kernel has.
    taken: Option<u8>,
    written: Vec<Vec<u8>>,
}

impl ErrorType for Bus {
    type Error = Fault;
}

impl I2c for Bus {
    fn transaction(&mut self, address: u8, all: &mut [Operation<'_>]) -> Result<(), Fault> {
        if self.taken == Some(address) {
            return Err(Fault(Errno::EBUSY));
        }
        let chip = self.chips.get(&address).ok_or(Fault(Errno::EREMOTEIO))?;
        for operation in all {
            match operation {
                Operation::Write(bytes) => self.written.push(bytes.to_vec()),
                Operation::Read(into) => {
                    let after = self.written.last().cloned().unwrap_or_default();
                    let answer = chip.get(&after).cloned().unwrap_or_default();
                    for (place, byte) in into.iter_mut().zip(answer) {
                        *place = byte;
                    }
                }
            }
        }
        Ok(())
    }
}

fn at(address: u8) -> Wiring {
    Wiring::I2c {
        path: PathBuf::from("/dev/i2c-1"),
        address,
    }
}

fn found(bus: &mut Bus) -> Vec<Found> {
    chips(bus, Path::new("/dev/i2c-1"))
}

#[test]
fn chips_are_recognized_by_their_numbers() {
    let mut bus = Bus::default();
    let with = |register: u8, id: u8| BTreeMap::from([(vec![register], vec![id])]);
    bus.chips.insert(0x68, with(0x75, 0x47));
    bus.chips.insert(0x69, with(0x75, 0x71));
    // A BMP180 has nothing in register 0, by which a BMP388 is recognized.
    bus.chips.insert(0x77, with(0xD0, 0x55));
    // Another chip at an address of the list, and one that has no number.
    bus.chips.insert(0x76, with(0x00, 0x58));
    bus.chips.insert(0x28, BTreeMap::new());
    // SDP31: 0x03010101, with its checksums.
    let number = vec![0x03, 0x01, 0x9D, 0x01, 0x01, 0x44];
    bus.chips
        .insert(0x21, BTreeMap::from([(vec![0xE1, 0x02], number)]));
    bus.taken = Some(0x0D);
    let chip = |kind, address, is_certain| Found::Chip {
        kind,
        wiring: at(address),
        is_certain,
    };
    let expected = [
        Found::Taken { wiring: at(0x0D) },
        chip(ChipKind::Sdp3x, 0x21, true),
        chip(ChipKind::Ms4525do, 0x28, false),
        chip(ChipKind::Icm42688, 0x68, true),
        chip(ChipKind::Mpu6050, 0x69, true),
        chip(ChipKind::Bmp180, 0x77, true),
    ];
    assert_eq!(found(&mut bus), expected);
    assert_eq!(
        expected[3].entry().as_deref(),
        Some("[[sensor]]\nkind = \"icm42688\"\ni2c = \"/dev/i2c-1\"\naddress = 0x68\n")
    );
    assert_eq!(expected[0].entry(), None);
}

/// A register's number is one byte, and nothing but that is written to a chip
/// that has registers.
#[test]
fn nothing_is_changed_in_a_chip_with_registers() {
    let mut bus = Bus::default();
    for address in [0x0D, 0x68, 0x69, 0x76, 0x77] {
        bus.chips.insert(address, BTreeMap::new());
    }
    assert_eq!(found(&mut bus), []);
    assert!(bus.written.len() >= 7 && bus.written.iter().all(|bytes| bytes.len() == 1));
}

/// `WHO_AM_I` of an ICM-42688-P and of an MPU-9250, the number of a BMP390, and what
/// a line without a chip shows.
#[test]
fn a_chip_on_spi_is_recognized_by_its_number() {
    let path = Path::new("/dev/spidev0.0");
    for (registers, expected) in [
        ([(0x75, 0x47)], Some(ChipKind::Icm42688)),
        ([(0x75, 0x71)], Some(ChipKind::Mpu6050)),
        ([(0x00, 0x60)], Some(ChipKind::Bmp388)),
        ([(0x75, 0xFF)], None),
        ([(0x75, 0x00)], None),
    ] {
        let mut board = Board::with(&registers);
        let found = spi_chip(&mut board, path).map(|found| match found {
            Found::Chip {
                kind,
                wiring: Wiring::Spi { path: at },
                is_certain: true,
            } if at == path => kind,
            other => panic!("{other:?}"),
        });
        assert_eq!(found, expected, "{registers:x?}");
        assert_eq!(board.state().written, [] as [Vec<u8>; 0]);
    }
}
