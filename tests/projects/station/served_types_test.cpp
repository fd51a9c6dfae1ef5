// Types mixed before robots that speak their real protocols and execute the written programs: the call says the type, and
// the frame that the controller holds afterwards is that type's.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <condition_variable>
#include <mutex>
#include <thread>

#include "projects/model/part_types.h"
#include "projects/reuse/part_type_edits.h"
#include "projects/station/watch.h"
#include "tests/projects/sample_project.h"
#include "tests/projects/served_cell.h"

namespace seamwright {
namespace {

using namespace std::chrono_literals;

class ServedTypes : public testing::TestWithParam<std::string> {
  protected:
    TemporaryFolder folder;
    std::mutex mutex;
    std::condition_variable told;
    std::string log;
    int over = 0;  // parts, measured or not
};

TEST_P(ServedTypes, TheFrameOnTheControllerIsTheOneOfThePartsType) {
    auto made = serve_cell({.driver = GetParam()}, folder / "cell.seam");
    ASSERT_TRUE(made) << made.error().sentence();
    ServedCell& served = *made;
    // Both push "path"; that of right was taught 400 mm beside.
    Project p = *clone_part_type(*add_part_type(served.station->project(), {"left", "", 1}), "left",
                                 {"right", "", 2});
    for (Spot& spot : p.spots) spot.reference_state = ReferenceState::measured;
    p.regions[1].base_from_frame.translation().y() += 400;
    ASSERT_EQ(p.regions[0].frame_name, p.regions[1].frame_name);
    ASSERT_TRUE(served.station->edit(p));

    WatchOptions options;
    options.push = true;
    std::stop_source stop;
    options.cancel = stop.get_token();
    options.tell = [&](const WatchEvent& e) {
        const std::lock_guard lock(mutex);
        log += fmt::format("{}: {}\n", name_of(e.happening), e.text);
        if (std::holds_alternative<watched::RunDone>(e.happening) ||
            std::holds_alternative<watched::Missed>(e.happening))
            ++over;
        told.notify_all();
    };
    std::jthread watching([&] { (void)watch(*served.station, options); });
    const double taught_mm = p.regions[0].base_from_frame.translation().y();
    const auto part = [&](const std::string& type, const std::string& said) {
        // The cell loads the program of its part, as its PLC has it do.
        if (!type.empty()) served.cell->store_program(measuring_program(of_type(p, type), "R1"));
        std::this_thread::sleep_for(1s);
        std::unique_lock lock(mutex);
        const int before = over;
        served.controller().press_start(PartId("CAR-" + said), PartTypeId(said));
        EXPECT_TRUE(told.wait_for(lock, 60s, [&] { return over > before; })) << log;
        return served.cell->read_frame("path").value();
    };
    Pose last = part("left", "left");
    EXPECT_NEAR(last.translation().y(), taught_mm, 5) << log;
    last = part("right", "2");
    EXPECT_NEAR(last.translation().y(), taught_mm + 400, 5) << log;
    const Pose unknown = part("", "wagon");
    EXPECT_EQ(unknown.matrix(), last.matrix()) << "an unknown type leaves the frame as it is: " << log;
    // The robot's program is the one of right: what it says is not what it is, so nothing is measured.
    EXPECT_EQ(part("", "left").matrix(), last.matrix()) << log;
    last = part("left", "1");
    EXPECT_NEAR(last.translation().y(), taught_mm, 5) << log;
    stop.request_stop();
    watching.join();
    const auto runs = served.station->file().runs();
    std::string types;  // the first one taught
    for (const RunSummary& run : *runs) types += fmt::format("{}:{} ", run.type_id, to_string(run.status));
    // A reference that a loaded machine spoilt was measured once more.
    EXPECT_TRUE(types.ends_with(":refused left:ok right:ok left:device left:ok ")) << types << log;
}

INSTANTIATE_TEST_SUITE_P(Brands, ServedTypes, testing::Values("kuka-eki", "kuka-kvp"), [](const auto& brand) {
    std::string name = brand.param;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
});

}  // namespace
}  // namespace seamwright
