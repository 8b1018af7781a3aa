"""Validation cases of buckling: Euler's columns, exact plane elasticity, a ring, homogeneity."""

from collections.abc import Callable, Sequence

import numpy as np
from petsc4py import PETSc
from restshape_studies.validation.case import CLOSED_FORM, IDENTITY, PUBLISHED, ROUNDING, Check
from scipy.optimize import brentq

from restshape.application import application
from restshape.interface.first_frame import first_frame
from restshape.replay.loop import Replay

SCENES = application("solid").folder / "scenes"
E, THICKNESS, LOAD, LENGTH, PRESSED = 210e9, 0.02, 40e3, 1.0, 1e-4
FOOT, FREE = 'supports.foot.fix=["x","y"]', 'supports.head.on=["a"]'
PRESS = f"supports.head.fix={{x=0,y={-PRESSED}}}"

ENDS: dict[str, tuple[list[str], list[Callable[[float, float], float]]]] = {
    "hinged at both ends": ([], [lambda z, s, n=n: z - n * np.pi for n in (1, 2, 3)]),
    "clamped, free": ([FOOT, FREE], [lambda z, s, n=n: z - (n - 0.5) * np.pi for n in (1, 2, 3)]),
    "clamped, hinged": ([FOOT], [lambda z, s: np.sin(z) - z * np.cos(z) * (1 - s)] * 3),
    "clamped at both ends": (
        [FOOT, PRESS],
        [
            lambda z, s: z - 2 * np.pi,
            lambda z, s: np.sin(z / 2) - z / 2 * np.cos(z / 2) * (1 - s),
            lambda z, s: z - 4 * np.pi,
        ],
    ),
}
"""Overrides of the scene, and what is 0 at z = k L and s = P/S for the first three modes: docs/theory/buckling.md."""

EULER = {
    "hinged at both ends": np.pi,
    "clamped, free": np.pi / 2,
    "clamped, hinged": 4.493409457909064,
    "clamped at both ends": 2 * np.pi,
}
ROOTS = {
    "hinged at both ends": (3.14, 6.28, 9.42),
    "clamped, free": (1.57, 4.71, 7.85),
    "clamped, hinged": (4.4934, 7.7253, 10.9041),
    "clamped at both ends": (6.2832, 8.9868, 12.5664),
}
"""z of slender columns."""


def column(height: float, size: float, overrides: Sequence[str] = (), comm: PETSc.Comm = PETSc.COMM_WORLD) -> Replay:
    """The column of a height h of its section [m] on a mesh of that size [m]."""
    shape = [f"shape.vertices.b=[{height},0]", f"shape.vertices.c=[{height},{LENGTH}]", f"mesh.size={size}"]
    return first_frame(SCENES / "euler.toml", [*shape, "solve.tolerance=1e-8", *overrides], comm)


def shearing_column(height: float, condition: Callable[[float, float], float], z: float) -> float:
    """The critical load [N] of a column with shear and compression whose slender limit is P = E I z^2 / L^2."""
    area, inertia = THICKNESS * height, THICKNESS * height**3 / 12
    S, euler = 5 / 6 * E / 2 * area, E * inertia * (z / LENGTH) ** 2

    def left(P: float) -> float:
        return condition(LENGTH * np.sqrt(S * P / ((S - P) * (E - P / area) * inertia)), P / S)

    return brentq(left, 0.9 * euler, 1.01 * euler, xtol=1e-9 * euler)


def elastic_column(height: float, length: float, n: int) -> float:
    """The n-th critical stress over E of a hinged column in plane elasticity without lateral strain (nu = 0), exact.

    u = f(x) sin ky, v = g(x) cos ky, f = sum A cosh ax, g = sum B sinh ax, with no stress on the sides.
    """
    k, M, G, half = n * np.pi / length, 1.0, 0.5, height / 2

    def determinant(p: float) -> float:
        # (M a^2 - k^2 (G - p)) (G a^2 - k^2 (M - p)) + k^2 G^2 a^2 = 0
        squares = np.roots([M * G, k**2 * (G**2 - M * (M - p) - G * (G - p)), k**4 * (G - p) * (M - p)])
        a = np.sqrt(squares.astype(complex))
        b = (M * a**2 - k**2 * (G - p)) / (k * G * a)
        side = M * a * np.sinh(a * half)
        shear = (k + b * a) * np.cosh(a * half)
        value = side[0] * shear[1] - side[1] * shear[0]
        return float((value / (a[0] ** 2 - a[1] ** 2)).real)

    euler = (k * height) ** 2 / 12
    return brentq(determinant, 0.5 * euler, 1.05 * euler, xtol=1e-14)


