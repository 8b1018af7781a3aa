from __future__ import annotations
import collections.abc
import numpy
import numpy.typing
import typing

__all__: list[str] = [
    "Body",
    "BodyRates",
    "Element",
    "GridDistance",
    "HarmonicExtension",
    "MesherFailure",
    "NearPairs",
    "OpenBlocks",
    "Operator",
    "OutlineCheck",
    "PatchRecovery",
    "PointRoom",
    "Sheet",
    "Stage",
    "SurfaceSearch",
    "TriangleRoom",
    "Triangulation",
    "add_friction",
    "begin_frame",
    "between_ranks",
    "border_complement",
    "bordered_pattern",
    "build",
    "calls",
    "cell_order",
    "cells_around",
    "cells_left_of",
    "check_cells",
    "combinations",
    "combine_rows",
    "complete_inside",
    "conjugate_steps",
    "correct_around",
    "couplings_of_ranks",
    "curved_jacobian_bound",
    "cycle_in_single",
    "distances",
    "edge_parameters",
    "edges_of_cells",
    "element_names",
    "eliminate_inside",
    "ended_at_zero",
    "energy_products",
    "estimate_points",
    "extrude_nodes",
    "factor_shared_rows",
    "farthest_apart",
    "finite_rows",
    "flop_rate",
    "follow_sides",
    "forget_cycle",
    "forget_failure",
    "forget_products",
    "give_back_memory",
    "gmls",
    "grade_sizes",
    "guess_step",
    "has_cgal",
    "hilbert_keys",
    "interpolate_rows",
    "inverted_cells",
    "keep_border",
    "keep_step",
    "lacking_forces",
    "largest_norm",
    "largest_size",
    "least_slide",
    "locate",
    "locate_quadratic",
    "longest_sides",
    "matrices",
    "matrix_products",
    "mean_at",
    "mean_value",
    "mesher_items",
    "met_by_inside",
    "momenta",
    "move_and_check",
    "moved_cells",
    "moved_points",
    "multiply_in_registers",
    "narrow_widths",
    "nested_vectors",
    "node_blocks",
    "node_lu",
    "node_lu_single",
    "node_order",
    "node_ssor",
    "nonzero_rows",
    "packed",
    "panel_value_bytes",
    "place_weights",
    "positive_mean_value",
    "pull_back",
    "quadratic_stress",
    "rates_after",
    "recover_quadratic",
    "recover_space",
    "recovery_energies",
    "recovery_points",
    "refine_delaunay",
    "register_node_cholesky",
    "register_node_lu",
    "register_node_relaxation",
    "relax_and_check",
    "remove_tractions",
    "reset_calls",
    "residual_norm",
    "ridge_weights",
    "row_products",
    "same_bits",
    "same_values",
    "schur_complement",
    "sent_fields",
    "sent_outline",
    "set_schur_rows",
    "set_stage",
    "sides_gone",
    "smooth_fresh",
    "solve_by_panels",
    "space_recovery_points",
    "split_prisms",
    "stop_watching",
    "take_entries",
    "take_increment",
    "thickness_stretch",
    "total_area",
    "triad_seconds",
    "triangle_energies",
    "triangle_stress",
    "update_friction",
    "von_mises",
    "watch",
    "watch_outlet",
    "weigh_state",
    "weighted_sum",
    "with_points",
]

class GridDistance:
    def __init__(
        self,
        origin: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"],
        spacing: typing.SupportsFloat | typing.SupportsIndex,
        bricks: typing.Annotated[collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex], "FixedSize(3)"],
        low: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"],
        high: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"],
        band: typing.SupportsFloat | typing.SupportsIndex,
        table: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
        fine: typing.Annotated[numpy.typing.ArrayLike, numpy.float32],
        coarse: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        bent: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        slope: typing.SupportsFloat | typing.SupportsIndex,
        thin: typing.SupportsFloat | typing.SupportsIndex,
        sharpest: typing.SupportsFloat | typing.SupportsIndex,
        slack: typing.SupportsFloat | typing.SupportsIndex,
    ) -> None: ...
    def at(self, x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> tuple: ...
    def shapes(
        self, x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]
    ) -> numpy.typing.NDArray[numpy.float64]: ...
    def values(
        self, x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]
    ) -> numpy.typing.NDArray[numpy.float64]: ...

class SurfaceSearch:
    def __init__(
        self,
        x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        cells: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
    ) -> None: ...
    def fill_lattice(
        self,
        origin: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(3)"],
        spacing: typing.SupportsFloat | typing.SupportsIndex,
        wanted: typing.Annotated[numpy.typing.ArrayLike, numpy.uint8],
        values: numpy.typing.NDArray[numpy.float64],
        whole: SurfaceSearch | None = None,
        far: typing.SupportsFloat | typing.SupportsIndex = 2.5,
    ) -> None: ...
    def first_hits(
        self,
        x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        ways: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    ) -> numpy.typing.NDArray[numpy.float64]: ...
    def nearest(
        self,
        x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        far: typing.SupportsFloat | typing.SupportsIndex = 2.5,
    ) -> tuple: ...
    def winding(
        self,
        x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        far: typing.SupportsFloat | typing.SupportsIndex = 2.5,
    ) -> numpy.typing.NDArray[numpy.float64]: ...

