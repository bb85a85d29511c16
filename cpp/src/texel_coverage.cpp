// SPDX-License-Identifier: Apache-2.0
#include "ltmd/texel_coverage.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "ltmd/errors.h"
#include "ltmd/tangent_frame.h"
#include "parallel.h"

namespace ltmd::inline v0 {
namespace {

constexpr int max_size = 65536;
constexpr int max_margin = 64;
// Blocks of texels are the unit of work: their buffers stay in a core's cache.
constexpr int block_size = 128;
constexpr std::size_t block_texels = std::size_t{block_size} * block_size;

struct Point {
    double x, y;
    auto operator<=>(const Point&) const = default;
};

struct Range {
    double low, high;
    bool empty() const { return !(low <= high); }
};

/// The part of segment ab with y in `band`, as a range of x; empty where there is none.
Range x_range(const Point& a, const Point& b, const Range& band) {
    const Point& lower = a.y <= b.y ? a : b;
    const Point& upper = a.y <= b.y ? b : a;
    if (upper.y < band.low || lower.y > band.high) return {1, 0};
    const auto x_at = [&](double y) {
        if (y <= lower.y) return lower.x;
        if (y >= upper.y) return upper.x;
        return lower.x + (y - lower.y) / (upper.y - lower.y) * (upper.x - lower.x);
    };
    const double x0 = x_at(band.low), x1 = x_at(band.high);
    return {std::min(x0, x1), std::max(x0, x1)};
}

/// The whole numbers in [range.low, range.high], kept within [begin, end), as a half-open range.
struct IntRange {
    int begin, end;
};
IntRange whole_numbers(const Range& range, int begin, int end) {
    const auto clamped = [&](double x) {
        return static_cast<int>(std::clamp(x, double(begin), double(end)));
    };
    if (range.empty()) return {begin, begin};
    return {clamped(std::ceil(range.low)), clamped(std::floor(range.high) + 1)};
}

/// An item's blocks in one row of blocks: columns [begin, end).
struct Span {
    std::int32_t item;
    std::uint16_t begin, end;
};

/// Lists of spans per row of blocks, in the order of addition. Per row, not per block: a mesh whose
/// every face fills the tile would need as many entries as it has triangles times blocks.
class Bins {
public:
    explicit Bins(int row_count) : starts_(static_cast<std::size_t>(row_count) + 1) {}

    void add(int row, std::int32_t item, const IntRange& columns) {
        if (columns.begin >= columns.end) return;
        entries_.push_back({{item, static_cast<std::uint16_t>(columns.begin),
                             static_cast<std::uint16_t>(columns.end)},
                            row});
        ++starts_[static_cast<std::size_t>(row) + 1];
    }
    void build() {
        for (std::size_t b = 1; b < starts_.size(); ++b) starts_[b] += starts_[b - 1];
        spans_.resize(entries_.size());
        std::vector<std::size_t> next(starts_.begin(), starts_.end() - 1);
        for (const Entry& entry : entries_)
            spans_[next[static_cast<std::size_t>(entry.row)]++] = entry.span;
        entries_ = {};
    }
    std::span<const Span> operator[](int row) const {
        const auto r = static_cast<std::size_t>(row);
        return std::span(spans_).subspan(starts_[r], starts_[r + 1] - starts_[r]);
    }

private:
    struct Entry {
        Span span;
        int row;
    };
    std::vector<Entry> entries_;
    std::vector<std::size_t> starts_;
    std::vector<Span> spans_;
};

std::size_t hash(const Point& p) {
    std::uint64_t h = std::bit_cast<std::uint64_t>(p.x) * 0x9E3779B97F4A7C15u;
    h = (std::rotl(h, 29) ^ std::bit_cast<std::uint64_t>(p.y)) * 0xBF58476D1CE4E5B9u;
    return static_cast<std::size_t>(h ^ (h >> 31));
}

/// A hash table of indices: find_or_add returns the slot of an equal item, or an empty slot (-1) to
/// fill.
class IndexTable {
public:
    explicit IndexTable(std::size_t capacity) : slots_(std::bit_ceil(2 * capacity + 1), -1) {}

