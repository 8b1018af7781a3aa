// The nonzero pattern by nodes: which nodes share an element, and where in its row each pair of an element's nodes
// lies.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

namespace restshape {

// Elements of one kind. Their arrays belong to the mesh, which changes them in place when edges flip.
struct Block {
    const int32_t* geometry;  // (count, nodes): nodes whose material coordinates and coefficients an element reads
    const int32_t* dofs;      // (count, dof_nodes): nodes whose unknowns it reads; the same array but for seams,
                              // periodicity and fields on different nodes
    int count, nodes, dof_nodes;
    std::shared_ptr<void> owner;   // keeps the arrays alive
    int32_t geometry_end = 0;      // above all of `geometry`
    std::vector<uint16_t> offset;  // (count, dof_nodes, dof_nodes): place of node j in the row of node i

    const int32_t* nodes_of(int e) const { return geometry + static_cast<size_t>(e) * nodes; }
    const int32_t* dofs_of(int e) const { return dofs + static_cast<size_t>(e) * dof_nodes; }
    uint16_t* offsets(int e) { return offset.data() + static_cast<size_t>(e) * dof_nodes * dof_nodes; }
    const uint16_t* offsets(int e) const { return offset.data() + static_cast<size_t>(e) * dof_nodes * dof_nodes; }
};

// Neighbours of each node, itself included, sorted: row i is adjacent[start[i]:start[i + 1]].
class NodeGraph {
 public:
    std::vector<int32_t> start, adjacent;

    int nodes() const { return static_cast<int>(start.size()) - 1; }
    int degree(int node) const { return start[node + 1] - start[node]; }
    int place(int node, int neighbour) const;  // in the row of `node`, or -1

    // Builds all pairs of all blocks, and the offsets of the blocks.
    void build(int nodes, std::vector<Block>& blocks);

    // Inserts the pairs that the changed cells of a block lack, keeps all old ones, mends the offsets.
    // Returns the nodes whose rows grew, sorted; `old_start` gets the row starts from before when there are any.
    const std::vector<int32_t>& patch(std::vector<Block>& blocks, int block, const int32_t* changed, int count,
                                      std::vector<int32_t>& old_start);

 private:
    struct Incidence {
        int32_t block, slot;  // slot = element * dof_nodes + local node
    };

    void collect_incidence(int nodes, const std::vector<Block>& blocks);
    void append_row(int node, const std::vector<Block>& blocks);
    void collect_missing(const Block& block, const int32_t* changed, int count);
    void merge_missing(std::vector<int32_t>& old_start);
    void mend_offsets(Block& block, int e, bool all_rows);

    // Kept between calls, so that a new mesh of the same size touches no new memory.
    std::vector<Incidence> incident_;
    std::vector<int32_t> first_, next_, seen_, place_in_row_;
    std::vector<uint64_t> missing_;  // (row << 32) + column
    std::vector<int32_t> grown_, merged_;
    std::vector<uint8_t> has_grown_;
};

}  // namespace restshape
