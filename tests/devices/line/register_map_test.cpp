// The table of registers: laws of its layout, known words, and the document that is made of it.

#include "devices/line/register_map.h"

#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>

#include "devices/line/mqtt.h"
#include "tests/devices/line/wait.h"

namespace seamwright {
namespace {

TEST(LineRegisters, LieBesideOneAnotherAndHaveNames) {
    int end = 0;
    std::set<std::string_view> names;
    for (const LineRegister& r : line_registers()) {
        EXPECT_GE(r.address, end) << r.name;
        end = r.address + r.words;
        EXPECT_TRUE(names.insert(r.name).second);
        EXPECT_FALSE(r.help.empty()) << r.name;
        EXPECT_EQ(r.writable(), end <= kLineWords) << r.name;
        EXPECT_EQ(line_may_write(r.address, r.words), r.writable()) << r.name;
        EXPECT_LE(end, kStationWordsEnd);
        const bool two = r.type == RegisterType::uint32 || r.type == RegisterType::int32;
        EXPECT_TRUE(r.type == RegisterType::text || r.words == (two ? 2 : 1)) << r.name;
    }
    end = 0;
    for (const LineRegister& r : line_region_registers()) {
        EXPECT_GE(r.address, end) << r.name;
        end = r.address + r.words;
        EXPECT_TRUE(names.insert(r.name).second);
        EXPECT_FALSE(r.writable());
    }
    EXPECT_LE(end, kRegionStride);
    EXPECT_FALSE(line_may_write(-1, 1));
    EXPECT_FALSE(line_may_write(kLineWords - 1, 2));
    EXPECT_FALSE(line_may_write(0, 0));
}

TEST(LineRegisters, HoldWhatTheStationSays) {
    AllWords words{};
    words[1] = 1;
    LineState state = told_part(70000);
    write_station_words({state, {true, false, true, LineResult::refused, LineAlarm::line_silent}, 0xfffe},
                        words);
    EXPECT_EQ(words[1], 1) << "the line's own";
    EXPECT_EQ(words[100], kLineProtocolVersion);
    EXPECT_EQ(words[101], 0xfffe);
    EXPECT_EQ(words[102], 1);
    EXPECT_EQ(words[103], 0);
    EXPECT_EQ(words[104], 1);
    EXPECT_EQ(words[105], 3);
    EXPECT_EQ(words[106], 34);
    EXPECT_EQ(words[110], 1);  // 70000 = 1 * 65536 + 4464
    EXPECT_EQ(words[111], 4464);
    EXPECT_EQ(words[115], 12345);
    EXPECT_EQ(words[116], 1);
    const auto number = [&](int at) {
        return static_cast<std::int32_t>(std::uint32_t{words[static_cast<std::size_t>(at)]} << 16 |
                                         words[static_cast<std::size_t>(at) + 1]);
    };
    EXPECT_EQ(words[120], 1);
    EXPECT_EQ(number(122), 1235);  // 1.2345 mm to the nearest
    EXPECT_EQ(number(124), -2500);
    EXPECT_EQ(number(126), 0);
    EXPECT_EQ(number(128), -250);
    EXPECT_EQ(number(132), 180000);
    EXPECT_EQ(number(134), 11) << "0.0101 mm: never less than it is";
    EXPECT_EQ(number(140), 1);
    EXPECT_EQ(number(142), 3);
    EXPECT_EQ(words[152], 0) << "no second region";
}

TEST(LineRegisters, WhatIsNoNumberIsSaidSo) {
    LineState state = told_part(1);
    state.regions[0].xyz_mm = {std::nan(""), HUGE_VAL, 3e6};
    state.regions[0].sigma_xyz_mm = {-HUGE_VAL, 0, 0};
    state.regions.resize(20, state.regions[0]);
    state.regions[1].solved = false;
    state.regions[1].passed = false;
    state.seconds = -5;
    AllWords words{};
    write_station_words({state, {}, 0}, words);
    for (const int at : {122, 124, 126, 134, 154, 160, 166}) {
        EXPECT_EQ(words[static_cast<std::size_t>(at)], 0x8000) << at;
        EXPECT_EQ(words[static_cast<std::size_t>(at) + 1], 0) << at;
    }
    EXPECT_EQ(words[152], 2);
    EXPECT_EQ(words[116], kLineRegions) << "no more than there is room for";
    EXPECT_EQ(words[114], 0);
    state.seconds = 1e300;
    write_station_words({state, {}, 0}, words);
}

TEST(LineRegisters, TheLinesWordsAreReadWhateverTheyHold) {
    std::array<std::uint16_t, kLineWords> words{7, 2, 3, 41, 1, 2, 'C' << 8 | 'A', 'R' << 8 | '-', '1' << 8};
    LineWords read = read_line_words(words);
    EXPECT_EQ(read.heartbeat, 7);
    EXPECT_TRUE(read.start);
    EXPECT_EQ(read.part.type, 3);
    EXPECT_EQ(read.part.paint, 41);
    EXPECT_EQ(read.part.number, 65538u);
    EXPECT_EQ(read.part.id(), "CAR-1");
    words[6] = 0;
    EXPECT_EQ(read_line_words(words).part.id(), "65538");
    words.fill(0xffff);
    read = read_line_words(words);
    EXPECT_EQ(read.part.name, std::string(32, '_')) << "no byte of a stranger's comes into the file";
    words.fill(0);
    EXPECT_EQ(read_line_words(words).part.id(), "");
}

TEST(LineRegisters, TheDocumentIsThatOfTheTable) {
    std::ostringstream file;
    file << std::ifstream(SEAMWRIGHT_SOURCE "/devices/line/LINE.md").rdbuf();
    EXPECT_EQ(file.str(), line_document())
        << "write it anew: seamwright line registers > devices/line/LINE.md";
}

TEST(LineRegisters, EveryProtocolDescribesItselfAndRefusesWhatItDoesNotKnow) {
    for (const LineProtocol& p : line_protocols()) {
        EXPECT_FALSE(p.settings().empty());
        for (const char* bad : {R"({"no such": 1})", R"({"port": "1"})", R"({"port": 1.5})",
                                R"({"port": -1})", "[]", R"({"start": "both"})", R"({"password": "x"})"}) {
            const auto link = open_line(std::string(p.name), nlohmann::json::parse(bad), "door");
            ASSERT_FALSE(link) << p.name << bad;
            EXPECT_EQ(link.error().kind, ErrorKind::input) << p.name << bad;
        }
    }
    EXPECT_FALSE(open_line("opc-ua", {}, "door"));
    for (const char* bad : {R"({"listen": "0.0.0.0"})", R"({"listen": "::"})", R"({"listen": "here"})",
                            R"({"line_address": "plc"})"})
        EXPECT_FALSE(open_line("modbus-server", nlohmann::json::parse(bad), "")) << bad;
    for (const char* bad : {"{}", R"({"address": "10.0.0.9", "write_address": 10})",
                            R"({"address": "10.0.0.9", "write_address": 0, "read_address": 531})"})
        EXPECT_FALSE(open_line("modbus-client", nlohmann::json::parse(bad), "")) << bad;
    for (const char* bad : {R"({"tls": true})", R"({"ca_file": "x"})",
                            R"({"password_env": "SEAMWRIGHT_NO_SUCH", "username": "u"})",
                            R"({"password_file": "/no/such"})", R"({"password_env": "PATH"})",
                            R"({"password_env": "PATH", "password_file": "x", "username": "u"})"})
        EXPECT_FALSE(open_line("mqtt", nlohmann::json::parse(bad), "")) << bad;
}

TEST(LineRegisters, CommandsOfABrokerAreReadStrictly) {
    const auto good = read_mqtt_command(
        R"({"id":"7","start":true,"part_type":2,"paint":41,"part_number":815,"part_name":"CAR"})");
    ASSERT_TRUE(good);
    EXPECT_EQ(good->part.type, 2);
    EXPECT_EQ(good->part.paint, 41);
    EXPECT_EQ(*good->start, true);
    EXPECT_FALSE(read_mqtt_command(R"({"id":"8","part_type":2})")->start);
    for (const char* bad : {"",
                            "{}",
                            "[]",
                            "null",
                            "\"start\"",
                            R"({"start":true})",
                            R"({"id":7})",
                            R"({"id":""})",
                            R"({"id":"1","start":1})",
                            R"({"id":"1","start":"true"})",
                            R"({"id":"1","part_type":-1})",
                            R"({"id":"1","part_type":65536})",
                            R"({"id":"1","paint":65536})",
                            R"({"id":"1","paint":"white"})",
                            R"({"id":"1","part_number":1.5})",
                            R"({"id":"1","part_number":4294967296})",
                            R"({"id":"1","part_name":5})",
                            R"({"id":"1","strat":true})",
                            R"({"id":"1","part_type":null})",
                            R"({"id":"1","part_type":1e999})",
                            R"({"id":"1")",
                            "\xff\xfe",
                            R"({"id":"1","id":"2"})"})
        EXPECT_FALSE(read_mqtt_command(bad)) << bad;
    EXPECT_FALSE(read_mqtt_command(std::string(100000, '[')));
    EXPECT_EQ(mqtt_topic("a/b", "STATE", "door #1+"), "seamwright/a_b/STATE/door _1_");
    EXPECT_EQ(topic_level(""), "_");
}

}  // namespace
}  // namespace seamwright
