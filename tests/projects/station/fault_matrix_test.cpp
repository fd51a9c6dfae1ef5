// Brand x fault x instant: a part is measured and pushed over the real driver of each brand before its
// simulated controller; one thing fails at one instant; then file, robot and verdict must say the same, and
// no frame may be released that nobody answers for. Prints the whole table.

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <thread>

#include "devices/exchange/pose_json.h"
#include "devices/net/socket.h"
#include "devices/simulated/cell.h"
#include "projects/gate/safety_gate.h"
#include "projects/station/acquire.h"
#include "projects/station/station.h"
#include "tests/projects/failing_disk.h"
#include "tests/projects/fake_cell.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

using std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;

struct Brand {
    std::string name;
    bool robot_is_client = false;
    std::string measuring = {};  // beside a cyclic correction
    bool cyclic() const { return !measuring.empty(); }
};
void PrintTo(const Brand& brand, std::ostream* out) {
    *out << brand.name;
}
const std::vector<Brand> kBrands = {{"kuka-eki", true},
                                    {"kuka-kvp", false},
                                    {"abb-rapid", false},
                                    {"ur-rtde", false},
                                    {"kuka-rsi", true, "kuka-eki"},
                                    {"abb-egm", false, "abb-rapid"}};

struct Killed {};  // thrown through everything: what a program that ends leaves behind

// Where a call stands in a run: "write_frame 2".
struct Instant {
    std::string call;
    int number = 0;
    std::string name() const { return number ? fmt::format("{} {}", call, number) : call; }
};

// Passes every call on and makes one of them fail.
class Saboteur final : public RobotLink {
  public:
    enum class Fault { none, request_lost, answer_lost, on_the_wire, killed_before, killed_after };
    explicit Saboteur(RobotLink& real) : real_(real) {}
    std::function<void(bool on)> wire;
    Fault fault = Fault::none;
    Instant at;
    std::vector<Instant> seen;

    Expected<RobotIdentity> identity() override {
        return call("identity", [&] { return real_.identity(); });
    }
    Expected<RobotMode> mode() override {
        return call("mode", [&] { return real_.mode(); });
    }
    bool tells_mode() const override { return real_.tells_mode(); }
    bool permission_outlives_link() const override { return real_.permission_outlives_link(); }
    Expected<Pose> base_from_flange() override { return real_.base_from_flange(); }
    Expected<void> start_measuring(const std::vector<MeasuringMove>& moves) override {
        return call("start_measuring", [&] { return real_.start_measuring(moves); });
    }
    Expected<TriggerEvent> wait_trigger(milliseconds timeout) override {
        // Counted by the triggers that came, not by the looks.
        auto trigger = real_.wait_trigger(timeout);
        if (!trigger) return trigger;
        return call("wait_trigger", [&] { return trigger; });
    }
    Expected<Pose> read_frame(const std::string& name) override {
        return call("read_frame", [&] { return real_.read_frame(name); });
    }
    Expected<void> write_frame(const std::string& name, const Pose& pose) override {
        return call("write_frame", [&] { return real_.write_frame(name, pose); });
    }
    Expected<void> confirm(PartVerdict verdict, const std::string& text) override {
        return call("confirm", [&] { return real_.confirm(verdict, text); });
    }
    Expected<Permission> permission() override {
        return call("permission", [&] { return real_.permission(); });
    }
    std::vector<Text> take_notices() override { return real_.take_notices(); }

  private:
    template <class F>
    std::invoke_result_t<F> call(const std::string& name, const F& f) {
        const Instant now{name, ++count_[name]};
        seen.push_back(now);
        if (fault == Fault::none || now.call != at.call || now.number != at.number) return f();
        switch (fault) {
            case Fault::request_lost:
                return device_error("the request was lost", "matrix");
            case Fault::answer_lost:
                (void)f();
                return device_error("the answer was lost", "matrix");
            case Fault::killed_before:
                throw Killed();
            case Fault::killed_after:
                (void)f();
                throw Killed();
            default: {
                wire(true);
                auto answer = f();
                wire(false);
                return answer;
            }
        }
    }
    RobotLink& real_;
    std::map<std::string, int> count_;
};

