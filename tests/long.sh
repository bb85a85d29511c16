#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# Builds the library with each sanitizer, beside the ordinary build, and runs the C++ tests under it, the
# command's tests too under AddressSanitizer.
#   tests/long.sh [asan] [tsan] [ubsan]     (default: all three)
# tests/run.sh --long runs this as its stage long, after everything else, the tests marked slow included.
set -uo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.." || exit 1
# shellcheck source=tests/environment.sh
. tests/environment.sh

for argument in "$@"; do
    case "$argument" in
        asan | tsan | ubsan) ;;
        *) ltmd_fail "unknown argument '$argument'; usage: tests/long.sh [asan] [tsan] [ubsan]" || exit 2 ;;
    esac
done
[ $# -gt 0 ] || set -- asan tsan ubsan
ltmd_system_packages && ltmd_venv_tools && ltmd_openexr || exit 1

# ThreadSanitizer reports false races where it does not see a library's locks: OpenEXR is built with it, too.
tsan_openexr() {
    LTMD_OPENEXR=$LTMD_CACHE/openexr-tsan CFLAGS="-fsanitize=thread -g1" CXXFLAGS="-fsanitize=thread -g1" \
        LDFLAGS=-fsanitize=thread ltmd_openexr
}

run_sanitizer() {
    local openexr=$LTMD_OPENEXR
    [ "$1" != tsan ] || { tsan_openexr && openexr=$LTMD_CACHE/openexr-tsan; } || return 1
    cmake --preset "$1" "-DCMAKE_PREFIX_PATH=$openexr" >/dev/null && cmake --build --preset "$1" &&
        ctest --preset "$1" --no-tests=error --timeout 600 -j 2 || return 1
    [ "$1" = asan ] || return 0
    ltmd_wheel || return 1
    LTMD_COMMAND=$LTMD_ROOT/build/asan/ltmd timeout 1200 "$LTMD_TOOLS/bin/python" -m pytest -q -rfEs \
        -p no:cacheprovider tests/python/test_command.py
}

STATUS=0
RESULTS=()
for preset in "$@"; do
    printf '\n===== %s\n' "$preset"
    if run_sanitizer "$preset"; then RESULTS+=("$preset passed"); else RESULTS+=("$preset FAILED") && STATUS=1; fi
done
printf '%s\n' "${RESULTS[@]}"
exit "$STATUS"
