"""The small scene of tests/data in a folder of its own, and applications that are installed for a test."""

import shutil
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from restshape import application as installed
from restshape.application import Application
from restshape.scene import overrides

DATA = Path(__file__).parents[1] / "data"


@pytest.fixture
def scene_file(tmp_path: Path) -> Path:
    """A scene file that a test may change."""
    return Path(shutil.copy(DATA / "plate.toml", tmp_path))


@pytest.fixture
def script_file(tmp_path: Path) -> Path:
    """An edit script for it that a test may change."""
    return Path(shutil.copy(DATA / "plate.jsonl", tmp_path))


@dataclass(order=True)
class Entry:
    """An entry point."""

    name: str
    application: Application = field(compare=False)

    def load(self) -> Application:
        """The application."""
        return self.application


def forget() -> None:
    """What is known of installed applications is found again."""
    installed.applications.cache_clear()
    overrides._named_of_physics.cache_clear()


@pytest.fixture
def install(monkeypatch) -> Iterator[Callable[..., None]]:
    """Makes applications the only ones that are installed."""

    def only(*applications: Application) -> None:
        entries = [Entry(app.name, app) for app in applications]
        monkeypatch.setattr(installed, "entry_points", lambda group: entries)
        forget()

    yield only
    monkeypatch.undo()
    forget()
