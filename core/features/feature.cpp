#include "core/features/feature.h"

namespace seamwright {

std::string_view to_string(FeatureStatus status) {
    switch (status) {
        case FeatureStatus::ok:
            return "ok";
        case FeatureStatus::no_points:
            return "no_points";
        case FeatureStatus::not_found:
            return "not_found";
        case FeatureStatus::ambiguous:
            return "ambiguous";
        case FeatureStatus::ill_conditioned:
            return "ill_conditioned";
    }
    return "not_found";
}

}  // namespace seamwright
