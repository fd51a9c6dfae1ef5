// KUKAVARPROXY's bytes as clients and servers in the field write them.

#include "devices/kuka/kvp_message.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace seamwright {
namespace {

using testing::HasSubstr;
using namespace std::string_literals;

// id 48, read $OV_PRO; and its answer "100", as py_openshowvar prints it: (48, 6, 0, 3, '100', 00 01 01).
const std::string kReadOverride = "\x00\x30\x00\x0a\x00\x00\x07$OV_PRO"s;
const std::string kOverrideIs100 =
    "\x00\x30\x00\x06\x00\x00\x03"
    "100\x00\x01\x01"s;
// id 67, write $OV_PRO = 100.
const std::string kWriteOverride =
    "\x00\x43\x00\x0f\x01\x00\x07$OV_PRO\x00\x03"
    "100"s;

TEST(KvpMessage, WritesTheKnownBytes) {
    EXPECT_EQ(kvp_bytes(KvpRequest{48, false, "$OV_PRO", ""}), kReadOverride);
    EXPECT_EQ(kvp_bytes(KvpRequest{67, true, "$OV_PRO", "100"}), kWriteOverride);
    EXPECT_EQ(kvp_bytes(KvpAnswer{48, false, "100", true}), kOverrideIs100);
}

TEST(KvpMessage, ReadsAnswersInAnyPieces) {
    const std::string refused = "\x00\x31\x00\x03\x01\x00\x00\x00\x00\x00"s;
    const std::string status_counted = "\x00\x32\x00\x0a\x00\x00\x04TRUE\x00\x01\x01"s;
    const std::string bytes = kOverrideIs100 + refused + status_counted;
    for (std::size_t piece : {std::size_t{1}, std::size_t{5}, bytes.size()}) {
        std::string stream;
        std::vector<KvpAnswer> answers;
        for (std::size_t at = 0; at < bytes.size(); at += piece) {
            stream += bytes.substr(at, piece);
            for (;;) {
                auto answer = take_kvp_answer(stream);
                ASSERT_TRUE(answer) << answer.error().sentence();
                if (!*answer) break;
                answers.push_back(**answer);
            }
        }
        ASSERT_EQ(answers.size(), 3u) << piece;
        EXPECT_EQ(answers[0].id, 48);
        EXPECT_EQ(answers[0].value, "100");
        EXPECT_TRUE(answers[0].done);
        EXPECT_EQ(answers[1].id, 49);
        EXPECT_TRUE(answers[1].write);
        EXPECT_FALSE(answers[1].done);
        EXPECT_EQ(answers[2].value, "TRUE");
        EXPECT_TRUE(answers[2].done);
        EXPECT_TRUE(stream.empty());
    }
}

TEST(KvpMessage, RefusesLengthsThatContradict) {
    for (std::string stream :
         {"\x00\x01\xff\xff\x00\x00\x01"s, "\x00\x01\x00\x06\x00\x00\x09"s, "\x00\x01\x00\x02\x00\x00\x00"s})
        EXPECT_FALSE(take_kvp_answer(stream));
    for (std::string stream : {"\x00\x01\x00\x05\x00\x00\x07$OV_PRO"s,
                               "\x00\x01\x00\x06\x01\x00\x01X\x00\x09"s, "\x00\x01\x00\x04\x01\x00\x01X"s})
        EXPECT_FALSE(take_kvp_request(stream));
}

TEST(KvpMessage, RequestsComeBackAsWritten) {
    std::string stream = kReadOverride + kWriteOverride;
    auto read = take_kvp_request(stream);
    ASSERT_TRUE(read && *read);
    EXPECT_EQ((*read)->name, "$OV_PRO");
    EXPECT_FALSE((*read)->write);
    auto write = take_kvp_request(stream);
    ASSERT_TRUE(write && *write);
    EXPECT_EQ((*write)->value, "100");
    EXPECT_TRUE(stream.empty());
}

TEST(KrlValues, FramesInEveryForm) {
    for (const char* text : {"{X 1.5, Y -2.0, Z 3.0, A 10.0, B 0.0, C 0.0}",
                             "{FRAME: X 1.5, Y -2.0, Z 3.0, A 10.0, B 0.0, C 0.0}",
                             "{E6POS: X 1.5, Y -2.0, Z 3.0, A 10.0, B 0.0, C 0.0, S 2, T 35, E1 0.0, E2 0.0}",
                             " {C 0.0,B 0.0,A 10.0,Z 3.0,Y -2.0,X 1.5}\r\n"}) {
        auto pose = frame_from_krl(text);
        ASSERT_TRUE(pose) << text << ": " << pose.error().sentence();
        EXPECT_EQ(pose->translation(), Eigen::Vector3d(1.5, -2, 3));
        EXPECT_NEAR(angle_rad(*pose, Pose::Identity()), 10 * kPi / 180, 1e-12);
    }
    const Pose pose = make_pose(rotation_exp({1, -2, 0.5}), {1234.56789, -0.001, 99999});
    EXPECT_LT(distance_mm(*frame_from_krl(krl_from_frame(pose)), pose), 1e-5);
    EXPECT_LT(angle_rad(*frame_from_krl(krl_from_frame(pose)), pose), 1e-7);
}

TEST(KrlValues, RefusesWhatIsNoFrame) {
    for (const char* text : {"", "{", "{}", "X 1", "{X 1.5, Y -2.0, Z 3.0, A 10.0, B 0.0}",
                             "{X 1, X 1, Y 2, Z 3, A 0, B 0, C 0}", "{X nan, Y 2, Z 3, A 0, B 0, C 0}",
                             "{X inf, Y 2, Z 3, A 0, B 0, C 0}", "{X 1e9, Y 2, Z 3, A 0, B 0, C 0}",
                             "{X 1;5, Y 2, Z 3, A 0, B 0, C 0}", "{X 1, Y 2, Z 3, A 400, B 0, C 0}"})
        EXPECT_FALSE(frame_from_krl(text)) << text;
}

TEST(KrlValues, PlainTypes) {
    EXPECT_EQ(bool_from_krl("TRUE"), true);
    EXPECT_EQ(bool_from_krl(" FALSE\r\n"), false);
    EXPECT_FALSE(bool_from_krl("1"));
    EXPECT_EQ(int_from_krl(" 17 "), 17);
    EXPECT_FALSE(int_from_krl("17.5"));
    EXPECT_FALSE(int_from_krl(""));
    EXPECT_FALSE(int_from_krl("99999999999999999999"));
    EXPECT_EQ(string_from_krl("\"CAR-1\""), "CAR-1");
    EXPECT_EQ(string_from_krl("#EX"), "#EX");
    EXPECT_EQ(krl_from_string("a\"b"), "\"a'b\"");
}

}  // namespace
}  // namespace seamwright
