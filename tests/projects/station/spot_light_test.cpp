#include "projects/station/light/spot_light.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "projects/proof/replay.h"
#include "projects/station/station.h"
#include "projects/station/teach.h"
#include "tests/projects/door_project.h"
#include "tests/projects/sample_project.h"
#include "tests/projects/served_cell.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;

// The door with a paint of its own, taught with the references of its truth; a small camera, for speed.
json painted(double albedo, double gloss, double dark_share = 0, double dark_albedo = 0.06) {
    json settings = cell_settings(make_pose(rotation_exp({0.003, -0.002, 0.004}), {2, -3, 1.5}));
    settings["optics"] = {{"width", 800}, {"height", 640}};
    settings["surface"] = {{"albedo", albedo},           {"gloss", gloss},       {"dark_share", dark_share},
                           {"dark_albedo", dark_albedo}, {"dark_size_mm", 25.0}, {"mirror", 0.0}};
    settings["noise"] = {{"stray_probability", 0.0}};
    return settings;
}

class Light : public testing::Test {
  protected:
    // References and templates come from a cell of ordinary paint: they do not know of light.
    void open(const json& settings, const std::function<void(Project&)>& change = {}) {
        station.reset();
        cell = *SimulatedCell::open(settings);
        Project p = door_project(*cell, settings);
        for (Spot& s : p.spots) {
            const auto doors = default_door_spots();
            const auto door =
                std::find_if(doors.begin(), doors.end(), [&](const DoorSpot& d) { return d.id == s.id; });
            s.reference_mm = {door->edge_mm.x(), 0, door->edge_mm.z()};
        }
        if (change) change(p);
        auto file = ProjectFile::create(folder / "light.seam", p, true);
        ASSERT_TRUE(file) << file.error().sentence();
        station.emplace(std::move(*file), p);
        const auto connected = station->connect();
        ASSERT_TRUE(connected) << connected.error().sentence();
    }
    double now(const char* setting) { return *station->sensor("A")->get(setting); }
    RunRecord run(const RunOptions& options = {}) {
        auto record = station->run(options);
        EXPECT_TRUE(record) << record.error().sentence();
        auto stored = station->file().load_run(record->number);
        EXPECT_TRUE(stored) << stored.error().sentence();
        EXPECT_EQ(stored->spots.size(), record->spots.size());
        for (std::size_t i = 0; i < stored->spots.size(); ++i)
            EXPECT_EQ(exact_text(stored->spots[i]), exact_text(record->spots[i]));
        auto again = recompute(*stored, *station->file().load_run_setup(record->number));
        EXPECT_TRUE(again);
        EXPECT_TRUE(compare(*stored, *again).empty()) << compare(*stored, *again).front().text;
        return *record;
    }
    static int measured(const RunRecord& run) {
        return static_cast<int>(
            std::ranges::count(run.spots, SpotStatus::measured, &SpotMeasurement::status));
    }
    TemporaryFolder folder;
    std::shared_ptr<SimulatedCell> cell;
    std::optional<Station> station;
};

TEST_F(Light, IsFoundInFiveFramesAndTheSensorStandsAsBefore) {
    for (const double start : {3.0, 1000.0, 900000.0}) {
        json settings = painted(0.6, 0.2);
        settings["exposure_us"] = start;
        open(settings);
        for (const std::size_t k : {0u, 5u, 11u}) {
            const Spot spot = station->project().spots[k];
            const auto found = find_light(*station, spot, {});
            ASSERT_TRUE(found) << found.error().sentence();
            EXPECT_EQ(found->verdict, LightVerdict::fit) << spot.id << " from " << start;
            const auto first = std::ranges::count(found->tried, false, &TriedLight::for_dark_lines);
            EXPECT_LE(first, kFramesOfSearch) << spot.id << " from " << start;
            EXPECT_TRUE(found->merge_us.empty());
            EXPECT_EQ(now("exposure_us"), start);
            EXPECT_EQ(now("gain_db"), 0);
            const double us = found->settings.at("exposure_us");
            EXPECT_GT(us, 100);
            EXPECT_LT(us, 10000);
        }
    }
}

