// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "distributions.h"
#include "ltmd/masking.h"

namespace ltmd::python {

/// The model of that name. Throws ValueError that lists the names for another.
MaskingModel parse_masking_model(const std::string& name);

/// Throws ValueError unless a quadrature may have so many points a side.
void require_points(int points);

/// function(directions..., out) for float or double: arrays of directions of one shape, and
/// float[...] for the result.
template <class Function>
py::object over_directions(const std::vector<Argument>& arguments, const Function& function) {
    const auto arrays = broadcast(arguments);
    return by_dtype(arrays[0], [&](auto real) -> py::object {
        using Real = decltype(real);
        std::vector<Array<Real>> given;
        std::vector<std::span<const Direction<Real>>> directions;
        for (std::size_t i = 0; i < arrays.size(); ++i) {
            given.push_back(require<Real>(arrays[i], arguments[i].name, {3}, true));
            directions.push_back(items<Direction<Real>>(given.back()));
        }
        Array<Real> out(
            std::vector<py::ssize_t>(given[0].shape(), given[0].shape() + given[0].ndim() - 1));
        const auto result = mutable_items<Real>(out);
        py::gil_scoped_release release;
        function(directions, result, real);
        return out;
    });
}

}  // namespace ltmd::python
