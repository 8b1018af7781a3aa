"""Ranks that have been given unlike scenes, scripts or calibrations are refused, on all of them with one message."""

from dataclasses import replace

import pytest
from modal import SCENES

from restshape.calibration import Calibration
from restshape.errors import UserError
from restshape.replay.rank_agreement import refuse_unlike
from restshape.replay.request import Request
from restshape.scene.load import load_scene


class Gathering:
    """A communicator that has heard what the ranks say one after the other.

    Args:
        size: ranks; said: what those before have said.
    """

    def __init__(self, size: int, said: list) -> None:
        self.size, self.said = size, said

    def tompi4py(self) -> "Gathering":
        return self

    def allgather(self, own: dict) -> list:
        self.said.append(own)
        return self.said if len(self.said) == self.size else [own] * self.size


def request(*overrides: str) -> Request:
    return Request.of(load_scene(SCENES / "bar_100.toml", overrides))


def heard(*requests: Request) -> list:
    """What the ranks of these requests have said to each other."""
    comm = Gathering(len(requests), [])
    for one in requests:
        refuse_unlike(one, comm)
    return comm.said


def test_ranks_that_are_given_the_same_go_on():
    first, *others = heard(request(), request(), request())
    assert others == [first, first]
    assert len(set(first.values())) > 1


def slower() -> Request:
    known = Calibration.load()
    return replace(request(), calibration=replace(known, iteration=2.0 * known.iteration))


@pytest.mark.parametrize(
    ("unlike", "named"),
    [
        (lambda: request("mesh.order=2"), "scene"),
        (slower, "calibration"),
        (lambda: replace(request(), predict="linear"), "predict"),
        (lambda: replace(request(), petsc=("-log_view",)), "PETSc"),
    ],
)
def test_a_rank_that_is_given_something_else_is_named(unlike, named):
    with pytest.raises(UserError, match=f"rank 2 has been given another .*{named}"):
        heard(request(), request(), unlike())
