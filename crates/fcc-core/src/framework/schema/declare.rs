//! The macro that declares the values of a type.

#[doc = include_str!("declare.md")]
#[macro_export]
macro_rules! schema {
    // What may be left out.
    (@some) => { ::core::option::Option::None };
    (@some $value:expr) => { ::core::option::Option::Some($value) };
    (@or $otherwise:expr;) => { $otherwise };
    (@or $otherwise:expr; $value:expr) => { $value };
    (@first $first:expr $(, $rest:expr)*) => { $first };

    // One field.
    (@field [$($doc:literal)*] $name:expr, $number:literal, [$($range:expr)?], [$($column:literal)?],
        $offset:expr, $of:expr) => {
        $crate::framework::schema::Field {
            name: $name,
            number: $number,
            meaning: concat!($($doc, "\n"),*),
            range: $crate::schema!(@some $($crate::framework::schema::bounds(&($range)))?),
            column: $crate::schema!(@some $($column)?),
            offset: $offset,
            of: $of,
        }
    };

    // What a variant holds.
    (@payload [$($doc:literal)*] $variant:ident; { $(
        [$($pdoc:literal)*] $pname:ident, $pnumber:literal, [$($prange:expr)?], $ptype:ty;
    )* }) => {
        $crate::framework::schema::Type::Struct(&$crate::framework::schema::Structure {
            name: stringify!($variant),
            meaning: concat!($($doc, "\n"),*),
            fields: &[$($crate::schema!(@field [$($pdoc)*] stringify!($pname), $pnumber, [$($prange)?], [],
                0, <$ptype as $crate::framework::schema::Schema>::TYPE)),*],
            derived: &[],
            is_reading: false,
            bytes: 0,
        })
    };
    (@payload [$($doc:literal)*] $variant:ident; $type:ty) => {
        <$type as $crate::framework::schema::Schema>::TYPE
    };
    (@payload [$($doc:literal)*] $variant:ident;) => {
        $crate::schema!(@payload [$($doc)*] $variant; {})
    };
    (@alone $visitor:ident $part:ident;) => {
        $visitor.begin($part);
        $visitor.end($part);
    };
    (@alone $visitor:ident $part:ident; $($held:tt)+) => {};

    // A struct.
    (
        $(#[doc = $doc:literal])*
        $(#[derive($($derive:ident),* $(,)?)])?
        $(#[name($called:literal)])?
        $(#[check($check:path)])?
        $vis:vis struct $name:ident $(<$($generic:ident),+>)? {
            $(
                $(#[doc = $fdoc:literal])*
                #[field($number:literal $(, range = $range:expr)? $(, column = $column:literal)?)]
                $fvis:vis $field:ident : $type:ty
            ),* $(,)?
        }
        $(
            $(#[doc = $ddoc:literal])*
            #[field($dnumber:literal)]
            derived $derived:ident = |$of:ident| $worked_out:expr;
        )*
    ) => {
        $(#[doc = $doc])*
        $(#[derive($($derive),*)])?
        #[repr(C)]
        $vis struct $name $(<$($generic),+>)? {
            $($(#[doc = $fdoc])* $fvis $field: $type),*
        }

        const _: () = assert!(
            $crate::framework::schema::are_distinct(&[$($number,)* $($dnumber,)*]),
            "the numbers of fields are 1 or more, and no two are the same"
        );

        impl $(<$($generic: $crate::framework::schema::Schema),+>)?
            $crate::framework::schema::Schema for $name $(<$($generic),+>)?
        {
            const TYPE: $crate::framework::schema::Type =
                $crate::framework::schema::Type::Struct(&$crate::framework::schema::Structure {
                    name: $crate::schema!(@or stringify!($name); $($called)?),
                    meaning: concat!($($doc, "\n"),*),
                    fields: Self::FIELDS,
                    derived: Self::DERIVED,
                    is_reading: false,
                    bytes: ::core::mem::size_of::<Self>(),
                });

            const FIELDS: &'static [$crate::framework::schema::Field] = &[$($crate::schema!(
                @field [$($fdoc)*] stringify!($field), $number, [$($range)?], [$($column)?],
                ::core::mem::offset_of!(Self, $field),
                <$type as $crate::framework::schema::Schema>::TYPE
            )),*];

            const DERIVED: &'static [$crate::framework::schema::Field] = &[$($crate::schema!(
                @field [$($ddoc)*] stringify!($derived), $dnumber, [], [], 0,
                <f64 as $crate::framework::schema::Schema>::TYPE
            )),*];

            fn write<W: $crate::framework::schema::Sink>(
                &self,
                field: &'static $crate::framework::schema::Field,
                sink: &mut W,
            ) {
                if let ([$($field),*], [$($derived),*]) = (Self::FIELDS, Self::DERIVED) {
                    sink.begin(field);
                    $($crate::framework::schema::Schema::write(&self.$field, $field, sink);)*
                    $({
                        let $of = self;
                        sink.derived($derived, $worked_out);
                    })*
                    sink.end(field);
                }
            }

            fn read<R: $crate::framework::schema::Source>(
                &mut self,
                field: &'static $crate::framework::schema::Field,
                source: &mut R,
            ) -> ::core::result::Result<(), $crate::framework::schema::Unknown> {
                if let [$($field),*] = Self::FIELDS {
                    source.begin(field);
                    $($crate::framework::schema::Schema::read(&mut self.$field, $field, source)?;)*
                    source.end(field);
                }
                $(if !$check(self) {
                    return ::core::result::Result::Err(
                        $crate::framework::schema::Unknown { of: Self::TYPE, field },
                    );
                })?
                ::core::result::Result::Ok(())
            }
        }
    };

    // An enum without data.
    (
        $(#[doc = $doc:literal])*
        $(#[name($called:literal)])?
        $vis:vis enum $name:ident {
            $(#[doc = $zdoc:literal])* $zero:ident = 0
            $(, $(#[doc = $vdoc:literal])* $variant:ident = $number:literal)* $(,)?
        }
    ) => {
        $(#[doc = $doc])*
        #[derive(Clone, Copy, PartialEq, Eq, Hash, Debug, Default)]
        #[repr(u8)]
        $vis enum $name {
            $(#[doc = $zdoc])*
            #[default]
            $zero = 0,
            $($(#[doc = $vdoc])* $variant = $number,)*
        }

        impl $name {
            /// From the number as stored; none for one that is not declared.
            #[allow(dead_code, unreachable_pub, reason = "not every enum is read by itself")]
            pub const fn from_number(number: u8) -> ::core::option::Option<Self> {
                match number {
                    0 => ::core::option::Option::Some(Self::$zero),
                    $($number => ::core::option::Option::Some(Self::$variant),)*
                    _ => ::core::option::Option::None,
                }
            }
        }

        impl $crate::framework::schema::Schema for $name {
            const TYPE: $crate::framework::schema::Type =
                $crate::framework::schema::Type::Leaf($crate::framework::schema::Kind::Code(
                    &$crate::framework::schema::Enumeration {
                        name: $crate::schema!(@or stringify!($name); $($called)?),
                        meaning: concat!($($doc, "\n"),*),
                        variants: &[
                            $crate::framework::schema::Variant {
                                name: stringify!($zero),
                                number: 0,
                                meaning: concat!($($zdoc, "\n"),*),
                            },
                            $($crate::framework::schema::Variant {
                                name: stringify!($variant),
                                number: $number,
                                meaning: concat!($($vdoc, "\n"),*),
                            }),*
                        ],
                    },
                ));

            fn write<W: $crate::framework::schema::Sink>(
                &self,
                field: &'static $crate::framework::schema::Field,
                sink: &mut W,
            ) {
                sink.value(field, $crate::framework::schema::Value::Code(*self as u8));
            }

            fn read<R: $crate::framework::schema::Source>(
                &mut self,
                field: &'static $crate::framework::schema::Field,
                source: &mut R,
            ) -> ::core::result::Result<(), $crate::framework::schema::Unknown> {
                if let ::core::option::Option::Some(value) = source.value(field) {
                    let known = match value {
                        $crate::framework::schema::Value::Code(number) => Self::from_number(number),
                        _ => ::core::option::Option::None,
                    };
                    *self = known.ok_or(
                        $crate::framework::schema::Unknown { of: Self::TYPE, field },
                    )?;
                }
                ::core::result::Result::Ok(())
            }
        }
    };

    // An enum that carries data.
    (
        $(#[doc = $doc:literal])*
        $(#[derive($($derive:ident),* $(,)?)])?
        $(#[name($called:literal)])?
        $(#[non_exhaustive $(@ $never:tt)?])?
        $vis:vis enum $name:ident $(<$($generic:ident),+>)? {
            $(
                $(#[doc = $vdoc:literal])*
                #[field($number:literal $(, range = $range:expr)?)]
                $variant:ident
                $(($payload:ident : $ptype:ty))?
                $({ $(
                    $(#[doc = $hdoc:literal])*
                    #[field($hnumber:literal $(, range = $hrange:expr)?)]
                    $held:ident : $htype:ty
                ),* $(,)? })?
            ),* $(,)?
        }
    ) => {
        $(#[doc = $doc])*
        $(#[derive($($derive),*)])?
        $(#[non_exhaustive] $($never)?)?
        $vis enum $name $(<$($generic),+>)? {
            $(
                $(#[doc = $vdoc])*
                $variant $(($ptype))? $({ $($(#[doc = $hdoc])* $held: $htype),* })?
            ),*
        }

        const _: () = assert!(
            $crate::framework::schema::are_distinct(&[$($number,)*]),
            "the numbers of variants are 1 or more, and no two are the same"
        );

        impl $(<$($generic: ::core::default::Default),+>)? ::core::default::Default for $name
            $(<$($generic),+>)?
        {
            fn default() -> Self {
                $crate::schema!(@first $(
                    Self::$variant
                    $((<$ptype as ::core::default::Default>::default()))?
                    $({ $($held: <$htype as ::core::default::Default>::default()),* })?
                ),*)
            }
        }

        impl $(<$($generic: $crate::framework::schema::Schema),+>)?
            $crate::framework::schema::Schema for $name $(<$($generic),+>)?
        {
            const TYPE: $crate::framework::schema::Type =
                $crate::framework::schema::Type::Choice(&$crate::framework::schema::Structure {
                    name: $crate::schema!(@or stringify!($name); $($called)?),
                    meaning: concat!($($doc, "\n"),*),
                    fields: Self::FIELDS,
                    derived: &[],
                    is_reading: false,
                    bytes: ::core::mem::size_of::<Self>(),
                });

            const FIELDS: &'static [$crate::framework::schema::Field] = &[$($crate::schema!(
                @field [$($vdoc)*]
                $crate::schema!(@or stringify!($variant); $(stringify!($payload))?),
                $number, [$($range)?], [], 0,
                $crate::schema!(@payload [$($vdoc)*] $variant;
                    $($ptype)?
                    $({ $([$($hdoc)*] $held, $hnumber, [$($hrange)?], $htype;)* })?)
            )),*];

            fn write<W: $crate::framework::schema::Sink>(
                &self,
                field: &'static $crate::framework::schema::Field,
                sink: &mut W,
            ) {
                sink.begin(field);
                match self {
                    $(Self::$variant $(($payload))? $({ $($held),* })? => {
                        if let ::core::option::Option::Some(part) =
                            $crate::framework::schema::numbered(Self::FIELDS, $number)
                        {
                            $crate::schema!(@alone sink part; $($payload)? $({ $($held)* })?);
                            $($crate::framework::schema::Schema::write($payload, part, sink);)?
                            $(
                                sink.begin(part);
                                let mut inner = $crate::framework::schema::inner(part);
                                $(if let ::core::option::Option::Some(inner) = inner.next() {
                                    $crate::framework::schema::Schema::write($held, inner, sink);
                                })*
                                sink.end(part);
                            )?
                        }
                    })*
                }
                sink.end(field);
            }

            fn read<R: $crate::framework::schema::Source>(
                &mut self,
                field: &'static $crate::framework::schema::Field,
                source: &mut R,
            ) -> ::core::result::Result<(), $crate::framework::schema::Unknown> {
                let unknown = $crate::framework::schema::Unknown { of: Self::TYPE, field };
                source.begin(field);
                match source.variant(field) {
                    $(::core::option::Option::Some($number) => {
                        let part = $crate::framework::schema::numbered(Self::FIELDS, $number)
                            .ok_or(unknown)?;
                        $crate::schema!(@alone source part; $($payload)? $({ $($held)* })?);
                        $(
                            let mut $payload = <$ptype as ::core::default::Default>::default();
                            $crate::framework::schema::Schema::read(&mut $payload, part, source)?;
                        )?
                        $(
                            source.begin(part);
                            let mut inner = $crate::framework::schema::inner(part);
                            $(
                                let mut $held = <$htype as ::core::default::Default>::default();
                                if let ::core::option::Option::Some(inner) = inner.next() {
                                    $crate::framework::schema::Schema::read(
                                        &mut $held, inner, source,
                                    )?;
                                }
                            )*
                            source.end(part);
                        )?
                        *self = Self::$variant $(($payload))? $({ $($held),* })?;
                    })*
                    _ => return ::core::result::Result::Err(unknown),
                }
                source.end(field);
                ::core::result::Result::Ok(())
            }
        }
    };
}
