"""The words that a user gives to PETSc's options database: which it refused, and which it never looked at."""

import ctypes
import re
from collections.abc import Sequence

from petsc4py import PETSc

from restshape.errors import UserError

_LOGS = ("log", "log_all", "log_mpe", "log_summary", "log_trace", "log_view", "log_view_memory", "log_view_gpu_time")
_MEMORY = ("malloc_dump", "malloc_info", "malloc_view", "malloc_view_threshold", "memory_view")
AT_THE_END = frozenset(
    (*_LOGS, *_MEMORY, "objects_dump", "options_left", "options_view", "citations", "mpidump", "get_total_flops")
)
"""Options that PETSc may look at only when it ends."""

WITHOUT_EFFECT = {
    "ksp_view": "-v names each KSP and PC, -{prefix}ksp_monitor shows its iterations",
    "ksp_rtol": "solve.tolerance of the scene ends each solve",
    "ksp_atol": "solve.tolerance of the scene ends each solve",
    "ksp_max_it": "each solve sets its own limit, after which the preconditioner is rebuilt",
}
"""Endings of options that PETSc knows and restshape's solvers make up for, and what serves instead."""
OF_BLOCKS = ("pc_factor_mat_ordering_type", "pc_factor_shift_type")
"""Endings of options that factors in blocks of a node have no use for, unless another factor is asked for, too."""
OTHER_FACTORS = ("pc_type", "pc_factor_mat_solver_type")
"""Endings of options that ask for another preconditioner."""
_SOLVERS = re.compile("[-_](ksp|pc|snes|mat)_")
_SHOWN = re.compile("_(monitor|view|reason)$")
"""Options of PETSc's solvers, and those among them that only print."""
WITH_EFFECT = "step_"
"""End of the prefix of solvers that take all options: those of the steps of cloth."""


def options_of(words: Sequence[str]) -> tuple[list[tuple[str, str]], list[str]]:
    """Pairs (option with its dash, value or ""), and the words that belong to no option."""
    options: list[tuple[str, str]] = []
    loose: list[str] = []
    open_for_value = False
    for word in words:
        if re.match(r"-{1,2}[A-Za-z]", word):
            options.append((word, ""))
            open_for_value = True
        elif open_for_value:
            options[-1] = (options[-1][0], word)
            open_for_value = False
        else:
            loose.append(word)
    return options, loose


def refusal(error: PETSc.Error, words: Sequence[str]) -> UserError:
    """What PETSc says against the user's words, naming the option where that can be known.

    Args:
        error: raised while solvers were set up or first used.
        words: what came after ``--``.
    """
    lines = [line for line in str(error).splitlines() if "() at " not in line]
    said = re.sub(r"^\[\d+\] ", "", [line for line in lines if line.startswith("[")][-1]).strip()
    options, _ = options_of(words)
    named = [(option, value) for option, value in options if value and re.search(rf"\b{re.escape(value)}\b", said)]
    empty = [pair for pair in options if not pair[1]]
    suspects = named or empty or options
    where = " ".join(word for pair in suspects for word in pair if word)
    return UserError(f"PETSc refuses it: {said}", f"-- {where}", "mend the words after --, or leave them out")


def unused(words: Sequence[str]) -> list[str]:
    """Those of the words that PETSc has not looked at so far, and will not look at when it ends."""
    options, loose = options_of(words)
    return [option for option, _ in options if not _is_used(option)] + loose


def without_effect(words: Sequence[str]) -> list[str]:
    """Those options among the words that PETSc takes and that change nothing here, each with what serves instead."""
    names = [option.lstrip("-") for option, _ in options_of(words)[0]]
    found = [
        f"-{name} ({WITHOUT_EFFECT[ending].format(prefix=name.removesuffix(ending))})"
        for name in names
        for ending in WITHOUT_EFFECT
        if name.endswith(ending) and not name.endswith(f"{WITH_EFFECT}{ending}")
    ]
    for name, ending in ((name, ending) for name in names for ending in OF_BLOCKS if name.endswith(ending)):
        prefix = name.removesuffix(ending)
        if not {prefix + other for other in OTHER_FACTORS} & set(names):
            found.append(f"-{name} (for factors of single numbers: -{prefix}pc_factor_mat_solver_type petsc)")
    return found


def of_solvers(words: Sequence[str]) -> list[str]:
    """Those of the words that choose what PETSc's solvers do, with their values, of options that it has looked at."""
    options = [pair for pair in options_of(words)[0] if _SOLVERS.search(pair[0]) and not _SHOWN.search(pair[0])]
    return [word for pair in options if _is_used(pair[0]) and not without_effect(pair) for word in pair if word]


def _is_used(option: str) -> bool:
    name = option.lstrip("-")
    if name in AT_THE_END:
        return True
    # petsc4py 3.18 has no name for PetscOptionsUsed; its module is linked with the PETSc in use.
    found = ctypes.c_int(0)
    code = ctypes.CDLL(PETSc.__file__).PetscOptionsUsed(None, name.encode(), ctypes.byref(found))
    return code != 0 or bool(found.value)
