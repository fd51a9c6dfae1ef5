#include "core/alignment/pass_registration.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/alignment/contour_ends.h"
#include "core/correction/contour_fit.h"
#include "core/features/contour/contour_noise.h"
#include "core/median.h"

namespace seamwright::alignment {
namespace {

// A profile counts as the same contour when this share of the trigger's is found in it.
constexpr double kSmallestShare = 0.5;
// A profile noisier than this multiple of the pass's usual noise is not what the others are registered to.
constexpr double kNoisy = 1.5;
// A good one shows most of the contour in most of the profiles.
constexpr double kWholeShare = 0.85, kGoodShare = 0.8;
constexpr int kReferencesTried = 2;
// A profile within so much of its noise, and of its scatter along itself, is a straight line.
constexpr double kStraightNoise = 1.5, kStraightShare = 1e-6;
// Travels as near as these tell no motion from one to the next; it is followed ahead so many times their distance.
constexpr double kSameTravel_mm = 1e-9, kMostAhead = 2.0;
// Where a profile that was lost is searched for: to either side, more per mm of travel, and turned.
constexpr double kSearched_mm = 2.0, kSearchedPerTravel = 0.3, kSearched_rad = 0.1;
// What the others are registered to has so many of the usual points; where there is no noise, it may have this.
constexpr double kUsualPoints = 0.8, kQuiet_mm = 1e-6;
constexpr double kClearlyBetter = 1.02;

}  // namespace

bool usable(const Profile& p, std::size_t i) {
    return std::isfinite(p.x_mm[i]) && std::isfinite(p.z_mm[i]) &&
           !(p.filtered() && p.segment[i] == kOutlier);
}

namespace {

std::size_t usable_points(const Profile& p) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < p.size(); ++i) count += usable(p, i);
    return count;
}

}  // namespace

Eigen::Vector2d centroid(const Profile& p) {
    Eigen::Vector2d sum = Eigen::Vector2d::Zero();
    double count = 0;
    for (std::size_t i = 0; i < p.size(); ++i) {
        if (!usable(p, i)) continue;
        sum += Eigen::Vector2d(p.x_mm[i], p.z_mm[i]);
        count += 1;
    }
    return sum / std::max(1.0, count);
}

namespace {

// Direction of a profile that is a straight line within 1.5 times its noise; zero when it has a shape.
// Registration alone would read a shape into the noise of a long line.
Eigen::Vector2d straight_direction(const Profile& p) {
    std::vector<double> x, z, scratch;
    const Eigen::Vector2d middle = centroid(p);
    Eigen::Matrix2d moment = Eigen::Matrix2d::Zero();
    for (std::size_t i = 0; i < p.size(); ++i) {
        if (!usable(p, i)) continue;
        x.push_back(p.x_mm[i]);
        z.push_back(p.z_mm[i]);
        const Eigen::Vector2d d = Eigen::Vector2d(x.back(), z.back()) - middle;
        moment += d * d.transpose();
    }
    Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen;
    eigen.computeDirect(moment);
    const double rms = std::sqrt(std::max(0.0, eigen.eigenvalues()[0]) /
                                 static_cast<double>(std::max<std::size_t>(1, x.size())));
    const double noise = contour_noise_mm(x, z, scratch);
    if (rms > kStraightNoise * noise + kStraightShare * std::sqrt(eigen.eigenvalues()[1]))
        return Eigen::Vector2d::Zero();
    return eigen.eigenvectors().col(1);
}

// A registration is taken over when the contour was found and, for a straight one, only across it.
bool accept(const Registration& r, const Eigen::Vector2d& reference, const Eigen::Vector2d& straight,
            Registered& out) {
    // A contour that becomes another one while the robot travels is what is looked for here: found over almost all of
    // its length it counts, however little it fits there.
    const bool changed = r.status == RegistrationStatus::no_match && r.inlier_share >= kWholeShare;
    if ((r.status != RegistrationStatus::ok && r.status != RegistrationStatus::sliding &&
         r.status != RegistrationStatus::other_shape && !changed) ||
        r.inlier_share < kSmallestShare)
        return false;
    out.shift = r.scene_from_template * reference - reference;
    out.phi = r.scene_from_template.phi_rad;
    out.rms = r.rms_mm;
    out.share = r.inlier_share;
    out.sigma_mm = std::sqrt(std::max(r.covariance(0, 0), r.covariance(1, 1)));
    out.slides = r.status == RegistrationStatus::sliding ? r.sliding_direction : straight;
    out.shift -= out.slides * out.slides.dot(out.shift);
    out.ok = out.shift.allFinite() && std::isfinite(out.phi);
    return out.ok;
}

}  // namespace

