#include "core/alignment/alignment.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "core/alignment/pass_registration.h"
#include "core/correction/contour_fit.h"
#include "core/median.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

using namespace alignment;

constexpr double kShortestTravel_mm = 1.0;
// Below this share within the jitter the contour does not stay the same.
constexpr double kSteadyShare = 0.8;
constexpr double kSignificant = 3.0;
// Rotations below this are not worth a word, degrees.
constexpr double kLeastTurn_deg = 0.02;
// A straight profile that slides so far along an axis says nothing about it.
constexpr double kSlidesAlong = 0.1;
constexpr double kStraight_per_mm = 1e-9;
// The best and the worst of the profiles are taken at this share.
constexpr double kBestShare = 0.1;

double quantile(std::vector<double> v, double share) {
    if (v.empty()) return 0;
    const auto place = v.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(v.size() - 1));
    std::nth_element(v.begin(), place, v.end());
    return *place;
}

double rise(const PolynomialFit& f, double y, double from, double to) {
    const double s = std::clamp(y, from, to);
    const auto& c = f.coefficient;
    const double slope = c[1] + s * (2 * c[2] + s * 3 * c[3]);
    return s * (c[1] + s * (c[2] + s * c[3])) + slope * (y - s);
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

// Profiles within the window, the trigger's neighbours first.
std::vector<std::size_t> outwards_from_trigger(std::span<const TravelProfile> pass, double window_mm) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < pass.size(); ++i)
        if (std::abs(pass[i].travel_mm) <= window_mm) order.push_back(i);
    std::stable_sort(order.begin(), order.end(), [&](auto a, auto b) {
        return std::abs(pass[a].travel_mm) < std::abs(pass[b].travel_mm);
    });
    return order;
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

// How the contour moves in the profile along the travel.
struct Drift {
    std::vector<double> travel_mm, dx_mm, dz_mm, dphi_deg;
    PolynomialFit x, z, phi;
    double from = 0, to = 0;  // travel that was seen, the trigger included
    Eigen::Vector2d along = Eigen::Vector2d::Zero();

