"""Hypothesis strategies of scenes that name a damaged or crafted drawing or mesh."""

import base64
from typing import Any

from hypothesis import strategies as st
from restshape_studies.stability.foreign_files import samples
from restshape_studies.stability.hostile_bytes import BYTES
from restshape_studies.stability.shape_strategies import Table

CRAFTED: dict[str, tuple[str, bytes]] = {
    "a million nodes claimed": (".msh", b"$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$Nodes\n1 10000000000 1 10000000000\n"),
    "an older claim": (".msh", b"$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n99999999999\n1 0 0 0\n"),
    "entities of XML": (
        ".vtu",
        b'<?xml version="1.0"?><!DOCTYPE a [<!ENTITY b "' + b"x" * 999 + b'"><!ENTITY c "' + b"&b;" * 999 + b'">'
        b'<!ENTITY d "' + b"&c;" * 999 + b'">]><VTKFile>&d;</VTKFile>',
    ),
    "another file named": (".inp", b"*INCLUDE, INPUT=/etc/passwd\n"),
    "a range without end": (".bdf", b"BEGIN BULK\nGRID,1,,0.,0.,0.\nSPC1,1,12,1,THRU,999999999999\nENDDATA\n"),
    "a loop without end": (".geo", b"For i In {1:1000000000}\n p = i;\nEndFor\n"),
    "a list without end": (".geo", b"a[] = {1:1000000000};\n"),
    "parentheses": (".geo", b"a = " + b"(" * 5000 + b"1" + b")" * 5000 + b";\n"),
    "copies of copies": (
        ".svg",
        b'<svg xmlns="http://www.w3.org/2000/svg"><defs>'
        + b"".join(b'<g id="g%d"><use href="#g%d"/><use href="#g%d"/></g>' % (i, i + 1, i + 1) for i in range(30))
        + b'<rect id="g30" width="1" height="1"/></defs><use href="#g0"/></svg>',
    ),
    "a path without end": (
        ".svg",
        b'<svg xmlns="http://www.w3.org/2000/svg"><path d="M0 0' + b"h1" * 99999 + b'"/></svg>',
    ),
    "a header alone": (".step", b"ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\n"),
    "nothing": (".dxf", b""),
    "a section without end": (".dxf", b"0\nSECTION\n2\nENTITIES\n" + b"0\nLINE\n" * 5000),
}
"""Files that nobody has written by chance, by what they hold."""
DRAWINGS = (".geo", ".dxf", ".svg", ".step")


@st.composite
def hostile_files(draw: st.DrawFn, scene: Table) -> tuple[Table, str, dict[str, str]]:
    """A scene that names a file, what was done to the file, and the file's bytes as base64 by its name."""
    if draw(st.integers(0, 9)) == 0:
        (ending, data), how = CRAFTED[draw(st.sampled_from(list(CRAFTED)))], "crafted"
    else:
        ending, data = samples()[draw(st.sampled_from(list(samples())))]
        how = draw(st.sampled_from([*BYTES, "other format"]))
        if how == "other format":
            ending = draw(st.sampled_from([other for other, _ in samples().values()]))
        else:
            data = BYTES[how](draw, data)
    name = f"part{ending}"
    return naming(scene, name), f"file: {how}", {name: base64.b64encode(data).decode()}


def naming(scene: Table, file: str) -> Table:
    """The scene with the shape of a file, clamped all around; nothing else that names a part of the shape stays."""
    changed: dict[str, Any] = {key: value for key, value in scene.items() if key not in ("loads", "quantities", "goal")}
    changed["material"] = {name: one for name, one in scene.get("material", {}).items() if "region" not in one}
    for one in list(scene.get("supports", {}).values())[:1]:
        changed["supports"] = {"s": {**one, "on": "outline"}}
    mesh = {key: value for key, value in scene.get("mesh", {}).items() if key not in ("near", "size", "file")}
    if file.endswith(DRAWINGS):
        return {**changed, "shape": {"file": file}, "mesh": {**mesh, "size": 0.2}}
    return {**changed, "shape": {}, "mesh": {**mesh, "file": file}}
