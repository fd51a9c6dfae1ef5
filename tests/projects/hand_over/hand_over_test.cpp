#include "projects/hand_over/hand_over.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <regex>
#include <set>

#include "projects/proof/known_shift.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

using testing::HasSubstr;
using testing::Not;

std::string report_of(const ProjectFile& file, const Project& project, Language language) {
    Facts facts;
    EXPECT_TRUE(gather(file, facts));
    HandOverOptions options;
    options.language = language;
    options.now_utc = "2024-06-01T12:34:00.000Z";
    options.program = "Seamwright 9";
    const auto page = hand_over_report(file, project, facts, options);
    EXPECT_TRUE(page) << page.error().sentence();
    return page->html();
}

class HandOver : public testing::Test {
  protected:
    TemporaryFolder folder;
    Project project = sample_project();
    void SetUp() override {
        project.calibrations[0].result = {
            {"reason", "fits well"},
            {"per_pose",
             {{{"id", "p1"}, {"rms_mm", 0.02}, {"used", true}},
              {{"id", "p2"}, {"rms_mm", 0.4}, {"used", false}}}},
            {"parameters", {{{"name", "radius"}, {"value", 12.7}, {"sigma", 0.003}, {"unit", "mm"}}}},
            {"hold_out", {{"folds", 5}, {"rms_mm", 0.031}}}};
        project.regions[0].limits.translation_mm = 7.25;
    }
};

TEST_F(HandOver, HoldsAllThatAHandOverNeeds) {
    auto file = ProjectFile::create(folder / "door.seam", project).value();
    FrozenContour frozen;
    frozen.spot_id = "S1";
    frozen.status = AlignmentStatus::frozen;
    frozen.expected_error_mm = 0.0123;
    frozen.offsets = {{-1, 0.01, 0, 0, 0, true}, {1, 0.02, 0, 0, 0, true}};
    ZeroShift zero;
    zero.runs = {1, 2, 3};
    zero.regions = {{"edge", {0.0111, 0, 0, 0, 0, 0}, {}, {}, 0.0444}};
    KnownShift known;
    known.range_mm = 10, known.range_deg = 1;
    ShiftTest test;
    test.amount = 10;
    test.regions = {{"edge", true, 0.1, {0.0301, -0.0602}, ""}};
    known.tests = {test};
    for (const auto& what :
         std::vector<decltype(Evidence::what)>{frozen, zero, known, HeadlessRun{4, "c", true, "pc"}})
        ASSERT_TRUE(file.append_evidence({0, {}, 0, what}, project));
    ASSERT_TRUE(file.append_event({0, {}, 0, EventKind::alarm, "R1", "cable <loose>"}));
    const std::string html = report_of(file, project, Language::english);
    for (const char* part : {"Hand-over report",
                             "2024-06-01 12:34",
                             "Seamwright 9",
                             "0001",
                             "0002",
                             "C1, in use at sensor A",
                             "fits well",
                             "Residual per pose",
                             "0.031",
                             "Spot S1: reference profile",
                             "Spot S1: drift over the travel",
                             "0.012",
                             "Predicted 3 sigma mm",
                             "0.044",
                             "-0.0602",
                             "7.25",
                             "BASE_DATA[7]",
                             "cable &lt;loose&gt;",
                             "Signature",
                             "pushed and read back"})
        EXPECT_THAT(html, HasSubstr(part));
    for (const char* outside : {"src=", "href=", "url(", "<script"})
        EXPECT_THAT(html, Not(HasSubstr(outside)));
}

TEST_F(HandOver, SaysWhatIsMissingAndWhatIsStale) {
    auto file = ProjectFile::create(folder / "door.seam", project).value();
    std::string html = report_of(file, project, Language::english);
    EXPECT_THAT(html, HasSubstr("not complete"));
    EXPECT_THAT(html, HasSubstr("not proven"));
    ZeroShift zero;
    zero.runs = {1, 2, 3};
    ASSERT_TRUE(file.append_evidence({0, "2024-05-05T10:00:00.000Z", 0, zero}, project));
    Project changed = project;
    changed.spots[0].weights.x() = 0.25;
    html = report_of(file, changed, Language::english);
    EXPECT_THAT(html, HasSubstr("the project was changed since 2024-05-05 10:00"));
}

TEST_F(HandOver, SpeaksGerman) {
    auto file = ProjectFile::create(folder / "door.seam", project).value();
    const std::string html = report_of(file, project, Language::german);
    for (const char* word :
         {"lang=\"de\"", "Übergabebericht", "Messstelle", "Unterschrift", "nicht nachgewiesen"})
        EXPECT_THAT(html, HasSubstr(word));
    for (const char* word : {"Hand-over report", "Signature", "not proven"})
        EXPECT_THAT(html, Not(HasSubstr(word)));
}

}  // namespace
}  // namespace seamwright
