// reduced_space.h: displacement fields of a bonded body, few but chosen, among which its equilibria are sought.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mechanics/elastic_solver.h"

namespace kiln::mechanics {

/// Freedoms are the travel of a punch, which moves no node, and then the amplitudes of the fields, m. The first fields are rigid
/// motions; the others are responses of the bonds to forces, orthogonal in energy to each other and free of rigid motion.
class ReducedSpace {
   public:
    /// The network must outlive the space.
    explicit ReducedSpace(const BondNetwork& network);

    std::size_t fields() const { return fields_.size(); }
    std::size_t rigid_motions() const { return rigid_motions_; }
    const Vector& displacement(std::size_t field) const { return fields_[field].displacement; }

    /// N/m, freedom by freedom; zero for the punch and for rigid motions.
    const Eigen::MatrixXd& stiffness() const { return stiffness_; }
    /// J, in the bonds.
    double energy(const Eigen::VectorXd& freedoms) const { return 0.5 * freedoms.dot(stiffness_ * freedoms); }
    /// Of every node.
    Vector displacement(const Eigen::VectorXd& freedoms) const;
    /// N, on every node, that holds the bonds.
    Vector force(const Eigen::VectorXd& freedoms) const;

    /// A shift and a turn about the middle of the network, both of the size that the network has. To come before all responses.
    void add_rigid_motion(const Vec3& shift, const Vec3& turn);

    struct Response {
        Vector displacement;
        double energy = 0.0;  // J, of the load on the way, before what the space has was taken out
        int iterations = 0;   // of the linear solver
    };
    /// What the bonds do under forces on the nodes (N), less what the space has of it.
    Response response(ElasticSolver& solver, const Vector& load) const;
    /// Takes a response as a field whose unit is so many of its own; false if there is next to nothing in it.
    bool add(const ElasticSolver& solver, Response response, double unit);
    void remove_last();

    struct Field {
        Vector displacement, force;  // force: stiffness times displacement, N; empty for a rigid motion
    };
    /// What all responses add up to now.
    Field sum_of_responses(const Eigen::VectorXd& freedoms) const;
    /// Takes their sum, divided by the unit, in the place of all responses.
    void replace_responses(Field sum, double unit);

    /// Leaves this share of a bond's stiffness, which the network still has whole.
    void soften(std::size_t bond, double share);

   private:
    void add_field(Field field);

    const BondNetwork& network_;
    std::vector<Field> fields_;
    std::size_t rigid_motions_ = 0;
    Eigen::MatrixXd stiffness_;
};

}  // namespace kiln::mechanics
