#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# openexr.sh PREFIX: builds a static OpenEXR with hidden symbols, with the Imath that its release names, and
# installs both in PREFIX.
set -euo pipefail
mkdir -p "$1"
prefix=$(cd "$1" && pwd)
python=$(command -v python3 || command -v python)
version=3.5.3
sha256=5645cc5493802832860a715ceb621139b44ee867084cec1501a2b8685e40d88a

[ ! -e "$prefix/.complete-$version" ] || exit 0
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$python" -m pip download --no-deps --no-binary OpenEXR -d "$work" "OpenEXR==$version"
"$python" - "$work/openexr-$version.tar.gz" "$sha256" "$work" <<'PYTHON'
import hashlib, sys, tarfile

archive, expected, folder = sys.argv[1:]
found = hashlib.sha256(open(archive, "rb").read()).hexdigest()
if found != expected:
    sys.exit(f"{archive} has the checksum {found}, not {expected}")
tarfile.open(archive).extractall(folder, filter="data")
PYTHON
cmake -S "$work/openexr-$version" -B "$work/build" -DCMAKE_BUILD_TYPE=Release "-DCMAKE_INSTALL_PREFIX=$prefix" \
    -DCMAKE_INSTALL_LIBDIR=lib -DBUILD_SHARED_LIBS=OFF -DCMAKE_POSITION_INDEPENDENT_CODE=ON \
    -DCMAKE_C_VISIBILITY_PRESET=hidden -DCMAKE_CXX_VISIBILITY_PRESET=hidden -DCMAKE_VISIBILITY_INLINES_HIDDEN=ON \
    -DOPENEXR_FORCE_INTERNAL_IMATH=ON -DOPENEXR_FORCE_INTERNAL_DEFLATE=ON -DBUILD_TESTING=OFF \
    -DOPENEXR_BUILD_TOOLS=OFF -DOPENEXR_INSTALL_TOOLS=OFF -DOPENEXR_BUILD_EXAMPLES=OFF -DOPENEXR_INSTALL_DOCS=OFF
cmake --build "$work/build" --config Release --target install --parallel
touch "$prefix/.complete-$version"
