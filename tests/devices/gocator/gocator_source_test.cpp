// The driver against the simulated cell behind the sensor's protocol.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <thread>

#include "core/features/feature.h"
#include "core/features/kinds/feature_registry.h"
#include "core/profile/stripe/peaks.h"
#include "devices/gocator/gocator.h"
#include "devices/net/socket.h"
#include "devices/served/served_gocator.h"

namespace seamwright {
namespace {

using namespace std::chrono_literals;
using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

class Gocator : public testing::Test {
  protected:
    void SetUp() override {
        auto made = SimulatedCell::open({{"optics", {{"width", 640}, {"height", 512}}}, {"buffers", 64}});
        ASSERT_TRUE(made) << made.error().sentence();
        cell = *made;
        for (const DoorSpot& spot : default_door_spots()) {
            MeasuringMove move;
            move.spot_id = spot.id;
            move.entry = move.trigger = move.exit = cell->flange_for(spot.workobject_from_sensor);
            moves.push_back(move);
        }
        cell->move_to(moves[0].trigger);
        serve();
    }
    void serve(json settings = json::object()) {
        settings.update({{"control_port", 0}, {"data_port", 0}, {"ascii_port", 0}});
        auto opened = ServedGocator::open(cell, settings);
        ASSERT_TRUE(opened) << opened.error().sentence();
        served = std::move(*opened);
    }
    Expected<std::unique_ptr<ProfileSource>> try_open(json settings = json::object()) {
        json all = {{"address", "127.0.0.1"},
                    {"control_port", served->control_port()},
                    {"data_port",
                     settings.value("output", "") == "ascii" ? served->ascii_port() : served->data_port()},
                    {"timeout_ms", 500}};
        all.update(settings);
        return open_gocator_sensor(all, session);
    }
    std::unique_ptr<ProfileSource> open(const json& settings = json::object()) {
        auto sensor = try_open(settings);
        EXPECT_TRUE(sensor) << sensor.error().sentence();
        EXPECT_TRUE((*sensor)->start());
        return std::move(*sensor);
    }
    FramePtr next(ProfileSource& sensor) {
        auto frame = sensor.wait_next(3s);
        EXPECT_TRUE(frame) << frame.error().sentence();
        return frame ? *frame : nullptr;
    }