    void add(const TravelOffset& o) {
        travel_mm.push_back(o.travel_mm);
        dx_mm.push_back(o.dx_mm);
        dz_mm.push_back(o.dz_mm);
        dphi_deg.push_back(o.dphi_deg);
    }
    // False: too little was seen.
    bool fit() {
        if (travel_mm.size() < static_cast<std::size_t>(kFewestProfiles)) return false;
        const auto [low, high] = std::minmax_element(travel_mm.begin(), travel_mm.end());
        from = std::min(0.0, *low), to = std::max(0.0, *high);
        if (*high - *low < kShortestTravel_mm) return false;
        x = fit_lowest_order(travel_mm, dx_mm, 1, 3);
        z = fit_lowest_order(travel_mm, dz_mm, 1, 3);
        phi = fit_lowest_order(travel_mm, dphi_deg, 1, 1);
        return x.ok && z.ok && phi.ok;
    }
    // The farthest that the contour stands off within the jitter; after a turn that takes `share` of the slopes away.
    double farthest(double jitter_mm, double share = 0) const {
        constexpr int kSteps = 50;
        double most = 0;
        for (int k = -kSteps; k <= kSteps; ++k) {
            const double at = jitter_mm * k / kSteps;
            most = std::max(most, std::hypot(rise(x, at, from, to) - share * x.coefficient[1] * at,
                                             rise(z, at, from, to) - share * z.coefficient[1] * at));
        }
        return most;
    }
};

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// What the polynomials leave of the motion within the jitter, and where: a notch, a weld nugget, a wave. One profile alone is a
// profile gone wrong, so the middle of three neighbours counts; and what exceeds the noise, which is told by neighbours: beside
// noise alone a line between two of them misses the one between by as much as the fit does.
struct StandOff {
    double most_mm = 0, at_mm = 0;
};
StandOff left_over(const Drift& drift, double jitter_mm) {
    constexpr std::size_t kFewest = 7;
    constexpr double kAlike = 1.8;            // of the noise: what is left is no noise
    constexpr double kBeyond = 3, kSeen = 2;  // times the noise; the latter where it is none
    const std::size_t n = drift.travel_mm.size();
    if (n < kFewest) return {};
    std::vector<std::size_t> order(n);
    std::iota(order.begin(), order.end(), 0);
    std::stable_sort(order.begin(), order.end(),
                     [&](auto a, auto b) { return drift.travel_mm[a] < drift.travel_mm[b]; });
    const auto travel = [&](std::size_t i) { return drift.travel_mm[order[i]]; };
    std::vector<Eigen::Vector2d> middle(n, Eigen::Vector2d::Zero());
    std::vector<bool> counts(n, false);
    for (const Eigen::Index axis : {0, 1}) {
        const PolynomialFit& f = axis == 0 ? drift.x : drift.z;
        const std::vector<double>& value = axis == 0 ? drift.dx_mm : drift.dz_mm;
        std::vector<double> rest(n), size, rough;
        for (std::size_t i = 0; i < n; ++i) {
            rest[i] = value[order[i]] - f.coefficient[0] - rise(f, travel(i), drift.from, drift.to);
            size.push_back(std::abs(rest[i]));
        }
        for (std::size_t i = 1; i + 1 < n; ++i) {
            const double wide = travel(i + 1) - travel(i - 1);
            const double w = wide > 0 ? (travel(i + 1) - travel(i)) / wide : 0.5;
            rough.push_back(std::abs(rest[i] - w * rest[i - 1] - (1 - w) * rest[i + 1]) /
                            std::sqrt(1 + w * w + (1 - w) * (1 - w)));
        }
        const double noise = kMadToSigma * median(rough);
        const bool alike = kMadToSigma * median(size) > kAlike * noise;
        for (std::size_t i = 1; i + 1 < n; ++i) {
            const double a = rest[i - 1], b = rest[i], c = rest[i + 1];
            middle[i][axis] = std::max(std::min(a, b), std::min(std::max(a, b), c));
            counts[i] = counts[i] || std::abs(middle[i][axis]) > (alike ? kSeen : kBeyond) * noise;
        }
    }
    StandOff most;
    for (std::size_t i = 0; i < n; ++i)
        if (counts[i] && std::abs(travel(i)) <= jitter_mm && middle[i].norm() > most.most_mm)
            most = {middle[i].norm(), travel(i)};
    return most;
}

// How far, two sigma, the contour stands now here and now there from profile to profile within the jitter, which no travel
// explains (a ripple shorter than the steps tell, a sensor that shakes); 0 where the registration's own noise does.
double scatter_beyond(const Reference& best, const Drift& drift, double jitter_mm) {
    constexpr std::size_t kFewest = 7;
    constexpr double kBeyond = 5;  // of the registration's sigma
    std::vector<double> stated;
    for (const Registered& r : best.found)
        if (r.ok) stated.push_back(r.sigma_mm);
    double most = 0;
    for (const bool along_x : {true, false}) {
        const PolynomialFit& f = along_x ? drift.x : drift.z;
        const std::vector<double>& value = along_x ? drift.dx_mm : drift.dz_mm;
        std::vector<double> rest;
        for (std::size_t i = 0; i < value.size(); ++i)
            if (std::abs(drift.travel_mm[i]) <= jitter_mm)
                rest.push_back(std::abs(value[i] - f.coefficient[0] -
                                        rise(f, drift.travel_mm[i], drift.from, drift.to)));
        if (rest.size() < kFewest) continue;
        const double sigma = kMadToSigma * median(rest);
        if (sigma > kBeyond * median(stated)) most = std::max(most, 2 * sigma);
    }
    return most;
}

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

// Within the noise of both slopes the two drifts are one.
double differ_mm(const Drift& own, const Drift& drift, double jitter_mm) {
    constexpr double kSure = 4;  // sigmas
    const auto differs = [](const PolynomialFit& a, const PolynomialFit& b) {
        const double by = a.coefficient[1] - b.coefficient[1];
        return std::abs(by) > kSure * std::hypot(a.coefficient_sigma[1], b.coefficient_sigma[1]) ? by : 0.0;
    };
    return std::hypot(differs(own.x, drift.x), differs(own.z, drift.z)) * jitter_mm;
}

