// The cells around rows: which go all the way around, and how rows are taken together.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <stdexcept>
#include <vector>

#include "fem/bounds.hpp"
#include "fem/pack.hpp"

namespace restshape {

// Rows are nodes, or nodes as one side of a border sees them. So many consecutive ones are a block, whose cells are
// numbered by themselves; those of them that have as many cells all the way around are in groups, one in a SIMD lane.
class PatchRows {
 public:
    struct Group {
        const int* rows;        // (lanes,), those beyond the last one repeat it
        int filled, cells;      // rows, and cells around each of them
        const int32_t* places;  // (cells, lanes) of the cells, in the block
    };

    PatchRows(int cells, int count) : cells_(cells), corners_(3 * static_cast<size_t>(cells)), node_of_(count) {}

    // cells (ne, 3): nodes of the corners; rows (ne, 3): their rows.
    void follow(const int32_t* cells, const int32_t* rows) {
        std::copy_n(rows, corners_.size(), corners_.begin());
        nodes_.assign(cells, cells == rows ? cells : cells + corners_.size());
        const auto size = static_cast<std::ptrdiff_t>(corners_.size());
        if (!all_within(corners_.data(), size, count()))
            throw std::invalid_argument("cells have rows that do not exist");
        int32_t least = 0, most = -1;
        for (std::ptrdiff_t k = 0; k < size; ++k)
            least = std::min(least, nodes()[k]), most = std::max(most, nodes()[k]);
        if (least < 0) throw std::invalid_argument("cells name nodes that do not exist");
        least_ = most + 1;
        const std::vector<uint8_t> inner = count_around();
        find_around();
        find_groups(inner);
    }

    int cells() const { return cells_; }
    int count() const { return static_cast<int>(node_of_.size()); }
    int least_nodes() const { return least_; }
    const int32_t* nodes() const { return nodes_.empty() ? corners_.data() : nodes_.data(); }

    int around(int row) const { return first_[row + 1] - first_[row]; }
    int cell(int row, int k) const { return in_blocks_[block_[block_of(row)] + around_[first_[row] + k]]; }
    int row(int e, int corner) const { return corners_[3 * static_cast<size_t>(e) + corner]; }
    const int32_t* node_of(int row) const { return &node_of_[row]; }
    // The corner of a cell that has a row.
    int corner_of(int e, int row) const { return this->row(e, 0) == row ? 0 : this->row(e, 1) == row ? 1 : 2; }

    int blocks() const { return static_cast<int>(block_.size()) - 1; }
    int begin(int block) const { return std::min(count(), block << block_bits); }
    // Behind them the last one is repeated until all lanes are filled.
    const int* block_cells(int block) const { return in_blocks_.data() + block_[block]; }
    int block_size(int block) const { return filled_[block] - block_[block]; }
    // Rows of a block whose cells do not go all the way around, up to those of the next one.
    const int* border(int block) const { return border_.data() + first_border_[block]; }
    int first_group(int block) const { return first_group_[block]; }
    Group group(int k) const {
        const Made& one = groups_[k];
        return {grouped_.data() + static_cast<size_t>(k) * pack_lanes, one.filled, one.cells,
                places_.data() + one.first};
    }

 private:
    static constexpr int block_bits = 10, block_rows = 1 << block_bits;  // with some 2,300 cells, 110 kB
    static int block_of(int row) { return row >> block_bits; }

    struct Made {
        int filled, cells;
        size_t first;
    };

    // How many cells each row and each block have; marks where three or more triangles go all the way around: each
    // neighbour follows and precedes one.
    std::vector<uint8_t> count_around() {
        first_.assign(count() + 1, 0);
        block_.assign((count() + block_rows - 1) / block_rows + 1, 0);
        std::vector<int64_t> balance(count(), 0);
        for (size_t k = 0; k < corners_.size(); k += 3) {
            const int32_t *row = corners_.data() + k, *node = nodes() + k;
            int64_t square[3];
            for (int i = 0; i < 3; ++i) square[i] = static_cast<int64_t>(node[i]) * (node[i] + 1);
            for (int i = 0; i < 3; ++i) {
                balance[row[i]] += square[(i + 1) % 3] - square[(i + 2) % 3];
                ++first_[row[i] + 1];
                node_of_[row[i]] = node[i];
            }
            each_block(row, [this](int block, int) { ++block_[block + 1]; });
        }
        std::vector<uint8_t> inner(count());
        for (int row = 0; row < count(); ++row) {
            inner[row] = balance[row] == 0 && first_[row + 1] >= 3;
            first_[row + 1] += first_[row];
        }
        for (size_t block = 1; block < block_.size(); ++block)
            block_[block] = block_[block - 1] + (block_[block] + pack_lanes - 1) / pack_lanes * pack_lanes;
        return inner;
    }

