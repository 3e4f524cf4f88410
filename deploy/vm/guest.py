"""A small Debian in qemu, booted for a few tests, with its own systemd and kernel.

    with Guest(Path("target/vm"), scratch) as guest:
        guest.sh("systemctl is-system-running --wait")

Changes are discarded: the disk is a temporary copy. The host's loopback is 10.0.2.2 there.
"""

from __future__ import annotations

import contextlib
import os
import subprocess
import tempfile
import time
from collections.abc import Callable
from pathlib import Path
from types import TracebackType

from agent import Agent, AgentError, Done

HOST = "10.0.2.2"
"""This machine, as the guest sees it."""

INSTALL_S = 300.0
"""Longest duration of an installation."""

# An emulated machine on a busy one takes minutes.
_BOOT_S = 300.0
_COMMAND_S = 120.0
_LOOK_S = 0.05
_LAST_LINES = 40


class Guest:
    """A running machine; a context manager that ends it, without a shutdown."""

    def __init__(self, image: Path, scratch: Path) -> None:
        """Boot, and wait until systemd has started everything."""
        self._console = scratch / "console"
        with contextlib.ExitStack() as undo:
            # A socket's path has to be short, which pytest's folders are not.
            sockets = undo.enter_context(tempfile.TemporaryDirectory(prefix="fccd-"))
            agent = Path(sockets) / "agent"
            begun_s = time.monotonic()
            self._process = subprocess.Popen(
                _command(image, agent, self._console),
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.PIPE,
                text=True,
            )
            undo.callback(self._end)
            self._wait(agent.exists, "qemu runs", 30.0)
            self.agent = undo.enter_context(Agent(agent))
            self._wait(lambda: self.agent.answers(1.0), "the guest's agent answers", _BOOT_S)
            self.sh("systemctl is-system-running --wait", within_s=_BOOT_S)
            self.boot_s = time.monotonic() - begun_s
            """How long that took."""
            self._undo = undo.pop_all()

    def __enter__(self) -> Guest:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        self._undo.close()

    def try_sh(self, script: str, within_s: float = _COMMAND_S) -> Done:
        """Run a line of shell as root, however it ends."""
        try:
            return self.agent.run(["/bin/sh", "-c", script], within_s)
        except AgentError as error:
            raise AgentError(f"{error}\n{self._last_words()}") from error

    def sh(self, script: str, within_s: float = _COMMAND_S) -> str:
        """Run a line of shell as root that must succeed; return its output."""
        done = self.try_sh(script, within_s)
        assert done.exit_code == 0, f"{script}: exit code {done.exit_code}\n{done.out}{done.err}"
        return done.out

    def _wait(self, holds: Callable[[], bool], what: str, within_s: float) -> None:
        give_up_s = time.monotonic() + within_s
        while not holds():
            if self._process.poll() is not None:
                assert self._process.stderr is not None
                raise AgentError(f"qemu ended: {self._process.stderr.read()}")
            if time.monotonic() > give_up_s:
                raise AgentError(f"not within {within_s:.0f} s: {what}\n{self._last_words()}")
            time.sleep(_LOOK_S)

    def _last_words(self) -> str:
        lines = self._console.read_text("utf-8", "replace").splitlines()
        return "\n".join(["the guest's console:", *lines[-_LAST_LINES:]])

    def _end(self) -> None:
        self._process.kill()
        self._process.wait()
        assert self._process.stderr is not None
        self._process.stderr.close()


def accelerator() -> str:
    """Return `kvm` if the processor can run guests, otherwise `tcg`: emulated, much slower.

    A kernel without either vendor's module may have /dev/kvm, and run only guests built for it.
    """
    hardware = any(Path(f"/sys/module/{name}").exists() for name in ("kvm_intel", "kvm_amd"))
    return "kvm" if hardware and os.access("/dev/kvm", os.R_OK | os.W_OK) else "tcg"


def _command(image: Path, agent: Path, console: Path) -> list[str]:
    words = ["qemu-system-x86_64", "-nodefaults", "-no-user-config", "-display", "none"]
    words += ["-accel", accelerator(), "-cpu", "max", "-smp", "2", "-m", "1024"]
    words += ["-kernel", f"{image}/vmlinuz", "-initrd", f"{image}/initrd.img"]
    words += ["-append", "root=/dev/vda rw console=ttyS0 panic=-1", "-no-reboot"]
    words += ["-drive", f"file={image}/root.img,format=raw,if=virtio,snapshot=on"]
    words += ["-netdev", "user,id=net", "-device", "virtio-net-pci,netdev=net"]
    words += ["-serial", f"file:{console}"]
    words += ["-chardev", f"socket,id=agent,path={agent},server=on,wait=off"]
    words += ["-device", "virtio-serial"]
    return [*words, "-device", "virtserialport,chardev=agent,name=org.qemu.guest_agent.0"]
