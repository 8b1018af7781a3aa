// Energy and forces of a sheet in one pass: membrane of St. Venant and Kirchhoff, dead load, and quadratic bending.
// What depends on material coordinates and stiffness alone is kept, several elements at once, one a lane.
//
// Source: docs/theory/cloth.md; the elements are those of membrane.hpp and bending.hpp.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <vector>

#include "cloth/bending.hpp"
#include "fem/pack.hpp"
#include "fem/shapes.hpp"

namespace restshape {

// Eight on any processor: forces and energies are summed in the order of the lanes, and drapes hang on the rounding.
constexpr int sheet_lanes = 8;

// Nodes of elements, one a lane.
template <int Nodes>
struct LaneNodes {
    int32_t node[Nodes][sheet_lanes];

    // Lanes beyond the last element repeat it.
    LaneNodes(const int32_t* cells, int64_t first, int64_t count) {
        for (int lane = 0; lane < sheet_lanes; ++lane)
            for (int i = 0; i < Nodes; ++i) node[i][lane] = cells[std::min(first + lane, count - 1) * Nodes + i];
    }
    void gather(const double* x, EightLanes (&at)[Nodes][3]) const {
        alignas(sizeof(EightLanes)) double own[Nodes][3][sheet_lanes];
        for (int i = 0; i < Nodes; ++i)
            for (int lane = 0; lane < sheet_lanes; ++lane)
                for (int a = 0; a < 3; ++a) own[i][a][lane] = x[3 * static_cast<int64_t>(node[i][lane]) + a];
        std::memcpy(at, own, sizeof(own));
    }
    void scatter(const EightLanes (&r)[Nodes][3], double* out) const {
        alignas(sizeof(EightLanes)) double own[Nodes][3][sheet_lanes];
        std::memcpy(own, r, sizeof(own));
        for (int i = 0; i < Nodes; ++i)
            for (int lane = 0; lane < sheet_lanes; ++lane)
                for (int a = 0; a < 3; ++a) out[3 * static_cast<int64_t>(node[i][lane]) + a] += own[i][a][lane];
    }
};

// Triangles; those in lanes beyond the last have no area.
class PackedMembrane {
 public:
    static constexpr int nodes = 3;

    // Parameters as of `MembraneParts`.
    PackedMembrane(const double* X, const int32_t* cells, const double* p, int stride, int64_t first, int64_t count)
        : where_(cells, first, count) {
        for (int lane = 0; lane < sheet_lanes; ++lane) {
            const double* own = p + stride * std::min(first + lane, count - 1);
            double Xe[6], G[3][2];
            for (int i = 0; i < 3; ++i)
                for (int a = 0; a < 2; ++a) Xe[2 * i + a] = X[2 * static_cast<int64_t>(where_.node[i][lane]) + a];
            const double area = Tri3::gradients(0, Xe, G);
            area_[lane] = first + lane < count ? area : 0.0;
            for (int i = 0; i < 2; ++i)
                for (int k = 0; k < 2; ++k) G_[i][k][lane] = G[i + 1][k];
            for (int k = 0; k < 6; ++k) C_[k][lane] = own[k];
            for (int a = 0; a < 3; ++a) load_[a][lane] = area_[lane] * (own[6 + a] / 3);
        }
    }

    // The energies; adds the forces to `out`.
    EightLanes add(const double* x, double* out) const {
        EightLanes at[3][3], F[3][2], E[3], S[3], r[3][3];
        where_.gather(x, at);
        for (int a = 0; a < 3; ++a) {
            const EightLanes first = at[1][a] - at[0][a], second = at[2][a] - at[0][a];
            for (int k = 0; k < 2; ++k) F[a][k] = first * G_[0][k] + second * G_[1][k];
        }
        E[0] = 0.5 * (F[0][0] * F[0][0] + F[1][0] * F[1][0] + F[2][0] * F[2][0] - 1.0);
        E[1] = 0.5 * (F[0][1] * F[0][1] + F[1][1] * F[1][1] + F[2][1] * F[2][1] - 1.0);
        const EightLanes twice = F[0][0] * F[0][1] + F[1][0] * F[1][1] + F[2][0] * F[2][1];
        S[0] = E[0] * C_[0] + E[1] * C_[1] + twice * C_[3];
        S[1] = E[0] * C_[1] + E[1] * C_[2] + twice * C_[4];
        S[2] = E[0] * C_[3] + E[1] * C_[4] + twice * C_[5];
        EightLanes energy = (0.5 * (S[0] * E[0] + S[1] * E[1] + S[2] * twice)) * area_;
        for (int a = 0; a < 3; ++a) {
            energy -= (at[0][a] + at[1][a] + at[2][a]) * load_[a];
            const EightLanes first = (F[a][0] * S[0] + F[a][1] * S[2]) * area_;
            const EightLanes second = (F[a][0] * S[2] + F[a][1] * S[1]) * area_;
            r[1][a] = first * G_[0][0] + second * G_[0][1];
            r[2][a] = first * G_[1][0] + second * G_[1][1];
            r[0][a] = -(r[1][a] + r[2][a]);
            for (int i = 0; i < 3; ++i) r[i][a] -= load_[a];
        }
        where_.scatter(r, out);
        return energy;
    }

