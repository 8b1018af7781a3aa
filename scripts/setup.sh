#!/usr/bin/env bash
# Makes .venv: what is missing from the distribution, Python packages, extension modules; and the page of live sessions.
# Usage: scripts/setup.sh [test|develop]      (what the second run finds unchanged it leaves alone)
#
# Environment:
#   PETSC_DIR, PETSC_ARCH   use that PETSc and the petsc4py that `python3` imports; nothing comes from apt
#   PYTHON                  with PETSC_DIR: the Python that imports petsc4py (default: python3)
#   RESTSHAPE_PORTABLE=1    an extension that runs on any CPU of the architecture
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
case "${1:-test}" in
test) extras=(test) ;;
develop) extras=(test develop) ;;
*)
    echo "usage: scripts/setup.sh [test|develop]" >&2
    exit 2
    ;;
esac
venv=.venv
. scripts/distribution.sh

fail() { # what, what to do
    printf 'setup: %s\n  try: %s\n' "$1" "$2" >&2
    exit 1
}

# Everything that the installed packages and the extension depend on, as one line.
state_of() { # files...
    {
        printf '%s\n' "$PWD" "${PETSC_DIR:-}" "${PETSC_ARCH:-}" "$python" "${EIGEN3_INCLUDE_DIR:-}"
        "$python" --version
        # -march=native means another extension on another CPU.
        if [ "${RESTSHAPE_PORTABLE:-0}" = 0 ]; then grep -m1 '^flags' /proc/cpuinfo || true; else echo portable; fi
        cat -- "$@"
    } | sha256sum | cut -d' ' -f1
}

choose_python() {
    if [ -n "${PETSC_DIR:-}" ]; then python=${PYTHON:-python3}; else python=/usr/bin/python3; fi
}

check_tools() {
    if [ -n "${PETSC_DIR:-}" ] && [ ! -d "$PETSC_DIR" ]; then
        fail "PETSC_DIR is $PETSC_DIR, and there is no such folder" "set it to your PETSc, or unset it for the distribution's"
    fi
    command -v "$python" >/dev/null || fail "$python not found" "install Python 3.11 or newer, or set PYTHON"
    "$python" -c 'import sys; sys.exit(sys.version_info < (3, 11))' ||
        fail "$python is older than 3.11" "docs/install.md lists what restshape runs on"
    local compiler
    for compiler in "${CXX:-g++}" "${MPICXX:-mpicxx}"; do
        command -v "$compiler" >/dev/null ||
            fail "no C++ compiler: $compiler not found" "install it, or name yours with CXX=... MPICXX=..."
    done
    local problem
    problem=$("$python" -c 'import petsc4py, slepc4py' 2>&1) ||
        fail "$python cannot import petsc4py and slepc4py: ${problem##*$'\n'}" \
            "add the folder that holds them to PYTHONPATH (docs/install.md, 'A PETSc of your own')"
}

make_venv() {
    echo "setup: virtual environment $venv"
    local version='import sys; print(sys.version_info[:2], sys.prefix != sys.base_prefix)'
    if ! cmp -s <("$venv/bin/python" -c "$version" 2>/dev/null) <("$python" -c "$version" | sed 's/False/True/'); then
        rm -rf "$venv"
        "$python" -m venv --system-site-packages "$venv" ||
            fail "$python cannot make a virtual environment" "install its venv module (python3-venv)"
    fi
    # petsc4py is compiled against the numpy beside it: pip must never bring another.
    "$python" -c 'import numpy; print(f"numpy=={numpy.__version__}")' >"$venv/constraints.txt"
}

pip_install() {
    "$venv/bin/python" -m pip install --quiet --compile --disable-pip-version-check --retries 2 \
        --constraint "$venv/constraints.txt" "$@" ||
        fail "pip could not install: $*" \
            "read pip's message above. Is there a network? Without one put the wheels into a folder and set PIP_FIND_LINKS
       to it and PIP_NO_INDEX=1"
}

# What setup.cfg asks for, one a line.
requirements() {
    "$python" - "${extras[@]}" <<'PYTHON'
import configparser
import sys

config = configparser.ConfigParser()
config.read("setup.cfg")
texts = [config["options"]["install_requires"], *(config["options.extras_require"][name] for name in sys.argv[1:])]
print("\n".join(line for text in texts for line in text.split("\n") if line))
PYTHON
}

install_packages() {
    echo "setup: build tools into $venv"
    pip_install 'setuptools>=64,<100' wheel 'pybind11>=2.11,<4'
    echo "setup: what pip installs for ${extras[*]}"
    local packages
    mapfile -t packages < <(requirements)
    # pip waits for the network, and keeps one core busy: the compiler starts beside it.
    pip_install "${packages[@]}" &
    local installing=$!
    trap "kill $installing 2>/dev/null || true" EXIT
    # First by itself, where the compiler's messages are seen; pip then finds it built.
    build_extension
    wait "$installing" || exit 1
    trap - EXIT
    pip_install --no-build-isolation --editable ".[$(IFS=, && echo "${extras[*]}")]"
}

build_extension() {
    echo "setup: extension modules"
    "$venv/bin/python" setup.py -q build_ext --inplace ||
        fail "an extension module does not build" "read the message above; docs/install.md names what the build needs"
}

# The page of `restshape live`, which nothing else needs.
build_page() {
    scripts/page.sh || echo "setup: the page of restshape live is not there; all else is" >&2
}

# Where Python may not write bytecode (PYTHONDONTWRITEBYTECODE, a folder that is not the user's) each command would
# compile all that it imports anew: about 0.3 s of a replay, 1 s of a report.
compile_modules() {
    "$venv/bin/python" -m compileall -q lib apps studies verification || true
}

verify() {
    local problem
    problem=$("$venv/bin/python" - 2>&1 <<'PYTHON'
import sys
import numpy
from pathlib import Path

wanted = Path(".venv/constraints.txt").read_text().strip().split("==")[1]
if numpy.__version__ != wanted:
    sys.exit(f"numpy {numpy.__version__} of {numpy.__path__[0]} hides the {wanted} that petsc4py needs")
import petsc4py.PETSc, slepc4py.SLEPc, h5py, gmsh, restshape._kernels
PYTHON
    ) || fail "the new environment does not import: ${problem##*$'\n'}" \
        "if the path is below your home folder set PYTHONNOUSERSITE=1, else see docs/install.md"
}

packages_state() { state_of setup.cfg setup.py pyproject.toml scripts/setup.sh scripts/distribution.sh; }
kernels_state() { state_of setup.py $(find lib/kernels apps/*/kernels -name '*.[ch]pp' | sort); }
unchanged() { # what
    [ "$(cat "$venv/$1.state" 2>/dev/null)" = "$("${1%%-*}_state" 2>/dev/null)" ]
}

choose_python
if ! unchanged "packages-${extras[-1]}"; then
    if [ -z "${PETSC_DIR:-}" ]; then install_distribution_packages "${extras[0]}"; fi
    check_tools
    make_venv
    # Both need nothing of what is installed: they run while pip and npm wait for the network, or one core has no work.
    compile_modules &
    build_page &
    install_packages
    wait
    verify
elif ! unchanged kernels || ! ls lib/restshape/_kernels.*.so >/dev/null 2>&1; then
    build_extension
    build_page
else
    build_page
    exit 0
fi
for extra in "${extras[@]}"; do packages_state >"$venv/packages-$extra.state"; done
kernels_state >"$venv/kernels.state"
echo "setup: done, the command is $venv/bin/restshape"
