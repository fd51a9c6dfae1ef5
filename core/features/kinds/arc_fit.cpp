#include "core/features/kinds/arc_fit.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>

#include "core/geometry/pose.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

constexpr int kFewestForArcFit = 6, kFewestForStraight = 4;
constexpr double kGate = 3.5 * 1.05;     // robust standard deviations
constexpr double kLeastGate_mm = 1e-9;   // where there is no noise
constexpr double kReach = 1;             // of the arc's length: what is taken of a straight
constexpr double kShortest = 0.1;        // of the arc's length: a straight that is shorter, or bent, is none
constexpr double kKept = 0.85;           // of a straight's points: fewer within the gate, and it is none
constexpr double kKink = 3.5;            // standard deviations off the tangent, or off a straight
constexpr double kSteps[] = {0.3, 0.3};  // at most, of the radius and rad
constexpr double kMoved = 0.1;           // of the arc's points: so many others, and it is fitted again
constexpr double kUnknown = 0.5;         // of the logarithm of a reading's weight, for each
constexpr double kSettled = 1e-9, kNear = 1e-6;
constexpr double kWidest = 170 * kPi / 180;  // to one side of the arc's middle

}  // namespace

ArcFit::Ends::Ends(const ArcFit& fit, const Shape& shape) {
    for (const Side side : {left, right}) {
        sign[side] = side == left ? -fit.turn_ : fit.turn_;
        const double angle = fit.towards_ + sign[side] * shape.p[3 + side];
        out[side] = {std::cos(angle), std::sin(angle)};
    }
}

double ArcFit::residual(const Shape& shape, const Ends& ends, int i, Vector5& row, Where& where) const {
    const double dx = x_[std::size_t(i)] - shape.p[0], dz = z_[std::size_t(i)] - shape.p[1];
    const Side side = i < middle_ ? left : right;
    if (shape.straight[side]) {
        const Eigen::Vector2d& out = ends.out[side];
        const double beyond = ends.sign[side] * (out.x() * dz - out.y() * dx);
        if (beyond > 0) {
            row << -out.x(), -out.y(), known_ ? 0 : -1, 0, 0;
            row[3 + side] = beyond;
            where = side == left ? Where::left : Where::right;
            return out.x() * dx + out.y() * dz - shape.p[2];
        }
    }
    where = Where::arc;
    const double rho = std::sqrt(dx * dx + dz * dz), divided = std::max(rho, 1e-12);
    row << -dx / divided, -dz / divided, known_ ? 0 : -1, 0, 0;
    return rho - shape.p[2];
}

void ArcFit::sum(Shape& shape, Vector5& gradient) const {
    const Ends ends(*this, shape);
    shape.normal.setZero();
    gradient.setZero();
    shape.rss = 0;
    shape.used = shape.on_arc = 0;
    shape.on_straight = {};
    Vector5 row;
    Where where;
    for (int i = from_; i <= to_; ++i) {
        if (!keep_[std::size_t(i - from_)]) continue;
        const double e = residual(shape, ends, i, row, where);
        shape.normal.noalias() += row * row.transpose();
        gradient += e * row;
        shape.rss += e * e;
        ++shape.used;
        if (where == Where::arc)
            ++shape.on_arc;
        else
            ++shape.on_straight[where == Where::left ? left : right];
    }
    if (known_) shape.normal(2, 2) = 1;
    for (const Side side : {left, right})
        if (!shape.straight[side]) shape.normal(3 + side, 3 + side) = 1;
}

