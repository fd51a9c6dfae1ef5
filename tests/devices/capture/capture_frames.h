#pragma once
// Frames with everything in them that a capture must keep, and what counts as equal: every bit.

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <limits>
#include <string>

#include "devices/capture/recorder.h"
#include "tests/devices/temporary_folder.h"

namespace seamwright::capture_test {

// A file's path in a folder that the program takes with it when it ends; nothing is there.
inline std::filesystem::path fresh_path(const std::string& name) {
    static const TemporaryFolder folder;
    const auto path = folder.path() / name;
    std::filesystem::remove(path);
    std::filesystem::remove(path.string() + "-journal");
    return path;
}

// Frame n of a made-up sensor: profile with holes, one value that only bits can tell (a signalling NaN's
// payload), every third frame damaged, every fourth with a pose, every fifth taken for a spot.
inline void fill(Frame& frame, std::uint64_t n, std::size_t points = 64) {
    frame.status = n % 3 == 2 ? static_cast<FrameStatus>(1 + n % 2) : FrameStatus::ok;
    frame.sequence = n;
    frame.device_time_ns = static_cast<std::int64_t>(1'000'000 * n + 7);
    frame.host_time_ns = static_cast<std::int64_t>(5'000'000'000 + 1'000'000 * n);
    frame.base_from_flange.reset();
    if (n % 4 == 0) {
        Pose pose = Pose::Identity();
        pose.translation() = Eigen::Vector3d(0.1 * static_cast<double>(n), -3, 1.0 / 3);
        frame.base_from_flange = pose;
    }
    frame.spot_id = n % 5 == 0 ? "S" + std::to_string(n / 5 % 3) : "";
    frame.profile.clear();
    for (std::size_t i = 0; i < points; ++i) {
        frame.profile.x_mm.push_back(0.1 * static_cast<double>(i) + (n % 7 == 0 ? 0.01 : 0.0));
        frame.profile.z_mm.push_back(300 + std::sin(0.01 * static_cast<double>(i * n)));
        frame.profile.intensity.push_back(static_cast<float>(i) / 3);
    }
    if (points > 3) {
        frame.profile.z_mm[1] = std::numeric_limits<double>::quiet_NaN();
        frame.profile.z_mm[2] = std::bit_cast<double>(0x7ff8000000001234ull);
        frame.profile.x_mm[2] = std::bit_cast<double>(0xfff800000000beefull);
        frame.profile.z_mm[3] = -0.0;
    }
}

template <class T>
bool same_bits(const std::vector<T>& a, const std::vector<T>& b) {
    return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0);
}

// `recorded` is a Frame or a Capture.
template <class Recorded>
void expect_same(const Recorded& recorded, const Frame& frame) {
    EXPECT_EQ(recorded.status, frame.status) << frame.sequence;
    EXPECT_EQ(recorded.sequence, frame.sequence);
    EXPECT_EQ(recorded.device_time_ns, frame.device_time_ns);
    EXPECT_EQ(recorded.spot_id, frame.spot_id);
    ASSERT_EQ(recorded.base_from_flange.has_value(), frame.base_from_flange.has_value()) << frame.sequence;
    if (frame.base_from_flange) {
        EXPECT_EQ(recorded.base_from_flange->matrix(), frame.base_from_flange->matrix());
    }
    EXPECT_TRUE(same_bits(recorded.profile.x_mm, frame.profile.x_mm)) << frame.sequence;
    EXPECT_TRUE(same_bits(recorded.profile.z_mm, frame.profile.z_mm)) << frame.sequence;
    EXPECT_TRUE(same_bits(recorded.profile.intensity, frame.profile.intensity)) << frame.sequence;
    EXPECT_TRUE(same_bits(recorded.profile.segment, frame.profile.segment)) << frame.sequence;
}

// A capture of `frames` frames of source "A", and of "B" when `second`.
inline std::filesystem::path make_capture(const std::string& name, std::uint64_t frames, bool second = false,
                                          const RecorderOptions& options = {}) {
    const auto path = fresh_path(name);
    auto recorder = Recorder::create(path, options);
    EXPECT_TRUE(recorder) << (recorder ? "" : recorder.error().sentence());
    const auto a = (*recorder)->add_sensor("A", {"test", "maker", "model A", "1"});
    EXPECT_TRUE(a);
    std::int64_t b = 0;
    if (second) b = *(*recorder)->add_sensor("B", {"test", "maker", "model B", "2"});
    Frame frame;
    for (std::uint64_t n = 0; n < frames; ++n) {
        fill(frame, n);
        (*recorder)->frame(*a, frame);
        if (second) {
            fill(frame, n + 1000);
            frame.host_time_ns -= 1'000'000'000;
            (*recorder)->frame(b, frame);
        }
    }
    const auto done = (*recorder)->finish();
    EXPECT_TRUE(done) << (done ? "" : done.error().sentence());
    return path;
}

}  // namespace seamwright::capture_test
