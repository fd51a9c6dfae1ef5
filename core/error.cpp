#include "core/error.h"

namespace seamwright {

Text Error::text() const {
    return joined(joined(where, ": ", what), "; ", mend);
}

std::string Error::sentence() const {
    return text().english();
}

}  // namespace seamwright
