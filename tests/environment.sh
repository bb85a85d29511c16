# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# Source this file. Each function installs one thing the tests need, only if it is missing, into a
# cache folder outside the checkout (LTMD_CACHE), and says what it does.

LTMD_ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
LTMD_CACHE=${LTMD_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/ltmd}
LTMD_OPENEXR=${LTMD_OPENEXR:-$LTMD_CACHE/openexr}
LTMD_TOOLS=$LTMD_CACHE/venv-tools
LTMD_BPY=$LTMD_CACHE/venv-bpy4.5
# Blender's two long-term versions; the first one serves examples and benchmarks.
LTMD_BLENDERS=(4.5 5.2)
LTMD_PYTHON313=$LTMD_CACHE/python3.13
LTMD_OPENEXR_VERSION=3.5.3
LTMD_OPENEXR_SHA256=5645cc5493802832860a715ceb621139b44ee867084cec1501a2b8685e40d88a
LTMD_WHEELS=()
export LTMD_ROOT LTMD_CACHE LTMD_OPENEXR LTMD_TOOLS LTMD_BPY
export PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_ROOT_USER_ACTION=ignore
mkdir -p "$LTMD_CACHE"

# The library's objects are compiled once for the tests, for each Python and for all checkouts, if there is ccache.
ltmd_ccache() {
    command -v ccache >/dev/null || return 0
    # One name for the compiler, which Python's builds would call g++: it is part of what objects are found by.
    export CXX=${CXX:-c++} CMAKE_CXX_COMPILER_LAUNCHER=${CMAKE_CXX_COMPILER_LAUNCHER:-ccache}
    export CCACHE_DIR=$LTMD_CACHE/ccache CCACHE_BASEDIR=$LTMD_ROOT CCACHE_NOHASHDIR=1 CCACHE_MAXSIZE=1G
}
ltmd_ccache

ltmd_say() { printf '== %s\n' "$*" >&2; }

ltmd_fail() {
    printf 'error: %s\n' "$*" >&2
    return 1
}

# Runs a command with its output kept back; shows the end of it only when the command fails.
ltmd_quiet() {
    local log status=0
    log=$(mktemp)
    "$@" >"$log" 2>&1 </dev/null || status=$?
    [ "$status" -eq 0 ] || { tail -n 40 "$log" >&2 && ltmd_say "failed: $*"; }
    rm -f "$log"
    return "$status"
}

# Runs a function of this file alone in the cache, so that two test runs do not install over each other.
ltmd_locked() {
    (
        flock -n 9 || { ltmd_say "waiting for another run that installs in $LTMD_CACHE" && flock 9; }
        "$@"
    ) 9>"$LTMD_CACHE/.lock"
}

ltmd_as_root() {
    if [ "$(id -u)" -eq 0 ]; then
        "$@"
    elif command -v sudo >/dev/null; then
        sudo "$@"
    else
        ltmd_fail "this needs root and there is no sudo: $*"
    fi
}

# ltmd_python 3.11: the path of such a Python.
ltmd_python() {
    local candidate
    for candidate in "${LTMD_PYTHON:-}" "$LTMD_CACHE/python$1/bin/python$1" "python$1" python3; do
        if [ -n "$candidate" ] && "$candidate" -c 'import sys; sys.exit("%d.%d" % sys.version_info[:2] != sys.argv[1])' "$1" 2>/dev/null; then
            command -v "$candidate"
            return
        fi
    done
    return 1
}

ltmd_python_is_complete() {
    "$1" -c 'import ensurepip, os, sysconfig, venv
assert os.path.exists(os.path.join(sysconfig.get_path("include"), "Python.h"))' 2>/dev/null
}