TEST_F(Light, ASpotThatIsPassedIsNotExposedLongerThanItsWindow) {
    open(painted(0.004, 0), [](Project& p) {
        p.spots[0].speed_mm_s = 500;
        p.spots[0].jitter_mm = 0.5;
    });
    auto found = find_light(*station, station->project().spots[0], {});
    ASSERT_TRUE(found) << found.error().sentence();
    EXPECT_DOUBLE_EQ(found->longest_us, 1000);
    for (const TriedLight& t : found->tried) EXPECT_LE(t.settings.at("exposure_us"), 1000);
    // More light comes from gain then, as far as it was allowed.
    EXPECT_GT(found->settings.at("gain_db"), 0);
    FindLightOptions little;
    little.longest_us = 200;
    little.highest_gain_db = 0;
    found = find_light(*station, station->project().spots[0], little);
    ASSERT_TRUE(found) << found.error().sentence();
    EXPECT_NE(found->verdict, LightVerdict::fit);
    EXPECT_LE(found->settings.at("exposure_us"), 200);
}

TEST_F(Light, EachSpotIsCutWithItsOwnSettingsAndTheyAreRecorded) {
    open(painted(0.6, 0.2), [](Project& p) {
        p.spots[1].light.settings = {{"exposure_us", 1500}, {"gain_db", 1.5}};
        p.spots[4].light.settings = {{"exposure_us", 700}};
        p.spots[4].light.paints = {{"white", {{"exposure_us", 400}}}, {"7", {{"exposure_us", 2000}}}};
    });
    const auto exposure_of = [](const RunRecord& run, std::size_t k) {
        return run.spots[k].light ? run.spots[k].light->settings.at("exposure_us") : -1;
    };
    for (const auto& [paint, expected] :
         {std::pair{"", 700.0}, {"white", 400.0}, {"7", 2000.0}, {"yellow", 700.0}}) {
        RunOptions options;
        options.paint = paint;
        const RunRecord record = run(options);
        EXPECT_GE(measured(record), 10);
        EXPECT_EQ(exposure_of(record, 0), 1000) << "the sensor's own";
        EXPECT_EQ(exposure_of(record, 1), 1500);
        EXPECT_EQ(record.spots[1].light->settings.at("gain_db"), 1.5);
        EXPECT_EQ(record.spots[2].light->settings.at("gain_db"), 0);
        EXPECT_EQ(exposure_of(record, 4), expected) << paint;
        EXPECT_EQ(now("exposure_us"), 1000);
        EXPECT_EQ(now("gain_db"), 0);
        if (std::string(paint) == "yellow") {
            EXPECT_THAT(record.events.front().text.english(), HasSubstr("no spot knows"));
        }
    }
    // A reference remembers the light it was measured with, also where the spot asks for none.
    TeachOptions once;
    once.repeats = 1;
    for (const auto& [k, expected] : {std::pair{1u, 1500.0}, {0u, 1000.0}}) {
        const auto taught = teach_spot(*station, station->project().spots[k], once);
        ASSERT_TRUE(taught) << taught.error().sentence();
        ASSERT_TRUE(taught->spot.reference_light);
        EXPECT_EQ(taught->spot.reference_light->settings.at("exposure_us"), expected);
        EXPECT_GT(*taught->spot.reference_light->bright, 0.2);
    }
}

TEST_F(Light, WithoutSettingsOfItsOwnNothingIsAskedOfTheSensor) {
    open(painted(0.6, 0.2));
    for (const SpotMeasurement& m : run().spots) EXPECT_FALSE(m.light);
}

