// few_particles.h: motion of a few particles among others that are held.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <vector>

#include "sintering/contact_network.h"

namespace kiln::sintering {

/// Stiffness of the contact of an entry of a network against motion of one particle relative to the other.
using ContactStiffness = std::function<Eigen::Matrix3d(std::size_t entry)>;

/// Motion that takes off the forces on the particles given and on their neighbours within a few contacts, by the stiffness of the
/// contacts; all other particles, and the box, are held. force: on each particle, in any unit of the stiffness times a length.
/// Conjugate gradients on the particles that move; passes over the whole network are only those that find them.
/// Throws Error where a number is not finite.
void relax_few(const ContactNetwork& network, const ContactStiffness& stiffness, const std::vector<std::size_t>& particles,
               const Motion& force, Motion& motion);

}  // namespace kiln::sintering
