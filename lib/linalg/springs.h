// springs.h: the stiffness matrix of springs between nodes, kept as the springs: a fifth of the memory of its blocks.
#pragma once

#include <algorithm>
#include <functional>
#include <utility>
#include <vector>

#include "linalg/spring_force.h"
#include "linalg/wide_registers.h"

namespace kiln::linalg {

/// Asks for values before they are needed.
template <typename Values>
KILN_INLINE void expect(const Values& values) {
    for (std::size_t byte = 0; byte < sizeof values; byte += 64) __builtin_prefetch(reinterpret_cast<const char*>(&values) + byte);
}

template <typename Real, int width>
KILN_INLINE Freedoms<Real, width> motion_at(const Batch<width>& motions, std::size_t node) {
    return motion_of<Real, width>(motions[node]);
}

template <typename Real, int width>
KILN_INLINE const Freedoms<Real, width>& motion_at(const std::vector<Freedoms<Real, width>>& motions, std::size_t node) {
    return motions[node];
}

template <typename Real, int width>
    requires(!std::is_same_v<Real, float>)
KILN_INLINE Freedoms<Real, width> motion_at(const std::vector<Freedoms<float, width>>& motions, std::size_t node) {
    Freedoms<Real, width> motion;
    using Fours = Four<Real>[Freedoms<Real, width>::size / 4];
    using Narrow = Four<float>[Freedoms<float, width>::size / 4];
    Fours& to = reinterpret_cast<Fours&>(motion);
    const Narrow& from = reinterpret_cast<const Narrow&>(motions[node]);
    for (int k = 0; k < Freedoms<Real, width>::size / 4; ++k) to[k] = __builtin_convertvector(from[k], Four<Real>);
    return motion;
}

/// Springs that a product counts: all, or without those that do nothing in certain motions.
enum class Which { all, active };

/// Nodes are cut into chunks of fixed size. A spring inside a chunk is computed once for both of its nodes; one between two chunks
/// once in each, which adds what it does to its own node. So chunks are independent, and sums do not depend on the number of
/// threads. All widths of the processor's registers sum in the same order.
template <typename Real>
class Springs {
   public:
    static constexpr std::size_t nodes_in_chunk = 2048;

    Springs() = default;
    Springs(std::size_t nodes, const std::vector<Spring<Real>>& springs);
    /// The same with all stiffnesses times a factor. idle: whether a spring does nothing in the motions of Which::active.
    Springs(const Springs<double>& other, double factor, const std::function<bool(const Spring<double>&)>& idle);

    std::size_t nodes() const { return nodes_; }
    std::size_t chunks() const { return chunks_.size(); }
    /// Nodes [first, last) of a chunk.
    std::pair<std::size_t, std::size_t> nodes_of(std::size_t chunk) const {
        return {chunks_[chunk].first_node, chunks_[chunk].last_node};
    }
    /// By first node, in an order of their own.
    const std::vector<Spring<Real>>& springs() const { return springs_; }

    /// Holds a node to the ground by a spring for each freedom, N/m.
    void hold(std::size_t node, const Vec6& stiffness) { held_.emplace_back(node, stiffness); }
    const std::vector<std::pair<std::size_t, Vec6>>& held() const { return held_; }

    /// Leaves a share of a spring of the list that was given.
    void soften(std::size_t row, double share);

    /// Calls visit(spring) for each spring that has a node in the chunk.
    template <typename Visit>
    void for_springs(std::size_t chunk, const Visit& visit) const {
        const Chunk& c = chunks_[chunk];
        for (std::size_t k = c.own.first; k < c.own.last; ++k) visit(springs_[k]);
        for (std::size_t k = c.incoming.first; k < c.incoming.last; ++k) visit(springs_[incoming_[k]]);
    }

