"""Plates that sound, at random."""

from hypothesis import strategies as st
from restshape_studies.stability.plane_strategies import head, materials, meshes, supports, tolerances
from restshape_studies.stability.random_scenes import RandomScenes
from restshape_studies.stability.shape_strategies import Table, numbers, shapes


@st.composite
def modal_effects(draw: st.DrawFn) -> Table:
    """The [effects] of free vibrations."""
    modal = {"model": draw(st.sampled_from(["plate", "solid", "plane_stress", "plane_strain"]))}
    return {"modal": {**modal, "modes": draw(st.integers(1, 6)), "in_plane": draw(st.booleans())}}


@st.composite
def hangings(draw: st.DrawFn, modes: int) -> Table:
    """The table of hanging points of so many modes."""
    weights = draw(st.lists(st.sampled_from((0.0, 0.5, 1.0)), max_size=modes))
    return {"weights": weights, "mode": draw(st.integers(1, modes))}


@st.composite
def quantities(draw: st.DrawFn, modes: int) -> Table:
    """The [quantities] of so many modes."""
    found: Table = {"area": {"area": True}, "first": {"frequency": 1}}
    if draw(st.booleans()):
        found["followed"] = {"mode": draw(st.integers(1, modes))}
    if draw(st.booleans()):
        found["in_tune"] = {"cents": draw(st.sampled_from(("C5", "F#3", "Bb7"))), "mode": draw(st.integers(1, modes))}
    if modes > 1 and draw(st.booleans()):
        found["overtone"] = {"ratio": draw(st.integers(2, modes))}
    return found


@st.composite
def scenes(draw: st.DrawFn) -> Table:
    """The tables of a scene of a plate."""
    shape, area = draw(shapes())
    effects = draw(modal_effects())
    scene = {"shape": shape, "material": draw(materials(shape, True)), "effects": effects}
    scene = head("metallophone", draw(numbers(-0.2, 0.2))) | scene
    if draw(st.booleans()):
        scene["supports"] = draw(supports(shape, effects["modal"]["model"] == "plate", True))
    elif effects["modal"]["model"] in ("plate", "solid") and draw(st.booleans()):
        effects["modal"]["hanging"] = draw(hangings(effects["modal"]["modes"]))
    scene["mesh"] = draw(meshes(area, effects))
    scene["solve"] = {"tolerance": draw(tolerances)}
    scene["quantities"] = draw(quantities(effects["modal"]["modes"]))
    return scene


SCENES = RandomScenes(scenes())