// A robot link that somebody else owns.
class Borrowed final : public RobotLink {
  public:
    explicit Borrowed(RobotLink& link) : link_(link) {}
    Expected<RobotIdentity> identity() override { return link_.identity(); }
    Expected<RobotMode> mode() override { return link_.mode(); }
    bool tells_mode() const override { return link_.tells_mode(); }
    bool permission_outlives_link() const override { return link_.permission_outlives_link(); }
    Expected<Pose> base_from_flange() override { return link_.base_from_flange(); }
    Expected<void> start_measuring(const std::vector<MeasuringMove>& m) override {
        return link_.start_measuring(m);
    }
    Expected<TriggerEvent> wait_trigger(milliseconds t) override { return link_.wait_trigger(t); }
    Expected<Pose> read_frame(const std::string& n) override { return link_.read_frame(n); }
    Expected<void> write_frame(const std::string& n, const Pose& p) override {
        return link_.write_frame(n, p);
    }
    Expected<void> confirm(PartVerdict v, const std::string& t) override { return link_.confirm(v, t); }
    Expected<Permission> permission() override { return link_.permission(); }
    std::vector<Text> take_notices() override { return link_.take_notices(); }

  private:
    RobotLink& link_;
};

struct Outcome {
    int exit = 3;
    std::string run = "error", message;  // status as returned
    RunStatus file = RunStatus::interrupted, resolved = RunStatus::interrupted;
    bool at_target = false, at_old = false;  // all frames on the controller, with the link closed
    bool released = false;                   // with the link closed
    bool not_restored = false;               // the record says so
};

class FaultMatrix : public testing::TestWithParam<Brand> {
  protected:
    void SetUp() override {
        make_project();
        nlohmann::json frames;
        for (const Region& r : fake->project.regions) frames[r.frame_name] = pose_json(r.base_from_frame);
        auto opened = SimulatedCell::open({{"serial", "MATRIX-1"},
                                           {"optics", {{"width", 64}, {"height", 64}}},
                                           {"robot",
                                            {{"mode", "external"},
                                             {"repeatability_mm", 0},
                                             {"repeatability_deg", 0},
                                             {"trigger_jitter_mm", 0},
                                             {"frames", frames}}}});
        ASSERT_TRUE(opened) << opened.error().sentence();
        cell = *opened;
        cell->store_program(measuring_program(fake->project, "R1"));
        const auto free_tcp = [] { return TcpListener::listen("127.0.0.1", 0)->port(); };
        const int port = brand.cyclic() ? UdpSocket::bind("127.0.0.1", 0)->port() : free_tcp();
        link_settings = {{"port", port}, {"timeout_ms", 400}};
        controller_settings = {{"port", port}};
        if (!brand.cyclic()) controller_settings["time_scale"] = 4;
        if (brand.name == "ur-rtde")
            link_settings["dashboard_port"] = controller_settings["dashboard_port"] = free_tcp();
        if (brand.cyclic()) {
            const nlohmann::json beside = {{"driver", brand.measuring}, {"settings", {{"port", free_tcp()}}}};
            link_settings["measuring"] = controller_settings["measuring"] = beside;
            controller_settings["measuring"]["settings"]["time_scale"] = 4;
            link_settings["max_late"] = 100;
            for (const Region& r : fake->project.regions)
                link_settings["frames"][r.frame_name] = {{"base_from_frame", pose_json(r.base_from_frame)}};
        }
        if (brand.robot_is_client) open_link();
        auto started = start_controller(brand.name, cell, controller_settings);
        ASSERT_TRUE(started) << started.error().sentence();
        controller = std::move(*started);
        ASSERT_TRUE(answers());
        fake->project.calibrations[0].robot_identity = fake->robot_identity = *link->identity();
    }

