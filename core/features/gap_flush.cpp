#include "core/features/gap_flush.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace seamwright {

namespace {

constexpr double kFoldBreak_mm = 1;

// Two sheets in flush with nothing seen between them are one contour to the filter: the second goes on where
// the first points to. The widest stretch without returns is the gap.
bool split_at_hole(const FeaturePoints& points, const FeaturePoints::Piece& whole, int least,
                   FeaturePoints::Piece& before, FeaturePoints::Piece& after) {
    const int end = whole.first + whole.count;
    int behind = 0;
    double widest = 0;
    for (int i = whole.first + least; i + least <= end; ++i) {
        const double dx = points.x[i] - points.x[i - 1], dz = points.z[i] - points.z[i - 1];
        if (!points.pitch.is_gap(dx, dz) || std::hypot(dx, dz) <= widest) continue;
        widest = std::hypot(dx, dz);
        behind = i;
    }
    if (behind == 0) return false;
    before = {whole.first, behind - whole.first, whole.cut_before, false};
    after = {behind, end - behind, false, whole.cut_after};
    return true;
}

}  // namespace

std::string_view to_string(GapFlushStatus status) {
    switch (status) {
        case GapFlushStatus::ok:
            return "ok";
        case GapFlushStatus::no_points:
            return "no_points";
        case GapFlushStatus::not_found:
            return "not_found";
        case GapFlushStatus::ill_conditioned:
            return "ill_conditioned";
    }
    return "not_found";
}

Expected<void> check(const GapFlushSettings& s) {
    const FeatureWindow& w = s.window;
    if (!(w.x_min < w.x_max) || !(w.z_min < w.z_max))
        return input_error("the window of gap and flush is empty", "window",
                           "give a minimum below the maximum");
    const auto in = [](double value, double least, double most) { return value >= least && value <= most; };
    if (!in(s.surface_mm, 0.1, 1000) || !in(s.edge_skip_mm, 0, 100))
        return input_error(Text("a surface of {} mm, {} mm beside the edge, gives no line",
                                       s.surface_mm, s.edge_skip_mm),
                           "surface_mm, edge_skip_mm",
                           "give 0.1 to 1000 mm of surface and 0 to 100 mm beside the edge");
    if (s.minimum_points < 4 || s.minimum_points > 1000000)
        return input_error(Text("{} points are no surface", s.minimum_points), "minimum_points",
                           "give at least 4");
    return {};
}

// The surface line of a piece: points between edge_skip and edge_skip + surface length from its edge.
bool GapFlushGauge::measure_line(const FeaturePoints::Piece& piece, double edge_along_x, double inward,
                                 LineFit& line) {
    x_.clear();
    z_.clear();
    for (int i = piece.first; i < piece.first + piece.count; ++i) {
        const double d = inward * (points_.x[i] - edge_along_x);
        if (d < settings_.edge_skip_mm || d > settings_.edge_skip_mm + settings_.surface_mm) continue;
        x_.push_back(points_.x[i]);
        z_.push_back(points_.z[i]);
    }
    line = fit_line(x_, z_, workspace_);
    return line.ok && line.used >= 4;
}

// A fold or flank that the filter cut off from its surface belongs to it: pieces between the two sides that
// go on where a side ends.
void GapFlushGauge::join_folds(FeaturePoints::Piece& left, FeaturePoints::Piece& right) const {
    const auto near = [&](int a, int b) {
        return std::hypot(points_.x[b] - points_.x[a], points_.z[b] - points_.z[a]) <= kFoldBreak_mm;
    };
    const auto end = [](const FeaturePoints::Piece& p) { return p.first + p.count; };
    for (const auto& p : points_.pieces)
        if (p.first >= end(left) && end(p) <= right.first && near(end(left) - 1, p.first))
            left.count = end(p) - left.first;
    for (auto p = points_.pieces.rbegin(); p != points_.pieces.rend(); ++p)
        if (end(*p) <= right.first && p->first >= end(left) && near(right.first, end(*p) - 1)) {
            right.count += right.first - p->first;
            right.first = p->first;
        }
}

// The outermost place along u, half a pitch beyond the outermost return where the surface tears off there.
void GapFlushGauge::measure_edge(const FeaturePoints::Piece& piece, const Eigen::Vector2d& u, Side& side) {
    int outermost = piece.first;
    double most = -std::numeric_limits<double>::infinity();
    const auto along = [&](int i) { return u.dot(Eigen::Vector2d(points_.x[i], points_.z[i])); };
    for (int i = piece.first; i < piece.first + piece.count; ++i)
        if (along(i) > most) {
            most = along(i);
            outermost = i;
        }
    steps_.clear();
    const int last = piece.first + piece.count - 1;
    for (int i = std::max(piece.first, outermost - 8); i < std::min(last, outermost + 8); ++i)
        steps_.push_back(std::abs(along(i + 1) - along(i)));
    const auto middle = steps_.begin() + static_cast<std::ptrdiff_t>(steps_.size() / 2);
    std::nth_element(steps_.begin(), middle, steps_.end());
    side.pitch = *middle;
    side.edge = Eigen::Vector2d(points_.x[outermost], points_.z[outermost]) + 0.5 * side.pitch * u;
}

