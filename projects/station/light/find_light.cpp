// The light that suits a spot, found on the part.

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/profile/stripe/peaks.h"
#include "projects/station/light/spot_light.h"
#include "projects/station/station.h"

namespace seamwright {
namespace {

constexpr double kShareToMerge = 0.03;  // of the lit lines badly seen by the best single exposure
constexpr double kStepUp = 6;           // to where dark lines are looked for
constexpr double kAnotherExposure = 1.5;
constexpr std::size_t kMostMerged = 3;

// One spot before the sensor: exposes, and keeps what was seen.
class Bench {
  public:
    Bench(ProfileSource& sensor, SensorLight& light, const SensorSetup& setup, const Spot& spot,
          const std::stop_token& cancel)
        : sensor_(sensor), light_(light), setup_(setup), spot_(spot), cancel_(cancel) {}

    Expected<void> expose(const ParameterValues& settings) {
        TriedLight tried;
        SEAM_OK(light_.set(settings));
        for (const auto& [name, value] : settings) tried.settings[name] = light_.now().at(name);
        SEAM_OK(sensor_.trigger(spot_.id));
        const AcquireLimits limits;
        SEAM_TRY(const auto frame, next_frame(sensor_, limits.frame_timeout, cancel_));
        const Text where("spot {}", spot_.id);
        if (frame->status != FrameStatus::ok)
            return device_error(Text("the frame is {}", to_string(frame->status)), where, "try again");
        if (frame->image.empty() || frame->profile.size() > 0)
            return input_error("the sensor delivers finished profiles, which show no light", where,
                               "set the exposure at the sensor itself");
        StripePeaks peaks;
        SEAM_OK(find_peaks(frame->image, setup_.peaks, peaks));
        full_scale = frame->image.full_scale();
        tried.surrounding = surrounding_level(frame->image);
        tried.stripe = stripe_light(peaks, full_scale);
        seen.push_back(std::move(peaks));
        frames.push_back(std::move(tried));
        return {};
    }

    std::vector<TriedLight> frames;
    std::vector<StripePeaks> seen;  // of each
    int full_scale = 1;

  private:
    ProfileSource& sensor_;
    SensorLight& light_;
    const SensorSetup& setup_;
    const Spot& spot_;
    const std::stop_token& cancel_;
};

const ParameterInfo* named(const std::vector<ParameterInfo>& list, const char* name) {
    const auto it = std::find_if(list.begin(), list.end(), [&](const auto& p) { return p.name == name; });
    return it == list.end() ? nullptr : &*it;
}

// Exposure first, gain where the longest exposure is too short.
struct Range {
    double shortest_us = 1, longest_us = 1, lowest_gain_db = 0, highest_gain_db = 0;
    bool gain = false;