PlanarMotion motion_of(const Registered& r, const Eigen::Vector2d& reference) {
    const double c = std::cos(r.phi), sn = std::sin(r.phi);
    const Eigen::Vector2d moved =
        reference + r.shift -
        Eigen::Vector2d(c * reference.x() - sn * reference.y(), sn * reference.x() + c * reference.y());
    return {moved.x(), moved.y(), r.phi};
}

namespace {

// From the trigger outwards, each profile starts where its inner neighbours point to.
void track(const ContourMatcher& matcher, std::span<const TravelProfile> pass,
           const std::vector<std::size_t>& outwards, const Eigen::Vector2d& reference,
           const Eigen::Vector2d& straight, std::vector<Registered>& out) {
    PlanarMotion last, before;
    double last_y = 0, before_y = 0;
    int known = 0;
    for (const std::size_t i : outwards) {
        if (usable_points(pass[i].profile) < static_cast<std::size_t>(kFewestProfiles)) continue;
        const double y = pass[i].travel_mm;
        PlanarMotion start = last;
        if (known >= 2 && std::abs(last_y - before_y) > kSameTravel_mm) {
            const double ahead = std::clamp((y - last_y) / (last_y - before_y), -kMostAhead, kMostAhead);
            start.dx_mm += ahead * (last.dx_mm - before.dx_mm);
            start.dz_mm += ahead * (last.dz_mm - before.dz_mm);
            start.phi_rad += ahead * (last.phi_rad - before.phi_rad);
        }
        Registration r = matcher.refine(pass[i].profile, start);
        if (!accept(r, reference, straight, out[i])) {
            SearchWindow window;
            window.dx_mm = window.dz_mm = kSearched_mm + kSearchedPerTravel * std::abs(y);
            window.phi_rad = kSearched_rad;
            window.centre_mm = last * reference - reference;
            r = matcher.match(pass[i].profile, window);
            if (!accept(r, reference, straight, out[i])) continue;
        }
        before = last;
        before_y = last_y;
        last = motion_of(out[i], reference);
        last_y = y;
        ++known;
    }
}

double noise_of(const Profile& p) {
    std::vector<double> x, z, scratch;
    for (std::size_t i = 0; i < p.size(); ++i)
        if (usable(p, i)) {
            x.push_back(p.x_mm[i]);
            z.push_back(p.z_mm[i]);
        }
    return contour_noise_mm(x, z, scratch);
}

Reference register_to(std::size_t index, ContourMatcher matcher, std::span<const TravelProfile> pass,
                      const std::vector<std::size_t>& order, const Eigen::Vector2d& reference) {
    Reference r{index, std::move(matcher), std::vector<Registered>(pass.size()), 0, false};
    const Eigen::Vector2d straight = straight_direction(pass[index].profile);
    const double y0 = pass[index].travel_mm;
    for (const bool forward : {true, false}) {
        std::vector<std::size_t> outwards;
        for (const std::size_t i : order)
            if (i != index && (pass[i].travel_mm >= y0) == forward) outwards.push_back(i);
        std::stable_sort(outwards.begin(), outwards.end(), [&](auto a, auto b) {
            return std::abs(pass[a].travel_mm - y0) < std::abs(pass[b].travel_mm - y0);
        });
        track(r.matcher, pass, outwards, reference, straight, r.found);
    }
    double whole = 0;
    for (const Registered& f : r.found) {
        if (!f.ok) continue;
        r.quality += f.share * (f.slides.isZero() ? 1.0 : 0.5);
        whole += f.slides.isZero() && f.share > kWholeShare;
    }
    r.good = whole >= kGoodShare * static_cast<double>(order.size() - 1);
    return r;
}

}  // namespace