    // Four spots within a hand's breadth, so that a robot in real time is soon round.
    void make_project() {
        fake = make_fake_cell(4);
        Project& p = fake->project;
        const Calibration& c = p.calibrations[0];
        p.part.base_from_workobject = make_pose(rotation_exp({0, 0, 0.1}), {900, -200, 500});
        for (int i = 0; i < 4; ++i) {
            Spot& s = p.spots[static_cast<std::size_t>(i)];
            const Eigen::Matrix3d r = rotation_exp(Eigen::Vector3d(0, 0, 0.5 * i)) *
                                      rotation_exp(Eigen::Vector3d(0.2 * (i % 2), 0.15 * (i / 2), 0));
            const Eigen::Vector3d at(40 * std::cos(kPi / 2 * i), 40 * std::sin(kPi / 2 * i), 10 * (i % 2));
            s.base_from_flange =
                p.part.base_from_workobject * make_pose(r, at) * c.flange_from_sensor.inverse();
            s.entry_mm = s.exit_mm = 5;
            s.speed_mm_s = 200;
        }
        p.robots[0].required_mode = RobotMode::unknown;
        p.robots[0].driver = brand.name;
        if (brand.cyclic()) p.regions.pop_back();
        int k = 0;
        for (Region& region : p.regions) {
            region.frame_name = k++ ? "BASE_right" : "BASE_left";
            region.base_from_frame = p.part.base_from_workobject;
            region.sigma_limit_mm = 1;
            region.sigma_limit_deg = 1;
        }
        fake->workobject_from_movedworkobject =
            make_pose(rotation_exp({2e-4, -3e-4, 4e-4}), {0.4, -0.3, 0.5});
    }

    void open_link() {
        auto opened = open_robot(brand.name, link_settings, session);
        ASSERT_TRUE(opened) << opened.error().sentence();
        link = std::move(*opened);
    }
    bool answers() {
        if (!link) open_link();
        for (const auto until = Clock::now() + std::chrono::seconds(20); link && Clock::now() < until;) {
            if (link->identity() && link->mode() && link->read_frame("BASE_left")) return true;
            std::this_thread::sleep_for(milliseconds(20));
        }
        return false;
    }
    bool frames_are(bool corrected) {
        for (const Region& region : fake->project.regions) {
            const Pose wanted = corrected
                                    ? corrected_frame(fake->project.part.base_from_workobject,
                                                      Displacement{fake->workobject_from_movedworkobject},
                                                      region.base_from_frame)
                                    : region.base_from_frame;
            const auto now = cell->read_frame(region.frame_name);
            if (!now || distance_mm(*now, wanted) > 0.1) return false;
        }
        return true;
    }

    // The fresh file of the next run, on the link as `way` makes it.
    void make_station(RobotLink& way) {
        station.reset();
        auto file = ProjectFile::create(path, fake->project, true);
        ASSERT_TRUE(file) << file.error().sentence();
        station.emplace(std::move(*file), fake->project);
        connect(way);
    }
    void connect(RobotLink& way) {
        std::map<std::string, std::unique_ptr<ProfileSource>> sensors;
        sensors["A"] = std::make_unique<FakeSensor>(*fake);
        std::map<std::string, std::unique_ptr<RobotLink>> robots;
        robots["R1"] = std::make_unique<Borrowed>(way);
        station->connect(std::move(sensors), std::move(robots));
    }
    RunStatus status_in_file() {
        auto file = ProjectFile::open(path, FileAccess::read_only);
        EXPECT_TRUE(file) << file.error().sentence();
        if (!file) return RunStatus::interrupted;
        const auto runs = file->runs();
        return runs && !runs->empty() ? runs->back().status : RunStatus::interrupted;
    }

    struct Sabotage {
        std::string fault = "none";
        Instant at = {"-"};
        Saboteur::Fault on_link = Saboteur::Fault::none;
        ControllerFault on_wire = ControllerFault::none;
        std::int64_t sync = 0;
        FailingDisk::Fails disk = FailingDisk::Fails::once;
    };

