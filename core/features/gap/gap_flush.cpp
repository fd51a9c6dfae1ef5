#include "core/features/gap/gap_flush.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/median.h"
#include "core/numbers.h"

namespace seamwright {

namespace {

// The least that a point tells of an edge: a third of the pitch, though the outermost place is seen.
constexpr double kSteepens = 1.2, kUnseenDrop = 1.2;
constexpr double kSeenEdge = 1.0 / 3;
constexpr double kSeldomLost = 0.01;  // share of lines; more seldom is left out by an ellipse of 95 %
constexpr double kMostLost = 0.5;
constexpr double kLeastSurface_mm = 0.1, kMostSurface_mm = 1000, kMostSkip_mm = 100;
constexpr double kAcross = 0.2;  // cos of 78 degrees: a surface that stands across the other one

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
    if (!in(s.surface_mm, kLeastSurface_mm, kMostSurface_mm) || !in(s.edge_skip_mm, 0, kMostSkip_mm))
        return input_error(
            Text("a surface of {} mm, {} mm beside the edge, gives no line", s.surface_mm, s.edge_skip_mm),
            "surface_mm, edge_skip_mm", "give 0.1 to 1000 mm of surface and 0 to 100 mm beside the edge");
    if (s.minimum_points < 4 || s.minimum_points > 1000000)
        return input_error(Text("{} points are no surface", s.minimum_points), "minimum_points",
                           "give at least 4");
    return {};
}

// The surface line of a part: points between edge_skip and edge_skip + surface length from its edge.
bool GapFlushGauge::measure_line(const GapPart& part, double edge_along_x, double inward, LineFit& line) {
    x_.clear();
    z_.clear();
    for (std::size_t i = 0; i < part.x.size(); ++i) {
        const double d = inward * (part.x[i] - edge_along_x);
        if (d < settings_.edge_skip_mm || d > settings_.edge_skip_mm + settings_.surface_mm) continue;
        x_.push_back(part.x[i]);
        z_.push_back(part.z[i]);
    }
    line = fit_line(x_, z_, workspace_);
    return line.ok && line.used >= 4;
}

// The outermost end of a face that is seen: of all its stretches, upright or leaning, the one that reaches out farthest by
// all that is sure: a long one of a plane face, a short one of a round rim. False: there is no face.
bool GapFlushGauge::measure_face(const GapPart& part, const Eigen::Vector2d& u, double pitch, Side& side) {
    constexpr double kReach_mm = 0.5, kReachLines = 5;  // behind the outermost return
    constexpr std::size_t kFewest = 5, kFewestOfFace = 10;
    constexpr double kSure = 3.5, kMedian = 1.2533;  // sigmas; of a median, in those of a mean
    constexpr double kLeans = 2;                     // sigmas of the difference of two halves
    constexpr double kDeep = 3;                      // pitches: what is shorter is no face
    const Eigen::Vector2d n(-u.y(), u.x());
    face_.clear();
    double most = -std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < part.x.size(); ++i)
        most = std::max(most, u.dot(Eigen::Vector2d(part.x[i], part.z[i])));
    for (std::size_t i = 0; i < part.x.size(); ++i) {
        const Eigen::Vector2d p(part.x[i], part.z[i]);
        if (u.dot(p) > most - std::max(kReach_mm, kReachLines * pitch))
            face_.emplace_back(n.dot(p), u.dot(p));
    }
    if (face_.size() < kFewestOfFace) return false;
    std::sort(face_.begin(), face_.end(), [](const auto& a, const auto& b) { return a.x() < b.x(); });
    if (!(face_.back().x() - face_.front().x() > kDeep * pitch)) return false;
    x_.clear();
    for (std::size_t i = 1; i + 1 < face_.size(); ++i)
        x_.push_back(std::abs(face_[i - 1].y() - 2 * face_[i].y() + face_[i + 1].y()));
    const double sigma = kMedian * kMadToSigma * median(x_) / std::sqrt(6.0);
    const auto middle = [&](std::size_t first, std::size_t count) {
        x_.clear();
        for (std::size_t i = first; i < first + count; ++i) x_.push_back(face_[i].y());
        return median(x_);
    };
    double best = -std::numeric_limits<double>::infinity(), along = 0;
    std::size_t start = 0, length = 0;
    for (std::size_t m = kFewest;; m = std::min(face_.size(), m + std::max<std::size_t>(2, m / 2))) {
        const double unsure = sigma / std::sqrt(static_cast<double>(m));
        for (std::size_t first = 0; first + m <= face_.size(); first += std::max<std::size_t>(1, m / 4)) {
            const double stands = middle(first, m);
            if (stands - kSure * unsure <= best) continue;
            best = stands - kSure * unsure;
            along = stands;
            start = first;
            length = m;
        }
        if (m == face_.size()) break;
    }
    // The outermost end of a stretch that leans is as far from its middle as the middles of its halves are from each other.
    const std::size_t half = length / 2;
    const double of_length = sigma / std::sqrt(static_cast<double>(length));
    double lean = std::abs(middle(start, half) - middle(start + length - half, half));
    if (lean < kLeans * 2 * of_length) lean = 0;
    side.edge = n * 0.5 * (face_[start].x() + face_[start + length - 1].x()) + u * (along + 0.5 * lean);
    side.edge_variance = of_length * of_length * (1 + kSure * kSure / 4) + lean * lean / 12;
    return true;
}

