// contact_network.h: the contacts of a packing, packed for one pass through memory, and sums of pair forces over them.
//
// Unknowns are the particles' displacements u relative to the affine motion and the strains e of the box along its axes. A contact
// from i to j with vector l moves by du = u_j - u_i + e*l (component by component). With U = u + e*x, where x is the position, this
// is U_j - U_i + e*(shift by box lengths), so that only contacts through a face of the box meet the strains one by one.
//
// Particles are cut into chunks of fixed size. A contact inside a chunk stands there once; one between two chunks stands in both,
// and each adds the force on its own particle. So chunks are independent, and results do not depend on the number of threads.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <type_traits>
#include <vector>

#include "core/neighbours.h"
#include "core/parallel.h"
#include "linalg/quad.h"
#include "linalg/wide_registers.h"

namespace kiln::sintering {

/// Displacements and strains, or forces and the work conjugate to the strains.
struct Motion {
    std::vector<double> displacement;  // m, x y z of each particle, relative to the affine motion
    Vec3 strain = Vec3::Zero();        // of the box along its axes

    explicit Motion(std::size_t particles = 0) : displacement(3 * particles, 0.0) {}
};

/// x, y and z of four vectors.
struct Fours {
    linalg::WideQuad::Lanes x, y, z;
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
    /// du is the relative motion of the contact. total is scratch space of N. Or of four entries at a time: force(entry, count, du)
    /// gives the Fours of the forces of the first `count` of entry, entry + 1 and so on; what it gives for the others is left out.
    template <typename Force>
    void gather(const Motion& motion, Motion& forces, std::vector<linalg::WideQuad>& total, const Force& force) const;

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

    /// The entry of a row of the list of pairs that the chunk of its first particle has.
    std::size_t entry_of(std::size_t row) const { return static_cast<std::size_t>(entry_[row]); }

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
    template <typename MotionOf, typename Force, typename Take>
    static void for_entries(std::size_t begin, std::size_t end, const MotionOf& motion_of, const Force& force, const Take& take);
    void displace(std::size_t chunk, const Motion& motion, std::vector<linalg::WideQuad>& total) const;
    template <typename Force>
    Vec3 gather_chunk(std::size_t chunk, const Vec3& strain, const std::vector<linalg::WideQuad>& total, Motion& forces,
                      const Force& force) const;

    std::vector<Vec3> position_;
    std::vector<std::int32_t> entry_;  // of each pair
    std::vector<Chunk> chunks_;
    std::vector<Vec3> shift_;         // m, of crossing entries
    std::vector<std::uint8_t> side_;  // which particles of a crossing entry are the chunk's own
};

/// A matrix of four by four.
struct FourByFour {
    linalg::WideQuad::Lanes a, b, c, d;