    template <class Equal>
    std::int32_t& find_or_add(std::size_t hash_value, const Equal& equal) {
        const std::size_t mask = slots_.size() - 1;
        for (std::size_t i = hash_value & mask;; i = (i + 1) & mask)
            if (slots_[i] < 0 || equal(slots_[i])) return slots_[i];
    }

private:
    std::vector<std::int32_t> slots_;
};

/// A corner of a triangle: of triangle `triangle`, the `corner`-th.
struct Owner {
    std::int32_t triangle;
    std::int8_t corner;
};

/// An edge of the layout's border: covered texels on one side only. A point that no triangle covers
/// has its nearest point of the layout on one of these.
struct BorderEdge {
    Point a, b;
    double inverse_length2;
    Owner owner_a, owner_b;          ///< The lowest triangle at each end.
    std::int32_t triangle;           ///< The lowest triangle along the edge.
    std::int8_t corner_a, corner_b;  ///< Its corners at a and b.
};

/// E(p) >= 0 on the triangle's side of a line. Computed alike for both triangles of a shared edge,
/// so that no centre is on the inner side of both or of none.
struct EdgeFunction {
    double x, y, dx, dy;

    EdgeFunction(const Point& a, const Point& b, double sign) {
        const bool swapped = b < a;
        const Point& from = swapped ? b : a;
        const Point& to = swapped ? a : b;
        const double s = swapped ? -sign : sign;
        x = from.x, y = from.y;
        dx = s * (to.x - from.x), dy = s * (to.y - from.y);
    }
    double row(double py) const { return dx * (py - y); }
    double at(double row_value, double px) const { return row_value - dy * (px - x); }
};

class Rasteriser {
public:
    Rasteriser(const MeshView& mesh, int width, int height, Tile tile, int margin)
        : mesh_(mesh),
          width_(width),
          height_(height),
          tile_(tile),
          margin_(margin),
          columns_((width + block_size - 1) / block_size),
          rows_((height + block_size - 1) / block_size),
          triangle_bins_(rows_),
          edge_bins_(rows_) {
        bin_triangles();
        if (margin_ >= 0) {
            find_border();
            bin_edges();
        }
    }

    std::size_t block_count() const {
        return static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_);
    }

    struct Counts {
        std::size_t covered = 0, overlapping = 0;
    };

    /// Fills `texels` ([height * width]).
    Counts fill(CoverageTexel* texels) const {
        return for_blocks([&](const Block& block, Buffers& buffers) {
            const Counts counts = fill_centres<true>(block, buffers, texels);
            if (counts.covered < block.texel_count()) fill_margin(block, buffers, texels);
            return counts;
        });
    }

    Counts count() const {
        return for_blocks([&](const Block& block, Buffers& buffers) {
            return fill_centres<false>(block, buffers, nullptr);
        });
    }

private:
    /// What is known of a texel's centre.
    enum State : std::uint8_t { outside, on_border, inside, inside_several };

    struct Buffers {
        std::vector<std::uint8_t> state = std::vector<std::uint8_t>(block_texels);
        std::vector<double> distance2 = std::vector<double>(block_texels);
        std::vector<std::uint8_t> met = std::vector<std::uint8_t>(block_texels);
        std::array<IntRange, block_size>
            open;  ///< Per row, the columns from the first to the last open texel.
    };

    struct Block {
        int column, row;
        int x0, y0, x1, y1;
        std::size_t texel_count() const {
            return static_cast<std::size_t>(x1 - x0) * static_cast<std::size_t>(y1 - y0);
        }
        std::size_t local(int x, int y) const {
            return static_cast<std::size_t>((y - y0) * block_size + (x - x0));
        }
    };

