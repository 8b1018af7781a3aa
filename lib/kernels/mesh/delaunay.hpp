// Delaunay refinement of a polygonal region by CGAL's Delaunay_mesher_2, with a size field.
//
// Nothing here is random, and no order depends on addresses: equally bad triangles are refined in the order in which
// they were found, and CGAL's containers are walked in the order in which they were filled.
#pragma once

#define CGAL_NDEBUG 1
// Exact arithmetic decides few predicates: Boost's is fast enough, and no library has to be linked.
#define CGAL_DISABLE_GMP 1
#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Delaunay_mesh_face_base_2.h>
#include <CGAL/Delaunay_mesh_vertex_base_2.h>
#include <CGAL/Delaunay_mesher_2.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Triangulation_face_base_with_info_2.h>
#include <CGAL/Triangulation_vertex_base_with_info_2.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <list>
#include <map>
#include <memory>
#include <stdexcept>
#include <type_traits>
#include <unordered_map>
#include <utility>
#include <vector>

#include "mesh/relaxation.hpp"
#include "mesh/size.hpp"
#include "mesh/stock.hpp"

namespace restshape {

// The boundary cannot be meshed, or only with too many triangles.
struct MesherFailure : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// Points keep their numbers; then come those that split segments, by segment and along it; then those inside.
struct MeshOutput {
    std::vector<double> X;
    std::vector<std::int32_t> cells, split_segment;
    std::vector<double> split_fraction;
};

namespace cgal {

// Angles decide only whether a side is split: where one is a right one but for rounding, either is well.
struct Kernel : CGAL::Exact_predicates_inexact_constructions_kernel {
    struct Angle_2 {
        using result_type = CGAL::Angle;
        CGAL::Angle operator()(const Point_2& p, const Point_2& q, const Point_2& r) const {
            const double dot = (p.x() - q.x()) * (r.x() - q.x()) + (p.y() - q.y()) * (r.y() - q.y());
            return static_cast<CGAL::Angle>(CGAL::sign(dot));
        }
    };
    Angle_2 angle_2_object() const { return {}; }
};
struct Number {
    std::int32_t value = -1;
};
using VertexBase =
    CGAL::Triangulation_vertex_base_with_info_2<Number, Kernel, CGAL::Delaunay_mesh_vertex_base_2<Kernel>>;
using FaceBase = CGAL::Delaunay_mesh_face_base_2<
    Kernel, CGAL::Constrained_Delaunay_triangulation_face_base_2<
                Kernel, CGAL::Constrained_triangulation_face_base_2<
                            Kernel, CGAL::Triangulation_face_base_with_info_2<Number, Kernel>>>>;
using Structure = CGAL::Triangulation_data_structure_2<VertexBase, FaceBase>;
using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<Kernel, Structure>;
using Vertex = Triangulation::Vertex_handle;
using Face = Triangulation::Face_handle;
using Point = Kernel::Point_2;

// How urgently a triangle is refined: too large ones first, then the sharpest.
struct Quality {
    double size = 0.0, sine = 1.0;
    bool operator<(const Quality& other) const {
        if (size > 1.0 || other.size > 1.0) return size > other.size;
        return sine < other.sine;
    }
};

}  // namespace cgal
}  // namespace restshape

#ifdef __GLIBCXX__
// Each node that is inserted fills lists of the triangles and sides around it. What they let go of serves the next
// ones: to allocate it anew takes a tenth of the refinement.
namespace restshape {
namespace cgal {

template <class Item>
struct KeptItems {
    union Place {
        Place* next;
        alignas(Item) unsigned char room[sizeof(Item)];
    };

    ~KeptItems() {
        while (first) {
            Place* last = first;
            first = last->next;
            delete last;
        }
    }

    void* take() {
        Place* place = first;
        if (place) {
            first = place->next;
            return place;
        }
        ++made;
        return new Place;
    }
    void give(void* item) {
        auto* place = static_cast<Place*>(item);
        place->next = first;
        first = place;
    }

