// SPDX-License-Identifier: Apache-2.0
#include "ltmd/mdf_conversion.h"

#include <algorithm>
#include <array>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "gauss_quadrature.h"
#include "ltmd/errors.h"
#include "ltmd/require_range.h"
#include "parallel.h"
#include "text.h"
#include "unit_form.h"

namespace ltmd::inline v0 {
namespace {

using std::numbers::ln2, std::numbers::pi;

constexpr double smallest_m = 1e-6, largest_m = 1, largest_closed_form_m = 0.45;
/// Fits are smooth functions of m_B between these: the largest angle, min(4 m_B, pi/2), has a
/// corner at pi/8, and from about 0.1453 on the end of Schlick's function is inside.
constexpr std::array<double, 4> smooth_between{0, 0.145312736, pi / 8, largest_m};

/// A root of f between a and b, both logarithms, by Ridders' method; where f has no change of sign,
/// the end nearer to one.
template <class Function>
double find_root(const Function& f, double a, double b) {
    double fa = f(a), fb = f(b);
    if ((fa < 0) == (fb < 0)) return std::abs(fa) < std::abs(fb) ? a : b;
    double x = a;
    for (int step = 0; step < 100; ++step) {
        const double middle = (a + b) / 2, fm = f(middle), root = std::sqrt(fm * fm - fa * fb);
        if (fm == 0 || root == 0) return middle;
        const double before = x;
        x = middle + (middle - a) * std::copysign(fm / root, fa * fm);
        const double fx = f(x);
        if (fx == 0 || std::abs(x - before) <= 1e-15 * std::max(1.0, std::abs(x))) return x;
        // x lies on the side of the middle where the sign changes.
        ((fm < 0) == (fa < 0) ? a : b) = middle;
        ((fm < 0) == (fa < 0) ? fa : fb) = fm;
        ((fx < 0) == (fa < 0) ? a : b) = x;
        ((fx < 0) == (fa < 0) ? fa : fb) = fx;
    }
    return x;
}

/// Parameters of the bell that a narrow unit form has in common: value = factor width^power.
struct Scale {
    double power, factor;
};
constexpr Scale scale_of(MdfFamily family) {
    const bool exponent = family == MdfFamily::phong || family == MdfFamily::sawicki;
    return exponent ? Scale{-2, 2} : Scale{1, 1};
}

/// The values that a family's formula takes.
struct Limits {
    double low, high;
};
constexpr Limits limits_of(MdfFamily family) {
    const auto of = [](MdfParameter parameter) -> Limits {
        return {mdf_info(parameter).low, mdf_info(parameter).high};
    };
    switch (family) {
        case MdfFamily::beckmann:
            return of(MdfParameter::beckmann_alpha);
        case MdfFamily::gauss:
            return of(MdfParameter::gauss_m);
        case MdfFamily::gtr:
            return of(MdfParameter::gtr_alpha);
        case MdfFamily::phong:
            return of(MdfParameter::phong_exponent);
        case MdfFamily::schlick:
            return of(MdfParameter::schlick_m);
        case MdfFamily::sawicki:
            return of(MdfParameter::sawicki_n);
    }
    return {};
}

// -- Least squares --

/// Quadrature over [0, end], finer towards 0.
std::vector<QuadratureNode> angles(double finest, double end) {
    static const std::vector<QuadratureNode> rule = gauss_jacobi(24, 1, 1);
    std::vector<QuadratureNode> nodes;
    double high = end;
    while (high > 0) {
        const double low = high > finest ? high / 2 : 0;
        for (const QuadratureNode& node : rule)
            nodes.push_back({low + (high - low) * node.x, (high - low) * node.weight});
        high = low;
    }
    return nodes;
}

/// The p of `form` nearest to the unit form `reference` of `reference_p`; `guess` is near it.
MdfFit fit(const UnitForm& reference, double reference_p, const UnitForm& form, double guess,
           double end) {
    const double width = std::pow(reference_p / scale_of(reference.family).factor,
                                  1 / scale_of(reference.family).power);
    const auto integrate = [&](double from, double to, const auto& integrand) {
        double sum = 0;
        for (const QuadratureNode& node : angles(std::min(width, to - from), to - from))
            sum += node.weight * integrand(from + node.x);
        return sum;
    };
    const auto difference = [&](double log_p, bool squared) {
        const double p = std::exp(log_p);
        const auto integrand = [&](double beta) {
            const UnitForm::Point here = form.at(p, beta);
            const double error = here.value - reference.at(reference_p, beta).value;
            return squared ? error * error : error * here.slope;
        };
        // Schlick's functions end inside with a corner.
        double ends[2] = {form.end(p), reference.end(reference_p)};
        std::sort(ends, ends + 2);
        double sum = 0, from = 0;
        for (const double to : {std::min(ends[0], end), std::min(ends[1], end), end}) {
            if (to > from) sum += integrate(from, to, integrand);
            from = to;
        }
        return sum;
    };
    const auto slope = [&](double log_p) { return difference(log_p, false); };
    const Limits limits = limits_of(form.family);
    const double least = std::log(limits.low), most = std::log(limits.high);
    double low = std::clamp(std::log(guess), least, most), high = low, step = 0.01;
    const double at_guess = slope(low);
    // Downhill until the slope changes sign.
    for (; low > least || high < most; step *= 2) {
        double& next = at_guess > 0 ? low : high;
        next = std::clamp(next + (at_guess > 0 ? -step : step), least, most);
        if ((slope(next) > 0) != (at_guess > 0) || next == least || next == most) break;
    }
    const double log_p = find_root(slope, low, high);
    return {std::exp(log_p), std::sqrt(difference(log_p, true) / end)};
}

/// A smooth function on [low, high] by its values at Chebyshev's points.
class Interpolant {
public:
    template <class Function>
    Interpolant(double low, double high, int count, const Function& f) : low_(low), high_(high) {
        std::vector<double> values;
        for (int j = 0; j < count; ++j) {
            const double x = std::cos(pi * (j + 0.5) / count);
            values.push_back(f((low + high) / 2 + (high - low) / 2 * x));
        }
        for (int k = 0; k < count; ++k) {
            double sum = 0;
            for (int j = 0; j < count; ++j)
                sum += values[static_cast<std::size_t>(j)] * std::cos(pi * k * (j + 0.5) / count);
            coefficients_.push_back((k == 0 ? 1.0 : 2.0) * sum / count);
        }
    }
    /// Clenshaw's summation.
    double operator()(double x) const {
        const double t = (2 * x - low_ - high_) / (high_ - low_);
        double b1 = 0, b2 = 0;
        for (std::size_t k = coefficients_.size() - 1; k > 0; --k) {
            const double b = coefficients_[k] + 2 * t * b1 - b2;
            b2 = b1;
            b1 = b;
        }
        return coefficients_[0] + t * b1 - b2;
    }

private:
    double low_, high_;
    std::vector<double> coefficients_;
};

/// The fits of a family to Beckmann, as a function of m_B.
class FitOfBeckmann {
public:
    explicit FitOfBeckmann(const UnitForm& form) : form_(form) {
        if (form.family == MdfFamily::beckmann) return;
        const Scale scale = scale_of(form.family);
        double last = 0;  // The guess for the next.
        const auto log_ratio = [&](double m) {
            const double bell = scale.factor * std::pow(m, scale.power);
            const MdfFit nearest = fit({MdfFamily::beckmann, 0}, m, form, bell * std::exp(last),
                                       std::min(4 * m, pi / 2));
            return last = std::log(nearest.value / bell);
        };
        for (std::size_t i = 0; i + 1 < smooth_between.size(); ++i)
            pieces_.emplace_back(smooth_between[i], smooth_between[i + 1], i < 2 ? 24 : 40,
                                 log_ratio);
    }

