"""Off means absent: a scene with an effect off costs what its body costs, which follows from the mesh.

Counted are unknowns, elements, matrix entries, calls of kernels by purpose, and PETSc's events, in the first frame and
in those that move nodes; and all this changes where the effect is on, so that nothing here holds for lack of a measure.
"""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from called import LARGE, Law
from called_cloth import ClothLaw
from counted_replays import begin_log, happened, kernels, tally, watched
from small_scenes import CLAMPED, HEAD, HOLE, PULLED, STEEL, across, block, drag, meshed, write_scene, write_script

from restshape import _kernels
from restshape.analysis.modal import ModalAnalysis
from restshape.analysis.nonlinear import NonlinearSteadyAnalysis
from restshape.analysis.steady import SteadyAnalysis
from restshape.analysis.transient import TransientAnalysis
from restshape.application import applications
from restshape.physics.cloth.relaxation.analysis import RelaxationAnalysis

STRETCH = '[quantities]\nstretch = { displacement = "x", at = "right" }\n'
PEAK = 'peak = { stress = "von_mises" }\n'
PLATE = block(2.0, 1.0) + HOLE + STEEL + CLAMPED + meshed(0.25)
GRAVITY = "[effects.gravity]\n"
PRESSURE = '[loads.push]\non = "right"\npressure = "1 MPa"\n'
BODY = '[loads.bulk]\non = "all"\nbody = ["1e4*x", 0]\n'
TURNED = '[supports.turned]\non = "right"\nfix = { x = "1 mm" }\n'
SECOND = "[mesh]\nsize = 0.25\n", "[mesh]\nsize = 0.25\norder = 2\n"
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


@dataclass(frozen=True)
class Case:
    """A scene without an effect, and with it.

    Args:
        off, on: texts of the scene.
        kernels: that are called for the effect only.
        events: that happen for it only.
    """

    off: str
    on: str
    kernels: frozenset[str] = frozenset()
    events: tuple[str, ...] = ()


def case(off, more, names=(), events=()):
    """The case of a text and what is added to it for the effect."""
    return Case(off + STRETCH, off + more + STRETCH, frozenset(names), tuple(events))


def solid(head):
    """Cases of plane Static solids of small strains."""
    small = head + PLATE
    second = small.replace(*SECOND)
    pushed = small + LARGE + PULLED
    return {
        "gravity": case(small, GRAVITY),
        "large_deformation": case(small + PULLED, LARGE, ["stvk_tri3", "inverted_cells"], ["SNESSolve"]),
        "surface_loads": case(small + GRAVITY, PULLED, ["traction_edge2"]),
        "following_pressure": case(pushed, PRESSURE, ["pressure_edge2"], ["MatLUFactorNum", "KSPGMRESOrthog"]),
        "body_force": case(second + PULLED, BODY, ["mass_tri6"]),
        "moving_supports": case(small, TURNED),
        "regions": Case(small + PULLED + STRETCH + PEAK, small + PULLED + CORE + STRETCH + PEAK),
        "stresses": Case(small + PULLED + STRETCH, small + PULLED + STRETCH + PEAK, frozenset(["recover"])),
    }


def sheets(head):
    """Cases of cloth that is relaxed to equilibrium."""
    cut = head + block(2.0, 1.0) + HOLE + COTTON + meshed(0.25)
    hung = cut + HAMMOCK + GRAVITY
    tight, laid = cut + GRAVITY + TIGHT, hung + FLOOR
    hinged = hung + '[effects.cloth]\nbending = "hinge"\n'
    return {
        "gravity": case(cut + TIGHT.replace("X", '"1 cm"'), GRAVITY),
        "contact": case(hung, FLOOR),
        "friction": Case(laid + STRETCH, laid.replace("friction = 0\n", "friction = 0.3\n") + STRETCH),
        "grain": Case(hung + STRETCH, hung.replace('E = "2 MPa"\nnu = 0.3', HEMP) + STRETCH),
        # Morley's triangles hold slopes there, and need nothing more; hinges fold against their mirror images.
        "symmetry": case(hinged, MIRROR, ["hinge_mirrored_flap3"]),
        "moving_supports": Case(tight.replace("X", "0") + STRETCH, tight.replace("X", '"1 cm"') + STRETCH),
        "regions": case(hung, LINEN),
    }


