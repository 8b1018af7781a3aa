"""Seams of cloth that something holds where it is."""

from types import SimpleNamespace

import numpy as np
import pytest

from restshape.physics.cloth.relaxation.close_seams import PATIENCE, ROUGH, close_seams
from restshape.physics.cloth.relaxation.relaxation_report import ConvergenceReport


@pytest.mark.parametrize(("residual", "rounds"), [(1e8, PATIENCE), (0.5 * ROUGH, 10)])
def test_cloth_that_cannot_move_is_given_up_far_from_rest_alone(residual, rounds):
    """Near rest the seams pull harder, until they do with all of their stiffness."""
    seams = SimpleNamespace(edge_length=0.02, stiffness=np.array([1e6]), pull=1.0, gap=lambda _: 0.1)
    problem = SimpleNamespace(
        seams=seams, size=0.3, stiffest=300.0, corners=lambda x: x, mesh=SimpleNamespace(cell_piece=np.ones(1))
    )
    problem.pull_seams = lambda part: setattr(seams, "pull", part)
    falls = []

    class Light:
        def __enter__(self):
            return self

        def __exit__(self, *_):
            return False

    problem.lightened = lambda _: Light()

    def fall(x, goal, most, report):
        falls.append(most)
        report.residual = residual
        x += 1e-7

    close_seams(SimpleNamespace(problem=problem, fall=fall), np.zeros((4, 3)), 3000, ConvergenceReport())
    assert len(falls) == rounds if residual > 1.0 else len(falls) >= rounds
