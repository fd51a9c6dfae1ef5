// From stored runs to the sentence: carriers by name, a fixture kept in the project, a locator that gave way.

#include "projects/statistics/diagnosis.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/statistics/carrier_line.h"
#include "tests/projects/statistics/production_runs.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

const nlohmann::json kFixture = nlohmann::json::parse(R"({
    "elements": [
        {"id": "rest 1", "at_mm": [100, 50, 0], "direction": [0, 0, 1]},
        {"id": "rest 2", "at_mm": [900, 60, 0], "direction": [0, 0, 2]},
        {"id": "rest 3", "at_mm": [480, 760, 0], "direction": [0, 0, 1]},
        {"id": "locator 1", "at_mm": [150, 0, 40], "directions": [[0, 1, 0]]},
        {"id": "locator 2", "at_mm": [850, 0, 35], "directions": [[0, -1, 0]]},
        {"id": "stop", "at_mm": [0, 420, 50], "direction": [1, 0, 0]}],
    "carrier_pattern": "-C([0-9]+)$"})");

// 5 carriers go round, a part every minute; what holds carrier 3 in place 4 gives way by +0.4 mm from car 101 on.
void fill(ProjectFile& file, const Project& project, int cars, double give_mm) {
    std::mt19937_64 random(11);
    std::normal_distribution<double> normal;
    for (int k = 0; k < cars; ++k) {
        std::vector<double> give(6);
        for (double& g : give) g = 0.05 * normal(random);
        const int carrier = k % 5;
        if (carrier == 3 && k >= 101) give[4] += give_mm;
        const auto seat = carrier_line::seated(carrier_line::door_locators(), give);
        RunRecord run = production_run(k, {3 + seat.t.x(), seat.t.y() - 1, seat.t.z()});
        run.part_id = fmt::format("CAR-{}-C{}", 1000 + k, carrier);
        auto& correction = *run.regions.front().correction;
        correction.displacement.workobject_from_movedworkobject =
            make_pose(seat.r, seat.t) * make_pose(rotation_exp({0.002, -0.01, 0.005}), {3, -1, 0.5});
        correction.covariance_random.diagonal() << 4e-4, 4e-4, 4e-4, 1e-9, 1e-9, 1e-9;
        correction.covariance = correction.covariance_random;
        ASSERT_TRUE(file.append_run(run, project));
    }
}

Project door() {
    Project p = production_project();
    p.regions.front().free = kAllFree;
    return p;
}

TEST(CarrierDiagnosis, NamesLocatorAmountCarAndDayFromStoredRuns) {
    const TemporaryFolder folder;
    Project project = door();
    project.fixture = *fixture_from_json(kFixture, "fixture.json");
    auto file = ProjectFile::create(folder / "door.seam", project);
    ASSERT_TRUE(file) << file.error().sentence();
    EXPECT_EQ(*file->load()->fixture, *project.fixture);
    fill(*file, project, 200, 0.4);
    const auto production = production_of({folder / "door.seam"}, {});
    ASSERT_TRUE(production) << production.error().sentence();
    const auto d = diagnose_production(*production, {});
    ASSERT_TRUE(d) << d.error().sentence();
    ASSERT_EQ(d->sentences.size(), 1u);
    const std::string said = d->sentences.front().english();
    EXPECT_THAT(said, HasSubstr("carrier 3: locator 2, +0.39 mm Y"))
        << "the direction is -Y, said is along Y";
    EXPECT_THAT(said, HasSubstr("mm Y since 2024-05-01T13:43 UTC (run 104, part CAR-1103-C3)"));
    const auto json = diagnosis_json(*d);
    EXPECT_EQ(json.at("status"), "moved");
    EXPECT_EQ(json.at("changes")[0].at("carrier"), "3");
    EXPECT_GT(json.at("changes")[0].at("elements")[0].at("probability").get<double>(), 0.95);
    EXPECT_EQ(json.at("carriers").size(), 5u);
    report::Page page("x");
    write_diagnosis(*d, Language::german, page);
    EXPECT_THAT(page.text(), HasSubstr("Träger 3: locator 2"));
}

TEST(CarrierDiagnosis, QuietRunsAndOneFixtureForAll) {
    const TemporaryFolder folder;
    const Project project = door();
    auto file = ProjectFile::create(folder / "door.seam", project);
    fill(*file, project, 120, 0);
    const auto production = production_of({folder / "door.seam"}, {"", "", "", true});
    ASSERT_TRUE(production);
    CarrierDiagnosisOptions options;
    options.fixture = *fixture_from_json(kFixture, "fixture.json");
    EXPECT_FALSE(diagnose_production(*production, options)->changed());
    options.fixture->carrier_pattern.clear();
    const auto all = diagnose_production(*production, options);
    EXPECT_EQ(all->carriers.size(), 1u);
    EXPECT_FALSE(all->changed());
    // A list instead of the pattern: who is not in it is left out.
    options.carriers = *read_carriers("part,carrier\r\nCAR-1000-C0,A\nCAR-1001-C1,A\n", "list");
    const auto listed = diagnose_production(*production, options);
    EXPECT_EQ(listed->numbers.status, DiagnosisStatus::too_few);
    EXPECT_EQ(listed->no_carrier, 118);
}

TEST(CarrierDiagnosis, FixturesThatAreNone) {
    const auto refused = [](const char* what, const nlohmann::json& patch) {
        nlohmann::json json = kFixture;
        json.merge_patch(patch);
        const auto fixture = fixture_from_json(json, "fixture.json");
        EXPECT_FALSE(fixture) << what;
        return fixture ? std::string() : fixture.error().sentence();
    };
    EXPECT_THAT(refused("no group", {{"carrier_pattern", "C[0-9]+"}}), HasSubstr("no group"));
    EXPECT_THAT(refused("no pattern", {{"carrier_pattern", "(("}}), HasSubstr("pattern is none"));
    EXPECT_THAT(refused("misspelt", {{"carier_pattern", "(x)"}}), HasSubstr("carier_pattern"));
    auto five = kFixture.at("elements");
    five.erase(5);
    EXPECT_THAT(refused("loose along X", {{"elements", five}}), HasSubstr("free to move (X"));
    auto crooked = kFixture.at("elements");
    crooked[0].erase("direction");
    crooked[0]["directions"] = {{0, 0, 1}, {0, 1, 1}};
    EXPECT_THAT(refused("crooked", {{"elements", crooked}}), HasSubstr("right angles"));
    auto twice = kFixture.at("elements");
    twice[1]["id"] = "rest 1";
    EXPECT_THAT(refused("twice", {{"elements", twice}}), HasSubstr("called \"rest 1\""));
    auto none = kFixture.at("elements");
    none[0]["direction"] = {0, 0, 0};
    EXPECT_THAT(refused("none", {{"elements", none}}), HasSubstr("no length"));
    EXPECT_FALSE(read_carriers("car,carrier\nx,1\n", "list"));
    EXPECT_FALSE(read_carriers("part,carrier\nx,1\nx,2\n", "list"));
    EXPECT_FALSE(read_carriers("part,carrier\nx\n", "list"));
    EXPECT_FALSE(read_carriers("", "list"));
}

}  // namespace
}  // namespace seamwright