// Gauss-Newton, damped (Levenberg, Marquardt): where an end has few points beyond it the sum of squares is far from its
// parabola. False: an end ran out of the points.
bool ArcFit::minimise(Shape& shape, int rounds) const {
    Vector5 gradient, next_gradient;
    sum(shape, gradient);
    double damping = 1e-4;
    for (int round = 0; round < rounds; ++round) {
        Matrix5 damped = shape.normal;
        damped.diagonal() *= 1 + damping;
        damped.diagonal().array() += 1e-12;
        Vector5 step = -damped.ldlt().solve(gradient);
        if (!step.allFinite()) return false;
        const double most = std::max(step.head<3>().norm() / (kSteps[0] * shape.p[2]),
                                     step.tail<2>().cwiseAbs().maxCoeff() / kSteps[1]);
        if (most > 1) step /= most;
        Shape next = shape;
        next.p += step;
        if (!(next.p[2] > 0)) return false;
        sum(next, next_gradient);
        if (next.rss <= shape.rss) {
            shape = next;
            gradient = next_gradient;
            damping = std::max(damping * 0.1, 1e-9);
            if (step.norm() < kSettled * (1 + shape.p[2])) break;
        } else {
            damping *= 10;
            if (damping > 1e6) break;
        }
    }
    // Where the sum of squares no longer tells two places apart its gradient still does.
    for (int round = 0; round < 2; ++round) {
        const Vector5 step = -shape.normal.ldlt().solve(gradient);
        if (!step.allFinite() || step.norm() > kNear * (1 + shape.p[2])) break;
        shape.p += step;
        sum(shape, gradient);
    }
    if (shape.on_arc < kFewestForArcFit) return false;
    for (const Side side : {left, right})
        if (shape.straight[side] &&
            (shape.on_straight[side] < kFewestForStraight || !(std::abs(shape.p[3 + side]) < kWidest)))
            return false;
    return shape.p[3] + shape.p[4] > 0 && shape.p.allFinite();
}

bool ArcFit::choose_points(const Shape& shape) {
    const Ends ends(*this, shape);
    Vector5 row;
    Where where;
    scratch_.clear();
    for (int i = from_; i <= to_; ++i) scratch_.push_back(std::abs(residual(shape, ends, i, row, where)));
    const auto middle = scratch_.begin() + static_cast<std::ptrdiff_t>(scratch_.size() / 2);
    std::nth_element(scratch_.begin(), middle, scratch_.end());
    const double gate = std::max(kGate * std::max(kMadToSigma * *middle, 0.5 * least_), kLeastGate_mm);
    bool changed = false;
    for (int i = from_; i <= to_; ++i) {
        const std::uint8_t now = std::abs(residual(shape, ends, i, row, where)) <= gate;
        changed |= now != keep_[std::size_t(i - from_)];
        keep_[std::size_t(i - from_)] = now;
    }
    return changed;
}

bool ArcFit::settle(Shape& shape) {
    for (int round = 0; round < 6; ++round) {
        if (!choose_points(shape) && round > 0) break;
        if (!minimise(shape, 8)) return false;
    }
    return minimise(shape, 20);
}

// The outermost point of the piece within `length` of the arc's end.
int ArcFit::reach(const ArcPlace& place, Side side, double length) const {
    const int end = side == left ? place.first : place.last, step = side == left ? -1 : 1;
    int i = end;
    while (i + step >= place.from && i + step <= place.to &&
           std::hypot(x_[i + step] - x_[end], z_[i + step] - z_[end]) <= length)
        i += step;
    return i;
}

double ArcFit::end_of_data(const Shape& shape, Side side) const {
    const int i = side == left ? from_ : to_;
    const double sign = side == left ? -turn_ : turn_;
    double off =
        sign * std::remainder(std::atan2(z_[i] - shape.p[1], x_[i] - shape.p[0]) - towards_, 2 * kPi);
    if (off < -0.5 * kPi) off += 2 * kPi;
    return off;
}

// From several guesses of where the arc ends.
bool ArcFit::try_straights(const ArcPlace& place, std::array<bool, 2> may, Shape& best) {
    static constexpr double kGuesses[] = {0.12, 0.35, 0.6};  // of the way from the middle to the arc's end
    bool found = false;
    const auto end_of_arc = [&](Side side) {
        const int i = side == left ? place.first : place.last;
        const double sign = side == left ? -turn_ : turn_;
        return sign *
               std::remainder(
                   std::atan2(z_[i] - place.circle.centre.y(), x_[i] - place.circle.centre.x()) - towards_,
                   2 * kPi);
    };
    for (int guess = 0; guess < 9; ++guess) {
        const std::array<int, 2> which{guess % 3, guess / 3};
        if ((which[left] && !may[left]) || (which[right] && !may[right])) continue;
        Shape shape;
        shape.straight = may;
        shape.p << place.circle.centre, place.circle.radius, 0, 0;
        for (const Side side : {left, right})
            if (may[side]) shape.p[3 + side] = end_of_arc(side) * (1 - kGuesses[which[side]]);
        std::fill(keep_.begin(), keep_.end(), std::uint8_t(1));
        if (!minimise(shape, 15)) continue;
        if (!found || shape.rss < best.rss) best = shape;
        found = true;
    }
    return found;
}