def all_cases():
    """Cases by application and effect."""
    heads = {name: HEAD.replace('"solid"', f'"{name}"') for name in applications()}
    found = {("solid", name): given for name, given in solid(heads["solid"]).items()}
    small = heads["solid"] + PLATE
    found["solid", "buckling"] = case(small + PULLED, "[effects.buckling]\n", ["geometric_tri6"])
    found |= {("bridge", name): given for name, given in solid(heads["bridge"]).items()}
    large = solid(heads["cantilever"].replace(LARGE, ""))
    del large["large_deformation"]
    for name, given in large.items():
        texts = (text.replace(LARGE, "") for text in (given.off, given.on))
        found["cantilever", name] = Case(*texts, given.kernels, given.events)
    moving = heads["vibration"] + MOVES
    found |= {("vibration", name): given for name, given in solid(moving).items()}
    # Of second order the mass of the body has the kernel of its body forces.
    body = found["vibration", "body_force"]
    found["vibration", "body_force"] = replace(body, kernels=frozenset())
    shaken = '[effects.ground]\nfrequency = 5\nacceleration = "1 m/s^2"\n'
    found["vibration", "ground"] = case(moving + PLATE + PULLED, shaken)
    # Of small strains damping is in the factors of the matrices that there are.
    damped = "[effects.damping]\nalpha = 1\nbeta = 1e-4\n"
    found["vibration", "damping"] = case(moving + PLATE + LARGE + PULLED, damped, ["linear_elastic_tri3"])
    modal = heads["metallophone"] + THICK + "[mesh]\nsize = 0.4\norder = 1\n[effects.modal]\nmodes = 3\n"
    found["metallophone", "in_plane_modes"] = Case(modal, modal + "in_plane = true\n")
    isotropic = "E = 200e9\nnu = 0.3"
    found["metallophone", "grain"] = Case(modal, modal.replace(isotropic, WOOD), frozenset(["anisotropic_tet4"]))
    found["metallophone", "regions"] = Case(modal, modal + CORE.replace("thickness = 0.01", "thickness = 0.6"))
    return found | {("couture", name): given for name, given in sheets(heads["couture"]).items()}


CASES = all_cases()


@pytest.fixture(scope="module", autouse=True)
def _logged():
    begin_log()


def test_every_effect_of_every_application_has_a_case():
    # Those with a session of their own have no kernels of elements, and the law here is that of bodies that deform:
    # the tests of furniture and of heat look at theirs.
    meshed = [app for app in applications().values() if not app.session and app.name != "thermal"]
    optional = {(app.name, name) for app in meshed for name, e in app.effects.items() if not e.required}
    derived = {(app.name, name) for app in meshed for name in app.derived}
    assert set(CASES) == optional | derived


def rows_of(folder, app, text):
    """The rows of a short drag, and the law that they obey in a scene without anything but its body."""
    script = write_script(folder, drag("window", (0.5, 0.5), across((0.5, 0.5), (0.54, 0.5), 3)))
    rows, replay = watched(write_scene(folder, text), script)
    mesh = replay.analysis.state.body.space if app == "metallophone" else replay.analysis.space
    if app == "couture":
        return rows, ClothLaw(text, mesh.cells, len(mesh.X))
    return rows, Law(app, text, mesh.cells, len(mesh.X))


@pytest.mark.parametrize(("app", "effect"), list(CASES))
def test_off_is_absent_and_on_is_not(tmp_path, app, effect):
    given = CASES[app, effect]
    (off, law), (on, _) = (rows_of(tmp_path, app, text) for text in (given.off, given.on))
    assert not any(row["refused"] for row in off + on)
    law.hold(off)
    assert tally(off) != tally(on)
    assert not given.kernels & kernels(off)
    assert given.kernels <= kernels(on)
    for event in given.events:
        assert happened(off, event) == 0 < happened(on, event)


@pytest.mark.parametrize("effect", sorted(name for app, name in CASES if app == "bridge"))
def test_what_two_applications_share_costs_the_same_in_both(tmp_path, effect):
    ours, theirs = CASES["solid", effect], CASES["bridge", effect]
    for mine, other in ((ours.off, theirs.off), (ours.on, theirs.on)):
        assert tally(rows_of(tmp_path, "solid", mine)[0]) == tally(rows_of(tmp_path, "bridge", other)[0])


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
        (SteadyAnalysis, "solid", "gravity"),
        (SteadyAnalysis, "bridge", "regions"),
        (NonlinearSteadyAnalysis, "cantilever", "following_pressure"),
        (TransientAnalysis, "vibration", "gravity"),
        (TransientAnalysis, "vibration", "ground"),
        (ModalAnalysis, "metallophone", "in_plane_modes"),
        (RelaxationAnalysis, "couture", "contact"),
    ],
)
def test_the_law_notices_what_is_computed_without_being_asked_for(tmp_path, monkeypatch, analysis, app, effect):
    monkeypatch.setattr(analysis, "solve", wasteful(analysis.solve))
    rows, law = rows_of(tmp_path, app, CASES[app, effect].off)
    with pytest.raises(AssertionError):
        law.hold(rows)
