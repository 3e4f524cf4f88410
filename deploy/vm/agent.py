"""Runs commands in the guest through qemu's guest agent on a virtio serial port.

The agent needs no network, no login and no clock that is right. Its protocol is one JSON
object a line (QEMU, "QEMU Guest Agent Protocol Reference").
"""

from __future__ import annotations

import base64
import json
import socket
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

_LOOK_S = 0.01
_ANSWER_S = 30.0
_CHUNK = 1 << 20


class AgentError(RuntimeError):
    """The agent refused a command, or does not answer."""


@dataclass(frozen=True)
class Done:
    """A command that has ended."""

    words: str
    exit_code: int
    """Negative for a signal."""
    out: str
    err: str


class Agent:
    """A connection to the agent; a context manager that closes it."""

    def __init__(self, path: Path) -> None:
        """Connect to qemu's end of the port, which exists before the guest runs."""
        self._socket = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        self._socket.connect(str(path))
        self._heard = b""

    def __enter__(self) -> Agent:
        return self

    def __exit__(self, *_: object) -> None:
        self._socket.close()

    def answers(self, within_s: float) -> bool:
        """Return whether the agent answers yet."""
        # Requests sent before it ran may be answered late, and more than once.
        number = time.monotonic_ns()
        try:
            self._send("guest-sync", {"id": number})
            give_up_s = time.monotonic() + within_s
            while (left_s := give_up_s - time.monotonic()) > 0.0:
                if self._receive(left_s).get("return") == number:
                    return True
        except TimeoutError:
            pass
        return False

    def run(self, words: Sequence[str], within_s: float) -> Done:
        """Run a program and wait for its end. Raises AgentError if that takes too long."""
        log = " ".join(words)
        asked = {"path": words[0], "arg": list(words[1:]), "capture-output": True}
        number = self._ask("guest-exec", asked)["pid"]
        give_up_s = time.monotonic() + within_s
        while True:
            status = self._ask("guest-exec-status", {"pid": number})
            if status["exited"]:
                return Done(
                    log,
                    status["exitcode"] if "exitcode" in status else -status["signal"],
                    _text(status.get("out-data", "")),
                    _text(status.get("err-data", "")),
                )
            if time.monotonic() > give_up_s:
                raise AgentError(f"not done within {within_s:.0f} s: {log}")
            time.sleep(_LOOK_S)

    def write(self, path: str, content: bytes) -> None:
        """Write a file of the guest."""
        handle = self._ask("guest-file-open", {"path": path, "mode": "w"})
        for start in range(0, len(content), _CHUNK):
            chunk = base64.b64encode(content[start : start + _CHUNK]).decode()
            self._ask("guest-file-write", {"handle": handle, "buf-b64": chunk})
        self._ask("guest-file-close", {"handle": handle})

    def read(self, path: str) -> bytes:
        """Return the content of a file of the guest."""
        handle = self._ask("guest-file-open", {"path": path, "mode": "r"})
        content = b""
        while True:
            part = self._ask("guest-file-read", {"handle": handle, "count": _CHUNK})
            content += base64.b64decode(part["buf-b64"])
            if part["eof"]:
                break
        self._ask("guest-file-close", {"handle": handle})
        return content

    def _ask(self, name: str, arguments: dict[str, Any]) -> Any:
        self._send(name, arguments)
        try:
            answer = self._receive(_ANSWER_S)
        except TimeoutError:
            raise AgentError(f"{name}: the guest has not answered for {_ANSWER_S:.0f} s") from None
        if "error" in answer:
            raise AgentError(f"{name} {arguments}: {answer['error']['desc']}")
        return answer["return"]

    def _send(self, name: str, arguments: dict[str, Any]) -> None:
        self._socket.settimeout(_ANSWER_S)
        self._socket.sendall(json.dumps({"execute": name, "arguments": arguments}).encode() + b"\n")

    def _receive(self, within_s: float) -> dict[str, Any]:
        give_up_s = time.monotonic() + within_s
        while b"\n" not in self._heard:
            left_s = give_up_s - time.monotonic()
            if left_s <= 0.0:
                raise TimeoutError
            self._socket.settimeout(left_s)
            more = self._socket.recv(_CHUNK)
            if not more:
                raise AgentError("qemu has closed the agent's port")
            self._heard += more
        line, _, self._heard = self._heard.partition(b"\n")
        answer: dict[str, Any] = json.loads(line)
        return answer


def _text(encoded: str) -> str:
    return base64.b64decode(encoded).decode("utf-8", "replace")
