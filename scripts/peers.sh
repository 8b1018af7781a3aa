#!/usr/bin/env bash
# Puts other solvers aside, each in an environment of its own, for `restshape bench peers --installed FOLDER`.
# Usage: scripts/peers.sh FOLDER [dolfinx] [scikit-fem] [ngsolve] [freefem] [newton]      (default: all five)
#
# Packages of the distribution are unpacked below FOLDER, not installed; those of PyPI get virtual environments there.
# Each peer has FOLDER/NAME/python, the Python that runs its programs. Nothing outside FOLDER is changed.
set -euo pipefail

fail() { # what, what to do
    printf 'peers: %s\n  try: %s\n' "$1" "$2" >&2
    exit 1
}

unpack() { # name, packages...
    local place="$folder/$1" deb
    shift
    rm -rf "$place"
    mkdir -p "$place/archives/partial" "$place/root"
    apt-get -qq install --no-install-recommends --download-only --yes \
        -o Dir::Cache::archives="$place/archives" -o Debug::NoLocking=1 "$@" >/dev/null ||
        fail "the distribution does not give $*" "apt-get update; Debian 12 has it"
    for deb in "$place"/archives/*.deb; do dpkg -x "$deb" "$place/root"; done
    rm -rf "$place/archives"
}

from_pypi() { # name, packages...
    local place="$folder/$1"
    shift
    rm -rf "$place"
    "${PYTHON:-python3}" -m venv "$place" || fail "no virtual environment in $place" "install python3-venv"
    "$place/bin/python" -m pip install --quiet --disable-pip-version-check "$@" ||
        fail "pip could not install $*" "read pip's message above"
    write_python "$place" "exec '$place/bin/python' \"\$@\""
}

write_python() { # place, lines...
    local place="$1"
    shift
    printf '%s\n' '#!/usr/bin/env bash' "$@" >"$place/python"
    chmod +x "$place/python"
}

install_dolfinx() {
    unpack dolfinx python3-dolfinx-real
    local root="$folder/dolfinx/root" packages
    packages=$(dirname "$(find "$root" -type d -name dolfinx -path '*real*dist-packages*' | head -n 1)")
    write_python "$folder/dolfinx" \
        "export PYTHONPATH='$root/usr/lib/python3/dist-packages:$packages'" \
        "export LD_LIBRARY_PATH='$root/usr/lib/$(dpkg-architecture -qDEB_HOST_MULTIARCH)'" \
        "export XDG_CACHE_HOME=\"\${RESTSHAPE_PEER_CACHE:-$folder/dolfinx/cache}\"" \
        'exec /usr/bin/python3 "$@"'
}

install_scikit-fem() { from_pypi scikit-fem scikit-fem; }

install_ngsolve() { from_pypi ngsolve ngsolve scipy; }

install_freefem() {
    unpack freefem freefem++
    local root="$folder/freefem/root"
    write_python "$folder/freefem" \
        "export PATH='$root/usr/bin':\"\$PATH\"" \
        "export LD_LIBRARY_PATH='$root/usr/lib/$(dpkg-architecture -qDEB_HOST_MULTIARCH)'" \
        'exec /usr/bin/python3 "$@"'
}

install_newton() { from_pypi newton newton; }

known=(dolfinx scikit-fem ngsolve freefem newton)
[ $# -ge 1 ] || fail "no folder is given" "scripts/peers.sh FOLDER [${known[*]}]"
mkdir -p "$1"
folder=$(cd "$1" && pwd)
shift
for name in "${@:-${known[@]}}"; do
    case " ${known[*]} " in
    *" $name "*) ;;
    *) fail "there is no peer $name" "one of ${known[*]}" ;;
    esac
done
for name in "${@:-${known[@]}}"; do
    echo "peers: $name"
    "install_$name"
done
