#include "fem/operator.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace restshape {

namespace {

struct Events {
    PetscClassId id = 0;
    PetscLogEvent pattern = 0, patch = 0, values = 0;
};

// Registered once PETSc runs.
const Events& events() {
    static const Events registered = [] {
        Events e;
        check(PetscClassIdRegister("Restshape", &e.id), "PetscClassIdRegister");
        check(PetscLogEventRegister("RestshapePattern", e.id, &e.pattern), "PetscLogEventRegister");
        check(PetscLogEventRegister("RestshapePatch", e.id, &e.patch), "PetscLogEventRegister");
        check(PetscLogEventRegister("RestshapeValues", e.id, &e.values), "PetscLogEventRegister");
        return e;
    }();
    return registered;
}

std::set<const Operator*>& registered() {
    // Never destroyed: Python may let go of operators after everything else.
    static auto* all = new std::set<const Operator*>;
    return *all;
}

class Logged {
 public:
    explicit Logged(PetscLogEvent event) : event_(event) { (void)PetscLogEventBegin(event_, 0, 0, 0, 0); }
    ~Logged() { (void)PetscLogEventEnd(event_, 0, 0, 0, 0); }

 private:
    PetscLogEvent event_;
};

}  // namespace

void check(PetscErrorCode code, const char* call) {
    if (!code) return;
    const char* text = nullptr;
    char* specific = nullptr;
    PetscErrorMessage(code, &text, &specific);
    std::string message = std::string(call) + " failed with PETSc error " + std::to_string(static_cast<int>(code));
    if (text) message += std::string(": ") + text;
    if (specific && *specific) message += std::string(": ") + specific;
    throw std::runtime_error(message);
}

std::unique_ptr<Operator> Operator::create(bool world, int fields, std::vector<int32_t> node_offsets, int rank,
                                           const std::string& backend) {
    PetscBool running = PETSC_FALSE;
    PetscInitialized(&running);
    if (!running) throw std::runtime_error("PETSc is not initialised: import petsc4py and call petsc4py.init() first");
    if (backend == "csr") return make_csr_operator(world, fields, std::move(node_offsets), rank);
    if (backend == "bcsr") return make_bcsr_operator(world, fields, std::move(node_offsets), rank);
    throw std::invalid_argument("no backend \"" + backend + "\"; there are csr, bcsr");
}

Operator::Operator(bool world, int fields, std::vector<int32_t> node_offsets, int rank)
    : comm_(world ? PETSC_COMM_WORLD : PETSC_COMM_SELF),
      fields_(fields),
      rank_(rank),
      node_offsets_(std::move(node_offsets)) {
    if (fields < 1) throw std::invalid_argument("an operator needs at least one field");
    if (node_offsets_.size() < 2 || node_offsets_.front() != 0)
        throw std::invalid_argument("node_offsets must start with 0 and end with the number of nodes");
    for (size_t k = 1; k < node_offsets_.size(); ++k)
        if (node_offsets_[k] < node_offsets_[k - 1]) throw std::invalid_argument("node_offsets must not fall");
    PetscMPIInt size = 1;
    MPI_Comm_size(comm_, &size);
    if (static_cast<int>(node_offsets_.size()) - 1 != size)
        throw std::invalid_argument("node_offsets is for " + std::to_string(node_offsets_.size() - 1) +
                                    " ranks, the communicator has " + std::to_string(size));
    if (rank < 0 || rank >= size) throw std::invalid_argument("rank is not in the communicator");
    own_ = {node_offsets_[rank], node_offsets_[rank + 1] - node_offsets_[rank], nodes()};
    events();
    mask_.assign(static_cast<size_t>(nodes()) * fields_, 0);
    diagonal_.assign(mask_.size(), 0.0);
    registered().insert(this);
}

