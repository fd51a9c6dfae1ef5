// Car after car for half an hour over real protocols: nothing grows, nothing is lost unaccounted, nothing
// unverified is released. `ctest -L soak`; SEAMWRIGHT_SOAK_MINUTES shortens it (5/6 of it on a sound network,
// 1/6 with one stream packet in fifty lost). Frames are 640 x 512, which two cores render, send and measure
// at 100 triggers/s.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <malloc.h>

#include <cstdlib>
#include <fstream>
#include <thread>

#include "projects/station/watch.h"
#include "tests/projects/served_cell.h"

namespace seamwright {
namespace {

using Clock = std::chrono::steady_clock;
using Minutes = std::chrono::duration<double, std::ratio<60>>;

Minutes soak_minutes() {
    const char* text = std::getenv("SEAMWRIGHT_SOAK_MINUTES");
    const double minutes = text ? std::strtod(text, nullptr) : 30;
    return Minutes(minutes > 0 ? minutes : 30);
}

double resident_mib() {
    malloc_trim(0);  // what the allocator keeps back is no leak
    std::ifstream statm("/proc/self/statm");
    double total = 0, resident = 0;
    statm >> total >> resident;
    return resident * 4096 / (1 << 20);
}

struct Soaked {
    std::int64_t parts = 0, triggers = 0, measured = 0, unmeasured = 0, pushed = 0, not_pushed = 0;
    double rss_begin_mib = 0, rss_end_mib = 0, seconds = 0;
    SourceCounters counters;
};

// Lets the line call part after part and holds every stored run against what the controller says.
Soaked soak(const ServedCellOptions& options, Minutes minutes) {
    const auto folder =
        std::filesystem::temp_directory_path() / fmt::format("seamwright_soak_{}", ::getpid());
    std::filesystem::create_directories(folder);
    Soaked sum;
    {
        auto served = serve_cell(options, folder / "soak.seam");
        EXPECT_TRUE(served) << served.error().sentence();
        if (!served) return sum;
        served->cell->set_part({make_pose(rotation_exp({0.002, -0.001, 0.003}), {2, -1, 1}), {}});
        const auto begin = Clock::now();
        std::stop_source stop;
        std::atomic<std::int64_t> ended = 0;
        std::string outage;
        WatchOptions watching;
        watching.push = true;
        watching.keep_runs = 4;
        watching.cancel = stop.get_token();
        watching.tell = [&](const WatchEvent& e) {
            ended = e.counts.corrected + e.counts.refused + e.counts.failed + e.counts.alarms;
            if (e.counts.lost > 0 || e.counts.alarms > 0) outage = e.text.english();
        };
        std::jthread runner([&] {
            auto counts = watch(*served->station, watching);
            EXPECT_TRUE(counts) << counts.error().sentence();
        });
        auto reader = ProjectFile::open(folder / "soak.seam", FileAccess::read_only);
        EXPECT_TRUE(reader) << reader.error().sentence();
        auto next_report = begin + std::chrono::minutes(1);
        std::int64_t seen = 0;
        {
            auto before = reader->runs();
            if (before && !before->empty()) seen = before->back().number;  // the teaching
        }
        while (Clock::now() - begin < minutes && !testing::Test::HasFailure()) {
            const std::int64_t due = ended + 1;
            served->controller().press_start(PartId(fmt::format("CAR-{}", ++sum.parts)));
            const auto until = Clock::now() + std::chrono::seconds(30);
            while (ended < due && Clock::now() < until)
                std::this_thread::sleep_for(std::chrono::milliseconds(1));
            EXPECT_GE(ended, due) << "part " << sum.parts << " has no end " << outage;
            auto runs = reader->runs();
            EXPECT_TRUE(runs) << runs.error().sentence();
            if (!runs) break;
            for (const RunSummary& summary : *runs) {
                if (summary.number <= seen) continue;
                EXPECT_EQ(summary.number, seen + 1) << "a run is missing";
                seen = summary.number;
                auto run = reader->load_run(summary.number, false);
                EXPECT_TRUE(run) << run.error().sentence();
                if (!run) break;
                for (const SpotMeasurement& spot : run->spots) {
                    ++sum.triggers;
                    const bool good = spot.status == SpotStatus::measured;
                    good ? ++sum.measured : ++sum.unmeasured;
                    EXPECT_TRUE(good || !spot.message.empty()) << "a lost trigger without a word";
                }
                for (const RegionRecord& region : run->regions) {
                    if (region.push.status == PushStatus::written) {
                        ++sum.pushed;
                        EXPECT_TRUE(region.push.read_back);
                        if (!region.push.read_back) continue;
                        EXPECT_LT(distance_mm(*region.push.read_back, region.base_from_frame), 1e-3);
                    } else {
                        ++sum.not_pushed;
                        if (sum.not_pushed <= 3) fmt::print("part {}: {}\n", sum.parts, run->message);
                        EXPECT_FALSE(region.refusals.empty() && region.push.message.empty());
                    }
                }
                EXPECT_TRUE(run->status == RunStatus::ok || !served->controller().released());
            }
            if (sum.rss_begin_mib == 0 && Clock::now() - begin > minutes / 5)
                sum.rss_begin_mib = resident_mib();
            if (Clock::now() > next_report) {
                next_report += std::chrono::minutes(1);
                fmt::print("{:5.1f} min: {} parts, {} triggers, {} not measured, {:.1f} MiB\n",
                           Minutes(Clock::now() - begin).count(), sum.parts, sum.triggers, sum.unmeasured,
                           resident_mib());
                std::fflush(stdout);
            }
        }
        sum.seconds = std::chrono::duration<double>(Clock::now() - begin).count();
        sum.rss_end_mib = resident_mib();
        stop.request_stop();
        runner.join();
        if (ProfileSource* sensor = served->station->sensor("A")) sum.counters = sensor->counters();
    }
    std::filesystem::remove_all(folder);
    fmt::print(
        "{} parts, {} triggers ({} measured, {} not), {} frames pushed and read back, {} not pushed; {:.1f} "
        "s, RSS {:.1f} "
        "to {:.1f} MiB; camera: {} whole, {} damaged, {} packets missing, {} resent, {} lost\n",
        sum.parts, sum.triggers, sum.measured, sum.unmeasured, sum.pushed, sum.not_pushed, sum.seconds,
        sum.rss_begin_mib, sum.rss_end_mib, sum.counters.completed, sum.counters.damaged,
        sum.counters.missing_packets, sum.counters.resent_packets, sum.counters.lost);
    return sum;
}

ServedCellOptions at_100_per_second() {
    ServedCellOptions options;
    options.width = 640;
    options.height = 512;
    options.time_scale = 160;
    return options;
}

// Every trigger is a measured spot or one that its run tells as not measured, and every measured spot has a
// whole frame of its own (`taught`: frames of before). What a camera never exposed, because its machine was
// busy, its counters cannot know; the run does.
void expect_accounted(const Soaked& s, std::int64_t taught) {
    EXPECT_EQ(s.measured + s.unmeasured, s.triggers);
    const auto completed = static_cast<std::int64_t>(s.counters.completed);
    const auto others = static_cast<std::int64_t>(s.counters.damaged + s.counters.lost);
    EXPECT_LE(s.measured + taught, completed) << "a damaged frame was measured, or one twice";
    EXPECT_LE(completed + others, s.triggers + taught) << "more frames than triggers";
    EXPECT_LE(completed - s.measured - taught, s.unmeasured) << "a whole frame was dropped and nobody told";
}

TEST(Soak, SoundNetwork) {
    const Soaked s = soak(at_100_per_second(), soak_minutes() * 5 / 6);
    EXPECT_GT(s.parts, 0);
    expect_accounted(s, static_cast<std::int64_t>(default_door_spots().size()));
    EXPECT_GE(s.measured, s.triggers * 999 / 1000) << "a busy machine may lose a packet, not more";
    EXPECT_EQ(s.pushed + s.not_pushed, s.parts);
    EXPECT_GT(s.pushed, s.parts * 4 / 5) << "what the scatter of triggers makes contradict itself is refused";
    EXPECT_LT(s.rss_end_mib, 1.1 * s.rss_begin_mib + 8) << "memory grows";
}

TEST(Soak, OnePacketInFiftyLost) {
    ServedCellOptions options = at_100_per_second();
    options.lost_packets_per_mille = 20;
    const Soaked s = soak(options, soak_minutes() / 6);
    EXPECT_GT(s.counters.damaged + s.counters.resent_packets, 0U)
        << "nothing was lost: the test tests nothing";
    expect_accounted(s, 0);
    EXPECT_GT(s.measured, 0);
    EXPECT_LT(s.rss_end_mib, 1.1 * s.rss_begin_mib + 8) << "memory grows";
}

}  // namespace
}  // namespace seamwright
