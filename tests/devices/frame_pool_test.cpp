#include <gtest/gtest.h>

#include <random>
#include <thread>

#include "devices/frame.h"
#include "tests/allocations.h"

namespace seamwright {
namespace {

TEST(FramePool, CountsAndRefusesWhenEmpty) {
    FramePool pool(3);
    EXPECT_EQ(pool.size(), 3U);
    std::vector<FramePtr> held;
    for (int i = 0; i < 3; ++i) held.push_back(pool.acquire());
    for (const auto& f : held) EXPECT_NE(f, nullptr);
    EXPECT_EQ(pool.free(), 0U);
    EXPECT_EQ(pool.acquire(), nullptr);
    held.pop_back();
    EXPECT_EQ(pool.free(), 1U);
    EXPECT_NE(pool.acquire(), nullptr);
}

TEST(FramePool, AFrameComesBackCleanButKeepsItsMemory) {
    FramePool pool(1);
    const std::byte* memory = nullptr;
    {
        const FramePtr f = pool.acquire();
        f->status = FrameStatus::corrupt;
        f->sequence = 7;
        f->device_time_ns = f->host_time_ns = 9;
        f->base_from_flange = Pose::Identity();
        f->spot_id = "S1";
        f->pixels.resize(100000);
        memory = f->pixels.data();
        f->image = {memory, 100, 1000, 100, 8};
        f->profile.x_mm = f->profile.z_mm = {1, 2};
    }
    const FramePtr f = pool.acquire();
    EXPECT_EQ(f->status, FrameStatus::ok);
    EXPECT_EQ(f->sequence, 0U);
    EXPECT_EQ(f->device_time_ns, 0);
    EXPECT_EQ(f->host_time_ns, 0);
    EXPECT_FALSE(f->base_from_flange);
    EXPECT_TRUE(f->spot_id.empty());
    EXPECT_TRUE(f->image.empty());
    EXPECT_EQ(f->profile.size(), 0U);
    EXPECT_EQ(f->pixels.data(), memory);
}

TEST(FramePool, AllocatesNothingWhenWarm) {
    FramePool pool(4);
    for (int i = 0; i < 8; ++i) pool.acquire()->pixels.resize(1 << 16);
    std::vector<FramePtr> held;
    held.reserve(4);
    for (int i = 0; i < 4; ++i) held.push_back(pool.acquire());
    for (const auto& f : held) f->pixels.resize(1 << 16);
    held.clear();
    const long before = allocations_so_far();
    for (int round = 0; round < 1000; ++round) {
        for (int i = 0; i < 3; ++i) {
            held.push_back(pool.acquire());
            held.back()->pixels.resize(1 << 16);
        }
        held.clear();
    }
    EXPECT_EQ(allocations_so_far(), before);
}

TEST(FramePool, FramesOutliveTheirPool) {
    FramePtr f;
    std::weak_ptr<Frame> watch;
    {
        FramePool pool(2);
        f = pool.acquire();
        f->spot_id = "still here";
        watch = f;
    }
    EXPECT_EQ(f->spot_id, "still here");
    f.reset();
    EXPECT_TRUE(watch.expired());
}

TEST(FramePool, AWeakPointerKeepsTheSlotFromReuse) {
    FramePool pool(1);
    FramePtr f = pool.acquire();
    std::weak_ptr<Frame> watch = f;
    f.reset();
    EXPECT_TRUE(watch.expired());
    EXPECT_EQ(pool.acquire(), nullptr);
    watch.reset();
    EXPECT_NE(pool.acquire(), nullptr);
}

TEST(FramePool, ThreadsNeverShareAFrame) {
    FramePool pool(5);
    std::atomic<long> got = 0, refused = 0, clashes = 0;
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t) {
        threads.emplace_back([&, t] {
            std::mt19937 rng(static_cast<unsigned>(t));
            std::vector<FramePtr> held;
            for (int i = 0; i < 5000; ++i) {
                if (FramePtr f = pool.acquire()) {
                    ++got;
                    f->sequence = static_cast<std::uint64_t>(t) * 1000000 + static_cast<std::uint64_t>(i);
                    held.push_back(f);
                } else {
                    ++refused;
                }
                if (!held.empty() && (held.size() > 2 || rng() % 2)) {
                    if (held.front()->sequence / 1000000 != static_cast<std::uint64_t>(t)) ++clashes;
                    held.erase(held.begin());
                }
            }
        });
    }
    threads.clear();
    EXPECT_EQ(clashes, 0);
    EXPECT_EQ(got + refused, 20000);
    EXPECT_GT(got, 0);
    EXPECT_EQ(pool.free(), 5U);
}

}  // namespace
}  // namespace seamwright
