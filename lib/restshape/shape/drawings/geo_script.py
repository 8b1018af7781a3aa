"""Gmsh .geo files read statement by statement: those that draw are made, no other is run."""

from __future__ import annotations

from collections.abc import Callable
from types import ModuleType
from typing import TypeVar

from restshape.shape.drawings.geo_numbers import Numbers
from restshape.shape.drawings.geo_operations import operation
from restshape.shape.drawings.geo_tokens import Cursor, tokens_of

ENTITY_STEPS = 100
"""What an entity takes off the budget of words."""
DIMENSIONS = {"Point": 0, "Curve": 1, "Line": 1, "Surface": 2, "Volume": 3}
FRESH = ("newl", "newc", "newll", "newcl", "news", "newsl", "newv", "newreg")
TWO_WORDS = (
    "Curve Loop",
    "Line Loop",
    "Plane Surface",
    "Ruled Surface",
    "Physical Point",
    "Physical Curve",
    "Physical Line",
    "Physical Surface",
    "Physical Volume",
    "Background Field",
    "Characteristic Length",
)

Result = TypeVar("Result")
OF_THE_MESH = (
    "Mesh",
    "MeshSize",
    "Characteristic Length",
    "Transfinite",
    "Recombine",
    "Smoother",
    "Field",
    "Background Field",
    "Coherence",
)
"""Statements that say nothing about the outline, as those that embed entities do: passed over."""
OPTIONS = ("Mesh", "General", "Geometry")
"""Options that say how gmsh meshes and shows: passed over."""
TRUST = "draw with points, curves, loops and surfaces, or run the whole script, if you trust it: --trust-geo"


def draw(gmsh: ModuleType, text: str, where: str) -> None:
    """Makes, in gmsh's current model, what a .geo file draws.

    Args:
        gmsh: the package, started, with an empty model.
        text: of the file.
        where: its name, for messages.

    Raises:
        UserError: naming the line of a statement that is not read, or that gmsh cannot make.
    """
    GeoScript(gmsh, Cursor(tokens_of(text, where), where)).run()


