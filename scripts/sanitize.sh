#!/bin/sh
# Builds the kernels with address and undefined-behaviour sanitizers into a folder of their own, and fuzzes them there.
#
#   scripts/sanitize.sh [FOLDER [EXAMPLES [SEED [OPTION...]]]]      default: build/sanitized 2000 0
#
# Further options are those of `restshape stability --fuzz`, such as `--seconds 900` or `--kind files`.
# The tree itself and its build stay as they are. Leaks are not looked for: Python and MPI keep memory until they end.
# The exit code is that of `restshape stability --fuzz`; reports of the sanitizers are in FOLDER/reports.
set -eu
root=$(cd "$(dirname "$0")/.." && pwd)
folder=$(mkdir -p "${1:-$root/build/sanitized}" && cd "${1:-$root/build/sanitized}" && pwd)
examples=${2:-2000}
seed=${3:-0}
[ $# -le 3 ] && set -- || shift 3
python=$root/.venv/bin/python

mkdir -p "$folder/tree" "$folder/reports"
(cd "$root" && git ls-files -z lib apps studies verification meshes setup.py pyproject.toml setup.cfg README.md) |
    (cd "$root" && tar --null -T - -cf -) | (cd "$folder/tree" && tar -xf -)
cd "$folder/tree"
# Portable: vector instructions of the machine hide what is read beyond an array.
RESTSHAPE_PORTABLE=1 RESTSHAPE_SANITIZE=1 "$python" setup.py -q build_ext --inplace

# The runtime must come before Python's own libraries; what other libraries do is theirs.
compiler=${CXX:-g++}
LD_PRELOAD="$("$compiler" -print-file-name=libasan.so) $("$compiler" -print-file-name=libubsan.so)"
ASAN_OPTIONS="detect_leaks=0:allocator_may_return_null=1:handle_segv=0:log_path=$folder/reports/address"
UBSAN_OPTIONS="print_stacktrace=1:log_path=$folder/reports/undefined"
PYTHONPATH="$folder/paths"
export LD_PRELOAD ASAN_OPTIONS UBSAN_OPTIONS PYTHONPATH

# The packages of this copy come before the installed ones.
mkdir -p "$folder/paths"
for pair in lib/restshape:restshape apps:restshape_apps studies:restshape_studies verification:restshape_verification; do
    ln -sfn "$folder/tree/${pair%%:*}" "$folder/paths/${pair##*:}"
done

status=0
"$python" -m restshape.cli.main stability --fuzz "$examples" --seed "$seed" --keep "$folder/kept" \
    --json "$folder/fuzz.json" "$@" || status=$?
# A request for more memory than there is is refused with a warning, and ends in a message: it is no report.
found=$(grep -rlE "ERROR: |runtime error:" "$folder/reports" | wc -l)
echo "$found reports of the sanitizers in $folder/reports"
[ "$found" -eq 0 ] || status=1
exit "$status"
