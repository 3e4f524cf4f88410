"""The stub of the module `fcc`: what it declares, and what follows from the schema.

`FCC_UPDATE=1 python -m pytest hil/tests/test_fcc_stub.py` writes the parts that follow from
the schema anew.
"""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path

import fcc
import pytest

STUB = Path(__file__).parents[2] / "crates/fcc-py/fcc.pyi"
LONGEST = 80
BEGIN, END = "    # <schema>\n", "    # </schema>\n"
SETTABLE = (fcc.Measurements(), fcc.Surfaces(), fcc.RawTruth())
"""What is constructed from its values."""
VALUES = (
    *SETTABLE,
    fcc.Machine().setpoints,
    fcc.Machine().estimate,
    fcc.BuiltInAircraft().truth,
)


def _body(values: object) -> str:
    """Return what the schema says of a class."""
    kind = type(values)
    properties = {name: p for name, p in vars(kind).items() if isinstance(p, property)}
    types = {name: type(getattr(values, name)).__name__ for name in properties}
    lines = []
    if values in SETTABLE or isinstance(values, fcc.Measurements):
        lines.append("def __new__(")
        lines += ["    cls,", "    *,"]
        lines += [f"    {name}: {types[name]} = ...," for name in properties]
        lines.append(f") -> {kind.__name__}: ...")
    for name, declared in properties.items():
        lines += ["@property", f"def {name}(self) -> {types[name]}:"]
        lines += [f'    """{_first_sentence(str(declared.__doc__))}."""', ""]
        if declared.fset is not None:
            lines += [f"@{name}.setter", f"def {name}(self, value: {types[name]}) -> None: ..."]
    return "".join(f"    {line}\n" if line else "\n" for line in lines)


def _first_sentence(meaning: str) -> str:
    """Return the first part of a text that fits in a line."""
    for end in (". ", "; ", ": ", ", "):
        meaning = meaning.split(end, maxsplit=1)[0].rstrip(".")
        if len(meaning) <= LONGEST:
            break
    return meaning


def _declared(stub: str) -> str:
    for values in VALUES:
        start = f"@final\nclass {type(values).__name__}:\n"
        before, rest = stub.split(start)
        head, rest = rest.split(BEGIN, maxsplit=1)
        _, after = rest.split(END, maxsplit=1)
        stub = f"{before}{start}{head}{BEGIN}{_body(values)}{END}{after}"
    return stub


def test_the_values_of_the_stub_are_those_of_the_schema() -> None:
    declared = _declared(STUB.read_text())
    if "FCC_UPDATE" in os.environ:
        STUB.write_text(declared)
    assert STUB.read_text() == declared, "see the head of this test"


def _commands() -> set[str]:
    with pytest.raises(ValueError, match="choose of ") as refused:
        fcc.Machine().command(**{"none": 1.0})
    return set(str(refused.value).partition("choose of ")[2].split(", "))


def test_the_stub_has_every_command() -> None:
    body = STUB.read_text().partition("class _Commanded")[2].partition("\n\n__version__")[0]
    assert set(re.findall(r"^    (\w+): float", body, re.MULTILINE)) == _commands()


def test_the_documents_have_every_command() -> None:
    page = (STUB.parents[2] / "docs/telemetry.md").read_text()
    table = page.partition("| name of a set point")[2].partition("\n\n")[0]
    first = "".join(row.split("|")[1] for row in table.splitlines()[2:])
    assert set(re.findall(r"`(\w+)`", first)) == _commands()


def test_the_stubs_match_the_module(tmp_path: Path) -> None:
    allowed = tmp_path / "allowed"
    # The binary beside the package, the list of its names, and what is for tests only.
    allowed.write_text("fcc\\.fcc\nfcc\\.__all__\nfcc\\._conformance\n")
    checked = subprocess.run(
        [
            *(sys.executable, "-m", "mypy.stubtest", "fcc"),
            *("--ignore-disjoint-bases", "--ignore-unused-allowlist", "--allowlist", allowed),
        ],
        capture_output=True,
        text=True,
        check=False,
    )
    assert checked.returncode == 0, checked.stdout
