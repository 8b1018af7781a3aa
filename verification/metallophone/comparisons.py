"""Plates that sound beside restshape's own values: frames that reuse, and frames that are solved from nothing."""

from petsc4py import PETSc
from restshape_studies.validation.case import OWN, Case, Check
from restshape_verification.metallophone.reference import EDITS, SCENES
from restshape_verification.metallophone.validation import PLATE

from restshape.interface.replays import replay_files


def reused(comm: PETSc.Comm) -> list[Check]:
    """A bar is shortened until bending overtakes torsion: frequencies of `auto` beside those of `refactor`."""
    rows, rebuilt = (
        replay_files(SCENES / "bar_150.toml", EDITS / "crossing.jsonl", policy, PLATE)["rows"]
        for policy in ("auto", "refactor")
    )
    off = max(abs(one[f"f_{k}"] / other[f"f_{k}"] - 1) for one, other in zip(rows, rebuilt) for k in range(1, 5))
    what, source = "largest difference of four frequencies in any frame", "each frame solved from nothing"
    return [Check(what, off, 0.0, 1e-6, source, OWN)]


COMPARISONS: dict[str, Case] = {"reused": reused}
