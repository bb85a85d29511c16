#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Prints the budgets of the geometry branch as ratios measured in one run. tests/bench/run.sh [OPTIONS of geometry.py]
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/../.."
# shellcheck source=tests/environment.sh
. tests/environment.sh
ltmd_system_packages
ltmd_venv_tools
ltmd_venv_blender
ltmd_openexr
ltmd_wheel
exec "$LTMD_TOOLS/bin/python" tests/bench/geometry.py --blender-python "$LTMD_BPY/bin/python" "$@"
