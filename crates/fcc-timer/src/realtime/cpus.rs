//! Choosing the CPU for a loop.
//!
//! `/sys` lists the CPUs that the kernel keeps other threads away from, and
//! `/proc` which of them handle device interrupts. The formats differ between
//! kernels: what cannot be parsed is treated as unknown. Files are read under a
//! root folder, `/` except in tests.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// More CPUs than any machine that a loop runs on: a list with more is invalid.
const MOST_CPUS: usize = 8_192;
/// A CPU that handles less than this part of the busiest one's interrupts is
/// considered free of them; a smaller difference may be chance.
const MUCH_LESS: u64 = 4;

/// A CPU, and why it is the best.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct BestCpu {
    /// Its number, from 0.
    pub cpu: usize,
    /// Why a loop is best kept there, in words.
    pub because: String,
}

/// The CPUs of a machine.
#[derive(Clone, PartialEq, Eq, Debug, Default)]
pub struct Cpus {
    /// Those that run threads.
    pub online: BTreeSet<usize>,
    /// Those that no thread runs on unless it asks (`isolcpus=`).
    pub isolated: BTreeSet<usize>,
    /// Those without a periodic tick of the kernel (`nohz_full=`).
    pub tickless: BTreeSet<usize>,
    /// Those that interrupts go to unless somebody says otherwise; empty if
    /// not known.
    pub interrupted_by_default: BTreeSet<usize>,
    /// Device interrupts since the machine started, by CPU; empty if unknown.
    pub device_interrupts: Vec<(usize, u64)>,
}

impl Cpus {
    /// Reads the files under `root`.
    pub fn read(root: &Path) -> Self {
        let text = |path: &str| fs::read_to_string(root.join(path)).unwrap_or_default();
        let list = |name: &str| parse_list(&text(&format!("sys/devices/system/cpu/{name}")));
        Self {
            online: list("online"),
            isolated: list("isolated"),
            tickless: list("nohz_full"),
            interrupted_by_default: parse_mask(&text("proc/irq/default_smp_affinity")),
            device_interrupts: parse_interrupts(&text("proc/interrupts")),
        }
    }

    /// The best CPU for a thread that may run on `allowed`, or an isolated one.
    /// `may_use` returns whether the kernel permits it.
    /// This is what [`CpuRequest::Auto`](super::CpuRequest::Auto) chooses.
    ///
    /// # Errors
    /// Why none is better than the others, in words.
    pub fn best(
        &self,
        allowed: &[usize],
        may_use: impl Fn(usize) -> bool,
    ) -> Result<BestCpu, String> {
        let is_tickless = |cpu: &usize| self.tickless.contains(cpu);
        let of_isolated = || self.isolated.iter().rev().copied();
        if let Some(cpu) = of_isolated()
            .filter(is_tickless)
            .chain(of_isolated())
            .filter(|cpu| self.online.is_empty() || self.online.contains(cpu))
            .find(|&cpu| may_use(cpu))
        {
            return Ok(BestCpu {
                cpu,
                because: "it is isolated: no other thread runs on it".to_owned(),
            });
        }
        if allowed.len() < 2 {
            return Err("there is no other to choose from".to_owned());
        }
        if !self.interrupted_by_default.is_empty()
            && let Some(&cpu) = allowed
                .iter()
                .rev()
                .find(|cpu| !self.interrupted_by_default.contains(cpu))
        {
            return Ok(BestCpu {
                cpu,
                because: "interrupts are kept off it (default_smp_affinity)".to_owned(),
            });
        }
        let counts: Vec<_> = self
            .device_interrupts
            .iter()
            .filter(|(cpu, _)| allowed.contains(cpu))
            .collect();
        let busiest = counts.iter().max_by_key(|(_, count)| *count);
        let calmest = counts.iter().rev().min_by_key(|(_, count)| *count);
        match (busiest, calmest) {
            (Some((busy, most)), Some((calm, least)))
                if least.saturating_mul(MUCH_LESS) < *most =>
            {
                Ok(BestCpu {
                    cpu: *calm,
                    because: format!(
                        "it handled {least} device interrupts since the start, CPU {busy} {most}"
                    ),
                })
            }
            (Some(_), Some(_)) => Err("interrupts are spread over all of them".to_owned()),
            _ => Err("/proc/interrupts does not show which CPU handles the interrupts".to_owned()),
        }
    }
}

