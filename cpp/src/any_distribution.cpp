// SPDX-License-Identifier: Apache-2.0
#include "ltmd/any_distribution.h"

#include "for_items.h"

namespace ltmd::inline v0 {
template <std::floating_point R>
void AnyDistribution<R>::P22(std::span<const Slope<R>> slope, std::span<R> out) const {
    for_pieces(out, [&](auto... piece) { model_->P22(piece...); }, slope);
}
template <std::floating_point R>
void AnyDistribution<R>::D(std::span<const Direction<R>> m, std::span<R> out) const {
    for_pieces(out, [&](auto... piece) { model_->D(piece...); }, m);
}
template <std::floating_point R>
void AnyDistribution<R>::Lambda(std::span<const Direction<R>> v, std::span<R> out) const {
    for_pieces(out, [&](auto... piece) { model_->Lambda(piece...); }, v);
}
template <std::floating_point R>
void AnyDistribution<R>::G1(std::span<const Direction<R>> v, std::span<R> out) const {
    for_pieces(out, [&](auto... piece) { model_->G1(piece...); }, v);
}
template <std::floating_point R>
void AnyDistribution<R>::projected_area(std::span<const Direction<R>> v, std::span<R> out) const {
    for_pieces(out, [&](auto... piece) { model_->projected_area(piece...); }, v);
}
template <std::floating_point R>
void AnyDistribution<R>::sample(std::span<const Uniform<R>> u, std::span<Direction<R>> out) const {
    for_pieces(out, [&](auto... piece) { model_->sample(piece...); }, u);
}
template <std::floating_point R>
void AnyDistribution<R>::pdf(std::span<const Direction<R>> m, std::span<R> out) const {
    for_pieces(out, [&](auto... piece) { model_->pdf(piece...); }, m);
}
template <std::floating_point R>
void AnyDistribution<R>::sample_visible(std::span<const Direction<R>> v,
                                        std::span<const Uniform<R>> u,
                                        std::span<Direction<R>> out) const {
    for_pieces(out, [&](auto... piece) { model_->sample_visible(piece...); }, v, u);
}
template <std::floating_point R>
void AnyDistribution<R>::pdf_visible(std::span<const Direction<R>> v,
                                     std::span<const Direction<R>> m, std::span<R> out) const {
    for_pieces(out, [&](auto... piece) { model_->pdf_visible(piece...); }, v, m);
}

template class AnyDistribution<float>;
template class AnyDistribution<double>;

}  // namespace ltmd::inline v0
