#pragma once
// Who may do what to a project and its robots. A project without users asks nobody.
//
// Enforced by ProjectFile alone (ProjectFile::may): all that a program does to a project or through it to a robot begins
// with something that is written there. Reading, measuring without pushing, and what makes a cell safe (frames taken
// back, alarms) need nobody.

#include <array>
#include <optional>
#include <string>
#include <string_view>

#include "core/text.h"

namespace seamwright {

// In the order of what they may.
//   service        pushes, and clears old runs away: `run --watch --push` without a person
//   operator       pushes
//   engineer       all but users
//   administrator  all
enum class Role { service, operator_, engineer, administrator };
inline constexpr std::array<Role, 4> kRoles{Role::service, Role::operator_, Role::engineer,
                                            Role::administrator};
std::string_view to_string(Role role);  // "operator"
std::optional<Role> role_from(std::string_view name);

enum class Deed {
    push,      // a run that writes to a robot
    teach,     // any edit of the project that is none of the next two; proofs
    limits,    // regions with their limits and offsets, requirements, what bends the path
    override,  // the drift watch: acknowledging a step, compensation, its limits
    remove,    // runs and scans
    users
};
bool allows(Role role, Deed deed);
Text name_of(Deed deed);  // "changing limits"

struct User {
    std::string name;  // see check_user_name()
    Role role = Role::operator_;
    std::string created_utc;
};

struct Person {
    std::string name;
    Role role = Role::operator_;
};

}  // namespace seamwright
