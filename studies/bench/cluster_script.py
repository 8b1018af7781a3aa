"""A job script of Slurm that measures a scene on the ranks of a cluster."""

from __future__ import annotations

import shlex
from collections.abc import Sequence
from dataclasses import dataclass

from restshape.outputs.kinds import JOB_SCRIPT_MARK

HOUR = 60


@dataclass(frozen=True)
class Measured:
    """What is to be measured: a scene as the command line names it.

    Args:
        scene: file, or name of an installed one; edits: script; none: the scene's own.
        overrides: ``key=value`` as after --set.
        modes: "strong", "weak"; triangles: as after --triangles, or nothing.
        ranks: numbers of them.
    """

    scene: str
    edits: str
    overrides: Sequence[str]
    modes: Sequence[str]
    triangles: str
    ranks: Sequence[int]

    def words(self) -> str:
        """The command, without where it writes."""
        words = ["restshape", "bench", "scaling", self.scene, *(["--edits", self.edits] if self.edits else [])]
        words += ["--ranks", ",".join(map(str, self.ranks)), *(f"--{mode}" for mode in self.modes)]
        words += ["--triangles", self.triangles] if self.triangles else []
        return shlex.join([*words, *(word for key in self.overrides for word in ("--set", key))])


def job_script(measured: Measured, minutes: int = HOUR) -> str:
    """The script that sbatch takes.

    Args:
        measured: scene, edits and numbers of ranks, the largest of which is asked for.
        minutes: that the job may take.
    """
    hours, rest = divmod(minutes, HOUR)
    most = max(measured.ranks)
    edits = ["--edits", measured.edits] if measured.edits else []
    given = [word for key in measured.overrides for word in ("--set", key)]
    replay = shlex.join(["restshape", "replay", measured.scene, *edits, *given, "--csv", f"replay-{most}.csv"])
    return f"""\
#!/bin/bash
{JOB_SCRIPT_MARK}; hand it to sbatch: sbatch scaling.sbatch
#SBATCH --job-name=restshape-scaling
#SBATCH --ntasks={most}
#SBATCH --cpus-per-task=1
#SBATCH --hint=nomultithread
#SBATCH --exclusive
#SBATCH --time={hours:02d}:{rest:02d}:00
#SBATCH --output=scaling-%j.txt
set -e
cd "$SLURM_SUBMIT_DIR"
export OMP_NUM_THREADS=1
# How srun makes its tasks ranks of this MPI: `srun --mpi=list` shows what there is.
export SLURM_MPI_TYPE=pmix

# Starts srun itself, once for each number of ranks.
{measured.words()} --out "scaling-$SLURM_JOB_ID" --json "scaling-$SLURM_JOB_ID.json"

# The same edits once more on all ranks: a row of numbers a frame.
srun --ntasks={most} {replay}
"""
