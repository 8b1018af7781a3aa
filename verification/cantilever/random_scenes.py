"""Cantilevers at random."""

from hypothesis import strategies as st
from restshape_studies.stability.plane_strategies import solid_effects, solid_scenes
from restshape_studies.stability.random_scenes import RandomScenes
from restshape_studies.stability.shape_strategies import Table


def distance(effects: Table) -> Table:
    """The distance from the goal."""
    return {"goal": {"distance": "curve"}}


goals = st.sampled_from(["spline", "polyline"]).map(
    lambda kind: {"goal": {"curve": {kind: [[-1, -1], [0, 0.4], [1, 1]]}}}
)
SCENES = RandomScenes(solid_scenes("cantilever", solid_effects(always_large=True), own=distance, more=goals))
