// SPDX-License-Identifier: Apache-2.0
#include "ltmd/texel_coverage.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <bit>
#include <cmath>
#include <limits>
#include <memory>
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

/// Lists of spans per row of blocks, in the order of items. Per row, not per block: a mesh whose
/// every face fills the tile would need as many entries as it has triangles times blocks.
class Bins {
public:
    explicit Bins(int row_count) : starts_(static_cast<std::size_t>(row_count) + 1) {}

    /// spans(item, add) calls add(row, columns) for each row that the item reaches.
    template <class Spans>
    void build(std::size_t count, const Spans& spans) {
        // Counted first and placed then, by pieces of items: nothing but the result is held.
        const std::size_t rows = starts_.size() - 1;
        std::vector<std::size_t> next((count + piece - 1) / piece * rows);
        const auto each = [&](const auto& add_at) {
            parallel_for(count, piece, [&](std::size_t begin, std::size_t end) {
                std::size_t* piece_next = next.data() + begin / piece * rows;
                for (std::size_t i = begin; i < end; ++i)
                    spans(static_cast<std::int32_t>(i), [&](int row, const IntRange& columns) {
                        if (columns.begin < columns.end)
                            add_at(piece_next[row]++, static_cast<std::int32_t>(i), columns);
                    });
            });
        };
        each([](std::size_t, std::int32_t, const IntRange&) {});
        std::size_t total = 0;
        for (std::size_t row = 0; row < rows; ++row) {
            starts_[row] = total;
            for (std::size_t i = row; i < next.size(); i += rows)
                total += std::exchange(next[i], total);
        }
        starts_[rows] = total;
        spans_ = std::make_unique_for_overwrite<Span[]>(total);
        each([&](std::size_t at, std::int32_t item, const IntRange& columns) {
            spans_[at] = {item, static_cast<std::uint16_t>(columns.begin),
                          static_cast<std::uint16_t>(columns.end)};
        });
    }
    std::span<const Span> operator[](int row) const {
        const auto r = static_cast<std::size_t>(row);
        return {spans_.get() + starts_[r], starts_[r + 1] - starts_[r]};
    }

private:
    static constexpr std::size_t piece = 1 << 14;
    std::vector<std::size_t> starts_;
    std::unique_ptr<Span[]> spans_;
};

std::uint64_t hash(const Point& p) {
    std::uint64_t h = std::bit_cast<std::uint64_t>(p.x) * 0x9E3779B97F4A7C15u;
    h = (std::rotl(h, 29) ^ std::bit_cast<std::uint64_t>(p.y)) * 0xBF58476D1CE4E5B9u;
    return h ^ (h >> 31);
}

/// The slot where a search with this hash begins, of `count` slots.
std::size_t home(std::uint32_t hash, std::size_t count) {
    return static_cast<std::size_t>((std::uint64_t{hash} * count) >> 32);
}
/// Slots of a hash table for so many items: 5 for 4.
std::size_t slots_for(std::size_t items) { return items + items / 4 + 1; }

/// An item by its number, with half of its key's hash.
struct Hashed {
    std::uint32_t hash, item;
};

/// Items in groups, in order. Equal items are in one group and have one hash.
class Groups {
public:
    /// list(i, add) calls add(cell, hash, item) for the items of i, 0 <= i < count; `most`: about
    /// how many items there are. Items of one cell are in one group: matching them reads memory
    /// that a core's cache holds.
    template <class List>
    Groups(std::size_t count, std::size_t most, const List& list) {
        const int bits = std::min(12, static_cast<int>(std::bit_width(most >> 15)));
        const std::size_t groups = std::size_t{1} << bits;
        std::vector<std::size_t> next((count + piece - 1) / piece * groups);
        const auto each = [&](const auto& add_at) {
            parallel_for(count, piece, [&](std::size_t begin, std::size_t end) {
                std::size_t* piece_next = next.data() + begin / piece * groups;
                for (std::size_t i = begin; i < end; ++i)
                    list(i, [&](std::uint64_t cell, std::uint64_t hash, std::uint32_t item) {
                        add_at(piece_next[(cell >> 32) >> (32 - bits)]++,
                               Hashed{static_cast<std::uint32_t>(hash), item});
                    });
            });
        };
        each([](std::size_t, const Hashed&) {});
        starts_.resize(groups + 1);
        std::size_t total = 0;
        for (std::size_t group = 0; group < groups; ++group) {
            starts_[group] = total;
            for (std::size_t i = group; i < next.size(); i += groups)
                total += std::exchange(next[i], total);
        }
        starts_[groups] = total;
        items_ = std::make_unique_for_overwrite<Hashed[]>(total);
        each([&](std::size_t at, const Hashed& item) { items_[at] = item; });
    }

