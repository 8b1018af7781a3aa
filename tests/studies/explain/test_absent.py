"""Off means absent: no kernel of an effect is called, and no event of it happens, in a scene that does not name it.

Each case is shown with the effect on, too, where its kernels are called: nothing here holds for lack of a measure.
"""

from dataclasses import dataclass

import numpy as np
import pytest
from counted_replays import begin_log, happened, tally, watched
from small_scenes import CLAMPED, HOLE, PULLED, STEEL, across, block, drag, head, meshed, write_scene, write_script

from restshape import _kernels
from restshape.analysis.modal.modal import ModalAnalysis
from restshape.analysis.motion.transient import TransientAnalysis
from restshape.analysis.static.nonlinear import NonlinearSteadyAnalysis
from restshape.analysis.static.steady import SteadyAnalysis
from restshape.application import application
from restshape.physics.cloth.relaxation.relaxation_analysis import RelaxationAnalysis

LARGE = "[effects.large_deformation]\n"
STRETCH = '[quantities]\nstretch = { displacement = "x", at = "right" }\n'
PEAK = 'peak = { stress = "von_mises" }\n'
PLATE = block(2.0, 1.0) + HOLE + STEEL + CLAMPED + meshed(0.25)
GRAVITY = "[effects.gravity]\n"
PRESSURE = '[loads.push]\non = "right"\npressure = "1 MPa"\n'
BODY = '[loads.bulk]\non = "all"\nbody = ["1e4*x", 0]\n'
TURNED = '[supports.turned]\non = "right"\nfix = { x = "1 mm" }\n'
SECOND = "order = 1\n", "order = 2\n"
CORE = (
    "[shape.regions.core]\npolygon = [[1.2, 0.3], [1.7, 0.3], [1.7, 0.7], [1.2, 0.7]]\n"
    '[material.brass]\nE = 100e9\nnu = 0.3\nrho = 8500\nthickness = 0.01\nregion = "core"\n'
)
MOVES = '[effects.dynamics]\ntime_step = "1 ms"\nsteps = 2\n'
THICK = block(2.0, 1.0) + HOLE + STEEL.partition("[effects")[0].replace("thickness = 0.01", "thickness = 0.6")
COTTON = '[material.cotton]\nE = "2 MPa"\nnu = 0.3\nrho = 400\nthickness = "0.5 mm"\nbending = "1e-4 N m"\n'
HAMMOCK = '[supports.walls]\non = ["left", "right"]\nfix = ["x", "y", "z"]\n'
TIGHT = '[supports.wall]\non = "left"\nfix = ["x", "y", "z"]\n'
TIGHT += '[supports.pull]\non = "right"\nfix = { x = X, y = 0, z = 0 }\n'
FLOOR = "[bodies.floor]\nplane = { point = [0, 0, -0.05], normal = [0, 0, 1] }\nfriction = 0\n[effects.contact]\n"
MIRROR = '[supports.mirror]\non = "top"\nsymmetry = "y"\n'
HEMP = "orthotropic = { E = [2e6, 1e6, 1e6], nu = [0.3, 0.3, 0.3], G = [5e5, 5e5, 5e5] }"
LINEN = (
    CORE.partition("[material")[0]
    + '[material.linen]\nE = "4 MPa"\nnu = 0.3\nrho = 500\nthickness = "0.5 mm"\nregion = "core"\n'
)
WOOD = "orthotropic = { E = [14e9, 1.5e9, 0.9e9], nu = [0.3, 0.5, 0.6], G = [1.2e9, 0.9e9, 0.4e9] }"
APPLICATIONS = ("plane", "moving", "modes", "cloth")


@dataclass(frozen=True)
class Case:
    """A scene without an effect, and with it.

    Args:
        off, on: texts of the scene.
        only: kernels with their purposes, ``name.purpose``, that are called for the effect alone.
        events: that happen for it alone.
    """

    off: str
    on: str
    only: frozenset[str] = frozenset()
    events: tuple[str, ...] = ()


def case(off, more, only=(), events=()):
    """The case of a text and what is added to it for the effect."""
    return Case(off + STRETCH, off + more + STRETCH, frozenset(only), tuple(events))


