// voxel_options.cpp: options, memory and keys of what works on voxels.
#include "tools/analyze/voxel_options.h"

#include <CLI/CLI.hpp>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <iostream>

#include "io/voxel_image.h"
#include "tools/common/each_state.h"
#include "tools/common/quantity_options.h"
#include "tools/common/value_options.h"

namespace kiln::analyze {

namespace {

constexpr double network_tolerance = 1e-8, voxel_tolerance = 1e-2;
constexpr double finest_voxel_tolerance = 1e-6;  // of fields in single precision
constexpr double worth_saying = 1e9;             // bytes
constexpr double max_voxels = 1000.0;            // a mean radius

bool given(const CLI::App& app, const std::string& name) { return app.get_option(name)->count() > 0; }

std::string size_text(double bytes) {
    char text[32];
    std::snprintf(text, sizeof text, bytes < 1e9 ? "%.0f MB" : "%.1f GB", bytes < 1e9 ? bytes / 1e6 : bytes / 1e9);
    return text;
}

std::string count_text(const std::array<std::size_t, 3>& count) {
    return std::to_string(count[0]) + "x" + std::to_string(count[1]) + "x" + std::to_string(count[2]);
}

/// What a grid takes while it is at work: its image and fields, and the answers of the grid before.
template <typename Medium>
double memory_at(const std::vector<std::array<std::size_t, 3>>& grids, std::size_t index) {
    const auto [x, y, z] = grids[index];
    return voxel::memory_of<Medium>(grids[index]) + static_cast<double>(x) * static_cast<double>(y) * static_cast<double>(z) +
           (index > 0 ? voxel::memory_of<Medium>(grids[index - 1]) : 0.0);
}

}  // namespace

void VoxelOptions::add_to(CLI::App& app, const std::string& network, const std::string& unbalanced) {
    cli::add_choice(app, "--model", model, {{"network", Model::network}, {"voxel", Model::voxel}},
                    "network: " + network + "; voxel: finite elements of the union of spheres and bonds, on grids");
    cli::add_quantities(
        app, "--voxels", voxels, io::Dimension::none,
        "With --model voxel: voxels a mean radius, of each grid; two or more are extrapolated to voxels without size")
        ->default_str("6,9,12");
    app.add_option("--image", image,
                   "With --model voxel, in the place of states: a periodic image in NumPy's format, three dimensions of bytes or "
                   "booleans, 0 void, 1 solid")
        ->type_name("FILE.npy");
    cli::add_number(app, "--tolerance", tolerance, {1e-14, 1e-2}, unbalanced + " at which a solve ends; voxels: at least 1e-6")
        ->default_str("1e-8, voxels 1e-2");
}

void VoxelOptions::check(const CLI::App& app, const std::vector<std::string>& of_network, const std::vector<std::string>& of_image,
                         const cli::Common& common) {
    if (!given(app, "--tolerance")) tolerance = model == Model::voxel ? voxel_tolerance : network_tolerance;
    if (model == Model::network) {
        for (const char* name : {"--voxels", "--image"})
            if (given(app, name)) throw CLI::ValidationError(name, "needs --model voxel");
    } else {
        for (const std::string& name : of_network)
            if (given(app, name)) throw CLI::ValidationError(name, "has no meaning with --model voxel");
        if (tolerance < finest_voxel_tolerance)
            throw CLI::ValidationError("--tolerance",
                                       cli::number_text(tolerance) + " is not between 1e-6 and 0.01 with --model voxel");
    }
    for (const std::string& name : of_image) {
        if (image.empty() && given(app, name)) throw CLI::ValidationError(name, "needs --image; states have materials");
        if (!image.empty() && !given(app, name)) throw CLI::ValidationError(name, "is required with --image");
    }
    for (const double each : voxels)
        if (!(each > 0.0 && each <= max_voxels))
            throw CLI::ValidationError("--voxels", cli::number_text(each) + " is not between 0 and 1000");
    if (image.empty()) return;
    if (given(app, "--voxels")) throw CLI::ValidationError("--voxels", "has no meaning with --image, which has its own");
    if (!common.files.empty()) throw CLI::ValidationError("--image", "is read in the place of states, and there is a FILE too");
}

namespace {

voxel::Image read_image(const std::string& file) {
    io::ByteImage bytes = io::read_npy_mask(file);
    voxel::Image image;
    image.count = bytes.shape;
    image.phase = std::move(bytes.values);
    if (std::find(image.phase.begin(), image.phase.end(), 1) == image.phase.end())
        throw Error(file + ": nothing in the image is solid");
    return image;
}

template <typename Medium>
void announce_memory(const std::string& tool, const std::vector<std::array<std::size_t, 3>>& grids, const cli::Common& common) {
    const auto memory = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
    for (std::size_t index = 0; index < grids.size(); ++index) {
        const double bytes = memory_at<Medium>(grids, index);
        const std::string words = count_text(grids[index]) + " voxels take " + size_text(bytes) + " of memory";
        if (bytes > memory)
            throw Error(words + ", and this machine has " + size_text(memory) + "; ask for fewer voxels or a smaller cell");
        if (!common.quiet && (common.verbose || bytes > worth_saying)) std::cerr << tool << ": " << words << "\n";
    }
}

}  // namespace

template <typename Medium>
voxel::OnGrid solve_image(const std::string& tool, const VoxelOptions& options, const Medium& medium, const cli::Common& common,
                          const Watch& watch) {
    const voxel::Image image = read_image(options.image);
    announce_memory<Medium>(tool, {image.count}, common);
    return cli::at_place(options.image, [&] { return voxel::of_image(image, std::vector{medium}, options.tolerance, watch); });
}

template <typename Medium>
std::vector<voxel::OnGrid> solve_state(const std::string& tool, const VoxelOptions& options, const State& state,
                                       const voxel::Phases<Medium>& phases, const cli::Common& common, const Watch& watch) {
    const auto grids = voxel::grids_of(state, options.voxels);
    announce_memory<Medium>(tool, grids, common);
    return voxel::on_grids(state, phases, grids, options.tolerance, watch);
}

template voxel::OnGrid solve_image(const std::string&, const VoxelOptions&, const voxel::Solid&, const cli::Common&, const Watch&);
template voxel::OnGrid solve_image(const std::string&, const VoxelOptions&, const voxel::Conductor&, const cli::Common&,
                                   const Watch&);
template std::vector<voxel::OnGrid> solve_state(const std::string&, const VoxelOptions&, const State&,
                                                const voxel::Phases<voxel::Solid>&, const cli::Common&, const Watch&);
template std::vector<voxel::OnGrid> solve_state(const std::string&, const VoxelOptions&, const State&,
                                                const voxel::Phases<voxel::Conductor>&, const cli::Common&, const Watch&);

Limits::Limits(const std::vector<voxel::OnGrid>& grids, voxel::Order order) : order_(order) {
    for (const voxel::OnGrid& grid : grids) {
        edges_.push_back(grids.size() == 1 ? 1.0 : 1.0 / grid.voxels);  // in mean radii; an image has no radius
        tensors_.push_back(grid.found.tensor);
    }
}

Limit Limits::of(const std::vector<double>& values) const {
    if (values.size() == 1) return {values.front(), nullptr};
    const voxel::Extrapolated limit = voxel::extrapolate(edges_, values, order_);
    return {limit.value, limit.error};
}

Eigen::MatrixXd Limits::tensor() const { return voxel::extrapolate(edges_, tensors_, order_); }

voxel::Order order_of(const State& state) {
    return state.bonds && state.bonds->size() > 0 ? voxel::Order::second : voxel::Order::first;
}

Json grid_json(const voxel::OnGrid& grid) {
    return {{"voxels", grid.voxels > 0.0 ? Json(grid.voxels) : Json()},
            {"count", grid.count},
            {"union_fraction", grid.union_fraction},
            {"loose_fraction", grid.loose_fraction},
            {"iterations", grid.found.iterations},
            {"residual", grid.found.residual}};
}

Json solves_json(const std::vector<voxel::OnGrid>& grids) {
    int iterations = 0;
    double residual = 0.0;
    bool converged = true;
    for (const voxel::OnGrid& grid : grids) {
        iterations += grid.found.iterations;
        residual = std::max(residual, grid.found.residual);
        converged = converged && grid.found.converged;
    }
    return {{"union_fraction", grids.back().union_fraction},
            {"iterations", iterations},
            {"residual", residual},
            {"converged", converged}};
}

Json rows_of(const Eigen::MatrixXd& matrix) {
    Json rows = Json::array();
    for (Eigen::Index row = 0; row < matrix.rows(); ++row)
        rows.push_back(std::vector<double>(matrix.row(row).begin(), matrix.row(row).end()));
    return rows;
}

}  // namespace kiln::analyze
