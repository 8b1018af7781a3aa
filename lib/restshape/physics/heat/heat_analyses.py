"""The analysis of conduction that a plan calls for."""

from restshape.analysis.analysis import Analysis, Context
from restshape.analysis.motion.transient import TransientAnalysis
from restshape.analysis.static.steady import SteadyAnalysis
from restshape.fem.problem import TransientProblem
from restshape.physics.heat.conduction import HeatConduction
from restshape.scene.model import Scene
from restshape.scene.plan import Plan


def heat_analysis(scene: Scene, plan: Plan, context: Context) -> Analysis[TransientProblem]:
    """The temperature in time where heat is stored, else the steady one; arguments as of any `Analysis`."""
    make = TransientAnalysis if plan.on("storage") else SteadyAnalysis
    return make(scene, plan, context, HeatConduction)
