"""The thesis's bridge study beside our illustration: figure 4.14."""

from typing import Any

from restshape_studies.each_week import each_week
from restshape_verification.bridge.study import study


@each_week()
def rows(timed: bool = True) -> list[dict[str, Any]]:
    """Rows of `restshape tables`: areas that are known to hold, of one scripted designer; no clock decides them."""
    ways = study()
    always, asked = ways["every frame"], ways["on demand"]
    common = {"table": "figure 4.14", "timing": False}
    return [
        {
            **common,
            "row": f"analysis {name} (illustration)",
            "quantity": "smallest area known to hold",
            "thesis": "drawn, without numbers",
            "ours": float(way.best[-1]),
            "unit": "m²",
        }
        for name, way in ways.items()
    ] + [
        {
            **common,
            "row": "every frame against on demand",
            "quantity": "same edits, smaller area known to hold",
            "thesis": "generally better",
            "ours": float(1.0 - always.best[-1] / asked.best[-1]) * 100.0,
            "unit": "%",
        }
    ]
