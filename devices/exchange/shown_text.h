#pragma once

#include <string>
#include <string_view>

namespace seamwright {

// What a file holds, for a message: at most `most` signs of it, UTF-8 as it is (so that a title can be copied from
// the sentence), '?' for what cannot be shown: control characters and every byte that is no UTF-8.
inline std::string shown_text(std::string_view text, std::size_t most) {
    std::string s;
    for (std::size_t signs = 0; !text.empty(); ++signs) {
        if (signs == most) return s + "...";
        const auto byte = [&](std::size_t i) {
            return i < text.size() ? static_cast<unsigned char>(text[i]) : 0U;
        };
        const unsigned lead = byte(0), second = byte(1);
        std::size_t length = lead < 0x80                   ? 1
                             : lead >= 0xC2 && lead < 0xE0 ? 2
                             : lead >= 0xE0 && lead < 0xF0 ? 3
                             : lead >= 0xF0 && lead < 0xF5 ? 4
                                                           : 0;
        for (std::size_t i = 1; i < length; ++i)
            if ((byte(i) & 0xC0) != 0x80) length = 0;
        // written longer than need be, halves of UTF-16, beyond Unicode, control characters
        if ((lead == 0xE0 && second < 0xA0) || (lead == 0xED && second >= 0xA0) ||
            (lead == 0xF0 && second < 0x90) || (lead == 0xF4 && second >= 0x90) ||
            (lead == 0xC2 && second < 0xA0) || lead < 0x20 || lead == 0x7F)
            length = 0;
        if (length == 0)
            s += '?';
        else
            s += text.substr(0, length);
        text.remove_prefix(length == 0 ? 1 : length);
    }
    return s;
}

// UTF-16 by its mark, or by the zeros between the signs of plain ASCII.
inline bool is_utf16(std::string_view text) {
    if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) return true;
    return text.size() >= 4 && ((text[0] != 0 && text[1] == 0 && text[2] != 0 && text[3] == 0) ||
                                (text[0] == 0 && text[1] != 0 && text[2] == 0 && text[3] != 0));
}

}  // namespace seamwright
