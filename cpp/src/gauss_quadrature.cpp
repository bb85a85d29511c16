// SPDX-License-Identifier: Apache-2.0
#include "gauss_quadrature.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace ltmd::inline v0 {
namespace {

/// The orthonormal polynomials p_k of a measure: b_{k+1} p_{k+1} = (x - a_k) p_k - b_k p_{k-1}.
struct Recurrence {
    double mass;
    std::vector<double> a, b;  // b[k] belongs to p_{k+1}
};

/// The eigenvalues of the symmetric tridiagonal matrix (diagonal a, beside it b), by QL with
/// implicit shifts.
std::vector<double> eigenvalues(std::vector<double> a, std::vector<double> b) {
    const int n = static_cast<int>(a.size());
    b.resize(a.size());
    b.back() = 0;
    const auto at = [](std::vector<double>& v, int i) -> double& {
        return v[static_cast<std::size_t>(i)];
    };
    for (int first = 0; first < n; ++first) {
        for (int sweep = 0; sweep < 60; ++sweep) {
            int last = first;
            while (last + 1 < n &&
                   std::abs(at(b, last)) > std::numeric_limits<double>::epsilon() / 4 *
                                               (std::abs(at(a, last)) + std::abs(at(a, last + 1))))
                ++last;
            if (last == first) break;
            double g = (at(a, first + 1) - at(a, first)) / (2 * at(b, first));
            double r = std::hypot(g, 1.0);
            g = at(a, last) - at(a, first) + at(b, first) / (g + std::copysign(r, g));
            double s = 1, c = 1, p = 0;
            int i = last - 1;
            for (; i >= first; --i) {
                double f = s * at(b, i);
                const double h = c * at(b, i);
                r = std::hypot(f, g);
                at(b, i + 1) = r;
                if (r == 0) {
                    at(a, i + 1) -= p;
                    at(b, last) = 0;
                    break;
                }
                s = f / r;
                c = g / r;
                g = at(a, i + 1) - p;
                r = (at(a, i) - g) * s + 2 * c * h;
                p = s * r;
                at(a, i + 1) = g + p;
                g = c * r - h;
            }
            if (r == 0 && i >= first) continue;
            at(a, first) -= p;
            at(b, first) = g;
            at(b, last) = 0;
        }
    }
    std::sort(a.begin(), a.end());
    return a;
}

std::vector<QuadratureNode> rule(const Recurrence& r) {
    std::vector<QuadratureNode> nodes;
    for (const double x : eigenvalues(r.a, r.b)) {
        double before = 0, p = 1, sum = 1;
        for (std::size_t k = 0; k + 1 < r.a.size(); ++k) {
            const double next = ((x - r.a[k]) * p - (k > 0 ? r.b[k - 1] * before : 0)) / r.b[k];
            before = p;
            p = next;
            sum += p * p;
        }
        nodes.push_back({x, r.mass / sum});
    }
    return nodes;
}

}  // namespace

std::vector<QuadratureNode> gauss_rule(std::span<const QuadratureNode> points, int count) {
    Recurrence r{};
    for (const auto& point : points) r.mass += point.weight;
    std::vector<double> before(points.size(), 0), p(points.size(), 1);
    double b = 0;
    for (int k = 0; k < count; ++k) {
        double a = 0;
        for (std::size_t i = 0; i < p.size(); ++i)
            a += points[i].weight / r.mass * points[i].x * p[i] * p[i];
        double norm2 = 0;
        for (std::size_t i = 0; i < p.size(); ++i) {
            const double next = (points[i].x - a) * p[i] - b * before[i];
            before[i] = p[i];
            p[i] = next;
            norm2 += points[i].weight / r.mass * next * next;
        }
        r.a.push_back(a);
        b = std::sqrt(norm2);
        if (!(b > 1e-100)) break;
        r.b.push_back(b);
        for (double& value : p) value /= b;
    }
    r.b.resize(r.a.size());
    return rule(r);
}

std::vector<QuadratureNode> gauss_jacobi(int count, double a, double b) {
    // The recurrence of Jacobi's polynomials for (1 - t)^(b-1) (1 + t)^(a-1), t = 2x - 1.
    Recurrence r{};
    r.mass = std::exp(std::lgamma(a) + std::lgamma(b) - std::lgamma(a + b));
    for (int k = 0; k < count; ++k) {
        const double n = 2 * k + a + b, m = k + 1;
        const double centre = k == 0 ? (a - b) / n : (a - b) * (a + b - 2) / ((n - 2) * n);
        const double b2 = k == 0
                              ? 4 * a * b / (n * n * (n + 1))
                              : 4 * m * (k + a) * (k + b) * (k + a + b - 1) / (n * n * (n * n - 1));
        r.a.push_back((centre + 1) / 2);
        r.b.push_back(std::sqrt(b2) / 2);
    }
    return rule(r);
}

}  // namespace ltmd::inline v0
