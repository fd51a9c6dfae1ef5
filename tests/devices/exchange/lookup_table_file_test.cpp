#include "devices/exchange/lookup_table_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "devices/exchange/files.h"
#include "tests/devices/temporary_folder.h"

namespace seamwright {
namespace {

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

LookupTable table() {
    return {0.5, -2, 8, 4, 3, 2, {1, 2.25, kNaN, -4e-9, 5e8, 6}, {7, 8, kNaN, 10, 11, 1.0 / 3}};
}

// The bytes with a check sum that fits again.
std::string sealed(std::string bytes) {
    bytes.resize(bytes.size() - 4);
    const auto crc = crc32_z(0, reinterpret_cast<const Bytef*>(bytes.data()), bytes.size());
    for (int i = 0; i < 4; ++i) bytes.push_back(static_cast<char>((crc >> (8 * i)) & 0xff));
    return bytes;
}

std::string replaced(std::string bytes, const std::string& from, const std::string& to) {
    const auto at = bytes.find(from);
    EXPECT_NE(at, std::string::npos) << from;
    return sealed(bytes.replace(at, from.size(), to));
}

TEST(LookupTableFile, ComesBackBitForBit) {
    const TemporaryFolder folder;
    const auto path = folder.path() / "sensor.lut";
    ASSERT_TRUE(write_lookup_table(path, table()));
    const auto back = read_lookup_table(path);
    ASSERT_TRUE(back) << back.error().sentence();
    const LookupTable t = table();
    EXPECT_EQ(back->u0, t.u0);
    EXPECT_EQ(back->v0, t.v0);
    EXPECT_EQ(back->step_u, t.step_u);
    EXPECT_EQ(back->step_v, t.step_v);
    ASSERT_EQ(back->columns, t.columns);
    ASSERT_EQ(back->rows, t.rows);
    for (std::size_t i = 0; i < 6; ++i) {
        EXPECT_EQ(std::isnan(back->x_mm[i]), i == 2);
        if (i == 2) continue;
        EXPECT_EQ(back->x_mm[i], t.x_mm[i]);
        EXPECT_EQ(back->z_mm[i], t.z_mm[i]);
    }
}

TEST(LookupTableFile, IsTheDocumentedFormat) {
    const auto bytes = lookup_table_bytes(table());
    ASSERT_TRUE(bytes);
    const std::string header =
        R"({"format":"seamwright-lookup-table","version":1,"u0":0.5,"v0":-2.0,"step_u":8.0,"step_v":4.0,"columns":3,"rows":2})"
        "\n";
    ASSERT_EQ(bytes->substr(0, header.size()), header);
    ASSERT_EQ(bytes->size(), header.size() + 12 * 8 + 4);
    // 2.25 = 0x4002000000000000, little-endian, is the second number; z starts at the seventh.
    EXPECT_EQ(bytes->substr(header.size() + 8, 8), std::string("\0\0\0\0\0\0\x02\x40", 8));
    double z0 = 0;
    std::memcpy(&z0, bytes->data() + header.size() + 6 * 8, 8);
    if constexpr (std::endian::native == std::endian::little) {
        EXPECT_EQ(z0, 7);
    }
    EXPECT_EQ(sealed(*bytes), *bytes);
}

TEST(LookupTableFile, RefusesDamageOfEveryByte) {
    const auto bytes = lookup_table_bytes(table());
    ASSERT_TRUE(bytes);
    ASSERT_TRUE(parse_lookup_table(*bytes, "a"));
    for (std::size_t i = 0; i < bytes->size(); ++i) {
        std::string damaged = *bytes;
        damaged[i] = static_cast<char>(damaged[i] ^ 0x10);
        EXPECT_FALSE(parse_lookup_table(damaged, "a")) << i;
        EXPECT_FALSE(parse_lookup_table(bytes->substr(0, i), "a")) << i;
    }
    EXPECT_FALSE(parse_lookup_table(*bytes + "x", "a"));
}

TEST(LookupTableFile, RefusesHostileHeaders) {
    const auto bytes = lookup_table_bytes(table());
    ASSERT_TRUE(bytes);
    EXPECT_TRUE(parse_lookup_table(sealed(*bytes), "a"));
    for (const auto& [from, to] : std::vector<std::pair<std::string, std::string>>{
             {"\"columns\":3", "\"columns\":300000000"},
             {"\"columns\":3", "\"columns\":-3"},
             {"\"columns\":3", "\"columns\":1e300"},
             {"\"columns\":3", "\"columns\":3.5"},
             {"\"columns\":3", "\"columns\":\"3\""},
             {"\"columns\":3", "\"columns\":null"},
             {"\"columns\":3", "\"columns\":6"},
             {"\"rows\":2", "\"rows\":1"},
             {"\"rows\":2", "\"rows\":2,\"rows\":2"},
             {"\"rows\":2", "\"rows\":2,\"more\":2"},
             {"\"step_u\":8.0", "\"step_u\":0"},
             {"\"step_u\":8.0", "\"step_u\":-8"},
             {"\"step_u\":8.0", "\"step_u\":1e999"},
             {"\"version\":1", "\"version\":2"},
             {"seamwright-lookup-table", "something"},
             {"{\"format\"", "[\"format\""},
         }) {
        const auto r = parse_lookup_table(replaced(*bytes, from, to), "a.lut");
        ASSERT_FALSE(r) << to;
        EXPECT_EQ(r.error().kind, ErrorKind::input);
        EXPECT_THAT(r.error().sentence(), testing::HasSubstr("a.lut")) << to;
    }
    EXPECT_FALSE(parse_lookup_table("", "a"));
    EXPECT_FALSE(parse_lookup_table(std::string(100000, '{'), "a"));
    EXPECT_FALSE(parse_lookup_table(std::string(100000, '\n'), "a"));
    const TemporaryFolder folder;
    EXPECT_EQ(read_lookup_table(folder.path() / "none").error().kind, ErrorKind::file);
    EXPECT_EQ(read_lookup_table(folder.path()).error().kind, ErrorKind::file);
}

TEST(LookupTableFile, RefusesTablesThatAreNone) {
    const auto refused = [](auto change) {
        LookupTable t = table();
        change(t);
        return !lookup_table_bytes(t);
    };
    EXPECT_TRUE(refused([](LookupTable& t) { t.columns = 4; }));
    EXPECT_TRUE(refused([](LookupTable& t) { t.rows = 0; }));
    EXPECT_TRUE(refused([](LookupTable& t) { t.columns = t.rows = 1 << 30; }));
    EXPECT_TRUE(refused([](LookupTable& t) { t.step_v = 0; }));
    EXPECT_TRUE(refused([](LookupTable& t) { t.u0 = kNaN; }));
    EXPECT_TRUE(refused([](LookupTable& t) { t.x_mm[0] = INFINITY; }));
    EXPECT_TRUE(refused([](LookupTable& t) { t.x_mm[0] = kNaN; }));  // half a hole
    EXPECT_TRUE(refused([](LookupTable& t) { t.z_mm.pop_back(); }));
    EXPECT_FALSE(refused([](LookupTable&) {}));
}

}  // namespace
}  // namespace seamwright
