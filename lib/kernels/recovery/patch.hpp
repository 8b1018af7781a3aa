// Superconvergent patch recovery: nodal stresses from stresses that are constant on triangles.
//
// Around an inner node a linear polynomial is fitted to the values at the triangles' centres; a boundary node takes the
// mean of the polynomials of the inner nodes next to it. Zienkiewicz and Zhu, Int. J. Numer. Meth. Engng 33 (1992)
// 1331.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "fem/corners.hpp"
#include "fem/gathered.hpp"
#include "fem/register_pack.hpp"
#include "recovery/patch_fit.hpp"
#include "recovery/patch_rows.hpp"

namespace restshape {

// Made for triangles that keep their corners; places and values may change from run to run.
//
// Rows are taken in blocks, with what they read of the cells around a block side by side in the cache, and several rows
// of a block at once that have as many cells.
class PatchRecovery {
 public:
    // So many numbers of each cell, or of each row: at most 4.
    static constexpr int most = 4;
    template <int components>
    using Values = RegisterPack[components];

    // cells (ne, 3): nodes of the corners; rows (ne, 3): where each cell has them in what is recovered, `count` rows.
    PatchRecovery(const int32_t* cells, const int32_t* rows, int ne, int count) : rows_(ne, count) {
        follow(cells, rows);
    }

    // Takes as many cells with other corners: memory that was used before is found sooner than new one.
    void follow(const int32_t* cells, const int32_t* rows) {
        rows_.follow(cells, rows);
        fitted_.assign(rows_.count(), 0);
        place_.assign(rows_.cells(), -1);
        listed_.clear();
        late_cells_.clear();
        late_count_ = 0;
    }

    int cells() const { return rows_.cells(); }
    int rows() const { return rows_.count(); }
    int least_nodes() const { return rows_.least_nodes(); }
    const int32_t* nodes() const { return rows_.nodes(); }  // (ne, 3), of the corners

    // Recovers at nodes X (n, 2), where `also` (n, 2) are other numbers of nodes that are read, or null. `give(cells,
    // count, nodes, corners, found)` finds the values of some cells, a lane each, from their nodes and the places (2,
    // 3) of these; of some cells more than once. `take(rows, count, found)` gets those of rows likewise, of rows
    // without a polynomial of their own a second time, which counts.
    template <int components, class Give, class Take>
    void run(const double* X, const double* also, const Give& give, const Take& take) {
        late_.clear();
        for (int block = 0; block < rows_.blocks(); ++block) {
            fetch(block + 1, X);
            if (also) fetch(block + 1, also);
            fill<components>(X, rows_.block_cells(block), rows_.block_size(block), give);
            late_.insert(late_.end(), rows_.border(block), rows_.border(block + 1));
            for (int group = rows_.first_group(block); group < rows_.first_group(block + 1); ++group)
                fit_group<components>(X, rows_.group(group), take);
        }
        if (late_ != listed_) list_late();
        recover_late<components>(X, give, take);
    }

 private:
    // Numbers (n, 2) of the nodes of a block, which are neighbours in memory: they arrive while the one before is
    // taken.
    void fetch(int block, const double* numbers) const {
        constexpr int nodes_a_line = 4;
        for (int row = rows_.begin(block); row < rows_.begin(block + 1); row += nodes_a_line)
            __builtin_prefetch(numbers + 2 * static_cast<size_t>(*rows_.node_of(row)), 0, 2);
    }

    // Values and centres of these cells, side by side; behind them one is repeated until all lanes are filled.
    template <int components, class Give>
    void fill(const double* X, const int* cells, int count, const Give& give) {
        const int stride = (count + register_lanes - 1) / register_lanes * register_lanes;
        room_.resize(std::max(room_.size(), static_cast<size_t>(components + 2) * stride));
        for (int i = 0; i < components + 2; ++i) at_[i] = room_.data() + static_cast<size_t>(i) * stride;
        for (int first = 0; first < count; first += register_lanes) {
            const int filled = std::min(register_lanes, count - first);
            const int32_t* corners[register_lanes];
            for (int lane = 0; lane < register_lanes; ++lane)
                corners[lane] = nodes() + 3 * static_cast<size_t>(cells[first + lane]);
            RegisterPack P[2][3];
            for (int i = 0; i < 3; ++i) corner_of(X, corners, i, P[0][i], P[1][i]);
            Values<components> found;
            give(cells + first, filled, corners, P, found);
            for (int i = 0; i < components; ++i) store(found[i], at_[i] + first);
            for (int a = 0; a < 2; ++a) store((P[a][0] + P[a][1] + P[a][2]) * (1.0 / 3.0), at_[components + a] + first);
        }
    }
    static void store(const RegisterPack& from, double* to) { std::memcpy(to, &from, sizeof(RegisterPack)); }

