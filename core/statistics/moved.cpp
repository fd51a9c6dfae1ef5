#include "core/statistics/moved.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/acceptance/distributions.h"
#include "core/numbers.h"

namespace seamwright {
namespace {

// 95 % of the likelihood of where a step is: half of the quantile of chi^2 with one degree and something for
// its being a place among few.
constexpr double kStepDrop = 6;
// A car is left out when it lies so far off both neighbours, chi^2 with 6 degrees: one of a million.
constexpr double kOddCar = 38.3;
constexpr double kFarDifference = 22.5;  // one of a thousand
constexpr double kLeastSigma_mm = 1e-6, kLeastSigma_rad = 1e-9;
constexpr double kStatedShare = 1e-6;  // of what is stated: a thousandth, squared
constexpr double kMostAlike = 0.9;     // correlation of one car with the next
constexpr double kRoundedOff = 1e-9;   // of a pattern's length
constexpr double kOneSided95 = 1.645;  // normal quantile

Matrix6 inverse_of(const Matrix6& m) {
    return m.ldlt().solve(Matrix6::Identity());
}

double log_normal(const Vector6& x, const Matrix6& covariance) {
    const Eigen::LLT<Matrix6> llt(covariance);
    const Vector6 white = llt.matrixL().solve(x);
    const Matrix6 factor = llt.matrixL();
    return -0.5 * white.squaredNorm() - factor.diagonal().array().log().sum();
}

// A weighted mean as it grows: sums of W^-1 and W^-1 x.
struct Weighed {
    Matrix6 information = Matrix6::Zero();
    Vector6 moment = Vector6::Zero();
    void add(const Matrix6& weight, const Vector6& x) {
        information += weight;
        moment += weight * x;
    }
    Vector6 mean() const { return information.ldlt().solve(moment); }
};

struct Candidate {
    double statistic = 0;
    Change change;
};
// By the degrees of freedom that the change was looked for with: 1 to 3 along what an element can do, 6 of any motion.
using Candidates = std::array<Candidate, 7>;
using Statistics = std::array<double, 7>;

class Diagnosing {
  public:
    Diagnosing(std::span<const CarLies> cars, std::size_t carriers, std::span<const Pattern> patterns,
               const DiagnosisOptions& options)
        : cars_(cars), patterns_(patterns), options_(options), of_carrier_(carriers), at_(cars.size()) {
        for (std::size_t k = 0; k < cars.size(); ++k) {
            assert(cars[k].carrier < carriers);
            of_carrier_[cars[k].carrier].push_back(k);
            at_[k] = cars[k].at;
        }
    }

    Diagnosis run() {
        out_.cars = cars_.size();
        if (!learn_scatter()) {
            out_.status = DiagnosisStatus::too_few;
            return std::move(out_);
        }
        leave_out_odd_cars();
        learn_scatter();
        weigh();
        while (out_.changes.size() < options_.most) {
            auto found = best();
            if (!found) break;
            take_off(*found);
            attribute(*found);
            out_.changes.push_back(std::move(*found));
        }
        effects();
        return std::move(out_);
    }