    Place* first = nullptr;
    std::int64_t made = 0;
};

// Of all meshes: Python's lock lets one thread refine at a time.
template <class Item>
inline KeptItems<Item> kept_items;

// What an allocator is of which all are alike.
template <class Item>
struct KeepingAllocator {
    using value_type = Item;
    using size_type = std::size_t;
    using difference_type = std::ptrdiff_t;
    using is_always_equal = std::true_type;

    Item* allocate(std::size_t count) {
        if (count != 1) return static_cast<Item*>(::operator new(count * sizeof(Item)));
        return static_cast<Item*>(kept_items<Item>.take());
    }
    void deallocate(Item* item, std::size_t count) {
        if (count != 1) return ::operator delete(item);
        kept_items<Item>.give(item);
    }
    // Asked for up to C++17.
    template <class Other, class... Given>
    void construct(Other* at, Given&&... given) {
        ::new (static_cast<void*>(at)) Other(std::forward<Given>(given)...);
    }
    template <class Other>
    void destroy(Other* at) {
        at->~Other();
    }
    friend bool operator==(const KeepingAllocator&, const KeepingAllocator&) { return true; }
    friend bool operator!=(const KeepingAllocator&, const KeepingAllocator&) { return false; }
};

using FaceItem = std::_List_node<Face>;
using SideItem = std::_List_node<Triangulation::Edge>;

// How many items have been allocated.
inline std::int64_t items_made() { return kept_items<FaceItem>.made + kept_items<SideItem>.made; }

}  // namespace cgal
}  // namespace restshape

template <>
struct std::allocator<restshape::cgal::FaceItem> : restshape::cgal::KeepingAllocator<restshape::cgal::FaceItem> {
    allocator() = default;
    template <class Other>
    allocator(const std::allocator<Other>&) {}
};
template <>
struct std::allocator<restshape::cgal::SideItem> : restshape::cgal::KeepingAllocator<restshape::cgal::SideItem> {
    allocator() = default;
    template <class Other>
    allocator(const std::allocator<Other>&) {}
};
#else
namespace restshape {
namespace cgal {
inline std::int64_t items_made() { return 0; }
}  // namespace cgal
}  // namespace restshape
#endif

// CGAL's queue of bad triangles is a pair of search trees, half of the mesher's time. A heap gives the same order, the
// oldest first among equals: entries that were erased stay in it until they come to the top.
template <class Compare, class Reverse>
class CGAL::Double_map<restshape::cgal::Face, restshape::cgal::Quality, Compare, Reverse> {
    using Face = restshape::cgal::Face;
    using Quality = restshape::cgal::Quality;
    struct Entry {
        Quality first;
        std::int32_t ticket;
        Face second;
        bool operator<(const Entry& other) const {
            if (first < other.first) return false;
            return other.first < first || ticket > other.ticket;
        }
    };

 public:
    using Direct_entry = std::pair<Face, Quality>;
    using const_iterator = const Direct_entry*;

    void clear() { heap_.clear(), waits_.clear(), count_ = 0; }
    bool empty() const { return count_ == 0; }

    bool insert(const Face& face, const Quality& quality) {
        if (face->info().value >= 0) return false;
        face->info().value = static_cast<std::int32_t>(waits_.size());
        heap_.push_back({quality, face->info().value, face});
        std::push_heap(heap_.begin(), heap_.end());
        waits_.push_back(1), ++count_;
        return true;
    }

    bool erase(const Face& face) {
        if (face->info().value < 0) return false;
        waits_[face->info().value] = 0, --count_;
        face->info().value = -1;
        return true;
    }

    const Entry* front() {
        while (!waits_[heap_.front().ticket]) {
            std::pop_heap(heap_.begin(), heap_.end());
            heap_.pop_back();
        }
        return heap_.data();
    }

    void pop_front() { erase(front()->second); }

 private:
    std::vector<Entry> heap_;
    std::vector<std::uint8_t> waits_;
    std::size_t count_ = 0;
};

namespace restshape {
namespace cgal {

// The standard library's are compiled before the option for rounding, for which they are called one by one.
inline double smaller(double a, double b) { return b < a ? b : a; }
inline double larger(double a, double b) { return a < b ? b : a; }

// Triangles are bad if their longest edge exceeds `stretch` x the size at their centre, or their least angle is below
// asin(sqrt(sine_bound)).
class Criteria {
 public:
    using Quality = cgal::Quality;

