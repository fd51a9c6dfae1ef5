// Extremum: the highest, lowest, leftmost or rightmost place of a contour, between the samples.
//
// A parabola is fitted to the points within fit_length_mm around the extreme one (h over t: z over x for highest and
// lowest, x over z for leftmost and rightmost), the window is centred on its vertex and the fit repeated, so that the
// noise that made one point the extreme one does not choose the window. Unless it is given, that length grows from 2
// mm as long as the contour is a parabola within its noise on both sides: until a quartic through the same points
// takes more than chance from the sum of squares, then it is the one before, and one less where the bow is clear all
// the same: just below what is seen, a form that is none still moves the vertex. Vertex t = -b / (2 a), h = c - b^2 /
// (4 a); the covariance is that of (a, b, c) carried through these, noise from the residuals, widened where
// neighbours are alike (contour_noise.h). The contour need not be a parabola (a bead that leans, an arc between flanks, a
// ridge that noise hides), and noise may hide that. The answer is the mean of the vertices of the parabola and of a quartic
// through the same points, weighted by exp(-chi^2 / 2 - unknowns / 2) as in arc_fit.h, and the covariance has their
// disagreement and a quarter of what the quartic moves, for the powers that it has not.
//
// Where the contour has no smooth extremum (a ridge of a corner, the end of a slope) the parabola's vertex
// means nothing: the status is then not_found, unless the extreme point is a contour's end, which
// `contour-end` measures. A flat top whose bow is not seen above the noise is ill_conditioned along the flat.

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "core/features/contour/contour_noise.h"
#include "core/features/feature_points.h"
#include "core/features/kinds/feature_kinds.h"

namespace seamwright {
namespace {

constexpr double kApexGate = 3.5;    // standard deviations from the first parabola
constexpr double kLeastBow = 5;      // standard deviations: flatter is no bow
constexpr double kRidgeNoise = 1.4;  // times the contour's noise, and
constexpr double kRidgeSag = 0.045;  // of the parabola's own sag: a misfit beyond both is an edge
constexpr double kLeastSide = 0.15;  // of the fitted length that must be seen on either side

constexpr double kShortestFit_mm = 2,
                 kLongerFit = 1.25;  // where the length is not given: the first, and by how much each grows
constexpr double kClearBow = 15;     // standard deviations: less length would do
constexpr double kNoParabola = 4;    // chi^2 of the quartic's two unknowns: the shape has left the parabola
constexpr double kQuarticPrice = 2;  // chi^2 that its two unknowns cost
constexpr double kQuarticsOwn =
    0.25;  // of the square by which it moves the vertex: what a further power might
constexpr double kNoParabolaFlat = 12;  // the same while no bow is seen
constexpr double kParabolaKept = 0.95;  // of the points, within the gate: fewer, and it is none
constexpr double kBothSides = 0.45;     // of the fitted length, that a longer one must see on either side

constexpr double kApexLeastGate_mm = 1e-9;
constexpr double kApexLeastVariance = 1e-300;  // of a bow: divided by
constexpr double kApexUnknown_mm2 = 1e12;      // variance where the contour is flat
constexpr double kApexSingular = 1e-12;        // reciprocal condition

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
        {"fit_length_mm", "mm", 0, 1000, 0, 2,
         "Length of contour around the extremum that the parabola takes; 0: as far as it is a parabola."},
    });
}

class Extremum final : public FeatureFinder {
  public:
    Extremum(FeatureWindow window, Which which, double fit_length_mm)
        : window_(window), which_(which), given_(fit_length_mm) {}