/// A list of CPUs as the kernel writes it: `0-1,3`. Empty if it is none.
pub fn parse_list(text: &str) -> BTreeSet<usize> {
    let mut cpus = BTreeSet::new();
    for part in text.trim().split(',').filter(|part| !part.is_empty()) {
        let (first, last) = part.split_once('-').unwrap_or((part, part));
        // `0-7:2/4` chooses from a range: no file that is read here has that.
        let (Ok(first), Ok(last)) = (first.trim().parse::<usize>(), last.trim().parse()) else {
            return BTreeSet::new();
        };
        if last >= MOST_CPUS {
            return BTreeSet::new();
        }
        cpus.extend(first..=last);
    }
    cpus
}

/// A mask of CPUs as the kernel writes it, in words of 32 bits: `3`,
/// `ff,ffffffff`. Empty if it is none.
pub fn parse_mask(text: &str) -> BTreeSet<usize> {
    let mut cpus = BTreeSet::new();
    for (word, digits) in text.trim().rsplit(',').enumerate().take(MOST_CPUS / 32) {
        let Ok(bits) = u32::from_str_radix(digits, 16) else {
            return BTreeSet::new();
        };
        cpus.extend(
            (0..32)
                .filter(|bit| bits & (1 << bit) != 0)
                .map(|bit| 32 * word + bit),
        );
    }
    cpus
}

/// Interrupts of devices, CPU by CPU, from `/proc/interrupts`.
pub fn parse_interrupts(text: &str) -> Vec<(usize, u64)> {
    let mut totals: Vec<(usize, u64)> =
        parse_header(text).into_iter().map(|cpu| (cpu, 0)).collect();
    for device in parse_devices(text) {
        for ((_, total), (_, count)) in totals.iter_mut().zip(device.counts) {
            *total = total.saturating_add(count);
        }
    }
    totals
}

/// The interrupt of a device, or of several that share it.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct DeviceInterrupt {
    /// Its number, as in `/proc/irq`.
    pub number: u32,
    /// Its device: `eth0`.
    pub name: String,
    /// How often it came since the machine started, CPU by CPU.
    pub counts: Vec<(usize, u64)>,
}

/// The devices of `/proc/interrupts`: the rows whose name is a number. The
/// others belong to the CPUs: their timers and their interrupts of each other.
pub fn parse_devices(text: &str) -> Vec<DeviceInterrupt> {
    let cpus = parse_header(text);
    let row = |line: &str| {
        let (number, rest) = line.split_once(':')?;
        let rest = rest.trim_end();
        // On ARM, and on old x86, the clocks of the CPUs have numbers too.
        if rest.ends_with("timer") {
            return None;
        }
        let counts = rest.split_whitespace().map_while(|word| word.parse().ok());
        Some(DeviceInterrupt {
            number: number.trim().parse().ok()?,
            // Two spaces are before it, and one at most in it.
            name: rest
                .rsplit("  ")
                .next()
                .unwrap_or_default()
                .trim()
                .to_owned(),
            counts: cpus.iter().copied().zip(counts).collect(),
        })
    };
    text.lines().skip(1).filter_map(row).collect()
}

