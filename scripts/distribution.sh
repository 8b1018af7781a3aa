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

# What `restshape live` needs to build its page and to test it; by command, for Node.js may have come another way.
page_packages() { # extra
    command -v node >/dev/null || echo nodejs
    command -v npm >/dev/null || echo npm
    # Ubuntu's package is a link to another installer, whose browser tests cannot start as they need it.
    if [ "$1" = test ] && [ "$(distribution_name)" = debian ] && ! command -v chromium >/dev/null; then echo chromium; fi
}

missing_packages() {
    local name
    for name in "${distribution_packages[@]}"; do
        case "$(dpkg-query --show --showformat='${db:Status-Abbrev}' "$name" 2>/dev/null)" in
        ?i*) ;;
        *) echo "$name" ;;
        esac
    done
}

distribution_name() {
    local ID=""
    if [ -r /etc/os-release ]; then . /etc/os-release; fi
    echo "$ID"
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

# The command in front of apt-get: nothing for root, sudo where it works; false where neither does.
become_root() {
    if [ "$(id -u)" = 0 ]; then
        as_root=(env)
    elif command -v sudo >/dev/null && { [ -t 0 ] || sudo -n true 2>/dev/null; }; then
        as_root=(sudo env)
    else
        return 1
    fi
}

apt_install() { # packages...
    echo "setup: from the distribution: $*"
    local apt=("${as_root[@]}" DEBIAN_FRONTEND=noninteractive apt-get -qq -o DPkg::Lock::Timeout=300 -o Acquire::Retries=2)
    "${apt[@]}" update || fail "apt-get update failed" "check the network and /etc/apt/sources.list"
    "${apt[@]}" install --yes --no-install-recommends "$@" >/dev/null ||
        fail "apt-get could not install: $*" \
            "check the network; on Ubuntu the section universe must be on (sudo add-apt-repository universe)"
}

install_distribution_packages() { # extra
    check_distribution
    local missing for_page
    mapfile -t missing < <(missing_packages)
    mapfile -t for_page < <(page_packages "$1")
    if [ ${#missing[@]} = 0 ] && [ ${#for_page[@]} = 0 ]; then return; fi
    if become_root; then
        apt_install "${missing[@]}" "${for_page[@]}"
    elif [ ${#missing[@]} = 0 ]; then
        # Without them all but the page of `restshape live` can be had.
        echo "setup: missing for the page of restshape live: ${for_page[*]}" >&2
    else
        fail "these packages are missing and you are neither root nor allowed to use sudo: ${missing[*]}" \
            "ask for: apt-get install --no-install-recommends ${missing[*]} ${for_page[*]}
       or use a PETSc of your own: docs/install.md"
    fi
}
