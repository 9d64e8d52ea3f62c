// fourier_inverse.h: the exact inverse of the stiffness of a homogeneous periodic grid of trilinear hexahedra, in Fourier space.
#pragma once

#include "linalg/line_transform.h"
#include "linalg/periodic_grid.h"

namespace kiln::linalg {

/// A homogeneous medium that conducts: one component.
struct HomogeneousConductor {
    static constexpr std::size_t components = 1;
    double conductivity;
};

/// A homogeneous isotropic elastic medium, by Lame's constants: three components.
struct HomogeneousSolid {
    static constexpr std::size_t components = 3;
    double lambda, shear;
};

/// Applies the inverse of the stiffness of a grid that one medium fills, as a preconditioner of what another body on the grid has
/// (Moulinec & Suquet 1998; Ladecky et al., Appl. Math. Comput. 446 (2023) 127835). Elements are hexahedra with trilinear shape
/// functions, integrated exactly; the mean of each component is set to 0. Single precision; the same bytes for any number of
/// threads.
///
/// Two half passes, so that what lies between them costs no pass over memory: real lines along z are transformed two at a time into
/// half a spectrum, whose planes, small enough for a cache, are then transformed, divided and transformed back one by one.
template <typename Medium>
class FourierInverse {
   public:
    FourierInverse(const PeriodicGrid& grid, const Medium& medium);

    /// Takes the forces f; the solution z stays inside. Gives f . z.
    double solve(const GridField& forces);

    /// direction <- z + ratio direction.
    void add_to(GridField& direction, float ratio);

   private:
    static constexpr std::size_t components = Medium::components;
    /// Of one axis: the symbols of second differences, of the mass and of the first difference (over i), for each wave number.
    struct Symbols {
        std::vector<float> stiffness, mass, slope;
    };

    double solve_plane(std::size_t wave);
    double solve_rows(std::size_t wave, std::size_t y, std::vector<Lines>& lines);

    PeriodicGrid grid_;
    std::size_t waves_;  // planes of half the spectrum, real and imaginary parts one behind the other
    float first_, second_;  // conductivity; sum of Lame's constants and shear modulus
    std::array<Symbols, 3> symbols_;
    std::array<LineTransform, 3> transform_;
    GridField spectrum_;
};

extern template class FourierInverse<HomogeneousConductor>;
extern template class FourierInverse<HomogeneousSolid>;

}  // namespace kiln::linalg