    std::shared_ptr<SimulatedCell> cell;
    std::vector<MeasuringMove> moves;
    std::unique_ptr<ServedGocator> served;
    DeviceSession session;
};

TEST_F(Gocator, TellsWhoItIs) {
    auto sensor = open();
    EXPECT_EQ(sensor->identity(),
              (SensorIdentity{"gocator", "LMI Technologies", "Gocator simulated", "12345"}));
    const auto other = try_open({{"serial", "777"}});
    ASSERT_FALSE(other);
    EXPECT_THAT(other.error().sentence(), HasSubstr("serial number 12345 answers, not 777"));
}

TEST_F(Gocator, SoftwareTriggerCarriesItsSpotAndTheProfileOfTheCell) {
    auto sensor = open();
    for (int i = 0; i < 3; ++i) {
        ASSERT_TRUE(sensor->trigger("S" + std::to_string(i)));
        const FramePtr frame = next(*sensor);
        ASSERT_TRUE(frame);
        EXPECT_EQ(frame->status, FrameStatus::ok);
        EXPECT_EQ(frame->spot_id, "S" + std::to_string(i));
        EXPECT_EQ(frame->sequence, static_cast<std::uint64_t>(i));
        EXPECT_GT(frame->device_time_ns, 0);
        // The same exposure, measured here.
        Frame image;
        cell->render(*cell->true_flange(), frame->sequence, image);
        StripePeaks peaks;
        ASSERT_TRUE(find_peaks(image.image, {}, peaks));
        ProfileCandidates candidates;
        to_millimetres(peaks, cell->sensor_model(), candidates);
        ASSERT_EQ(frame->profile.size(), static_cast<std::size_t>(candidates.lines));
        int seen = 0;
        for (int line = 0; line < candidates.lines; ++line) {
            const auto at = static_cast<std::size_t>(line),
                       c = static_cast<std::size_t>(candidates.index(line, 0));
            if (candidates.count[at] == 0 || std::isnan(frame->profile.z_mm[at])) continue;
            // Noise differs from exposure to exposure; the stripe does not.
            if (std::abs(frame->profile.z_mm[at] - candidates.z_mm[c]) < 0.5) ++seen;
        }
        EXPECT_GT(seen, candidates.lines / 2);
    }
    EXPECT_EQ(sensor->counters().completed, 3u);
    EXPECT_EQ(sensor->latest()->sequence, 2u);
}

// Another sensor's data port, by a wrong setting.
TEST_F(Gocator, DataOfAnotherSensorAreNotTaken) {
    auto other = SimulatedCell::open({{"optics", {{"width", 640}, {"height", 512}}}, {"buffers", 64}});
    ASSERT_TRUE(other);
    auto second = ServedGocator::open(
        *other, {{"control_port", 0}, {"data_port", 0}, {"ascii_port", 0}, {"serial", 777}});
    ASSERT_TRUE(second) << second.error().sentence();
    (*other)->move_to(moves[0].trigger);
    auto its_own = open_gocator_sensor({{"address", "127.0.0.1"},
                                        {"control_port", (*second)->control_port()},
                                        {"data_port", (*second)->data_port()},
                                        {"timeout_ms", 500}},
                                       session);
    ASSERT_TRUE(its_own && (*its_own)->start());
    auto sensor = try_open({{"data_port", (*second)->data_port()}});
    ASSERT_TRUE(sensor) << sensor.error().sentence();
    ASSERT_TRUE((*sensor)->start());
    ASSERT_TRUE((*its_own)->trigger("S1"));
    const auto frame = (*sensor)->wait_next(3s);
    ASSERT_FALSE(frame);
    EXPECT_THAT(frame.error().sentence(), HasSubstr("of sensor 777, connected is 12345"));
}

TEST_F(Gocator, RobotFiresTheDigitalInput) {
    auto sensor = open({{"hardware_trigger", true}});
    EXPECT_FALSE(sensor->trigger("S1"));
    cell->start_moves(moves);
    std::uint64_t number = 0;
    while (cell->next_trigger()) EXPECT_EQ(next(*sensor)->sequence, number++);
    EXPECT_EQ(number, moves.size());
}

TEST_F(Gocator, LostFrameIsCountedAndTheOthersKeepTheirSpots) {
    auto sensor = open();
    served->lose_next(1);
    for (const char* spot : {"A", "B", "C"}) ASSERT_TRUE(sensor->trigger(spot));
    FramePtr frame = next(*sensor);
    EXPECT_EQ(frame->spot_id, "B");
    EXPECT_EQ(frame->sequence, 1u);
    frame = next(*sensor);
    EXPECT_EQ(frame->spot_id, "C");
    EXPECT_EQ(sensor->counters().lost, 1u);
}

TEST_F(Gocator, SequenceGoesOnOverStopAndStart) {
    auto sensor = open();
    ASSERT_TRUE(sensor->trigger("A"));
    EXPECT_EQ(next(*sensor)->sequence, 0u);
    sensor->stop();
    EXPECT_FALSE(sensor->wait_next(10ms));
    ASSERT_TRUE(sensor->start());
    ASSERT_TRUE(sensor->trigger("B"));
    EXPECT_EQ(next(*sensor)->sequence, 1u);
    EXPECT_EQ(sensor->counters().lost, 0u);
}

TEST_F(Gocator, ComesBackAfterItsConnectionsWereCut) {
    auto sensor = open({{"reconnect_ms", 10}, {"reconnect_most_ms", 50}});
    ASSERT_TRUE(sensor->trigger("A"));
    ASSERT_TRUE(next(*sensor));
    served->cut();
    auto frame = sensor->wait_next(2s);
    ASSERT_FALSE(frame);
    EXPECT_TRUE(is_disconnect(frame.error())) << frame.error().sentence();
    const auto until = std::chrono::steady_clock::now() + 5s;
    while (sensor->counters().reconnects == 0 && std::chrono::steady_clock::now() < until)
        (void)sensor->wait_next(20ms);
    ASSERT_EQ(sensor->counters().reconnects, 1u);
    ASSERT_TRUE(sensor->trigger("B"));
    frame = sensor->wait_next(2s);
    ASSERT_TRUE(frame) << frame.error().sentence();
    EXPECT_EQ((*frame)->spot_id, "B");
    EXPECT_EQ((*frame)->sequence, 1u);
}

TEST_F(Gocator, SaysWhetherItIsThereWhileNothingIsMeasured) {
    auto sensor = try_open({{"timeout_ms", 100}});
    ASSERT_TRUE(sensor) << sensor.error().sentence();
    EXPECT_TRUE((*sensor)->answers());
    EXPECT_TRUE((*sensor)->start());
    (*sensor)->stop();
    EXPECT_TRUE((*sensor)->answers());
    served->cut();
    Expected<void> gone;
    for (int i = 0; i < 200 && (gone = (*sensor)->answers()); ++i) std::this_thread::sleep_for(10ms);
    ASSERT_FALSE(gone);
    EXPECT_TRUE(is_disconnect(gone.error())) << gone.error().sentence();
    EXPECT_FALSE((*sensor)->answers()) << "until it is started again";
    EXPECT_TRUE((*sensor)->start());
    (*sensor)->stop();
    EXPECT_TRUE((*sensor)->answers());
}

TEST_F(Gocator, SilentSensorIsFoundOutByAPing) {
    auto sensor = open({{"timeout_ms", 100}});
    EXPECT_TRUE(is_silence(sensor->wait_next(1100ms).error())) << "it answers the ping";
    served.reset();
    const auto gone = sensor->wait_next(1100ms);
    ASSERT_FALSE(gone);
    EXPECT_TRUE(is_disconnect(gone.error())) << gone.error().sentence();
}

TEST_F(Gocator, AsciiResultsAreProfilesOfAPoint) {
    for (const char* format : {"", "%frame;%time;%value[0];%value[1];%decision[0]"}) {
        serve({{"format", format}});
        auto sensor = open({{"output", "ascii"}, {"format", format}});
        auto profiles = open();  // both outputs of one sensor: its start restarts the job
        cell->move_to(moves[1].trigger);
        ASSERT_TRUE(sensor->trigger("S2"));
        const FramePtr frame = next(*sensor);
        ASSERT_TRUE(frame);
        ASSERT_EQ(frame->status, FrameStatus::ok);
        EXPECT_EQ(frame->spot_id, "S2");
        ASSERT_EQ(frame->profile.size(), 1u);
        const FramePtr whole = next(*profiles);
        ASSERT_TRUE(whole);
        auto finder = make_feature_finder({"contour-end", {}, {}, Eigen::Vector2d::Zero()});
        const Feature end = (*finder)->find(whole->profile);
        auto point = make_feature_finder({"sensor-point", {{"sigma_mm", 0.05}}, {}, Eigen::Vector2d::Zero()});
        const Feature told = (*point)->find(frame->profile);
        EXPECT_EQ(told.status, end.status);
        if (end.status != FeatureStatus::ok) continue;
        EXPECT_LT((told.point_mm - end.point_mm).norm(), 0.005) << "rounded to whole um on both ways";
        EXPECT_DOUBLE_EQ(told.covariance_mm2(0, 0), 0.0025);
    }
}

TEST_F(Gocator, ForeignServerIsRefusedInWords) {
    auto listener = TcpListener::listen("127.0.0.1", 0);
    std::jthread web([&] {
        if (auto client = listener->accept(3s)) {
            (void)client->send(bytes_of("HTTP/1.1 400 Bad Request\r\n\r\n"), 1s);
            std::array<std::byte, 100> rest;
            (void)client->receive_some(rest, 1s);
        }
    });
    const auto sensor = try_open({{"control_port", listener->port()}});
    ASSERT_FALSE(sensor);
    EXPECT_THAT(sensor.error().sentence(), HasSubstr("are those of a Gocator"));
}

// --- a sensor by hand: its bytes as the manual prints them, not as our own code writes them

class HandSensor {
  public:
    struct Asked {
        int command, nth;  // of its kind, from 0
    };
    // Answers every command with success, after as long as `wait` says; no answer at all: nullopt.
    using Wait = std::function<std::optional<std::chrono::milliseconds>(Asked)>;
    HandSensor(std::string address, std::uint16_t control_port, std::uint16_t data_port, Wait wait)
        : control_(TcpListener::listen(address, control_port).value()),
          data_(TcpListener::listen(address, data_port).value()),
          wait_(std::move(wait)),
          thread_([this](const std::stop_token& stop) { serve(stop); }) {}
    std::uint16_t control_port() const { return control_.port(); }
    std::uint16_t data_port() const { return data_.port(); }