    /// log(p) of log(m_B), monotone.
    double operator()(double log_m) const {
        const Scale scale = scale_of(form_.family);
        double log_p = std::log(scale.factor) + scale.power * log_m;
        if (!pieces_.empty()) {
            const double m = std::exp(log_m);
            log_p += pieces_[m < smooth_between[1] ? 0 : m < smooth_between[2] ? 1 : 2](m);
        }
        return log_p;
    }

private:
    UnitForm form_;
    std::vector<Interpolant> pieces_;  ///< log of p over the value of a narrow bell of one width.
};

template <MdfFamily family>
std::shared_ptr<const FitOfBeckmann> made_once() {
    static const auto fits = std::make_shared<const FitOfBeckmann>(UnitForm{family, 2});
    return fits;
}

std::shared_ptr<const FitOfBeckmann> fits_of(const UnitForm& form) {
    switch (form.family) {
        case MdfFamily::beckmann:
            return made_once<MdfFamily::beckmann>();
        case MdfFamily::gauss:
            return made_once<MdfFamily::gauss>();
        case MdfFamily::phong:
            return made_once<MdfFamily::phong>();
        case MdfFamily::schlick:
            return made_once<MdfFamily::schlick>();
        case MdfFamily::sawicki:
            return made_once<MdfFamily::sawicki>();
        case MdfFamily::gtr:
            break;
    }
    return form.gamma == 2 ? made_once<MdfFamily::gtr>()
                           : std::make_shared<const FitOfBeckmann>(form);
}

// -- The angle where the unit form is 1/2 --

/// The value that a family has at half angle beta (eq. 3-5, 9, 10).
double value_at_half_angle(const UnitForm& form, double beta) {
    const double sine = std::sin(beta), cosine = std::cos(beta);
    const double half_sine = std::sin(beta / 2), versine = 2 * half_sine * half_sine;
    switch (form.family) {
        case MdfFamily::phong:
            return -ln2 / std::log1p(-versine);  // eq. 3
        case MdfFamily::gauss:
            return beta / std::sqrt(ln2);  // eq. 4
        case MdfFamily::gtr:               // eq. 5 for any gamma
            return sine / std::sqrt(std::exp2(1 / form.gamma) - 1 + sine * sine);
        case MdfFamily::beckmann:  // eq. 9
            return sine / (cosine * std::sqrt(ln2 - 4 * std::log1p(-versine)));
        case MdfFamily::sawicki:  // eq. 10
            return 1 + 4 * (std::sqrt(std::sqrt(2 * cosine)) - 1) / versine;
        case MdfFamily::schlick:
            break;
    }
    // The unit form reaches 1/2 at the m for which its end is past beta and below 1.
    const auto above_half = [&](double log_m) {
        return form.at(std::exp(log_m), beta).value - 0.5;
    };
    return std::exp(find_root(above_half, std::log(versine), 0));
}

/// The inverse: eq. 6-8; eq. 9 and 10 solved.
double half_angle(const UnitForm& form, double p) {
    switch (form.family) {
        case MdfFamily::phong:
            return 2 * std::asin(std::sqrt(-std::expm1(-ln2 / p) / 2));  // eq. 6
        case MdfFamily::gauss:
            return p * std::sqrt(ln2);  // eq. 7
        case MdfFamily::gtr: {          // eq. 8
            const double k = std::exp2(1 / form.gamma) - 1;
            return std::asin(std::min(1.0, p * std::sqrt(k / ((1 - p) * (1 + p)))));
        }
        case MdfFamily::beckmann:
        case MdfFamily::sawicki:
        case MdfFamily::schlick:
            break;
    }
    const Scale scale = scale_of(form.family);
    const double width = std::pow(p / scale.factor, 1 / scale.power);
    const auto above_half = [&](double log_beta) {
        return form.at(p, std::exp(log_beta)).value - 0.5;
    };
    return std::exp(find_root(above_half, std::log(std::min(0.1 * width, 1.0)),
                              std::log(std::min(10 * width, pi / 2))));
}

// -- The paper's formulas for the least squares --

/// microfacet-distribution-conversion, eq. 12-15, Tables 3 and 4. Schlick's m is m_B.
double closed_form(MdfFamily source, MdfFamily target, double x) {
    using enum MdfFamily;
    if (source == schlick) source = beckmann;
    if (target == schlick) target = beckmann;
    if (source == sawicki) return closed_form(phong, target, (x - 0.3) / 1.174);  // eq. 15
    if (target == sawicki) return 1.174 * closed_form(source, phong, x) + 0.3;    // eq. 15
    const double cube = x * x * x;
    if (source == beckmann) {
        if (target == phong) return 2 / (x * x) - 2.5;    // eq. 12
        if (target == gauss) return 0.5591 * cube + x;    // eq. 13
        if (target == gtr) return 1.2 * x - 0.56 * cube;  // Table 4
    } else if (source == gauss) {
        if (target == beckmann) return x - 0.4134 * cube;    // eq. 13
        if (target == phong) return 2 / (x * x) - 0.5;       // eq. 14
        if (target == gtr) return 1.186 * x - 0.835 * cube;  // Table 4
    } else if (source == phong) {
        if (target == beckmann) return std::sqrt(2 / (x + 2.5));  // eq. 12
        if (target == gauss) return std::sqrt(2 / (x + 0.5));     // eq. 14
        if (target == gtr) return 1.697 / std::sqrt(x + 4.5);     // Table 4
    } else if (source == gtr) {
        if (target == beckmann) return 0.8388 * x + 0.7 * cube * x;  // Table 3
        if (target == gauss) return 0.8222 * x + 0.82 * cube;        // Table 3
        if (target == phong) return 1.696 * 1.696 / (x * x) - 4.5;   // Table 3
    }
    return x;
}

// -- Through a common coordinate --

/// A parameter's value as a monotone function of a coordinate that source and target share, and the
/// coordinate of a value, or the nearest that is possible.
struct Relation {
    std::function<double(double)> value, coordinate;
};

Relation fitted(MdfParameter parameter, double gamma) {
    const UnitForm form = unit_form(parameter, gamma);
    const auto fits = fits_of(form);
    return {[=](double log_m) { return parameter_value(parameter, std::exp((*fits)(log_m))); },
            [=](double value) {
                const double log_p = std::log(family_value(parameter, value));
                return find_root([&](double log_m) { return (*fits)(log_m)-log_p; },
                                 std::log(smallest_m), std::log(largest_m));
            }};
}

Relation by_half_angle(MdfParameter parameter, double gamma) {
    const UnitForm form = unit_form(parameter, gamma);
    return {
        [=](double beta) { return parameter_value(parameter, value_at_half_angle(form, beta)); },
        [=](double value) { return half_angle(form, family_value(parameter, value)); }};
}

/// The coordinate is what the family's formulas take.
Relation of_family(MdfParameter parameter) {
    return {[=](double p) { return parameter_value(parameter, p); },
            [=](double value) { return family_value(parameter, value); }};
}

/// What is in the family of `parameter` by Ward's formula, which is its own inverse (eq. 11).
bool in_eq_11(MdfFamily family) {
    return family == MdfFamily::beckmann || family == MdfFamily::phong;
}
double ward(MdfFamily source, double x) {
    return source == MdfFamily::beckmann ? 2 / (x * x) : std::sqrt(2 / x);
}

}  // namespace

MdfMethod parse_mdf_method(std::string_view name) {
    std::string names;
    for (std::size_t i = 0; i < mdf_method_names.size(); ++i) {
        if (name == mdf_method_names[i]) return static_cast<MdfMethod>(i);
        names += text(i == 0 ? "" : ", ", mdf_method_names[i]);
    }
    throw InvalidInput(text("there is no method '", name, "'; the names are ", names));
}

MdfConversion::MdfConversion(MdfParameter source, MdfParameter target, MdfMethod method,
                             double gamma)
    : source_(source), target_(target), method_(method) {
    if (source == MdfParameter::gtr_alpha || target == MdfParameter::gtr_alpha)
        require_range("gamma", gamma, smallest_mdf_gamma, largest_mdf_gamma);
    const UnitForm from = unit_form(source, gamma), to = unit_form(target, gamma);
    Relation of_source, of_target;
    double low, high;
    if (from.family == to.family && from.gamma == to.gamma) {
        of_source = of_family(source), of_target = of_family(target);
        low = 0, high = std::numeric_limits<double>::infinity();
    } else if (method == MdfMethod::rmse) {
        of_source = fitted(source, gamma), of_target = fitted(target, gamma);
        low = std::log(smallest_m), high = std::log(largest_m);
    } else if (method == MdfMethod::half_angle) {
        of_source = by_half_angle(source, gamma), of_target = by_half_angle(target, gamma);
        const UnitForm beckmann{MdfFamily::beckmann, 0};
        low = half_angle(beckmann, smallest_m), high = half_angle(beckmann, largest_m);
    } else {
        const bool by_ward = method == MdfMethod::ward;
        const auto known = [&](const UnitForm& form) {
            return by_ward ? in_eq_11(form.family)
                           : form.family != MdfFamily::gtr || form.gamma == 2;
        };
        if (!known(from) || !known(to))
            throw InvalidInput(text(
                "the method ", mdf_method_names[static_cast<std::size_t>(method)],
                " has no conversion from ", mdf_info(source).name, " to ", mdf_info(target).name));
        const auto convert = [=](MdfFamily a, MdfFamily b, double x) {
            return by_ward ? ward(a, x) : closed_form(a, b, x);
        };
        const auto of_beckmann = [&](double m) {
            return from.family == MdfFamily::beckmann
                       ? m
                       : convert(MdfFamily::beckmann, from.family, m);
        };
        of_source = of_family(source);
        // What the range below gives is in the target's range too.
        of_target = {
            [=](double x) { return parameter_value(target, convert(from.family, to.family, x)); },
            nullptr};
        low = of_beckmann(smallest_m);
        high = of_beckmann(by_ward ? largest_m : largest_closed_form_m);
        if (low > high) std::swap(low, high);
    }
    // Both in their own ranges.
    for (const auto& [relation, parameter] :
         {std::pair(&of_source, source), std::pair(&of_target, target)}) {
        if (!relation->coordinate) continue;
        const MdfParameterInfo& info = mdf_info(parameter);
        const double a = relation->coordinate(info.low), b = relation->coordinate(info.high);
        low = std::max(low, std::min(a, b));
        high = std::min(high, std::max(a, b));
    }
    low_ = of_source.value(low), high_ = of_source.value(high);
    if (low_ > high_) std::swap(low_, high_);
    convert_ = [=, info = mdf_info(target)](double value) {
        const double coordinate = std::clamp(of_source.coordinate(value), low, high);
        return std::clamp(of_target.value(coordinate), info.low, info.high);
    };
}

double MdfConversion::operator()(double value) const {
    double out;
    (*this)({&value, 1}, {&out, 1});
    return out;
}

void MdfConversion::operator()(std::span<const double> values, std::span<double> out) const {
    if (out.size() != values.size())
        throw InvalidInput(text(values.size(), " values, but room for ", out.size()));
    // Ends that were converted themselves may be off by a rounding.
    constexpr double rounding = 1e-9;
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!(values[i] >= low_ * (1 - rounding) && values[i] <= high_ * (1 + rounding)))
            throw InvalidInput(text(mdf_info(source_).name, " is ", values[i],
                                    values.size() > 1 ? text(" at index ", i) : "",
                                    "; to convert it to ", mdf_info(target_).name, " by ",
                                    mdf_method_names[static_cast<std::size_t>(method_)],
                                    " it must be in [", low_, ", ", high_, "]"));
    parallel_for(values.size(), 1024, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) out[i] = convert_(values[i]);
    });
}

MdfFit fit_mdf(MdfParameter source, double value, MdfParameter target, double largest_angle,
               double gamma) {
    const MdfParameterInfo& info = mdf_info(source);
    require_range(info.name, value, info.low, info.high);
    if (source == MdfParameter::gtr_alpha || target == MdfParameter::gtr_alpha)
        require_range("gamma", gamma, smallest_mdf_gamma, largest_mdf_gamma);
    if (!(largest_angle > 0 && largest_angle <= pi / 2))
        throw InvalidInput(
            text("the largest angle is ", largest_angle, "; it must be in (0, pi/2]"));
    const UnitForm from = unit_form(source, gamma), to = unit_form(target, gamma);
    const double p = family_value(source, value);
    const Scale a = scale_of(from.family), b = scale_of(to.family);
    const double guess = b.factor * std::pow(p / a.factor, b.power / a.power);
    const MdfFit nearest = fit(from, p, to, guess, largest_angle);
    const double found = parameter_value(target, nearest.value);
    return {std::clamp(found, mdf_info(target).low, mdf_info(target).high), nearest.rmse};
}

}  // namespace ltmd::inline v0
