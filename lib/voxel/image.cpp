// image.cpp: solid fraction and connected components of an image.
#include "voxel/image.h"

#include <algorithm>

#include "core/parallel.h"

namespace kiln::voxel {

namespace {

/// Disjoint sets of runs of solid voxels along x, each with its way to the root in whole boxes.
class Runs {
   public:
    using Shift = std::array<std::int32_t, 3>;

    explicit Runs(std::size_t runs) : parent_(runs), shift_(runs, Shift{}), round_(runs, 0) {
        for (std::size_t run = 0; run < runs; ++run) parent_[run] = static_cast<std::uint32_t>(run);
    }

    /// The root of a run; its shift is then that from the root.
    std::uint32_t root(std::uint32_t run) {
        std::uint32_t top = run;
        Shift way{};
        while (parent_[top] != top) {
            for (std::size_t axis = 0; axis < 3; ++axis) way[axis] += shift_[top][axis];
            top = parent_[top];
        }
        while (parent_[run] != run) {  // all on the way hang from the root from now on
            const std::uint32_t next = parent_[run];
            const Shift step = shift_[run];
            parent_[run] = top;
            shift_[run] = way;
            for (std::size_t axis = 0; axis < 3; ++axis) way[axis] -= step[axis];
            run = next;
        }
        return top;
    }

    /// Voxels of `second`, moved by whole boxes, lie beside voxels of `first`.
    void join(std::uint32_t first, std::uint32_t second, const Shift& box) {
        const std::uint32_t a = root(first), b = root(second);
        Shift apart;  // of the roots
        for (std::size_t axis = 0; axis < 3; ++axis) apart[axis] = shift_[first][axis] + box[axis] - shift_[second][axis];
        if (a == b) {
            for (std::size_t axis = 0; axis < 3; ++axis)
                if (apart[axis] != 0) round_[a] |= static_cast<std::uint8_t>(1 << axis);
            return;
        }
        parent_[b] = a;
        shift_[b] = apart;
        round_[a] |= round_[b];
    }

    /// The axes that the component of a run reaches round, a bit each.
    std::uint8_t round(std::uint32_t run) { return round_[root(run)]; }

   private:
    std::vector<std::uint32_t> parent_;
    std::vector<Shift> shift_;  // from the parent's box to that of the run
    std::vector<std::uint8_t> round_;
};

/// Solid voxels begin .. end - 1 of a row.
struct Run {
    std::uint32_t begin, end;
};

struct Rows {
    std::vector<Run> runs;
    std::vector<std::uint32_t> first;  // run of each row; one more than there are rows
};

Rows runs_of(const Image& image) {
    const std::size_t nx = image.count[0];
    Rows rows;
    rows.first.push_back(0);
    for (std::size_t row = 0; row < image.count[1] * image.count[2]; ++row) {
        const std::uint8_t* phase = image.phase.data() + row * nx;
        for (std::size_t x = 0; x < nx;) {
            if (phase[x] == 0) {
                ++x;
                continue;
            }
            const std::size_t begin = x;
            while (x < nx && phase[x] != 0) ++x;
            rows.runs.push_back({static_cast<std::uint32_t>(begin), static_cast<std::uint32_t>(x)});
        }
        rows.first.push_back(static_cast<std::uint32_t>(rows.runs.size()));
    }
    return rows;
}

/// Joins the runs of two rows that lie beside each other.
void join_rows(Runs& sets, const Rows& rows, std::size_t first, std::size_t second, const Runs::Shift& box) {
    std::uint32_t i = rows.first[first], j = rows.first[second];
    while (i < rows.first[first + 1] && j < rows.first[second + 1]) {
        const Run &a = rows.runs[i], &b = rows.runs[j];
        if (a.begin < b.end && b.begin < a.end) sets.join(i, j, box);
        a.end < b.end ? ++i : ++j;
    }
}

}  // namespace

double Image::solid_fraction() const {
    constexpr std::size_t chunk = 1 << 16;
    const std::size_t solid = sum_chunks((phase.size() + chunk - 1) / chunk, std::size_t{0}, [&](std::size_t index) {
        const auto begin = phase.begin() + static_cast<std::ptrdiff_t>(index * chunk);
        const auto end = phase.begin() + static_cast<std::ptrdiff_t>(std::min(phase.size(), (index + 1) * chunk));
        return static_cast<std::size_t>(std::count_if(begin, end, [](std::uint8_t value) { return value != 0; }));
    });
    return static_cast<double>(solid) / static_cast<double>(voxels());
}

Percolation remove_loose(Image& image) {
    const auto [nx, ny, nz] = image.count;
    const Rows rows = runs_of(image);
    Runs sets(rows.runs.size());
    for (std::size_t z = 0; z < nz; ++z) {
        for (std::size_t y = 0; y < ny; ++y) {
            const std::size_t row = y + ny * z, above = (y + 1) % ny + ny * z, behind = y + ny * ((z + 1) % nz);
            if (rows.first[row] == rows.first[row + 1]) continue;
            const std::uint32_t last = rows.first[row + 1] - 1;
            if (rows.runs[rows.first[row]].begin == 0 && rows.runs[last].end == nx) sets.join(last, rows.first[row], {1, 0, 0});
            join_rows(sets, rows, row, above, {0, y + 1 == ny ? 1 : 0, 0});
            join_rows(sets, rows, row, behind, {0, 0, z + 1 == nz ? 1 : 0});
        }
    }
    Percolation result;
    for (std::size_t row = 0; row + 1 < rows.first.size(); ++row) {
        for (std::uint32_t run = rows.first[row]; run < rows.first[row + 1]; ++run) {
            const std::uint8_t round = sets.round(run);
            for (std::size_t axis = 0; axis < 3; ++axis)
                if (round >> axis & 1) result.along[axis] = true;
            if (round != 0) continue;
            const Run& range = rows.runs[run];
            result.loose += range.end - range.begin;
            std::fill(image.phase.begin() + static_cast<std::ptrdiff_t>(row * nx + range.begin),
                      image.phase.begin() + static_cast<std::ptrdiff_t>(row * nx + range.end), std::uint8_t{0});
        }
    }
    return result;
}

}  // namespace kiln::voxel
