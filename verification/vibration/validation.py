"""Validation cases of vibrating solids: period, energy and order of Newmark's method, a beam's frequency."""

from collections.abc import Callable, Iterator, Sequence
from types import SimpleNamespace

import numpy as np
from petsc4py import PETSc
from restshape_studies.validation.case import CLOSED_FORM, IDENTITY, Case, Check
from restshape_verification.vibration.large import csm3
from scipy.linalg import expm
from scipy.optimize import brentq

from restshape.analysis.frame import Frame
from restshape.analysis.modal.frequencies import lowest_modes
from restshape.analysis.motion.transient import TransientAnalysis
from restshape.application import application
from restshape.interface.first_frame import first_frame
from restshape.replay.loop import Replay

SCENES = application("vibration").folder / "scenes"
STILL_GROUND = "effects.ground.displacement=0"
PRECISION = 1e-11
"""Of a frequency from 60 steps, each solved by a complete factor."""
NO_CELLS = np.empty(0, dtype=np.int32)


def idle(replay: Replay, frames: int) -> Iterator[TransientAnalysis]:
    """The analysis after each of so many frames in which nothing is edited."""
    analysis = replay.analysis
    for _ in range(frames):
        analysis.solve(Frame(replay.moving.mesh, NO_CELLS, None, analysis.state.scene, (None, (0.0, 0.0))))
        yield analysis


def first_mode(analysis: TransientAnalysis) -> tuple[float, np.ndarray, np.ndarray]:
    """Angular frequency [rad/s], mode phi (n, 2) and M phi (n, 2) of the lowest eigenvalue, with phi^T M phi = 1."""
    stiffness, mass, _ = analysis.matrices()
    omega, modes = lowest_modes(stiffness, mass, 1)
    phi = np.zeros(analysis.body.constrained.shape)
    phi[~analysis.body.constrained] = modes[:, 0]
    weight = np.where(analysis.body.constrained, 0.0, analysis.body.mass.apply(phi))
    return float(omega[0]), phi, weight


def column(comm: PETSc.Comm, overrides: Sequence[str] = ()) -> Replay:
    """The clamped column at rest, a time step a frame."""
    return first_frame(SCENES / "column.toml", ["effects.dynamics.steps=1", *overrides], comm)


def period(comm: PETSc.Comm) -> list[Check]:
    """Period elongation of one mode against its closed form, for steps from a hundredth to a fifth of the period."""
    omega = first_mode(column(comm).analysis)[0]
    checks = []
    for share in (0.01, 0.02, 0.05, 0.1, 0.2):
        dt = share * 2 * np.pi / omega
        replay = column(comm, [STILL_GROUND, f"effects.dynamics.time_step={dt!r}"])
        _, phi, weight = first_mode(replay.analysis)
        replay.analysis.begin(phi, 0 * phi)
        q = np.array([1.0, *(np.vdot(weight, analysis.x) for analysis in idle(replay, 60))])
        # A discrete harmonic obeys q(n+1) + q(n-1) = 2 cos(w dt) q(n).
        cosine = q[1:-1] @ (q[2:] + q[:-2]) / (2 * q[1:-1] @ q[1:-1])
        half = 0.5 * omega * dt
        source = "w_h = (2/dt) atan(w dt/2)"
        found, elongation = float(np.arccos(cosine) / dt), half / np.arctan(half) - 1
        frequency, period = f"frequency at dt/T = {share:g} [rad/s]", f"period elongation at dt/T = {share:g}"
        # What the elongation has of rounding is that of the frequency, over the elongation.
        checks += [
            Check(frequency, found, 2 / dt * np.arctan(half), PRECISION, source, CLOSED_FORM),
            Check(period, omega / found - 1, elongation, PRECISION / elongation, source, CLOSED_FORM),
        ]
    return checks


def energy(comm: PETSc.Comm) -> list[Check]:
    """Energy of a motion of many modes over 10,000 steps without load, damping or edit."""
    replay = first_frame(SCENES / "column.toml", [STILL_GROUND, "effects.dynamics.steps=100"], comm)
    analysis = replay.analysis
    X = replay.moving.mesh.X
    shape = np.column_stack([np.sin(7 * X[:, 1]) + X[:, 1] ** 2, np.cos(5 * X[:, 0]) * X[:, 1]])
    analysis.begin(1e-3 * shape, 0.1 * shape[:, ::-1])
    start = analysis.energy()
    drift = max(abs(now.energy() / start - 1) for now in idle(replay, 100))
    # Rounding of 10,000 steps.
    source = "average acceleration keeps it exactly"
    return [Check("largest change of energy, relative", drift, 0.0, 1e-11, source, IDENTITY)]