    /// Calls found(items, first) for each group, on several threads: items[first[i]] is the first
    /// item that equal(item, other) says is equal to items[i].
    template <class Equal, class Found>
    void match(const Equal& equal, const Found& found) const {
        parallel_for(starts_.size() - 1, 8, [&](std::size_t begin, std::size_t end) {
            constexpr std::uint32_t empty = std::numeric_limits<std::uint32_t>::max();
            std::vector<std::uint32_t> slots, first;
            for (std::size_t group = begin; group < end; ++group) {
                const std::span<const Hashed> items{items_.get() + starts_[group],
                                                    starts_[group + 1] - starts_[group]};
                slots.assign(slots_for(items.size()), empty);
                first.resize(items.size());
                for (std::uint32_t i = 0; i < items.size(); ++i) {
                    std::size_t slot = home(items[i].hash, slots.size());
                    while (slots[slot] != empty && !(items[slots[slot]].hash == items[i].hash &&
                                                     equal(items[slots[slot]].item, items[i].item)))
                        slot = slot + 1 < slots.size() ? slot + 1 : 0;
                    if (slots[slot] == empty) slots[slot] = i;
                    first[i] = slots[slot];
                }
                found(items, std::span<const std::uint32_t>(first));
            }
        });
    }

private:
    static constexpr std::size_t piece = 1 << 16;
    std::vector<std::size_t> starts_;
    std::unique_ptr<Hashed[]> items_;
};

/// A corner of a triangle, or the edge from it to the next one: 3 triangle + k. Below 2^31, as
/// validate() sees to.
using Corner = std::uint32_t;

/// An edge of the layout's border: covered texels on one side only. A point that no triangle covers
/// has its nearest point of the layout on one of these.
struct BorderEdge {
    Corner edge;              ///< Of the lowest triangle along it.
    Corner owner_a, owner_b;  ///< The lowest triangle's corner at each end.
};

/// The edge with its ends in order.
struct Edge {
    Point a, b;
    Corner corner_a, corner_b;
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
        find_places();
        if (margin_ >= 0) {
            find_border();
            bin_edges();
        }
        bin_triangles();
        place_ = {};
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
    /// A triangle among those that have its three points. The third and further ones, and those
    /// without area or far from the tile, count for nothing.
    enum Place : std::uint8_t { no_place, alone, first_of_several, second };

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

    /// Neighbours have the same number, and equal points.
    std::uint64_t cell(const Point& p) const {
        constexpr double cells = 128;  // each way
        return hash({std::floor(p.x * (cells / width_)), std::floor(p.y * (cells / height_))});
    }

    static double area2(const std::array<Point, 3>& p) {
        return (p[1].x - p[0].x) * (p[2].y - p[0].y) - (p[1].y - p[0].y) * (p[2].x - p[0].x);
    }

    /// Whether the triangle has area and comes within reach of the tile.
    bool is_near(std::int32_t triangle) const {
        const double far = margin_ >= 0 ? reach() : 0;
        const std::array<Point, 3> p = points(triangle);
        const auto [x_low, x_high] = std::minmax({p[0].x, p[1].x, p[2].x});
        const auto [y_low, y_high] = std::minmax({p[0].y, p[1].y, p[2].y});
        if (x_high < -far || x_low > width_ + far || y_high < -far || y_low > height_ + far)
            return false;
        const Triangle& t = mesh_.triangles[static_cast<std::size_t>(triangle)];
        const auto uv = [&](std::size_t k) {
            return mesh_.corner_uv[static_cast<std::size_t>(t[k])];
        };
        return area2(p) != 0 && uv_area_sign(uv(0), uv(1), uv(2)) != 0;
    }

