# What restshape needs from Debian 12 or Ubuntu 24.04, and how it gets there; read by setup.sh.

distribution_packages=(
    # solvers, and MPI with its compiler wrappers
    petsc-dev slepc-dev python3-petsc4py python3-slepc4py python3-mpi4py python3-numpy openmpi-bin libopenmpi-dev
    # building the extension
    python3-venv python3-dev g++ make libeigen3-dev libcgal-dev ca-certificates
    # shared libraries that the gmsh and vtk wheels load
    libglu1-mesa libgl1 libegl1 libgl1-mesa-dri libgomp1
    libx11-6 libxext6 libxrender1 libxcursor1 libxft2 libxinerama1 libxfixes3 libfontconfig1
)

missing_packages() {
    local name
    for name in "${distribution_packages[@]}"; do
        case "$(dpkg-query --show --showformat='${db:Status-Abbrev}' "$name" 2>/dev/null)" in
        ?i*) ;;
        *) echo "$name" ;;
        esac
    done
}

check_distribution() {
    local ID="" VERSION_ID="" PRETTY_NAME="an unknown system"
    if [ -r /etc/os-release ]; then . /etc/os-release; fi
    case "$ID:${VERSION_ID%%.*}" in
    debian:1[2-9] | ubuntu:2[4-9]) ;;
    debian:) ;; # testing and unstable carry no number
    *)
        fail "$PRETTY_NAME is not a distribution that this script knows (Debian 12, Ubuntu 24.04, or newer)" \
            "install PETSc, SLEPc and their Python packages yourself and set PETSC_DIR: docs/install.md, 'A PETSc of your own'"
        ;;
    esac
}

# The command in front of apt-get: nothing for root, sudo where it works.
become_root() { # packages...
    if [ "$(id -u)" = 0 ]; then
        as_root=(env)
    elif command -v sudo >/dev/null && { [ -t 0 ] || sudo -n true 2>/dev/null; }; then
        as_root=(sudo env)
    else
        fail "these packages are missing and you are neither root nor allowed to use sudo: $*" \
            "ask for: apt-get install --no-install-recommends $*
       or use a PETSc of your own: docs/install.md"
    fi
}

install_distribution_packages() {
    check_distribution
    local missing
    mapfile -t missing < <(missing_packages)
    if [ ${#missing[@]} = 0 ]; then return; fi
    become_root "${missing[@]}"
    echo "setup: from the distribution: ${missing[*]}"
    local apt=("${as_root[@]}" DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=300 -o Acquire::Retries=2)
    "${apt[@]}" update || fail "apt-get update failed" "check the network and /etc/apt/sources.list"
    "${apt[@]}" install --yes --no-install-recommends "${missing[@]}" >/dev/null ||
        fail "apt-get could not install: ${missing[*]}" \
            "check the network; on Ubuntu the section universe must be on (sudo add-apt-repository universe)"
}
