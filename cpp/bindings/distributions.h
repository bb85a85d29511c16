// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <utility>
#include <vector>

#include "arrays.h"
#include "ltmd/any_distribution.h"

/// Distributions in Python: arrays of float32 and float64 each have their own copy.
namespace ltmd::python {

/// What every distribution's class in Python derives from.
struct Distribution {
    AnyDistribution<float> single;
    AnyDistribution<double> full;

    const AnyDistribution<float>& of(float) const { return single; }
    const AnyDistribution<double>& of(double) const { return full; }
};

/// A distribution D<Real> with its parameters at hand; to bind with Distribution as its base:
/// py::class_<Bound<GGX>, Distribution>(module, "GGX").def(py::init<double, double>(), …).
template <template <class> class D>
struct Bound : Distribution {
    template <class... Arguments>
    explicit Bound(const Arguments&... arguments)
        : Bound(D<float>(arguments...), D<double>(arguments...)) {}

    D<float> exact_single;
    D<double> exact;

    const D<float>& exact_of(float) const { return exact_single; }
    const D<double>& exact_of(double) const { return exact; }

private:
    Bound(D<float> f, D<double> d)
        : Distribution{AnyDistribution<float>(f), AnyDistribution<double>(d)},
          exact_single(std::move(f)),
          exact(std::move(d)) {}
};

/// `object` as an array of float32 or float64, anything but an array as float64. Throws TypeError
/// for an array of another type or what is not numbers.
py::array floating(py::handle object, const char* name);

/// The array to write results to: `out`, or a new one if it is None. Throws TypeError unless `out`
/// is an array of that type, ValueError unless it has the shape, is C-contiguous and writable and
/// shares no memory with the arguments.
py::array result_array(py::handle out, const py::dtype& type, const std::vector<py::ssize_t>& shape,
                       std::initializer_list<py::array> arguments);

/// `from`, of shape (…, n) with n = sizeof(In) / sizeof(Real), through function(span<const In>,
/// span<Out>): the leading axes, followed by those of Out if it is more than one number. `other` is
/// what function() reads besides.
template <class In, class Out, class Real, class Function>
Array<Real> for_each_item(const Array<Real>& from, const Function& function,
                          py::handle to = py::none(), const py::array& other = {}) {
    std::vector<py::ssize_t> shape(from.shape(), from.shape() + from.ndim() - 1);
    if constexpr (sizeof(Out) > sizeof(Real))
        shape.push_back(static_cast<py::ssize_t>(sizeof(Out) / sizeof(Real)));
    auto out = Array<Real>(result_array(to, py::dtype::of<Real>(), shape, {from, other}));
    const auto given = items<In>(from);
    const auto result = mutable_items<Out>(out);
    py::gil_scoped_release release;
    function(given, result);
    return out;
}

/// An argument of a function over arrays: float[..., size], or float[...] if size is 0.
struct Argument {
    py::handle object;
    const char* name;
    py::ssize_t size;
};

/// Arrays of one dtype with their leading axes broadcast to one shape. Throws TypeError for two
/// dtypes, ValueError for shapes that do not fit.
std::vector<py::array> broadcast(const std::vector<Argument>& arguments);
std::pair<py::array, py::array> broadcast(py::handle a, const char* name_a, py::ssize_t size_a,
                                          py::handle b, const char* name_b, py::ssize_t size_b);

/// function<Real>() with Real = float or double by the array's dtype.
template <class Function>
auto by_dtype(const py::array& array, const Function& function) {
    return py::isinstance<py::array_t<float>>(array) ? function(float{}) : function(double{});
}

/// call(real, items, out) over an array of In, for the array's type of number: real is a 0 of it.
/// The results are directions or numbers; `to` is None or the array for them.
template <template <class> class In, bool direction_out, class Call>
py::object over_items(py::handle object, const char* name, py::handle to, const Call& call) {
    const py::array array = floating(object, name);
    return by_dtype(array, [&](auto real) -> py::object {
        using Real = decltype(real);
        using Out = std::conditional_t<direction_out, Direction<Real>, Real>;
        const auto size = static_cast<py::ssize_t>(sizeof(In<Real>) / sizeof(Real));
        return for_each_item<In<Real>, Out>(
            require<Real>(array, name, {size}, true),
            [&](auto from, auto out) { call(real, from, out); }, to);
    });
}

/// call(real, views, others, out) in the same way, over arrays of views and of Other, broadcast.
template <template <class> class Other, bool direction_out, class Call>
py::object over_views(py::handle v, py::handle other, const char* name, py::handle to,
                      const Call& call) {
    constexpr auto size = static_cast<py::ssize_t>(sizeof(Other<float>) / sizeof(float));
    const auto [views, others] = broadcast(v, "v", 3, other, name, size);
    return by_dtype(views, [&, &a = views, &b = others](auto real) -> py::object {
        using Real = decltype(real);
        using Out = std::conditional_t<direction_out, Direction<Real>, Real>;
        const auto given = require<Real>(a, "v", {3}, true);
        const auto second = require<Real>(b, name, {size}, true);
        const auto second_items = items<Other<Real>>(second);
        return for_each_item<Direction<Real>, Out>(
            given, [&](auto from, auto out) { call(real, from, second_items, out); }, to, second);
    });
}

/// call(v) of each direction v: float[..., 3] -> float[...].
template <class Call>
py::object for_each_direction(py::handle object, const char* name, const Call& call) {
    const py::array array = floating(object, name);
    return by_dtype(array, [&](auto real) -> py::object {
        using Real = decltype(real);
        return for_each_item<Direction<Real>, Real>(
            require<Real>(array, name, {3}, true), [&](auto from, auto to) {
                for (std::size_t i = 0; i < from.size(); ++i) to[i] = call(from[i]);
            });
    });
}

/// M of shape (2, 2), or (3, 3) with (0, 0, 1) as third row and column.
Matrix2 parse_surface_matrix(py::handle m);
/// float64[2, 2].
Array<double> matrix_array(const Matrix2& m);

}  // namespace ltmd::python