# ltmd_packages NAME…: installs these packages of Debian 12.
ltmd_packages() {
    local missing=() package
    if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
        ltmd_say "no apt here: these packages of Debian 12, or their like, are taken as given: $*"
        return
    fi
    for package in "$@"; do
        [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)" = installed ] || missing+=("$package")
    done
    [ ${#missing[@]} -gt 0 ] || return 0
    ltmd_say "installing system packages: ${missing[*]}"
    ltmd_quiet ltmd_as_root apt-get update
    ltmd_quiet ltmd_as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "${missing[@]}"
}

ltmd_system_packages() {
    local wanted python
    wanted=(g++ ccache cmake ninja-build pkg-config libgtest-dev libcli11-dev libtinyobjloader-dev ca-certificates
        libsm6 libice6 libxrender1 libxi6 libxfixes3 libxxf86vm1 libxkbcommon0 libgl1 libegl1)
    python=$(ltmd_python 3.11) || wanted+=(python3.11)
    if [ -z "${python:-}" ] || ! ltmd_python_is_complete "$python"; then
        wanted+=(python3.11-venv python3.11-dev)
    fi
    ltmd_packages "${wanted[@]}" && ltmd_ccache
}

# ltmd_venv NAME PYTHON: $LTMD_CACHE/venv-NAME with exactly the pins of tests/requirements-NAME.txt.
ltmd_venv() {
    local venv=$LTMD_CACHE/venv-$1 pins=$LTMD_ROOT/tests/requirements-$1.txt python
    ! cmp -s "$pins" "$venv/.ltmd-pins" || return 0
    python=$(ltmd_python "$2") || ltmd_fail "Python $2 was not found; set LTMD_PYTHON" || return 1
    ltmd_say "preparing $venv"
    if ! "$venv/bin/python" -c pass 2>/dev/null; then
        rm -rf "$venv"
        ltmd_quiet "$python" -m venv "$venv" || return 1
    fi
    ltmd_quiet "$venv/bin/python" -m pip install -r "$pins" || return 1
    cp "$pins" "$venv/.ltmd-pins"
}

ltmd_venv_tools() { ltmd_locked ltmd_venv tools 3.11; }

# ltmd_venv_blender [VERSION]
ltmd_venv_blender() {
    case "${1:-4.5}" in
        4.5) ltmd_locked ltmd_venv bpy4.5 3.11 ;;
        5.2) ltmd_locked ltmd_python313_build && ltmd_locked ltmd_venv bpy5.2 3.13 ;;
        *) ltmd_fail "no Blender $1 here, only ${LTMD_BLENDERS[*]}" ;;
    esac
}

# ltmd_debian_source PACKAGE SUITE FOLDER: unpacks the package's upstream source, from the mirror
# that the machine's own package lists name.
ltmd_debian_source() {
    local package=$1 suite=$2 work=$3 uri list=$3/source.list codename
    # shellcheck source=/dev/null
    codename=$(. /etc/os-release && echo "${VERSION_CODENAME:-}")
    ltmd_repository() {
        apt-get indextargets 'Created-By: Packages' --format '$(REPO_URI)|$(RELEASE)|$(COMPONENT)' |
            awk -F'|' -v c="$codename" '$2 == c && $3 == "main" { print $1; exit }'
    }
    uri=$(ltmd_repository)
    if [ -z "$uri" ]; then
        ltmd_quiet ltmd_as_root apt-get update
        uri=$(ltmd_repository)
    fi
    [ -n "$uri" ] || ltmd_fail "no Debian repository of '$codename' main is set up here, so the source of $package cannot be fetched" || return 1
    echo "deb-src $uri ${suite:-$codename} main" >"$list"
    mkdir -p "$work/lists/partial" "$work/archives/partial"
    local apt=(apt-get -o "Dir::Etc::SourceList=$list" -o Dir::Etc::SourceParts=/dev/null
        -o "Dir::State::Lists=$work/lists" -o "Dir::Cache=$work" -o "APT::Sandbox::User=$(id -un)")
    (cd "$work" && ltmd_quiet "${apt[@]}" update &&
        ltmd_quiet "${apt[@]}" source --download-only "$package") || return 1
    tar -xf "$(find "$work" -name '*.orig.tar.*' ! -name '*.asc')" -C "$work"
}

ltmd_python313_into() {
    local prefix=$1 work=$2 source
    ltmd_debian_source python3.13 trixie "$work" || return 1
    source=$(find "$work" -maxdepth 1 -name 'Python-3.13*')
    cd "$source" || return 1
    ltmd_quiet ./configure -q "--prefix=$prefix" --with-ensurepip=install --disable-test-modules || return 1
    ltmd_quiet make -s "-j$(nproc)" && ltmd_quiet make -s install
}

