// SPDX-License-Identifier: Apache-2.0
#pragma once

// The one place where the version is written: CMake, the wheel and the extension read these lines.
#define LTMD_VERSION_MAJOR 0
#define LTMD_VERSION_MINOR 1
#define LTMD_VERSION_PATCH 0
