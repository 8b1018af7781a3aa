// Signed distances on an even lattice: blocks of its places share the triangles of which one is nearest to any of them.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "cloth/surface_search.hpp"
#include "fem/pack.hpp"

namespace restshape {

// An even lattice with z running fastest; `wanted` are the places that are looked for.
struct Lattice {
    double origin[3], spacing;
    long counts[3];
    const std::uint8_t* wanted;

    std::size_t number(const long* at) const {
        return static_cast<std::size_t>((at[0] * counts[1] + at[1]) * counts[2] + at[2]);
    }
};

class LatticeDistance {
 public:
    // Distances from `outer`, negative where `whole` winds around a place; dipoles: see SurfaceSearch::winding.
    LatticeDistance(const SurfaceSearch& outer, const SurfaceSearch& whole, double far)
        : outer_(outer), whole_(whole), far_(far) {}

    void fill(const Lattice& lattice, double* values) {
        lattice_ = lattice;
        values_ = values;
        long at[3];
        for (at[0] = 0; at[0] < lattice.counts[0]; at[0] += wide)
            for (at[1] = 0; at[1] < lattice.counts[1]; at[1] += wide)
                for (at[2] = 0; at[2] < lattice.counts[2]; at[2] += wide)
                    if (any_wanted(at, wide)) large_block(at);
    }

 private:
    static constexpr long wide = 8, side = 4, places = side * side * side, packs = places / pack_lanes;

    bool any_wanted(const long* first, long width) const {
        long at[3];
        for (at[0] = first[0]; at[0] < end(first, 0, width); ++at[0])
            for (at[1] = first[1]; at[1] < end(first, 1, width); ++at[1]) {
                at[2] = first[2];
                const std::uint8_t* row = lattice_.wanted + lattice_.number(at);
                if (std::any_of(row, row + (end(first, 2, width) - first[2]), [](std::uint8_t one) { return one; }))
                    return true;
            }
        return false;
    }
    long end(const long* first, int a, long width) const { return std::min(first[a] + width, lattice_.counts[a]); }

    void middle(const long* first, long width, double* at) const {
        for (int a = 0; a < 3; ++a) at[a] = lattice_.origin[a] + lattice_.spacing * (first[a] + 0.5 * (width - 1));
    }
    double radius(long width) const { return 0.5 * std::sqrt(3.0) * lattice_.spacing * (width - 1); }

    void large_block(const long* first) {
        double centre[3];
        middle(first, wide, centre);
        const double clear = outer_.within_reach(centre, radius(wide), near_);
        one_side_ = clear > 1.001 * radius(wide);
        if (one_side_) inside_ = inside(centre);
        long at[3];
        for (at[0] = first[0]; at[0] < end(first, 0, wide); at[0] += side)
            for (at[1] = first[1]; at[1] < end(first, 1, wide); at[1] += side)
                for (at[2] = first[2]; at[2] < end(first, 2, wide); at[2] += side)
                    if (any_wanted(at, side)) block(at);
    }

    void block(const long* first) {
        double centre[3], least = std::numeric_limits<double>::infinity();
        middle(first, side, centre);
        squares_.clear();
        for (const Face& face : near_) {
            squares_.push_back(square_of_distance(face, centre));
            least = std::min(least, squares_.back());
        }
        const double most = std::sqrt(least) * (1.0 + 1e-12) + 2.0 * radius(side);
        Pack found[packs], y[packs][3];
        lay_out(first, y);
        for (Pack& square : found) square = Pack{} + std::numeric_limits<double>::infinity();
        for (std::size_t k = 0; k < near_.size(); ++k)
            if (squares_[k] <= most * most)
                for (int p = 0; p < packs; ++p) closer(near_[k], y[p], found[p]);
        write(first, found, std::sqrt(least) > 1.001 * radius(side), centre);
    }

    void lay_out(const long* first, Pack (*y)[3]) const {
        for (long k = 0; k < places; ++k) {
            long at[3];
            place(first, k, at);
            for (int a = 0; a < 3; ++a)
                y[k / pack_lanes][a][k % pack_lanes] = lattice_.origin[a] + lattice_.spacing * at[a];
        }
    }

    // The smaller of squares of distances and those of a triangle.
    [[gnu::always_inline]] static void closer(const Face& face, const Pack* y, Pack& found) {
        Pack at[3], square{};
        nearest_place(face.x[0], face.x[1], face.x[2], y, at);
        for (int k = 0; k < 3; ++k) square += (y[k] - at[k]) * (y[k] - at[k]);
        found = square < found ? square : found;
    }

    // Signs as well: of a block that the surface does not pass through, the same for all.
    void write(const long* first, const Pack* found, bool one_side, const double* centre) {
        double own[places];
        bool within[places];
        for (long k = 0; k < places; ++k) own[k] = std::sqrt(found[k / pack_lanes][k % pack_lanes]);
        if (one_side_ || one_side)
            std::fill(within, within + places, one_side_ ? inside_ : inside(centre));
        else
            find_sides(first, own, within);
        for (long k = 0; k < places; ++k) {
            long at[3];
            place(first, k, at);
            if (at[0] >= lattice_.counts[0] || at[1] >= lattice_.counts[1] || at[2] >= lattice_.counts[2]) continue;
            const std::size_t number = lattice_.number(at);
            if (lattice_.wanted[number]) values_[number] = within[k] ? -own[k] : own[k];
        }
    }
    static void place(const long* first, long k, long* at) {
        at[0] = first[0] + k / (side * side), at[1] = first[1] + k / side % side, at[2] = first[2] + k % side;
    }

    // Of a place as of one before it, where the balls around both touch and hold no surface; else by its winding
    // number.
    void find_sides(const long* first, const double* own, bool* within) const {
        for (long k = 0; k < places; ++k) {
            const long back[3] = {k % side ? 1 : 0, k / side % side ? side : 0, k / (side * side) ? side * side : 0};
            const long* known = std::find_if(
                back, back + 3, [&](long way) { return way && lattice_.spacing < 0.999 * (own[k] + own[k - way]); });
            if (known != back + 3) {
                within[k] = within[k - *known];
                continue;
            }
            long at[3];
            double y[3];
            place(first, k, at);
            for (int a = 0; a < 3; ++a) y[a] = lattice_.origin[a] + lattice_.spacing * at[a];
            within[k] = inside(y);
        }
    }
    bool inside(const double* y) const { return whole_.winding(y, far_) > 0.5; }

    const SurfaceSearch &outer_, &whole_;
    const double far_;
    Lattice lattice_{};
    double* values_ = nullptr;
    std::vector<Face> near_;  // of the large block
    std::vector<double> squares_;
    bool one_side_ = false, inside_ = false;  // of the large block
};

}  // namespace restshape
