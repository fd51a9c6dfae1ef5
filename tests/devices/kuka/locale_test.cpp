// A German desktop: QApplication sets the process's locale, and "1.5" must stay 1.5 for every parser of the
// drivers and over a whole EthernetKRL round trip.

#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <clocale>
#include <filesystem>
#include <thread>

#include "devices/controllers/kuka/controller.h"
#include "devices/kuka/eki.h"
#include "devices/kuka/eki_telegram.h"
#include "devices/kuka/kvp_message.h"
#include "devices/net/socket.h"

namespace seamwright {
namespace {

namespace fs = std::filesystem;

// de_DE.UTF-8 for the test's time; made with localedef where the machine has none.
class German : public testing::Test {
  protected:
    void SetUp() override {
        if (!std::setlocale(LC_ALL, "de_DE.UTF-8")) {
            folder_ = fs::temp_directory_path() / ("seamwright_locale_" + std::to_string(::getpid()));
            fs::create_directories(folder_);
            const std::string made = "localedef -i de_DE -f UTF-8 '" + (folder_ / "de_DE.UTF-8").string() +
                                     "' > '" + (folder_ / "log").string() + "' 2>&1";
            ASSERT_EQ(std::system(made.c_str()), 0) << "localedef of the package locales is needed";
            ::setenv("LOCPATH", folder_.c_str(), 1);
            ASSERT_TRUE(std::setlocale(LC_ALL, "de_DE.UTF-8"));
        }
        ASSERT_STREQ(std::localeconv()->decimal_point, ",");
        ASSERT_EQ(std::strtod("1.5", nullptr), 1.0) << "what the parsers must not rely on";
    }
    void TearDown() override {
        std::setlocale(LC_ALL, "C");
        ::unsetenv("LOCPATH");
        if (!folder_.empty()) fs::remove_all(folder_);
    }
    fs::path folder_;
};

TEST_F(German, ParsersReadThePoint) {
    const Pose pose = make_pose(rotation_exp({0.3, -0.2, 0.9}), {1234.5678, -20.25, 900.125});
    EkiTelegram t{.kind = "answer", .id = 3, .name = "BASE", .mode = "#EX", .pose = pose};
    auto telegram = parse_eki_telegram(write_eki("Robot", t));
    ASSERT_TRUE(telegram) << telegram.error().sentence();
    EXPECT_LT(distance_mm(telegram->pose, pose), 1e-5);
    auto frame = frame_from_krl(krl_from_frame(pose));
    ASSERT_TRUE(frame) << frame.error().sentence();
    EXPECT_LT(distance_mm(*frame, pose), 1e-5);
}

TEST_F(German, EthernetKrlRoundTrip) {
    auto cell = SimulatedCell::open(
        {{"optics", {{"width", 64}, {"height", 64}}},
         {"robot", {{"frames", {{"F", {{"xyz", {900.5, -450.25, 500}}, {"abc", {12.5, -4, 3}}}}}}}}});
    ASSERT_TRUE(cell);
    const std::uint16_t port = TcpListener::listen("127.0.0.1", 0)->port();
    DeviceSession session;
    auto link = open_kuka_eki({{"port", port}, {"timeout_ms", 2000}}, session);
    ASSERT_TRUE(link) << link.error().sentence();
    auto controller = start_kuka_eki_controller(*cell, {{"port", port}});
    ASSERT_TRUE(controller) << controller.error().sentence();
    auto frame = (*link)->read_frame("F");
    for (int i = 0; i < 100 && !frame; ++i) {  // until the application has set its frames up
        std::this_thread::sleep_for(std::chrono::milliseconds(20));
        frame = (*link)->read_frame("F");
    }
    ASSERT_TRUE(frame) << frame.error().sentence();
    EXPECT_NEAR(frame->translation().x(), 900.5, 1e-3);
    EXPECT_NEAR(frame->translation().y(), -450.25, 1e-3);
    frame->translation().x() = 901.75;
    ASSERT_TRUE((*link)->write_frame("F", *frame));
    EXPECT_NEAR((*link)->read_frame("F")->translation().x(), 901.75, 1e-3);
}

}  // namespace
}  // namespace seamwright
