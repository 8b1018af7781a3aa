"""Static solids at random, some of which buckle."""

from hypothesis import strategies as st
from restshape_studies.stability.plane_strategies import solid_effects, solid_scenes
from restshape_studies.stability.random_scenes import RandomScenes
from restshape_studies.stability.shape_strategies import Table


@st.composite
def effects(draw: st.DrawFn) -> Table:
    """The [effects] of static solids."""
    found = draw(solid_effects())
    if "large_deformation" not in found and draw(st.booleans()):
        found["buckling"] = {
            "modes": draw(st.integers(1, 4)),
            "load": draw(st.sampled_from(["given", "given", "reversed"])),
        }
    return found


def critical(effects: Table) -> Table:
    """The load factor of what buckles."""
    return {"critical": {"load_factor": 1, "at_least": 1.0}} if "buckling" in effects else {}


SCENES = RandomScenes(solid_scenes("solid", effects(), own=critical))
