#include "core/error.h"

namespace seamwright {

std::string Error::sentence() const {
    std::string s;
    if (!where.empty()) s += where + ": ";
    s += what;
    if (!mend.empty()) s += "; " + mend;
    return s;
}

}  // namespace seamwright
