#include "geometry/subdivision_surface.h"

#include "base/joined_sets.h"
#include "splines/bounds.h"

#include <algorithm>
#include <functional>

#include <oneapi/tbb/parallel_for.h>

namespace rayleaf {
namespace {

constexpr uint32_t kNone = 0xffffffffu;

/// For each face, whether all faces connected with it are quads.
std::vector<bool> among_quads(const CageTopology& topology, std::span<const int32_t> face_sizes) {
    JoinedSets faces(face_sizes.size());
    for (uint32_t edge = 0; edge < topology.edge_count(); ++edge) {
        const std::vector<uint32_t> at_edge = topology.edge_faces(edge);
        for (size_t i = 1; i < at_edge.size(); ++i) faces.join(at_edge[0], at_edge[i]);
    }
    std::vector<bool> quads(face_sizes.size(), true), result(face_sizes.size());
    for (uint32_t face = 0; face < face_sizes.size(); ++face)
        if (face_sizes[face] != 4) quads[faces.root(face)] = false;
    for (uint32_t face = 0; face < face_sizes.size(); ++face) result[face] = quads[faces.root(face)];
    return result;
}

/// Parameters of a border's point.
Vec2d border_place(int border, double at) {
    switch (border) {
        case 0:
            return {at, 0.0};
        case 1:
            return {1.0, at};
        case 2:
            return {at, 1.0};
        default:
            return {0.0, at};
    }
}

/// Parameters of an element's node.
Vec2d corner_parameters(std::ptrdiff_t node) {
    return {node % 2 == 1 ? 1.0 : 0.0, node >= 2 ? 1.0 : 0.0};
}

/// Numbers of the nodes and lines of a cage: vertices, middles of edges, and middles of faces; edges or their first
/// halves, second halves, and the lines inside faces.
struct CageNumbers {
    const CageTopology& topology;
    uint32_t vertices, edges;

