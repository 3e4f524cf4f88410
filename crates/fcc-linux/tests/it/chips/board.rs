//! A stand-in for a chip: its registers, and a bus that it can be pulled out of.

use std::collections::{BTreeMap, VecDeque};
use std::sync::{Arc, Mutex, MutexGuard};

use embedded_hal::delay::DelayNs;
use embedded_hal::{i2c, spi};
use fcc_linux::chip::{BusError, I2cBus, SpiBus};
use nix::errno::Errno;

/// What the chip has.
#[derive(Debug, Default)]
pub(crate) struct State {
    pub(crate) registers: BTreeMap<u8, u8>,
    /// Registers whose bytes come from a queue, such as that of a FIFO.
    pub(crate) queues: BTreeMap<u8, VecDeque<u8>>,
    /// What is read without a register.
    pub(crate) answer: Vec<u8>,
    /// Registers that show another value after the first that is written.
    pub(crate) forgets: Option<u8>,
    /// What a register and the next ones have after a command.
    pub(crate) after: BTreeMap<Vec<u8>, (u8, Vec<u8>)>,
    pub(crate) written: Vec<Vec<u8>>,
    /// A register that is cleared when it is read.
    pub(crate) cleared_by_reading: Option<u8>,
    pub(crate) is_gone: bool,
    /// The first register that was chosen.
    chosen: Option<u8>,
    pub(crate) reads: u64,
}

/// A bus with that chip; every copy is the same.
#[derive(Clone, Debug, Default)]
pub(crate) struct Board(Arc<Mutex<State>>);

#[derive(Debug)]
pub(crate) struct Fault(pub(crate) Errno);

impl i2c::Error for Fault {
    fn kind(&self) -> i2c::ErrorKind {
        i2c::ErrorKind::Other
    }
}

impl spi::Error for Fault {
    fn kind(&self) -> spi::ErrorKind {
        spi::ErrorKind::Other
    }
}

impl BusError for Fault {
    fn into_io(self) -> std::io::Error {
        self.0.into()
    }
}

impl Board {
    pub(crate) fn with(registers: &[(u8, u8)]) -> Self {
        let board = Self::default();
        board.state().registers = registers.iter().copied().collect();
        board
    }

    pub(crate) fn state(&self) -> MutexGuard<'_, State> {
        self.0.lock().unwrap()
    }

    pub(crate) fn put(&self, from: u8, bytes: &[u8]) {
        let numbered = (from..).zip(bytes.iter().copied());
        self.state().registers.extend(numbered);
    }

    pub(crate) fn i2c(&self) -> I2cBus<Self> {
        I2cBus::new(self.clone(), "/dev/i2c-1", 0x68)
    }

    pub(crate) fn spi(&self, dummy_bytes: usize) -> SpiBus<Self> {
        SpiBus::new(self.clone(), "/dev/spidev0.0").with_dummy_bytes(dummy_bytes)
    }
}

impl State {
    fn write(&mut self, bytes: &[u8]) {
        self.written.push(bytes.to_vec());
        self.chosen = bytes.first().copied();
        if let [register, value] = *bytes {
            let kept = if self.forgets == Some(register) {
                0xEE
            } else {
                value
            };
            self.registers.insert(register, kept);
        }
        if let Some((from, bytes)) = self.after.get(bytes) {
            self.registers.extend((*from..).zip(bytes.iter().copied()));
        }
    }

    fn read(&mut self, into: &mut [u8]) {
        self.reads += 1;
        let Some(first) = self.chosen else {
            for (place, byte) in into.iter_mut().zip(&self.answer) {
                *place = *byte;
            }
            return;
        };
        for (register, place) in (first..).zip(into) {
            *place = match self.queues.get_mut(&first) {
                Some(queue) => queue.pop_front().unwrap_or(0),
                None => self.registers.get(&register).copied().unwrap_or(0),
            };
            if self.cleared_by_reading == Some(register) {
                self.registers.insert(register, 0);
            }
        }
    }
}

impl i2c::ErrorType for Board {
    type Error = Fault;
}

impl i2c::I2c for Board {
    fn transaction(
        &mut self,
        address: u8,
        operations: &mut [i2c::Operation<'_>],
    ) -> Result<(), Fault> {
        assert_eq!(address, 0x68);
        let mut state = self.state();
        if state.is_gone {
            return Err(Fault(Errno::EREMOTEIO));
        }
        state.chosen = None;
        for operation in operations {
            match operation {
                i2c::Operation::Write(bytes) => state.write(bytes),
                i2c::Operation::Read(into) => state.read(into),
            }
        }
        Ok(())
    }
}

impl spi::ErrorType for Board {
    type Error = Fault;
}

impl spi::SpiDevice for Board {
    /// A read has the highest bit of its register set; bytes after it are
    /// meaningless.
    fn transaction(&mut self, operations: &mut [spi::Operation<'_, u8>]) -> Result<(), Fault> {
        let mut state = self.state();
        if state.is_gone {
            return Err(Fault(Errno::EIO));
        }
        match operations {
            [spi::Operation::Write(bytes)] => state.write(bytes),
            [
                spi::Operation::Write([command]),
                spi::Operation::Write(_),
                spi::Operation::Read(into),
            ] => {
                assert!(command & 0x80 != 0, "{command:#x} is no read");
                state.chosen = Some(command & 0x7F);
                state.read(into);
            }
            other => panic!("{other:?}"),
        }
        Ok(())
    }
}

/// Waits not at all.
#[derive(Debug)]
pub(crate) struct NoDelay;

impl DelayNs for NoDelay {
    fn delay_ns(&mut self, _: u32) {}
}
