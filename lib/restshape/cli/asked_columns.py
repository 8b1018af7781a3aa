"""What a scene asks for beside its answers, and no replay of it can give: refused by `check` as by a replay."""

from restshape.application import Application
from restshape.replay.columns import asked_errors, columns_of, refuse_asked_jumps
from restshape.scene.model import Scene


def refuse_columns(scene: Scene, application: Application) -> None:
    """Refuses errors and jumps that are not estimated in such scenes, and names of quantities that are columns.

    Raises:
        UserError: the scene asks for one of them.
    """
    columns_of(scene, application)
    refuse_asked_jumps(scene, application)
    if asked_errors(scene):
        _refuse_errors(scene, application)


def _refuse_errors(scene: Scene, application: Application) -> None:
    """Refuses errors that the analysis of a scene, which is made for this, does not estimate."""
    # Only scenes that ask for errors wait for these modules; and PETSc takes its options as it is imported.
    from petsc4py import PETSc

    from restshape.algebra.stages import Stages
    from restshape.analysis.analysis import Context
    from restshape.analysis.made_analysis import made_analysis
    from restshape.calibration import Calibration
    from restshape.policy import policy as policy_named
    from restshape.replay.error_columns import refuse_asked_errors

    context = Context(PETSc.COMM_SELF, policy_named(scene.solve.policy), Calibration.load(), Stages())
    if made_analysis(scene, application, context).quantity_errors is None:
        refuse_asked_errors(scene)