# Blender 5.2's Python, which Debian 12 does not have.
ltmd_python313_build() {
    local work status=0
    ! ltmd_python_is_complete "$(ltmd_python 3.13)" || return 0
    ltmd_packages gcc make xz-utils libssl-dev libffi-dev zlib1g-dev libbz2-dev liblzma-dev libsqlite3-dev || return 1
    ltmd_say "building Python 3.13 in $LTMD_PYTHON313 (three to five minutes)"
    work=$(mktemp -d) || return 1
    rm -rf "$LTMD_PYTHON313"
    (ltmd_python313_into "$LTMD_PYTHON313" "$work") || status=1
    rm -rf "$work"
    [ "$status" -eq 0 ] && ltmd_python_is_complete "$LTMD_PYTHON313/bin/python3.13" && return
    rm -rf "$LTMD_PYTHON313"
    ltmd_fail "Python 3.13 was not built; install one with its headers, or name it with LTMD_PYTHON"
}

ltmd_openexr_into() {
    local prefix=$1 work=$2 source options
    # Hidden symbols: inside Blender the host's own OpenEXR must neither be called nor replaced.
    options=(-G Ninja -DCMAKE_BUILD_TYPE=Release -DBUILD_SHARED_LIBS=OFF -DCMAKE_POSITION_INDEPENDENT_CODE=ON
        -DCMAKE_CXX_VISIBILITY_PRESET=hidden -DCMAKE_C_VISIBILITY_PRESET=hidden
        -DCMAKE_VISIBILITY_INLINES_HIDDEN=ON "-DCMAKE_INSTALL_PREFIX=$prefix" "-DCMAKE_PREFIX_PATH=$prefix"
        -DCMAKE_INSTALL_LIBDIR=lib -DBUILD_TESTING=OFF -DOPENEXR_BUILD_TOOLS=OFF -DOPENEXR_INSTALL_TOOLS=OFF
        -DOPENEXR_BUILD_EXAMPLES=OFF -DOPENEXR_INSTALL_DOCS=OFF)
    ltmd_debian_source imath "" "$work" ||
        ltmd_fail "build static, hidden, position-independent Imath and OpenEXR yourself and set LTMD_OPENEXR to their prefix" || return 1
    # pip configures the source to learn its version, by default with make, which may be missing.
    CMAKE_GENERATOR=Ninja ltmd_quiet "$LTMD_TOOLS/bin/python" -m pip download --no-deps --no-build-isolation -d "$work" \
        --no-binary OpenEXR "OpenEXR==$LTMD_OPENEXR_VERSION" || return 1
    (cd "$work" && echo "$LTMD_OPENEXR_SHA256  openexr-$LTMD_OPENEXR_VERSION.tar.gz" |
        sha256sum --check --quiet -) >&2 || return 1
    tar -xf "$work/openexr-$LTMD_OPENEXR_VERSION.tar.gz" -C "$work" || return 1
    for source in "$work"/Imath-*/ "$work/openexr-$LTMD_OPENEXR_VERSION/"; do
        ltmd_quiet cmake -S "$source" -B "$source/build" --no-warn-unused-cli "${options[@]}" || return 1
        ltmd_quiet cmake --build "$source/build" --target install || return 1
    done
}

ltmd_openexr_build() {
    [ ! -e "$LTMD_OPENEXR/.complete" ] || return 0
    ltmd_say "building static OpenEXR $LTMD_OPENEXR_VERSION and Imath in $LTMD_OPENEXR (about two minutes)"
    local work prefix=$LTMD_OPENEXR.partial status=0
    work=$(mktemp -d) || return 1
    rm -rf "$prefix"
    ltmd_openexr_into "$prefix" "$work" || status=1
    rm -rf "$work"
    [ "$status" -eq 0 ] || ltmd_fail "OpenEXR was not built" || return 1
    # The prefix may be moved; only these files name the place it was built for.
    rm -rf "$prefix/lib/pkgconfig" "$LTMD_OPENEXR"
    touch "$prefix/.complete"
    mv "$prefix" "$LTMD_OPENEXR"
}

ltmd_openexr() { ltmd_locked ltmd_openexr_build; }

