//! What is connected to this machine, and how a configuration reads it.

use std::path::Path;

use fcc_linux::iio::{Quantity, Roots};
use fcc_linux::probe::{Found, probe};
use serde::Serialize;

/// Something that is connected, or a reason why that is not known.
#[derive(Clone, PartialEq, Eq, Debug, Serialize)]
pub struct Connected {
    /// Where: a bus and an address, or a device of the kernel.
    pub at: String,
    /// What it is.
    pub name: String,
    /// What it measures, or what is to be known of it.
    pub remark: String,
    /// The lines of a configuration that read it; none if it cannot be read.
    pub entry: Option<String>,
}

/// Looks at the devices under a root folder, `/` of this machine.
pub fn connected(root: &Path) -> Vec<Connected> {
    let roots = Roots {
        sysfs: root.join("sys/bus/iio/devices"),
        dev: root.join("dev"),
    };
    probe(&roots).iter().map(described).collect()
}

fn described(found: &Found) -> Connected {
    let entry = found.entry();
    let (at, name, remark) = match found {
        Found::Chip {
            kind,
            wiring,
            is_certain,
        } => {
            let measures = kind.measures().to_owned();
            let remark = if *is_certain {
                measures
            } else {
                format!("{measures}, if it is one: something answers at its address")
            };
            (wiring.to_string(), kind.name().to_owned(), remark)
        }
        Found::Iio {
            node,
            name,
            quantities,
            ..
        } => {
            let all: Vec<_> = quantities.iter().copied().map(Quantity::shown).collect();
            (node.clone(), name.clone(), all.join(", "))
        }
        Found::Taken { wiring } => (
            wiring.to_string(),
            "a driver of the kernel has it".to_owned(),
            "is listed as iio:device if it measures".to_owned(),
        ),
        Found::Unreadable { path, why } => (
            path.display().to_string(),
            "cannot be searched".to_owned(),
            why.clone(),
        ),
    };
    Connected {
        at,
        name,
        remark,
        entry,
    }
}
