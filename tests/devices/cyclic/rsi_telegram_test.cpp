#include "devices/kuka/rsi_telegram.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "devices/net/socket.h"

namespace seamwright {
namespace {

// As printed in KUKA's manuals: blanks, line ends, elements that we do not ask for.
constexpr const char* kPublished = R"(<Rob Type="KUKA">
<RIst X="1620.0008" Y="-0.0000" Z="1910.0000" A="0.0000" B="90.0000" C="0.0000"/>
<RSol X="1620.0000" Y="0.0000" Z="1910.0000" A="0.0000" B="90.0000" C="0.0000"/>
<AIPos A1="0.0" A2="-90.0" A3="90.0" A4="0.0" A5="0.0" A6="0.0"/>
<Delay D="3"/>
<Tech C11="0.000000" C12="0.000000" T21="1.09" />
<DiL>5</DiL>
<Digout o1="0" o2="0" o3="0"/>
<IPOC>123645634563</IPOC>
</Rob>)";

TEST(RsiTelegram, ReadsWhatTheManualPrints) {
    const auto rob = parse_rsi_rob(bytes_of(kPublished));
    ASSERT_TRUE(rob) << rob.error().sentence();
    EXPECT_EQ(rob->ipoc, 123645634563u);
    EXPECT_STREQ(rob->ipoc_text.data(), "123645634563");
    EXPECT_EQ(rob->delay, 3u);
    EXPECT_EQ(rob->digital_in, 5);
    ASSERT_TRUE(rob->rist && rob->rsol);
    EXPECT_DOUBLE_EQ(rob->rist->xyzabc[0], 1620.0008);
    EXPECT_DOUBLE_EQ(rob->rsol->xyzabc[4], 90);
    EXPECT_TRUE(rob->rist->usable);
}

TEST(RsiTelegram, OldControllersWriteTypeInCapitalsAndADeclaration) {
    const auto rob =
        parse_rsi_rob(bytes_of("<?xml version='1.0'?><!-- x --><Rob TYPE='KUKA'><IPOC> 0042 </IPOC></Rob>"));
    ASSERT_TRUE(rob) << rob.error().sentence();
    EXPECT_STREQ(rob->ipoc_text.data(), "0042");
    EXPECT_FALSE(rob->rist || rob->rsol || rob->delay);
}

TEST(RsiTelegram, RefusesWhatIsNoTelegram) {
    for (const std::string& text :
         {std::string(), std::string("<Rob>"), std::string("<Rob></Rob>"),
          std::string("<Sen><IPOC>1</IPOC></Sen>"), std::string("<Rob><IPOC>-1</IPOC></Rob>"),
          std::string("<Rob><IPOC>1x</IPOC></Rob>"),
          std::string("<Rob><IPOC>123456789012345678901</IPOC></Rob>"),
          std::string("<Rob><IPOC>1</IPOC><IPOC>2</IPOC></Rob>"),
          std::string("<Rob><RIst X='1'/><IPOC>1</IPOC></Rob>"),
          std::string("<Rob><RIst X='1' X='1' Y='0' Z='0' A='0' B='0' C='0'/><IPOC>1</IPOC></Rob>"),
          std::string("<Rob><RIst X='one' Y='0' Z='0' A='0' B='0' C='0'/><IPOC>1</IPOC></Rob>"),
          std::string("<Rob><Delay D='-1'/><IPOC>1</IPOC></Rob>"),
          std::string("<Rob><a><b></a></b><IPOC>1</IPOC></Rob>"),
          std::string("<Rob><IPOC>1</IPOC></Rob><Rob><IPOC>1</IPOC></Rob>"), std::string(9000, ' ')}) {
        EXPECT_FALSE(parse_rsi_rob(bytes_of(text))) << text.substr(0, 80);
    }
    const std::string whole = kPublished;
    for (std::size_t cut = 0; cut < whole.size(); ++cut)
        EXPECT_FALSE(parse_rsi_rob(bytes_of(whole.substr(0, cut)))) << cut;
}

TEST(RsiTelegram, NumbersThatCannotBeMeantAreMarked) {
    for (const char* x : {"1e9", "nan", "inf", "-1.#INF", "1e999"}) {
        const std::string text =
            std::string("<Rob><RIst X=\"") + x + "\" Y='0' Z='0' A='0' B='0' C='0'/><IPOC>7</IPOC></Rob>";
        const auto rob = parse_rsi_rob(bytes_of(text));
        ASSERT_TRUE(rob) << x;
        EXPECT_FALSE(rob->rist->usable) << x;
    }
}

TEST(RsiTelegram, AnswersAsTheManualPrints) {
    std::array<char, 512> buffer;
    EXPECT_EQ(write_rsi_sen(buffer, "ImFree", {0, -1.5, 0, 0.25, 0, 0}, 4, "123645634563"),
              "<Sen Type=\"ImFree\"><RKorr X=\"0.0000\" Y=\"-1.5000\" Z=\"0.0000\" A=\"0.2500\" B=\"0.0000\" "
              "C=\"0.0000\" /><IPOC>123645634563</IPOC></Sen>");
    EXPECT_EQ(write_rsi_sen(std::span(buffer).first(20), "ImFree", {}, 4, "1"), "");
}

TEST(RsiTelegram, ChangedBytesNeverBreakIt) {
    std::mt19937 random(3);
    for (int i = 0; i < 20000; ++i) {
        std::string text = kPublished;
        for (int k = 0; k < 4; ++k) text[random() % text.size()] = static_cast<char>(random() % 256);
        (void)parse_rsi_rob(bytes_of(text));
    }
}

}  // namespace
}  // namespace seamwright