  private:
    void serve(const std::stop_token& stop) {
        std::optional<TcpConnection> client, data;
        std::map<int, int> count;
        std::string in;
        while (!stop.stop_requested()) {
            if (auto come = control_.accept(5ms)) client.emplace(std::move(*come)), in.clear();
            if (auto come = data_.accept(5ms)) data.emplace(std::move(*come));
            std::array<std::byte, 512> buffer;
            if (!client) continue;
            const auto got = client->receive_some(buffer, 5ms);
            if (!got && !is_silence(got.error())) client.reset();
            if (!got) continue;
            in.append(reinterpret_cast<const char*>(buffer.data()), *got);
            for (std::size_t size; in.size() >= 6 && (size = byte(in, 0) + 256 * byte(in, 1)) <= in.size();
                 in.erase(0, size)) {
                const auto command = static_cast<int>(byte(in, 4) + 256 * byte(in, 5));
                const auto wait = wait_({command, count[command]++});
                if (!wait) continue;
                std::this_thread::sleep_for(*wait);
                std::string answer = in.substr(4, 2) + std::string("\1\0\0\0", 4);  // id, status 1
                if (command == 0x4010) {
                    answer += std::string("\x3C\0", 2) +
                              std::string("\x39\x30\0\0", 4) +  // size 60, serial 12345
                              std::string("\xC0\xA8\1\x0A", 4) + "Gocator 2130" + std::string(20, '\0') +
                              std::string("\6\0\1\0", 4) + std::string(4, '\0') + std::string(12, '\0') +
                              std::string(20, '\0');
                }
                const std::size_t whole = answer.size() + 4;
                const std::string sized{static_cast<char>(whole & 0xff), static_cast<char>(whole >> 8), 0, 0};
                (void)client->send(bytes_of(sized + answer), 1s);
            }
        }
    }
    static std::size_t byte(const std::string& s, std::size_t at) {
        return static_cast<unsigned char>(s[at]);
    }