    // `patience`: triangles that may be judged before the refinement counts as endless.
    Criteria(const SizeField& field, double stretch, double sine_bound, std::size_t patience)
        : field_(&field), stretch_(stretch), sine_bound_(sine_bound), patience_(patience) {}

    class Is_bad {
     public:
        explicit Is_bad(const Criteria& criteria) : criteria_(criteria) {}

        CGAL::Mesh_2::Face_badness operator()(const Quality& quality) const {
            if (quality.size > 1.0) return CGAL::Mesh_2::IMPERATIVELY_BAD;
            return quality.sine < criteria_.sine_bound_ ? CGAL::Mesh_2::BAD : CGAL::Mesh_2::NOT_BAD;
        }

        CGAL::Mesh_2::Face_badness operator()(const Face& face, Quality& quality) const {
            const Point &a = face->vertex(0)->point(), &b = face->vertex(1)->point(), &c = face->vertex(2)->point();
            const double abx = b.x() - a.x(), aby = b.y() - a.y(), acx = c.x() - a.x(), acy = c.y() - a.y();
            const double bcx = c.x() - b.x(), bcy = c.y() - b.y();
            const double ab = abx * abx + aby * aby, bc = bcx * bcx + bcy * bcy, ca = acx * acx + acy * acy;
            const double low = smaller(ab, bc), high = larger(ab, bc);
            const double longest = larger(high, ca), shortest = smaller(low, ca);
            const double middle = larger(low, smaller(high, ca));
            const double third = 1.0 / 3.0;
            const double size = criteria_.stretch_ *
                                criteria_.field_->at((a.x() + b.x() + c.x()) * third, (a.y() + b.y() + c.y()) * third);
            if (++criteria_.judged_ > criteria_.patience_ || !(shortest > 1e-8 * size * size))
                throw MesherFailure("the refinement does not end");
            quality.size = longest / (size * size);
            const double area = abx * acy - acx * aby;
            quality.sine = area * area / (longest * middle);
            return (*this)(quality);
        }

     private:
        const Criteria& criteria_;
    };

    Is_bad is_bad_object() const { return Is_bad(*this); }

