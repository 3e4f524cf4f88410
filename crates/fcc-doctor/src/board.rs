//! The board, and where its kernel's command line is configured.

use super::Finding;
use super::machine::Machine;

/// The board.
#[derive(Debug)]
pub(super) struct Board {
    /// `Raspberry Pi 4 Model B Rev 1.4`; empty if unknown.
    pub(super) name: String,
    /// The file that gives the kernel's command line.
    command_line: &'static str,
    /// How an option is added to that file.
    style: Style,
    /// Whether a Raspberry Pi runs Debian and not Raspberry Pi OS.
    is_plain_debian: bool,
}

#[derive(Clone, Copy, PartialEq, Eq, Debug)]
enum Style {
    /// The file contains only the command line.
    Bare,
    /// A variable contains it.
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
        // Debian's own system for the board generates cmdline.txt from this.
        let is_plain_debian = machine.exists("etc/default/raspi-firmware");
        let (command_line, style) = if name.contains("Raspberry Pi") && is_plain_debian {
            ("/etc/default/raspi-extra-cmdline", Style::Bare)
        } else if name.contains("Raspberry Pi") {
            // Before Debian 12 it was in /boot.
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

    /// Adds the remedy: an option of the kernel's command line.
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
