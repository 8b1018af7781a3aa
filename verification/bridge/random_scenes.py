"""Bridges at random."""

from restshape_studies.stability.plane_strategies import solid_effects, solid_scenes
from restshape_studies.stability.random_scenes import RandomScenes
from restshape_studies.stability.shape_strategies import Table


def strength(effects: Table) -> Table:
    """The quantity that has a limit."""
    return {"strength": {"stress": "von_mises", "take": "max", "limit": 1e6}}


SCENES = RandomScenes(solid_scenes("bridge", solid_effects(), own=strength))
