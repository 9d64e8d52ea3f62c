// contact_springs.h: contacts as the springs that they are under small motions, of a body that as a whole follows them.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "linalg/block_solver.h"

namespace kiln::mechanics {

using linalg::Vec6;

/// A spring between two nodes (the second may be -1, a wall): what stretches it, and its stiffness in N/m.
struct ContactSpring {
    std::int32_t node, other;
    Vec6 by_node, by_other;
    double stiffness;
};

/// Springs between nodes, walls and a punch. Freedoms of the whole (the punch, rigid motions of the body) follow without
/// resistance, so that what the springs do is in equilibrium. Without that, conjugate gradients would meet the body's motion in its
/// contacts, which is far stiffer or softer than all that bonds do, in every search.
class ContactSprings {
   public:
    /// by_whole: what each freedom of the whole stretches.
    void add(const ContactSpring& spring, const Eigen::VectorXd& by_whole);

    /// To be called after the last one.
    void let_whole_follow();

    /// Forces that hold the springs in motions of the nodes.
    linalg::NodeForces forces(const std::function<Vec6(std::size_t)>& motion) const;

   private:
    std::vector<ContactSpring> springs_;
    Eigen::MatrixXd by_whole_, compliance_;  // freedom by spring; freedom by freedom
};

}  // namespace kiln::mechanics
