// Circle: the centre of a round piece of contour (a bead, a pin, a fixed sphere), robust against the rest of
// it.
//
// Start: circles through three points at growing distances along the contour, the one with the most points within the
// noise of its rim wins (fixed places, so the answer is always the same); only circles of allowed radius whose points
// span minimum_arc_deg compete, since a straight fits any large circle. Then the sum of squared distances from the
// rim is minimised (Gauss-Newton; the algebraic fit is biased to small radii on short arcs) over the points within
// 3.5 robust sigma, until the set stands still. With a known radius only the centre is fitted. Then once more
// together with the straights that run tangentially into the arc, if any do (arc_fit.h): their first points lie
// within the noise of the rim, and taken for a part of it they make it flatter.
//
// Covariance: sigma^2 (J^T J)^-1 of the centre, sigma from the residuals and the profile's noise, widened where neighbours
// are alike (contour_noise.h). On a short arc the centre is hardly determined along the arc's bisector (with a free radius
// the variance grows with the inverse fourth power of the arc): below minimum_arc_deg, or when the centre's sigma exceeds a
// tenth of the radius, the answer is ill_conditioned.
//
// A large circle may lie within the noise of a small rim and of what runs into it, with more points than the rim has. So every
// piece that a circle of less than half the radius (another shape, no mere error of form) fits much better than the answer,
// though the answer takes most of it for its own rim, is a rival: ambiguous.

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/features/contour/contour_noise.h"
#include "core/features/feature_points.h"
#include "core/features/kinds/arc_fit.h"
#include "core/features/kinds/feature_kinds.h"
#include "core/geometry/pose.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

constexpr int kFewestOnArc = 6;
constexpr double kCircleGate = 3.5, kCircleGateMore = 1.05;  // robust sigma; and by how much wider it stands
constexpr double kCircleLeastTolerance_mm = 1e-6, kCircleLeastGate_mm = 1e-9;  // where there is no noise
// Of the known radius: between these a circle through three points is one of it.
constexpr double kCircleSmaller = 0.7, kCircleLarger = 1.4;
constexpr double kCircleShortRow = 0.15;  // of the longest row: a straight that crosses the rim
constexpr double kCircleRowEnd = 0.06;    // of a row, that it loses where the contour goes on
constexpr double kCircleStep = 0.3;       // of the radius, at most
constexpr double kCircleSettled = 1e-9;   // of 1 mm and the radius
constexpr double kCircleUncertain = 0.1;  // of the radius: the centre's sigma from which the arc is too short
// A rival's radius in that of the answer, its points in the answer's and how many of them the answer has.
constexpr double kRivalRadius = 0.5, kRivalShare = 0.08, kRivalOwned = 0.7;
// The answer's chi-squared on the rival's points less the rival's, and of the latter. A best of some hundred places and three
// unknowns reaches 20 by chance.
constexpr double kRivalGain = 30, kRivalGainShare = 0.5;
constexpr double kRivalMisfit = 1.15;  // rms over the noise, below which the answer explains its points

std::vector<ParameterInfo> circle_parameters() {
    return with_window({
        {"radius_mm", "mm", 0, 1e5, 0, 3, "The radius when it is known; 0 fits it."},
        {"radius_min_mm", "mm", 0, 1e5, 0.2, 3, "Free radius: the smallest that is accepted."},
        {"radius_max_mm", "mm", 0, 1e5, 500, 3, "Free radius: the largest that is accepted."},
        {"minimum_arc_deg", "deg", 1, 360, 25, 1, "The least arc that must be seen."},
    });
}

class CircleFinder final : public FeatureFinder {
  public:
    CircleFinder(FeatureWindow window, double known, double smallest, double largest, double arc)
        : window_(window), known_(known), smallest_(smallest), largest_(largest), minimum_arc_(arc) {}