  private:
    // V from the differences of cars that follow each other in a carrier.
    bool learn_scatter() {
        std::vector<Vector6> steps;
        Matrix6 stated = Matrix6::Zero();
        std::vector<std::size_t> begins;  // of a carrier's differences in `steps`
        std::size_t count = 0;
        for (const auto& list : of_carrier_) {
            begins.push_back(steps.size());
            for (std::size_t i = 0; i + 1 < list.size(); ++i)
                steps.push_back((at_[list[i + 1]] - at_[list[i]]) / std::sqrt(2.0));
            for (const std::size_t k : list) stated += cars_[k].covariance, ++count;
        }
        out_.differences = steps.size();
        if (steps.size() < kFewestDifferences) return false;
        stated /= static_cast<double>(count);
        Matrix6 scatter = robust_start(steps);
        std::vector<bool> near(steps.size(), true);
        for (int round = 0; round < 8; ++round) {
            const Matrix6 weight = inverse_of(scatter);
            Matrix6 sum = Matrix6::Zero();
            std::size_t used = 0;
            for (std::size_t i = 0; i < steps.size(); ++i) {
                near[i] = steps[i].dot(weight * steps[i]) < kFarDifference;
                if (near[i]) sum += steps[i] * steps[i].transpose(), ++used;
            }
            if (used < kFewestDifferences) return false;
            scatter = floored(sum / static_cast<double>(used), stated);
            degrees_ = 2.0 / 3 * static_cast<double>(used);  // differences overlap by half
        }
        correlation(steps, begins, near, inverse_of(scatter));
        // Where the measurement is stated to scatter more than all does, it is the truth: nothing of the parts.
        const Eigen::LLT<Matrix6> llt(scatter);
        Matrix6 share = llt.matrixL().solve(stated);
        share = llt.matrixL().solve(share.transpose().eval());
        const Eigen::SelfAdjointEigenSolver<Matrix6> solved(0.5 * (share + share.transpose()));
        const Vector6 left = (1 - solved.eigenvalues().array()).cwiseMax(0.0);
        const Matrix6 factor = Matrix6(llt.matrixL()) * solved.eigenvectors();
        out_.part_covariance = factor * left.asDiagonal() * factor.transpose();
        out_.car_covariance = out_.part_covariance + stated;
        return true;
    }

    // By coordinates, from medians: what single cars that lie far off do nothing to.
    static Matrix6 robust_start(const std::vector<Vector6>& steps) {
        Matrix6 start = Matrix6::Zero();
        std::vector<double> values(steps.size());
        for (int axis = 0; axis < 6; ++axis) {
            for (std::size_t i = 0; i < steps.size(); ++i) values[i] = std::abs(steps[i](axis));
            const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
            std::nth_element(values.begin(), middle, values.end());
            const double sigma = std::max(kMadToSigma * *middle, axis < 3 ? kLeastSigma_mm : kLeastSigma_rad);
            start(axis, axis) = 4 * sigma * sigma;  // wide: correlated directions are not cut off
        }
        return start;
    }

    // A scatter that is none in some direction (rounded poses, copies) is held at a thousandth of what is stated.
    static Matrix6 floored(Matrix6 scatter, const Matrix6& stated) {
        scatter += kStatedShare * stated;
        scatter.diagonal().head<3>().array() += kLeastSigma_mm * kLeastSigma_mm;
        scatter.diagonal().tail<3>().array() += kLeastSigma_rad * kLeastSigma_rad;
        return scatter;
    }

    // c of the differences is -(1 - r) / 2 where the cars' own is r.
    void correlation(const std::vector<Vector6>& steps, const std::vector<std::size_t>& begins,
                     const std::vector<bool>& near, const Matrix6& weight) {
        double product = 0, square = 0;
        for (std::size_t c = 0; c < begins.size(); ++c) {
            const std::size_t end = c + 1 < begins.size() ? begins[c + 1] : steps.size();
            for (std::size_t i = begins[c]; i + 1 < end; ++i) {
                if (!near[i] || !near[i + 1]) continue;
                product += steps[i].dot(weight * steps[i + 1]);
                square += 0.5 * (steps[i].dot(weight * steps[i]) + steps[i + 1].dot(weight * steps[i + 1]));
            }
        }
        out_.correlation = square > 0 ? std::clamp(1 + 2 * product / square, 0.0, kMostAlike) : 0;
        // Of no correlation it scatters about 0 by this; what is within is none.
        if (out_.correlation < 2 * 2 / std::sqrt(6 * static_cast<double>(steps.size()))) out_.correlation = 0;
        inflation_ = (1 + out_.correlation) / (1 - out_.correlation);
    }

