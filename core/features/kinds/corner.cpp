// Corner ("top edge"; methods.md 2): the intersection of two fitted lines. A rounded or burred edge has no
// corner point of its own; the intersection is where the two surfaces would meet and is far less noisy than
// any single point.
//
// Left and right line come from given x ranges, or from the bends of the contour in the window
// (contour_bends.h): the two straight stretches that meet at the one that is meant. More than one is
// ambiguous unless `which` tells them apart; a bend of less than a third of the sharpest turn is no rival.
// Where no bend shows, the split is the place that divides the points into two straight pieces with the
// smallest sum of squared distances (total least squares by running sums). Then both lines are fitted
// robustly without the zone `blend_mm` around their intersection. Where it is not given it grows until the points next to
// it do not leave the lines together any more: the sum of the first k distances of both sides, for every k, against its
// noise. Where a third of a side would have to go, the side is bent itself and nothing is left out.
//
// Covariance: each line fixes the point across itself with the variance of the fit at that place,
// sigma_i^2 (1 / n_i + s_i^2 / S_i), and with what all heights of a level side are rounded by alike
// (contour_noise.h); two lines with normals N = (n_1 n_2)^T give N^-1 diag(v) N^-T. As the
// angle between the lines goes to zero this grows without bound along them: below minimum_angle_deg the
// answer is ill_conditioned. phi_rad is the mean direction of the two lines, from left to right.

#include <fmt/format.h>

#include <Eigen/Core>
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>

#include "core/features/contour/contour_bends.h"
#include "core/features/contour/line_fit.h"
#include "core/features/feature_points.h"
#include "core/features/kinds/feature_kinds.h"
#include "core/geometry/pose.h"

namespace seamwright {
namespace {

constexpr int kFewestPerLine = 4;

std::vector<ParameterInfo> corner_parameters() {
    return with_window({
        {"split",
         "",
         0,
         1,
         0,
         0,
         "Where the left line ends and the right one begins: found, or given by two x ranges.",
         {"automatic", "given"}},
        {"left_from_mm", "mm", -1e5, 1e5, -1e5, 3, "Given split: the left line's first x."},
        {"left_to_mm", "mm", -1e5, 1e5, 0, 3, "Given split: the left line's last x."},
        {"right_from_mm", "mm", -1e5, 1e5, 0, 3, "Given split: the right line's first x."},
        {"right_to_mm", "mm", -1e5, 1e5, 1e5, 3, "Given split: the right line's last x."},
        {"side_length_mm", "mm", 0, 1e5, 0, 2,
         "Automatic split: length of each line from the corner; 0 takes all."},
        {"blend_mm", "mm", 0, 1000, 0, 2,
         "Points nearer to the corner than this are left out: radius or burr; 0 finds it (automatic split)."},
        {"which",
         "",
         0,
         5,
         0,
         0,
         "Automatic split: which corner is meant where several lie in the window.",
         {"only", "highest", "lowest", "leftmost", "rightmost", "sharpest"}},
        {"minimum_angle_deg", "deg", 0.1, 90, 5, 1, "Lines that meet at a smaller angle make no corner."},
    });
}

enum class CornerOf { only, highest, lowest, leftmost, rightmost, sharpest };

constexpr double kCornerRival = 1.0 / 3;     // of the sharpest turn: a weaker bend is no rival
constexpr double kCornerSharper = 1.25;      // of the next turn
constexpr double kCornerApart = 0.1;         // of their distance: what tells two corners apart by x or z
constexpr double kCornerUnknown_mm2 = 1e12;  // variance of a corner that two lines do not tell
constexpr double kCornerEndless_mm = 1e9;
constexpr std::size_t kCornersNamed = 4;
// Of a blend that is not given: sums beyond so many sigma, how it grows, and the most of a side.
constexpr double kBlendSeen = 3, kBlendGrows = 1.25, kBlendMost = 1.0 / 3;
constexpr double kBlendStep = 2;  // points

class Corner final : public FeatureFinder {
  public:
    struct Settings {
        bool given = false;
        CornerOf which = CornerOf::only;
        double left_from = 0, left_to = 0, right_from = 0, right_to = 0;
        double side_length = 0, blend = 0, minimum_angle = 0;
    };
    Corner(FeatureWindow window, const Settings& settings) : window_(window), settings_(settings) {}

