//! Drivers of chips, with a stand-in for the bus.

mod board;
mod conformance;
mod inertial;
mod pressure;
mod probe;

use fcc_linux::chip::qmc5883l::Qmc5883l;
use fcc_linux::chip::{Chip, Measurement};

use board::{Board, NoDelay};

fn measured(chip: &mut impl Chip) -> Measurement {
    chip.measure().unwrap().unwrap()
}

/// Registers 0 to 0x0D of a QMC5883L in a field of 1, -0.5 and 0.01 G: 3,000 LSB
/// are a gauss at ±8 G (QMC5883L, section 2).
#[test]
fn a_qmc5883l_measures_the_field() {
    let board = Board::with(&[(0x06, 1), (0x0D, 0xFF)]);
    board.put(0x00, &[0xB8, 0x0B, 0x24, 0xFA, 30, 0]);
    let mut chip = Qmc5883l::new(board.i2c(), &mut NoDelay).unwrap();
    assert_eq!(board.state().registers[&0x09], 0x1D);
    let [x, y, z] = measured(&mut chip).values.field_ut.unwrap();
    assert!((x - 100.0).abs() < 1e-9 && (y + 50.0).abs() < 1e-9 && (z - 1.0).abs() < 1e-9);
    board.put(0x06, &[0]);
    assert_eq!(chip.measure().unwrap(), None);
    board.put(0x06, &[3]);
    let beyond = chip.measure().unwrap_err().to_string();
    assert_eq!(
        beyond,
        "/dev/i2c-1, address 0x68: the field is beyond its range"
    );
}

#[test]
fn another_chip_is_recognized() {
    let board = Board::with(&[(0x0D, 0x10)]);
    let other = Qmc5883l::new(board.i2c(), &mut NoDelay).unwrap_err();
    assert_eq!(
        other.to_string(),
        "/dev/i2c-1, address 0x68: this is no QMC5883L, which has 0xff: its register 0x0d has \
         0x10; check `kind` and the address, `fccd probe` lists what is connected"
    );
}

#[test]
fn a_chip_that_forgets_its_settings_is_refused() {
    let board = Board::with(&[(0x0D, 0xFF)]);
    board.state().forgets = Some(0x09);
    let lost = Qmc5883l::new(board.i2c(), &mut NoDelay).unwrap_err();
    assert_eq!(
        lost.to_string(),
        "/dev/i2c-1, address 0x68: register 0x09 was set to 0x1d, and has 0xee: check its supply \
         and the wires"
    );
}

#[test]
fn a_chip_that_does_not_answer_is_an_error() {
    let board = Board::default();
    board.state().is_gone = true;
    let silent = Qmc5883l::new(board.i2c(), &mut NoDelay)
        .unwrap_err()
        .to_string();
    assert!(
        silent.ends_with("nothing answers there: check wiring, power and address"),
        "{silent}"
    );
}
