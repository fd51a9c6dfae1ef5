// Regions: what measured spots tell the correction, what it is asked for, and the correction of all of them.

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>

#include "core/correction/travel.h"
#include "projects/measure/measure_detail.h"
#include "projects/measure/reference_feature.h"

namespace seamwright {
namespace {

// The way in the trigger's latency; 0 where the robot stands at the trigger.
double latency_travel_mm(const Spot& spot, const RobotSetup& robot) {
    return spot.stop_at_trigger ? 0 : 1e-3 * robot.trigger_latency_ms * spot.speed_mm_s;
}

// What errs in the same way again.
void add_repeating(const Project& project, const Spot& spot, const Calibration& calibration,
                   const std::optional<Feature>& at_reference, SpotObservation& o) {
    o.sensor = spot.sensor_id;
    if (at_reference) o.reference_covariance_mm2 = at_reference->covariance_mm2;
    const RobotSetup* robot = find_robot(project, spot.robot_id);
    if (robot) o.latency_travel_mm = latency_travel_mm(spot, *robot);
    if (!robot || robot->arrival_covariance.isZero(0)) return;
    const Pose& flange_from_sensor = calibration.flange_from_sensor;
    const Matrix6 in_base = covariance_of_product(spot.base_from_flange, robot->arrival_covariance,
                                                  flange_from_sensor, Matrix6::Zero());
    o.reference_arrivals = std::max(1, spot.reference_arrivals);
    o.robot_covariance = covariance_of_product(project.part.base_from_workobject.inverse(), Matrix6::Zero(),
                                               spot.base_from_flange * flange_from_sensor, in_base);
}

// What the trigger of a sensor's spots errs by.
void state_trigger(const Project& project, const std::string& sensor_id, SensorPrior& prior) {
    for (const Spot& spot : project.spots) {
        if (spot.sensor_id != sensor_id) continue;
        const RobotSetup* robot = find_robot(project, spot.robot_id);
        if (!robot || latency_travel_mm(spot, *robot) == 0) continue;
        prior.latency_sigma = 1;  // none of it is taken off
        prior.speed_sigma = std::max(prior.speed_sigma, robot->speed_sigma);
    }
}

void state_drift(DriftOf drifts, const std::string& device_id, double sigma_mm, CorrectionOptions& options) {
    if (drifts == DriftOf::robot) {
        options.robot_drift_sigma_mm = sigma_mm;
        return;
    }
    for (SensorPrior& prior : options.sensors)
        if (prior.id == device_id) prior.drift_sigma_mm.setConstant(sigma_mm);
}

// Of the sensor or the robot that measures the region.
bool concerns(const Project& project, const Region& region, DriftOf drifts, const std::string& device_id) {
    return std::any_of(region.spot_ids.begin(), region.spot_ids.end(), [&](const std::string& id) {
        const Spot* spot = find_spot(project, id);
        return spot && (drifts == DriftOf::sensor ? spot->sensor_id : spot->robot_id) == device_id;
    });
}

// What a person kept and switched on (KeptOffset). The offset's own covariance is the same in every part. The largest
// sigma at the spots is that of its worst direction, whatever that of the correction: never too small.
void take_off(const KeptOffset& kept, RegionRecord& record) {
    RegionCorrection& c = *record.correction;
    c.displacement.workobject_from_movedworkobject.pretranslate(-kept.offset_mm);
    const Eigen::Matrix3d cov = 0.5 * (kept.covariance_mm2 + kept.covariance_mm2.transpose());
    for (Matrix6* sum : {&c.covariance, &c.covariance_systematic}) sum->topLeftCorner<3, 3>() += cov;
    for (Eigen::Vector3d* sigma : {&c.sigma_xyz_mm, &c.sigma_systematic.xyz_mm})
        *sigma = (sigma->array().square() + cov.diagonal().array()).sqrt();
    const double worst = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(cov).eigenvalues().maxCoeff();
    c.sigma_at_spots_mm = std::sqrt(c.sigma_at_spots_mm * c.sigma_at_spots_mm + std::max(0.0, worst));
    record.offset = ActingOffset{kept.version, kept.offset_mm};
}

// The error of what was compensated is the same at all spots: stated as a translation in every direction.
void add_systematic(RegionCorrection& c, double sigma_mm) {
    const double variance = sigma_mm * sigma_mm;
    for (Matrix6* sum : {&c.covariance, &c.covariance_systematic})
        sum->topLeftCorner<3, 3>().diagonal().array() += variance;
    for (Eigen::Vector3d* sigma : {&c.sigma_xyz_mm, &c.sigma_systematic.xyz_mm})
        *sigma = (sigma->array().square() + variance).sqrt();
    c.sigma_at_spots_mm = std::hypot(c.sigma_at_spots_mm, sigma_mm);
}

// The frame stays the rigid answer, which fits an unbent path best; a path that is corrected point by point is bent too
// (path.h).
void bend(const RegionModes& modes, const CorrectionOptions& options,
          const std::vector<SpotObservation>& observations, RegionRecord& record) {
    ActingModes& said = record.modes.emplace();
    ElasticOptions limits;
    limits.most_added_mm = modes.most_added_mm;
    auto solved = solve_elastic(observations, options, modes.modes, limits);
    if (!solved) {
        said.why = solved.error().text();
        return;
    }
    said.acted = solved->acted;
    said.why = modes.modes.modes.empty() ? Text("none were found when they were learnt") : solved->why;
    for (const ElasticAmplitude& a : solved->amplitudes) {
        said.amplitudes_mm.push_back(a.value_mm);
        said.sigma_mm.push_back(a.sigma_mm);
    }
    said.largest_added_mm = solved->largest_added_mm;
    said.probability = solved->probability;
    if (!said.acted) return;
    const Eigen::MatrixXd& c = solved->covariance;
    for (Eigen::Index r = 0; r < c.rows(); ++r)
        for (Eigen::Index k = 0; k < c.cols(); ++k) said.covariance.push_back(c(r, k));
}

}  // namespace

SpotObservation observation(const Spot& spot, const Pose& base_from_workobject,
                            const Pose& flange_from_sensor, const SpotMeasurement& measurement) {
    SpotObservation o;
    o.id = spot.id;
    o.workobject_from_sensor = base_from_workobject.inverse() * spot.base_from_flange * flange_from_sensor;
    o.reference_mm = spot.reference_mm;
    o.measured_mm = measurement.measured_mm;
    o.weights = spot.weights;
    o.sigma_mm = measurement.sigma_mm;
    o.curve = spot.curve;
    if (spot.weights.x() == spot.weights.z()) {
        const Eigen::Matrix2d& feature = measurement.feature.covariance_mm2;
        const double rest = o.sigma_mm * o.sigma_mm - 0.5 * feature.trace();
        if (rest > 0) o.covariance_mm2 = feature + rest * Eigen::Matrix2d::Identity();
    }
    return o;
}

std::vector<SpotObservation> planned_observations(const Project& project, const Region& region) {
    std::vector<SpotObservation> observations;
    for (const std::string& id : region.spot_ids) {
        const Spot* spot = find_spot(project, id);
        if (!spot || !spot->enabled) continue;
        const Calibration* calibration = calibration_of(project, *spot);
        if (!calibration) continue;
        SpotMeasurement at_reference;
        at_reference.spot_id = id;
        at_reference.measured_mm = spot->reference_mm;
        const std::optional<Feature> found = feature_at_reference(*spot);
        if (found) at_reference.feature = *found;
        at_reference.sigma_mm = total_sigma_mm(*spot, at_reference.feature);
        observations.push_back(observation(*spot, project.part.base_from_workobject,
                                           calibration->flange_from_sensor, at_reference));
        add_repeating(project, *spot, *calibration, found, observations.back());
    }
    return observations;
}

std::vector<SpotObservation> region_observations(const Project& project, const Region& region,
                                                 std::span<const SpotMeasurement> measurements,
                                                 int* uncalibrated) {
    std::vector<SpotObservation> observations;
    for (const std::string& id : region.spot_ids) {
        const Spot* spot = find_spot(project, id);
        const auto measured = std::find_if(
            measurements.begin(), measurements.end(),
            [&](const SpotMeasurement& m) { return m.spot_id == id && m.status == SpotStatus::measured; });
        const Calibration* calibration = spot ? calibration_of(project, *spot) : nullptr;
        if (!spot || !spot->enabled || measured == measurements.end()) continue;
        if (!calibration) {
            if (uncalibrated) ++*uncalibrated;
            continue;
        }
        observations.push_back(observation(*spot, project.part.base_from_workobject,
                                           calibration->flange_from_sensor, *measured));
        add_repeating(project, *spot, *calibration, feature_at_reference(*spot), observations.back());
    }
    return observations;
}

CorrectionOptions correction_options(const Project& project, const Region& region, const ActingDrift* drift) {
    CorrectionOptions options;
    for (const SensorSetup& sensor : project.sensors)
        if (const Calibration* calibration = calibration_of(project, sensor.id)) {
            const Matrix6& c = calibration->covariance;
            SensorPrior& prior = options.sensors.emplace_back();
            prior.id = sensor.id;
            prior.hand_eye_covariance =
                hand_eye_along_sensor(calibration->flange_from_sensor, 0.5 * (c + c.transpose()));
            prior.scale_sigma = calibration->scale_sigma;
            prior.shear_sigma = calibration->shear_sigma;
            state_trigger(project, sensor.id, prior);
        }
    options.workobject_covariance = project.part.workobject_covariance;
    if (drift && !drift->compensated && concerns(project, region, drift->drifts, drift->device_id))
        state_drift(drift->drifts, drift->device_id, drift->standing_mm, options);
    options.free = region.free;
    options.limits = region.limits;
    options.sigma_limit_mm = std::max(options.sigma_limit_mm, region.sigma_limit_mm);
    options.sigma_limit_deg = std::max(options.sigma_limit_deg, region.sigma_limit_deg);
    return options;
}

CorrectionOptions planned_options(const Project& project, const Region& region) {
    CorrectionOptions options = correction_options(project, region);
    if (!project.drift || !project.drift->learnt || project.drift->spot_ids.empty()) return options;
    const DriftWatch& watch = *project.drift;
    const Spot* spot = find_spot(project, watch.spot_ids.front());
    if (!spot) return options;
    double sigma_mm = watch.limit_mm / std::sqrt(3.0);
    if (watch.compensate) {
        sigma_mm = 0;
        for (const LearntDirection& d : watch.learnt->directions) sigma_mm = std::max(sigma_mm, d.sigma_mm);
    }
    const std::string& device_id = watch.drifts == DriftOf::sensor ? spot->sensor_id : spot->robot_id;
    if (concerns(project, region, watch.drifts, device_id))
        state_drift(watch.drifts, device_id, sigma_mm, options);
    return options;
}

double travel_window_mm(const Spot& spot) {
    return spot.stop_at_trigger ? 0 : spot.jitter_mm;
}

RegionCorrector::RegionCorrector(const Project& project, const Region& region, const ActingDrift* drift)
    : RegionCorrector(project, correction_options(project, region, drift)) {}

RegionCorrector::RegionCorrector(const Project& project, CorrectionOptions options)
    : project_(&project), options_(std::move(options)), roughly_(options_) {
    roughly_.limits = {};
}

Expected<void> RegionCorrector::correct(std::vector<SpotObservation>& observations,
                                        RegionCorrection& correction) {
    // First where the part lies, to know what the travel does there. A good spot that the travel made look
    // wrong does not matter to that.
    auto rough = solver_.solve(observations, roughly_, correction);
    if (rough && correction.status != CorrectionStatus::ok) {
        CorrectionOptions all = roughly_;
        all.reject_outliers = false;
        rough = solver_.solve(observations, all, correction);
    }
    if (rough && correction.status == CorrectionStatus::ok)
        for (SpotObservation& o : observations)
            add_travel(o, correction.displacement, travel_window_mm(*find_spot(*project_, o.id)));
    return solver_.solve(observations, options_, correction);
}

std::vector<SpotMeasurement> without_drift(const Project& project,
                                           std::span<const SpotMeasurement> measurements,
                                           const ActingDrift* drift) {
    std::vector<SpotMeasurement> out(measurements.begin(), measurements.end());
    if (!drift || !drift->compensated) return out;
    for (SpotMeasurement& m : out) {
        const Spot* spot = find_spot(project, m.spot_id);
        if (!spot || m.status != SpotStatus::measured) continue;
        if (drift->drifts == DriftOf::sensor) {
            if (spot->sensor_id == drift->device_id) m.measured_mm -= drift->shift_mm;
            continue;
        }
        const Calibration* calibration = calibration_of(project, *spot);
        if (!calibration || spot->robot_id != drift->device_id) continue;
        const Pose base_from_sensor = spot->base_from_flange * calibration->flange_from_sensor;
        m.measured_mm -= base_from_sensor.linear().transpose() * drift->shift_mm;
    }
    return out;
}

std::vector<RegionRecord> correct_regions(const Project& project,
                                          std::span<const SpotMeasurement> as_measured,
                                          const ActingDrift* drift) {
    const std::vector<SpotMeasurement> measurements = without_drift(project, as_measured, drift);
    std::vector<RegionRecord> records;
    for (const Region& region : project.regions) {
        RegionRecord& record = records.emplace_back();
        record.region_id = region.id;
        record.base_from_frame = region.base_from_frame;
        record.push.frame_name = region.frame_name;
        if (drift) record.drift = *drift;
        int uncalibrated = 0;
        std::vector<SpotObservation> observations =
            region_observations(project, region, measurements, &uncalibrated);
        if (observations.empty()) {
            record.refusals.push_back(uncalibrated
                                          ? Text("the sensors at the region's spots have no calibration")
                                          : Text("no spot of the region was measured"));
            continue;
        }
        RegionCorrection correction;
        if (auto solved = RegionCorrector(project, region, drift).correct(observations, correction);
            !solved) {
            record.refusals.push_back(Text("the correction refuses its input: {}", solved.error().text()));
            continue;
        }
        record.correction = std::move(correction);
        if (const RegionModes* modes = modes_of(project, region.id); modes && modes->on)
            bend(*modes, correction_options(project, region, drift), observations, record);
        if (const KeptOffset* kept = acting_offset(region)) take_off(*kept, record);
        if (drift && drift->compensated) add_systematic(*record.correction, drift->sigma_mm);
    }
    return records;
}

}  // namespace seamwright
