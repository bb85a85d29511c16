#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Prints the budgets of the geometry branch as ratios measured in one run, or runs another benchmark of this folder.
#   tests/bench/run.sh [OPTIONS of geometry.py]
#   tests/bench/run.sh growth [OPTIONS of growth.py]
#   tests/bench/run.sh materials [OPTIONS of cycles_materials.py]    in the Blender of LTMD_BLENDER
#   tests/bench/run.sh microfacet [OPTIONS of microfacet.py]    also from C++, one call at a time
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
# shellcheck source=tests/environment.sh
. tests/environment.sh
ltmd_system_packages
ltmd_venv_tools
ltmd_venv_blender
ltmd_openexr
ltmd_wheel
if [ "${1:-}" = microfacet ]; then
    cmake --preset release -DCMAKE_PREFIX_PATH="$LTMD_OPENEXR" -DLTMD_BUILD_TESTS=ON > build/bench.log
    cmake --build --preset release --target ltmd_bench >> build/bench.log
    build/release/tests/cpp/ltmd_bench
fi
if [ "${1:-}" = materials ]; then
    blender=${LTMD_BLENDER:-4.5}
    ltmd_venv_blender "$blender"
    exec "$LTMD_CACHE/venv-bpy$blender/bin/python" tests/bench/cycles_materials.py "${@:2}"
fi
if [ -e "tests/bench/${1:-}.py" ]; then
    exec "$LTMD_TOOLS/bin/python" "tests/bench/$1.py" "${@:2}"
fi
exec "$LTMD_TOOLS/bin/python" tests/bench/geometry.py --blender-python "$LTMD_BPY/bin/python" "$@"