    Feature find(const Profile& profile) const override {
        Feature feature;
        points_.gather(profile, window_);
        const auto n = points_.x.size();
        if (n < 2 * kFewestPerLine) {
            feature.status = FeatureStatus::no_points;
            feature.message = Text("{} points in the window, a corner needs {}", n, 2 * kFewestPerLine);
            return feature;
        }
        if (settings_.given) {
            take(
                [&](std::size_t i) {
                    return points_.x[i] >= settings_.left_from && points_.x[i] <= settings_.left_to;
                },
                left_x_, left_z_);
            take(
                [&](std::size_t i) {
                    return points_.x[i] >= settings_.right_from && points_.x[i] <= settings_.right_to;
                },
                right_x_, right_z_);
            return intersect(feature, settings_.blend > 0 ? 3 : 1, 0, 0, n, settings_.blend);
        }
        const auto& bends = bends_.find(points_.x, points_.z, settings_.minimum_angle, settings_.blend);
        if (bends.empty()) return blended(feature, best_split(), 0, n);
        const Bend* bend = choose(bends, feature);
        if (!bend) return feature;
        return blended(feature, static_cast<std::size_t>(bend->split), static_cast<std::size_t>(bend->first),
                       static_cast<std::size_t>(bend->last) + 1);
    }

  private:
    // nullptr with status, message and rivals in `feature` where nothing tells which one is meant.
    const Bend* choose(const std::vector<Bend>& bends, Feature& feature) const {
        double sharpest = 0;
        for (const Bend& b : bends) sharpest = std::max(sharpest, std::abs(b.turn_rad));
        const auto rank = [&](const Bend& b) {
            switch (settings_.which) {
                case CornerOf::highest:
                    return b.place.y();
                case CornerOf::lowest:
                    return -b.place.y();
                case CornerOf::leftmost:
                    return -b.place.x();
                case CornerOf::rightmost:
                    return b.place.x();
                case CornerOf::only:
                case CornerOf::sharpest:
                    break;
            }
            return std::abs(b.turn_rad);
        };
        const Bend* best = nullptr;
        for (const Bend& b : bends)
            if (std::abs(b.turn_rad) >= kCornerRival * sharpest && (!best || rank(b) > rank(*best)))
                best = &b;
        const auto told_apart = [&](const Bend& other) {
            if (settings_.which == CornerOf::only) return false;
            if (settings_.which == CornerOf::sharpest) return rank(*best) > kCornerSharper * rank(other);
            return rank(*best) - rank(other) > kCornerApart * (best->place - other.place).norm();
        };
        std::string places;
        for (const Bend& b : bends) {
            if (&b == best || std::abs(b.turn_rad) < kCornerRival * sharpest || told_apart(b)) continue;
            if (feature.rivals_mm.empty()) feature.rivals_mm.push_back(best->place);
            feature.rivals_mm.push_back(b.place);
        }
        if (feature.rivals_mm.empty()) return best;
        for (std::size_t i = 0; i < std::min(feature.rivals_mm.size(), kCornersNamed); ++i)
            places += fmt::format("{}x {:.2f} z {:.2f}", i ? ", " : "", feature.rivals_mm[i].x(),
                                  feature.rivals_mm[i].y());
        if (feature.rivals_mm.size() > kCornersNamed) places += " ...";
        feature.status = FeatureStatus::ambiguous;
        feature.message =
            Text("{} corners lie in the window: {}; say which by the window or by the setting which",
                 feature.rivals_mm.size(), places);
        return nullptr;
    }

    template <class Keep>
    void take(Keep keep, std::vector<double>& x, std::vector<double>& z) const {
        x.clear();
        z.clear();
        for (std::size_t i = 0; i < points_.x.size(); ++i)
            if (keep(i)) {
                x.push_back(points_.x[i]);
                z.push_back(points_.z[i]);
            }
    }

    // Number of points that belong to the left line.
    std::size_t best_split() const {
        const std::size_t n = points_.x.size();
        sums_.assign(n + 1, {});
        const double ox = points_.x[n / 2], oz = points_.z[n / 2];
        for (std::size_t i = 0; i < n; ++i) {
            const double x = points_.x[i] - ox, z = points_.z[i] - oz;
            sums_[i + 1] = {sums_[i][0] + x, sums_[i][1] + z, sums_[i][2] + x * x, sums_[i][3] + x * z,
                            sums_[i][4] + z * z};
        }
        // Smallest eigenvalue of the scatter = sum of squared distances from the total least squares line.
        const auto scatter = [&](std::size_t a, std::size_t b) {
            const double m = double(b - a);
            std::array<double, 5> s;
            for (int j = 0; j < 5; ++j) s[j] = sums_[b][j] - sums_[a][j];
            const double xx = s[2] - s[0] * s[0] / m, xz = s[3] - s[0] * s[1] / m,
                         zz = s[4] - s[1] * s[1] / m;
            return 0.5 * (xx + zz) - std::hypot(0.5 * (xx - zz), xz);
        };
        std::size_t best = n / 2;
        double least = std::numeric_limits<double>::infinity();
        for (std::size_t k = kFewestPerLine; k + kFewestPerLine <= n; ++k) {
            const double sum = scatter(0, k) + scatter(k, n);
            if (sum < least) {
                least = sum;
                best = k;
            }
        }
        return best;
    }

