#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Installs what is missing, builds everything and runs every test. All stages run even if one fails;
# the exit code is then 1.
#   tests/run.sh [--fast | --long] [STAGE…]
# --fast takes the installed tools as they are and leaves out the tests marked slow. --long adds the
# tests marked long and the stages long (tests/long.sh) and window (a real Blender window).
# Stages: environment cpp ctest wheel extension format python osl4.5 osl5.2 blender4.5 blender5.2 both
# (default: all, in this order); osl and blender name both versions.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 1
# shellcheck source=tests/environment.sh
. tests/environment.sh

ALL=(environment cpp ctest wheel extension format python osl4.5 osl5.2 blender4.5 blender5.2 both)
LONG=(long window)
LEFT_OUT="not long"
FAST=
STAGES=()
for argument in "$@"; do
    case "$argument" in
        --fast) FAST=1 LEFT_OUT="not long and not slow" ;;
        --long) ALL+=("${LONG[@]}") LEFT_OUT= ;;
        osl | blender) for version in "${LTMD_BLENDERS[@]}"; do STAGES+=("$argument$version"); done ;;
        *)
            case " ${ALL[*]} ${LONG[*]} " in
                *" $argument "*) STAGES+=("$argument") ;;
                *) ltmd_fail "unknown argument '$argument'; usage: tests/run.sh [--fast | --long] [${ALL[*]}]" || exit 2 ;;
            esac
            ;;
    esac
done
[ ${#STAGES[@]} -gt 0 ] || STAGES=("${ALL[@]}")

LOGS=$(mktemp -d)
trap 'rm -rf "$LOGS"' EXIT

stage_environment() {
    if [ -n "$FAST" ]; then
        return 0
    fi
    ltmd_system_packages && ltmd_venv_tools && ltmd_venv_blender 4.5 && ltmd_venv_blender 5.2 && ltmd_openexr
}

stage_cpp() {
    cmake --preset release "-DCMAKE_PREFIX_PATH=$LTMD_OPENEXR" && cmake --build --preset release
}

stage_ctest() { ctest --preset release --no-tests=error --timeout 300 -j 2; }

# The wheel is tested with NumPy 2 beside the judges; inside Blender's Python it must load too.
stage_wheel() {
    local version
    ltmd_wheel || return 1
    for version in "${LTMD_BLENDERS[@]}"; do
        "$LTMD_CACHE/venv-bpy$version/bin/python" -c 'import bpy, ltmd, numpy; print("ltmd", ltmd.__version__, "with bpy", bpy.app.version_string, "and NumPy", numpy.__version__)' || return 1
    done
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
    # Most of a Blender test is one thread that starts Blender: as many at a time as there are cores.
    local options=(-q -rfEs --durations=5 -p no:cacheprovider -m "$LEFT_OUT" -n "$(nproc)" --dist worksteal)
    timeout 1200 "$LTMD_TOOLS/bin/python" -m pytest "${options[@]}" "$@"
}

stage_python() { pytest_of tests/python; }
pytest_in() { ltmd_extension && LTMD_BLENDER=$1 pytest_of "$2"; }
stage_osl4.5() { pytest_in 4.5 tests/osl; }
stage_osl5.2() { pytest_in 5.2 tests/osl; }
stage_blender4.5() { pytest_in 4.5 tests/blender; }
stage_blender5.2() { pytest_in 5.2 tests/blender; }
stage_both() { ltmd_extension && pytest_of tests/both; }

stage_long() {
    [ ! -e tests/long.sh ] || bash tests/long.sh
}

stage_window() { ltmd_extension && bash tests/window/run.sh; }

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
for stage in ctest python osl4.5 osl5.2 blender4.5 blender5.2 both; do
    [ -e "$LOGS/$stage" ] || continue
    printf '%s: %s\n' "$stage" "$(grep -E 'tests? (passed|failed)|[0-9]+ (passed|failed|error|skipped|deselected).* in |no tests ran' "$LOGS/$stage" | tail -n 1)"
done
exit "$STATUS"
