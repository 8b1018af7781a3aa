#include "fem/pattern.hpp"

#include <algorithm>
#include <iterator>
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

bool Block::touches(const NodeRange& own, int e) const {
    return std::any_of(dofs_of(e), dofs_of(e) + dof_nodes, [&](int32_t node) { return own.has(node); });
}

int Block::position(int e) const {
    if (all_touch) return e;
    const auto at = std::lower_bound(touching.begin(), touching.end(), e);
    return at != touching.end() && *at == e ? static_cast<int>(at - touching.begin()) : -1;
}

void Block::list_touching(const NodeRange& own) {
    all_touch = own.whole();
    touching.clear();
    if (all_touch) return;
    for (int e = 0; e < count; ++e)
        if (touches(own, e)) touching.push_back(e);
}

void Block::list_changed(const NodeRange& own, const int32_t* changed, int changed_count) {
    if (all_touch) return;
    std::vector<int32_t> come, gone;
    for (int k = 0; k < changed_count; ++k) {
        const bool listed = position(changed[k]) >= 0;
        if (touches(own, changed[k]) != listed) (listed ? gone : come).push_back(changed[k]);
    }
    if (come.empty() && gone.empty()) return;
    for (auto* list : {&come, &gone}) {
        std::sort(list->begin(), list->end());
        list->erase(std::unique(list->begin(), list->end()), list->end());
    }
    const size_t each = static_cast<size_t>(dof_nodes) * dof_nodes;
    std::vector<int32_t> stay, merged;
    std::set_difference(touching.begin(), touching.end(), gone.begin(), gone.end(), std::back_inserter(stay));
    std::set_union(stay.begin(), stay.end(), come.begin(), come.end(), std::back_inserter(merged));
    std::vector<uint16_t> moved(merged.size() * each, 0);
    // Both lists ascend: those that came have offsets of 0 until these are mended.
    size_t from = 0;
    for (size_t k = 0; k < merged.size(); ++k) {
        while (from < touching.size() && touching[from] < merged[k]) ++from;
        if (from < touching.size() && touching[from] == merged[k])
            std::copy_n(offset.begin() + from * each, each, moved.begin() + k * each);
    }
    touching.swap(merged);
    offset.swap(moved);
}

int NodeGraph::place(int row, int32_t column) const {
    const int32_t* first = adjacent.data() + start[row];
    const int length = degree(row);
    const int k = static_cast<int>(std::lower_bound(first, first + length, column) - first);
    return k < length && first[k] == column ? k : -1;
}

int NodeGraph::own_degree(int row) const {
    const int32_t *first = adjacent.data() + start[row], *last = adjacent.data() + start[row + 1];
    if (last[-1] < own_.count) return degree(row);
    return static_cast<int>(std::lower_bound(first, last, own_.count) - first);
}

void NodeGraph::build(const NodeRange& own, std::vector<Block>& blocks) {
    own_ = own;
    for (Block& b : blocks) b.offset.resize(static_cast<size_t>(b.listed()) * b.dof_nodes * b.dof_nodes);
    collect_incidence(blocks);
    start.assign(1, 0);
    start.reserve(own.count + 1);
    adjacent.clear();
    adjacent.reserve(static_cast<size_t>(own.count) * 8);
    // Nodes of other ranks have columns above those of own ones.
    const int columns = own.whole() ? own.count : own.count + own.all;
    seen_.assign(columns, -1);
    place_in_row_.resize(columns);
    for (int i = 0; i < own.count; ++i) {
        append_row(i, blocks);
        for (int s = first_[i]; s < first_[i + 1]; ++s) {
            Block& b = blocks[incident_[s].block];
            const int32_t* cell = b.dofs_of(b.element(incident_[s].slot / b.dof_nodes));
            uint16_t* offset = b.offset.data() + static_cast<size_t>(incident_[s].slot) * b.dof_nodes;
            for (int j = 0; j < b.dof_nodes; ++j) offset[j] = static_cast<uint16_t>(place_in_row_[own.column(cell[j])]);
        }
    }
    has_grown_.assign(own.count, 0);
}

