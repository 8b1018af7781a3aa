"""Validation cases of plates that sound: beams, bars, plates, discs, derivatives, and modes that cross."""

from collections.abc import Sequence

import numpy as np
from petsc4py import PETSc
from restshape_studies.each_week import each_week
from restshape_studies.validation.case import CLOSED_FORM, IDENTITY, PROGRAM, PUBLISHED, ROUNDING, Case, Check, Kind
from restshape_verification.metallophone.exactness import discrete, norms, rates, remainders
from restshape_verification.metallophone.hanging import hanging
from restshape_verification.metallophone.heard import heard
from restshape_verification.metallophone.reference import EDITS, SCENES, solved, timoshenko
from restshape_verification.metallophone.tuned import tuned_bars
from restshape_verification.metallophone.validation_rasping import rasping

from restshape.algebra.eigenproblems.clusters import CLUSTER
from restshape.analysis.modal.modal import ModalAnalysis
from restshape.interface.replays import replay_files
from restshape.sensitivity.frequency_derivative import frequency_derivatives, material_derivatives

CANTILEVER = (8.35516595, 52.36093119, 146.61212348)
"""Euler and Bernoulli's frequencies [Hz] of 1 m x 10 mm of steel; they grow with the height."""

PLATE = ["effects.modal.model=plate", "effects.modal.modes=4"]
"""Overrides of a bar that is replayed as a plate."""

FAR = (("c", 200), ("d", 0))
FREE_BEAM = tuple(
    beta**2 / (2 * np.pi) * np.sqrt(70e9 / 2700.0 / 12) * 4e-4 / 0.2**2
    for beta in (4.73004074486, 7.8532046241, 10.995607838, 14.1371654913)
)
"""Frequencies [Hz] of 200 mm x 0.4 mm of aluminium, free at both ends."""

BARS = {
    100: (2089.35, 4008.1, 5737.3, 8358.8, 11128.5),
    150: (930.03, 2563.1, 2654.2, 5013.5, 5433.2),
    200: (523.31, 1443.0, 1984.5, 2828.2, 3648.2),
}
"""Frequencies [Hz] of free bars of aluminium L x 30 x 4 mm by p-FEM of three-dimensional elasticity."""

FV12 = (1.62165, 2.35950, 2.92228, 4.19024, 4.19024, 7.35600, 7.35600, 7.66821)
FV13 = (2.37672, 5.94181, 5.94181, 9.50689, 11.88361, 11.88361, 15.44870, 15.44870)
FREE_RECTANGLE = (21.4632, 26.5749, 58.4820, 59.6061, 88.0097, 101.503)
"""omega a^2 sqrt(rho h / D) of a free rectangle, a/b = 2, nu = 0.3, by a converged Ritz method."""

CLAMPED_DISC = (10.2158262, 21.2603977, 21.2603977, 34.8770354, 34.8770354, 39.7711482)
SUPPORTED_DISC = (4.93514904, 13.8981651, 13.8981651, 25.6132967, 25.6132967)
"""omega r^2 sqrt(rho h / D) of discs, the second for nu = 0.3."""


def beside(
    what: str,
    analysis: ModalAnalysis,
    reference: Sequence[float],
    tolerance: float,
    source: str,
    kind: Kind = CLOSED_FORM,
    factor: float = 1.0,
) -> list[Check]:
    """Frequencies [Hz], times a factor, beside references."""
    pairs = enumerate(zip(factor * analysis.frequencies, reference), 1)
    return [Check(f"{what}, mode {k} [Hz]", float(f), ref, tolerance, source, kind) for k, (f, ref) in pairs]


def plate_unit(analysis: ModalAnalysis, length: float) -> float:
    """sqrt(D / (rho h)) / (2 pi length^2) [Hz] of the scene's only material."""
    m = next(iter(analysis.state.scene.material.values()))
    D = m.E * m.thickness**3 / (12 * (1 - m.nu**2))
    return float(np.sqrt(D / (m.rho * m.thickness)) / (2 * np.pi * length**2))


def beams(comm: PETSc.Comm) -> list[Check]:
    """Slender cantilevers in the plane and as a plate, and a thick beam with shear and rotary inertia."""
    euler = "Euler and Bernoulli"
    # In the slender limit f grows with the height: brought to 10 mm, shear is left out of these thinner ones.
    plane = solved("slender.toml", comm)
    checks = beside("cantilever in plane stress, 5 mm brought to 10", plane, CANTILEVER, 1e-3, euler, factor=2.0)
    supported = [f"supports.{side}.{key}" for side in ("left", "right") for key in ('on="left"', 'fix=["z","rx","ry"]')]
    plate = solved("strip.toml", comm, [*supported, 'material.steel.thickness="1 mm"'])
    checks += beside("cantilever as a plate, 1 mm brought to 10", plate, CANTILEVER, 1e-3, euler, factor=10.0)
    narrow = ["effects.modal.model=plate", "effects.modal.modes=4", "material.aluminium.nu=0", 'mesh.size="2.5 mm"']
    narrow += ['material.aluminium.thickness="0.4 mm"', *(f'shape.vertices.{v}=["{x} mm", "6 mm"]' for v, x in FAR)]
    free = solved("bar_200.toml", comm, narrow)
    checks += beside("free beam, height 1/500", free, FREE_BEAM, 1e-3, euler)
    thick = solved("strip.toml", comm, ["effects.modal.modes=2"])
    exact = [timoshenko(k, 1.0, 0.1, 210e9, 0.0, 7850.0) for k in (1, 2)]
    return checks + beside("supported beam, height 1/10", thick, exact, 1e-4, "Timoshenko, shear factor 5/6")


