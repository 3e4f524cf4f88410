"""The README's test runs as printed."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import fcc_hil.lockstep_rig  # noqa: F401 - or the run inside loads it anew

README = Path(__file__).parents[2] / "README.md"


def test_the_test_runs_as_printed(pytester: pytest.Pytester) -> None:
    blocks = re.findall(r"^```python\n(.*?)^```$", README.read_text(), re.MULTILINE | re.DOTALL)
    tests = [block for block in blocks if "def test_" in block]
    assert len(tests) == 1
    pytester.makepyfile(tests[0])
    pytester.runpytest_inprocess("-p", "no:cacheprovider").assert_outcomes(passed=1)
