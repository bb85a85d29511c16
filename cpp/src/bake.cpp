// SPDX-License-Identifier: Apache-2.0
#include "ltmd/bake.h"

#include <array>
#include <string>

#include "ltmd/errors.h"
#include "parallel.h"

namespace ltmd::inline v0 {
namespace {

constexpr int max_channels = 16;
constexpr std::size_t texels_per_piece = 1 << 15;

void require_size(const char* what, std::size_t given, std::size_t expected) {
    if (given != expected)
        throw InvalidInput(std::string(what) + " has " + std::to_string(given) +
                           " numbers; expected " + std::to_string(expected));
}

void validate_bake(const TexelCoverage& coverage, const char* what, std::size_t values,
                   std::size_t items, int channels, std::span<const float> background,
                   int out_channels, std::span<float> out) {
    if (channels < 1 || channels > max_channels)
        throw InvalidInput(std::to_string(channels) + " channels are outside 1 to " +
                           std::to_string(max_channels));
    if (out_channels != channels && out_channels != channels + 1)
        throw InvalidInput(std::to_string(out_channels) + " output channels; expected " +
                           std::to_string(channels) + " or " + std::to_string(channels + 1));
    const auto k = static_cast<std::size_t>(channels);
    require_size(what, values, items * k);
    require_size("background", background.size(), k);
    require_size("output", out.size(),
                 coverage.texels().size() * static_cast<std::size_t>(out_channels));
}

/// The values of one triangle as base + b0 d0 + b1 d1, `Out` channels wide. `In` and `Out` are 0
/// where only known at run time.
template <int In, int Out>
class Gather {
public:
    Gather(const TexelCoverage& coverage, std::span<const float> values, bool flat, int channels,
           std::span<const float> background, int out_channels)
        : coverage_(coverage),
          values_(values.data()),
          flat_(flat),
          in_(channels),
          out_(out_channels) {
        std::copy(background.begin(), background.end(), background_.begin());
        background_[static_cast<std::size_t>(channels)] = 1;
    }

    void run(std::size_t begin, std::size_t end, float* out) const {
        const CoverageTexel* texels = coverage_.texels().data();
        const auto width = static_cast<std::size_t>(out_channels());
        out += begin * width;
        std::int32_t current = -1;
        Plane plane;
        plane.base = background_;
        for (std::size_t i = begin; i < end; ++i, out += width) {
            const CoverageTexel texel = texels[i];
            if (texel.triangle != current) set(plane, current = texel.triangle);
            float result[Out > 0 ? Out : max_channels + 1];
            for (int k = 0; k < out_channels(); ++k)
                result[k] = plane.base[static_cast<std::size_t>(k)] +
                            (texel.b0 * plane.d0[static_cast<std::size_t>(k)] +
                             texel.b1 * plane.d1[static_cast<std::size_t>(k)]);
            for (int k = 0; k < out_channels(); ++k) out[k] = result[k];
        }
    }

private:
    static constexpr std::size_t capacity = Out > 0 ? Out + 1 : max_channels + 1;
    using Values = std::array<float, capacity>;
    struct Plane {
        Values base{}, d0{}, d1{};
    };

    int in_channels() const { return In > 0 ? In : in_; }
    int out_channels() const { return Out > 0 ? Out : out_; }

    const float* value(std::int32_t item) const {
        return values_ + static_cast<std::size_t>(item) * static_cast<std::size_t>(in_channels());
    }

    void set(Plane& plane, std::int32_t triangle) const {
        if (triangle < 0) {
            plane = {background_, {}, {}};
            return;
        }
        const auto in = static_cast<std::size_t>(in_channels());
        plane.base[in] = 1;
        if (flat_) {
            const float* v = value(triangle);
            std::copy(v, v + in, plane.base.begin());
            plane.d0 = plane.d1 = {};
            return;
        }
        const Triangle& t = coverage_.triangles()[static_cast<std::size_t>(triangle)];
        const float *v0 = value(t[0]), *v1 = value(t[1]), *v2 = value(t[2]);
        for (std::size_t k = 0; k < in; ++k) {
            plane.base[k] = v2[k];
            plane.d0[k] = v0[k] - v2[k];
            plane.d1[k] = v1[k] - v2[k];
        }
        plane.d0[in] = plane.d1[in] = 0;
    }

    const TexelCoverage& coverage_;
    const float* values_;
    bool flat_;
    int in_, out_;
    Values background_{};
};

template <int In, int Out>
void gather(const TexelCoverage& coverage, std::span<const float> values, bool flat, int channels,
            std::span<const float> background, int out_channels, std::span<float> out) {
    const Gather<In, Out> work(coverage, values, flat, channels, background, out_channels);
    parallel_for(coverage.texels().size(), texels_per_piece,
                 [&](std::size_t begin, std::size_t end) { work.run(begin, end, out.data()); });
}

void gather_any(const TexelCoverage& coverage, std::span<const float> values, bool flat,
                int channels, std::span<const float> background, int out_channels,
                std::span<float> out) {
    const auto work = channels == 3 && out_channels == 4   ? gather<3, 4>
                      : channels == 3 && out_channels == 3 ? gather<3, 3>
                      : channels == 4 && out_channels == 4 ? gather<4, 4>
                      : channels == 1 && out_channels == 1 ? gather<1, 1>
                                                           : gather<0, 0>;
    work(coverage, values, flat, channels, background, out_channels, out);
}

}  // namespace

void bake(const TexelCoverage& coverage, std::span<const float> corner_values, int channels,
          std::span<const float> background, int out_channels, std::span<float> out) {
    validate_bake(coverage, "corner values", corner_values.size(), coverage.corner_count(),
                  channels, background, out_channels, out);
    gather_any(coverage, corner_values, false, channels, background, out_channels, out);
}

void bake_flat(const TexelCoverage& coverage, std::span<const float> triangle_values, int channels,
               std::span<const float> background, int out_channels, std::span<float> out) {
    validate_bake(coverage, "triangle values", triangle_values.size(), coverage.triangles().size(),
                  channels, background, out_channels, out);
    gather_any(coverage, triangle_values, true, channels, background, out_channels, out);
}

}  // namespace ltmd::inline v0
