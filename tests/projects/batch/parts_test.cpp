// What was computed in parts is what was computed at once, to the bit; a part that is none is refused.

#include "projects/batch/parts.h"

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <limits>
#include <random>

namespace seamwright {
namespace {

using nlohmann::json;

struct Value {
    double number = 0;
    bool yes = false;
    std::vector<double> list;
    std::optional<Eigen::Vector3d> place;
    bool operator==(const Value& o) const {
        return std::bit_cast<std::uint64_t>(number) == std::bit_cast<std::uint64_t>(o.number) &&
               yes == o.yes && list == o.list && place == o.place;
    }
};

void hand_over(PartValue& part, Value& v) {
    part(v.number);
    part(v.yes);
    part.list(v.list, [&](double& x) { part(x); });
    part.maybe(v.place, [&](Eigen::Vector3d& m) { part.matrix(m); });
}

Value made(std::size_t loop, std::size_t i) {
    std::mt19937_64 rng(1000 * loop + i);
    Value v;
    const double odd[] = {0.1 + static_cast<double>(i), -0.0, std::numeric_limits<double>::infinity(),
                          std::numeric_limits<double>::quiet_NaN(), 5e-324};
    v.number = odd[rng() % 5];
    v.yes = rng() % 2 == 0;
    for (std::size_t k = rng() % 4; k > 0; --k)
        v.list.push_back(std::ldexp(1.0, -static_cast<int>(rng() % 900)) / 3);
    if (rng() % 2 == 0) v.place = Eigen::Vector3d(1e300, -1.0 / 3, static_cast<double>(i));
    return v;
}

// Loops of 10, 0, 1 and 7 values.
std::vector<std::vector<Value>> computed(Parts* parts, std::size_t& counted) {
    std::vector<std::vector<Value>> all;
    std::size_t loop = 0;
    for (const std::size_t count : {10, 0, 1, 7}) {
        std::vector<Value> values(count);
        std::vector<std::size_t> mine(count);
        for (std::size_t i = 0; i < count; ++i) mine[i] = i;
        if (parts) mine = parts->begin(count);
        for (const std::size_t i : mine) values[i] = made(loop, i);
        counted += parts ? parts->end([&](PartValue& part, std::size_t i) { hand_over(part, values[i]); },
                                      mine.size())
                         : mine.size();
        all.push_back(std::move(values));
        ++loop;
    }
    return all;
}

std::vector<json> parts_of(int of) {
    std::vector<json> parts;
    for (int k = 0; k < of; ++k) {
        Parts part(Portion{k, of});
        std::size_t counted = 0;
        computed(&part, counted);
        parts.push_back(json::parse(part.json().dump()));  // as through a file
    }
    return parts;
}

TEST(Parts, TogetherAreTheWholeToTheBit) {
    std::size_t once = 0;
    const auto whole = computed(nullptr, once);
    for (const int of : {1, 2, 3, 8, 25}) {
        auto collected = Parts::collected(parts_of(of));
        ASSERT_TRUE(collected) << collected.error().sentence();
        std::size_t counted = 0;
        EXPECT_EQ(computed(&*collected, counted), whole) << of;
        EXPECT_EQ(counted, once);
        EXPECT_TRUE(collected->check());
    }
}

TEST(Parts, DamagedOrForeignOnesAreRefused) {
    const auto refused = [](const std::vector<json>& parts) {
        auto collected = Parts::collected(parts);
        if (!collected) return true;
        std::size_t counted = 0;
        computed(&*collected, counted);
        return !collected->check();
    };
    const std::vector<json> good = parts_of(3);
    EXPECT_FALSE(refused(good));
    EXPECT_TRUE(refused({good[0], good[1]}));
    EXPECT_TRUE(refused({good[0], good[2], good[1]}));
    EXPECT_TRUE(refused({good[0], good[1], nullptr}));
    EXPECT_TRUE(refused({}));
    std::mt19937 rng(5);
    int changed = 0;
    for (int i = 0; i < 300; ++i) {
        // Something of the structure is taken away or is another number: never a crash; what is left out is noticed.
        std::vector<json> bad = good;
        json& loops = bad[rng() % 3]["loops"];
        json& loop = loops[rng() % loops.size()];
        json& values = loop["values"];
        switch (rng() % 5) {
            case 0:
                loops.erase(rng() % loops.size());
                break;
            case 1:
                loop["of"] = 1'000'000'000'000;
                break;
            case 2:
                loop.erase("values");
                break;
            case 3:
                if (values.empty()) continue;
                values.erase(rng() % values.size());
                break;
            default:
                if (values.empty()) continue;
                values[rng() % values.size()].erase(0);
        }
        ++changed;
        EXPECT_TRUE(refused(bad)) << json(bad).dump().substr(0, 300);
    }
    EXPECT_GT(changed, 200);
}

TEST(Parts, APortionIsReadAsItIsWritten) {
    for (const char* good : {"0/1", "3/8", "999/1000"}) {
        const auto p = portion_from(good, "--task");
        ASSERT_TRUE(p) << good;
        EXPECT_EQ(to_string(*p), good);
    }
    for (const char* bad : {"", "3", "8/8", "-1/8", "1/0", "1/8x", "a/b", "1/", "/8", "1/99999999999999"})
        EXPECT_FALSE(portion_from(bad, "--task")) << bad;
}

}  // namespace
}  // namespace seamwright
