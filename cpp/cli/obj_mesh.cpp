// SPDX-License-Identifier: Apache-2.0
#include "obj_mesh.h"

#include <tiny_obj_loader.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sstream>
#include <streambuf>

#include "errors.h"
#include "polygon.h"

namespace ltmd::cli {
namespace {

/// Hands a file to the loader line by line, so that its callbacks know the line they are for.
class Lines : public std::streambuf {
public:
    explicit Lines(std::streambuf& file) : file_(file) {}
    std::size_t number() const { return number_; }
    /// The words of the line after the first.
    std::vector<std::string> words() const {
        std::vector<std::string> found;
        std::istringstream line(text_);
        for (std::string word; line >> word;) found.push_back(word);
        if (!found.empty()) found.erase(found.begin());
        return found;
    }

protected:
    int_type underflow() override {
        text_.clear();
        for (int_type c; (c = file_.sbumpc()) != traits_type::eof();) {
            // The loader looks beyond a '\r'.
            if (c == '\r' && file_.sgetc() == '\n') c = file_.sbumpc();
            text_ += c == '\r' ? '\n' : traits_type::to_char_type(c);
            if (text_.back() == '\n') break;
        }
        if (text_.empty()) return traits_type::eof();
        ++number_;
        setg(text_.data(), text_.data(), text_.data() + text_.size());
        return traits_type::to_int_type(text_.front());
    }

private:
    std::streambuf& file_;
    std::string text_;
    std::size_t number_ = 0;
};

/// What a file says, faces with their corners one after another; -1: no texture coordinate.
struct ObjFile {
    std::vector<Vec3f> positions;
    std::vector<Vec2f> uvs;
    std::vector<std::size_t> face_sizes;
    std::vector<std::int32_t> vert, uv;
    const Lines& line;
    std::string problem;  ///< The first one.

