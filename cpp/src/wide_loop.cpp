// SPDX-License-Identifier: Apache-2.0
#include "ltmd/wide_loop.h"

namespace ltmd::inline v0 {

VectorWidth vector_width() {
#if defined(__x86_64__) && defined(__GNUC__)
    static const VectorWidth width = [] {
        __builtin_cpu_init();
        if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512bw") &&
            __builtin_cpu_supports("avx512cd") && __builtin_cpu_supports("avx512dq") &&
            __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("fma") &&
            __builtin_cpu_supports("bmi2"))
            return VectorWidth::avx512;
        return __builtin_cpu_supports("avx2") ? VectorWidth::avx2 : VectorWidth::baseline;
    }();
    return width;
#else
    return VectorWidth::baseline;
#endif
}

}  // namespace ltmd::inline v0