// Of a straight that is not the tangent a shift is seen, of one that is bent a square: each by its score, what one more
// unknown would take from the sum of squares.
ArcFit::Found ArcFit::check(const Shape& shape, Side side) const {
    const Where of_side = side == left ? Where::left : Where::right;
    const double end = towards_ + (side == left ? -turn_ : turn_) * shape.p[3 + side];
    Eigen::Matrix<double, 5, 2> shared = Eigen::Matrix<double, 5, 2>::Zero();
    Eigen::Vector2d own = Eigen::Vector2d::Zero(), score = Eigen::Vector2d::Zero();
    int there = 0, kept = 0;
    const Ends ends(*this, shape);
    Vector5 row;
    Where where;
    for (int i = from_; i <= to_; ++i) {
        const double e = residual(shape, ends, i, row, where);
        if (where != of_side) continue;
        ++there;
        if (!keep_[std::size_t(i - from_)]) continue;
        ++kept;
        const double t =
            (-std::sin(end) * (x_[i] - shape.p[0]) + std::cos(end) * (z_[i] - shape.p[1])) / shape.p[2];
        const Eigen::Vector2d more(1, t * t);
        shared += row * more.transpose();
        own += more.cwiseAbs2();
        score += e * more;
    }
    if (kept < kKept * there) return Found::kink;
    const Eigen::LDLT<Matrix5> solver(shape.normal);
    const double sigma2 = apart_ * std::max(shape.rss / std::max(1, shape.used - shape.unknowns(known_)),
                                            kLeastGate_mm * kLeastGate_mm);
    for (int k = 0; k < 2; ++k) {
        const double left_over = own[k] - shared.col(k).dot(solver.solve(shared.col(k)));
        if (!(left_over > 1e-9 * own[k])) continue;
        if (score[k] * score[k] > kKink * kKink * sigma2 * left_over)
            return k == 0 ? Found::kink : Found::curved;
    }
    return Found::tangent;
}

void ArcFit::average(const Shape& fullest, const ProfileNoise& noise, FittedArc& fitted) {
    std::array<Shape, 4> shapes;
    constexpr double kNone = -std::numeric_limits<double>::infinity();
    std::array<double, 4> weights{kNone, kNone, kNone, kNone};  // their logarithms first
    Vector5 row;
    Where where;
    const Ends ends(*this, fullest);
    const int unknowns = fullest.unknowns(known_), freedom = std::max(1, fullest.used - unknowns);
    scratch_.clear();
    for (int i = from_; i <= to_; ++i)
        if (keep_[std::size_t(i - from_)]) scratch_.push_back(residual(fullest, ends, i, row, where));
    const PooledSigma pooled = pooled_sigma(std::sqrt(fullest.rss / freedom), freedom, noise);
    const double alike = alike_widening(scratch_, unknowns, noise);
    const double one = std::max(pooled.sigma_mm * pooled.sigma_mm, kLeastGate_mm * kLeastGate_mm);
    const double sigma2 = one * pooled.widening * alike;
    for (int k = 0; k < 4; ++k) {
        const std::array<bool, 2> straight{(k & 1) != 0, (k & 2) != 0};
        if ((straight[left] && !fullest.straight[left]) || (straight[right] && !fullest.straight[right]))
            continue;
        Shape& shape = shapes[std::size_t(k)];
        shape = fullest;
        shape.straight = straight;
        if (straight != fullest.straight && !minimise(shape, 20)) continue;
        const double worse = (shape.rss - fullest.rss) / (one * std::max(alike, 1.0));
        weights[std::size_t(k)] = -0.5 * worse - kUnknown * (shape.unknowns(known_) - unknowns);
    }
    const double most = *std::max_element(weights.begin(), weights.end());  // the fullest's own is finite
    double all = 0;
    for (double& w : weights) all += w = std::exp(w - most);
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (int k = 0; k < 4; ++k)
        if (weights[std::size_t(k)] > 0)
            mean += weights[std::size_t(k)] / all * shapes[std::size_t(k)].p.head<3>();
    fitted.covariance.setZero();
    fitted.within.setZero();
    fitted.arc = fitted.rms = 0;
    for (int k = 0; k < 4; ++k) {
        const double w = weights[std::size_t(k)] / all;
        if (!(w > 0)) continue;
        const Shape& shape = shapes[std::size_t(k)];
        const Eigen::Vector2d off = shape.p.head<2>() - mean.head<2>();
        fitted.within +=
            w * sigma2 * Matrix5(shape.normal.ldlt().solve(Matrix5::Identity())).topLeftCorner<2, 2>();
        fitted.covariance += w * off * off.transpose();
        for (const Side side : {left, right})
            fitted.arc += w * (shape.straight[side] ? shape.p[3 + side] : end_of_data(shape, side));
        fitted.rms += w * std::sqrt(shape.rss / shape.used);
    }
    fitted.covariance += fitted.within;
    fitted.circle = {mean.head<2>(), mean[2]};
    fitted.used = fullest.used;
}

