// Study values: what is accepted is finite, named, and no value stands twice; a Q-DAS file of it stays one field a line.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <string_view>

#include "devices/quality/qdas.h"
#include "devices/quality/study_csv.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const auto values = seamwright::parse_study_csv({reinterpret_cast<const char*>(data), size}, "fuzz");
    if (!values) return 0;
    seamwright::QdasStudy study;
    study.values = *values;
    for (const auto& v : *values) {
        if (!std::isfinite(v.value_mm) || v.part.empty() || v.rehang.empty()) std::abort();
        if (v.reference_mm && !std::isfinite(*v.reference_mm)) std::abort();
        study.part_number = v.part;
    }
    const std::string text = seamwright::dfq_text(study);
    std::size_t begin = 0;
    while (begin < text.size()) {
        if (text[begin] != 'K') std::abort();
        const auto end = text.find("\r\n", begin);
        if (end == std::string::npos ||
            std::any_of(text.begin() + static_cast<std::ptrdiff_t>(begin),
                        text.begin() + static_cast<std::ptrdiff_t>(end),
                        [](char c) { return static_cast<unsigned char>(c) < 0x20; }))
            std::abort();
        begin = end + 2;
    }
    return 0;
}
