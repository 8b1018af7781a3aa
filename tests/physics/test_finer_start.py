"""Cloth that goes on on a finer mesh lies as far from bodies there as it did, and passes nothing on the way."""

from dataclasses import dataclass, field

import numpy as np
import pytest

from restshape import _kernels
from restshape.mesh.nested import Refined
from restshape.physics.cloth.relaxation.finer_start import finer_places

THICKNESS = 2e-3


@dataclass
class Touching:
    """Contact with bodies."""

    bodies: list
    thickness: float = THICKNESS


@dataclass
class Layers:
    """Cloth that may go so much of a way."""

    share: float

    def step_share(self, x: np.ndarray, d: np.ndarray) -> float:
        return self.share


@dataclass
class Cloth:
    """What is asked of a problem."""

    contact: Touching | None
    self_contact: Layers | None = None
    begun: list = field(default_factory=list)

    def flat(self, corners: np.ndarray) -> np.ndarray:
        return corners

    def begin(self, x: np.ndarray) -> bool:
        self.begun.append(x)
        return True


def halved(n: int) -> Refined:
    """The step to nodes at those of a line and between them."""
    ends = np.arange(n)
    parents = np.vstack([np.column_stack([ends, ends]), np.column_stack([ends[:-1], ends[1:]])]).astype(np.int32)
    return Refined(None, parents, ends, ends[:-1], ends, ends, ends)


def arc(gap: float) -> np.ndarray:
    """Nodes at this distance around a ball of 0.1 m, 50 mm apart."""
    angle = np.arange(4) * 0.5
    return (0.1 + gap) * np.column_stack([np.cos(angle), np.sin(angle), np.zeros(4)])


BALL = _kernels.Body.sphere(np.zeros(3), 0.1)


def test_middles_lie_as_far_from_a_body_as_their_ends():
    coarse = arc(0.5e-3)
    found = finer_places(Cloth(Touching([BALL])), halved(4), coarse)
    # Between them the chord is 3 mm below the surface.
    assert np.linalg.norm(0.5 * (coarse[0] + coarse[1])) < 0.098
    assert np.linalg.norm(found, axis=1) == pytest.approx(0.1005, rel=1e-9)
    assert found[:4] == pytest.approx(coarse, abs=1e-12)


@pytest.mark.parametrize("gap", [0.99, 1.01, 1.5])
def test_middles_do_not_jump_where_their_ends_begin_to_touch(gap):
    found = finer_places(Cloth(Touching([BALL])), halved(4), arc(gap * THICKNESS))
    assert np.linalg.norm(found[4:], axis=1) - 0.1 == pytest.approx(min(gap, 1.0) * THICKNESS, rel=1e-9)


def test_what_does_not_touch_stays_in_the_middle():
    for contact, gap in ((None, 1.01), (Touching([BALL]), 3.0)):
        coarse = arc(gap * THICKNESS)
        found = finer_places(Cloth(contact), halved(4), coarse)
        assert found == pytest.approx(halved(4).prolonged(coarse), abs=0.0)


class Flatter:
    """The ball, with a distance that grows more slowly, as that of a body of triangles may."""

    def distances(self, x: np.ndarray) -> np.ndarray:
        return 0.7 * BALL.distances(x)

    def distance(self, x: np.ndarray) -> tuple[np.ndarray, ...]:
        return tuple(0.7 * np.asarray(part) for part in BALL.distance(x))


def test_middles_lie_as_far_where_the_gradient_is_not_of_length_one():
    found = finer_places(Cloth(Touching([Flatter()])), halved(4), arc(0.5e-3))
    assert np.linalg.norm(found, axis=1) == pytest.approx(0.1005, rel=1e-9)


def test_layers_stop_it():
    coarse, cloth = arc(0.5e-3), Cloth(Touching([BALL]), Layers(0.25))
    straight, whole = halved(4).prolonged(coarse), finer_places(Cloth(cloth.contact), halved(4), coarse)
    assert finer_places(cloth, halved(4), coarse) == pytest.approx(straight + 0.25 * (whole - straight), abs=1e-12)
    assert len(cloth.begun) == 1
