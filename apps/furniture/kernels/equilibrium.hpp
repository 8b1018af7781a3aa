// Equilibrium of a piece on its springs, with the joint forces eliminated: h = d / eps.
#pragma once

#include "blocks.hpp"
#include "forces.hpp"
#include "parts.hpp"

namespace restshape::planks {

class Equilibrium {
 public:
    explicit Equilibrium(const Piece& piece);

    double joint_t() const { return 1.0 / P.settings.eps_t; }
    double joint_r() const { return 1.0 / P.settings.eps_r; }
    double floor() const { return 1.0 / P.settings.eps_floor; }
    Blocks& blocks() { return blocks_; }
    const std::vector<Part>& parts() const { return parts_; }
    bool carried(int plank) const { return parts_[plank_part_[plank]].grounded; }

    // Finds the motions of each part that its contacts leave free. Parts without any contact are held whole.
    void find_free(const Shape<double>& shape);

    // The gradient of the energy (6 n) at x; with `joint_forces` (6 a joint) they are taken in place of d / eps.
    template <class T>
    void gradient(const Shape<T>& shape, int load_case, Law law, const T* x, T* r, T* openings = nullptr,
                  const T* joint_forces = nullptr) const;

    // How far joints open (6 a joint) at x.
    std::vector<double> openings(const Shape<double>& shape, const std::vector<double>& x);

    // The energy [J] whose gradient the other is, with contacts as springs.
    double energy(const Shape<double>& shape, int load_case, const double* x, const double* joint_forces) const;

    void set_case(int load_case) { load_case_ = load_case; }

    // The stiffness at x: exact by dual numbers, or that of small displacements, which differs by parts of d / L.
    // joints_known: the last one that was not exact had these joints, which small displacements do not change.
    void stiffness(const Shape<double>& shape, Law law, const double* x, bool exact, bool joints_known = false);

    // Whether stiffness is taken anew at each step, where planks have turned to and with what forces add to it. What
    // small displacements leave out is a part of d / L of the stiffest springs, which soft joints do not have to spare.
    void look_close(bool close) { turned_ = close; }

    // Hands over the exact stiffness of contacts, loads and what is held, one block a term.
    template <class Sink>
    void ground(const Shape<double>& shape, Law law, const double* x, Sink sink) const {
        add_ground(shape, law, x, true, sink);
    }

    // Solves for x from the guess in it, unless its residual is larger than `from`, in parts of the loads; returns the
    // steps, negative where there is no end.
    int solve(const Shape<double>& shape, int load_case, Law law, std::vector<double>& x, double from = 1e300);

    // Newton's steps of all solutions so far.
    long steps() const { return steps_; }

    // One-sided contacts with Coulomb's friction from where springs are: contacts first stick, then slide beyond what
    // mu allows under the pressures found, again and again, until Coulomb's law can take over; or else it begins with
    // the pressures of forces that balance the loads. All but Coulomb's law have convex energies, whose least Newton's
    // method finds from anywhere.
    bool ease(const Shape<double>& shape, int load_case, const std::vector<V3<double>>& balance,
              std::vector<double>& x);

    // Coulomb's friction from bounds of friction [N] that are not far off, and from x: bounds are those of the
    // pressures that the last ones led to, until Coulomb's law can take over.
    bool settle(const Shape<double>& shape, int load_case, std::vector<double> bounds, std::vector<double>& x);

    // What friction allows each contact under its pressures at x [N].
    std::vector<double> allowed(const Shape<double>& shape, const std::vector<double>& x);

 private:
    const Piece& P;
    std::vector<Part> parts_;
    std::vector<int> plank_part_;
    Blocks blocks_;
    long steps_ = 0;
    bool turned_ = false;
    int load_case_ = 0;                  // whose loads an exact stiffness holds
    std::vector<Place<double>> places_;  // of planks, at displacements that were placed last
    std::vector<double> bounds_;         // [N] of each contact's friction, in the law of that name

    // Finds the free motions of a part from all that its contacts stiffen.
    void find_free(const Shape<double>& shape, int part);

    double bound(Law law, size_t contact) const { return law == Law::bounded ? bounds_[contact] : 0.0; }

    void place(const double* x);

    // Goes along a Newton step of a convex energy to where its slope has fallen to a hundredth. Displacements are
    // small: only contacts are looked at again at each place.
    void search(const Shape<double>& shape, const std::vector<double>& slope, const std::vector<double>& step,
                std::vector<double>& x);

    // The second derivative of the energy of joints and free motions along a step.
    double linear_curvature(const Shape<double>& shape, const std::vector<double>& step) const;

    void small_joint(const Shape<double>& shape, size_t k);

    void turned_joint(const Shape<double>& shape, size_t k);

    // Adds the stiffness of a joint whose points go with rotations by `a` and `b`.
    void put_joint(int i, int j, const Eigen::Matrix3d& a, const Eigen::Matrix3d& b);

    void exact_joint(const Shape<double>& shape, size_t k, const double* x);

    template <class Sink>
    void add_ground(const Shape<double>& shape, Law law, const double* x, bool exact, Sink sink) const {
        for (size_t k = 0; k < shape.contacts.size(); ++k) {
            const auto& contact = shape.contacts[k];
            const double* at = x + 6 * contact.plank;
            sink(contact.plank, exact     ? exact_contact(contact, law, at, bound(law, k))
                                : turned_ ? turned_contact(contact, law, bound(law, k))
                                          : small_contact(contact, law, at, bound(law, k)));
        }
        for (size_t k = 0; exact && k < P.loads.size(); ++k)
            if (const int i = P.loads[k].plank; carried(i)) sink(i, load_stiffness(shape, k, x + 6 * i));
        for (const Part& part : parts_)
            for (const auto& q : part.free) sink(part.carrier, Block(floor() * q * q.transpose()));
    }

    static Block block_of(const Dual<6> (&r)[6]);

    Block exact_contact(const Contact<double>& contact, Law law, const double* x, double bound) const;

    Block turned_contact(const Contact<double>& contact, Law law, double bound) const;

    Block small_contact(const Contact<double>& contact, Law law, const double* x, double bound) const;

    // A load keeps its direction, but its arm turns with the plank.
    Block load_stiffness(const Shape<double>& shape, size_t k, const double* x) const;
};

}  // namespace restshape::planks
