"""Numbers of a scene as the page's sliders get them."""

from __future__ import annotations

from pathlib import Path

from restshape.live.settable_numbers import SceneNumbers
from restshape.scene.load import load_scene

FISH = Path(__file__).parents[1] / "scenes" / "fish.toml"


def test_counts_are_whole_numbers_and_lengths_are_not():
    numbers = {one.key: one for one in SceneNumbers()(load_scene(FISH, []))}
    assert numbers["effects.modal.modes"].whole
    thickness = numbers["material.brass.thickness"]
    assert (thickness.whole, thickness.unit, thickness.text) == (False, "m", "3 mm")
    assert abs(thickness.value - 0.003) < 1e-15