    static double factor(double gain_db) { return std::pow(10, gain_db / 20); }
    double lowest() const { return shortest_us * factor(lowest_gain_db); }
    double highest() const { return longest_us * factor(gain ? highest_gain_db : lowest_gain_db); }
    ParameterValues settings(double light) const {
        ParameterValues s;
        const double us = std::clamp(light / factor(lowest_gain_db), shortest_us, longest_us);
        s["exposure_us"] = us < 100 ? us : std::round(us);
        if (gain) s["gain_db"] = std::clamp(20 * std::log10(light / us), lowest_gain_db, highest_gain_db);
        return s;
    }
};

Expected<Range> range_of(const ProfileSource& sensor, const Spot& spot, const FindLightOptions& options) {
    const Text where("spot {}", spot.id);
    const auto parameters = sensor.parameters();
    const ParameterInfo* exposure = named(parameters, "exposure_us");
    if (!exposure)
        return input_error("the sensor takes no exposure from here", where,
                           "set the exposure at the sensor itself");
    if (!std::isfinite(options.longest_us) || options.longest_us < 0 ||
        !std::isfinite(options.highest_gain_db))
        return usage_error(Text("{} us and {} dB are no limits", options.longest_us, options.highest_gain_db),
                           where, "give finite numbers");
    Range range;
    range.shortest_us = std::max(1.0, exposure->minimum);
    range.longest_us = exposure->maximum;
    // Longer would smear what the frozen contour was proven for.
    if (!spot.stop_at_trigger && spot.speed_mm_s > 0 && spot.jitter_mm > 0)
        range.longest_us = std::min(range.longest_us, 1e6 * spot.jitter_mm / spot.speed_mm_s);
    if (options.longest_us > 0) range.longest_us = std::min(range.longest_us, options.longest_us);
    if (range.longest_us < range.shortest_us)
        return usage_error(Text("the sensor exposes for {} us at least", range.shortest_us), where,
                           "allow more");
    if (const ParameterInfo* gain = named(parameters, "gain_db")) {
        range.gain = true;
        range.lowest_gain_db = std::max(0.0, gain->minimum);
        range.highest_gain_db =
            std::max(range.lowest_gain_db, std::min(gain->maximum, options.highest_gain_db));
    }
    return range;
}

// Searches for the lines in `only` (empty: all), from the frame `begin` on, which may be there already. The index of the
// best one in `bench`.
Expected<std::size_t> search(Bench& bench, const Range& range, LightSearch search, std::size_t begin,
                             const std::vector<std::uint8_t>& only, LightVerdict& verdict) {
    for (std::size_t k = begin; k < begin + kFramesOfSearch; ++k) {
        if (k == bench.frames.size()) SEAM_OK(bench.expose(range.settings(search.next())));
        TriedLight& tried = bench.frames.back();
        tried.for_dark_lines = !only.empty();
        if (!only.empty()) tried.stripe = stripe_light(bench.seen.back(), bench.full_scale, only);
        tried.verdict = judge_light(tried.stripe, tried.surrounding);
        if (search.seen(tried.stripe, tried.surrounding)) break;
    }
    verdict = search.verdict();
    std::size_t best = begin;
    const auto off = [&](std::size_t k) {
        return std::abs(std::log(light_of(bench.frames[k].settings) / search.light()));
    };
    for (std::size_t k = begin; k < bench.frames.size(); ++k)
        if (off(k) < off(best)) best = k;
    return best;
}

// The frame that shows best what `merged` shows badly; nullopt where that is not worth another exposure. `most`: light
// of the brightest exposure so far. `unserved_share`: of the lit lines.
Expected<std::optional<std::size_t>> further_exposure(Bench& bench, const Range& range, bool may_merge,
                                                      const StripePeaks& merged, double most,
                                                      double& unserved_share) {
    const double least = kAnotherExposure * most, start = std::min(kStepUp * most, range.highest());
    std::size_t begin = bench.frames.size();
    if (least > range.highest()) return std::nullopt;
    // Where nothing brighter was tried, one frame shows whether there is more to be seen.
    if (std::none_of(bench.frames.begin(), bench.frames.end(),
                     [&](const TriedLight& t) { return light_of(t.settings) > least; })) {
        SEAM_OK(bench.expose(range.settings(start)));
        bench.frames.back().verdict =
            judge_light(bench.frames.back().stripe, bench.frames.back().surrounding);
        bench.frames.back().for_dark_lines = true;
    }
    const auto only = unserved_lines(merged, bench.full_scale, bench.seen);
    const auto unserved = static_cast<double>(std::count(only.begin(), only.end(), 1));
    int lit = 0;
    for (int line = 0; line < merged.lines; ++line)
        lit += std::any_of(bench.seen.begin(), bench.seen.end(),
                           [&](const StripePeaks& p) { return p.count[static_cast<std::size_t>(line)] > 0; });
    unserved_share = lit > 0 ? unserved / lit : 0;
    if (unserved_share < kShareToMerge || !may_merge) return std::nullopt;
    LightVerdict verdict = LightVerdict::no_stripe;
    SEAM_TRY(const std::size_t best,
             search(bench, range, LightSearch(start, least, range.highest()), begin, only, verdict));
    if (verdict == LightVerdict::no_stripe) return std::nullopt;
    return best;
}

Expected<FoundLight> found_before(Bench& bench, Range range, const Spot& spot, double start) {
    FoundLight found;
    found.longest_us = range.longest_us;
    SEAM_TRY(std::size_t best,
             search(bench, range, LightSearch(start, range.lowest(), range.highest()), 0, {}, found.verdict));
    found.settings = bench.frames[best].settings;
    std::vector<StripePeaks> taken;
    std::vector<double> light, exposures;
    StripePeaks merged = bench.seen[best];
    // Further ones differ in the exposure alone.
    if (const auto gain = found.settings.find("gain_db"); gain != found.settings.end())
        range.lowest_gain_db = range.highest_gain_db = gain->second;
    while (found.verdict != LightVerdict::no_stripe) {
        taken.push_back(bench.seen[best]);
        light.push_back(light_of(bench.frames[best].settings));
        exposures.push_back(bench.frames[best].settings.at("exposure_us"));
        SEAM_OK(merge_exposures(taken, light, bench.full_scale, merged));
        if (exposures.size() == kMostMerged) break;
        double unserved = 0;
        SEAM_TRY(const auto next,
                 further_exposure(bench, range, spot.stop_at_trigger, merged, light.back(), unserved));
        if (exposures.size() == 1) found.unserved_share = unserved;
        if (!next) break;
        best = *next;
    }
    if (exposures.size() > 1) found.merge_us = exposures;
    found.tried = std::move(bench.frames);
    return found;
}

}  // namespace

Expected<FoundLight> find_light(Station& station, const Spot& spot, const FindLightOptions& options) {
    ProfileSource* sensor = station.sensor(spot.sensor_id);
    RobotLink* robot = station.robot(spot.robot_id);
    const SensorSetup* setup = find_sensor(station.project(), spot.sensor_id);
    if (!sensor || !robot || !setup)
        return usage_error("its sensor or robot is not connected", Text("spot {}", spot.id), "connect first");
    SEAM_TRY(const Range range, range_of(*sensor, spot, options));
    SEAM_TRY(const auto by_software, SoftwareTriggered::begin(*sensor));
    StartedSensors started;
    SEAM_OK(started.start(*sensor, options.cancel));
    // Everything that the spot sets beside exposure and gain holds during the search; all is set back after it.
    Spot asked = spot;
    asked.light.merge_us.clear();
    asked.light.shortest_us = asked.light.longest_us = 0;
    SEAM_TRY(auto light, SensorLight::begin(*sensor, *setup, {&asked, 1}, SensorLight::Look::always));
    SEAM_OK(light.ready(asked));
    SEAM_OK(stand_at(*robot, spot.id, spot.base_from_flange));
    Bench bench(*sensor, light, *setup, spot, options.cancel);
    return found_before(bench, range, spot, light_of(light.now()));
}

}  // namespace seamwright
