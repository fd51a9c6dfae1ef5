#pragma once
// Which frame is which: counting frames across wraps of the camera's number, and telling which frame answers
// which software trigger. Pure logic, no camera, no clock.

#include <cstdint>
#include <deque>
#include <optional>
#include <string>
#include <vector>

namespace seamwright {

// Frame numbers of a camera to a sequence that counts up by 1. GigE Vision 1 counts 1..65535 and then 1 again
// (0 is no frame; some cameras send it all the same), GigE Vision 2 and USB3 Vision count 64 bits. A number
// that goes back by less than half the 16-bit circle is a frame out of order, not a wrap.
//
// GigE Vision lets the number begin at 1 with the stream, so a first frame that begins a little later shows how many
// before it were lost. A camera that counts on from one stream to the next, against the standard, is known by that;
// a number far off tells nothing.
class FrameCounter {
  public:
    // Sequence of the frame with that number. The first frame after restart() follows the highest so far, and
    // those that were lost before it.
    std::uint64_t sequence(std::uint64_t frame_id);
    // `from_one`: the numbers of what follows begin at 1.
    void restart(bool from_one = false);
    bool fresh() const { return !last_id_; }                   // no frame since restart()
    std::uint64_t lost_at_start() const { return at_start_; }  // before the first since restart()
    // Sequence of a frame without number, that comes now.
    std::uint64_t unnumbered() const { return fresh() && any_ ? highest_ + 1 : highest_; }

  private:
    std::optional<std::uint64_t> last_id_;  // of the highest sequence
    std::optional<std::uint64_t> before_;   // last_id_ of the stream before
    bool from_one_ = false, counts_anew_ = false;
    std::uint64_t at_start_ = 0;
    std::uint64_t highest_ = 0;
    bool any_ = false;
};

// Software triggers and their frames. Every trigger that the camera takes uses up one frame number, so order
// and number say which frame is whose, even when frames between got lost; the camera's time stamps must
// agree. Where they do not, where a trigger stays without a frame, or where a frame is too damaged to tell,
// nothing is guessed: from then on no frame is given a spot until the acquisition was begun anew (restart()),
// which makes sure that no old frame can come any more.
class TriggerPairing {
  public:
    // After a new acquisition: nothing outstanding.
    void restart();
    // May another trigger be sent? The first after restart() must be answered before the second, since only
    // then the camera's numbers and clock are known.
    bool ready() const { return !lost_track_ && (anchor_ || waiting_.empty()); }
    bool lost_track() const { return lost_track_; }
    // Trigger sent between these two instants (host clock). begin() first, since the frame may be faster than
    // the camera's answer to the command.
    void begin(std::string spot_id, std::int64_t before_ns);
    void sent(std::int64_t after_ns);
    void cancel();  // the camera refused the last one

    enum class Verdict { paired, unprompted, late };
    struct Answer {
        Verdict verdict = Verdict::unprompted;
        std::string spot_id;
    };
    // `device_ns` 0: unknown (no clock, or the packet with the time got lost).
    Answer arrived(std::uint64_t sequence, std::int64_t device_ns, std::int64_t host_ns);
    // Triggers older than this stay without a frame: their spots.
    std::vector<std::string> expire(std::int64_t sent_before_ns);
    std::size_t outstanding() const { return waiting_.size(); }
    std::uint64_t unanswered() const { return unanswered_; }
    // The exposure changed, and with it the delay between trigger and time stamp.
    void forget_clock() { offset_.reset(); }

  private:
    struct Waiting {
        std::string spot_id;
        std::int64_t before_ns = 0, after_ns = 0;  // after 0: not yet answered
    };
    void lose_track();
    std::deque<Waiting> waiting_;
    std::optional<std::uint64_t> anchor_;  // sequence of the last frame accounted for
    std::optional<std::int64_t> offset_;   // device clock minus host clock at the trigger
    bool lost_track_ = false;
    std::uint64_t unanswered_ = 0;
};

}  // namespace seamwright
