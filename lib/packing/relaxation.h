// relaxation.h: spheres that overlap push each other apart, with inertia and damping, until little or no overlap is left.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "core/box.h"
#include "core/stop.h"

namespace kiln::packing {

/// Overlap ratios are h/(r_i + r_j), for equal spheres h/2R.
struct RelaxationOptions {
    double damping = 0.295;         // of a pair, as a fraction of its critical damping
    double max_overlap = 1e-5;  // ends when the largest overlap ratio is at or below this
    double mean_overlap = 0.0;      // or when the mean overlap ratio of the contacts is
    int max_steps = 20000;
};

struct Relaxation {
    int steps = 0;
    std::size_t contacts = 0;      // overlapping pairs
    double max_overlap = 0.0;  // ratio
    double mean_overlap = 0.0;     // ratio, mean of the contacts
    bool jammed = false;           // the forces on every particle balance: nothing moves any more
    bool finished = false;         // one of the two required overlaps was reached
};

/// Moves the centres (m) from rest. The acceleration by a contact is 2 m_j/(m_i + m_j) h along the contact normal, with m = r^3:
/// every pair, whatever its sizes, parts at the same rate. Contacts are the fewer the less damping there is, since particles fly on
/// after they parted. progress sees each step. The result does not depend on the number of threads. Throws Interrupted.
Relaxation relax(const Box& box, std::span<const double> radius, std::vector<Vec3>& position, const RelaxationOptions& options,
                 const StopRequest& stop = {}, const std::function<void(const Relaxation&)>& progress = {});

}  // namespace kiln::packing
