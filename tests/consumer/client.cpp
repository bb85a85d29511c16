// SPDX-License-Identifier: Apache-2.0
// A program of someone else: it measures a stretched square, writes it, and reads it back.
#include <ltmd/bake.h>
#include <ltmd/errors.h>
#include <ltmd/exr.h>
#include <ltmd/rest_state.h>
#include <ltmd/tension.h>
#include <ltmd/texel_coverage.h>
#include <ltmd/verify.h>
#include <ltmd/version.h>

#include <cstdio>
#include <filesystem>
#include <string>
#include <type_traits>
#include <vector>

// The inner namespace goes with the major version: two of them can live in one process.
static_assert(LTMD_VERSION_MAJOR == 0);
static_assert(std::is_same_v<ltmd::RestState, ltmd::v0::RestState>);

int main(int, char** arguments) {
    const std::vector<ltmd::Triangle> triangles = {{0, 1, 2}, {0, 2, 3}};
    const std::vector<std::int32_t> verts = {0, 1, 2, 3};
    const std::vector<ltmd::Vec2f> uv = {{0, 0}, {1, 0}, {1, 1}, {0, 1}};
    const std::vector<ltmd::Vec3f> rest_positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}},
                                   deformed = {{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}};
    const ltmd::MeshView mesh{triangles, verts, uv, 4};
    const ltmd::RestState rest(mesh, rest_positions);
    std::vector<ltmd::Tension> t(verts.size());
    ltmd::tension(rest, deformed, ltmd::Per::corner, t);

    const ltmd::TexelCoverage coverage(mesh, 8, 8);
    std::vector<float> pixels(8 * 8 * 4);
    ltmd::bake(coverage, {t.data()->data(), 3 * t.size()}, 3, ltmd::identity_tension, 4, pixels);
    const std::string path =
        (std::filesystem::path(arguments[0]).parent_path() / "client_tension.0001.exr").string();
    const std::vector<std::string> channels = {"R", "G", "B", "A"};
    ltmd::write_exr(path, pixels, 8, 8, channels, ltmd::Compression::zip,
                    {{"ltmd:convention", "1"}, {"ltmd:pass", "tension"}});
    const ltmd::ExrImage image = ltmd::read_exr(path);
    if (image.pixels != pixels || image.pixels[0] != 2 || image.pixels[2] != 1) {
        std::fprintf(stderr, "the file does not hold the stretch of the square\n");
        return 1;
    }
    try {  // its exceptions can be caught by type outside
        ltmd::read_exr(path + ".none");
        return 1;
    } catch (const ltmd::FileError&) {
    }
    std::printf("stretched %g x %g with ltmd %d.%d\n", image.pixels[0], image.pixels[2],
                LTMD_VERSION_MAJOR, LTMD_VERSION_MINOR);
}
