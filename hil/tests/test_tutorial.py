"""The tests in docs/tutorial.md, as printed there."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

TUTORIAL = (Path(__file__).parents[2] / "docs/tutorial.md").read_text()
FIRST, SECOND = re.findall(r"```python\n(.*?)```", TUTORIAL, re.DOTALL)


def test_the_first_test_fails_with_the_printed_message(pytester: pytest.Pytester) -> None:
    pytester.makepyfile(test_first=FIRST)
    result = pytester.runpytest_subprocess()
    result.assert_outcomes(failed=1)
    printed = [
        line[4:] for line in TUTORIAL.splitlines() if "required:" in line or "flown: " in line
    ]
    assert len(printed) == 2
    result.stdout.fnmatch_lines(printed)


def test_the_corrected_and_the_second_test_pass(pytester: pytest.Pytester) -> None:
    assert "by=10" in FIRST
    pytester.makepyfile(test_first=FIRST.replace("by=10", "by=17"), test_airspeed=SECOND)
    pytester.runpytest_subprocess().assert_outcomes(passed=2)
