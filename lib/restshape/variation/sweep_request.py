"""What is to be swept, and how."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from restshape.calibration import Calibration
from restshape.variation.swept_key import SweptKey, combinations


@dataclass(frozen=True)
class SweepRequest:
    """What is to be swept, and how.

    Args:
        scene: the file.
        fixed: overrides of all runs.
        swept: keys, each with its values.
        edits: script that each run replays; None: the first shape only.
        policy, guess: as of a replay; None: the scene's.
        calibration: seconds a unit of counted work.
        continued: meshes move with the shape, and nonlinear solutions start from that of the run before, and follow its
            branch; else each run has a mesh of its own, and starts from rest.
        petsc: words for PETSc's options database.
    """

    scene: Path
    fixed: Sequence[str]
    swept: Sequence[SweptKey]
    edits: Path | None
    policy: str | None
    guess: str | None
    calibration: Calibration
    continued: bool = True
    petsc: tuple[str, ...] = ()

    def combinations(self) -> Iterator[tuple[int, ...]]:
        """Of each run the place of its value of each key."""
        return combinations(self.swept)