    Feature find(const Profile& profile) const override {
        Feature feature;
        points_.gather(profile, window_);
        const int n = static_cast<int>(points_.x.size());
        if (n < kFewestOnArc) {
            feature.status = FeatureStatus::no_points;
            feature.message = Text("{} points in the window, a circle needs {}", n, kFewestOnArc);
            return feature;
        }
        Circle begun;
        double arc = 0;
        if (!start(begun, arc)) {
            feature.message = "no round piece of contour in the window";
            return feature;
        }
        const ProfileNoise noise = points_.noise(SharedOver::many);
        Circle circle = begun;
        const Feature alone = refine(feature, circle, noise);
        return without_rival(with_straights(alone, begun, circle, noise), noise);
    }

  private:
    bool through(int i, int j, int k, Circle& circle) const {
        const Eigen::Vector2d a(points_.x[i], points_.z[i]);
        const Eigen::Vector2d b = Eigen::Vector2d(points_.x[j], points_.z[j]) - a;
        const Eigen::Vector2d c = Eigen::Vector2d(points_.x[k], points_.z[k]) - a;
        constexpr double kStraight = 1e-12;
        const double cross = 2 * (b.x() * c.y() - b.y() * c.x());
        if (!(std::abs(cross) > kStraight * (b.squaredNorm() + c.squaredNorm()))) return false;
        const double bb = b.squaredNorm(), cc = c.squaredNorm();
        const Eigen::Vector2d centre((c.y() * bb - b.y() * cc) / cross, (b.x() * cc - c.x() * bb) / cross);
        circle.centre = a + centre;
        circle.radius = centre.norm();
        if (known_ > 0) {
            if (circle.radius < kCircleSmaller * known_ || circle.radius > kCircleLarger * known_)
                return false;
            // Keep the middle of the arc and put the centre at the known distance from it.
            const Eigen::Vector2d m(points_.x[j], points_.z[j]);
            circle.centre = m + (circle.centre - m) * (known_ / circle.radius);
            circle.radius = known_;
            return true;
        }
        return circle.radius >= smallest_ && circle.radius <= largest_;
    }

    // The longest row of points within `tolerance` of the rim, in contour order; a few misses in between are
    // dirt or missing returns. Returns its number of points and the angle that it spans.
    int longest_run(const Circle& circle, double tolerance, double& arc, int* from = nullptr,
                    int* to = nullptr) const {
        constexpr int kMisses = 6;
        const int n = static_cast<int>(points_.x.size());
        int best = 0, count = 0, misses = 0, begin = 0;
        double turned = 0, best_turned = 0, last = 0;
        for (int i = 0; i < n; ++i) {
            const double dx = points_.x[i] - circle.centre.x(), dz = points_.z[i] - circle.centre.y();
            const double low = std::max(0.0, circle.radius - tolerance), high = circle.radius + tolerance;
            const double r2 = dx * dx + dz * dz;
            if (r2 < low * low || r2 > high * high) {
                if (count > 0 && ++misses > kMisses) count = 0;
                continue;
            }
            const double angle = std::atan2(dz, dx);
            if (count == 0) {
                turned = 0;
                begin = i;
            } else {
                turned += std::abs(std::remainder(angle - last, 2 * kPi));
            }
            last = angle;
            misses = 0;
            ++count;
            if (count > best) {
                best = count;
                best_turned = turned;
                if (from) *from = begin, *to = i;
            }
        }
        arc = std::min(best_turned, 2 * kPi);
        return best;
    }

    struct Piece {
        Circle circle;
        int from = 0, to = 0, count = 0;
    };

