// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <span>
#include <utility>

#include "ltmd/export.h"
#include "ltmd/transformed_distribution.h"
#include "ltmd/wide_loop.h"

namespace ltmd::inline v0 {

/// Any distribution behind one type, chosen at run time; copies share it. Itself a distribution,
/// and evaluates arrays on thread_count() threads with one virtual call for many items.
template <std::floating_point R>
class AnyDistribution : public SlopeDistribution<AnyDistribution<R>, R> {
public:
    using Real = R;

    template <MicrofacetDistribution Distribution>
        requires std::same_as<typename Distribution::Real, R> &&
                 (!std::same_as<Distribution, AnyDistribution>)
    explicit AnyDistribution(Distribution distribution);

    Real P22(const Slope<Real>& slope) const { return one<Real>(&Interface::P22, slope); }
    Real D(const Direction<Real>& m) const { return one<Real>(&Interface::D, m); }
    Real Lambda(const Direction<Real>& v) const { return one<Real>(&Interface::Lambda, v); }
    Real projected_area(const Direction<Real>& v) const {
        return one<Real>(&Interface::projected_area, v);
    }
    Direction<Real> sample(const Uniform<Real>& u) const {
        return one<Direction<Real>>(&Interface::sample, u);
    }
    Direction<Real> sample_visible(const Direction<Real>& v, const Uniform<Real>& u) const {
        return one<Direction<Real>>(&Interface::sample_visible, v, u);
    }

    // The same for arrays: out[i] of item i. Throws InvalidInput unless all have one length.
    LTMD_API void P22(std::span<const Slope<Real>> slope, std::span<Real> out) const;
    LTMD_API void D(std::span<const Direction<Real>> m, std::span<Real> out) const;
    LTMD_API void Lambda(std::span<const Direction<Real>> v, std::span<Real> out) const;
    LTMD_API void G1(std::span<const Direction<Real>> v, std::span<Real> out) const;
    LTMD_API void projected_area(std::span<const Direction<Real>> v, std::span<Real> out) const;
    LTMD_API void sample(std::span<const Uniform<Real>> u, std::span<Direction<Real>> out) const;
    LTMD_API void pdf(std::span<const Direction<Real>> m, std::span<Real> out) const;
    LTMD_API void sample_visible(std::span<const Direction<Real>> v,
                                 std::span<const Uniform<Real>> u,
                                 std::span<Direction<Real>> out) const;
    LTMD_API void pdf_visible(std::span<const Direction<Real>> v,
                              std::span<const Direction<Real>> m, std::span<Real> out) const;
    // For one item.
    using SlopeDistribution<AnyDistribution, R>::G1;
    using SlopeDistribution<AnyDistribution, R>::pdf;
    using SlopeDistribution<AnyDistribution, R>::pdf_visible;

    /// This distribution under M; throws as TransformedDistribution.
    AnyDistribution transformed(const Matrix2& m) const { return model_->transformed(m); }

private:
    struct Interface {
        virtual ~Interface() = default;
        virtual void P22(const Slope<Real>* slope, Real* out, std::size_t n) const = 0;
        virtual void D(const Direction<Real>* m, Real* out, std::size_t n) const = 0;
        virtual void Lambda(const Direction<Real>* v, Real* out, std::size_t n) const = 0;
        virtual void G1(const Direction<Real>* v, Real* out, std::size_t n) const = 0;
        virtual void projected_area(const Direction<Real>* v, Real* out, std::size_t n) const = 0;
        virtual void sample(const Uniform<Real>* u, Direction<Real>* out, std::size_t n) const = 0;
        virtual void pdf(const Direction<Real>* m, Real* out, std::size_t n) const = 0;
        virtual void sample_visible(const Direction<Real>* v, const Uniform<Real>* u,
                                    Direction<Real>* out, std::size_t n) const = 0;
        virtual void pdf_visible(const Direction<Real>* v, const Direction<Real>* m, Real* out,
                                 std::size_t n) const = 0;
        virtual AnyDistribution transformed(const Matrix2& m) const = 0;
    };

