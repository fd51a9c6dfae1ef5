#include "devices/genicam/gvcp.h"

#include <gtest/gtest.h>

#include <cstring>

#include "devices/genicam/genicam_settings.h"

namespace seamwright {
namespace {

std::vector<std::byte> ack() {
    std::vector<std::byte> a(256);
    const auto put = [&](std::size_t at, std::initializer_list<int> values) {
        for (int v : values) a[at++] = static_cast<std::byte>(v);
    };
    put(0, {0x00, 0x00, 0x00, 0x03, 0x00, 0xF8, 0x12, 0x34});
    put(8 + 0x24, {192, 168, 1, 20});
    std::memcpy(a.data() + 8 + 0x48, "Baumer", 6);
    std::memcpy(a.data() + 8 + 0x68, "VCXG-25M", 8);
    std::memcpy(a.data() + 8 + 0xD8,
                "700\x01"
                "1234567890123",
                16);
    return a;
}

TEST(Gvcp, DiscoveryBytes) {
    const auto command = discovery_command(0x1234);
    const unsigned char expected[] = {0x42, 0x01, 0x00, 0x02, 0x00, 0x00, 0x12, 0x34};
    EXPECT_EQ(std::memcmp(command.data(), expected, 8), 0);
    const auto camera = parse_discovery_ack(ack(), 0x1234);
    ASSERT_TRUE(camera) << camera.error().sentence();
    EXPECT_EQ(camera->vendor, "Baumer");
    EXPECT_EQ(camera->model, "VCXG-25M");
    EXPECT_EQ(camera->address, "192.168.1.20");
    EXPECT_EQ(camera->serial, "700?123456789012");  // fills its field, no zero byte at the end
    EXPECT_FALSE(parse_discovery_ack(ack(), 0x1235));
    for (std::size_t size = 0; size < 256; ++size)
        EXPECT_FALSE(parse_discovery_ack(std::span<const std::byte>(ack()).first(size), 0x1234)) << size;
    auto refused = ack();
    refused[0] = std::byte{0x80};
    EXPECT_FALSE(parse_discovery_ack(refused, 0x1234));
    auto other = ack();
    other[3] = std::byte{0x81};
    EXPECT_FALSE(parse_discovery_ack(other, 0x1234));
}

TEST(GenicamSettings, RefusesWhatItDoesNotKnow) {
    const auto sentence = [](const char* text) {
        const auto s = parse_genicam_settings(nlohmann::json::parse(text));
        return s ? std::string("accepted") : s.error().sentence();
    };
    EXPECT_EQ(sentence(R"({"serial": "1"})"), "accepted");
    EXPECT_NE(sentence(R"({})").find("no camera is named"), std::string::npos);
    EXPECT_NE(sentence(R"({"serial": "1", "exposure": 3})").find("settings.exposure"), std::string::npos);
    EXPECT_NE(sentence(R"({"serial": 1})").find("settings.serial"), std::string::npos);
    EXPECT_NE(sentence(R"({"serial": "1", "exposure_us": "long"})").find("settings.exposure_us"),
              std::string::npos);
    EXPECT_NE(sentence(R"({"serial": "1", "buffers": 2.5})").find("settings.buffers"), std::string::npos);
    EXPECT_NE(sentence(R"({"serial": "1", "buffers": 100000})").find("settings.buffers"), std::string::npos);
    EXPECT_NE(sentence(R"({"serial": "1", "region": {"w": 1}})").find("settings.region.w"),
              std::string::npos);
    EXPECT_NE(sentence(R"({"serial": "1", "features": {"Gain": [1]}})").find("settings.features.Gain"),
              std::string::npos);
    EXPECT_NE(sentence(R"({"serial": "1", "range": {"z_scale_mm": 0}})").find("z_scale_mm"),
              std::string::npos);
    EXPECT_NE(sentence(R"({"serial": "1", "hardware_trigger": true, "trigger": "free"})").find("contradicts"),
              std::string::npos);
    EXPECT_NE(sentence("[]").find("object"), std::string::npos);
    EXPECT_EQ(parse_genicam_settings({{"serial", "1"}, {"hardware_trigger", true}})->trigger, "Line1");
}

}  // namespace
}  // namespace seamwright
