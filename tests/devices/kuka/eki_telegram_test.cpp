// Telegrams as a controller writes them, in any pieces, and what must not pass for one.

#include "devices/kuka/eki_telegram.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

namespace seamwright {
namespace {

using testing::HasSubstr;

// As EthernetKRL sends it: line breaks, elements with a closing tag, an XML declaration now and then.
const std::string kTrigger =
    "<Robot Kind=\"trigger\" Id=\"17\" Name=\"S4\" Part=\"\" Mode=\"#EX\" Text=\"\">\r\n"
    "  <Pos X=\"1234.5678\" Y=\"-20.000000\" Z=\"900.1\" A=\"12.5\" B=\"-4.25\" "
    "C=\"178.0\"></Pos>\r\n</Robot>\r\n";

std::string changed(std::string text, const std::string& from, const std::string& to) {
    const auto at = text.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return text.replace(at, from.size(), to);
}

TEST(EkiTelegramTest, ReadsWhatAControllerWrites) {
    for (const std::string& text : {kTrigger, "<?xml version=\"1.0\"?>\n" + kTrigger}) {
        auto t = parse_eki_telegram(text);
        ASSERT_TRUE(t) << t.error().sentence();
        EXPECT_EQ(t->kind, "trigger");
        EXPECT_EQ(t->id, 17);
        EXPECT_EQ(t->name, "S4");
        EXPECT_EQ(t->mode, "#EX");
        EXPECT_EQ(t->pose.translation(), Eigen::Vector3d(1234.5678, -20, 900.1));
        // R = Rz(A) Ry(B) Rx(C), written out.
        const double d = kPi / 180;
        const Eigen::Matrix3d r = (Eigen::AngleAxisd(12.5 * d, Eigen::Vector3d::UnitZ()) *
                                   Eigen::AngleAxisd(-4.25 * d, Eigen::Vector3d::UnitY()) *
                                   Eigen::AngleAxisd(178.0 * d, Eigen::Vector3d::UnitX()))
                                      .toRotationMatrix();
        EXPECT_TRUE(t->pose.linear().isApprox(r, 1e-12));
    }
}

TEST(EkiTelegramTest, NumbersInEveryFormOfADecimal) {
    for (const char* form : {"+1234.5678", "1.2345678e3", "1.2345678E+03", "1234.56780000"}) {
        const auto t = parse_eki_telegram(changed(kTrigger, "1234.5678", form));
        ASSERT_TRUE(t) << form << ": " << t.error().sentence();
        EXPECT_DOUBLE_EQ(t->pose.translation().x(), 1234.5678) << form;
    }
    for (const char* form : {"+-1", "+", "++1", "1 2", "0x10"})
        EXPECT_FALSE(parse_eki_telegram(changed(kTrigger, "1234.5678", form))) << form;
}

TEST(EkiTelegramTest, RefusesWhatIsNone) {
    const std::vector<std::pair<std::string, std::string>> bad = {
        {"", "no XML"},
        {"<Robot", "no XML"},
        {changed(kTrigger, "</Pos>", ""), "no XML"},
        {changed(changed(kTrigger, "<Robot", "<Sensor"), "</Robot", "</Sensor"), "root"},
        {changed(kTrigger, "Kind=\"trigger\"", ""), "Kind"},
        {changed(kTrigger, "Name=\"S4\"", ""), "Name"},
        {changed(kTrigger, "Id=\"17\"", ""), "Id"},
        {changed(kTrigger, "\"17\"", "\"-1\""), "Id"},
        {changed(kTrigger, "\"17\"", "\"17x\""), "Id"},
        {changed(kTrigger, "\"17\"", "\"99999999999999999999\""), "Id"},
        {changed(kTrigger, "X=\"1234.5678\"", ""), "Pos/X"},
        {changed(kTrigger, "1234.5678", ""), "Pos/X"},
        {changed(kTrigger, "1234.5678", "12,5"), "Pos/X"},
        {changed(kTrigger, "1234.5678", "nan"), "no position of a robot"},
        {changed(kTrigger, "1234.5678", "inf"), "no position of a robot"},
        {changed(kTrigger, "1234.5678", "1e9"), "no position of a robot"},
        {changed(kTrigger, "178.0", "361"), "no position of a robot"}};
    for (const auto& [text, word] : bad) {
        auto t = parse_eki_telegram(text);
        ASSERT_FALSE(t) << text;
        EXPECT_THAT(t.error().sentence(), HasSubstr(word)) << text;
        EXPECT_EQ(t.error().kind, ErrorKind::device);
    }
}

TEST(EkiTelegramTest, WritingAndReadingAreInverse) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> unit(-1, 1);
    for (int i = 0; i < 200; ++i) {
        EkiTelegram t{.kind = "write", .id = i, .name = "BASE \"<&'> left", .text = "grün"};
        t.pose = make_pose(rotation_exp(kPi * Eigen::Vector3d(unit(random), unit(random), unit(random))),
                           9000 * Eigen::Vector3d(unit(random), unit(random), unit(random)));
        auto back = parse_eki_telegram(write_eki("Robot", t));
        ASSERT_TRUE(back) << back.error().sentence();
        EXPECT_EQ(back->name, t.name);
        EXPECT_EQ(back->text, t.text);
        EXPECT_LT(distance_mm(back->pose, t.pose), 1e-5);
        EXPECT_LT(angle_rad(back->pose, t.pose), 1e-7);
    }
}

TEST(EkiSplitterTest, CutsTheStreamWhateverItsPieces) {
    const std::string stream = kTrigger + std::string(1, '\0') + changed(kTrigger, "S4", "S5") + kTrigger;
    for (std::size_t piece : {std::size_t{1}, std::size_t{7}, std::size_t{150}, stream.size()}) {
        EkiSplitter splitter("Robot");
        std::vector<std::string> names;
        std::string document;
        for (std::size_t at = 0; at < stream.size(); at += piece) {
            ASSERT_TRUE(splitter.add(std::string_view(stream).substr(at, piece)));
            while (splitter.next(document)) names.push_back(parse_eki_telegram(document).value().name);
        }
        EXPECT_THAT(names, testing::ElementsAre("S4", "S5", "S4")) << piece;
        EXPECT_FALSE(splitter.in_the_middle());
    }
}

// XML 1.0, production 42: blanks may stand before the '>'.
TEST(EkiSplitterTest, TheEndingTagMayHoldBlanks) {
    const std::string one = kTrigger.substr(0, kTrigger.find("</Robot>") + 8);
    const std::string blank = changed(one, "</Robot>", "</Robot\r\n >"),
                      other = changed(one, "</Robot>", "<Robots></Robots></Robot\t>");
    const std::string stream = blank + other + one;
    for (std::size_t piece : {std::size_t{1}, stream.size()}) {
        EkiSplitter splitter("Robot");
        std::vector<std::string> documents;
        std::string document;
        for (std::size_t at = 0; at < stream.size(); at += piece) {
            ASSERT_TRUE(splitter.add(std::string_view(stream).substr(at, piece)));
            while (splitter.next(document)) documents.push_back(document);
        }
        EXPECT_THAT(documents, testing::ElementsAre(blank, other, one)) << piece;
        EXPECT_FALSE(splitter.in_the_middle());
    }
}

TEST(EkiSplitterTest, AnEndlessDocumentIsRefusedNotKept) {
    EkiSplitter splitter("Robot");
    const std::string chunk(1000, 'x');
    Expected<void> added;
    int chunks = 0;
    for (; chunks < 100 && added; ++chunks) added = splitter.add(chunk);
    EXPECT_FALSE(added);
    EXPECT_LT(chunks, 12);
}

TEST(EkiModeTest, KnowsKukasModesAlone) {
    EXPECT_EQ(mode_from_eki("#T1"), RobotMode::manual_reduced);
    EXPECT_EQ(mode_from_eki("#T2"), RobotMode::manual_full);
    EXPECT_EQ(mode_from_eki("#AUT"), RobotMode::automatic);
    EXPECT_EQ(mode_from_eki("#EX"), RobotMode::external);
    EXPECT_FALSE(mode_from_eki("#T3"));
    EXPECT_FALSE(mode_from_eki(""));
}

}  // namespace
}  // namespace seamwright
