#include "core/alignment/contour_ends.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/median.h"
#include "core/numbers.h"

namespace seamwright::alignment {

std::vector<Break> breaks_of(const Profile& p) {
    constexpr double kOfPitch = 5, kLeast_mm = 0.3, kClear = 3, kSharp = 2;
    std::vector<Eigen::Vector2d> points;
    std::vector<std::size_t> index;
    for (std::size_t i = 0; i < p.size(); ++i) {
        if (!usable(p, i)) continue;
        points.emplace_back(p.x_mm[i], p.z_mm[i]);
        index.push_back(i);
    }
    std::vector<double> apart;
    for (std::size_t i = 1; i < points.size(); ++i) apart.push_back((points[i] - points[i - 1]).norm());
    std::vector<double> sorted = apart;
    const double least = std::max(kOfPitch * median(sorted), kLeast_mm);
    std::vector<Break> out;
    for (std::size_t i = 0; i < apart.size(); ++i) {
        if (!(apart[i] > least)) continue;
        const double before = i > 0 ? apart[i - 1] : 0, after = i + 1 < apart.size() ? apart[i + 1] : 0;
        out.push_back({points[i], points[i + 1], index[i], index[i + 1], apart[i] > kClear * least,
                       apart[i] > kSharp * std::max(before, after), before, after});
    }
    return out;
}

std::vector<ContourEnd> ends_of(const Profile& p) {
    std::vector<ContourEnd> out;
    std::vector<Eigen::Vector2d> points;
    std::vector<std::size_t> index;
    for (std::size_t i = 0; i < p.size(); ++i) {
        if (!usable(p, i)) continue;
        points.emplace_back(p.x_mm[i], p.z_mm[i]);
        index.push_back(i);
    }
    if (points.size() < 2) return out;
    const std::size_t last = points.size() - 1;
    out.push_back({points.front(), index.front(), true, true, true, true, (points[1] - points[0]).norm()});
    for (const Break& b : breaks_of(p)) {
        out.push_back({b.before, b.index_before, false, b.clear, b.sharp, false, b.grain_before_mm});
        out.push_back({b.after, b.index, true, b.clear, b.sharp, false, b.grain_after_mm});
    }
    out.push_back(
        {points.back(), index.back(), false, true, true, true, (points[last] - points[last - 1]).norm()});
    return out;
}

namespace {

// The end that the reference point lies on.
const ContourEnd* end_at(const std::vector<ContourEnd>& ends, const Eigen::Vector2d& point) {
    constexpr double kNear_mm = 1.5;
    const auto off = [&](const ContourEnd& e) { return (e.at - point).norm(); };
    const auto own = std::min_element(ends.begin(), ends.end(),
                                      [&](const auto& a, const auto& b) { return off(a) < off(b); });
    return own == ends.end() || off(*own) > kNear_mm ? nullptr : &*own;
}

// The profiles on one side of the reference's, the nearest first: each is searched for where its inner neighbour's was.
std::vector<std::size_t> outwards(std::size_t reference, std::span<const TravelProfile> pass,
                                  const std::vector<std::size_t>& order, bool forward) {
    const double y0 = pass[reference].travel_mm;
    std::vector<std::size_t> out;
    for (const std::size_t i : order)
        if (i != reference && (pass[i].travel_mm >= y0) == forward) out.push_back(i);
    std::stable_sort(out.begin(), out.end(), [&](auto a, auto b) {
        return std::abs(pass[a].travel_mm - y0) < std::abs(pass[b].travel_mm - y0);
    });
    return out;
}

// Not the largest: now and then a return is missing beside the end.
double usual_grain(std::vector<double>& grains) {
    constexpr double kUsual = 0.8;
    const auto usual =
        grains.begin() + static_cast<std::ptrdiff_t>(kUsual * static_cast<double>(grains.size() - 1));
    std::nth_element(grains.begin(), usual, grains.end());
    return *usual;
}

}  // namespace

EndOffsets end_offsets(const Reference& reference, std::span<const TravelProfile> pass,
                       const std::vector<std::size_t>& order, const Eigen::Vector2d& point) {
    constexpr double kLost_mm = 2;
    const std::vector<ContourEnd> taught = ends_of(pass[reference.index].profile);
    const ContourEnd* own = end_at(taught, point);
    if (!own || !own->clear) return {};
    EndOffsets answer{std::vector<std::optional<Eigen::Vector2d>>(pass.size())};
    auto& out = answer.off;
    std::vector<double> grains{own->grain_mm};
    for (const bool forward : {true, false}) {
        Eigen::Vector2d last = Eigen::Vector2d::Zero();
        for (const std::size_t i : outwards(reference.index, pass, order, forward)) {
            const Registered& f = reference.found[i];
            if (!f.ok) continue;
            const PlanarMotion motion = motion_of(f, point);
            const Eigen::Rotation2Dd back(-motion.phi_rad);
            double nearest = kLost_mm, grain_mm = 0;
            for (const ContourEnd& e : ends_of(pass[i].profile)) {
                if (e.begins != own->begins) continue;
                const Eigen::Vector2d moved =
                    back * (e.at - Eigen::Vector2d(motion.dx_mm, motion.dz_mm)) - own->at;
                if ((moved - last).norm() > nearest) continue;
                nearest = (moved - last).norm();
                out[i] = moved;
                grain_mm = e.grain_mm;
            }
            if (!out[i]) continue;
            last = *out[i];
            grains.push_back(grain_mm);
        }
    }
    answer.grain_mm = usual_grain(grains);
    answer.broken = taught.size() > 2;
    return answer;
}

namespace {

constexpr double kHeld_mm = 10;  // of the piece

// The piece of `end` from there inwards.
std::vector<Eigen::Vector2d> piece_of(const Profile& p, const ContourEnd& end,
                                      const std::vector<ContourEnd>& ends) {
    std::size_t stop = end.begins ? p.size() - 1 : 0;
    for (const ContourEnd& e : ends)
        if (e.begins != end.begins &&
            (end.begins ? e.index >= end.index && e.index < stop : e.index <= end.index && e.index > stop))
            stop = e.index;
    std::vector<Eigen::Vector2d> out;
    for (std::size_t i = end.index;; end.begins ? ++i : --i) {
        const Eigen::Vector2d at(p.x_mm[i], p.z_mm[i]);
        if (usable(p, i) && (at - end.at).norm() <= kHeld_mm) out.push_back(at);
        if (i == stop) break;
    }
    return out;
}

// The course of the piece in the reference's profile: how high it lies across the direction in which it runs inwards, against
// the distance from its end. Only where it is not steep: what is steep moves across it by its own noise.
struct Course {
    Eigen::Vector2d end, inwards, across;
    std::vector<double> at_mm, height_mm;
    std::vector<bool> level;  // from here to the next

