// Design derivatives by dual numbers, eight directions at a time.
#include "derivative.hpp"

#include "gradient.hpp"
#include "joint_utilisation.hpp"
#include "shaper.hpp"
#include "stability_rows.hpp"

namespace restshape::planks {

Derivatives DesignDerivative::solve(int load_case) {
    const Piece& P = S.piece;
    const CaseState& state = S.cases[load_case];
    const int size = 6 * P.count();
    Equilibrium& equilibrium = S.equilibrium;
    equilibrium.set_case(load_case);
    equilibrium.stiffness(S.shape, state.law, state.x.data(), true);
    equilibrium.blocks().factor();
    Rows rhs(size, m_);
    std::vector<Design> x(size), r(size), d(6 * P.joints.size());
    for (int first = 0; first < m_; first += lanes) {
        shape(first);
        for (int k = 0; k < size; ++k) x[k] = Design(state.x[k]);
        equilibrium.gradient(shape_, load_case, state.law, x.data(), r.data());
        for (int k = 0; k < size; ++k)
            for (int lane = 0; lane < used(first); ++lane) rhs(k, first + lane) = -r[k].d[lane];
    }
    equilibrium.blocks().solve(rhs);
    Derivatives out;
    const int joints = static_cast<int>(P.joints.size()), contacts = static_cast<int>(S.shape.contacts.size());
    out.x = rhs.transpose();
    for (Rows* rows : {&out.bending, &out.tension, &out.shear_x, &out.shear_y, &out.length}) rows->resize(m_, joints);
    out.normal.resize(m_, contacts);
    for (int first = 0; first < m_; first += lanes) {
        shape(first);
        for (int k = 0; k < size; ++k) {
            x[k] = Design(state.x[k]);
            for (int lane = 0; lane < used(first); ++lane) x[k].d[lane] = rhs(k, first + lane);
        }
        equilibrium.gradient(shape_, load_case, state.law, x.data(), r.data(), d.data());
        for (int k = 0; k < joints; ++k) {
            const auto f = joint_force(shape_.joints[k], &d[6 * k], P.settings);
            for (int lane = 0; lane < used(first); ++lane) {
                out.bending(first + lane, k) = f.bending.d[lane];
                out.tension(first + lane, k) = f.tension.d[lane];
                out.shear_x(first + lane, k) = f.shear_x.d[lane];
                out.shear_y(first + lane, k) = f.shear_y.d[lane];
                out.length(first + lane, k) = shape_.joints[k].length.d[lane];
            }
        }
        for (int k = 0; k < contacts; ++k) {
            const auto& contact = shape_.contacts[k];
            const Place<Design> a = place_of(x.data() + 6 * contact.plank);
            const V3<Design> v = a.u + times(a.t.less_one, contact.arm);
            const Design pressed =
                dot(contact_force(v, contact.normal, contact.mu, equilibrium.floor(), state.law), contact.normal);
            for (int lane = 0; lane < used(first); ++lane) out.normal(first + lane, k) = pressed.d[lane];
        }
    }
    return out;
}

Rows DesignDerivative::stability(int load_case, std::vector<double>& values) {
    values.clear();
    Rows out(m_, 0);
    std::vector<Design> rows;
    for (int first = 0; first < m_; first += lanes) {
        shape(first);
        rows.clear();
        StabilityRows<Design>(S.piece, S.equilibrium, shape_, load_case, rows);
        if (first == 0) {
            // Values come from the same hulls as derivatives: on those of another shape, or of other rounding, there
            // may be other rows.
            for (const Design& row : rows) values.push_back(row.v);
            out.resize(m_, values.size());
        }
        for (size_t k = 0; k < rows.size(); ++k)
            for (int lane = 0; lane < used(first); ++lane) out(first + lane, k) = rows[k].d[lane];
    }
    return out;
}

void DesignDerivative::shape(int first) {
    gamma_.assign(n_, Design(0.0));
    for (int k = 0; k < n_; ++k)
        for (int lane = 0; lane < used(first); ++lane) gamma_[k].d[lane] = directions_[(first + lane) * n_ + k];
    Shaper<Design>(S.piece, gamma_.data(), shape_);
}

std::vector<std::array<int, 2>> valid_freedoms(const Piece& P, double step) {
    const int n = P.count();
    std::vector<std::array<int, 2>> valid;
    std::vector<Design> gamma(8 * n, Design(0.0));
    std::vector<double> moved(8 * n, 0.0);
    Shape<Design> shape;
    Shape<double> tried;
    const auto closes = [&](double by, int at) {
        moved[at] = by;
        Shaper<double>(P, moved.data(), tried);
        moved[at] = 0.0;
        for (const Flawed& one : tried.faults)
            if (one.fault == Fault::slant || one.fault == Fault::behind) return false;
        for (size_t k = 0; k < P.joints.size(); ++k)
            if (tried.joints[k].fault == Fault::gap) return false;
        for (Fault fault : tried.foot_faults)
            if (fault != Fault::none) return false;
        return true;
    };
    for (int i = 0; i < n; ++i) {
        for (int k = 0; k < 8; ++k) gamma[8 * i + k] = Design::seed(0.0, k);
        Shaper<Design>(P, gamma.data(), shape);
        for (int k = 0; k < 8; ++k) gamma[8 * i + k] = Design(0.0);
        Eigen::MatrixXd change(15 * n, 8);
        for (int p = 0; p < n; ++p)
            for (int k = 0; k < 8; ++k) {
                for (int a = 0; a < 3; ++a) {
                    change(15 * p + a, k) = shape.centre[p][a].d[k];
                    change(15 * p + 3 + a, k) = shape.size[p][a].d[k];
                }
                for (int a = 0; a < 9; ++a) change(15 * p + 6 + a, k) = shape.axes[p][a].d[k];
            }
        std::vector<Eigen::VectorXd> kept;
        for (int k : {6, 7, 0, 1, 2, 3, 4, 5}) {
            Eigen::VectorXd rest = change.col(k);
            const double size = rest.norm();
            if (!(size > 1e-9)) continue;
            for (const auto& q : kept) rest -= q.dot(rest) * q;
            if (rest.norm() < 1e-8 * size || !closes(step, 8 * i + k) || !closes(-step, 8 * i + k)) continue;
            kept.push_back(rest.normalized());
            valid.push_back({i, k});
        }
    }
    return valid;
}

}  // namespace restshape::planks