    /// Of triangles in one place (stacked copies, faces that all fill the tile) the first two tell
    /// all.
    void find_places() {
        const auto sorted = [&](std::uint32_t triangle) {
            std::array<Point, 3> p = points(static_cast<std::int32_t>(triangle));
            std::sort(p.begin(), p.end());
            return p;
        };
        const std::size_t count = mesh_.triangles.size();
        const Groups groups(count, count, [&](std::size_t i, const auto& add) {
            if (!is_near(static_cast<std::int32_t>(i))) return;
            const std::array<Point, 3> p = points(static_cast<std::int32_t>(i));
            add(cell(std::min({p[0], p[1], p[2]})), hash(p[0]) + hash(p[1]) + hash(p[2]),
                static_cast<std::uint32_t>(i));
        });
        place_.assign(count, no_place);
        groups.match([&](std::uint32_t a, std::uint32_t b) { return sorted(a) == sorted(b); },
                     [&](std::span<const Hashed> items, std::span<const std::uint32_t> first) {
                         for (std::size_t i = 0; i < items.size(); ++i) {
                             Place& of_first = place_[items[first[i]].item];
                             if (first[i] == i) {
                                 of_first = alone;
                             } else if (of_first == alone) {
                                 of_first = first_of_several;
                                 place_[items[i].item] = second;
                             }
                         }
                     });
    }

    bool is_first(std::size_t triangle) const {
        return place_[triangle] == alone || place_[triangle] == first_of_several;
    }

    /// The blocks of the triangles that may hold a centre.
    void bin_triangles() {
        triangle_bins_.build(place_.size(), [&](std::int32_t triangle, const auto& add) {
            if (place_[static_cast<std::size_t>(triangle)] == no_place) return;
            const std::array<Point, 3> p = points(triangle);
            const auto [x_low, x_high] = std::minmax({p[0].x, p[1].x, p[2].x});
            const auto [y_low, y_high] = std::minmax({p[0].y, p[1].y, p[2].y});
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
                add(row, columns);
            }
        });
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

    Point point_of(Corner corner) const { return point(mesh_.triangles[corner / 3][corner % 3]); }

    Edge edge_of(Corner corner) const {
        const Corner next = corner % 3 < 2 ? corner + 1 : corner - 2;
        const Point a = point_of(corner), b = point_of(next);
        return b < a ? Edge{b, a, next, corner} : Edge{a, b, corner, next};
    }

    void find_border() {
        find_border_edges();
        find_owners();
    }

    void find_border_edges() {
        const std::size_t count = mesh_.triangles.size();
        // An item is 2 corner + side: on which side of the edge its triangle lies.
        const Groups groups(count, 3 * count, [&](std::size_t triangle, const auto& add) {
            if (!is_first(triangle)) return;
            const std::array<Point, 3> p = points(static_cast<std::int32_t>(triangle));
            const bool positive = area2(p) > 0;
            for (std::size_t k = 0; k < 3; ++k) {
                const Point &from = p[k], &to = p[(k + 1) % 3];
                const bool swapped = to < from;
                const Point &a = swapped ? to : from, &b = swapped ? from : to;
                add(cell(a), hash(a) * 3 + hash(b),
                    static_cast<std::uint32_t>(2 * (3 * triangle + k) + (swapped == positive)));
            }
        });
        std::vector<std::uint8_t> is_border(3 * count);
        groups.match(
            [&](std::uint32_t item, std::uint32_t other) {
                const Edge ours = edge_of(item / 2), theirs = edge_of(other / 2);
                return ours.a == theirs.a && ours.b == theirs.b;
            },
            [&](std::span<const Hashed> items, std::span<const std::uint32_t> first) {
                std::vector<unsigned> sides(items.size());
                for (std::size_t i = 0; i < items.size(); ++i)
                    sides[first[i]] |= items[i].item % 2 == 0 ? 1 : 2;
                for (std::size_t i = 0; i < items.size(); ++i)
                    is_border[items[i].item / 2] = first[i] == i && sides[i] != 3;
            });
        border_.reserve(static_cast<std::size_t>(
            std::count(is_border.begin(), is_border.end(), std::uint8_t{1})));
        for (std::size_t corner = 0; corner < is_border.size(); ++corner)
            if (is_border[corner]) border_.push_back({static_cast<Corner>(corner), 0, 0});
    }

