"""Points of a sheet that hands hold, in scenes that have no sheet."""

from pathlib import Path

import pytest

import restshape
from restshape.errors import UserError

FISH = Path(__file__).parents[1] / "scenes" / "fish.toml"


def test_other_scenes_know_no_cloth():
    simulation = restshape.open(restshape.load(FISH))
    with simulation, pytest.raises(UserError, match="cloth"):
        simulation.press("cloth", at=[0.0, 0.0])


def test_other_scenes_have_no_table_for_it():
    with pytest.raises(UserError, match="hold"):
        restshape.load(FISH, "hold.at=[0, 0]")