class Body:
    @staticmethod
    def box(
        centre: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        half: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        rotation: typing.Annotated[numpy.typing.ArrayLike, numpy.float64] | None = None,
        radius: typing.SupportsFloat | typing.SupportsIndex = 0.0,
    ) -> Body: ...
    @staticmethod
    def capsule(
        start: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        end: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        radius: typing.SupportsFloat | typing.SupportsIndex,
    ) -> Body: ...
    @staticmethod
    def cylinder(
        start: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        end: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        radius: typing.SupportsFloat | typing.SupportsIndex,
        rounded: typing.SupportsFloat | typing.SupportsIndex = 0.0,
    ) -> Body: ...
    @staticmethod
    def mesh(
        grid: GridDistance,
        place: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        rotation: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        scale: typing.SupportsFloat | typing.SupportsIndex = 1.0,
    ) -> Body: ...
    @staticmethod
    def plane(
        point: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        normal: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    ) -> Body: ...
    @staticmethod
    def sphere(
        centre: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        radius: typing.SupportsFloat | typing.SupportsIndex,
    ) -> Body: ...
    def add_contact(
        self,
        x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        area: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        stiffness: typing.SupportsFloat | typing.SupportsIndex,
        thickness: typing.SupportsFloat | typing.SupportsIndex,
        potential: numpy.typing.NDArray[numpy.float64],
        curved: bool = True,
    ) -> float: ...
    def distance(self, x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> tuple: ...
    def distances(
        self, x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]
    ) -> numpy.typing.NDArray[numpy.float64]: ...
    def lowest(
        self,
        x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        cells: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
        tolerance: typing.SupportsFloat | typing.SupportsIndex,
    ) -> tuple: ...
    def lowest_each(
        self,
        x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        cells: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
        tolerance: typing.SupportsFloat | typing.SupportsIndex,
        enough: typing.Annotated[numpy.typing.ArrayLike, numpy.float64] | None = None,
    ) -> tuple: ...
    def step_share(
        self,
        x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        d: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        cells: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
        floor: typing.SupportsFloat | typing.SupportsIndex,
        deeper: typing.SupportsFloat | typing.SupportsIndex,
        tolerance: typing.SupportsFloat | typing.SupportsIndex,
        bottom: typing.SupportsFloat | typing.SupportsIndex = ...,
    ) -> float: ...
    @property
    def hull(self) -> Body: ...
    @property
    def inner_radius(self) -> float: ...
    @property
    def sharpest(self) -> float: ...

class PointRoom:
    def __init__(self, body: Body, count: typing.SupportsInt | typing.SupportsIndex) -> None: ...
    def add_contact(
        self,
        x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        area: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        stiffness: typing.SupportsFloat | typing.SupportsIndex,
        thickness: typing.SupportsFloat | typing.SupportsIndex,
        potential: numpy.typing.NDArray[numpy.float64],
        curved: bool = True,
    ) -> float: ...
    @property
    def count(self) -> int: ...
    @property
    def looks(self) -> int: ...

class TriangleRoom:
    def __init__(
        self,
        body: Body,
        count: typing.SupportsInt | typing.SupportsIndex,
        floor: typing.SupportsFloat | typing.SupportsIndex,
        deeper: typing.SupportsFloat | typing.SupportsIndex,
        tolerance: typing.SupportsFloat | typing.SupportsIndex,
        bottom: typing.SupportsFloat | typing.SupportsIndex = ...,
    ) -> None: ...
    def step_share(
        self,
        x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        d: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        cells: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
    ) -> float: ...
    @property
    def looks(self) -> int: ...

class BodyRates:
    @staticmethod
    def box(
        centre: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        half: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        rotation: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        radius: typing.SupportsFloat | typing.SupportsIndex,
        dcentre: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        dhalf: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        drotation: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        dradius: typing.SupportsFloat | typing.SupportsIndex,
    ) -> BodyRates: ...
    @staticmethod
    def capsule(
        start: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        end: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        radius: typing.SupportsFloat | typing.SupportsIndex,
        dstart: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        dend: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        dradius: typing.SupportsFloat | typing.SupportsIndex,
    ) -> BodyRates: ...
    @staticmethod
    def cylinder(
        start: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        end: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        radius: typing.SupportsFloat | typing.SupportsIndex,
        rounded: typing.SupportsFloat | typing.SupportsIndex,
        dstart: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        dend: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        dradius: typing.SupportsFloat | typing.SupportsIndex,
        drounded: typing.SupportsFloat | typing.SupportsIndex,
    ) -> BodyRates: ...
    @staticmethod
    def mesh(
        grid: GridDistance,
        place: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        rotation: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        scale: typing.SupportsFloat | typing.SupportsIndex,
        dplace: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        drotation: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        dscale: typing.SupportsFloat | typing.SupportsIndex,
    ) -> BodyRates: ...
    @staticmethod
    def plane(
        point: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        normal: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        dpoint: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        dnormal: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    ) -> BodyRates: ...
    @staticmethod
    def sphere(
        centre: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        radius: typing.SupportsFloat | typing.SupportsIndex,
        dcentre: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        dradius: typing.SupportsFloat | typing.SupportsIndex,
    ) -> BodyRates: ...
    def __init__(self, body: Body) -> None: ...
    def add_force_rates(
        self,
        x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        dx: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        area: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        darea: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        stiffness: typing.Annotated[
            collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(2)"
        ],
        thickness: typing.Annotated[
            collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(2)"
        ],
        coefficient: typing.Annotated[
            collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(2)"
        ],
        slip: typing.Annotated[collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex], "FixedSize(2)"],
        anchor: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        danchor: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        limit: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        out: numpy.typing.NDArray[numpy.float64],
    ) -> None: ...