    void leave_out_odd_cars() {
        const Matrix6 weight = inverse_of(1.5 * out_.car_covariance);  // against the mean of two
        std::vector<bool> odd(cars_.size(), false);
        for (const auto& list : of_carrier_)
            for (std::size_t i = 1; i + 1 < list.size(); ++i) {
                const Vector6 off = at_[list[i]] - 0.5 * (at_[list[i - 1]] + at_[list[i + 1]]);
                const Vector6 sides = at_[list[i + 1]] - at_[list[i - 1]];
                // Between a step's two sides the middle is off both: then it is the step that is far.
                if (off.dot(weight * off) > kOddCar && sides.dot(weight * sides) < kFarDifference)
                    odd[list[i]] = true;
            }
        for (auto& list : of_carrier_)
            out_.odd_cars += std::erase_if(list, [&](std::size_t k) { return odd[k]; });
    }

    void weigh() {
        weight_.resize(cars_.size());
        for (const auto& list : of_carrier_)
            for (const std::size_t k : list) {
                weight_[k] = inverse_of(out_.part_covariance + cars_[k].covariance);
                used_.push_back(k);
            }
        std::ranges::sort(used_);
    }

    // What a step after the first i cars of a carrier tells: its information and the difference of the means.
    struct Told {
        Matrix6 information = Matrix6::Zero();
        Vector6 moment = Vector6::Zero();  // information times difference
    };
    static Told told_by(const Weighed& before, const Weighed& all) {
        const Matrix6 after = all.information - before.information;
        // B (A + B)^-1 A
        const Matrix6 information = before.information * all.information.ldlt().solve(after);
        const Vector6 difference =
            after.ldlt().solve(all.moment - before.moment) - before.information.ldlt().solve(before.moment);
        const Matrix6 symmetric = 0.5 * (information + information.transpose());
        return {symmetric, symmetric * difference};
    }

    // Of any motion, and of what each element can do, the most telling with as many directions.
    Statistics statistics_of(const Told& told, Moved what) {
        Statistics all{};
        all[6] = told.moment.dot(told.information.ldlt().solve(told.moment));
        ++tried_;
        if (what == Moved::cell && !options_.one_fixture) return all;
        for (const Pattern& pattern : patterns_) {
            const Eigen::VectorXd moment = pattern.transpose() * told.moment;
            const Eigen::MatrixXd information = pattern.transpose() * told.information * pattern;
            auto& best = all[static_cast<std::size_t>(moment.size())];
            best = std::max(best, moment.dot(information.ldlt().solve(moment)));
            ++tried_;
        }
        return all;
    }

    static void take(Candidates& best, const Statistics& statistics, const Told& told, const Change& as) {
        for (std::size_t degrees = 1; degrees < best.size(); ++degrees) {
            if (!(statistics[degrees] > best[degrees].statistic)) continue;
            const Eigen::LDLT<Matrix6> solver(told.information);
            best[degrees].statistic = statistics[degrees];
            best[degrees].change = as;
            best[degrees].change.motion = solver.solve(told.moment);
            best[degrees].change.covariance = solver.solve(Matrix6::Identity());
        }
    }

