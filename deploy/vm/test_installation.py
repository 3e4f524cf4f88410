"""The effects of installing the package."""

from __future__ import annotations

import json

import pytest

from guest import Guest

MACHINE_LACKS = 10


def test_nothing_is_started(guest: Guest) -> None:
    """According to systemd and to the kernel, the program does not run."""
    assert guest.try_sh("systemctl is-active fccd").out.strip() == "inactive"
    assert guest.try_sh("systemctl is-enabled fccd").out.strip() == "disabled"
    never = "0"
    output = guest.sh("systemctl show --property ActiveEnterTimestampMonotonic --value fccd")
    assert output.strip() == never
    assert "fccd" not in guest.sh("cat /proc/[0-9]*/comm").split()
    assert guest.sh("systemctl list-units --failed --plain --no-legend") == ""


@pytest.mark.parametrize(
    ("path", "owner_and_mode"),
    [
        ("/usr/bin/fccd", "root:root 755"),
        ("/etc/fccd", "root:root 755"),
        ("/etc/fccd/fccd.toml", "root:root 644"),
        ("/lib/systemd/system/fccd.service", "root:root 644"),
        ("/usr/lib/sysusers.d/fccd.conf", "root:root 644"),
        ("/usr/lib/udev/rules.d/60-fccd.rules", "root:root 644"),
        ("/usr/share/man/man1/fccd.1.gz", "root:root 644"),
        ("/usr/share/doc/fccd/copyright", "root:root 644"),
        # By the udev rule, without a reboot.
        ("/dev/cpu_dma_latency", "root:fccd 660"),
    ],
)
def test_owner_and_mode(guest: Guest, path: str, owner_and_mode: str) -> None:
    assert guest.sh(f"stat --format '%U:%G %a' {path}").strip() == owner_and_mode


def test_the_user_cannot_log_in(guest: Guest) -> None:
    name, _, uid, _, _, home, shell = guest.sh("getent passwd fccd").strip().split(":")
    assert (name, home) == ("fccd", "/var/lib/fccd")
    assert shell.endswith("/nologin")
    # Of the system, by Debian's policy (9.2.2).
    assert 100 <= int(uid) < 1000
    assert guest.sh("id --groups --name fccd").split() == ["fccd"]


@pytest.mark.parametrize("page", ["fccd", "fccd-run", "fccd-top"])
def test_its_manual_can_be_read_there(guest: Guest, page: str) -> None:
    text = guest.sh(f"MANWIDTH=80 man {page}")
    assert "SYNOPSIS" in text


def test_the_configuration_that_comes_with_it_is_right(guest: Guest) -> None:
    guest.sh("fccd check /etc/fccd/fccd.toml")


def test_dpkg_finds_every_file_as_it_was_packed(guest: Guest) -> None:
    assert guest.sh("dpkg --verify fccd") == ""
    assert guest.sh("dpkg --audit") == ""


@pytest.mark.parametrize("who", ["root", "fccd"])
def test_the_doctor_knows_the_machine(guest: Guest, who: str) -> None:
    done = guest.try_sh(f"sudo -u {who} fccd doctor --json")
    output = json.loads(done.out)
    findings = {finding["id"]: finding for finding in output["findings"]}
    lacking = [finding for finding in output["findings"] if finding["grade"] == "lacks"]
    assert done.exit_code == (MACHINE_LACKS if lacking else 0)
    assert guest.try_sh(f"sudo -u {who} fccd doctor").exit_code == done.exit_code
    assert guest.sh("uname --kernel-release").strip() in output["kernel"]
    clock = "/sys/devices/system/clocksource/clocksource0/current_clocksource"
    assert guest.sh(f"cat {clock}").strip() in findings["clock_source"]["found"]
    # Only the unit gives these to who is not root.
    assert (findings["realtime_priority"]["grade"] == "lacks") == (who == "fccd")
