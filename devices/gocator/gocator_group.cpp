#include "devices/gocator/gocator_group.h"

#include <optional>
#include <utility>

namespace seamwright {
namespace {

// How well data of that step stand for the contour; 0: not at all, they are a tool's.
int standing(std::optional<gdp::Step> step) {
    if (step == gdp::Step::profile) return 2;
    const bool unsaid = !step || step == gdp::Step::none || step == gdp::Step::video;
    return unsaid || step == gdp::Step::raw_profile ? 1 : 0;
}

// False: another one stands as well.
template <class Data>
bool keep_better(int now, Data data, Data& kept, int& kept_standing) {
    if (now == 0 || now < kept_standing) return true;
    if (now == kept_standing) return false;
    kept = std::move(data);
    kept_standing = now;
    return true;
}

}  // namespace

void GocatorGroup::take(const gdp::Message& message, int source) {
    const auto type = static_cast<gdp::Type>(message.type);
    if (type == gdp::Type::stamp) {
        if (auto read = gdp::parse_stamps(message.content))
            stamps = std::move(*read);
        else
            broken_ = true;
    } else if (type == gdp::Type::points || type == gdp::Type::uniform) {
        auto read = gdp::parse_profiles(type, message.content);
        if (!read || (read->source == source && !keep_better(standing(read->step), std::move(read->profiles),
                                                             profiles, profiles_standing_)))
            broken_ = true;
    } else if (type == gdp::Type::intensity) {
        auto read = gdp::parse_intensities(message.content);
        if (!read || (read->source == source && !keep_better(standing(read->step), std::move(read->rows),
                                                             intensities, intensities_standing_)))
            broken_ = true;
    }
}

}  // namespace seamwright
