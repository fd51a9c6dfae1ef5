#include "core/alignment/alignment.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/alignment/contour_ends.h"
#include "core/alignment/drift.h"
#include "core/alignment/pass_registration.h"
#include "core/correction/contour_fit.h"
#include "core/median.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

using namespace alignment;

// Below this share within the jitter the contour does not stay the same.
constexpr double kSteadyShare = 0.8;
constexpr double kSignificant = 3.0;
// Rotations below this are not worth a word, degrees.
constexpr double kLeastTurn_deg = 0.02;
// A straight profile that slides so far along an axis says nothing about it.
constexpr double kSlidesAlong = 0.1;
// Along such a profile travel may run off by 6 degrees to either side; one standard deviation of that.
constexpr double kUnseenSlope = 0.06;
constexpr double kStraight_per_mm = 1e-9;
// The best and the worst of the profiles are taken at this share.
constexpr double kBestShare = 0.1;

double quantile(std::vector<double> v, double share) {
    if (v.empty()) return 0;
    const auto place = v.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(v.size() - 1));
    std::nth_element(v.begin(), place, v.end());
    return *place;
}

Expected<void> check_pass(std::span<const TravelProfile> pass, const AlignmentOptions& options) {
    if (pass.empty())
        return input_error("there are no profiles", "alignment pass", "record the pass from entry to exit");
    for (const double v : {options.jitter_mm, options.tolerance_mm, options.window_mm}) {
        if (!(v > 0) || !std::isfinite(v))
            return input_error("jitter, tolerance and window must be positive numbers", "alignment options",
                               "give millimetres above 0");
    }
    if (options.reference_mm && !options.reference_mm->allFinite())
        return input_error("the reference point is not finite", "alignment options",
                           "give x and z in millimetres");
    for (std::size_t i = 0; i < pass.size(); ++i) {
        if (pass[i].profile.x_mm.size() != pass[i].profile.z_mm.size())
            return input_error("x and z have different numbers of points", Text("profile {} of the pass", i),
                               "give one x and one z a point");
    }
    return {};
}