    template <class Distribution>
    struct Model final : Interface {
        explicit Model(Distribution d) : distribution(std::move(d)) {}
        void P22(const Slope<Real>* slope, Real* out, std::size_t n) const override {
            each<normals_vectorize<Distribution>>(
                [](const Distribution& d, const auto&... item) { return d.P22(item...); }, n, out,
                slope);
        }
        void D(const Direction<Real>* m, Real* out, std::size_t n) const override {
            each<normals_vectorize<Distribution>>(
                [](const Distribution& d, const auto&... item) { return d.D(item...); }, n, out, m);
        }
        void Lambda(const Direction<Real>* v, Real* out, std::size_t n) const override {
            each<views_vectorize<Distribution>>(
                [](const Distribution& d, const auto&... item) { return d.Lambda(item...); }, n,
                out, v);
        }
        void G1(const Direction<Real>* v, Real* out, std::size_t n) const override {
            each<views_vectorize<Distribution>>(
                [](const Distribution& d, const auto&... item) { return d.G1(item...); }, n, out,
                v);
        }
        void projected_area(const Direction<Real>* v, Real* out, std::size_t n) const override {
            each<views_vectorize<Distribution>>(
                [](const Distribution& d, const auto&... item) {
                    return d.projected_area(item...);
                },
                n, out, v);
        }
        void sample(const Uniform<Real>* u, Direction<Real>* out, std::size_t n) const override {
            each<normals_vectorize<Distribution>>(
                [](const Distribution& d, const auto&... item) { return d.sample(item...); }, n,
                out, u);
        }
        void pdf(const Direction<Real>* m, Real* out, std::size_t n) const override {
            each<normals_vectorize<Distribution>>(
                [](const Distribution& d, const auto&... item) { return d.pdf(item...); }, n, out,
                m);
        }
        void sample_visible(const Direction<Real>* v, const Uniform<Real>* u, Direction<Real>* out,
                            std::size_t n) const override {
            each<views_vectorize<Distribution>>(
                [](const Distribution& d, const auto&... item) {
                    return d.sample_visible(item...);
                },
                n, out, v, u);
        }
        void pdf_visible(const Direction<Real>* v, const Direction<Real>* m, Real* out,
                         std::size_t n) const override {
            each<views_vectorize<Distribution>>(
                [](const Distribution& d, const auto&... item) { return d.pdf_visible(item...); },
                n, out, v, m);
        }
        AnyDistribution transformed(const Matrix2& m) const override {
            using ltmd::transformed;  // beside a distribution's own
            return AnyDistribution(transformed(distribution, m));
        }
        /// out[i] = function(distribution, in[i]...).
        template <bool in_vectors, class Function, class Out, class... In>
        void each(const Function& function, std::size_t n, Out* out, const In*... in) const {
            if constexpr (in_vectors) {
                wide_loop([function,
                           d = distribution](const In&... item) { return function(d, item...); },
                          n, out, in...);
            } else {
                for (std::size_t i = 0; i < n; ++i) out[i] = function(distribution, in[i]...);
            }
        }

        Distribution distribution;
    };

    template <class Result, class Function, class... Items>
    Result one(Function function, const Items&... items) const {
        Result result;
        (model_.get()->*function)(&items..., &result, 1);
        return result;
    }

    std::shared_ptr<const Interface> model_;
};

// Not in the class, where it would be inline: the library has it compiled for its own
// distributions.
template <std::floating_point R>
template <MicrofacetDistribution Distribution>
    requires std::same_as<typename Distribution::Real, R> &&
             (!std::same_as<Distribution, AnyDistribution<R>>)
AnyDistribution<R>::AnyDistribution(Distribution distribution)
    : model_(std::make_shared<Model<Distribution>>(std::move(distribution))) {}

extern template class AnyDistribution<float>;
extern template class AnyDistribution<double>;

}  // namespace ltmd::inline v0
