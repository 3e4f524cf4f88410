//! Servos: another program drives them by pulses. It receives messages of five
//! numbers of two bytes: 1 to drive or 0 to let the pilot's receiver drive,
//! then the pulse widths of throttle, elevator, aileron and rudder in µs.

use std::os::unix::net::{SocketAddr, UnixDatagram};

use fcc_conformance::{ActuatorBench, VanishingPlant, actuator_conformance};
use fcc_core::flight::Surfaces;
use fcc_core::framework::{Actuator, ActuatorFault, Tick};

use super::{address, errno};

const MESSAGE_BYTES: usize = 10;
/// A servo's middle position, and its travel to either side.
const MIDDLE_US: f64 = 1_500.0;
const TRAVEL_US: f64 = 500.0;

struct ServoBoard {
    socket: UnixDatagram,
    board: SocketAddr,
    is_held: bool,
}

impl ServoBoard {
    fn new(board: SocketAddr) -> std::io::Result<Self> {
        let socket = UnixDatagram::unbound()?;
        socket.set_nonblocking(true)?;
        Ok(Self {
            socket,
            board,
            is_held: false,
        })
    }

    fn send(&self, drive: bool, surfaces: &Surfaces) -> Result<(), ActuatorFault> {
        match self
            .socket
            .send_to_addr(&message(drive, surfaces), &self.board)
        {
            Ok(_) => Ok(()),
            Err(error) => Err(ActuatorFault::Io {
                errno: errno(&error),
            }),
        }
    }
}

impl Actuator<Surfaces> for ServoBoard {
    fn apply(&mut self, _: &Tick, surfaces: &Surfaces) -> Result<(), ActuatorFault> {
        // Set before sending: a message that may have arrived must be released.
        self.is_held = true;
        self.send(true, surfaces)
    }

    fn release(&mut self) -> Result<(), ActuatorFault> {
        if self.is_held {
            // One message centres the surfaces and releases control.
            self.send(false, &Surfaces::default())?;
            self.is_held = false;
        }
        Ok(())
    }

    fn name(&self) -> &'static str {
        "servo board"
    }
}

fn message(drive: bool, surfaces: &Surfaces) -> [u8; MESSAGE_BYTES] {
    let centred_us = |deflection: f64| (MIDDLE_US + TRAVEL_US * deflection).round() as u16;
    let numbers = [
        u16::from(drive),
        // Idle is at one end.
        centred_us(2.0 * surfaces.throttle - 1.0),
        centred_us(surfaces.elevator),
        centred_us(surfaces.aileron),
        centred_us(surfaces.rudder),
    ];
    let mut message = [0; MESSAGE_BYTES];
    for (bytes, number) in message.chunks_exact_mut(2).zip(numbers) {
        bytes.copy_from_slice(&number.to_le_bytes());
    }
    message
}

/// The program that drives the servos.
struct Bench {
    actuator: ServoBoard,
    at: SocketAddr,
    socket: Option<UnixDatagram>,
    last: [u8; MESSAGE_BYTES],
    messages: u64,
}

impl Bench {
    fn listen(&mut self) {
        let socket = UnixDatagram::bind_addr(&self.at).unwrap();
        socket.set_nonblocking(true).unwrap();
        self.socket = Some(socket);
    }

    fn receive(&mut self) {
        let Some(socket) = &self.socket else { return };
        while let Ok(length) = socket.recv(&mut self.last) {
            assert_eq!(length, MESSAGE_BYTES);
            self.messages += 1;
        }
    }
}

impl ActuatorBench for Bench {
    type Outputs = Surfaces;

    fn new() -> Self {
        let at = address();
        let mut bench = Self {
            actuator: ServoBoard::new(at.clone()).unwrap(),
            at,
            socket: None,
            last: message(false, &Surfaces::default()),
            messages: 0,
        };
        bench.listen();
        bench
    }

    fn actuator(&mut self) -> &mut dyn Actuator<Surfaces> {
        &mut self.actuator
    }

    fn outputs(number: u32) -> Surfaces {
        let share = f64::from(number % 10 + 1) * 0.1;
        Surfaces {
            throttle: share,
            elevator: share,
            aileron: -share,
            rudder: 0.5 * share,
            ..Surfaces::IDLE
        }
    }

    fn live(&mut self, _: &Tick) {
        self.receive();
    }

    fn is_held(&mut self) -> bool {
        self.receive();
        self.last.first() == Some(&1)
    }

    fn follows(&mut self, surfaces: &Surfaces) -> bool {
        self.receive();
        self.last == message(true, surfaces)
    }

    fn messages(&mut self) -> u64 {
        self.receive();
        self.messages
    }
}

impl VanishingPlant for Bench {
    /// The kernel reports at once that there is no receiver.
    const PATIENCE: usize = 0;
    const BACK_AFTER: usize = 1;

    fn vanish(&mut self) {
        self.receive();
        self.socket = None;
    }

    fn come_back(&mut self) {
        self.listen();
    }
}

actuator_conformance!(servo_board: Bench, vanishes);

/// As servos require: 1 ms to 2 ms, the middle at 1.5 ms.
#[test]
fn deflections_become_pulses() {
    let surfaces = Surfaces {
        throttle: 1.0,
        elevator: -1.0,
        aileron: 0.5,
        rudder: 0.0,
        ..Surfaces::IDLE
    };
    let numbers: [u16; 5] = [1, 2_000, 1_000, 1_750, 1_500];
    let bytes: Vec<u8> = numbers.iter().flat_map(|n| n.to_le_bytes()).collect();
    assert_eq!(message(true, &surfaces).to_vec(), bytes);
}
