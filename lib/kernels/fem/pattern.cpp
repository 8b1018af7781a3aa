#include "fem/pattern.hpp"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>

namespace restshape {

namespace {

// Rows are short: by insertion in half the time of std::sort.
void sort_few(int32_t* begin, int32_t* end) {
    if (end - begin > 32) return std::sort(begin, end);
    for (int32_t* at = begin + 1; at < end; ++at) {
        const int32_t value = *at;
        int32_t* to = at;
        for (; to > begin && to[-1] > value; --to) *to = to[-1];
        *to = value;
    }
}

}  // namespace

int NodeGraph::place(int node, int neighbour) const {
    const int32_t* row = adjacent.data() + start[node];
    const int length = degree(node);
    const int k = static_cast<int>(std::lower_bound(row, row + length, neighbour) - row);
    return k < length && row[k] == neighbour ? k : -1;
}

void NodeGraph::build(int nodes, std::vector<Block>& blocks) {
    for (Block& b : blocks) b.offset.resize(static_cast<size_t>(b.count) * b.dof_nodes * b.dof_nodes);
    collect_incidence(nodes, blocks);
    start.assign(1, 0);
    start.reserve(nodes + 1);
    adjacent.clear();
    adjacent.reserve(static_cast<size_t>(nodes) * 8);
    seen_.assign(nodes, -1);
    place_in_row_.resize(nodes);
    for (int i = 0; i < nodes; ++i) {
        append_row(i, blocks);
        for (int s = first_[i]; s < first_[i + 1]; ++s) {
            Block& b = blocks[incident_[s].block];
            const int32_t* cell = b.dofs_of(incident_[s].slot / b.dof_nodes);
            uint16_t* offset = b.offset.data() + static_cast<size_t>(incident_[s].slot) * b.dof_nodes;
            for (int j = 0; j < b.dof_nodes; ++j) offset[j] = static_cast<uint16_t>(place_in_row_[cell[j]]);
        }
    }
    has_grown_.assign(nodes, 0);
}

void NodeGraph::collect_incidence(int nodes, const std::vector<Block>& blocks) {
    first_.assign(nodes + 1, 0);
    for (const Block& b : blocks) {
        const size_t slots = static_cast<size_t>(b.count) * b.dof_nodes;
        for (size_t s = 0; s < slots; ++s) ++first_[b.dofs[s] + 1];
    }
    for (int i = 0; i < nodes; ++i) first_[i + 1] += first_[i];
    incident_.resize(first_[nodes]);
    next_.assign(first_.begin(), first_.end() - 1);
    for (size_t k = 0; k < blocks.size(); ++k) {
        const size_t slots = static_cast<size_t>(blocks[k].count) * blocks[k].dof_nodes;
        for (size_t s = 0; s < slots; ++s)
            incident_[next_[blocks[k].dofs[s]]++] = {static_cast<int32_t>(k), static_cast<int32_t>(s)};
    }
}

void NodeGraph::append_row(int node, const std::vector<Block>& blocks) {
    const size_t row = adjacent.size();
    seen_[node] = node;
    adjacent.push_back(node);
    for (int s = first_[node]; s < first_[node + 1]; ++s) {
        const Block& b = blocks[incident_[s].block];
        const int32_t* cell = b.dofs_of(incident_[s].slot / b.dof_nodes);
        for (int j = 0; j < b.dof_nodes; ++j)
            if (seen_[cell[j]] != node) {
                seen_[cell[j]] = node;
                adjacent.push_back(cell[j]);
            }
    }
    sort_few(adjacent.data() + row, adjacent.data() + adjacent.size());
    const size_t length = adjacent.size() - row;
    if (length > std::numeric_limits<uint16_t>::max())
        throw std::runtime_error("a node has more than 65535 neighbours");
    for (size_t k = 0; k < length; ++k) place_in_row_[adjacent[row + k]] = static_cast<int32_t>(k);
    start.push_back(static_cast<int32_t>(adjacent.size()));
}

const std::vector<int32_t>& NodeGraph::patch(std::vector<Block>& blocks, int block, const int32_t* changed, int count,
                                             std::vector<int32_t>& old_start) {
    collect_missing(blocks[block], changed, count);
    grown_.clear();
    for (uint64_t pair : missing_) {
        const int32_t row = static_cast<int32_t>(pair >> 32);
        if (grown_.empty() || grown_.back() != row) grown_.push_back(row);
    }
    if (!grown_.empty()) {
        merge_missing(old_start);
        for (int32_t node : grown_) has_grown_[node] = 1;
        for (Block& b : blocks)
            for (int e = 0; e < b.count; ++e) {
                const int32_t* cell = b.dofs_of(e);
                uint8_t any = 0;
                for (int i = 0; i < b.dof_nodes; ++i) any |= has_grown_[cell[i]];
                if (any) mend_offsets(b, e, false);
            }
        for (int32_t node : grown_) has_grown_[node] = 0;
    }
    for (int k = 0; k < count; ++k) mend_offsets(blocks[block], changed[k], true);
    return grown_;
}

void NodeGraph::collect_missing(const Block& block, const int32_t* changed, int count) {
    missing_.clear();
    for (int k = 0; k < count; ++k) {
        const int32_t* cell = block.dofs_of(changed[k]);
        for (int i = 0; i < block.dof_nodes; ++i)
            for (int j = 0; j < block.dof_nodes; ++j)
                if (place(cell[i], cell[j]) < 0)
                    missing_.push_back((static_cast<uint64_t>(cell[i]) << 32) + static_cast<uint32_t>(cell[j]));
    }
    std::sort(missing_.begin(), missing_.end());
    missing_.erase(std::unique(missing_.begin(), missing_.end()), missing_.end());
}

void NodeGraph::merge_missing(std::vector<int32_t>& old_start) {
    merged_.clear();
    merged_.reserve(adjacent.capacity());
    old_start = start;
    size_t copied = 0, added = 0;
    int32_t shifted = 0;
    for (uint64_t pair : missing_) {
        const int32_t row = static_cast<int32_t>(pair >> 32), column = static_cast<int32_t>(pair & 0xffffffffu);
        for (; shifted <= row; ++shifted) start[shifted] += static_cast<int32_t>(added);
        const auto from = adjacent.begin() + std::max<size_t>(copied, old_start[row]);
        const size_t at = std::lower_bound(from, adjacent.begin() + old_start[row + 1], column) - adjacent.begin();
        merged_.insert(merged_.end(), adjacent.begin() + copied, adjacent.begin() + at);
        merged_.push_back(column);
        copied = at;
        ++added;
    }
    for (; shifted < static_cast<int32_t>(start.size()); ++shifted) start[shifted] += static_cast<int32_t>(added);
    merged_.insert(merged_.end(), adjacent.begin() + copied, adjacent.end());
    adjacent.swap(merged_);
    for (int32_t node : grown_)
        if (degree(node) > std::numeric_limits<uint16_t>::max())
            throw std::runtime_error("a node has more than 65535 neighbours");
}

void NodeGraph::mend_offsets(Block& block, int e, bool all_rows) {
    const int32_t* cell = block.dofs_of(e);
    uint16_t* offset = block.offsets(e);
    for (int i = 0; i < block.dof_nodes; ++i) {
        if (!all_rows && !has_grown_[cell[i]]) continue;
        for (int j = 0; j < block.dof_nodes; ++j) {
            const int k = place(cell[i], cell[j]);
            if (k < 0) throw std::runtime_error("cell " + std::to_string(e) + " changed, but no patch has named it");
            offset[i * block.dof_nodes + j] = static_cast<uint16_t>(k);
        }
    }
}

}  // namespace restshape
