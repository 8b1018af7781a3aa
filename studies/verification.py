"""What studies know of an application: its cases, its parameters and its random scenes, found through entry points."""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from importlib import import_module
from importlib.metadata import entry_points
from pathlib import Path
from typing import TYPE_CHECKING, Any

from restshape.application import VERIFICATION, Application, Command, applications
from restshape.errors import UserError

if TYPE_CHECKING:
    from restshape_studies.accuracy.scale import StudyScale
    from restshape_studies.stability.case import Case
    from restshape_studies.stability.random_scenes import RandomScenes

    from restshape.scene.model import Scene

FrameCheck = Callable[[Any, dict[str, Any]], str]
"""What is wrong with an analysis and the row of its frame, in words; empty where nothing is."""


@dataclass(frozen=True)
class StudyParameter:
    """A key of a scene that studies of accuracy vary, one at a time.

    Args:
        key: dotted, such as ``effects.modal.model``.
        values: tried in place of the scene's own, which must be one of them, or left out.
        factors: of the scene's own number, in place of values.
        reference: value in the reference that errors are counted from, the scene's own where that is a larger number;
            for factors a factor. None: the scene's own.
        against: a whole number that is divided by the same factor, so that their product stays.
        effect: the parameter means something only with this effect; empty where it always does.
        grid: each value is tried with every mesh size, not with the scene's own alone.
    """

    key: str
    values: tuple[Any, ...] = ()
    factors: tuple[float, ...] = ()
    reference: Any = None
    against: str = ""
    effect: str = ""
    grid: bool = False


@dataclass(frozen=True)
class Verification:
    """What an application's folder of verification offers; each path ``module:attribute`` is imported when asked for.

    Args:
        validation: path of its validation cases by name.
        hard_cases: path of its hard cases by name.
        thesis: path of the function that gives its rows of the thesis's tables.
        parameters: what studies of accuracy vary besides mesh, order, tolerance and policy.
        scale: path of the function that gives the `StudyScale` of a scene, of it, its application and an element order.
        random_scenes: path of the scenes and edits that a fuzz draws of it.
        study: path of the study of accuracy of scenes without a mesh: of a case, a function that announces, a folder
            for pages and the command, it prints tables, writes pages, and gives records and the scene's title.
        frame_check: path of the `FrameCheck` of random edits; empty: shown numbers and fields must be finite.
        drapes: path of the function that gives the scenes by name, as texts or files, on which ways to rest are
            compared.
        drags: path of the function that gives scenes and edits by name whose frames are timed.
        commands: that it adds to `restshape`.
    """

    validation: str = ""
    hard_cases: str = ""
    thesis: str = ""
    parameters: tuple[StudyParameter, ...] = ()
    scale: str = "restshape_studies.accuracy.scale:scale_of"
    random_scenes: str = ""
    study: str = ""
    frame_check: str = ""
    drapes: str = ""
    drags: str = ""
    commands: tuple[Command, ...] = ()

    def load_validation(self) -> dict[str, Callable[..., Any]]:
        """The validation cases by name, imported now."""
        return _attribute(self.validation) if self.validation else {}

    def load_hard_cases(self) -> "dict[str, Case]":
        """The hard cases by name, imported now."""
        return _attribute(self.hard_cases) if self.hard_cases else {}

    def load_thesis(self) -> Callable[..., list[dict[str, Any]]] | None:
        """What measures the thesis's numbers beside ours, imported now; None where there are none."""
        return _attribute(self.thesis) if self.thesis else None

    def thesis_rows(self, timed: bool = True) -> list[dict[str, Any]]:
        """The thesis's numbers beside ours, measured now; not `timed`: those alone that no clock decides."""
        measure = self.load_thesis()
        return measure(timed) if measure else []

    def study_scale(self, scene: "Scene", application: Application, order: int) -> "StudyScale":
        """How large studies of accuracy of a scene may be."""
        return _attribute(self.scale)(scene, application, order)

    def load_random_scenes(self) -> "RandomScenes":
        """The scenes and edits that a fuzz draws, imported now; there must be some."""
        return _attribute(self.random_scenes)

    def load_study(self) -> Callable[..., tuple[list[dict[str, Any]], str]] | None:
        """The study of scenes without a mesh, imported now; None where there is none."""
        return _attribute(self.study) if self.study else None

    def load_drapes(self) -> dict[str, str | Path]:
        """The scenes by name on which ways to rest are compared, made now; none where there are none."""
        return _attribute(self.drapes)() if self.drapes else {}

    def load_drags(self) -> dict[str, tuple[str, list[dict[str, Any]]]]:
        """Scenes and edits by name whose frames are timed, made now; none where there are none."""
        return _attribute(self.drags)() if self.drags else {}

    def load_frame_check(self) -> FrameCheck | None:
        """The function that checks a frame, imported now; None where there is none."""
        return _attribute(self.frame_check) if self.frame_check else None


def _attribute(path: str) -> Any:
    module, attribute = path.split(":")
    return getattr(import_module(module), attribute)


@cache
def verifications() -> dict[str, Verification]:
    """What verifies each installed application, by its name."""
    known = applications()
    return {entry.name: entry.load() for entry in sorted(entry_points(group=VERIFICATION)) if entry.name in known}


def verification(name: str) -> Verification:
    """What verifies an installed application; nothing where it brings none."""
    return verifications().get(name, Verification())


def check_cases(names: list[str], known: dict[str, Any], remedy: str) -> None:
    """Check that there are cases of these names, ``application.case``.

    Args:
        names: that somebody asked for.
        known: all cases.
        remedy: what to do where there is no such case.

    Raises:
        UserError: there is no such case, or its application is not installed.
    """
    unknown = [name for name in names if name not in known]
    if not unknown:
        return
    app = unknown[0].partition(".")[0]
    if app not in applications() and entry_points(group=VERIFICATION, name=app):
        raise UserError(f"the application {app!r} is not installed", f"--case {unknown[0]}", f"install {app}")
    raise UserError(f"no case is named {unknown[0]!r}", "--case", remedy)
