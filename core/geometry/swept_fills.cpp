#include "geometry/swept_fills.h"

#include "geometry/swept_surface.h"

#include <algorithm>

namespace rayleaf {
namespace {

/// Corners of an outline for each curved piece, along which the direction turns by 50 degrees or so at most.
constexpr int kCornersOfPiece = 8;

}  // namespace

Vec3d SweptFill::at(const Vec2f& parameters) const {
    return low + Vec3d(parameters.x * size.x, parameters.y * size.y, 0);
}

Vec2f SweptFill::parameters(const Vec3d& position) const {
    const auto share = [](double from, double length) { return length > 0.0 ? from / length : 0.0; };
    return Vec2f(Vec2d(share(position.x - low.x, size.x), share(position.y - low.y, size.y)));
}

bool SweptFill::covers(const Vec3d& position) const {
    const auto x = static_cast<float>(position.x), y = static_cast<float>(position.y);
    bool inside = false;
    for (size_t k = 0; k + 1 < begins.size(); ++k) {
        for (uint32_t i = begins[k], before = begins[k + 1] - 1; i < begins[k + 1]; before = i++) {
            const Vec2f &a = outlines[i], &b = outlines[before];
            if ((a.y > y) != (b.y > y) && x < (b.x - a.x) * (y - a.y) / (b.y - a.y) + a.x) inside = !inside;
        }
    }
    return inside;
}

LocalSurface SweptFill::surface(const LocalHit& hit) const {
    LocalSurface result;
    result.position = hit.position;
    result.normal = normalized_or(hit.normal, Vec3f(normal()));
    result.uv = Vec2f(hit.u, hit.v);
    result.dp_du = Vec3f(Vec3d(size.x, 0, 0));
    result.dp_dv = Vec3f(Vec3d(0, size.y, 0));
    return result;
}

size_t SweptFill::bytes() const {
    return sizeof(*this) + splines.capacity() * sizeof(uint32_t) + outlines.capacity() * sizeof(Vec2f) +
           begins.capacity() * sizeof(uint32_t);
}

std::vector<FillBorder> fill_borders(const SweptCurveDescription& curve, const std::vector<SweepProfile>& profiles) {
    std::vector<FillBorder> borders;
    if (curve.fill_materials.empty()) return borders;
    if (profiles.empty()) return {{Vec2d(curve.offset, 0), FillSide::Front}};
    if (profiles.size() > 1 || profiles.front().closed) return borders;
    const SweepProfile& profile = profiles.front();
    if (curve.fill == BevelFill::Back || curve.fill == BevelFill::Half)
        borders.push_back({profile.evaluate(0, 0.0).position, FillSide::Back});
    if (curve.fill == BevelFill::Front || curve.fill == BevelFill::Half)
        borders.push_back({profile.evaluate(profile.parts.size() - 1, 1.0).position, FillSide::Front});
    return borders;
}

std::vector<SweptFill> swept_fills(const SweptCurveDescription& curve, const SweepPath& path,
                                   const std::vector<FillBorder>& borders) {
    std::vector<SweptFill> fills;
    for (const FillBorder& border : borders) {
        const size_t first = fills.size();
        for (const int slot : curve.fill_materials) {
            SweptFill& fill = fills.emplace_back();
            fill.border = border;
            fill.material_slot = static_cast<uint32_t>(slot);
            fill.begins.push_back(0);
        }
        std::vector<Box3d> boxes(curve.fill_materials.size());
        for (uint32_t s = 0; s < path.splines.size(); ++s) {
            const SweepSpline& spline = path.splines[s];
            if (!spline.closed) continue;
            const auto group = static_cast<size_t>(curve.splines[spline.group].fill_group);
            SweptFill& fill = fills[first + group];
            fill.splines.push_back(s);
            for (uint32_t p = spline.first_piece; p < spline.first_piece + spline.piece_count; ++p) {
                const SweepPiece& piece = path.pieces[p];
                const int corners = piece.kind == SweepPieceKind::Ruled ? 1 : kCornersOfPiece;
                for (int k = 0; k < corners; ++k) {
                    const Vec3d corner = path.ring(piece, static_cast<double>(k) / corners).at(border.place);
                    boxes[group].extendBy(corner);
                    fill.outlines.push_back(Vec2f(Vec2d(corner.x, corner.y)));
                }
            }
            fill.begins.push_back(static_cast<uint32_t>(fill.outlines.size()));
        }
        for (size_t group = 0; group < boxes.size(); ++group) {
            if (boxes[group].isEmpty()) continue;
            const Vec3d size = boxes[group].max - boxes[group].min;
            fills[first + group].low = boxes[group].min;
            fills[first + group].size = {size.x, size.y};
        }
    }
    std::erase_if(fills, [](const SweptFill& fill) { return fill.splines.empty(); });
    for (SweptFill& fill : fills) fill.outlines.shrink_to_fit();
    fills.shrink_to_fit();
    return fills;
}

}  // namespace rayleaf
