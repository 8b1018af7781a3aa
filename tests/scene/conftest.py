"""The small scene of tests/data, in a folder of its own."""

import shutil
from pathlib import Path

import pytest

DATA = Path(__file__).parents[1] / "data"


@pytest.fixture
def scene_file(tmp_path: Path) -> Path:
    """A scene file that a test may change."""
    return Path(shutil.copy(DATA / "plate.toml", tmp_path))


@pytest.fixture
def script_file(tmp_path: Path) -> Path:
    """An edit script for it that a test may change."""
    return Path(shutil.copy(DATA / "plate.jsonl", tmp_path))
