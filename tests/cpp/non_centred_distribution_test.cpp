// SPDX-License-Identifier: Apache-2.0
#include "ltmd/non_centred_distribution.h"

#include <gtest/gtest.h>

#include "ltmd/any_distribution.h"
#include "ltmd/errors.h"
#include "ltmd/ggx.h"

namespace {

using ltmd::AnyDistribution;
using ltmd::Direction;
using ltmd::GGX;
using ltmd::Matrix2;
using ltmd::NonCentredDistribution;
using ltmd::Slope;
using ltmd::TransformedDistribution;
using ltmd::Uniform;

constexpr double eps = std::numeric_limits<double>::epsilon();
const Matrix2 shear{1, 0.3, -2, 1.5};

template <class Real>
std::vector<Direction<Real>> directions() {
    std::vector<Direction<Real>> all;
    for (const double z : {1.0, 0.8, 0.3, 1e-4})
        for (int i = 0; i < 7; ++i) {
            const double r = std::sqrt(1 - z * z);
            all.push_back({static_cast<Real>(r * std::cos(i * 0.9)),
                           static_cast<Real>(r * std::sin(i * 0.9)), static_cast<Real>(z)});
        }
    return all;
}

TEST(NonCentredDistribution, JoinsWithOtherShearsAndMaps) {
    using Base = GGX<float>;
    static_assert(ltmd::MicrofacetDistribution<NonCentredDistribution<Base>>);
    const auto once = sheared(Base(0.2), {0.3, 0.1});
    static_assert(std::same_as<decltype(sheared(once, {0.1, 0.1})), NonCentredDistribution<Base>>);
    static_assert(std::same_as<decltype(transformed(transformed(once, shear), shear)),
                               NonCentredDistribution<TransformedDistribution<Base>>>);
    EXPECT_DOUBLE_EQ(sheared(once, {0.1, -0.4}).offset().x, 0.4);
    EXPECT_DOUBLE_EQ(sheared(once, {0.1, -0.4}).offset().y, -0.3);
}

// A shear, then M is M, then a shear by M^-T of the slopes.
TEST(NonCentredDistribution, CombinesWithAMapInEitherOrder) {
    const GGX<double> base(0.4, 0.2);
    const Slope<double> s{0.3, -0.7};
    const Matrix2 i = inverse(shear);
    const Slope<double> turned{i.xx * s.x + i.yx * s.y, i.xy * s.x + i.yy * s.y};
    const TransformedDistribution<NonCentredDistribution<GGX<double>>> plain(sheared(base, s),
                                                                             shear);
    for (const auto& d : {AnyDistribution<double>(transformed(sheared(base, s), shear)),
                          AnyDistribution<double>(sheared(base, s)).transformed(shear),
                          AnyDistribution<double>(sheared(transformed(base, shear), turned)),
                          AnyDistribution<double>(
                              sheared(AnyDistribution<double>(base).transformed(shear), turned))})
        for (const Direction<double>& v : directions<double>()) {
            EXPECT_NEAR(d.D(v), plain.D(v), 1000 * eps * plain.D(v));
            EXPECT_NEAR(d.Lambda(v), plain.Lambda(v), 1000 * eps * (1 + plain.Lambda(v)) / v.z);
            EXPECT_NEAR(d.projected_area(v), plain.projected_area(v), 1000 * eps);
            const auto m = d.sample({0.3, 0.6}), n = plain.sample({0.3, 0.6});
            EXPECT_NEAR(dot(m, n), 1, 1000 * eps);
        }
}

template <class Real>
void expect_normals_that_face(double alpha, const Slope<double>& offset) {
    const auto d = sheared(GGX<Real>(alpha), offset);
    for (const Direction<Real>& v : directions<Real>()) {
        ASSERT_GE(d.Lambda(v), 0);
        ASSERT_GT(d.projected_area(v), 0);
        for (int i = 1; i < 10; ++i)
            for (int j = 1; j < 10; ++j) {
                const Direction<Real> m =
                    d.sample_visible(v, {static_cast<Real>(i) / 10, static_cast<Real>(j) / 10});
                ASSERT_GE(m.z, 0);
                ASSERT_NEAR(length(m), 1, 8 * std::numeric_limits<Real>::epsilon());
                ASSERT_GE(dot(v, m), -1e3 * std::numeric_limits<Real>::epsilon());
            }
    }
}

// Where the mesosurface faces away as well.
TEST(NonCentredDistribution, ShowsOnlyNormalsThatFaceTheView) {
    for (const Slope<double>& offset : {Slope<double>{0, 0}, {0.4, -0.2}, {-2, 1}}) {
        expect_normals_that_face<float>(0.3, offset);
        expect_normals_that_face<double>(0.3, offset);
        // Next to nothing faces some of the views.
        expect_normals_that_face<float>(1e-3, offset);
        expect_normals_that_face<double>(1e-3, offset);
    }
}

TEST(NonCentredDistribution, RefusesWhatIsOutOfRange) {
    for (const double slope : {2e6, -2e6, std::nan("")}) {
        EXPECT_THROW(sheared(GGX<float>(0.1), {slope, 0}), ltmd::InvalidInput);
        EXPECT_THROW(sheared(GGX<float>(0.1), {0, slope}), ltmd::InvalidInput);
    }
    EXPECT_THROW(transformed(sheared(GGX<float>(0.1), {0, 0}), Matrix2{1, 2, 2, 4}),
                 ltmd::InvalidInput);
}

TEST(CorrelatedStretch, RefusesWhatIsOutOfRange) {
    for (const double r : {1.0, -1.0, std::nan("")})
        EXPECT_THROW(ltmd::correlated_stretch(0.1, 0.2, r), ltmd::InvalidInput);
    EXPECT_THROW(ltmd::correlated_stretch(0, 0.2, 0), ltmd::InvalidInput);
    EXPECT_THROW(ltmd::correlated_stretch(0.1, 1e7, 0), ltmd::InvalidInput);
}

}  // namespace