// The paint is 12 times darker than the one that the settings were found on.
TEST_F(Light, TheExposureFollowsThePaintFromSpotToSpotWithinItsLimits) {
    const auto follow = [](double longest_us) {
        return [longest_us](Project& p) {
            for (Spot& s : p.spots) {
                s.light.settings = {{"exposure_us", 1000}};
                s.light.shortest_us = 200;
                s.light.longest_us = longest_us;
            }
        };
    };
    const json dark = painted(0.05, 0);
    open(dark, follow(30000));
    RunOptions options;
    options.paint = "black";
    const RunRecord first = run(options), second = run(options);
    EXPECT_EQ(first.spots[0].light->settings.at("exposure_us"), 1000);
    for (std::size_t k = 2; k < first.spots.size(); ++k) {
        EXPECT_GT(first.spots[k].light->settings.at("exposure_us"), 4000) << k;
        EXPECT_GT(*first.spots[k].light->bright, 0.3) << k;
    }
    // The next part of this paint begins where the last one ended; another paint with its own.
    EXPECT_GT(second.spots[0].light->settings.at("exposure_us"), 4000);
    options.paint = "white";
    EXPECT_EQ(run(options).spots[0].light->settings.at("exposure_us"), 1000);
    open(dark, follow(2500));
    for (const SpotMeasurement& m : run().spots) EXPECT_LE(m.light->settings.at("exposure_us"), 2500.5);
    for (const SpotMeasurement& m : run().spots) EXPECT_LE(m.light->settings.at("exposure_us"), 2500.5);
    // A robot that stands takes the first spot again.
    open(dark, [&](Project& p) {
        follow(30000)(p);
        p.spots[0].stop_at_trigger = true;
    });
    EXPECT_GT(run().spots[0].light->settings.at("exposure_us"), 4000);
    EXPECT_EQ(now("exposure_us"), 1000);
}

// Half of the surface lies in patches 40 times darker than the rest.
TEST_F(Light, AContourHalfBlackHalfShiningIsMeasuredFromMergedExposures) {
    const json patched = painted(0.8, 0.2, 0.5, 0.02);
    const auto standing = [](Project& p) {
        for (Spot& s : p.spots) s.stop_at_trigger = true;
    };
    // The same part in one even paint says where it lies, by the same references.
    open(painted(0.8, 0.2), standing);
    const RunRecord even = run();
    ASSERT_TRUE(even.regions[0].correction);
    open(patched, standing);
    Project p = station->project();
    int merged = 0;
    for (Spot& s : p.spots) {
        const auto found = find_light(*station, s, {});
        ASSERT_TRUE(found) << found.error().sentence();
        s.light.settings = found->settings;
        s.light.merge_us = found->merge_us;
        merged += !found->merge_us.empty();
        EXPECT_TRUE(check_light(s, p.sensors[0]));
        if (!found->merge_us.empty()) {
            EXPECT_GT(found->merge_us.back(), 4 * found->merge_us.front());
            EXPECT_GT(found->unserved_share, 0.03);
        }
    }
    EXPECT_GE(merged, 8);
    ASSERT_TRUE(station->edit(p));
    const RunRecord with = run();
    for (const SpotMeasurement& m : with.spots) {
        const Spot& s = *find_spot(p, m.spot_id);
        EXPECT_EQ(m.light->exposures, std::max<int>(1, static_cast<int>(s.light.merge_us.size())));
    }
    for (Spot& s : p.spots) s.light.merge_us.clear();
    ASSERT_TRUE(station->edit(p));
    const RunRecord without = run();
    // Points that the features rest on, and whether the part is found where it lies.
    const auto points = [](const RunRecord& r) {
        int sum = 0;
        for (const SpotMeasurement& m : r.spots)
            if (m.status == SpotStatus::measured) sum += m.feature.points_used;
        return sum;
    };
    EXPECT_GE(measured(with), measured(without));
    EXPECT_GE(measured(with), 11);
    EXPECT_GT(points(with), points(without));
    ASSERT_TRUE(with.regions[0].correction);
    const auto found = [](const RunRecord& r) {
        return r.regions[0].correction->displacement.workobject_from_movedworkobject;
    };
    EXPECT_LT(distance_mm(found(with), found(even)), 0.15);
    for (std::size_t k = 0; k < with.spots.size(); ++k) {
        if (with.spots[k].status != SpotStatus::measured) continue;
        EXPECT_LT((with.spots[k].measured_mm - even.spots[k].measured_mm).norm(), 0.25)
            << with.spots[k].spot_id;
    }
}

