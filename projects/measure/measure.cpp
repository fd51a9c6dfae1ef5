#include "projects/measure/measure.h"

#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/correction/travel.h"
#include "core/features/kinds/feature_registry.h"
#include "core/features/registration/taught_stripe.h"
#include "projects/measure/reference_feature.h"

namespace seamwright {
namespace {

template <class T>
const T* find_by_id(const std::vector<T>& items, const std::string& id) {
    const auto it = std::find_if(items.begin(), items.end(), [&](const T& item) { return item.id == id; });
    return it == items.end() ? nullptr : &*it;
}

// Copies that keep the target's capacity.
void keep_profile(const Profile& from, Profile& to) {
    to.x_mm.assign(from.x_mm.begin(), from.x_mm.end());
    to.z_mm.assign(from.z_mm.begin(), from.z_mm.end());
    to.intensity.assign(from.intensity.begin(), from.intensity.end());
    to.segment.clear();  // raw: the filter marks segments again
}

// Two observed coordinates share the feature's variance: the mean of the trace.
double total_sigma_mm(const Spot& spot, const Feature& feature) {
    return std::sqrt(spot.sigma_mm * spot.sigma_mm + 0.5 * feature.covariance_mm2.trace());
}

void clear_candidates(ProfileCandidates& c) {
    c.lines = 0;
    c.per_line = 1;
    c.count.clear();
    c.x_mm.clear();
    c.z_mm.clear();
    c.intensity.clear();
}

}  // namespace

SpotStatus capture_frame(const Frame& frame, const PeakOptions& peak_options, const SensorModel* model,
                         StripePeaks& peaks, Capture& capture, Text& message) {
    capture.status = frame.status;
    capture.sequence = frame.sequence;
    capture.device_time_ns = frame.device_time_ns;
    capture.host_time_ns = frame.host_time_ns;
    capture.base_from_flange = frame.base_from_flange;
    capture.profile.clear();
    clear_candidates(capture.candidates);
    message.clear();
    if (frame.status != FrameStatus::ok) {
        message = Text("the frame is {}", to_string(frame.status));
        return SpotStatus::damaged_frame;
    }
    if (frame.profile.size() > 0) {
        // What the sensor finished itself is not computed again from its image.
        if (frame.profile.z_mm.size() != frame.profile.x_mm.size() ||
            (!frame.profile.intensity.empty() &&
             frame.profile.intensity.size() != frame.profile.x_mm.size())) {
            message = "the columns of the profile differ in length";
            return SpotStatus::damaged_frame;
        }
        keep_profile(frame.profile, capture.profile);
        return SpotStatus::measured;
    }
    if (frame.image.empty()) {
        message = "the frame holds neither a profile nor an image";
        return SpotStatus::no_stripe;
    }
    if (!model) {
        message = "the sensor delivers images and its calibration holds no model";
        return SpotStatus::no_calibration;
    }
    if (auto found = find_peaks(frame.image, peak_options, peaks); !found) {
        message = found.error().text();
        return SpotStatus::no_stripe;
    }
    to_millimetres(peaks, *model, capture.candidates);
    const auto& count = capture.candidates.count;
    if (std::none_of(count.begin(), count.end(), [](std::uint8_t n) { return n > 0; })) {
        message = "no stripe was found in the image";
        return SpotStatus::no_stripe;
    }
    return SpotStatus::measured;
}

Expected<void> track_capture(const Capture& capture, const FilterOptions& options, Profile& profile) {
    if (capture.profile.size() > 0) {
        keep_profile(capture.profile, profile);
        return filter_profile(profile, options);
    }
    return track_stripe(capture.candidates, options, profile);
}

Eigen::Vector3d in_taught_sensor(const Eigen::Vector2d& point_mm, const Pose& flange_from_sensor,
                                 const Pose& base_from_flange_taught,
                                 const std::optional<Pose>& base_from_flange_reported) {
    const Eigen::Vector3d m(point_mm.x(), 0, point_mm.y());
    if (!base_from_flange_reported) return m;
    const Pose base_from_sensor = base_from_flange_taught * flange_from_sensor;
    return base_from_sensor.inverse() * (*base_from_flange_reported * flange_from_sensor * m);
}

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

const SensorSetup* find_sensor(const Project& project, const std::string& id) {
    return find_by_id(project.sensors, id);
}
const RobotSetup* find_robot(const Project& project, const std::string& id) {
    return find_by_id(project.robots, id);
}
const Spot* find_spot(const Project& project, const std::string& id) {
    return find_by_id(project.spots, id);
}

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

}  // namespace

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

const PanelJob* find_panel_job(const Project& project, const std::string& id) {
    return find_by_id(project.panel_jobs, id);
}

