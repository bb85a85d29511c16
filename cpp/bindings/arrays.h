// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <span>
#include <string>
#include <vector>

#include "ltmd/errors.h"

/// NumPy arrays as spans: C-contiguous arrays of the right type are used in place.
namespace ltmd::python {

namespace py = pybind11;

template <class Scalar>
using Array = py::array_t<Scalar, py::array::c_style>;

/// `shape` as Python writes it.
inline std::string shape_text(const py::array& array) { return py::str(array.attr("shape")); }

/// `object` as a C-contiguous array. A dimension of -1 may have any length, and `leading` allows
/// any number of axes before `shape`. Throws TypeError for another type, ValueError for another
/// shape.
template <class Scalar>
Array<Scalar> require(py::handle object, const char* name, const std::vector<py::ssize_t>& shape,
                      bool leading = false) {
    const std::string wanted = py::str(py::dtype::of<Scalar>());
    if (!py::isinstance<py::array>(object))
        throw py::type_error(std::string(name) + " must be a NumPy array of " + wanted + ", not " +
                             std::string(py::str(py::type::of(object).attr("__name__"))));
    const auto array = py::reinterpret_borrow<py::array>(object);
    if (!py::isinstance<py::array_t<Scalar>>(object))
        throw py::type_error(std::string(name) + " must be of " + wanted + ", not " +
                             std::string(py::str(array.dtype())));
    const py::ssize_t extra = array.ndim() - static_cast<py::ssize_t>(shape.size());
    bool fits = leading ? extra >= 0 : extra == 0;
    std::string expected = leading ? "(..., " : "(";
    for (std::size_t i = 0; i < shape.size(); ++i) {
        fits =
            fits && (shape[i] < 0 || array.shape(extra + static_cast<py::ssize_t>(i)) == shape[i]);
        expected += (shape[i] < 0 ? "any" : std::to_string(shape[i]));
        expected += i + 1 < shape.size() ? ", " : shape.size() == 1 && !leading ? ",)" : ")";
    }
    if (!fits)
        throw py::value_error(std::string(name) + " must have shape " + expected + ", not " +
                              shape_text(array));
    return Array<Scalar>::ensure(object);
}

/// The array's scalars grouped into items, such as Vec3f.
template <class Item, class Scalar>
std::span<const Item> items(const Array<Scalar>& array) {
    static_assert(sizeof(Item) % sizeof(Scalar) == 0);
    return {reinterpret_cast<const Item*>(array.data()),
            static_cast<std::size_t>(array.size()) / (sizeof(Item) / sizeof(Scalar))};
}

template <class Item, class Scalar>
std::span<Item> mutable_items(Array<Scalar>& array) {
    return {reinterpret_cast<Item*>(array.mutable_data()),
            static_cast<std::size_t>(array.size()) / (sizeof(Item) / sizeof(Scalar))};
}

/// A new array with `like`'s axes, less its last, followed by `tail`.
inline Array<float> empty_like_leading(const py::array& like,
                                       std::initializer_list<py::ssize_t> tail) {
    std::vector<py::ssize_t> shape(like.shape(), like.shape() + like.ndim() - 1);
    shape.insert(shape.end(), tail);
    return Array<float>(shape);
}

}  // namespace ltmd::python
