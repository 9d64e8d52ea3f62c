// analyze.h: the subcommands of analyze; argv[0] is the subcommand's name, and each parses its own options.
#pragma once

namespace kiln::analyze {

constexpr double confidence = 0.95;  // of the intervals that are printed

int info(int argc, char** argv);
int density(int argc, char** argv);
int bonds(int argc, char** argv);
int select(int argc, char** argv);
int modulus(int argc, char** argv);
int strength(int argc, char** argv);
int elastic(int argc, char** argv);
int conductivity(int argc, char** argv);
int voxel(int argc, char** argv);
int fit(int argc, char** argv);
int mean(int argc, char** argv);
int kinetics(int argc, char** argv);
int materials(int argc, char** argv);

}  // namespace kiln::analyze