class Element:
    def __init__(self, name: str) -> None: ...
    def design(
        self,
        X: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        dX: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        cells: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
        params: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        out: numpy.typing.NDArray[numpy.float64],
        dx: typing.Annotated[numpy.typing.ArrayLike, numpy.float64] | None = None,
        coefficients: typing.Annotated[numpy.typing.ArrayLike, numpy.float64] | None = None,
        dw: typing.Annotated[numpy.typing.ArrayLike, numpy.float64] | None = None,
        dofs: typing.Annotated[numpy.typing.ArrayLike, numpy.int32] | None = None,
    ) -> None: ...
    def energy(
        self,
        X: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        cells: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
        params: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        coefficients: typing.Annotated[numpy.typing.ArrayLike, numpy.float64] | None = None,
        dofs: typing.Annotated[numpy.typing.ArrayLike, numpy.int32] | None = None,
    ) -> numpy.typing.NDArray[numpy.float64]: ...
    def residual(
        self,
        X: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        cells: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
        params: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        out: numpy.typing.NDArray[numpy.float64],
        subset: typing.Annotated[numpy.typing.ArrayLike, numpy.int32] | None = None,
        coefficients: typing.Annotated[numpy.typing.ArrayLike, numpy.float64] | None = None,
        dofs: typing.Annotated[numpy.typing.ArrayLike, numpy.int32] | None = None,
    ) -> None: ...
    def stress(
        self,
        X: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        cells: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
        params: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        out: numpy.typing.NDArray[numpy.float64],
        points: typing.Annotated[numpy.typing.ArrayLike, numpy.float64] | None = None,
        coefficients: typing.Annotated[numpy.typing.ArrayLike, numpy.float64] | None = None,
        dofs: typing.Annotated[numpy.typing.ArrayLike, numpy.int32] | None = None,
    ) -> None: ...
    def tangent_block(
        self,
        X: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        params: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        coefficients: typing.Annotated[numpy.typing.ArrayLike, numpy.float64] | None = None,
    ) -> numpy.typing.NDArray[numpy.float64]: ...
    @property
    def coefficients(self) -> tuple: ...
    @property
    def dim(self) -> int: ...
    @property
    def dof_nodes(self) -> int: ...
    @property
    def family(self) -> str: ...
    @property
    def fields(self) -> int: ...
    @property
    def has_tangent(self) -> bool: ...
    @property
    def layout(self) -> tuple: ...
    @property
    def name(self) -> str: ...
    @property
    def nodes(self) -> int: ...
    @property
    def parameters(self) -> tuple: ...
    @property
    def shape(self) -> str: ...
    @property
    def stress_components(self) -> int: ...
    @property
    def symmetric(self) -> bool: ...

class Operator:
    def __init__(
        self,
        world: bool,
        fields: typing.SupportsInt | typing.SupportsIndex,
        node_offsets: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex],
        rank: typing.SupportsInt | typing.SupportsIndex = 0,
        backend: str = "csr",
    ) -> None: ...
    def add(
        self,
        block: typing.SupportsInt | typing.SupportsIndex,
        X: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        terms: list,
        rhs: numpy.typing.NDArray[numpy.float64] | None = None,
        cells: typing.Annotated[numpy.typing.ArrayLike, numpy.int32] | None = None,
    ) -> None: ...
    def add_sum(
        self, terms: collections.abc.Sequence, rhs: numpy.typing.NDArray[numpy.float64] | None = None
    ) -> None: ...
    def assemble(
        self,
        terms: collections.abc.Sequence,
        rhs: numpy.typing.NDArray[numpy.float64] | None = None,
        kept: bool = False,
    ) -> None: ...
    def begin(self, kept: bool = False) -> None: ...
    def end(self) -> None: ...
    def keep(self) -> None: ...
    def patch(
        self,
        block: typing.SupportsInt | typing.SupportsIndex,
        changed_cells: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
    ) -> None: ...
    def set_constraints(self, mask: typing.Annotated[numpy.typing.ArrayLike, numpy.uint8]) -> None: ...
    def set_sliding(
        self,
        nodes: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
        kept: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    ) -> None: ...
    def set_topology(self, blocks: list) -> None: ...
    @property
    def generation(self) -> int: ...
    @property
    def handle(self) -> int: ...
    @property
    def mat(self) -> typing.Any: ...
    @property
    def nnz(self) -> int: ...

class HarmonicExtension:
    def __init__(
        self,
        X: numpy.typing.NDArray[numpy.float64],
        cells: numpy.typing.NDArray[numpy.int32],
        boundary: numpy.typing.NDArray[numpy.int32],
        border: numpy.typing.NDArray[numpy.int32] | None = None,
    ) -> None: ...
    def complement(self) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    def complete(
        self,
        values: typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]", "flags.c_contiguous"],
        border: typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]", "flags.c_contiguous"],
    ) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    def reduce(
        self, values: typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]", "flags.c_contiguous"]
    ) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    def solve(
        self, values: typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]", "flags.c_contiguous"]
    ) -> typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]"]: ...
    def stiffen(self, largest: typing.SupportsFloat | typing.SupportsIndex) -> None: ...
    def weigh(
        self, field: typing.Annotated[numpy.typing.NDArray[numpy.float64], "[m, n]", "flags.c_contiguous"]
    ) -> float: ...

class Triangulation:
    def __init__(
        self,
        cells: numpy.typing.NDArray[numpy.int32],
        cell_edges: numpy.typing.NDArray[numpy.int32],
        edge_nodes: numpy.typing.NDArray[numpy.int32],
        fixed: numpy.typing.NDArray[numpy.uint8],
    ) -> None: ...
    def flip_delaunay(
        self,
        X: numpy.typing.NDArray[numpy.float64],
        max_passes: typing.SupportsInt | typing.SupportsIndex,
        quality_floor: typing.SupportsFloat | typing.SupportsIndex = 1.0,
    ) -> tuple: ...
    @property
    def edge_cells(self) -> numpy.typing.NDArray[numpy.int32]: ...

class MesherFailure(Exception):
    pass

class NearPairs:
    def __init__(
        self,
        X: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        edges: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
        cells: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
    ) -> None: ...
    def crossed(
        self, x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]
    ) -> numpy.typing.NDArray[numpy.int32]: ...
    def search(
        self,
        x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        reach: typing.SupportsFloat | typing.SupportsIndex,
    ) -> tuple: ...
    def sew(
        self,
        numbers: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
        sewn: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
    ) -> None: ...
    def step_share(
        self,
        x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        d: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        reach: typing.SupportsFloat | typing.SupportsIndex = 0.0,
    ) -> float: ...

class Sheet:
    def __init__(
        self,
        X: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        corners: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
        moduli: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        bends: str,
        cells: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
        stiffness: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    ) -> None: ...
    def evaluate(
        self, x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64], out: numpy.typing.NDArray[numpy.float64]
    ) -> float: ...

