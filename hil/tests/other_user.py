"""Another user of the machine: only root can act as one."""

from __future__ import annotations

import os

import pytest

NOBODY = 65534
"""The user with this name, who owns nothing."""

needs_two_users = pytest.mark.skipif(os.geteuid() != 0, reason="only root can act as another user")


def as_user(user: int) -> list[str]:
    """Return the words before those of a program that another user runs."""
    return ["setpriv", f"--reuid={user}", f"--regid={user}", "--clear-groups"]
