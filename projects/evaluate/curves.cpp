#include "projects/evaluate/curves.h"
#include "projects/evaluate/spread.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace seamwright::evaluation {
namespace {

constexpr int kRepeatsPerPlace = 10;
constexpr double kStepMm = 2.5, kMostMm = 10;

// x of r - W^-1 D^-1 W m, with the curve's x(y) added when asked for: residual of core/correction at a known
// D.
double across_mm(const SpotObservation& o, const Pose& displacement, bool learnt) {
    const Pose& w = o.workobject_from_sensor;
    const Eigen::Vector3d back = w.inverse() * (displacement.inverse() * (w * o.measured_mm));
    const Eigen::Vector3d e = o.reference_mm - back;
    if (!learnt) return e.x();
    const double y = -e.y();
    return e.x() + o.curve->x_coefficients.dot(Eigen::Vector3d(y, y * y, y * y * y));
}

double largest_deviation(const std::vector<TaughtSpot>& spots, const std::vector<Eigen::Vector3d>& sum,
                         int count) {
    double most = 0;
    for (std::size_t n = 0; n < spots.size(); ++n) most = std::max(most, sum[n].norm() / std::max(1, count));
    return most;
}

}  // namespace

Expected<CurvedContour> curved_contour(const EvaluationSettings& settings, double radius_mm,
                                       std::atomic<std::size_t>& profiles) {
    const Cell cell = curved_cell(settings, radius_mm, profiles);
    const Method method{3, "curved contour", true, false, false};
    SEAM_TRY(const auto taught, teach_all(cell, method));
    const std::vector<TaughtSpot>& spots = taught.spots;

    CurvedContour out;
    out.radius_mm = radius_mm;
    for (double e = -kMostMm; e <= kMostMm; e += kStepMm) out.steps.push_back({e});
    struct Sums {
        std::array<std::vector<double>, 2> across;  // straight, learnt; per spot
        std::array<std::vector<Eigen::Vector3d>, 2> deviation;
        std::array<int, 2> solved{};
        std::vector<double> squares;  // of the learnt one; per spot
    };
    const auto worker = [&] {
        return [&, measurers = std::make_shared<Measurers>(make_measurers(taught)),
                frame = std::make_shared<Frame>()](std::size_t i) {
            Random random(hash64(settings.seed, static_cast<std::uint64_t>(radius_mm)), i);
            CurveStep& step = out.steps[i];
            const double e = step.displacement_mm;
            step.expected_mm = radius_mm - std::sqrt(radius_mm * radius_mm - e * e);
            Pose truth = Pose::Identity();
            truth.translation().x() = e;
            Sums sums;
            for (auto& a : sums.across) a.assign(spots.size(), 0);
            sums.squares.assign(spots.size(), 0);
            for (auto& d : sums.deviation) d.assign(spots.size(), Eigen::Vector3d::Zero());
            for (int k = 0; k < kRepeatsPerPlace; ++k) {
                std::vector<SpotObservation> observed;
                for (std::size_t n = 0; n < spots.size(); ++n) {
                    const SpotMeasurement& m =
                        measure_spot(cell, method, spots[n], n, (*measurers)[n], truth, random, *frame);
                    if (m.status != SpotStatus::measured) continue;
                    SpotObservation o = observation_of(spots[n], m);
                    sums.across[0][n] += across_mm(o, truth, false) / kRepeatsPerPlace;
                    const double learnt = across_mm(o, truth, true);
                    sums.across[1][n] += learnt / kRepeatsPerPlace;
                    sums.squares[n] += learnt * learnt / kRepeatsPerPlace;
                    observed.push_back(std::move(o));
                }
                for (const std::size_t way : {1, 0}) {  // learnt first: the curve is dropped for the other
                    if (way == 0)
                        for (SpotObservation& o : observed) o.curve.reset();
                    // As stated: a spot that contradicts the straight line is part of what it errs by.
                    CorrectionOptions all;
                    all.reject_outliers = false;
                    const auto solved = solve_region(observed, all);
                    if (!solved || solved->status != CorrectionStatus::ok) continue;
                    ++sums.solved[way];
                    for (std::size_t n = 0; n < spots.size(); ++n)
                        sums.deviation[way][n] +=
                            solved->displacement.workobject_from_movedworkobject * spots[n].landmark -
                            truth * spots[n].landmark;
                }
            }
            int along = 0;
            double variance = 0;  // of the sum over the spots
            for (std::size_t n = 0; n < spots.size(); ++n) {
                const Pose& w = spots[n].workobject_from_sensor;
                if (std::abs(w.linear()(0, 1)) < 0.5) continue;  // its contour runs along Y
                ++along;
                // A contour that bends towards +X at its sensor comes nearer when it slides.
                const double sense = spots[n].spot.curve->x_coefficients[1] >= 0 ? -1 : 1;
                step.straight_mm += sense * sums.across[0][n];
                step.learnt_mm += sense * sums.across[1][n];
                variance +=
                    (sums.squares[n] - sums.across[1][n] * sums.across[1][n]) / (kRepeatsPerPlace - 1);
                step.learnt_worst_mm = std::max(step.learnt_worst_mm, std::abs(sums.across[1][n]));
            }
            step.straight_mm /= along;
            step.learnt_mm /= along;
            step.sigma_mm = std::sqrt(std::max(0.0, variance)) / along;
            step.region_straight_mm = largest_deviation(spots, sums.deviation[0], sums.solved[0]);
            step.region_learnt_mm = largest_deviation(spots, sums.deviation[1], sums.solved[1]);
        };
    };
    spread_values(settings, profiles, out.steps.size(), worker, [&](PartValue& part, std::size_t i) {
        CurveStep& s = out.steps[i];
        for (double* v : {&s.displacement_mm, &s.expected_mm, &s.straight_mm, &s.learnt_mm, &s.sigma_mm,
                          &s.learnt_worst_mm, &s.region_straight_mm, &s.region_learnt_mm})
            part(*v);
    });
    return out;
}

}  // namespace seamwright::evaluation
