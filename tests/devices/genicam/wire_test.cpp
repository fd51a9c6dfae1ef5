// The driver before a served camera on a loopback address that is free. Nothing leaves the loopback
// interface.
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <map>
#include <thread>

#include "devices/genicam/genicam.h"
#include "devices/genicam/gvcp.h"
#include "devices/genicam/pixels/pixel_format.h"
#include "devices/net/socket.h"
#include "devices/registry.h"
#include "devices/served/served_camera.h"
#include "devices/silence.h"

namespace seamwright {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;

std::string camera_address = "127.0.0.1";  // of the camera served last

Expected<std::unique_ptr<ProfileSource>> open(const json& extra = json::object()) {
    json settings = {{"address", camera_address}, {"packet_resend", false}, {"frame_retention_ms", 200}};
    settings.update(extra);
    DeviceSession session;
    return open_sensor("genicam", settings, session);
}

std::shared_ptr<SimulatedCell> small_cell(int depth) {
    auto cell =
        SimulatedCell::open(json{{"seed", 5},
                                 {"serial", "WIRE-1"},
                                 {"buffers", 64},
                                 {"optics", {{"width", 320}, {"height", 128}, {"bit_depth", depth}}}});
    return cell ? *cell : nullptr;
}

Expected<std::unique_ptr<ServedCamera>> serve(const std::shared_ptr<SimulatedCell>& cell,
                                              json settings = json::object()) {
    if (!settings.contains("address")) settings["address"] = kFreeAddress;
    auto camera = ServedCamera::open(cell, settings);
    if (camera) camera_address = (*camera)->address();
    return camera;
}

class Wire : public testing::Test {
  protected:
    static void SetUpTestSuite() {
        cell_ = small_cell(8);
        deep_ = small_cell(12);
        ASSERT_TRUE(cell_ && deep_);
        for (auto& cell : {cell_, deep_}) cell->move_to(cell->flange_for(Pose::Identity()));
    }
    static void TearDownTestSuite() {
        cell_.reset();
        deep_.reset();
    }
    // What was served, by time stamp.
    void keep(ServedCamera& camera) {
        camera.watch([this](const ServedCamera::Served& s) {
            const std::lock_guard lock(mutex_);
            served_[s.device_ns] = *s.payload;
        });
    }
    bool is_what_was_served(const Frame& frame) {
        const std::lock_guard lock(mutex_);
        const auto it = served_.find(frame.device_time_ns);
        if (it == served_.end() || frame.image.empty()) return false;
        const std::size_t bytes = frame.image.row_bytes * static_cast<std::size_t>(frame.image.height);
        return it->second.size() == bytes && std::memcmp(it->second.data(), frame.image.pixels, bytes) == 0;
    }
    static std::vector<MeasuringMove> moves(int count) {
        std::vector<MeasuringMove> list;
        for (int i = 0; i < count; ++i) {
            MeasuringMove m;
            m.spot_id = "s" + std::to_string(i);
            m.trigger = m.entry = m.exit = cell_->flange_for(Pose::Identity());
            list.push_back(m);
        }
        return list;
    }
    static std::shared_ptr<SimulatedCell> cell_, deep_;
    std::mutex mutex_;
    std::map<std::int64_t, std::vector<std::byte>> served_;
};
std::shared_ptr<SimulatedCell> Wire::cell_, Wire::deep_;

TEST_F(Wire, IsFoundAndOpenedByAddressAndSerial) {
    auto camera = serve(cell_);
    ASSERT_TRUE(camera) << camera.error().sentence();
    const auto seen = ask_camera(camera_address, 1s);
    ASSERT_TRUE(seen) << seen.error().sentence();
    EXPECT_EQ(seen->serial, "WIRE-1");
    EXPECT_EQ(seen->vendor, "Seamwright");
    EXPECT_EQ(seen->address, camera_address);
    {
        auto sensor = open();
        ASSERT_TRUE(sensor) << sensor.error().sentence();
        EXPECT_EQ((*sensor)->identity(),
                  (SensorIdentity{"genicam", "Seamwright", "Simulated stripe camera", "WIRE-1"}));
    }
    DeviceSession session;
    json by_serial = {{"serial", "WIRE-1"}, {"search", {camera_address}}};
    auto sensor = open_sensor("genicam", by_serial, session);
    ASSERT_TRUE(sensor) << sensor.error().sentence();
    sensor->reset();
    by_serial["serial"] = "WIRE-2";
    sensor = open_sensor("genicam", by_serial, session);
    ASSERT_FALSE(sensor);
    EXPECT_NE(sensor.error().sentence().find("no camera with serial number WIRE-2"), std::string::npos);
    EXPECT_NE(sensor.error().sentence().find("WIRE-1"), std::string::npos);
    sensor = open({{"serial", "WIRE-2"}});
    ASSERT_FALSE(sensor);
    EXPECT_NE(sensor.error().sentence().find("serial number WIRE-1, not WIRE-2"), std::string::npos);
}

TEST_F(Wire, NobodyThereIsSilence) {
    auto sensor = open({{"address", "127.99.98.97"}, {"timeout_ms", 200}});
    ASSERT_FALSE(sensor);
    EXPECT_TRUE(is_silence(sensor.error())) << sensor.error().sentence();
    sensor = open({{"address", "nowhere"}});
    ASSERT_FALSE(sensor);
    EXPECT_EQ(sensor.error().kind, ErrorKind::input);
}

TEST_F(Wire, FeaturesWithTheCamerasRanges) {
    auto camera = serve(cell_);
    ASSERT_TRUE(camera) << camera.error().sentence();
    auto sensor = open({{"exposure_us", 2500}, {"gain_db", 6}, {"region", {{"x", 16}, {"width", 256}}}});
    ASSERT_TRUE(sensor) << sensor.error().sentence();
    std::map<std::string, ParameterInfo> infos;
    for (const auto& info : (*sensor)->parameters()) infos[info.name] = info;
    EXPECT_EQ(infos.at("exposure_us").minimum, 1);
    EXPECT_EQ(infos.at("exposure_us").maximum, 1e6);
    EXPECT_EQ(infos.at("gain_db").maximum, 48);
    EXPECT_EQ(infos.at("region_x").maximum, 320 - 256);
    EXPECT_EQ(infos.at("region_width").maximum, 320 - 16);
    EXPECT_EQ(infos.at("pixel_format").choices, std::vector<std::string>{"Mono8"});
    EXPECT_EQ(infos.at("trigger").choices, (std::vector<std::string>{"free", "Line1", "software"}));
    EXPECT_EQ((*sensor)->get("trigger").value(), 2);
    EXPECT_EQ((*sensor)->get("exposure_us").value(), 2500);
    const auto reached = [&] {
        return cell_->parameter("exposure_us") == 2500 && cell_->parameter("gain_db") == 6;
    };
    for (int i = 0; i < 200 && !reached(); ++i) std::this_thread::sleep_for(5ms);
    EXPECT_EQ(cell_->parameter("exposure_us"), 2500);  // reached the cell
    EXPECT_EQ(cell_->parameter("gain_db"), 6);
    ASSERT_TRUE((*sensor)->set("exposure_us", 1000));
    ASSERT_TRUE((*sensor)->set("gain_db", 0));
    const auto refused = (*sensor)->set("exposure_us", 2e6);
    ASSERT_FALSE(refused);
    EXPECT_NE(refused.error().sentence().find("exposure_us"), std::string::npos);
    EXPECT_FALSE((*sensor)->set("region_width", 305));
    EXPECT_FALSE((*sensor)->set("colour", 1));
    EXPECT_FALSE((*sensor)->get("colour"));
    for (int i = 0; i < 200 && cell_->parameter("exposure_us") != 1000; ++i) std::this_thread::sleep_for(5ms);
    sensor->reset();
    const auto sentence = [](const json& extra) {
        auto s = open(extra);
        return s ? std::string("accepted") : s.error().sentence();
    };
    EXPECT_NE(sentence({{"pixel_format", "Mono12p"}}).find("Mono8"), std::string::npos);
    EXPECT_NE(sentence({{"trigger", "Line7"}}).find("free, Line1, software"), std::string::npos);
    EXPECT_NE(sentence({{"features", {{"Focus", 3}}}}).find("no feature Focus"), std::string::npos);
    EXPECT_NE(sentence({{"features", {{"ExposureTime", 2e7}}}}).find("ExposureTime"), std::string::npos);
    EXPECT_NE(sentence({{"chunks", {"Timestamp"}}}).find("no chunks"), std::string::npos);
    EXPECT_EQ(sentence({{"region", {{"x", 0}, {"width", 320}}},
                        {"features", {{"Gain", 3.5}, {"AcquisitionFrameRateEnable", false}}}}),
              "accepted");
}

TEST_F(Wire, SoftwareTriggersCarryTheirSpot) {
    auto camera = serve(cell_, {{"first_frame_id", 65530}});  // wraps on the way
    ASSERT_TRUE(camera) << camera.error().sentence();
    keep(**camera);
    auto sensor = open();
    ASSERT_TRUE(sensor) << sensor.error().sentence();
    EXPECT_FALSE((*sensor)->trigger("early"));
    ASSERT_TRUE((*sensor)->start());
    std::optional<std::uint64_t> last;
    for (int i = 0; i < 12; ++i) {
        const std::string spot = "spot " + std::to_string(i);
        ASSERT_TRUE((*sensor)->trigger(spot));
        const auto frame = (*sensor)->wait_next(3s);
        ASSERT_TRUE(frame) << frame.error().sentence();
        EXPECT_EQ((*frame)->status, FrameStatus::ok);
        EXPECT_EQ((*frame)->spot_id, spot);
        EXPECT_TRUE(is_what_was_served(**frame)) << i;
        EXPECT_GT((*frame)->host_time_ns, (*frame)->device_time_ns);  // one host, one clock
        if (last) {
            EXPECT_EQ((*frame)->sequence, *last + 1);
        }
        last = (*frame)->sequence;
        EXPECT_EQ((*sensor)->latest(), *frame);
    }
    // Several on the way, one lost completely: the others keep their spots.
    (*camera)->wire().fail_next(WireFault::lost);
    for (const char* spot : {"a", "b", "c"}) ASSERT_TRUE((*sensor)->trigger(spot));
    auto frame = (*sensor)->wait_next(3s);
    ASSERT_TRUE(frame) << frame.error().sentence();
    EXPECT_EQ((*frame)->spot_id, "b");
    frame = (*sensor)->wait_next(3s);
    ASSERT_TRUE(frame);
    EXPECT_EQ((*frame)->spot_id, "c");
    EXPECT_EQ((*sensor)->counters().lost, 1U);
    EXPECT_EQ((*sensor)->counters().completed, 14U);
}

TEST_F(Wire, AfterASilentTriggerTheNextOneIsPairedAnew) {
    auto camera = serve(cell_);
    ASSERT_TRUE(camera) << camera.error().sentence();
    auto sensor = open({{"timeout_ms", 150}});
    ASSERT_TRUE(sensor) << sensor.error().sentence();
    ASSERT_TRUE((*sensor)->start());
    ASSERT_TRUE((*sensor)->trigger("a"));
    auto frame = (*sensor)->wait_next(3s);
    ASSERT_TRUE(frame) << frame.error().sentence();
    (*camera)->wire().fail_next(WireFault::late, 400);
    ASSERT_TRUE((*sensor)->trigger("b"));
    frame = (*sensor)->wait_next(200ms);
    ASSERT_FALSE(frame);
    EXPECT_TRUE(is_silence(frame.error()));
    // b's frame comes now, and is nobody's.
    frame = (*sensor)->wait_next(3s);
    ASSERT_TRUE(frame) << frame.error().sentence();
    EXPECT_EQ((*frame)->status, FrameStatus::late);
    EXPECT_TRUE((*frame)->spot_id.empty());
    EXPECT_EQ((*sensor)->counters().late, 1U);
    ASSERT_TRUE((*sensor)->trigger("c"));
    frame = (*sensor)->wait_next(3s);
    ASSERT_TRUE(frame) << frame.error().sentence();
    EXPECT_EQ((*frame)->spot_id, "c");
    EXPECT_EQ((*frame)->status, FrameStatus::ok);
}

TEST_F(Wire, TheRobotsTriggersAreLineOne) {
    auto camera = serve(cell_);
    ASSERT_TRUE(camera) << camera.error().sentence();
    keep(**camera);
    auto sensor = open({{"hardware_trigger", true}, {"buffers", 32}});
    ASSERT_TRUE(sensor) << sensor.error().sentence();
    ASSERT_TRUE((*sensor)->start());
    EXPECT_FALSE((*sensor)->trigger("x"));
    cell_->start_moves(moves(20));
    for (int i = 0; i < 20; ++i) {
        ASSERT_TRUE(cell_->next_trigger());
        std::this_thread::sleep_for(10ms);  // 100 triggers a second
    }
    for (int i = 0; i < 20; ++i) {
        const auto frame = (*sensor)->wait_next(3s);
        ASSERT_TRUE(frame) << i << ": " << frame.error().sentence();
        EXPECT_EQ((*frame)->status, FrameStatus::ok);
        EXPECT_TRUE((*frame)->spot_id.empty());
        EXPECT_TRUE(is_what_was_served(**frame));
    }
    (*sensor)->stop();
    EXPECT_FALSE((*sensor)->wait_next(10ms));
    // In software mode the line is dead.
    ASSERT_TRUE((*sensor)->set("trigger", 2));
    ASSERT_TRUE((*sensor)->start());
    cell_->start_moves(moves(1));
    cell_->next_trigger();
    EXPECT_FALSE((*sensor)->wait_next(100ms));
    ASSERT_TRUE((*sensor)->trigger("x"));
    const auto frame = (*sensor)->wait_next(3s);
    ASSERT_TRUE(frame) << frame.error().sentence();
    EXPECT_EQ((*frame)->spot_id, "x");
}

// Of a pass of five: a first frame that is lost leaves the first spot without measurement, not all the others with
// that of another.
TEST_F(Wire, AFirstFrameThatIsLostIsToldOnATriggerLine) {
    auto camera = serve(cell_);
    ASSERT_TRUE(camera) << camera.error().sentence();
    auto sensor = open({{"hardware_trigger", true}});
    ASSERT_TRUE(sensor) << sensor.error().sentence();
    for (const int lost : {1, 0, 1}) {  // the numbers begin anew with each
        ASSERT_TRUE((*sensor)->start());
        if (lost) (*camera)->wire().fail_next(WireFault::lost);
        cell_->start_moves(moves(5));
        std::uint64_t before = 0;
        for (int i = 0; i < 5; ++i) {
            ASSERT_TRUE(cell_->next_trigger());
            std::this_thread::sleep_for(20ms);
        }
        for (int i = 0; i < 5; ++i) {
            const auto frame = (*sensor)->wait_next(3s);
            ASSERT_TRUE(frame) << i << ": " << frame.error().sentence();
            EXPECT_EQ((*frame)->status, i < lost ? FrameStatus::incomplete : FrameStatus::ok) << i;
            EXPECT_TRUE(i == 0 || (*frame)->sequence == before + 1);
            before = (*frame)->sequence;
        }
        EXPECT_FALSE((*sensor)->wait_next(20ms));
        (*sensor)->stop();
    }
    EXPECT_EQ((*sensor)->counters().lost, 2U);
}

// As a stranger does before we come.
void write_register(std::uint32_t address, std::uint32_t value) {
    auto socket = UdpSocket::bind("127.0.0.1", 0);
    ASSERT_TRUE(socket);
    constexpr std::uint32_t kControl = 0xA00;
    for (const auto& [at, word] : {std::pair{kControl, 2U}, {address, value}, {kControl, 0U}}) {
        std::vector<std::byte> packet;
        for (const int b : {0x42, 1, 0, 0x82, 0, 8, 0, 1}) packet.push_back(static_cast<std::byte>(b));
        for (const std::uint32_t field : {at, word})
            for (int shift = 24; shift >= 0; shift -= 8)
                packet.push_back(static_cast<std::byte>(field >> shift & 0xFF));
        ASSERT_TRUE(socket->send_to(packet, {camera_address, kGvcpPort}));
        std::array<std::byte, 64> answer;
        Endpoint from;
        ASSERT_TRUE(socket->receive(answer, from, 3s));
        ASSERT_EQ(answer[0], std::byte{0}) << "refused";
    }
}

TEST_F(Wire, AMovedImageIsRefusedUnlessTheSettingsSayIt) {
    constexpr std::uint32_t kHeight = 0x104, kOffsetY = 0x134;
    auto camera = serve(cell_);
    ASSERT_TRUE(camera) << camera.error().sentence();
    write_register(kHeight, 126);
    EXPECT_TRUE(open()) << "a cut at the far side moves nothing";
    write_register(kOffsetY, 2);
    auto sensor = open();
    ASSERT_FALSE(sensor);
    EXPECT_NE(sensor.error().sentence().find("OffsetY is 2"), std::string::npos) << sensor.error().sentence();
    EXPECT_TRUE(open({{"region", {{"y", 2}}}}));
    EXPECT_TRUE(open({{"region", {{"y", 0}, {"height", 128}}}}));
    EXPECT_TRUE(open()) << "and now it is whole again";
}

TEST_F(Wire, AFrameOfAnotherPartOfTheSensorIsCorrupt) {
    auto camera = serve(cell_);
    ASSERT_TRUE(camera) << camera.error().sentence();
    auto sensor = open();
    ASSERT_TRUE(sensor) << sensor.error().sentence();
    ASSERT_TRUE((*sensor)->start());
    for (const bool moved : {false, true, false}) {
        if (moved) (*camera)->wire().fail_next(WireFault::moved);
        ASSERT_TRUE((*sensor)->trigger("a"));
        const auto frame = (*sensor)->wait_next(3s);
        ASSERT_TRUE(frame) << frame.error().sentence();
        EXPECT_EQ((*frame)->status, moved ? FrameStatus::corrupt : FrameStatus::ok);
        EXPECT_EQ((*frame)->image.empty(), moved);
    }
    EXPECT_EQ((*sensor)->counters().damaged, 1U);
}

TEST(WireArming, ACameraThatDoesNotArmIsNotTriggered) {
    WireCameraSettings s;
    s.width = 64;
    s.height = 48;
    s.address = kFreeAddress;
    auto camera = WireCamera::open(s);
    ASSERT_TRUE(camera) << camera.error().sentence();
    camera_address = (*camera)->address();
    auto sensor = open();
    ASSERT_TRUE(sensor) << sensor.error().sentence();
    const auto started = (*sensor)->start();  // nobody draws
    ASSERT_FALSE(started);
    EXPECT_NE(started.error().sentence().find("does not arm within 3000 ms"), std::string::npos)
        << started.error().sentence();
    (*camera)->set_ready(true);
    EXPECT_TRUE((*sensor)->start());
}

TEST_F(Wire, FreeRunning) {
    auto camera = serve(cell_);
    ASSERT_TRUE(camera) << camera.error().sentence();
    auto sensor = open({{"trigger", "free"}, {"frame_rate_hz", 100}});
    ASSERT_TRUE(sensor) << sensor.error().sentence();
    ASSERT_TRUE((*sensor)->start());
    for (int i = 0; i < 20; ++i) ASSERT_TRUE((*sensor)->wait_next(3s)) << i;
    // Another region on the run.
    ASSERT_TRUE((*sensor)->set("region_height", 64));
    const auto frame = (*sensor)->wait_next(3s);
    ASSERT_TRUE(frame) << frame.error().sentence();
    EXPECT_EQ((*frame)->image.height, 64);
}

TEST_F(Wire, EveryPixelFormatOfADeepSensor) {
    auto camera = serve(deep_);
    ASSERT_TRUE(camera) << camera.error().sentence();
    keep(**camera);
    auto sensor = open();
    ASSERT_TRUE(sensor) << sensor.error().sentence();
    std::vector<std::string> formats;
    for (const auto& info : (*sensor)->parameters())
        if (info.name == "pixel_format") formats = info.choices;
    ASSERT_EQ(formats, (std::vector<std::string>{"Mono12", "Mono12Packed", "Mono12p", "Mono16", "Mono8"}));
    ASSERT_TRUE((*sensor)->start());
    for (std::size_t i = 0; i < formats.size(); ++i) {
        ASSERT_TRUE((*sensor)->set("pixel_format", static_cast<double>(i)));
        ASSERT_TRUE((*sensor)->trigger(formats[i]));
        const auto frame = (*sensor)->wait_next(3s);
        ASSERT_TRUE(frame) << formats[i] << ": " << frame.error().sentence();
        EXPECT_EQ((*frame)->status, FrameStatus::ok);
        EXPECT_EQ((*frame)->spot_id, formats[i]);
        const PixelFormat& format = *pixel_format_by_name(formats[i]);
        EXPECT_EQ((*frame)->image.bit_depth, format.bit_depth);
        std::vector<std::byte> packed(image_bytes(format, 320, 128));
        pack_pixels(format, (*frame)->image.pixels, 320 * 128, packed.data());
        const std::lock_guard lock(mutex_);
        EXPECT_EQ(packed, served_.at((*frame)->device_time_ns)) << formats[i];
    }
}

TEST_F(Wire, LostPacketsAreCountedAndNeverMeasured) {
    auto camera = serve(cell_, {{"lost_packets_per_mille", 20}, {"packet_size", 1400}});
    ASSERT_TRUE(camera) << camera.error().sentence();
    keep(**camera);
    auto sensor = open({{"hardware_trigger", true}, {"frame_retention_ms", 30}, {"buffers", 16}});
    ASSERT_TRUE(sensor) << sensor.error().sentence();
    ASSERT_TRUE((*sensor)->start());
    constexpr int kTriggers = 60;
    cell_->start_moves(moves(kTriggers));
    int ok = 0, damaged = 0;
    const auto take = [&](std::chrono::milliseconds timeout) {
        while (const auto frame = (*sensor)->wait_next(timeout)) {
            if ((*frame)->status == FrameStatus::ok) {
                ++ok;
                EXPECT_TRUE(is_what_was_served(**frame));
            } else {
                ++damaged;
                EXPECT_TRUE((*frame)->image.empty());
            }
        }
    };
    for (int i = 0; i < kTriggers; ++i) {
        cell_->next_trigger();
        take(5ms);
    }
    const auto through = [&] {
        const WireCounters left = (*camera)->wire().counters();
        return left.sent + left.dropped == static_cast<std::uint64_t>(kTriggers);
    };
    for (int i = 0; i < 50 && !through(); ++i) take(100ms);
    take(400ms);
    const SourceCounters c = (*sensor)->counters();
    EXPECT_GT(damaged, 0);
    EXPECT_GT(ok, 0);
    EXPECT_EQ(c.completed, static_cast<std::uint64_t>(ok));
    EXPECT_EQ(c.damaged + c.late, static_cast<std::uint64_t>(damaged));
    EXPECT_GT(c.missing_packets, 0U);
    // Every frame that left the camera is accounted for; one whose last number got lost is known from the
    // next frame on only. A camera that gets no processor time drops whole frames before the wire, which no
    // client can see.
    const WireCounters left = (*camera)->wire().counters();
    EXPECT_EQ(left.sent + left.dropped, static_cast<std::uint64_t>(kTriggers));
    const std::uint64_t known = c.completed + c.damaged + c.late + c.lost + c.underrun;
    EXPECT_LE(known, left.sent);
    EXPECT_GE(known + 1, left.sent);
}

TEST_F(Wire, UnpluggedAndPluggedInAgain) {
    // On an address of its own: another program that wants a free one would take this one over while it is unplugged.
    const auto taken = UdpSocket::bind("127.0.0.1", kGvcpPort);  // or another program has it already
    auto camera = serve(cell_);
    ASSERT_TRUE(camera) << camera.error().sentence();
    auto sensor = open({{"heartbeat_ms", 50}, {"reconnect_ms", 20}, {"reconnect_most_ms", 100}});
    ASSERT_TRUE(sensor) << sensor.error().sentence();
    ASSERT_TRUE((*sensor)->start());
    ASSERT_TRUE((*sensor)->set("exposure_us", 777));
    ASSERT_TRUE((*sensor)->trigger("before"));
    auto frame = (*sensor)->wait_next(3s);
    ASSERT_TRUE(frame) << frame.error().sentence();
    const std::uint64_t sequence = (*frame)->sequence;
    camera->reset();
    frame = (*sensor)->wait_next(10s);
    ASSERT_FALSE(frame);
    EXPECT_TRUE(is_disconnect(frame.error())) << frame.error().sentence();
    EXPECT_NE(frame.error().sentence().find("the camera is gone"), std::string::npos);
    frame = (*sensor)->wait_next(100ms);
    ASSERT_FALSE(frame);
    EXPECT_TRUE(is_silence(frame.error())) << frame.error().sentence();
    EXPECT_FALSE((*sensor)->get("exposure_us"));
    camera = serve(cell_, {{"address", camera_address}});
    ASSERT_TRUE(camera) << camera.error().sentence();
    Expected<void> fired;
    for (int i = 0; i < 200 && !(fired = (*sensor)->trigger("after")); ++i) std::this_thread::sleep_for(20ms);
    ASSERT_TRUE(fired) << fired.error().sentence();
    frame = (*sensor)->wait_next(3s);
    ASSERT_TRUE(frame) << frame.error().sentence();
    EXPECT_EQ((*frame)->spot_id, "after");
    EXPECT_EQ((*frame)->sequence, sequence + 1);
    EXPECT_EQ((*sensor)->get("exposure_us").value(), 777);
    EXPECT_EQ((*sensor)->counters().reconnects, 1U);
    EXPECT_EQ((*sensor)->identity().serial, "WIRE-1");
}

TEST_F(Wire, SaysWhetherItIsThereWhileNothingIsMeasured) {
    const auto taken = UdpSocket::bind("127.0.0.1", kGvcpPort);
    auto camera = serve(cell_);
    ASSERT_TRUE(camera) << camera.error().sentence();
    auto sensor = open({{"heartbeat_ms", 50}, {"reconnect_ms", 20}, {"reconnect_most_ms", 100}});
    ASSERT_TRUE(sensor) << sensor.error().sentence();
    EXPECT_TRUE((*sensor)->answers());
    ASSERT_TRUE((*sensor)->start());
    (*sensor)->stop();
    EXPECT_TRUE((*sensor)->answers());
    camera->reset();
    Expected<void> there;
    for (int i = 0; i < 500 && (there = (*sensor)->answers()); ++i) std::this_thread::sleep_for(20ms);
    ASSERT_FALSE(there);
    EXPECT_TRUE(is_disconnect(there.error())) << there.error().sentence();
    camera = serve(cell_, {{"address", camera_address}});
    ASSERT_TRUE(camera) << camera.error().sentence();
    Expected<void> started;
    for (int i = 0; i < 200 && !(started = (*sensor)->start()); ++i) std::this_thread::sleep_for(20ms);
    ASSERT_TRUE(started) << started.error().sentence();
    (*sensor)->stop();
    EXPECT_TRUE((*sensor)->answers());
}

TEST_F(Wire, ASecondCameraOrControllerIsRefusedInWords) {
    auto camera = serve(cell_);
    ASSERT_TRUE(camera) << camera.error().sentence();
    auto twice = ServedCamera::open(cell_, {{"address", camera_address}});
    ASSERT_FALSE(twice);
    EXPECT_NE(twice.error().sentence().find(camera_address), std::string::npos);
    EXPECT_FALSE(ServedCamera::open(cell_, {{"adress", "127.0.0.1"}}));
    EXPECT_FALSE(ServedCamera::open(cell_, {{"serial", ""}}));
    EXPECT_FALSE(ServedCamera::open(cell_, {{"packet_size", 10}}));
    EXPECT_FALSE(ServedCamera::open(cell_, {{"address", "203.0.113.9"}}));
}

// The port is fixed by the standard, so another program's camera on an address leaves the other addresses.
TEST_F(Wire, AFreeAddressIsFoundBesideTakenOnes) {
    const auto other = UdpSocket::bind("127.0.0.1", kGvcpPort);  // or another program has it already
    auto first = serve(cell_);
    ASSERT_TRUE(first) << first.error().sentence();
    EXPECT_NE((*first)->address(), "127.0.0.1");
    auto second = serve(deep_, {{"serial", "WIRE-2"}});
    ASSERT_TRUE(second) << second.error().sentence();
    EXPECT_NE((*first)->address(), (*second)->address());
    for (const ServedCamera* camera : {first->get(), second->get()}) {
        const auto seen = ask_camera(camera->address(), 10s);
        ASSERT_TRUE(seen) << seen.error().sentence();
        EXPECT_EQ(seen->serial, camera->serial());
        EXPECT_EQ(seen->address, camera->address());
    }
    // No machine is so busy that a frame counts as damaged here.
    auto sensor = open({{"frame_retention_ms", 5000}});
    ASSERT_TRUE(sensor) << sensor.error().sentence();
    ASSERT_TRUE((*sensor)->start());
    ASSERT_TRUE((*sensor)->trigger("a"));
    const auto frame = (*sensor)->wait_next(20s);
    ASSERT_TRUE(frame) << frame.error().sentence();
    EXPECT_EQ((*frame)->status, FrameStatus::ok);
}

TEST(WireRange, RowsAreProfilesInOrder) {
    WireCameraSettings s;
    s.width = 64;
    s.height = 4;
    s.pixel_formats = {"Coord3D_C16"};
    s.a_scale_mm = 0.25;
    s.a_offset_mm = -8;
    s.c_scale_mm = 0.01;
    s.c_offset_mm = -100;
    s.invalid_flag = true;
    s.invalid_value = 0;
    s.address = kFreeAddress;
    auto camera = WireCamera::open(s);
    ASSERT_TRUE(camera) << camera.error().sentence();
    camera_address = (*camera)->address();
    auto sensor = open({{"trigger", "free"}});
    ASSERT_TRUE(sensor) << sensor.error().sentence();
    (*camera)->set_ready(true);
    ASSERT_TRUE((*sensor)->start());
    for (int image = 0; image < 5; ++image) {
        std::vector<std::byte> payload(64 * 4 * 2);
        for (int i = 0; i < 64 * 4; ++i) {
            const auto z = static_cast<std::uint16_t>(i % 64 == 5 ? 0 : 10000 + 256 * image + i);
            std::memcpy(payload.data() + 2 * i, &z, 2);
        }
        ASSERT_TRUE((*camera)->push(std::move(payload), 1000 + image));
    }
    for (int row = 0; row < 20; ++row) {
        const auto frame = (*sensor)->wait_next(3s);
        ASSERT_TRUE(frame) << frame.error().sentence();
        const Profile& p = (*frame)->profile;
        ASSERT_EQ(p.size(), 64U);
        EXPECT_TRUE((*frame)->image.empty());
        EXPECT_EQ((*frame)->sequence, static_cast<std::uint64_t>(row));
        EXPECT_EQ((*frame)->device_time_ns, 1000 + row / 4);
        EXPECT_DOUBLE_EQ(p.x_mm[2], -7.5);
        EXPECT_NEAR(p.z_mm[2], 0.01 * (64 * row + 2), 1e-9);
        EXPECT_TRUE(std::isnan(p.z_mm[5]));
    }
    EXPECT_EQ((*sensor)->counters().completed, 20U);
}

}  // namespace
}  // namespace seamwright
