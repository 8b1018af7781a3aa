"""The shipped bench: edits without a hand, a plank that is connected, weights that come and go, by statics by hand."""

import numpy as np
import pytest
from restshape_apps.furniture.physics.fasteners import wood
from restshape_apps.furniture.pieces import SCENES
from small_scenes import make_replay, rows_of

G = 9.80665


@pytest.mark.slow
def test_an_arm_is_drawn_connected_overloaded_and_mended() -> None:
    seen = []
    replay = make_replay(SCENES / "bench.toml", SCENES.parent / "edits" / "bench.jsonl")

    def look(row) -> None:
        furniture = replay.analysis.design.furniture
        seen.append((furniture.moved(replay.analysis.gamma), replay.analysis.forces[0]))

    rows = rows_of(replay, look)
    assert not any(row["refused"] for row in rows)
    done = {do: [k for k, row in enumerate(rows) if row["event"] == do] for do in {row["event"] for row in rows}}
    assert set(done) >= {"rotate", "scale", "plank", "connect", "weight", "choose", "slide", "delete", "undo"}
    # Legs stay on the floor and at the seat while they turn: what they lean by is what was asked for.
    turned, _ = seen[done["rotate"][-1]]
    for name in ("left", "right"):
        leg = turned.planks[turned.index(name)]
        along = leg.end(1) - leg.end(0)
        assert np.degrees(np.arccos(abs(along[2]) / np.linalg.norm(along))) == pytest.approx(4.0, abs=1e-9)
        assert leg.end(0)[2] == pytest.approx(0.0, abs=1e-9) and leg.end(1)[2] == pytest.approx(0.42, abs=1e-9)
    longer = turned.planks[turned.index("seat")].size[0] * 1.15
    scaled, _ = seen[done["scale"][5]]
    assert scaled.planks[scaled.index("seat")].size[0] == pytest.approx(longer)
    # A plank in the air is a part of its own, until it is connected.
    holds = [row["constraint_status"] == "holds" for row in rows]
    assert not any(holds[done["plank"][0] : done["connect"][0]]) and all(holds[: done["plank"][0]])
    assert holds[done["connect"][0]]
    first, second, *_ = done["weight"]
    assert (
        holds[first]
        and not holds[second]
        and rows[second]["violated_constraints"].startswith("weak: joint arm on right")
    )
    assert all(holds[done["choose"][0] :])
    # The arm is a cantilever: its joint has the moment of the pot, and of its own weight.
    for k, kilograms in ((first, 2.0), (second, 9.0), (done["slide"][-1], 9.0), (done["delete"][0], 0.0)):
        piece, forces = seen[k]
        number = piece.index("arm")
        arm = piece.planks[number]
        joint = next(j for j, one in enumerate(piece.joints) if one.i == number)
        length, own = arm.size[0], wood("pine").density * arm.size.prod() * G
        moment = own * length / 2 + kilograms * G * 0.85 * length
        assert abs(forces.bending[joint]) == pytest.approx(moment, rel=0.02)
    # What was deleted last is there again.
    assert "rail" in {plank.name for plank in seen[-1][0].planks}
    assert "rail" not in {plank.name for plank in seen[-2][0].planks}
    assert rows[-1]["utilisation"] == pytest.approx(rows[done["delete"][0]]["utilisation"], rel=1e-9)