const Calibration* calibration_of(const Project& project, const Spot& spot) {
    return calibration_of(project, spot.sensor_id);
}

const Calibration* calibration_of(const Project& project, const std::string& sensor_id) {
    const SensorSetup* sensor = find_sensor(project, sensor_id);
    return sensor && !sensor->calibration_id.empty()
               ? find_by_id(project.calibrations, sensor->calibration_id)
               : nullptr;
}

struct SpotMeasurer::Impl {
    Spot spot;
    PeakOptions peak_options;
    FilterOptions filter;
    std::optional<SensorModel> model;
    Pose flange_from_sensor = Pose::Identity();
    bool calibrated = false;
    std::unique_ptr<FeatureFinder> finder;
    std::optional<TaughtStripe> taught;  // where the reference profile is a contour

    StripePeaks peaks;
    Capture capture;
    Profile profile;
    SpotMeasurement measurement;

    void reset(std::int64_t host_time_ns) {
        measurement.status = SpotStatus::not_measured;
        measurement.message.clear();
        measurement.feature.status = FeatureStatus::not_found;
        measurement.feature.point_mm.setConstant(std::numeric_limits<double>::quiet_NaN());
        measurement.feature.covariance_mm2.setZero();
        measurement.feature.phi_rad.reset();
        measurement.feature.rms_mm = 0;
        measurement.feature.points_used = 0;
        measurement.feature.message.clear();
        measurement.measured_mm.setZero();
        measurement.sigma_mm = 0;
        measurement.pose_reported = false;
        measurement.host_time_ns = host_time_ns;
        profile.clear();
    }

    const SpotMeasurement& no(SpotStatus status, const Text& message) {
        measurement.status = status;
        measurement.message = message;
        return measurement;
    }

    // From the capture's profile or candidates to the end.
    const SpotMeasurement& evaluate(const Capture& from) {
        if (taught && from.profile.size() == 0) {
            const auto choice = taught->track(from.candidates, filter, profile);
            if (!choice) return no(SpotStatus::no_stripe, choice.error().text());
            if (*choice == StripeChoice::undecided) {
                measurement.feature.status = FeatureStatus::ambiguous;
                return no(SpotStatus::no_feature, kTwoContours);
            }
        } else if (auto tracked = track_capture(from, filter, profile); !tracked) {
            return no(SpotStatus::no_stripe, tracked.error().text());
        }
        measurement.feature = finder->find(profile);
        const Feature& feature = measurement.feature;
        if (feature.status != FeatureStatus::ok)
            return no(SpotStatus::no_feature,
                      feature.message.empty() ? std::string(to_string(feature.status)) : feature.message);
        if (!feature.point_mm.allFinite() || !feature.covariance_mm2.allFinite())
            return no(SpotStatus::no_feature, "the feature is not a finite point");
        if (from.base_from_flange && !pose_from_matrix(from.base_from_flange->matrix(), "", 1e-4))
            return no(SpotStatus::not_measured, "the reported pose of the flange is no rigid pose");
        // Without a calibration it is not known where the sensor sits: the point stays as seen.
        measurement.pose_reported = calibrated && from.base_from_flange.has_value();
        measurement.measured_mm =
            in_taught_sensor(feature.point_mm, flange_from_sensor, spot.base_from_flange,
                             calibrated ? from.base_from_flange : std::nullopt);
        measurement.sigma_mm = total_sigma_mm(spot, feature);
        measurement.status = SpotStatus::measured;
        return measurement;
    }
};

