// Studies chosen from tables and from stored runs, their JSON fields and their page.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "projects/acceptance/pages/acceptance_json.h"
#include "projects/acceptance/pages/acceptance_page.h"
#include "projects/acceptance/study/stored_values.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

std::vector<Study> all() {
    return {std::begin(kStudies), std::end(kStudies)};
}

// Ten parts hung twice, each time measured twice; a reference part measured thirty times.
std::vector<StudyValue> table(double noise, unsigned seed = 4) {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal;
    std::vector<StudyValue> out;
    for (int p = 0; p < 10; ++p) {
        const double part = normal(random);
        for (int h = 0; h < 2; ++h) {
            const double hung = part + noise * normal(random);
            for (int n = 1; n <= 2; ++n)
                out.push_back(
                    {"P" + std::to_string(p), std::to_string(h), n, hung + noise * normal(random), {}, {}});
        }
    }
    for (int n = 1; n <= 30; ++n) out.push_back({"master", "1", n, 2 + noise * normal(random), 2.0, {}});
    return out;
}

TEST(Studies, OneTableIsMadeIntoAllItAllows) {
    AcceptanceSettings settings;
    settings.tolerance_mm = 2;
    settings.nominal_mm = 2;
    auto a = judge_acceptance(StudyValues::of(table(0.01)), {}, settings, all());
    ASSERT_TRUE(a) << a.error().sentence();
    ASSERT_TRUE(a->type1 && a->type3 && a->vda5);
    EXPECT_EQ(a->type1_part, "master");
    EXPECT_EQ(a->type1->n, 30);
    EXPECT_EQ(a->type3->parts, 10);
    EXPECT_TRUE(a->type3->nested);
    EXPECT_TRUE(a->type1_part_left_out);
    EXPECT_TRUE(a->vda5->type3);
    EXPECT_GT(a->vda5->u_mp_mm, a->vda5->u_ms_mm);
    EXPECT_EQ(a->type1->verdict, AcceptanceVerdict::ok);
    EXPECT_EQ(a->type3->verdict, AcceptanceVerdict::ok);
    EXPECT_TRUE(a->not_done.contains(Study::linearity));
    EXPECT_TRUE(a->not_done.contains(Study::correlation));

    // Without the master, what is said holds at the desk too, which has no options.
    auto parts = table(0.01);
    std::erase_if(parts, [](const StudyValue& v) { return v.part == "master"; });
    const auto b = judge_acceptance(StudyValues::of(parts), {}, settings, all());
    ASSERT_TRUE(b) << b.error().sentence();
    ASSERT_TRUE(b->not_done.contains(Study::type1));
    EXPECT_THAT(b->not_done.at(Study::type1).sentence(), HasSubstr("measure one of them 25 times or more"));
    EXPECT_THAT(b->not_done.at(Study::type1).sentence(), Not(HasSubstr("--")));

    const json j = acceptance_json(*a);
    for (const char* field : {"n", "mean", "s", "bias", "bias_p", "cg", "cgk", "limits", "verdict"})
        EXPECT_TRUE(j["type1"].contains(field)) << field;
    for (const char* field : {"ev", "rehang", "pv", "grr", "grr_percent_tolerance", "grr_percent_total",
                              "ndc", "anova", "verdict", "limits"})
        EXPECT_TRUE(j["type3"].contains(field)) << field;
    for (const char* field : {"source", "df", "ss", "ms"})
        EXPECT_TRUE(j["type3"]["anova"][0].contains(field)) << field;
    for (const char* field : {"u_ms", "u_mp", "q_ms_percent", "q_mp_percent", "conformity_zone", "limits"})
        EXPECT_TRUE(j["vda5"].contains(field)) << field;
    EXPECT_EQ(j["linearity"]["verdict"], "not_done");
    EXPECT_EQ(j["status"], to_string(a->verdict()));
}

