// Study values from tables, and Q-DAS files read by a reader that shares nothing with the writer.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>
#include <sstream>

#include "devices/quality/qdas.h"
#include "devices/quality/study_csv.h"

namespace seamwright {
namespace {

using testing::HasSubstr;

TEST(StudyCsv, AnyOrderOfColumnsAndRows) {
    const auto v = parse_study_csv(
        "run,value_mm,extra,part,rehang,reference\n2,1.5,x,\"a,b\",h1,\n\n1,+2,y,B,,1e-1\n", "f");
    ASSERT_TRUE(v) << v.error().sentence();
    ASSERT_EQ(v->size(), 2u);
    EXPECT_EQ((*v)[0].part, "a,b");
    EXPECT_EQ((*v)[0].rehang, "h1");
    EXPECT_EQ((*v)[0].run, 2);
    EXPECT_DOUBLE_EQ((*v)[0].value_mm, 1.5);
    EXPECT_FALSE((*v)[0].reference_mm);
    EXPECT_EQ((*v)[1].rehang, "1");
    EXPECT_DOUBLE_EQ(*(*v)[1].reference_mm, 0.1);
}

TEST(StudyCsv, DecimalCommaAndUnits) {
    for (const char* text :
         {"\xEF\xBB\xBFPart;Rehang;Run;Value [mm]\r\nA;1;1;0,25\r\nA;1;2;-1\r\n",
          "part\trun\tvalue\nA\t1\t0,25\nA\t2\t-1\n", "part;run;value [um]\nA;1;250\nA;2;-1000",
          "part,run,value\nA,1,0.25\nA,2,-1\n"}) {
        const auto v = parse_study_csv(text, "f");
        ASSERT_TRUE(v) << text << v.error().sentence();
        ASSERT_EQ(v->size(), 2u);
        EXPECT_DOUBLE_EQ((*v)[0].value_mm, 0.25) << text;
        EXPECT_DOUBLE_EQ((*v)[1].value_mm, -1) << text;
    }
}

TEST(StudyCsv, HostileTexts) {
    const std::string head = "part,rehang,run,value,reference\n";
    const std::pair<std::string, const char*> cases[] = {
        {"", "empty"},
        {" \n\n", "empty"},
        {head, "no values"},
        {"\xFF\xFEp", "UTF-16"},
        {"part,value\nA,1\n", "no column run"},
        {"teil,hub,lauf,wert\n", "no column part"},
        {"1,2,3,4\n", "no column part"},
        {"part,run,value,value\nA,1,1,1\n", "named twice"},
        {head + "A,1,1,nan,\n", "value is missing"},
        {head + "A,1,1,,\n", "value is missing"},
        {head + "A,1,1,inf,\n", "is missing"},
        {head + "A,1,1,1e999,\n", "no number"},
        {head + "A,1,1,2e6,\n", "beyond 1 km"},
        {head + "A,1,1,0x10,\n", "no number"},
        {head + "A,1,1,abc,\n", "value = \"abc\" is no number"},
        {head + "A,1,1,1,abc\n", "reference = \"abc\" is no number"},
        {head + "A,1,one,1,\n", "run = \"one\" is no whole number"},
        {head + "A,1,1.5,1,\n", "whole number"},
        {head + ",1,1,1,\n", "the part is missing"},
        {head + "A,1,1,1,\nA,1,1,2,\n", "line 3: part A, rehang 1, run 1 stands in line 2 already"},
        {head + "A,1,1,1\n", "has 4 fields where the header names 5"},
        {head + "A,1,1,0,5,0,5\n", "decimal points"},
        {"part;run;value\nA;1;0,5\nA;2;0.5\n", "decimal comma"},
        {"part,run,value\nA,1,\"0,5\"\n", "decimal points"},
        {"part,run,value [bar]\nA,1,1\n", "no unit of length"},
        {"part,run,value [deg]\nA,1,1\n", "no unit of length"},
        {std::string("part,run,value\nA,1,\0\n", 21), "no number"},
    };
    for (const auto& [text, part] : cases) {
        const auto v = parse_study_csv(text, "f.csv");
        ASSERT_FALSE(v) << text;
        EXPECT_EQ(v.error().kind, ErrorKind::input) << text;
        EXPECT_THAT(v.error().sentence(), HasSubstr(part)) << text;
        EXPECT_EQ(v.error().sentence().find('\n'), std::string::npos);
    }
}

// A reader of K-fields: key, characteristic, text. A value begins with each K0001.
struct Dfq {
    std::map<std::string, std::string> fields;
    std::vector<std::map<std::string, std::string>> values;
};
Dfq read_dfq(const std::string& text) {
    Dfq dfq;
    std::istringstream in(text);
    std::string line;
    while (std::getline(in, line)) {
        EXPECT_EQ(line.back(), '\r');
        line.pop_back();
        const auto blank = line.find(' ');
        EXPECT_EQ(line[0], 'K') << line;
        const std::string key = line.substr(0, line.find_first_of(" /")), content = line.substr(blank + 1);
        EXPECT_EQ(key.size(), 5u) << line;
        if (key == "K0001") dfq.values.emplace_back();
        const bool of_value = key < "K0100";
        auto& into = of_value ? dfq.values.back() : dfq.fields;
        EXPECT_TRUE(into.emplace(key, content).second) << line;
        const bool of_characteristic = of_value || key >= "K2000";
        EXPECT_EQ(line.compare(5, 2, "/1") == 0, of_characteristic) << line;
    }
    return dfq;
}

TEST(Qdas, ReadBackByAnotherReader) {
    QdasStudy study;
    study.part_number = "T\xC3\xBCr 7\nK0001/1 99";
    study.part_name = "door \xE2\x82\xAC left";
    study.gauge_number = "0001";
    study.gauge_name = "Seamwright S";
    study.machine_number = "0002";
    study.characteristic_number = "left";
    study.characteristic_name = "deviation across the bead, spot S1, binormal";
    study.nominal_mm = 0;
    study.lower_mm = -0.5;
    study.upper_mm = 0.5;
    study.values = {{"P 1", "1", 1, 0.12345678, {}, "2024-05-01T12:34:56.789Z"},
                    {"P 2", "2", 2, -0.5, {}, ""},
                    {"P\x14 3", "2", 3, 1e-9, {}, "yesterday, at about noon"}};
    const Dfq dfq = read_dfq(dfq_text(study));
    EXPECT_EQ(dfq.fields.at("K0100"), "1");
    EXPECT_EQ(dfq.fields.at("K1001"), "T\xFCr 7 K0001/1 99");
    EXPECT_EQ(dfq.fields.at("K1002"), "door ? left");
    EXPECT_EQ(dfq.fields.at("K1081"), "0002");
    EXPECT_EQ(dfq.fields.count("K1082"), 0u);
    EXPECT_EQ(dfq.fields.at("K2002"), study.characteristic_name);
    EXPECT_DOUBLE_EQ(std::stod(dfq.fields.at("K2101")), 0);
    EXPECT_DOUBLE_EQ(std::stod(dfq.fields.at("K2110")), -0.5);
    EXPECT_DOUBLE_EQ(std::stod(dfq.fields.at("K2111")), 0.5);
    EXPECT_EQ(dfq.fields.at("K2142"), "mm");
    EXPECT_EQ(dfq.fields.at("K2401"), "0001");
    ASSERT_EQ(dfq.values.size(), 3u);
    EXPECT_NEAR(std::stod(dfq.values[0].at("K0001")), 0.12345678, 5e-5);
    EXPECT_EQ(dfq.values[0].at("K0004"), "01.05.2024/12:34:56");
    EXPECT_EQ(dfq.values[0].at("K0014"), "P 1");
    EXPECT_EQ(dfq.values[1].at("K0006"), "2");
    EXPECT_EQ(dfq.values[1].count("K0004"), 0u);
    EXPECT_EQ(dfq.values[2].count("K0004"), 0u);
    EXPECT_EQ(dfq.values[2].at("K0014"), "P  3");
    EXPECT_EQ(dfq.values[2].at("K0002"), "0");
}

}  // namespace
}  // namespace seamwright
