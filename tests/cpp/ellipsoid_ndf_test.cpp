// SPDX-License-Identifier: Apache-2.0
#include "ltmd/ellipsoid_ndf.h"

#include <gtest/gtest.h>

#include "ltmd/any_distribution.h"
#include "ltmd/errors.h"
#include "ltmd/ggx.h"
#include "ltmd/non_centred_distribution.h"

namespace {

using ltmd::Direction;
using ltmd::Ellipsoid;
using ltmd::EllipsoidNDF;
using ltmd::GGX;
using ltmd::Matrix2;
using ltmd::Slope;
using ltmd::Uniform;

constexpr double eps = std::numeric_limits<double>::epsilon();
// Few roundings, at a condition of A and M of less than 100.
constexpr double close = 1e4 * eps;

const Ellipsoid::Matrix skewed{0.3, 0.1, 0.2, -0.2, 0.5, 0.1, 0.1, -0.3, 1.1};
const Matrix2 shear{1, 0.3, -2, 1.5};

/// Directions of many slopes above the horizon.
std::vector<Direction<double>> directions() {
    std::vector<Direction<double>> all;
    for (const double z : {1.0, 0.9, 0.5, 0.1, 1e-3, 1e-7})
        for (int i = 0; i < 7; ++i) {
            const double r = std::sqrt(1 - z * z);
            all.push_back({r * std::cos(i * 0.9), r * std::sin(i * 0.9), z});
        }
    return all;
}

std::vector<Uniform<double>> square() {
    std::vector<Uniform<double>> all;
    for (const double x : {0.0, 0.2, 0.5, 0.77, 1.0})
        for (const double y : {0.0, 0.31, 0.5, 0.9, 1.0}) all.push_back({x, y});
    return all;
}

template <class A, class B>
void expect_same(const A& a, const B& b, bool with_samples) {
    for (const Direction<double>& v : directions()) {
        EXPECT_NEAR(a.D(v), b.D(v), close * b.D(v));
        EXPECT_NEAR(a.Lambda(v), b.Lambda(v), close * (1 + b.Lambda(v)));
        // Far below the mesosurface the facing area is a small difference.
        EXPECT_NEAR(a.projected_area(v), b.projected_area(v), close);
        if (!with_samples) continue;
        for (const Uniform<double>& u : square()) {
            const auto m = a.sample_visible(v, u), n = b.sample_visible(v, u);
            EXPECT_NEAR(length(Direction<double>{m.x - n.x, m.y - n.y, m.z - n.z}), 0, 1e-7);
        }
    }
}

TEST(EllipsoidNdf, IsADistributionLikeAllOthers) {
    static_assert(ltmd::MicrofacetDistribution<EllipsoidNDF<float>>);
    static_assert(
        ltmd::MicrofacetDistribution<ltmd::TransformedDistribution<EllipsoidNDF<double>>>);
    static_assert(std::same_as<decltype(transformed(EllipsoidNDF<float>(skewed), Matrix2{})),
                               EllipsoidNDF<float>>);
    static_assert(
        std::same_as<decltype(sheared(EllipsoidNDF<float>(skewed), {})), EllipsoidNDF<float>>);
}

TEST(EllipsoidNdf, OfADiagonalMatrixIsGgx) {
    expect_same(EllipsoidNDF<double>::from_angles(0.3, 0.05, 0, 0, 0), GGX<double>(0.3, 0.05),
                false);
}

TEST(EllipsoidNdf, UnderAMapStaysAnEllipsoid) {
    const EllipsoidNDF<double> base(skewed);
    expect_same(transformed(base, shear),
                ltmd::TransformedDistribution<EllipsoidNDF<double>>(base, shear), false);
    // The same at run time, behind one type.
    expect_same(ltmd::AnyDistribution<double>(base).transformed(shear), transformed(base, shear),
                true);
}

TEST(EllipsoidNdf, IsANonCentredGgxOverSlopes) {
    const Ellipsoid ellipsoid(skewed);
    expect_same(EllipsoidNDF<double>(ellipsoid),
                sheared(transformed(GGX<double>(1), inverse(ellipsoid.slope_matrix())),
                        ellipsoid.mean_slope()),
                false);
}

TEST(EllipsoidNdf, IsTheSameForAScaledTurnedOrMirroredMatrix) {
    const EllipsoidNDF<double> base(skewed);
    Ellipsoid::Matrix scaled = skewed, turned = skewed, mirrored = skewed;
    for (std::size_t i = 0; i < 3; ++i) {
        for (std::size_t j = 0; j < 3; ++j) scaled[3 * i + j] *= -1e20;
        turned[i] = 0.6 * skewed[i] - 0.8 * skewed[6 + i];
        turned[6 + i] = 0.8 * skewed[i] + 0.6 * skewed[6 + i];
        std::swap(mirrored[i], mirrored[3 + i]);
    }
    for (const auto& same : {scaled, turned, mirrored})
        expect_same(EllipsoidNDF<double>(same), base, true);
}

template <class Real>
void expect_normals_above_horizon(double largest_slope) {
    const auto u0 = square();
    for (const double alpha_x : {1e-5, 1e-3, 0.3, 30.0})
        for (const double alpha_y : {1e-4, 0.1, 10.0})
            for (const double tilt : {0.0, 0.3, -1.5})
                for (const Direction<double>& d : directions()) {
                    const auto e =
                        EllipsoidNDF<Real>(Ellipsoid::from_angles(alpha_x, alpha_y, 0, 0, 0.4)
                                               .sheared({tilt * largest_slope, largest_slope}));
                    const Direction<Real> v{static_cast<Real>(d.x), static_cast<Real>(d.y),
                                            static_cast<Real>(d.z)};
                    EXPECT_GE(e.Lambda(v), 0);
                    EXPECT_GT(e.projected_area(v), 0);
                    EXPECT_GE(e.G1(v), 0);
                    EXPECT_LE(e.G1(v), 1);
                    for (const Uniform<double>& w : u0) {
                        const Uniform<Real> u{static_cast<Real>(w.x), static_cast<Real>(w.y)};
                        for (const Direction<Real>& m : {e.sample(u), e.sample_visible(v, u)}) {
                            ASSERT_GE(m.z, 0);
                            ASSERT_NEAR(length(m), 1, 8 * std::numeric_limits<Real>::epsilon());
                        }
                    }
                }
}

TEST(EllipsoidNdf, HasNoNormalBelowTheHorizonAndNothingNotANumber) {
    for (const double largest_slope : {0.0, 0.5, 3.0}) {
        expect_normals_above_horizon<float>(largest_slope);
        expect_normals_above_horizon<double>(largest_slope);
    }
}

TEST(EllipsoidNdf, RefusesWhatIsNoEllipsoid) {
    const double nan = std::nan("");
    for (const Ellipsoid::Matrix& a : {Ellipsoid::Matrix{},
                                       {1, 2, 3, 2, 4, 6, 0, 0, 1},
                                       {nan, 0, 0, 0, 1, 0, 0, 0, 1},
                                       {1, 0, 0, 0, 1, 0, 0, 0, 1e-8},
                                       {1e300, 0, 0, 0, 1e300, 0, 0, 0, 1e300}})
        EXPECT_THROW(EllipsoidNDF<float>{a}, ltmd::InvalidInput);
    try {
        Ellipsoid({1, 0, 0, 0, 2, 0, 0, 0, 1e-8});
        FAIL();
    } catch (const ltmd::InvalidInput& error) {
        EXPECT_STREQ(error.what(),
                     "A is ((1, 0, 0), (0, 2, 0), (0, 0, 1e-08)) with condition 2.23607e+08; it "
                     "must be invertible, with a condition of at most 1e+07");
    }
    EXPECT_THROW(Ellipsoid::from_angles(1e-7, 1, 0, 0, 0), ltmd::InvalidInput);
    EXPECT_THROW(Ellipsoid::from_angles(1, 2e6, 0, 0, 0), ltmd::InvalidInput);
    EXPECT_THROW(Ellipsoid::from_angles(1, 1, 0, nan, 0), ltmd::InvalidInput);
    EXPECT_THROW(Ellipsoid::from_sggx({1, 0.1, 0, 0, 1, 0, 0, 0, 1}), ltmd::InvalidInput);
    EXPECT_THROW(Ellipsoid::from_sggx({1, 2, 0, 2, 1, 0, 0, 0, 1}), ltmd::InvalidInput);
    EXPECT_THROW(Ellipsoid(skewed).transformed({1, 2, 2, 4}), ltmd::InvalidInput);
}

}  // namespace
