// Profiles as blocks of bytes.

#include <gtest/gtest.h>

#include "devices/capture/profile_blob.h"
#include "tests/projects/file/kill_test.h"
#include "tests/projects/sample_project.h"

namespace seamwright {
namespace {

TEST(ProfileBlob, PacksToAboutOneMebibyte) {
    SampleMaker make(5);
    std::vector<Capture> captures;
    for (int i = 0; i < 300; ++i) {
        Capture c;
        c.spot_id = "S" + std::to_string(i);
        c.profile = make.profile(1000, false);
        captures.push_back(c);
    }
    auto blobs = pack_captures(captures);
    ASSERT_TRUE(blobs);
    EXPECT_GT(blobs->size(), 3u);
    std::vector<Capture> again;
    for (const CaptureBlob& blob : *blobs) {
        EXPECT_LT(blob.bytes.size(), kCaptureBlobBytes + 20000);
        ASSERT_TRUE(unpack_captures(blob.bytes, "blob", again));
    }
    ASSERT_EQ(again.size(), captures.size());
    for (std::size_t i = 0; i < again.size(); ++i) EXPECT_TRUE(same_bits(again[i], captures[i]));
}

// Forged blobs with a right checksum: lengths must be held against what is there.
TEST(ProfileBlob, ForgedLengthsAreRefused) {
    SampleMaker make(6);
    const Capture capture = make.image_capture("S1", 40);
    const auto blobs = pack_captures(std::span(&capture, 1));
    ASSERT_TRUE(blobs);
    const std::vector<std::byte> good = blobs->front().bytes;
    std::mt19937 rng(8);
    int refused = 0;
    for (int i = 0; i < 3000; ++i) {
        std::vector<std::byte> bad = good;
        if (i % 3 == 0) bad.resize(16 + rng() % (bad.size() - 16));
        for (int k = 0; k < 2 && i % 3; ++k) {
            const std::size_t at = 16 + rng() % std::min<std::size_t>(bad.size() - 16, 200);
            const std::uint32_t value = rng() % 2 ? 0xffffffffu : rng();
            std::memcpy(bad.data() + at, &value, std::min<std::size_t>(4, bad.size() - at));
        }
        set_blob_checksum(bad);
        std::vector<Capture> out;
        if (!unpack_captures(bad, "forged", out)) ++refused;
    }
    EXPECT_GT(refused, 1500);
}

}  // namespace
}  // namespace seamwright
