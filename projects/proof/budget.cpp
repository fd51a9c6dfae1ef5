#include "projects/proof/budget.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>

#include "core/acceptance/distributions.h"
#include "core/geometry/decompositions.h"
#include "core/geometry/notation.h"
#include "projects/measure/measure.h"
#include "projects/measure/nozzle.h"
#include "projects/measure/reference_feature.h"
#include "projects/proof/forecast.h"
#include "projects/proof/path_direction.h"

namespace seamwright {
namespace {

constexpr double kConfidence = 0.95;

Eigen::Matrix<double, 6, 1> printed(const Pose& d) {
    const KukaAbc abc = kuka_from_rotation(d.linear());
    Eigen::Matrix<double, 6, 1> out;
    out << d.translation(), abc.a_deg, abc.b_deg, abc.c_deg;
    return out;
}

Expected<void> check_displacement(const Region& region, const Pose& d) {
    const Text where("region {}: displacement", region.id);
    const double moved = d.translation().norm(), turned = deg_from_rad(rotation_log(d.linear()).norm());
    if (!(moved <= region.limits.translation_mm && turned <= region.limits.rotation_deg))
        return input_error(
            Text("{:.3f} mm and {:.3f} degrees are beyond the region's limits, the gate refuses "
                 "such a correction",
                 moved, turned),
            where,
            Text("stay within {:g} mm and {:g} degrees", region.limits.translation_mm,
                 region.limits.rotation_deg));
    constexpr double kRounding = 1e-9;
    const auto values = printed(d);
    for (std::size_t i = 0; i < 6; ++i)
        if (!region.free[i] && std::abs(values[static_cast<int>(i)]) > kRounding)
            return input_error(Text("the region keeps {} fixed", std::string(1, "xyzabc"[i])), where,
                               "give a displacement that the region can find");
    return {};
}

Expected<std::vector<BudgetSpot>> spots_of(const Project& project, const Region& region) {
    std::vector<BudgetSpot> all;
    for (SpotObservation& o : planned_observations(project, region)) {
        const Spot& spot = *find_spot(project, o.id);
        if (spot.reference_profile.size() == 0 && spot.reference_mm.isZero(0))
            return input_error(Text("spot {} has no reference", spot.id), Text("region {}", region.id),
                               "measure its reference first");
        BudgetSpot& b = all.emplace_back();
        b.stated_sigma_mm = spot.sigma_mm;
        b.half_window_mm = travel_window_mm(spot);
        if (const int points = points_at_reference(spot); points > kFitted)
            b.feature_degrees = b.reference_degrees = points - kFitted;
        b.spot = std::move(o);
    }
    if (all.empty())
        return input_error(Text("region \"{}\" has no calibrated spot", region.id), {},
                           "teach its spots and calibrate their sensors first");
    return all;
}

std::vector<Text> not_stated(const Project& project, const CorrectionOptions& options,
                             const std::vector<BudgetSpot>& spots) {
    std::vector<Text> out;
    std::map<std::string, bool> robots;
    for (const SensorPrior& p : options.sensors) {
        const bool used = std::any_of(spots.begin(), spots.end(),
                                      [&](const BudgetSpot& b) { return b.spot.sensor == p.id; });
        if (used && p.hand_eye_covariance.isZero(0))
            out.push_back(Text("Sensor {}: its calibration states no covariance of the hand-eye.", p.id));
        if (used && p.scale_sigma.isZero(0) && p.shear_sigma == 0)
            out.push_back(Text("Sensor {}: no uncertainty of its scale and shear is stated.", p.id));
    }
    if (!project.drift || !project.drift->learnt)
        out.push_back(
            Text("No drift watch has learnt its reference: what wanders after the calibration is not "
                 "in the budget."));
    for (const RobotSetup& robot : project.robots)
        if (robot.trigger_latency_ms != 0 && robot.speed_sigma == 0)
            out.push_back(
                Text("Robot {}: it is taken to pass the spots as fast as when they were taught; say with "
                     "--state {}:speed_change=0.1 by what share it may differ.",
                     robot.id, robot.id));
    std::vector<Text> references;
    for (const BudgetSpot& b : spots) {
        if (!b.spot.robot_covariance) robots[find_spot(project, b.spot.id)->robot_id] = true;
        if (!b.spot.reference_covariance_mm2) references.push_back(b.spot.id);
    }
    for (const auto& [id, missing] : robots)
        out.push_back(Text("Robot {}: no repeatability is stated, the spots' own sigma stands for it.", id));
    if (!references.empty())
        out.push_back(
            Text("No reference profile, so no uncertainty of the reference: {}.", listed(references)));
    return out;
}

bool is_of_spot(ErrorSource source) {
    return source <= ErrorSource::robot_taught;
}

bool is_type_a(const Project& project, const BudgetRow& row) {
    if (row.source == ErrorSource::feature || row.source == ErrorSource::reference)
        return std::isfinite(row.degrees);
    if (row.source == ErrorSource::nozzle) return std::isfinite(row.degrees);
    if (row.source != ErrorSource::hand_eye) return false;
    const Calibration* c = calibration_of(project, row.owner);
    return c && c->method != "factory" && c->method != "simulated truth";
}

// A measurand, as far as it is linear in D: its variance of a term.
struct Measure {
    Quantity quantity;
    Vector6 gradient = Vector6::Zero();  // of normal and binormal, by D's tangent
    double variance(const Matrix6& covariance, const DofSigma& sigma) const {
        const int k = static_cast<int>(quantity) - static_cast<int>(Quantity::x);
        if (k < 0) return std::max(0.0, gradient.dot(covariance * gradient));
        const double s = k < 3 ? sigma.xyz_mm[k] : sigma.abc_deg[k - 3];
        return s * s;
    }
};

// d . d(D p) = d . (dt + dw x R p).
Measure measure_at(const PathDirection& at, const Pose& d) {
    Measure m;
    m.quantity = at.normal ? Quantity::normal : Quantity::binormal;
    m.gradient << at.direction, (d.linear() * at.point_mm).cross(at.direction);
    return m;
}

class Tables {
  public:
    Tables(const Project& project, const CorrectionOptions& options, const std::vector<BudgetSpot>& spots,
           const UncertaintyBudget& budget)
        : project_(project), options_(options), spots_(spots), budget_(budget) {}

