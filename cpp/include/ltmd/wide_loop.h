// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <cstddef>
#include <tuple>
#include <utility>

#include "ltmd/direction.h"
#include "ltmd/export.h"

/// Loops over arrays of directions and the like in the widest vectors that the machine has.
/// Nothing is contracted or reordered, so all widths, and one item alone, give the same bits.
namespace ltmd::inline v0 {

/// How wide the loops are.
enum class VectorWidth { baseline, avx2, avx512 };

/// That of this machine.
LTMD_API VectorWidth vector_width();

namespace detail {

// What the body calls is compiled into it, for each width anew.
#if defined(__x86_64__) && defined(__GNUC__) && !defined(__clang__)
template <class Body>
__attribute__((noinline, flatten, target("avx2"))) void run_avx2(const Body& body) {
    body();
}
template <class Body>
__attribute__((noinline, flatten, target("arch=x86-64-v4"))) void run_avx512(const Body& body) {
    body();
}
template <class Body>
__attribute__((noinline, flatten)) void run_baseline(const Body& body) {
    body();
}
template <class Body>
void run_wide(const Body& body) {
    switch (vector_width()) {
        case VectorWidth::avx512:
            return run_avx512(body);
        case VectorWidth::avx2:
            return run_avx2(body);
        case VectorWidth::baseline:
            break;
    }
    run_baseline(body);
}
#else
template <class Body>
void run_wide(const Body& body) {
    body();
}
#endif

inline constexpr std::size_t block_size = 64;

/// Items of two or three numbers, coordinate by coordinate.
template <class Item>
struct Block;
template <std::floating_point Real>
struct Block<Real> {
    alignas(64) Real x[block_size];

    void store(std::size_t i, Real v) { x[i] = v; }
    Real item(std::size_t i) const { return x[i]; }
};
template <template <class> class Item, std::floating_point Real>
    requires(sizeof(Item<Real>) == 2 * sizeof(Real))
struct Block<Item<Real>> {
    alignas(64) Real x[block_size];
    alignas(64) Real y[block_size];

    void store(std::size_t i, const Item<Real>& v) { x[i] = v.x, y[i] = v.y; }
    Item<Real> item(std::size_t i) const { return {x[i], y[i]}; }
};
template <template <class> class Item, std::floating_point Real>
    requires(sizeof(Item<Real>) == 3 * sizeof(Real))
struct Block<Item<Real>> {
    alignas(64) Real x[block_size];
    alignas(64) Real y[block_size];
    alignas(64) Real z[block_size];

    void store(std::size_t i, const Item<Real>& v) { x[i] = v.x, y[i] = v.y, z[i] = v.z; }
    Item<Real> item(std::size_t i) const { return {x[i], y[i], z[i]}; }
};

}  // namespace detail

/// out[i] = function(in[i]...) for n items. The function should be free of branches and of calls
/// that cannot be compiled into it.
template <class Function, class Out, class... In>
void wide_loop(const Function& function, std::size_t n, Out* out, const In*... in) {
    if (n == 1) {
        *out = function(*in...);
        return;
    }
    detail::run_wide([=] {
        detail::Block<Out> result;
        std::tuple<detail::Block<In>...> blocks;
        for (std::size_t first = 0; first < n; first += detail::block_size) {
            const std::size_t count = std::min(detail::block_size, n - first);
            std::apply(
                [&](auto&... block) {
                    const auto load = [&](auto& to, const auto* from) {
                        for (std::size_t i = 0; i < count; ++i) to.store(i, from[first + i]);
                    };
                    (load(block, in), ...);
                    for (std::size_t i = 0; i < count; ++i)
                        result.store(i, function(block.item(i)...));
                    for (std::size_t i = 0; i < count; ++i) out[first + i] = result.item(i);
                },
                blocks);
        }
    });
}

}  // namespace ltmd::inline v0
