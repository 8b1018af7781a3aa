"""What tuning a scene costs, for `restshape explain`: one solve and one set of derivatives, as they are measured."""

from time import process_time

import numpy as np
from restshape_apps.metallophone.tuning.bar import Bar
from restshape_apps.metallophone.tuning.followed_modes import followed
from restshape_apps.metallophone.tuning.freedoms import freedoms_of, with_fixed_curves
from restshape_apps.metallophone.tuning.motions import motions_of
from restshape_apps.metallophone.tuning.tone_rates import tone_rates
from restshape_apps.metallophone.tuning.tuning import SOLVES, SOLVES_OF_RATIOS

from restshape.errors import UserError
from restshape.scene.model import Scene

ASIDE = 1e-3
"""Share of the size of the shape by which a point moves for the solve that is measured."""


def tuning_cost(scene: Scene) -> list[tuple[str, str, str]]:
    """A line: milliseconds of processor time of a solve and of the derivatives by the outline, and how many there are.

    Where no point of the outline can change, what `restshape tune` would say.
    """
    try:
        fixed = with_fixed_curves(scene)
        bar = Bar(fixed, freedoms_of(fixed, []))
    except UserError as error:
        return [("restshape tune", "not by its outline", error.what)]
    values = np.array([freedom.start for freedom in bar.freedoms])
    modes = bar.analysis.state.modes
    own = followed(bar, modes.ids.ids[modes.chosen[:1]])
    start = process_time()
    motions = motions_of(bar, values)
    moved = process_time()
    if own is not None:
        tone_rates(bar, own, motions)
    derived = process_time()
    values[0] += ASIDE * bar.outline.size
    bar.at(values)
    solved = process_time()
    count = len(bar.freedoms)
    what = (
        f"{1e3 * (solved - derived):.3g} ms a solve, {1e3 * (derived - moved):.3g} ms the derivatives, "
        f"{1e3 * (moved - start):.3g} ms the motions of {count} freedoms"
    )
    why = f"by its outline, one of each a step; at most {SOLVES} solves for a tone, {SOLVES_OF_RATIOS} for ratios"
    return [("restshape tune", what, why)]
