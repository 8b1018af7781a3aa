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
#include "fem/pack.hpp"
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
    using Values = Pack[components];

    // cells (ne, 3): nodes of the corners; rows (ne, 3): where each cell has them in what is recovered, `count` rows.
    PatchRecovery(const int32_t* cells, const int32_t* rows, int ne, int count) : rows_(ne, count) {
        follow(cells, rows);
    }

    // Takes as many cells with other corners: memory that was used before is found sooner than new one.
    void follow(const int32_t* cells, const int32_t* rows) {
        rows_.follow(cells, rows);
        fitted_.assign(rows_.count(), 1);
        late_.assign(rows_.border(0), rows_.border(rows_.blocks()));
        for (const int row : late_) fitted_[row] = 0;
        list_late();
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
        fit_all<components>(X, also, give, take);
        if (late_ != listed_) {
            // Places on a line, which is rare: other polynomials are read than those that were kept.
            list_late();
            fit_all<components>(X, also, give, take);
        }
        fill<components>(X, late_cells_.data(), late_count_, give);
        int alone = 0;
        for (size_t first = 0; first < late_.size(); first += pack_lanes) {
            const int filled = static_cast<int>(std::min<size_t>(pack_lanes, late_.size() - first));
            Values<components> found = {};
            for (int lane = 0; lane < filled; ++lane) around<components>(X, late_[first + lane], lane, alone, found);
            take(&late_[first], filled, found);
        }
    }

 private:
    // Rows with a polynomial of their own; the others are listed.
    template <int components, class Give, class Take>
    void fit_all(const double* X, const double* also, const Give& give, const Take& take) {
        late_.clear();
        for (int block = 0; block < rows_.blocks(); ++block) {
            fetch(block + 1, X);
            if (also) fetch(block + 1, also);
            fill<components>(X, rows_.block_cells(block), rows_.block_size(block), give);
            late_.insert(late_.end(), rows_.border(block), rows_.border(block + 1));
            for (int group = rows_.first_group(block); group < rows_.first_group(block + 1); ++group)
                fit_group<components>(X, rows_.group(group), take);
        }
    }

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
        const int stride = (count + pack_lanes - 1) / pack_lanes * pack_lanes;
        room_.resize(std::max(room_.size(), static_cast<size_t>(components + 2) * stride));
        for (int i = 0; i < components + 2; ++i) at_[i] = room_.data() + static_cast<size_t>(i) * stride;
        for (int first = 0; first < count; first += pack_lanes) {
            const int filled = std::min(pack_lanes, count - first);
            const int32_t* corners[pack_lanes];
            for (int lane = 0; lane < pack_lanes; ++lane)
                corners[lane] = nodes() + 3 * static_cast<size_t>(cells[first + lane]);
            Pack P[2][3];
            for (int i = 0; i < 3; ++i) corner_of(X, corners, i, P[0][i], P[1][i]);
            Values<components> found;
            give(cells + first, filled, corners, P, found);
            for (int i = 0; i < components; ++i) store(found[i], at_[i] + first);
            for (int a = 0; a < 2; ++a) store((P[a][0] + P[a][1] + P[a][2]) * (1.0 / 3.0), at_[components + a] + first);
        }
    }
    static void store(const Pack& from, double* to) { std::memcpy(to, &from, sizeof(Pack)); }

    // Several rows with as many cells.
    template <int components, class Take>
    void fit_group(const double* X, const PatchRows::Group& group, const Take& take) {
        const int32_t* own[pack_lanes];
        for (int lane = 0; lane < pack_lanes; ++lane) own[lane] = rows_.node_of(group.rows[lane]);
        Pack here[2];
        corner_of(X, own, 0, here[0], here[1]);
        PatchFit<Pack, components> fit;
        for (int k = 0; k < group.cells; ++k) {
            const int32_t* places = group.places + k * pack_lanes;
            Values<components> value;
            for (int i = 0; i < components; ++i) value[i] = gathered(at_[i], places);
            fit.add(gathered(at_[components], places) - here[0], gathered(at_[components + 1], places) - here[1],
                    value);
        }
        fit.solve(Pack{} + static_cast<double>(group.cells));
        const auto known = fit.known();
        Values<components> found;
        for (int i = 0; i < components; ++i) found[i] = fit.here(i);
        take(group.rows, group.filled, found);
        bool kept = false;
        for (int lane = 0; lane < group.filled; ++lane) {
            const int row = group.rows[lane];
            fitted_[row] = known[lane] != 0;
            kept |= place_[row] >= 0;
            // What it was given is replaced.
            if (!fitted_[row]) late_.push_back(row);
        }
        if (kept) keep(group, fit, found);
    }

    // The polynomials of a group, for rows next to them without one: values at the nodes and derivatives.
    template <int components>
    [[gnu::always_inline]] void keep(const PatchRows::Group& group, const PatchFit<Pack, components>& fit,
                                     const Values<components>& found) {
        for (int i = 0; i < components; ++i) {
            const Pack by_x = fit.by_x(i), by_y = fit.by_y(i);
            for (int lane = 0; lane < group.filled; ++lane) {
                const int place = place_[group.rows[lane]];
                if (place < 0) continue;
                double* to = kept_.data() + numbers * static_cast<size_t>(place) + i;
                to[0] = found[i][lane], to[most] = by_x[lane], to[2 * most] = by_y[lane];
            }
        }
    }

    // The rows whose polynomials are read by rows without one, and the cells that these read themselves where no
    // polynomial is near.
    void list_late() {
        listed_ = late_;
        late_cells_.clear();
        place_.assign(rows_.count(), -1);
        alone_.clear();
        int kept = 0;
        for (const int row : late_) {
            bool near = false;
            for (int k = 0; k < rows_.around(row); ++k)
                for (int i = 0; i < 3; ++i) {
                    const int beside = rows_.row(rows_.cell(row, k), i);
                    if (!fitted_[beside]) continue;
                    near = true;
                    if (place_[beside] < 0) place_[beside] = kept++;
                }
            if (near) continue;
            alone_.push_back(static_cast<int>(late_cells_.size()));
            for (int k = 0; k < rows_.around(row); ++k) late_cells_.push_back(rows_.cell(row, k));
        }
        kept_.resize(numbers * static_cast<size_t>(kept));
        late_count_ = static_cast<int>(late_cells_.size());
        while (late_cells_.size() % pack_lanes) late_cells_.push_back(late_cells_.back());
    }

    // The mean of the neighbours' polynomials, in a lane; of the triangles around where no inner node is near.
    // `alone` counts the latter.
    template <int components>
    void around(const double* X, int row, int lane, int& alone, Values<components>& found) const {
        double sum[components] = {};
        int count = 0;
        const int cells = rows_.around(row);
        const double* there = X + 2 * static_cast<size_t>(*rows_.node_of(row));
        for (int k = 0; k < cells; ++k) {
            const int e = rows_.cell(row, k), own = rows_.corner_of(e, row);
            for (int j = 1; j < 3; ++j) {
                const int beside = rows_.row(e, (own + j) % 3);
                if (!fitted_[beside]) continue;
                const double* here = X + 2 * static_cast<size_t>(*rows_.node_of(beside));
                const double* kept = kept_.data() + numbers * static_cast<size_t>(place_[beside]);
                const double along = there[0] - here[0], across = there[1] - here[1];
                for (int i = 0; i < components; ++i)
                    sum[i] += kept[i] + along * kept[most + i] + across * kept[2 * most + i];
                ++count;
            }
        }
        if (count == 0) {
            const int first = alone_[alone++];
            for (int k = 0; k < cells; ++k)
                for (int i = 0; i < components; ++i) sum[i] += at_[i][first + k];
        }
        const double parts = std::max(1, count ? count : cells);
        for (int i = 0; i < components; ++i) found[i][lane] = sum[i] / parts;
    }

    static constexpr int numbers = 3 * most;  // of a polynomial

    PatchRows rows_;
    std::vector<uint8_t> fitted_;                  // of each row, whether it has a polynomial of its own
    std::vector<int> late_, listed_, late_cells_;  // rows without one, those of the list, and the cells of it
    std::vector<int> place_;                       // of each row's polynomial among those that are kept; -1: it is not
    std::vector<int> alone_;     // of each listed row beside which none is, its first cell in the list
    int late_count_ = 0;         // in that list, which is filled up for the last lanes
    std::vector<double> kept_;   // polynomials
    std::vector<double> room_;   // values and centres of some cells, a component after the other
    double* at_[most + 2] = {};  // these components, and the centres behind those that there are
};

}  // namespace restshape
