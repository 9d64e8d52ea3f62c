// neighbours.cpp: one cell grid for each class of sizes; a particle searches the grids of its own class and of the larger ones.
//
// A class holds reaches within a factor of two and its cells are two of its largest reaches wide, so every search visits at most
// three or four cells an axis, however different the particles are. A periodic search counts cells beyond the box as well: the box
// that such a cell lies in is the image. Cells stand in a table by their index modulo its length, so an empty box costs no memory.
#include "core/neighbours.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/grouping.h"
#include "core/parallel.h"

namespace kiln {
namespace {

using Cell = std::array<std::int64_t, 3>;

constexpr std::int64_t max_cells = 1 << 20;  // along an axis, so that a cell's index fits into 60 bits
constexpr double rounding_margin = 1e-9;      // in cells, so that no pair is lost to the rounding of a cell coordinate
constexpr double farthest_home = 1e9;         // boxes that a position may be away from the box
constexpr std::size_t chunk_particles = 512;  // particles a task; fixed, whatever the number of threads
constexpr std::size_t fewest_tasks = 16;      // from which it pays to wake threads

struct Entry {
    Vec3 position;                     // m, as given
    double reach;                      // m
    std::uint64_t cell;                // index of its cell
    std::array<std::int32_t, 3> home;  // whole boxes from the box to the position, zero along axes that are not periodic
    std::int32_t row;
};

/// Where cell coordinates start, and how long the grid is along each axis.
struct Frame {
    Vec3 start, extent;  // m
    std::array<bool, 3> periodic;

    /// Coordinate in the frame, 0 to 1, and the whole boxes taken from it.
    double fraction(double position, int axis, std::int32_t& home) const {
        const double scaled = (position - start[axis]) / extent[axis];
        if (!periodic[static_cast<std::size_t>(axis)]) {
            home = 0;
            return scaled;
        }
        const double boxes = std::floor(scaled);
        home = static_cast<std::int32_t>(boxes);
        return scaled - boxes;
    }
};

struct Grid {
    std::array<std::int64_t, 3> cells;
    double max_reach;            // m
    std::uint64_t places = 0;        // of the table
    std::vector<std::size_t> begin;  // first entry of each place, and the end
    std::vector<Entry> entries;

    std::uint64_t index(const Cell& cell) const {
        return static_cast<std::uint64_t>(cell[0] + cells[0] * (cell[1] + cells[1] * cell[2]));
    }

    std::size_t place(std::uint64_t cell) const {
        return cell < places ? cell : cell % places;
    }
};

Frame frame_of(const Box& box, std::span<const Vec3> position) {
    Vec3 low = Vec3::Constant(std::numeric_limits<double>::infinity());
    Vec3 high = -low;
    for (std::size_t row = 0; row < position.size(); ++row) {
        if (!position[row].allFinite()) throw Error("particle row " + std::to_string(row) + ": its position is not finite");
        low = low.cwiseMin(position[row]);
        high = high.cwiseMax(position[row]);
    }
    Frame frame{low, (high - low).cwiseMax(std::numeric_limits<double>::min()), box.periodic};
    for (int axis = 0; axis < 3; ++axis) {
        if (!box.periodic[static_cast<std::size_t>(axis)]) continue;
        frame.start[axis] = box.origin[axis];
        frame.extent[axis] = box.lengths[axis];
        if (std::max(std::abs(low[axis] - box.origin[axis]), std::abs(high[axis] - box.origin[axis])) >
            farthest_home * box.lengths[axis])
            throw Error("a particle lies more than 1e9 box lengths outside the box along axis " + std::to_string(axis));
    }
    return frame;
}

/// Class of a reach: how often the smallest reach doubles up to it.
std::size_t size_class(double reach, double smallest) { return static_cast<std::size_t>(std::ilogb(reach / smallest)); }

void number_cells(Grid& grid, const Frame& frame) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double fitting = std::floor(frame.extent[static_cast<int>(axis)] / (2.0 * grid.max_reach));
        grid.cells[axis] = static_cast<std::int64_t>(std::clamp(fitting, 1.0, static_cast<double>(max_cells)));
    }
}

/// Puts the entries into the order of their places in the table; within a place the rows stay ascending.
void sort_into_places(Grid& grid) {
    const auto all_cells = static_cast<std::size_t>(grid.cells[0] * grid.cells[1] * grid.cells[2]);
    grid.places = std::min(all_cells, 4 * grid.entries.size() + 1);
    Grouping<Entry> sorted = group_by<Entry>(grid.places, [&](const auto& visit) {
        for (const Entry& entry : grid.entries) visit(grid.place(entry.cell), entry);
    });
    grid.begin = std::move(sorted.begin);
    grid.entries = std::move(sorted.items);
}