    // With the zone that is given, or with the one that is found.
    Feature blended(const Feature& begun, std::size_t split, std::size_t first, std::size_t end) const {
        const Feature whole = intersect(begun, 4, split, first, end, settings_.blend);
        if (settings_.blend > 0) return whole;
        const double most = kBlendMost * std::min(left_.length_mm(), right_.length_mm());
        const double step = kBlendStep * std::max(left_.length_mm() / std::max(1, left_.used),
                                                  right_.length_mm() / std::max(1, right_.used));
        Feature feature = whole;
        for (double blend = 0; feature.status == FeatureStatus::ok && rounded(feature.point_mm);) {
            blend = kBlendGrows * blend + step;
            if (!(blend <= most)) return whole;
            feature = intersect(begun, 4, split, first, end, blend);
        }
        return feature.status == FeatureStatus::ok ? feature : whole;
    }

    // Whether the points next to the corner leave the two lines together, to the inside or to the outside.
    bool rounded(const Eigen::Vector2d& corner) const {
        const double sigma = workspace_.noise.point_mm > 0 ? workspace_.noise.point_mm
                                                           : std::min(left_.sigma_mm, right_.sigma_mm);
        // The lines run from left to right; where they turn to the left the inside is there.
        const double inside =
            left_.direction.x() * right_.direction.y() > left_.direction.y() * right_.direction.x() ? 1 : -1;
        near_.clear();
        const auto side = [&](const std::vector<double>& x, const std::vector<double>& z,
                              const LineFit& line) {
            for (std::size_t i = 0; i < x.size(); ++i) {
                const Eigen::Vector2d p(x[i], z[i]);
                near_.emplace_back((p - corner).norm(), inside * line.distance(p));
            }
        };
        side(left_x_, left_z_, left_);
        side(right_x_, right_z_, right_);
        std::sort(near_.begin(), near_.end());
        const double apart = std::max(1.0, workspace_.noise.apart());
        double sum = 0;
        for (std::size_t k = 0; k < near_.size() / 2; ++k) {
            sum += near_[k].second;
            if (std::abs(sum) > kBlendSeen * sigma * std::sqrt(static_cast<double>(k + 1) * apart))
                return true;
        }
        return false;
    }

    // `split` = 0: the sides are already taken. Else they are taken from the points first..end. Rounds: the
    // intersection decides which points count, and so on.
    Feature intersect(Feature feature, int rounds, std::size_t split, std::size_t first, std::size_t end,
                      double blend) const {
        if (split > 0) {
            take([&](std::size_t i) { return i >= first && i < split; }, left_x_, left_z_);
            take([&](std::size_t i) { return i >= split && i < end; }, right_x_, right_z_);
        }
        LineFit &a = left_, &b = right_;
        workspace_.noise = points_.noise(SharedOver::many);
        Eigen::Matrix2d normals;
        for (int round = 0; round < rounds; ++round) {
            if (left_x_.size() < kFewestPerLine || right_x_.size() < kFewestPerLine) {
                feature.status = FeatureStatus::no_points;
                feature.message = Text("{} points left and {} right of the corner, each line needs {}",
                                       left_x_.size(), right_x_.size(), kFewestPerLine);
                return feature;
            }
            a = fit_line(left_x_, left_z_, workspace_);
            b = fit_line(right_x_, right_z_, workspace_);
            if (!a.ok || !b.ok) {
                feature.message = "the points do not form two lines";
                return feature;
            }
            const double cross = a.direction.x() * b.direction.y() - a.direction.y() * b.direction.x();
            if (std::abs(cross) < std::sin(settings_.minimum_angle)) {
                feature.status = FeatureStatus::ill_conditioned;
                feature.message = Text("the two lines meet at {:.1f} degrees only",
                                       deg_from_rad(std::asin(std::abs(cross))));
                feature.covariance_mm2 = Eigen::Matrix2d::Identity() * kCornerUnknown_mm2;
                return feature;
            }
            normals << -a.direction.y(), a.direction.x(), -b.direction.y(), b.direction.x();
            const Eigen::Vector2d offsets(normals.row(0).dot(a.centre), normals.row(1).dot(b.centre));
            feature.point_mm = normals.inverse() * offsets;
            if (round + 1 == rounds) break;
            const Eigen::Vector2d p = feature.point_mm;
            const auto near = [&](std::size_t i) {
                return std::hypot(points_.x[i] - p.x(), points_.z[i] - p.y());
            };
            const double longest = settings_.side_length > 0 ? settings_.side_length : kCornerEndless_mm;
            if (split > 0) {
                // Divide at the point nearest to the intersection.
                std::size_t nearest = first;
                for (std::size_t i = first; i < end; ++i)
                    if (near(i) < near(nearest)) nearest = i;
                take(
                    [&](std::size_t i) {
                        return i >= first && i < nearest && near(i) >= blend && near(i) <= longest;
                    },
                    left_x_, left_z_);
                take(
                    [&](std::size_t i) {
                        return i > nearest && i < end && near(i) >= blend && near(i) <= longest;
                    },
                    right_x_, right_z_);
            } else {
                drop_near(left_x_, left_z_, p, blend);
                drop_near(right_x_, right_z_, p, blend);
            }
        }
        const double sa = a.direction.dot(feature.point_mm - a.centre),
                     sb = b.direction.dot(feature.point_mm - b.centre);
        const Eigen::Matrix2d inverse = normals.inverse();
        feature.covariance_mm2 =
            inverse * Eigen::Vector2d(across(a, sa), across(b, sb)).asDiagonal() * inverse.transpose();
        const Eigen::Vector2d mean = a.direction + b.direction;
        feature.phi_rad = std::atan2(mean.y(), mean.x());
        feature.points_used = a.used + b.used;
        feature.rms_mm =
            std::sqrt((a.used * a.rms_mm * a.rms_mm + b.used * b.rms_mm * b.rms_mm) / feature.points_used);
        // The corner must lie where the lines end, not somewhere far off on their continuations.
        const double reach = std::max(a.length_mm(), b.length_mm());
        if (std::max(std::abs(sa), std::abs(sb)) > 2 * reach) {
            feature.status = FeatureStatus::not_found;
            feature.message = "the two lines meet far away from the points";
            return feature;
        }
        feature.status = FeatureStatus::ok;
        return feature;
    }