GapFlush GapFlushGauge::measure(const Profile& profile) {
    GapFlush result;
    points_.gather(profile, settings_.window);
    const FeaturePoints::Piece *first = nullptr, *second = nullptr;
    const int least = std::max(settings_.minimum_points, 4);
    for (const auto& piece : points_.pieces) {
        if (piece.count < least) continue;
        if (!first || piece.count > first->count) {
            second = first;
            first = &piece;
        } else if (!second || piece.count > second->count) {
            second = &piece;
        }
    }
    if (!first) {
        result.status = GapFlushStatus::no_points;
        result.message = "no surface in the window";
        return result;
    }
    FeaturePoints::Piece before, after;
    if (!second) {
        if (!split_at_hole(points_, *first, least, before, after)) {
            result.message = "only one surface in the window: the contour is not broken by a gap";
            return result;
        }
        first = &before;
        second = &after;
    }
    const auto mean_x = [&](const FeaturePoints::Piece& p) {
        double sum = 0;
        for (int i = p.first; i < p.first + p.count; ++i) sum += points_.x[i];
        return sum / p.count;
    };
    const bool first_is_left = mean_x(*first) < mean_x(*second);
    FeaturePoints::Piece left = first_is_left ? *first : *second;
    FeaturePoints::Piece right = first_is_left ? *second : *first;
    join_folds(left, right);
    const bool reference_left = settings_.reference == GapFlushSettings::Reference::left;
    const FeaturePoints::Piece& reference_piece = reference_left ? left : right;
    const FeaturePoints::Piece& other_piece = reference_left ? right : left;
    const double inward_sign = reference_left ? 1 : -1;  // x direction from the reference into the gap

    // Lines first by the edges along x, then again by the edges along the surface.
    Side reference, other;
    Eigen::Vector2d u(inward_sign, 0);
    for (int round = 0; round < 2; ++round) {
        measure_edge(reference_piece, u, reference);
        measure_edge(other_piece, -u, other);
        if (!measure_line(reference_piece, reference.edge.x(), -inward_sign, reference.line) ||
            !measure_line(other_piece, other.edge.x(), inward_sign, other.line)) {
            result.status = GapFlushStatus::ill_conditioned;
            result.message = "too little straight surface beside an edge";
            return result;
        }
        u = reference.line.direction * (reference.line.direction.x() * inward_sign > 0 ? 1.0 : -1.0);
    }
    measure_edge(reference_piece, u, reference);
    measure_edge(other_piece, -u, other);
    Eigen::Vector2d n(-u.y(), u.x());
    if (n.y() < 0) n = -n;

    result.along = u;
    result.reference_edge_mm = reference.edge;
    result.other_edge_mm = other.edge;
    const Eigen::Vector2d between = other.edge - reference.edge;
    result.gap_mm = u.dot(between);
    // The other surface at the place along u where its edge is.
    const Eigen::Vector2d d = other.line.direction;
    const double along_u = d.dot(u);
    if (std::abs(along_u) < 0.2) {
        result.status = GapFlushStatus::ill_conditioned;
        result.message = "the two surfaces stand across each other: flush has no meaning";
        return result;
    }
    const double s_other = u.dot(other.edge - other.line.centre) / along_u;
    const Eigen::Vector2d surface = other.line.centre + s_other * d;
    result.flush_mm = n.dot(surface - reference.line.centre);
    result.reference_point_mm = reference.line.centre + u * u.dot(reference.edge - reference.line.centre);
    result.other_point_mm = surface;

    // u turns with the reference line: the gap then changes by -(n . between), the flush by the distance
    // along u.
    const double s_reference = u.dot(surface - reference.line.centre);
    const double turn = reference.line.angle_variance();
    const double across = n.dot(between), slope = d.dot(n) / along_u;
    const double edges = (reference.pitch * reference.pitch + other.pitch * other.pitch) / 12;
    const double other_edge = other.pitch * other.pitch / 12;
    result.covariance(0, 0) = edges + across * across * turn;
    result.covariance(1, 1) = reference.line.variance_at(s_reference) +
                              other.line.variance_at(s_other) / (along_u * along_u) +
                              slope * slope * other_edge;
    result.covariance(0, 1) = result.covariance(1, 0) = -across * s_reference * turn + slope * other_edge;
    if (const double distance = between.norm(); settings_.gap_by == GapBy::edge_distance && distance > 0) {
        // Turning u moves no edge; along the line between them each edge has its share of pitch and noise.
        const double by_pitch = u.dot(between) / distance, by_noise = across / distance;
        const double noise = std::pow(reference.line.sigma_mm, 2) * reference.line.widening +
                             std::pow(other.line.sigma_mm, 2) * other.line.widening;
        result.gap_mm = std::copysign(distance, result.gap_mm);
        result.covariance(0, 0) = by_pitch * by_pitch * edges + by_noise * by_noise * noise;
        result.covariance(0, 1) = result.covariance(1, 0) = std::abs(by_pitch) * slope * other_edge;
    }
    result.status = GapFlushStatus::ok;
    return result;
}

}  // namespace seamwright
