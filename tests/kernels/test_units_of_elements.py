"""A changed element compiles few files: each includes its own, and what all share holds no element."""

import re
from functools import cache
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
KERNELS = ROOT / "lib" / "kernels"
ELEMENT = re.compile(r"^struct \w+Element\b", re.MULTILINE)
MOST = 3
"""Files that include a header with an element: they compile in less than half a minute of one core."""


@cache
def included(path: Path) -> frozenset[Path]:
    """The kernel headers that a file reads, whatever includes them."""
    text = path.read_text(encoding="utf-8")
    own = {KERNELS / name for name in re.findall(r'^#include "([^"]+)"', text, re.MULTILINE)}
    return frozenset(own).union(*map(included, own))


def elements() -> list[Path]:
    """The headers that hold an element."""
    return [path for path in sorted(KERNELS.rglob("*.hpp")) if ELEMENT.search(path.read_text(encoding="utf-8"))]


def test_elements_are_found():
    names = {path.stem for path in elements()}
    assert {"solid", "mass", "straight_mass", "membrane", "plate"} <= names and "solid_parts" not in names


@pytest.mark.parametrize("path", elements(), ids=lambda path: path.stem)
def test_a_changed_element_compiles_few_files(path):
    units = [unit.name for unit in KERNELS.rglob("*.cpp") if path in included(unit)]
    assert 0 < len(units) <= MOST, units