TEST_F(Light, WhatNoSensorOrRobotCouldFollowIsRefusedBeforeItMoves) {
    open(painted(0.6, 0.2));
    const Project sound = station->project();
    const auto refusal = [&](const std::function<void(Spot&)>& change) {
        Project p = sound;
        change(p.spots[2]);
        station->use(p);
        RunOptions options;
        const auto record = station->run(options);
        EXPECT_EQ(now("exposure_us"), 1000);
        if (!record) return record.error().sentence();
        EXPECT_EQ(record->status, RunStatus::device);
        EXPECT_EQ(measured(*record), 0);
        return record->message.english();
    };
    EXPECT_THAT(refusal([](Spot& s) { s.light.settings["brightness"] = 3; }),
                HasSubstr("no setting \"brightness\""));
    EXPECT_THAT(refusal([](Spot& s) { s.light.settings["region_width"] = 300; }), HasSubstr("calibration"));
    EXPECT_THAT(refusal([](Spot& s) { s.light.settings["exposure_us"] = 0; }), HasSubstr("no setting"));
    EXPECT_THAT(refusal([](Spot& s) { s.light.settings["exposure_us"] = std::nan(""); }),
                HasSubstr("no setting"));
    EXPECT_THAT(refusal([](Spot& s) { s.light.settings["gain_db"] = 300; }), HasSubstr("gain_db"));
    EXPECT_THAT(refusal([](Spot& s) { s.light.merge_us = {100, 900}; }), HasSubstr("stop at the trigger"));
    const auto standing = [](Spot& s, std::vector<double> merge) {
        s.stop_at_trigger = true;
        s.light.merge_us = std::move(merge);
    };
    EXPECT_THAT(refusal([&](Spot& s) { standing(s, {100}); }), HasSubstr("2 to 4"));
    EXPECT_THAT(refusal([&](Spot& s) { standing(s, {900, 100}); }), HasSubstr("ascend"));
    EXPECT_THAT(refusal([&](Spot& s) { standing(s, {-1, 100}); }), HasSubstr("ascend"));
    EXPECT_THAT(refusal([](Spot& s) { s.light.longest_us = 100; }), HasSubstr("follow the paint"));
    EXPECT_THAT(refusal([](Spot& s) {
                    s.light.paints = {{"white", {{"exposure_us", 5}}}, {"white", {{"exposure_us", 6}}}};
                }),
                HasSubstr("name"));
    Project wired = sound;
    wired.sensors[0].settings["hardware_trigger"] = true;
    standing(wired.spots[0], {100, 900});
    EXPECT_THAT(check_light(wired.spots[0], wired.sensors[0]).error().sentence(), HasSubstr("wired"));
}

// The whole way over wires: GigE Vision registers, and a robot that executes the KRL program and stands as long as it says.
TEST(ServedLight, ACameraIsSetOverTheWireAndExposesTwiceWhereTheRobotStands) {
    TemporaryFolder folder;
    auto served = serve_cell({.time_scale = 40}, folder / "served.seam");
    ASSERT_TRUE(served) << served.error().sentence();
    Station& station = *served->station;
    Project p = station.project();
    p.spots.resize(4);
    p.regions.clear();
    p.sensors[0].settings.erase("hardware_trigger");
    p.robots[0].trigger_latency_ms = 5;  // as if measured: else nobody passes a spot with a software trigger
    p.spots[1].light.settings = {{"exposure_us", 1700}};
    p.spots[2].stop_at_trigger = true;
    p.spots[2].light.merge_us = {500, 1500};
    station.disconnect();
    ASSERT_TRUE(station.edit(p));
    served->robot.reset();
    served->robot_options.program = measuring_program(p, "R1");
    EXPECT_GT(served->robot_options.program[2].stand_s, 0.3);
    EXPECT_EQ(served->robot_options.program[1].stand_s, kStand_s);
    served->robot_options.controllers[0].settings["time_scale"] = 4;
    auto robot = CellServer::start(served->robot_options, served->cell);
    ASSERT_TRUE(robot) << robot.error().sentence();
    served->robot.emplace(std::move(*robot));
    const auto connected = station.connect();
    ASSERT_TRUE(connected) << connected.error().sentence();
    const auto record = station.run({});
    ASSERT_TRUE(record) << record.error().sentence();
    EXPECT_NE(record->status, RunStatus::device) << record->message;
    EXPECT_EQ(record->spots[1].status, SpotStatus::measured) << record->spots[1].message;
    ASSERT_TRUE(record->spots[1].light);
    EXPECT_NEAR(record->spots[1].light->settings.at("exposure_us"), 1700, 1);
    ASSERT_TRUE(record->spots[2].light);
    EXPECT_EQ(record->spots[2].light->exposures, 2) << record->spots[2].message;
    EXPECT_EQ(record->spots[2].status, SpotStatus::measured) << record->spots[2].message;
}

}  // namespace
}  // namespace seamwright
