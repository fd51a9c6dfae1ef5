#include "widgets/worker/live_feed.h"

#include <utility>

#include "core/features/feature.h"
#include "core/features/kinds/feature_registry.h"
#include "core/features/registration/taught_stripe.h"
#include "widgets/shown_text.h"

namespace seamwright {

using Clock = std::chrono::steady_clock;

struct LiveFeed::Lane {
    ProfileSource* source = nullptr;
    std::shared_ptr<const LiveRecipe> recipe = std::make_shared<LiveRecipe>();
    bool recipe_changed = true;
    std::unique_ptr<FeatureFinder> finder;
    std::optional<TaughtStripe> taught;
    std::optional<Feature> feature;  // last found
    std::uint64_t last_sequence = 0;
    std::int64_t last_time_ns = -1;
    std::uint64_t number = 0;
    double rate_hz = 0;
    Clock::time_point last_seen, asked;  // converted; by a view
    Clock::time_point search_due;        // not before
    bool search_owed = false;            // the newest snapshot carries the feature of an older one
    ProfileCandidates candidates;
    std::shared_ptr<const LiveSnapshot> newest;
};

namespace {

// Frame -> peaks -> candidates -> tracked profile; the reason when there is none. Where the taught contour cannot tell
// the stripe from a reflection, the feature is ambiguous, as in a run.
Text convert(const Frame& frame, const LiveRecipe& recipe, std::optional<TaughtStripe>& taught,
             ProfileCandidates& candidates, LiveSnapshot& snapshot) {
    if (frame.status != FrameStatus::ok) return Text("damaged frame: {}", to_string(frame.status));
    if (frame.profile.size() > 0) {
        snapshot.profile = frame.profile;
        if (auto filtered = filter_profile(snapshot.profile, recipe.filter); !filtered)
            return filtered.error().text();
        return {};
    }
    if (frame.image.empty()) return "the frame is empty";
    if (auto found = find_peaks(frame.image, recipe.peaks, snapshot.peaks); !found)
        return found.error().text();
    if (!recipe.model) return "no calibration: the image has no millimetres";
    to_millimetres(snapshot.peaks, *recipe.model, candidates);
    if (!taught) {
        const auto tracked = track_stripe(candidates, recipe.filter, snapshot.profile);
        return tracked ? Text{} : tracked.error().text();
    }
    const auto choice = taught->track(candidates, recipe.filter, snapshot.profile);
    if (!choice) return choice.error().text();
    if (*choice == StripeChoice::undecided) {
        snapshot.feature.emplace().status = FeatureStatus::ambiguous;
        snapshot.feature->message = kTwoContours;
    }
    return {};
}

}  // namespace

// Takes milliseconds; whoever asks for the newest does not wait for it.
void LiveFeed::take_recipe(Lane& lane, const LiveRecipe& recipe) {
    lane.search_due = {};
    lane.feature.reset();
    lane.finder.reset();
    lane.taught.reset();
    if (!recipe.feature) return;
    if (auto made = make_feature_finder(*recipe.feature)) lane.finder = std::move(*made);
    if (auto made = TaughtStripe::make(recipe.taught, recipe.taught_at_mm, search_window(*recipe.feature)))
        lane.taught.emplace(std::move(*made));
}

void LiveFeed::search(Lane& lane, const Profile& profile) {
    const auto start = Clock::now();
    lane.feature = lane.finder->find(profile);
    const auto end = Clock::now();
    const auto rest = std::chrono::duration_cast<Clock::duration>((end - start) * (1 / kSearchShare - 1));
    lane.search_due = end + std::min<Clock::duration>(rest, kSearchAtLeast);
    lane.search_owed = false;
}

LiveFeed::LiveFeed(QObject* parent)
    : QObject(parent), thread_([this](const std::stop_token& stop) { work(stop); }) {}

LiveFeed::~LiveFeed() {
    thread_.request_stop();
    thread_.join();
}

void LiveFeed::attach(const std::map<std::string, ProfileSource*>& sources) {
    const std::lock_guard use(use_mutex_);
    const std::lock_guard lock(mutex_);
    lanes_.clear();
    for (auto& [id, source] : sources) {
        auto lane = std::make_shared<Lane>();
        lane->source = source;
        if (const auto it = recipes_.find(id); it != recipes_.end())
            lane->recipe = std::make_shared<LiveRecipe>(it->second);
        lanes_[id] = std::move(lane);
    }
}

void LiveFeed::detach() {
    const std::lock_guard use(use_mutex_);
    const std::lock_guard lock(mutex_);
    lanes_.clear();
}

void LiveFeed::set_recipe(const std::string& sensor_id, const LiveRecipe& recipe) {
    const std::lock_guard lock(mutex_);
    recipes_[sensor_id] = recipe;
    if (const auto it = lanes_.find(sensor_id); it != lanes_.end()) {
        it->second->recipe = std::make_shared<LiveRecipe>(recipe);
        it->second->recipe_changed = true;
    }
}

std::shared_ptr<const LiveSnapshot> LiveFeed::latest(const std::string& sensor_id) const {
    const std::lock_guard lock(mutex_);
    const auto it = lanes_.find(sensor_id);
    if (it == lanes_.end()) return nullptr;
    it->second->asked = Clock::now();
    return it->second->newest;
}

std::optional<std::chrono::milliseconds> LiveFeed::age(const std::string& sensor_id) const {
    const std::lock_guard lock(mutex_);
    const auto it = lanes_.find(sensor_id);
    if (it == lanes_.end() || !it->second->newest) return std::nullopt;
    return std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - it->second->last_seen);
}

