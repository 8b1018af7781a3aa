"""How often PETSc did what: counts of its logged events."""

from collections.abc import Sequence

from petsc4py import PETSc

from restshape.algebra.stages import LOGGED, OWNER, log_stage

NAMES = (
    "MatCholFctrSym",
    "MatCholFctrNum",
    "MatICCFactorSym",
    "MatILUFactorSym",
    "MatLUFactorNum",
    "PCSetUp",
    "KSPSolve",
    "PCApply",
    "MatMult",
    "RestshapePattern",
    "RestshapePatch",
    "RestshapeValues",
)


def begin_log() -> None:
    """Let PETSc count; the events of all its parts are known by their names then."""
    PETSc.Log.begin()
    PETSc.KSP().create(PETSc.COMM_SELF).destroy()
    for name in LOGGED:
        log_stage(name)


class EventCounts:
    """Counts over PETSc's main log stage and those of restshape; PETSc's log must have begun.

    Args:
        names: of events.
        owner: of `Stages`, in whose log stages alone they are counted.
    """

    def __init__(self, names: Sequence[str] = NAMES, owner: str = "") -> None:
        self._events = {name: PETSc.Log.Event(name) for name in names}
        own = [log_stage(name, owner or OWNER).id for name in LOGGED]
        self._stages = own if owner else [0, *own]
        self._last = dict.fromkeys(names, 0)

    def since_last(self) -> dict[str, int]:
        """Counts by event since the last call, or since the log began."""
        now = {
            name: sum(event.getPerfInfo(stage)["count"] for stage in self._stages)
            for name, event in self._events.items()
        }
        before, self._last = self._last, now
        return {name: now[name] - before[name] for name in now}
