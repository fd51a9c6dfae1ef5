#include "projects/station/teach.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/median.h"
#include "core/profile/taught_profile.h"
#include "projects/measure/measure.h"
#include "projects/station/acquire.h"
#include "projects/station/light/spot_light.h"

namespace seamwright {
namespace {

constexpr double kSamePoseMm = 1e-3, kSamePoseDeg = 1e-4;

Pose flange_from_sensor(const Station& station, const Spot& spot) {
    const Calibration* calibration = calibration_of(station.project(), spot);
    return calibration ? calibration->flange_from_sensor : Pose::Identity();
}

}  // namespace

Expected<void> measure_standing(Station& station, const Spot& spot, std::span<const Standing> stands,
                                const std::stop_token& cancel,
                                const std::function<void(const RunProgress&)>& progress,
                                const std::function<void(std::size_t stand, const SpotMeasurer& measurer,
                                                         const SpotMeasurement& measurement)>& visit) {
    ProfileSource* sensor = station.sensor(spot.sensor_id);
    RobotLink* robot = station.robot(spot.robot_id);
    if (!sensor || !robot)
        return usage_error("its sensor or robot is not connected", Text("spot {}", spot.id), "connect first");
    Project project = station.project();
    auto known = std::find_if(project.spots.begin(), project.spots.end(),
                              [&](const Spot& s) { return s.id == spot.id; });
    if (known == project.spots.end())
        project.spots.push_back(spot);
    else
        *known = spot;
    SEAM_TRY(auto measurer, SpotMeasurer::make(project, spot.id));

    SEAM_TRY(const auto by_software, SoftwareTriggered::begin(*sensor));
    StartedSensors started;
    SEAM_OK(started.start(*sensor));
    SEAM_TRY(auto light, SensorLight::begin(*sensor, *find_sensor(project, spot.sensor_id), {&spot, 1},
                                            SensorLight::Look::always));
    SEAM_OK(light.ready(spot));
    const AcquireLimits limits;
    const auto take = [&]() -> Expected<FramePtr> {
        SEAM_OK(sensor->trigger(spot.id));
        return next_frame(*sensor, limits.frame_timeout, cancel);
    };
    for (std::size_t i = 0; i < stands.size(); ++i) {
        if (cancel.stop_requested())
            return device_error(ErrorCode::cancelled, "cancelled", Text("spot {}", spot.id));
        SEAM_TRY(auto at, stand_at(*robot, spot.id, stands[i].base_from_flange));
        for (int n = 0; n < stands[i].measurements; ++n) {
            SEAM_OK(light.ready(spot));
            SEAM_TRY(auto frame, take());
            SEAM_TRY(const auto measured, light.measure(spot, frame, at, measurer, take, true));
            visit(i, measurer, measured);
        }
        if (progress)
            progress({static_cast<int>(i) + 1, static_cast<int>(stands.size()),
                      Text("{}: {} of {}", spot.id, i + 1, stands.size())});
    }
    return {};
}

Expected<TaughtSpot> teach_spot(Station& station, const Spot& draft, const TeachOptions& options) {
    if (options.repeats < 1 || options.repeats > 1000)
        return usage_error(Text("{} repeats", options.repeats), Text("spot {}", draft.id), "give 1 to 1000");
    std::vector<SpotMeasurement> measurements;
    std::vector<Profile> profiles;
    // Standing still: the reference is free of trigger jitter.
    const bool anew = calibration_of(station.project(), draft) && draft.entry_mm > 0;
    std::vector<Standing> stands;
    for (int k = 0; k < options.repeats; ++k) {
        if (anew && k > 0)
            stands.push_back({measuring_move(draft, flange_from_sensor(station, draft)).entry, 0});
        stands.push_back({draft.base_from_flange, kTaughtAnArrival});
    }
    SEAM_OK(measure_standing(station, draft, stands, options.cancel, options.progress,
                             [&](std::size_t, const SpotMeasurer& measurer, const SpotMeasurement& m) {
                                 measurements.push_back(m);
                                 profiles.push_back(measurer.profile());
                             }));
    return taught_from(draft, std::move(measurements), profiles, anew ? options.repeats : 1);
}

Expected<TaughtSpot> taught_from(const Spot& draft, std::vector<SpotMeasurement> measurements,
                                 std::span<const Profile> profiles, int arrivals) {
    TaughtSpot taught;
    taught.spot = draft;
    taught.measurements = std::move(measurements);
    const std::size_t count = taught.measurements.size();
    std::vector<std::size_t> found;
    Text reason;
    for (std::size_t i = 0; i < count; ++i) {
        if (taught.measurements[i].status == SpotStatus::measured)
            found.push_back(i);
        else
            reason = taught.measurements[i].message;
    }
    if (2 * found.size() < count)
        return input_error(
            Text("the feature was found in {} of {} measurements ({})", found.size(), count, reason),
            Text("spot {}", draft.id), "choose another feature or move the sensor");

    // A reflection that took the feature once must not pull the reference: what lies far from the median is
    // left out.
    const auto point = [&](std::size_t i) -> const Eigen::Vector2d& {
        return taught.measurements[i].feature.point_mm;
    };
    Eigen::Vector2d middle, limit;
    for (int axis = 0; axis < 2; ++axis) {
        std::vector<double> values;
        for (std::size_t i : found) values.push_back(point(i)[axis]);
        middle[axis] = median(values);
        for (double& v : values) v = std::abs(v - middle[axis]);
        limit[axis] = std::max(5 * 1.4826 * median(values), 3 * draft.sigma_mm);
    }
    std::vector<std::size_t> kept;
    for (std::size_t i : found)
        if (((point(i) - middle).cwiseAbs().array() <= limit.array()).all()) kept.push_back(i);
    taught.left_out = static_cast<int>(count - kept.size());
    if (2 * kept.size() < count)
        return input_error(Text("only {} of {} measurements agree", kept.size(), count),
                           Text("spot {}", draft.id),
                           "choose another feature, shield reflections or move the sensor");
    Eigen::Vector2d sum = Eigen::Vector2d::Zero(), squares = Eigen::Vector2d::Zero();
    for (std::size_t i : kept) sum += point(i);
    const Eigen::Vector2d mean = sum / static_cast<double>(kept.size());
    for (std::size_t i : kept) squares += (point(i) - mean).cwiseAbs2();
    if (kept.size() > 1) taught.spread_mm = (squares / static_cast<double>(kept.size() - 1)).cwiseSqrt();
    taught.spot.reference_mm = {mean.x(), 0.0, mean.y()};
    taught.spot.reference_state = ReferenceState::measured;
    // The profile that is kept states the middle one of the sigmas: the forecast judges by it, and the surest of ten would
    // promise what the others do not keep.
    std::vector<std::size_t> by_sigma = kept;
    const auto typical = by_sigma.begin() + static_cast<std::ptrdiff_t>(by_sigma.size() / 2);
    std::nth_element(by_sigma.begin(), typical, by_sigma.end(), [&](std::size_t i, std::size_t k) {
        return taught.measurements[i].sigma_mm < taught.measurements[k].sigma_mm;
    });
    taught.spot.reference_profile = profiles[*typical];
    taught.spot.reference_light = taught.measurements[*typical].light;
    // An arrival counts where one of its measurements does; those of a robot that stands still are one.
    std::set<std::size_t> reached;
    for (std::size_t i : kept) reached.insert(i * static_cast<std::size_t>(arrivals) / count);
    taught.spot.reference_arrivals = static_cast<int>(reached.size());
    std::vector<Profile> good;
    for (std::size_t i : kept) good.push_back(profiles[i]);
    taught.mean = mean_profile(good);
    return taught;
}

Expected<Spot> with_taught(const Spot& is, const TaughtSpot& taught) {
    if (!measured_alike(is, taught.spot))
        return input_error("it was changed while its reference was measured", Text("spot {}", is.id),
                           "measure the reference again");
    Spot after = is;
    after.reference_mm = taught.spot.reference_mm;
    after.reference_profile = taught.spot.reference_profile;
    after.reference_arrivals = taught.spot.reference_arrivals;
    after.reference_light = taught.spot.reference_light;
    after.reference_state = taught.spot.reference_state;
    after.curve.reset();
    return after;
}

Expected<Spot> with_template(const Spot& spot, const Profile& profile, const Eigen::AlignedBox2d& window) {
    const Profile piece = cut_out(profile, window);
    if (piece.size() < kTemplatePoints)
        return input_error(Text("the window holds fewer than {} points of the contour", kTemplatePoints),
                           Text("spot {}", spot.id), "drag a larger one");
    Spot after = spot;
    after.feature.template_profile = piece;
    const std::size_t middle = piece.size() / 2;
    after.feature.template_reference_mm = {piece.x_mm[middle], piece.z_mm[middle]};
    return after;
}

bool measured_alike(const Spot& a, const Spot& b) {
    const auto same = [](const Profile& p, const Profile& q) { return p.x_mm == q.x_mm && p.z_mm == q.z_mm; };
    return a.sensor_id == b.sensor_id && a.robot_id == b.robot_id && a.feature.kind == b.feature.kind &&
           a.feature.parameters == b.feature.parameters &&
           same(a.feature.template_profile, b.feature.template_profile) &&
           a.feature.template_reference_mm == b.feature.template_reference_mm &&
           distance_mm(a.base_from_flange, b.base_from_flange) < kSamePoseMm &&
           angle_rad(a.base_from_flange, b.base_from_flange) < rad_from_deg(kSamePoseDeg);
}

Spot with_reference_of(const Spot& before, Spot after) {
    if (measured_alike(before, after)) return after;
    after.reference_profile = {};
    after.reference_arrivals = 1;
    after.drawn.reset();
    after.curve.reset();
    return after;
}

Expected<RecordedPass> record_pass(Station& station, const Spot& spot, const PassOptions& options) {
    if (!(options.step_mm >= 0.05) || !std::isfinite(options.step_mm))
        return usage_error(Text("a step of {} mm", options.step_mm), Text("spot {}", spot.id),
                           "give 0.05 mm or more");
    const MeasuringMove through = measuring_move(spot, flange_from_sensor(station, spot));
    const Eigen::Vector3d before = through.entry.translation() - through.trigger.translation();
    const Eigen::Vector3d after = through.exit.translation() - through.trigger.translation();
    std::vector<Standing> poses;
    std::vector<double> travel;
    const int back = static_cast<int>(std::floor(spot.entry_mm / options.step_mm + 1e-9));
    const int ahead = static_cast<int>(std::floor(spot.exit_mm / options.step_mm + 1e-9));
    for (int k = -back; k <= ahead; ++k) {
        const double y = k * options.step_mm;
        Pose at = through.trigger;
        at.translation() += y < 0   ? Eigen::Vector3d(before * (-y / spot.entry_mm))
                            : y > 0 ? Eigen::Vector3d(after * (y / spot.exit_mm))
                                    : Eigen::Vector3d(Eigen::Vector3d::Zero());
        poses.push_back(Standing{at});
        travel.push_back(y);
    }
    RecordedPass pass;
    SEAM_OK(measure_standing(
        station, spot, poses, options.cancel, options.progress,
        [&](std::size_t i, const SpotMeasurer& measurer, const SpotMeasurement& m) {
            pass.profiles.push_back({travel[i], measurer.profile()});  // where nothing was seen, too
            if (m.status == SpotStatus::measured)
                pass.references.push_back({travel[i], m.feature.point_mm.x(), m.feature.point_mm.y()});
        }));
    return pass;
}

AlignmentOptions alignment_options(const Spot& spot) {
    AlignmentOptions options;
    options.jitter_mm = spot.jitter_mm;
    options.window_mm = std::max(spot.entry_mm, spot.exit_mm);
    options.reference_mm = Eigen::Vector2d(spot.reference_mm.x(), spot.reference_mm.z());
    return options;
}

Expected<JudgedPass> judge_pass(const Spot& spot, RecordedPass pass, const AlignmentOptions& options) {
    if (std::none_of(pass.profiles.begin(), pass.profiles.end(),
                     [](const TravelProfile& t) { return t.profile.size() > 0; }))
        return input_error("no profile was seen on the whole pass", Text("spot {}", spot.id),
                           "look at the live picture: light, stand-off, calibration");
    SEAM_TRY(auto result, check_alignment(pass.profiles, options));
    JudgedPass judged{spot, std::move(pass), options, std::move(result), std::nullopt};
    if (auto curve = fit_contour_curve(judged.pass.references)) judged.curve = *curve;
    return judged;
}

Expected<Spot> with_pass(const Spot& is, const JudgedPass& judged) {
    const Text where("spot {}", is.id);
    if (is.id != judged.spot.id || !measured_alike(is, judged.spot))
        return input_error("it was changed since it was passed", where, "record the pass again");
    if (judged.result.status != AlignmentStatus::frozen)
        return input_error(Text("the contour does not stand still: {}", to_string(judged.result.status)),
                           where, judged.result.cure);
    if (!judged.curve)
        return input_error("the feature was found in too few profiles to learn the contour's curve", where,
                           "record the pass again, or choose another feature");
    Spot after = is;
    after.curve = judged.curve;
    after.jitter_mm = judged.options.jitter_mm;
    return after;
}

Spot cured(const Spot& spot, const AlignmentResult& result, const Pose& flange_from_sensor) {
    const Eigen::Matrix3d turn =
        (Eigen::AngleAxisd(rad_from_deg(result.cure_about_z_deg), Eigen::Vector3d::UnitZ()) *
         Eigen::AngleAxisd(rad_from_deg(result.cure_about_x_deg), Eigen::Vector3d::UnitX()))
            .toRotationMatrix();
    const Eigen::Vector3d r = spot.reference_mm;
    Spot after = spot;
    after.base_from_flange = spot.base_from_flange * flange_from_sensor * make_pose(turn, r - turn * r) *
                             flange_from_sensor.inverse();
    return with_reference_of(spot, std::move(after));
}

FrozenContour frozen_contour(const std::string& spot_id, const AlignmentResult& result,
                             const AlignmentOptions& options) {
    FrozenContour frozen{spot_id,
                         result.status,
                         result.yaw_deg,
                         result.pitch_deg,
                         result.radius_mm,
                         result.expected_error_mm,
                         options.tolerance_mm,
                         options.jitter_mm,
                         {}};
    for (const TravelOffset& offset : result.offsets)
        if (offset.ok) frozen.offsets.push_back(offset);
    return frozen;
}

}  // namespace seamwright
