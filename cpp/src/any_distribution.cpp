// SPDX-License-Identifier: Apache-2.0
#include "ltmd/any_distribution.h"

#include <string>

#include "ltmd/errors.h"
#include "parallel.h"

namespace ltmd::inline v0 {
namespace {

constexpr std::size_t grain = 1 << 12;

void require_length(std::size_t given, std::size_t expected) {
    if (given != expected)
        throw InvalidInput("arrays of " + std::to_string(given) + " and " +
                           std::to_string(expected) + " items; they must have one length");
}

/// function(pointers to a piece of each array, its length) over pieces, on threads.
template <class Function, class Out, class... Items>
void for_pieces(const Function& function, std::span<Out> out, const Items&... items) {
    (require_length(items.size(), out.size()), ...);
    parallel_for(out.size(), grain, [&](std::size_t begin, std::size_t end) {
        function((items.data() + begin)..., out.data() + begin, end - begin);
    });
}

}  // namespace

template <std::floating_point R>
void AnyDistribution<R>::P22(std::span<const Slope<R>> slope, std::span<R> out) const {
    for_pieces([&](auto... piece) { model_->P22(piece...); }, out, slope);
}
template <std::floating_point R>
void AnyDistribution<R>::D(std::span<const Direction<R>> m, std::span<R> out) const {
    for_pieces([&](auto... piece) { model_->D(piece...); }, out, m);
}
template <std::floating_point R>
void AnyDistribution<R>::Lambda(std::span<const Direction<R>> v, std::span<R> out) const {
    for_pieces([&](auto... piece) { model_->Lambda(piece...); }, out, v);
}
template <std::floating_point R>
void AnyDistribution<R>::G1(std::span<const Direction<R>> v, std::span<R> out) const {
    for_pieces([&](auto... piece) { model_->G1(piece...); }, out, v);
}
template <std::floating_point R>
void AnyDistribution<R>::projected_area(std::span<const Direction<R>> v, std::span<R> out) const {
    for_pieces([&](auto... piece) { model_->projected_area(piece...); }, out, v);
}
template <std::floating_point R>
void AnyDistribution<R>::sample(std::span<const Uniform<R>> u, std::span<Direction<R>> out) const {
    for_pieces([&](auto... piece) { model_->sample(piece...); }, out, u);
}
template <std::floating_point R>
void AnyDistribution<R>::pdf(std::span<const Direction<R>> m, std::span<R> out) const {
    for_pieces([&](auto... piece) { model_->pdf(piece...); }, out, m);
}
template <std::floating_point R>
void AnyDistribution<R>::sample_visible(std::span<const Direction<R>> v,
                                        std::span<const Uniform<R>> u,
                                        std::span<Direction<R>> out) const {
    for_pieces([&](auto... piece) { model_->sample_visible(piece...); }, out, v, u);
}
template <std::floating_point R>
void AnyDistribution<R>::pdf_visible(std::span<const Direction<R>> v,
                                     std::span<const Direction<R>> m, std::span<R> out) const {
    for_pieces([&](auto... piece) { model_->pdf_visible(piece...); }, out, v, m);
}

template class AnyDistribution<float>;
template class AnyDistribution<double>;

}  // namespace ltmd::inline v0