class OutlineCheck:
    def __init__(
        self,
        first: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
        ends: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
        loops: collections.abc.Sequence[
            tuple[
                typing.SupportsInt | typing.SupportsIndex,
                collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex],
                collections.abc.Sequence[bool],
                typing.SupportsInt | typing.SupportsIndex,
            ]
        ],
        gap: typing.SupportsFloat | typing.SupportsIndex,
        sharpest: typing.SupportsFloat | typing.SupportsIndex,
        round: collections.abc.Sequence[bool],
        spot_pieces: collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex],
    ) -> None: ...
    def check(
        self, c0: typing.SupportsFloat | typing.SupportsIndex, c1: typing.SupportsFloat | typing.SupportsIndex
    ) -> typing.Any: ...
    def set_motion(
        self,
        p0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        p1: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        p2: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        e0: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        e1: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        e2: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
        state: typing.Annotated[numpy.typing.ArrayLike, numpy.uint8],
        rigid: bool,
    ) -> None: ...
    def settle(
        self, c0: typing.SupportsFloat | typing.SupportsIndex, c1: typing.SupportsFloat | typing.SupportsIndex
    ) -> None: ...

class OpenBlocks:
    def __init__(self) -> None: ...

class Stage:
    def __enter__(self) -> None: ...
    def __exit__(self, kind: typing.Any, error: typing.Any, trace: typing.Any) -> None: ...
    def __init__(
        self, name: str, seconds: dict, open: OpenBlocks, log: typing.SupportsInt | typing.SupportsIndex = -1
    ) -> None: ...
    @property
    def name(self) -> str: ...

class PatchRecovery:
    def __call__(
        self,
        X: numpy.typing.NDArray[numpy.float64],
        stress: numpy.typing.NDArray[numpy.float64],
        out: numpy.typing.NDArray[numpy.float64],
    ) -> None: ...
    def __init__(
        self,
        cells: numpy.typing.NDArray[numpy.int32],
        rows: numpy.typing.NDArray[numpy.int32],
        count: typing.SupportsInt | typing.SupportsIndex,
    ) -> None: ...
    def follow(self, cells: numpy.typing.NDArray[numpy.int32], rows: numpy.typing.NDArray[numpy.int32]) -> None: ...
    def triangles(
        self,
        X: numpy.typing.NDArray[numpy.float64],
        x: numpy.typing.NDArray[numpy.float64],
        params: numpy.typing.NDArray[numpy.float64],
        plane_stress: bool,
        energy: numpy.typing.NDArray[numpy.float64],
        stress: numpy.typing.NDArray[numpy.float64] | None,
        nodal: numpy.typing.NDArray[numpy.float64] | None,
        equivalent: numpy.typing.NDArray[numpy.float64] | None,
    ) -> None: ...

