//! One drone and its client.

use core::time::Duration;

use crate::at::{Command, Malformed, Stick, commands};
use crate::limits::{Configured, Limits};
use crate::navdata::{self, Flight, NAVDATA_BYTES, Seen, bits};

/// Without a command for this long the link is lost: it hovers (developer guide, section 6.3).
const LOST_AFTER: Duration = Duration::from_secs(2);
/// So long after the last command it lands.
const LANDS_AFTER: Duration = Duration::from_secs(12);

/// What the client wants of the vehicle.
#[derive(Clone, Copy, PartialEq, Debug)]
pub enum Wanted {
    /// Land, or stay on the ground.
    Land,
    /// Take off, and hold the place.
    Hover,
    /// Take off, and follow the stick.
    Fly(Stick),
    /// Stop the motors at once: the emergency button.
    StopMotors,
}

/// A client's session.
#[derive(Clone, Debug)]
pub struct Session {
    configured: Configured,
    /// Of the last command that was carried out.
    sequence: u32,
    heard: Option<Duration>,
    flies: bool,
    stick: Option<Stick>,
    emergency: Emergency,
    is_acknowledged: bool,
    /// Only the state is sent until the client has configured what it wants.
    is_bootstrap: bool,
    sent: u32,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug, Default)]
struct Emergency {
    is_on: bool,
    is_pressed: bool,
}

impl Default for Session {
    fn default() -> Self {
        Self {
            configured: Configured::default(),
            sequence: 0,
            heard: None,
            flies: false,
            stick: None,
            emergency: Emergency::default(),
            is_acknowledged: false,
            is_bootstrap: true,
            sent: 0,
        }
    }
}

impl Session {
    /// Carries out the commands of a datagram that was received at a time since any instant.
    /// A command that is older than the last one has no effect; the numbers 0 and 1 begin anew.
    ///
    /// # Errors
    /// The first command that cannot be read; the others are carried out.
    pub fn read(&mut self, datagram: &[u8], now: Duration) -> Result<(), Malformed> {
        let mut wrong = Ok(());
        for command in commands(datagram) {
            match command {
                Ok((sequence, command)) if sequence <= 1 || sequence > self.sequence => {
                    self.sequence = sequence;
                    self.heard = Some(now);
                    self.carry_out(command);
                }
                Ok(_) => {}
                Err(error) => wrong = wrong.and(Err(error)),
            }
        }
        wrong
    }

    fn carry_out(&mut self, command: Command<'_>) {
        match command {
            Command::Buttons { flies, emergency } => {
                self.emergency.is_on ^= emergency && !self.emergency.is_pressed;
                self.emergency.is_pressed = emergency;
                self.flies = flies && !self.emergency.is_on;
            }
            Command::Move(stick) => self.stick = stick,
            Command::Configure { key, value } => {
                self.is_acknowledged = true;
                if key == "general:navdata_demo" {
                    self.is_bootstrap = false;
                }
                self.configured.set(key, value);
            }
            Command::Control(5) => self.is_acknowledged = false,
            Command::Control(_) | Command::Watchdog | Command::FlatTrim | Command::Other => {}
        }
    }

    /// What a full stick means.
    pub const fn limits(&self) -> Limits {
        self.configured.limits()
    }

    /// What is wanted at a time.
    pub fn wanted(&self, now: Duration) -> Wanted {
        let silent = self.silent(now);
        match self.stick {
            _ if self.emergency.is_on => Wanted::StopMotors,
            _ if !self.flies || silent > LANDS_AFTER => Wanted::Land,
            Some(stick) if silent <= LOST_AFTER => Wanted::Fly(stick),
            _ => Wanted::Hover,
        }
    }

    fn silent(&self, now: Duration) -> Duration {
        self.heard
            .map_or(Duration::MAX, |heard| now.saturating_sub(heard))
    }

