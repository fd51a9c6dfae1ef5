#pragma once
// The two telegrams of KUKA.RobotSensorInterface (RSI 2.3 to 4.x, object ETHERNET; KUKA.Ethernet RSI XML 1.1
// before it): one XML document a UDP datagram.
//   <Rob Type="KUKA"><RIst X="1620.0008" Y="0.0" Z="1910.0" A="0.0" B="90.0" C="0.0"/><RSol .../>
//   <Delay D="0"/>...<IPOC>123645634563</IPOC></Rob>
//   <Sen Type="ImFree"><RKorr X="0.0000" Y="0.0000" Z="0.0000" A="0.0000" B="0.0000" C="0.0000"/>
//   <IPOC>123645634563</IPOC></Sen>
// Millimetres and degrees; A, B, C as KUKA turns (Z, Y', X''). The IPOC is the controller's cycle stamp in ms
// and goes back digit by digit. `Type` and `TYPE` are both written by controllers. Elements not named here
// are let pass: what is sent follows from the controller's configuration.

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "core/error.h"

namespace seamwright {

inline constexpr std::size_t kLargestRsiTelegram = 8192;

struct RsiFrame {
    std::array<double, 6> xyzabc{};  // mm, degrees
    bool usable = true;              // finite, |mm| <= 1e5, |degrees| <= 720
};

struct RsiRob {
    std::array<char, 21> ipoc_text{};  // as it came, ends with 0
    std::uint64_t ipoc = 0;
    std::optional<RsiFrame> rist, rsol;
    std::optional<std::uint64_t> delay;      // <Delay D="">: answers that came late, in a row until now
    std::optional<std::int64_t> digital_in;  // <DiL>
    std::optional<bool> on_path;             // <Path>: seamwright_rsi.src runs the application's path
};

// Does not allocate unless it fails. Refused: what is no well-formed document with root Rob, nesting beyond
// 16, a missing or repeated or non-numeric IPOC, a repeated or incomplete RIst, RSol or Delay.
Expected<RsiRob> parse_rsi_rob(std::span<const std::byte> datagram);

struct RsiSen {
    std::string type;  // <Sen Type="">
    std::string ipoc;
    std::optional<RsiFrame> rkorr;
    std::optional<bool> release;
};
// The other side's reading of an answer.
Expected<RsiSen> parse_rsi_sen(std::span<const std::byte> datagram);

// Writes the answer with `decimals` digits after the point into `buffer`; empty if it does not fit. `type`
// must be an XML name. `release`: the element that lets seamwright_rsi.src run the path.
std::string_view write_rsi_sen(std::span<char> buffer, std::string_view type,
                               const std::array<double, 6>& rkorr, int decimals, std::string_view ipoc,
                               std::optional<bool> release = {});

}  // namespace seamwright