Operator::~Operator() {
    registered().erase(this);
    // petsc4py may have finalised PETSc before Python lets go of the operator.
    PetscBool finished = PETSC_FALSE;
    PetscFinalized(&finished);
    if (finished) return;
    for (Mat& mat : retired_) (void)MatDestroy(&mat);
    if (mat_) (void)MatDestroy(&mat_);
}

const std::set<const Operator*>& Operator::living() { return registered(); }

const Block& Operator::block(int k) const {
    if (k < 0 || k >= block_count())
        throw std::invalid_argument("block " + std::to_string(k) + " is not in the topology, which has " +
                                    std::to_string(block_count()));
    return blocks_[k];
}

void Operator::check_cells(const Block& b, const int32_t* list, int count) const {
    for (int k = 0; k < count; ++k) {
        const int e = list ? list[k] : k;
        if (e < 0 || e >= b.count) throw std::invalid_argument("cell " + std::to_string(e) + " does not exist");
        const auto require = [e](int32_t node, bool exists) {
            if (!exists)
                throw std::invalid_argument("cell " + std::to_string(e) + " names node " + std::to_string(node) +
                                            ", which does not exist");
        };
        for (int i = 0; i < b.dof_nodes; ++i)
            require(b.dofs_of(e)[i], b.dofs_of(e)[i] >= 0 && b.dofs_of(e)[i] < nodes());
        for (int i = 0; i < b.nodes; ++i) require(b.nodes_of(e)[i], b.nodes_of(e)[i] >= 0);
    }
}

void Operator::set_topology(std::vector<Block> blocks) {
    for (const Block& b : blocks) check_cells(b, nullptr, b.count);
    Logged event(events().pattern);
    release_retired();
    stop_filling();
    keeps_ = false;
    blocks_ = std::move(blocks);
    for (Block& b : blocks_) {
        find_geometry_end(b, nullptr, b.count);
        b.list_touching(own_);
    }
    flagged_.resize(blocks_.size());
    flag_all_constrained();
    new_pattern();
}

void Operator::patch(int k, const int32_t* changed, int count) {
    check_cells(block(k), changed, count);
    Logged event(events().patch);
    release_retired();
    stop_filling();
    keeps_ = false;
    find_geometry_end(blocks_[k], changed, count);
    flag_constrained(k, changed, count);
    patch_pattern(k, changed, count);
}

void Operator::find_geometry_end(Block& b, const int32_t* list, int count) {
    for (int k = 0; k < count; ++k) {
        const int32_t* cell = b.nodes_of(list ? list[k] : k);
        for (int i = 0; i < b.nodes; ++i) b.geometry_end = std::max(b.geometry_end, cell[i] + 1);
    }
}

void Operator::set_constraints(const uint8_t* mask) {
    keeps_ = false;
    mask_.assign(mask, mask + mask_.size());
    constrained_.clear();
    const int first = node_offsets_[rank_] * fields_, last = node_offsets_[rank_ + 1] * fields_;
    for (int dof = first; dof < last; ++dof)
        if (mask_[dof]) constrained_.push_back(dof);
    flag_all_constrained();
}

// Nodes whose first two unknowns are kept only as far as a symmetric projection keeps them.
void Operator::set_sliding(const int32_t* list, int count, const double* kept) {
    if (fields_ < 2) throw std::invalid_argument("unknowns slide in two directions, and the operator has one");
    for (int k = 0; k < count; ++k)
        if (list[k] < 0 || list[k] >= nodes())
            throw std::invalid_argument("node " + std::to_string(list[k]) + " slides and does not exist");
    keeps_ = false;
    slides_.assign(kept, kept + static_cast<size_t>(count) * 3);
    if (static_cast<size_t>(count) == sliding_.size() && std::equal(list, list + count, sliding_.begin())) return;
    sliding_.assign(list, list + count);
    slide_of_.assign(count ? static_cast<size_t>(nodes()) : 0, -1);
    for (int k = 0; k < count; ++k) slide_of_[list[k]] = k;
    flag_all_constrained();
}