    bool start(Circle& best, double& best_arc) const {
        pieces_.clear();
        const int n = static_cast<int>(points_.x.size());
        const double noise = contour_noise_mm(points_.x, points_.z, scratch_);
        const double tolerance = std::max(3 * noise, kCircleLeastTolerance_mm);
        int best_count = 0, best_any = 0;
        Circle any;
        const auto try_circle = [&](const Circle& c) {
            double arc = 0;
            int from = 0, to = 0;
            const int count = longest_run(c, tolerance, arc, &from, &to);
            if (count < kFewestOnArc) return;
            if (arc >= minimum_arc_) {
                pieces_.push_back({c, from, to, count});
                if (count > best_count) {
                    best_count = count;
                    best = c;
                    best_arc = arc;
                }
            } else if (count > best_any) {
                best_any = count;
                any = c;
            }
        };
        // Of the contour, from the first to the last of the three points.
        static constexpr double kShares[] = {1, 0.6, 0.35, 0.2, 0.1, 0.05, 0.025};
        constexpr double kMostPlaces = 96;
        Circle c;
        for (const double share : kShares) {
            const int span = std::max(kFewestOnArc - 1, static_cast<int>(share * (n - 1)));
            if (span > n - 1) continue;
            const int places = static_cast<int>(std::min(kMostPlaces, 3 / share));
            for (int p = 0; p < places; ++p) {
                const int i = places > 1 ? (n - 1 - span) * p / (places - 1) : 0;
                if (through(i, i + span / 2, i + span, c)) try_circle(c);
                if (through(i + span / 8, i + (5 * span) / 8, i + span - span / 8, c)) try_circle(c);
                if (share == 1.0 && p > 0) break;
            }
        }
        if (best_count > 0) return true;
        // Something round, but not enough of it: the refinement will say how badly it is determined.
        if (best_any < std::max(kFewestOnArc, n / 3)) return false;
        best = any;
        return true;
    }

    // Straights that cross the rim leave short rows, and where a straight joins the arc its first points
    // still lie within the noise, all on one side: short rows go, long ones lose their ends where the contour
    // goes on.
    void trim_rows() const {
        const int n = static_cast<int>(keep_.size());
        constexpr int kMisses = 6;
        int longest = 0;
        rows_.clear();
        for (int i = 0; i < n; ++i) {
            if (!keep_[i]) continue;
            if (rows_.empty() || i - rows_.back()[1] > kMisses) rows_.push_back({i, i, 0});
            rows_.back()[1] = i;
            longest = std::max(longest, ++rows_.back()[2]);
        }
        for (const auto& row : rows_) {
            const int cut = row[2] < kCircleShortRow * longest
                                ? row[2]
                                : std::max(2, static_cast<int>(kCircleRowEnd * row[2]));
            const bool ends_before = row[0] == 0, ends_after = row[1] == n - 1;
            if (cut == row[2]) {
                for (int i = row[0]; i <= row[1]; ++i) keep_[i] = 0;
                continue;
            }
            for (int i = row[0]; !ends_before && i < row[0] + cut; ++i) keep_[i] = 0;
            for (int i = row[1]; !ends_after && i > row[1] - cut; --i) keep_[i] = 0;
        }
    }