/// Grids of the classes that have particles, small to large.
std::vector<Grid> build_grids(const Frame& frame, std::span<const Vec3> position, std::span<const double> reach) {
    const double smallest = *std::min_element(reach.begin(), reach.end());
    const double largest = *std::max_element(reach.begin(), reach.end());
    std::vector<Grid> grids(size_class(largest, smallest) + 1);
    for (std::size_t row = 0; row < reach.size(); ++row) {
        Grid& grid = grids[size_class(reach[row], smallest)];
        if (grid.entries.empty()) grid.max_reach = 0.0;
        grid.max_reach = std::max(grid.max_reach, reach[row]);
        grid.entries.push_back({position[row], reach[row], 0, {0, 0, 0}, static_cast<std::int32_t>(row)});
    }
    std::erase_if(grids, [](const Grid& grid) { return grid.entries.empty(); });
    for (Grid& grid : grids) {
        number_cells(grid, frame);
        for (Entry& entry : grid.entries) {
            Cell cell;
            for (std::size_t axis = 0; axis < 3; ++axis) {
                const double fraction =
                    frame.fraction(entry.position[static_cast<int>(axis)], static_cast<int>(axis), entry.home[axis]);
                cell[axis] =
                    std::min(static_cast<std::int64_t>(fraction * static_cast<double>(grid.cells[axis])), grid.cells[axis] - 1);
            }
            entry.cell = grid.index(cell);
        }
        sort_into_places(grid);
    }
    return grids;
}

/// Cells of a grid along one axis that a search visits, and the image each of them belongs to.
struct Visit {
    std::int64_t first, last;  // counted on beyond the box where the axis is periodic
    std::int64_t cells;

    std::int64_t image(std::int64_t cell) const { return cell >= 0 ? cell / cells : -((cells - 1 - cell) / cells); }
};

Visit visit_axis(const Frame& frame, const Grid& grid, const Entry& entry, int axis) {
    const auto at = static_cast<std::size_t>(axis);
    std::int32_t home = 0;
    const auto cells = static_cast<double>(grid.cells[at]);
    const double centre = frame.fraction(entry.position[axis], axis, home) * cells;
    const double range =
        (entry.reach + grid.max_reach) / frame.extent[axis] * cells * (1.0 + rounding_margin) + rounding_margin;
    if (frame.periodic[at])
        return {static_cast<std::int64_t>(std::floor(centre - range)), static_cast<std::int64_t>(std::floor(centre + range)),
                grid.cells[at]};
    return {static_cast<std::int64_t>(std::floor(std::clamp(centre - range, 0.0, cells - 1.0))),
            static_cast<std::int64_t>(std::floor(std::clamp(centre + range, 0.0, cells - 1.0))), grid.cells[at]};
}

bool is_positive(const std::array<std::int64_t, 3>& image) { return image > std::array<std::int64_t, 3>{0, 0, 0}; }

/// Adds the pair if the two are near. image: whole boxes from entry's copy of the box to the other's.
/// Throws Error if an image does not fit.
void add_if_near(const Box& box, const Entry& entry, const Entry& other, std::array<std::int64_t, 3> image,
                 std::vector<Pair>& pairs) {
    Vec3 apart = other.position - entry.position;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        image[axis] += entry.home[axis] - other.home[axis];
        apart[static_cast<int>(axis)] += static_cast<double>(image[axis]) * box.lengths[static_cast<int>(axis)];
    }
    const double near = entry.reach + other.reach;
    if (apart.squaredNorm() >= near * near) return;
    if (entry.row == other.row && !is_positive(image)) return;
    const bool in_order = entry.row <= other.row;
    Pair pair{in_order ? entry.row : other.row, in_order ? other.row : entry.row, {}};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const std::int64_t signed_image = in_order ? image[axis] : -image[axis];
        pair.image[axis] = static_cast<std::int8_t>(signed_image);
        if (pair.image[axis] != signed_image)
            throw Error("particle rows " + std::to_string(pair.i) + " and " + std::to_string(pair.j) +
                        ": they are neighbours over " + std::to_string(signed_image) + " boxes along axis " + std::to_string(axis) +
                        ", more than an image can hold");
    }
    pairs.push_back(pair);
}

/// Pairs of an entry with the particles of a grid, without those that `searches_too` says look for it and have lower rows.
template <typename SearchesToo>
void search(const Box& box, const Frame& frame, const Entry& entry, const Grid& grid, const SearchesToo& searches_too,
            std::vector<Pair>& pairs) {
    const std::array<Visit, 3> visit{visit_axis(frame, grid, entry, 0), visit_axis(frame, grid, entry, 1),
                                     visit_axis(frame, grid, entry, 2)};
    std::array<std::int64_t, 3> image;
    for (std::int64_t z = visit[2].first; z <= visit[2].last; ++z) {
        image[2] = visit[2].image(z);
        for (std::int64_t y = visit[1].first; y <= visit[1].last; ++y) {
            image[1] = visit[1].image(y);
            for (std::int64_t x = visit[0].first; x <= visit[0].last; ++x) {
                image[0] = visit[0].image(x);
                const std::uint64_t cell =
                    grid.index({x - image[0] * grid.cells[0], y - image[1] * grid.cells[1], z - image[2] * grid.cells[2]});
                const std::size_t place = grid.place(cell);
                for (std::size_t at = grid.begin[place]; at < grid.begin[place + 1]; ++at) {
                    const Entry& other = grid.entries[at];
                    if (other.cell != cell || (other.row < entry.row && searches_too(other.row))) continue;
                    add_if_near(box, entry, other, image, pairs);
                }
            }
        }
    }
}

