"""The analysis of a scene, made by its application."""

from __future__ import annotations

from typing import TYPE_CHECKING, cast

from restshape.scene.plan import plan

if TYPE_CHECKING:
    from restshape.analysis.analysis import Analysis, Context
    from restshape.application import Application
    from restshape.fem.problem import Problem
    from restshape.scene.model import Scene


def made_analysis(scene: Scene, application: Application, context: Context) -> Analysis[Problem]:
    """An analysis that has solved nothing yet.

    Args:
        scene: where it starts; application: of the scene.
        context: of the replay that it is a part of.

    Raises:
        UserError: the scene cannot be simulated.
    """
    return cast("Analysis[Problem]", application.make_analysis()(scene, plan(scene, application), context))
