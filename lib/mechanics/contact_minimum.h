// contact_minimum.h: the least energy of a body in contact within a reduced space.
#pragma once

#include "mechanics/contact_set.h"
#include "mechanics/reduced_space.h"

namespace kiln::mechanics {

/// What drives the punch.
struct PunchLoad {
    double force;       // N; of a punch that is held, only a measure
    bool held = false;  // where it is
};

/// Stiffness of bonds and contacts together, freedom by freedom, N/m.
Eigen::MatrixXd tangent_stiffness(const ReducedSpace& space, const ContactSet& contacts, const ContactSet::Forces& forces,
                                  const Eigen::VectorXd& freedoms);

/// Takes the freedoms to the minimum of the energy of bonds, contacts (their friction with limits as they are) and punch, which is
/// convex: until what is unbalanced in the space is 1e-13 of the punch force.
void minimise(const ReducedSpace& space, const ContactSet& contacts, const PunchLoad& load, Eigen::VectorXd& freedoms);

}  // namespace kiln::mechanics
