#include "devices/ur/dashboard.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

namespace seamwright::ur {

using Clock = std::chrono::steady_clock;
constexpr std::size_t kLongestLine = 1000;

Dashboard::Dashboard(std::string address, std::uint16_t port, Timeout timeout)
    : address_(std::move(address)),
      where_(fmt::format("dashboard of {}:{}", address_, port)),
      port_(port),
      timeout_(timeout) {}

tl::unexpected<Error> Dashboard::fail(Error error) {
    connection_.reset();
    received_.clear();
    error.where = where_;
    return tl::unexpected(std::move(error));
}

Expected<std::string> Dashboard::line(Clock::time_point until) {
    std::array<char, 512> buffer;
    for (;;) {
        if (const auto end = received_.find('\n'); end != std::string::npos) {
            std::string text = received_.substr(0, end);
            received_.erase(0, end + 1);
            if (text.ends_with('\r')) text.pop_back();
            return text;
        }
        if (received_.size() > kLongestLine)
            return fail({ErrorKind::device, "an answer without an end came", {}, {}});
        const auto left = std::chrono::ceil<Timeout>(until - Clock::now());
        auto got =
            connection_->receive_some(std::as_writable_bytes(std::span(buffer)), std::max(Timeout(1), left));
        if (!got) return fail(got.error());
        received_.append(buffer.data(), *got);
    }
}

Expected<std::string> Dashboard::ask(const std::string& question) {
    const bool old = connection_.has_value();
    auto answer = ask_once(question);
    // A connection that the controller closed since (it was switched off) says nothing of the controller now.
    if (!answer && old && !is_silence(answer.error())) answer = ask_once(question);
    return answer;
}

Expected<std::optional<std::string>> Dashboard::ask_if_known(const std::string& question) {
    constexpr std::string_view kUnknown = "could not understand";
    SEAM_TRY(auto answer, ask(question));
    const auto same = [](char unknown, char said) {
        return std::tolower(static_cast<unsigned char>(said)) == unknown;
    };
    if (answer.size() >= kUnknown.size() &&
        std::equal(kUnknown.begin(), kUnknown.end(), answer.begin(), same))
        return std::nullopt;
    return answer;
}

Expected<std::string> Dashboard::ask_once(const std::string& question) {
    const auto until = Clock::now() + timeout_;
    if (!connection_) {
        auto made = TcpConnection::connect(address_, port_, timeout_);
        if (!made) return fail(made.error());
        connection_.emplace(std::move(*made));
        received_.clear();
        SEAM_OK(line(until));
    }
    if (auto sent = connection_->send(bytes_of(question + "\n"), timeout_); !sent) return fail(sent.error());
    return line(until);
}

}  // namespace seamwright::ur
