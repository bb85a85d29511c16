#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs what is missing, builds everything and runs every test. All stages run even if one fails;
# the exit code is then 1.
#   tests/run.sh [--fast] [STAGE…]
# --fast takes the installed tools as they are and leaves out the tests marked slow.
# Stages: environment cpp ctest wheel extension format python osl blender (default: all, in this order).
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 1
# shellcheck source=tests/environment.sh
. tests/environment.sh

ALL=(environment cpp ctest wheel extension format python osl blender)
FAST=
STAGES=()
for argument in "$@"; do
    case " ${ALL[*]} --fast " in
        *" $argument "*) [ "$argument" = --fast ] && FAST=1 || STAGES+=("$argument") ;;
        *) ltmd_fail "unknown argument '$argument'; usage: tests/run.sh [--fast] [${ALL[*]}]" || exit 2 ;;
    esac
done
[ ${#STAGES[@]} -gt 0 ] || STAGES=("${ALL[@]}")

LOGS=$(mktemp -d)
trap 'rm -rf "$LOGS"' EXIT

stage_environment() {
    if [ -n "$FAST" ]; then
        return 0
    fi
    ltmd_system_packages && ltmd_venv_tools && ltmd_venv_blender && ltmd_openexr
}

stage_cpp() {
    cmake --preset release "-DCMAKE_PREFIX_PATH=$LTMD_OPENEXR" && cmake --build --preset release
}

stage_ctest() { ctest --preset release --no-tests=error --timeout 300 -j 2; }

# The wheel is tested with NumPy 2 beside the judges; inside Blender's Python it must load too.
stage_wheel() {
    ltmd_wheel && "$LTMD_BPY/bin/python" -c 'import bpy, ltmd, numpy; print("ltmd", ltmd.__version__, "with bpy", bpy.app.version_string, "and NumPy", numpy.__version__)'
}

stage_extension() { ltmd_extension && ls -l "$LTMD_EXTENSION_ZIP"; }

stage_format() {
    local sources status=0
    mapfile -t sources < <(find cpp tests -name '*.h' -o -name '*.cpp')
    "$LTMD_TOOLS/bin/clang-format" --dry-run -Werror "${sources[@]}" || status=1
    "$LTMD_TOOLS/bin/ruff" check . || status=1
    "$LTMD_TOOLS/bin/ruff" format --check . || status=1
    return "$status"
}

# pytest's own exit code 5, nothing collected, is a failure too.
pytest_of() {
    ltmd_wheel || return 1
    local options=(-q -rfEs --durations=5 -p no:cacheprovider)
    [ -z "$FAST" ] || options+=(-m "not slow")
    timeout 1200 "$LTMD_TOOLS/bin/python" -m pytest "${options[@]}" "$@"
}

stage_python() { pytest_of tests/python; }
stage_osl() { ltmd_extension && pytest_of tests/osl; }
stage_blender() { ltmd_extension && pytest_of tests/blender; }

TABLE=()
STATUS=0
for stage in "${STAGES[@]}"; do
    printf '\n===== %s\n' "$stage"
    start=$SECONDS
    if "stage_$stage" 2>&1 | tee "$LOGS/$stage"; then
        result=passed
    else
        result=FAILED
        STATUS=1
    fi
    TABLE+=("$(printf '%-12s %s %5d s' "$stage" "$result" $((SECONDS - start)))")
done

printf '\n===== stages\n'
printf '%s\n' "${TABLE[@]}"
# The closing lines of the runners, in their own words.
for stage in ctest python osl blender; do
    [ -e "$LOGS/$stage" ] || continue
    printf '%s: %s\n' "$stage" "$(grep -E 'tests? (passed|failed)|[0-9]+ (passed|failed|error|skipped|deselected).* in |no tests ran' "$LOGS/$stage" | tail -n 1)"
done
exit "$STATUS"