    // Of the cars `lists`, a carrier each, all that they tell of one step at every time.
    void steps_of(const std::vector<std::size_t>& carriers, Moved what, Candidates& best) {
        std::vector<Weighed> all(of_carrier_.size()), before(of_carrier_.size());
        std::vector<std::size_t> seen(of_carrier_.size(), 0), order;
        std::vector<Told> told(of_carrier_.size());
        for (const std::size_t c : carriers)
            for (const std::size_t k : of_carrier_[c]) {
                all[c].add(weight_[k], at_[k]);
                order.push_back(k);
            }
        std::ranges::sort(order);
        Told sum;
        std::vector<std::pair<std::size_t, Statistics>> course;  // first car after
        Candidates own;
        for (std::size_t i = 0; i + 1 < order.size(); ++i) {
            const std::size_t c = cars_[order[i]].carrier;
            before[c].add(weight_[order[i]], at_[order[i]]);
            ++seen[c];
            sum.information -= told[c].information;
            sum.moment -= told[c].moment;
            const bool enough = seen[c] >= kFewestCars && of_carrier_[c].size() - seen[c] >= kFewestCars;
            told[c] = enough ? told_by(before[c], all[c]) : Told{};
            sum.information += told[c].information;
            sum.moment += told[c].moment;
            if (told[c].information.isZero(0) && carriers.size() == 1) continue;
            if (std::ranges::all_of(carriers,
                                    [&](std::size_t each) { return told[each].information.isZero(0); }))
                continue;
            Change as;
            as.what = what;
            as.carrier = c;
            as.first_car = order[i + 1];
            const Statistics statistics = statistics_of(sum, what);
            course.emplace_back(as.first_car, statistics);
            take(own, statistics, sum, as);
        }
        for (std::size_t degrees = 1; degrees < own.size(); ++degrees) {
            Candidate& found = own[degrees];
            if (!(found.statistic > best[degrees].statistic)) continue;
            found.change.earliest = found.change.latest = found.change.first_car;
            for (const auto& [car, statistics] : course)
                if (statistics[degrees] > found.statistic - kStepDrop * inflation_) {
                    found.change.earliest = std::min(found.change.earliest, car);
                    found.change.latest = std::max(found.change.latest, car);
                }
            best[degrees] = found;
        }
    }

    // A line in time, each carrier about a mean of its own.
    void trend_of(const std::vector<std::size_t>& carriers, Moved what, Candidates& best) {
        double first = std::numeric_limits<double>::infinity(), last = -first;
        Told told;
        std::size_t count = 0;
        std::size_t first_car = cars_.size();
        for (const std::size_t c : carriers) {
            Matrix6 weight = Matrix6::Zero(), by_day = Matrix6::Zero(), by_day2 = Matrix6::Zero();
            Vector6 moment = Vector6::Zero(), moment_day = Vector6::Zero();
            for (const std::size_t k : of_carrier_[c]) {
                const double day = cars_[k].day - cars_.front().day;
                weight += weight_[k];
                by_day += weight_[k] * day;
                by_day2 += weight_[k] * (day * day);
                const Vector6 m = weight_[k] * at_[k];
                moment += m;
                moment_day += m * day;
                first = std::min(first, day), last = std::max(last, day);
                first_car = std::min(first_car, k);
                ++count;
            }
            if (of_carrier_[c].size() < 2 * kFewestCars) continue;
            const Matrix6 centre = by_day.transpose() * weight.ldlt().solve(Matrix6::Identity());
            told.information += by_day2 - centre * by_day;
            told.moment += moment_day - centre * moment;
        }
        const double span = last - first;
        if (count < 4 * kFewestCars || !(span > 0)) return;
        told.information /= span * span;  // of what it makes over the whole time
        told.moment /= span;
        told.information = 0.5 * (told.information + told.information.transpose()).eval();
        if (!(told.information.ldlt().vectorD().minCoeff() > 0)) return;
        Change as;
        as.what = what;
        as.how = MovedBy::trend;
        as.carrier = carriers.front();
        as.first_car = as.earliest = as.latest = first_car;
        take(best, statistics_of(told, what), told, as);
    }

    std::optional<Change> best() {
        tried_ = 0;
        std::vector<std::size_t> all;
        for (std::size_t c = 0; c < of_carrier_.size(); ++c)
            if (!of_carrier_[c].empty()) all.push_back(c);
        Candidates found;
        const Moved of_all = all.size() == 1 && !options_.one_fixture ? Moved::carrier : Moved::cell;
        steps_of(all, of_all, found);
        trend_of(all, of_all, found);
        if (all.size() > 1)
            for (const std::size_t c : all) {
                steps_of({c}, Moved::carrier, found);
                trend_of({c}, Moved::carrier, found);
            }
        std::optional<Change> best;
        for (std::size_t m = 1; m < found.size(); ++m) {
            if (!(found[m].statistic > 0)) continue;
            const auto with = static_cast<double>(m);
            const double degrees = std::max(degrees_ - with + 1, 1.0);
            const double f = found[m].statistic / inflation_ * degrees / (degrees_ * with);
            const double probability = std::min(1.0, f_upper(with, degrees, f) * static_cast<double>(tried_));
            if (!(probability < options_.alarm) || (best && best->probability <= probability)) continue;
            best = found[m].change;
            best->statistic = found[m].statistic / inflation_;
            best->probability = probability;
        }
        if (best) best->covariance *= inflation_;
        return best;
    }

