"""The error estimate of a solid with one displacement, made when it is first asked for."""

from restshape.fem.error_estimate import SolidEstimate
from restshape.physics.elasticity.plane_solid import PlaneSolid


class Estimated:
    """Holds the estimate of the solid that an analysis is at.

    Attributes:
        estimated: what `estimate()` of the analysis is of.
    """

    estimated = "displacement in the energy norm"
    _estimator: SolidEstimate | None = None

    def estimator_of(self, physics: PlaneSolid) -> SolidEstimate:
        """The estimate on the solid's mesh, kept until there is another solid."""
        if self._estimator is None or self._estimator.physics is not physics:
            self._estimator = SolidEstimate(physics)
        return self._estimator