    void report(const std::string& what) {
        if (problem.empty()) problem = "line " + std::to_string(line.number()) + ": " + what;
    }
};

/// The loader takes what it cannot read for 0.
void require_numbers(ObjFile& file, std::size_t least, std::size_t used, const char* what) {
    const std::vector<std::string> words = file.line.words();
    if (words.size() < least)
        file.report(std::string(what) + " has " + std::to_string(words.size()) + " of " +
                    std::to_string(least) + " numbers");
    for (std::size_t i = 0; i < std::min(used, words.size()); ++i) {
        char* end = nullptr;
        const double value = std::strtod(words[i].c_str(), &end);
        if (*end != '\0' || !std::isfinite(static_cast<float>(value)))
            file.report(std::string(what) + " has '" + words[i] + "', not a finite number");
    }
}

/// The loader wraps what does not fit an int.
void require_small(ObjFile& file) {
    for (const std::string& word : file.line.words())
        for (const char* c = word.c_str(); *c != '\0';) {
            char* end = nullptr;
            const long long index = std::strtoll(c, &end, 10);
            if (std::abs(index) > std::numeric_limits<int>::max())
                file.report("a face uses the index " + word);
            c = end > c ? end : c + 1;
        }
}

/// Counted from 1, or backwards from the last one read; -1 and a problem when there is none.
std::int32_t index_of(int written, std::size_t count, const char* what, ObjFile& file) {
    const auto end = static_cast<std::int64_t>(count);
    const std::int64_t index = written > 0 ? written - 1 : end + written;
    if (written != 0 && index >= 0 && index < end) return static_cast<std::int32_t>(index);
    file.report("a face uses " + std::string(what) + " " + std::to_string(written) + " of " +
                std::to_string(count));
    return -1;
}

void add_face(void* data, tinyobj::index_t* corners, int count) {
    auto& file = *static_cast<ObjFile*>(data);
    if (count < 3) return;
    require_small(file);
    file.face_sizes.push_back(static_cast<std::size_t>(count));
    for (int i = 0; i < count; ++i) {
        const int uv = corners[i].texcoord_index;
        file.vert.push_back(
            index_of(corners[i].vertex_index, file.positions.size(), "vertex", file));
        file.uv.push_back(uv == 0 ? -1 : index_of(uv, file.uvs.size(), "texture coordinate", file));
    }
}

ObjFile load(const std::string& path) {
    std::ifstream stream{std::filesystem::path(path), std::ios::binary};
    std::error_code error;
    if (!stream || std::filesystem::is_directory(path, error))
        throw BadInput(path + ": cannot be read" +
                       (std::filesystem::exists(path, error) ? "" : " (there is no such file)"));
    Lines lines(*stream.rdbuf());
    std::istream text(&lines);
    ObjFile file{{}, {}, {}, {}, {}, lines, {}};
    tinyobj::callback_t callbacks;
    callbacks.vertex_cb = [](void* data, float x, float y, float z, float) {
        auto& read = *static_cast<ObjFile*>(data);
        require_numbers(read, 3, 3, "a vertex");
        read.positions.push_back({x, y, z});
    };
    callbacks.texcoord_cb = [](void* data, float u, float v, float) {
        auto& read = *static_cast<ObjFile*>(data);
        require_numbers(read, 1, 2, "a texture coordinate");
        read.uvs.push_back({u, v});
    };
    callbacks.index_cb = add_face;
    // Without a reader of materials a missing .mtl file is no problem.
    std::string warning, problem;
    if (!tinyobj::LoadObjWithCallback(text, callbacks, &file, nullptr, &warning, &problem))
        throw BadInput(path + ": is not a valid OBJ file");
    if (stream.bad() || text.bad()) throw BadInput(path + ": cannot be read to its end");
    if (!file.problem.empty()) throw BadInput(path + ": " + file.problem);
    return file;
}

}  // namespace

MeshView ObjMesh::view() const {
    return {triangles, corner_vert, corner_uv, static_cast<std::int32_t>(positions.size())};
}

ObjMesh read_rest(const std::string& path) {
    ObjFile file = load(path);
    if (file.face_sizes.empty()) throw BadInput(path + ": has no faces");
    if (file.uvs.empty())
        throw BadInput(path +
                       ": has no texture coordinates (vt); unwrap the mesh and export it with UVs");
    std::size_t without_uv = 0;
    for (const std::int32_t uv : file.uv) without_uv += uv < 0;
    if (without_uv > 0)
        throw BadInput(path + ": has " + std::to_string(without_uv) +
                       " face corners without a texture coordinate (vt); unwrap the whole mesh");

    ObjMesh mesh;
    mesh.corner_uv.reserve(file.uv.size());
    for (const std::int32_t uv : file.uv)
        mesh.corner_uv.push_back(file.uvs[static_cast<std::size_t>(uv)]);
    std::vector<Vec3f> corners;
    std::vector<std::array<std::size_t, 3>> cut;
    std::size_t first = 0;
    for (const std::size_t size : file.face_sizes) {
        corners.clear();
        cut.clear();
        for (std::size_t i = 0; i < size; ++i)
            corners.push_back(file.positions[static_cast<std::size_t>(file.vert[first + i])]);
        cut_polygon(corners, cut);
        for (const auto& [a, b, c] : cut)
            mesh.triangles.push_back({static_cast<std::int32_t>(first + a),
                                      static_cast<std::int32_t>(first + b),
                                      static_cast<std::int32_t>(first + c)});
        first += size;
    }
    mesh.positions = std::move(file.positions);
    mesh.corner_vert = std::move(file.vert);
    mesh.face_sizes = std::move(file.face_sizes);
    return mesh;
}

std::vector<Vec3f> read_deformed(const std::string& path, const ObjMesh& rest) {
    ObjFile file = load(path);
    const auto require = [&](std::size_t ours, std::size_t theirs, const char* what) {
        if (ours != theirs)
            throw BadInput(path + ": has " + std::to_string(ours) + " " + what +
                           ", the rest state has " + std::to_string(theirs));
    };
    require(file.positions.size(), rest.positions.size(), "vertices");
    require(file.face_sizes.size(), rest.face_sizes.size(), "faces");
    require(file.vert.size(), rest.corner_vert.size(), "face corners");
    if (file.face_sizes != rest.face_sizes || file.vert != rest.corner_vert)
        throw BadInput(path + ": its faces join other vertices than those of the rest state");
    return std::move(file.positions);
}

}  // namespace ltmd::cli
