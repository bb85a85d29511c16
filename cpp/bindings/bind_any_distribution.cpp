// SPDX-License-Identifier: Apache-2.0
#include "ltmd/any_distribution.h"

#include "bindings.h"
#include "distributions.h"

namespace ltmd::python {
namespace {

/// A distribution under M, in Python.
struct Transformed : Distribution {
    py::object base;
    Matrix2 matrix;
};

}  // namespace

py::array floating(py::handle object, const char* name) {
    if (py::isinstance<py::array>(object)) {
        if (py::isinstance<py::array_t<float>>(object) ||
            py::isinstance<py::array_t<double>>(object))
            return py::reinterpret_borrow<py::array>(object);
        throw py::type_error(
            std::string(name) + " must be of float32 or float64, not " +
            std::string(py::str(py::reinterpret_borrow<py::array>(object).dtype())));
    }
    auto array = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(object);
    if (!array) {
        PyErr_Clear();
        throw py::type_error(std::string(name) + " must be an array of float32 or float64, not " +
                             std::string(py::str(py::type::of(object).attr("__name__"))));
    }
    return array;
}

std::vector<py::array> broadcast(const std::vector<Argument>& arguments) {
    // What is not an array takes the type of those that are.
    const Argument* typed = nullptr;
    std::vector<py::array> arrays;
    for (const Argument& argument : arguments) {
        arrays.push_back(floating(argument.object, argument.name));
        if (!typed && py::isinstance<py::array>(argument.object)) typed = &argument;
    }
    const auto leading = [](const py::array& array, py::ssize_t size) {
        const py::ssize_t axes = array.ndim() - (size > 0);
        py::tuple shape(axes);
        for (py::ssize_t i = 0; i < axes; ++i) shape[static_cast<std::size_t>(i)] = array.shape(i);
        return shape;
    };
    const auto numpy = py::module_::import("numpy");
    py::list shapes;
    for (std::size_t i = 0; i < arrays.size(); ++i) {
        const auto& [object, name, size] = arguments[i];
        py::array& array = arrays[i];
        if (typed) {
            const py::dtype wanted = floating(typed->object, typed->name).dtype();
            if (!py::isinstance<py::array>(object)) array = array.attr("astype")(wanted);
            if (!array.dtype().equal(wanted))
                throw py::type_error(std::string(typed->name) + " is of " +
                                     std::string(py::str(wanted)) + " and " + name + " of " +
                                     std::string(py::str(array.dtype())) +
                                     "; both must be of one type");
        }
        if (size > 0 && (array.ndim() < 1 || array.shape(array.ndim() - 1) != size))
            throw py::value_error(std::string(name) + " must have shape (..., " +
                                  std::to_string(size) + "), not " + shape_text(array));
        shapes.append(leading(array, size));
    }
    py::tuple shape;
    try {
        shape = numpy.attr("broadcast_shapes")(*shapes);
    } catch (py::error_already_set&) {
        std::string text;
        for (std::size_t i = 0; i < arrays.size(); ++i)
            text += (i == 0 ? "" : " and ") + std::string(arguments[i].name) +
                    (i == 0 ? " has shape " : " ") + shape_text(arrays[i]);
        throw py::value_error(text + "; their leading axes do not fit together");
    }
    for (std::size_t i = 0; i < arrays.size(); ++i) {
        const py::ssize_t size = arguments[i].size;
        if (leading(arrays[i], size).equal(shape)) continue;
        const py::tuple full = size > 0 ? py::tuple(shape + py::make_tuple(size)) : shape;
        arrays[i] = numpy.attr("ascontiguousarray")(numpy.attr("broadcast_to")(arrays[i], full));
    }
    return arrays;
}

std::pair<py::array, py::array> broadcast(py::handle a, const char* name_a, py::ssize_t size_a,
                                          py::handle b, const char* name_b, py::ssize_t size_b) {
    const auto arrays = broadcast({{a, name_a, size_a}, {b, name_b, size_b}});
    return {arrays[0], arrays[1]};
}

py::array result_array(py::handle out, const py::dtype& type, const std::vector<py::ssize_t>& shape,
                       std::initializer_list<py::array> arguments) {
    if (out.is_none()) return py::array(type, shape);
    if (!py::isinstance<py::array>(out) ||
        !py::reinterpret_borrow<py::array>(out).dtype().equal(type))
        throw py::type_error("out must be a NumPy array of " + std::string(py::str(type)) +
                             ", as the arguments are");
    auto array = py::reinterpret_borrow<py::array>(out);
    const py::tuple wanted = py::cast(shape);
    if (!py::tuple(array.attr("shape")).equal(wanted))
        throw py::value_error("out must have shape " + std::string(py::str(wanted)) + ", not " +
                              shape_text(array));
    if (!array.writeable() || !(array.flags() & py::array::c_style))
        throw py::value_error("out must be writable and C-contiguous; numpy.empty() makes such");
    const auto* first = static_cast<const std::byte*>(array.data());
    for (const py::array& argument : arguments) {
        const auto* other = static_cast<const std::byte*>(argument.data());
        if (other < first + array.nbytes() && first < other + argument.nbytes())
            throw py::value_error("out shares memory with an argument; give it memory of its own");
    }
    return array;
}

Matrix2 parse_surface_matrix(py::handle m) {
    const auto values = py::array_t<double, py::array::c_style | py::array::forcecast>::ensure(m);
    if (!values) {
        PyErr_Clear();
        throw py::type_error("M must be a 2x2 matrix of numbers");
    }
    if (values.ndim() == 2 && values.shape(0) == 2 && values.shape(1) == 2) {
        const double* v = values.data();
        return {v[0], v[1], v[2], v[3]};
    }
    if (values.ndim() == 2 && values.shape(0) == 3 && values.shape(1) == 3) {
        std::array<double, 9> all;
        std::copy_n(values.data(), 9, all.begin());
        return tangent_plane_part(all);
    }
    throw py::value_error("M must have shape (2, 2) or (3, 3), not " + shape_text(values));
}

Array<double> matrix_array(const Matrix2& m) {
    Array<double> out({py::ssize_t{2}, py::ssize_t{2}});
    const double values[4] = {m.xx, m.xy, m.yx, m.yy};
    std::copy_n(values, 4, out.mutable_data());
    return out;
}

void bind_any_distribution(py::module_& module) {
    using namespace py::literals;
    py::class_<Distribution>(module, "Distribution",
                             R"(A microfacet distribution; GGX and others derive from it.

Directions are unit vectors (x, y, z) in the tangent frame, z the macrosurface normal. Arrays are float32 or float64, results
have the same type; anything else with numbers counts as float64. Leading axes are kept, and broadcast where there are two
arrays. out: an array of the results' type and shape to write them to, which saves the time to get fresh memory.)")
        .def(
            "P22",
            [](const Distribution& self, py::handle slopes, py::handle out) {
                return over_items<Slope, false>(
                    slopes, "slopes", out,
                    [&](auto real, auto s, auto to) { self.of(real).P22(s, to); });
            },
            "slopes"_a, py::kw_only(), "out"_a = py::none(),
            R"(The density of slopes (-m_x/m_z, -m_y/m_z): float[..., 2] -> float[...]; integrates to 1.

Source: microsurface-transformations, eq. 4.)")
        .def(
            "D",
            [](const Distribution& self, py::handle m, py::handle out) {
                return over_items<Direction, false>(
                    m, "m", out, [&](auto real, auto s, auto to) { self.of(real).D(s, to); });
            },
            "m"_a, py::kw_only(), "out"_a = py::none(),
            R"(The density of normals, D = P22 / cos^4: float[..., 3] -> float[...], per steradian; 0 for m_z <= 0.

D cos integrates to 1. Source: microsurface-transformations, eq. 3, 4.)")
        .def(
            "Lambda",
            [](const Distribution& self, py::handle v, py::handle out) {
                return over_items<Direction, false>(
                    v, "v", out, [&](auto real, auto s, auto to) { self.of(real).Lambda(s, to); });
            },
            "v"_a, py::kw_only(), "out"_a = py::none(),
            R"(Smith's auxiliary function, 0 or more, for v_z > 0: float[..., 3] -> float[...].

Source: masking-shadowing, eq. 65.)")
        .def(
            "G1",
            [](const Distribution& self, py::handle v, py::handle out) {
                return over_items<Direction, false>(
                    v, "v", out, [&](auto real, auto s, auto to) { self.of(real).G1(s, to); });
            },
            "v"_a, py::kw_only(), "out"_a = py::none(),
            R"(The masking 1 / (1 + Lambda) of microfacets that face v, in [0, 1]; 0 for v_z <= 0: float[..., 3] -> float[...].)")
        .def(
            "projected_area",
            [](const Distribution& self, py::handle v, py::handle out) {
                return over_items<Direction, false>(v, "v", out, [&](auto real, auto s, auto to) {
                    self.of(real).projected_area(s, to);
                });
            },
            "v"_a, py::kw_only(), "out"_a = py::none(),
            R"(The integral of D(m) max(0, v.m), the area of the microfacets that face v, projected along v: float[..., 3] -> float[...].)")
        .def(
            "sample",
            [](const Distribution& self, py::handle u, py::handle out) {
                return over_items<Uniform, true>(
                    u, "u", out, [&](auto real, auto s, auto to) { self.of(real).sample(s, to); });
            },
            "u"_a, py::kw_only(), "out"_a = py::none(),
            R"(Normals with density D cos, from random numbers in [0, 1]: float[..., 2] -> float[..., 3].

Source: microsurface-transformations, eq. 25, 26.)")
        .def(
            "pdf",
            [](const Distribution& self, py::handle m, py::handle out) {
                return over_items<Direction, false>(
                    m, "m", out, [&](auto real, auto s, auto to) { self.of(real).pdf(s, to); });
            },
            "m"_a, py::kw_only(), "out"_a = py::none(),
            "The density of sample(), D cos, per steradian: float[..., 3] -> float[...].")
        .def(
            "sample_visible",
            [](const Distribution& self, py::handle v, py::handle u, py::handle out) {
                return over_views<Uniform, true>(v, u, "u", out,
                                                 [&](auto real, auto a, auto b, auto to) {
                                                     self.of(real).sample_visible(a, b, to);
                                                 });
            },
            "v"_a, "u"_a, py::kw_only(), "out"_a = py::none(),
            R"(Normals as seen from v (v_z > 0), from random numbers in [0, 1]: float[..., 3], float[..., 2] -> float[..., 3].

Source: microsurface-transformations, eq. 27, 28.)")
        .def(
            "pdf_visible",
            [](const Distribution& self, py::handle v, py::handle m, py::handle out) {
                return over_views<Direction, false>(v, m, "m", out,
                                                    [&](auto real, auto a, auto b, auto to) {
                                                        self.of(real).pdf_visible(a, b, to);
                                                    });
            },
            "v"_a, "m"_a, py::kw_only(), "out"_a = py::none(),
            R"(The density of sample_visible(), D max(0, v.m) / projected_area(v), per steradian: float[..., 3], float[..., 3] -> float[...].)")
        .def(
            "transformed",
            [](py::object self, py::handle m) {
                const auto& d = self.cast<const Distribution&>();
                const Matrix2 matrix = parse_surface_matrix(m);
                return Transformed{
                    {d.single.transformed(matrix), d.full.transformed(matrix)}, self, matrix};
            },
            "M"_a,
            R"(This distribution after the map p' = M p of its surface, M of shape (2, 2), heights kept.

Raises ValueError for a singular M, or a (3, 3) M that leaves the tangent plane.
Source: microsurface-transformations, eq. 9, 12, 22, 24-28.)");
    py::class_<Transformed, Distribution>(module, "TransformedDistribution",
                                          "A distribution under a linear map of its surface.")
        .def_readonly("base", &Transformed::base)
        .def_property_readonly("M", [](const Transformed& t) { return matrix_array(t.matrix); })
        .def("__repr__", [](const Transformed& t) {
            return std::string(py::repr(t.base)) + ".transformed(" +
                   std::string(py::str(matrix_array(t.matrix).attr("tolist")())) + ")";
        });
}

}  // namespace ltmd::python