    uint32_t edge_middle(uint32_t edge) const { return vertices + edge; }
    uint32_t face_middle(uint32_t face) const { return vertices + edges + face; }
    uint32_t half(uint32_t edge, uint32_t vertex) const {
        return topology.edge_vertices(edge)[0] == vertex ? edge : edges + edge;
    }
    /// From the middle of the edge that follows a corner to that of the face.
    uint32_t inside(uint32_t corner) const { return 2 * edges + corner; }
};

/// From parameters of a face to those of an element: the chain rule for a map without rotation other than by quarters.
PatchPoint by_element(const PatchPoint& p, const Vec2d& along_u, const Vec2d& along_v) {
    const auto first = [&](const Vec2d& a) { return p.du * a.x + p.dv * a.y; };
    const auto second = [&](const Vec2d& a, const Vec2d& b) {
        return p.duu * (a.x * b.x) + p.duv * (a.x * b.y + a.y * b.x) + p.dvv * (a.y * b.y);
    };
    return {p.position,
            first(along_u),
            first(along_v),
            second(along_u, along_u),
            second(along_u, along_v),
            second(along_v, along_v)};
}

ContentHash hash_of(const SubdivisionCage& cage, ContentHasher hasher) {
    const auto add = [&hasher](const auto& values) {
        hasher.add(std::vector<std::decay_t<decltype(values[0])>>(values.begin(), values.end()));
    };
    add(cage.vertices);
    add(cage.face_sizes);
    add(cage.corners);
    add(cage.crease_edges);
    add(cage.crease_sharpness);
    add(cage.crease_vertices);
    add(cage.vertex_sharpness);
    add(cage.material_slots);
    add(cage.corner_normals);
    hasher.add(static_cast<int>(cage.scheme));
    hasher.add(static_cast<int>(cage.border_corners));
    hasher.add(static_cast<int>(cage.uv_smoothing));
    hasher.add(cage.active_uv);
    for (const auto* attributes : {&cage.uv_maps, &cage.attributes}) {
        for (const CornerAttribute& attribute : *attributes) {
            hasher.add(attribute.id);
            hasher.add(attribute.channels);
            hasher.add(attribute.values);
        }
    }
    return hasher.value();
}

}  // namespace

SubdivisionSurface::SubdivisionSurface(const SubdivisionCage& cage, const Box3d& extent)
    : Shape(ShapeKind::SubdivisionSurface, cage.name) {
    validate(cage);
    const size_t count = cage.vertices.size() / 3;
    const auto vertex = [&](size_t i) {
        return Vec3d(cage.vertices[3 * i], cage.vertices[3 * i + 1], cage.vertices[3 * i + 2]);
    };
    for (const int32_t corner : cage.corners) object_bounds_.extendBy(vertex(static_cast<size_t>(corner)));
    Box3d whole = object_bounds_;
    whole.extendBy(extent);
    frame_ = LocalFrame::fitting(whole);
    std::vector<Vec3d> local(count);
    for (size_t i = 0; i < count; ++i) local[i] = (vertex(i) - frame_.center) / frame_.scale;
    // The limit lies in the hull of the cage.
    if (!object_bounds_.isEmpty())
        bounds_ = outward_float(
            {(object_bounds_.min - frame_.center) / frame_.scale, (object_bounds_.max - frame_.center) / frame_.scale});

    ContentHasher hasher;
    add_to(hasher);
    hash_ = hash_of(cage, hasher);
    for (const int32_t slot : cage.material_slots) slots_.push_back(static_cast<uint16_t>(slot));
    if (cage.face_sizes.empty()) return;
    const CageTopology topology(cage);
    limit_ = topology.limit(local);
    add_elements(topology, cage);
    find_owners();
    make_nets();
    for (uint32_t face = 0; face < cage.face_sizes.size(); ++face)
        if (limit_.is_regular(face)) limit_.forget(face);
    for (size_t i = 0; i < cage.uv_maps.size(); ++i) {
        if (cage.uv_maps[i].id == cage.active_uv) active_uv_ = static_cast<int>(i);
        uv_maps_.push_back({cage.uv_maps[i].id, topology.uv_limit(i)});
    }
    attributes_ = cage.attributes;
    corner_normals_ = {kNoAttribute, 3, {cage.corner_normals.begin(), cage.corner_normals.end()}};
}

void SubdivisionSurface::add_elements(const CageTopology& topology, const SubdivisionCage& cage) {
    const std::vector<bool> whole = among_quads(topology, cage.face_sizes);
    const auto faces = static_cast<uint32_t>(cage.face_sizes.size());
    const CageNumbers numbers{topology, static_cast<uint32_t>(cage.vertices.size() / 3), topology.edge_count()};
    first_corner_.assign(1, 0);
    for (const int32_t size : cage.face_sizes)
        first_corner_.push_back(first_corner_.back() + static_cast<uint32_t>(size));
    for (uint32_t face = 0; face < faces; ++face) {
        const auto size = static_cast<uint32_t>(cage.face_sizes[face]);
        const auto corner = [&](uint32_t i) {
            return static_cast<uint32_t>(cage.corners[first_corner_[face] + i % size]);
        };
        for (uint32_t i = 0; i < (whole[face] ? 1 : size); ++i) {
            SubdivisionElement element;
            element.face = face;
            element.corner = i;
            element.whole = whole[face];
            element.square = CageTopology::corner_square(static_cast<int>(size), static_cast<int>(i));
            const uint32_t before = (i + size - 1) % size;
            const uint32_t next = topology.face_edge(face, i), previous = topology.face_edge(face, before);
            if (whole[face]) {
                element.square.next *= 2.0;
                element.square.previous *= 2.0;
                element.nodes = {corner(0), corner(3), corner(1), corner(2)};
                element.lines = {previous, topology.face_edge(face, 2), topology.face_edge(face, 1), next};
            } else {
                element.nodes = {corner(i), numbers.edge_middle(previous), numbers.edge_middle(next),
                                 numbers.face_middle(face)};
                element.lines = {numbers.half(previous, corner(i)), numbers.inside(first_corner_[face] + before),
                                 numbers.inside(first_corner_[face] + i), numbers.half(next, corner(i))};
            }
            elements_.push_back(element);
        }
    }
    nodes_.resize(numbers.face_middle(faces));
    lines_.resize(numbers.inside(first_corner_.back()));
    for (SubdivisionLine& line : lines_) line.owner = kNone;
}

PatchPoint SubdivisionSurface::in_element(const LimitFaces& limit, const SubdivisionElement& element, double u,
                                          double v) const {
    const FaceSquare& square = element.square;
    return by_element(limit.evaluate(element.face, square.origin + square.previous * u + square.next * v),
                      square.previous, square.next);
}

/// The owner of a node or line is its first element that is one bicubic patch, or else its first element.
void SubdivisionSurface::find_owners() {
    const auto regular = [this](uint32_t element) { return limit_.is_regular(elements_[element].face); };
    node_owners_.assign(nodes_.size(), kNone);
    const auto better = [&](uint32_t owner, uint32_t element) {
        return owner == kNone || (!regular(owner) && regular(element));
    };
    uint32_t nets = 0;
    for (uint32_t i = 0; i < elements_.size(); ++i) {
        SubdivisionElement& element = elements_[i];
        if (regular(i)) element.net = nets++;
        for (const uint32_t node : element.nodes)
            if (better(node_owners_[node], i)) node_owners_[node] = i;
        for (size_t border = 0; border < element.lines.size(); ++border) {
            SubdivisionLine& line = lines_[element.lines[border]];
            if (!better(line.owner, i)) continue;
            line.owner = i;
            line.border = static_cast<uint8_t>(border);
            line.cubic = regular(i);
        }
    }
    nets_.resize(size_t{16} * nets);
    place_nodes();
}

void SubdivisionSurface::place_nodes() {
    tbb::parallel_for(size_t{0}, nodes_.size(), [&](size_t i) {
        if (node_owners_[i] == kNone) return;
        const SubdivisionElement& owner = elements_[node_owners_[i]];
        const auto corner = std::find(owner.nodes.begin(), owner.nodes.end(), i) - owner.nodes.begin();
        nodes_[i] = in_element(limit_, owner, corner_parameters(corner).x, corner_parameters(corner).y).position;
    });
}

void SubdivisionSurface::make_nets() {
    // Hermite to Bezier: an inner point of a border is a third of the derivative away from its end.
    tbb::parallel_for(size_t{0}, lines_.size(), [&](size_t i) {
        SubdivisionLine& line = lines_[i];
        if (!line.cubic) return;
        const SubdivisionElement& owner = elements_[line.owner];
        const bool along_u = line.border % 2 == 0;
        for (int end = 0; end < 2; ++end) {
            const Vec2d place = border_place(line.border, end);
            const PatchPoint p = in_element(limit_, owner, place.x, place.y);
            const Vec3d third = (along_u ? p.du : p.dv) / 3.0;
            const Vec3d& node =
                nodes_[owner.nodes[static_cast<size_t>(kBorderEnds[line.border][static_cast<size_t>(end)])]];
            line.inner[static_cast<size_t>(is_reversed(owner, line.border) ? 1 - end : end)] =
                end == 0 ? node + third : node - third;
        }
    });
    tbb::parallel_for(size_t{0}, elements_.size(), [&](size_t i) {
        const SubdivisionElement& element = elements_[i];
        if (element.net == SubdivisionElement::kIrregular) return;
        Vec4d* net = &nets_[size_t{16} * element.net];
        const auto set = [net](int u, int v, const Vec3d& p) { net[4 * v + u] = Vec4d(p.x, p.y, p.z, 1.0); };
        for (int corner = 0; corner < 4; ++corner) {
            const int u = corner % 2, v = corner / 2;
            const double inward_u = 1 - 2 * u, inward_v = 1 - 2 * v;
            const PatchPoint p = in_element(limit_, element, u, v);
            set(3 * u, 3 * v, nodes_[element.nodes[static_cast<size_t>(corner)]]);
            set(1 + u, 1 + v,
                p.position + (p.du * inward_u + p.dv * inward_v) / 3.0 + p.duv * (inward_u * inward_v / 9.0));
        }
        for (int border = 0; border < 4; ++border) {
            const SubdivisionLine& line = lines_[element.lines[static_cast<size_t>(border)]];
            for (int k = 0; k < 2; ++k) {
                const Vec2d place = border_place(border, k + 1);
                const int u = border == 1 ? 3 : static_cast<int>(place.x),
                          v = border == 2 ? 3 : static_cast<int>(place.y);
                set(u, v, line.inner[static_cast<size_t>(is_reversed(element, border) ? 1 - k : k)]);
            }
        }
    });
}

BorderPlace SubdivisionSurface::owner_place(const BorderPlace& place) const {
    const SubdivisionElement& element = elements_[place.element];
    const float u = place.parameters.x, v = place.parameters.y;
    const bool on_u = u == 0.0f || u == 1.0f, on_v = v == 0.0f || v == 1.0f;
    if (on_u && on_v) {
        const uint32_t node = element.nodes[static_cast<size_t>(u) + 2 * static_cast<size_t>(v)];
        const SubdivisionElement& owner = elements_[node_owners_[node]];
        const auto corner = std::find(owner.nodes.begin(), owner.nodes.end(), node) - owner.nodes.begin();
        return {node_owners_[node], Vec2f(corner_parameters(corner))};
    }
    if (!on_u && !on_v) return place;
    const int border = on_v ? (v == 0.0f ? 0 : 2) : (u == 0.0f ? 3 : 1);
    const SubdivisionLine& line = lines_[element.lines[static_cast<size_t>(border)]];
    const bool turned = is_reversed(element, border) != is_reversed(elements_[line.owner], line.border);
    const double at = on_v ? u : v;
    return {line.owner, Vec2f(border_place(line.border, turned ? 1.0 - at : at))};
}

PatchPoint SubdivisionSurface::evaluate(uint32_t index, double u, double v) const {
    const SubdivisionElement& element = elements_[index];
    return element.net == SubdivisionElement::kIrregular ? in_element(limit_, element, u, v)
                                                         : net(element).evaluate(u, v);
}

Vec3d SubdivisionSurface::position(uint32_t index, double u, double v) const {
    const SubdivisionElement& element = elements_[index];
    if (element.net != SubdivisionElement::kIrregular) return net(element).position(u, v);
    return limit_.position(element.face, element.square.origin + element.square.previous * u + element.square.next * v);
}

void SubdivisionSurface::irregular_positions(uint32_t index, double u, std::span<const double> v,
                                             Vec3d* positions) const {
    const SubdivisionElement& element = elements_[index];
    constexpr size_t kAtOnce = 17;  // a line of a grid
    Vec2d at[kAtOnce];
    for (size_t first = 0; first < v.size(); first += kAtOnce) {
        const size_t count = std::min(kAtOnce, v.size() - first);
        for (size_t i = 0; i < count; ++i)
            at[i] = element.square.origin + element.square.previous * u + element.square.next * v[first + i];
        limit_.positions(element.face, {at, count}, positions + first);
    }
}

Vec3d SubdivisionSurface::line_position(uint32_t index, double at) const {
    const SubdivisionLine& line = lines_[index];
    const Vec2d place = border_place(line.border, is_reversed(elements_[line.owner], line.border) ? 1.0 - at : at);
    return position(line.owner, place.x, place.y);
}

PatchPoint SubdivisionSurface::evaluate_at(uint32_t index, double u, double v, float time) const {
    if (!deforms()) return evaluate(index, u, v);
    const StepShare step = step_share(time, steps());
    return mixed(form(step.first).evaluate(index, u, v), form(step.first + 1).evaluate(index, u, v), step.share);
}

LimitNormal SubdivisionSurface::normal_at(uint32_t index, double u, double v, const PatchPoint& point,
                                          const Vec3d& geometric, float time) const {
    const SubdivisionElement& element = elements_[index];
    const NormalFallback fallback{{}, geometric};
    if (!deforms() && element.net != SubdivisionElement::kIrregular)
        return limit_normal(net(element), u, v, point, fallback);
    const auto now = [&](double x, double y) { return evaluate_at(index, x, y, time); };
    return limit_normal(SurfaceFunction(std::ref(now)), u, v, point, fallback);
}

LocalSurface SubdivisionSurface::surface(const LocalHit& hit) const {
    return surface(hit, evaluate_at(hit.primitive, hit.u, hit.v, hit.time), std::nullopt);
}

/// The surface at a hit with a known point, and perhaps a known limit normal that does not depend on the facet.
LocalSurface SubdivisionSurface::surface(const LocalHit& hit, const PatchPoint& point,
                                         const std::optional<LimitNormal>& known) const {
    const Vec3f facet_normal = normalized_or(hit.normal, Vec3f(0, 0, 1));
    const LimitNormal limit =
        known ? *known : normal_at(hit.primitive, hit.u, hit.v, point, -Vec3d(facet_normal), hit.time);
    if (limit.stage != NormalStage::Regular)
        limit_normals_[static_cast<size_t>(limit.stage)].fetch_add(1, std::memory_order_relaxed);
    LocalSurface result;
    result.position = point.position;
    // Where a coarse facet and the exact surface face opposite sides, the facet that was hit decides.
    const double side = Vec3f(limit.normal).dot(facet_normal) > 0.0f ? 1.0 : -1.0;
    result.normal = shading_normal(hit, Vec3f(limit.normal * side), facet_normal);
    set_texture_coordinates(hit, point, limit, side, result);
    return result;
}

ElementPoint SubdivisionSurface::element_point_at(uint32_t element, const Vec2f& parameters, float time) const {
    const PatchPoint point = evaluate_at(element, parameters.x, parameters.y, time);
    ElementPoint result;
    result.normal = -Vec3f(normal_at(element, parameters.x, parameters.y, point, Vec3d(0, 0, 1), time).normal);
    result.hit = placed_hit(element, parameters, point.position, result.normal);
    result.hit.time = time;
    result.area_factor = static_cast<float>(point.du.cross(point.dv).length());
    return result;
}

void SubdivisionSurface::line_points(uint32_t index, float u, std::span<const float> v, PlacedPoint* points) const {
    const SubdivisionElement& element = elements_[index];
    std::optional<PatchColumn> column;
    if (element.net != SubdivisionElement::kIrregular) column.emplace(net(element), u);
    for (size_t i = 0; i < v.size(); ++i) {
        const PatchPoint point = column ? column->evaluate(v[i]) : in_element(limit_, element, u, v[i]);
        const LimitNormal normal = normal_at(index, u, v[i], point, Vec3d(0, 0, 1), kMiddleTime);
        points[i].hit = placed_hit(index, {u, v[i]}, point.position, -Vec3f(normal.normal));
        const bool depends = normal.stage >= NormalStage::Neighbour;
        points[i].surface = surface(points[i].hit, point, depends ? std::nullopt : std::optional(normal));
    }
}

NormalCounters SubdivisionSurface::limit_normals() const {
    NormalCounters counters;
    for (size_t i = 0; i < kNormalStageCount; ++i)
        counters.counts[i] = limit_normals_[i].load(std::memory_order_relaxed);
    return counters;
}

size_t SubdivisionSurface::bytes() const {
    size_t total = sizeof(*this) + elements_.capacity() * sizeof(SubdivisionElement) +
                   lines_.capacity() * sizeof(SubdivisionLine) + nodes_.capacity() * sizeof(Vec3d) +
                   nets_.capacity() * sizeof(Vec4d) + node_owners_.capacity() * sizeof(uint32_t) +
                   first_corner_.capacity() * sizeof(uint32_t) + slots_.capacity() * sizeof(uint16_t);
    if (!elements_.empty()) total += limit_.bytes();
    for (const UvMap& map : uv_maps_) total += map.limit.bytes();
    for (const CornerAttribute& attribute : attributes_) total += attribute.values.capacity() * sizeof(float);
    total += corner_normals_.values.capacity() * sizeof(float);
    total += moments_.bytes();
    return total;
}

}  // namespace rayleaf
