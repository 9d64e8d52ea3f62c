// contact_network.h: the contacts of a packing, packed for one pass through memory, and sums of pair forces over them.
//
// Unknowns are the particles' displacements u relative to the affine motion and the strains e of the box along its axes. A contact
// from i to j with vector l moves by du = u_j - u_i + e*l (component by component). With U = u + e*x, where x is the position, this
// is U_j - U_i + e*(shift by box lengths), so that only contacts through a face of the box meet the strains one by one.
//
// Particles are cut into chunks of fixed size. A contact inside a chunk stands there once; one between two chunks stands in both,
// and each adds the force on its own particle. So chunks are independent, and results do not depend on the number of threads.
#pragma once

#include <span>
#include <vector>

#include "core/neighbours.h"
#include "core/parallel.h"

namespace kiln::sintering {

/// Displacements and strains, or forces and the work conjugate to the strains.
struct Motion {
    std::vector<double> displacement;  // m, x y z of each particle, relative to the affine motion
    Vec3 strain = Vec3::Zero();        // of the box along its axes

    explicit Motion(std::size_t particles = 0) : displacement(3 * particles, 0.0) {}
};

class ContactNetwork {
   public:
    static constexpr std::size_t chunk_particles = 2048;  // fixed, so that sums do not depend on the number of threads

    /// Entries of one chunk: [begin, first_only) join two own particles, [first_only, second_only) have only i in the chunk,
    /// [second_only, crossing) only j, [crossing, end) run through a face of the box, with their shift at shift_begin onwards.
    struct Chunk {
        std::size_t first_particle, last_particle;
        std::size_t begin, first_only, second_only, crossing, end;
        std::size_t shift_begin;
    };

    /// Positions (m) must be those that the images of the pairs refer to.
    ContactNetwork(const Box& box, std::span<const Vec3> position, std::span<const Pair> pairs);

    std::size_t particles() const { return position_.size(); }
    const Vec3& position(std::size_t row) const { return position_[row]; }
    const std::vector<Chunk>& chunks() const { return chunks_; }

    /// Calls work(chunk number) for each chunk, in parallel.
    template <typename Work>
    void for_chunks(const Work& work) const { kiln::for_chunks(chunks_.size(), work, min_parallel_chunks); }

    /// Sum of value(chunk number) over the chunks, in their order.
    template <typename Sum = double, typename Value>
    Sum sum_chunks(const Sum& zero, const Value& value) const {
        return kiln::sum_chunks(chunks_.size(), zero, value, min_parallel_chunks);
    }

    /// forces = sum over contacts of force(entry, du): added to particle j, taken from i; forces.strain = sum of force * l.
    /// du is the relative motion of the contact. total is scratch space of 3N.
    template <typename Force>
    void gather(const Motion& motion, Motion& forces, std::vector<double>& total, const Force& force) const;

    /// Calls visit(entry) once for each contact of a chunk that it owns, so that all chunks together visit every contact once.
    template <typename Visit>
    void for_owned(std::size_t chunk, const Visit& visit) const {
        const Chunk& c = chunks_[chunk];
        for (std::size_t entry = c.begin; entry < c.second_only; ++entry) visit(entry);
        for (std::size_t entry = c.crossing; entry < c.end; ++entry)
            if (owns_first(c, entry)) visit(entry);
    }

    std::vector<std::int32_t> first, second;    // particles i and j of each entry
    std::vector<std::int32_t> pair;             // row of the entry in the list of pairs

    /// Of a crossing entry: its shift, m, and whether the chunk owns its first and its second particle.
    const Vec3& shift(const Chunk& chunk, std::size_t entry) const { return shift_[chunk.shift_begin + entry - chunk.crossing]; }
    bool owns_first(const Chunk& chunk, std::size_t entry) const { return owns(chunk, entry, own_first); }
    bool owns_second(const Chunk& chunk, std::size_t entry) const { return owns(chunk, entry, own_second); }

   private:
    static constexpr std::size_t min_parallel_chunks = 5;  // chunks; below, threads wait for each other longer than they work
    static constexpr std::uint8_t own_first = 1, own_second = 2;
    bool owns(const Chunk& chunk, std::size_t entry, std::uint8_t which) const {
        return (side_[chunk.shift_begin + entry - chunk.crossing] & which) != 0;
    }
    template <bool AddFirst, bool AddSecond, typename Force>
    void gather_range(std::size_t begin, std::size_t end, const double* total, double* forces, const Force& force) const;
    void displace(std::size_t chunk, const Motion& motion, std::vector<double>& total) const;
    template <typename Force>
    Vec3 gather_chunk(std::size_t chunk, const Vec3& strain, const std::vector<double>& total, Motion& forces,
                      const Force& force) const;
    template <typename Force>
    Vec3 gather_crossing(const Chunk& chunk, const Vec3& strain, const double* total, double* forces, const Force& force) const;

