// The tables that describe the drivers' settings, and the reader that they feed.
#include "devices/exchange/settings.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <set>
#include <sstream>

#include "devices/registry.h"

namespace seamwright {
namespace {

const SettingTable& sample() {
    static const SettingTable table = entry::joined(
        {entry::text("address", "127.0.0.1", "of it"), entry::whole("port", 7000, 1, 65535, "of it"),
         entry::number("speed_mm_s", nullptr, 0.5, 10, "of it"),
         entry::choice("mode", {"slow", "fast"}, "of it"), entry::yes_no("loop", true, "or not"),
         entry::object("region", {entry::whole("x", 3, 0, 9, "first")}, "part")},
        entry::reconnect(1, 100, 500, "retry_ms", "retry_most_ms"));
    return table;
}

struct Values {
    std::string address, mode;
    int port = 0, x = 0, reconnect_ms = 0, reconnect_most_ms = 0;
    double speed = 4;
    bool loop = false;
};

Expected<Values> read(const nlohmann::json& json) {
    Values v;
    SettingsReader f(json, "settings", sample());
    f.text("address", v.address);
    f.whole("port", v.port);
    f.number("speed_mm_s", v.speed);
    f.text("mode", v.mode);
    f.truth("loop", v.loop);
    f.object("region", [&](SettingsReader& r) { r.whole("x", v.x); });
    f.whole("reconnect_ms", v.reconnect_ms);
    f.whole("reconnect_most_ms", v.reconnect_most_ms);
    if (f.failed()) return tl::unexpected(f.error());
    return v;
}

TEST(Settings, WhatIsAbsentHasTheTablesDefault) {
    const auto v = read(nlohmann::json::object());
    ASSERT_TRUE(v) << v.error().sentence();
    EXPECT_EQ(v->address, "127.0.0.1");
    EXPECT_EQ(v->port, 7000);
    EXPECT_EQ(v->speed, 4) << "the table has none";
    EXPECT_EQ(v->mode, "slow");
    EXPECT_TRUE(v->loop);
    EXPECT_EQ(v->reconnect_ms, 100);
    EXPECT_EQ(v->reconnect_most_ms, 500);
}

TEST(Settings, FormerNamesAreStillRead) {
    const auto v = read({{"retry_ms", 20}, {"reconnect_most_ms", 70}});
    ASSERT_TRUE(v) << v.error().sentence();
    EXPECT_EQ(v->reconnect_ms, 20);
    EXPECT_EQ(v->reconnect_most_ms, 70);
    EXPECT_FALSE(read({{"retry_ms", 20}, {"reconnect_ms", 30}}));
}

TEST(Settings, WhatIsWrongIsRefusedWithItsPlace) {
    const std::pair<nlohmann::json, const char*> wrong[] = {{{{"adress", "x"}}, "settings.adress"},
                                                            {{{"port", 0}}, "settings.port"},
                                                            {{{"reconnect_ms", 0}}, "settings.reconnect_ms"},
                                                            {{{"port", 1e99}}, "settings.port"},
                                                            {{{"port", 7.5}}, "settings.port"},
                                                            {{{"port", "7000"}}, "settings.port"},
                                                            {{{"port", nullptr}}, "settings.port"},
                                                            {{{"speed_mm_s", 0.4}}, "settings.speed_mm_s"},
                                                            {{{"mode", "Fast"}}, "settings.mode"},
                                                            {{{"mode", 1}}, "settings.mode"},
                                                            {{{"loop", 1}}, "settings.loop"},
                                                            {{{"region", 1}}, "settings.region"},
                                                            {{{"region", {{"y", 1}}}}, "settings.region.y"},
                                                            {{{"region", {{"x", 10}}}}, "settings.region.x"},
                                                            {nlohmann::json::array(), "settings"}};
    for (const auto& [json, where] : wrong) {
        const auto v = read(json);
        ASSERT_FALSE(v) << json;
        EXPECT_EQ(v.error().where, where) << json;
        EXPECT_EQ(v.error().kind, ErrorKind::input);
    }
}

void expect_sound(const SettingTable& table, const std::string& where) {
    std::set<std::string> names;
    for (const SettingInfo& s : table) {
        const std::string at = where + "." + s.name;
        EXPECT_TRUE(names.insert(s.name).second) << at << " is there twice";
        EXPECT_TRUE(s.former.empty() || names.insert(s.former).second) << at;
        EXPECT_FALSE(s.help.empty()) << at;
        const bool numeric = s.kind == SettingKind::number || s.kind == SettingKind::whole;
        if (numeric) {
            EXPECT_LT(s.low, s.high) << at;
            if (s.otherwise.is_number()) {
                EXPECT_GE(s.otherwise.get<double>(), s.low) << at;
                EXPECT_LE(s.otherwise.get<double>(), s.high) << at;
            }
        }
        EXPECT_TRUE(s.kind != SettingKind::choice || s.choices.size() >= 2) << at;
        expect_sound(s.fields, at);
    }
}

TEST(Settings, EveryDriverDescribesItself) {
    for (const SensorDriver& d : sensor_drivers()) {
        EXPECT_FALSE(d.settings().empty()) << d.name;
        expect_sound(d.settings(), std::string(d.name));
    }
    for (const RobotDriver& d : robot_drivers()) {
        EXPECT_FALSE(d.settings().empty()) << d.name;
        expect_sound(d.settings(), std::string(d.name));
    }
    EXPECT_FALSE(driver_text("no such"));
    EXPECT_THAT(*driver_text("kuka-eki"), testing::HasSubstr("robot_address"));
}

// One thing has one name in all brands.
TEST(Settings, TheBackOffIsCalledTheSameEverywhere) {
    for (const RobotDriver& d : robot_drivers())
        for (const SettingInfo& s : d.settings()) {
            EXPECT_EQ(s.name.find("backoff"), std::string::npos) << d.name;
            EXPECT_EQ(s.name.find("retry"), std::string::npos) << d.name;
        }
}

TEST(Settings, TheDocumentIsThatOfTheTables) {
    std::ostringstream file;
    file << std::ifstream(SEAMWRIGHT_SOURCE "/devices/SETTINGS.md").rdbuf();
    EXPECT_EQ(file.str(), settings_document())
        << "write it anew: seamwright devices --help all > devices/SETTINGS.md";
}

// What check_settings() says is what a reader of every field says.
TEST(Settings, AreCheckedAsTheyAreRead) {
    for (const char* text :
         {"{}", R"({"port": 1})", R"({"port": 0})", R"({"port": 1.5})", R"({"port": "1"})",
          R"({"speed_mm_s": 20})", R"({"mode": "fast"})", R"({"mode": "idle"})", R"({"loop": 1})",
          R"({"region": {"x": 10}})", R"({"region": {"y": 1}})", R"({"region": 3})", R"({"other": 1})",
          R"({"retry_ms": 5})", R"({"retry_ms": 5, "reconnect_ms": 6})", "[]", "3"}) {
        const auto json = nlohmann::json::parse(text);
        const auto checked = check_settings(json, "settings", sample());
        const auto values = read(json);
        ASSERT_EQ(checked.has_value(), values.has_value()) << text;
        if (!checked) {
            EXPECT_EQ(checked.error().sentence(), values.error().sentence());
        }
    }
}

}  // namespace
}  // namespace seamwright