    // What the application has taken stays until the next part begins: so one begins and is given up.
    void end_last_part() {
        const auto moves = measuring_program(fake->project, "R1");
        for (int tries = 0; controller->released() && tries < 100; ++tries) {
            if (link->start_measuring(moves))
                for (std::size_t i = 0; i < moves.size(); ++i)
                    (void)link->wait_trigger(std::chrono::seconds(5));
            (void)link->confirm(PartVerdict::failed, "given up");
            std::this_thread::sleep_for(milliseconds(20));
        }
        EXPECT_FALSE(controller->released());
    }

    Outcome run(const Sabotage& sabotage, std::vector<Instant>* instants = nullptr,
                std::int64_t* syncs = nullptr) {
        Outcome out;
        for (const Region& r : fake->project.regions)
            (void)cell->write_frame(r.frame_name, r.base_from_frame);
        EXPECT_TRUE(answers()) << "before " << sabotage.fault << " at " << sabotage.at.name();
        // The controller's program holds the frames; it takes them once the last part's application is over.
        for (const Region& r : fake->project.regions)
            for (int i = 0; i < 200; ++i) {
                const auto now = link->read_frame(r.frame_name);
                if (now && distance_mm(*now, r.base_from_frame) < 1e-3) break;
                (void)link->write_frame(r.frame_name, r.base_from_frame);
                std::this_thread::sleep_for(std::chrono::milliseconds(25));
            }
        end_last_part();
        auto saboteur = std::make_unique<Saboteur>(*link);
        saboteur->wire = [&](bool on) {
            controller->set_fault(on ? sabotage.on_wire : ControllerFault::none);
        };
        make_station(*saboteur);
        saboteur->seen.clear();
        saboteur->fault = sabotage.on_link;
        saboteur->at = sabotage.at;
        disk.fail_at(sabotage.sync, sabotage.disk, FailingDisk::Counts::syncs);
        RunOptions options;
        options.part_id = "car";
        options.push = true;
        options.hold = std::chrono::seconds(20);
        bool killed = false;
        try {
            auto record = station->run(options);
            if (record) {
                out.run = to_string(record->status);
                out.message = record->message.english();
                out.exit = record->status == RunStatus::ok                                             ? 0
                           : record->status == RunStatus::device || record->status == RunStatus::alarm ? 3
                                                                                                       : 1;
                for (const RegionRecord& r : record->regions)
                    out.message += fmt::format("\n  {}: {}, {}: {}", r.region_id, to_string(r.push.status),
                                               to_string(r.push.release), r.push.message);
                for (const RegionRecord& r : record->regions)
                    out.not_restored = out.not_restored || r.push.status == PushStatus::not_restored;
            } else {
                out.message = record.error().sentence();
            }
        } catch (const Killed&) {
            killed = true;
            out.run = "killed";
        }
        if (syncs) *syncs = disk.counted();
        disk.heal();
        if (instants) *instants = saboteur->seen;
        station.reset();
        link.reset();  // the program ends
        std::this_thread::sleep_for(milliseconds(100));
        out.file = out.resolved = status_in_file();
        out.released = controller->released();
        out.at_target = frames_are(true);
        out.at_old = frames_are(false);
        if (killed || out.file == RunStatus::pushed) {
            // The next program asks what became of it.
            EXPECT_TRUE(answers());
            station.emplace(*Station::open(path));
            connect(*link);
            station.reset();
            out.resolved = status_in_file();
            link.reset();
            std::this_thread::sleep_for(milliseconds(100));
            out.released = controller->released();
        }
        return out;
    }

