"""The parts of a replay: session, mesh, analysis and prediction, which know nothing of each other."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from restshape.analysis.analysis import Context
from restshape.analysis.made_analysis import made_analysis
from restshape.analysis.refining_predictor import Refinable
from restshape.errors import UserError
from restshape.replay.predicted_frames import PredictedFrames
from restshape.replay.refined_frames import NestedLevels, RefinedFrames
from restshape.replay.sampled_frames import SampledFrames

if TYPE_CHECKING:
    from petsc4py import PETSc

    from restshape.algebra.stages import Stages
    from restshape.analysis.analysis import Analysis
    from restshape.fem.problem import Problem
    from restshape.mesh.follower import Follower
    from restshape.replay.request import Request
    from restshape.shape.protocol import Session


class ReplayParts(NamedTuple):
    """What a replay goes from frame to frame with.

    Args:
        session: gives the frames; moving: follows them; analysis: solves them.
        prediction: shows some of them without a solve; None: all are solved.
    """

    session: Session
    moving: Follower
    analysis: Analysis[Problem]
    prediction: PredictedFrames | None


def replay_parts(request: Request, comm: PETSc.Comm, stages: Stages) -> ReplayParts:
    """The parts of the replay that is asked for.

    Args:
        request: what is to be replayed.
        comm: whose ranks share mesh and algebra.
        stages: takes the time of each stage.

    Raises:
        UserError: no valid first shape, or what is to be predicted cannot be.
    """
    scene, application, policy = request.scene, request.application, request.policy
    session, moving = application.editing.start(scene, request.script, application, policy, comm)
    context = Context(comm, policy, request.calibration, stages, request.guided)
    analysis = made_analysis(scene, application, context)
    if request.predict == "none":
        return ReplayParts(session, moving, analysis, None)
    if request.script.header.analysis != "every frame":
        raise UserError("frames that are not analysed cannot be predicted", "--predict", "--predict none")
    if request.predict == "linear":
        return ReplayParts(session, moving, analysis, PredictedFrames(analysis, moving, session, policy))
    return ReplayParts(session, moving, analysis, _sampled(request, session, moving, analysis))


def _sampled(request: Request, session: Session, moving: Follower, analysis: Analysis[Problem]) -> SampledFrames:
    """What predicts frames from several samples.

    Raises:
        UserError: nothing follows the hand linearly.
    """
    scene, policy, outline = request.scene, request.policy, session.outline
    if (policy.relocation or scene.mesh.relocation) == "laplacian":
        what = "springs relax the nodes, which do not follow the hand linearly: there are no derivatives to mix"
        raise UserError(what, "--predict gmls", "choose another mesh.relocation or policy, or leave it out")
    size = outline.size if outline is not None else 1.0
    levels, parts = scene.predicted_levels, (analysis, moving, session, policy)
    refinable: Refinable | None = getattr(analysis, "refinable", None)
    if levels > 1 and refinable is not None:
        known = refinable.refined(levels)
        nested = NestedLevels(scene.mesh.levels - levels + 1, scene.mesh.levels)
        return RefinedFrames(*parts, spec=scene.predict, size=size, pair=known, levels=nested)
    return SampledFrames(*parts, spec=scene.predict, size=size)