    Feature find(const Profile& profile) const override {
        points_.gather(profile, window_);
        const std::size_t n = points_.x.size();
        if (n < kFewestForApex)
            return refused(FeatureStatus::no_points,
                           Text("{} points in the window, an extremum needs {}", n, kFewestForApex));
        const bool upright = which_ == Which::highest || which_ == Which::lowest;
        const double sign = which_ == Which::highest || which_ == Which::rightmost ? 1 : -1;
        const std::vector<double>& t = upright ? points_.x : points_.z;
        const std::vector<double>& h = upright ? points_.z : points_.x;
        const Top top = top_of(h, sign);
        if (!top.piece)
            return refused(FeatureStatus::no_points,
                           Text("no unbroken piece of {} points in the window", kFewestForApex));
        noise_ = points_.noise(SharedOver::many);
        fit_length_ = given_ > 0 ? given_ : kShortestFit_mm;
        Parabola fit = parabola_at(t, h, sign, top);
        if (!(given_ > 0)) fit = longest(t, h, sign, top, fit);
        Feature feature;
        feature.points_used = fit.used;
        if (fit.used < kFewestForApex) {
            feature.status = FeatureStatus::no_points;
            feature.message = Text("{} points within {} mm of the extremum, the parabola needs {}", fit.used,
                                   fit_length_, kFewestForApex);
            return feature;
        }
        feature.rms_mm = std::sqrt(fit.sigma2 * (fit.used - 3) / fit.used);
        const double a = fit.coefficient[0], b = fit.coefficient[1], c = fit.coefficient[2];
        const Eigen::Matrix3d covariance =
            fit.variance * fit.normal.ldlt().solve(Eigen::Matrix3d::Identity());
        const double vertex = fit.bent ? -b / (2 * a) : 0;
        if (bow_of(fit) < kLeastBow) {
            feature.status = FeatureStatus::ill_conditioned;
            feature.message = "the contour is flat there: no bow is seen above the noise";
            feature.point_mm =
                upright ? Eigen::Vector2d(fit.centre, fit.origin) : Eigen::Vector2d(fit.origin, fit.centre);
            feature.covariance_mm2 = Eigen::Matrix2d::Identity() * kApexUnknown_mm2;
            return feature;
        }
        // A ridge is no summit: the parabola's misfit stands out against both the noise and its own bow.
        // Of neighbours that share their noise it is more than these tell.
        const double noise = std::max(contour_noise_mm(points_.x, points_.z, scratch_), noise_.alone_mm);
        const double sag = std::abs(a) * 0.25;
        const bool ridge = feature.rms_mm > std::max(kRidgeNoise * noise, kRidgeSag * sag);
        const bool seen_on_both_sides = fit.low <= -kLeastSide && fit.high >= kLeastSide;
        if (!fit.bent || ridge || vertex < fit.low || vertex > fit.high || !seen_on_both_sides) {
            feature.message = "the contour has no smooth extremum there, it ends or has an edge";
            return feature;
        }
        Eigen::Matrix<double, 2, 3> j;
        j << b / (2 * a * a), -1 / (2 * a), 0, b * b / (4 * a * a), -b / (2 * a), 1;
        j.row(0) *= fit_length_;
        const Shape shape = other_shape(t, h, sign, *top.piece, fit, vertex);
        Eigen::Matrix2d c_th = shape.alike * j * covariance * j.transpose();
        const double place = fit.centre + vertex * fit_length_ + shape.by.x();
        const double height = fit.origin + sign * (c - b * b / (4 * a) + shape.by.y());
        c_th(0, 1) *= sign;
        c_th(1, 0) *= sign;
        c_th.diagonal() += shape.more_t_h;
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
    // Where the contour is outermost: points `first` and `last` of equal height, on one piece; nullptr: no piece is long
    // enough.
    struct Top {
        int first = 0, last = 0;
        double height = -std::numeric_limits<double>::infinity();  // times sign
        const FeaturePoints::Piece* piece = nullptr;
    };
    // v = c0 u^2 + c1 u + c2 with u = (t - centre) / fit_length_ and v = sign (h - origin).
    struct Parabola {
        Eigen::Vector3d coefficient = Eigen::Vector3d::Zero();
        Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
        double sigma2 = 0, variance = 0;  // of its points; and as that of a few is known (pooled_sigma())
        double centre = 0, origin = 0;
        double low = 0, high = 0;  // u that was seen
        int used = 0, there = 0;   // within the gate, and all
        bool bent = false;         // outwards
    };

    static Feature refused(FeatureStatus status, Text message) {
        Feature feature;
        feature.status = status;
        feature.message = std::move(message);
        return feature;
    }

    // The median of three neighbours decides, so a single spike is no summit. Neighbours share medians: the middle of
    // equal ones is taken, the same seen from left and right.
    Top top_of(const std::vector<double>& h, double sign) const {
        Top top;
        for (const auto& p : points_.pieces) {
            if (p.count < kFewestForApex) continue;
            for (int i = p.first; i < p.first + p.count; ++i) {
                const int a = std::max(i - 1, p.first), b = std::min(i + 1, p.first + p.count - 1);
                const double value = std::max(std::min(sign * h[a], sign * h[i]),
                                              std::min(std::max(sign * h[a], sign * h[i]), sign * h[b]));
                if (value > top.height)
                    top = {i, i, value, &p};
                else if (value == top.height && top.piece == &p && i - top.last <= 2)
                    top.last = i;
            }
        }
        return top;
    }

    // Least squares about fit.centre in two passes: all points, then those within the gate of the first.
    void fit_parabola(const std::vector<double>& t, const std::vector<double>& h, double sign,
                      const FeaturePoints::Piece& piece, Parabola& fit) const {
        double gate = std::numeric_limits<double>::infinity();
        for (int pass = 0; pass < 2; ++pass) {
            fit.normal.setZero();
            Eigen::Vector3d right = Eigen::Vector3d::Zero();
            double hh = 0;
            fit.used = fit.there = 0;
            fit.low = fit.high = 0;
            for (int i = piece.first; i < piece.first + piece.count; ++i) {
                const double u = (t[i] - fit.centre) / fit_length_, v = sign * (h[i] - fit.origin);
                if (std::abs(u) > 0.5 || std::abs(h[i] - fit.origin) > fit_length_) continue;
                const Eigen::Vector3d row(u * u, u, 1);
                ++fit.there;
                if (pass > 0 && std::abs(row.dot(fit.coefficient) - v) > gate) continue;
                fit.normal += row * row.transpose();
                right += v * row;
                hh += v * v;
                fit.low = std::min(fit.low, u);
                fit.high = std::max(fit.high, u);
                ++fit.used;
            }
            if (fit.used < kFewestForApex) return;
            fit.coefficient = fit.normal.ldlt().solve(right);
            fit.sigma2 = std::max(0.0, hh - right.dot(fit.coefficient)) / (fit.used - 3);
            const PooledSigma pooled = pooled_sigma(std::sqrt(fit.sigma2), fit.used - 3, noise_);
            fit.variance = pooled.sigma_mm * pooled.sigma_mm * pooled.widening;
            gate = kApexGate * std::sqrt(fit.sigma2) + kApexLeastGate_mm;
        }
    }

    // What a quartic through the same points says beside the parabola; where they do not know one, nothing.
    using Vector5 = Eigen::Matrix<double, 5, 1>;
    struct Shape {
        Eigen::Vector2d by =
            Eigen::Vector2d::Zero();  // by how much it moves the vertex, in t and h, as far as it counts
        Eigen::Vector2d more_t_h = Eigen::Vector2d::Zero();  // the variances that it adds
        double alike = 1;                                    // contour_noise.h, of its residuals
        double more = 0;                                     // chi^2 that its two further unknowns take
    };
    Shape other_shape(const std::vector<double>& t, const std::vector<double>& h, double sign,
                      const FeaturePoints::Piece& piece, const Parabola& fit, double vertex) const {
        constexpr int kFewest = 9;
        constexpr double kFarthest = 0.25;  // in u
        const double gate = kApexGate * std::sqrt(fit.sigma2) + kApexLeastGate_mm;
        Eigen::Matrix<double, 5, 5> normal = Eigen::Matrix<double, 5, 5>::Zero();
        Vector5 right = Vector5::Zero();
        double hh = 0, parabola = 0;
        rows_.clear();
        scratch_.clear();
        int used = 0;
        for (int i = piece.first; i < piece.first + piece.count; ++i) {
            const double u = (t[i] - fit.centre) / fit_length_, v = sign * (h[i] - fit.origin);
            if (std::abs(u) > 0.5 || std::abs(h[i] - fit.origin) > fit_length_) continue;
            const double off = Eigen::Vector3d(u * u, u, 1).dot(fit.coefficient) - v;
            if (std::abs(off) > gate) continue;
            parabola += off * off;
            const double w = u - vertex;
            const Vector5 row(
                Vector5::Map(std::array<double, 5>{1, w, w * w, w * w * w, w * w * w * w}.data()));
            normal += row * row.transpose();
            right += v * row;
            hh += v * v;
            rows_.push_back(row);
            scratch_.push_back(v);
            ++used;
        }
        if (used < kFewest) return {};
        const Eigen::LDLT<Eigen::Matrix<double, 5, 5>> solver(normal);
        if (!(solver.rcond() > kApexSingular)) return {};
        const Vector5 c = solver.solve(right);
        Shape shape;
        for (std::size_t i = 0; i < rows_.size(); ++i) scratch_[i] -= rows_[i].dot(c);
        shape.alike = alike_widening(scratch_, 5, noise_);
        const double quartic = std::max(0.0, hh - right.dot(c));
        const PooledSigma pooled = pooled_sigma(std::sqrt(quartic / (used - 5)), used - 5, noise_);
        const double sigma2 = shape.alike * pooled.sigma_mm * pooled.sigma_mm * pooled.widening;
        shape.more = (parabola - quartic) / std::max(sigma2, kApexLeastGate_mm * kApexLeastGate_mm);
        const Eigen::Matrix2d full = solver.solve(Eigen::Matrix<double, 5, 2>::Identity()).topRows<2>();
        const Eigen::Matrix3d few = normal.topLeftCorner<3, 3>().ldlt().solve(Eigen::Matrix3d::Identity());
        const double bow = 2 * fit.coefficient[0];  // of both: the quartic's own says little at its middle
        const double shift = std::clamp(-c[1] / bow, -kFarthest, kFarthest);
        const double summit =
            fit.coefficient[2] + vertex * (fit.coefficient[1] + vertex * fit.coefficient[0]);
        const double rise = c[0] - summit;
        const double counts = 1 / (1 + std::exp(0.5 * (kQuarticPrice - shape.more)));
        const Eigen::Vector2d moved(fit_length_ * shift, rise);
        const Eigen::Vector2d noisier(
            fit_length_ * fit_length_ * sigma2 * std::max(0.0, full(1, 1) - few(1, 1)) / (bow * bow),
            sigma2 * std::max(0.0, full(0, 0) - few(0, 0)));
        shape.by = counts * moved;
        shape.more_t_h = counts * noisier + counts * (1 - counts + kQuarticsOwn) * moved.cwiseAbs2();
        return shape;
    }

    double bow_of(const Parabola& fit) const {
        const Eigen::Matrix3d inverse = fit.normal.ldlt().solve(Eigen::Matrix3d::Identity());
        const double variance = std::max(1.0, noise_.apart()) * fit.variance * inverse(0, 0);
        return std::abs(fit.coefficient[0]) / std::sqrt(std::max(variance, kApexLeastVariance));
    }

    // Sets fit_length_ as well.
    Parabola longest(const std::vector<double>& t, const std::vector<double>& h, double sign, const Top& top,
                     const Parabola& shortest) const {
        const auto is_parabola = [&](const Parabola& fit) {
            const double vertex = fit.bent ? -fit.coefficient[1] / (2 * fit.coefficient[0]) : 0;
            const double most = bow_of(fit) < kLeastBow ? kNoParabolaFlat : kNoParabola;
            return fit.used >= kParabolaKept * fit.there &&
                   other_shape(t, h, sign, *top.piece, fit, std::clamp(vertex, -0.5, 0.5)).more < most;
        };
        Parabola best = shortest, before = shortest;
        double length = fit_length_, length_before = length;
        if (shortest.used >= kFewestForApex && !is_parabola(shortest)) return shortest;
        const auto [low, high] = std::minmax_element(t.begin() + top.piece->first,
                                                     t.begin() + top.piece->first + top.piece->count);
        while (length < *high - *low) {
            fit_length_ = length * kLongerFit;
            const Parabola fit = parabola_at(t, h, sign, top);
            const bool seen = fit.low <= -kBothSides && fit.high >= kBothSides;
            if (fit.used >= kFewestForApex && (!seen || !is_parabola(fit))) break;
            before = std::exchange(best, fit);
            length_before = std::exchange(length, fit_length_);
        }
        const bool clear = before.used >= kFewestForApex && before.bent && bow_of(before) > kClearBow;
        fit_length_ = clear ? length_before : length;
        return clear ? before : best;
    }

    // Round by round about the vertex that the last one found.
    Parabola parabola_at(const std::vector<double>& t, const std::vector<double>& h, double sign,
                         const Top& top) const {
        constexpr int kRounds = 4;
        constexpr double kStill = 1e-3;  // of fit_length_
        Parabola fit;
        fit.centre = 0.5 * (t[static_cast<std::size_t>(top.first)] + t[static_cast<std::size_t>(top.last)]);
        fit.origin = sign * top.height;
        for (int round = 0; round < kRounds; ++round) {
            fit_parabola(t, h, sign, *top.piece, fit);
            if (fit.used < kFewestForApex) break;
            fit.bent = fit.coefficient[0] < 0;
            if (!fit.bent) break;
            const double vertex = -fit.coefficient[1] / (2 * fit.coefficient[0]);
            if (std::abs(vertex) > 0.5) break;
            if (round + 1 < kRounds) fit.centre += vertex * fit_length_;
            if (std::abs(vertex) < kStill && round > 0) break;
        }
        return fit;
    }

    FeatureWindow window_;
    Which which_;
    double given_;  // 0: none
    mutable double fit_length_ = kShortestFit_mm;
    mutable FeaturePoints points_;
    mutable ProfileNoise noise_;
    mutable std::vector<double> scratch_;
    mutable std::vector<Vector5> rows_;
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
