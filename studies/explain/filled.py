"""Which kernels fill each matrix: reported by watching the operators that element loops fill."""

from collections import Counter
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from weakref import WeakKeyDictionary

from restshape import _kernels
from restshape.algebra.operator import Operator

FILLING = ("assemble", "keep")
"""Methods of operators that take terms to fill matrices with."""
Filled = dict[str, int]
"""Matrix entries by the names of the kernels that fill them, with spaces between; under "" those not filled yet."""


@contextmanager
def watched_operators() -> Iterator["Watch"]:
    """Note, while this lasts, which kernels each operator is filled by."""
    watch, originals = Watch(), {name: getattr(Operator, name) for name in FILLING}

    def noting(fill: Callable) -> Callable:
        def noted(operator: Operator, terms: list[tuple], *rest: object, **options: object) -> object:
            watch.kernels.setdefault(operator, set()).update(term[1].name for term in terms)
            return fill(operator, terms, *rest, **options)

        return noted

    for name, fill in originals.items():
        setattr(Operator, name, noting(fill))
    try:
        yield watch
    finally:
        for name, fill in originals.items():
            setattr(Operator, name, fill)


class Watch:
    """The operators that have been filled and exist, each with the names of its kernels."""

    def __init__(self) -> None:
        self.kernels: WeakKeyDictionary[Operator, set[str]] = WeakKeyDictionary()

    def entries(self) -> Counter:
        """Entries of all matrices that there are now, by kernels as in `Filled`."""
        found: Counter = Counter()
        for operator, names in self.kernels.items():
            found[" ".join(sorted(names))] += operator.core.nnz
        found[""] = stored()[1] - found.total()
        return found


def stored() -> tuple[int, int]:
    """How many matrices of element operators there are now, and their entries."""
    matrices = _kernels.matrices()
    return len(matrices), sum(entries for _, entries in matrices)


def of_kernels(filled: Filled, starts: tuple[str, ...]) -> int:
    """The entries of matrices that no other kernels fill than those whose names begin so."""
    return sum(
        entries
        for names, entries in filled.items()
        if starts and names and all(name.startswith(starts) for name in names.split())
    )