// A straight profile slides on itself: when most say so, all are judged across their common direction, which is
// answered; else it is zero and those that slide do not count.
Eigen::Vector2d common_sliding(std::vector<Registered>& found) {
    Eigen::Vector2d along = Eigen::Vector2d::Zero();
    std::size_t registered = 0, sliding = 0;
    for (const Registered& r : found) {
        registered += r.ok;
        if (!r.ok || r.slides.isZero()) continue;
        ++sliding;
        along += r.slides.dot(along) < 0 ? Eigen::Vector2d(-r.slides) : r.slides;
    }
    if (2 * sliding > registered) {
        along.normalize();
        for (Registered& r : found) r.shift -= along * along.dot(r.shift);
        return along;
    }
    for (Registered& r : found) r.ok = r.ok && r.slides.isZero();
    return Eigen::Vector2d::Zero();
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// A stretch of travel within the jitter in which the contour is not found.
struct Unseen {
    double from_mm = 0, to_mm = 0;
    bool lost = false;       // profiles were recorded there
    bool uncovered = false;  // hardly any were
};
Unseen unseen_within(const std::vector<TravelOffset>& offsets, const AlignmentOptions& options) {
    constexpr double kLost = 0.1, kUncovered = 0.9, kUncoveredEnd = 0.25;  // of the jitter
    constexpr double kByChance = 0.05;
    constexpr double kSteps = 2.5;  // of the usual step, or the pass is as sparse as that
    const double jitter_mm = options.jitter_mm;
    std::vector<const TravelOffset*> by_travel;
    for (const TravelOffset& o : offsets)
        if (std::abs(o.travel_mm) <= options.window_mm) by_travel.push_back(&o);
    std::stable_sort(by_travel.begin(), by_travel.end(),
                     [](auto a, auto b) { return a->travel_mm < b->travel_mm; });
    std::vector<double> steps;
    double last = -kInfinity;
    int stretches = 0;  // in which profiles are lost, of one as of many
    bool before_ok = true;
    for (const TravelOffset* o : by_travel) {
        stretches += before_ok && !o->ok;
        before_ok = o->ok;
        if (!o->ok) continue;
        if (o->travel_mm > last && std::isfinite(last)) steps.push_back(o->travel_mm - last);
        last = o->travel_mm;
    }
    const double step = steps.empty() ? 0 : median(steps);
    Unseen worst;
    double before = -kInfinity;
    int lost = 0;
    const auto close = [&](double after) {
        const double from = std::max(before, -jitter_mm), to = std::min(after, jitter_mm);
        const bool end = !std::isfinite(before) || !std::isfinite(after);
        // As many in a row as the others that are lost here and there would hardly make by chance.
        const double others = static_cast<double>(by_travel.size()) - lost;
        const double by_chance = others * std::pow((stretches - 1) / std::max(1.0, others), lost);
        const bool is_lost = lost >= 2 && by_chance < kByChance && to - from > kLost * jitter_mm;
        const bool uncovered = to - from > (end ? kUncoveredEnd : kUncovered) * jitter_mm &&
                               (end || after - before > kSteps * step);
        if ((is_lost || uncovered) && to - from > worst.to_mm - worst.from_mm)
            worst = {from, to, is_lost, uncovered && !is_lost};
        before = after;
        lost = 0;
    };
    for (const TravelOffset* o : by_travel) {
        if (o->ok)
            close(o->travel_mm);
        else
            ++lost;
    }
    close(kInfinity);
    return worst;
}

// Angles, their sigmas, the cure and the contour's radius.
void state_direction(const Drift& drift, double jitter_mm, AlignmentResult& result) {
    const double sx = drift.x.coefficient[1], sz = drift.z.coefficient[1];
    result.dx_mm_per_mm = sx;
    result.dz_mm_per_mm = sz;
    result.yaw_deg = deg_from_rad(std::atan(sx));
    result.pitch_deg = deg_from_rad(std::atan(sz));
    result.roll_deg = drift.phi.coefficient[1] * jitter_mm;
    result.sigma_yaw_deg = deg_from_rad(drift.x.coefficient_sigma[1] / (1 + sx * sx));
    result.sigma_pitch_deg = deg_from_rad(drift.z.coefficient_sigma[1] / (1 + sz * sz));
    // Drift along a straight profile is not seen; what it has of the other axis is as unsure.
    const double aslant = std::abs(drift.along.x() * drift.along.y()) * kUnseenSlope;
    result.sigma_yaw_deg = std::hypot(result.sigma_yaw_deg, deg_from_rad(aslant));
    result.sigma_pitch_deg = std::hypot(result.sigma_pitch_deg, deg_from_rad(aslant));
    if (std::abs(drift.along.x()) > kSlidesAlong) result.sigma_yaw_deg = kInfinity;
    if (std::abs(drift.along.y()) > kSlidesAlong) result.sigma_pitch_deg = kInfinity;
    // R_z(a) R_x(b) takes the sensor's Y to the contour's direction (sx, 1, sz).
    const double a = -std::atan(sx);
    result.cure_about_z_deg = deg_from_rad(a);
    result.cure_about_x_deg = deg_from_rad(std::atan(sz * std::cos(a)));

    const auto bend = [](const PolynomialFit& f) {
        return std::abs(f.coefficient[2]) > kSignificant * f.coefficient_sigma[2] ? 2 * f.coefficient[2]
                                                                                  : 0.0;
    };
    const Eigen::Vector3d tangent(sx, 1, sz), second(bend(drift.x), 0, bend(drift.z));
    const double curvature = tangent.cross(second).norm() / std::pow(tangent.norm(), 3);
    result.radius_mm = curvature > kStraight_per_mm ? 1 / curvature : kInfinity;
}

void state_error(const Drift& drift, double jitter_mm, AlignmentResult& result) {
    result.expected_error_mm = drift.farthest(jitter_mm);
    result.expected_error_sigma_mm =
        jitter_mm * std::hypot(drift.x.coefficient_sigma[1], drift.z.coefficient_sigma[1]);
    if (!std::isfinite(result.sigma_yaw_deg) || !std::isfinite(result.sigma_pitch_deg))
        result.expected_error_sigma_mm = kInfinity;
    for (std::size_t k = 0; k < 3; ++k) {
        result.curve.x_coefficients[static_cast<Eigen::Index>(k)] = drift.x.coefficient[k + 1];
        result.curve.z_coefficients[static_cast<Eigen::Index>(k)] = drift.z.coefficient[k + 1];
    }
    result.curve.valid_from_mm = drift.from;
    result.curve.valid_to_mm = drift.to;
}

// Noise is what the best registered profiles keep; the rest of the worst within the jitter is change of shape. True: the
// contour does not stay the same, whatever its size.
bool state_shape(const Reference& best, std::span<const TravelProfile> pass, const AlignmentOptions& options,
                 AlignmentResult& result) {
    std::vector<double> all_rms, near_rms, near_share;
    for (std::size_t i = 0; i < pass.size(); ++i) {
        const Registered& f = best.found[i];
        if (!f.ok) continue;
        all_rms.push_back(f.rms);
        if (std::abs(pass[i].travel_mm) > options.jitter_mm) continue;
        near_rms.push_back(f.rms);
        near_share.push_back(f.share);
    }
    if (near_rms.empty()) near_rms = all_rms;
    const double noise = quantile(all_rms, kBestShare), worst = quantile(near_rms, 1 - kBestShare);
    const Eigen::Vector2d point =
        options.reference_mm ? *options.reference_mm : centroid(pass[best.index].profile);
    result.shape_change_mm = std::max(std::sqrt(std::max(0.0, worst * worst - noise * noise)),
                                      std::max(growth_mm(best, pass, point, options.jitter_mm),
                                               parting_mm(best, pass, point, options.jitter_mm)));
    // One profile alone is a profile gone wrong.
    return near_share.size() > 1 &&
           quantile(near_share, std::max(kBestShare, 1.0 / double(near_share.size() - 1))) < kSteadyShare;
}

AlignmentStatus judged(const AlignmentResult& result, double tolerance_mm, bool changes, bool uncovered) {
    const double error = result.expected_error_mm, two_sigma = 2 * result.expected_error_sigma_mm;
    // Too uncertain to tell: within two sigma it may be either, and two sigma are more than the tolerance.
    const bool unsure = two_sigma > tolerance_mm;
    const bool seen_to_drift =
        error > tolerance_mm && (!unsure || result.sliding || error - two_sigma > tolerance_mm);
    return seen_to_drift         ? AlignmentStatus::drifting
           : unsure || uncovered ? AlignmentStatus::undetermined
           : changes             ? AlignmentStatus::shape_changes
                                 : AlignmentStatus::frozen;
}

// By which rotation the sensor's travel follows the contour; empty: by none worth a word.
Text turn_advised(const AlignmentResult& result) {
    const double z = result.cure_about_z_deg, x = result.cure_about_x_deg;
    const bool about_z = std::abs(z) > kLeastTurn_deg, about_x = std::abs(x) > kLeastTurn_deg;
    if (!about_z && !about_x) return {};
    const Text how =
        about_z && about_x
            ? Text(
                  "about the sensor's own Z axis by {:+.2f} degrees, then about its turned X axis by "
                  "{:+.2f} degrees",
                  z, x)
        : about_z ? Text("about the sensor's own Z axis by {:+.2f} degrees", z)
                  : Text("about the sensor's own X axis by {:+.2f} degrees", x);
    return Text(
        "rotate the sensor at the trigger position, about the reference point and together with "
        "its travel, {}",
        how);
}

Text cure_of(const AlignmentResult& result, const Drift& drift, const AlignmentOptions& options, bool changes,
             const StandOff& off, const Unseen& unseen) {
    Text cure;
    const auto say = [&](const Text& sentence) {
        if (!sentence.empty()) cure = joined(cure, "; ", sentence);
    };
    if (result.status == AlignmentStatus::drifting) {
        say(turn_advised(result));
        // What the bend alone costs cannot be turned away.
        if (const double rest = drift.farthest(options.jitter_mm, 1); rest > options.tolerance_mm)
            say(
                Text("the contour bends with a radius of {:.0f} mm, which alone costs {:.3f} mm "
                     "within the jitter: let "
                     "the correction use the contour curve, or trigger more exactly",
                     result.radius_mm, rest));
    }
    if (unseen.lost)
        say(Text("the contour is not found from {:+.1f} to {:+.1f} mm of travel, within the jitter",
                 unseen.from_mm, unseen.to_mm));
    else if (unseen.uncovered)
        say(
            Text("the pass shows nothing from {:+.1f} to {:+.1f} mm of travel, within the jitter: record it "
                 "from entry to exit",
                 unseen.from_mm, unseen.to_mm));
    else if (result.status == AlignmentStatus::undetermined && !result.sliding)
        say(
            Text("the drift is not known well enough to tell: {:.3f} mm with a sigma of {:.3f} mm; "
                 "record the pass "
                 "again with more profiles or less noise",
                 result.expected_error_mm, result.expected_error_sigma_mm));
    if (off.most_mm > options.tolerance_mm)
        say(Text("the contour stands off by {:.2f} mm at {:+.1f} mm of travel, within the jitter",
                 off.most_mm, off.at_mm));
    if (changes)
        say("the profile changes its shape along the travel: teach the spot where the contour stays the "
            "same");
    if (result.sliding)
        say(Text(
            "the profile is a straight line along ({:.2f}, {:.2f}) in x, z: drift along it cannot be seen",
            drift.along.x(), drift.along.y()));
    return cure;
}

}  // namespace