SpotMeasurer::SpotMeasurer(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
SpotMeasurer::SpotMeasurer(SpotMeasurer&&) noexcept = default;
SpotMeasurer& SpotMeasurer::operator=(SpotMeasurer&&) noexcept = default;
SpotMeasurer::~SpotMeasurer() = default;

Expected<SpotMeasurer> SpotMeasurer::make(const Project& project, const std::string& spot_id) {
    const Spot* spot = find_spot(project, spot_id);
    if (!spot) return input_error(Text("there is no spot \"{}\"", spot_id), "spots");
    const Text where("spot {}", spot_id);
    const SensorSetup* sensor = find_sensor(project, spot->sensor_id);
    if (!sensor)
        return input_error(Text("its sensor \"{}\" is not in the project", spot->sensor_id), where,
                           "choose one of the project's sensors");
    auto finder = make_feature_finder(spot->feature);
    if (!finder) {
        Error error = finder.error();
        error.within(where);
        return tl::unexpected(error);
    }
    auto impl = std::make_unique<Impl>();
    impl->spot = *spot;
    impl->peak_options = sensor->peaks;
    impl->filter = sensor->filter;
    impl->finder = std::move(*finder);
    if (auto taught =
            TaughtStripe::make(spot->reference_profile, {spot->reference_mm.x(), spot->reference_mm.z()},
                               search_window(spot->feature)))
        impl->taught = std::move(*taught);
    if (const Calibration* calibration = calibration_of(project, *spot)) {
        impl->calibrated = true;
        impl->model = calibration->model;
        impl->flange_from_sensor = calibration->flange_from_sensor;
    }
    impl->measurement.spot_id = spot_id;
    impl->capture.spot_id = spot_id;
    impl->capture.sensor_id = sensor->id;
    return SpotMeasurer(std::move(impl));
}

const SpotMeasurement& SpotMeasurer::measure(const Frame& frame, const std::optional<Pose>& reported) {
    Impl& i = *impl_;
    i.reset(frame.host_time_ns);
    const SpotStatus status = capture_frame(frame, i.peak_options, i.model ? &*i.model : nullptr, i.peaks,
                                            i.capture, i.measurement.message);
    if (reported) i.capture.base_from_flange = reported;
    if (status != SpotStatus::measured) {
        i.measurement.status = status;
        return i.measurement;
    }
    return i.evaluate(i.capture);
}

const SpotMeasurement& SpotMeasurer::measure(std::span<const FramePtr> exposures,
                                             std::span<const double> light,
                                             const std::optional<Pose>& reported) {
    Impl& i = *impl_;
    if (exposures.size() == 1) return measure(*exposures.front(), reported);
    i.reset(exposures.empty() ? 0 : exposures.front()->host_time_ns);
    i.capture.profile.clear();
    clear_candidates(i.capture.candidates);
    std::vector<StripePeaks> peaks(exposures.size());
    int full_scale = 0;
    for (std::size_t k = exposures.size(); k-- > 0;) {  // the first one's times and pose stay
        const Frame& frame = *exposures[k];
        if (frame.profile.size() > 0)
            return i.no(SpotStatus::no_stripe, "exposures are merged from images, the sensor sends profiles");
        if (full_scale != 0 && !frame.image.empty() && full_scale != frame.image.full_scale())
            return i.no(SpotStatus::damaged_frame, "the exposures differ in their grey values' depth");
        const SpotStatus status = capture_frame(frame, i.peak_options, i.model ? &*i.model : nullptr,
                                                peaks[k], i.capture, i.measurement.message);
        // A single exposure may show nothing; all of them together are asked.
        if (status == SpotStatus::damaged_frame || status == SpotStatus::no_calibration ||
            frame.image.empty())
            return i.no(status, i.measurement.message);
        full_scale = frame.image.full_scale();
    }
    if (reported) i.capture.base_from_flange = reported;
    i.measurement.message.clear();
    if (auto merged = merge_exposures(peaks, light, full_scale, i.peaks); !merged)
        return i.no(SpotStatus::no_stripe, merged.error().text());
    to_millimetres(i.peaks, *i.model, i.capture.candidates);
    const auto& count = i.capture.candidates.count;
    if (std::none_of(count.begin(), count.end(), [](std::uint8_t n) { return n > 0; }))
        return i.no(SpotStatus::no_stripe, "no stripe was found in any of the exposures");
    return i.evaluate(i.capture);
}

const SpotMeasurement& SpotMeasurer::measure(const Capture& stored) {
    Impl& i = *impl_;
    if (stored.image && stored.status == FrameStatus::ok && stored.profile.size() == 0) {
        Frame frame;
        frame.status = stored.status;
        frame.sequence = stored.sequence;
        frame.device_time_ns = stored.device_time_ns;
        frame.host_time_ns = stored.host_time_ns;
        frame.base_from_flange = stored.base_from_flange;
        frame.image = stored.image->view();
        return measure(frame, stored.base_from_flange);
    }
    i.reset(stored.host_time_ns);
    if (stored.status != FrameStatus::ok)
        return i.no(SpotStatus::damaged_frame, Text("the frame is {}", to_string(stored.status)));
    const auto& count = stored.candidates.count;
    const bool candidates = std::any_of(count.begin(), count.end(), [](std::uint8_t n) { return n > 0; });
    if (stored.profile.size() == 0 && !candidates)
        return i.no(SpotStatus::no_stripe, "the capture holds no profile");
    return i.evaluate(stored);
}

const Spot& SpotMeasurer::spot() const {
    return impl_->spot;
}
const Capture& SpotMeasurer::capture() const {
    return impl_->capture;
}
const Profile& SpotMeasurer::profile() const {
    return impl_->profile;
}
const StripePeaks& SpotMeasurer::peaks() const {
    return impl_->peaks;
}

namespace {

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

}  // namespace

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

namespace {

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
