"""Bars tuned to tones beside closed forms, an independent model, other starts, and what makes a change the smallest."""

import numpy as np
from petsc4py import PETSc
from restshape_apps.metallophone.tuning.bar import Bar
from restshape_apps.metallophone.tuning.descent import Descent
from restshape_apps.metallophone.tuning.freedoms import freedoms_of, with_fixed_curves
from restshape_apps.metallophone.tuning.tuning import SOLVES, SOLVES_OF_RATIOS, Tuning, tuned
from restshape_apps.metallophone.tuning.wanted import Wanted, wanted_tones
from restshape_studies.each_week import each_week
from restshape_studies.validation.case import CLOSED_FORM, IDENTITY, Check

from restshape.application import application
from restshape.interface.first_frame import first_frame
from restshape.scene.load import load_scene

FOLDER = application("metallophone").folder
BAR, UNDERCUT, FISH = (
    FOLDER / "template/scene.toml",
    FOLDER / "template/undercut/scene.toml",
    FOLDER / "scenes/fish.toml",
)
THICKNESS = "material.aluminium.thickness"
THIN = ["material.aluminium.nu=0", f'{THICKNESS}="0.5 mm"', "effects.modal.modes=1", 'mesh.near.outline="8 mm"']
LENGTH = ["shape.vertices.a.0", "shape.vertices.b.0", "shape.vertices.c.0", "shape.vertices.d.0"]
TETRAHEDRA = ["effects.modal.model=solid", "mesh.order=2", "mesh.layers=2"]
SIZES = ['mesh.size="7 mm"', 'mesh.near.outline="3.5 mm"']
"""Of the tetrahedra."""
CENTS_5 = 2.0 ** (5.0 / 1200.0) - 1.0
E, RHO = 70e9, 2700.0


def free_bar(thickness: float, length: float) -> float:
    """The lowest frequency [Hz] of a thin free bar of aluminium by Euler and Bernoulli."""
    return float(4.73004074486**2 / (2.0 * np.pi) * np.sqrt(E / (12.0 * RHO)) * thickness / length**2)


def overrides(tuning: Tuning) -> list[str]:
    """The tuned numbers as words of --set."""
    pairs = ((".".join(key), f'"{value}"' if isinstance(value, str) else value) for key, value in tuning.changes())
    return [f"{key}={value}" for key, value in pairs]


def hertz(frequency: float) -> Wanted:
    """A wanted frequency [Hz] alone."""
    return Wanted(f"{frequency:g} Hz", (1.0,), (frequency,))


def closed_forms() -> list[Check]:
    """The thickness and the length of a thin bar of a frequency, and no more than the solves that a tone may take."""
    thin, wanted = load_scene(BAR, THIN), free_bar(0.7e-3, 0.17)
    thick = tuned(thin, hertz(wanted), [THICKNESS])
    long = tuned(thin, hertz(free_bar(0.5e-3, 0.2)), LENGTH)
    (thickness,), (a, b, *_) = thick.found.last.values, long.found.last.values
    # Both ways to one bar: from what the other freedom was tuned to.
    both = hertz(free_bar(0.7e-3, 0.2))
    longer = tuned(load_scene(BAR, [*THIN, *overrides(thick)]), both, LENGTH)
    thicker = tuned(load_scene(BAR, [*THIN, *overrides(long)]), both, [THICKNESS])
    a_2, b_2, *_ = longer.found.last.values
    (thickness_2,) = thicker.found.last.values
    other = "Euler and Bernoulli's free bar, from one tuned by another freedom"
    source = "Euler and Bernoulli's free bar, f ~ h/L^2"
    return [
        Check("thickness of a thin bar of a frequency [m]", float(thickness), 0.7e-3, 5e-3, source, CLOSED_FORM),
        Check("length of a thin bar of a frequency [m]", float(b - a), 0.2, 5e-3, source, CLOSED_FORM),
        Check("length of a bar that its thickness had tuned [m]", float(b_2 - a_2), 0.2, 5e-3, other, CLOSED_FORM),
        Check("thickness of one that its length had tuned [m]", float(thickness_2), 0.7e-3, 5e-3, other, CLOSED_FORM),
        Check("solves beyond 12", max(thick.solves, long.solves, SOLVES) - SOLVES, 0, 0, "the most allowed", IDENTITY),
    ]


