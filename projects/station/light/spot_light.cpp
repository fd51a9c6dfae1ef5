#include "projects/station/light/spot_light.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "devices/robot_link.h"

namespace seamwright {
namespace {

constexpr const char* kExposure = "exposure_us";
constexpr const char* kGain = "gain_db";
constexpr std::size_t kMostExposures = 4;
constexpr double kLongestExposure_us = 1e6;
// What a device rounds a value to; further off it did not take it.
constexpr double kTakenShare = 0.25;
constexpr double kRetakeOverhead_s = 0.15;  // for setting, triggering and fetching, beside the exposure
constexpr double kSameExposure = 1.02;

bool is_number(double v) {
    return std::isfinite(v) && std::abs(v) <= 1e9;
}

Expected<void> check_settings(const ParameterValues& settings, const Text& where) {
    for (const auto& [name, value] : settings) {
        if (!may_belong_to_spot(name))
            return input_error(
                Text("\"{}\" is the sensor's and no setting of a spot", name), where,
                "set it at the sensor; what moves or scales the image is part of its calibration");
        if (!is_number(value) || (name == kExposure && (value <= 0 || value > kLongestExposure_us)))
            return input_error(Text("{} {} is no setting", name, value), where,
                               "give a finite number; exposures lie above 0 and up to 1 s");
    }
    return {};
}

}  // namespace

bool may_belong_to_spot(const std::string& parameter) {
    static const std::set<std::string> sensors{"pixel_format", "trigger", "scene", "channel"};
    return !parameter.empty() && !parameter.starts_with("region_") && !parameter.starts_with("binning") &&
           !parameter.starts_with("decimation") && !sensors.count(parameter);
}

Expected<void> check_light(const Spot& spot, const SensorSetup& sensor) {
    const SpotLight& light = spot.light;
    const Text where("spot {}, light", spot.id);
    SEAM_OK(check_settings(light.settings, where));
    std::set<std::string> paints;
    for (const PaintLight& paint : light.paints) {
        if (paint.paint.empty() || !paints.insert(paint.paint).second)
            return input_error(Text("paint \"{}\" has no name of its own", paint.paint), where,
                               "name each paint once");
        SEAM_OK(check_settings(paint.settings, joined(where, ", paint ", Text("{}", paint.paint))));
    }
    if (light.longest_us != 0 || light.shortest_us != 0)
        if (!is_number(light.shortest_us) || !(light.shortest_us > 0) ||
            !(light.longest_us > light.shortest_us) || !(light.longest_us <= kLongestExposure_us))
            return input_error(Text("the exposure cannot follow the paint between {} and {} us",
                                    light.shortest_us, light.longest_us),
                               where, "give a shortest above 0 and a longest above it, up to 1 s");
    if (light.merge_us.empty()) return {};
    if (light.merge_us.size() < 2 || light.merge_us.size() > kMostExposures)
        return input_error(Text("{} exposures are to be merged", light.merge_us.size()), where,
                           Text("give 2 to {}", kMostExposures));
    for (std::size_t k = 0; k < light.merge_us.size(); ++k)
        if (!(light.merge_us[k] > 0) || !(light.merge_us[k] <= kLongestExposure_us) ||
            (k > 0 && light.merge_us[k] <= light.merge_us[k - 1]))
            return input_error("the exposures to be merged do not ascend", where,
                               "give them above 0, each longer than the one before, up to 1 s");
    if (!spot.stop_at_trigger)
        return input_error("exposures are merged of a robot that stands, and it passes the spot", where,
                           "let it stop at the trigger");
    if (hardware_triggered(sensor))
        return input_error("the sensor is wired to the robot, which fires once a spot", where,
                           "use one exposure, or let the program trigger the sensor");
    if (light.follows_paint())
        return input_error("exposures that are merged do not follow the paint", where,
                           "give one or the other");
    return {};
}

ParameterValues settings_on(const SpotLight& light, const std::string& paint) {
    ParameterValues settings = light.settings;
    if (paint.empty()) return settings;
    for (const PaintLight& p : light.paints)
        if (p.paint == paint)
            for (const auto& [name, value] : p.settings) settings[name] = value;
    return settings;
}

bool knows_paint(const Project& project, const std::string& paint) {
    return std::any_of(project.spots.begin(), project.spots.end(), [&](const Spot& s) {
        return s.enabled && (s.light.follows_paint() ||
                             std::any_of(s.light.paints.begin(), s.light.paints.end(),
                                         [&](const PaintLight& p) { return p.paint == paint; }));
    });
}

int further_exposures(const Spot& spot) {
    if (!spot.stop_at_trigger) return 0;
    if (!spot.light.merge_us.empty()) return static_cast<int>(spot.light.merge_us.size()) - 1;
    return spot.light.follows_paint() ? kRetakes : 0;
}

double standing_time_s(const Spot& spot) {
    double time_s = kStand_s;
    if (!spot.stop_at_trigger) return time_s;
    if (!spot.light.merge_us.empty())
        for (const double us : spot.light.merge_us) time_s += us * 1e-6 + kRetakeOverhead_s;
    else
        time_s += further_exposures(spot) * (spot.light.longest_us * 1e-6 + kRetakeOverhead_s);
    return std::ceil(100 * time_s - 1e-9) / 100;  // as robot programs write it
}

double light_of(const ParameterValues& settings) {
    const auto value = [&](const char* name, double otherwise) {
        const auto it = settings.find(name);
        return it == settings.end() ? otherwise : it->second;
    };
    return value(kExposure, 1) * std::pow(10, value(kGain, 0) / 20);
}

Expected<SensorLight> SensorLight::begin(ProfileSource& sensor, const SensorSetup& setup,
                                         std::span<const Spot> spots, Look look, std::string paint,
                                         PaintFactors* factors) {
    std::set<std::string> names;
    for (const Spot& spot : spots) {
        if (spot.sensor_id != setup.id) continue;
        SEAM_OK(check_light(spot, setup));
        for (const auto& [name, value] : spot.light.settings) names.insert(name);
        for (const PaintLight& p : spot.light.paints)
            for (const auto& [name, value] : p.settings) names.insert(name);
        if (!spot.light.merge_us.empty() || spot.light.follows_paint()) names.insert(kExposure);
    }
    SensorLight light(sensor, setup);
    if (names.empty() && look == Look::where_asked) {
        light.sensor_ = nullptr;
        return light;
    }
    std::string known;
    for (ParameterInfo& info : sensor.parameters()) {
        if (may_belong_to_spot(info.name)) known += (known.empty() ? "" : ", ") + info.name;
        light.infos_[info.name] = std::move(info);
    }
    // Recorded beside whatever else is set: the two make the light.
    for (const char* name : {kExposure, kGain})
        if (light.infos_.count(name)) names.insert(name);
    if (names.empty()) {  // a sensor without either
        light.sensor_ = nullptr;
        return light;
    }
    for (const std::string& name : names) {
        if (!light.infos_.count(name)) {
            light.sensor_ = nullptr;
            return input_error(Text("the sensor has no setting \"{}\"", name), Text("sensor {}", setup.id),
                               known.empty()
                                   ? Text("it takes no settings from here: set them at the sensor, and "
                                          "remove them from the spot")
                                   : Text("spots may set {}", known));
        }
        auto now = sensor.get(name);
        if (!now) {
            light.sensor_ = nullptr;
            return tl::unexpected(now.error());
        }
        light.now_[name] = *now;
    }
    light.asked_ = light.before_ = light.now_;
    if (auto possible = light.check_values(spots); !possible) {
        light.sensor_ = nullptr;
        return tl::unexpected(possible.error());
    }
    light.paint_ = std::move(paint);
    light.factors_ = factors;
    if (factors)
        if (const auto it = factors->find({setup.id, light.paint_}); it != factors->end())
            light.factor_ = it->second;
    return light;
}

Expected<void> SensorLight::check_values(std::span<const Spot> spots) const {
    std::vector<ParameterInfo> infos;
    for (const auto& [name, info] : infos_) infos.push_back(info);
    const auto check = [&](const Spot& spot, const ParameterValues& values) {
        return validate(values, infos, Text("spot {}, sensor {}", spot.id, setup_->id));
    };
    for (const Spot& spot : spots) {
        if (spot.sensor_id != setup_->id) continue;
        SEAM_OK(check(spot, spot.light.settings));
        for (const PaintLight& p : spot.light.paints) SEAM_OK(check(spot, p.settings));
        for (const double us : spot.light.merge_us) SEAM_OK(check(spot, {{kExposure, us}}));
        if (spot.light.follows_paint())
            for (const double us : {spot.light.shortest_us, spot.light.longest_us})
                SEAM_OK(check(spot, {{kExposure, us}}));
    }
    return {};
}

SensorLight::SensorLight(SensorLight&& other) noexcept
    : sensor_(std::exchange(other.sensor_, nullptr)),
      setup_(other.setup_),
      before_(std::move(other.before_)),
      now_(std::move(other.now_)),
      asked_(std::move(other.asked_)),
      infos_(std::move(other.infos_)),
      ready_for_(std::move(other.ready_for_)),
      paint_(std::move(other.paint_)),
      factor_(other.factor_),
      factors_(other.factors_) {}

SensorLight::~SensorLight() {
    // A sensor that is gone comes back with its own settings.
    if (sensor_) (void)set(before_);
}

Expected<void> SensorLight::set(const ParameterValues& wanted) {
    for (const auto& [name, value] : wanted) {
        if (asked_[name] == value) continue;
        const Text where("sensor {}", setup_->id);
        if (auto done = sensor_->set(name, value); !done) {
            Error error = done.error();
            error.within(where);
            return tl::unexpected(std::move(error));
        }
        SEAM_TRY(const double taken, sensor_->get(name));
        const ParameterInfo& info = infos_.at(name);
        const double step = info.choices.empty() ? std::pow(10, -info.decimals) : 0;
        if (std::abs(taken - value) >
            std::max(info.choices.empty() ? kTakenShare * std::abs(value) : 0, step))
            return device_error(Text("{} was set to {} and reads back as {}", name, value, taken), where,
                                "choose what the sensor can take");
        asked_[name] = value;
        now_[name] = taken;
    }
    return {};
}

double SensorLight::own_exposure_us(const Spot& spot) const {
    const ParameterValues own = settings_on(spot.light, paint_);
    const auto it = own.find(kExposure);
    return it == own.end() ? before_.at(kExposure) : it->second;
}

double SensorLight::exposure_us(const Spot& spot) const {
    return std::clamp(own_exposure_us(spot) * factor_, spot.light.shortest_us, spot.light.longest_us);
}

Expected<void> SensorLight::ready(const Spot& spot) {
    if (!in_use()) return {};
    ready_for_.clear();
    ParameterValues wanted = before_;
    for (const auto& [name, value] : settings_on(spot.light, paint_)) wanted[name] = value;
    if (!spot.light.merge_us.empty())
        wanted[kExposure] = spot.light.merge_us.front();
    else if (spot.light.follows_paint())
        wanted[kExposure] = exposure_us(spot);
    if (auto done = set(wanted); !done) {
        Error error = done.error();
        error.within(Text("spot {}", spot.id));
        return tl::unexpected(std::move(error));
    }
    ready_for_ = spot.id;
    return {};
}

SeenLight SensorLight::seen_by(const SpotMeasurer& measurer, const Frame& frame) const {
    SeenLight seen;
    seen.settings = now_;
    if (frame.status != FrameStatus::ok || frame.profile.size() > 0 || frame.image.empty()) return seen;
    const StripeLight light = stripe_light(measurer.peaks(), frame.image.full_scale());
    seen.bright = light.bright;
    seen.saturated_share = light.saturated_share();
    seen.width_px = light.width_px;
    return seen;
}

Expected<SpotMeasurement> SensorLight::measure(const Spot& spot, FramePtr first,
                                               const std::optional<Pose>& reported, SpotMeasurer& measurer,
                                               const Take& take, bool may_take_again) {
    if (!in_use()) return measurer.measure(*first, reported);
    if (!spot.light.merge_us.empty()) return measure_merged(spot, std::move(first), reported, measurer, take);
    SpotMeasurement m = measurer.measure(*first, reported);
    m.light = seen_by(measurer, *first);
    if (!spot.light.follows_paint()) return m;
    FramePtr frame = std::move(first);
    for (int k = 0; m.light->bright; ++k) {
        const StripeLight light = stripe_light(measurer.peaks(), frame->image.full_scale());
        const double surrounding = surrounding_level(frame->image);
        if (judge_light(light, surrounding) == LightVerdict::fit) break;
        const double used = exposure_us(spot), own = own_exposure_us(spot);
        factor_ = std::clamp(factor_ * wanted_light_factor(light, surrounding), spot.light.shortest_us / own,
                             spot.light.longest_us / own);
        const double wanted = exposure_us(spot);
        if (wanted < used * kSameExposure && wanted * kSameExposure > used) break;  // at a limit
        if (!may_take_again || k == kRetakes) break;
        SEAM_OK(set({{kExposure, wanted}}));
        SEAM_TRY(auto again, take());
        if (!again) break;
        frame = std::move(again);
        m = measurer.measure(*frame, reported);
        m.light = seen_by(measurer, *frame);
    }
    if (factors_) (*factors_)[{setup_->id, paint_}] = factor_;
    return m;
}

Expected<SpotMeasurement> SensorLight::measure_merged(const Spot& spot, FramePtr first,
                                                      const std::optional<Pose>& reported,
                                                      SpotMeasurer& measurer, const Take& take) {
    std::vector<FramePtr> frames{std::move(first)};
    std::vector<double> light{light_of(now_)};
    SpotMeasurement m;
    for (std::size_t k = 1; k < spot.light.merge_us.size(); ++k) {
        SEAM_OK(set({{kExposure, spot.light.merge_us[k]}}));
        SEAM_TRY(auto next, take());
        if (!next) break;
        frames.push_back(std::move(next));
        light.push_back(light_of(now_));
    }
    const bool all = frames.size() == spot.light.merge_us.size();
    // Fewer than were taught see less of the contour: another contour.
    if (all) {
        m = measurer.measure(frames, light, reported);
        m.light = seen_by(measurer, *frames.front());
    } else {
        Frame gone;
        gone.status = FrameStatus::incomplete;
        gone.sequence = frames.front()->sequence;
        gone.host_time_ns = frames.front()->host_time_ns;
        m = measurer.measure(gone, reported);
        m.light = SeenLight{.settings = now_, .bright = {}, .saturated_share = {}, .width_px = {}};
    }
    m.light->exposures = static_cast<int>(frames.size());
    if (!all) {
        m.status = SpotStatus::not_measured;
        m.message =
            Text("the robot went on after {} of {} exposures", frames.size(), spot.light.merge_us.size());
    }
    return m;
}

}  // namespace seamwright
