// SPDX-License-Identifier: Apache-2.0
#include "ltmd/exr.h"

#include <pybind11/stl.h>

#include "bindings.h"

namespace ltmd::python {

Compression parse_compression(const std::string& name) {
    if (name == "none") return Compression::none;
    if (name == "zips") return Compression::zips;
    if (name == "zip") return Compression::zip;
    if (name == "piz") return Compression::piz;
    throw py::value_error("compression is '" + name +
                          "'; it must be 'none', 'zips', 'zip' or 'piz'");
}

Precision parse_precision(bool half, std::optional<int> mantissa_bits) {
    const Precision precision{half, mantissa_bits.value_or(full_mantissa)};
    validate(precision);
    return precision;
}

std::string parse_path(py::handle path) {
    return py::str(py::module_::import("os").attr("fsdecode")(path));
}

Metadata parse_metadata(const py::dict& metadata) {
    Metadata result;
    for (const auto& [key, value] : metadata) result[key.cast<std::string>()] = py::str(value);
    return result;
}

namespace {

/// Other programs' headers need not be UTF-8: what is not becomes U+FFFD.
py::str decode(const std::string& text) {
    return py::reinterpret_steal<py::str>(
        PyUnicode_DecodeUTF8(text.data(), static_cast<py::ssize_t>(text.size()), "replace"));
}

}  // namespace

void bind_exr(py::module_& module) {
    using namespace py::literals;
    module.attr("convention") = convention;
    module.def(
        "write_exr",
        [](py::handle path, py::handle pixels,
           const std::optional<std::vector<std::string>>& channels, const std::string& compression,
           bool half, std::optional<int> mantissa_bits, const py::dict& metadata) {
            const Precision precision = parse_precision(half, mantissa_bits);
            const auto image = require<float>(pixels, "pixels", {-1, -1, -1});
            std::vector<std::string> names;
            if (channels) {
                names = *channels;
                if (static_cast<py::ssize_t>(names.size()) != image.shape(2))
                    throw py::value_error(std::to_string(names.size()) + " channel names for " +
                                          std::to_string(image.shape(2)) + " channels");
            } else if (image.shape(2) == 1) {
                names = {"Y"};
            } else if (image.shape(2) == 3 || image.shape(2) == 4) {
                names = {"R", "G", "B", "A"};
            } else {
                throw py::value_error("pixels have " + std::to_string(image.shape(2)) +
                                      " channels: name them with channels=[...]");
            }
            const std::string file = parse_path(path);
            const Compression codec = parse_compression(compression);
            const Metadata attributes = parse_metadata(metadata);
            const int height = static_cast<int>(image.shape(0)),
                      width = static_cast<int>(image.shape(1));
            const auto values = items<float>(image);
            py::gil_scoped_release release;
            write_exr(file, values, width, height, names, codec, attributes, precision);
        },
        "path"_a, "pixels"_a, py::kw_only(), "channels"_a = py::none(), "compression"_a = "zip",
        "half"_a = false, "mantissa_bits"_a = py::none(), "metadata"_a = py::dict(),
        R"(Write float32[height, width, channels], row 0 = top, as a float OpenEXR file.

channels: names, one per channel. By default 1 channel is Y, 4 are R, G, B, A, and 3 are R, G, B with A = 1 added, because
Blender needs a finite alpha. compression: 'none', 'zips', 'zip' or 'piz', all lossless. half: 16-bit float (10 mantissa bits, at most 65504).
mantissa_bits: round to nearest even at 1 to 23 bits, a relative error up to 2^-(bits+1), so that files compress better;
None keeps all. Finite values stay finite. metadata: dict of header attributes, written as text.
The file appears only when complete (temporary file, then rename). Raises OSError with the path, ValueError, TypeError.)");
    module.def(
        "read_exr",
        [](py::handle path) {
            const std::string file = parse_path(path);
            auto image = [&] {
                py::gil_scoped_release release;
                return std::make_unique<ExrImage>(read_exr(file));
            }();
            const std::vector<py::ssize_t> shape = {
                image->height, image->width, static_cast<py::ssize_t>(image->channels.size())};
            float* data = image->pixels.data();
            py::capsule owner(image.release(),
                              [](void* pointer) { delete static_cast<ExrImage*>(pointer); });
            return py::array_t<float>(shape, data, owner);
        },
        "path"_a,
        R"(The pixels of an OpenEXR file, float32[height, width, channels], row 0 = top; R, G, B, A first where present.

Raises OSError for an unreadable file, or one of a newer `ltmd:convention` than this library reads.)");
    module.def(
        "exr_metadata",
        [](py::handle path) {
            const std::string file = parse_path(path);
            const Metadata metadata = [&] {
                py::gil_scoped_release release;
                return exr_metadata(file);
            }();
            py::dict result;
            for (const auto& [key, value] : metadata) result[decode(key)] = decode(value);
            return result;
        },
        "path"_a,
        "The text and number attributes of an OpenEXR file's header, as a dict of str. Raises as "
        "read_exr.");
}

}  // namespace ltmd::python
