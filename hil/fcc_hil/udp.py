"""The stand-in's sockets: one that listens, and one that replies come from, as X-Plane has."""

from __future__ import annotations

import contextlib
import itertools
import random
import socket
from typing import Literal

from .faults import Address

ReplyPort = int | Literal["same", "next"]
"""The port to send from: a number, 0 for any free one; "same" as the one that listens; "next" for
the one after it, or any free one."""

_NEXT = itertools.count(random.SystemRandom().randrange(6_000))


def open_ports(host: str, port: int, reply_port: ReplyPort) -> tuple[socket.socket, socket.socket]:
    """Return the socket that listens and the one that sends; raise OSError with what to do."""
    listens = _bound(host, port, "is X-Plane or another stand-in running? Choose another --port")
    if reply_port == "same":
        return listens, listens
    try:
        return listens, _open_reply(host, port, reply_port)
    except OSError:
        listens.close()
        raise


def send_beacons_from(opened: socket.socket, host: str) -> None:
    """Let a socket of IPv4 send to a group: one hop, and to this machine."""
    opened.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_TTL, 1)
    opened.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_LOOP, 1)
    if host != "0.0.0.0":
        interface = socket.inet_aton(socket.gethostbyname(host))
        opened.setsockopt(socket.IPPROTO_IP, socket.IP_MULTICAST_IF, interface)


def free_port() -> int:
    """Return a free port; the next one is free, too: a stand-in sends from it.

    Both stay free: below the range from which the kernel gives ports to others
    (`ip_local_port_range` in ip(7): 32768 and above), and given once by this process.
    """
    while True:
        first = 20_000 + next(_NEXT) * 2 % 12_000
        with contextlib.ExitStack() as opened:
            try:
                for port in (first, first + 1):
                    probe = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
                    opened.enter_context(probe).bind(("0.0.0.0", port))
            except OSError:
                continue
            return first


def port_of(opened: socket.socket) -> int:
    """Return the port that a socket is bound to."""
    port: int = opened.getsockname()[1]
    return port


def address_of(sender: tuple[str, int] | tuple[str, int, int, int]) -> Address:
    """Return host and port of a sender: of IPv6 there are four parts."""
    return sender[0], sender[1]


def _open_reply(host: str, port: int, reply_port: int | Literal["next"]) -> socket.socket:
    if reply_port != "next":
        return _bound(host, reply_port, "choose another --reply-port")
    if 0 < port < 65_535:
        with contextlib.suppress(OSError):
            return _bound(host, port + 1, "")
    return _bound(host, 0, "")


def _bound(host: str, port: int, advice: str) -> socket.socket:
    is_ipv6 = ":" in host
    opened = socket.socket(socket.AF_INET6 if is_ipv6 else socket.AF_INET, socket.SOCK_DGRAM)
    try:
        opened.bind((host, port))
    except OSError as error:
        opened.close()
        raise OSError(f"cannot listen on {host}:{port} ({error.strerror}); {advice}") from error
    opened.setblocking(False)
    return opened
