#include "core/features/registration/registration.h"

#include <algorithm>
#include <cmath>

#include "core/features/registration/registration_kernel.h"
#include "core/geometry/pose.h"

namespace seamwright {
namespace {

// A pose that meets this much of the template's length and of each direction's information needs no further
// search.
constexpr double kConvincingShare = 0.85, kConvincingInformation = 0.7;
// What is known of the least determined direction beside the best, from which on no shape is small on a long straight.
constexpr double kWellHeld = 0.15;
// Cost of what is missing (nine for each point) up to which nothing is.
constexpr double kComplete = 27;
// Coarse ratings worse by this are not followed up.
constexpr double kHopeless = 0.2;
// Residuals of the best place beyond this multiple of the noise are a shape that is a little another one.
constexpr double kMisfit = 1.5;
constexpr double kWideGate_mm = 1.5;
constexpr int kMostRivals = 4;
constexpr int kStarts = 10, kFinishedAtOnce = 3, kAlong = 4;

}  // namespace

ContourMatcher::ContourMatcher(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
ContourMatcher::ContourMatcher(ContourMatcher&&) noexcept = default;
ContourMatcher& ContourMatcher::operator=(ContourMatcher&&) noexcept = default;
ContourMatcher::~ContourMatcher() = default;

Expected<ContourMatcher> ContourMatcher::make(const Profile& contour, const Eigen::Vector2d& reference_mm) {
    if (contour.x_mm.size() != contour.z_mm.size())
        return input_error("the template has unequal numbers of x and z", "template");
    if (!reference_mm.allFinite())
        return input_error("the template's reference point is not finite", "template",
                           "give two numbers in mm");
    auto impl = std::make_unique<Impl>();
    impl->contour = contour;
    impl->model.build(contour);
    if (impl->model.x().size() < static_cast<std::size_t>(kFewestRegistrationPoints))
        return input_error("the template has fewer than 5 usable points", "template",
                           "take a longer piece of contour");
    if (!impl->model.usable())
        return input_error("the template has no extent: its points do not form a contour", "template",
                           "take a piece of contour some millimetres long");
    impl->reference = reference_mm;
    if (!impl->learn())
        return input_error("the template has no connected piece of contour", "template",
                           "take points in sensor order");
    return ContourMatcher(std::move(impl));
}

bool ContourMatcher::Impl::learn() {
    arc.clear();
    jumps.clear();
    double length = 0;
    for (const auto& edge : model.edges()) {
        arc.push_back(length);
        if (!edge.wall) length += 2 * edge.half;
    }
    if (!(length > 0)) return false;
    const auto& tx = model.x();
    const auto& tz = model.z();
    const int most = static_cast<int>(tx.size()) - 1;
    const double most_open = model.pitch().most_open();
    for (std::size_t e = 0; e < model.edges().size(); ++e) {
        const auto& edge = model.edges()[e];
        if (!edge.wall) continue;
        const bool rising = tz[edge.point + 1] > tz[edge.point];
        JumpEnd end = jump_end(tx, tz, rising ? edge.point : edge.point + 1,
                               rising ? edge.point + 1 : edge.point, 0, most, model.sigma_mm(), most_open);
        end.outline = outline_at(tx, tz, edge.point, 0, most, model.sigma_mm());
        if (sampled_wall(e)) end.is_edge = false;
        jumps.push_back(end);
    }
    for (int i = 0; i < most; ++i) {
        const auto at = static_cast<std::size_t>(i);
        if (model.pitch().is_gap(tx[at + 1] - tx[at], tz[at + 1] - tz[at]))
            gap_ends(tx, tz, i, 0, most, model.sigma_mm(), most_open, jumps);
    }
    learn_directions();
    search.prepare(model);
    finder = search;
    return true;
}

void ContourMatcher::Impl::share_noise() {
    constexpr double kOther = 1;  // lines
    if (!(scene.pitch.alike() > 1) || std::abs(scene.pitch.shared - model.pitch().shared) <= kOther) return;
    model.build(contour, scene.pitch.shared, scene.sigma_mm);
    if (model.usable() && learn()) return;
    model.build(contour, 1);
    learn();
}

bool ContourMatcher::Impl::within(const SearchWindow& window, const CentredPose& pose) const {
    return motion_box(window, model.origin(), reference, pose.phi)
               .contains(pose.dx, pose.dz, 0.1 * std::max(window.dx_mm, window.dz_mm) + 0.5) &&
           std::abs(pose.phi) <= 1.1 * window.phi_rad + 0.01;
}

bool ContourMatcher::Impl::gather(const Profile& profile, const SearchWindow& window) const {
    // What the template cannot reach is no part of the search: a stray point a kilometre off costs nothing.
    const double arm =
        std::max((reference - model.origin()).norm(),
                 window.pivot == SearchPivot::reference_or_origin ? model.origin().norm() : 0.0);
    const double turn = std::min(1.1 * std::abs(window.phi_rad) + 0.02, 3.2);
    const double reach = model.extent_mm() + window.centre_mm.norm() +
                         1.2 * std::hypot(window.dx_mm, window.dz_mm) +
                         2 * arm * std::sin(0.5 * std::min(turn, 3.1)) + 3;
    scene.gather(profile, model.origin(), Eigen::Vector2d::Zero(), reach);
    return scene.x.size() >= static_cast<std::size_t>(kFewestRegistrationPoints);
}

// The places that the search proposes, each brought to the bottom of its basin. In `finishes`: all within the
// window, no two in one basin.
void ContourMatcher::Impl::search_places(const SearchWindow& window) const {
    finishes.clear();
    scene.reduce(std::max(search.reduction_tolerance_mm(), std::min(3 * scene.sigma_mm, search.step_mm())),
                 search.step_mm());
    finder.find(scene, window, model.origin(), reference, kStarts, candidates);
    const int stride = std::max(1, static_cast<int>(scene.x.size()) / 250);
    const int support_stride = std::max(1, static_cast<int>(scene.x.size()) / 800);
    const double start_gate = 1.2 * search.step_mm();
    Support best;
    double best_cost = std::numeric_limits<double>::infinity();
    auto consider = [&](const CentredPose& start) {
        for (const Finish& f : finishes)
            if (apart_mm(f.pose, start) < 0.7 * search.step_mm()) return;
        const Finish f = finish(start, start_gate, stride, 20);
        if (!within(window, f.pose)) return;
        for (const Finish& other : finishes)
            if (apart_mm(f.pose, other.pose) < std::max(0.3 * search.step_mm(), f.gate)) return;
        finishes.push_back(f);
        const Support s = support(f, noise_mm(), support_stride);
        if (s.cost < best_cost) {
            best_cost = s.cost;
            best = s;
        }
    };
    auto convincing = [&] {
        return best.share >= kConvincingShare && best.least_informed() >= kConvincingInformation;
    };
    for (std::size_t i = 0; i < candidates.size(); ++i) {
        if (i >= static_cast<std::size_t>(kFinishedAtOnce) && convincing()) break;
        consider(candidates[i].pose);
    }
    if (finishes.empty()) return;
    // A small shape on a long straight: the straight is met everywhere, so look along it for the shape.
    if (weakest_share < kWellHeld || !convincing()) {
        const double step = 0.25 * search.step_mm();
        const double along_reach = 2.5 * std::max(window.dx_mm, window.dz_mm);
        const double tolerance = std::max(0.3 * search.step_mm(), best.gate);
        const CentredPose from = best.pose;
        finder.find_along(scene, from, directions[0].twist, along_reach, step, tolerance, window,
                          model.origin(), reference, kAlong, along);
        // Far fewer partners than here, shape and all: not worth a finish.
        const double here = finder.rate(scene, from, tolerance);
        for (const SearchCandidate& c : along)
            if (c.score > here - kHopeless) consider(c.pose);
    }
}

// A direction of which little is met, or that the slopes leave open, is a flat valley of the finish: the pose may still be
// on its way along it.
void ContourMatcher::Impl::follow(Finish& f, Support& s, double sigma) const {
    constexpr int kMostSteps = 6;
    for (int step = 0; step < kMostSteps; ++step) {
        const bool informed = s.least_informed() >= kConvincingInformation;
        if (informed && weakest_share >= kWellHeld) return;
        const auto least = std::min_element(s.informed.begin(), s.informed.end()) - s.informed.begin();
        Eigen::Vector3d twist = directions[static_cast<std::size_t>(least)].twist;
        if (const Weakest weak = weakest_at(f); weak.unsure)
            twist = weak.twist;
        else if (informed)
            return;
        const Held place = held(f, s, sigma, twist, telling_difference(s));
        if (std::abs(place.shift) < 0.1 * search.step_mm()) return;
        const Finish next =
            finish(moved_along(f.pose, twist, place.shift), std::max(2 * f.gate, smallest_gate()), 1, 30);
        const Support there = support(next, sigma, 1);
        if (there.cost >= s.cost) return;
        f = next;
        s = there;
    }
}

Registration ContourMatcher::match(const Profile& profile, const SearchWindow& window) const {
    const Impl& m = *impl_;
    m.iterations = 0;
    Registration result;
    if (!std::isfinite(window.dx_mm) || !std::isfinite(window.dz_mm) || !std::isfinite(window.phi_rad) ||
        !window.centre_mm.allFinite())
        return result;
    if (!m.gather(profile, window)) {
        result.status = RegistrationStatus::no_points;
        return result;
    }
    impl_->share_noise();
    m.search_places(window);
    result.status = RegistrationStatus::no_match;
    result.iterations = m.iterations;
    if (m.finishes.empty()) return result;

    // All against the same noise: that of the scene and the template, or what the best fitting place keeps.
    double sigma = m.noise_mm();
    const int support_stride = std::max(1, static_cast<int>(m.scene.x.size()) / 800);
    double kept = std::numeric_limits<double>::infinity();
    for (const Impl::Finish& f : m.finishes)
        if (m.support(f, sigma, support_stride).share >= kConvincingShare) kept = std::min(kept, f.sigma);
    if (std::isfinite(kept) && kept > kMisfit * sigma) sigma = kept;
    std::vector<Impl::Finish>& places = m.finishes;
    for (Impl::Finish& f : places) f.cost = m.support(f, sigma, support_stride).cost;
    std::sort(places.begin(), places.end(), [](const auto& a, const auto& b) { return a.cost < b.cost; });
    const double start_gate = 1.2 * m.search.step_mm();
    Impl::Finish f = m.finish(places[0].pose, std::max(2 * places[0].gate, m.smallest_gate()), 1, 30);
    Impl::Support s = m.support(f, sigma, 1);
    m.follow(f, s, sigma);
    // From a narrow gate it may have come to rest on a part of the points: once more from a wide one.
    if (f.sigma > kMisfit * m.noise_mm()) {
        const Impl::Finish wide = m.finish(f.pose, std::max(start_gate, kWideGate_mm), 1, 40);
        const Impl::Support there = m.support(wide, sigma, 1);
        if (there.cost < s.cost) f = wide, s = there;
    }
    result = m.conclude(f, s, sigma);
    if (result.status != RegistrationStatus::ok) return result;
    if (!m.within(window, f.pose)) {
        result.status = RegistrationStatus::no_match;
        return result;
    }
    const double told = Impl::telling_difference(s);
    int rivals = 0;
    for (std::size_t i = 1; i < places.size() && rivals < kMostRivals; ++i) {
        if (places[i].cost > 1.1 * places[0].cost + 2 * told) break;
        const double apart = std::max(m.search.step_mm(), 3 * f.gate);
        if (m.apart_mm(places[i].pose, f.pose) < apart) continue;
        ++rivals;
        // Both to their end: a start that was merely on its way is no second place.
        Impl::Finish other = m.finish(places[i].pose, start_gate, 1, 40);
        other.gate = f.gate;
        if (m.apart_mm(other.pose, f.pose) > apart && m.support(other, sigma, 1).cost < s.cost + told) {
            result.status = RegistrationStatus::ambiguous;
            return result;
        }
    }
    if (s.share >= kConvincingShare && s.least_informed() >= kConvincingInformation && s.missing < kComplete)
        return result;
    // Part of the template is missing. Where it is found better beyond the window, it is there and not here.
    SearchWindow wide = window;
    wide.dx_mm = 2.5 * window.dx_mm + 3;
    wide.dz_mm = 2.5 * window.dz_mm + 3;
    wide.phi_rad = std::min(1.25 * window.phi_rad + 0.03, kPi);
    if (!m.gather(profile, wide)) return result;
    m.search_places(wide);
    Impl::Finish better = f;
    Impl::Support best = s;
    for (const Impl::Finish& elsewhere : m.finishes) {
        if (m.support(elsewhere, sigma, support_stride).cost > s.cost / support_stride + told) continue;
        const Impl::Finish other = m.finish(elsewhere.pose, start_gate, 1, 40);
        const Impl::Support there = m.support(other, sigma, 1);
        if (there.cost >= best.cost) continue;
        better = other;
        best = there;
    }
    if (best.cost > s.cost - told) return result;
    m.follow(better, best, sigma);
    result = m.conclude(better, best, sigma);
    if (!m.within(window, better.pose)) result.status = RegistrationStatus::no_match;
    return result;
}

Registration ContourMatcher::refine(const Profile& profile, const PlanarMotion& start) const {
    const Impl& m = *impl_;
    m.iterations = 0;
    Registration result;
    const Eigen::Vector2d d = start * m.model.origin() - m.model.origin();
    if (!d.allFinite() || !std::isfinite(start.phi_rad)) return result;
    m.scene.gather(profile, m.model.origin(), d, m.model.extent_mm() + 3);
    if (m.scene.x.size() < static_cast<std::size_t>(kFewestRegistrationPoints)) {
        result.status = RegistrationStatus::no_points;
        return result;
    }
    const Impl::Finish f = m.finish(CentredPose(d.x(), d.y(), start.phi_rad), 1.5, 1, 40);
    return m.conclude(f, m.support(f, m.noise_mm(), 1), m.noise_mm());
}

void ContourMatcher::deviations(const Profile& profile, const PlanarMotion& scene_from_template,
                                double reach_mm, std::vector<ContourDeviation>& out) const {
    out.clear();
    const Impl& m = *impl_;
    const Eigen::Vector2d d = scene_from_template * m.model.origin() - m.model.origin();
    if (!d.allFinite() || !std::isfinite(scene_from_template.phi_rad)) return;
    m.scene.gather(profile, m.model.origin(), d, m.model.extent_mm() + reach_mm + 1);
    m.collect(CentredPose(d.x(), d.y(), scene_from_template.phi_rad), reach_mm, 1);
    for (const Impl::Match& match : m.matches) {
        const auto& edge = m.model.edges()[match.foot.edge];
        if (edge.wall) continue;
        const double s = m.arc[static_cast<std::size_t>(match.foot.edge)] + edge.half + match.foot.u;
        out.push_back({std::clamp(s / m.model.length_mm(), 0.0, 1.0), match.foot.residual});
    }
}

Eigen::Vector2d PlanarMotion::operator*(const Eigen::Vector2d& p) const {
    const double c = std::cos(phi_rad), s = std::sin(phi_rad);
    return {c * p.x() - s * p.y() + dx_mm, s * p.x() + c * p.y() + dz_mm};
}

std::string_view to_string(RegistrationStatus status) {
    switch (status) {
        case RegistrationStatus::ok:
            return "ok";
        case RegistrationStatus::no_points:
            return "no_points";
        case RegistrationStatus::no_match:
            return "no_match";
        case RegistrationStatus::ambiguous:
            return "ambiguous";
        case RegistrationStatus::sliding:
            return "sliding";
        case RegistrationStatus::other_shape:
            return "other_shape";
    }
    return "no_match";
}

}  // namespace seamwright