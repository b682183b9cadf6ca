#include "splines/sweep_profile.h"

#include "splines/bounds.h"

#include <algorithm>

namespace rayleaf {

ProfilePoint SweepProfile::evaluate(size_t part, double s) const {
    const ProfilePart& p = parts[part];
    ProfilePoint point;
    switch (p.kind) {
        case ProfilePartKind::Arc: {
            const double angle = p.first_angle + p.angle * s;
            const Vec2d out(std::cos(angle), std::sin(angle)), along(-out.y, out.x);
            point.position = p.center + out * p.radius;
            point.first = along * (p.radius * p.angle);
            point.second = out * (-p.radius * p.angle * p.angle);
            return point;
        }
        case ProfilePartKind::Line:
            point.first = p.end - p.begin;
            point.position = s == 1.0 ? p.end : p.begin + point.first * s;
            return point;
        default: {
            const CurvePoint c = p.curve.evaluate(s);
            point.position = {c.position.x, c.position.y};
            point.first = {c.first.x, c.first.y};
            point.second = {c.second.x, c.second.y};
            return point;
        }
    }
}

SweepProfile::Shares SweepProfile::shares(size_t part) const {
    double before = 0.0, total = 0.0;
    for (size_t i = 0; i < parts.size(); ++i) {
        if (i < part) before += parts[i].pieces;
        total += parts[i].pieces;
    }
    return {before / total, parts[part].pieces / total};
}

double SweepProfile::extent() const {
    double extent = 0.0;
    const auto reach = [&extent](const Vec2d& p) { extent = std::max(extent, p.length()); };
    for (const ProfilePart& part : parts) {
        reach(part.begin);
        reach(part.end);
        extent = std::max(extent, part.center.length() + std::abs(part.radius));
        if (part.kind != ProfilePartKind::Bezier) continue;
        const Box3d box = hull_bounds(part.curve);
        for (const double x : {box.min.x, box.max.x})
            for (const double y : {box.min.y, box.max.y}) reach({x, y});
    }
    return extent;
}

ProfilePlace profile_place(const SweepProfile& profile, float v) {
    const double scaled = static_cast<double>(v) * static_cast<double>(profile.parts.size());
    const auto last = static_cast<double>(profile.parts.size() - 1);
    const double part = std::clamp(std::floor(scaled), 0.0, last);
    return {static_cast<size_t>(part), std::clamp(scaled - part, 0.0, 1.0)};
}

float profile_parameter(const SweepProfile& profile, const ProfilePlace& place) {
    const auto count = static_cast<double>(profile.parts.size());
    auto v = static_cast<float>((static_cast<double>(place.part) + place.s) / count);
    while (profile_place(profile, v).part > place.part) v = std::nextafter(v, 0.0f);
    while (profile_place(profile, v).part < place.part) v = std::nextafter(v, 1.0f);
    return v;
}

}  // namespace rayleaf
