// Extremum: the highest, lowest, leftmost or rightmost place of a contour, between the samples.
//
// A parabola is fitted to the points within fit_length_mm around the extreme one (h over t: z over x for
// highest and lowest, x over z for leftmost and rightmost), the window is centred on its vertex and the fit
// repeated, so that the noise that made one point the extreme one does not choose the window. Vertex t = -b /
// (2 a), h = c - b^2 / (4 a); the covariance is that of (a, b, c) carried through these, noise from the
// residuals.
//
// Where the contour has no smooth extremum (a ridge of a corner, the end of a slope) the parabola's vertex
// means nothing: the status is then not_found, unless the extreme point is a contour's end, which
// `contour-end` measures. A flat top whose bow is not seen above the noise is ill_conditioned along the flat.

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <cmath>

#include "core/features/feature_points.h"
#include "core/features/kinds/feature_kinds.h"

namespace seamwright {
namespace {

enum class Which { highest, lowest, leftmost, rightmost };
constexpr int kFewestForApex = 6;

std::vector<ParameterInfo> extremum_parameters() {
    return with_window({
        {"which",
         "",
         0,
         3,
         0,
         0,
         "The extremum that is meant.",
         {"highest", "lowest", "leftmost", "rightmost"}},
        {"fit_length_mm", "mm", 0.01, 1000, 2, 2,
         "Length of contour around the extremum that the parabola takes."},
    });
}

class Extremum final : public FeatureFinder {
  public:
    Extremum(FeatureWindow window, Which which, double fit_length_mm)
        : window_(window), which_(which), fit_length_(fit_length_mm) {}

