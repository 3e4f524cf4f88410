"""What the service's unit denies, tried from inside: a program in the daemon's place.

Each attempt succeeds without the unit, so it is the unit that denies it.
"""

from __future__ import annotations

import shlex

import pytest

from guest import Guest

_PROGRAM = "/usr/local/bin/attempts"
_RESULTS = "/var/lib/fccd/attempts"
_UNIT = "/run/systemd/system/attempts.service"

# Numbers of x86-64: mmap, unshare (syscalls(2)); PROT_READ | PROT_WRITE | PROT_EXEC, MAP_PRIVATE |
# MAP_ANONYMOUS; CLONE_NEWUSER; AF_ALG (38), AF_PACKET (17).
_OF_ANY_USER = {
    "memory that is written and executed": "perl -e 'exit(syscall(9,0,4096,7,34,-1,0) == -1)'",
    "a namespace of users": "perl -e 'exit(syscall(272,0x10000000) == -1)'",
    "a socket of the kernel's ciphers": "perl -e 'socket(S,38,5,0) or exit 1'",
    "a datagram to another network": "echo > /dev/udp/192.0.2.1/9",
    "processes of others": "test -e /proc/1/status",
}
_OF_ROOT = {
    "a file of the system": "touch /usr/attempt && rm /usr/attempt",
    "a file of its configuration": "touch /etc/fccd/attempt && rm /etc/fccd/attempt",
    "a file of a user": "test -e /root/.attempts",
    "a raw socket": "perl -e 'socket(S,17,3,0) or exit 1'",
    "the kernel's log": "dd if=/dev/kmsg bs=8192 count=1",
    "a device": "mknod /var/lib/fccd/device c 1 3 && rm /var/lib/fccd/device",
    "the clock": "date --set '+1 second'",
    "the kernel's settings": "echo guest > /proc/sys/kernel/hostname",
    "another owner": "chown root:fccd /var/lib/fccd",
    "a file with the rights of its owner": "touch /var/lib/fccd/s && chmod u+s /var/lib/fccd/s",
    "a mount": "mount --bind /var/lib/fccd /var/lib/fccd",
    "another group of control": "mkdir /sys/fs/cgroup/attempt && rmdir /sys/fs/cgroup/attempt",
}


@pytest.fixture(scope="module", params=["fccd", "root"])
def user(request: pytest.FixtureRequest) -> str:
    """Return whose rights the attempts have before the unit takes some."""
    name: str = request.param
    return name


def _attempts(user: str) -> dict[str, str]:
    return _OF_ANY_USER if user == "fccd" else _OF_ANY_USER | _OF_ROOT


def _succeeded(guest: Guest) -> set[str]:
    return set(guest.sh(f"cat {_RESULTS}; rm {_RESULTS}").splitlines())


def test_what_the_unit_denies_is_denied(guest: Guest, user: str) -> None:
    attempts = _attempts(user)
    lines = ["#!/bin/bash", f"> {_RESULTS}"]
    for name, command in attempts.items():
        note = f"echo {shlex.quote(name)} >> {_RESULTS}"
        lines.append(f"if ( {command} ) > /dev/null 2>&1; then {note}; fi")
    # Its own folders it may write, and talk to this machine.
    lines.append(f"( echo > /dev/udp/127.0.0.1/9 ) && echo 'this machine' >> {_RESULTS}")
    guest.agent.write(_PROGRAM, "\n".join([*lines, ""]).encode())
    guest.sh(f"chmod 755 {_PROGRAM}; touch /root/.attempts; mkdir -p /var/lib/fccd")
    guest.sh("chown fccd:fccd /var/lib/fccd")

    # In the unit's group both times: what ProtectProc= hides, the group root still sees.
    guest.sh(f"runuser -u {user} -g fccd -- {_PROGRAM}")
    assert _succeeded(guest) == {*attempts, "this machine"}, "nothing denies them without the unit"
    guest.sh("umount /var/lib/fccd || true; rm -f /var/lib/fccd/*; chown fccd:fccd /var/lib/fccd")

    changes = [
        f"s#^ExecStart=.*#ExecStart={_PROGRAM}#",
        "s/^Type=.*/Type=oneshot/",
        f"s/^User=.*/User={user}/",
        "/^WatchdogSec=/d; /^Restart/d; /^NotifyAccess=/d",
    ]
    edit = " ".join(f"-e '{change}'" for change in changes)
    guest.sh(f"sed {edit} $(systemctl show --property FragmentPath --value fccd) > {_UNIT}")
    guest.sh("systemctl daemon-reload; systemctl start attempts")
    assert _succeeded(guest) == {"this machine"}
