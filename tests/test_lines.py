"""Net lines by room are counted as stated, and the page of the architecture has a row for every room."""

import re
import sys
from collections import Counter
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "architecture.md").read_text(encoding="utf-8")
PYTHON = '"""Says what."""\n\n# A comment.\nx = 1  # one\n\n\ndef f():\n    # Another.\n    return x\n'
CPP = "// A comment.\n#include <vector>\n\nint x;\n"


@pytest.fixture
def lines(monkeypatch):
    monkeypatch.syspath_prepend(str(ROOT / "scripts"))
    import lines

    yield lines
    del sys.modules["lines"]


def test_blank_lines_and_comments_do_not_count(lines):
    assert lines.net_lines({"lib/a.py": PYTHON, "lib/kernels/a.hpp": CPP}) == {"lib/a.py": 4, "lib/kernels/a.hpp": 2}


def test_each_file_counts_in_one_area(lines):
    now = {
        "lib/restshape/fem/space.py": 1,
        "lib/kernels/fem/dual.hpp": 2,
        "apps/one/__init__.py": 4,
        "apps/other/kernels/planks.cpp": 8,
        "apps/one/tests/test_one.py": 16,
        "tests/fem/test_space.py": 32,
        "conftest.py": 64,
        "studies/thesis.py": 128,
        "verification/one/large.py": 256,
        "setup.py": 512,
    }
    expected = {"lib": 1, "kernels": 2, "apps": 4, "apps, C++": 8, "tests": 112, "studies": 128, "verification": 256}
    assert lines.by_area(now) == expected


def test_files_that_moved_count_as_what_they_became(lines):
    early = {
        "lib/restshape/accuracy/study.py": 1,
        "lib/restshape/cli/bench_order.py": 2,
        "apps/one/validation.py": 4,
        "apps/other/sound.py": 8,
        "lib/restshape/cli/replay.py": 16,
    }
    assert lines.by_area(early) == {"studies": 3, "verification": 4, "apps": 8, "lib": 16}


def test_rooms_are_folders_and_those_of_each_physics_by_themselves(lines):
    found = lines.by_room(
        {
            "lib/restshape/fem/space.py": 1,
            "lib/restshape/physics/cloth/relaxation/row.py": 2,
            "lib/restshape/physics/cloth/effects.py": 32,
            "lib/restshape/physics/__init__.py": 4,
            "lib/restshape/errors.py": 8,
            "apps/one/__init__.py": 16,
        }
    )
    rooms = {
        "lib/restshape/fem/": 1,
        "lib/restshape/physics/cloth/relaxation/": 2,
        "lib/restshape/physics/cloth/": 32,
        "lib/restshape/physics/": 4,
        "lib/restshape/": 8,
    }
    assert found == Counter(rooms)


def folders(*parents: str) -> set[str]:
    """Folders with sources below these, without what tools leave behind; those of the live page have none of ours."""
    return {
        one.relative_to(ROOT).as_posix() + "/"
        for parent in parents
        for one in (ROOT / parent).iterdir()
        if one.is_dir() and any(one.rglob("*.?pp")) | any(one.rglob("*.py"))
    }


def test_the_page_has_a_row_for_every_room():
    rooms = set(re.findall(r"^\| `([\w/]+/)` \|", PAGE, re.M))
    there = folders("lib/restshape", "lib/restshape/physics", "lib/kernels")
    there |= {inner for room in there if room.startswith("lib/restshape/") for inner in folders(room)}
    assert rooms == there
