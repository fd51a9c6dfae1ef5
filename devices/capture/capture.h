#pragma once
// One frame as it is kept: with a run in a project, and in a recorded capture.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/profile/profile.h"
#include "devices/frame.h"

namespace seamwright {

// A raw camera image with its own pixels, rows packed without gaps; depths as in StripeImage.
struct StoredImage {
    int width = 0, height = 0, bit_depth = 8;
    std::vector<std::byte> pixels;  // [height * width * bytes per pixel]
    StripeImage view() const;
};
StoredImage keep_image(const StripeImage& image);

// Raw: what the sensor gave, before tracking and filtering. A profile sensor leaves `profile` (no segments);
// a camera leaves `candidates` (peaks in millimetres) and, where asked, the image. A damaged frame of a run
// leaves only its status.
struct Capture {
    std::string spot_id, sensor_id;
    FrameStatus status = FrameStatus::ok;
    std::uint64_t sequence = 0;
    std::int64_t device_time_ns = 0, host_time_ns = 0;
    std::optional<Pose> base_from_flange;  // as reported for this trigger; absent = the taught pose is taken
    Profile profile;
    ProfileCandidates candidates;
    std::optional<StoredImage> image;
};

// The wall clock for records: ISO 8601 with milliseconds.
std::string utc_now();
// Seconds since 1970 of such a text, its fraction dropped; nothing where it is none: another form, a date
// that does not exist. A date without a time is its midnight.
std::optional<std::int64_t> utc_seconds(const std::string& utc);

}  // namespace seamwright
