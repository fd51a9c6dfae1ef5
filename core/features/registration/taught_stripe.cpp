#include "core/features/registration/taught_stripe.h"

#include <algorithm>
#include <cmath>

namespace seamwright {
namespace {

constexpr int kFewestLines = 24;       // of a contour: fewer are single false peaks
constexpr double kReachSigmas = 6;     // of a point to the contour that it lies on
constexpr double kSpread = 2;          // lines and points on either side, over which a missing return is none
constexpr double kLeastShare = 0.25;   // of the taught contour, that a place rests on
constexpr double kShareLost = 0.02;    // of the contour, that what is told may show less
constexpr double kLeastMargin = 0.06;  // of what it explains, by which the right place explains more,
constexpr double kMostlyAtOdds = 0.5;  // where two take different candidates on so many of the lines
// Lines and points of the contour, by which another place than the tracked profile's own has to be better.
constexpr double kBetter = 12;
constexpr int kAround = 8;            // lines on either side, of which ..
constexpr double kShareAround = 0.5;  // .. so many show the contour, where a line shows a reflection alone

bool usable(const Registration& r) {
    return r.status != RegistrationStatus::no_points && r.inlier_share > kLeastShare &&
           std::isfinite(r.scene_from_template.dx_mm) && std::isfinite(r.scene_from_template.dz_mm) &&
           std::isfinite(r.scene_from_template.phi_rad);
}

std::size_t slot(const ProfileCandidates& c, int line, int k) {
    return static_cast<std::size_t>(c.index(line, k));
}

}  // namespace

Expected<TaughtStripe> TaughtStripe::make(const Profile& contour, const Eigen::Vector2d& reference_mm,
                                          const SearchWindow& window) {
    SEAM_TRY(auto matcher, ContourMatcher::make(contour, reference_mm));
    TaughtStripe taught(std::move(matcher), window);
    taught.model_.build(contour);
    return taught;
}

// What the tracked profile leaves, tracked in its turn, and both together. False where that is no contour.
bool TaughtStripe::second_contour(const ProfileCandidates& candidates, const FilterOptions& options,
                                  const Profile& profile) {
    const auto left = [&](int line, int k) {
        const auto at = static_cast<std::size_t>(line);
        return profile.segment[at] == kOutlier ||
               candidates.x_mm[slot(candidates, line, k)] != profile.x_mm[at] ||
               candidates.z_mm[slot(candidates, line, k)] != profile.z_mm[at];
    };
    rest_ = candidates;
    int lines = 0;
    for (int line = 0; line < candidates.lines; ++line) {
        const auto at = static_cast<std::size_t>(line);
        std::uint8_t kept = 0;
        for (int k = 0; k < candidates.count[at]; ++k) {
            if (!left(line, k)) continue;
            const std::size_t from = slot(candidates, line, k), to = slot(candidates, line, kept++);
            rest_.x_mm[to] = candidates.x_mm[from], rest_.z_mm[to] = candidates.z_mm[from];
            if (!candidates.intensity.empty()) rest_.intensity[to] = candidates.intensity[from];
        }
        rest_.count[at] = kept;
        lines += kept > 0;
    }
    if (lines < kFewestLines || !track_stripe(rest_, options, rival_)) return false;
    // One after the other: neighbours are then neighbours on a contour.
    both_.clear();
    for (const Profile* p : {&profile, static_cast<const Profile*>(&rival_)})
        for (std::size_t i = 0; i < p->size(); ++i) {
            if (p->segment[i] == kOutlier) continue;
            both_.x_mm.push_back(p->x_mm[i]), both_.z_mm.push_back(p->z_mm[i]);
        }
    return std::count_if(rival_.segment.begin(), rival_.segment.end(),
                         [](auto s) { return s != kOutlier; }) >= kFewestLines;
}

// A place more, where the scene shows one; the share of the contour that it rests on.
double TaughtStripe::look_for(const Profile& scene) {
    const Registration r = matcher_.match(scene, window_);
    if (!usable(r)) return 0;
    Place& place = places_[found_++];
    place.scene_from_taught = r.scene_from_template;
    place.ambiguous = r.status == RegistrationStatus::ambiguous;
    if (r.noise_mm > 0) noise_mm_ = std::min(noise_mm_, r.noise_mm);
    return r.inlier_share;
}

// The best of the neighbours on both sides, as far as `reach` along.
void TaughtStripe::spread(std::vector<float>& quality, std::span<const double> along, double reach) {
    spread_.assign(quality.size(), 0);
    std::size_t from = 0;
    for (std::size_t i = 0; i < quality.size(); ++i) {
        while (along[i] - along[from] > reach) ++from;
        for (std::size_t j = from; j < quality.size() && along[j] - along[i] <= reach; ++j)
            spread_[i] = std::max(spread_[i], quality[j]);
    }
    quality.swap(spread_);
}

// Which candidates lie on the taught contour at the place, and what speaks for it: how much of the contour they show, in
// points of the scene, and on how many lines.
void TaughtStripe::look_at(const ProfileCandidates& candidates, Place& place) {
    const PlanarMotion& m = place.scene_from_taught;
    const double c = std::cos(m.phi_rad), s = std::sin(m.phi_rad);
    const double reach = kReachSigmas * noise_mm_;
    const auto& edges = model_.edges();
    place.on_contour.assign(candidates.x_mm.size(), 0);
    of_edge_.assign(edges.size(), 0);
    of_line_.assign(static_cast<std::size_t>(candidates.lines), 0);
    double lowest = std::numeric_limits<double>::infinity(), highest = -lowest, previous = 0, pitch = 0;
    int lines = 0;
    for (int line = 0; line < candidates.lines; ++line)
        for (int k = 0; k < candidates.count[static_cast<std::size_t>(line)]; ++k) {
            const std::size_t at = slot(candidates, line, k);
            const double x = candidates.x_mm[at], z = candidates.z_mm[at];
            if (!std::isfinite(x) || !std::isfinite(z)) continue;
            if (k == 0) {
                if (lines++ > 0) pitch += std::abs(x - previous);
                previous = x;
            }
            lowest = std::min(lowest, x), highest = std::max(highest, x);
            const double dx = x - m.dx_mm, dz = z - m.dz_mm;
            const auto foot = model_.nearest(c * dx + s * dz - model_.origin().x(),
                                             -s * dx + c * dz - model_.origin().y(), reach);
            if (foot.edge < 0) continue;
            place.on_contour[at] = 1;
            const auto near = static_cast<float>(1 - std::pow(foot.residual / reach, 2));
            auto& edge = of_edge_[static_cast<std::size_t>(foot.edge)];
            auto& here = of_line_[static_cast<std::size_t>(line)];
            edge = std::max(edge, near), here = std::max(here, near);
        }
    pitch /= std::max(1, lines - 1);
    along_.resize(of_line_.size());
    for (std::size_t i = 0; i < along_.size(); ++i) along_[i] = static_cast<double>(i);
    spread(of_line_, along_, kSpread);
    along_.resize(edges.size());
    double length = 0;
    for (std::size_t e = 0; e < edges.size(); ++e) {
        along_[e] = length + edges[e].half;
        length += 2 * edges[e].half;
    }
    spread(of_edge_, along_, kSpread * std::max(pitch, model_.pitch().along_x));
    place.seen = 0, place.lines = 0;
    for (const float q : of_line_) {
        place.seen += static_cast<double>(q);
        place.lines += q > 0;
    }
    for (std::size_t e = 0; e < edges.size(); ++e) {
        const auto& edge = edges[e];
        const double x = c * (edge.cx + model_.origin().x()) - s * (edge.cz + model_.origin().y()) + m.dx_mm;
        if (edge.wall || x < lowest || x > highest || !(pitch > 0)) continue;
        place.seen += static_cast<double>(of_edge_[e]) * 2 * edge.half / pitch;
    }
}

// False where the tracked profile is what the place tells.
bool TaughtStripe::tell(const ProfileCandidates& candidates, const Place& place, const Profile& profile) {
    known_.assign(candidates.x_mm.size(), 0);
    std::vector<char>& shows = shows_;
    shows.assign(static_cast<std::size_t>(candidates.lines), 0);
    for (int line = 0; line < candidates.lines; ++line)
        for (int k = 0; k < candidates.count[static_cast<std::size_t>(line)]; ++k)
            shows[static_cast<std::size_t>(line)] |= place.on_contour[slot(candidates, line, k)];
    bool other = false;
    int around = 0, width = 0;
    const auto shown = [&](int line) {
        return line >= 0 && line < candidates.lines ? int(shows[static_cast<std::size_t>(line)]) : 0;
    };
    for (int line = -kAround; line < kAround; ++line) around += shown(line);
    width = 2 * kAround + 1;
    for (int line = 0; line < candidates.lines; ++line) {
        around += shown(line + kAround) - shown(line - kAround - 1);
        const auto at = static_cast<std::size_t>(line);
        const bool contour_here = shows[at] != 0 || around >= kShareAround * width;
        for (int k = 0; k < candidates.count[at]; ++k) {
            const std::size_t i = slot(candidates, line, k);
            if (place.on_contour[i])
                known_[i] = 1;
            else if (contour_here)
                known_[i] = -1;
            other |= known_[i] < 0 && profile.segment[at] != kOutlier &&
                     candidates.x_mm[i] == profile.x_mm[at] && candidates.z_mm[i] == profile.z_mm[at];
        }
    }
    return other;
}

Expected<StripeChoice> TaughtStripe::track(const ProfileCandidates& candidates, const FilterOptions& options,
                                           Profile& profile) {
    SEAM_OK(track_stripe(candidates, options, profile));
    if (!second_contour(candidates, options, profile)) return StripeChoice::plain;
    found_ = 0;
    noise_mm_ = std::numeric_limits<double>::infinity();
    const double share = look_for(profile);
    look_for(rival_), look_for(both_);
    if (found_ == 0 || !std::isfinite(noise_mm_)) return StripeChoice::plain;
    const std::span places(places_.data(), found_);
    for (Place& place : places) look_at(candidates, place);
    // The tracked profile's own where no other one shows more.
    std::size_t chosen = 0;
    for (std::size_t k = 1; k < found_; ++k)
        if (places[k].seen > places[chosen].seen + (chosen == 0 ? kBetter : 0)) chosen = k;
    const Place& best = places[chosen];
    // Lines on which two places take different candidates for the contour.
    const auto at_odds = [&](const Place& other) {
        int lines = 0;
        for (int line = 0; line < candidates.lines; ++line) {
            bool one = false, two = false, common = false;
            for (int k = 0; k < candidates.count[static_cast<std::size_t>(line)]; ++k) {
                const std::size_t i = slot(candidates, line, k);
                one |= best.on_contour[i] != 0, two |= other.on_contour[i] != 0;
                common |= best.on_contour[i] && other.on_contour[i];
            }
            lines += one && two && !common;
        }
        return lines;
    };
    for (const Place& other : places)
        if (&other != &best && best.seen - other.seen < kLeastMargin * best.seen &&
            at_odds(other) >= std::max<double>(kFewestLines, kMostlyAtOdds * best.lines))
            return StripeChoice::undecided;
    if (best.ambiguous && &best != &places[0]) return StripeChoice::undecided;
    if (!tell(candidates, best, profile)) return StripeChoice::plain;
    SEAM_OK(track_stripe(candidates, options, told_, known_));
    // What is told shows the contour at least as well, or nothing was told.
    if (matcher_.match(told_, window_).inlier_share < share - kShareLost) return StripeChoice::plain;
    std::swap(profile, told_);
    return StripeChoice::told;
}

}  // namespace seamwright