# One number for the contents of the named files and folders of the checkout.
ltmd_hash() {
    (
        cd "$LTMD_ROOT"
        find "$@" -type f ! -name '*.pyc' ! -path '*/__pycache__/*' -print0 2>/dev/null |
            sort -z | xargs -0 sha256sum | sha256sum | cut -c 1-16
    )
}

# The Pythons that get a wheel: the tools' 3.11, which Blender 4.5 has too, and Blender 5.2's.
ltmd_wheel_venvs() {
    echo "$LTMD_TOOLS"
    [ ! -e "$LTMD_CACHE/venv-bpy5.2/.ltmd-pins" ] || echo "$LTMD_CACHE/venv-bpy5.2"
}

ltmd_wheel_build() {
    local hash folder wheel venv tag venvs
    # Not README.md, whose text a wheel also has: it changes more often than what is tested.
    hash=$(ltmd_hash pyproject.toml CMakeLists.txt LICENSE cmake cpp)
    folder=$LTMD_CACHE/wheels-$hash
    mapfile -t venvs < <(ltmd_wheel_venvs)
    for venv in "${venvs[@]}"; do
        tag=$(ltmd_tag "$venv") || return 1
        ! compgen -G "$folder/pyltmd-*-$tag-*.whl" >/dev/null || continue
        ltmd_say "building the wheel for $tag"
        rm -rf "$folder.partial"
        CMAKE_PREFIX_PATH=$LTMD_OPENEXR ltmd_quiet "$venv/bin/python" -m pip wheel \
            --no-build-isolation --no-deps -w "$folder.partial" -C "build-dir=$LTMD_ROOT/build/$tag" \
            -C cmake.define.LTMD_WARNINGS_AS_ERRORS=ON "$LTMD_ROOT" || { rm -rf "$folder.partial" && return 1; }
        mkdir -p "$folder"
        mv "$folder.partial"/*.whl "$folder"
        rm -rf "$folder.partial"
        find "$LTMD_CACHE" -maxdepth 1 -name 'wheels-*' -mtime +3 -exec rm -rf {} +
    done
    for venv in "$LTMD_TOOLS" "$LTMD_CACHE"/venv-bpy*; do
        [ -e "$venv/.ltmd-pins" ] || continue
        [ "$(cat "$venv/.ltmd-wheel" 2>/dev/null)" != "$hash" ] || continue
        wheel=$(compgen -G "$folder/pyltmd-*-$(ltmd_tag "$venv")-*.whl")
        ltmd_say "installing $(basename "$wheel") in $(basename "$venv")"
        rm -f "$venv/.ltmd-wheel"
        ltmd_quiet "$venv/bin/python" -m pip install --no-deps --no-index --force-reinstall "$wheel" || return 1
        echo "$hash" >"$venv/.ltmd-wheel"
    done
    compgen -G "$folder/pyltmd-*.whl"
}

# ltmd_tag VENV: cp311 or cp313.
ltmd_tag() { "$1/bin/python" -c 'import sys; print("cp%d%d" % sys.version_info[:2])'; }

# Sets LTMD_WHEELS to the wheels of the checkout's sources and installs them in every environment.
ltmd_wheel() {
    local found
    found=$(ltmd_locked ltmd_wheel_build) || return 1
    mapfile -t LTMD_WHEELS <<<"$found"
}

# Sets LTMD_EXTENSION_ZIP to the Blender extension with those wheels in it.
ltmd_extension() {
    [ ${#LTMD_WHEELS[@]} -gt 0 ] || ltmd_wheel || return 1
    LTMD_EXTENSION_ZIP=$LTMD_CACHE/extension-$(ltmd_hash blender_addon osl pyproject.toml CMakeLists.txt cmake cpp)-${#LTMD_WHEELS[@]}/ltmd.zip
    export LTMD_EXTENSION_ZIP
    [ ! -e "$LTMD_EXTENSION_ZIP" ] || return 0
    ltmd_say "building the extension"
    mkdir -p "$(dirname "$LTMD_EXTENSION_ZIP")"
    find "$LTMD_CACHE" -maxdepth 1 -name 'extension-*' -mtime +3 -exec rm -rf {} +
    ltmd_quiet "$LTMD_BPY/bin/python" "$LTMD_ROOT/blender_addon/build_extension.py" "${LTMD_WHEELS[@]}" -o "$LTMD_EXTENSION_ZIP"
}
