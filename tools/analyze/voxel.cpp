// voxel.cpp: a state as an image of voxels, for NumPy or ParaView.
#include <CLI/CLI.hpp>

#include "io/state_io.h"
#include "io/voxel_image.h"
#include "tools/analyze/analyze.h"
#include "tools/common/each_state.h"
#include "tools/common/tool.h"
#include "tools/common/value_options.h"
#include "voxel/geometry.h"

namespace kiln::analyze {

namespace {

constexpr const char* voxel_footer =
    "The union of spheres and bonds of one state. A voxel is 1 if its middle is solid, else 0; of several "
    "materials it is the number of the material, from 1. Voxels of two spheres that a gap thinner than a voxel parts are 0 along "
    "it. "
    "array[i, j, k] of a .npy file has i along x. A .vti file has the voxels as cells, in metres.\n\n"
    "Examples:\n"
    "  analyze select --density 0.79 sintered.kiln | bondify --method necks |\n"
    "      analyze voxel -o body.vti\n"
    "  analyze select --density 0.79 sintered.kiln | analyze voxel --voxels 8 -o body.npy";

bool ends_in(const std::string& name, const std::string& end) { return name.ends_with(end); }

std::string bytes_of(const State& state, double voxels, bool npy) {
    std::vector<std::uint8_t> phase;
    if (state.materials.size() > 254) throw Error("a voxel can be of 254 materials, and the state has more");
    for (const std::int32_t material : state.particles.material) phase.push_back(static_cast<std::uint8_t>(material + 1));
    if (phase.empty()) throw Error("the state has no particles");
    const auto count = voxel::grid_counts(state.box, voxel::mean_radius(state.particles), voxels);
    voxel::Raster raster = voxel::rasterise(state, count, phase);
    const io::ByteImage image{count, std::move(raster.image.phase)};
    return npy ? io::npy_bytes(image) : io::vti_bytes(image, state.box.origin, raster.image.edges, "phase");
}

}  // namespace

int voxel(int argc, char** argv) {
    cli::Common common;
    double voxels = 12.0;
    CLI::App app{"Writes a state as an image of voxels.", "analyze voxel"};
    app.footer(voxel_footer);
    cli::add_number(app, "--voxels", voxels, {cli::above_zero, 1000.0}, "Voxels a mean radius");
    common.add_to(app, true, false);
    cli::parse(app, argc, argv, common);
    const bool npy = ends_in(common.output, ".npy");
    if (!npy && !ends_in(common.output, ".vti"))
        throw CLI::ValidationError("--output", "names a file that ends in .npy or .vti, which says what is written");

    io::Input input(common.files, cli::stop_requested);
    io::Output output(common.output, true);
    std::size_t states = 0;
    cli::for_each_state(input, [&](const State& state, const std::string&) {
        if (++states > 1) throw Error("a file holds one image, and this is a second state; analyze select picks one");
        output.write_text(bytes_of(state, voxels, npy));
        return true;
    });
    output.commit();
    return cli::done;
}

}  // namespace kiln::analyze
