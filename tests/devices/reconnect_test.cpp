// A link that reconnects by itself may find another robot at the same address: nothing is written to it
// before somebody has asked who it is.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "devices/net/socket.h"
#include "devices/registry.h"
#include "devices/simulated/cell.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

class Reconnected : public testing::TestWithParam<std::string> {
  protected:
    static std::shared_ptr<SimulatedCell> cell(const std::string& serial) {
        const nlohmann::json frame = {{"xyz", {900, -450, 500}}, {"abc", {12, -4, 3}}};
        return SimulatedCell::open({{"serial", serial},
                                    {"optics", {{"width", 64}, {"height", 64}}},
                                    {"robot", {{"mode", "external"}, {"frames", {{"BASE_left", frame}}}}}})
            .value();
    }
    void start(const std::shared_ptr<SimulatedCell>& of) {
        auto started = start_controller(GetParam(), of, controller_settings);
        ASSERT_TRUE(started) << started.error().sentence();
        controller = std::move(*started);
    }
    bool answers() {
        for (int i = 0; i < 500; ++i) {
            if (link->read_frame("BASE_left")) return true;
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        }
        return false;
    }
    std::shared_ptr<SimulatedCell> first = cell("4711"), second = cell("4712");
    nlohmann::json controller_settings, link_settings;
    DeviceSession session;
    std::unique_ptr<RobotLink> link;
    std::unique_ptr<SimulatedController> controller;
};

TEST_P(Reconnected, AnotherRobotIsNotWrittenToBeforeItIsAskedWhoItIs) {
    const std::uint16_t port = TcpListener::listen("127.0.0.1", 0)->port();
    controller_settings = {{"port", port}};
    link_settings = {{"port", port}, {"timeout_ms", 500}};
    if (GetParam() == "ur-rtde")
        link_settings["dashboard_port"] = controller_settings["dashboard_port"] =
            TcpListener::listen("127.0.0.1", 0)->port();
    start(first);
    auto opened = open_robot(GetParam(), link_settings, session);
    ASSERT_TRUE(opened) << opened.error().sentence();
    link = std::move(*opened);
    ASSERT_TRUE(answers());
    ASSERT_EQ(link->identity()->serial, "4711");

    const Pose corrected = make_pose(rotation_exp({0.31, -0.19, 0.91}), {904, -447, 502});
    const Pose taught = *second->read_frame("BASE_left");
    // The same robot again is the same.
    controller.reset();
    start(first);
    ASSERT_TRUE(answers());
    EXPECT_TRUE(link->write_frame("BASE_left", corrected));
    EXPECT_TRUE(link->confirm(PartVerdict::corrected, ""));

    controller.reset();
    start(second);
    ASSERT_TRUE(answers());
    for (const auto& refused : {link->write_frame("BASE_left", corrected),
                                link->confirm(PartVerdict::corrected, ""), link->move_to(corrected)}) {
        ASSERT_FALSE(refused);
        EXPECT_EQ(refused.error().kind, ErrorKind::device);
        EXPECT_THAT(refused.error().sentence(),
                    HasSubstr("another robot answers than before: \"4712\", not \"4711\""));
    }
    EXPECT_LT(distance_mm(*second->read_frame("BASE_left"), taught), 1e-9);
    EXPECT_FALSE(controller->released());
    EXPECT_TRUE(link->confirm(PartVerdict::failed, "")) << "that takes nothing but a permission back";

    ASSERT_EQ(link->identity()->serial, "4712") << "who asks now is told, and compares";
    EXPECT_TRUE(link->write_frame("BASE_left", corrected));
}

INSTANTIATE_TEST_SUITE_P(Brands, Reconnected, testing::Values("kuka-eki", "kuka-kvp", "abb-rapid", "ur-rtde"),
                         [](const auto& brand) {
                             std::string name = brand.param;
                             std::replace(name.begin(), name.end(), '-', '_');
                             return name;
                         });

}  // namespace
}  // namespace seamwright
