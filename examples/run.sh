#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Makes the pictures of the README: installs what is missing, builds, simulates, bakes and renders.
#   examples/run.sh          every example
#   examples/run.sh NAME…    some of them
#   examples/run.sh --list   their names
set -euo pipefail
here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
all=(balloon suzanne)

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
steps=$((2 + ${#names[@]}))
step=0
say() {
    step=$((step + 1))
    printf '[%d/%d] %s\n' "$step" "$steps" "$*"
}

say "installing what is missing (the first time some minutes: Blender, OpenEXR)"
ltmd_system_packages
ltmd_venv_tools
ltmd_venv_blender
ltmd_openexr

say "building the library and the Blender extension"
ltmd_wheel
ltmd_extension

for name in "${names[@]}"; do
    say "$name: simulating, baking and rendering"
    mkdir -p "$out/$name"
    log=$out/$name/blender.log
    # The user folder is made anew, so that the extension is the one just built.
    rm -rf "$out/$name/blender_user" "$out/$name/tension"
    if ! "$LTMD_BPY/bin/python" -B "$here/$name.py" --extension "$LTMD_EXTENSION_ZIP" --out "$out/$name" >"$log"; then
        tail -n 20 "$log" >&2
        echo "error: $name was not made; Blender's log: $log" >&2
        exit 1
    fi
    "$LTMD_TOOLS/bin/python" -B "$here/contact_sheet.py" "$out/$name/sheet.json" "$out/$name.png"
    echo "      picture: $out/$name.png"
    echo "      scene:   $out/$name/$name.blend, baked images: $out/$name/tension"
done
