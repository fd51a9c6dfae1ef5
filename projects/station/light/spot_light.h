#pragma once
// The sensor set to what a spot asks for (Spot::light), before each frame of it, in runs as in teaching; and the light that
// suits a spot, found on the part.
//
// Every value that is set is read back from the device and kept with the measurement (SpotMeasurement::light). A setting
// that the device does not know or does not take is an Error: a spot is never measured with another one's.
//
// Following the paint (SpotLight::shortest_us..longest_us). A robot in motion sees a spot once, so what one spot showed
// sets the exposure of the next ones of the same sensor on this part: their own, times the factor that
// the spots before needed, within each one's limits. The first spot of a part begins with the factor of the last
// part of this paint. Where the robot stands and the sensor is triggered by software, the spot itself is taken again, up
// to kRetakes times.

#include <functional>
#include <map>
#include <span>
#include <stop_token>

#include "projects/measure/measure.h"
#include "projects/station/acquire.h"

namespace seamwright {

class Station;
struct RunProgress;

// Settings that move or scale the image's pixels, or what stands before a sensor, are the sensor's and not a spot's.
bool may_belong_to_spot(const std::string& parameter);
// The first thing in it that no run could follow: names, numbers, limits, exposures to be merged in motion or on a wired sensor.
Expected<void> check_light(const Spot& spot, const SensorSetup& sensor);

// The settings of a spot on a paint ("": none was said).
ParameterValues settings_on(const SpotLight& light, const std::string& paint);
// Whether an enabled spot names the paint, or follows any.
bool knows_paint(const Project& project, const std::string& paint);
// Exposures after the first that a run may want while the robot stands at the spot.
int further_exposures(const Spot& spot);
// How long the robot has to stand for them, kStand_s at least.
double standing_time_s(const Spot& spot);

// Exposure times gain, in microseconds at 0 dB; 1 where neither is known.
double light_of(const ParameterValues& settings);

inline constexpr int kRetakes = 2;

// The factor on a spot's own exposure that a part's paint asked for: by sensor and paint.
using PaintFactors = std::map<std::pair<std::string, std::string>, double>;

// One sensor from spot to spot. Touches nothing while none of `spots` asks for anything. Must not outlive the
// sensor.
class SensorLight {
  public:
    // `spots`: all that this sensor will cut; the settings that any of them names stand as they do now, before and
    // between. Look::always: what is measured gets its light also where no spot asks for anything. Error: the device
    // does not know one, or does not tell it.
    enum class Look { where_asked, always };
    static Expected<SensorLight> begin(ProfileSource& sensor, const SensorSetup& setup,
                                       std::span<const Spot> spots, Look look, std::string paint = {},
                                       PaintFactors* factors = nullptr);
    SensorLight(SensorLight&& other) noexcept;
    SensorLight& operator=(SensorLight&&) = delete;
    ~SensorLight();  // the sensor as it was

    bool in_use() const { return sensor_ != nullptr; }
    // Sets the sensor for this spot's first exposure. Error: refused, or read back otherwise.
    Expected<void> ready(const Spot& spot);
    // Besides: these now. Precondition: exposure, gain or named by a spot. Error: refused, or read back otherwise.
    Expected<void> set(const ParameterValues& wanted);
    bool is_ready_for(const Spot& spot) const { return !in_use() || ready_for_ == spot.id; }
    // What the sensor stands at now, of what any spot names.
    const ParameterValues& now() const { return now_; }

    // A frame of `spot` after its first one was taken. `take` triggers the sensor once more. What is measured then stands in
    // `measurer`, with light. `may_take_again`: the robot stands and will.
    using Take = std::function<Expected<FramePtr>()>;
    Expected<SpotMeasurement> measure(const Spot& spot, FramePtr first, const std::optional<Pose>& reported,
                                      SpotMeasurer& measurer, const Take& take, bool may_take_again);

  private:
    explicit SensorLight(ProfileSource& sensor, const SensorSetup& setup)
        : sensor_(&sensor), setup_(&setup) {}
    // Within what the device takes.
    Expected<void> check_values(std::span<const Spot> spots) const;
    Expected<SpotMeasurement> measure_merged(const Spot& spot, FramePtr first,
                                             const std::optional<Pose>& reported, SpotMeasurer& measurer,
                                             const Take& take);
    SeenLight seen_by(const SpotMeasurer& measurer, const Frame& frame) const;
    double own_exposure_us(const Spot& spot) const;
    double exposure_us(const Spot& spot) const;  // of a spot that follows the paint

    ProfileSource* sensor_ = nullptr;  // nullptr: nothing to set
    const SensorSetup* setup_ = nullptr;
    ParameterValues before_, now_, asked_;  // asked_: as set, which a device rounds
    std::map<std::string, ParameterInfo> infos_;
    std::string ready_for_, paint_;
    double factor_ = 1;
    PaintFactors* factors_ = nullptr;
};

// One frame of a search.
struct TriedLight {
    ParameterValues settings;  // read back
    StripeLight stripe;
    double surrounding = 0;
    LightVerdict verdict = LightVerdict::no_stripe;
    bool for_dark_lines = false;  // of the lines alone that the exposure found before shows badly
};

// What suits a spot. `merge_us`: two or three exposures where no single one shows all lines.
struct FoundLight {
    std::vector<TriedLight> tried;
    LightVerdict verdict = LightVerdict::no_stripe;
    ParameterValues settings;
    std::vector<double> merge_us;
    double unserved_share = 0;  // of the lit lines, badly seen by `settings` alone
    double longest_us = 0;      // that was allowed
};

struct FindLightOptions {
    double longest_us =
        0;  // 0: the device's, and where the robot passes the spot what the jitter window allows
    double highest_gain_db = 12;  // gain only where the longest exposure is too short
    std::stop_token cancel;
};

// Goes to the spot and stands there: at most kFramesOfSearch frames find one exposure, as many more each further one that is
// merged, where the robot stands at the trigger. The sensor is left as it was. Error: device, cancelled, finished
// profiles (no image to judge), no exposure setting.
inline constexpr int kFramesOfSearch = 5;
Expected<FoundLight> find_light(Station& station, const Spot& spot, const FindLightOptions& options);

}  // namespace seamwright