    std::vector<Vec3> position_;
    std::vector<Chunk> chunks_;
    std::vector<Vec3> shift_;         // m, of crossing entries
    std::vector<std::uint8_t> side_;  // which particles of a crossing entry are the chunk's own
};

template <bool AddFirst, bool AddSecond, typename Force>
void ContactNetwork::gather_range(std::size_t begin, std::size_t end, const double* total, double* forces,
                                  const Force& force) const {
    for (std::size_t entry = begin; entry < end; ++entry) {
        const std::size_t i = 3 * static_cast<std::size_t>(first[entry]), j = 3 * static_cast<std::size_t>(second[entry]);
        const Vec3 f = force(entry, Vec3(total[j] - total[i], total[j + 1] - total[i + 1], total[j + 2] - total[i + 2]));
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double component = f[static_cast<Eigen::Index>(axis)];
            if constexpr (AddFirst) forces[i + axis] -= component;
            if constexpr (AddSecond) forces[j + axis] += component;
        }
    }
}

template <typename Force>
Vec3 ContactNetwork::gather_crossing(const Chunk& chunk, const Vec3& strain, const double* total, double* forces,
                                     const Force& force) const {
    Vec3 work = Vec3::Zero();
    for (std::size_t entry = chunk.crossing; entry < chunk.end; ++entry) {
        const std::size_t i = 3 * static_cast<std::size_t>(first[entry]), j = 3 * static_cast<std::size_t>(second[entry]);
        const Vec3 du = Vec3(total[j] - total[i], total[j + 1] - total[i + 1], total[j + 2] - total[i + 2]) +
                        strain.cwiseProduct(shift(chunk, entry));
        const Vec3 f = force(entry, du);
        if (owns_first(chunk, entry)) {
            work += f.cwiseProduct(shift(chunk, entry));
            for (std::size_t axis = 0; axis < 3; ++axis) forces[i + axis] -= f[static_cast<Eigen::Index>(axis)];
        }
        if (owns_second(chunk, entry))
            for (std::size_t axis = 0; axis < 3; ++axis) forces[j + axis] += f[static_cast<Eigen::Index>(axis)];
    }
    return work;
}

inline void ContactNetwork::displace(std::size_t chunk, const Motion& motion, std::vector<double>& total) const {
    for (std::size_t row = chunks_[chunk].first_particle; row < chunks_[chunk].last_particle; ++row) {
        Eigen::Map<Vec3> target(&total[3 * row]);
        target = Eigen::Map<const Vec3>(&motion.displacement[3 * row]) + motion.strain.cwiseProduct(position_[row]);
    }
}

template <typename Force>
Vec3 ContactNetwork::gather_chunk(std::size_t index, const Vec3& strain, const std::vector<double>& total, Motion& forces,
                                  const Force& force) const {
    const Chunk& chunk = chunks_[index];
    double* target = forces.displacement.data();
    std::fill(target + 3 * chunk.first_particle, target + 3 * chunk.last_particle, 0.0);
    gather_range<true, true>(chunk.begin, chunk.first_only, total.data(), target, force);
    gather_range<true, false>(chunk.first_only, chunk.second_only, total.data(), target, force);
    gather_range<false, true>(chunk.second_only, chunk.crossing, total.data(), target, force);
    Vec3 sum = gather_crossing(chunk, strain, total.data(), target, force);
    // Sum of f * l: with l = x_j + shift - x_i it is the sum of the particles' forces times their positions, and the shifts.
    for (std::size_t row = chunk.first_particle; row < chunk.last_particle; ++row)
        sum += Eigen::Map<const Vec3>(target + 3 * row).cwiseProduct(position_[row]);
    return sum;
}

template <typename Force>
void ContactNetwork::gather(const Motion& motion, Motion& forces, std::vector<double>& total, const Force& force) const {
    for_chunks([&](std::size_t chunk) { displace(chunk, motion, total); });
    std::vector<Vec3> work(chunks_.size());
    for_chunks([&](std::size_t chunk) { work[chunk] = gather_chunk(chunk, motion.strain, total, forces, force); });
    forces.strain.setZero();
    for (const Vec3& part : work) forces.strain += part;
}

}  // namespace kiln::sintering
