// Whether a piece is valid at values of its design parameters: joined, free of overlaps, stable, durable.
#pragma once

#include <memory>

#include "state.hpp"
#include "support.hpp"

namespace restshape::planks {

// What is not as it must be, as bits.
enum Flaw { lost = 1, overlapping = 2, unstable = 4, weak = 8, unbalanced = 16, apart = 32, doubtful = 64 };
constexpr int every_flaw = 63;  // a doubt is none

// What overloads a joint: its pull, its shear, the moment along its line, the one about its normal.
enum class Load { pull, shear, line, twist };

// The largest utilisation of a joint's strength, if that is more than there is.
struct Overloaded {
    int joint, load_case;
    double utilisation;
    Load by;
};

struct DesignCheck {
    int flaws = 0;
    bool sprung = false;             // the equilibrium of some case, as `CaseState` has it
    double pull = 0.0, shear = 0.0;  // the largest utilisation of a joint's strength, in parts of it
    double unbalanced_load = 0.0;
    std::vector<Flawed> faults;
    std::vector<std::pair<int, int>> overlaps;  // as the function of that name
    std::vector<std::pair<int, int>> falls;     // case, and the first plank of the part that falls
    std::vector<int> unbalanced;                // cases
    std::vector<Overloaded> overloaded;
    std::vector<Overloaded> doubts;  // moments that do not count
};

struct Part;

class Furniture {
 public:
    static constexpr double balance_tolerance = 1e-7;
    static constexpr double repeated = 1e-6;  // of a joint's utilisation, that counts as the same in two cases

    explicit Furniture(Piece piece);
    ~Furniture();

    const Piece& piece() const { return P; }
    const Shape<double>& shape() const { return shape_; }
    const std::vector<CaseState>& states() const { return states_; }
    State state() { return {P, *equilibrium_, shape_, states_}; }
    int parts() const;
    long steps() const;                  // Newton's, of all equilibria so far
    long fits() const { return fits_; }  // least squares of all tests of stability so far

    // Sets the geometry to design parameters (8 a plank), or to the piece as it is.
    void set_shape(const double* gamma);

    // Tests at design parameters; with `quick` it ends at the first flaw among those `wanted`.
    DesignCheck test(const double* gamma, int wanted, bool quick);

    // The first half of a test, which springs have no part in: joints, overlaps, support. Whether it goes on.
    bool hold(const double* gamma, int wanted, bool quick, DesignCheck& check);

    // The second half: equilibria, and what joints bear; where asked for, the largest utilisation of each. It ends
    // after the first case with a flaw of `ending`.
    void bear(DesignCheck& check, std::vector<double>* utilisations = nullptr, int ending = 0);

    // Whether each case has an equilibrium with springs that also pull, found from rest: what `bear` finds is so
    // balanced.
    bool springs_rest();

    // Gives the springs other compliances [m/N], [rad/(N m)], [m/N], for equilibria from now on.
    void set_compliance(double joint_t, double joint_r, double floor);

    // Narrows a bracket of a parameter t along a direction (8 a plank), of whose ends one is free of what is wanted
    // away, until it is within a tolerance; gives the number of tests.
    int bisect(const double* direction, double& good, double& bad, double tolerance, int wanted);

    // Brings a case to equilibrium, from the state that it has; returns whether with one-sided contacts.
    bool one_sided(int load_case);

    // Openings (6 a joint) at the state of a case.
    std::vector<double> openings(int load_case);

    // Forces (3 each) of the contacts on their planks at the state of a case.
    std::vector<V3<double>> contact_forces(int load_case) const;

    // Balances the loads of a case by forces [N] inside the friction cones; the part of them that is left.
    double balance(int load_case, std::vector<V3<double>>& forces) const;

    void forget();

    // Changes the equilibria that are known for others, from which the next ones are found.
    void exchange(std::vector<CaseState>& others);

    // Sets the state of a case from elsewhere.
    void set_state(int load_case, const double* x, Law law);

    // Whether no contact of the springs pulls, or pushes sideways beyond its friction.
    bool inside(int load_case) const;

 private:
    Piece P;
    std::unique_ptr<Equilibrium> equilibrium_;
    Shape<double> shape_;
    std::vector<CaseState> states_;

    // By case and part: forces in the friction cones that the last test has ended with.
    std::vector<std::vector<ConeForce>> near_;
    long fits_ = 0;

    std::vector<int> separating_;  // numbers of axes that separate pairs of planks, as `overlaps` keeps them

    // Which loads the contacts of each part cannot balance, all or the first one. A quick test begins with the forces
    // of the last one.
    void stand(DesignCheck& check, bool quick, bool first_only);

    static DesignCheck invalid(DesignCheck check);

    // One-sided contact from the last such state where there is one; else springs, and one-sided contact where those
    // pull or slide.
    void equilibrate(int load_case);

    // Whether one-sided contacts converge on floors that grow stiffer up to that of the model.
    bool stiffen(int load_case);

    // Whether one-sided contacts converge by the longer way, from where springs are.
    bool ease(int load_case, const std::vector<double>& springs);

    bool wild(const CaseState& state) const;

    void add_utilisation(int load_case, DesignCheck& check, std::vector<Overloaded>& most,
                         std::vector<Overloaded>& doubts, std::vector<double>* utilisations);
};

}  // namespace restshape::planks
