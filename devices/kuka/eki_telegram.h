#pragma once
// The telegrams between Seamwright and the KRL module seamwright.src over KUKA.EthernetKRL (EKI 2.2 and
// later).
//
// The robot is the TCP client, Seamwright the server. Both sides send XML documents back to back without
// length or separator, in the structure that resources/robot/kuka/Seamwright.xml tells the controller:
//
//     robot -> Seamwright   <Robot Kind="trigger" Id="17" Name="S4" Part="" Mode="#EX" Text=""><Pos X=".."
//     Y=".."
//                           Z=".." A=".." B=".." C=".."/></Robot>
//     Seamwright -> robot   <Sensor Kind="write" Id="18" Name="BASE_left" Text=""><Pos X=".." .../></Sensor>
//
// Kind from the robot: hello (first on every connection; Name serial number, Part robot model, Text
// software), start (Part: its name, Name: its type), trigger (Name: spot, Id: counts up by one through a program, Pos: flange
// in base at the trigger), answer (Id of the command; Name, Pos, Mode as asked), error (Id of the command;
// Text: why; it begins with "not ready" where the same command may be done a moment later), done (the
// measuring program has ended). Kind to the robot: state (answer: Mode, Pos; Part: none, given or taken, as
// Permission; Text: why Pos is not known, if so), read, write (Name: frame), measure (Name: signature of the
// program), confirm (Name: verdict, Text for the smartPAD), move (Pos; answered at its end). X, Y, Z in mm,
// A, B, C in degrees (KUKA's Z-Y'-X''). Every field is always there; what has no meaning is "-" (KRL has no
// empty string) or 0.

#include <cstdint>
#include <deque>
#include <string>
#include <string_view>

#include "core/error.h"
#include "core/geometry/pose.h"
#include "devices/robot_link.h"

namespace seamwright {

struct EkiTelegram {
    std::string kind{};
    std::int64_t id = 0;
    std::string name{}, part{}, mode{}, text{};
    Pose pose = Pose::Identity();
};

inline constexpr std::size_t kEkiLongestTelegram =
    8192;  // bytes; the controller's own limit is 3600 a string
inline constexpr std::string_view kEkiNotReady = "not ready";
inline constexpr std::size_t kEkiLongestText = 80;  // KRL strings of the module

// From the robot: the document's root is Robot. Refuses other roots, missing or malformed fields, numbers
// that are not finite, |X, Y, Z| > 1e5 mm, |A, B, C| > 360 degrees, strings that are too long.
Expected<EkiTelegram> parse_eki_telegram(std::string_view document);
// The same from the other end, for peers that stand in for a robot: the root is Sensor.
Expected<EkiTelegram> parse_eki_command(std::string_view document);
// One document. `root` is "Sensor" or "Robot". Strings are cut to kEkiLongestText, quotes and '<' escaped.
std::string write_eki(std::string_view root, const EkiTelegram& telegram);

// Cuts a byte stream into documents by their root's closing tag. Not an XML parser: parse_eki_telegram
// judges.
class EkiSplitter {
  public:
    explicit EkiSplitter(std::string root) : end_("</" + std::move(root)) {}
    // Error (device): the document that has begun is longer than kEkiLongestTelegram; the stream is then
    // broken.
    Expected<void> add(std::string_view bytes);
    bool next(std::string& document);
    bool in_the_middle() const;  // part of a document is there
    void clear();

  private:
    std::string end_, buffer_;
    std::deque<std::string> documents_;
};

// $MODE_OP with the program's state: "#T1", "#T2", "#AUT", "#EX"; "#STOP" and "#FAULT" are the module's.
Expected<RobotMode> mode_from_eki(std::string_view mode);

}  // namespace seamwright