    void take_off(const Change& change) {
        double first = 0, last = 0;
        if (change.how == MovedBy::trend) {
            first = std::numeric_limits<double>::infinity(), last = -first;
            for (const std::size_t k : used_)
                if (concerns(change, k)) {
                    first = std::min(first, cars_[k].day);
                    last = std::max(last, cars_[k].day);
                }
        }
        for (const std::size_t k : used_) {
            if (!concerns(change, k)) continue;
            if (change.how == MovedBy::trend)
                at_[k] -= change.motion * ((cars_[k].day - first) / (last - first));
            else if (k >= change.first_car)
                at_[k] -= change.motion;
        }
    }
    bool concerns(const Change& change, std::size_t car) const {
        return change.what == Moved::cell || cars_[car].carrier == change.carrier;
    }

    void attribute(Change& change) const {
        if (patterns_.empty() || (change.what == Moved::cell && !options_.one_fixture)) return;
        constexpr double prior2 = kMovedPrior * kMovedPrior;
        std::vector<double> logs;
        Matrix6 together = change.covariance;
        for (const Pattern& pattern : patterns_) {
            const Matrix6 spread = prior2 * pattern * pattern.transpose();
            together += spread;
            logs.push_back(std::log(kAlone / static_cast<double>(patterns_.size())) +
                           log_normal(change.motion, change.covariance + spread));
        }
        logs.push_back(std::log(1 - kAlone) + log_normal(change.motion, together));
        const double most = *std::ranges::max_element(logs);
        double sum = 0;
        for (double& l : logs) sum += l = std::exp(l - most);
        const Matrix6 weight = inverse_of(change.covariance);
        for (std::size_t e = 0; e < patterns_.size(); ++e) {
            const Eigen::MatrixXd information = patterns_[e].transpose() * weight * patterns_[e];
            const Eigen::MatrixXd covariance =
                information.ldlt().solve(Eigen::MatrixXd::Identity(information.rows(), information.cols()));
            ElementMoved moved;
            moved.element = e;
            moved.probability = logs[e] / sum;
            moved.amount_mm = covariance * (patterns_[e].transpose() * weight * change.motion);
            moved.sigma_mm = covariance.diagonal().cwiseMax(0).cwiseSqrt();
            change.elements.push_back(std::move(moved));
        }
        change.several = logs.back() / sum;
        std::ranges::stable_sort(change.elements, std::greater<>{}, &ElementMoved::probability);
    }

    // Each carrier against the mean of all, one vote each.
    void effects() {
        out_.carriers.resize(of_carrier_.size());
        Vector6 mean = Vector6::Zero();
        double count = 0;
        for (std::size_t c = 0; c < of_carrier_.size(); ++c) {
            CarrierEffect& effect = out_.carriers[c];
            effect.cars = of_carrier_[c].size();
            if (of_carrier_[c].empty()) continue;
            Weighed all;
            for (const std::size_t k : of_carrier_[c]) all.add(weight_[k], at_[k]);
            effect.motion = all.mean();
            effect.covariance = inflation_ * inverse_of(all.information);
            mean += effect.motion;
            ++count;
        }
        if (count > 0)
            for (CarrierEffect& effect : out_.carriers)
                if (effect.cars > 0) effect.motion -= mean / count;
    }

