"""Hard cases of heat: materials that conduct very differently, hardly any convection, and those of fluids."""

from collections.abc import Iterator
from typing import Any

from restshape_studies.stability.case import Case, Statement, Trial, below, valid
from restshape_studies.stability.known_bounds import ENTRIES, SOLVED
from restshape_studies.stability.scenery import across, block, drag, rows_of
from restshape_verification.flow.heated_stability import CASES as FLUIDS

from restshape.policy import POLICIES
from restshape.replay.parity import Parity

HEAD = 'format = "restshape-scene"\nversion = 1\napp = "thermal"\n'
WINDOW = "[shape.holes.window]\ncircle = { center = [0.3, 0.5], radius = 0.12 }\n"
INSERT = '[shape.regions.insert]\npolygon = [["620 mm", 0.3], [0.85, 0.3], [0.85, 0.7], [0.62, 0.7]]\n'
HEATED = '[loads.warm]\non = "left"\nflux = 1000\n'
QUANTITIES = '[quantities]\nwarm = { heat_flow = true, at = "left" }\ncold = { heat_flow = true, at = "right" }\n'
MOVED = drag("window", (0.3, 0.5), across((0.3, 0.5), (0.42, 0.6), 12))

DISTURBED = 1e-6
"""Distance in the energy norm that rounding may leave where one temperature is hardly bound to the others."""


def _air(film: float) -> str:
    return f'[loads.air]\non = "right"\nconvection = {{ film = {film!r}, ambient = 300 }}\n'


def _moved(trial: Trial, text: str) -> Iterator[Statement]:
    """What must hold in each frame of a window that moves: all frames, cold solves, heat in = heat out."""
    run = trial.replay(HEAD + block() + WINDOW + text + QUANTITIES, MOVED)
    made = run.replay
    check = Parity(made)
    rows = rows_of(run, lambda row: row["index"] % 4 or check())
    yield from valid(rows)
    yield below("entries equal cold ones", check.entries, ENTRIES)
    yield below("solutions equal cold ones", check.solution, DISTURBED)
    lost = max(abs(row["q_warm"] + row["q_cold"]) for row in rows)
    yield below("heat that is lost, of that which enters", lost / 1000.0, SOLVED)


def conductivity_ratio(trial: Trial) -> Iterator[Statement]:
    """An insert that conducts a million times better than the wall around it."""
    wall = "[material.wall]\nconductivity = 0.1\n[material.silver]\nconductivity = 1e5\nregion = 'insert'\n"
    yield from _moved(trial, INSERT + wall + HEATED + _air(10.0) + "[solve]\ntolerance = 1e-9\n[mesh]\nsize = 0.06\n")


def tiny_convection(trial: Trial) -> Iterator[Statement]:
    """A film coefficient so small that the temperature is hardly held."""
    plate = "[material.plate]\nconductivity = 100\n"
    yield from _moved(trial, plate + HEATED + _air(1e-4) + "[solve]\ntolerance = 1e-11\n[mesh]\nsize = 0.06\n")


CASES: dict[str, Any] = {
    "conductivity_ratio": Case(conductivity_ratio, tuple(POLICIES)),
    "tiny_convection": Case(tiny_convection, tuple(POLICIES)),
    **FLUIDS,
}