void Operator::flag_all_constrained() {
    for (int k = 0; k < block_count(); ++k) flag_constrained(k, blocks_[k].list(), blocks_[k].listed());
}

void Operator::flag_constrained(int k, const int32_t* list, int count) {
    const Block& b = blocks_[k];
    flagged_[k].resize(b.count);
    for (int m = 0; m < count; ++m) {
        const int e = list ? list[m] : m;
        uint8_t any = 0;
        for (int i = 0; i < b.dof_nodes; ++i)
            for (int a = 0; a < fields_; ++a) any |= mask_[static_cast<size_t>(b.dofs_of(e)[i]) * fields_ + a];
        if (!slide_of_.empty())
            for (int i = 0; i < b.dof_nodes; ++i) any |= slide_of_[b.dofs_of(e)[i]] >= 0;
        flagged_[k][e] = any;
    }
}

void Operator::begin(bool kept) {
    if (!mat_) throw std::runtime_error("an operator needs set_topology before begin");
    if (kept && !keeps_)
        throw std::runtime_error("an operator keeps no values: topology, patches and constraints forget them");
    stop_filling();
    (void)PetscLogEventBegin(events().values, 0, 0, 0, 0);
    filling_ = true;
    const Entries target = values();
    if (kept) {
        std::copy(kept_.begin(), kept_.end(), target.data);
        for (size_t k = 0; k < constrained_.size(); ++k) diagonal_[constrained_[k]] = kept_diagonal_[k];
    } else {
        std::fill_n(target.data, target.count, 0.0);
        for (int32_t dof : constrained_) diagonal_[dof] = 0.0;
    }
}

void Operator::keep() {
    if (!filling_) throw std::runtime_error("an operator needs begin before keep");
    keeps_ = true;
    kept_.assign(values().data, values().data + values().count);
    kept_diagonal_.clear();
    for (int32_t dof : constrained_) kept_diagonal_.push_back(diagonal_[dof]);
}

void Operator::add(int k, const Terms& terms) {
    if (!filling_) throw std::runtime_error("an operator needs begin before add");
    if (terms.list.empty()) throw std::invalid_argument("a sum needs a term");
    for (const Term& term : terms.list) {
        const Element& e = *term.element;
        const Block& b = block(k);
        if (e.fields != fields_ || e.nodes != b.nodes || e.dof_nodes != b.dof_nodes ||
            e.dim != terms.list.front().element->dim)
            throw std::invalid_argument(e.name + " has " + std::to_string(e.nodes) + " nodes and " +
                                        std::to_string(e.fields) + " fields on " + std::to_string(e.dof_nodes) +
                                        "; block " + std::to_string(k) + " has " + std::to_string(b.nodes) +
                                        " nodes and dofs on " + std::to_string(b.dof_nodes) + ", the operator " +
                                        std::to_string(fields_) + " fields");
    }
    if (terms.subset) check_cells(block(k), terms.subset, terms.subset_count);
    const int count = terms.subset ? terms.subset_count : block(k).count;
    for (const Term& term : terms.list)
        term.element->tally->add(term.element->has_tangent() ? Purpose::tangent : Purpose::residual, count);
    const Block& b = block(k);
    if (!terms.subset || b.all_touch) return assemble(k, terms);
    std::vector<int32_t> touching, rows;
    for (int q = 0; q < terms.subset_count; ++q) {
        if (b.position(terms.subset[q]) < 0) continue;
        touching.push_back(terms.subset[q]);
        rows.push_back(terms.parameter_row(q, terms.subset[q]));
    }
    Terms own = terms;
    own.subset = touching.data();
    own.subset_count = static_cast<int>(touching.size());
    own.parameter_rows = rows.data();
    if (own.subset_count) assemble(k, own);
}