    // `nozzle`: of the robot that lays the bead; nullptr: none, or the measurand is no bead.
    MeasurandBudget table(const Measure& measure, const Calibration* nozzle = nullptr) const {
        struct Sum {
            BudgetRow row;
            double variance = 0, inputs = 0, n = 0, largest = -1, spread = 0;
        };
        std::map<std::pair<ErrorSource, std::string>, Sum> rows;
        for (const BudgetTerm& term : budget_.terms) {
            const std::string owner = owner_of(term);
            Sum& sum = rows[{term.source, owner}];
            sum.row.source = term.source;
            sum.row.owner = owner;
            const double variance = measure.variance(term.covariance, term.sigma);
            sum.variance += variance;
            sum.inputs += term.input_sigma * term.input_sigma;
            ++sum.n;
            sum.spread += variance * variance / degrees_of(term);
            if (!is_of_spot(term.source) || !(variance > sum.largest)) continue;
            sum.largest = variance;
            sum.row.spot_id = spots_[term.of].spot.id;
        }
        MeasurandBudget out;
        out.quantity = measure.quantity;
        double random = 0, systematic = 0;
        std::vector<MeanSquare> squares;
        if (nozzle) {
            Sum& sum = rows[{ErrorSource::nozzle, nozzle->robot_id}];
            const double sigma = nozzle_sigma_mm(*nozzle);
            sum.row.source = ErrorSource::nozzle;
            sum.row.owner = nozzle->robot_id;
            sum.variance = sum.inputs = sigma * sigma;
            sum.n = 1;
            sum.spread = sum.variance * sum.variance / nozzle->nozzle->degrees;
        }
        for (auto& [key, sum] : rows) {
            BudgetRow& row = sum.row;
            row.u = std::sqrt(sum.variance);
            row.input_u = std::sqrt(sum.inputs / sum.n);
            row.sensitivity = row.input_u > 0 ? row.u / row.input_u : 0;
            if (sum.spread > 0) row.degrees = sum.variance * sum.variance / sum.spread;
            row.type_a = is_type_a(project_, row);
            if (sum.n == 1 || !(sum.variance > 0) || !is_of_spot(row.source)) row.spot_id.clear();
            squares.push_back({sum.variance, row.degrees});
            (is_systematic(row.source) ? systematic : random) += sum.variance;
            out.rows.push_back(row);
        }
        const double all = random + systematic;
        for (BudgetRow& row : out.rows) row.share = all > 0 ? row.u * row.u / all : 0;
        out.u = std::sqrt(all);
        out.u_random = std::sqrt(random);
        out.u_systematic = std::sqrt(systematic);
        out.degrees = satterthwaite_degrees(squares);
        out.k = t_quantile(out.degrees, 0.5 * (1 + kConfidence));
        out.expanded = out.k * out.u;
        return out;
    }