    Feature refine(Feature feature, Circle& circle, const ProfileNoise& noise) const {
        const int n = static_cast<int>(points_.x.size());
        const int unknowns = known_ > 0 ? 2 : 3;
        keep_.assign(static_cast<std::size_t>(n), 0);
        double gate = 0;
        Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
        double rss = 0;
        int used = 0;
        for (int round = 0; round < 30; ++round) {
            // The set is chosen while it still moves much; then it stays, so that the end is a true minimum.
            if (round < 12) {
                scratch_.clear();
                const double first =
                    std::max(6 * contour_noise_mm(points_.x, points_.z, scratch_), kCircleLeastTolerance_mm);
                if (round == 0) gate = first;
                scratch_.clear();
                for (int i = 0; i < n; ++i) {
                    const double d = std::abs(circle.distance(points_.x[i], points_.z[i]));
                    if (d <= gate) scratch_.push_back(d);
                }
                if (scratch_.size() < kFewestOnArc) break;
                const auto middle = scratch_.begin() + static_cast<std::ptrdiff_t>(scratch_.size() / 2);
                std::nth_element(scratch_.begin(), middle, scratch_.end());
                gate = std::max(std::min(kCircleGate * kMadToSigma * *middle * kCircleGateMore, first),
                                kCircleLeastGate_mm);
                for (int i = 0; i < n; ++i)
                    keep_[i] = std::abs(circle.distance(points_.x[i], points_.z[i])) <= gate;
                trim_rows();
            }
            normal.setZero();
            Eigen::Vector3d gradient = Eigen::Vector3d::Zero();
            rss = 0;
            used = 0;
            for (int i = 0; i < n; ++i) {
                if (!keep_[i]) continue;
                const double dx = points_.x[i] - circle.centre.x(), dz = points_.z[i] - circle.centre.y();
                const double rho = std::hypot(dx, dz);
                if (!(rho > 0)) continue;
                const Eigen::Vector3d row(-dx / rho, -dz / rho, known_ > 0 ? 0 : -1);
                const double e = rho - circle.radius;
                normal += row * row.transpose();
                gradient += e * row;
                rss += e * e;
                ++used;
            }
            if (used < kFewestOnArc) break;
            if (known_ > 0) normal(2, 2) = 1;
            const Eigen::Vector3d step = -normal.ldlt().solve(gradient);
            if (!step.allFinite()) break;
            const double most = kCircleStep * circle.radius;
            const double size = step.norm();
            const double scale = size > most ? most / size : 1;
            circle.centre += scale * step.head<2>();
            if (known_ <= 0) circle.radius += scale * step.z();
            if (round >= 12 && size < kCircleSettled * (1 + circle.radius)) break;
        }
        feature.points_used = used;
        if (used < kFewestOnArc || !circle.centre.allFinite()) {
            feature.status = FeatureStatus::not_found;
            feature.message = "no round piece of contour in the window";
            return feature;
        }
        scratch_.clear();
        for (int i = 0; i < n; ++i)
            if (keep_[i]) scratch_.push_back(circle.distance(points_.x[i], points_.z[i]));
        const int freedom = std::max(1, used - unknowns);
        const PooledSigma pooled = pooled_sigma(std::sqrt(rss / freedom), freedom, noise);
        const double sigma2 =
            pooled.sigma_mm * pooled.sigma_mm * pooled.widening * alike_widening(scratch_, unknowns, noise);
        feature.rms_mm = std::sqrt(rss / used);
        const Eigen::Matrix3d covariance = sigma2 * normal.ldlt().solve(Eigen::Matrix3d::Identity());
        feature.covariance_mm2 = covariance.topLeftCorner<2, 2>();
        double arc = 0;
        longest_run(circle, std::max(gate, kCircleLeastGate_mm), arc);
        return judged(feature, circle, arc, feature.covariance_mm2);
    }

    Feature judged(Feature feature, const Circle& circle, double arc,
                   const Eigen::Matrix2d& covariance) const {
        answer_ = circle;
        feature.point_mm = circle.centre;
        if (known_ <= 0 && (circle.radius < smallest_ || circle.radius > largest_)) {
            feature.status = FeatureStatus::not_found;
            feature.message = Text("the radius of {:.3g} mm is not within the limits", circle.radius);
            return feature;
        }
        Eigen::SelfAdjointEigenSolver<Eigen::Matrix2d> eigen;
        eigen.computeDirect(covariance);
        const double worst = std::sqrt(std::max(0.0, eigen.eigenvalues()[1]));
        if (arc < minimum_arc_ || !(worst < kCircleUncertain * circle.radius)) {
            feature.status = FeatureStatus::ill_conditioned;
            feature.message =
                Text("the arc of {:.0f} degrees is too short: the centre is uncertain by {:.2g} mm",
                     deg_from_rad(arc), worst);
            return feature;
        }
        feature.status = FeatureStatus::ok;
        return feature;
    }

    // The same arc and the straights beside it, where there are such. `circle` may have slid off the arc on to a straight:
    // then from where it began.
    Feature with_straights(const Feature& alone, const Circle& begun, const Circle& circle,
                           const ProfileNoise& noise) const {
        const double tolerance =
            std::max(3 * contour_noise_mm(points_.x, points_.z, scratch_), kCircleLeastTolerance_mm);
        ArcPlace place{circle, 0, 0, 0, 0};
        double arc = 0;
        longest_run(circle, tolerance, arc, &place.first, &place.last);
        if (alone.status == FeatureStatus::not_found || arc < minimum_arc_) {
            place.circle = begun;
            longest_run(begun, tolerance, arc, &place.first, &place.last);
        }
        place.from = place.first;
        place.to = place.last;
        for (const auto& piece : points_.pieces) {
            const int last = piece.first + piece.count - 1;
            if (place.first >= piece.first && place.first <= last) place.from = piece.first;
            if (place.last >= piece.first && place.last <= last) place.to = last;
        }
        FittedArc fitted;
        if (arc < minimum_arc_ || !arc_.fit(points_.x, points_.z, place, known_ > 0, noise, fitted))
            return alone;
        Feature feature;
        feature.covariance_mm2 = fitted.covariance;
        feature.rms_mm = fitted.rms;
        feature.points_used = fitted.used;
        return judged(feature, fitted.circle, fitted.arc, fitted.within);
    }

