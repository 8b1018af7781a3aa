// The nonzero pattern by nodes: which nodes share an element, and where in its row each pair of an element's nodes
// lies. On several ranks each has the rows of its own nodes, from the elements that touch these.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

namespace restshape {

// The nodes whose rows a rank has, among all.
struct NodeRange {
    int32_t first = 0, count = 0, all = 0;

    bool whole() const { return count == all; }
    bool has(int32_t node) const { return static_cast<uint32_t>(node - first) < static_cast<uint32_t>(count); }
    // Columns of own nodes come first, by their rows; those of other ranks' nodes are `count` above these.
    int32_t column(int32_t node) const { return has(node) ? node - first : count + node; }
    int32_t node_of(int32_t column) const { return column < count ? column + first : column - count; }
};

// Elements of one kind. Their arrays belong to the mesh, which changes them in place when edges flip.
struct Block {
    const int32_t* geometry;  // (count, nodes): nodes whose material coordinates and coefficients an element reads
    const int32_t* dofs;      // (count, dof_nodes): nodes whose unknowns it reads; the same array but for seams,
                              // periodicity and fields on different nodes
    int count, nodes, dof_nodes;
    std::shared_ptr<void> owner;    // keeps the arrays alive
    int32_t geometry_end = 0;       // above all of `geometry`
    bool all_touch = true;          // whether this rank has a node of each element, as it does where it has all nodes
    std::vector<int32_t> touching;  // else the elements of which it has one, ascending
    std::vector<uint16_t> offset;   // (touching, dof_nodes, dof_nodes): place of node j in the row of own node i

    const int32_t* nodes_of(int e) const { return geometry + static_cast<size_t>(e) * nodes; }
    const int32_t* dofs_of(int e) const { return dofs + static_cast<size_t>(e) * dof_nodes; }
    const int32_t* list() const { return all_touch ? nullptr : touching.data(); }
    int listed() const { return all_touch ? count : static_cast<int>(touching.size()); }
    int element(int k) const { return all_touch ? k : touching[k]; }
    int position(int e) const;  // where an element stands among those that touch, or -1
    uint16_t* offsets(int k) { return offset.data() + static_cast<size_t>(k) * dof_nodes * dof_nodes; }
    const uint16_t* offsets(int k) const { return offset.data() + static_cast<size_t>(k) * dof_nodes * dof_nodes; }

    void list_touching(const NodeRange& own);
    // The same after some elements have changed; offsets move along.
    void list_changed(const NodeRange& own, const int32_t* changed, int count);

 private:
    bool touches(const NodeRange& own, int e) const;
};

// Neighbours of each own node, itself included, as columns of its range, sorted: row i is
// adjacent[start[i]:start[i + 1]].
class NodeGraph {
 public:
    std::vector<int32_t> start, adjacent;

    int rows() const { return own_.count; }
    int degree(int row) const { return start[row + 1] - start[row]; }
    int own_degree(int row) const;             // how many of them are own nodes
    int place(int row, int32_t column) const;  // in the row, or -1

    // Builds all pairs of all blocks, and the offsets of the blocks.
    void build(const NodeRange& own, std::vector<Block>& blocks);

    // Inserts the pairs that the changed cells of a block lack, keeps all old ones, mends the offsets.
    // Returns the rows that grew, sorted; `old_start` gets the row starts from before when there are any.
    const std::vector<int32_t>& patch(std::vector<Block>& blocks, int block, const int32_t* changed, int count,
                                      std::vector<int32_t>& old_start);

 private:
    struct Incidence {
        int32_t block, slot;  // slot = position of the element * dof_nodes + local node
    };

    void collect_incidence(const std::vector<Block>& blocks);
    void append_row(int row, const std::vector<Block>& blocks);
    void collect_missing(const Block& block, const int32_t* changed, int count);
    void merge_missing(std::vector<int32_t>& old_start);
    void mend_offsets(Block& block, int position, bool all_rows);

    NodeRange own_;
    // Kept between calls, so that a new mesh of the same size touches no new memory.
    std::vector<Incidence> incident_;
    std::vector<int32_t> first_, next_, seen_, place_in_row_;
    std::vector<uint64_t> missing_;  // (row << 32) + column
    std::vector<int32_t> grown_, merged_;
    std::vector<uint8_t> has_grown_;
};

}  // namespace restshape