@each_week(BARS={100: BARS[100]})
def bars(comm: PETSc.Comm) -> list[Check]:
    """Free bars of the thesis's sizes against three-dimensional elasticity, five modes, those in the plane included."""
    checks = []
    for length, reference in BARS.items():
        mesh = ["mesh.order=2", "mesh.layers=2", 'mesh.size="6 mm"', 'mesh.near.outline="2.5 mm"']
        settings = ["effects.modal.modes=5", "effects.modal.in_plane=true"]
        bar = solved(f"bar_{length}.toml", comm, [*mesh, *settings])
        checks += beside(f"bar of {length} mm", bar, reference, 5e-3, "p-FEM of 3D elasticity", PROGRAM)
    return checks


def plates(comm: PETSc.Comm) -> list[Check]:
    """Thin plates: free squares and rectangles, simply supported and clamped squares."""
    square = solved("square.toml", comm)
    checks = beside("FV12, free square", square, FV12, 5e-3, "NAFEMS FV12, Kirchhoff's plate", PUBLISHED)
    rectangle = ["shape.vertices.c=[10, 5]", "shape.vertices.d=[0, 5]", "effects.modal.modes=6", "mesh.size=0.25"]
    free = solved("square.toml", comm, rectangle)
    unit = plate_unit(free, 10.0)
    checks += beside("free rectangle, a/b = 2", free, [unit * x for x in FREE_RECTANGLE], 5e-3, "Ritz", PROGRAM)
    checks += beside("supported square", solved("supported.toml", comm), FV13, 5e-3, "closed form, thin plate")
    all_around = [f'supports.along_{axis}.fix=["z","rx","ry"]' for axis in "xy"]
    clamped = solved("supported.toml", comm, [*all_around, "effects.modal.modes=1"])
    lowest = 35.985 * plate_unit(clamped, 10.0)
    return checks + beside("clamped square", clamped, [lowest], 5e-3, "Leissa 1973", PUBLISHED)


def discs(comm: PETSc.Comm) -> list[Check]:
    """Thin discs, clamped and simply supported, against Bessel functions."""
    clamped = solved("disc.toml", comm)
    unit = plate_unit(clamped, 1.0)
    checks = beside("clamped disc", clamped, [unit * x for x in CLAMPED_DISC], 5e-3, "Bessel functions")
    free = solved("disc.toml", comm, ['supports.rim.fix=["z"]', "effects.modal.modes=5"])
    return checks + beside("supported disc", free, [unit * x for x in SUPPORTED_DISC], 5e-3, "Bessel functions")


def grain(comm: PETSc.Comm) -> list[Check]:
    """A simply supported orthotropic plate, its grain along x and along y, against Navier's solution."""
    checks = []
    for what, turn in (("grain along x", "0 deg"), ("grain along y", "90 deg")):
        plate = solved("rosewood.toml", comm, [f'material.wood.grain="{turn}"'])
        exact = navier(plate, 0.3, 0.2, turn != "0 deg")
        checks += beside(what, plate, exact, 5e-3, "Navier: thin orthotropic plate")
    return checks


def navier(analysis: ModalAnalysis, a: float, b: float, across: bool) -> list[float]:
    """The lowest frequencies [Hz] of a thin, simply supported plate a x b, from its material's constants."""
    m = next(iter(analysis.state.scene.material.values()))
    (E1, E2, _), (nu12, *_), (G12, *_) = m.orthotropic.E, m.orthotropic.nu, m.orthotropic.G
    if across:
        a, b = b, a
    third = m.thickness**3 / 12
    root = 1 - nu12**2 * E2 / E1
    D1, D2, mixed = E1 * third / root, E2 * third / root, nu12 * E2 * third / root + 2 * G12 * third
    square = [
        D1 * (j / a) ** 4 + 2 * mixed * (j / a) ** 2 * (k / b) ** 2 + D2 * (k / b) ** 4
        for j in range(1, 9)
        for k in range(1, 9)
    ]
    return [float(0.5 * np.pi * np.sqrt(s / (m.rho * m.thickness))) for s in sorted(square)]