    Feature find(const Profile& profile) const override {
        Feature feature;
        points_.gather(profile, window_);
        const std::size_t n = points_.x.size();
        if (n < kFewestForApex) {
            feature.status = FeatureStatus::no_points;
            feature.message = Text("{} points in the window, an extremum needs {}", n, kFewestForApex);
            return feature;
        }
        const bool upright = which_ == Which::highest || which_ == Which::lowest;
        const double sign = which_ == Which::highest || which_ == Which::rightmost ? 1 : -1;
        const std::vector<double>& t = upright ? points_.x : points_.z;
        const std::vector<double>& h = upright ? points_.z : points_.x;
        // The median of three neighbours decides, so a single spike is no summit. Neighbours share medians:
        // the middle of equal ones is taken, the same seen from left and right.
        int top = 0, top_last = 0;
        double best = -std::numeric_limits<double>::infinity();
        const FeaturePoints::Piece* piece = nullptr;
        for (const auto& p : points_.pieces) {
            if (p.count < kFewestForApex) continue;
            for (int i = p.first; i < p.first + p.count; ++i) {
                const int a = std::max(i - 1, p.first), b = std::min(i + 1, p.first + p.count - 1);
                const double value = std::max(std::min(sign * h[a], sign * h[i]),
                                              std::min(std::max(sign * h[a], sign * h[i]), sign * h[b]));
                if (value > best) {
                    best = value;
                    top = top_last = i;
                    piece = &p;
                } else if (value == best && piece == &p && i - top_last <= 2) {
                    top_last = i;
                }
            }
        }
        if (!piece) {
            feature.status = FeatureStatus::no_points;
            feature.message = Text("no unbroken piece of {} points in the window", kFewestForApex);
            return feature;
        }
        const int first = piece->first, last = first + piece->count - 1;
        double centre = 0.5 * (t[static_cast<std::size_t>(top)] + t[static_cast<std::size_t>(top_last)]);
        const double origin_h = sign * best;
        Eigen::Vector3d coefficient = Eigen::Vector3d::Zero();
        Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
        double sigma2 = 0;
        int used = 0;
        bool bent = false;
        double low = 0, high = 0;
        for (int round = 0; round < 4; ++round) {
            // Two passes: all points, then those within 3.5 sigma of the first.
            double gate = std::numeric_limits<double>::infinity();
            for (int pass = 0; pass < 2; ++pass) {
                normal.setZero();
                Eigen::Vector3d right = Eigen::Vector3d::Zero();
                double hh = 0;
                used = 0;
                low = high = 0;
                for (int i = first; i <= last; ++i) {
                    const double u = (t[i] - centre) / fit_length_, v = sign * (h[i] - origin_h);
                    if (std::abs(u) > 0.5 || std::abs(h[i] - origin_h) > fit_length_) continue;
                    const Eigen::Vector3d row(u * u, u, 1);
                    if (pass > 0 && std::abs(row.dot(coefficient) - v) > gate) continue;
                    normal += row * row.transpose();
                    right += v * row;
                    hh += v * v;
                    low = std::min(low, u);
                    high = std::max(high, u);
                    ++used;
                }
                if (used < kFewestForApex) break;
                coefficient = normal.ldlt().solve(right);
                sigma2 = std::max(0.0, hh - right.dot(coefficient)) / (used - 3);
                gate = 3.5 * std::sqrt(sigma2) + 1e-9;
            }
            if (used < kFewestForApex) break;
            bent = coefficient[0] < 0;
            if (!bent) break;
            const double vertex = -coefficient[1] / (2 * coefficient[0]);
            if (std::abs(vertex) > 0.5) break;
            if (round < 3) centre += vertex * fit_length_;
            if (std::abs(vertex) < 1e-3 && round > 0) break;
        }
        feature.points_used = used;
        if (used < kFewestForApex) {
            feature.status = FeatureStatus::no_points;
            feature.message = Text("{} points within {} mm of the extremum, the parabola needs {}", used,
                                   fit_length_, kFewestForApex);
            return feature;
        }
        feature.rms_mm = std::sqrt(sigma2 * (used - 3) / used);
        const double a = coefficient[0], b = coefficient[1], c = coefficient[2];
        const Eigen::Matrix3d covariance = sigma2 * normal.ldlt().solve(Eigen::Matrix3d::Identity());
        const double vertex = bent ? -b / (2 * a) : 0;
        const double bow = std::abs(a) / std::sqrt(std::max(covariance(0, 0), 1e-300));
        if (bow < 5) {
            feature.status = FeatureStatus::ill_conditioned;
            feature.message = "the contour is flat there: no bow is seen above the noise";
            feature.point_mm =
                upright ? Eigen::Vector2d(centre, origin_h) : Eigen::Vector2d(origin_h, centre);
            feature.covariance_mm2 = Eigen::Matrix2d::Identity() * 1e12;
            return feature;
        }
        // A ridge is no summit: the parabola's misfit stands out against both the noise and its own bow.
        const double noise = contour_noise_mm(points_.x, points_.z, scratch_);
        const double sag = std::abs(a) * 0.25;
        const bool ridge = feature.rms_mm > std::max(1.4 * noise, 0.045 * sag);
        if (!bent || ridge || vertex < low || vertex > high || low > -0.15 || high < 0.15) {
            feature.message = "the contour has no smooth extremum there, it ends or has an edge";
            return feature;
        }
        Eigen::Matrix<double, 2, 3> j;
        j << b / (2 * a * a), -1 / (2 * a), 0, b * b / (4 * a * a), -b / (2 * a), 1;
        j.row(0) *= fit_length_;
        Eigen::Matrix2d c_th = j * covariance * j.transpose();
        const double place = centre + vertex * fit_length_;
        const double height = origin_h + sign * (c - b * b / (4 * a));
        c_th(0, 1) *= sign;
        c_th(1, 0) *= sign;
        if (upright) {
            feature.point_mm = {place, height};
            feature.covariance_mm2 = c_th;
        } else {
            feature.point_mm = {height, place};
            feature.covariance_mm2 << c_th(1, 1), c_th(0, 1), c_th(0, 1), c_th(0, 0);
        }
        feature.status = FeatureStatus::ok;
        return feature;
    }

  private:
    FeatureWindow window_;
    Which which_;
    double fit_length_;
    mutable FeaturePoints points_;
    mutable std::vector<double> scratch_;
};

Expected<std::unique_ptr<FeatureFinder>> make_extremum(const FeatureRecipe& recipe) {
    const auto infos = extremum_parameters();
    SEAM_TRY(const auto window, FeatureWindow::from(recipe.parameters, infos));
    return std::make_unique<Extremum>(
        window, static_cast<Which>(std::lround(parameter(recipe.parameters, infos, "which"))),
        parameter(recipe.parameters, infos, "fit_length_mm"));
}

}  // namespace

FeatureKind extremum_kind() {
    return {"extremum", "The highest, lowest, leftmost or rightmost place of the contour.",
            extremum_parameters(), &make_extremum};
}

}  // namespace seamwright
