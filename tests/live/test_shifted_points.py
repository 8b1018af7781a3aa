"""What moves as it lies travels as a vector, and a page that missed frames is led to the same places."""

import json

import numpy as np

from restshape.live.frame_arrays import PicturePart
from restshape.live.frame_message import FrameEncoder
from restshape.live.server_frames import KeptFrames
from restshape.live.shifted_points import ShiftedPoints, shifted

DRAPE = np.random.default_rng(3).normal(size=(40, 3))
STEP = np.array([0.01, -0.002, 0.3])


def test_points_that_move_as_they_lie_are_the_array_of_before_and_a_vector():
    points = ShiftedPoints()
    first, none = points(DRAPE)
    assert none is None
    for count in (1, 2, 500):
        array, shift = points(DRAPE + count * STEP)
        assert array is first and np.allclose(shift, count * STEP, rtol=1e-12)
        wanted = (DRAPE + count * STEP).astype("f4")
        assert np.abs(shifted(array, shift) - wanted).max() <= 2 * np.spacing(np.abs(wanted).max())
    assert points(DRAPE) == (first, None)


def test_points_of_which_one_moves_by_itself_and_those_that_are_no_numbers_travel_whole():
    for inside, value in ((1, 1e-9), (-1, 1e-9), (7, np.nan)):
        points, other = ShiftedPoints(), DRAPE + STEP
        first, _ = points(DRAPE)
        other[inside, 1] += value
        array, shift = points(other)
        assert array is not first and shift is None
        assert np.array_equal(array, other.astype("f4"), equal_nan=True)


def test_points_in_the_plane_have_a_vector_in_space():
    points = ShiftedPoints()
    array, _ = points(DRAPE[:, :2])
    again, shift = points(DRAPE[:, :2] + STEP[:2])
    assert again is array and len(shift) == 3 and shift[2] == 0.0
    assert np.allclose(shifted(again, shift), DRAPE[:, :2] + STEP[:2], atol=1e-6)


def test_a_page_that_comes_in_mid_drag_gets_the_array_and_the_last_vector():
    encode, kept, points = FrameEncoder(), KeptFrames(), ShiftedPoints()
    drape = DRAPE
    for number, move in enumerate((0, 1, 2, None, 3)):  # None: it deforms
        drape = 1.1 * drape if move is None else drape
        array, shift = points(drape + (move or 0) * STEP)
        part = PicturePart("shape", "surface", "shape", {"displacement": array}, {"shift": shift} if shift else {})
        message = b"".join(bytes(piece) for piece in encode({"type": "frame", "number": number}, [part]))
        kept.add(message)
        if move in (1, 2):
            assert len(message) < DRAPE.size * 4
    wanted = (drape + 3 * STEP).astype("f4")
    for seen in (0, 1, 3):  # of a page that opens, and of those that have missed some
        found = kept.since(seen)
        length = int.from_bytes(found[:4], "little")
        (part,) = json.loads(found[4 : 4 + length])["parts"]
        values = np.frombuffer(found, "<f4", DRAPE.size, 4 + length + part["arrays"]["displacement"]["at"])
        assert np.allclose(shifted(values.reshape(-1, 3), part["shift"]), wanted, atol=1e-6)
