// SPDX-License-Identifier: Apache-2.0
#include "ltmd/tabulated.h"

#include "bindings.h"
#include "distributions.h"

namespace ltmd::python {
namespace {

using Values = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// `object` as one axis of float64.
Values values(py::handle object, const char* name) {
    const auto array = Values::ensure(object);
    if (!array) {
        PyErr_Clear();
        throw py::type_error(std::string(name) + " must be numbers, not " +
                             std::string(py::str(py::type::of(object).attr("__name__"))));
    }
    if (array.ndim() != 1)
        throw py::value_error(std::string(name) + " must have shape (any,), not " +
                              shape_text(array));
    return array;
}

std::shared_ptr<const VisibleNormals> tabulate(py::handle p22_or_r, py::handle p22) {
    if (!p22.is_none()) {
        const Values r = values(p22_or_r, "r"), density = values(p22, "p22");
        return std::make_shared<const VisibleNormals>(
            RadialTable(items<double>(Array<double>(r)), items<double>(Array<double>(density))));
    }
    if (!PyCallable_Check(p22_or_r.ptr()))
        throw py::type_error("p22 must be a function of an array of slopes, or follow an array r");
    const RadialTable table([&](const std::vector<double>& r) {
        const Values given(static_cast<py::ssize_t>(r.size()), r.data());
        const Values result = values(p22_or_r(given), "the result of p22");
        return std::vector<double>(result.data(), result.data() + result.size());
    });
    return std::make_shared<const VisibleNormals>(table);
}

}  // namespace

void bind_tabulated(py::module_& module) {
    using namespace py::literals;
    using Class = Bound<Tabulated>;
    py::class_<Class, Distribution>(module, "Tabulated",
                                    R"(An isotropic distribution given by its P22 alone.

Tabulated(f): f takes slopes r = tan(theta), float64[n], 0 to 1e12, and returns P22, float64[n]. Tabulated(r, p22): linear
between the slopes r, constant below the first, 0 beyond the last. P22 may have any scale; it is made to integrate to 1.
The table is within 1e-6 of f where P22 matters; its projected area and visible normals are within 1e-6 of the table's own.
Raises ValueError for a density that is negative, not finite or 0 everywhere, or slopes that do not increase.
Source: microsurface-transformations, section 4.5.)")
        .def(py::init([](py::handle f, py::handle p22) { return Class(tabulate(f, p22)); }),
             "p22_or_r"_a, "p22"_a = py::none())
        .def("__repr__", [](const Class&) { return "Tabulated(...)"; });
}

}  // namespace ltmd::python