def by_tetrahedra(comm: PETSc.Comm) -> list[Check]:
    """A plate that is tuned by its outline, as tetrahedra of second order on a finer mesh: an independent model."""
    fine = ['mesh.size="6 mm"', 'mesh.near.outline="3 mm"']
    plate = tuned(load_scene(BAR, [*fine, "effects.modal.modes=1"]), wanted_tones("F5", None, 440.0))
    solid = first_frame(BAR, [*overrides(plate), *TETRAHEDRA, *SIZES, "effects.modal.modes=1"], comm).analysis
    wanted, tone = plate.wanted.frequencies[0], float(plate.found.last.frequencies[0])
    exact = float(solid.frequencies[0])
    return [
        Check("tone by the plate that was tuned [Hz]", tone, wanted, 3e-5, "F5", IDENTITY),
        Check("tone by tetrahedra [Hz]", exact, wanted, CENTS_5, "F5, in 3D elasticity", IDENTITY),
    ]


def undercut(comm: PETSc.Comm) -> list[Check]:
    """An undercut bar brought to 1 : 4 : 10, replayed from its scene; and to a tone by one number from two starts."""
    three = tuned(load_scene(UNDERCUT), wanted_tones("C4", "1:4:10", 440.0), ["middle", "between", "reach"])
    first, second, third = first_frame(UNDERCUT, overrides(three), comm).analysis.frequencies[[0, 2, 4]]
    starts = ([], ['parameters.middle="6 mm"'])
    one, other = (tuned(load_scene(UNDERCUT, start), wanted_tones("C4", None, 440.0), ["middle"]) for start in starts)
    away = float(other.found.last.values[0]), float(one.found.last.values[0])
    beyond = max(three.solves, SOLVES_OF_RATIOS) - SOLVES_OF_RATIOS
    return [
        Check("second bending mode over the first", float(second / first), 4.0, 2e-5, "asked for", IDENTITY),
        Check("third bending mode over the first", float(third / first), 10.0, 2e-5, "asked for", IDENTITY),
        Check("solves beyond 25", beyond, 0, 0, "the most allowed", IDENTITY),
        Check("thickness in the middle from another start [m]", *away, 2e-5, "one freedom, one tone: unique", IDENTITY),
    ]


def smallest() -> list[Check]:
    """At the smallest change it is, in the metric, a multiple of the gradient of the tone."""
    scene = with_fixed_curves(load_scene(BAR, ["effects.modal.modes=1"]))
    freedoms = freedoms_of(scene, [])
    bar = Bar(scene, freedoms)
    ids = [int(bar.analysis.state.modes.ids.ids[bar.analysis.state.modes.chosen[0]])]
    descent = Descent(bar, ids, np.array([698.4565]), np.full((len(freedoms), 2), np.nan), SOLVES)
    found = descent.run()
    force = descent._motions.metric @ (found.last.values - descent.start)
    slope = found.derivatives[0]
    cosine = abs(float(force @ slope)) / float(np.linalg.norm(force) * np.linalg.norm(slope))
    return [Check("cosine between G q and the gradient of the tone", cosine, 1, 1e-7, "Lagrange's condition", IDENTITY)]


@each_week(SIZES=['mesh.size="12 mm"', 'mesh.near.outline="12 mm"'])
def tuned_bars(comm: PETSc.Comm) -> list[Check]:
    """Bars tuned to tones: closed forms, tetrahedra beside a plate that was tuned, other starts, the least change."""
    return [*closed_forms(), *by_tetrahedra(comm), *undercut(comm), *smallest()]
