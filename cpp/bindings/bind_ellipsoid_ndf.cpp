// SPDX-License-Identifier: Apache-2.0
#include "ltmd/ellipsoid_ndf.h"

#include "bindings.h"
#include "distributions.h"
#include "ltmd/non_centred_distribution.h"

namespace ltmd::python {
namespace {

using Class = Bound<EllipsoidNDF>;

Ellipsoid::Matrix parse_matrix3(py::handle object, const char* name) {
    const auto values = Array<double>::ensure(object);
    if (!values) {
        PyErr_Clear();
        throw py::type_error(std::string(name) + " must be a 3x3 matrix of numbers");
    }
    if (values.ndim() != 2 || values.shape(0) != 3 || values.shape(1) != 3)
        throw py::value_error(std::string(name) + " must have shape (3, 3), not " +
                              shape_text(values));
    Ellipsoid::Matrix matrix;
    std::copy_n(values.data(), 9, matrix.begin());
    return matrix;
}

Array<double> array3(const Ellipsoid::Matrix& matrix) {
    Array<double> out({py::ssize_t{3}, py::ssize_t{3}});
    std::copy_n(matrix.data(), 9, out.mutable_data());
    return out;
}

/// function(ellipsoid, direction) of each direction in double.
template <class Function>
Array<double> of_each(const Class& c, py::handle object, const char* name,
                      const Function& function) {
    const auto array =
        require<double>(floating(object, name).attr("astype")("float64"), name, {3}, true);
    return for_each_item<Direction<double>, double>(array, [&](auto from, auto to) {
        for (std::size_t i = 0; i < from.size(); ++i)
            to[i] = function(c.exact.ellipsoid(), from[i]);
    });
}

}  // namespace

void bind_ellipsoid_ndf(py::module_& module) {
    using namespace py::literals;
    py::class_<Class, Distribution>(
        module, "EllipsoidNDF",
        R"(The normals of the upper half of the ellipsoid |A p| = 1, which may be skewed.

A: float[3, 3], acting on points; c A and Q A with Q orthogonal give the same distribution. G1 has the paper's min, so that
where a skewed ellipsoid's visible area is less than the macrosurface's the weak white furnace gives less than 1.
Raises ValueError with A's numbers unless its condition is at most 1e7. Source: ellipsoid-ndf, eq. 1-6.)")
        .def(py::init([](py::handle a) { return Class(Ellipsoid(parse_matrix3(a, "A"))); }), "A"_a)
        .def_static(
            "from_angles",
            [](double alpha_x, double alpha_y, double theta_x, double theta_y, double theta_z) {
                return Class(Ellipsoid::from_angles(alpha_x, alpha_y, theta_x, theta_y, theta_z));
            },
            "alpha_x"_a, "alpha_y"_a, "theta_x"_a = 0.0, "theta_y"_a = 0.0, "theta_z"_a = 0.0,
            R"(A = diag(alpha_x, alpha_y, 1) R_x(theta_x) R_y(theta_y) R_z(theta_z); alphas in [1e-6, 1e6], angles in radians.

theta_z turns the axes of the alphas by -theta_z about the normal; if both alphas are below 1, theta_x > 0 tips the peak of D
toward +V and theta_y > 0 toward -U. Source: ellipsoid-ndf, eq. 2, 3.)")
        .def_static(
            "from_sggx",
            [](py::handle s) { return Class(Ellipsoid::from_sggx(parse_matrix3(s, "S"))); }, "S"_a,
            R"(The upper triangular A with A^T A = S, float[3, 3] of the SGGX microflake distribution.

Raises ValueError unless S is symmetric and positive definite. Source: ellipsoid-ndf, section 5.2.)")
        .def_property_readonly("A",
                               [](const Class& c) { return array3(c.exact.ellipsoid().matrix()); })
        .def_property_readonly(
            "sggx_matrix", [](const Class& c) { return array3(c.exact.ellipsoid().sggx_matrix()); },
            "S = A^T A, float64[3, 3] (ellipsoid-ndf, section 5.2).")
        .def_property_readonly(
            "mean_normal",
            [](const Class& c) {
                const Direction<double> m = c.exact.ellipsoid().mean_normal();
                Array<double> out(py::ssize_t{3});
                *reinterpret_cast<Direction<double>*>(out.mutable_data()) = m;
                return out;
            },
            "A^T A n at length 1, float64[3]: the microsurface's mean normal (ellipsoid-ndf, "
            "section 5.1).")
        .def_property_readonly(
            "mean_slope",
            [](const Class& c) {
                const Slope<double> s = c.exact.ellipsoid().mean_slope();
                return std::pair(s.x, s.y);
            },
            "The slopes of mean_normal, about which P22 is a GGX distribution.")
        .def(
            "unclamped_G1",
            [](const Class& c, py::handle v) {
                return for_each_direction(v, "v",
                                          [&](auto& w) { return c.exact_of(w.z).unclamped_G1(w); });
            },
            "v"_a,
            R"(G1 without the min: above 1 where a skewed ellipsoid's visible area is less than v_z: float[..., 3] -> float[...].

Source: ellipsoid-ndf, eq. 6.)")
        .def(
            "gaussian_curvature",
            [](const Class& c, py::handle m, double c_e) {
                return of_each(c, m, "m",
                               [c_e](auto& e, auto d) { return e.gaussian_curvature(d, c_e); });
            },
            "m"_a, "C_e"_a = 1.0,
            R"(The Gaussian curvature of |A p| = C_e where its unit normal is m: float[..., 3] -> float64[...].

Source: ellipsoid-ndf, eq. 20.)")
        .def(
            "ellipsoid_area",
            [](const Class& c, py::handle u, double c_e) {
                return of_each(c, u, "u",
                               [c_e](auto& e, auto d) { return e.projected_area(d, c_e); });
            },
            "u"_a, "C_e"_a = 1.0,
            R"(The area of the whole |A p| = C_e projected along u: float[..., 3] -> float64[...].

Source: ellipsoid-ndf, eq. 26.)")
        .def(
            "lune_area",
            [](const Class& c, py::handle u, py::handle v, double c_e) {
                const auto array =
                    require<double>(floating(v, "v").attr("astype")("float64"), "v", {3});
                const Direction<double> other = items<Direction<double>>(array)[0];
                return of_each(c, u, "u", [c_e, other](auto& e, auto d) {
                    return e.lune_area(d, other, c_e);
                });
            },
            "u"_a, "v"_a, "C_e"_a = 1.0,
            R"(The area of the part of |A p| = C_e that faces u and v, projected along u: float[..., 3], float[3] -> float64[...].

Source: ellipsoid-ndf, eq. 28.)")
        .def_property_readonly(
            "unit_size", [](const Class& c) { return c.exact.ellipsoid().unit_size(); },
            "The C_e at which ellipsoid_area((0, 0, 1)) is 1 (ellipsoid-ndf, eq. 29).")
        .def(
            "transformed",
            [](const Class& c, py::handle m) {
                return Class(c.exact.ellipsoid().transformed(parse_surface_matrix(m)));
            },
            "M"_a,
            R"(The ellipsoid after the map p' = M p of its surface: A M^-1. M of shape (2, 2).

Raises ValueError for a singular M, or a (3, 3) M that leaves the tangent plane.)")
        .def(
            "sheared",
            [](const Class& c, double x, double y) {
                return Class(c.exact.ellipsoid().sheared({x, y}));
            },
            "slope_x"_a, "slope_y"_a,
            "The ellipsoid with every slope of its surface moved by (slope_x, slope_y).")
        .def("__repr__", [](const Class& c) {
            return "EllipsoidNDF(" +
                   std::string(py::str(array3(c.exact.ellipsoid().matrix()).attr("tolist")())) +
                   ")";
        });
}

}  // namespace ltmd::python
