//! The values of a struct as columns.

use fcc_core::framework::schema::{Field, Kind, Schema, Sink, Structure, Type, Value};

/// A column: one value of a struct.
#[derive(Clone, PartialEq, Debug)]
pub struct Column {
    /// Its name in tables and arrays, with the unit at the end.
    pub name: String,
    /// Its name in its struct; of a reading's value, the reading's.
    pub field: &'static str,
    /// Its path in the struct: `measurements.attitude.value.pitch_rad`.
    pub path: String,
    /// The numbers of the fields of this path, which identify it in a message.
    pub numbers: Vec<u32>,
    /// The path of the reading that contains it, if there is one.
    pub reading: Option<String>,
    /// Bytes from the struct's beginning.
    pub offset: usize,
    /// The kind of value.
    pub kind: Kind,
    /// What it means.
    pub meaning: String,
    /// Its unit; empty if it has none.
    pub unit: &'static str,
    /// The smallest and the largest value.
    pub range: Option<(f64, f64)>,
}

/// The values of a struct, in order.
pub fn columns<T: Schema>() -> Vec<Column> {
    collect::<T>(false)
}

/// The same, followed by the derived values.
pub(super) fn columns_and_derived<T: Schema>() -> Vec<Column> {
    collect::<T>(true)
}

/// The single values of a struct, in the order of its [`columns`].
#[derive(Clone, PartialEq, Debug, Default)]
pub struct Leaves {
    values: Vec<Value>,
}

impl Leaves {
    /// Replaces the values by those of a struct.
    pub fn take<T: Schema>(&mut self, of: &T) {
        self.values.clear();
        of.visit(self);
    }

    /// The values.
    pub fn as_slice(&self) -> &[Value] {
        &self.values
    }
}

impl Sink for Leaves {
    fn value(&mut self, _: &'static Field, value: Value) {
        self.values.push(value);
    }
}

fn collect<T: Schema>(derived: bool) -> Vec<Column> {
    let mut found = Vec::new();
    let root = Around {
        path: String::new(),
        offset: 0,
        field: T::ROOT,
        outer: None,
        quantity: "",
    };
    root.collect(derived, &mut found);
    found
}

/// A field and the structs that contain it.
struct Around<'a> {
    path: String,
    offset: usize,
    field: &'static Field,
    outer: Option<&'a Self>,
    /// In a reading: the name of the reading.
    quantity: &'static str,
}

impl Around<'_> {
    fn collect(&self, derived: bool, found: &mut Vec<Column>) {
        match self.field.of {
            Type::Leaf(kind) => found.push(self.column(kind)),
            Type::Struct(of) | Type::Choice(of) => {
                let more: &[Field] = if derived { of.derived } else { &[] };
                for field in of.fields.iter().chain(more) {
                    self.inner(of, field).collect(derived, found);
                }
            }
        }
    }

    fn inner(&self, of: &'static Structure, field: &'static Field) -> Around<'_> {
        let dot = if self.path.is_empty() { "" } else { "." };
        Around {
            path: format!("{}{dot}{}", self.path, field.name),
            offset: self.offset + field.offset,
            field,
            outer: Some(self),
            quantity: if of.is_reading { self.field.name } else { "" },
        }
    }

    fn column(&self, kind: Kind) -> Column {
        // A reading's value is described by the reading.
        let told_by = match self.outer {
            Some(reading) if self.is_value() => reading.field,
            _ => self.field,
        };
        let mut named = *told_by;
        named.of = Type::Leaf(kind);
        Column {
            name: self.name(),
            field: told_by.name,
            path: self.path.clone(),
            numbers: self.numbers(),
            reading: self.reading(),
            offset: self.offset,
            kind,
            meaning: super::meaning(told_by.meaning),
            unit: named.unit(),
            range: told_by.range,
        }
    }

    fn numbers(&self) -> Vec<u32> {
        let Some(outer) = self.outer else {
            return Vec::new();
        };
        let mut numbers = outer.numbers();
        numbers.push(self.field.number);
        numbers
    }

    fn reading(&self) -> Option<String> {
        let mut around = self.outer;
        while let Some(outer) = around {
            if let Type::Struct(of) = outer.field.of
                && of.is_reading
            {
                return Some(outer.path.clone());
            }
            around = outer.outer;
        }
        None
    }

    fn is_value(&self) -> bool {
        !self.quantity.is_empty() && self.field.name == "value"
    }

    /// Its name, qualified as the structs around it require.
    fn name(&self) -> String {
        let own = self.field.column.unwrap_or(self.field.name);
        let mut around = self.outer;
        let mut name = match self.field.of {
            // A reading's time is named after the reading; its value has the
            // reading's name.
            Type::Leaf(Kind::Instant) if !self.quantity.is_empty() => {
                let reading = around;
                around = reading.and_then(|reading| reading.outer);
                let quantity = reading.map_or("", |reading| reading.field.quantity());
                format!("{quantity}_{own}_ns")
            }
            Type::Leaf(Kind::Instant) => format!("{own}_ns"),
            _ if self.is_value() => self.quantity.to_owned(),
            _ if !self.quantity.is_empty() => {
                let reading = around;
                around = reading.and_then(|reading| reading.outer);
                let quantity = reading.map_or("", |reading| reading.field.quantity());
                format!("{quantity}_{own}")
            }
            _ => own.replace('*', self.field.name),
        };
        while let Some(outer) = around {
            if let Some(wanted) = outer.field.column {
                name = wanted.replace('*', &name);
            }
            around = outer.outer;
        }
        name
    }
}