/// Pairs of the entries [first, last) of a grid with their own class and all larger ones.
std::vector<Pair> search_chunk(const Box& box, const Frame& frame, std::span<const Grid> from_own, std::size_t first,
                               std::size_t last) {
    std::vector<Pair> pairs;
    for (std::size_t at = first; at < last; ++at)
        for (std::size_t level = 0; level < from_own.size(); ++level)
            search(box, frame, from_own.front().entries[at], from_own[level], [&](std::int32_t) { return level == 0; }, pairs);
    return pairs;
}

/// Joins the chunks and sorts by i, then j, then image.
std::vector<Pair> sorted_pairs(std::span<const std::vector<Pair>> chunks, std::size_t particles) {
    Grouping<Pair> pairs = group_by<Pair>(particles, [&](const auto& visit) {
        for (const auto& chunk : chunks)
            for (const Pair& pair : chunk) visit(static_cast<std::size_t>(pair.i), pair);
    });
    for_rows(particles, [&](std::size_t row) {
        std::sort(pairs.items.begin() + static_cast<std::ptrdiff_t>(pairs.begin[row]),
                  pairs.items.begin() + static_cast<std::ptrdiff_t>(pairs.begin[row + 1]),
                  [](const Pair& a, const Pair& b) { return a.j != b.j ? a.j < b.j : a.image < b.image; });
    });
    return std::move(pairs.items);
}

/// Searches the chunks of all tasks on all threads; search(task) gives a chunk's pairs. Sorted by i, then j, then image.
template <typename Search>
std::vector<Pair> search_tasks(std::size_t tasks, std::size_t particles, const Search& search) {
    std::vector<std::vector<Pair>> chunks(tasks);
    for_chunks(tasks, [&](std::size_t task) { chunks[task] = search(task); }, fewest_tasks);
    return sorted_pairs(chunks, particles);
}

void check(const Box& box, std::span<const Vec3> position, std::span<const double> reach) {
    if (position.size() != reach.size())
        throw Error("neighbour search: " + std::to_string(position.size()) + " positions but " + std::to_string(reach.size()) +
                    " reaches");
    double largest = 0.0;
    for (std::size_t row = 0; row < reach.size(); ++row) {
        if (!(reach[row] > 0.0) || !std::isfinite(reach[row]))
            throw Error("particle row " + std::to_string(row) + ": its reach " + std::to_string(reach[row]) + " m is not positive");
        largest = std::max(largest, reach[row]);
    }
    for (std::size_t axis = 0; axis < 3; ++axis)  // its own image 128 boxes on would be near: no need to search through them all
        if (box.periodic[axis] && 2.0 * largest > 128.0 * box.lengths[static_cast<int>(axis)])
            throw Error("the box is more than 128 times shorter along axis " + std::to_string(axis) +
                        " than particles reach, more than an image can hold");
}

}  // namespace

std::vector<Pair> find_pairs(const Box& box, std::span<const Vec3> position, std::span<const double> reach) {
    check(box, position, reach);
    if (position.empty()) return {};
    const Frame frame = frame_of(box, position);
    const std::vector<Grid> grids = build_grids(frame, position, reach);

    struct Task {
        std::size_t grid, first, last;
    };
    std::vector<Task> tasks;
    for (std::size_t grid = 0; grid < grids.size(); ++grid)
        for (std::size_t first = 0; first < grids[grid].entries.size(); first += chunk_particles)
            tasks.push_back({grid, first, std::min(first + chunk_particles, grids[grid].entries.size())});

    return search_tasks(tasks.size(), position.size(), [&](std::size_t task) {
        return search_chunk(box, frame, std::span(grids).subspan(tasks[task].grid), tasks[task].first, tasks[task].last);
    });
}

std::vector<Pair> find_pairs(const Box& box, std::span<const Vec3> position, std::span<const double> reach,
                             std::span<const std::int32_t> of) {
    check(box, position, reach);
    if (of.empty()) return {};
    const Frame frame = frame_of(box, position);
    const std::vector<Grid> grids = build_grids(frame, position, reach);
    std::vector<std::uint8_t> chosen(position.size(), 0);
    for (const std::int32_t row : of) chosen[static_cast<std::size_t>(row)] = 1;
    const auto searches_too = [&](std::int32_t row) { return chosen[static_cast<std::size_t>(row)] != 0; };
    return search_tasks(of.size(), position.size(), [&](std::size_t task) {
        const auto row = static_cast<std::size_t>(of[task]);
        Entry entry{position[row], reach[row], 0, {0, 0, 0}, of[task]};
        for (int axis = 0; axis < 3; ++axis) frame.fraction(entry.position[axis], axis, entry.home[static_cast<std::size_t>(axis)]);
        std::vector<Pair> pairs;
        for (const Grid& grid : grids) search(box, frame, entry, grid, searches_too, pairs);
        return pairs;
    });
}

}  // namespace kiln
