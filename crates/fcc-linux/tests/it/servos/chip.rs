//! A PCA9685, by a stand-in for its registers.

use std::sync::{Arc, Mutex};

use embedded_hal::i2c::{ErrorType, I2c, Operation};
use fcc_linux::servo::{Pca9685, Pca9685Settings, PulseOutputs};
use nix::errno::Errno;

/// The registers of a PCA9685, which another test may look at; none if it is
/// unplugged.
#[derive(Clone, Default, Debug)]
struct Chip(Arc<Mutex<Option<Box<[u8; 256]>>>>);

impl Chip {
    /// As it is after it was switched on: table 4 of the data sheet.
    fn new() -> Self {
        let mut registers = [0; 256];
        (registers[0x00], registers[0x01], registers[0xfe]) = (0x11, 0x04, 0x1e);
        Self(Arc::new(Mutex::new(Some(Box::new(registers)))))
    }

    fn register(&self, at: usize) -> u8 {
        self.0
            .lock()
            .unwrap()
            .as_ref()
            .map_or(0, |registers| registers[at])
    }

    /// On and off, in counts.
    fn counts(&self, output: usize) -> [u16; 2] {
        let at = |at: usize| u16::from_le_bytes([self.register(at), self.register(at + 1)]);
        [at(6 + 4 * output), at(8 + 4 * output)]
    }
}

impl ErrorType for Chip {
    type Error = Refusal;
}

/// `EREMOTEIO`, as the operating system says it.
#[derive(Debug)]
struct Refusal;

impl embedded_hal::i2c::Error for Refusal {
    fn kind(&self) -> embedded_hal::i2c::ErrorKind {
        embedded_hal::i2c::ErrorKind::Other
    }
}

impl fcc_linux::chip::BusError for Refusal {
    fn into_io(self) -> std::io::Error {
        Errno::EREMOTEIO.into()
    }
}

impl I2c for Chip {
    fn transaction(
        &mut self,
        address: u8,
        operations: &mut [Operation<'_>],
    ) -> Result<(), Refusal> {
        let mut chip = self.0.lock().unwrap();
        let registers = chip.as_mut().filter(|_| address == 0x41).ok_or(Refusal)?;
        let mut at = 0;
        for operation in operations {
            match operation {
                Operation::Write([register, values @ ..]) => {
                    at = usize::from(*register);
                    for value in values {
                        // The rate is locked while it is awake (7.3.5).
                        if at != 0xfe || registers[0] & 0x10 != 0 {
                            registers[at] = *value;
                        }
                        at += 1;
                    }
                }
                Operation::Write([]) => {}
                Operation::Read(into) => {
                    into.fill_with(|| {
                        at += 1;
                        registers[at - 1]
                    });
                }
            }
        }
        Ok(())
    }
}

fn pca9685(rate_hz: f64) -> Pca9685Settings {
    Pca9685Settings {
        device: "/dev/i2c-1, address 0x41".into(),
        address: 0x41,
        rate_hz,
        oscillator_hz: 25e6,
        outputs: vec![0, 5],
    }
}

/// The data sheet's example in 7.3.5: 25 MHz and 200 Hz give 1Eh. 50 Hz give 79h,
/// 23.8 and 1,526 Hz the ends, `FFh` and 03h.
#[test]
fn the_prescale_value_is_that_of_the_data_sheet() {
    for (rate_hz, prescale) in [(200.0, 0x1e), (50.0, 0x79), (23.8, 0xff), (1_526.0, 0x03)] {
        let chip = Chip::new();
        Pca9685::open(chip.clone(), pca9685(rate_hz)).unwrap();
        assert_eq!(chip.register(0xfe), prescale, "{rate_hz} Hz");
        assert_eq!(chip.register(0x00), 0x20, "awake, AI");
        assert_eq!(chip.counts(5), [0, 0x1000], "off");
    }
}

/// At 50 Hz the divider is 122: a count is 122/25 MHz = 4.88 µs, so 1,500 µs are
/// 307.4 counts.
#[test]
fn pulses_are_written_to_the_registers_of_a_pca9685() {
    let chip = Chip::new();
    let mut servos = Pca9685::open(chip.clone(), pca9685(50.0)).unwrap();
    servos.write(&[Some(1_500.0), Some(2_000.0)]).unwrap();
    assert_eq!((chip.counts(0), chip.counts(5)), ([0, 307], [0, 410]));
    assert_eq!(chip.counts(1), [0, 0], "not used");
    servos.write(&[None, Some(2_000.0)]).unwrap();
    assert_eq!(chip.counts(0), [0, 0x1000], "off");
}

/// Nothing is changed but the pulses: a chip that slept for a moment would send none.
#[test]
fn a_chip_that_another_process_has_set_up_goes_on() {
    let chip = Chip::new();
    let mut first = Pca9685::open(chip.clone(), pca9685(50.0)).unwrap();
    first.write(&[Some(1_200.0), Some(2_000.0)]).unwrap();
    let mut second = Pca9685::of_another_process(chip.clone(), pca9685(50.0)).unwrap();
    assert_eq!(chip.counts(5), [0, 410], "the first one's pulse");
    second.write(&[Some(1_500.0), None]).unwrap();
    assert_eq!((chip.counts(0), chip.counts(5)), ([0, 307], [0, 0x1000]));
    // After it lost its power it is set up.
    let fresh = Chip::new();
    Pca9685::of_another_process(fresh.clone(), pca9685(50.0)).unwrap();
    assert_eq!(fresh.register(0xfe), 0x79);
}

#[test]
fn a_pca9685_that_does_not_answer_is_an_error() {
    let chip = Chip::default();
    let error = Pca9685::open(chip, pca9685(50.0)).unwrap_err();
    assert_eq!(
        error.to_string(),
        "/dev/i2c-1, address 0x41: writing: Remote I/O error (os error 121); nothing answers \
         there: check wiring, power and address"
    );
    let mut settings = pca9685(50.0);
    settings.outputs = vec![16];
    let error = Pca9685::open(Chip::new(), settings)
        .unwrap_err()
        .to_string();
    assert!(
        error.ends_with("it has no output 16: choose 0 to 15"),
        "{error}"
    );
}
