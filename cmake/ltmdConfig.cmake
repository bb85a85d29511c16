# SPDX-License-Identifier: Apache-2.0
# OpenEXR stays inside the library: its users need nothing but these targets.
include(${CMAKE_CURRENT_LIST_DIR}/ltmdTargets.cmake)
