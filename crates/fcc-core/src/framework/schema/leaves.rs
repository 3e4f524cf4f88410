//! The schemas of single values, and of a reading of any of them.

use core::mem::{offset_of, size_of};

use super::{Field, Kind, Schema, Sink, Source, Structure, Type, Unknown, Value};
use crate::framework::{Flags, Reading, ReadingSet, Time};

/// Implements a type that is a single value: its conversion to a [`Value`] and
/// back.
macro_rules! leaf {
    ($type:ty, $kind:expr, $self:ident => $write:expr, $pattern:pat => $read:expr) => {
        impl Schema for $type {
            const TYPE: Type = Type::Leaf($kind);

            fn write<W: Sink>(&self, field: &'static Field, sink: &mut W) {
                let $self = *self;
                sink.value(field, $write);
            }

            fn read<R: Source>(
                &mut self,
                field: &'static Field,
                source: &mut R,
            ) -> Result<(), Unknown> {
                match source.value(field) {
                    Some($pattern) => {
                        *self = $read.ok_or(Unknown {
                            of: Self::TYPE,
                            field,
                        })?
                    }
                    Some(_) => {
                        return Err(Unknown {
                            of: Self::TYPE,
                            field,
                        });
                    }
                    None => {}
                }
                Ok(())
            }
        }
    };
}

leaf!(bool, Kind::Bool, v => Value::Bool(v), Value::Bool(v) => Some(v));
leaf!(Flags, Kind::Flags, v => Value::Flags(v.bits()), Value::Flags(v) => Some(Self::from_bits(v)));
leaf!(ReadingSet, Kind::Flags, v => Value::Flags(v.bits()), Value::Flags(v) => Some(Self::from_bits(v)));
leaf!(u8, Kind::Count(1), v => Value::Count(v.into()), Value::Count(v) => Self::try_from(v).ok());
leaf!(u16, Kind::Count(2), v => Value::Count(v.into()), Value::Count(v) => Self::try_from(v).ok());
leaf!(u32, Kind::Count(4), v => Value::Count(v.into()), Value::Count(v) => Self::try_from(v).ok());
leaf!(u64, Kind::Count(8), v => Value::Count(v), Value::Count(v) => Some(v));
leaf!(i32, Kind::Signed(4), v => Value::Signed(v.into()), Value::Signed(v) => Self::try_from(v).ok());
leaf!(i64, Kind::Signed(8), v => Value::Signed(v), Value::Signed(v) => Some(v));
leaf!(Time, Kind::Instant, v => Value::Instant(v.as_nanos()), Value::Instant(v) => Some(Self::from_nanos(v)));
leaf!(f64, Kind::Number, v => Value::Number(v), Value::Number(v) => Some(v));
// None is a NaN: a value of a fixed layout cannot be absent.
leaf!(Option<f64>, Kind::Number,
    v => Value::Number(v.unwrap_or(f64::NAN)), Value::Number(v) => Some(Some(v).filter(|v| !v.is_nan())));

/// Nothing: for a plant without set points, or a controller without commands.
impl Schema for () {
    const TYPE: Type = Type::Struct(&Structure {
        name: "Nothing",
        meaning: " Nothing.\n",
        fields: &[],
        derived: &[],
        is_reading: false,
        bytes: 0,
    });

    fn write<W: Sink>(&self, field: &'static Field, sink: &mut W) {
        sink.begin(field);
        sink.end(field);
    }

    fn read<R: Source>(&mut self, field: &'static Field, source: &mut R) -> Result<(), Unknown> {
        source.begin(field);
        source.end(field);
        Ok(())
    }
}

impl<T: Schema> Schema for Reading<T> {
    const TYPE: Type = Type::Struct(&Structure {
        name: "Reading",
        meaning: " A value, the time it was taken and the sensor it came from.\n",
        fields: Self::FIELDS,
        derived: &[],
        is_reading: true,
        bytes: size_of::<Self>(),
    });

    const FIELDS: &'static [Field] = &[
        Field {
            name: "value",
            number: 1,
            meaning: " The value; it means nothing where `taken` is never.\n",
            offset: offset_of!(Self, value),
            of: T::TYPE,
            ..Field::ROOT
        },
        Field {
            name: "taken",
            number: 2,
            meaning: " When it was taken.\n",
            offset: offset_of!(Self, taken),
            of: Time::TYPE,
            ..Field::ROOT
        },
        Field {
            name: "source",
            number: 3,
            meaning: " The place in the loop of the sensor that it came from, the first being 0.\n",
            offset: offset_of!(Self, source),
            of: u8::TYPE,
            ..Field::ROOT
        },
    ];

    fn write<W: Sink>(&self, field: &'static Field, sink: &mut W) {
        if let [value, taken, source] = Self::FIELDS {
            sink.begin(field);
            self.value.write(value, sink);
            self.taken.write(taken, sink);
            self.source.write(source, sink);
            sink.end(field);
        }
    }

    fn read<R: Source>(&mut self, field: &'static Field, source: &mut R) -> Result<(), Unknown> {
        if let [value, taken, place] = Self::FIELDS {
            source.begin(field);
            self.value.read(value, source)?;
            self.taken.read(taken, source)?;
            self.source.read(place, source)?;
            source.end(field);
        }
        Ok(())
    }
}
