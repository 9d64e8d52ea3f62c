// green_options.h: the options of `sinter green`.
#pragma once

#include <optional>
#include <string>

#include "packing/packing.h"
#include "tools/common/tool.h"

namespace kiln::sinter {

struct GreenOptions {
    cli::Common common;
    packing::PackingOptions packing;
    double diameter = 100e-9;  // m, of monosize particles
    std::string distribution = "monosize";
    std::optional<packing::Weighting> sizes_by;  // nothing: as the distribution is usually stated
    std::string material = "alumina";

    void add_to(CLI::App& app);

    /// Checks the options against each other and reads the size distribution, after parsing.
    /// Throws CLI::ValidationError, or Error where the list of diameters cannot be read.
    void complete(const CLI::App& app);

   private:
    void add_sizes(CLI::App& app);
};

}  // namespace kiln::sinter
