#pragma once
// When a client may try to connect again: after a failure it waits `first`, after the next twice as long, up to `most`;
// once it worked, the next failure waits `first` again. Settings: entry::reconnect (devices/exchange/settings.h).

#include <algorithm>
#include <chrono>
#include <optional>

namespace seamwright {

class Backoff {
  public:
    using Clock = std::chrono::steady_clock;
    using Milliseconds = std::chrono::milliseconds;

    Backoff(Milliseconds first, Milliseconds most) : first_(first), most_(std::max(first, most)) {}

    // One attempt to connect where one is due, its outcome noted; nullopt: none is due. `connect` answers Expected<...>.
    template <class Connect>
    auto attempt(const Connect& connect) -> std::optional<decltype(connect())> {
        if (!due()) return std::nullopt;
        auto made = connect();
        made ? worked() : failed();
        return made;
    }

    bool due() const { return Clock::now() >= not_before_; }
    // 0 or less: due.
    Milliseconds left() const { return std::chrono::ceil<Milliseconds>(not_before_ - Clock::now()); }
    void failed() {
        wait_ = wait_.count() == 0 ? first_ : std::min(2 * wait_, most_);
        not_before_ = Clock::now() + wait_;
    }
    void worked() { wait_ = Milliseconds(0); }
    void try_now() { not_before_ = {}; }  // what failed is another thing than connecting

  private:
    Milliseconds first_, most_, wait_{0};
    Clock::time_point not_before_{};
};

}  // namespace seamwright