def identities(comm: PETSc.Comm) -> list[Check]:
    """What homogeneity says of derivatives: to rounding, with the discrete frequencies themselves."""
    checks = []
    for scene, overrides, what in (
        ("bar_100.toml", ["solve.tolerance=1e-9"], "tetrahedra"),
        ("bar_100.toml", ["solve.tolerance=1e-9", "mesh.order=2", "mesh.layers=1"], "second-order tetrahedra"),
        ("square.toml", ["solve.tolerance=1e-9", "effects.modal.modes=1", "material.steel.thickness=0.01"], "plate"),
    ):
        bar = solved(scene, comm, overrides)
        f, X, name = float(bar.frequencies[0]), bar.state.body.space.X, next(iter(bar.state.scene.material))
        scaled = float(frequency_derivatives(bar, X)[0])
        by = material_derivatives(bar, int(bar.state.modes.chosen[0]))[name]
        material = bar.state.scene.material[name]
        source = "f is homogeneous"
        checks += [
            Check(f"{what}: X . df/dX [Hz]", scaled, -f, 1e-10, source + ", of degree -1 in all lengths", IDENTITY),
            Check(f"{what}: E df/dE [Hz]", material.E * by["E"], 0.5 * f, 1e-10, source, IDENTITY),
            Check(f"{what}: rho df/drho [Hz]", material.rho * by["rho"], -0.5 * f, ROUNDING, source, IDENTITY),
        ]
        if what == "plate":
            thicker = np.zeros_like(X)
            thicker[:, 2] = X[:, 2]
            rate = float(frequency_derivatives(bar, thicker)[0])
            checks.append(Check("plate: h df/dh [Hz]", rate, f, 2e-3, "thin plate: f ~ h", CLOSED_FORM))
    return checks


def pair(comm: PETSc.Comm) -> list[Check]:
    """The pair of a supported square stretched along x: -2 pi^2 and -8 pi^2 in units, where the naive formula mixes."""
    supported = [f"mesh.size={0.2}", "effects.modal.modes=3"]
    square = solved("supported.toml", comm, supported)
    stretch = np.zeros_like(square.state.body.space.X)
    stretch[:, 0] = square.state.body.space.X[:, 0]
    rates = np.sort(frequency_derivatives(square, stretch, CLUSTER)[1:3])
    unit = plate_unit(square, 10.0)
    source = "omega_mn = pi^2 (m^2/a^2 + n^2), differentiated"
    references = (-8 * np.pi**2 * unit, -2 * np.pi**2 * unit)
    return [
        Check(f"a df/da of the pair, {which} [Hz]", float(rate), ref, 5e-3, source, CLOSED_FORM)
        for which, rate, ref in zip(("steeper", "flatter"), rates, references)
    ]


def crossing(comm: PETSc.Comm) -> list[Check]:
    """A bar is shortened until bending overtakes torsion: each mode keeps its number."""
    rows = replay_files(SCENES / "bar_150.toml", EDITS / "crossing.jsonl", "auto", PLATE)["rows"]
    drag = [rows[0], *(row for row in rows if row["event"] == "drag")]

    def followed(row: dict, number: int) -> float:
        return row[f"f_{row['mode_ids'].split().index(str(number)) + 1}"]

    bending, torsion = ((followed(drag[0], n), followed(drag[-1], n)) for n in (2, 3))
    grown = 0.15 / 0.12
    # By the frequencies of the bar of 150 mm: 2563 and 2654 Hz, which become 4005 and 3318 Hz.
    at_first, at_last = "L = 150 mm, p-FEM", "L = 120 mm, f ~ 1/L^2 and 1/L from p-FEM"
    long, twist = "bending: f ~ 1/L^2", "torsion: f ~ 1/L, less its ends"
    return [
        Check("rank of the second bending mode, first frame", _rank(drag[0], 2), 2, 0, at_first, PROGRAM),
        Check("rank of the same mode, last frame", _rank(drag[-1], 2), 3, 0, at_last, PROGRAM),
        Check("its growth", bending[1] / bending[0], grown**2, 1e-2, long, CLOSED_FORM),
        Check("growth of the torsional mode", torsion[1] / torsion[0], grown, 1e-2, twist, CLOSED_FORM),
    ]


def _rank(row: dict, number: int) -> int:
    """The rank of the mode of that number in a frame."""
    return row["mode_ids"].split().index(str(number)) + 1


CASES: dict[str, Case] = {
    "beams": beams,
    "bars": bars,
    "plates": plates,
    "discs": discs,
    "grain": grain,
    "identities": identities,
    "pair": pair,
    "crossing": crossing,
    "heard": heard,
    "discrete": discrete,
    "rates": rates,
    "norms": norms,
    "remainders": remainders,
    "hanging": hanging,
    "tuned": tuned_bars,
    "rasping": rasping,
}
