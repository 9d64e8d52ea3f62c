// green.h: `sinter green`, the command that makes green bodies.
#pragma once

namespace kiln::sinter {

/// Runs the command; argv[0] is "green". Returns the exit status; errors are thrown, for cli::run to report.
int green(int argc, char** argv);

}  // namespace kiln::sinter