def add_friction(
    x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    anchor: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    normal: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    limit: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    slip: typing.SupportsFloat | typing.SupportsIndex,
    potential: numpy.typing.NDArray[numpy.float64],
) -> float: ...
def begin_frame() -> None: ...
def between_ranks(
    handle: typing.SupportsInt | typing.SupportsIndex, place: numpy.typing.NDArray[numpy.int32]
) -> tuple: ...
def border_complement(
    factor: typing.SupportsInt | typing.SupportsIndex, out: numpy.typing.NDArray[numpy.float64]
) -> None: ...
def bordered_pattern(
    handle: typing.SupportsInt | typing.SupportsIndex,
    number: numpy.typing.NDArray[numpy.int32],
    inside: typing.SupportsInt | typing.SupportsIndex,
    border: typing.SupportsInt | typing.SupportsIndex,
) -> tuple: ...
def build() -> dict: ...
def calls() -> dict: ...
def cell_order(
    cells: typing.Annotated[numpy.typing.ArrayLike, numpy.int32], nodes: typing.SupportsInt | typing.SupportsIndex
) -> numpy.typing.NDArray[numpy.int32]: ...
def cells_around(
    cells: numpy.typing.NDArray[numpy.int32],
    nodes: numpy.typing.NDArray[numpy.int32],
    node_count: typing.SupportsInt | typing.SupportsIndex,
) -> numpy.typing.NDArray[numpy.int32]: ...
def cells_left_of(
    facets: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
    cells: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
    nodes: typing.SupportsInt | typing.SupportsIndex,
) -> numpy.typing.NDArray[numpy.int32]: ...
def check_cells(
    X: numpy.typing.NDArray[numpy.float64],
    cells: numpy.typing.NDArray[numpy.int32],
    area_floor: typing.SupportsFloat | typing.SupportsIndex,
    quality_floor: typing.SupportsFloat | typing.SupportsIndex,
) -> tuple: ...
def combinations(
    K: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    h: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    e: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    low: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    high: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    most: typing.SupportsInt | typing.SupportsIndex,
    least: typing.SupportsInt | typing.SupportsIndex,
    least_gain: typing.SupportsFloat | typing.SupportsIndex,
    longest: typing.SupportsFloat | typing.SupportsIndex,
    barred: collections.abc.Sequence[collections.abc.Sequence[typing.SupportsInt | typing.SupportsIndex]],
    keep: typing.SupportsInt | typing.SupportsIndex,
) -> tuple: ...
def combine_rows(
    weights: numpy.typing.NDArray[numpy.float64],
    rows: numpy.typing.NDArray[numpy.float64],
    out: numpy.typing.NDArray[numpy.float64],
    add: bool,
) -> None: ...
def complete_inside(
    factor: typing.SupportsInt | typing.SupportsIndex,
    border: numpy.typing.NDArray[numpy.float64],
    inside: numpy.typing.NDArray[numpy.float64],
) -> None: ...
def conjugate_steps(
    mat: typing.SupportsInt | typing.SupportsIndex,
    pc: typing.SupportsInt | typing.SupportsIndex,
    right: numpy.typing.NDArray[numpy.float64],
    out: numpy.typing.NDArray[numpy.float64],
    known: typing.SupportsFloat | typing.SupportsIndex,
    delay: typing.SupportsInt | typing.SupportsIndex,
    enough: typing.SupportsFloat | typing.SupportsIndex,
    most: typing.SupportsInt | typing.SupportsIndex,
) -> bool: ...
def correct_around(
    factor: typing.SupportsInt | typing.SupportsIndex,
    matrix: typing.SupportsInt | typing.SupportsIndex,
    nodes: numpy.typing.NDArray[numpy.int32],
    fields: typing.SupportsInt | typing.SupportsIndex,
) -> bool: ...
def couplings_of_ranks(handle: typing.SupportsInt | typing.SupportsIndex) -> tuple: ...
def curved_jacobian_bound(
    X: numpy.typing.NDArray[numpy.float64],
    cells: numpy.typing.NDArray[numpy.int32],
    subset: typing.Annotated[numpy.typing.ArrayLike, numpy.int32] | None = None,
) -> numpy.typing.NDArray[numpy.float64]: ...
def cycle_in_single(pc: typing.SupportsInt | typing.SupportsIndex) -> bool: ...
def distances(
    points: numpy.typing.NDArray[numpy.float64],
    starts: numpy.typing.NDArray[numpy.float64],
    ends: numpy.typing.NDArray[numpy.float64],
) -> numpy.typing.NDArray[numpy.float64]: ...
def edge_parameters(
    s: numpy.typing.NDArray[numpy.float64],
    arc: numpy.typing.NDArray[numpy.float64],
    size: numpy.typing.NDArray[numpy.float64],
    stops: numpy.typing.NDArray[numpy.float64],
    fewest: typing.SupportsInt | typing.SupportsIndex,
) -> numpy.typing.NDArray[numpy.float64]: ...
def edges_of_cells(
    cells: typing.Annotated[numpy.typing.ArrayLike, numpy.int32], nodes: typing.SupportsInt | typing.SupportsIndex
) -> tuple: ...
def element_names() -> list: ...
def eliminate_inside(
    factor: typing.SupportsInt | typing.SupportsIndex,
    inside: numpy.typing.NDArray[numpy.float64],
    border: numpy.typing.NDArray[numpy.float64],
) -> None: ...
def ended_at_zero(factor: typing.SupportsInt | typing.SupportsIndex) -> bool: ...
def energy_products(
    handle: typing.SupportsInt | typing.SupportsIndex,
    x: numpy.typing.NDArray[numpy.float64],
    b: numpy.typing.NDArray[numpy.float64],
    steps: numpy.typing.NDArray[numpy.float64],
    gram: numpy.typing.NDArray[numpy.float64],
    right: numpy.typing.NDArray[numpy.float64],
) -> bool: ...
def estimate_points(nodes: typing.SupportsInt | typing.SupportsIndex) -> numpy.typing.NDArray[numpy.float64]: ...
def extrude_nodes(
    plane: numpy.typing.NDArray[numpy.float64],
    thickness: numpy.typing.NDArray[numpy.float64],
    levels: typing.SupportsInt | typing.SupportsIndex,
    datum: typing.SupportsFloat | typing.SupportsIndex,
    X: numpy.typing.NDArray[numpy.float64],
) -> None: ...
def factor_shared_rows(
    factor: typing.SupportsInt | typing.SupportsIndex,
    handle: typing.SupportsInt | typing.SupportsIndex,
    number: numpy.typing.NDArray[numpy.int32],
) -> None: ...
def farthest_apart(
    before: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    after: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
) -> float: ...
def finite_rows(handle: typing.SupportsInt | typing.SupportsIndex) -> bool: ...
def flop_rate(
    steps: typing.SupportsInt | typing.SupportsIndex = 20000, runs: typing.SupportsInt | typing.SupportsIndex = 20
) -> float: ...
def follow_sides(
    corners: numpy.typing.NDArray[numpy.float64],
    corner_number: numpy.typing.NDArray[numpy.int32],
    ends: numpy.typing.NDArray[numpy.int32],
    side_number: numpy.typing.NDArray[numpy.int32],
    curved: numpy.typing.NDArray[numpy.int32],
    reference: numpy.typing.NDArray[numpy.float64],
    basis: numpy.typing.NDArray[numpy.float64],
    c0: typing.SupportsFloat | typing.SupportsIndex,
    c1: typing.SupportsFloat | typing.SupportsIndex,
    offset: numpy.typing.NDArray[numpy.float64],
    X: numpy.typing.NDArray[numpy.float64],
    cells: numpy.typing.NDArray[numpy.int32],
    curved_cells: numpy.typing.NDArray[numpy.int32],
    floor: typing.SupportsFloat | typing.SupportsIndex,
) -> int: ...
def forget_cycle(pc: typing.SupportsInt | typing.SupportsIndex) -> None: ...
def forget_failure(pc: typing.SupportsInt | typing.SupportsIndex) -> None: ...
def forget_products(pc: typing.SupportsInt | typing.SupportsIndex) -> None: ...
def give_back_memory() -> bool: ...
def gmls(
    hand: numpy.typing.NDArray[numpy.float64],
    last: numpy.typing.NDArray[numpy.float64],
    places: numpy.typing.NDArray[numpy.float64],
    size: typing.SupportsFloat | typing.SupportsIndex,
    epsilon2: typing.SupportsFloat | typing.SupportsIndex,
    rows: numpy.typing.NDArray[numpy.float64],
    out: numpy.typing.NDArray[numpy.float64],
) -> numpy.typing.NDArray[numpy.float64]: ...
def grade_sizes(
    points: numpy.typing.NDArray[numpy.float64],
    size: numpy.typing.NDArray[numpy.float64],
    growth: typing.SupportsFloat | typing.SupportsIndex,
    coarsest: typing.SupportsFloat | typing.SupportsIndex,
) -> None: ...
def guess_step(
    forces: numpy.typing.NDArray[numpy.float64],
    gram: numpy.typing.NDArray[numpy.float64],
    ridge: typing.SupportsFloat | typing.SupportsIndex,
    steps: numpy.typing.NDArray[numpy.float64],
    products: numpy.typing.NDArray[numpy.float64],
    guess: numpy.typing.NDArray[numpy.float64],
) -> None: ...
def hilbert_keys(
    points: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
) -> numpy.typing.NDArray[numpy.int64]: ...
def interpolate_rows(
    nodes: numpy.typing.NDArray[numpy.int32],
    weights: numpy.typing.NDArray[numpy.float64],
    rows: numpy.typing.NDArray[numpy.float64],
    out: numpy.typing.NDArray[numpy.float64],
) -> None: ...
def inverted_cells(
    X: numpy.typing.NDArray[numpy.float64],
    u: numpy.typing.NDArray[numpy.float64],
    cells: numpy.typing.NDArray[numpy.int32],
) -> numpy.typing.NDArray[numpy.int32]: ...
def keep_border(
    factor: typing.SupportsInt | typing.SupportsIndex,
    unknowns: typing.SupportsInt | typing.SupportsIndex,
    fields: typing.SupportsInt | typing.SupportsIndex,
) -> None: ...
def keep_step(
    now: numpy.typing.NDArray[numpy.float64],
    before: numpy.typing.NDArray[numpy.float64],
    products: numpy.typing.NDArray[numpy.float64],
    place: typing.SupportsInt | typing.SupportsIndex,
    steps: numpy.typing.NDArray[numpy.float64],
    forces: numpy.typing.NDArray[numpy.float64],
    gram: numpy.typing.NDArray[numpy.float64],
) -> None: ...
def lacking_forces(
    old_X: numpy.typing.NDArray[numpy.float64],
    old_cells: numpy.typing.NDArray[numpy.int32],
    u: numpy.typing.NDArray[numpy.float64],
    X: numpy.typing.NDArray[numpy.float64],
    cells: numpy.typing.NDArray[numpy.int32],
    start: numpy.typing.NDArray[numpy.float64],
    at: numpy.typing.NDArray[numpy.float64],
    weights: numpy.typing.NDArray[numpy.float64],
    found: numpy.typing.NDArray[numpy.int32],
    values: numpy.typing.NDArray[numpy.float64],
    moduli: numpy.typing.NDArray[numpy.float64],
    means: numpy.typing.NDArray[numpy.float64],
) -> numpy.typing.NDArray[numpy.float64]: ...
def largest_norm(a: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> float: ...
def largest_size(a: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> float: ...
def least_slide(
    x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    nodes: typing.Annotated[numpy.typing.ArrayLike, numpy.int64],
    start: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    normals: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
) -> float: ...
def locate(
    X: numpy.typing.NDArray[numpy.float64],
    cells: numpy.typing.NDArray[numpy.int32],
    points: numpy.typing.NDArray[numpy.float64],
    close: bool = False,
) -> tuple: ...
def locate_quadratic(
    X: numpy.typing.NDArray[numpy.float64],
    corners: numpy.typing.NDArray[numpy.int32],
    cells: numpy.typing.NDArray[numpy.int32],
    points: numpy.typing.NDArray[numpy.float64],
    close: bool = False,
) -> tuple: ...
def longest_sides(
    x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    cells: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
) -> numpy.typing.NDArray[numpy.float64]: ...
def matrices() -> list: ...
def matrix_products(
    handle: typing.SupportsInt | typing.SupportsIndex,
    rows: numpy.typing.NDArray[numpy.float64],
    out: numpy.typing.NDArray[numpy.float64],
) -> bool: ...
def mean_at(
    X: numpy.typing.NDArray[numpy.float64],
    places: numpy.typing.NDArray[numpy.int32],
    of: str,
    at: numpy.typing.NDArray[numpy.int32],
    values: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
) -> float: ...
def mean_value(
    points: numpy.typing.NDArray[numpy.float64],
    vertices: numpy.typing.NDArray[numpy.float64],
    segments: numpy.typing.NDArray[numpy.int32],
    values: numpy.typing.NDArray[numpy.float64],
) -> numpy.typing.NDArray[numpy.float64]: ...
def mesher_items() -> int: ...
def met_by_inside(
    handle: typing.SupportsInt | typing.SupportsIndex, place: numpy.typing.NDArray[numpy.int32]
) -> numpy.typing.NDArray[numpy.int32]: ...
def momenta(
    old_cells: numpy.typing.NDArray[numpy.int32],
    v: numpy.typing.NDArray[numpy.float64],
    X: numpy.typing.NDArray[numpy.float64],
    cells: numpy.typing.NDArray[numpy.int32],
    at: numpy.typing.NDArray[numpy.float64],
    weights: numpy.typing.NDArray[numpy.float64],
    found: numpy.typing.NDArray[numpy.int32],
    values: numpy.typing.NDArray[numpy.float64],
    density: numpy.typing.NDArray[numpy.float64],
) -> numpy.typing.NDArray[numpy.float64]: ...
def move_and_check(
    X_reference: numpy.typing.NDArray[numpy.float64],
    Psi: numpy.typing.NDArray[numpy.float64],
    c0: typing.SupportsFloat | typing.SupportsIndex,
    c1: typing.SupportsFloat | typing.SupportsIndex,
    X: numpy.typing.NDArray[numpy.float64],
    cells: numpy.typing.NDArray[numpy.int32],
    area_floor: typing.SupportsFloat | typing.SupportsIndex,
    quality_floor: typing.SupportsFloat | typing.SupportsIndex,
) -> tuple: ...
def moved_cells(
    x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    cells: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
    slack: typing.SupportsFloat | typing.SupportsIndex,
    before: numpy.typing.NDArray[numpy.float64],
) -> numpy.typing.NDArray[numpy.int64]: ...
def moved_points(
    reference: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    basis: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    along: typing.SupportsFloat | typing.SupportsIndex,
    across: typing.SupportsFloat | typing.SupportsIndex,
) -> numpy.typing.NDArray[numpy.float64]: ...
def multiply_in_registers(mat: typing.SupportsInt | typing.SupportsIndex) -> None: ...
def narrow_widths(
    points: numpy.typing.NDArray[numpy.float64],
    arc: numpy.typing.NDArray[numpy.float64],
    first: numpy.typing.NDArray[numpy.int32],
    ends: numpy.typing.NDArray[numpy.int32],
    straight: numpy.typing.NDArray[numpy.uint8],
    side: numpy.typing.NDArray[numpy.float64],
    reach: typing.SupportsFloat | typing.SupportsIndex,
    fold: typing.SupportsFloat | typing.SupportsIndex,
) -> numpy.typing.NDArray[numpy.float64]: ...
def nested_vectors(
    coarse: numpy.typing.NDArray[numpy.float64],
    cells: numpy.typing.NDArray[numpy.int32],
    next: numpy.typing.NDArray[numpy.int32],
    sign: numpy.typing.NDArray[numpy.float64],
    starts: numpy.typing.NDArray[numpy.int32],
    columns: numpy.typing.NDArray[numpy.int32],
    weights: numpy.typing.NDArray[numpy.float64],
    placed: numpy.typing.NDArray[numpy.uint8],
    vectors: numpy.typing.NDArray[numpy.float64],
    back: bool,
    out: numpy.typing.NDArray[numpy.float64],
) -> None: ...
def node_order(X: typing.Annotated[numpy.typing.ArrayLike, numpy.float64]) -> numpy.typing.NDArray[numpy.int32]: ...
def nonzero_rows(
    values: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
) -> numpy.typing.NDArray[numpy.int64]: ...
def packed(arrays: list, size: typing.SupportsInt | typing.SupportsIndex) -> bytes: ...
def panel_value_bytes(handle: typing.SupportsInt | typing.SupportsIndex) -> int: ...
def place_weights(
    X: numpy.typing.NDArray[numpy.float64], places: numpy.typing.NDArray[numpy.int32], of: str
) -> numpy.typing.NDArray[numpy.float64]: ...
def positive_mean_value(
    points: numpy.typing.NDArray[numpy.float64],
    vertices: numpy.typing.NDArray[numpy.float64],
    segments: numpy.typing.NDArray[numpy.int32],
    values: numpy.typing.NDArray[numpy.float64],
) -> numpy.typing.NDArray[numpy.float64]: ...
def pull_back(
    X: numpy.typing.NDArray[numpy.float64],
    x: numpy.typing.NDArray[numpy.float64],
    cells: numpy.typing.NDArray[numpy.int32],
    points: numpy.typing.NDArray[numpy.float64],
    stress: numpy.typing.NDArray[numpy.float64],
) -> None: ...
def quadratic_stress(
    X: numpy.typing.NDArray[numpy.float64],
    x: numpy.typing.NDArray[numpy.float64],
    cells: numpy.typing.NDArray[numpy.int32],
    params: numpy.typing.NDArray[numpy.float64],
    points: numpy.typing.NDArray[numpy.float64],
) -> numpy.typing.NDArray[numpy.float64]: ...
def rates_after(
    y: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    before: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    v: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    of_change: typing.SupportsFloat | typing.SupportsIndex,
    of_rate: typing.SupportsFloat | typing.SupportsIndex,
) -> numpy.typing.NDArray[numpy.float64]: ...
def recover_quadratic(
    X: numpy.typing.NDArray[numpy.float64],
    cells: numpy.typing.NDArray[numpy.int32],
    stress: numpy.typing.NDArray[numpy.float64],
    out: numpy.typing.NDArray[numpy.float64],
) -> None: ...
def recover_space(
    X: numpy.typing.NDArray[numpy.float64],
    cells: numpy.typing.NDArray[numpy.int32],
    stress: numpy.typing.NDArray[numpy.float64],
    out: numpy.typing.NDArray[numpy.float64],
) -> None: ...
def recovery_energies(
    X: numpy.typing.NDArray[numpy.float64],
    cells: numpy.typing.NDArray[numpy.int32],
    rows: numpy.typing.NDArray[numpy.int32],
    nodal: numpy.typing.NDArray[numpy.float64],
    samples: numpy.typing.NDArray[numpy.float64],
    compliance: numpy.typing.NDArray[numpy.float64],
    kinds: numpy.typing.NDArray[numpy.int32],
) -> tuple[float, float]: ...
def recovery_points() -> numpy.typing.NDArray[numpy.float64]: ...
def refine_delaunay(
    points: numpy.typing.NDArray[numpy.float64],
    segments: numpy.typing.NDArray[numpy.int32],
    border: numpy.typing.NDArray[numpy.uint8],
    size: typing.SupportsFloat | typing.SupportsIndex,
    growth: typing.SupportsFloat | typing.SupportsIndex,
    sources: numpy.typing.NDArray[numpy.float64],
    stretch: typing.SupportsFloat | typing.SupportsIndex,
    sine_bound: typing.SupportsFloat | typing.SupportsIndex,
    patience: typing.SupportsInt | typing.SupportsIndex,
) -> tuple: ...
def register_node_cholesky() -> None: ...
def register_node_lu() -> None: ...
def register_node_relaxation() -> None: ...
def relax_and_check(
    X_reference: numpy.typing.NDArray[numpy.float64],
    Psi: numpy.typing.NDArray[numpy.float64],
    c0: typing.SupportsFloat | typing.SupportsIndex,
    c1: typing.SupportsFloat | typing.SupportsIndex,
    X: numpy.typing.NDArray[numpy.float64],
    cells: numpy.typing.NDArray[numpy.int32],
    edge_nodes: numpy.typing.NDArray[numpy.int32],
    fixed: numpy.typing.NDArray[numpy.uint8],
    sweeps: typing.SupportsInt | typing.SupportsIndex,
    area_floor: typing.SupportsFloat | typing.SupportsIndex,
    quality_floor: typing.SupportsFloat | typing.SupportsIndex,
) -> tuple: ...
def remove_tractions(
    normals: numpy.typing.NDArray[numpy.float64],
    constrained: numpy.typing.NDArray[numpy.uint8],
    nodal: numpy.typing.NDArray[numpy.float64],
) -> None: ...
def reset_calls() -> None: ...
def residual_norm(
    mat: typing.SupportsInt | typing.SupportsIndex,
    b: typing.SupportsInt | typing.SupportsIndex,
    x: typing.SupportsInt | typing.SupportsIndex,
) -> float: ...
def ridge_weights(
    gram: numpy.typing.NDArray[numpy.float64],
    products: numpy.typing.NDArray[numpy.float64],
    ridge: typing.SupportsFloat | typing.SupportsIndex,
    out: numpy.typing.NDArray[numpy.float64],
) -> None: ...
def row_products(
    a: numpy.typing.NDArray[numpy.float64],
    b: numpy.typing.NDArray[numpy.float64],
    out: numpy.typing.NDArray[numpy.float64],
) -> None: ...
def same_bits(
    a: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    b: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
) -> bool: ...
def same_values(
    a: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    b: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
) -> bool: ...
def schur_complement(
    factor: typing.SupportsInt | typing.SupportsIndex, out: numpy.typing.NDArray[numpy.float64]
) -> None: ...
def sent_fields(
    points: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    displacement: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    values: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
) -> tuple: ...
def sent_outline(
    controls: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    ends: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
    shares: typing.Annotated[numpy.typing.ArrayLike, numpy.complex128],
    vertices: typing.SupportsInt | typing.SupportsIndex,
) -> tuple: ...
def set_schur_rows(
    factor: typing.SupportsInt | typing.SupportsIndex, rows: numpy.typing.NDArray[numpy.int32]
) -> None: ...
def set_stage(stage: str) -> None: ...
def sides_gone(
    X: numpy.typing.NDArray[numpy.float64],
    Y: numpy.typing.NDArray[numpy.float64],
    cells: numpy.typing.NDArray[numpy.int32],
) -> float: ...
def smooth_fresh(
    X: numpy.typing.NDArray[numpy.float64],
    cells: numpy.typing.NDArray[numpy.int32],
    fixed: typing.SupportsInt | typing.SupportsIndex,
    sweeps: typing.SupportsInt | typing.SupportsIndex,
) -> float: ...
def solve_by_panels(handle: typing.SupportsInt | typing.SupportsIndex, single: bool = False) -> bool: ...
def space_recovery_points() -> numpy.typing.NDArray[numpy.float64]: ...
def split_prisms(
    plane_cells: numpy.typing.NDArray[numpy.int32],
    places: numpy.typing.NDArray[numpy.int32],
    layers: typing.SupportsInt | typing.SupportsIndex,
    cells: numpy.typing.NDArray[numpy.int32],
    changed: typing.Annotated[numpy.typing.ArrayLike, numpy.int32] | None = None,
) -> None: ...
def stop_watching() -> None: ...
def take_entries(
    handle: typing.SupportsInt | typing.SupportsIndex,
    entries: numpy.typing.NDArray[numpy.int32],
    out: numpy.typing.NDArray[numpy.float64],
) -> None: ...
def take_increment(
    now: numpy.typing.NDArray[numpy.float64],
    last: numpy.typing.NDArray[numpy.float64],
    step: numpy.typing.NDArray[numpy.float64],
) -> bool: ...
def thickness_stretch(
    X: numpy.typing.NDArray[numpy.float64],
    u: numpy.typing.NDArray[numpy.float64],
    cells: numpy.typing.NDArray[numpy.int32],
    ratio: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    points: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
) -> numpy.typing.NDArray[numpy.float64]: ...
def total_area(X: numpy.typing.NDArray[numpy.float64], cells: numpy.typing.NDArray[numpy.int32]) -> float: ...
def triad_seconds(
    a: numpy.typing.NDArray[numpy.float64],
    b: numpy.typing.NDArray[numpy.float64],
    c: numpy.typing.NDArray[numpy.float64],
    passes: typing.SupportsInt | typing.SupportsIndex,
    runs: typing.SupportsInt | typing.SupportsIndex,
) -> float: ...
def triangle_energies(
    X: numpy.typing.NDArray[numpy.float64],
    x: numpy.typing.NDArray[numpy.float64],
    cells: numpy.typing.NDArray[numpy.int32],
    params: numpy.typing.NDArray[numpy.float64],
) -> numpy.typing.NDArray[numpy.float64]: ...
def triangle_stress(
    X: numpy.typing.NDArray[numpy.float64],
    x: numpy.typing.NDArray[numpy.float64],
    cells: numpy.typing.NDArray[numpy.int32],
    params: numpy.typing.NDArray[numpy.float64],
    plane_stress: bool,
) -> tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]]: ...
def update_friction(
    x: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    pushed: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    coefficient: typing.SupportsFloat | typing.SupportsIndex,
    slip: typing.SupportsFloat | typing.SupportsIndex,
    anchor: numpy.typing.NDArray[numpy.float64],
    normal: numpy.typing.NDArray[numpy.float64],
    limit: numpy.typing.NDArray[numpy.float64],
) -> float: ...
def von_mises(stress: numpy.typing.NDArray[numpy.float64]) -> numpy.typing.NDArray[numpy.float64]: ...
def watch(
    seconds: typing.SupportsFloat | typing.SupportsIndex,
    bytes: typing.SupportsInt | typing.SupportsIndex,
    code: typing.SupportsInt | typing.SupportsIndex,
    slow: str,
    large: str,
    waits: typing.SupportsFloat | typing.SupportsIndex = 10.0,
) -> None: ...
def watch_outlet(
    control: typing.SupportsInt | typing.SupportsIndex, process: typing.SupportsInt | typing.SupportsIndex
) -> None: ...
def weigh_state(
    y: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    v: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    a: typing.Annotated[numpy.typing.ArrayLike, numpy.float64] | None,
    weights: collections.abc.Sequence[typing.SupportsFloat | typing.SupportsIndex],
    base: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    stiff: numpy.typing.NDArray[numpy.float64],
    inert: numpy.typing.NDArray[numpy.float64],
) -> None: ...
def weighted_sum(weights: list, rows: list, out: numpy.typing.NDArray[numpy.float64]) -> None: ...
def with_points(
    values: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
    nodes: typing.Annotated[numpy.typing.ArrayLike, numpy.int32],
    weights: typing.Annotated[numpy.typing.ArrayLike, numpy.float64],
) -> numpy.typing.NDArray[numpy.float64]: ...

has_cgal: bool = True
node_blocks: str = "node_blocks"
node_lu: str = "node_lu"
node_lu_single: str = "node_lu_single"
node_ssor: str = "node_ssor"
