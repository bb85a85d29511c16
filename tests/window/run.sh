#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs and uses the extension in a real Blender window: Debian sid's Blender 5.2 in a folder of
# the cache (about 2.5 GB, made once), on a display in memory. That Blender is an executable with its
# own OpenEXR, OpenImageIO and TBB, has Python 3.14 and no OSL. Needs root and Debian.
#   tests/window/run.sh [--pictures]    --pictures also writes docs/pictures/panel.png
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
# shellcheck source=../environment.sh
. tests/environment.sh

SID=$LTMD_CACHE/sid
PICTURES=${1:-}

inside() { ltmd_as_root chroot "$SID" env DEBIAN_FRONTEND=noninteractive LC_ALL=C.UTF-8 "$@"; }

sid_root() {
    [ ! -e "$SID/.complete" ] || return 0
    ltmd_packages debootstrap
    ltmd_say "making a Debian sid root with Blender in $SID (some minutes)"
    ltmd_as_root rm -rf "$SID"
    ltmd_quiet ltmd_as_root debootstrap --variant=minbase --include=ca-certificates sid "$SID"
    # A mirror may lag behind; what is installed is used for tests alone.
    inside sh -c 'echo "Acquire::Check-Valid-Until \"false\";" >/etc/apt/apt.conf.d/90ltmd'
    ltmd_quiet inside apt-get update
    ltmd_quiet inside apt-get install -y --no-install-recommends \
        blender xvfb xauth x11-apps xdotool libgl1-mesa-dri python3-numpy python3-cattr python3-requests \
        g++ cmake ninja-build python3-dev python3-pip python3-pybind11 pybind11-dev python3-scikit-build-core
    ltmd_as_root touch "$SID/.complete"
}

# The wheel for that Python, with its compiler and the same static OpenEXR.
sid_wheel() {
    local stamp folder=$SID/ltmd
    stamp=$(ltmd_hash pyproject.toml CMakeLists.txt README.md LICENSE cmake cpp)
    if [ "$(cat "$folder/wheels/stamp" 2>/dev/null || true)" != "$stamp" ]; then
        ltmd_say "building the wheel for $(inside python3 --version)"
        ltmd_as_root rm -rf "$folder/wheels" "$folder/source" "$folder/openexr"
        ltmd_as_root mkdir -p "$folder/source"
        ltmd_as_root cp -r pyproject.toml CMakeLists.txt README.md LICENSE cmake cpp "$folder/source/"
        ltmd_as_root cp -rL "$LTMD_OPENEXR" "$folder/openexr"
        ltmd_quiet inside CMAKE_PREFIX_PATH=/ltmd/openexr CMAKE_GENERATOR=Ninja python3 -m pip wheel \
            --no-build-isolation --no-deps --no-index -w /ltmd/wheels /ltmd/source
        echo "$stamp" | ltmd_as_root tee "$folder/wheels/stamp" >/dev/null
    fi
    compgen -G "$folder/wheels/pyltmd-*.whl"
}

# window CASE: see window.py.
window() {
    local case=$1 log=$WORK/$1.log status=0
    ltmd_as_root rm -rf "$SID/ltmd/user" "$SID/ltmd/out-$case"
    ltmd_as_root mkdir -p "$SID/ltmd/user" "$SID/ltmd/out-$case"
    [ ! -e "$WORK/scene.blend" ] || ltmd_as_root cp "$WORK"/{scene,shown}.blend "$SID/ltmd/out-$case/"
    # A namespace of its own: /proc is gone from the root again when this ends.
    ltmd_as_root unshare --mount sh -c "mount --bind /proc '$SID/proc' && exec chroot '$SID' env \
        HOME=/ltmd/user BLENDER_USER_RESOURCES=/ltmd/user LIBGL_ALWAYS_SOFTWARE=1 LC_ALL=C.UTF-8 \
        timeout 600 xvfb-run -a -s '-screen 0 1280x900x24' blender --factory-startup \
        --gpu-backend opengl --window-geometry 0 0 1280 900 \
        --python-exit-code 1 --python /ltmd/window.py -- /ltmd $case" >"$log" 2>&1 || status=$?
    # What a panel raises while it is drawn is only seen in the log.
    if [ "$status" -ne 0 ] || ! grep -q 'WINDOW DONE' "$log" || grep -q Traceback "$log"; then
        cat "$log" >&2
        ltmd_fail "the window test '$case' failed; its last picture: $SID/ltmd/out-$case"
        return 1
    fi
    grep -E '^(loaded|ESC|LTMD:)' "$log" || true
    printf 'window %s: passed\n' "$case"
}

WORK=$(mktemp -d)
trap 'rm -rf "$WORK"' EXIT
ltmd_locked sid_root
ltmd_extension
wheel=$(ltmd_locked sid_wheel)
build=("$LTMD_BPY/bin/python" blender_addon/build_extension.py)
ltmd_quiet "${build[@]}" -o "$WORK/missing.zip"
ltmd_quiet "${build[@]}" "$wheel" -o "$WORK/whole.zip"
ltmd_as_root cp "$LTMD_EXTENSION_ZIP" "$SID/ltmd/released.zip"
ltmd_as_root cp "$WORK/missing.zip" "$WORK/whole.zip" tests/window/window.py "$SID/ltmd/"
window missing
ltmd_quiet "$LTMD_CACHE/venv-bpy5.2/bin/python" tests/window/scene.py "$LTMD_ROOT" "$WORK/scene.blend"
window whole
if [ "$PICTURES" = --pictures ]; then
    mkdir -p docs/pictures
    "$LTMD_TOOLS/bin/python" tests/window/xwd_to_png.py "$SID/ltmd/out-whole/panel.xwd" docs/pictures/panel.png
fi