// The outermost place along u. Where it is the last return, the surface goes on by up to one more line's
// advance; where the contour turns back behind it, the place is seen.
void GapFlushGauge::measure_edge(const GapPart& part, const Eigen::Vector2d& u, double pitch, Side& side) {
    if (part.face && measure_face(part, u, pitch, side)) return;
    const auto along = [&](std::size_t i) { return u.dot(Eigen::Vector2d(part.x[i], part.z[i])); };
    const double plain = pitch * std::abs(u.x());
    // What the noise moves a point along u; the outermost of several equal ones is so by its noise.
    const double noise = part.noise_mm * std::abs(u.y()), by_noise = 3 * std::sqrt(2.0) * noise;
    std::size_t outermost = 0;
    for (std::size_t i = 1; i < part.x.size(); ++i)
        if (along(i) > along(outermost) + (outermost == 0 ? noise : 0)) outermost = i;
    double advance = 0, flank = 0, unseen = 0;
    if (outermost == 0) {
        const double lines = std::max(1.0, std::abs(part.x[1] - part.x[0]) / pitch);
        advance = std::clamp((along(0) - along(1)) / lines, 0.0, 3 * plain);
        // A round rim falls on more steeply, unseen: with the drop as the root of the distance from where it
        // stands upright, by 1.2 of the last line's drop in the mean.
        const double drop = (part.z[0] - part.z[1]) / lines * u.y();
        const double before =
            (part.z[1] - part.z[2]) / std::max(1.0, std::abs(part.x[2] - part.x[1]) / pitch);
        flank = 0.5 * std::abs(drop);
        if (drop > by_noise && std::abs(drop) > kSteepens * std::abs(before * u.y()))
            unseen = (kUnseenDrop - 0.5) * drop;
        // Noise alone is no turn of the contour.
        if (std::abs(advance - plain) < by_noise) advance = plain;
    }
    const double spread = std::max(advance, kSeenEdge * plain);
    // Where single lines are lost, so may be the last ones: mean square of their geometric number.
    const double lost = outermost == 0 ? std::clamp(part.lost_share - kSeldomLost, 0.0, kMostLost) : 0;
    const double lost_square = lost * (1 + lost) / ((1 - lost) * (1 - lost));
    // The edge stands in the middle of a ramp that smoothing has drawn.
    const double ramp = part.ramp ? (part.smoothed_lines - 1) * plain : 0;
    // Points that were measured farther apart and laid on the lines of a grid: behind the last line on the surface it went on
    // to the last such point, and from there by up to a step of them.
    const double a = outermost == 0 && !part.ramp ? std::max(advance, kSeenEdge * plain) : 0;
    const double measured = part.drawn_lines * a;
    const double whether = part.drawn_lines * (sides_.noise().measured_apart - part.drawn_lines) * a * a / 4;
    // It has drawn a flank that is seen out over as many lines.
    if (part.smoothed_lines > 1)
        for (const std::size_t i : {outermost, outermost + 1})
            if (i > 0 && i < part.z.size())
                flank = std::max(flank,
                                 0.5 * part.smoothed_lines * std::abs((part.z[i] - part.z[i - 1]) * u.y()));
    side.edge = Eigen::Vector2d(part.x[outermost], part.z[outermost]) +
                (0.5 * (advance + ramp + measured) + unseen) * u;
    side.edge_variance = (spread * spread + ramp * ramp + measured * measured) / 12 + std::max(whether, 0.0) +
                         lost_square * plain * plain + std::pow(0.5 * part.unsure_lines * plain, 2) +
                         flank * flank + noise * noise;
}

GapFlush GapFlushGauge::measure(const Profile& profile) {
    GapFlush result;
    switch (sides_.find(profile, settings_.window, std::max(settings_.minimum_points, 4),
                        settings_.edge_skip_mm + settings_.surface_mm)) {
        case GapSides::Found::no_points:
            result.status = GapFlushStatus::no_points;
            result.message = "no surface in the window";
            return result;
        case GapSides::Found::one_surface:
        case GapSides::Found::unbroken:
            result.message = "only one surface in the window: the contour is not broken by a gap";
            return result;
        case GapSides::Found::ambiguous:
            result.status = GapFlushStatus::ill_conditioned;
            result.message =
                "which surface is a panel and which the ground in the gap cannot be told: show more of both "
                "panels, or narrow the window to them";
            return result;
        case GapSides::Found::both:
            break;
    }
    const bool reference_left = settings_.reference == GapFlushSettings::Reference::left;
    const GapPart& reference_part = reference_left ? sides_.left() : sides_.right();
    const GapPart& other_part = reference_left ? sides_.right() : sides_.left();
    const double pitch = sides_.pitch_mm();
    workspace_.noise = sides_.noise();
    const double inward_sign = reference_left ? 1 : -1;  // x direction from the reference into the gap

    // Lines first by the edges along x, then again by the edges along the surface.
    Side reference, other;
    Eigen::Vector2d u(inward_sign, 0);
    for (int round = 0; round < 2; ++round) {
        measure_edge(reference_part, u, pitch, reference);
        measure_edge(other_part, -u, pitch, other);
        if (!measure_line(reference_part, reference.edge.x(), -inward_sign, reference.line) ||
            !measure_line(other_part, other.edge.x(), inward_sign, other.line)) {
            result.status = GapFlushStatus::ill_conditioned;
            result.message = "too little straight surface beside an edge";
            return result;
        }
        u = reference.line.direction * (reference.line.direction.x() * inward_sign > 0 ? 1.0 : -1.0);
    }
    measure_edge(reference_part, u, pitch, reference);
    measure_edge(other_part, -u, pitch, other);
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
    if (std::abs(along_u) < kAcross) {
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
    const double edges = reference.edge_variance + other.edge_variance;
    const double other_edge = other.edge_variance;
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