def solid(head):
    """Cases of plane solids, by effect."""
    small = head + PLATE
    second = small.replace(*SECOND)
    pushed = small + LARGE + PULLED
    return {
        "gravity": case(small, GRAVITY),
        "large_deformation": case(small + PULLED, LARGE, ["stvk_tri3.tangent", "inverted_cells.field"], ["SNESSolve"]),
        "surface_loads": case(small + GRAVITY, PULLED, ["traction_edge2.residual"]),
        "following_pressure": case(pushed, PRESSURE, ["pressure_edge2.tangent"], ["MatLUFactorNum", "KSPGMRESOrthog"]),
        "body_force": case(second + PULLED, BODY, ["mass_tri6.residual"]),
        "moving_supports": case(small, TURNED),
        "regions": Case(small + PULLED + STRETCH + PEAK, small + PULLED + CORE + STRETCH + PEAK),
        "stresses": Case(
            small + PULLED + STRETCH,
            small + PULLED + STRETCH + PEAK,
            frozenset(["recover.field", "linear_elastic_tri3.stress"]),
        ),
    }


def sheets(head):
    """Cases of cloth in equilibrium, by effect."""
    cut = head + block(2.0, 1.0) + HOLE + COTTON + meshed(0.25)
    hung = cut + HAMMOCK + GRAVITY
    tight, placed = cut + GRAVITY + TIGHT, hung + FLOOR
    hinged = hung + '[effects.cloth]\nbending = "hinge"\n'
    return {
        "gravity": case(cut + TIGHT.replace("X", '"1 cm"'), GRAVITY),
        "contact": case(hung, FLOOR),
        "friction": Case(placed + STRETCH, placed.replace("friction = 0\n", "friction = 0.3\n") + STRETCH),
        "self_contact": Case(hung + "[effects.contact]\nself = false\n", hung),
        "grain": Case(hung + STRETCH, hung.replace('E = "2 MPa"\nnu = 0.3', HEMP) + STRETCH),
        # Morley's triangles hold slopes there, and need nothing more; hinges fold against their mirror images.
        "symmetry": case(hinged, MIRROR, ["hinge_mirrored_flap3.residual"]),
        "moving_supports": Case(tight.replace("X", "0") + STRETCH, tight.replace("X", '"1 cm"') + STRETCH),
        "regions": case(hung, LINEN),
    }


def all_cases():
    """Cases by application and effect."""
    found = {("plane", name): given for name, given in solid(head("plane")).items()}
    small = head("plane") + PLATE
    found["plane", "buckling"] = case(
        small.replace(*SECOND) + PULLED, "[effects.buckling]\n", ["geometric_tri6.tangent"], ["EPSSolve"]
    )
    moving = head("moving") + MOVES
    found |= {("moving", name): given for name, given in solid(moving).items()}
    shaken = '[effects.ground]\nfrequency = 5\nacceleration = "1 m/s^2"\n'
    found["moving", "ground"] = case(moving + PLATE + PULLED, shaken, ["mass_tri3.residual"])
    # Of small strains damping is in the factors of the matrices that there are.
    damped = "[effects.damping]\nalpha = 1\nbeta = 1e-4\n"
    found["moving", "damping"] = case(moving + PLATE + LARGE + PULLED, damped, ["linear_elastic_tri3.tangent"])
    beside = "[effects.modal]\nmodes = 2\n"
    found["moving", "modal"] = case(moving + PLATE + PULLED, beside, [], ["EPSSolve"])
    modal = head("modes") + THICK + "[mesh]\nsize = 0.4\norder = 1\n[effects.modal]\nmodes = 3\n"
    found["modes", "in_plane_modes"] = Case(modal, modal + "in_plane = true\n")
    wooden = modal.replace("E = 200e9\nnu = 0.3", WOOD)
    found["modes", "grain"] = Case(modal, wooden, frozenset(["anisotropic_tet4.tangent"]))
    found["modes", "regions"] = Case(modal, modal + CORE.replace("thickness = 0.01", "thickness = 0.6"))
    return found | {("cloth", name): given for name, given in sheets(head("cloth")).items()}


CASES = all_cases()


