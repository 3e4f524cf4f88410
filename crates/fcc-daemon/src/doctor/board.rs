//! Which board it is, and where its kernel's command line is kept.

use super::machine::Machine;
use super::{Finding, Grade};

/// What is told about the board.
#[derive(Debug)]
pub(super) struct Board {
    /// `Raspberry Pi 4 Model B Rev 1.4`; empty if it does not say.
    pub(super) name: String,
    /// The file that the kernel's command line is made from.
    command_line: &'static str,
    /// How a word gets into that file.
    style: Style,
    /// Whether a Raspberry Pi runs Debian and not its maker's Raspberry Pi OS.
    is_plain_debian: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Style {
    /// The file is the command line.
    Bare,
    /// A variable holds it.
    Variable(&'static str),
}

impl Board {
    pub(super) fn of(machine: &Machine) -> Self {
        let tree = machine.text("proc/device-tree/model");
        let dmi = |name| machine.text(&format!("sys/class/dmi/id/{name}"));
        let name = tree.unwrap_or_else(|| {
            [dmi("sys_vendor"), dmi("product_name")]
                .into_iter()
                .flatten()
                .collect::<Vec<_>>()
                .join(" ")
        });
        // Debian's own system for the board writes cmdline.txt anew from this.
        let is_plain_debian = machine.exists("etc/default/raspi-firmware");
        let (command_line, style) = if name.contains("Raspberry Pi") && is_plain_debian {
            ("/etc/default/raspi-extra-cmdline", Style::Bare)
        } else if name.contains("Raspberry Pi") {
            // Before Debian 12 it was in /boot itself.
            let new = "boot/firmware/cmdline.txt";
            let old = !machine.exists(new) && machine.exists("boot/cmdline.txt");
            let file = if old {
                "/boot/cmdline.txt"
            } else {
                "/boot/firmware/cmdline.txt"
            };
            (file, Style::Bare)
        } else if name.contains("BeagleBo") || name.contains("AM335x") {
            ("/boot/uEnv.txt", Style::Variable("cmdline="))
        } else {
            (
                "/etc/default/grub, then update-grub",
                Style::Variable("GRUB_CMDLINE_LINUX="),
            )
        };
        Self {
            name,
            command_line,
            style,
            is_plain_debian,
        }
    }

    /// Says what to add to the kernel's command line.
    pub(super) fn kernel_option(&self, finding: Finding, words: &str) -> Finding {
        let line = match self.style {
            Style::Bare => format!("at the end of its only line: {words}"),
            Style::Variable(name) => format!("at the end of {name}: {words}"),
        };
        finding.remedy(self.command_line, line)
    }

    pub(super) const fn is_plain_debian(&self) -> bool {
        self.is_plain_debian
    }

    pub(super) fn is_raspberry_pi(&self) -> bool {
        self.name.contains("Raspberry Pi")
    }
}

/// Something that the machine does not tell.
pub(super) fn not_told(id: &'static str, name: &'static str, words: &str) -> Finding {
    Finding::new(id, name, Grade::NotKnown, words)
}