std::string_view to_string(AlignmentStatus status) {
    switch (status) {
        case AlignmentStatus::frozen:
            return "frozen";
        case AlignmentStatus::drifting:
            return "drifting";
        case AlignmentStatus::shape_changes:
            return "shape_changes";
        case AlignmentStatus::not_enough_profiles:
            return "not_enough_profiles";
        case AlignmentStatus::undetermined:
            return "undetermined";
    }
    return "unknown";
}

Expected<AlignmentResult> check_alignment(std::span<const TravelProfile> pass,
                                          const AlignmentOptions& options) {
    SEAM_OK(check_pass(pass, options));
    AlignmentResult result;
    result.offsets.resize(pass.size());
    for (std::size_t i = 0; i < pass.size(); ++i) result.offsets[i].travel_mm = pass[i].travel_mm;
    const auto too_few = [&](std::size_t enough) {
        result.status = AlignmentStatus::not_enough_profiles;
        result.cure = Text(
            "only {} of {} profiles within {:g} mm of travel are usable: record at least {} over "
            "more than {:g} mm before and after the trigger position",
            enough, pass.size(), options.window_mm, kFewestProfiles + 1, kShortestTravel_mm);
        return result;
    };
    std::optional<Reference> best =
        choose_reference(pass, outwards_from_trigger(pass, options.window_mm), options.reference_mm);
    if (!best) return too_few(0);

    Drift drift;
    drift.along = common_sliding(best->found);
    result.offsets[best->index].ok = true;
    for (std::size_t i = 0; i < pass.size(); ++i) {
        const Registered& r = best->found[i];
        if (!r.ok) continue;
        result.offsets[i] = {pass[i].travel_mm, r.shift.x(), r.shift.y(), deg_from_rad(r.phi), r.rms, true};
        drift.add(result.offsets[i]);
    }
    if (!drift.fit()) return too_few(drift.travel_mm.size() + 1);
    const double scatter_mm = scatter_beyond(*best, drift, options.jitter_mm);
    const double apart_mm = follow_point(*best, pass, options, drift, result.offsets);
    result.sliding = !drift.along.isZero();
    state_direction(drift, options.jitter_mm, result);
    state_error(drift, options.jitter_mm, result);
    const bool lost = state_shape(*best, pass, options, result);
    const StandOff off = left_over(drift, options.jitter_mm);
    const Unseen unseen = unseen_within(result.offsets, options);
    result.shape_change_mm = std::max({result.shape_change_mm, off.most_mm, apart_mm, scatter_mm});
    const bool changes = lost || unseen.lost || result.shape_change_mm > options.tolerance_mm;
    result.status = judged(result, options.tolerance_mm, changes, unseen.uncovered);
    result.cure = cure_of(result, drift, options, changes, off, unseen);
    return result;
}

}  // namespace seamwright
