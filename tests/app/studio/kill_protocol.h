#pragma once
// What the killed studio says to the test that kills it: one message a write, so that none arrives in half.

#include <cstdint>
#include <functional>

#include "tests/projects/sample_project.h"

namespace seamwright {

struct KillMessage {
    char kind = 0;
    std::uint64_t value = 0;
};
namespace kill_message {
inline constexpr char asked = 'q';    // the restore question is on the screen
inline constexpr char forgets = 'f';  // it is about to be answered by "open as saved"
inline constexpr char ready = 'w';    // the window waits for a person; fingerprint of what it shows
inline constexpr char begins = 'b';   // an action of the person
inline constexpr char made = 'm';     // an edit, undo or redo was made; fingerprint
inline constexpr char kept = 'k';     // the studio says that it is autosaved; fingerprint
inline constexpr char saving = 's';   // Ctrl+S is about to be pressed
inline constexpr char saved = 'S';    // and was; fingerprint
inline constexpr char runs = 'R';     // so many runs are stored
inline constexpr char ended = 'e';    // the action is over
}  // namespace kill_message

// Of all that a person sets up. Who answered at the devices is not edited, and comes and goes with them.
inline std::uint64_t fingerprint(Project project) {
    for (SensorSetup& sensor : project.sensors) sensor.identity = {};
    for (RobotSetup& robot : project.robots) robot.identity = {};
    std::string text = exact_text(project);
    for (std::byte b : project.part.mesh_ply) text += static_cast<char>(b);
    return std::hash<std::string>()(text);
}

}  // namespace seamwright