bool LiveFeed::attached(const std::string& sensor_id) const {
    const std::lock_guard lock(mutex_);
    return lanes_.contains(sensor_id);
}

double LiveFeed::rate_hz(const std::string& sensor_id) const {
    const auto old = age(sensor_id);
    if (!old || *old > kStale) return 0;
    const std::lock_guard lock(mutex_);
    const auto it = lanes_.find(sensor_id);
    return it == lanes_.end() || !it->second->newest ? 0 : it->second->newest->rate_hz;
}

void LiveFeed::taken() {
    told_ = false;
}

void LiveFeed::work(const std::stop_token& stop) {
    while (!stop.stop_requested()) {
        bool fresh = false;
        std::vector<std::pair<std::string, std::shared_ptr<Lane>>> lanes;
        {
            const std::lock_guard lock(mutex_);
            lanes.assign(lanes_.begin(), lanes_.end());
        }
        for (auto& [id, lane] : lanes) {
            FramePtr frame;
            SourceCounters counters;
            bool owed = false;
            {
                const std::lock_guard use(use_mutex_);
                {
                    const std::lock_guard lock(mutex_);
                    const auto it = lanes_.find(id);
                    if (it == lanes_.end() || it->second != lane) continue;  // detached meanwhile
                    const auto now = Clock::now();
                    if (now - lane->asked > kShownFor && now - lane->last_seen < kHiddenPeriod) continue;
                }
                frame = lane->source->latest();
                if (!frame ||
                    (frame->sequence == lane->last_sequence && frame->host_time_ns == lane->last_time_ns)) {
                    if (lane->search_owed && Clock::now() >= lane->search_due) owed = true;
                    if (!owed) continue;
                } else {
                    counters = lane->source->counters();
                }
            }
            if (owed) {
                std::shared_ptr<LiveSnapshot> again;
                {
                    const std::lock_guard lock(mutex_);
                    lane->search_owed = false;
                    if (lane->newest && lane->finder && !lane->recipe_changed)
                        again = std::make_shared<LiveSnapshot>(*lane->newest);
                }
                if (!again) continue;
                again->number = ++lane->number;
                search(*lane, again->profile);
                again->feature = lane->feature;
                const std::lock_guard lock(mutex_);
                lane->newest = std::move(again);
                fresh = true;
                continue;
            }
            const std::uint64_t frames =
                frame->sequence > lane->last_sequence ? frame->sequence - lane->last_sequence : 1;
            lane->last_sequence = frame->sequence;
            lane->last_time_ns = frame->host_time_ns;
            std::shared_ptr<const LiveRecipe> recipe;
            bool changed = false;
            {
                const std::lock_guard lock(mutex_);
                recipe = lane->recipe;
                changed = std::exchange(lane->recipe_changed, false);
            }
            if (changed) take_recipe(*lane, *recipe);
            auto snapshot = std::make_shared<LiveSnapshot>();
            snapshot->sensor_id = id;
            snapshot->number = ++lane->number;
            snapshot->frame = frame;
            snapshot->counters = counters;
            snapshot->trouble = convert(*frame, *recipe, lane->taught, lane->candidates, *snapshot);
            if (!snapshot->trouble.empty() || snapshot->feature) {
                lane->feature.reset();
                lane->search_due = {};
                lane->search_owed = false;
            } else if (lane->finder) {
                if (Clock::now() >= lane->search_due)
                    search(*lane, snapshot->profile);
                else
                    lane->search_owed = true;
                snapshot->feature = lane->feature;
            }
            const auto now = Clock::now();
            if (lane->number > 1) {
                const double seconds = std::chrono::duration<double>(now - lane->last_seen).count();
                const double rate = seconds > 1e-6 ? static_cast<double>(frames) / seconds : 0;
                lane->rate_hz = lane->rate_hz > 0 ? 0.9 * lane->rate_hz + 0.1 * rate : rate;
            }
            snapshot->rate_hz = lane->rate_hz;
            const std::lock_guard lock(mutex_);
            lane->last_seen = now;
            lane->newest = std::move(snapshot);
            fresh = true;
        }
        if (fresh && !told_.exchange(true)) emit arrived();
        std::this_thread::sleep_for(std::chrono::milliseconds(fresh ? 2 : 8));
    }
}

}  // namespace seamwright