def columns(comm: PETSc.Comm) -> list[Check]:
    """Four columns: Euler's loads in the slender limit, higher modes with shear, and plane strain."""
    checks = []
    for name, (overrides, conditions) in ENDS.items():
        unit = E * THICKNESS * PRESSED if name == "clamped at both ends" else LOAD
        for height, size in ((0.02, 0.0125), (0.005, 0.01)):
            scale = unit * height if unit != LOAD else unit
            loads = column(height, size, overrides, comm).analysis.load_factors * scale
            if height < 0.01:
                euler = E * THICKNESS * height**3 / 12 * (EULER[name] / LENGTH) ** 2
                what, source = f"{name}, h/L = 1/200: P [N]", "Euler: E I z^2 / L^2"
                checks.append(Check(what, loads[0], euler, 1e-3, source, CLOSED_FORM))
                continue
            for n, (load, condition, z) in enumerate(zip(loads, conditions, ROOTS[name]), 1):
                reference = shearing_column(height, condition, z)
                source = "Engesser's column with shear (5/6) and compression"
                what = f"{name}, h/L = 1/50, mode {n}: P [N]"
                checks.append(Check(what, load, reference, 5e-4, source, CLOSED_FORM))
    strain = ['effects.solid.model="plane_strain"', "material.steel.nu=0.3", FOOT, FREE]
    load = column(0.005, 0.01, strain, comm).analysis.load_factors[0] * LOAD
    reference = E / (1 - 0.3**2) * THICKNESS * 0.005**3 / 12 * (np.pi / 2) ** 2
    what, source = "clamped, free, in plane strain: P [N]", "Euler with E / (1 - nu^2)"
    return [*checks, Check(what, load, reference, 1e-3, source, CLOSED_FORM)]


def elastic_columns(comm: PETSc.Comm) -> list[Check]:
    """A thick hinged column against plane elasticity, and the rates at which both orders of elements come to it."""
    height, checks = 0.2, []
    exact = np.array([elastic_column(height, LENGTH, n) for n in (1, 2)]) * E * height * THICKNESS / LOAD
    source = "plane elasticity under initial stress, exact for nu = 0"
    for order, sizes, rate in ((1, (0.05, 0.025), 2.0), (2, (0.05, 0.025), 4.0)):
        errors = []
        for size in sizes:
            found = column(height, size, [f"mesh.order={order}"], comm).analysis.load_factors[:2]
            errors.append(np.abs(found / exact - 1.0))
        slope = float(np.log2(errors[0][0] / errors[1][0]))
        checks.append(Check(f"order {order}: slope of the first load factor", slope, rate, 0.05, source, CLOSED_FORM))
    for n, (value, reference) in enumerate(zip(found, exact), 1):
        checks.append(Check(f"h/L = 1/5, load factor {n}", float(value), float(reference), 5e-5, source, CLOSED_FORM))
    return checks


def ring(comm: PETSc.Comm) -> list[Check]:
    """A ring under pressure that keeps its direction, in the limit of no thickness."""
    found = []
    for height in (0.02, 0.01):
        inner, outer = 1 - height / 2, 1 + height / 2
        shape = [
            f"shape.vertices.a=[{inner},0]",
            f"shape.vertices.b=[{outer},0]",
            f"shape.vertices.d=[0,{outer}]",
            f"shape.vertices.c=[0,{inner}]",
            f"mesh.size={height}",
        ]
        analysis = first_frame(SCENES / "ring.toml", shape, comm).analysis
        found.append(analysis.load_factors[0] * 1e6 / (E * height**3 / 12))
    limit = 2.0 * found[1] - found[0]
    source = "Bodner 1958; 3 where the pressure stays normal to the ring"
    return [Check("p R^3 / (E I / b)", float(limit), 4.0, 1e-3, source, PUBLISHED)]


def homogeneity(comm: PETSc.Comm) -> list[Check]:
    """Load factors go with E, with 1/load and, for a force on a plane body, with its size."""
    base = column(0.05, 0.02, (), comm).analysis.load_factors
    stiffer = column(0.05, 0.02, ["material.steel.E=420e9"], comm).analysis.load_factors
    loads = [f"loads.{name}.force=[0,{force}]" for name, force in (("head", -8e4), ("foot", 8e4))]
    loaded = column(0.05, 0.02, loads, comm).analysis.load_factors
    half = {"b": [0.025, 0], "c": [0.025, 0.5], "d": [0, 0.5]}
    smaller = first_frame(
        SCENES / "euler.toml",
        [*(f"shape.vertices.{name}={at}" for name, at in half.items()), "mesh.size=0.01", "solve.tolerance=1e-8"],
        comm,
    ).analysis.load_factors
    return [
        Check(what, float(np.max(np.abs(factors - 1))), 0.0, tolerance, source, IDENTITY)
        for what, factors, tolerance, source in (
            # E is no power of 2: the solver's iterates are others, and end at its tolerance.
            ("with twice E", stiffer / base / 2, 1e-10, "mu ~ E"),
            ("with twice the load", loaded / base * 2, ROUNDING, "mu ~ 1 / load"),
            ("at half the size", smaller / base * 2, ROUNDING, "mu ~ size"),
        )
    ]