class GeoScript:
    """One file while it is read.

    Args:
        gmsh: the package.
        cursor: at the first word.
    """

    def __init__(self, gmsh: ModuleType, cursor: Cursor) -> None:
        self.gmsh, self.cursor = gmsh, cursor
        self.kernel = gmsh.model.geo
        self.numbers = Numbers(cursor, self._fresh)
        self.groups: dict[tuple[int, str], list[int] | None] = {}

    def run(self) -> None:
        """Reads all statements, and gives the groups their names."""
        self._block(())
        self.synchronize()
        for (dimension, name), tags in self.groups.items():
            there = {tag for _, tag in self.gmsh.model.getEntities(dimension)}
            found = sorted(there) if tags is None else [abs(tag) for tag in tags if abs(tag) in there]
            if name and found:
                self.gmsh.model.addPhysicalGroup(dimension, found, name=name)

    def synchronize(self) -> None:
        """Puts what was drawn into gmsh's model."""
        for kernel in (self.gmsh.model.geo, self.gmsh.model.occ):
            kernel.synchronize()

    def made(self, line: int, make: Callable[..., Result], *arguments: object) -> Result:
        """What a call of gmsh gives.

        Raises:
            UserError: it cannot be made.
        """
        self.cursor.spend(ENTITY_STEPS)
        try:
            return make(*arguments)
        # gmsh reports every failure as a bare Exception, so nothing narrower can be caught.
        except Exception as error:
            raise self.cursor.error(f"gmsh cannot make this: {error}", "try it with gmsh itself", line) from None

    def _fresh(self, name: str) -> int | None:
        if name not in ("newp", *FRESH):
            return None
        dimensions = (0,) if name == "newp" else (1, 2, 3, -1, -2)
        kernels = (self.gmsh.model.geo, self.gmsh.model.occ)
        return max(kernel.getMaxTag(d) for kernel in kernels for d in dimensions) + 1

    def _block(self, ends: tuple[str, ...]) -> None:
        """Statements up to one of these words, or to the end of the file."""
        while self.cursor.peek().kind != "end":
            if self.cursor.peek().kind == "name" and self.cursor.peek().text in ends:
                return
            self._statement()
        if ends:
            raise self.cursor.error(f"{ends[0]} is missing", "close the loop or condition")

    def _statement(self) -> None:
        word = self.cursor.peek()
        if self.cursor.takes(";"):
            return
        if word.kind != "name":
            raise self.cursor.error(f"a statement is wanted here, not {word.text!r}")
        pair = f"{word.text} {self.cursor.peek(1).text}"
        name = pair if pair in TWO_WORDS else word.text
        flow = {"For": self._loop, "If": self._condition}.get(name)
        if flow:
            self.cursor.enter()
            flow()
            self.cursor.leave()
            return
        embedded = word.text in DIMENSIONS and self.cursor.peek(1).text == "{"
        if embedded or name in OF_THE_MESH or (word.text in OPTIONS and self.cursor.peek(1).text == "."):
            self._pass_over()
            return
        drawing = DRAWING.get(name)
        if drawing:
            for _ in name.split():
                self.cursor.next()
            drawing(self, word.line)
            self.cursor.expect(";")
        elif name == "SetFactory":
            self._factory()
        elif name == "DefineConstant":
            self._constants()
        elif operation(self) is not None:
            self.cursor.takes(";")
        elif not self._assignment():
            raise self.cursor.error(f"the statement {name} is not run", TRUST, word.line)

    def _pass_over(self) -> None:
        """Skips a statement, up to its semicolon."""
        depth = 0
        while depth or not self.cursor.sees(";"):
            word = self.cursor.next()
            depth += (word.text in ("{", "(", "[")) - (word.text in ("}", ")", "]")) if word.kind == "sign" else 0
            if word.kind == "end":
                raise self.cursor.error("the statement has no end", "close it by ;")
        self.cursor.next()

    def _factory(self) -> None:
        self.cursor.next()
        self.cursor.expect("(")
        word = self.cursor.next()
        kernels = {"Built-in": self.gmsh.model.geo, "OpenCASCADE": self.gmsh.model.occ}
        if word.text[1:-1] not in kernels:
            raise self.cursor.error(f"there is no kernel {word.text}", 'write "Built-in" or "OpenCASCADE"', word.line)
        self.kernel = kernels[word.text[1:-1]]
        self.cursor.expect(")")
        self.cursor.takes(";")

    def _constants(self) -> None:
        """``DefineConstant[ a = 1, b = {2, Name "b"} ]``: the values, where none is there already."""
        self.cursor.next()
        self.cursor.expect("[")
        while not self.cursor.takes("]"):
            name = self.cursor.next().text
            value = 0.0
            if self.cursor.takes("="):
                braced = self.cursor.takes("{")
                value = self.numbers.number()
                while braced and not self.cursor.takes("}"):
                    # What follows describes how gmsh's window shows it.
                    if self.cursor.next().kind == "end":
                        raise self.cursor.error("the braces have no end", "close them by }")
            self.numbers.values.setdefault(name, value)
            if not self.cursor.sees("]"):
                self.cursor.expect(",")
        self.cursor.takes(";")

    def _assignment(self) -> bool:
        """Sets a number or a list; False where this is no assignment."""
        name, numbers = self.cursor.peek().text, self.numbers
        if self.cursor.peek(1).text in ("=", "+=", "-=", "*=", "/=", "++", "--"):
            self.cursor.next()
            sign = self.cursor.next().text
            self._set_number(name, sign)
        elif (self.cursor.peek(1).text, self.cursor.peek(2).text) in (("[", "]"), ("(", ")")):
            for _ in range(3):
                self.cursor.next()
            more = self.cursor.takes("+=")
            if not more:
                self.cursor.expect("=")
            made = operation(self)
            found = [float(tag) for _, tag in made] if made is not None else numbers.list()
            numbers.lists[name] = [*numbers.lists.get(name, []), *found] if more else found
            self.cursor.spend(len(numbers.lists[name]))
            numbers.refuse_long(len(numbers.lists[name]))
        else:
            return False
        self.cursor.expect(";")
        return True

    def _set_number(self, name: str, sign: str) -> None:
        values, line = self.numbers.values, self.cursor.peek().line
        if sign != "=" and name not in values:
            raise self.cursor.error(f"there is no number {name!r}", "set it first", line)
        if self.cursor.peek().kind == "text":
            raise self.cursor.error("texts are not kept", TRUST, line)
        change = 1.0 if sign in ("++", "--") else self.numbers.number()
        match sign:
            case "=":
                values[name] = change
            case "+=" | "++":
                values[name] += change
            case "-=" | "--":
                values[name] -= change
            case "*=":
                values[name] *= change
            case "/=" if not change:
                raise self.cursor.error("this divides by 0", "mend the expression", line)
            case "/=":
                values[name] /= change

    def _loop(self) -> None:
        """``For i In {a:b:c} ... EndFor`` or ``For (a:b:c) ... EndFor``."""
        self.cursor.next()
        name = "" if self.cursor.sees("(") else self.cursor.next().text
        close = ")"
        if name:
            self.cursor.expect("In")
            close = "}"
        self.cursor.expect("{" if name else "(")
        first = self.numbers.number()
        self.cursor.expect(":")
        rounds = self.numbers.range(first)
        self.cursor.expect(close)
        start = self.cursor.at
        for value in rounds:
            self.cursor.at = start
            if name:
                self.numbers.values[name] = value
            self._block(("EndFor",))
        if not rounds:
            self._skip("For", ("EndFor",))
        self.cursor.expect("EndFor")

    def _condition(self) -> None:
        """``If (a) ... ElseIf (b) ... Else ... EndIf``."""
        done, ends = False, ("EndIf", "Else", "ElseIf")
        while not self.cursor.sees("EndIf"):
            word = self.cursor.next().text
            holds = word == "Else" or self.numbers.number() != 0.0
            if holds and not done:
                self._block(ends)
            else:
                self._skip("If", ends)
            done = done or holds
        self.cursor.next()

    def _skip(self, opening: str, ends: tuple[str, ...]) -> None:
        """Passes over statements that are not run, up to one of these words of the same level."""
        depth = 0
        while depth or self.cursor.peek().text not in ends:
            word = self.cursor.next()
            if word.kind == "end":
                raise self.cursor.error(f"{ends[0]} is missing", "close the loop or condition")
            depth += (word.text == opening) - (word.text == ends[0])

    def _head(self) -> int:
        """The number in ``(number) =``."""
        self.cursor.expect("(")
        tag = self.numbers.tag()
        self.cursor.expect(")")
        self.cursor.expect("=")
        return tag

    def _check_count(self, what: str, values: list[float], counts: tuple[int, ...], line: int) -> None:
        if len(values) not in counts:
            wanted = " or ".join(map(str, counts))
            raise self.cursor.error(f"{what} takes {wanted} numbers, not {len(values)}", "see gmsh's manual", line)

    def point(self, line: int) -> None:
        """``Point(t) = {x, y, z, size}``; the size says nothing about the outline."""
        tag, values = self._head(), self.numbers.list()
        self._check_count("Point", values, (3, 4), line)
        self.made(line, self.kernel.addPoint, *values[:3], 0.0, tag)

    def curve(self, line: int, call: str, least: int, most: int | None = None) -> None:
        """A curve through points that are there."""
        tag, points = self._head(), self.numbers.tags()
        if len(points) < least or (most and len(points) > most):
            raise self.cursor.error(f"{len(points)} points do not make this curve", "see gmsh's manual", line)
        make = getattr(self.kernel, call)
        self.made(line, make, *(points if most else [points]), tag)

    def round(self, line: int, arc: str, whole: str, corners: int) -> None:
        """An arc between points, or, with OpenCASCADE, a whole circle or ellipse or a part of it by its angles."""
        tag, values = self._head(), self.numbers.list()
        if len(values) == corners:
            points = [self.numbers.whole(value, line) for value in values]
            self.made(line, getattr(self.kernel, arc), *points, tag)
            return
        count = corners + 1
        if self.kernel is not self.gmsh.model.occ or not count <= len(values) <= count + 2:
            what = f"{len(values)} numbers do not make this curve"
            raise self.cursor.error(what, "see gmsh's manual", line)
        self.made(line, getattr(self.kernel, whole), *values[:count], tag, *values[count:])

    def loop(self, line: int) -> None:
        """``Curve Loop(t) = {curves}``."""
        tag, curves = self._head(), self.numbers.tags()
        self.made(line, self.kernel.addCurveLoop, curves, tag)

    def plane(self, line: int) -> None:
        """``Plane Surface(t) = {loops}``."""
        tag, loops = self._head(), self.numbers.tags()
        self.made(line, self.kernel.addPlaneSurface, [abs(loop) for loop in loops], tag)

    def filling(self, line: int) -> None:
        """``Surface(t) = {loop}``."""
        tag, loops = self._head(), self.numbers.tags()
        if len(loops) != 1:
            raise self.cursor.error("a surface is filled into one loop", "write Plane Surface", line)
        wires = loops if self.kernel is self.gmsh.model.geo else loops[0]
        self.made(line, self.kernel.addSurfaceFilling, wires, tag)

    def block_of(self, line: int, call: str, counts: tuple[int, ...]) -> None:
        """A surface of OpenCASCADE's: a rectangle or a disk."""
        tag, values = self._head(), self.numbers.list()
        if self.kernel is not self.gmsh.model.occ:
            raise self.cursor.error("the built-in kernel has no such surface", 'SetFactory("OpenCASCADE");', line)
        self._check_count(call.removeprefix("add"), values, counts, line)
        if call == "addRectangle":
            self.made(line, self.kernel.addRectangle, *values[:5], tag, *values[5:])
        else:
            self.made(line, self.kernel.addDisk, *values[:4], values[-1], tag)

    def group(self, line: int) -> None:
        """``Physical Curve("name", number) = {curves}``; one without a name is passed over."""
        dimension = DIMENSIONS[self.cursor.peek(-1).text]
        self.cursor.expect("(")
        name = ""
        if self.cursor.peek().kind == "text":
            name = self.cursor.next().text[1:-1]
        if not name or self.cursor.takes(","):
            self.numbers.number()
        self.cursor.expect(")")
        more = self.cursor.takes("+=")
        if not more:
            self.cursor.expect("=")
        if self.cursor.peek().text in DIMENSIONS:
            self.cursor.next()
        former = self.groups.get((dimension, name), []) if more else []
        tags = None if self.cursor.takes("{", ":", "}") else self.numbers.tags()
        self.groups[dimension, name] = None if tags is None or former is None else [*former, *tags]


DRAWING: dict[str, Callable[[GeoScript, int], None]] = {
    "Point": GeoScript.point,
    "Line": lambda script, line: script.curve(line, "addLine", 2, 2),
    "Circle": lambda script, line: script.round(line, "addCircleArc", "addCircle", 3),
    "Ellipse": lambda script, line: script.round(line, "addEllipseArc", "addEllipse", 4),
    "Spline": lambda script, line: script.curve(line, "addSpline", 2),
    "BSpline": lambda script, line: script.curve(line, "addBSpline", 2),
    "Bezier": lambda script, line: script.curve(line, "addBezier", 2),
    "Curve Loop": GeoScript.loop,
    "Line Loop": GeoScript.loop,
    "Plane Surface": GeoScript.plane,
    "Ruled Surface": GeoScript.filling,
    "Surface": GeoScript.filling,
    "Rectangle": lambda script, line: script.block_of(line, "addRectangle", (5, 6)),
    "Disk": lambda script, line: script.block_of(line, "addDisk", (4, 5)),
    **{name: GeoScript.group for name in TWO_WORDS if name.startswith("Physical")},
}
"""Statements that draw or name, by what they begin with."""