    /// At a border vertex every triangle around it is equally near, those without a border edge
    /// too.
    void find_owners() {
        constexpr Corner empty = std::numeric_limits<Corner>::max();
        // A hash table of points; each slot holds the lowest corner at its point.
        std::vector<std::atomic<Corner>> slots(slots_for(2 * border_.size()));
        for (auto& slot : slots) slot.store(empty, std::memory_order_relaxed);
        const auto slot_of = [&](const Point& p) -> std::atomic<Corner>& {
            std::size_t i = home(static_cast<std::uint32_t>(hash(p)), slots.size());
            for (;; i = i + 1 < slots.size() ? i + 1 : 0) {
                const Corner corner = slots[i].load(std::memory_order_relaxed);
                if (corner == empty || point_of(corner) == p) return slots[i];
            }
        };
        for (const BorderEdge& border : border_) {
            const Edge edge = edge_of(border.edge);
            slot_of(edge.a).store(edge.corner_a, std::memory_order_relaxed);
            slot_of(edge.b).store(edge.corner_b, std::memory_order_relaxed);
        }
        constexpr std::size_t piece = 1 << 14;
        parallel_for(mesh_.triangles.size(), piece, [&](std::size_t begin, std::size_t end) {
            for (std::size_t triangle = begin; triangle < end; ++triangle) {
                if (!is_first(triangle)) continue;
                for (std::size_t k = 0; k < 3; ++k) {
                    const Corner corner = static_cast<Corner>(3 * triangle + k);
                    std::atomic<Corner>& slot = slot_of(point_of(corner));
                    Corner seen = slot.load(std::memory_order_relaxed);
                    while (seen != empty && corner < seen &&
                           !slot.compare_exchange_weak(seen, corner, std::memory_order_relaxed)) {
                    }
                }
            }
        });
        parallel_for(border_.size(), piece, [&](std::size_t begin, std::size_t end) {
            for (std::size_t i = begin; i < end; ++i) {
                const Edge edge = edge_of(border_[i].edge);
                border_[i].owner_a = slot_of(edge.a).load(std::memory_order_relaxed);
                border_[i].owner_b = slot_of(edge.b).load(std::memory_order_relaxed);
            }
        });
    }

    void bin_edges() {
        const double far = reach();
        edge_bins_.build(border_.size(), [&](std::int32_t item, const auto& add) {
            const Edge edge = edge_of(border_[static_cast<std::size_t>(item)].edge);
            const auto [y_low, y_high] = std::minmax(edge.a.y, edge.b.y);
            const IntRange rows = block_range({y_low - far, y_high + far}, rows_);
            for (int row = rows.begin; row < rows.end; ++row) {
                const Range band{double(row) * block_size - far,
                                 double(row + 1) * block_size + far};
                const Range x = x_range(edge.a, edge.b, band);
                if (!x.empty()) add(row, block_range({x.low - far, x.high + far}, columns_));
            }
        });
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
            const BorderEdge& border = border_[static_cast<std::size_t>(item)];
            const Edge edge = edge_of(border.edge);
            const Point &a = edge.a, &b = edge.b;
            const double dx = b.x - a.x, dy = b.y - a.y;
            const double inverse_length2 = 1 / (dx * dx + dy * dy);
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
                    const double t = ((px - a.x) * dx + (py - a.y) * dy) * inverse_length2;
                    const double qx = t <= 0 ? a.x : t >= 1 ? b.x : a.x + t * dx;
                    const double qy = t <= 0 ? a.y : t >= 1 ? b.y : a.y + t * dy;
                    const double distance2 = (px - qx) * (px - qx) + (py - qy) * (py - qy);
                    if (only_met && meets(edge, x_texel, y)) met_row[x_texel - block.x0] = 1;
                    if (distance2 > best) continue;
                    const CoverageTexel candidate = texel_on(border, edge, t);
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
    static CoverageTexel texel_on(const BorderEdge& border, const Edge& edge, double t) {
        double weights[3] = {0, 0, 0};
        Corner corner = border.edge;
        if (t <= 0 || t >= 1) {
            corner = t <= 0 ? border.owner_a : border.owner_b;
            weights[corner % 3] = 1;
        } else {
            weights[edge.corner_a % 3] = 1 - t;
            weights[edge.corner_b % 3] = t;
        }
        return {static_cast<std::int32_t>(corner / 3), static_cast<float>(weights[0]),
                static_cast<float>(weights[1])};
    }

    /// Whether the edge passes through the open square of texel (x, y).
    static bool meets(const Edge& edge, int x, int y) {
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
    std::vector<Place> place_;  ///< Of each triangle.
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
    texels_ = std::make_unique_for_overwrite<CoverageTexel[]>(static_cast<std::size_t>(width) *
                                                              static_cast<std::size_t>(height));
    const auto counts = Rasteriser(mesh, width, height, tile, margin).fill(texels_.get());
    covered_ = counts.covered;
    overlapping_ = counts.overlapping;
    triangles_.assign(mesh.triangles.begin(), mesh.triangles.end());
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
