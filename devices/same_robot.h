#pragma once
// Whether the robot that a link has reconnected to is the one that it was.

#include <fmt/format.h>

#include <optional>
#include <utility>

#include "core/error.h"
#include "devices/robot_link.h"

namespace seamwright {

// A link reconnects by itself, and who answers then need not be who answered before. identity() tells whoever
// is there, and who asked compares. Whatever moves the robot or lets it run asks check() first: on a
// connection newer than the last identity() the identity is asked once more and must be the same.
class SameRobot {
  public:
    void connected_anew() { compared_ = false; }
    RobotIdentity told(RobotIdentity identity) {
        told_ = identity;
        compared_ = true;
        return identity;
    }
    // `ask` answers the identity on the present connection.
    template <class Ask>
    Expected<void> check(const Ask& ask, const std::string& where) {
        if (!told_ || compared_) return {};
        const Expected<RobotIdentity> now = ask();
        if (!now) return tl::unexpected(now.error());
        if (*now != *told_)
            return device_error(
                Text("another robot answers than before: \"{}\", not \"{}\"", now->serial, told_->serial),
                where, "check the cables and addresses");
        compared_ = true;
        return {};
    }

  private:
    std::optional<RobotIdentity> told_;
    bool compared_ = false;  // on this connection
};

}  // namespace seamwright
