"""The page that adds a physics shows the files as they are."""

import re
from pathlib import Path

ROOT = Path(__file__).parents[1]
PAGE = ROOT / "docs" / "add-a-physics.md"
BLOCK = re.compile(r"^`([^`\n]+)`:\n\n```\w+\n(.*?)^```$", re.DOTALL | re.MULTILINE)
MOST_LINES = 500


def test_its_blocks_are_the_files():
    blocks = BLOCK.findall(PAGE.read_text(encoding="utf-8"))
    assert len(blocks) > 6
    changed = [path for path, text in blocks if (ROOT / path).read_text(encoding="utf-8") != text]
    assert changed == []


def test_it_shows_the_whole_folder_of_the_physics():
    shown = {path for path, _ in BLOCK.findall(PAGE.read_text(encoding="utf-8"))}
    files = [path for path in (ROOT / "lib/restshape/physics/heat").glob("*.py") if path.name != "__init__.py"]
    assert {str(path.relative_to(ROOT)) for path in files} <= shown
    assert sum(len(path.read_text().splitlines()) for path in files) < MOST_LINES


def test_the_registry_lists_the_elements():
    assert "file(heat_elements)" in (ROOT / "lib/kernels/fem/registry.cpp").read_text()
