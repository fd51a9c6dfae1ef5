#pragma once
// What a sensor hands over: one frame, from a fixed pool.

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/geometry/pose.h"
#include "core/profile/profile.h"
#include "core/profile/stripe/stripe_image.h"

namespace seamwright {

// Only `ok` may be measured; everything else is counted and reported.
enum class FrameStatus { ok, incomplete, corrupt, late };
std::string_view to_string(FrameStatus status);

// Every frame carries an image, a finished profile, or both (a profile sensor with its raw image switched
// on).
struct Frame {
    FrameStatus status = FrameStatus::ok;
    std::uint64_t sequence = 0;            // counts up by 1 at the source; a gap is a lost frame
    std::int64_t device_time_ns = 0;       // the device's clock, 0 where it has none
    std::int64_t host_time_ns = 0;         // steady clock at arrival
    std::optional<Pose> base_from_flange;  // where the robot stood, if the source knows
    std::string spot_id;                   // the spot it was triggered for, if the source knows
    std::vector<std::byte> pixels;  // owned image data (capacity is kept when the buffer returns to the pool)
    StripeImage image;              // view into `pixels`; empty() when there is none
    Profile profile;                // size() == 0 when there is none
};

// A fixed number of frames. acquire() answers nullptr when none is free: the source then drops its frame and
// counts it as an underrun. Frames return to the pool when their last FramePtr goes; the pool may go before
// its frames. Thread-safe.
using FramePtr = std::shared_ptr<Frame>;
class FramePool {
  public:
    explicit FramePool(std::size_t size);
    FramePtr acquire();
    std::size_t size() const;
    std::size_t free() const;

  private:
    struct State;
    std::shared_ptr<State> state_;
};

}  // namespace seamwright
