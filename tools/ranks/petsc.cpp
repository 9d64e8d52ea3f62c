// petsc.cpp: the processes of a run under MPI, in a build with PETSc.
#include <mpi.h>
#include <petscsys.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <thread>

#include "petsc/petsc_solver.h"
#include "tools/common/ranks.h"

namespace kiln::cli::ranks {

namespace {

constexpr auto patience = std::chrono::seconds(2);  // for the others to fail as well
constexpr int in_message = 1 << 30;                 // bytes

struct Shared {
    bool begun = false;
    int rank = 0, count = 1;
    MPI_Comm failures = MPI_COMM_NULL;  // on which nothing else is said, so that a process may come there at any time
};

Shared& shared() {
    static Shared processes;
    return processes;
}

}  // namespace

bool available() { return true; }

mechanics::LinearSolverMaker solver() { return petsc::solver(); }

void begin() {
    Shared& processes = shared();
    if (processes.begun) return;
    // Signals are for the programs, and what PETSc has to say comes with its errors; PETSC_OPTIONS is read, no other settings are.
    static std::array<std::string, 3> words{"kiln", "-no_signal_handler", "-skip_petscrc"};
    static std::array<char*, 4> pointers{words[0].data(), words[1].data(), words[2].data(), nullptr};
    int number = static_cast<int>(words.size());
    char** arguments = pointers.data();
    if (PetscInitialize(&number, &arguments, nullptr, nullptr) != 0) throw Error("PETSc does not start");
    PetscPushErrorHandler(PetscReturnErrorHandler, nullptr);
    MPI_Comm_rank(PETSC_COMM_WORLD, &processes.rank);
    MPI_Comm_size(PETSC_COMM_WORLD, &processes.count);
    MPI_Comm_dup(PETSC_COMM_WORLD, &processes.failures);
    processes.begun = true;
}

int rank() { return shared().rank; }

int count() { return shared().count; }

void broadcast(std::string& text) {
    if (count() == 1) return;
    unsigned long long size = text.size();
    MPI_Bcast(&size, 1, MPI_UNSIGNED_LONG_LONG, 0, PETSC_COMM_WORLD);
    text.resize(size);
    for (std::size_t done = 0; done < size; done += in_message)
        MPI_Bcast(text.data() + done, static_cast<int>(std::min<std::size_t>(in_message, size - done)), MPI_BYTE, 0,
                  PETSC_COMM_WORLD);
}

bool any(bool mine) {
    if (count() == 1) return mine;
    int of_all = mine ? 1 : 0;
    MPI_Allreduce(MPI_IN_PLACE, &of_all, 1, MPI_INT, MPI_MAX, PETSC_COMM_WORLD);
    return of_all != 0;
}

bool all_failed() {
    if (count() == 1) return true;
    MPI_Request request = MPI_REQUEST_NULL;
    MPI_Ibarrier(shared().failures, &request);
    const auto until = std::chrono::steady_clock::now() + patience;
    while (true) {
        int here = 0;
        MPI_Test(&request, &here, MPI_STATUS_IGNORE);
        if (here || std::chrono::steady_clock::now() > until) return here != 0;
        std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
}

void abort(int status) {
    MPI_Abort(PETSC_COMM_WORLD, status);
    std::abort();  // MPI_Abort does not come back
}

int end(int status) {
    Shared& processes = shared();
    if (!processes.begun) return status;
    MPI_Bcast(&status, 1, MPI_INT, 0, PETSC_COMM_WORLD);
    MPI_Comm_free(&processes.failures);
    PetscFinalize();
    processes.begun = false;
    return status;
}

}  // namespace kiln::cli::ranks