    /// Writes the datagram that tells the client of the vehicle; its length.
    pub fn write(&mut self, seen: &Seen, now: Duration, to: &mut [u8; NAVDATA_BYTES]) -> usize {
        let is_lost = self.silent(now) > LOST_AFTER;
        let state = [
            (seen.flight != Flight::Landed, bits::FLIES),
            (true, bits::HOLDS_ALTITUDE | bits::THREADS | bits::DEMO),
            (self.is_acknowledged, bits::ACKNOWLEDGED),
            (self.is_bootstrap, bits::BOOTSTRAP),
            (is_lost, bits::LINK_LOST | bits::WATCHDOG),
            (
                100.0 * seen.battery < navdata::LOW_PERCENT,
                bits::BATTERY_LOW,
            ),
            (self.emergency.is_on, bits::EMERGENCY),
        ];
        let state = state.iter().filter(|(is_set, _)| *is_set);
        let state = state.fold(0, |state, (_, bit)| state | bit);
        self.sent = self.sent.wrapping_add(1);
        navdata::write(to, state, self.sent, seen)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const fn s(seconds: u64) -> Duration {
        Duration::from_secs(seconds)
    }

    fn after(texts: &[&str]) -> Session {
        let mut session = Session::default();
        for text in texts {
            session.read(text.as_bytes(), s(10)).unwrap();
        }
        session
    }

    #[test]
    fn it_takes_off_hovers_flies_and_lands() {
        let full = "AT*PCMD=12,1,1065353216,0,0,0\r";
        assert_eq!(Session::default().wanted(s(10)), Wanted::Land);
        assert_eq!(after(&["AT*REF=11,512\r"]).wanted(s(10)), Wanted::Hover);
        let Wanted::Fly(stick) = after(&["AT*REF=11,290718208\r", full]).wanted(s(10)) else {
            panic!("it does not fly");
        };
        assert!((stick.roll - 1.0).abs() < 1e-9);
        let landed = after(&["AT*REF=11,512\r", full, "AT*REF=13,290717696\r"]);
        assert_eq!(landed.wanted(s(10)), Wanted::Land);
    }

    #[test]
    fn a_silent_client_makes_it_hover_and_then_land() {
        let session = after(&["AT*REF=11,512\r", "AT*PCMD=12,1,1065353216,0,0,0\r"]);
        assert!(matches!(session.wanted(s(12)), Wanted::Fly(_)));
        assert_eq!(session.wanted(s(13)), Wanted::Hover);
        assert_eq!(session.wanted(s(23)), Wanted::Land);
    }

    #[test]
    fn old_commands_have_no_effect_and_a_client_begins_anew() {
        let mut session = after(&["AT*REF=11,512\r"]);
        session.read(b"AT*REF=10,0\rAT*REF=11,0\r", s(10)).unwrap();
        assert_eq!(session.wanted(s(10)), Wanted::Hover);
        session.read(b"AT*REF=1,0\r", s(10)).unwrap();
        assert_eq!(session.wanted(s(10)), Wanted::Land);
    }

    /// The button toggles, and is held for several commands.
    #[test]
    fn the_emergency_button_stops_the_motors_and_permits_them_again() {
        let mut session = after(&["AT*REF=11,512\r", "AT*REF=12,768\r", "AT*REF=13,768\r"]);
        assert_eq!(session.wanted(s(10)), Wanted::StopMotors);
        session.read(b"AT*REF=14,512\r", s(10)).unwrap();
        assert_eq!(session.wanted(s(10)), Wanted::StopMotors);
        session
            .read(b"AT*REF=15,256\rAT*REF=16,0\r", s(10))
            .unwrap();
        assert_eq!(session.wanted(s(10)), Wanted::Land);
    }

    fn sent(session: &mut Session) -> (usize, [u8; NAVDATA_BYTES]) {
        let mut bytes = [0; NAVDATA_BYTES];
        let seen = Seen {
            flight: Flight::Hovers,
            battery: 0.87,
            attitude_rad: [0.1, -0.2, 1.5],
            height_m: 1.25,
            velocity_mps: [0.5, -0.25, 0.0],
        };
        (session.write(&seen, s(10), &mut bytes), bytes)
    }

    fn word(bytes: &[u8], at: usize) -> u32 {
        u32::from_le_bytes(bytes[at..at + 4].try_into().unwrap())
    }

    /// State bits 6 and 11, as both clients wait for them.
    #[test]
    fn a_client_configures_it_by_the_handshake() {
        let mut session = after(&["AT*CTRL=1,5,0\r"]);
        let (length, bytes) = sent(&mut session);
        assert_eq!((length, word(&bytes, 4) >> 11 & 1), (24, 1));
        session
            .read(b"AT*CONFIG=2,\"general:navdata_demo\",\"TRUE\"\r", s(10))
            .unwrap();
        let (length, bytes) = sent(&mut session);
        assert_eq!(
            (length, word(&bytes, 4) >> 11 & 1, word(&bytes, 4) >> 6 & 1),
            (172, 0, 1)
        );
        session.read(b"AT*CTRL=3,5,0\r", s(10)).unwrap();
        let (_, bytes) = sent(&mut session);
        assert_eq!((word(&bytes, 4) >> 6 & 1, word(&bytes, 8)), (0, 3));
    }

    /// Offsets of `navdata_demo_t`, SDK 2.0.
    #[test]
    fn the_state_is_where_the_sdk_has_it() {
        let mut session = after(&["AT*CONFIG=2,\"general:navdata_demo\",\"TRUE\"\r"]);
        let (length, bytes) = sent(&mut session);
        assert_eq!(word(&bytes, 0), 0x5566_7788);
        assert_eq!((word(&bytes, 20) >> 16, word(&bytes, 24)), (4, 87));
        let float = |at| f32::from_bits(word(&bytes, at));
        assert!((float(28) + 11_459.156).abs() < 0.01);
        assert!((float(32) - 5_729.578).abs() < 0.01);
        assert_eq!(
            (word(&bytes, 40), float(44), float(48)),
            (1250, 500.0, -250.0)
        );
        let sum: u32 = bytes[..length - 8]
            .iter()
            .map(|byte| u32::from(*byte))
            .sum();
        assert_eq!(
            (word(&bytes, length - 8), word(&bytes, length - 4)),
            (0x0008_ffff, sum)
        );
    }
}
