#include "projects/fleet/publish.h"

#include <condition_variable>
#include <deque>
#include <mutex>
#include <set>
#include <thread>

#include "projects/fleet/message.h"
#include "projects/fleet/store.h"

namespace seamwright {
namespace {

using fleet::Outgoing;
using fleet::Store;

constexpr std::int64_t kBatch = 200;       // of a publishing that nobody waits for
constexpr std::int64_t kBetweenParts = 5;  // runs that are read in one pause
constexpr std::size_t kMostWaiting = 200;  // messages in memory
constexpr std::chrono::milliseconds kLooked{250};

Expected<std::string> station_name(const std::string& given, const FleetMessages& messages) {
    const std::string name = given.empty() ? messages.project_name() : given;
    SEAM_OK(check_station_name(name));
    return name;
}

// What is to be sent of these runs. A damaged run is told and does not hold up the others.
struct Made {
    std::vector<Outgoing> messages;
    std::vector<QueuedRun> gone;  // there is nothing to publish of them
    std::vector<std::pair<std::int64_t, Error>> refused;
};
Made made_of(const ProjectFile& file, const FleetMessages& messages, const std::vector<QueuedRun>& runs) {
    Made made;
    for (const QueuedRun& run : runs) {
        auto message = messages.message(file, run);
        if (!message)
            made.refused.emplace_back(run.run, message.error());
        else if (*message)
            made.messages.push_back({run, std::move(**message)});
        else
            made.gone.push_back(run);
    }
    return made;
}

}  // namespace

Expected<PublishReport> publish_file(ProjectFile& file, const FleetTarget& target,
                                     const PublishOptions& options) {
    SEAM_TRY(const auto messages, FleetMessages::of(file));
    PublishReport report;
    SEAM_TRY(report.station, station_name(options.station, messages));
    SEAM_TRY(auto store, Store::connect(target));
    SEAM_TRY(const auto all, file.queued());
    for (std::int64_t after = -1; !options.cancel.stop_requested();) {
        SEAM_TRY(const auto queued, file.queued_runs(after, kBatch));
        if (queued.empty()) break;
        after = queued.back().run;
        Made made = made_of(file, messages, queued);
        SEAM_TRY(auto taken, store.take(report.station, messages.setup(), made.messages));
        report.runs += static_cast<std::int64_t>(taken.runs.size());
        made.gone.insert(made.gone.end(), taken.runs.begin(), taken.runs.end());
        for (auto* refused : {&made.refused, &taken.refused})
            for (auto& one : *refused) report.refused.push_back(std::move(one));
        SEAM_OK(file.published(made.gone));
        if (options.progress) options.progress(report.runs, all);
    }
    SEAM_TRY(report.waiting, file.queued());
    return report;
}

struct FleetPublisher::Impl {
    ProjectFile& file;
    FleetTarget target;
    PublisherOptions options;
    FleetMessages messages;
    std::string station;

    // Of the thread that owns the file.
    bool measuring = false;
    std::int64_t after = -1;
    std::chrono::steady_clock::time_point looked{};
    std::set<std::int64_t> let_be;  // refused by the database: not tried again while this runs

    std::mutex mutex;
    std::condition_variable_any wake;
    std::deque<Outgoing> to_send;
    std::vector<QueuedRun> done;
    std::vector<std::int64_t> refused;
    bool failing = false;
    std::jthread thread;  // the last: it ends before the rest goes

    Impl(ProjectFile& f, FleetTarget t, PublisherOptions o, FleetMessages m, std::string s)
        : file(f),
          target(std::move(t)),
          options(std::move(o)),
          messages(std::move(m)),
          station(std::move(s)) {}

    void tell(const Text& text) const {
        if (options.told) options.told(text);
    }

    void send(const std::stop_token& stop) {
        std::optional<Store> store;
        std::chrono::milliseconds wait = options.retry_first;
        while (!stop.stop_requested()) {
            std::vector<Outgoing> batch;
            {
                std::unique_lock lock(mutex);
                if (!wake.wait(lock, stop, [&] { return !to_send.empty(); })) return;
                batch.assign(to_send.begin(), to_send.end());
            }
            auto taken = send_batch(store, batch);
            const std::unique_lock lock(mutex);
            if (taken) {
                to_send.erase(to_send.begin(), to_send.begin() + static_cast<std::ptrdiff_t>(batch.size()));
                done.insert(done.end(), taken->runs.begin(), taken->runs.end());
                for (const auto& [run, error] : taken->refused) {
                    refused.push_back(run);
                    tell(Text("run {} is not published: {}", run, error.text()));
                }
                if (failing) tell("the fleet's database takes runs again");
                failing = false;
                wait = options.retry_first;
                continue;
            }
            store.reset();
            if (!failing) tell(Text("runs wait for the fleet's database: {}", taken.error().text()));
            failing = true;
            pause(stop, wait);
            wait = std::min(2 * wait, options.retry_longest);
        }
    }

