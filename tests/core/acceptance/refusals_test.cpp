// What no study is made of: one sentence, kind input.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/acceptance/correlation.h"
#include "core/acceptance/linearity.h"
#include "core/acceptance/process_uncertainty.h"
#include "core/acceptance/stability.h"
#include "core/acceptance/type1.h"
#include "core/acceptance/type3.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

template <class T>
void refused(const Expected<T>& answer, const char* part) {
    ASSERT_FALSE(answer) << part;
    EXPECT_EQ(answer.error().kind, ErrorKind::input);
    EXPECT_THAT(answer.error().sentence(), HasSubstr(part));
}

TEST(AcceptanceRefusals, Type1) {
    const std::vector<double> v{1, 2, 3};
    for (const double t : {0.0, -1.0, kNan, std::numeric_limits<double>::infinity()})
        refused(type1_study(v, 0, {t}), "tolerance");
    refused(type1_study(v, 0, {1, 0}), "share");
    refused(type1_study(v, 0, {1, 0.2, -6}), "width");
    refused(type1_study(v, kNan, {1}), "not finite");
    refused(type1_study(std::vector<double>{1, kNan}, 0, {1}), "not finite");
    refused(type1_study(std::vector<double>{}, 0, {1}), "0 value");
    refused(type1_study(std::vector<double>{1}, 0, {1}), "1 value");
    refused(type1_study(std::vector<double>(30, 0.1), 0, {1}), "all values are equal");
}

TEST(AcceptanceRefusals, Type3) {
    const auto value = [](const char* part, const char* rehang, long run, double v) {
        return StudyValue{part, rehang, run, v, {}, {}};
    };
    using Values = std::vector<StudyValue>;
    refused(type3_study(Values{}, {1}), "0 part");
    refused(type3_study(Values{value("A", "1", 1, 1), value("A", "1", 2, 2)}, {1}), "1 part");
    refused(type3_study(Values{value("A", "1", 1, 1), value("B", "1", 1, 2)}, {1}), "measured once");
    refused(type3_study(Values{value("A", "1", 1, 1), value("A", "1", 2, 1), value("B", "1", 1, 2)}, {1}),
            "runs");
    refused(type3_study(Values{value("A", "1", 1, 1), value("A", "2", 1, 1), value("B", "1", 1, 2)}, {1}),
            "hung");
    refused(type3_study(Values{value("A", "1", 1, 1), value("A", "1", 2, 1), value("B", "1", 1, 2),
                               value("B", "1", 2, 2)},
                        {1}),
            "all equal");
    refused(type3_study(Values{value("A", "1", 1, kNan), value("A", "1", 2, 1)}, {1}), "not finite");
    refused(type3_study(Values{value("A", "1", 1, 1)}, {0}), "tolerance");
}

TEST(AcceptanceRefusals, LinearityCorrelationStabilityVda5) {
    const auto value = [](const char* part, long run, double v, std::optional<double> reference) {
        return StudyValue{part, "1", run, v, reference, {}};
    };
    using Values = std::vector<StudyValue>;
    refused(linearity_study(Values{value("A", 1, 1, {})}), "no reference");
    refused(linearity_study(Values{value("A", 1, 1, 1), value("A", 2, 1.1, 1), value("A", 3, 1.2, 1)}),
            "1 different");
    refused(linearity_study(Values{value("A", 1, 1, 1), value("B", 1, 2, 2), value("C", 1, 3, 3)}),
            "exactly");
    refused(correlation_study(Values{value("A", 1, 1, 1), value("B", 1, 2, 2)}), "2 part");
    refused(correlation_study(Values{value("A", 1, 1, 1), value("B", 1, 2, 1), value("C", 1, 3, 1)}),
            "references are all equal");
    refused(stability_study(std::vector<Subgroup>{}), "0 subgroup");
    refused(stability_study(std::vector<Subgroup>{{1, {1, 2}}, {2, {1}}}), "subgroup of run 2");
    refused(stability_study(std::vector<Subgroup>{{1, {1, kNan}}, {2, {1, 2}}}), "not finite");
    refused(stability_study(std::vector<Subgroup>{{1, {1, 1}}, {2, {2, 2}}}), "tell nothing");
    ProcessSettings settings;
    settings.upper_mm = 1;
    refused(process_uncertainty(Values{value("A", 1, 1, 1)}, {}, settings), "often enough");
    settings.upper_mm = -1;
    refused(process_uncertainty(Values{value("A", 1, 1, 1)}, {}, settings), "tolerance");
}

}  // namespace
}  // namespace seamwright