 private:
    LaneNodes<3> where_;
    EightLanes G_[2][2], area_, C_[6], load_[3];
};

// Of a `QuadraticElement`; those in lanes beyond the last have no stiffness.
template <class E>
class PackedBending {
 public:
    static constexpr int nodes = E::nodes, forms = E::forms;

    PackedBending(const double* X, const int32_t* cells, const double* p, int stride, int64_t first, int64_t count)
        : where_(cells, first, count) {
        for (int lane = 0; lane < sheet_lanes; ++lane) {
            double Xe[2 * nodes], B[nodes][forms], W[forms][forms];
            for (int i = 0; i < nodes; ++i)
                for (int a = 0; a < 2; ++a) Xe[2 * i + a] = X[2 * static_cast<int64_t>(where_.node[i][lane]) + a];
            E::prepare(Xe, p + stride * std::min(first + lane, count - 1), B, W);
            for (int m = 0; m < forms; ++m) {
                for (int i = 1; i < nodes; ++i) B_[i - 1][m][lane] = B[i][m];
                for (int l = 0; l < forms; ++l) W_[m][l][lane] = first + lane < count ? W[m][l] : 0.0;
            }
        }
    }

    // The energies; adds the forces to `out`.
    EightLanes add(const double* x, double* out) const {
        EightLanes at[nodes][3], r[nodes][3], energy{};
        where_.gather(x, at);
        for (int a = 0; a < 3; ++a) {
            EightLanes kappa[forms], moment[forms];
            for (int i = 1; i < E::corners; ++i) at[i][a] -= at[0][a];
            for (int m = 0; m < forms; ++m) {
                kappa[m] = at[1][a] * B_[0][m];
                for (int i = 2; i < nodes; ++i) kappa[m] += at[i][a] * B_[i - 1][m];
            }
            for (int m = 0; m < forms; ++m) {
                moment[m] = kappa[0] * W_[m][0];
                for (int l = 1; l < forms; ++l) moment[m] += kappa[l] * W_[m][l];
                energy += 0.5 * (kappa[m] * moment[m]);
            }
            r[0][a] = EightLanes{};
            for (int i = 1; i < nodes; ++i) {
                r[i][a] = moment[0] * B_[i - 1][0];
                for (int m = 1; m < forms; ++m) r[i][a] += moment[m] * B_[i - 1][m];
                // The forms vanish on positions that are all the same.
                if (i < E::corners) r[0][a] -= r[i][a];
            }
        }
        where_.scatter(r, out);
        return energy;
    }

 private:
    LaneNodes<nodes> where_;
    EightLanes B_[nodes - 1][forms], W_[forms][forms];
};

// All elements of one kind.
template <class Packed>
class PackedElements {
 public:
    PackedElements() = default;
    PackedElements(const double* X, const int32_t* cells, const double* p, int stride, int64_t count) {
        for (int64_t first = 0; first < count; first += sheet_lanes)
            packs_.emplace_back(X, cells, p, stride, first, count);
        energies_.resize(packs_.size());
    }

    // Adds the forces; the energies are summed in pairs, so that rounding grows little with their number.
    double add(const double* x, double* out) {
        for (size_t k = 0; k < packs_.size(); ++k) energies_[k] = packs_[k].add(x, out);
        if (packs_.empty()) return 0.0;
        const EightLanes total = sum(0, energies_.size());
        double all = 0.0;
        for (int lane = 0; lane < sheet_lanes; ++lane) all += total[lane];
        return all;
    }

 private:
    EightLanes sum(size_t first, size_t end) const {
        if (end - first == 1) return energies_[first];
        const size_t half = (first + end) / 2;
        return sum(first, half) + sum(half, end);
    }

    std::vector<Packed> packs_;
    std::vector<EightLanes> energies_;
};

}  // namespace restshape
