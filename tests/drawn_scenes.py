"""Scenes that strategies of random tests draw, read from files."""

from collections.abc import Callable
from pathlib import Path

import pytest
from hypothesis import HealthCheck, given, seed, settings
from hypothesis.internal.conjecture import providers
from hypothesis.strategies import SearchStrategy
from restshape_studies.stability.tables import toml

from restshape.errors import UserError
from restshape.scene.load import load_scene


def look_at_drawn(strategy: SearchStrategy, examples: int, folder: Path, look: Callable[..., None]) -> None:
    """Calls `look` with each tuple of a strategy, a scene's tables first, and with the scene; None if it is refused."""

    @seed(3)
    @settings(max_examples=examples, database=None, deadline=None, suppress_health_check=list(HealthCheck))
    @given(strategy)
    def each(drawn: tuple) -> None:
        path = folder / "scene.toml"
        path.write_text(toml(drawn[0]))
        try:
            scene = load_scene(path)
        except UserError:
            scene = None
        look(*drawn, scene)

    with pytest.MonkeyPatch.context() as changed:
        # Else it would draw constants of whatever modules other tests have imported.
        changed.setattr(providers, "_get_local_constants", providers.Constants, raising=False)
        each()
