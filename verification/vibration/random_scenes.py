"""Solids that vibrate, at random."""

from hypothesis import strategies as st
from restshape_studies.stability.plane_strategies import solid_effects, solid_scenes
from restshape_studies.stability.random_scenes import RandomScenes, never
from restshape_studies.stability.shape_strategies import Table


@st.composite
def motion(draw: st.DrawFn) -> Table:
    """The [effects] of motion in time."""
    newmark = draw(st.sampled_from([{}, {"beta": 0.3025, "gamma": 0.6}, {"mass": "lumped"}, {"beta": 0.05}]))
    step = draw(st.sampled_from([0.01, 1e-4, 1.0]))
    found: Table = {"dynamics": {"time_step": step, "steps": draw(st.integers(1, 4)), **newmark}}
    if draw(st.booleans()):
        kind = draw(st.sampled_from(["displacement", "acceleration"]))
        found["ground"] = {kind: draw(st.sampled_from([0.1, 10.0])), "frequency": draw(st.sampled_from([2.0, 200.0]))}
    if draw(st.booleans()):
        ways = [{"ratio": 0.02, "frequencies": [1.0, 30.0]}, {"alpha": 0.5, "beta": 1e-3}, {"beta": 0.1}]
        found["damping"] = draw(st.sampled_from(ways))
    return found


@st.composite
def effects(draw: st.DrawFn) -> Table:
    """The [effects] of solids that vibrate."""
    return draw(solid_effects()) | draw(motion())


SCENES = RandomScenes(
    solid_scenes("vibration", effects(), energies=("total", "edit")), heads=({}, {}, {}), predictable=never
)
