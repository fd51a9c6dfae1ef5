#pragma once
// Profiles and captures as bytes: exact, versioned, little endian, checked.
//
// Blob: "SWPB" | u16 version = 1 | u16 record kind (1 profile, 2 capture, 3 frame) | u32 records
//       | u32 crc32 of the payload | payload
// Profile: u32 points | u8 columns (1 intensity, 2 segment) | x f64[n] | z f64[n] | [intensity f32[n]]
//          | [segment i32[n]]
// Capture: spot id, sensor id (u16 length + UTF-8 each) | u8 frame status | u64 sequence | i64 device time ns
//          | i64 host time ns | u8 pose present | [matrix rows 0..2 row-major f64[12]] | profile
//          | u32 lines | u8 per line | [per line: u8 count, then count * (x f64, z f64, intensity f32)]
//          The image of a project's capture is not in here, see project_file.h.
// Frame:   capture | u8 image present | [u32 width | u32 height | u8 bit depth | rows without gaps]
//          In a frame's profile, column bit 4 says that x equals that of the profile before in this blob, bit
//          for bit, and is left out: a sensor that samples on a fixed grid repeats it thousands of times.
// Reading never trusts a length: every size is held against what is left of the blob before memory is taken.

#include <cstddef>
#include <span>
#include <vector>

#include "core/error.h"
#include "devices/capture/capture.h"

namespace seamwright {

// Error: columns of different length.
Expected<std::vector<std::byte>> pack_profile(const Profile& profile);
Expected<Profile> unpack_profile(std::span<const std::byte> blob, const std::string& where);

// Packs captures in order into blobs that are closed as soon as they reach `target_bytes`.
inline constexpr std::size_t kCaptureBlobBytes = 1u << 20;
struct CaptureBlob {
    int captures = 0;
    std::vector<std::byte> bytes;
};
// Error: columns of different length, ids over 64 KiB, more than 65536 lines or 64 candidates a line.
Expected<std::vector<CaptureBlob>> pack_captures(std::span<const Capture> captures,
                                                 std::size_t target_bytes = kCaptureBlobBytes);
// Appends to `captures`.
Expected<void> unpack_captures(std::span<const std::byte> blob, const std::string& where,
                               std::vector<Capture>& captures);

// A blob of frames in the making, for a recorder: appended one at a time into memory that is kept.
class FrameBlock {
  public:
    FrameBlock() { clear(); }
    void clear();
    // Error: as of pack_captures, or an image whose rows are shorter than its width. Nothing is appended
    // then.
    Expected<void> append(const Frame& frame, const ProfileCandidates* candidates, bool with_image);
    std::size_t bytes() const { return blob_.size(); }
    int frames() const { return frames_; }
    // Fills in the header. Valid until the next append() or clear().
    std::span<const std::byte> finish();

  private:
    std::vector<std::byte> blob_;
    int frames_ = 0;
    std::vector<double> last_x_mm_;
};
// What append() adds at most.
std::size_t frame_record_bytes(const Frame& frame, const ProfileCandidates* candidates, bool with_image);
// Appends to `captures`; `sensor_id` of each is empty.
Expected<void> unpack_frames(std::span<const std::byte> blob, const std::string& where,
                             std::vector<Capture>& captures);

}  // namespace seamwright
