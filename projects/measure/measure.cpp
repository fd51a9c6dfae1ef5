#include "projects/measure/measure.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/features/kinds/feature_registry.h"
#include "core/features/registration/taught_stripe.h"
#include "projects/measure/measure_detail.h"

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

void clear_candidates(ProfileCandidates& c) {
    c.lines = 0;
    c.per_line = 1;
    c.count.clear();
    c.x_mm.clear();
    c.z_mm.clear();
    c.intensity.clear();
}

}  // namespace

const SensorSetup* find_sensor(const Project& project, const std::string& id) {
    return find_by_id(project.sensors, id);
}
const RobotSetup* find_robot(const Project& project, const std::string& id) {
    return find_by_id(project.robots, id);
}
const Spot* find_spot(const Project& project, const std::string& id) {
    return find_by_id(project.spots, id);
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

// Does what a spot's sensor sends hold every line of its field? The stripe in an image has a place for each; a sensor
// that lists one line without return lists all of them. A file may have dropped those without return: its profile is
// then shorter than what was taught.
struct ListedLines {
    bool images = false;     // what an image's stripe tells
    std::size_t taught = 0;  // lines of a profile that lists all of them; 0: none is known to

    static ListedLines of(const Project& project, const Spot& spot) {
        constexpr std::ptrdiff_t kFewestEmpty = 3;
        ListedLines lines;
        const Calibration* calibration = calibration_of(project, spot);
        if (calibration && calibration->method == "pixels")
            return lines;  // a look at images, nothing that is corrected by
        lines.images = calibration && calibration->model;
        for (const Spot& other : project.spots) {
            const auto& z = other.reference_profile.z_mm;
            if (other.sensor_id == spot.sensor_id &&
                std::count_if(z.begin(), z.end(), [](double v) { return !std::isfinite(v); }) >= kFewestEmpty)
                lines.taught = std::max(lines.taught, z.size());
        }
        return lines;
    }
    bool any() const { return images || taught > 0; }
    bool all_in(const Capture& capture) const {
        constexpr double kAll = 0.9;  // of the lines: what lies without return is more
        const std::size_t n = capture.profile.size();
        return n == 0 ? images : taught > 0 && double(n) >= kAll * double(taught);
    }
};

struct SpotMeasurer::Impl {
    Spot spot;
    PeakOptions peak_options;
    FilterOptions filter;
    std::optional<SensorModel> model;
    Pose flange_from_sensor = Pose::Identity();
    bool calibrated = false;
    std::unique_ptr<FeatureFinder> finder;
    ListedLines lines;
    std::unique_ptr<FeatureFinder> finder_of_all_lines;  // of contour ends, where a sensor may list them all
    std::optional<TaughtStripe> taught;                  // where the reference profile is a contour

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
        const bool all = finder_of_all_lines && lines.all_in(from);
        measurement.feature = (all ? finder_of_all_lines : finder)->find(profile);
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
    auto impl = std::make_unique<Impl>();
    const auto finder_of = [&](const FeatureRecipe& recipe) {
        return make_feature_finder(recipe).map_error([&](Error error) {
            error.within(where);
            return error;
        });
    };
    SEAM_TRY(auto finder, finder_of(spot->feature));
    impl->lines = ListedLines::of(project, *spot);
    if (spot->feature.kind == "contour-end" && impl->lines.any()) {
        FeatureRecipe recipe = spot->feature;
        recipe.parameters["every_line"] = 1;
        SEAM_TRY(impl->finder_of_all_lines, finder_of(recipe));
    }
    impl->spot = *spot;
    impl->peak_options = sensor->peaks;
    impl->filter = sensor->filter;
    impl->finder = std::move(finder);
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

}  // namespace seamwright
