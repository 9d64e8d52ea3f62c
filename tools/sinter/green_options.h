// green_options.h: the options of `sinter green`.
#pragma once

#include <optional>
#include <string>

#include "packing/packing.h"
#include "packing/sphere_list.h"
#include "tools/common/tool.h"

namespace kiln::sinter {

struct GreenOptions {
    cli::Common common;
    packing::PackingOptions packing;
    double diameter = 100e-9;  // m, of monosize particles
    std::string distribution = "monosize";
    std::optional<packing::Weighting> sizes_by;  // nothing: as the distribution is usually stated
    std::optional<packing::Shares> shares;       // nothing: as the file says, or what its numbers add up to
    packing::FileManner manner;                  // of files of sizes or spheres
    std::string spheres;                         // file of a body that is not packed here; or empty
    packing::SphereOptions body;                 // its box
    std::string material = "alumina";

    void add_to(CLI::App& app);

    /// Checks the options against each other and reads the size distribution, after parsing.
    /// Throws CLI::ValidationError, or Error where the list of diameters cannot be read.
    void complete(const CLI::App& app);

   private:
    void add_sizes(CLI::App& app);
    void add_spheres(CLI::App& app);
    void complete_spheres(const CLI::App& app);
    void complete_sizes(const CLI::App& app);
};

}  // namespace kiln::sinter
