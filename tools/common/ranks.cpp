// ranks.cpp: what the programs that start others under MPI tell them.
#include "tools/common/ranks.h"

#include <array>
#include <charconv>
#include <cstdlib>
#include <cstring>

namespace kiln::cli::ranks {

namespace {

/// A number of the environment; `otherwise` where there is none.
int number_of(const char* name, int otherwise) {
    const char* text = std::getenv(name);
    if (!text) return otherwise;
    int value = otherwise;
    std::from_chars(text, text + std::strlen(text), value);
    return value;
}

}  // namespace

Launch launched() {
    struct Names {
        const char *rank, *count;
    };
    // Open MPI's mpirun, those of MPICH and Intel or srun --mpi=pmi2, and srun --mpi=pmix.
    constexpr std::array ways{Names{"OMPI_COMM_WORLD_RANK", "OMPI_COMM_WORLD_SIZE"}, Names{"PMI_RANK", "PMI_SIZE"},
                              Names{"PMIX_RANK", "SLURM_STEP_NUM_TASKS"}};
    for (const auto& [rank, count] : ways)
        if (number_of(rank, -1) >= 0 && number_of(count, 1) > 1) return {number_of(rank, 0), number_of(count, 1)};
    return {};
}

}  // namespace kiln::cli::ranks