 private:
    const SizeField* field_;
    double stretch_, sine_bound_;
    std::size_t patience_;
    mutable std::size_t judged_ = 0;
};

inline std::uint64_t key(std::int32_t a, std::int32_t b) {
    return (static_cast<std::uint64_t>(static_cast<std::uint32_t>(a)) << 32) | static_cast<std::uint32_t>(b);
}

// All points and segments, each segment one edge of the triangulation.
inline std::vector<Vertex> insert_boundary(Triangulation& mesh, const MeshInput& input) {
    std::vector<Vertex> vertices;
    vertices.reserve(input.point_count);
    for (std::ptrdiff_t i = 0; i < input.point_count; ++i) {
        const Point point(input.points[2 * i], input.points[2 * i + 1]);
        const Vertex vertex = mesh.insert(point, i ? vertices.back()->face() : Face());
        if (vertex->info().value >= 0) throw MesherFailure("two points of the boundary coincide");
        vertex->info().value = static_cast<std::int32_t>(i);
        vertices.push_back(vertex);
    }
    try {
        for (std::ptrdiff_t i = 0; i < input.segment_count; ++i)
            mesh.insert_constraint(vertices[input.segments[2 * i]], vertices[input.segments[2 * i + 1]]);
    } catch (const Triangulation::Intersection_of_constraints_exception&) {
        throw MesherFailure("the boundary crosses itself");
    }
    if (mesh.dimension() < 2) throw MesherFailure("the boundary has no area");
    return vertices;
}

// Unmarks all that can be reached from a face without crossing a segment.
inline void leave_domain(const Face& start, std::vector<Face>& stack) {
    if (!start->is_in_domain()) return;
    start->set_in_domain(false);
    stack.assign(1, start);
    while (!stack.empty()) {
        const Face face = stack.back();
        stack.pop_back();
        for (int i = 0; i < 3; ++i) {
            const Face next = face->neighbor(i);
            if (face->is_constrained(i) || !next->is_in_domain()) continue;
            next->set_in_domain(false);
            stack.push_back(next);
        }
    }
}

// Marks what lies left of the border; returns its area.
inline double mark_domain(Triangulation& mesh, const MeshInput& input, const std::vector<Vertex>& vertices) {
    for (auto face = mesh.all_faces_begin(); face != mesh.all_faces_end(); ++face) face->set_in_domain(true);
    std::vector<Face> stack;
    leave_domain(mesh.infinite_face(), stack);
    std::vector<Face> left;
    for (std::ptrdiff_t i = 0; i < input.segment_count; ++i) {
        Face face;
        int corner = 0;
        if (!mesh.is_edge(vertices[input.segments[2 * i]], vertices[input.segments[2 * i + 1]], face, corner) ||
            !face->is_constrained(corner))
            throw MesherFailure("the boundary touches itself");
        if (!input.border[i]) continue;
        // Counterclockwise in `face` the edge runs from corner + 1 to corner + 2.
        const Face other = face->neighbor(corner);
        const bool along = face->vertex(Triangulation::ccw(corner)) == vertices[input.segments[2 * i]];
        left.push_back(along ? face : other);
        leave_domain(along ? other : face, stack);
    }
    for (const Face& face : left)
        if (!face->is_in_domain()) throw MesherFailure("a hole lies outside the outline or inside another one");
    double area = 0.0;
    std::vector<std::uint8_t> inside(input.point_count, 0);
    for (auto face = mesh.finite_faces_begin(); face != mesh.finite_faces_end(); ++face) {
        if (!face->is_in_domain()) continue;
        area += mesh.triangle(face).area();
        for (int i = 0; i < 3; ++i) inside[face->vertex(i)->info().value] = 1;
    }
    if (std::find(inside.begin(), inside.end(), 0) != inside.end())
        throw MesherFailure("a point lies outside the material");
    return area;
}

// Numbers the points that split segments, and says where they lie.
inline void number_splits(Triangulation& mesh, const MeshInput& input, const std::vector<Vertex>& vertices,
                          MeshOutput& output) {
    // The neighbours along segments of each new vertex on one, numbered -2, -3, ... for now.
    std::vector<Vertex> found;
    std::vector<std::pair<Vertex, Vertex>> ends;
    for (auto edge = mesh.finite_edges_begin(); edge != mesh.finite_edges_end(); ++edge) {
        if (!mesh.is_constrained(*edge)) continue;
        const Vertex a = edge->first->vertex(Triangulation::cw(edge->second));
        const Vertex b = edge->first->vertex(Triangulation::ccw(edge->second));
        for (const auto& [own, other] : {std::pair(a, b), std::pair(b, a)}) {
            if (own->info().value >= 0) continue;
            if (own->info().value == -1) {
                own->info().value = -2 - static_cast<std::int32_t>(found.size());
                found.push_back(own), ends.emplace_back(other, Vertex());
            } else {
                ends[-2 - own->info().value].second = other;
            }
        }
    }
    if (found.empty()) return;
    std::unordered_map<std::uint64_t, std::vector<Vertex>> chains;
    for (const Vertex& start : found) {
        // Each chain is walked from the new vertices beside its ends, in both directions.
        for (Vertex from : {ends[-2 - start->info().value].first, ends[-2 - start->info().value].second}) {
            if (from->info().value < 0) continue;
            const std::int32_t first = from->info().value;
            std::vector<Vertex> chain;
            Vertex at = start;
            while (at->info().value < 0) {
                chain.push_back(at);
                const auto& [a, b] = ends[-2 - at->info().value];
                const Vertex next = a == from ? b : a;
                from = at, at = next;
            }
            chains[key(first, at->info().value)] = std::move(chain);
        }
    }
    for (std::ptrdiff_t i = 0; i < input.segment_count; ++i) {
        const std::int32_t a = input.segments[2 * i], b = input.segments[2 * i + 1];
        const auto chain = chains.find(key(a, b));
        if (chain == chains.end()) continue;
        const double length = std::sqrt(CGAL::squared_distance(vertices[a]->point(), vertices[b]->point()));
        for (const Vertex& vertex : chain->second) {
            output.split_segment.push_back(static_cast<std::int32_t>(i));
            output.split_fraction.push_back(std::sqrt(CGAL::squared_distance(vertices[a]->point(), vertex->point())) /
                                            length);
        }
    }
    // Numbered last: the chains are distinguished from the given points by negative numbers.
    std::int32_t number = static_cast<std::int32_t>(input.point_count);
    for (std::ptrdiff_t i = 0; i < input.segment_count; ++i) {
        const auto chain = chains.find(key(input.segments[2 * i], input.segments[2 * i + 1]));
        if (chain == chains.end()) continue;
        for (const Vertex& vertex : chain->second) vertex->info().value = number++;
    }
    if (output.split_segment.size() != found.size()) throw MesherFailure("a boundary segment got lost");
}

inline MeshOutput read_mesh(Triangulation& mesh, const MeshInput& input, const std::vector<Vertex>& vertices) {
    MeshOutput output;
    number_splits(mesh, input, vertices, output);
    auto number = static_cast<std::int32_t>(input.point_count + output.split_segment.size());
    output.X.resize(2 * mesh.number_of_vertices());
    output.cells.reserve(3 * mesh.number_of_faces());
    for (auto face = mesh.finite_faces_begin(); face != mesh.finite_faces_end(); ++face) {
        if (!face->is_in_domain()) continue;
        for (int i = 0; i < 3; ++i) {
            const Vertex vertex = face->vertex(i);
            if (vertex->info().value < 0) vertex->info().value = number++;
            output.X[2 * vertex->info().value] = vertex->point().x();
            output.X[2 * vertex->info().value + 1] = vertex->point().y();
            output.cells.push_back(vertex->info().value);
        }
    }
    if (static_cast<std::size_t>(number) != mesh.number_of_vertices()) throw MesherFailure("a point got lost");
    return output;
}

inline MeshOutput refine(const MeshInput& input, const SizeField& field, double stretch, double sine_bound,
                         std::size_t patience) {
    Triangulation mesh;
    const auto vertices = insert_boundary(mesh, input);
    const double wanted = 0.5 * doubled_area(input), area = mark_domain(mesh, input, vertices);
    if (!(std::abs(area - wanted) <= 1e-9 * std::abs(wanted))) throw MesherFailure("the boundary is not closed");
    Criteria criteria(field, stretch, sine_bound, patience);
    CGAL::Delaunay_mesher_2<Triangulation, Criteria> mesher(mesh, criteria);
    mesher.init(true);
    mesher.refine_mesh();
    return read_mesh(mesh, input, vertices);
}

// Halves the triangle in stock on whose side the mesher has put a node; returns false where it has put two.
inline bool halve(std::vector<std::int32_t>& cells, std::size_t cell, std::int32_t corner, std::int32_t node,
                  std::vector<std::uint8_t>& halved) {
    if (halved[cell]) return false;
    halved[cell] = 1;
    const std::int32_t opposite = cells[3 * cell + corner], last = cells[3 * cell + (corner + 2) % 3];
    cells[3 * cell + (corner + 2) % 3] = node;
    cells.insert(cells.end(), {opposite, node, last});
    return true;
}

// Puts the nodes in stock behind those of the boundary, and the triangles into the mesh of what is around them, whose
// given nodes are those of the boundary and the outer ones in stock. Returns whether the sides of the triangles agree.
inline bool join(MeshOutput& mesh, const MeshInput& input, const Stock& stock) {
    const auto given = static_cast<std::int32_t>(input.point_count), outer = stock.outer;
    const auto own = std::lower_bound(mesh.split_segment.begin(), mesh.split_segment.end(), input.segment_count);
    const auto split = static_cast<std::int32_t>(own - mesh.split_segment.begin());
    const auto all = static_cast<std::int32_t>(mesh.X.size() / 2);
    std::rotate(mesh.X.begin() + 2 * given, mesh.X.begin() + 2 * (given + outer),
                mesh.X.begin() + 2 * (given + outer + split));
    for (std::int32_t& node : mesh.cells)
        if (node >= given && node < given + outer + split) node += node < given + outer ? split : -outer;
    mesh.X.insert(mesh.X.end(), stock.X.begin() + 2 * outer, stock.X.end());
    std::vector<std::int32_t> cells;
    for (const std::int32_t row : stock.cells) cells.push_back(row < outer ? given + split + row : all + row - outer);
    std::vector<std::uint8_t> halved(cells.size() / 3, 0);
    for (std::size_t k = split; k < mesh.split_segment.size(); ++k) {
        const auto [cell, corner] = stock.behind[mesh.split_segment[k] - input.segment_count];
        if (!halve(cells, cell, corner, given + outer + static_cast<std::int32_t>(k), halved)) return false;
    }
    mesh.cells.insert(mesh.cells.end(), cells.begin(), cells.end());
    mesh.split_segment.resize(split), mesh.split_fraction.resize(split);
    return true;
}

constexpr int SWEEPS = 3;  // of smoothing

// The tile of which sides are at most `stretch`; without cells where refinement would split its sides.
inline Tile make_tile(double stretch, double sine_bound) {
    constexpr std::int32_t side = Tile::SIDE, count = 4 * side;
    std::vector<double> points;
    std::vector<std::int32_t> segments;
    for (std::int32_t i = 0; i < count; ++i) {
        const double along = i % side, far = side;
        const double corners[4][2] = {{along, 0.0}, {far, along}, {far - along, far}, {0.0, far - along}};
        points.insert(points.end(), corners[i / side], corners[i / side] + 2);
        segments.push_back(i), segments.push_back((i + 1) % count);
    }
    const std::vector<std::uint8_t> border(count, 1);
    MeshOutput mesh = refine({points.data(), count, segments.data(), border.data(), count},
                             SizeField(1.0, 0.0, {}, points.data(), count), stretch, sine_bound, 100000);
    const auto nodes = static_cast<std::int32_t>(mesh.X.size() / 2),
               cells = static_cast<std::int32_t>(mesh.cells.size() / 3);
    smooth_fresh(mesh.X.data(), nodes, mesh.cells.data(), cells, count, SWEEPS);
    return mesh.split_segment.empty() ? Tile(mesh.X, mesh.cells) : Tile({}, {});
}

// The same, made once for each pair of bounds.
inline const Tile& tile(double stretch, double sine_bound) {
    static std::map<std::pair<double, double>, Tile> known;
    const std::pair bounds(stretch, sine_bound);
    auto found = known.find(bounds);
    if (found == known.end()) found = known.emplace(bounds, make_tile(stretch, sine_bound)).first;
    return found->second;
}

}  // namespace cgal

// Triangles of at most `stretch` x the local size whose angles are at least asin(sqrt(sine_bound)) away from small
// angles of the boundary; those in stock are larger by their spacing, and smoothed already. Throws MesherFailure.
inline MeshOutput refine_delaunay(const MeshInput& input, const SizeField& field, double stretch, double sine_bound,
                                  std::size_t patience) {
    const Stock stock(cgal::tile(stretch, sine_bound), input, field);
    if (stock.X.empty()) return cgal::refine(input, field, stretch, sine_bound, patience);
    std::vector<double> points(input.points, input.points + 2 * input.point_count);
    points.insert(points.end(), stock.X.begin(), stock.X.begin() + 2 * stock.outer);
    std::vector<std::int32_t> segments(input.segments, input.segments + 2 * input.segment_count);
    for (const std::int32_t row : stock.border) segments.push_back(static_cast<std::int32_t>(input.point_count) + row);
    const auto count = static_cast<std::ptrdiff_t>(segments.size() / 2);
    std::vector<std::uint8_t> border(input.border, input.border + input.segment_count);
    border.resize(count, 1);
    const MeshInput around{points.data(), input.point_count + stock.outer, segments.data(), border.data(), count};
    MeshOutput mesh = cgal::refine(around, field, stretch, sine_bound, patience);
    return cgal::join(mesh, input, stock) ? mesh : cgal::refine(input, field, stretch, sine_bound, patience);
}

}  // namespace restshape