/// The CPUs that `/proc/interrupts` has columns of.
fn parse_header(text: &str) -> Vec<usize> {
    let header = text.lines().next().unwrap_or_default();
    header
        .split_whitespace()
        .map_while(|name| name.strip_prefix("CPU")?.parse().ok())
        .take(MOST_CPUS)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    // As a Raspberry Pi 4 writes it: all devices on the first CPU.
    const PI_4: &str = "           CPU0       CPU1       CPU2       CPU3       \n\
         \x20 9:          0          0          0          0     GICv2  25 Level     vgic\n\
         \x2011:    3031286    1287391    1127402     992338     GICv2  30 Level     arch_timer\n\
         \x2018:       1452          0          0          0     GICv2  65 Level     fe00b880.mailbox\n\
         \x2040:    9483302          0          0          0     GICv2 189 Level     eth0\n\
         IPI0:     23433      71277      68128      68441       Rescheduling interrupts\n\
         Err:          0\n";

    fn set(cpus: &[usize]) -> BTreeSet<usize> {
        cpus.iter().copied().collect()
    }

    // The format is that of the kernel's admin-guide/cputopology and
    // core-api/irq/irq-affinity.
    #[test]
    fn lists_and_masks_are_read_as_the_kernel_writes_them() {
        assert_eq!(parse_list("0-1,3\n"), set(&[0, 1, 3]));
        assert_eq!(parse_list("\n"), set(&[]));
        assert_eq!(parse_list("(null)\n"), set(&[]));
        assert_eq!(parse_list("0-99999999999"), set(&[]));
        assert_eq!(parse_mask("5\n"), set(&[0, 2]));
        assert_eq!(parse_mask("1,00000002\n"), set(&[1, 32]));
        assert_eq!(parse_mask("what\n"), set(&[]));
    }

    #[test]
    fn interrupts_of_devices_are_those_with_a_number() {
        assert_eq!(
            parse_interrupts(PI_4),
            [(0, 9_484_754), (1, 0), (2, 0), (3, 0)]
        );
        assert_eq!(parse_interrupts(""), []);
    }

    // Names of chips have spaces, and devices share interrupts.
    #[test]
    fn a_device_is_known_by_its_name_and_number() {
        let text =
            format!("{PI_4} 51:  7  0  1  2  BRCM STB PCIe MSI 524288 Edge      xhci_hcd, eth1\n");
        let devices = parse_devices(&text);
        let names: Vec<_> = devices
            .iter()
            .map(|d| (d.number, d.name.as_str()))
            .collect();
        assert_eq!(
            names,
            [
                (9, "vgic"),
                (18, "fe00b880.mailbox"),
                (40, "eth0"),
                (51, "xhci_hcd, eth1")
            ]
        );
        assert_eq!(devices[3].counts, [(0, 7), (1, 0), (2, 1), (3, 2)]);
        let x86 = "           CPU0       CPU1\n 36:          0   15745011 PCI-MSIX-0000:00:02.0   1-edge      virtio1-req.0\n";
        assert_eq!(
            parse_devices(x86),
            [DeviceInterrupt {
                number: 36,
                name: "virtio1-req.0".to_owned(),
                counts: vec![(0, 0), (1, 15_745_011)],
            }]
        );
    }

    #[test]
    fn an_isolated_cpu_is_the_best() {
        let cpus = Cpus {
            online: set(&[0, 1, 2, 3]),
            isolated: set(&[2, 3]),
            tickless: set(&[2]),
            device_interrupts: parse_interrupts(PI_4),
            ..Cpus::default()
        };
        // Threads are kept off isolated CPUs unless they ask.
        let allowed = [0, 1];
        assert_eq!(cpus.best(&allowed, |_| true).unwrap().cpu, 2);
        assert_eq!(cpus.best(&allowed, |cpu| cpu == 3).unwrap().cpu, 3);
        // A container may not have it.
        assert_eq!(cpus.best(&allowed, |cpu| cpu < 2).unwrap().cpu, 1);
        let gone = Cpus {
            online: set(&[0, 1]),
            ..cpus
        };
        assert_eq!(gone.best(&allowed, |_| true).unwrap().cpu, 1);
    }

    #[test]
    fn the_cpu_that_handles_the_interrupts_is_not_chosen() {
        let cpus = Cpus {
            device_interrupts: parse_interrupts(PI_4),
            ..Cpus::default()
        };
        let choice = cpus.best(&[0, 1, 2, 3], |_| true).unwrap();
        assert_eq!(choice.cpu, 3);
        assert!(
            choice.because.contains("CPU 0 9484754"),
            "{}",
            choice.because
        );
        let told = Cpus {
            interrupted_by_default: set(&[0, 1, 3]),
            ..cpus
        };
        assert_eq!(told.best(&[0, 1, 2, 3], |_| true).unwrap().cpu, 2);
    }

    proptest::proptest! {
        #[test]
        fn any_text_can_be_read(text in "[ -~\\n,:0-9]{0,200}") {
            let known = Cpus {
                online: parse_list(&text),
                interrupted_by_default: parse_mask(&text),
                device_interrupts: parse_interrupts(&text),
                ..Cpus::default()
            };
            let _ = known.best(&[0, 1, 2], |_| false);
        }
    }

    #[test]
    fn nothing_is_chosen_where_nothing_is_better() {
        let even = Cpus {
            device_interrupts: vec![(0, 1_000), (1, 900)],
            ..Cpus::default()
        };
        assert!(even.best(&[0, 1], |_| true).is_err());
        assert!(even.best(&[0], |_| true).is_err());
        assert!(Cpus::default().best(&[0, 1], |_| true).is_err());
    }
}
