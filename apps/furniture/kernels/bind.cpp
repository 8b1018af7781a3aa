// The extension module restshape_apps.furniture._kernels: a piece of planks, its tests, its equilibrium and its
// derivatives.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <memory>

#include "derivative.hpp"
#include "free_ends.hpp"
#include "furniture.hpp"
#include "joint_utilisation.hpp"
#include "many_springs.hpp"
#include "mixed.hpp"
#include "overlap.hpp"
#include "stability_rows.hpp"

namespace py = pybind11;
using namespace pybind11::literals;
using namespace restshape::planks;

namespace {

using Doubles = py::array_t<double, py::array::c_style | py::array::forcecast>;
using Integers = py::array_t<int, py::array::c_style | py::array::forcecast>;
using Output = py::array_t<double, py::array::c_style>;

void require(bool holds, const char* message) {
    if (!holds) throw std::invalid_argument(message);
}

V3<double> three(const double* a) { return {a[0], a[1], a[2]}; }

std::unique_ptr<Furniture> furniture(const Doubles& centre, const Doubles& axes, const Doubles& size,
                                     const Doubles& density, const Integers& joints, const Doubles& strength,
                                     const Integers& feet, const Doubles& planes, const Integers& loaded,
                                     const Doubles& places, const Doubles& cases, const Doubles& gravity,
                                     const Doubles& settings) {
    Piece piece;
    const py::ssize_t n = density.size(), nj = joints.size() / 4, nl = loaded.size();
    require(centre.size() == 3 * n && axes.size() == 9 * n && size.size() == 3 * n, "planks: sizes differ");
    require(strength.size() == 3 * nj && places.size() == 3 * nl && planes.size() % 7 == 0, "joints or loads: sizes");
    require(cases.ndim() == 3 && cases.shape(1) == nl && cases.shape(2) == 3, "cases must be (cases, loads, 3)");
    require(gravity.size() == 3 && settings.size() == 9, "gravity has 3 numbers, settings 9");
    for (py::ssize_t i = 0; i < n; ++i) {
        piece.centre.push_back(three(centre.data() + 3 * i)), piece.size.push_back(three(size.data() + 3 * i));
        piece.axes.emplace_back();
        std::copy_n(axes.data() + 9 * i, 9, piece.axes.back().begin());
        piece.density.push_back(density.data()[i]);
    }
    const auto plank = [n](int k) {
        require(k >= 0 && k < n, "no such plank");
        return k;
    };
    for (py::ssize_t k = 0; k < nj; ++k) {
        const int* j = joints.data() + 4 * k;
        const double* s = strength.data() + 3 * k;
        require(j[1] >= 0 && j[1] < 4 && (j[3] == 4 || j[3] == 5) && j[0] != j[2], "a joint is an end on a face");
        piece.joints.push_back({plank(j[0]), j[1], plank(j[2]), j[3], s[0], s[1], s[2]});
    }
    for (py::ssize_t k = 0; k < planes.size() / 7; ++k) {
        const double* p = planes.data() + 7 * k;
        piece.planes.push_back({three(p), three(p + 3), p[6]});
    }
    for (py::ssize_t k = 0; k < feet.size() / 3; ++k) {
        const int* f = feet.data() + 3 * k;
        require(f[1] >= 0 && f[1] < 6 && f[2] >= 0 && f[2] < planes.size() / 7, "no such side or plane");
        piece.feet.push_back({plank(f[0]), f[1], f[2]});
    }
    for (py::ssize_t k = 0; k < nl; ++k) piece.loads.push_back({plank(loaded.data()[k]), three(places.data() + 3 * k)});
    for (py::ssize_t c = 0; c < cases.shape(0); ++c) {
        piece.cases.emplace_back();
        for (py::ssize_t k = 0; k < nl; ++k) piece.cases.back().push_back(three(cases.data() + 3 * (c * nl + k)));
    }
    piece.gravity = three(gravity.data());
    const double* s = settings.data();
    piece.settings = {s[0], s[1], s[2], s[3], s[4], s[5], s[6], s[7], s[8] != 0.0};
    return std::make_unique<Furniture>(std::move(piece));
}

const double* parameters(const Furniture& f, const std::optional<Doubles>& gamma) {
    if (!gamma) return nullptr;
    require(gamma->size() == 8 * f.piece().count(), "gamma must have 8 numbers a plank");
    return gamma->data();
}

py::array_t<double> array(const std::vector<V3<double>>& a) {
    py::array_t<double> out({static_cast<py::ssize_t>(a.size()), py::ssize_t{3}});
    for (size_t k = 0; k < a.size(); ++k) std::copy_n(a[k].begin(), 3, out.mutable_data(k, 0));
    return out;
}
py::array_t<double> array(const std::vector<double>& a) {
    return py::array_t<double>(static_cast<py::ssize_t>(a.size()), a.data());
}
py::array_t<double> array(const Rows& a) {
    py::array_t<double> out({a.rows(), a.cols()});
    std::copy_n(a.data(), a.size(), out.mutable_data());
    return out;
}

py::tuple tuple(const DesignCheck& v) {
    py::list faults, overloaded, doubts;
    for (const Flawed& one : v.faults) faults.append(py::make_tuple(static_cast<int>(one.fault), one.where));
    for (const Overloaded& one : v.overloaded)
        overloaded.append(py::make_tuple(one.joint, one.load_case, one.utilisation, static_cast<int>(one.by)));
    for (const Overloaded& one : v.doubts)
        doubts.append(py::make_tuple(one.joint, one.load_case, one.utilisation, static_cast<int>(one.by)));
    return py::make_tuple(v.flaws, v.pull, v.shear, v.unbalanced_load, faults, v.overlaps, v.falls, v.unbalanced,
                          overloaded, doubts);
}

py::dict shape(Furniture& f, const std::optional<Doubles>& gamma) {
    f.set_shape(parameters(f, gamma));
    const Shape<double>& s = f.shape();
    py::dict out;
    out["centre"] = array(s.centre), out["size"] = array(s.size), out["mass"] = array(s.mass);
    const py::ssize_t n = f.piece().count(), nj = static_cast<py::ssize_t>(s.joints.size());
    py::array_t<double> axes({n, py::ssize_t{3}, py::ssize_t{3}});
    for (py::ssize_t i = 0; i < n; ++i) std::copy_n(s.axes[i].begin(), 9, axes.mutable_data(i, 0, 0));
    out["axes"] = axes;
    py::array_t<double> joints({nj, py::ssize_t{14}});
    std::vector<int> faults, foot_faults;
    for (py::ssize_t k = 0; k < nj; ++k) {
        const auto& j = s.joints[k];
        double* row = joints.mutable_data(k, 0);
        for (int a = 0; a < 3; ++a) row[a] = j.p[a], row[3 + a] = j.n[a], row[6 + a] = j.x[a], row[9 + a] = j.y[a];
        row[12] = j.length, row[13] = j.nails;
        faults.push_back(static_cast<int>(j.fault));
    }
    out["joints"] = joints, out["joint_faults"] = faults;
    std::vector<V3<double>> points;
    for (const auto& c : s.contacts) points.push_back(c.point);
    for (Fault fault : s.foot_faults) foot_faults.push_back(static_cast<int>(fault));
    out["contacts"] = array(points), out["foot_faults"] = foot_faults;
    out["fault"] = static_cast<int>(s.fault());
    out["overlaps"] = overlaps(f.piece(), s, false);
    return out;
}

py::dict forces(Furniture& f, int c) {
    const CaseState& state = f.states().at(c);
    py::dict out;
    out["x"] = array(state.x), out["law"] = static_cast<int>(state.law), out["found"] = state.found;
    out["contacts"] = array(f.contact_forces(c));
    std::vector<V3<double>> balance;
    out["unbalanced_load"] = f.balance(c, balance), out["balance"] = array(balance);
    const std::vector<double> d = f.openings(c);
    const py::ssize_t nj = static_cast<py::ssize_t>(f.shape().joints.size());
    py::array_t<double> joints({nj, py::ssize_t{10}});
    for (py::ssize_t k = 0; k < nj; ++k) {
        const auto h = joint_force(f.shape().joints[k], &d[6 * k], f.piece().settings);
        const JointSpec& spec = f.piece().joints[k];
        const JointUtilisation utilisation = joint_utilisation(h, f.shape().joints[k], spec, f.shape().size[spec.i][2]);
        const double row[10] = {h.tension, h.shear_x,        h.shear_y,         h.bending,        h.twist_x,
                                h.twist_n, utilisation.pull, utilisation.shear, utilisation.line, utilisation.twist};
        std::copy_n(row, 10, joints.mutable_data(k, 0));
    }
    out["joints"] = joints;
    return out;
}

// Bits of what is wanted: where all are, flaws alone, for a doubt must be asked for by its own bit.
int flaws_of(int wanted) { return wanted < 0 ? every_flaw : wanted; }

py::tuple scan(Furniture& f, const Doubles& direction, const Doubles& t, int wanted) {
    require(direction.size() == 8 * f.piece().count(), "direction must have 8 numbers a plank");
    wanted = flaws_of(wanted);
    std::vector<double> gamma(direction.size());
    py::array_t<int> flaws(t.size());
    py::array_t<double> pull(t.size()), shear(t.size());
    for (py::ssize_t k = 0; k < t.size(); ++k) {
        for (size_t a = 0; a < gamma.size(); ++a) gamma[a] = t.data()[k] * direction.data()[a];
        const DesignCheck v = f.test(gamma.data(), wanted, true);
        flaws.mutable_data()[k] = v.flaws & wanted;
        pull.mutable_data()[k] = v.pull, shear.mutable_data()[k] = v.shear;
    }
    return py::make_tuple(flaws, pull, shear);
}

py::tuple bisect(Furniture& f, const Doubles& direction, double good, double bad, double tolerance, int wanted) {
    require(direction.size() == 8 * f.piece().count(), "direction must have 8 numbers a plank");
    const int tests = f.bisect(direction.data(), good, bad, tolerance, flaws_of(wanted));
    return py::make_tuple(good, bad, tests);
}

py::dict derivative(Furniture& f, const Doubles& directions, int c) {
    require(directions.ndim() == 2 && directions.shape(1) == 8 * f.piece().count(), "directions must be (m, 8 planks)");
    DesignDerivative design(f.state(), directions.data(), static_cast<int>(directions.shape(0)));
    const Derivatives d = design.solve(c);
    py::dict out;
    out["x"] = array(d.x), out["bending"] = array(d.bending), out["tension"] = array(d.tension);
    out["shear_x"] = array(d.shear_x), out["shear_y"] = array(d.shear_y), out["normal"] = array(d.normal);
    out["length"] = array(d.length);
    return out;
}

py::tuple stability_rows(Furniture& f, const Doubles& directions, int c) {
    require(directions.ndim() == 2 && directions.shape(1) == 8 * f.piece().count(), "directions must be (m, 8 planks)");
    DesignDerivative design(f.state(), directions.data(), static_cast<int>(directions.shape(0)));
    std::vector<double> values;
    const Rows rows = design.stability(c, values);
    return py::make_tuple(array(values), array(rows));
}

Output stability(Furniture& f, int c) {
    require(c >= 0 && c < static_cast<int>(f.piece().cases.size()), "there is no such case");
    const State state = f.state();
    std::vector<double> rows;
    StabilityRows<double>(state.piece, state.equilibrium, state.shape, c, rows);
    return array(rows);
}

std::unique_ptr<ManySprings> many_springs(const Furniture& f, const Doubles& compliances) {
    require(compliances.ndim() == 2 && compliances.shape(1) == 3, "compliances must be (m, 3)");
    std::vector<Springs> springs;
    for (py::ssize_t k = 0; k < compliances.shape(0); ++k) {
        const double* one = compliances.data() + 3 * k;
        springs.push_back({one[0], one[1], one[2]});
    }
    return std::make_unique<ManySprings>(f.piece(), std::move(springs));
}

py::tuple tested(ManySprings& m, const std::optional<Doubles>& gamma, int ending) {
    require(!gamma || gamma->size() == m.parameters(), "gamma must have 8 numbers a plank");
    const ManySprings::Found found = m.test(gamma ? gamma->data() : nullptr, ending);
    py::array_t<double> utilisations({static_cast<py::ssize_t>(found.flaws.size()), py::ssize_t{m.joints()}});
    double* row = utilisations.mutable_data();
    for (const std::vector<double>& one : found.utilisations) row = std::copy(one.begin(), one.end(), row);
    return py::make_tuple(found.flaws, utilisations, found.sprung);
}

py::list missed(const Doubles& centre, const Doubles& axes, const Doubles& size, const Integers& joints,
                const Integers& feet, const Doubles& floor, const Doubles& near, const std::vector<int>& planks) {
    const int n = static_cast<int>(size.size() / 3);
    require(centre.size() == 3 * n && axes.size() == 9 * n && size.size() == 3 * n, "planks: sizes differ");
    require(joints.size() % 3 == 0 && feet.size() % 2 == 0, "a joint has 3 numbers, a foot 2");
    require(floor.size() == 6 && near.size() == 7, "the floor has 6 numbers, nearness 7");
    const auto plank = [n](int k) {
        require(k >= 0 && k < n, "no such plank");
        return k;
    };
    LyingPlanks lying;
    for (int i = 0; i < n; ++i) {
        lying.centre.push_back(three(centre.data() + 3 * i)), lying.size.push_back(three(size.data() + 3 * i));
        lying.axes.emplace_back();
        std::copy_n(axes.data() + 9 * i, 9, lying.axes.back().begin());
    }
    lying.held.assign(6 * n, 0);
    const auto hold = [&](int of, int side) {
        require(side >= 0 && side < 6, "no such side");
        lying.held[6 * plank(of) + side] = 1;
    };
    for (const int* j = joints.data(); j != joints.data() + joints.size(); j += 3) {
        hold(j[0], j[1]);
        lying.joined.emplace_back(j[0], plank(j[2])), lying.joined_side.push_back(j[1]);
    }
    for (const int* f = feet.data(); f != feet.data() + feet.size(); f += 2) hold(f[0], f[1]);
    lying.floor_point = three(floor.data()), lying.floor_normal = three(floor.data() + 3);
    for (int k : planks) plank(k);
    const double* m = near.data();
    py::list found;
    for (const FreeEnd& one : free_ends(lying, {m[0], m[1], m[2], m[3], m[4], m[5], m[6]}, planks))
        found.append(py::make_tuple(one.plank, one.side, one.other, one.gap, one.aside, one.tilted,
                                    py::make_tuple(one.way[0], one.way[1], one.way[2]), one.edge));
    return found;
}

void bind_many_springs(py::class_<Furniture>& c) {
    py::class_<ManySprings>(c, "ManySprings")
        .def(py::init(&many_springs), "furniture"_a, "compliances"_a)
        .def(
            "decide",
            [](ManySprings& m, const Doubles& gamma, double spread) {
                require(gamma.size() == m.parameters(), "gamma must have 8 numbers a plank");
                return m.decide(gamma.data(), spread);
            },
            "gamma"_a, "spread"_a,
            "Whether the piece bears its loads with some of the springs alone, by reason of a joint whose utilisation "
            "differs by more than `spread`.")
        .def("forget", &ManySprings::forget, "Lets the next equilibria that decide be found from rest.")
        .def_property_readonly("steps", &ManySprings::steps, "Newton's steps of all equilibria so far.")
        .def("test", &tested, "gamma"_a = py::none(), "ending"_a = 0,
             "Flaws (bits), the largest utilisation (m, j) of each joint over all cases, and whether some case is left "
             "to "
             "springs that also pull since one-sided contacts were not solved, with each of the springs: up to the "
             "first "
             "with a flaw of `ending`.");
}

void bind_mixed(py::class_<Furniture>& c) {
    py::class_<Mixed>(c, "Mixed")
        .def(py::init([](Furniture& f) { return std::make_unique<Mixed>(f.state()); }), py::keep_alive<1, 2>())
        .def_property_readonly("size", &Mixed::size)
        .def("pattern",
             [](const Mixed& m) {
                 const auto [rows, columns] = m.pattern();
                 return py::make_tuple(py::array_t<int>(rows.size(), rows.data()),
                                       py::array_t<int>(columns.size(), columns.data()));
             })
        .def("residual",
             [](const Mixed& m, int load_case, int law, const Doubles& z, Output out) {
                 require(z.size() == m.size() && out.size() == m.size(), "z and out must have the system's size");
                 m.residual(load_case, static_cast<Law>(law), z.data(), out.mutable_data());
             })
        .def("tangent",
             [](const Mixed& m, int load_case, int law, const Doubles& z, Output values, double shift) {
                 require(z.size() == m.size(), "z must have the system's size");
                 m.tangent(load_case, static_cast<Law>(law), z.data(), values.mutable_data(), shift);
             })
        .def("energy", [](const Mixed& m, int load_case, const Doubles& z) { return m.energy(load_case, z.data()); })
        .def("join", [](const Mixed& m, int load_case) { return array(m.join(load_case)); })
        .def("part", [](const Mixed& m, const Doubles& z) { return array(m.part(z.data())); });
}

}  // namespace