    bool make(const std::vector<Eigen::Vector2d>& piece) {
        constexpr double kFrom_mm = 1, kTo_mm = 6, kSteep = 0.5;
        constexpr std::size_t kFewest = 15, kBeside = 3;
        if (piece.size() < kFewest) return false;
        end = piece.front();
        Eigen::Vector2d middle = Eigen::Vector2d::Zero();
        std::vector<Eigen::Vector2d> straight;
        for (const Eigen::Vector2d& p : piece)
            if (const double d = (p - end).norm(); d >= kFrom_mm && d <= kTo_mm) straight.push_back(p);
        if (straight.size() < kFewest) straight = piece;
        for (const Eigen::Vector2d& p : straight) middle += p / static_cast<double>(straight.size());
        Eigen::Matrix2d moment = Eigen::Matrix2d::Zero();
        for (const Eigen::Vector2d& p : straight) moment += (p - middle) * (p - middle).transpose();
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen;
        eigen.computeDirect(moment);
        inwards = eigen.eigenvectors().col(1);
        if (inwards.dot(middle - end) < 0) inwards = -inwards;
        across = {-inwards.y(), inwards.x()};
        std::vector<Eigen::Vector2d> own;
        for (const Eigen::Vector2d& p : piece) own.emplace_back(inwards.dot(p - end), across.dot(p - end));
        std::sort(own.begin(), own.end(), [](const auto& a, const auto& b) { return a.x() < b.x(); });
        for (std::size_t k = 0; k < own.size(); ++k) {
            at_mm.push_back(own[k].x());
            height_mm.push_back(own[k].y());
            const Eigen::Vector2d step =
                own[std::min(k + kBeside, own.size() - 1)] - own[k < kBeside ? 0 : k - kBeside];
            level.push_back(std::abs(step.y()) < kSteep * step.x());
        }
        return true;
    }
    // The lines of a sensor lie at places of x: an end is known along x, and along a steep piece itself.
    bool pinned_by_x() const {
        constexpr double kSteep = 0.7;
        return std::abs(inwards.x()) > kSteep;
    }
    double grain(const std::vector<Eigen::Vector2d>& piece) const {
        if (piece.size() < 2) return 0;
        const Eigen::Vector2d by = piece[1] - piece[0];
        return std::abs(pinned_by_x() ? by.x() : by.dot(inwards));
    }
    // Height at `at`; nothing where the piece is steep or not known.
    std::optional<double> height(double at) const {
        const auto next = std::upper_bound(at_mm.begin(), at_mm.end(), at);
        if (next == at_mm.begin() || next == at_mm.end()) return std::nullopt;
        const auto k = static_cast<std::size_t>(next - at_mm.begin());
        if (!level[k - 1] || !level[k] || !(at_mm[k] > at_mm[k - 1])) return std::nullopt;
        const double share = (at - at_mm[k - 1]) / (at_mm[k] - at_mm[k - 1]);
        return height_mm[k - 1] + share * (height_mm[k] - height_mm[k - 1]);
    }
};

// How far, and how turned, the piece lies off its course once it is moved back; robust straight line through the deviations.
struct Off {
    double across_mm = 0, turn_rad = 0, rms_mm = 0;
    bool ok = false;
};
Off off_course(const Course& course, const std::vector<Eigen::Vector2d>& piece, const Eigen::Vector2d& end,
               double phi) {
    constexpr std::size_t kFewest = 12;
    constexpr double kKept = 4, kShortest_mm = 1.5, kExact_mm = 1e-9;
    constexpr int kRounds = 3;
    Off out;
    std::vector<double> at, deviation;
    const Eigen::Rotation2Dd back(-phi);
    for (const Eigen::Vector2d& p : piece) {
        const Eigen::Vector2d d = back * (p - end);
        const double s = course.inwards.dot(d);
        const auto height = course.height(s);
        const double by = height ? course.across.dot(d) - *height : 0;
        if (!height || std::abs(by) > kReach_mm) continue;
        at.push_back(s);
        deviation.push_back(by);
    }
    if (at.size() < kFewest) return out;
    const auto [low, high] = std::minmax_element(at.begin(), at.end());
    if (*high - *low < kShortest_mm) return out;
    std::vector<double> size = deviation;
    const double middle = median(size);
    std::vector<bool> kept(at.size());
    for (std::size_t k = 0; k < at.size(); ++k) size[k] = std::abs(deviation[k] - middle);
    double cut = std::numeric_limits<double>::infinity();
    for (int round = 0; round < kRounds; ++round) {
        double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
        for (std::size_t k = 0; k < at.size(); ++k) {
            kept[k] = std::abs(deviation[k] - out.across_mm - out.turn_rad * at[k]) <= cut;
            if (!kept[k]) continue;
            n += 1, sx += at[k], sy += deviation[k], sxx += at[k] * at[k], sxy += at[k] * deviation[k];
        }
        const double determinant = n * sxx - sx * sx;
        if (n < kFewest || !(determinant > 0)) return out;
        out.turn_rad = (n * sxy - sx * sy) / determinant;
        out.across_mm = (sy - out.turn_rad * sx) / n;
        for (std::size_t k = 0; k < at.size(); ++k)
            size[k] = std::abs(deviation[k] - out.across_mm - out.turn_rad * at[k]);
        out.rms_mm = kMadToSigma * median(size);
        cut = std::max(kKept * out.rms_mm, kExact_mm);
    }
    out.ok = true;
    return out;
}

// Where `piece` with its last point at `last` carries the end of `course`: the end's place and turn.
struct Carried {
    Eigen::Vector2d end = Eigen::Vector2d::Zero();
    double phi = 0, rms_mm = 0;
    bool ok = false;
};
Carried carry(const Course& course, const std::vector<Eigen::Vector2d>& piece, const Eigen::Vector2d& last,
              double phi) {
    constexpr int kSteps = 5;
    constexpr double kSettled_mm = 1e-5;
    Carried out;
    out.phi = phi;
    out.end = last;
    for (int step = 0; step < kSteps; ++step) {
        const Off off = off_course(course, piece, out.end, out.phi);
        if (!off.ok) return out;
        const Eigen::Rotation2Dd turn(out.phi);
        const Eigen::Vector2d along = turn * course.inwards;
        const Eigen::Vector2d pinned =
            course.pinned_by_x() ? Eigen::Vector2d::UnitX() : Eigen::Vector2d(along);
        Eigen::Vector2d next = out.end + turn * (course.across * off.across_mm);
        next += along * (pinned.dot(last - next) / pinned.dot(along));
        const double by = (next - out.end).norm();
        out.end = next;
        out.phi += off.turn_rad;
        out.rms_mm = off.rms_mm;
        if (by < kSettled_mm) break;
    }
    out.ok = out.end.allFinite() && std::isfinite(out.phi);
    return out;
}

}  // namespace

std::optional<EndMotion> follow_end(const Reference& reference, std::span<const TravelProfile> pass,
                                    const std::vector<std::size_t>& order, const Eigen::Vector2d& point) {
    constexpr double kLost_mm = 2, kBeyond = 3, kAtRim = 0.5;  // grains
    constexpr int kMayLieThere = 3;
    constexpr double kMostAhead = 2;
    const Profile& taught = pass[reference.index].profile;
    const std::vector<ContourEnd> ends = ends_of(taught);
    const ContourEnd* own = end_at(ends, point);
    Course course;
    if (!own || !own->sharp || !course.make(piece_of(taught, *own, ends))) return std::nullopt;
    // How far the field of view reaches, beyond doubt; seen from the end.
    const double sign = own->begins ? -1 : 1;
    double rim = -std::numeric_limits<double>::infinity();
    for (const std::size_t i : order)
        for (const double x : pass[i].profile.x_mm)
            if (std::isfinite(x)) rim = std::max(rim, sign * x);
    if (own->outermost && rim - sign * own->at.x() < kBeyond * own->grain_mm) return std::nullopt;

    EndMotion answer;
    answer.offsets.resize(pass.size());
    for (std::size_t i = 0; i < pass.size(); ++i) answer.offsets[i].travel_mm = pass[i].travel_mm;
    std::vector<double> grains;
    std::vector<std::size_t> at_rim;
    const double y0 = pass[reference.index].travel_mm;
    for (const bool forward : {true, false}) {
        Eigen::Vector2d last = own->at, slope = Eigen::Vector2d::Zero();
        double last_y = y0, phi = 0;
        for (const std::size_t i : outwards(reference.index, pass, order, forward)) {
            const double on = pass[i].travel_mm - last_y;
            const Eigen::Vector2d expected = last + slope * std::clamp(on, -kMostAhead, kMostAhead);
            const std::vector<ContourEnd> seen = ends_of(pass[i].profile);
            const ContourEnd* found = nullptr;
            double nearest = kLost_mm;
            for (const ContourEnd& e : seen) {
                // Its height is that of one point; of a rounded rim it is anywhere on the flank.
                const double off = (e.at - expected).norm();
                if (e.begins != own->begins || off > nearest) continue;
                nearest = off;
                found = &e;
            }
            if (!found) continue;
            const std::vector<Eigen::Vector2d> piece = piece_of(pass[i].profile, *found, seen);
            const Carried moved = carry(course, piece, found->at, phi);
            if (!moved.ok || (moved.end - expected).norm() > kLost_mm) continue;
            if (on != 0) slope = (moved.end - last) / on;
            last = moved.end;
            last_y = pass[i].travel_mm;
            phi = moved.phi;
            grains.push_back(course.grain(piece));
            if (found->outermost && rim - sign * found->at.x() < kAtRim * found->grain_mm)
                at_rim.push_back(i);
            const Eigen::Vector2d shift = moved.end + Eigen::Rotation2Dd(phi) * (point - own->at) - point;
            answer.offsets[i] = {pass[i].travel_mm, shift.x(),    shift.y(),
                                 deg_from_rad(phi), moved.rms_mm, true};
        }
    }
    if (static_cast<int>(at_rim.size()) > kMayLieThere)
        for (const std::size_t i : at_rim) answer.offsets[i].ok = false;
    if (grains.empty()) return std::nullopt;
    const double grain = usual_grain(grains);
    answer.grain_mm = course.pinned_by_x()
                          ? Eigen::Vector2d(grain, grain * std::abs(course.inwards.y() / course.inwards.x()))
                          : Eigen::Vector2d(grain * course.inwards.cwiseAbs());
    return answer;
}

double parting_mm(const Reference& reference, std::span<const TravelProfile> pass,
                  const Eigen::Vector2d& point, double jitter_mm) {
    const std::vector<Break> taught = breaks_of(pass[reference.index].profile);
    struct Width {
        std::vector<double> travel, along, across;
    };
    std::vector<Width> widths(taught.size());
    for (std::size_t i = 0; i < pass.size(); ++i) {
        const Registered& f = reference.found[i];
        if (i != reference.index && !f.ok) continue;
        const PlanarMotion motion = i == reference.index ? PlanarMotion{} : motion_of(f, point);
        const std::vector<Break> seen = breaks_of(pass[i].profile);
        for (std::size_t k = 0; k < taught.size(); ++k) {
            const Eigen::Vector2d before = motion * taught[k].before, after = motion * taught[k].after;
            const auto off = [&](const Break& b) {
                return std::max((b.before - before).norm(), (b.after - after).norm());
            };
            const auto nearest = std::min_element(
                seen.begin(), seen.end(), [&](const Break& a, const Break& b) { return off(a) < off(b); });
            if (nearest == seen.end() || off(*nearest) > kReach_mm) continue;
            const Eigen::Vector2d width =
                Eigen::Rotation2Dd(-motion.phi_rad) * (nearest->after - nearest->before);
            widths[k].travel.push_back(pass[i].travel_mm);
            widths[k].along.push_back(width.x());
            widths[k].across.push_back(width.y());
        }
    }
    double most = 0;
    for (const Width& w : widths)
        most = std::max(most, std::hypot(sure_slope(w.travel, w.along), sure_slope(w.travel, w.across)));
    return most * jitter_mm;
}

}  // namespace seamwright::alignment
