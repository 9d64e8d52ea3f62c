// types.h: the few types that every part of Kiln shares.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <stdexcept>

namespace kiln {

using Vec3 = Eigen::Vector3d;

/// Periodic image: how many box lengths along x, y, z are added to a position.
using Image = std::array<std::int8_t, 3>;

/// Something could not be done; what() is one sentence that names the datum. Exit status 1.
struct Error : std::runtime_error {
    using std::runtime_error::runtime_error;
};

/// A text that a person wrote is not what it should be: "'5' has no unit". What is wrong on a command line is exit status 2.
struct TextError : Error {
    using Error::Error;
};

}  // namespace kiln
