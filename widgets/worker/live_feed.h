#pragma once
// What the sensors see, for screens: newest frames only, turned into profiles by the project's recipe on a
// thread of its own. Whoever triggers the sensors (StationWorker when nothing runs, a run, a free-running
// sensor) does not wait for it and is not waited for. A sensor whose snapshots nobody has asked for within
// kShownFor is looked at twice a second only: filtering what no view shows would cost a core with eight
// sensors. Looking for the feature may take kSearchShare of a core per sensor: one that takes longer than the
// frames leave is looked for in every so many of them, at least every kSearchAtLeast, and in the last one.

#include <QObject>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>

#include "core/features/feature.h"
#include "core/profile/filter.h"
#include "core/profile/sensor_model.h"
#include "core/profile/stripe/peaks.h"
#include "devices/profile_source.h"

namespace seamwright {

// How a sensor's frames become a profile, and which feature is looked for.
struct LiveRecipe {
    PeakOptions peaks;
    FilterOptions filter;
    std::optional<SensorModel> model;      // absent: images have no millimetres
    std::optional<FeatureRecipe> feature;  // of the selected spot
    // Its reference profile, which tells the stripe from its reflections as in a run; empty: none is taught.
    Profile taught;
    Eigen::Vector2d taught_at_mm = Eigen::Vector2d::Zero();
};

struct LiveSnapshot {
    std::string sensor_id;
    std::uint64_t number = 0;        // counts snapshots of the sensor
    Profile profile;                 // filtered; empty when the frame shows no stripe
    std::optional<Feature> feature;  // of LiveRecipe::feature; of a frame shortly before where it takes long
    FramePtr frame;                  // raw image where the sensor gives one
    StripePeaks peaks;               // of the image
    double rate_hz = 0;              // frames of the source, by their numbers
    SourceCounters counters;
    Text trouble;  // why there is no profile; empty when there is one
};

// A picture that is older is not live.
inline constexpr std::chrono::milliseconds kStale{1000};
inline constexpr std::chrono::milliseconds kShownFor{1000}, kHiddenPeriod{500}, kSearchAtLeast{200};
inline constexpr double kSearchShare = 0.04;

class LiveFeed : public QObject {
    Q_OBJECT
  public:
    explicit LiveFeed(QObject* parent = nullptr);
    ~LiveFeed() override;

    // The sources must stay until detach() has returned.
    void attach(const std::map<std::string, ProfileSource*>& sources);
    void detach();
    void set_recipe(const std::string& sensor_id, const LiveRecipe& recipe);
    // nullptr before the first frame. Whoever asks shows it.
    std::shared_ptr<const LiveSnapshot> latest(const std::string& sensor_id) const;
    // Since the newest frame; nothing before the first one and while the sensor is not attached.
    std::optional<std::chrono::milliseconds> age(const std::string& sensor_id) const;
    bool attached(const std::string& sensor_id) const;
    double rate_hz(const std::string& sensor_id) const;  // 0 before the second frame and when it is stale

  signals:
    void arrived();  // at least one sensor has a newer snapshot; coalesced

  public slots:
    void taken();  // the receiver has drawn: the next arrival is told again

  private:
    struct Lane;
    void work(const std::stop_token& stop);
    static void search(Lane& lane, const Profile& profile);
    static void take_recipe(Lane& lane, const LiveRecipe& recipe);
    mutable std::mutex mutex_;  // sources, recipes, snapshots
    std::mutex use_mutex_;      // held while a source is asked
    std::map<std::string, std::shared_ptr<Lane>> lanes_;
    std::map<std::string, LiveRecipe> recipes_;
    std::atomic<bool> told_ = false;
    std::jthread thread_;
};

}  // namespace seamwright
