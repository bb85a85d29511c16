// SPDX-License-Identifier: Apache-2.0
#pragma once

/// Marks the functions and classes that the library exports; everything else is hidden.
#if defined(LTMD_STATIC)
#define LTMD_API
#elif defined(_WIN32)
#if defined(LTMD_BUILDING)
#define LTMD_API __declspec(dllexport)
#else
#define LTMD_API __declspec(dllimport)
#endif
#else
#define LTMD_API __attribute__((visibility("default")))
#endif