def order(comm: PETSc.Comm) -> list[Check]:
    """Rate of convergence in time to a manufactured motion q(t) = sin^3 of the first mode, with damping.

    The ground's acceleration that makes q the first mode's coordinate is -(q'' + 2 z w q' + w^2 q) / (phi . M 1).
    """
    base = column(comm).analysis
    omega = first_mode(base)[0]
    rate, end = 0.4 * omega, 4 * np.pi / omega

    def motion(t: float) -> tuple[float, float, float]:
        s, c = np.sin(rate * t), np.cos(rate * t)
        return s**3, 3 * rate * s**2 * c, 3 * rate**2 * s * (2 * c**2 - s**2)

    errors = []
    counts = (80, 160, 320)
    for count in counts:
        damping = ["effects.damping.alpha=0.4", "effects.damping.beta=1e-4"]
        replay = column(comm, [f"effects.dynamics.time_step={end / count!r}", *damping])
        errors.append(_largest_error(replay, motion, count))
    slope = float(np.log(errors[0] / errors[-1]) / np.log(counts[-1] / counts[0]))
    return [Check("slope of the error in time", slope, 2.0, 0.02, "manufactured solution; second order", CLOSED_FORM)]


def _largest_error(replay: Replay, motion: Callable[[float], tuple[float, float, float]], count: int) -> float:
    """The largest error of the first mode's coordinate over so many steps under the ground that makes it `motion`."""
    analysis = replay.analysis
    omega, phi, weight = first_mode(analysis)
    rayleigh = analysis.body.damping_of
    damping = rayleigh.alpha + rayleigh.beta * omega**2
    participation = float(weight[:, 0].sum()) + float(
        np.vdot(phi, analysis.body.mass.apply(np.column_stack([analysis.body.constrained[:, 0], 0 * phi[:, 0]])))
    )

    def acceleration(t: float) -> np.ndarray:
        q, speed, change = motion(t)
        return np.array([-(change + damping * speed + omega**2 * q) / participation, 0.0])

    analysis.set_integration(excitation=SimpleNamespace(acceleration=acceleration))
    return max(abs(np.vdot(weight, now.x) - motion(now.time)[0]) for now in idle(replay, count))


def timoshenko_frequency(length: float, depth: float, E: float, nu: float, rho: float) -> float:
    """The lowest frequency [Hz] of a clamped beam of rectangular section, with shear and rotary inertia.

    The state (deflection, rotation, moment, shear force) per breadth obeys s' = A s; A(omega) carries the clamped end's
    two free states to the other end, where moment and shear force vanish at an eigenfrequency. Cowper's shear factor.

    Source: S. P. Timoshenko, Phil. Mag. 43 (1922) 125; G. R. Cowper, J. Appl. Mech. 33 (1966) 335.
    """
    area, inertia = depth, depth**3 / 12
    shear = 10 * (1 + nu) / (12 + 11 * nu) * E / (2 * (1 + nu)) * area

    def end(omega: float) -> float:
        A = np.zeros((4, 4))
        A[0, 1], A[0, 3] = 1.0, 1 / shear
        A[1, 2] = 1 / (E * inertia)
        A[2, 1], A[2, 3] = -rho * inertia * omega**2, -1.0
        A[3, 0] = -rho * area * omega**2
        return float(np.linalg.det(expm(A * length)[2:, 2:]))

    slender = 3.516 / length**2 * np.sqrt(E * inertia / (rho * area))
    return float(brentq(end, 0.5 * slender, 1.1 * slender)) / (2 * np.pi)


def beam(comm: PETSc.Comm) -> list[Check]:
    """The lowest frequency of the clamped column with second-order triangles, on a coarse mesh and a finer one."""
    metal = column(comm).session.scene.material["aluminium"]
    expected = timoshenko_frequency(4.0, 0.5, metal.E, metal.nu, metal.rho)
    checks = []
    for size in (0.4, 0.2):
        for mass in ("consistent", "lumped"):
            analysis = column(comm, [f"mesh.size={size}", "mesh.order=2", f'effects.dynamics.mass="{mass}"']).analysis
            what = f"frequency, {mass} mass, {analysis.unknowns} unknowns [Hz]"
            checks.append(
                Check(what, first_mode(analysis)[0] / (2 * np.pi), expected, 0.01, "Timoshenko's beam", CLOSED_FORM)
            )
    return checks


CASES: dict[str, Case] = {
    "period": period,
    "energy": energy,
    "order": order,
    "beam": beam,
    "csm3": csm3,
}
