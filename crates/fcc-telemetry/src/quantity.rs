//! The quantities of a record: what is measured, estimated and desired under
//! one name, and what is commanded.

use fcc_core::framework::schema::{Kind, Schema};

use crate::schema::{Column, columns};

/// A quantity of a record: its places among the record's [`columns`].
#[derive(Clone, PartialEq, Debug)]
pub struct RecordedQuantity {
    /// Its first column.
    pub column: Column,
    /// The measured value; of several of one name the first.
    pub measured: Option<usize>,
    /// The time of the measurement.
    pub taken: Option<usize>,
    /// The estimate.
    pub estimated: Option<usize>,
    /// The set point.
    pub desired: Option<usize>,
    /// The output. It is a quantity of its own, even if a measurement has its
    /// name.
    pub commanded: Option<usize>,
}

impl RecordedQuantity {
    /// All quantities of a record: measurements, then estimates and set points
    /// that are not measured, then outputs; numbers, and what has a name for
    /// each of its values.
    pub fn all<T: Schema>() -> Vec<Self> {
        let columns = columns::<T>();
        let mut all: Vec<Self> = Vec::new();
        let is_shown =
            |column: &Column| matches!(column.kind, Kind::Number | Kind::Bool | Kind::Code(_));
        let columns_shown = columns.iter().enumerate();
        for (place, column) in columns_shown.filter(|(_, column)| is_shown(column)) {
            let mut quantity = Self::of(column);
            let Some(value) = quantity.value(&column.path) else {
                continue;
            };
            *value = Some(place);
            if let (Some(_), Some(reading)) = (quantity.measured, &column.reading) {
                let taken = format!("{reading}.taken");
                quantity.taken = columns.iter().position(|other| other.path == taken);
            }
            let is_output = quantity.commanded.is_some();
            let known = all.iter_mut().find(|known| {
                known.column.field == column.field && known.commanded.is_some() == is_output
            });
            match known {
                Some(known) => known.join(&quantity),
                None => all.push(quantity),
            }
        }
        all
    }

    fn of(column: &Column) -> Self {
        Self {
            column: column.clone(),
            measured: None,
            taken: None,
            estimated: None,
            desired: None,
            commanded: None,
        }
    }

    /// The place of the value at a path of the record.
    fn value(&mut self, path: &str) -> Option<&mut Option<usize>> {
        match path.split('.').next()? {
            "measurements" => Some(&mut self.measured),
            "estimate" => Some(&mut self.estimated),
            "setpoints" => Some(&mut self.desired),
            "outputs" => Some(&mut self.commanded),
            _ => None,
        }
    }

    fn join(&mut self, other: &Self) {
        if self.measured.is_none() {
            (self.measured, self.taken) = (other.measured, other.taken);
        }
        self.estimated = self.estimated.or(other.estimated);
        self.desired = self.desired.or(other.desired);
        self.commanded = self.commanded.or(other.commanded);
    }
}
