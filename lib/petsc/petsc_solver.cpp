// petsc_solver.cpp: assembly of the own rows, conjugate gradients with GAMG, and the solution gathered on all processes.
#include "petsc/petsc_solver.h"

#include <petscksp.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

namespace kiln::petsc {

namespace {

using mechanics::BondBlocks, mechanics::BondNetwork, mechanics::GroundSprings, mechanics::Mat6, mechanics::Vec6, mechanics::Vector;

constexpr PetscInt six = 6;  // freedoms a node

void check(PetscErrorCode code) {
    if (code == 0) return;
    const char* kind = nullptr;
    char* words = nullptr;
    PetscErrorMessage(code, &kind, &words);
    throw Error("PETSc failed: " + std::string(words && *words ? words : kind ? kind : "error " + std::to_string(code)));
}

std::size_t at(std::int64_t index) { return static_cast<std::size_t>(index); }

/// A handle of PETSc's that is given back.
template <typename Handle, PetscErrorCode (*destroy)(Handle*)>
class Owned {
   public:
    Owned() = default;
    Owned(const Owned&) = delete;
    Owned& operator=(const Owned&) = delete;
    ~Owned() { destroy(&handle_); }
    operator Handle() const { return handle_; }
    Handle* address() { return &handle_; }

   private:
    Handle handle_ = nullptr;
};

using Values = Owned<Vec, VecDestroy>;

/// A choice of this file, unless PETSC_OPTIONS has another.
void prefer(const char* option, const char* value) {
    PetscBool given = PETSC_FALSE;
    check(PetscOptionsHasName(nullptr, nullptr, option, &given));
    if (!given) check(PetscOptionsSetValue(nullptr, option, value));
}

/// The nodes of a process: equal parts.
struct Part {
    std::int32_t first = 0, last = 0;
    std::vector<int> counts, starts;  // values of each process

    explicit Part(std::size_t nodes) {
        int rank = 0, ranks = 1;
        MPI_Comm_rank(PETSC_COMM_WORLD, &rank);
        MPI_Comm_size(PETSC_COMM_WORLD, &ranks);
        const auto start = [&](int part) { return static_cast<std::int32_t>(nodes * at(part) / at(ranks)); };
        first = start(rank);
        last = start(rank + 1);
        for (int part = 0; part < ranks; ++part) {
            starts.push_back(start(part) * six);
            counts.push_back((start(part + 1) - start(part)) * six);
        }
    }

    bool holds(std::int32_t node) const { return node >= first && node < last; }
    std::int32_t nodes() const { return last - first; }
    PetscInt values() const { return nodes() * six; }
};

/// Blocks of each own row of the matrix: those of own columns and the others.
struct RowSizes {
    std::vector<PetscInt> inside, outside;
};

RowSizes row_sizes(const BondNetwork& network, const Part& part) {
    std::vector<std::int32_t> ends(at(part.nodes()) + 1, 0);  // of the neighbours of each own node
    const auto for_each_end = [&](const auto& work) {
        for (const auto& [i, j] : network.pair) {
            if (part.holds(i)) work(at(i - part.first), j);
            if (part.holds(j)) work(at(j - part.first), i);
        }
    };
    for_each_end([&](std::size_t row, std::int32_t) { ++ends[row + 1]; });
    for (std::size_t row = 1; row < ends.size(); ++row) ends[row] += ends[row - 1];
    std::vector<std::int32_t> neighbours(at(ends.back())), next(ends);
    for_each_end([&](std::size_t row, std::int32_t other) { neighbours[at(next[row]++)] = other; });
    RowSizes sizes;
    for (std::int32_t node = part.first; node < part.last; ++node) {
        const auto row = at(node - part.first);
        const auto begin = neighbours.begin() + ends[row], full = neighbours.begin() + ends[row + 1];
        std::sort(begin, full);
        const auto end = std::unique(begin, full);
        const auto within = [&](std::int32_t other) { return other != node && part.holds(other); };
        sizes.inside.push_back(1 + static_cast<PetscInt>(std::count_if(begin, end, within)));
        sizes.outside.push_back(static_cast<PetscInt>(std::count_if(begin, end, [&](auto other) { return !part.holds(other); })));
    }
    return sizes;
}

class Solver : public mechanics::LinearSolver {
   public:
    Solver(const BondNetwork& network, const GroundSprings& ground, StopRequest stop);

