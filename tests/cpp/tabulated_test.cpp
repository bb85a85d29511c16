// SPDX-License-Identifier: Apache-2.0
#include "ltmd/tabulated.h"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "ltmd/any_distribution.h"
#include "ltmd/errors.h"
#include "ltmd/ggx.h"

namespace {

using ltmd::Direction;
using ltmd::GGX;
using ltmd::Matrix2;
using ltmd::Slope;
using ltmd::Tabulated;
using ltmd::Uniform;

/// A distribution as a user writes it against the interface: a share of one GGX, the rest another.
template <class R>
class TwoLobes : public ltmd::SlopeDistribution<TwoLobes<R>, R> {
public:
    using Real = R;

    Real P22(const Slope<Real>& slope) const {
        return share * narrow.P22(slope) + (1 - share) * wide.P22(slope);
    }
    Real Lambda(const Direction<Real>& v) const {
        return share * narrow.Lambda(v) + (1 - share) * wide.Lambda(v);
    }
    Direction<Real> sample(const Uniform<Real>& u) const {
        return pick(share, u,
                    [](const GGX<Real>& lobe, const Uniform<Real>& w) { return lobe.sample(w); });
    }
    Direction<Real> sample_visible(const Direction<Real>& v, const Uniform<Real>& u) const {
        const Real p = share * narrow.projected_area(v) / this->projected_area(v);
        return pick(p, u, [&](const GGX<Real>& lobe, const Uniform<Real>& w) {
            return lobe.sample_visible(v, w);
        });
    }

    static constexpr Real share{0.7};
    GGX<Real> narrow{0.05}, wide{0.5};

private:
    template <class Sample>
    Direction<Real> pick(Real p, const Uniform<Real>& u, const Sample& sample) const {
        return u.x < p ? sample(narrow, {u.x / p, u.y}) : sample(wide, {(u.x - p) / (1 - p), u.y});
    }
};

static_assert(ltmd::MicrofacetDistribution<TwoLobes<float>>);
static_assert(ltmd::MicrofacetDistribution<Tabulated<float>>);
static_assert(ltmd::MicrofacetDistribution<ltmd::TransformedDistribution<TwoLobes<double>>>);

const Matrix2 shear = Matrix2{1, 0.4, -2, 1.5};
const std::vector<Direction<double>> directions = [] {
    std::vector<Direction<double>> all;
    for (double z : {1.0, 0.9, 0.5, 0.1, 0.01})
        for (double angle : {0.0, 1.0, 2.5, 4.0}) {
            const double across = std::sqrt(1 - z * z);
            all.push_back({across * std::cos(angle), across * std::sin(angle), z});
        }
    return all;
}();

/// The part of `count` visible samples of d that face the half-space of `side`.
template <class Distribution>
double share_on_side(const Distribution& d, const Direction<double>& v,
                     const Direction<double>& side, int count) {
    int found = 0;
    for (int i = 0; i < count; ++i) {
        // A rank-1 lattice of the golden ratio.
        const Uniform<double> u{(i + 0.5) / count, std::fmod(0.6180339887498949 * i, 1.0)};
        found += dot(d.sample_visible(v, u), side) > 0;
    }
    return static_cast<double>(found) / count;
}

TEST(UserDefinedDistribution, TransformsAsItsLobesDo) {
    const TwoLobes<double> base;
    const auto d = transformed(base, shear);
    const auto narrow = transformed(base.narrow, shear), wide = transformed(base.wide, shear);
    const double s = base.share;
    for (const auto& m : directions) {
        const double D = s * narrow.D(m) + (1 - s) * wide.D(m);
        const double area = s * narrow.projected_area(m) + (1 - s) * wide.projected_area(m);
        EXPECT_NEAR(d.D(m), D, 1e-12 * D);
        EXPECT_NEAR(d.projected_area(m), area, 1e-12 * area);
        EXPECT_NEAR(ltmd::AnyDistribution<double>(d).D(m), D, 1e-12 * D);
        EXPECT_NEAR(ltmd::AnyDistribution<double>(base).transformed(shear).G1(m), m.z / area,
                    1e-12);
    }
}

TEST(UserDefinedDistribution, ItsP22AloneGivesTheSame) {
    const TwoLobes<double> exact;
    const Tabulated<double> d([&](double r) { return 3 * exact.P22({r, 0}); });
    const auto d_M = transformed(d, shear);
    const auto exact_M = transformed(exact, shear);
    for (const auto& m : directions) {
        EXPECT_NEAR(d_M.D(m), exact_M.D(m), 1e-4 * exact_M.D(m));
        const double area = exact_M.projected_area(m);
        EXPECT_NEAR(d_M.projected_area(m), area, 1e-6 * area);
    }
    constexpr int count = 100'000;
    for (const Direction<double>& v : {Direction<double>{0.6, 0, 0.8}, {0.3, -0.9, 0.316}}) {
        for (const Direction<double>& side :
             {Direction<double>{1, 0, 0}, {0, 1, 0}, {1, 0, -0.2}, {-0.5, 1, -0.05}}) {
            // The lattice's error, as for any set of discrepancy O(log count / count).
            EXPECT_NEAR(share_on_side(d_M, normalized(v), side, count),
                        share_on_side(exact_M, normalized(v), side, count), 1e-3);
        }
    }
}

TEST(Tabulated, FloatAndDoubleShareOneTable) {
    const auto normals = std::make_shared<const ltmd::VisibleNormals>(
        ltmd::RadialTable(std::array{0.0, 0.5, 1.0}, std::array{1.0, 0.5, 0.0}));
    const Tabulated<float> single(normals);
    const Tabulated<double> full(normals);
    // 1 - r integrates to pi / 3.
    EXPECT_NEAR(full.P22({0.25, 0}), 0.75 * 3 * std::numbers::inv_pi, 1e-15);
    EXPECT_EQ(single.P22({0.25f, 0}), static_cast<float>(full.P22({0.25, 0})));
    EXPECT_EQ(full.P22({1.5, 0}), 0);
}

TEST(Tabulated, RefusesWhatIsNoDensity) {
    EXPECT_THROW(Tabulated<float>([](double r) { return 1 - r; }), ltmd::InvalidInput);
    EXPECT_THROW(Tabulated<float>([](double) { return 0.0; }), ltmd::InvalidInput);
    EXPECT_THROW(Tabulated<float>([](double) { return std::nan(""); }), ltmd::InvalidInput);
    EXPECT_THROW(Tabulated<float>(std::array{0.0, 1.0}, std::array{1.0, -1.0}), ltmd::InvalidInput);
}

}  // namespace
