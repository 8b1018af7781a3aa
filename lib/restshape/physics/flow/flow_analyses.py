"""The analysis of flow that a plan calls for."""

from restshape.analysis.analysis import Analysis, Context
from restshape.physics.flow.flow_in_time import FlowInTimeAnalysis
from restshape.physics.flow.incompressible_flow import IncompressibleFlow
from restshape.physics.flow.steady_flow import SteadyFlowAnalysis
from restshape.scene.model import Scene
from restshape.scene.plan import Plan


def flow_analysis(scene: Scene, plan: Plan, context: Context) -> Analysis[IncompressibleFlow]:
    """The flow in time where there is a time step, else the steady one; arguments as of any `Analysis`."""
    in_time = plan.settings("flow").time_step is not None
    make = FlowInTimeAnalysis if in_time else SteadyFlowAnalysis
    return make(scene, plan, context, IncompressibleFlow)
