"""Stresses of a solid that several ask for: the same bits whoever asks first, and no room for what nobody asks for."""

import itertools
import tracemalloc

import numpy as np
import pytest
from small_scenes import write_scene
from test_shared_solid import FIRST, LARGE, SCENE, whole

from restshape.interface.first_frame import first_frame
from restshape.physics.elasticity.nodal_stress import NodalStress

ASKED = {
    "sampled": lambda nodal, x: nodal.sampled(x),
    "energies": lambda nodal, x: nodal.energies(x),
    "nodal": lambda nodal, x: nodal(x),
    "von_mises": lambda nodal, x: nodal.component("von_mises", x),
    "xx": lambda nodal, x: nodal.component("xx", x),
}


@pytest.mark.parametrize("overrides", [[], [FIRST], [LARGE, FIRST]])
def test_whoever_asks_first_gets_the_same_bits(tmp_path, overrides):
    """At three states, each asked for something else than the one before, beside what is computed step by step."""
    analysis = first_frame(write_scene(tmp_path, SCENE), overrides).analysis
    stresses, x = whole(analysis).stresses, analysis.x
    states = [x, 1.5 * x, x]
    recovery = NodalStress(stresses).recovery
    known = []
    for state in states:
        sampled, energies = stresses.with_energies(state, recovery.points)
        known.append({"sampled": sampled, "energies": energies, "nodal": recovery(sampled)})
    for order in itertools.permutations(ASKED):
        nodal = NodalStress(stresses)
        for number, (state, expected) in enumerate(zip(states, known)):
            for name in (order, order[:2], order[3:])[number]:
                found = ASKED[name](nodal, state)
                if name in expected:
                    np.testing.assert_array_equal(found, expected[name])
                elif name == "xx":
                    np.testing.assert_array_equal(found, expected["nodal"][:, 0])
                else:
                    np.testing.assert_array_equal(found, NodalStress(stresses).component(name, state))


def room_of(nodal, x, *names) -> int:
    """Bytes that are taken at most while these are asked for at another state than before."""
    tracemalloc.start()
    for name in names:
        ASKED[name](nodal, x)
    most = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    return most


def test_an_extreme_takes_no_room_for_the_stresses_of_cells(tmp_path):
    analysis = first_frame(write_scene(tmp_path, SCENE), [FIRST, "mesh.size=0.03"]).analysis
    nodal, x = NodalStress(whole(analysis).stresses), analysis.x
    cells, rows = len(analysis.space.cells), len(nodal.recovery.nodes)
    nodal.component("von_mises", x)
    # Energies, von Mises' stress, and a copy of the state; no four components of cells or nodes.
    lean = room_of(nodal, 1.5 * x, "von_mises")
    assert lean < 8 * (cells + rows) + x.nbytes + 16 * rows
    # What was asked for at the last state comes of the same loop at the next one.
    room_of(nodal, 1.2 * x, "von_mises", "sampled", "nodal")
    assert room_of(nodal, 1.1 * x, "von_mises") > lean + 32 * cells
    assert room_of(nodal, x, "von_mises") == pytest.approx(lean, rel=0.1)
    assert room_of(nodal, 1.3 * x, "energies") > 8 * cells
    assert room_of(nodal, 1.4 * x, "energies") < 8 * cells + x.nbytes + 8 * rows