    // Several rows with as many cells.
    template <int components, class Take>
    void fit_group(const double* X, const PatchRows::Group& group, const Take& take) {
        const int32_t* own[register_lanes];
        for (int lane = 0; lane < register_lanes; ++lane) own[lane] = rows_.node_of(group.rows[lane]);
        RegisterPack here[2];
        corner_of(X, own, 0, here[0], here[1]);
        PatchFit<RegisterPack, components> fit;
        for (int k = 0; k < group.cells; ++k) {
            const int32_t* places = group.places + k * register_lanes;
            Values<components> value;
            for (int i = 0; i < components; ++i) value[i] = gathered(at_[i], places);
            fit.add(gathered(at_[components], places) - here[0], gathered(at_[components + 1], places) - here[1],
                    value);
        }
        fit.solve(RegisterPack{} + static_cast<double>(group.cells));
        const auto known = fit.known();
        Values<components> found;
        for (int i = 0; i < components; ++i) found[i] = fit.here(i);
        take(group.rows, group.filled, found);
        for (int lane = 0; lane < group.filled; ++lane) {
            const int row = group.rows[lane];
            fitted_[row] = known[lane] != 0;
            // What it was given is replaced.
            if (!fitted_[row]) late_.push_back(row);
        }
    }

    // The cells that rows without a polynomial of their own read, and their places.
    void list_late() {
        listed_ = late_;
        late_cells_.clear();
        std::fill(place_.begin(), place_.end(), -1);
        const auto list = [this](int e) {
            if (place_[e] >= 0) return;
            place_[e] = static_cast<int>(late_cells_.size());
            late_cells_.push_back(e);
        };
        for (const int row : late_)
            for (int k = 0; k < rows_.around(row); ++k) {
                const int e = rows_.cell(row, k);
                list(e);
                for (int i = 0; i < 3; ++i) {
                    const int beside = rows_.row(e, i);
                    for (int l = 0; fitted_[beside] && l < rows_.around(beside); ++l) list(rows_.cell(beside, l));
                }
            }
        late_count_ = static_cast<int>(late_cells_.size());
        while (late_cells_.size() % register_lanes) late_cells_.push_back(late_cells_.back());
    }

    // Rows without a polynomial of their own, of all components in any case: with fewer, which compilers take together
    // in other ways, the others would be rounded otherwise.
    template <int components, class Give, class Take>
    void recover_late(const double* X, const Give& give, const Take& take) {
        const auto give_all = [&](const int* cells, int count, const int32_t* const(&nodes)[register_lanes],
                                  const RegisterPack(&corners)[2][3], Values<most>& all) {
            Values<components> found;
            give(cells, count, nodes, corners, found);
            for (int i = 0; i < most; ++i) all[i] = i < components ? found[i] : RegisterPack{};
        };
        fill<most>(X, late_cells_.data(), late_count_, give_all);
        for (const int row : late_) {
            Values<most> all;
            around(X, row, all);
            Values<components> found;
            std::copy_n(all, components, found);
            take(&row, 1, found);
        }
    }

    // The polynomial of a row, at the place of another node.
    void at_beside(const double* X, int row, int32_t node, double (&found)[most]) const {
        const double *here = X + 2 * static_cast<size_t>(*rows_.node_of(row)),
                     *there = X + 2 * static_cast<size_t>(node);
        PatchFit<double, most> fit;
        for (int k = 0; k < rows_.around(row); ++k) {
            const int place = place_[rows_.cell(row, k)];
            double value[most];
            for (int i = 0; i < most; ++i) value[i] = at_[i][place];
            fit.add(at_[most][place] - here[0], at_[most + 1][place] - here[1], value);
        }
        fit.solve(rows_.around(row));
        for (int i = 0; i < most; ++i) found[i] = fit.at(i, there[0] - here[0], there[1] - here[1]);
    }

    // The mean of the neighbours' polynomials, in the first lane; of the triangles around where no inner node is near.
    void around(const double* X, int row, Values<most>& found) const {
        double sum[most] = {}, plain[most] = {};
        int count = 0;
        for (int k = 0; k < rows_.around(row); ++k) {
            const int e = rows_.cell(row, k);
            for (int i = 0; i < most; ++i) plain[i] += at_[i][place_[e]];
            const int own = rows_.corner_of(e, row);
            for (int j = 1; j < 3; ++j) {
                const int beside = rows_.row(e, (own + j) % 3);
                if (!fitted_[beside]) continue;
                // Few rows have none of their own: those next to them are made again, not kept.
                double there[most];
                at_beside(X, beside, *rows_.node_of(row), there);
                for (int i = 0; i < most; ++i) sum[i] += there[i];
                ++count;
            }
        }
        const int cells = std::max(1, rows_.around(row));
        for (int i = 0; i < most; ++i) found[i] = RegisterPack{} + (count > 0 ? sum[i] / count : plain[i] / cells);
    }

    PatchRows rows_;
    std::vector<uint8_t> fitted_;                  // of each row, whether it has a polynomial of its own
    std::vector<int> late_, listed_, late_cells_;  // rows without one, those of the list, and the cells of it
    std::vector<int> place_;                       // of each cell in that list
    int late_count_ = 0;                           // in that list, which is filled up for the last lanes
    std::vector<double> room_;                     // values and centres of some cells, a component after the other
    double* at_[most + 2] = {};                    // these components, and the centres behind those that there are
};

}  // namespace restshape
