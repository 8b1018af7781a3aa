"""What a study of accuracy found, as cells and as pairs of a name and a value: the terminal and the page show both."""

from __future__ import annotations

from typing import Any

from restshape_studies.accuracy.chosen import stalled
from restshape_studies.accuracy.distance import NAMES
from restshape_studies.accuracy.front import front_of, percent, rates, rivals, slope
from restshape_studies.accuracy.record import PARTS
from restshape_studies.accuracy.setting import present, shown
from restshape_studies.accuracy.study import Study

from restshape.application import application_of
from restshape.outputs.si_numbers import counted, si
from restshape.scene.model import Scene
from restshape.shape.build import outline_from_spec

Row = dict[str, Any]
Facts = list[tuple[str, str]]

HEADS = ("error", "discretisation", "algebraic", "reuse", "ms a frame, p50", "total, s", "size", "unknowns")
HEADS += ("order", "policy", "tolerance", "varied alone", "remarks")
ELSEWHERE = "take it away from there, or round the corner, or spread the load; restshape check says where it is taken"
FINER_SIZES = "try finer ones (--sizes), or another order (--orders)"
FRONT, BELOW = "front", "below the error of the reference"


def row(record: Row) -> list[str]:
    """A record's line of the table."""
    parts = record["parts"] or dict.fromkeys(PARTS)
    marks = [FRONT] if record["pareto"] else []
    marks += [BELOW] if record["below_reference"] else []
    return [
        percent(record["error"]),
        *("–" if parts[part] is None else f"{parts[part]:.1e}" for part in PARTS),
        "–" if record["frame_ms"] is None else f"{record['frame_ms']:.3g}",
        f"{record['total_s']:.3g}",
        si(record["size"], "m"),
        str(record["unknowns"]),
        str(record["order"]),
        record["policy"],
        f"{record['tolerance']:.0e}",
        f"{record['varied']} = {shown(record['given'])}" if record["varied"] else "",
        ", ".join(marks),
    ]


def rows(study: Study) -> list[list[str]]:
    """All lines of the table, the most accurate first."""
    known = (record for record in study.records if record["error"] is not None)
    return [row(record) for record in sorted(known, key=lambda r: r["error"])]


def measure_name(name: str) -> str:
    """A measure for people."""
    return f"quantity {name[2:]}" if name.startswith("q_") else NAMES.get(name, name)


def facts(study: Study) -> Facts:
    """Numbers of a whole study by what they are."""
    found, front = slope(study.records), front_of(study.records)
    return [
        ("reference's uncertainty", f"{percent(study.uncertainty)} ({measure_name(study.measure)})"),
        ("slope p of the front", f"– ({counted(len(front), 'point')})" if found is None else f"{found:.2f}"),
        *_rates(study),
        *_without_limit(study),
        *compared_values(study),
        *_idle(study),
        ("reuse below the tolerance", reuse_fact(study)),
        ("reuse + algebraic error, over the tolerance", solver_fact(study)),
    ]


def _idle(study: Study) -> Facts:
    """That the frames of a script have no times, for none of them solves anything."""
    known = [record["frame_ms"] for record in study.records if record["error"] is not None]
    if study.total == 1 or not known or any(known):
        return []
    edits = study.case.edits.name if study.case.edits else "the script"
    why = f"no frame of {edits} moves the shape or changes the solution, so that there is nothing to time"
    return [("time of a frame", f"not known: {why}; name a script that does: --edits FILE")]


def _rates(study: Study) -> Facts:
    """How errors fall with the mesh size, of the policy that the grid has most of."""
    policies = [record["policy"] for record in study.records if not record["varied"]]
    if not policies:
        return []
    policy = "auto" if "auto" in policies else policies[0]
    return [
        (f"{measure_name(name)}, rate", ", ".join(f"h^{p:.2f} (order {order})" for order, p in orders.items()))
        for name, orders in rates(study.records, policy).items()
    ]


def _without_limit(study: Study) -> Facts:
    """Why quantities do not converge: they are taken at singular places, or their errors do not fall."""
    singular, found = singular_quantities(study.scene), []
    for name in study.scene.quantities:
        if name in singular:
            power = singular[name] - 1.0
            grows = f"stress grows as r^{power:.3f}" if singular[name] else "a point load acts"
            why = f"at a singular place, where {grows}: its value is one of the mesh size"
            found.append((f"quantity {name}", f"does not converge, for it is taken {why}; {ELSEWHERE}"))
        elif falls := stalled(study.records, name):
            why = f"its error falls as {falls}: no singular place is known there, so that meshes may be too coarse yet"
            found.append((f"quantity {name}", f"does not converge; {why}; {FINER_SIZES}"))
    return found


def singular_quantities(scene: Scene) -> dict[str, float]:
    """Quantities of a scene's first shape at singular places, with the exponent of displacements there."""
    if not any(physics.inspect_shape for physics in application_of(scene).physics):
        return {}
    outline = outline_from_spec(scene.shape, scene.folder)
    seen = (physics.inspected(scene, outline).singular for physics in application_of(scene).physics)
    return {name: exponent for found in seen for name, exponent in found.items()}


def compared_values(study: Study) -> Facts:
    """Errors of the values of each key that was tried with several mesh sizes, the most accurate first."""
    lines = []
    for key, found in rivals(study.records).items():
        own = present(study.scene, application_of(study.scene), key)
        finest = sorted(found.finest.items(), key=lambda pair: pair[1][0])
        then = sorted(found.then.items(), key=lambda pair: pair[1])
        names = {value: shown(own if value is None else value) for value in found.finest}
        listed = ", ".join(f"{names[value]} {percent(error)} (h^{p:.2f})" for value, (error, p) in finest)
        lines.append((f"{key}, finest meshes", listed))
        if then:
            listed = ", ".join(f"{names[value]} {percent(error)}" for value, error in then)
            lines.append((f"{key}, frames of {found.ms:.3g} ms", listed))
    return lines


def reuse_fact(study: Study) -> str:
    """At how many points reuse stays below the tolerance, and how far."""
    known = [record for record in study.records if record["reuse_holds"] is not None]
    if not known:
        return "not known at any point"
    failed = [record["name"] for record in known if not record["reuse_holds"]]
    if failed:
        return f"FAILURE at {len(failed)} of {len(known)} points: {'; '.join(failed)}"
    worst = max(record["parts"]["reuse"] / record["tolerance"] for record in known)
    of = f"all {len(known)}" if len(known) == len(study.records) else f"{len(known)} of {len(study.records)}"
    return f"at {of} points, at most {worst:.1e} of it"


def solver_fact(study: Study) -> str:
    """The largest sum of reuse and algebraic error, in tolerances."""
    shares = [(r["parts"]["reuse"] + r["parts"]["algebraic"]) / r["tolerance"] for r in study.records if r["parts"]]
    return f"at most {max(shares):.2g}" if shares else "not known at any point"


def left_out(study: Study) -> list[str]:
    """What failed, was left out, or lacks a part, with the reason; one line each."""
    lines = [f"{omission.name}: {omission.why}" for omission in study.omissions]
    for record in study.records:
        if record["problem"]:
            lines.append(f"{record['name']}: {record['problem']}")
        elif record["parts"] is None and record["error"] is not None:
            lines.append(f"{record['name']}: error not split, for its other replays took other meshes")
    return lines
