//! Records with arbitrary bits.

use fcc_core::framework::schema::{Field, Kind, Schema, Sink, Source, Type, Value};
use fcc_core::framework::{Cause, Flags, Record, State};
use proptest::prelude::*;

/// The bits of a record: comparing floats would treat -0 as 0, and NaN as
/// different from itself.
pub(crate) fn bits(record: &impl Schema) -> Vec<u64> {
    struct Bits(Vec<u64>);
    impl Sink for Bits {
        fn value(&mut self, _: &'static Field, value: Value) {
            self.0.push(value.bits());
        }
    }
    let mut bits = Bits(Vec::new());
    record.visit(&mut bits);
    bits.0
}

/// Numbers that file formats tend to change.
const NUMBERS: [f64; 7] = [
    0.0,
    -0.0,
    f64::NAN,
    f64::from_bits(0xfff8_0000_dead_beef),
    f64::from_bits(0x7ff0_0000_0000_0001),
    f64::INFINITY,
    f64::MIN_POSITIVE / 2.0,
];

/// Makes values from arbitrary bits: infinities, NaN with any payload, and
/// often one of [`NUMBERS`].
struct AnyBits {
    bits: std::vec::IntoIter<(u64, bool)>,
    /// Whether inside a state, for which not all bits are valid.
    in_state: bool,
}

impl Source for AnyBits {
    fn begin(&mut self, field: &'static Field) {
        self.in_state |= field.name == "state";
    }

    fn end(&mut self, field: &'static Field) {
        self.in_state &= field.name != "state";
    }

    fn value(&mut self, field: &'static Field) -> Option<Value> {
        let (bits, special) = self.bits.next().unwrap();
        let Type::Leaf(kind) = field.of else {
            panic!("{} is no single value", field.name)
        };
        match kind {
            _ if self.in_state => None,
            Kind::Bool => Some(Value::Bool(special)),
            Kind::Code(of) => {
                let variant = &of.variants[bits as usize % of.variants.len()];
                Some(Value::Code(variant.number))
            }
            Kind::Number if special => Some(Value::Number(NUMBERS[bits as usize % NUMBERS.len()])),
            Kind::Instant if special => Some(Value::Instant(i64::MIN)),
            kind => Value::from_bits(kind, bits),
        }
    }
}

fn any_state() -> impl Strategy<Value = State> {
    prop_oneof![
        Just(State::Standby),
        Just(State::Engaged),
        Just(State::Stopped),
        Just(State::Failsafe(Cause::InvalidOutput)),
        Just(State::Failsafe(Cause::Overrun)),
        any::<u64>().prop_map(|bits| State::Failsafe(Cause::Faults(Flags::from_bits(bits)))),
    ]
}

pub(crate) fn any_record<M: Schema, E: Schema, S: Schema, O: Schema>()
-> impl Strategy<Value = Record<M, E, S, O>> {
    let leaves = Record::<M, E, S, O>::TYPE.leaves();
    let bits = proptest::collection::vec(any::<(u64, bool)>(), leaves);
    (bits, any_state()).prop_map(|(bits, state)| {
        let mut source = AnyBits {
            bits: bits.into_iter(),
            in_state: false,
        };
        let mut record = Record::from_source(&mut source).unwrap();
        record.state = state.into();
        record
    })
}
