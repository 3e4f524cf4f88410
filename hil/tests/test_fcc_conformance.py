"""What sensors and actuators promise, asked of those whose plant or callback is in Python."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable

import fcc
import pytest

REQUIREMENTS: dict[str, Callable[[], None]] = getattr(fcc, "_conformance", dict)()


def test_the_module_has_the_suites() -> None:
    """The Makefile builds it so: maturin develop --features conformance."""
    counts = Counter(name.split("::")[0] for name in REQUIREMENTS)
    assert counts == {"CallbackSensor": 8, "QueuedSensor": 11, "HeldFlag": 10}


@pytest.mark.parametrize("requirement", REQUIREMENTS)
def test_requirement(requirement: str) -> None:
    REQUIREMENTS[requirement]()