    FourByFour transposed() const {
        const auto even_ab = __builtin_shufflevector(a, b, 0, 4, 2, 6), odd_ab = __builtin_shufflevector(a, b, 1, 5, 3, 7);
        const auto even_cd = __builtin_shufflevector(c, d, 0, 4, 2, 6), odd_cd = __builtin_shufflevector(c, d, 1, 5, 3, 7);
        return {__builtin_shufflevector(even_ab, even_cd, 0, 1, 4, 5), __builtin_shufflevector(odd_ab, odd_cd, 0, 1, 4, 5),
                __builtin_shufflevector(even_ab, even_cd, 2, 3, 6, 7), __builtin_shufflevector(odd_ab, odd_cd, 2, 3, 6, 7)};
    }
};

template <typename MotionOf, typename Force, typename Take>
void ContactNetwork::for_entries(std::size_t begin, std::size_t end, const MotionOf& motion_of, const Force& force,
                                 const Take& take) {
    if constexpr (std::is_invocable_v<const Force&, std::size_t, std::size_t, const Fours&>) {
        for (std::size_t entry = begin; entry < end; entry += 4) {
            const std::size_t count = std::min<std::size_t>(4, end - entry), last = entry + count - 1;
            const FourByFour du = FourByFour{motion_of(entry).lanes, motion_of(std::min(entry + 1, last)).lanes,
                                             motion_of(std::min(entry + 2, last)).lanes, motion_of(last).lanes}.transposed();
            const Fours forces = force(entry, count, Fours{du.a, du.b, du.c});
            const FourByFour f = FourByFour{forces.x, forces.y, forces.z, {}}.transposed();
            take(entry, linalg::WideQuad{f.a});
            if (count > 1) take(entry + 1, linalg::WideQuad{f.b});
            if (count > 2) take(entry + 2, linalg::WideQuad{f.c});
            if (count > 3) take(entry + 3, linalg::WideQuad{f.d});
        }
    } else {
        for (std::size_t entry = begin; entry < end; ++entry) {
            const Vec3 f = force(entry, motion_of(entry).vector());
            take(entry, linalg::wide_quad(f[0], f[1], f[2]));
        }
    }
}

inline void ContactNetwork::displace(std::size_t chunk, const Motion& motion, std::vector<linalg::WideQuad>& total) const {
    for (std::size_t row = chunks_[chunk].first_particle; row < chunks_[chunk].last_particle; ++row) {
        const double* u = &motion.displacement[3 * row];
        const Vec3& x = position_[row];
        const Vec3& e = motion.strain;
        total[row] = linalg::wide_quad(u[0] + e[0] * x[0], u[1] + e[1] * x[1], u[2] + e[2] * x[2]);
    }
}

template <typename Force>
Vec3 ContactNetwork::gather_chunk(std::size_t index, const Vec3& strain, const std::vector<linalg::WideQuad>& total,
                                  Motion& forces, const Force& force) const {
    const Chunk& chunk = chunks_[index];
    std::array<linalg::WideQuad, chunk_particles> sums{};
    const auto sum_of = [&](std::int32_t particle) -> linalg::WideQuad& {
        return sums[static_cast<std::size_t>(particle) - chunk.first_particle];
    };
    const auto motion_of = [&](std::size_t entry) -> linalg::WideQuad {
        return {total[static_cast<std::size_t>(second[entry])].lanes - total[static_cast<std::size_t>(first[entry])].lanes};
    };
    for_entries(chunk.begin, chunk.first_only, motion_of, force, [&](std::size_t entry, linalg::WideQuad f) {
        sum_of(first[entry]).lanes -= f.lanes;
        sum_of(second[entry]).lanes += f.lanes;
    });
    for_entries(chunk.first_only, chunk.second_only, motion_of, force,
                [&](std::size_t entry, linalg::WideQuad f) { sum_of(first[entry]).lanes -= f.lanes; });
    for_entries(chunk.second_only, chunk.crossing, motion_of, force,
                [&](std::size_t entry, linalg::WideQuad f) { sum_of(second[entry]).lanes += f.lanes; });
    Vec3 sum = Vec3::Zero();
    const auto through_face = [&](std::size_t entry) -> linalg::WideQuad {
        const Vec3& l = shift(chunk, entry);
        return {motion_of(entry).lanes + linalg::wide_quad(strain[0] * l[0], strain[1] * l[1], strain[2] * l[2]).lanes};
    };
    for_entries(chunk.crossing, chunk.end, through_face, force, [&](std::size_t entry, linalg::WideQuad f) {
        if (owns_first(chunk, entry)) {
            sum += f.vector().cwiseProduct(shift(chunk, entry));
            sum_of(first[entry]).lanes -= f.lanes;
        }
        if (owns_second(chunk, entry)) sum_of(second[entry]).lanes += f.lanes;
    });
    // Sum of f * l: with l = x_j + shift - x_i it is the sum of the particles' forces times their positions, and the shifts.
    for (std::size_t row = chunk.first_particle; row < chunk.last_particle; ++row) {
        const Vec3 f = sums[row - chunk.first_particle].vector();
        Eigen::Map<Vec3>(&forces.displacement[3 * row]) = f;
        sum += f.cwiseProduct(position_[row]);
    }
    return sum;
}

template <typename Force>
void ContactNetwork::gather(const Motion& motion, Motion& forces, std::vector<linalg::WideQuad>& total, const Force& force) const {
    for_chunks([&](std::size_t chunk) { displace(chunk, motion, total); });
    forces.strain = sum_chunks<Vec3>(Vec3::Zero(), [&](std::size_t chunk) {
        return linalg::in_widest_registers([&] { return gather_chunk(chunk, motion.strain, total, forces, force); });
    });
}

}  // namespace kiln::sintering
