// contacts.h: what the contacts of a packing look like from afar: coordination, overlap, clusters.
#pragma once

#include <array>
#include <numeric>
#include <span>
#include <vector>

#include "core/neighbours.h"
#include "core/state.h"

namespace kiln {

struct ContactStatistics {
    double coordination_number;  // contacts of a particle, mean of all particles
    double mean_overlap_ratio;   // h/(r_i + r_j), for equal spheres h/2R, mean of the contacts; zero without contacts
};

/// Statistics of the pairs that touch; the others are left out. offset: what is added to the overlap of the spheres of each pair,
/// m; none for zeros.
ContactStatistics contact_statistics(const Box& box, const Particles& particles, std::span<const Pair> pairs,
                                     std::span<const double> offset = {});

/// Groups of rows that grow as rows are joined (union-find).
class Clusters {
   public:
    explicit Clusters(std::size_t rows) : parent_(rows) { std::iota(parent_.begin(), parent_.end(), 0); }

    /// The lowest row of the cluster that a row is in.
    std::int32_t root(std::int32_t row);

    /// The same, when nothing is joined any more.
    std::int32_t root_of(std::int32_t row) const {
        while (parent_[static_cast<std::size_t>(row)] != row) row = parent_[static_cast<std::size_t>(row)];
        return row;
    }

    void join(std::int32_t a, std::int32_t b);

   private:
    std::vector<std::int32_t> parent_;
};

/// Clusters of a periodic packing: each row knows by which image it is seen from the row that stands for its cluster.
class PeriodicClusters {
   public:
    using Offset = std::array<int, 3>;

    explicit PeriodicClusters(std::size_t rows) : parent_(rows), offset_(rows, Offset{0, 0, 0}) {
        std::iota(parent_.begin(), parent_.end(), 0);
    }

    /// The row that stands for the cluster of a row, and the image by which the row is seen from it along the cluster's contacts.
    std::int32_t root(std::int32_t row, Offset& image);

    /// Joins the rows of a pair. Where they are joined already, and the pair leads to another image, the cluster reaches its
    /// own image.
    void join(const Pair& pair);

    /// Axes along which some cluster reaches its own periodic image.
    const std::array<bool, 3>& percolating() const { return percolating_; }

   private:
    std::vector<std::int32_t> parent_;
    std::vector<Offset> offset_;  // image of each row as seen from its parent
    std::array<bool, 3> percolating_{false, false, false};
};

/// Axes along which a group of touching particles reaches its own periodic image. Along another axis nothing in the packing resists
/// or drives a strain of the box. rows: number of particles; pairs: those that touch.
std::array<bool, 3> percolating_axes(std::size_t rows, std::span<const Pair> pairs);

}  // namespace kiln
