// voxel_options.h: what the subcommands that work on voxels share: their options, memory, and keys of results.
#pragma once

#include <string>
#include <vector>

#include "io/json.h"
#include "tools/common/progress.h"
#include "tools/common/tool.h"
#include "voxel/extrapolation.h"
#include "voxel/grids.h"

namespace CLI {
class App;
}

namespace kiln::analyze {

/// What a tensor is computed from: a network of what lies between the particles, or voxels.
enum class Model { network, voxel };

/// The options --model, --voxels, --image and --tolerance.
struct VoxelOptions {
    Model model = Model::network;
    std::vector<double> voxels{6.0, 9.0, 12.0};  // a mean radius, of each grid
    std::string image;                           // file; none: states
    double tolerance = 0.0;                      // of the network's or the voxels' equations

    /// Adds the options. network: what --model network stands for, in the words of --help; unbalanced: what --tolerance is of.
    void add_to(CLI::App& app, const std::string& network, const std::string& unbalanced);

    /// To be called once options are parsed. Throws CLI::ValidationError for an option that is given and that the chosen model, or
    /// an image, does not use: --voxels, --image, one of `of_network`, and one of `of_image` without an image or missing with it.
    void check(const CLI::App& app, const std::vector<std::string>& of_network, const std::vector<std::string>& of_image,
               const cli::Common& common);
};

/// The tensor of the image of the options, a .npy file of cubes, whose solid is one medium. Says on standard error what memory it
/// takes: with -v always, else where it is more than a gigabyte. Throws Error if the machine has less.
template <typename Medium>
voxel::OnGrid solve_image(const std::string& tool, const VoxelOptions& options, const Medium& medium, const cli::Common& common,
                          const Watch& watch);

/// The tensors of a state on the grids of the options; memory likewise.
template <typename Medium>
std::vector<voxel::OnGrid> solve_state(const std::string& tool, const VoxelOptions& options, const State& state,
                                       const voxel::Phases<Medium>& phases, const cli::Common& common, const Watch& watch);

/// Extrapolation of one number of each grid: the value, and its error, null for one grid.
struct Limit {
    double value;
    Json error;
};

/// What several grids say of one without end; for one grid, what it says itself. order: first where spheres merely overlap.
class Limits {
   public:
    Limits(const std::vector<voxel::OnGrid>& grids, voxel::Order order);

    Limit of(const std::vector<double>& values) const;
    Eigen::MatrixXd tensor() const;

   private:
    std::vector<double> edges_;
    std::vector<Eigen::MatrixXd> tensors_;
    voxel::Order order_;
};

/// The order for a state: see voxel/extrapolation.h.
voxel::Order order_of(const State& state);

/// The keys of a grid that every result has: voxels, count, union_fraction, loose_fraction, iterations, residual.
Json grid_json(const voxel::OnGrid& grid);

/// The keys that all grids together have: union_fraction (of the finest), iterations, residual, converged.
Json solves_json(const std::vector<voxel::OnGrid>& grids);

/// Rows of a matrix.
Json rows_of(const Eigen::MatrixXd& matrix);

}  // namespace kiln::analyze