    /// Calls visit(node, force) for each node of a chunk, with the forces that hold the nodes in their motions.
    /// which: of the springs. wide: by registers of 32 bytes; gives the same bytes.
    template <int width, Which which = Which::all, typename Motions, typename Visit>
    void for_forces(std::size_t chunk, const Motions& motions, const Visit& visit, bool wide = has_wide_registers) const {
        static thread_local std::vector<Freedoms<Real, width>> sums;
        const Chunk& c = chunks_[chunk];
        sums.assign(c.last_node - c.first_node + 1, Freedoms<Real, width>{});  // the last for what belongs to other chunks
#if defined(__x86_64__)
        if (wide)
            add_wide<width, which>(c, motions, sums.data());
        else
#endif
            add_forces<width, which, false>(c, motions, sums.data());
        for (const auto& [node, stiffness] : held_)
            if (node >= c.first_node && node < c.last_node)
                add_ground<width>(stiffness, motion_at<Real, width>(motions, node), sums[node - c.first_node]);
        for (std::size_t node = c.first_node; node < c.last_node; ++node) visit(node, std::as_const(sums[node - c.first_node]));
    }

   private:
    /// Springs before its own at which a node's motion is asked for: that long memory may take.
    static constexpr std::size_t springs_ahead = 24;

    static std::size_t at(std::int32_t index) { return static_cast<std::size_t>(index); }

    template <typename Other>
    friend class Springs;

    /// Of a list: the active ones, then those that may be idle.
    struct Run {
        std::size_t first, idle, last;

        std::size_t end(Which which) const { return which == Which::active ? idle : last; }
    };

    struct Chunk {
        std::size_t first_node, last_node;
        Run own;       // of springs_, whose first node is in the chunk
        Run incoming;  // of incoming_: others whose second node is
    };

    template <int width, Which which, bool one_register, typename Motions>
    KILN_INLINE void add_forces(const Chunk& c, const Motions& motions, Freedoms<Real, width>* sums) const {
        const auto first = static_cast<std::uint32_t>(c.first_node), count = static_cast<std::uint32_t>(c.last_node) - first;
        for (std::size_t k = c.own.first, end = c.own.end(which); k < end; ++k) {
            const Spring<Real>& spring = springs_[k];
            expect(motions[at(springs_[std::min(k + springs_ahead, end - 1)].second)]);
            const auto i = static_cast<std::uint32_t>(spring.first), j = static_cast<std::uint32_t>(spring.second);
            add_force<one_register>(spring, motion_at<Real, width>(motions, i), motion_at<Real, width>(motions, j), sums[i - first],
                                   sums[std::min(j - first, count)]);
        }
        for (std::size_t k = c.incoming.first, end = c.incoming.end(which); k < end; ++k) {
            const Spring<Real>& spring = springs_[incoming_[k]];
            expect(motions[at(springs_[incoming_[std::min(k + springs_ahead, end - 1)]].first)]);
            const auto i = static_cast<std::uint32_t>(spring.first), j = static_cast<std::uint32_t>(spring.second);
            add_force<one_register>(spring, motion_at<Real, width>(motions, i), motion_at<Real, width>(motions, j), sums[count],
                                   sums[j - first]);
        }
    }

#if defined(__x86_64__)
    template <int width, Which which, typename Motions>
    [[gnu::target("avx2")]] void add_wide(const Chunk& c, const Motions& motions, Freedoms<Real, width>* sums) const {
        add_forces<width, which, std::is_same_v<Real, float>>(c, motions, sums);
    }
#endif

    template <int width>
    static void add_ground(const Vec6& stiffness, const Freedoms<Real, width>& motion, Freedoms<Real, width>& sum) {
        for (int component = 0; component < 6; ++component)
            for (int field = 0; field < width; ++field) {
                const int place = Freedoms<Real, width>::place(component, field);
                sum.data()[place] += static_cast<Real>(stiffness[component]) * motion.data()[place];
            }
    }

    std::size_t nodes_ = 0;
    std::vector<Chunk> chunks_;
    std::vector<Spring<Real>> springs_;
    std::vector<std::uint32_t> incoming_;  // springs
    std::vector<std::uint32_t> place_;     // of each spring of the list that was given
    std::vector<std::pair<std::size_t, Vec6>> held_;
};

/// y = A x.
void multiply(const Springs<double>& matrix, const Vector& x, Vector& y);

/// r = b - A x, of one field or three.
template <int width>
void residual(const Springs<double>& matrix, const Batch<width>& x, const Batch<width>& b, Batch<width>& r);

/// The blocks on the diagonal.
std::vector<Mat6> diagonal_blocks(const Springs<double>& matrix);

}  // namespace kiln::linalg
