# SPDX-License-Identifier: Apache-2.0
# shellcheck shell=bash
# Source this file. Each function installs one thing the tests need, only if it is missing, into a
# cache folder outside the checkout (LTMD_CACHE), and says what it does.

LTMD_ROOT=$(cd "$(dirname "${BASH_SOURCE[0]}")/.." && pwd)
LTMD_CACHE=${LTMD_CACHE:-${XDG_CACHE_HOME:-$HOME/.cache}/ltmd}
LTMD_OPENEXR=${LTMD_OPENEXR:-$LTMD_CACHE/openexr}
LTMD_TOOLS=$LTMD_CACHE/venv-tools
LTMD_BPY=$LTMD_CACHE/venv-bpy4.5
LTMD_OPENEXR_VERSION=3.5.3
LTMD_OPENEXR_SHA256=5645cc5493802832860a715ceb621139b44ee867084cec1501a2b8685e40d88a
export LTMD_ROOT LTMD_CACHE LTMD_OPENEXR LTMD_TOOLS LTMD_BPY
export PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_ROOT_USER_ACTION=ignore
mkdir -p "$LTMD_CACHE"

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

ltmd_python() {
    local candidate
    for candidate in "${LTMD_PYTHON:-}" python3.11 python3; do
        if [ -n "$candidate" ] && "$candidate" -c 'import sys; sys.exit(sys.version_info[:2] != (3, 11))' 2>/dev/null; then
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

ltmd_system_packages() {
    local wanted missing=() package python
    wanted=(g++ cmake ninja-build libgtest-dev ca-certificates
        libsm6 libice6 libxrender1 libxi6 libxfixes3 libxxf86vm1 libxkbcommon0 libgl1 libegl1)
    python=$(ltmd_python) || wanted+=(python3.11)
    if [ -z "${python:-}" ] || ! ltmd_python_is_complete "$python"; then
        wanted+=(python3.11-venv python3.11-dev)
    fi
    if ! command -v dpkg-query >/dev/null || ! command -v apt-get >/dev/null; then
        ltmd_say "no apt here: these packages of Debian 12, or their like, are taken as given: ${wanted[*]}"
        return
    fi
    for package in "${wanted[@]}"; do
        [ "$(dpkg-query -W -f '${db:Status-Status}' "$package" 2>/dev/null || true)" = installed ] || missing+=("$package")
    done
    [ ${#missing[@]} -gt 0 ] || return 0
    ltmd_say "installing system packages: ${missing[*]}"
    ltmd_quiet ltmd_as_root apt-get update
    ltmd_quiet ltmd_as_root env DEBIAN_FRONTEND=noninteractive apt-get install -y --no-install-recommends "${missing[@]}"
}

# ltmd_venv NAME: $LTMD_CACHE/venv-NAME with exactly the pins of tests/requirements-NAME.txt.
ltmd_venv() {
    local venv=$LTMD_CACHE/venv-$1 pins=$LTMD_ROOT/tests/requirements-$1.txt python
    ! cmp -s "$pins" "$venv/.ltmd-pins" || return 0
    python=$(ltmd_python) || ltmd_fail "Python 3.11 was not found; set LTMD_PYTHON" || return 1
    ltmd_say "preparing $venv"
    if ! "$venv/bin/python" -c pass 2>/dev/null; then
        rm -rf "$venv"
        ltmd_quiet "$python" -m venv "$venv" || return 1
    fi
    ltmd_quiet "$venv/bin/python" -m pip install -r "$pins" || return 1
    cp "$pins" "$venv/.ltmd-pins"
}

ltmd_venv_tools() { ltmd_locked ltmd_venv tools; }
ltmd_venv_blender() { ltmd_locked ltmd_venv bpy4.5; }

# Debian's Imath source, by the machine's own package lists.
ltmd_imath_source() {
    local codename uri list=$1/imath.list
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
    [ -n "$uri" ] || ltmd_fail "no Debian repository of '$codename' main is set up here; build static, hidden, position-independent Imath and OpenEXR yourself and set LTMD_OPENEXR to their prefix" || return 1
    echo "deb-src $uri $codename main" >"$list"
    mkdir -p "$1/lists/partial" "$1/archives/partial"
    local apt=(apt-get -o "Dir::Etc::SourceList=$list" -o Dir::Etc::SourceParts=/dev/null
        -o "Dir::State::Lists=$1/lists" -o "Dir::Cache=$1" -o "APT::Sandbox::User=$(id -un)")
    (cd "$1" && ltmd_quiet "${apt[@]}" update &&
        ltmd_quiet "${apt[@]}" source --download-only imath) || return 1
    tar -xf "$(find "$1" -name 'imath_*.orig.tar.*' ! -name '*.asc')" -C "$1"
}

ltmd_openexr_into() {
    local prefix=$1 work=$2 source options
    # Hidden symbols: inside Blender the host's own OpenEXR must neither be called nor replaced.
    options=(-G Ninja -DCMAKE_BUILD_TYPE=Release -DBUILD_SHARED_LIBS=OFF -DCMAKE_POSITION_INDEPENDENT_CODE=ON
        -DCMAKE_CXX_VISIBILITY_PRESET=hidden -DCMAKE_C_VISIBILITY_PRESET=hidden
        -DCMAKE_VISIBILITY_INLINES_HIDDEN=ON "-DCMAKE_INSTALL_PREFIX=$prefix" "-DCMAKE_PREFIX_PATH=$prefix"
        -DCMAKE_INSTALL_LIBDIR=lib -DBUILD_TESTING=OFF -DOPENEXR_BUILD_TOOLS=OFF -DOPENEXR_INSTALL_TOOLS=OFF
        -DOPENEXR_BUILD_EXAMPLES=OFF -DOPENEXR_INSTALL_DOCS=OFF)
    ltmd_imath_source "$work" || return 1
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

ltmd_wheel_build() {
    local hash folder wheel venv
    hash=$(ltmd_hash pyproject.toml CMakeLists.txt README.md LICENSE cmake cpp)
    folder=$LTMD_CACHE/wheels-$hash
    if ! compgen -G "$folder/pyltmd-*.whl" >/dev/null; then
        ltmd_say "building the wheel"
        rm -rf "$folder" "$folder.partial"
        CMAKE_PREFIX_PATH=$LTMD_OPENEXR ltmd_quiet "$LTMD_TOOLS/bin/python" -m pip wheel \
            --no-build-isolation --no-deps -w "$folder.partial" "$LTMD_ROOT" || { rm -rf "$folder.partial" && return 1; }
        mv "$folder.partial" "$folder"
        find "$LTMD_CACHE" -maxdepth 1 -name 'wheels-*' -mtime +3 -exec rm -rf {} +
    fi
    wheel=$(compgen -G "$folder/pyltmd-*.whl")
    for venv in "$LTMD_TOOLS" "$LTMD_BPY"; do
        [ -x "$venv/bin/python" ] || continue
        [ "$(cat "$venv/.ltmd-wheel" 2>/dev/null)" != "$hash" ] || continue
        ltmd_say "installing $(basename "$wheel") in $(basename "$venv")"
        rm -f "$venv/.ltmd-wheel"
        ltmd_quiet "$venv/bin/python" -m pip install --no-deps --no-index --force-reinstall "$wheel" || return 1
        echo "$hash" >"$venv/.ltmd-wheel"
    done
    echo "$wheel"
}

# Sets LTMD_WHEEL to the wheel of the checkout's sources and installs it in both environments.
ltmd_wheel() {
    LTMD_WHEEL=$(ltmd_locked ltmd_wheel_build) || return 1
    export LTMD_WHEEL
}

# Sets LTMD_EXTENSION_ZIP to the Blender extension with that wheel in it.
ltmd_extension() {
    [ -n "${LTMD_WHEEL:-}" ] || ltmd_wheel || return 1
    LTMD_EXTENSION_ZIP=$LTMD_CACHE/extension-$(ltmd_hash blender_addon osl pyproject.toml CMakeLists.txt cpp)/ltmd.zip
    export LTMD_EXTENSION_ZIP
    [ ! -e "$LTMD_EXTENSION_ZIP" ] || return 0
    ltmd_say "building the extension"
    mkdir -p "$(dirname "$LTMD_EXTENSION_ZIP")"
    find "$LTMD_CACHE" -maxdepth 1 -name 'extension-*' -mtime +3 -exec rm -rf {} +
    ltmd_quiet "$LTMD_BPY/bin/python" "$LTMD_ROOT/blender_addon/build_extension.py" "$LTMD_WHEEL" -o "$LTMD_EXTENSION_ZIP"
}