void NodeGraph::collect_incidence(const std::vector<Block>& blocks) {
    const auto each_slot = [&](auto visit) {
        for (size_t k = 0; k < blocks.size(); ++k) {
            const Block& b = blocks[k];
            for (int q = 0, slot = 0; q < b.listed(); ++q) {
                const int32_t* cell = b.dofs_of(b.element(q));
                for (int i = 0; i < b.dof_nodes; ++i, ++slot)
                    if (own_.has(cell[i])) visit(cell[i] - own_.first, static_cast<int32_t>(k), slot);
            }
        }
    };
    first_.assign(own_.count + 1, 0);
    each_slot([&](int row, int32_t, int32_t) { ++first_[row + 1]; });
    for (int i = 0; i < own_.count; ++i) first_[i + 1] += first_[i];
    incident_.resize(first_[own_.count]);
    next_.assign(first_.begin(), first_.end() - 1);
    each_slot([&](int row, int32_t block, int32_t slot) { incident_[next_[row]++] = {block, slot}; });
}

void NodeGraph::append_row(int row, const std::vector<Block>& blocks) {
    const size_t begin = adjacent.size();
    seen_[row] = row;
    adjacent.push_back(row);
    for (int s = first_[row]; s < first_[row + 1]; ++s) {
        const Block& b = blocks[incident_[s].block];
        const int32_t* cell = b.dofs_of(b.element(incident_[s].slot / b.dof_nodes));
        for (int j = 0; j < b.dof_nodes; ++j) {
            const int32_t column = own_.column(cell[j]);
            if (seen_[column] == row) continue;
            seen_[column] = row;
            adjacent.push_back(column);
        }
    }
    sort_few(adjacent.data() + begin, adjacent.data() + adjacent.size());
    const size_t length = adjacent.size() - begin;
    if (length > std::numeric_limits<uint16_t>::max())
        throw std::runtime_error("a node has more than 65535 neighbours");
    for (size_t k = 0; k < length; ++k) place_in_row_[adjacent[begin + k]] = static_cast<int32_t>(k);
    start.push_back(static_cast<int32_t>(adjacent.size()));
}

const std::vector<int32_t>& NodeGraph::patch(std::vector<Block>& blocks, int block, const int32_t* changed, int count,
                                             std::vector<int32_t>& old_start) {
    blocks[block].list_changed(own_, changed, count);
    collect_missing(blocks[block], changed, count);
    grown_.clear();
    for (uint64_t pair : missing_) {
        const int32_t row = static_cast<int32_t>(pair >> 32);
        if (grown_.empty() || grown_.back() != row) grown_.push_back(row);
    }
    if (!grown_.empty()) {
        merge_missing(old_start);
        for (int32_t row : grown_) has_grown_[row] = 1;
        for (Block& b : blocks)
            for (int k = 0; k < b.listed(); ++k) {
                const int32_t* cell = b.dofs_of(b.element(k));
                uint8_t any = 0;
                for (int i = 0; i < b.dof_nodes; ++i) any |= own_.has(cell[i]) && has_grown_[cell[i] - own_.first];
                if (any) mend_offsets(b, k, false);
            }
        for (int32_t row : grown_) has_grown_[row] = 0;
    }
    for (int k = 0; k < count; ++k) {
        const int position = blocks[block].position(changed[k]);
        if (position >= 0) mend_offsets(blocks[block], position, true);
    }
    return grown_;
}

void NodeGraph::collect_missing(const Block& block, const int32_t* changed, int count) {
    missing_.clear();
    for (int k = 0; k < count; ++k) {
        const int32_t* cell = block.dofs_of(changed[k]);
        for (int i = 0; i < block.dof_nodes; ++i) {
            if (!own_.has(cell[i])) continue;
            const int32_t row = cell[i] - own_.first;
            for (int j = 0; j < block.dof_nodes; ++j) {
                const int32_t column = own_.column(cell[j]);
                if (place(row, column) < 0)
                    missing_.push_back((static_cast<uint64_t>(row) << 32) + static_cast<uint32_t>(column));
            }
        }
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
    for (int32_t row : grown_)
        if (degree(row) > std::numeric_limits<uint16_t>::max())
            throw std::runtime_error("a node has more than 65535 neighbours");
}

void NodeGraph::mend_offsets(Block& block, int position, bool all_rows) {
    const int32_t* cell = block.dofs_of(block.element(position));
    uint16_t* offset = block.offsets(position);
    for (int i = 0; i < block.dof_nodes; ++i) {
        if (!own_.has(cell[i])) continue;
        const int32_t row = cell[i] - own_.first;
        if (!all_rows && !has_grown_[row]) continue;
        for (int j = 0; j < block.dof_nodes; ++j) {
            const int k = place(row, own_.column(cell[j]));
            if (k < 0)
                throw std::runtime_error("cell " + std::to_string(block.element(position)) +
                                         " changed, but no patch has named it");
            offset[i * block.dof_nodes + j] = static_cast<uint16_t>(k);
        }
    }
}

}  // namespace restshape