    // Calls visit(block, corners) for the blocks of a cell with these rows, of which most have one: the last bits are 1
    // where a corner is in the block.
    template <class Visit>
    static void each_block(const int32_t* row, const Visit& visit) {
        const int a = block_of(row[0]), b = block_of(row[1]), c = block_of(row[2]);
        if (a == b && a == c) {
            visit(a, 7);
            return;
        }
        visit(a, 1 | (b == a) << 1 | (c == a) << 2);
        if (b != a) visit(b, 2 | (c == b) << 2);
        if (c != a && c != b) visit(c, 4);
    }

    // The cells of each block, ascending, and where among them those of each row are.
    void find_around() {
        around_.resize(corners_.size());
        in_blocks_.resize(block_.back());
        filled_.assign(block_.begin(), block_.end() - 1);
        std::vector<int> next(first_.begin(), first_.end() - 1);
        for (int e = 0; e < cells_; ++e) {
            const int32_t* row = corners_.data() + 3 * static_cast<size_t>(e);
            each_block(row, [&](int block, int corners) {
                const int place = filled_[block] - block_[block];
                in_blocks_[filled_[block]++] = e;
                for (int i = 0; i < 3; ++i)
                    if (corners >> i & 1) around_[next[row[i]]++] = place;
            });
        }
        for (int block = 0; block < blocks(); ++block)
            for (int k = filled_[block]; k < block_[block + 1]; ++k) in_blocks_[k] = in_blocks_[k - 1];
    }

    void find_groups(const std::vector<uint8_t>& inner) {
        border_.clear(), first_border_.clear(), groups_.clear(), first_group_.clear(), grouped_.clear();
        places_.clear();
        places_.reserve(around_.size() + around_.size() / 32);
        std::vector<int> some, next;
        for (int begin = 0; begin < count(); begin += block_rows) {
            first_border_.push_back(static_cast<int>(border_.size()));
            first_group_.push_back(static_cast<int>(groups_.size()));
            const int end = std::min(begin + block_rows, count());
            // Rows by their number of cells, in ascending order of both.
            next.assign(1, 0);
            for (int row = begin; row < end; ++row) {
                if (!inner[row]) {
                    border_.push_back(row);
                    continue;
                }
                if (around(row) + 2 > static_cast<int>(next.size())) next.resize(around(row) + 2, 0);
                ++next[around(row) + 1];
            }
            for (size_t k = 1; k < next.size(); ++k) next[k] += next[k - 1];
            some.resize(next.back());
            for (int row = begin; row < end; ++row)
                if (inner[row]) some[next[around(row)]++] = row;
            group(some);
        }
        first_border_.push_back(static_cast<int>(border_.size()));
        first_group_.push_back(static_cast<int>(groups_.size()));
    }

    // Groups of rows that ascend by their number of cells.
    void group(const std::vector<int>& rows) {
        for (size_t k = 0, end; k < rows.size(); k = end) {
            const int cells = around(rows[k]);
            for (end = k + 1; end < rows.size() && end - k < pack_lanes && around(rows[end]) == cells;) ++end;
            groups_.push_back({static_cast<int>(end - k), cells, places_.size()});
            grouped_.resize(grouped_.size() + pack_lanes);
            places_.resize(places_.size() + static_cast<size_t>(cells) * pack_lanes);
            int* own = &*grouped_.end() - pack_lanes;
            int32_t* place = &*places_.end() - static_cast<size_t>(cells) * pack_lanes;
            for (int lane = 0; lane < pack_lanes; ++lane) {
                own[lane] = rows[std::min(k + lane, end - 1)];
                for (int i = 0; i < cells; ++i) place[i * pack_lanes + lane] = around_[first_[own[lane]] + i];
            }
        }
    }

    int cells_;
    std::vector<int32_t> corners_, nodes_;         // (ne, 3) rows, and nodes; no nodes where these are the rows
    std::vector<int32_t> node_of_;                 // of each row
    std::vector<int> first_, around_;              // cells of each row, from first to next first, by places in a block
    std::vector<int> block_, filled_, in_blocks_;  // cells of each block, from its first to where it is filled
    std::vector<int> first_border_, border_;       // rows of each block with cells on one side alone
    std::vector<int> first_group_, grouped_;       // groups of each block; rows of all
    std::vector<Made> groups_;
    std::vector<int32_t> places_;  // as of `Group`
    int32_t least_ = 0;
};

}  // namespace restshape