    std::span<const CarLies> cars_;
    std::span<const Pattern> patterns_;
    const DiagnosisOptions& options_;
    std::vector<std::vector<std::size_t>> of_carrier_;  // cars in the order of time, odd ones left out
    std::vector<std::size_t> used_;
    std::vector<Vector6> at_;  // changes taken off
    std::vector<Matrix6> weight_;
    double degrees_ = 0, inflation_ = 1;
    std::size_t tried_ = 0;
    Diagnosis out_;
};

}  // namespace

FixturePatterns fixture_patterns(std::span<const HoldingElement> elements) {
    FixturePatterns out;
    Eigen::Vector3d centre = Eigen::Vector3d::Zero();
    for (const HoldingElement& e : elements) centre += e.at_mm / static_cast<double>(elements.size());
    double size = 1;
    for (const HoldingElement& e : elements) size = std::max(size, (e.at_mm - centre).norm());
    Eigen::Index rows = 0;
    for (const HoldingElement& e : elements) rows += static_cast<Eigen::Index>(e.directions.size());
    // About the elements' middle, rotations as what they make at its size: rows of one length.
    Eigen::MatrixXd held(rows, 6);
    Eigen::Index row = 0;
    for (const HoldingElement& e : elements)
        for (const Eigen::Vector3d& n : e.directions)
            held.row(row++) << n.transpose(), ((e.at_mm - centre).cross(n) / size).transpose();
    Matrix6 to_origin =
        Matrix6::Identity();  // (motion of the middle, turn times size) to (dt, dw) at the origin
    to_origin.topRightCorner<3, 3>() = skew(centre) / size;
    to_origin.bottomRightCorner<3, 3>() /= size;
    const Eigen::JacobiSVD<Eigen::MatrixXd> svd(rows >= 6 ? held : Eigen::MatrixXd(held.transpose() * held),
                                                Eigen::ComputeFullV);
    constexpr double kLoose = 1e-3;  // a millimetre of play where the fixture is a metre
    const auto& values = svd.singularValues();
    if (rows < 6 || values(5) < kLoose * values(0)) {
        out.status = FixtureStatus::loose;
        out.free_motion = to_origin * svd.matrixV().col(5);
        return out;
    }
    const Eigen::MatrixXd answer = held.completeOrthogonalDecomposition().pseudoInverse();
    row = 0;
    for (const HoldingElement& e : elements) {
        const auto count = static_cast<Eigen::Index>(e.directions.size());
        out.elements.emplace_back(to_origin * answer.middleCols(row, count));
        row += count;
    }
    return out;
}

Diagnosis diagnose(std::span<const CarLies> cars, std::size_t carriers, std::span<const Pattern> patterns,
                   const DiagnosisOptions& options) {
    return Diagnosing(cars, carriers, patterns, options).run();
}

double cars_to_tell_apart(const Pattern& one, const Pattern& other, const Matrix6& car_covariance,
                          double amount_mm) {
    const Eigen::LLT<Matrix6> llt(car_covariance);
    const Eigen::MatrixXd a = llt.matrixL().solve(one), b = llt.matrixL().solve(other);
    double least = std::numeric_limits<double>::infinity();
    const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(b);
    for (Eigen::Index i = 0; i < a.cols(); ++i) {
        const Eigen::VectorXd left = a.col(i) - b * qr.solve(a.col(i));
        // What rounding leaves is nothing.
        least = std::min(least, left.norm() < kRoundedOff * a.col(i).norm() ? 0 : left.norm());
    }
    // n cars on either side know a change by 2 W / n; the nearer of two faults is taken wrongly when noise beyond
    // half their distance lies along it, kOneSided95 sigma at 5 %.
    const double distance = least * amount_mm / std::sqrt(2.0);
    return distance > 0 ? std::ceil(std::pow(2 * kOneSided95 / distance, 2))
                        : std::numeric_limits<double>::infinity();
}

}  // namespace seamwright
