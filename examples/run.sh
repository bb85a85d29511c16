#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes the pictures of the README: installs what is missing, builds, simulates, bakes and renders.
#   examples/run.sh          every example
#   examples/run.sh NAME…    some of them
#   examples/run.sh --list   their names
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
scenes=(balloon suzanne presets tension_views plate figurines vases knot beyond_lobes tails)
# Made by the Python package alone: NAME.py --out FILE.png.
plots=(sphere_grid torus_knot mdf_conversion ellipsoid_ndf masking distributions lobe_error)
all=("${scenes[@]}" "${plots[@]}")

usage="usage: examples/run.sh [--list | NAME…], NAME is one of: ${all[*]}"
names=()
for argument in "$@"; do
    case " ${all[*]} " in
        *" $argument "*) names+=("$argument") ;;
        *)
            case "$argument" in
                --list) printf '%s\n' "${all[@]}" && exit ;;
                -h | --help) echo "$usage" && exit ;;
                *) echo "error: there is no example '$argument'; $usage" >&2 && exit 2 ;;
            esac
            ;;
    esac
done
[ ${#names[@]} -gt 0 ] || names=("${all[@]}")

# shellcheck source=../tests/environment.sh
. "$here/../tests/environment.sh"
out=$here/out
needs_blender=
for name in "${names[@]}"; do
    case " ${scenes[*]} " in *" $name "*) needs_blender=1 ;; esac
done
steps=$((2 + ${#names[@]}))
step=0
say() {
    step=$((step + 1))
    printf '[%d/%d] %s\n' "$step" "$steps" "$*"
}

say "installing what is missing (the first time some minutes: Blender, OpenEXR)"
ltmd_system_packages
ltmd_venv_tools
[ -z "$needs_blender" ] || ltmd_venv_blender
ltmd_openexr

say "building the library${needs_blender:+ and the Blender extension}"
ltmd_wheel
[ -z "$needs_blender" ] || ltmd_extension

scene() {
    say "$1: simulating, baking and rendering"
    mkdir -p "$out/$1"
    local log=$out/$1/blender.log
    # The user folder is made anew, so that the extension is the one just built.
    rm -rf "$out/$1/blender_user" "$out/$1/tension"
    if ! "$LTMD_BPY/bin/python" -B "$here/$1.py" --extension "$LTMD_EXTENSION_ZIP" --out "$out/$1" >"$log"; then
        tail -n 20 "$log" >&2
        echo "error: $1 was not made; Blender's log: $log" >&2
        exit 1
    fi
    "$LTMD_TOOLS/bin/python" -B "$here/contact_sheet.py" "$out/$1/sheet.json" "$out/$1.png"
    echo "      picture: $out/$1.png"
    echo "      scene:   $out/$1/$1.blend, baked images: $out/$1/tension"
}

plot() {
    say "$1: computing and plotting"
    "$LTMD_TOOLS/bin/python" -B "$here/$1.py" --out "$out/$1.png"
    echo "      picture: $out/$1.png"
}

mkdir -p "$out"
for name in "${names[@]}"; do
    case " ${scenes[*]} " in
        *" $name "*) scene "$name" ;;
        *) plot "$name" ;;
    esac
done
