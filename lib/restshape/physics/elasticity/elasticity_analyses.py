"""The analyses of plane solids that plans call for."""

from restshape.analysis.analysis import Analysis, Context
from restshape.analysis.buckling import BucklingAnalysis
from restshape.analysis.nonlinear import NonlinearSteadyAnalysis
from restshape.analysis.nonlinear_transient import NonlinearTransientAnalysis
from restshape.analysis.steady import SteadyAnalysis
from restshape.analysis.transient import TransientAnalysis
from restshape.fem.problem import SteadyProblem, TransientProblem
from restshape.physics.elasticity.plane_solid import PlaneSolid
from restshape.physics.elasticity.prestressed_solid import PrestressedSolid
from restshape.scene.model import Scene
from restshape.scene.plan import Plan


def steady_analysis(scene: Scene, plan: Plan, context: Context) -> Analysis[SteadyProblem]:
    """The analysis of a static solid; arguments as of any `Analysis`."""
    if plan.solver.equations == "nonlinear":
        return NonlinearSteadyAnalysis(scene, plan, context, PlaneSolid)
    if plan.on("buckling"):
        return BucklingAnalysis(scene, plan, context, PrestressedSolid)
    return SteadyAnalysis(scene, plan, context, PlaneSolid)


def transient_analysis(scene: Scene, plan: Plan, context: Context) -> Analysis[TransientProblem]:
    """The analysis of a solid that moves; arguments as of any `Analysis`."""
    make = NonlinearTransientAnalysis if plan.solver.equations == "nonlinear" else TransientAnalysis
    return make(scene, plan, context, PlaneSolid)
