#pragma once
// How long an id may be: as people count it, in signs and not in the bytes that a sign takes.

#include <algorithm>
#include <string_view>

#include "projects/file/project_file.h"

namespace seamwright {

// More than kLongestId code points of UTF-8, or of what is no UTF-8 more bytes than so many signs can take.
inline bool is_too_long(std::string_view id) {
    const auto begins = [](char c) { return (static_cast<unsigned char>(c) & 0xC0U) != 0x80U; };
    return id.size() > 4 * kLongestId ||
           static_cast<std::size_t>(std::count_if(id.begin(), id.end(), begins)) > kLongestId;
}

}  // namespace seamwright