PYBIND11_MODULE(_kernels, m) {
    m.doc() = "Compiled kernels of furniture: pieces of planks.";
    py::class_<Furniture> c(m, "Furniture");
    c.def(py::init(&furniture), "centre"_a, "axes"_a, "size"_a, "density"_a, "joints"_a, "strength"_a, "feet"_a,
          "planes"_a, "loaded"_a, "places"_a, "cases"_a, "gravity"_a, "settings"_a)
        .def_property_readonly("parts", &Furniture::parts)
        .def_property_readonly("steps", &Furniture::steps, "Newton's steps of all equilibria so far.")
        .def_property_readonly("fits", &Furniture::fits, "Least squares of all tests of stability so far.")
        .def("shape", &shape, "gamma"_a = py::none(),
             "The closed geometry at design parameters (n, 8), which becomes the present one.")
        .def(
            "test",
            [](Furniture& f, const std::optional<Doubles>& gamma, int wanted, bool quick) {
                return tuple(f.test(parameters(f, gamma), wanted, quick));
            },
            "gamma"_a = py::none(), "wanted"_a = every_flaw, "quick"_a = false,
            "Flaws (bits), largest utilisation of pull and of shear strength, the part of the load that contacts "
            "cannot "
            "balance, and lists: faults, overlaps, what falls, cases without an equilibrium, overloaded joints, and "
            "doubts: joints that moments overload that do not count.")
        .def("forces", &forces, "case"_a, "Displacements, contact and joint forces at the last test.")
        .def("scan", &scan, "direction"_a, "t"_a, "wanted"_a = every_flaw,
             "Flaws, and utilisations of pull and shear strength, at each t along a direction (n, 8).")
        .def("bisect", &bisect, "direction"_a, "good"_a, "bad"_a, "tolerance"_a, "wanted"_a = every_flaw,
             "The last good and the first bad t along a direction (n, 8) between one of each, and the tests that it "
             "took.")
        .def("derivative", &derivative, "directions"_a, "case"_a,
             "Derivatives of the last test's equilibrium along design directions (m, 8 n).")
        .def("stability_rows", &stability_rows, "directions"_a, "case"_a,
             "How far each tipping edge and friction of the piece as it is are from giving way, and the derivatives "
             "(m, rows).")
        .def("stability", &stability, "case"_a,
             "How far each tipping edge and friction are from giving way (rows,) at the last test.")
        .def(
            "freedoms", [](Furniture& f, double step) { return valid_freedoms(f.piece(), step); }, "step"_a = 1e-2,
            "Plank and number (0 to 7) of each design parameter that is valid.")
        .def("nails",
             [](const Furniture& f) {
                 std::vector<double> nails;
                 for (const auto& joint : f.shape().joints) nails.push_back(joint.nails);
                 return array(nails);
             })
        .def("inside", &Furniture::inside, "case"_a,
             "Whether at the state of a case no contact pulls, or pushes sideways beyond its friction.")
        .def("one_sided", &Furniture::one_sided, "case"_a,
             "Brings a case to rest from the state that it has; whether with contacts that only push.")
        .def("forget", &Furniture::forget, "Starts the next test from rest.")
        .def("set_state", [](Furniture& f, int load_case, const Doubles& x, int law) {
            require(x.size() == 6 * f.piece().count(), "x must have 6 numbers a plank");
            f.set_state(load_case, x.data(), static_cast<Law>(law));
        });
    c.attr("LOST") = int(lost), c.attr("OVERLAPPING") = int(overlapping), c.attr("UNSTABLE") = int(unstable);
    c.attr("WEAK") = int(weak), c.attr("UNBALANCED") = int(unbalanced), c.attr("APART") = int(apart);
    c.attr("DOUBTFUL") = int(doubtful);
    m.def(
        "free_ends", &missed, "centre"_a, "axes"_a, "size"_a, "joints"_a, "feet"_a, "floor"_a, "near"_a, "planks"_a,
        "Ends of some planks that nothing holds and what they missed: plank, side, other plank, gap, how far aside, "
        "whether tilted, the way sideways, and whether it meets an edge. joints: plank, side and other plank of each; "
        "feet: plank and side; floor: point and normal.");
    bind_mixed(c);
    bind_many_springs(c);
}
