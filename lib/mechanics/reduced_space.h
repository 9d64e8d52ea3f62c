// reduced_space.h: displacement fields of a bonded body, few but chosen, among which its equilibria are sought.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "mechanics/compact_field.h"
#include "mechanics/elastic_solver.h"

namespace kiln::mechanics {

/// Freedoms are the travel of a punch, which moves no node, and then the amplitudes of the fields, m. The first fields are rigid
/// motions; the others are responses of the bonds to forces, free of rigid motion.
/// What forces hold a field is not kept: a product with the bonds gives it back.
class ReducedSpace {
   public:
    /// The network must outlive the space.
    explicit ReducedSpace(const BondNetwork& network);

    std::size_t fields() const { return rigid_.size() + responses_.size(); }
    std::size_t rigid_motions() const { return rigid_.size(); }
    /// Of a node in a field.
    Vec6 displacement(std::size_t field, std::size_t node) const;

    /// N/m, freedom by freedom; zero for the punch and for rigid motions.
    const Eigen::MatrixXd& stiffness() const { return stiffness_; }
    /// J, in the bonds.
    double energy(const Eigen::VectorXd& freedoms) const { return 0.5 * freedoms.dot(stiffness_ * freedoms); }
    /// Of every node.
    Vector displacement(const Eigen::VectorXd& freedoms) const;
    /// N, on every node, that holds the bonds.
    Vector force(const ElasticSolver& solver, const Eigen::VectorXd& freedoms) const;

    /// A shift and a turn about the middle of the network, both of the size that the network has. To come before all responses.
    void add_rigid_motion(const Vec3& shift, const Vec3& turn);

    struct Response {
        Vector displacement;  // m, without rigid motion
        Vector force;         // N, that holds it
        int iterations = 0;   // of the linear solver
    };
    /// What the bonds do, nearly, under forces on the nodes (N), by so many iterations at most.
    Response response(ElasticSolver& solver, const Vector& load, int max_iterations) const;
    /// Takes a response as a field whose unit is so many of its own; false if there is next to nothing new in it. exact: gives the
    /// forces that hold the field as it is kept; otherwise those of the response count, which differ by rounding.
    bool add(const Response& response, double unit, const ElasticSolver* exact = nullptr);
    void remove_last();

    /// What fields [first, last), no rigid motions, add up to now.
    Vector sum(const Eigen::VectorXd& freedoms, std::size_t first, std::size_t last) const;
    /// Takes them out, and their sum, divided by the unit, in as the last field.
    void join(const ElasticSolver& solver, std::size_t first, std::size_t last, const Vector& sum, double unit);

    /// Leaves this share of a bond's stiffness, which the network still has whole.
    void soften(std::size_t bond, double share);

   private:
    struct RigidMotion {
        Vec3 shift, turn;  // the turn over the size of the network
    };

    Vec6 displacement(const RigidMotion& motion, std::size_t node) const;
    RigidMotion sum_of_rigid_motions(const Eigen::VectorXd& amplitudes) const;
    Eigen::VectorXd work_on_rigid_motions(const Vector& force) const;
    Eigen::VectorXd work(const Vector& force) const;
    void add_freedom();
    bool add_response(const Response& response, double unit, const ElasticSolver* exact, double least);
    void remove_rigid_motions(Vector& displacement) const;

    const BondNetwork& network_;
    Vec3 middle_;
    double size_;
    std::vector<RigidMotion> rigid_;
    Eigen::MatrixXd rigid_products_;  // of these with each other
    std::vector<CompactField> responses_;
    Eigen::MatrixXd stiffness_;
};

/// The freedoms of a space of so many fields without those of fields [first, last).
std::vector<Eigen::Index> freedoms_without(std::size_t fields, std::size_t first, std::size_t last);

}  // namespace kiln::mechanics