void Operator::end() {
    if (!filling_) throw std::runtime_error("an operator needs begin before end");
    // A supported node without stiffness of its own still needs a regular row.
    for (int32_t dof : constrained_)
        if (diagonal_[dof] == 0.0) set_diagonal(dof, 1.0);
    finish();
    stop_filling();
}

void Operator::stop_filling() {
    if (filling_) (void)PetscLogEventEnd(events().values, 0, 0, 0, 0);
    filling_ = false;
}

bool Operator::packs(const Terms& terms) {
    // On the diagonal of what is constrained each term adds its size: that is the size of the sum where all are added.
    const bool single = terms.list.size() == 1;
    return terms.list.size() <= max_packed_terms &&
           std::all_of(terms.list.begin(), terms.list.end(),
                       [&](const Term& t) { return t.element->packed.tangent && (single || t.coef >= 0.0); });
}

void Operator::constrain(const Element& element, const int32_t* dofs, double coef, double* r, double* K) {
    const int n = element.unknowns(), stride = element.tangent_stride;
    for (int i = 0; i < n; ++i) {
        const size_t dof = static_cast<size_t>(dofs[i / fields_]) * fields_ + i % fields_;
        if (!mask_[dof]) continue;
        r[i] = 0.0;
        if (!element.has_tangent()) continue;
        const double kept = std::fabs(K[i * stride + i]);
        for (int j = 0; j < n; ++j) K[i * stride + j] = K[j * stride + i] = 0.0;
        K[i * stride + i] = coef < 0 ? -kept : kept;
        diagonal_[dof] += std::fabs(coef) * kept;
    }
    if (slide_of_.empty()) return;
    for (int i = 0; i < element.dof_nodes; ++i)
        if (slide_of_[dofs[i]] >= 0) slide(element, i, slides_.data() + slide_of_[dofs[i]] * 3, coef, r, K);
}

// With P = {{xx, xy}, {xy, yy}}: P r, and P K P with what the diagonal lacks times I - P.
void Operator::slide(const Element& element, int node, const double* kept, double coef, double* r, double* K) const {
    const int n = element.unknowns(), stride = element.tangent_stride, x = node * fields_, y = x + 1;
    const double xx = kept[0], xy = kept[1], yy = kept[2];
    const auto project = [=](double& a, double& b) {
        const double first = xx * a + xy * b;
        b = xy * a + yy * b;
        a = first;
    };
    project(r[x], r[y]);
    if (!element.has_tangent()) return;
    double *rx = K + static_cast<size_t>(x) * stride, *ry = K + static_cast<size_t>(y) * stride;
    const double size = (std::fabs(rx[x]) + std::fabs(ry[y])) * (coef < 0 ? -0.5 : 0.5);
    for (int j = 0; j < n; ++j) project(rx[j], ry[j]);
    for (int i = 0; i < n; ++i) project(K[i * stride + x], K[i * stride + y]);
    rx[x] += size * (1.0 - xx);
    ry[y] += size * (1.0 - yy);
    rx[y] -= size * xy;
    ry[x] -= size * xy;
}

Mat Operator::mat() const {
    if (!mat_) throw std::runtime_error("an operator needs set_topology before it has a matrix");
    return mat_;
}

void Operator::replace_matrix(Mat mat) {
    if (mat_) retired_.push_back(mat_);
    mat_ = mat;
    ++generation_;
}

// petsc4py only queues an object whose last reference it drops (PetscObjectDelayedDestroy), so the last one must be
// ours.
void Operator::release_retired() {
    size_t kept = 0;
    for (Mat mat : retired_) {
        PetscInt references = 0;
        check(PetscObjectGetReference(reinterpret_cast<PetscObject>(mat), &references), "PetscObjectGetReference");
        if (references > 1)
            retired_[kept++] = mat;
        else
            check(MatDestroy(&mat), "MatDestroy");
    }
    retired_.resize(kept);
}

}  // namespace restshape
