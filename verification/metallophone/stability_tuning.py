"""Hard cases of tuning: modes that cross on the way, pairs, out of reach, thin plates, holes near nodal lines."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from restshape_apps.metallophone.tuning.bending import bending_modes
from restshape_apps.metallophone.tuning.descent import IN_TUNE
from restshape_apps.metallophone.tuning.tuning import SOLVES, Tuning, tuned
from restshape_apps.metallophone.tuning.wanted import Wanted
from restshape_studies.stability.case import Case, Statement, Trial, below, near, true, valid
from restshape_studies.stability.known_bounds import Known
from restshape_studies.stability.scenery import across, drag, rows_of
from restshape_verification.metallophone.tines import kalimba

from restshape.application import application
from restshape.interface.first_frame import first_frame
from restshape.scene.load import load_scene

SCENES = application("metallophone").folder / "scenes"
PLATE = ["effects.modal.model=plate", 'mesh.size="9 mm"']
RIGHT = ["shape.vertices.b.0", "shape.vertices.c.0"]
CLOSE = Known(IN_TUNE, "the distance at which tuning may end")
CLOSE_SHARE = Known(3e-4, "half a cent, at which tuning may end")
THICKNESS = "material.aluminium.thickness"


def brought(
    trial: Trial, scene: Path, frequency: float, by: list[str], overrides: list[str], rank: int = 1
) -> tuple[Tuning, list[str]]:
    """A scene with one mode tuned to a frequency [Hz], and the words of --set that bring it there."""
    wanted = Wanted(f"{frequency:g} Hz", (1.0,), (frequency,))
    words = [*overrides, f"solve.policy={trial.policy}"]
    found = tuned(load_scene(scene, words), wanted, by, ranks=[rank])
    pairs = ((".".join(key), f'"{value}"' if isinstance(value, str) else value) for key, value in found.changes())
    return found, [*words, *(f"{key}={value}" for key, value in pairs)]


def in_tune(what: str, found: Tuning) -> Iterator[Statement]:
    """The statements that a tone is met, within the solves that it may take."""
    yield below(f"distance from the tone [cents] ({what})", found.found.last.worst, CLOSE)
    yield below(f"solves ({what})", found.solves, SOLVES)


def tuning_across_a_crossing(trial: Trial) -> Iterator[Statement]:
    """A bar is shortened until its second bending has a tone beyond the first torsion, and one where both coincide."""
    scene, own = SCENES / "bar_150.toml", [*PLATE, "effects.modal.modes=5"]
    for frequency, rank in ((2930.0, 3), (2450.0, 2)):
        found, words = brought(trial, scene, frequency, RIGHT, own, 2)
        yield from in_tune(f"bending, {frequency:g} Hz", found)
        again = first_frame(scene, words).analysis
        bending = (np.flatnonzero(np.isin(again.state.modes.chosen, bending_modes(again))) + 1).tolist()
        yield true(f"the second bending mode is of rank {rank} ({frequency:g} Hz)", bending[1] == rank, bending[1])
        tone = float(again.frequencies[bending[1] - 1])
        yield near(f"its frequency when replayed [Hz] ({frequency:g} Hz)", tone, frequency, CLOSE_SHARE)
    torsion, _ = brought(trial, scene, 2480.0, RIGHT, own, 3)
    yield from in_tune("torsion, 2480 Hz", torsion)
    both, _ = brought(trial, scene, 2729.0, RIGHT, own, 2)
    yield from in_tune("where both coincide", both)


def tuned_pairs(trial: Trial) -> Iterator[Statement]:
    """Of the pair of a square, and of a fork of two equal tines, the mean is tuned, and the pair stays one."""
    found, _ = brought(trial, SCENES / "square.toml", 4.3, [], ["mesh.size=0.7"], 4)
    yield from in_tune("square", found)
    yield true("the square has a pair", [len(group) for group in found.found.clusters] == [2])
    found, _ = brought(trial, kalimba(trial.folder, [0.030, 0.030], gap=0.006, root=0.002), 900.0, [], [])
    yield from in_tune("fork", found)
    yield true("the fork has a pair", [len(group) for group in found.found.clusters] == [2])


def tone_out_of_reach(trial: Trial) -> Iterator[Statement]:
    """A tone two octaves away, and a bound that is met at once: the nearest tone, and the bound that holds."""
    scene, own = SCENES / "bar_100.toml", [*PLATE, "effects.modal.modes=1"]
    found, _ = brought(trial, scene, 523.0, [THICKNESS], own)
    yield true("two octaves are out of reach", not found.found.in_tune)
    yield true("the thickness is at its bound", found.found.last.values[0] == 0.002)
    yield true("the bound is named", found.found.at_bounds() == [(0, "lower")])
    wanted = Wanted("5000 Hz", (1.0,), (5000.0,))
    still = tuned(load_scene(scene, own), wanted, [THICKNESS], [f"{THICKNESS}=1 mm:4 mm"])
    yield true("a bound that is met at once leaves the bar", still.found.last.values[0] == 0.004)
    yield below("solves for that", still.solves, 1)


HOLE = '[shape.holes]\ncord = {{ circle = {{ center = ["{x} mm", "15 mm"], radius = "3 mm" }} }}\n'


def holes_and_thin_plates(trial: Trial) -> Iterator[Statement]:
    """A hole dragged onto the nodal line, a hole that is tuned by, and a plate of 0.5 mm, dragged on when tuned."""
    text = (SCENES / "bar_100.toml").read_text()
    for x in (12.0, 22.4):
        scene = trial.folder / f"holed_{x:g}.toml"
        scene.write_text(text.replace("[material", HOLE.format(x=x) + "[material", 1))
        found, _ = brought(trial, scene, 2030.0, [*RIGHT, "cord"], [*PLATE, "effects.modal.modes=1"])
        yield from in_tune(f"hole at {x:g} mm", found)
    thin = [*PLATE, "effects.modal.modes=1", f'{THICKNESS}="0.5 mm"']
    found, words = brought(trial, SCENES / "bar_100.toml", 261.0, [], thin)
    yield from in_tune("plate of 0.5 mm", found)
    path = across((0.1, 0.015), (0.104, 0.015), 4)
    run = trial.replay(SCENES / "bar_100.toml", drag("right", (0.1, 0.015), path), words)
    rows = rows_of(run)
    yield near("tone of the tuned bar, dragged on, over the first", rows[-1]["f_1"] / rows[0]["f_1"], 0.925, 5e-3)
    yield from valid(rows)


CASES: dict[str, Case] = {
    "tuning_across_a_crossing": Case(tuning_across_a_crossing),
    "tuned_pairs": Case(tuned_pairs),
    "tone_out_of_reach": Case(tone_out_of_reach),
    "holes_and_thin_plates": Case(holes_and_thin_plates),
}