  private:
    std::string owner_of(const BudgetTerm& term) const {
        if (is_of_sensor(term.source)) return options_.sensors[term.of].id;
        if (term.source == ErrorSource::robot_drift) return find_spot(project_, spots_[0].spot.id)->robot_id;
        if (!is_of_spot(term.source)) return {};
        const Spot& spot = *find_spot(project_, spots_[term.of].spot.id);
        const bool robot = term.source == ErrorSource::travel || term.source == ErrorSource::robot_run ||
                           term.source == ErrorSource::robot_taught;
        return robot ? spot.robot_id : spot.sensor_id;
    }
    double degrees_of(const BudgetTerm& term) const {
        if (term.source == ErrorSource::feature) return spots_[term.of].feature_degrees;
        if (term.source == ErrorSource::reference) return spots_[term.of].reference_degrees;
        return std::numeric_limits<double>::infinity();
    }
    const Project& project_;
    const CorrectionOptions& options_;
    const std::vector<BudgetSpot>& spots_;
    const UncertaintyBudget& budget_;
};

bool is_bead(Quantity quantity) {
    return quantity <= Quantity::binormal;
}

const Calibration* nozzle_in_use(const Project& project, const Region& region) {
    const RobotSetup* robot = robot_of(project, region);
    return robot ? nozzle_of(project, robot->id) : nullptr;
}

void add_nozzle_remarks(const Project& project, const Calibration& nozzle, std::vector<Text>& remarks) {
    if (Text trouble = nozzle_trouble(project, nozzle.robot_id); !trouble.empty())
        remarks.push_back(std::move(trouble));
    if (nozzle.nozzle->off_programmed_mm > 0)
        remarks.push_back(
            Text("Robot {}: the nozzle lies {:.2f} mm off the programmed tool; the budget holds where the "
                 "found tool is "
                 "entered on the controller.",
                 nozzle.robot_id, nozzle.nozzle->off_programmed_mm));
}

// As correct_regions() adds it.
void add_offset(const KeptOffset& kept, UncertaintyBudget& budget) {
    BudgetTerm& term = budget.terms.emplace_back();
    term.source = ErrorSource::offset;
    term.covariance.topLeftCorner<3, 3>() = kept.covariance_mm2;
    term.sigma.xyz_mm = kept.covariance_mm2.diagonal().cwiseMax(0).cwiseSqrt();
    term.input_sigma = term.sigma.xyz_mm.norm() / std::sqrt(3.0);
    budget.covariance += term.covariance;
    budget.sigma.xyz_mm = (budget.sigma.xyz_mm.cwiseAbs2() + term.sigma.xyz_mm.cwiseAbs2()).cwiseSqrt();
}

// Normal and binormal where either is largest.
std::vector<Measure> worst_of(const std::vector<PathDirection>& directions, const UncertaintyBudget& budget,
                              const Pose& d, std::string& spot_id, std::array<PathDirection, 2>& at) {
    std::vector<Measure> out;
    double largest = -1;
    for (std::size_t i = 0; i + 1 < directions.size(); i += 2) {
        const Measure normal = measure_at(directions[i], d), binormal = measure_at(directions[i + 1], d);
        const double here = std::max(normal.variance(budget.covariance, budget.sigma),
                                     binormal.variance(budget.covariance, budget.sigma));
        if (!(here > largest)) continue;
        largest = here;
        out = {normal, binormal};
        spot_id = directions[i].spot_id;
        at = {directions[i], directions[i + 1]};
    }
    return out;
}

void compare(MeasurandBudget& m, const MonteCarlo& drawn, const MonteCarloFigure& figure) {
    m.drawn = figure;
    const bool told = drawn.failed <= kMostFailed * static_cast<double>(drawn.trials);
    m.agrees = told && std::abs(figure.low + m.expanded) <= kAgreement * m.u &&
               std::abs(figure.high - m.expanded) <= kAgreement * m.u;
}

struct Prepared {
    std::vector<BudgetSpot> spots;
    CorrectionOptions correction;
    RegionPlan plan;
    std::vector<PathDirection> directions;
};

Expected<Prepared> prepare(const Project& project, const Region& region) {
    Prepared out;
    SEAM_TRY(auto spots, spots_of(project, region));
    out.spots = std::move(spots);
    out.correction = planned_options(project, region);
    std::vector<SpotObservation> observations;
    for (const BudgetSpot& b : out.spots) observations.push_back(b.spot);
    SEAM_TRY(auto plan, plan_region(observations, out.correction));
    out.plan = std::move(plan);
    out.directions = path_directions(project, region);
    return out;
}

// The tables, and what they are of.
struct FirstOrder {
    RegionBudget budget;
    std::vector<Measure> measures;
    std::array<PathDirection, 2> at;
    const Calibration* nozzle = nullptr;  // of the robot that lays the bead
};

Expected<FirstOrder> first_order(const Project& project, const Region& region, const Prepared& p,
                                 const Displacement& displacement) {
    FirstOrder out;
    RegionBudget& b = out.budget;
    b.region_id = region.id;
    b.displacement = displacement;
    b.required_sigma3_mm = project.requirements.sigma3_mm;
    SEAM_TRY(auto budget, uncertainty_budget(p.spots, p.correction, displacement));
    if (const KeptOffset* kept = acting_offset(region)) add_offset(*kept, budget);
    if (p.plan.status != CorrectionStatus::ok || !budget.determined) {
        b.status = CorrectionStatus::under_determined;
        b.message = p.plan.advice;
        return out;
    }
    out.measures =
        worst_of(p.directions, budget, displacement.workobject_from_movedworkobject, b.spot_id, out.at);
    for (std::size_t i = 0; i < 6; ++i)
        if (region.free[i])
            out.measures.push_back(
                {static_cast<Quantity>(static_cast<int>(Quantity::x) + static_cast<int>(i))});
    const Tables tables(project, p.correction, p.spots, budget);
    out.nozzle = nozzle_in_use(project, region);
    for (const Measure& m : out.measures)
        b.measurands.push_back(tables.table(m, is_bead(m.quantity) ? out.nozzle : nullptr));
    b.remarks = not_stated(project, p.correction, p.spots);
    if (out.nozzle) add_nozzle_remarks(project, *out.nozzle, b.remarks);
    return out;
}

}  // namespace

std::string_view to_string(Quantity quantity) {
    constexpr std::array<std::string_view, 8> kNames{"normal", "binormal", "x", "y", "z", "a", "b", "c"};
    return kNames[static_cast<std::size_t>(quantity)];
}

bool RegionBudget::first_order_holds() const {
    return std::all_of(measurands.begin(), measurands.end(),
                       [](const MeasurandBudget& m) { return m.agrees; });
}

double RegionBudget::bead_u_mm() const {
    double worst = 0;
    for (const MeasurandBudget& m : measurands)
        if (m.quantity <= Quantity::binormal) worst = std::max(worst, m.u);
    return worst;
}

Expected<std::vector<StatedScatter>> stated_scatter(const Project& project, const Region& region,
                                                    const PathDirection& at,
                                                    std::span<const Displacement> displacements) {
    SEAM_TRY(const auto prepared, prepare(project, region));
    std::vector<StatedScatter> out;
    for (const Displacement& d : displacements) {
        SEAM_TRY(const auto budget, uncertainty_budget(prepared.spots, prepared.correction, d));
        if (prepared.plan.status != CorrectionStatus::ok || !budget.determined)
            return input_error(prepared.plan.advice, Text("region {}", region.id));
        const MeasurandBudget sums = Tables(project, prepared.correction, prepared.spots, budget)
                                         .table(measure_at(at, d.workobject_from_movedworkobject));
        out.push_back({sums.u_random, sums.u_systematic});
    }
    return out;
}

Expected<RegionBudget> worst_budget(const Project& project, const Region& region) {
    SEAM_TRY(const auto prepared, prepare(project, region));
    Eigen::Vector3d middle = Eigen::Vector3d::Zero();
    for (const BudgetSpot& b : prepared.spots)
        middle +=
            b.spot.workobject_from_sensor * b.spot.reference_mm / static_cast<double>(prepared.spots.size());
    std::optional<RegionBudget> worst;
    for (const Displacement& d : required_displacements(project.requirements, middle)) {
        if (!check_displacement(region, d.workobject_from_movedworkobject)) continue;
        SEAM_TRY(auto here, first_order(project, region, prepared, d));
        if (!worst || here.budget.status != CorrectionStatus::ok ||
            here.budget.bead_u_mm() > worst->bead_u_mm())
            worst = std::move(here.budget);
        if (worst->status != CorrectionStatus::ok) break;
    }
    return std::move(*worst);  // as taught is always among them
}

Expected<RegionBudget> region_budget(const Project& project, const Region& region,
                                     const BudgetOptions& options) {
    const Pose& d = options.displacement.workobject_from_movedworkobject;
    SEAM_OK(check_displacement(region, d));
    SEAM_TRY(const auto prepared, prepare(project, region));
    SEAM_TRY(const auto first, first_order(project, region, prepared, options.displacement));
    RegionBudget out = first.budget;
    out.seed = options.seed;
    if (!options.monte_carlo || out.status != CorrectionStatus::ok) return out;

    CorrectionDraws draws(prepared.spots, prepared.correction, options.displacement, options.seed);
    RegionCorrector corrector(project, prepared.correction);
    RegionCorrection found;
    const auto truth = printed(d);
    // Of the bead alone, and of its own: without a nozzle the draws are what they were.
    const double nozzle_mm = first.nozzle ? nozzle_sigma_mm(*first.nozzle) : 0;
    std::mt19937_64 nozzle_random(options.seed + 1);
    std::normal_distribution<double> nozzle_draw;
    const KeptOffset* const kept = acting_offset(region);
    std::mt19937_64 offset_random(options.seed + 2);
    std::normal_distribution<double> offset_draw;
    Eigen::Matrix3d offset_root = Eigen::Matrix3d::Zero();
    if (kept) {
        const SymmetricEigen eigen = symmetric_eigen(kept->covariance_mm2);
        offset_root = eigen.vectors * eigen.values.cwiseMax(0).cwiseSqrt().asDiagonal();
    }
    const auto trial = [&](std::span<double> values) {
        if (!corrector.correct(draws.next(), found)) return false;
        if (found.status != CorrectionStatus::ok && found.status != CorrectionStatus::over_limit)
            return false;
        Pose estimate = draws.laid(found.displacement.workobject_from_movedworkobject);
        if (kept) {
            Eigen::Vector3d v;
            for (int k = 0; k < 3; ++k) v[k] = offset_draw(offset_random);
            estimate.pretranslate(Eigen::Vector3d(offset_root * v));
        }
        const auto off = Eigen::Matrix<double, 6, 1>(printed(estimate) - truth);
        for (std::size_t i = 0; i < first.measures.size(); ++i) {
            const int k = static_cast<int>(first.measures[i].quantity) - static_cast<int>(Quantity::x);
            if (k < 0)
                values[i] = first.at[i].value(estimate) - first.at[i].value(d) +
                            (nozzle_mm > 0 ? nozzle_mm * nozzle_draw(nozzle_random) : 0);
            else
                values[i] = k < 3 ? off[k] : std::remainder(off[k], 360.0);
        }
        return true;
    };
    out.drawn = monte_carlo(first.measures.size(), options.drawing, trial);
    if (options.drawing.cancel.stop_requested())
        return usage_error(Text("cancelled after {} trials", out.drawn->trials), Text("region {}", region.id),
                           "start it again");
    for (std::size_t i = 0; i < first.measures.size(); ++i)
        compare(out.measurands[i], *out.drawn, out.drawn->figures[i]);
    return out;
}

}  // namespace seamwright