    // Called with the mutex held, which is given back while it lasts.
    void pause(const std::stop_token& stop, std::chrono::milliseconds longest) {
        std::unique_lock lock(mutex, std::adopt_lock);
        wake.wait_for(lock, stop, longest, [] { return false; });
        lock.release();
    }

    Expected<Store::Taken> send_batch(std::optional<Store>& store, const std::vector<Outgoing>& batch) {
        if (!store) {
            SEAM_TRY(auto connected, Store::connect(target));
            store.emplace(std::move(connected));
        }
        return store->take(station, messages.setup(), batch);
    }

    // What was confirmed leaves the outbox, what is queued goes out.
    Expected<void> exchange(std::int64_t most) {
        std::vector<QueuedRun> confirmed;
        std::size_t waiting = 0;
        {
            const std::lock_guard lock(mutex);
            confirmed.swap(done);
            let_be.insert(refused.begin(), refused.end());
            refused.clear();
            waiting = to_send.size();
        }
        if (!confirmed.empty()) SEAM_OK(file.published(confirmed));
        if (waiting >= kMostWaiting) return {};
        SEAM_TRY(auto queued, file.queued_runs(after, most));
        // From the beginning again where everything is on its way or confirmed: a run whose outcome changed is queued anew.
        if (queued.empty() && waiting == 0) after = -1;
        if (!queued.empty()) after = queued.back().run;
        std::erase_if(queued, [&](const QueuedRun& run) { return let_be.contains(run.run); });
        if (queued.empty()) return {};
        Made made = made_of(file, messages, queued);
        for (const auto& [run, error] : made.refused) {
            let_be.insert(run);
            tell(Text("run {} is not published: {}", run, error.text()));
        }
        if (!made.gone.empty()) SEAM_OK(file.published(made.gone));
        const std::lock_guard lock(mutex);
        for (Outgoing& out : made.messages) to_send.push_back(std::move(out));
        wake.notify_all();
        return {};
    }

    std::pair<std::size_t, bool> standing() {
        const std::lock_guard lock(mutex);
        return {to_send.size() + done.size(), failing};
    }
};

Expected<std::unique_ptr<FleetPublisher>> FleetPublisher::start(ProjectFile& file, const FleetTarget& target,
                                                                PublisherOptions options) {
    SEAM_TRY(auto messages, FleetMessages::of(file));
    SEAM_TRY(auto station, station_name(options.station, messages));
    auto impl =
        std::make_unique<Impl>(file, target, std::move(options), std::move(messages), std::move(station));
    Impl& i = *impl;
    i.thread = std::jthread([&i](const std::stop_token& stop) { i.send(stop); });
    return std::unique_ptr<FleetPublisher>(new FleetPublisher(std::move(impl)));
}

FleetPublisher::FleetPublisher(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
FleetPublisher::~FleetPublisher() = default;

void FleetPublisher::measuring(bool on) {
    impl_->measuring = on;
}

// The message is kept at once: the run may be deleted long before the database is back.
Expected<void> FleetPublisher::part_done(std::int64_t number) {
    Impl& i = *impl_;
    SEAM_TRY(const auto newest, i.file.queued_runs(number - 1, 1));
    for (const QueuedRun& run : newest) {
        SEAM_TRY(const auto message, i.messages.message(i.file, run));
        if (message) SEAM_OK(i.file.keep_message(run, *message));
    }
    return i.exchange(kBetweenParts);
}

Expected<void> FleetPublisher::idle() {
    Impl& i = *impl_;
    const auto now = std::chrono::steady_clock::now();
    if (i.measuring || now - i.looked < kLooked) return {};
    i.looked = now;
    return i.exchange(kBetweenParts);
}

std::int64_t FleetPublisher::finish(std::chrono::milliseconds longest) {
    Impl& i = *impl_;
    i.measuring = false;
    const auto until = std::chrono::steady_clock::now() + longest;
    while (std::chrono::steady_clock::now() < until) {
        if (!i.exchange(kBatch)) break;
        const auto [waiting, failing] = i.standing();
        const auto queued = i.file.queued();
        if (failing || !queued || *queued <= static_cast<std::int64_t>(i.let_be.size())) break;
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
    return i.file.queued().value_or(0);
}

}  // namespace seamwright
