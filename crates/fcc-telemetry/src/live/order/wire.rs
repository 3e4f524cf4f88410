//! Orders and answers as they lie in shared memory.

#![expect(unsafe_code, reason = "iceoryx2 asks for a promise about layouts")]

use iceoryx2::prelude::ZeroCopySend;

use super::super::Text;
use super::{FlightOrder, NewSetpoints, ORDERS_VERSION, Verdict};

/// An order as it lies in shared memory.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Request {
    /// [`ORDERS_VERSION`].
    pub(super) version: u32,
    /// 0 engage, 1 disengage, 2 stop, 3 set.
    pub(super) code: u32,
    /// NaN where it stays.
    pub(super) airspeed_mps: f64,
    /// NaN where it stays.
    pub(super) heading_rad: f64,
    /// NaN where it stays.
    pub(super) altitude_m: f64,
}

/// An answer as it lies in shared memory.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Answer {
    /// 0 carried out, 1 refused.
    pub(super) code: u32,
    /// [`ORDERS_VERSION`].
    pub(super) version: u32,
    /// The tick that read the order; 0 if none did.
    pub(super) tick: u64,
    /// Why it was refused.
    pub(super) text: Text<240>,
}

// SAFETY: repr(C), numbers only.
unsafe impl ZeroCopySend for Request {
    unsafe fn type_name() -> &'static str {
        "fcc.v1.Order"
    }
}

// SAFETY: repr(C), numbers and bytes only.
unsafe impl ZeroCopySend for Answer {
    unsafe fn type_name() -> &'static str {
        "fcc.v1.OrderAnswer"
    }
}

const ENGAGE: u32 = 0;
const DISENGAGE: u32 = 1;
const STOP: u32 = 2;
const SET: u32 = 3;

const CARRIED_OUT: u32 = 0;
const REFUSED: u32 = 1;

impl From<FlightOrder> for Request {
    fn from(order: FlightOrder) -> Self {
        let (code, set) = match order {
            FlightOrder::Engage => (ENGAGE, NewSetpoints::default()),
            FlightOrder::Disengage => (DISENGAGE, NewSetpoints::default()),
            FlightOrder::Stop => (STOP, NewSetpoints::default()),
            FlightOrder::Set(set) => (SET, set),
        };
        let number = |value: Option<f64>| value.unwrap_or(f64::NAN);
        Self {
            version: ORDERS_VERSION,
            code,
            airspeed_mps: number(set.airspeed_mps),
            heading_rad: number(set.heading_rad),
            altitude_m: number(set.altitude_m),
        }
    }
}

impl Request {
    /// What another program wrote may be anything.
    ///
    /// # Errors
    /// Why it is no order, in words.
    pub(super) fn order(&self) -> Result<FlightOrder, String> {
        if self.version != ORDERS_VERSION {
            return Err(format!(
                "the order is of version {}, and this daemon takes version {ORDERS_VERSION}: use \
                 the fccd that belongs to it",
                self.version
            ));
        }
        let given = |value: f64| (!value.is_nan()).then_some(value);
        let order = match self.code {
            ENGAGE => FlightOrder::Engage,
            DISENGAGE => FlightOrder::Disengage,
            STOP => FlightOrder::Stop,
            SET => FlightOrder::Set(NewSetpoints {
                airspeed_mps: given(self.airspeed_mps),
                heading_rad: given(self.heading_rad),
                altitude_m: given(self.altitude_m),
            }),
            other => return Err(format!("there is no order with the number {other}")),
        };
        order.check().map(|()| order)
    }
}

impl From<&Verdict> for Answer {
    fn from(verdict: &Verdict) -> Self {
        let (code, tick, text) = match verdict {
            Verdict::CarriedOut { tick } => (CARRIED_OUT, *tick, ""),
            Verdict::Refused(words) => (REFUSED, 0, words.as_str()),
        };
        Self {
            code,
            version: ORDERS_VERSION,
            tick,
            text: Text::new(text),
        }
    }
}

impl Answer {
    pub(super) fn verdict(&self) -> Verdict {
        if self.code == CARRIED_OUT {
            Verdict::CarriedOut { tick: self.tick }
        } else {
            Verdict::Refused(self.text.as_str().to_owned())
        }
    }
}

#[cfg(test)]
mod tests {
    use std::mem::offset_of;

    use proptest::prelude::*;

    use super::*;

    #[test]
    fn the_layouts_are_as_written_down() {
        assert_eq!((size_of::<Request>(), size_of::<Answer>()), (32, 256));
        assert_eq!(
            [
                offset_of!(Request, version),
                offset_of!(Request, code),
                offset_of!(Request, airspeed_mps),
                offset_of!(Request, heading_rad),
                offset_of!(Request, altitude_m),
            ],
            [0, 4, 8, 16, 24]
        );
        assert_eq!(
            [
                offset_of!(Answer, code),
                offset_of!(Answer, version),
                offset_of!(Answer, tick),
                offset_of!(Answer, text),
            ],
            [0, 4, 8, 16]
        );
    }

    #[test]
    fn orders_and_verdicts_come_back() {
        for order in [
            FlightOrder::Engage,
            FlightOrder::Disengage,
            FlightOrder::Stop,
            FlightOrder::Set(NewSetpoints {
                heading_rad: Some(1.5),
                ..NewSetpoints::default()
            }),
        ] {
            assert_eq!(Request::from(order).order(), Ok(order));
        }
        for verdict in [
            Verdict::CarriedOut { tick: 9 },
            Verdict::Refused("why".to_owned()),
        ] {
            assert_eq!(Answer::from(&verdict).verdict(), verdict);
        }
    }

    #[test]
    fn another_version_is_refused() {
        let mut request = Request::from(FlightOrder::Engage);
        request.version = 2;
        let words = request.order().unwrap_err();
        assert!(
            words.contains("version 2") && words.contains("version 1"),
            "{words}"
        );
    }

    proptest! {
        /// Nothing that lies in shared memory is an order that cannot be flown.
        #[test]
        fn any_bytes_are_an_order_or_refused(version in 0..3_u32, code in 0..6_u32, bits: [u64; 3]) {
            let [airspeed_mps, heading_rad, altitude_m] = bits.map(f64::from_bits);
            let request = Request { version, code, airspeed_mps, heading_rad, altitude_m };
            if let Ok(order) = request.order() {
                prop_assert!(order.check().is_ok());
            }
        }
    }
}