    template <class Body>
    Counts for_blocks(const Body& body) const {
        std::atomic<std::size_t> covered{0}, overlapping{0};
        parallel_for(block_count(), 4, [&](std::size_t begin, std::size_t end) {
            Buffers buffers;
            Counts sum;
            for (std::size_t b = begin; b < end; ++b) {
                const int column = static_cast<int>(b % static_cast<std::size_t>(columns_));
                const int row = static_cast<int>(b / static_cast<std::size_t>(columns_));
                const int x0 = column * block_size, y0 = row * block_size;
                const Block block{column,
                                  row,
                                  x0,
                                  y0,
                                  std::min(x0 + block_size, width_),
                                  std::min(y0 + block_size, height_)};
                const Counts counts = body(block, buffers);
                sum.covered += counts.covered;
                sum.overlapping += counts.overlapping;
            }
            covered += sum.covered;
            overlapping += sum.overlapping;
        });
        return {covered, overlapping};
    }

    double reach() const { return margin_ > 0 ? margin_ : std::sqrt(0.5); }

    Point point(std::int32_t corner) const {
        const Vec2f& uv = mesh_.corner_uv[static_cast<std::size_t>(corner)];
        // "+ 0.0" makes a negative zero positive: equal points have equal bits.
        return {(double(uv[0]) - tile_.u) * width_ + 0.0,
                (1.0 - (double(uv[1]) - tile_.v)) * height_ + 0.0};
    }

    std::array<Point, 3> points(std::int32_t triangle) const {
        const Triangle& t = mesh_.triangles[static_cast<std::size_t>(triangle)];
        return {point(t[0]), point(t[1]), point(t[2])};
    }