    // An ok answer that misses its points by more than their noise, and has a rival, is ambiguous.
    Feature without_rival(Feature feature, const ProfileNoise& noise) const {
        if (feature.status != FeatureStatus::ok || known_ > 0) return feature;
        const Circle& circle = answer_;
        const double sigma = std::max({noise.point_mm, noise.alone_mm, kCircleLeastGate_mm});
        const double apart = std::max(1.0, noise.apart());
        // Of neighbours that share their noise the profile tells it too small.
        if (feature.rms_mm < kRivalMisfit * std::sqrt(std::min(apart, 3.0)) * sigma) return feature;
        const double least = kRivalGain * sigma * sigma * apart;
        const double gate = kCircleGate * feature.rms_mm;
        const Piece* worst = nullptr;
        double most = 0;
        for (const Piece& piece : pieces_) {
            if (piece.circle.radius > kRivalRadius * circle.radius || piece.count < 2 * kFewestOnArc ||
                piece.count < kRivalShare * feature.points_used)
                continue;
            int owned = 0;
            double of_answer = 0, of_piece = 0;
            for (int i = piece.from; i <= piece.to; ++i) {
                const double d = circle.distance(points_.x[i], points_.z[i]);
                if (std::abs(d) > gate) continue;
                ++owned;
                of_answer += d * d;
                of_piece += std::pow(piece.circle.distance(points_.x[i], points_.z[i]), 2);
            }
            const double gain = of_answer - of_piece;
            if (owned < kRivalOwned * piece.count || gain < least || gain < kRivalGainShare * of_answer ||
                gain < most)
                continue;
            most = gain;
            worst = &piece;
        }
        if (!worst) return feature;
        feature.status = FeatureStatus::ambiguous;
        feature.message = Text(
            "a circle of {:.3g} mm fits the most points, one of {:.3g} mm fits a part of them much better: "
            "limit the "
            "radius",
            circle.radius, worst->circle.radius);
        feature.rivals_mm = {circle.centre, worst->circle.centre};
        return feature;
    }

    FeatureWindow window_;
    double known_, smallest_, largest_, minimum_arc_;
    mutable FeaturePoints points_;
    mutable ArcFit arc_;
    mutable Circle answer_;              // that judged() has seen last
    mutable std::vector<Piece> pieces_;  // that start() found round
    mutable std::vector<double> scratch_;
    mutable std::vector<std::array<int, 3>> rows_;  // first, last, count
    mutable std::vector<std::uint8_t> keep_;
};

Expected<std::unique_ptr<FeatureFinder>> make_circle(const FeatureRecipe& recipe) {
    const auto infos = circle_parameters();
    SEAM_TRY(const auto window, FeatureWindow::from(recipe.parameters, infos));
    auto value = [&](const char* name) { return parameter(recipe.parameters, infos, name); };
    if (!(value("radius_min_mm") < value("radius_max_mm")))
        return input_error("the limits of the radius are empty", "radius_min_mm",
                           "give a minimum below the maximum");
    return std::make_unique<CircleFinder>(window, value("radius_mm"), value("radius_min_mm"),
                                          value("radius_max_mm"), rad_from_deg(value("minimum_arc_deg")));
}

}  // namespace

FeatureKind circle_kind() {
    return {"circle", "The centre of a round piece of contour.", circle_parameters(), &make_circle};
}

}  // namespace seamwright
