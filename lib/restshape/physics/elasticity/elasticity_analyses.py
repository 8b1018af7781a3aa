"""The analyses of plane solids that plans call for, each imported where a plan calls for it."""

from restshape.analysis.analysis import Analysis, Context
from restshape.fem.problem import SteadyProblem, TransientProblem
from restshape.physics.elasticity.plane_solid import PlaneSolid
from restshape.scene.model import Scene
from restshape.scene.plan import Plan


def steady_analysis(scene: Scene, plan: Plan, context: Context) -> Analysis[SteadyProblem]:
    """The analysis of a static solid; arguments as of any `Analysis`."""
    if plan.solver.equations == "nonlinear":
        from restshape.analysis.static.nonlinear import NonlinearSteadyAnalysis

        return NonlinearSteadyAnalysis(scene, plan, context, PlaneSolid)
    if plan.on("buckling"):
        from restshape.analysis.buckling.buckling import BucklingAnalysis
        from restshape.physics.elasticity.prestressed_solid import PrestressedSolid

        return BucklingAnalysis(scene, plan, context, PrestressedSolid)
    from restshape.analysis.static.steady import SteadyAnalysis

    return SteadyAnalysis(scene, plan, context, PlaneSolid)


def transient_analysis(scene: Scene, plan: Plan, context: Context) -> Analysis[TransientProblem]:
    """The analysis of a solid that moves; arguments as of any `Analysis`."""
    if plan.solver.equations == "nonlinear":
        from restshape.analysis.motion.nonlinear_transient import NonlinearTransientAnalysis

        return NonlinearTransientAnalysis(scene, plan, context, PlaneSolid)
    from restshape.analysis.motion.transient import TransientAnalysis

    return TransientAnalysis(scene, plan, context, PlaneSolid)
