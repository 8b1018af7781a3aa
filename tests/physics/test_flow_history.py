"""What the mesh does to the history of a flow: fields that nodes keep or take again."""

import numpy as np
import pytest
from restshape_studies.stability.scenery import across, drag, make_replay, write_scene, write_script
from restshape_verification.flow.scenes import everywhere, in_time

DRAG = drag("window", (0.4, 0.5), across((0.4, 0.5), (0.6, 0.55), 8))
FAR = drag("window", (0.4, 0.5), across((0.4, 0.5), (0.7, 0.6), 3))
SHEAR = '["y", 0]'


def rows(folder, scene, events, look=lambda made, row: None, policy="auto"):
    """The rows of a replay of a scene, a file or text; `look` sees the replay after each."""
    path = write_scene(folder, scene) if isinstance(scene, str) else scene
    made, found = make_replay(path, write_script(folder, events), policy), []
    for row in made.frames():
        look(made, row)
        found.append(dict(row))
    return found


@pytest.mark.parametrize("script", [DRAG, FAR])
@pytest.mark.parametrize("carry", ["ale", "remap", "auto"])
@pytest.mark.parametrize("scheme", ["bdf2", "backward_euler"])
def test_a_steady_shear_stays_one_whatever_carry_says(tmp_path, carry, scheme, script):
    levels, worst = set(), []

    def look(made, row):
        analysis = made.analysis
        exact = np.column_stack([analysis.space.X[:, 1], 0 * analysis.space.X[:, 1]])
        if row["index"] == 0:
            analysis.begin(np.column_stack([exact, 0 * exact[:, 0]]))
        worst.append(float(np.abs(analysis.x[:, :2] - exact).max()))
        levels.add(row["level"])

    rows(tmp_path, everywhere(SHEAR, in_time(scheme=scheme, carry=carry)), script, look)
    assert max(worst) < 1e-8 and levels >= {1, 3}