    double across(const LineFit& line, double s) const {
        return line.variance_at(s) +
               workspace_.noise.shared_rounding_mm2(line.rms_mm) * line.direction.x() * line.direction.x();
    }

    static void drop_near(std::vector<double>& x, std::vector<double>& z, const Eigen::Vector2d& p,
                          double blend) {
        std::size_t kept = 0;
        for (std::size_t i = 0; i < x.size(); ++i)
            if (std::hypot(x[i] - p.x(), z[i] - p.y()) >= blend) {
                x[kept] = x[i];
                z[kept++] = z[i];
            }
        x.resize(kept);
        z.resize(kept);
    }

    FeatureWindow window_;
    Settings settings_;
    mutable FeaturePoints points_;
    mutable ContourBends bends_;
    mutable std::vector<double> left_x_, left_z_, right_x_, right_z_;
    mutable std::vector<std::array<double, 5>> sums_;
    mutable LineFit left_, right_;                         // as intersect() fitted them last
    mutable std::vector<std::pair<double, double>> near_;  // distance from the corner, and from its line
    mutable LineWorkspace workspace_;
};

Expected<std::unique_ptr<FeatureFinder>> make_corner(const FeatureRecipe& recipe) {
    const auto infos = corner_parameters();
    SEAM_TRY(const auto window, FeatureWindow::from(recipe.parameters, infos));
    auto value = [&](const char* name) { return parameter(recipe.parameters, infos, name); };
    Corner::Settings s;
    s.given = value("split") > 0.5;
    s.which = static_cast<CornerOf>(std::lround(value("which")));
    s.left_from = value("left_from_mm");
    s.left_to = value("left_to_mm");
    s.right_from = value("right_from_mm");
    s.right_to = value("right_to_mm");
    s.side_length = value("side_length_mm");
    s.blend = value("blend_mm");
    s.minimum_angle = rad_from_deg(value("minimum_angle_deg"));
    if (s.given && (!(s.left_from < s.left_to) || !(s.right_from < s.right_to)))
        return input_error("a range of x for the corner's lines is empty", "left_from_mm",
                           "give each range a beginning below its end");
    if (s.side_length > 0 && s.side_length <= s.blend)
        return input_error(
            Text("side_length_mm = {} leaves no points outside of blend_mm = {}", s.side_length, s.blend),
            "side_length_mm", "give a longer side");
    return std::make_unique<Corner>(window, s);
}

}  // namespace

FeatureKind corner_kind() {
    return {"corner", "The intersection of two lines fitted left and right of an edge.", corner_parameters(),
            &make_corner};
}

}  // namespace seamwright
