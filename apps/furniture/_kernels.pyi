from __future__ import annotations
import collections.abc
import numpy
import numpy.typing
import typing

__all__: list[str] = ["Furniture", "free_ends"]

class Furniture:
    class Mixed:
        def __init__(self, arg0: Furniture) -> None: ...
        def energy(
            self,
            arg0: typing.SupportsInt | typing.SupportsIndex,
            arg1: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        ) -> float: ...
        def join(self, arg0: typing.SupportsInt | typing.SupportsIndex) -> numpy.typing.NDArray[numpy.float64]: ...
        def part(
            self, arg0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]
        ) -> numpy.typing.NDArray[numpy.float64]: ...
        def pattern(self) -> tuple[numpy.typing.NDArray[numpy.int32], numpy.typing.NDArray[numpy.int32]]: ...
        def residual(
            self,
            arg0: typing.SupportsInt | typing.SupportsIndex,
            arg1: typing.SupportsInt | typing.SupportsIndex,
            arg2: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
            arg3: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        ) -> None: ...
        def tangent(
            self,
            arg0: typing.SupportsInt | typing.SupportsIndex,
            arg1: typing.SupportsInt | typing.SupportsIndex,
            arg2: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
            arg3: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
            arg4: typing.SupportsFloat | typing.SupportsIndex,
        ) -> None: ...
        @property
        def size(self) -> int: ...

    class ManySprings:
        def __init__(
            self, furniture: Furniture, compliances: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]
        ) -> None: ...
        def decide(
            self,
            gamma: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
            spread: typing.SupportsFloat | typing.SupportsIndex,
        ) -> bool: ...
        def forget(self) -> None: ...
        def test(
            self,
            gamma: typing.Annotated[numpy.typing.ArrayLike, numpy.float64] | None = None,
            ending: typing.SupportsInt | typing.SupportsIndex = 0,
        ) -> tuple: ...
        @property
        def steps(self) -> int: ...

    APART: typing.ClassVar[int] = 32
    DOUBTFUL: typing.ClassVar[int] = 64
    LOST: typing.ClassVar[int] = 1
    OVERLAPPING: typing.ClassVar[int] = 2
    UNBALANCED: typing.ClassVar[int] = 16
    UNSTABLE: typing.ClassVar[int] = 4
    WEAK: typing.ClassVar[int] = 8

    def __init__(
        self,
        centre: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        axes: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        size: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        density: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        joints: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
        strength: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        feet: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
        planes: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        loaded: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
        places: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        cases: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        gravity: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        settings: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    ) -> None: ...
    def bisect(
        self,
        direction: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        good: typing.SupportsFloat | typing.SupportsIndex,
        bad: typing.SupportsFloat | typing.SupportsIndex,
        tolerance: typing.SupportsFloat | typing.SupportsIndex,
        wanted: typing.SupportsInt | typing.SupportsIndex = 63,
    ) -> tuple: ...
    def derivative(
        self,
        directions: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        case: typing.SupportsInt | typing.SupportsIndex,
    ) -> dict: ...
    def forces(self, case: typing.SupportsInt | typing.SupportsIndex) -> dict: ...
    def forget(self) -> None: ...
    def freedoms(
        self, step: typing.SupportsFloat | typing.SupportsIndex = 0.01
    ) -> list[typing.Annotated[list[int], "FixedSize(2)"]]: ...
    def inside(self, case: typing.SupportsInt | typing.SupportsIndex) -> bool: ...
    def nails(self) -> numpy.typing.NDArray[numpy.float64]: ...
    def one_sided(self, case: typing.SupportsInt | typing.SupportsIndex) -> bool: ...
    def scan(
        self,
        direction: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        t: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        wanted: typing.SupportsInt | typing.SupportsIndex = 63,
    ) -> tuple: ...
    def set_state(
        self,
        arg0: typing.SupportsInt | typing.SupportsIndex,
        arg1: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        arg2: typing.SupportsInt | typing.SupportsIndex,
    ) -> None: ...
    def shape(self, gamma: typing.Annotated[numpy.typing.ArrayLike, numpy.float64] | None = None) -> dict: ...
    def stability(self, case: typing.SupportsInt | typing.SupportsIndex) -> numpy.typing.NDArray[numpy.float64]: ...
    def stability_rows(
        self,
        directions: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        case: typing.SupportsInt | typing.SupportsIndex,
    ) -> tuple: ...
    def test(
        self,
        gamma: typing.Annotated[numpy.typing.ArrayLike, numpy.float64] | None = None,
        wanted: typing.SupportsInt | typing.SupportsIndex = 63,
        quick: bool = False,
    ) -> tuple: ...
    @property
    def fits(self) -> int: ...
    @property
    def parts(self) -> int: ...
    @property
    def steps(self) -> int: ...

def free_ends(
    centre: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    axes: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    size: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    joints: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
    feet: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
    floor: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    near: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    planks: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex],
) -> list: ...