def called_for(text):
    """The kernels, ``name.purpose``, that a scene calls for at most: those of its body, its loads, and its motion."""
    if 'app = "cloth"' in text:
        parts = ("hinge_flap4", "membrane_tri3") + (() if 'bending = "hinge"' in text else ("morley_tri6",))
        points = {"membrane_stabilised_tri3.tangent", "potential_point1.tangent"}
        # Of frames of a drag: Newton's method with tensions of its own.
        points |= {"membrane_tension_tri3.tangent", "membrane_tri3.stress"}
        return points | {f"{part}.{purpose}" for part in parts for purpose in ("energy", "residual", "tangent")}
    if 'app = "modes"' in text:
        return {"linear_elastic_tet4.tangent", "mass_tet4.tangent"}
    cell, edge = ("tri6", "edge3") if "order = 2" in text else ("tri3", "edge2")
    moving, large = "[effects.dynamics]" in text, LARGE in text
    law = f"{'stvk' if large else 'linear_elastic'}_{cell}"
    found = {f"{law}.tangent"}
    if large:
        found |= {f"{law}.residual", "inverted_cells.field"}
    if moving:
        found.add(f"mass_{cell}.tangent")
    if moving and large:
        found |= {f"mass_{cell}.residual", f"mass_{cell}.energy", f"{law}.energy"}
    if moving and "[effects.gravity]" in text:
        found.add(f"{law}.residual")
    if "[loads.pull]" in text:
        found.add(f"traction_{edge}.residual")
    if "stress =" in text:
        found |= {f"{law}.stress", "recover.field"}
    return found


@pytest.fixture(scope="module", autouse=True)
def _logged():
    begin_log()


def test_every_effect_that_can_be_left_out_has_a_case():
    apps = [application(name) for name in APPLICATIONS]
    optional = {(app.name, name) for app in apps for name, effect in app.effects.items() if not effect.required}
    assert set(CASES) == optional | {(app.name, name) for app in apps for name in app.derived}


def rows_of(folder, text):
    """The rows of a short drag in a scene."""
    script = write_script(folder, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.54, 0.5), 3)))
    rows, _ = watched(write_scene(folder, text), script)
    assert not any(row["refused"] for row in rows)
    return rows


def called(rows):
    """Kernels that were called, ``name.purpose``."""
    return {f"{name}.{purpose}" for row in rows for name, purposes in row["calls"].items() for purpose in purposes}


@pytest.mark.slow
@pytest.mark.parametrize(("app", "effect"), list(CASES))
def test_off_is_absent_and_on_is_not(tmp_path, app, effect):
    given = CASES[app, effect]
    off, on = (rows_of(tmp_path, text) for text in (given.off, given.on))
    assert called(off) <= called_for(given.off)
    assert not given.only & called(off) and given.only <= called(on)
    for event in given.events:
        assert happened(off, event) == 0 < happened(on, event)
    # Where an effect has no kernel of its own, others are called more often, or for more unknowns.
    assert tally(off) != tally(on)


def wasteful(solve):
    """A solve that weighs the body although nobody asks for it."""

    def weighs(analysis, frame):
        found, mesh = solve(analysis, frame), frame.mesh
        weight = np.zeros_like(mesh.X)
        element = _kernels.Element(f"mass_tri{mesh.cells.shape[1]}")
        element.residual(mesh.X, np.zeros_like(weight), mesh.cells, np.ones(1), weight)
        return found

    return weighs


@pytest.mark.parametrize(
    ("analysis", "app", "effect"),
    [
        (SteadyAnalysis, "plane", "gravity"),
        (NonlinearSteadyAnalysis, "plane", "following_pressure"),
        (TransientAnalysis, "moving", "ground"),
        (ModalAnalysis, "modes", "in_plane_modes"),
        (RelaxationAnalysis, "cloth", "contact"),
    ],
)
def test_what_is_computed_without_being_asked_for_is_noticed(tmp_path, monkeypatch, analysis, app, effect):
    monkeypatch.setattr(analysis, "solve", wasteful(analysis.solve))
    text = CASES[app, effect].off
    assert not called(rows_of(tmp_path, text)) <= called_for(text)
