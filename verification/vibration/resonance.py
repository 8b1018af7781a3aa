"""A building's resonance: amplitude of its motion, harmonic response and eigenfrequency by the place of the window."""

# More than 15 modules: it runs three analyses of one scene, and compares them.

import argparse
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from petsc4py import PETSc

from restshape.analysis.modal.frequencies import lowest_modes
from restshape.analysis.motion.harmonic import harmonic_response
from restshape.analysis.motion.transient import TransientAnalysis
from restshape.application import application
from restshape.cli.options import add_json, write_json
from restshape.errors import one_line
from restshape.interface.run import Run
from restshape.outputs.atomic_files import write_whole
from restshape.outputs.kinds import CsvFile, PictureFile
from restshape.replay.request import Request
from restshape.scene.edit_script import load_script
from restshape.scene.load import load_scene

FOLDER = application("vibration").folder
SCENE, EDITS = FOLDER / "scenes" / "building.toml", FOLDER / "edits" / "building.jsonl"
WINDOW, EVERY = "right_top", 10


@dataclass
class Resonance:
    """What the drag of the window gives, by frames.

    Args:
        excitation_frequency: of the ground [Hz].
        path: (n,) how far down the window is [m], at each frame of the drag.
        amplitude: (n,) peak of the motion in the frame's period [m].
        places: (m,) how far down the window is [m], where the next two were computed on the frame's own mesh.
        harmonic: (m,) amplitude of the steady motion on a shape that stays [m].
        frequency: (m,) lowest eigenfrequency [Hz].
    """

    excitation_frequency: float
    path: np.ndarray
    amplitude: np.ndarray
    places: np.ndarray
    harmonic: np.ndarray
    frequency: np.ndarray

    @property
    def crossing(self) -> float:
        """Where the eigenfrequency meets that of the base excitation [m]."""
        return float(np.interp(-self.excitation_frequency, -self.frequency, self.places))

    @property
    def moving_peak(self) -> float:
        """Where the motion is largest [m]."""
        return summit(self.path, self.amplitude)

    @property
    def harmonic_peak(self) -> float:
        """Where the harmonic response is largest [m]."""
        return summit(self.places, self.harmonic)


def summit(x: np.ndarray, y: np.ndarray) -> float:
    """Where y (n,) over x (n,) is largest: the top of the parabola through what exceeds 9/10 of the peak."""
    near = y > 0.9 * y.max()
    middle = x[near].mean()
    square, slope, _ = np.polyfit(x[near] - middle, y[near], 2)
    return float(middle - 0.5 * slope / square)


def study(comm: PETSc.Comm = PETSc.COMM_WORLD, overrides: Sequence[str] = (), name: str = "auto") -> Resonance:
    """The resonance of the building under its own edit script.

    Args:
        comm: PETSc communicator.
        overrides: ``key=value`` as after --set.
        name: policy of reuse.
    """
    scene = load_scene(SCENE, overrides)
    script = load_script(EDITS, scene)
    run = Run(Request.of(scene, script, name), summed=False, comm=comm)
    replay = run.replay
    start, path, amplitude, slow = None, [], [], []
    for row in run.rows():
        outline = replay.moving.mesh.outline
        height = outline.centroid(outline.entity(WINDOW))[1]
        start = height if start is None else start
        if row["event"] != "drag":
            continue
        path.append(start - height)
        amplitude.append(row["q_amplitude"])
        if len(path) % EVERY == 1:
            slow.append((path[-1], *steady(replay.analysis, replay.moving.mesh.outline)))
    places, harmonic, frequency = np.array(slow).T
    return Resonance(
        scene.effects["ground"]["frequency"], *map(np.array, (path, amplitude)), places, harmonic, frequency
    )


def steady(analysis: TransientAnalysis, outline: object) -> tuple[float, float]:
    """The amplitude [m] of the steady motion where `amplitude` is observed, and the lowest eigenfrequency [Hz]."""
    stiffness, mass, damping = analysis.matrices()
    inertia, ground, constrained = (
        analysis.body.mass,
        analysis.state.integration.excitation,
        analysis.body.constrained.ravel(),
    )
    load = -inertia.apply(np.broadcast_to(ground.amplitude, (len(constrained) // 2, 2)).copy()).ravel()[~constrained]
    motion = np.zeros(constrained.size, dtype=complex)
    motion[~constrained] = harmonic_response(stiffness, mass, damping, ground.omega, load)
    node = analysis.space.nodes_of(analysis.state.scene.quantities["amplitude"].at)[0]
    return float(abs(motion[2 * node])), float(lowest_modes(stiffness, mass, 1)[0][0] / (2 * np.pi))


def arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments."""
    parser.add_argument(
        "--picture", type=PictureFile, metavar="FILE", help="amplitude by the place of the window (.png)"
    )
    parser.add_argument(
        "--csv", type=CsvFile, metavar="FILE", help="place [m], amplitude [m] of each frame of the drag"
    )
    add_json(parser)


def run(args: argparse.Namespace) -> int:
    """Print the three places, and write the picture and the table; 0."""
    found = study()
    print(f"eigenfrequency meets {found.excitation_frequency:g} Hz with the window {found.crossing:.3f} m down")
    print(f"peak of the motion {found.moving_peak:.3f} m, of the harmonic response {found.harmonic_peak:.3f} m down")
    if args.csv:
        rows = zip(found.path, found.amplitude, strict=True)
        lines = ["window_down_m,amplitude_m", *(f"{down:.18e},{amplitude:.18e}" for down, amplitude in rows)]
        write_whole(args.csv, "\n".join(lines) + "\n")
    if args.picture:
        from restshape_studies.pictures.response import draw_response

        draw_response(args.picture, found)
        print(f"wrote {one_line(args.picture)}")
    lists = {name: getattr(found, name).tolist() for name in ("path", "amplitude", "places", "harmonic", "frequency")}
    summits = {name: getattr(found, name) for name in ("crossing", "moving_peak", "harmonic_peak")}
    write_json(args, {"excitation_frequency": found.excitation_frequency, **lists, **summits})
    return 0