    static double area2(const std::array<Point, 3>& p) {
        return (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
    }

    /// The triangles with area that come within reach of the tile, into near_; of those, the ones
    /// that may hold a centre, into bins. Of triangles in one place (stacked copies, faces that all
    /// fill the tile) the first two tell all.
    void bin_triangles() {
        struct Place {
            std::int32_t first;
            bool twice;
        };
        std::vector<Place> places;
        IndexTable table(mesh_.triangles.size());
        const auto sorted = [](std::array<Point, 3> p) {
            std::sort(p.begin(), p.end());
            return p;
        };
        const double far = margin_ >= 0 ? reach() : 0;
        for (std::size_t i = 0; i < mesh_.triangles.size(); ++i) {
            const Triangle& t = mesh_.triangles[i];
            const auto index = static_cast<std::int32_t>(i);
            const std::array<Point, 3> p = points(index);
            const auto [x_low, x_high] = std::minmax({p[0].x, p[1].x, p[2].x});
            const auto [y_low, y_high] = std::minmax({p[0].y, p[1].y, p[2].y});
            if (x_high < -far || x_low > width_ + far || y_high < -far || y_low > height_ + far)
                continue;
            const auto uv = [&](int k) {
                return mesh_.corner_uv[static_cast<std::size_t>(t[static_cast<std::size_t>(k)])];
            };
            if (area2(p) == 0 || uv_area_sign(uv(0), uv(1), uv(2)) == 0) continue;
            std::int32_t& slot =
                table.find_or_add(hash(p[0]) + hash(p[1]) + hash(p[2]), [&](std::int32_t place) {
                    return sorted(points(places[static_cast<std::size_t>(place)].first)) ==
                           sorted(p);
                });
            if (slot < 0) {
                slot = static_cast<std::int32_t>(places.size());
                places.push_back({index, false});
                if (margin_ >= 0) near_.push_back(index);
            } else if (std::exchange(places[static_cast<std::size_t>(slot)].twice, true)) {
                continue;
            }

            const IntRange rows = block_range({y_low, y_high}, rows_);
            for (int row = rows.begin; row < rows.end; ++row) {
                IntRange columns = block_range({x_low, x_high}, columns_);
                if (columns.end - columns.begin > 2) {
                    const Range band{double(row) * block_size, double(row + 1) * block_size};
                    Range x{std::numeric_limits<double>::infinity(),
                            -std::numeric_limits<double>::infinity()};
                    for (std::size_t k = 0; k < 3; ++k)
                        extend(x, x_range(p[k], p[(k + 1) % 3], band));
                    columns = block_range(x, columns_);
                }
                triangle_bins_.add(row, index, columns);
            }
        }
        triangle_bins_.build();
    }

    static void extend(Range& range, const Range& other) {
        if (other.empty()) return;
        range.low = std::min(range.low, other.low);
        range.high = std::max(range.high, other.high);
    }

    /// The blocks that [low, high] reaches into, with a little room for rounding.
    static IntRange block_range(const Range& texels, int count) {
        constexpr double slack = 1e-3;
        if (texels.empty()) return {0, 0};
        return whole_numbers({std::floor((texels.low - slack) / block_size),
                              std::floor((texels.high + slack) / block_size)},
                             0, count);
    }

    void find_border() {
        struct Edge {
            Point a, b;
            std::int32_t triangle;
            std::int8_t corner_a, corner_b;
            std::uint8_t sides;
        };
        std::vector<Edge> edges;
        edges.reserve(2 * near_.size());
        IndexTable edge_table(3 * near_.size());
        for (const std::int32_t triangle : near_) {
            const std::array<Point, 3> p = points(triangle);
            const bool positive = area2(p) > 0;
            for (std::int8_t k = 0; k < 3; ++k) {
                std::int8_t ca = k, cb = static_cast<std::int8_t>((k + 1) % 3);
                Point a = p[static_cast<std::size_t>(ca)], b = p[static_cast<std::size_t>(cb)];
                const bool swapped = b < a;
                if (swapped) std::swap(a, b), std::swap(ca, cb);
                std::int32_t& slot =
                    edge_table.find_or_add(hash(a) * 3 + hash(b), [&](std::int32_t e) {
                        const Edge& other = edges[static_cast<std::size_t>(e)];
                        return other.a == a && other.b == b;
                    });
                if (slot < 0) {
                    slot = static_cast<std::int32_t>(edges.size());
                    edges.push_back({a, b, triangle, ca, cb, 0});
                }
                edges[static_cast<std::size_t>(slot)].sides |= swapped == positive ? 1 : 2;
            }
        }
        std::size_t border_count = 0;
        for (const Edge& edge : edges) border_count += edge.sides != 3;
        border_.reserve(border_count);

        // At a border vertex every triangle around it is equally near, those without a border edge
        // too.
        std::vector<Point> vertices;
        std::vector<Owner> owners;
        IndexTable vertex_table(2 * border_count);
        const auto vertex = [&](const Point& p) -> std::int32_t& {
            return vertex_table.find_or_add(hash(p), [&](std::int32_t v) {
                return vertices[static_cast<std::size_t>(v)] == p;
            });
        };
        for (const Edge& edge : edges) {
            if (edge.sides == 3) continue;
            for (const Point& p : {edge.a, edge.b}) {
                std::int32_t& slot = vertex(p);
                if (slot >= 0) continue;
                slot = static_cast<std::int32_t>(vertices.size());
                vertices.push_back(p);
            }
        }
        owners.assign(vertices.size(), {-1, 0});
        for (const std::int32_t triangle : near_) {
            const std::array<Point, 3> p = points(triangle);
            for (std::int8_t k = 0; k < 3; ++k) {
                const std::int32_t v = vertex(p[static_cast<std::size_t>(k)]);
                if (v >= 0 && owners[static_cast<std::size_t>(v)].triangle < 0)
                    owners[static_cast<std::size_t>(v)] = {triangle, k};
            }
        }
        for (const Edge& edge : edges) {
            if (edge.sides == 3) continue;
            const double dx = edge.b.x - edge.a.x, dy = edge.b.y - edge.a.y;
            border_.push_back({edge.a, edge.b, 1 / (dx * dx + dy * dy),
                               owners[static_cast<std::size_t>(vertex(edge.a))],
                               owners[static_cast<std::size_t>(vertex(edge.b))], edge.triangle,
                               edge.corner_a, edge.corner_b});
        }
        near_ = {};
    }

    void bin_edges() {
        const double far = reach();
        for (std::size_t i = 0; i < border_.size(); ++i) {
            const BorderEdge& edge = border_[i];
            const auto [y_low, y_high] = std::minmax(edge.a.y, edge.b.y);
            const IntRange rows = block_range({y_low - far, y_high + far}, rows_);
            for (int row = rows.begin; row < rows.end; ++row) {
                const Range band{double(row) * block_size - far,
                                 double(row + 1) * block_size + far};
                const Range x = x_range(edge.a, edge.b, band);
                if (!x.empty())
                    edge_bins_.add(row, static_cast<std::int32_t>(i),
                                   block_range({x.low - far, x.high + far}, columns_));
            }
        }
        edge_bins_.build();
    }

    /// The texels whose centre lies in a triangle; all others get "not covered".
    template <bool store>
    Counts fill_centres(const Block& block, Buffers& buffers, CoverageTexel* texels) const {
        std::fill(buffers.state.begin(), buffers.state.end(), std::uint8_t{outside});
        const auto stride = static_cast<std::size_t>(width_);
        if constexpr (store)
            for (int y = block.y0; y < block.y1; ++y) {
                CoverageTexel* row = texels + static_cast<std::size_t>(y) * stride;
                std::fill(row + block.x0, row + block.x1, CoverageTexel{-1, 0, 0});
            }
        Counts counts;
        std::size_t settled = 0;  // texels that nothing can change
        for (const auto& [triangle, begin, end] : triangle_bins_[block.row]) {
            if (block.column < begin || block.column >= end) continue;
            if (settled == block.texel_count()) break;
            const std::array<Point, 3> p = points(triangle);
            const double area = area2(p), sign = area > 0 ? 1 : -1,
                         inverse_area = 1 / std::abs(area);
            const EdgeFunction edges[3] = {
                {p[1], p[2], sign}, {p[2], p[0], sign}, {p[0], p[1], sign}};
            const auto [y_low, y_high] = std::minmax({p[0].y, p[1].y, p[2].y});
            const auto [x_low, x_high] = std::minmax({p[0].x, p[1].x, p[2].x});
            const IntRange rows = whole_numbers({y_low - 0.5, y_high - 0.5}, block.y0, block.y1);
            for (int y = rows.begin; y < rows.end; ++y) {
                const double py = y + 0.5;
                const double row0 = edges[0].row(py), row1 = edges[1].row(py),
                             row2 = edges[2].row(py);
                // A texel of room on both sides: the edge functions decide.
                Range span{x_low, x_high};
                for (const auto& [edge, row] :
                     {std::pair{edges[0], row0}, {edges[1], row1}, {edges[2], row2}}) {
                    if (edge.dy > 0) span.high = std::min(span.high, edge.x + row / edge.dy);
                    if (edge.dy < 0) span.low = std::max(span.low, edge.x + row / edge.dy);
                }
                const IntRange xs =
                    whole_numbers({span.low - 1.5, span.high + 0.5}, block.x0, block.x1);
                CoverageTexel* texel_row =
                    store ? texels + static_cast<std::size_t>(y) * stride : nullptr;
                std::uint8_t* state_row = buffers.state.data() + block.local(block.x0, y);
                for (int x = xs.begin; x < xs.end; ++x) {
                    const double px = x + 0.5;
                    const double e0 = edges[0].at(row0, px), e1 = edges[1].at(row1, px),
                                 e2 = edges[2].at(row2, px);
                    if (!(e0 >= 0 && e1 >= 0 && e2 >= 0)) continue;
                    const bool strictly = e0 > 0 && e1 > 0 && e2 > 0;
                    std::uint8_t& state = state_row[x - block.x0];
                    if (state == outside) {
                        state = strictly ? inside : on_border;
                        ++counts.covered;
                        if constexpr (store) {
                            const double b0 = std::min(e0 * inverse_area, 1.0);
                            texel_row[x] = {
                                triangle, static_cast<float>(b0),
                                static_cast<float>(std::min(e1 * inverse_area, 1 - b0))};
                        }
                    } else if (strictly) {
                        counts.overlapping += state == inside;
                        settled += state == inside;
                        state = state == on_border ? inside : inside_several;
                    }
                }
            }
        }
        return counts;
    }

    /// The uncovered texels within reach of the border.
    void fill_margin(const Block& block, Buffers& buffers, CoverageTexel* texels) const {
        // Where charts are small and many, nearly every texel is settled by its close surroundings.
        constexpr double close = 3;
        if (reach() > 2 * close) {
            if (!open_texels(block, buffers, texels, close * close)) return;
            visit_edges(block, buffers, texels, close);
        }
        const double far2 = margin_ > 0 ? reach() * reach() : 0.5;
        if (!open_texels(block, buffers, texels, far2)) return;
        std::fill(buffers.met.begin(), buffers.met.end(), std::uint8_t{0});
        visit_edges(block, buffers, texels, reach());
        if (margin_ > 0) return;
        for (int y = block.y0; y < block.y1; ++y)
            for (int x = block.x0; x < block.x1; ++x) {
                const std::size_t i = block.local(x, y);
                if (buffers.state[i] == outside && !buffers.met[i])
                    texels[index(x, y)] = {-1, 0, 0};
            }
    }

    std::size_t index(int x, int y) const {
        return static_cast<std::size_t>(y) * static_cast<std::size_t>(width_) +
               static_cast<std::size_t>(x);
    }

    /// Texels without a triangle are open up to the distance, all others closed; false if none is
    /// open.
    bool open_texels(const Block& block, Buffers& buffers, const CoverageTexel* texels,
                     double distance2) const {
        bool any = false;
        for (int y = block.y0; y < block.y1; ++y) {
            const CoverageTexel* texel_row = texels + index(0, y);
            IntRange& columns = buffers.open[static_cast<std::size_t>(y - block.y0)];
            columns = {block.x1, block.x0};
            double* distance_row = buffers.distance2.data() + block.local(block.x0, y);
            for (int x = block.x0; x < block.x1; ++x) {
                const bool is_open = texel_row[x].triangle < 0;
                distance_row[x - block.x0] = is_open ? distance2 : -1;
                if (!is_open) continue;
                columns.begin = std::min(columns.begin, x);
                columns.end = x + 1;
                any = true;
            }
        }
        return any;
    }

    /// Gives open texels the nearest point of the border edges within `far`.
    void visit_edges(const Block& block, Buffers& buffers, CoverageTexel* texels,
                     double far) const {
        const bool only_met = margin_ == 0;
        for (const auto& [item, begin, end] : edge_bins_[block.row]) {
            if (block.column < begin || block.column >= end) continue;
            const BorderEdge& edge = border_[static_cast<std::size_t>(item)];
            const Point &a = edge.a, &b = edge.b;
            const double dx = b.x - a.x, dy = b.y - a.y;
            const auto [y_low, y_high] = std::minmax(a.y, b.y);
            const IntRange rows =
                whole_numbers({y_low - far - 0.5, y_high + far - 0.5}, block.y0, block.y1);
            for (int y = rows.begin; y < rows.end; ++y) {
                const IntRange open = buffers.open[static_cast<std::size_t>(y - block.y0)];
                if (open.begin >= open.end) continue;
                const double py = y + 0.5;
                const Range x = x_range(a, b, {py - far, py + far});
                if (x.empty()) continue;
                const IntRange xs =
                    whole_numbers({x.low - far - 0.5, x.high + far - 0.5}, open.begin, open.end);
                CoverageTexel* texel_row = texels + index(0, y);
                const std::size_t local = block.local(block.x0, y);
                double* distance_row = buffers.distance2.data() + local;
                std::uint8_t* met_row = buffers.met.data() + local;
                for (int x_texel = xs.begin; x_texel < xs.end; ++x_texel) {
                    double& best = distance_row[x_texel - block.x0];
                    if (best < 0) continue;
                    const double px = x_texel + 0.5;
                    const double t = ((px - a.x) * dx + (py - a.y) * dy) * edge.inverse_length2;
                    const double qx = t <= 0 ? a.x : t >= 1 ? b.x : a.x + t * dx;
                    const double qy = t <= 0 ? a.y : t >= 1 ? b.y : a.y + t * dy;
                    const double distance2 = (px - qx) * (px - qx) + (py - qy) * (py - qy);
                    if (only_met && meets(edge, x_texel, y)) met_row[x_texel - block.x0] = 1;
                    if (distance2 > best) continue;
                    const CoverageTexel candidate = texel_on(edge, t);
                    CoverageTexel& texel = texel_row[x_texel];
                    if (distance2 < best || texel.triangle < 0 ||
                        candidate.triangle < texel.triangle)
                        texel = candidate;
                    best = distance2;
                }
            }
        }
    }

    /// The point at a + t (b - a) of a border edge, kept on the edge.
    static CoverageTexel texel_on(const BorderEdge& edge, double t) {
        double weights[3] = {0, 0, 0};
        std::int32_t triangle = edge.triangle;
        if (t <= 0 || t >= 1) {
            const Owner& owner = t <= 0 ? edge.owner_a : edge.owner_b;
            triangle = owner.triangle;
            weights[owner.corner] = 1;
        } else {
            weights[edge.corner_a] = 1 - t;
            weights[edge.corner_b] = t;
        }
        return {triangle, static_cast<float>(weights[0]), static_cast<float>(weights[1])};
    }

    /// Whether the edge passes through the open square of texel (x, y).
    static bool meets(const BorderEdge& edge, int x, int y) {
        double low = -std::numeric_limits<double>::infinity(),
               high = std::numeric_limits<double>::infinity();
        const auto clip = [&](double from, double delta, double side) {
            if (delta == 0) return from > side && from < side + 1;
            const double t0 = (side - from) / delta, t1 = (side + 1 - from) / delta;
            low = std::max(low, std::min(t0, t1));
            high = std::min(high, std::max(t0, t1));
            return true;
        };
        return clip(edge.a.x, edge.b.x - edge.a.x, x) && clip(edge.a.y, edge.b.y - edge.a.y, y) &&
               low < high && low < 1 && high > 0;
    }

    const MeshView& mesh_;
    int width_, height_;
    Tile tile_;
    int margin_;  ///< -1: centres only.
    int columns_, rows_;
    Bins triangle_bins_, edge_bins_;
    std::vector<std::int32_t> near_;
    std::vector<BorderEdge> border_;
};

}  // namespace

TexelCoverage::TexelCoverage(const MeshView& mesh, int width, int height, Tile tile, int margin)
    : width_(width), height_(height), tile_(tile), corner_count_(mesh.corner_vert.size()) {
    if (width < 1 || height < 1 || width > max_size || height > max_size)
        throw InvalidInput("texture size " + std::to_string(width) + " x " +
                           std::to_string(height) + " is outside 1 to " + std::to_string(max_size) +
                           " texels a side");
    if (margin < 0 || margin > max_margin)
        throw InvalidInput("margin " + std::to_string(margin) + " is outside 0 to " +
                           std::to_string(max_margin) + " texels");
    validate(mesh);
    require_uv(mesh);
    triangles_.assign(mesh.triangles.begin(), mesh.triangles.end());
    texels_ = std::make_unique_for_overwrite<CoverageTexel[]>(static_cast<std::size_t>(width) *
                                                              static_cast<std::size_t>(height));
    const auto counts = Rasteriser(mesh, width, height, tile, margin).fill(texels_.get());
    covered_ = counts.covered;
    overlapping_ = counts.overlapping;
}

double overlap_fraction(const MeshView& mesh, int resolution) {
    if (resolution < 1 || resolution > max_size)
        throw InvalidInput("resolution " + std::to_string(resolution) + " is outside 1 to " +
                           std::to_string(max_size));
    validate(mesh);
    require_uv(mesh);
    std::size_t covered = 0, overlapping = 0;
    for (const Tile& tile : tiles(mesh)) {
        const auto counts = Rasteriser(mesh, resolution, resolution, tile, -1).count();
        covered += counts.covered;
        overlapping += counts.overlapping;
    }
    return covered == 0 ? 0 : static_cast<double>(overlapping) / static_cast<double>(covered);
}

}  // namespace ltmd::inline v0
