#include "projects/model/users.h"

namespace seamwright {

std::string_view to_string(Role role) {
    constexpr std::array<std::string_view, 4> words{"service", "operator", "engineer", "administrator"};
    return words[static_cast<std::size_t>(role)];
}

std::optional<Role> role_from(std::string_view name) {
    for (const Role role : kRoles)
        if (to_string(role) == name) return role;
    return std::nullopt;
}

bool allows(Role role, Deed deed) {
    switch (deed) {
        case Deed::push:
            return true;
        case Deed::remove:
            return role != Role::operator_;
        case Deed::teach:
        case Deed::limits:
        case Deed::override:
            return role == Role::engineer || role == Role::administrator;
        case Deed::users:
            return role == Role::administrator;
    }
    return false;
}

Text name_of(Deed deed) {
    switch (deed) {
        case Deed::push:
            return "pushing to a robot";
        case Deed::teach:
            return "teaching and changing the project";
        case Deed::limits:
            return "changing limits";
        case Deed::override:
            return "changing the drift watch or acknowledging a step";
        case Deed::remove:
            return "deleting runs and scans";
        case Deed::users:
            return "managing users";
    }
    return {};
}

}  // namespace seamwright