TEST(Studies, WhatIsNotKnownIsAskedFor) {
    AcceptanceSettings settings;
    settings.tolerance_mm = 2;
    const Study type1[] = {Study::type1};
    auto values = table(0.01);
    for (StudyValue& v : values) v.reference_mm.reset();
    auto refused = [&](const char* part) {
        const auto a = judge_acceptance(StudyValues::of(values), {}, settings, type1);
        ASSERT_FALSE(a);
        EXPECT_THAT(a.error().sentence(), HasSubstr(part));
        EXPECT_EQ(a.error().kind, ErrorKind::input);
    };
    refused("the reference of part master is not known");
    settings.reference_mm = 2;
    EXPECT_TRUE(judge_acceptance(StudyValues::of(values), {}, settings, type1));
    settings.part = "nobody";
    refused("no values of part \"nobody\"");
    settings.part.clear();
    std::erase_if(values, [](const StudyValue& v) { return v.part == "master"; });
    refused("reference part");
    settings.part = "P1";
    const auto few = judge_acceptance(StudyValues::of(values), {}, settings, type1);
    ASSERT_TRUE(few);
    EXPECT_EQ(few->verdict(), AcceptanceVerdict::too_little_data);
    EXPECT_EQ(acceptance_json(*few)["type1"]["message"], "4 values; 25 are needed at least");
    for (const double none : {0.0, -1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
        settings.tolerance_mm = none;
        refused("tolerance");
    }
}

// Values of known s: 50 alternating -+a have s = a sqrt(50 / 49).
std::vector<StudyValue> alternating(double a, double mean) {
    std::vector<StudyValue> values;
    for (int i = 0; i < 50; ++i) values.push_back({"master", "1", i, mean + (i % 2 ? a : -a), 0.0, {}});
    return values;
}

TEST(Studies, TheForecastStandsBesideTheMeasured) {
    AcceptanceSettings settings;
    settings.tolerance_mm = 2;
    const Study type1[] = {Study::type1};
    const auto judged = [&](double s, double mean, double predicted_s, double bias_u) {
        StudySource source;
        source.forecast = StudyForecast{predicted_s, bias_u, 0};
        source.unmoved_part = "master";
        auto a = judge_acceptance(StudyValues::of(alternating(s * std::sqrt(49.0 / 50), mean)), source,
                                  settings, type1);
        EXPECT_TRUE(a) << a.error().sentence();
        return *a;
    };
    const Acceptance right = judged(0.02, 0.005, 0.021, 0.01);
    ASSERT_TRUE(right.type1_check && right.bias_check);
    EXPECT_EQ(right.type1_check->agreement, Agreement::agrees);
    EXPECT_EQ(right.bias_check->agreement, Agreement::agrees);
    EXPECT_NEAR(right.bias_check->predicted_mm, std::hypot(0.01, 0.021 / std::sqrt(50.0)), 1e-12);
    json j = acceptance_json(right);
    EXPECT_NEAR(j["forecast"]["cg"], 0.2 * 2 / (6 * 0.021), 1e-12);
    EXPECT_EQ(j["type1"]["forecast"]["s"]["agreement"], "agrees");
    EXPECT_TRUE(j["forecast"]["ev"].is_null());
    AcceptancePageOptions options;
    EXPECT_THAT(acceptance_page(right, options).text(), HasSubstr("they agree"));
    // 1.5 times the stated, a third of it, and a bias that the systematic part does not explain.
    const Acceptance more = judged(0.03, 0, 0.02, 0.01), less = judged(0.01, 0, 0.03, 0.01),
                     biased = judged(0.02, 0.05, 0.02, 0.01);
    EXPECT_EQ(more.type1_check->agreement, Agreement::beyond_99);
    EXPECT_EQ(less.type1_check->agreement, Agreement::beyond_99);
    EXPECT_EQ(biased.type1_check->agreement, Agreement::agrees);
    EXPECT_EQ(biased.bias_check->agreement, Agreement::beyond_99);
    EXPECT_THAT(acceptance_page(more, options).text(), HasSubstr("differ beyond chance at 99 %"));
    options.language = Language::german;
    EXPECT_THAT(acceptance_page(more, options).text(), HasSubstr("weichen mehr als zuf"));
    // Another part than the unmoved one is not what the forecast is of.
    StudySource source;
    source.forecast = StudyForecast{0.02, 0.01, 0};
    source.unmoved_part = "zero shift";
    EXPECT_FALSE(
        judge_acceptance(StudyValues::of(alternating(0.02, 0)), source, settings, type1)->type1_check);
}

TEST(Studies, RequirementsDecide) {
    AcceptanceSettings settings;
    AcceptanceRequirements required;
    required.tolerance_mm = 2;
    required.cg_share = 0.15;
    required.cg_width = 4;
    require(settings, required);
    EXPECT_EQ(from_of(settings, "cg_share"), RequirementFrom::project);
    EXPECT_EQ(from_of(settings, "ndc"), RequirementFrom::standard);
    EXPECT_EQ(requirements_of(settings), required);
    settings.nominal_mm = 2;
    const auto a = judge_acceptance(StudyValues::of(table(0.01)), {}, settings, all());
    ASSERT_TRUE(a && a->type1 && a->type3 && a->vda5);
    EXPECT_NEAR(a->type1->cg, 0.15 * 2 / (4 * a->type1->s_mm), 1e-12);
    EXPECT_EQ(a->type3->verdict, AcceptanceVerdict::ok);
    EXPECT_EQ(a->vda5->verdict, AcceptanceVerdict::ok);
    // Stricter than the values are: each study says no by its own limit.
    required.cgk = 10;
    required.grr_accepted_percent = 0.1;
    required.grr_refused_percent = 0.2;
    required.process_percent = 1;
    require(settings, required);
    const auto strict = judge_acceptance(StudyValues::of(table(0.01)), {}, settings, all());
    ASSERT_TRUE(strict);
    EXPECT_EQ(strict->type1->verdict, AcceptanceVerdict::not_ok);
    EXPECT_EQ(strict->type3->verdict, AcceptanceVerdict::not_ok);
    EXPECT_EQ(strict->vda5->verdict, AcceptanceVerdict::not_ok);
    AcceptancePageOptions options;
    const std::string text = acceptance_page(*strict, options).text();
    EXPECT_THAT(text, HasSubstr("Cg must reach 1.33 and Cgk 10.00"));
    EXPECT_THAT(text, HasSubstr("of the project"));
    EXPECT_THAT(text, HasSubstr("default"));
}

TEST(Page, BothLanguages) {
    AcceptanceSettings settings;
    settings.tolerance_mm = 2;
    settings.nominal_mm = 2;
    StudySource source;
    source.file = "a<b.csv";
    source.simulated = true;
    auto a = judge_acceptance(StudyValues::of(table(0.01)), source, settings, all());
    ASSERT_TRUE(a);
    AcceptancePageOptions options;
    options.now_utc = "2024-05-01T12:00:00.000Z";
    const std::string english = acceptance_page(*a, options).text();
    EXPECT_THAT(english, HasSubstr("Type 1: capability on a reference part"));
    EXPECT_THAT(english, HasSubstr("simulated"));
    EXPECT_THAT(english, HasSubstr("2024-05-01 12:00"));
    options.language = Language::german;
    const report::Page page = acceptance_page(*a, options);
    const std::string german = page.text(), html = page.html();
    EXPECT_THAT(german, HasSubstr("Verfahren 1"));
    EXPECT_THAT(german, HasSubstr("Varianzanalyse"));
    for (const char* english_word : {"capability", "repeat (mm)", "Required", "accepted", "conformity zone"})
        EXPECT_THAT(german, Not(HasSubstr(english_word)));
    EXPECT_THAT(html, HasSubstr("<svg"));
    EXPECT_THAT(html, HasSubstr("a&lt;b.csv"));
    EXPECT_THAT(html, Not(HasSubstr("no data")));
}

// Three spots along X whose sensors look along -Z... their axes are the work object's: the bead runs along Y, its
// normal is Z, its binormal X.
class Stored : public testing::Test {
  protected:
    TemporaryFolder folder;
    Project project;
    std::mt19937 random{9};
    std::normal_distribution<double> normal;

    void SetUp() override {
        project.name = "door";
        project.part.name = "door left";
        SensorSetup sensor;
        sensor.id = "A", sensor.driver = "simulated",
        sensor.identity = {"simulated", "Seamwright", "S", "0001"};
        sensor.calibration_id = "C";
        project.sensors.push_back(sensor);
        RobotSetup robot;
        robot.id = "R", robot.driver = "simulated", robot.identity = {"simulated", "KUKA", "KR", "0002"};
        project.robots.push_back(robot);
        Calibration c;
        c.id = "C";
        c.sensor_id = "A";
        c.robot_id = "R";
        project.calibrations.push_back(c);
        Region region;
        region.id = "edge";
        for (int i = 0; i < 3; ++i) {
            Spot s;
            s.id = "S" + std::to_string(i + 1);
            s.sensor_id = "A";
            s.robot_id = "R";
            s.base_from_flange = make_pose(Eigen::Matrix3d::Identity(), {100.0 * i, 0, 0});
            project.spots.push_back(s);
            region.spot_ids.push_back(s.id);
        }
        project.regions.push_back(region);
    }
    // Turned about Y: at spot S3 its height counts most.
    Pose with_error(const Pose& truth) {
        const Eigen::Vector3d turn(0, 5e-4 * normal(random), 0);
        return make_pose(rotation_exp(turn),
                         {0.02 * normal(random), 0.5 * normal(random), 0.01 * normal(random)}) *
               truth;
    }
    std::int64_t add(ProjectFile& file, const std::string& part, const Pose& found, bool passed = true) {
        RunRecord run;
        run.part_id = part;
        run.started_utc = run.finished_utc = "2024-05-01T12:00:00.000Z";
        RegionRecord region;
        region.region_id = "edge";
        region.gate_passed = passed;
        region.correction.emplace();
        region.correction->status = CorrectionStatus::ok;
        region.correction->displacement.workobject_from_movedworkobject = found;
        run.regions.push_back(region);
        const auto number = file.append_run(run, project);
        EXPECT_TRUE(number) << number.error().sentence();
        return number.value_or(0);
    }
};

TEST_F(Stored, StudiesOfTheWorstPathPoint) {
    auto file = ProjectFile::create(folder / "a.seam", project);
    ASSERT_TRUE(file) << file.error().sentence();
    std::vector<Pose> unmoved;
    for (int i = 0; i < 40; ++i) {
        unmoved.push_back(with_error(Pose::Identity()));
        add(*file, "zero shift " + std::to_string(i % 10 + 1), unmoved.back());
    }
    add(*file, "zero shift 11", make_pose(Eigen::Matrix3d::Identity(), {0, 0, 50}),
        false);  // refused by the gate
    KnownShift proof;
    for (int i = -25; i <= 25; ++i) {
        ShiftTest test;
        test.amount = i / 3.0;
        test.workobject_from_movedworkobject = make_pose(Eigen::Matrix3d::Identity(), {0, 0, test.amount});
        test.run = add(*file, "known shift Z", with_error(test.workobject_from_movedworkobject));
        proof.tests.push_back(test);
    }
    add(*file, "known shift Z", Pose::Identity());  // of no proof that stands
    ASSERT_TRUE(file->append_evidence({0, {}, 0, proof}, project));
    double squares = 0;  // of the differences of each part's last two runs
    for (int part = 0; part < 6; ++part) {
        const Pose truth = make_pose(Eigen::Matrix3d::Identity(), {normal(random), 0, 3 * normal(random)});
        std::vector<double> z;
        for (int run = 0; run < (part == 2 ? 3 : 2); ++run) {
            const Pose found = with_error(truth);
            z.push_back((found * Eigen::Vector3d(200, 0, 0)).z());
            add(*file, "CAR " + std::to_string(part), found);
        }
        squares += std::pow(z[z.size() - 1] - z[z.size() - 2], 2);
    }
    add(*file, "CAR once", Pose::Identity());

    const auto study = stored_values(*file, "");
    ASSERT_TRUE(study) << study.error().sentence();
    EXPECT_EQ(study->source.measurand.in(Language::english), "region edge, spot S3, normal");
    EXPECT_EQ(study->source.sensor_serial, "0001");
    EXPECT_EQ(study->source.robot_serial, "0002");
    EXPECT_TRUE(study->source.simulated);
    EXPECT_EQ(study->reference_part, "zero shift");
    EXPECT_EQ(study->source.remarks.size(), 4u);  // refused, older proof, once, older run
    EXPECT_EQ(study->values.linearity.size(), 51u);
    EXPECT_EQ(study->values.type3.size(), 12u);

    AcceptanceSettings settings;
    settings.tolerance_mm = 10;
    settings.part = study->reference_part;
    const auto a = judge_acceptance(study->values, study->source, settings, all());
    ASSERT_TRUE(a) << a.error().sentence();
    ASSERT_TRUE(a->type1 && a->type3 && a->linearity && a->stability && a->vda5);
    ASSERT_EQ(a->type1->n, 40);
    // The value from first principles: how far the point (200, 0, 0) moves along Z.
    double mean = 0;
    for (std::size_t i = 0; i < unmoved.size(); ++i) {
        const double z = (unmoved[i] * Eigen::Vector3d(200, 0, 0)).z();
        EXPECT_NEAR(a->type1_values[i].value_mm, z, 1e-9);
        mean += z / 40;
    }
    EXPECT_NEAR(a->type1->bias_mm, mean, 1e-12);
    EXPECT_NEAR(a->type1->s_mm, 0.1, 0.03);
    EXPECT_NEAR(a->type3->ev_mm, std::sqrt(squares / 2 / 6), 1e-9);
    EXPECT_EQ(a->type3->parts, 6);
    EXPECT_EQ(a->type3->runs, 2);
    EXPECT_NEAR(a->linearity->line.slope, 0, 0.01);
    EXPECT_NE(a->linearity->verdict, AcceptanceVerdict::too_little_data);
    EXPECT_EQ(a->stability->means_mm.size(), 8u);
    EXPECT_TRUE(a->not_done.contains(Study::correlation));
}

TEST_F(Stored, ReferencesFromACmmAreMatchedByPart) {
    auto file = ProjectFile::create(folder / "a.seam", project);
    ASSERT_TRUE(file);
    std::vector<StudyValue> cmm;
    for (int part = 0; part < 12; ++part) {
        const double z = part - 6;
        const std::string name = "CAR " + std::to_string(part);
        for (int run = 0; run < 2; ++run)
            add(*file, name, with_error(make_pose(Eigen::Matrix3d::Identity(), {0, 0, z})));
        cmm.push_back({name, "1", 1, z - 0.5, {}, {}});
    }
    cmm.push_back({"CAR nobody", "1", 1, 77, {}, {}});
    auto study = stored_values(*file, "edge");
    ASSERT_TRUE(study);
    EXPECT_EQ(study->reference_part, "");
    add_references(study->values, cmm);
    AcceptanceSettings settings;
    settings.tolerance_mm = 10;
    const Study correlation[] = {Study::correlation};
    const auto a = judge_acceptance(study->values, study->source, settings, correlation);
    ASSERT_TRUE(a) << a.error().sentence();
    EXPECT_EQ(a->correlation->pairs.size(), 12u);
    EXPECT_TRUE(a->correlation->offset_limits.contains(0.5)) << a->correlation->offset_mm;
    EXPECT_TRUE(a->correlation->line.slope_limits.contains(1));
    EXPECT_EQ(a->correlation->verdict, AcceptanceVerdict::not_ok);
}

TEST_F(Stored, AnotherSetupIsAnotherProcess) {
    auto file = ProjectFile::create(folder / "a.seam", project);
    ASSERT_TRUE(file);
    for (int i = 0; i < 5; ++i) add(*file, "zero shift 1", with_error(Pose::Identity()));
    project.spots[0].sigma_mm = 0.07;
    ASSERT_TRUE(file->save(project));
    for (int i = 0; i < 30; ++i) add(*file, "zero shift 1", with_error(Pose::Identity()));
    const auto study = stored_values(*file, "");
    ASSERT_TRUE(study);
    EXPECT_EQ(study->values.type1.size(), 30u);
    ASSERT_EQ(study->source.remarks.size(), 1u);
    EXPECT_THAT(study->source.remarks[0].in(Language::english),
                HasSubstr("another setup than the newest: 5"));
}

TEST_F(Stored, Refusals) {
    auto file = ProjectFile::create(folder / "a.seam", project);
    ASSERT_TRUE(file);
    EXPECT_THAT(stored_values(*file, "").error().sentence(), HasSubstr("no stored run"));
    EXPECT_THAT(stored_values(*file, "nothing").error().sentence(), HasSubstr("\"nothing\""));
    project.regions.push_back(project.regions[0]);
    project.regions[1].id = "other";
    ASSERT_TRUE(file->save(project));
    const auto unnamed = stored_values(*file, "");
    ASSERT_FALSE(unnamed);
    EXPECT_THAT(unnamed.error().sentence(), HasSubstr("--region"));
    EXPECT_EQ(unnamed.error().kind, ErrorKind::usage);
}

}  // namespace
}  // namespace seamwright
