#pragma once
// A recorded profile without what stands for "no return", as the filter of a run takes it.

#include "core/profile/no_return.h"

namespace seamwright {

inline Profile recorded_heights(Profile profile) {
    for (const NoReturnCode& code : find_no_return_codes(profile)) erase_no_returns(profile, {code.value});
    return profile;
}

}  // namespace seamwright