    // Nothing disagrees, and what is released is what was corrected.
    bool safe(const Outcome& o) const {
        // A correction that lived in the link is over with it; the file does not claim to know more.
        if (brand.cyclic() && o.file == RunStatus::pushed) return o.resolved == RunStatus::pushed;
        const bool says_ok = o.resolved == RunStatus::ok;
        if (o.released != says_ok) return false;
        if (o.run == "killed")
            return o.file != RunStatus::ok && (!o.released || o.at_target || brand.cyclic());
        if (o.released) return o.exit == 0 && (o.at_target || brand.cyclic());
        return o.exit != 0 && o.file != RunStatus::ok && (o.at_old || o.not_restored || brand.cyclic());
    }
    void row(const Sabotage& s, const Outcome& o) {
        const bool is_safe = safe(o);
        fmt::print("{:<10} {:<26} {:<18} run {:<10} file {:<12} then {:<10} exit {}  frame {:<9} {:<13} {}\n",
                   brand.name, s.fault, s.at.name(), o.run, to_string(o.file), to_string(o.resolved),
                   o.run == "killed" ? "-" : std::to_string(o.exit),
                   brand.cyclic() ? "-"
                   : o.at_target  ? "corrected"
                   : o.at_old     ? "old"
                                  : "mixed",
                   o.released ? "released" : "not released", is_safe ? "safe" : "UNSAFE");
        std::fflush(stdout);
        EXPECT_TRUE(is_safe) << o.message;
    }

    const Brand brand = GetParam();
    FailingDisk disk;
    TemporaryFolder folder;
    const std::filesystem::path path = folder / "matrix.seam";
    std::unique_ptr<FakeCell> fake;
    std::shared_ptr<SimulatedCell> cell;
    DeviceSession session;
    nlohmann::json link_settings, controller_settings;
    std::unique_ptr<SimulatedController> controller;
    std::unique_ptr<RobotLink> link;
    std::optional<Station> station;
};

TEST_P(FaultMatrix, FileRobotAndVerdictAgree) {
    std::vector<Instant> instants;
    std::int64_t syncs = 0;
    const Outcome clean = run({}, &instants, &syncs);
    row({}, clean);
    ASSERT_EQ(clean.exit, 0) << clean.message;
    ASSERT_TRUE(clean.released) << "after the program has ended";
    ASSERT_GT(syncs, 5);

    std::vector<Instant> tried;
    for (const Instant& i : instants)
        if (i.call != "permission" || i.number <= 2) tried.push_back(i);
    for (const Instant& at : tried) {
        row({"request lost", at, Saboteur::Fault::request_lost},
            run({"request lost", at, Saboteur::Fault::request_lost}));
        row({"answer lost", at, Saboteur::Fault::answer_lost},
            run({"answer lost", at, Saboteur::Fault::answer_lost}));
        row({"program killed before", at, Saboteur::Fault::killed_before},
            run({"program killed before", at, Saboteur::Fault::killed_before}));
        row({"program killed after", at, Saboteur::Fault::killed_after},
            run({"program killed after", at, Saboteur::Fault::killed_after}));
    }
    for (const Instant& at : {Instant{"start_measuring", 1}, Instant{"write_frame", 1}, Instant{"confirm", 1},
                              Instant{"permission", 1}})
        for (const ControllerFault fault : controller_faults()) {
            const Sabotage s{"on the wire: " + std::string(to_string(fault)), at,
                             Saboteur::Fault::on_the_wire, fault};
            row(s, run(s));
        }
    for (std::int64_t k = 1; k <= syncs; ++k)
        for (const auto fails : {FailingDisk::Fails::once, FailingDisk::Fails::from_then_on}) {
            Sabotage s{fails == FailingDisk::Fails::once ? "disk fails once" : "disk fails from then on",
                       {"sync", static_cast<int>(k)}};
            s.sync = k;
            s.disk = fails;
            row(s, run(s));
        }
}

INSTANTIATE_TEST_SUITE_P(Brands, FaultMatrix, testing::ValuesIn(kBrands), [](const auto& brand) {
    std::string name = brand.param.name;
    std::replace(name.begin(), name.end(), '-', '_');
    return name;
});

TEST(FaultMatrixTable, HoldsEveryControllerOfTheRegistry) {
    for (const ControllerDriver& driver : controller_drivers())
        EXPECT_TRUE(std::any_of(kBrands.begin(), kBrands.end(), [&](const Brand& b) {
            return b.name == driver.name;
        })) << driver.name;
}

}  // namespace
}  // namespace seamwright