std::optional<Reference> choose_reference(std::span<const TravelProfile> pass,
                                          const std::vector<std::size_t>& order,
                                          const std::optional<Eigen::Vector2d>& point) {
    std::vector<double> counts, noises;
    for (const std::size_t i : order) {
        counts.push_back(static_cast<double>(usable_points(pass[i].profile)));
        noises.push_back(noise_of(pass[i].profile));
    }
    std::vector<double> by_size = counts, by_noise = noises;
    const double usual = median(by_size), quiet = median(by_noise);
    std::optional<Reference> best;
    int tried = 0;
    for (std::size_t k = 0; k < order.size() && tried < kReferencesTried; ++k) {
        const std::size_t i = order[k];
        if (counts[k] < kUsualPoints * usual || noises[k] > kNoisy * quiet + kQuiet_mm) continue;
        const Eigen::Vector2d reference = point ? *point : centroid(pass[i].profile);
        auto made = ContourMatcher::make(pass[i].profile, reference);
        if (!made) continue;
        ++tried;
        Reference r = register_to(i, std::move(*made), pass, order, reference);
        if (!best || r.quality > kClearlyBetter * best->quality || (r.good && !best->good))
            best.emplace(std::move(r));
        if (best->good) break;
    }
    return best;
}

// Of a straight line through the values, where it is beyond its noise; else 0.
double sure_slope(const std::vector<double>& travel, const std::vector<double>& value) {
    constexpr double kSure = 4;  // sigmas
    if (travel.size() < static_cast<std::size_t>(kFewestProfiles)) return 0;
    const PolynomialFit fit = fit_polynomial(travel, value, 1);
    return fit.ok && std::abs(fit.coefficient[1]) > kSure * fit.coefficient_sigma[1] ? fit.coefficient[1] : 0;
}

std::optional<Reference> register_piece(const Reference& reference, std::span<const TravelProfile> pass,
                                        const std::vector<std::size_t>& order, const Eigen::Vector2d& point,
                                        double within_mm) {
    constexpr std::size_t kFewestPoints = 20;
    const Profile& whole = pass[reference.index].profile;
    // What is near the point may be on either side of a break.
    const std::vector<Break> breaks = std::isfinite(within_mm) ? std::vector<Break>{} : breaks_of(whole);
    std::size_t first = 0, last = 0;
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k <= breaks.size(); ++k) {
        const std::size_t from = k == 0 ? 0 : breaks[k - 1].index;
        const std::size_t to = k == breaks.size() ? whole.size() : breaks[k].index;
        for (std::size_t i = from; i < to; ++i) {
            if (!usable(whole, i)) continue;
            const double off = (Eigen::Vector2d(whole.x_mm[i], whole.z_mm[i]) - point).norm();
            if (off >= nearest) continue;
            nearest = off;
            first = from, last = to;
        }
    }
    Profile piece;
    for (std::size_t i = first; i < last; ++i) {
        const Eigen::Vector2d p(whole.x_mm[i], whole.z_mm[i]);
        if (!usable(whole, i) || (p - point).norm() > within_mm) continue;
        piece.x_mm.push_back(p.x());
        piece.z_mm.push_back(p.y());
    }
    if (piece.size() == usable_points(whole) || piece.size() < kFewestPoints ||
        !straight_direction(piece).isZero())
        return std::nullopt;
    auto matcher = ContourMatcher::make(piece, point);
    if (!matcher) return std::nullopt;
    Reference r = register_to(reference.index, std::move(*matcher), pass, order, point);
    if (!r.good) return std::nullopt;
    for (Registered& f : r.found) f.ok = f.ok && f.slides.isZero();
    return r;
}

double growth_mm(const Reference& reference, std::span<const TravelProfile> pass,
                 const Eigen::Vector2d& point, double jitter_mm) {
    constexpr int kPieces = 12;
    constexpr std::size_t kFewestInPiece = 4;
    std::array<std::vector<double>, kPieces> travel, middle, piece;
    std::vector<ContourDeviation> deviations;
    for (std::size_t i = 0; i < pass.size(); ++i) {
        const Registered& f = reference.found[i];
        if (!f.ok) continue;
        reference.matcher.deviations(pass[i].profile, motion_of(f, point), kReach_mm, deviations);
        for (auto& p : piece) p.clear();
        for (const ContourDeviation& d : deviations)
            piece[static_cast<std::size_t>(std::min(d.along * kPieces, kPieces - 1.0))].push_back(
                d.across_mm);
        for (std::size_t k = 0; k < kPieces; ++k) {
            if (piece[k].size() < kFewestInPiece) continue;
            travel[k].push_back(pass[i].travel_mm);
            middle[k].push_back(median(piece[k]));
        }
    }
    double up = 0, down = 0;
    for (std::size_t k = 0; k < kPieces; ++k) {
        const double slope = sure_slope(travel[k], middle[k]);
        up = std::max(up, slope);
        down = std::min(down, slope);
    }
    return (up - down) * jitter_mm;
}

}  // namespace seamwright::alignment