// What counts is the drift where the reference point is. The whole contour's motion is another one where the profile is broken
// (a gap, a rim over a frame), where a part of it stands still (a swage beside an edge that runs off), and where a part grows:
// so the unbroken piece with the point, what is near it, and the end that it lies on are followed as well, and the one that
// differs and drifts farthest is taken. A field of view that cuts the contour makes an end that drifts against it, never farther.
// Answers by how much it differs within the jitter.
double follow_point(const Reference& best, std::span<const TravelProfile> pass,
                    const AlignmentOptions& options, Drift& drift, std::vector<TravelOffset>& offsets) {
    constexpr double kNear_mm = 8, kNearest_mm = 4;
    if (!options.reference_mm || !drift.along.isZero()) return 0;
    const Eigen::Vector2d point = *options.reference_mm;
    const auto order = outwards_from_trigger(pass, options.window_mm);
    const Drift whole = drift;
    const std::vector<TravelOffset> whole_offsets = offsets;
    double most = 0;
    const auto consider = [&](const std::vector<TravelOffset>& own_offsets, bool farther) {
        Drift own;
        for (std::size_t i = 0; i < pass.size(); ++i)
            if (i != best.index && own_offsets[i].ok) own.add(own_offsets[i]);
        if (!own.fit()) return;
        const double apart = differ_mm(own, whole, options.jitter_mm);
        if (!(apart > 0) || (farther && own.farthest(options.jitter_mm) <= drift.farthest(options.jitter_mm)))
            return;
        most = std::max(most, apart);
        drift = std::move(own);
        offsets = own_offsets;
    };
    for (const double within_mm : {kInfinity, kNear_mm, kNearest_mm}) {
        const auto piece = register_piece(best, pass, order, point, within_mm);
        if (!piece) continue;
        std::vector<TravelOffset> own = whole_offsets;
        for (std::size_t i = 0; i < pass.size(); ++i) {
            const Registered& r = piece->found[i];
            if (i == piece->index) continue;
            own[i] = {pass[i].travel_mm};
            if (r.ok)
                own[i] = {pass[i].travel_mm, r.shift.x(), r.shift.y(), deg_from_rad(r.phi), r.rms, true};
        }
        consider(own, std::isfinite(within_mm));
    }
    const auto ends = end_offsets(best, pass, order, point);
    if (!ends.empty()) {
        std::vector<TravelOffset> own = whole_offsets;
        for (std::size_t i = 0; i < pass.size(); ++i) {
            if (i == best.index) continue;
            own[i].ok = own[i].ok && ends[i];
            if (!own[i].ok) continue;
            own[i].dx_mm += ends[i]->x();
            own[i].dz_mm += ends[i]->y();
        }
        consider(own, true);
    }
    return most;
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
    result.sliding = !drift.along.isZero();
    result.offsets[best->index].ok = true;
    for (std::size_t i = 0; i < pass.size(); ++i) {
        const Registered& r = best->found[i];
        if (!r.ok) continue;
        result.offsets[i] = {pass[i].travel_mm, r.shift.x(), r.shift.y(), deg_from_rad(r.phi), r.rms, true};
        drift.add(result.offsets[i]);
    }
    if (!drift.fit()) return too_few(drift.travel_mm.size() + 1);
    const double apart_mm = follow_point(*best, pass, options, drift, result.offsets);
    state_direction(drift, options.jitter_mm, result);
    state_error(drift, options.jitter_mm, result);
    const bool lost = state_shape(*best, pass, options, result);
    const StandOff off = left_over(drift, options.jitter_mm);
    const double scatter_mm = scatter_beyond(*best, drift, options.jitter_mm);
    const Unseen unseen = unseen_within(result.offsets, options);
    result.shape_change_mm = std::max({result.shape_change_mm, off.most_mm, apart_mm, scatter_mm});
    const bool changes = lost || unseen.lost || result.shape_change_mm > options.tolerance_mm;
    result.status = judged(result, options.tolerance_mm, changes, unseen.uncovered);
    result.cure = cure_of(result, drift, options, changes, off, unseen);
    return result;
}

}  // namespace seamwright