bool ArcFit::fit_at(const ArcPlace& place, Shape& shape) {
    middle_ = (place.first + place.last) / 2;
    double turned = 0;
    const auto angle = [&](int i) {
        return std::atan2(z_[i] - place.circle.centre.y(), x_[i] - place.circle.centre.x());
    };
    const double first = angle(place.first), last = angle(place.last);
    towards_ = angle(middle_);
    turned = std::remainder(towards_ - first, 2 * kPi) + std::remainder(last - towards_, 2 * kPi);
    turn_ = turned < 0 ? -1 : 1;
    if (!(std::abs(turned) < 1.7 * kPi) || place.last - place.first + 1 < 2 * kFewestForArcFit) return false;
    const double length = std::abs(turned) * place.circle.radius;
    std::array<double, 2> share{kReach, kReach};
    std::array<bool, 2> may{true, true};
    shape = {};
    for (;;) {
        // A straight that is none: the arc's last points, where the contour goes on, may not be round.
        const auto end = [&](Side side) {
            const int arc_end = side == left ? place.first : place.last;
            if (may[side]) return reach(place, side, share[side] * length);
            const bool goes_on = side == left ? place.first > place.from : place.last < place.to;
            const int cut = goes_on ? std::max(2, int(0.06 * (place.last - place.first))) : 0;
            return side == left ? arc_end + cut : arc_end - cut;
        };
        from_ = end(left);
        to_ = end(right);
        keep_.assign(std::size_t(to_ - from_ + 1), 1);
        bool again = false;
        if (!may[left] && !may[right]) return false;
        if (!try_straights(place, may, shape) || !settle(shape)) {
            // Without the one or the other.
            bool found = false;
            for (const Side side : {left, right}) {
                if (!may[side] || !may[1 - side]) continue;
                std::array<bool, 2> one = may;
                one[side] = false;
                keep_.assign(keep_.size(), 1);
                Shape other;
                if (!try_straights(place, one, other) || !settle(other)) continue;
                if (!found || other.rss / other.used < shape.rss / shape.used) shape = other;
                found = true;
            }
            if (!found) return false;
            may = shape.straight;
            continue;
        }
        for (const Side side : {left, right}) {
            if (!may[side] || !shape.straight[side]) continue;
            const Found is = check(shape, side);
            if (is == Found::tangent) continue;
            again = true;
            share[side] *= 0.5;
            if (is == Found::kink || share[side] < kShortest) may[side] = false;
        }
        if (!again) break;
    }
    return true;
}

// Where the arc was taken to be a straight counts as a part of it, or one of its ends is cut off: once it is known better, again.
bool ArcFit::fit(std::span<const double> x, std::span<const double> z, ArcPlace place, bool known,
                 const ProfileNoise& noise, FittedArc& fitted) {
    x_ = x;
    z_ = z;
    known_ = known;
    least_ = noise.point_mm;
    apart_ = noise.apart();
    Shape shape;
    bool found = false;
    for (int round = 0; round < 3; ++round) {
        if (!fit_at(place, shape)) {
            if (!found) return false;
            fit_at(before_, shape);
            break;
        }
        found = true;
        before_ = place;
        Vector5 row;
        Where where;
        const Ends ends(*this, shape);
        ArcPlace next{shape.circle(), to_, from_, place.from, place.to};
        for (int i = from_; i <= to_; ++i) {
            residual(shape, ends, i, row, where);
            if (where != Where::arc || !keep_[std::size_t(i - from_)]) continue;
            next.first = std::min(next.first, i);
            next.last = std::max(next.last, i);
        }
        const int moved = std::abs(next.first - place.first) + std::abs(next.last - place.last);
        place = next;
        if (moved <= kMoved * (next.last - next.first)) break;
    }
    average(shape, noise, fitted);
    return true;
}

}  // namespace seamwright