    int solve(const Vector& b, Vector& x, double tolerance, int max_iterations) override;
    void soften(const BondNetwork& network, std::size_t bond, double share) override;

   private:
    void make_matrix(const BondNetwork& network);
    void assemble(const BondNetwork& network, const GroundSprings& ground);
    void add_block(std::int32_t row, std::int32_t column, const Mat6& values);
    void add_bond(const BondNetwork& network, std::size_t bond, double factor);
    void finish_matrix();
    void set_rigid_motions(const BondNetwork& network);
    void set_up();
    static PetscErrorCode converged(KSP iteration, PetscInt count, PetscReal residual, KSPConvergedReason* reason, void* solver);

    StopRequest stop_;
    bool stopped_ = false;
    double goal_ = 0.0;  // N, norm of the residual
    Part part_;
    Owned<Mat, MatDestroy> matrix_;
    Values load_, solution_;
    Owned<KSP, KSPDestroy> iteration_;
};

Solver::Solver(const BondNetwork& network, const GroundSprings& ground, StopRequest stop)
    : stop_(std::move(stop)), part_(network.nodes()) {
    make_matrix(network);
    assemble(network, ground);
    set_rigid_motions(network);
    set_up();
}

/// Empty, with room for the blocks of each own row. GAMG (3.18) takes no matrix of blocks, MATBAIJ: single values, which know that
/// they come in sixes.
void Solver::make_matrix(const BondNetwork& network) {
    const RowSizes sizes = row_sizes(network, part_);
    check(MatCreate(PETSC_COMM_WORLD, matrix_.address()));
    check(MatSetSizes(matrix_, part_.values(), part_.values(), PETSC_DETERMINE, PETSC_DETERMINE));
    check(MatSetBlockSize(matrix_, six));
    check(MatSetType(matrix_, MATAIJ));
    check(MatXAIJSetPreallocation(matrix_, six, sizes.inside.data(), sizes.outside.data(), nullptr, nullptr));
    check(MatSetOption(matrix_, MAT_NO_OFF_PROC_ENTRIES, PETSC_TRUE));
    check(MatSetOption(matrix_, MAT_SPD, PETSC_TRUE));
}

void Solver::add_block(std::int32_t row, std::int32_t column, const Mat6& values) {
    if (!part_.holds(row)) return;
    const Eigen::Matrix<double, 6, 6, Eigen::RowMajor> by_rows = values;
    check(MatSetValuesBlocked(matrix_, 1, &row, 1, &column, by_rows.data(), ADD_VALUES));
}

void Solver::add_bond(const BondNetwork& network, std::size_t bond, double factor) {
    const auto [i, j] = network.pair[bond];
    if (!part_.holds(i) && !part_.holds(j)) return;
    const BondBlocks blocks = mechanics::bond_blocks(network, bond);
    add_block(i, i, factor * blocks.ii);
    add_block(j, j, factor * blocks.jj);
    add_block(i, j, factor * blocks.ij);
    add_block(j, i, factor * blocks.ij.transpose());
}

void Solver::finish_matrix() {
    check(MatAssemblyBegin(matrix_, MAT_FINAL_ASSEMBLY));
    check(MatAssemblyEnd(matrix_, MAT_FINAL_ASSEMBLY));
}

void Solver::assemble(const BondNetwork& network, const GroundSprings& ground) {
    for (std::size_t bond = 0; bond < network.bonds(); ++bond) add_bond(network, bond, 1.0);
    const auto node = static_cast<std::int32_t>(ground.node);
    add_block(node, node, ground.stiffness.asDiagonal().toDenseMatrix());
    finish_matrix();
}

/// Three shifts and three turns about the middle of the network, orthonormal as PETSc asks.
void Solver::set_rigid_motions(const BondNetwork& network) {
    check(MatCreateVecs(matrix_, solution_.address(), load_.address()));
    Vec3 middle = Vec3::Zero();
    for (const Vec3& position : network.position) middle += position / static_cast<double>(network.nodes());
    std::array<Values, six> owned;
    std::array<Vec, six> motions{};
    for (std::size_t k = 0; k < motions.size(); ++k) {
        check(VecDuplicate(load_, owned[k].address()));
        motions[k] = owned[k];
        PetscScalar* values = nullptr;
        check(VecGetArray(motions[k], &values));
        const Vec3 axis = Vec3::Unit(static_cast<Eigen::Index>(k % 3));
        for (std::int32_t node = part_.first; node < part_.last; ++node) {
            Eigen::Map<Vec6> value(values + (node - part_.first) * six);
            if (k < 3)
                value << axis, Vec3::Zero();
            else
                value << axis.cross(network.position[at(node)] - middle) / network.rotation_length, axis;
        }
        check(VecRestoreArray(motions[k], &values));
        for (std::size_t before = 0; before < k; ++before) {
            PetscScalar part = 0.0;
            check(VecDot(motions[k], motions[before], &part));
            check(VecAXPY(motions[k], -part, motions[before]));
        }
        check(VecNormalize(motions[k], nullptr));
    }
    Owned<MatNullSpace, MatNullSpaceDestroy> space;
    check(MatNullSpaceCreate(PETSC_COMM_WORLD, PETSC_FALSE, six, motions.data(), space.address()));
    check(MatSetNearNullSpace(matrix_, space));
}

/// Aggregates over two steps of the graph on two levels, and the nodes' own 6x6 blocks in the smoother. Of 99,000 particles at 0.79
/// two such levels take 7.5 s to set up and 5.0 s to solve where one takes 12.7 and 5.0; blocks in place of PETSc's points take 18
/// iterations where those take 24 (15,000 particles).
void Solver::set_up() {
    prefer("-kiln_mg_levels_pc_type", PCPBJACOBI);
    prefer("-kiln_pc_gamg_aggressive_coarsening", "2");
    check(KSPCreate(PETSC_COMM_WORLD, iteration_.address()));
    check(KSPSetOptionsPrefix(iteration_, "kiln_"));
    check(KSPSetOperators(iteration_, matrix_, matrix_));
    check(KSPSetType(iteration_, KSPCG));
    check(KSPSetNormType(iteration_, KSP_NORM_UNPRECONDITIONED));
    check(KSPSetConvergenceTest(iteration_, converged, this, nullptr));
    PC preconditioner = nullptr;
    check(KSPGetPC(iteration_, &preconditioner));
    check(PCSetType(preconditioner, PCGAMG));
    check(KSPSetFromOptions(iteration_));
    check(KSPSetUp(iteration_));
    check(KSPSetReusePreconditioner(iteration_, PETSC_TRUE));  // for a softer body too
}

/// PETSc must not be left by an exception: a stop is noted.
PetscErrorCode Solver::converged(KSP, PetscInt count, PetscReal residual, KSPConvergedReason* reason, void* of) {
    Solver& solver = *static_cast<Solver*>(of);
    solver.stopped_ = solver.stop_ && solver.stop_();
    *reason = KSP_CONVERGED_ITERATING;
    if (solver.stopped_ || !std::isfinite(residual)) *reason = KSP_DIVERGED_BREAKDOWN;
    if (residual <= solver.goal_) *reason = count > 0 ? KSP_CONVERGED_RTOL : KSP_CONVERGED_ATOL;
    return 0;
}

int Solver::solve(const Vector& b, Vector& x, double tolerance, int max_iterations) {
    goal_ = tolerance * linalg::norm(b);
    PetscScalar* load = nullptr;
    check(VecGetArray(load_, &load));
    std::copy_n(b.front().data() + part_.first * six, part_.values(), load);
    check(VecRestoreArray(load_, &load));
    check(KSPSetTolerances(iteration_, PETSC_DEFAULT, PETSC_DEFAULT, PETSC_DEFAULT, max_iterations));
    check(KSPSolve(iteration_, load_, solution_));
    if (stopped_) throw Interrupted();
    x.resize(b.size());
    const PetscScalar* found = nullptr;
    check(VecGetArrayRead(solution_, &found));
    MPI_Allgatherv(found, part_.values(), MPI_DOUBLE, x.front().data(), part_.counts.data(), part_.starts.data(), MPI_DOUBLE,
                   PETSC_COMM_WORLD);
    check(VecRestoreArrayRead(solution_, &found));
    PetscInt iterations = 0;
    check(KSPGetIterationNumber(iteration_, &iterations));
    return iterations;
}

void Solver::soften(const BondNetwork& network, std::size_t bond, double share) {
    add_bond(network, bond, share - 1.0);
    finish_matrix();
}

}  // namespace

mechanics::LinearSolverMaker solver() {
    return [](const BondNetwork& network, const GroundSprings& ground, const StopRequest& stop) {
        return std::make_unique<Solver>(network, ground, stop);
    };
}

}  // namespace kiln::petsc