    TcpListener control_, data_;
    Wait wait_;
    std::jthread thread_;
};

constexpr int kStop = 0x1001, kStart = 0x100D;

json settings_of(const HandSensor& sensor, json more = json::object()) {
    json all = {
        {"address", "127.0.0.1"}, {"control_port", sensor.control_port()}, {"data_port", sensor.data_port()}};
    all.update(more);
    return all;
}

TEST(GocatorByHand, AnAddressIsEnough) {
    const HandSensor hand("127.77.0.3", 3190, 3196, [](auto) { return 0ms; });
    DeviceSession session;
    auto sensor = open_gocator_sensor({{"address", "127.77.0.3"}}, session);
    ASSERT_TRUE(sensor) << sensor.error().sentence();
    EXPECT_EQ((*sensor)->identity().serial, "12345");
    EXPECT_EQ((*sensor)->identity().model, "Gocator 2130");
    EXPECT_TRUE((*sensor)->start());
}

TEST(GocatorByHand, StartAndStopMayTakeTheirTime) {
    const HandSensor hand("127.0.0.1", 0, 0, [](HandSensor::Asked a) {
        return a.command == kStop || a.command == kStart ? 400ms : 0ms;
    });
    DeviceSession session;
    auto sensor = open_gocator_sensor(settings_of(hand, {{"timeout_ms", 100}}), session);
    ASSERT_TRUE(sensor) << sensor.error().sentence();
    for (int i = 0; i < 2; ++i) {
        const auto started = (*sensor)->start();
        ASSERT_TRUE(started) << started.error().sentence();
        const auto before = std::chrono::steady_clock::now();
        (*sensor)->stop();  // its answer comes when nobody waits for it, and is not taken for the next one's
        EXPECT_LT(std::chrono::steady_clock::now() - before, 300ms);
    }
}

TEST(GocatorByHand, AStartIsWaitedForNoLongerThanItsTimeOut) {
    const HandSensor hand("127.0.0.1", 0, 0, [](HandSensor::Asked a) {
        return a.command == kStart ? std::nullopt : std::optional(0ms);
    });
    DeviceSession session;
    auto sensor =
        open_gocator_sensor(settings_of(hand, {{"timeout_ms", 100}, {"start_timeout_ms", 500}}), session);
    ASSERT_TRUE(sensor) << sensor.error().sentence();
    const auto started = (*sensor)->start();
    ASSERT_FALSE(started);
    EXPECT_THAT(started.error().sentence(), HasSubstr("the sensor did not start its job within 0.5 s"));
    EXPECT_THAT(started.error().sentence(), Not(HasSubstr("controller")));
}

TEST(GocatorByHand, AStartCanBeGivenUp) {
    const HandSensor hand("127.0.0.1", 0, 0, [](HandSensor::Asked a) {
        return a.command == kStart && a.nth == 0 ? std::nullopt : std::optional(0ms);
    });
    DeviceSession session;
    auto sensor = open_gocator_sensor(settings_of(hand), session);
    ASSERT_TRUE(sensor) << sensor.error().sentence();
    const auto before = std::chrono::steady_clock::now();
    std::jthread person([&] {
        std::this_thread::sleep_for(200ms);
        (*sensor)->give_up();
    });
    const auto started = (*sensor)->start();
    EXPECT_LT(std::chrono::steady_clock::now() - before, 2s);
    ASSERT_FALSE(started);
    EXPECT_THAT(started.error().sentence(), HasSubstr("given up before the sensor answered"));
    EXPECT_FALSE((*sensor)->start()) << "until it is stopped";
    (*sensor)->stop();
    EXPECT_TRUE((*sensor)->start());
}

TEST(GocatorByHand, IsASensorInEverySentence) {
    DeviceSession session;
    const auto nobody =
        open_gocator_sensor({{"address", "127.77.0.4"}, {"control_port", 9}, {"timeout_ms", 100}}, session);
    ASSERT_FALSE(nobody);
    EXPECT_THAT(nobody.error().sentence(), HasSubstr("sensor"));
    EXPECT_THAT(nobody.error().sentence(), Not(HasSubstr("controller")));
    const HandSensor mute("127.0.0.1", 0, 0, [](auto) { return std::optional<std::chrono::milliseconds>(); });
    const auto silent = open_gocator_sensor(settings_of(mute, {{"timeout_ms", 100}}), session);
    ASSERT_FALSE(silent);
    EXPECT_THAT(silent.error().sentence(), HasSubstr("sensor"));
    EXPECT_THAT(silent.error().sentence(), Not(HasSubstr("controller")));
}

TEST_F(Gocator, TakesItsTimeToStartAsARealOneDoes) {
    serve({{"start_ms", 700}});
    auto sensor = open();  // waits half a second for other answers
    ASSERT_TRUE(sensor->trigger("A"));
    EXPECT_TRUE(next(*sensor));
}

TEST_F(Gocator, SettingsAreChecked) {
    EXPECT_FALSE(open_gocator_sensor(json::object(), session));
    for (const json& bad :
         {json{{"output", "video"}}, json{{"points", {{0}}}}, json{{"points", json::array()}},
          json{{"points", "0,1"}}, json{{"points", {{0, -1}}}}, json{{"source", 4}},
          json{{"data_port", 70000}}, json{{"exposure_us", 5}}, json{{"format", "%values"}},
          json{{"timeout_ms", "1 s"}}})
        EXPECT_FALSE(try_open(bad)) << bad;
}

}  // namespace
}  // namespace seamwright
