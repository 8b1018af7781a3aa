""".geo files read statement by statement: the same outline as gmsh reads, and bounds on what a file asks for."""

import time

import numpy as np
import pytest

from restshape.errors import UserError
from restshape.shape.drawings import geo_process
from restshape.shape.drawings.geo import read_geo
from restshape.shape.drawings.unordered_curves import shape_data

HOLES = """
// a plate with holes
DefineConstant[ lc = {0.1, Name "size"}, n = 3 ];
w = 2; h = w/2^1; Mesh.Algorithm = 6; Geometry.PointNumbers = 1; /* a
comment */
Point(1) = {0, 0, 0, lc}; Point(2) = {w, 0, 0, lc}; Point(3) = {w, h, 0, lc}; Point(4) = {0, h, 0, lc};
ls[] = {};
For i In {1:4}
  Line(i) = {i, (i % 4) + 1}; ls[] += i;
EndFor
Curve Loop(1) = ls[];
loops[] = {1};
For k In {0:n-1}
  If (k == 1) r = 0.05; ElseIf (k == 2) r = 0.06; Else r = 0.07; EndIf
  c = newp; Point(c) = {0.4 + 0.5*k, 0.5, 0};
  p[] = {};
  For j In {0:3}
    q = newp; Point(q) = {0.4 + 0.5*k + r*Cos(j*Pi/2), 0.5 + r*Sin(j*Pi/2), 0}; p[] += q;
  EndFor
  s[] = {};
  For j In {0:3}
    l = newl; Circle(l) = {p[j], c, p[(j + 1) % 4]}; s[] += l;
  EndFor
  ll = newll; Curve Loop(ll) = {s[]}; loops[] += ll;
EndFor
Plane Surface(1) = {loops[]}; Physical Curve("left") = {4}; Physical Surface("all", 7) = Surface{:};
Transfinite Curve {1, 2} = 10; Field[1] = Distance;
"""
CUT = """
SetFactory("OpenCASCADE");
Rectangle(1) = {0, 0, 0, 2, 1}; Disk(2) = {0.5, 0.5, 0, 0.2};
d[] = Translate {1, 0, 0} { Duplicata { Surface{2}; } };
BooleanDifference(10) = { Surface{1}; Delete; }{ Surface{2, d[]}; Delete; };
"""
SPLINED = """
Point(1) = {0, 0, 0}; Point(2) = {1, 0, 0}; Point(3) = {1.2, .5, 0}; Point(4) = {1, 1, 0}; Point(5) = {0, 1, 0};
Point(6) = {-1e-1, 0.5, 0}; Point(7) = {0, 0.5, 0};
Line(1) = {1, 2}; Spline(2) = {2, 3, 4}; Line(3) = {4, 5}; BSpline(4) = {5, 6, 1};
Line Loop(1) = {1:4}; Plane Surface(1) = {1}; Physical Line("round", 3) = {2}; Physical Line("round", 3) += {4};
"""


@pytest.mark.slow
@pytest.mark.parametrize("text", [HOLES, CUT, SPLINED], ids=["holes", "cut", "splined"])
def test_what_is_read_is_what_gmsh_reads(tmp_path, text):
    path = tmp_path / "x.geo"
    path.write_text(text)
    (read, _), (run, _) = (shape_data(read_geo(path, trusted=trusted).curves, path.name) for trusted in (False, True))
    assert read.keys() == run.keys()
    assert read["edges"] == run["edges"] and read["holes"] == run["holes"] and read["groups"] == run["groups"]
    for name, place in read["vertices"].items():
        np.testing.assert_allclose(place, run["vertices"][name], atol=1e-14)


BOUNDS = {
    "work": ("For i In {1:99999}\nFor j In {1:99999}\na = 1;\nEndFor\nEndFor", "too much work"),
    "list": ("a[] = {1:1e9};", "more than 100000 numbers"),
    "doubled": ("a[] = {1};\nFor i In {1:60}\na[] = {a[], a[]};\nEndFor", "more than 100000 numbers"),
    "parentheses": ("a = " + "(" * 5000 + "1" + ")" * 5000 + ";", "nested more than"),
    "braces": ("a[] = " + "{" * 5000, "nested more than"),
    "powers": ("a = 1" + "^2" * 5000 + ";", "nested more than"),
    "loops": ("For i In {1:2}\n" * 5000, "nested more than"),
    "operations": ("Translate {1,0,0} { " * 5000, "nested more than"),
    "points": ("For i In {1:50000}\nPoint(i) = {i, 0, 0};\nEndFor", "too much work"),
    "size": (" " * 1_000_001, "longer than 1000000 bytes"),
    "comment": ("/* " * 1000, "has no end"),
    "loop without end": ("For i In {1:2}", "EndFor is missing"),
    "zero": ("a = 1/0;", "no value"),
    "infinite": ("a = 1e999;", "not a finite number"),
    "tag": ("Point(1e300) = {0, 0, 0};", "not the number of an entity"),
    "text": ('a = "touch";', "texts are not kept"),
    "function": ("a = GetNumber(1);", "GetNumber is not read"),
    "nowhere": ("Line(1) = {1, 2};", "gmsh cannot make this"),
    "character": ("`ls`", "has no meaning"),
}


@pytest.mark.slow
@pytest.mark.parametrize("name", list(BOUNDS))
def test_bounds_are_reported_with_their_line(tmp_path, monkeypatch, name):
    text, why = BOUNDS[name]
    if "work" in why:
        # A tenth of what is done outside of tests.
        monkeypatch.setattr("restshape.shape.drawings.geo_tokens.MOST_STEPS", 300_000)
    path = tmp_path / "x.geo"
    path.write_text(text)
    with pytest.raises(UserError, match=why) as reported:
        read_geo(path)
    assert reported.value.where.startswith("x.geo")


@pytest.mark.slow
def test_a_script_without_end_is_stopped(tmp_path, monkeypatch):
    monkeypatch.setattr("restshape.shape.drawings.geo_process.LIMIT", 3.0)
    path = tmp_path / "x.geo"
    path.write_text('SystemCall "sleep 100";')
    with pytest.raises(UserError, match="has not ended after 3 s"):
        read_geo(path, trusted=True)


@pytest.mark.slow
def test_a_boolean_without_end_is_ended(tmp_path, monkeypatch):
    path = tmp_path / "hard.geo"
    path.write_text(
        'SetFactory("OpenCASCADE");\n'
        "For i In {1:500}\n  Disk(i) = {Cos(i), Sin(2*i), 0, 0.6 + 0.1*Cos(3*i), 0.3 + 0.1*Sin(i)};\nEndFor\n"
        "BooleanFragments{ Surface{1:250}; Delete; }{ Surface{251:500}; Delete; }\n"
    )
    monkeypatch.setattr(geo_process, "LIMIT", 4.0)
    start = time.monotonic()
    with pytest.raises(UserError, match="has not ended after 4 s") as found:
        read_geo(path)
    assert time.monotonic() - start < 30
    assert found.value.where == "hard.geo" and "simpler Booleans" in found.value.do
