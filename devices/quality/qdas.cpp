#include "devices/quality/qdas.h"

#include <fmt/format.h>

namespace seamwright {
namespace {

// UTF-8 to Windows-1252, of which only the part equal to Latin-1 is used.
std::string ansi(std::string_view text, std::size_t longest) {
    std::string out;
    for (std::size_t i = 0; i < text.size() && out.size() < longest; ++i) {
        const auto byte = static_cast<unsigned char>(text[i]);
        if (byte < 0x20 || byte == 0x7f) {
            out += ' ';
        } else if (byte < 0x80) {
            out += text[i];
        } else if ((byte == 0xc2 || byte == 0xc3) && i + 1 < text.size() &&
                   (static_cast<unsigned char>(text[i + 1]) & 0xc0) == 0x80) {
            const unsigned code = (byte & 0x03u) << 6 | (static_cast<unsigned char>(text[++i]) & 0x3fu);
            out += code >= 0xa0 ? static_cast<char>(code) : '?';
        } else {
            out += '?';
            while (i + 1 < text.size() && (static_cast<unsigned char>(text[i + 1]) & 0xc0) == 0x80) ++i;
        }
    }
    return out;
}

// "2024-05-01T12:00:00.000Z" -> "01.05.2024/12:00:00"; empty when it is no such time.
std::string qdas_time(const std::string& utc) {
    if (utc.size() < 19 || utc[4] != '-' || utc[7] != '-' || utc[13] != ':' || utc[16] != ':') return {};
    for (const std::size_t i : {0u, 1u, 2u, 3u, 5u, 6u, 8u, 9u, 11u, 12u, 14u, 15u, 17u, 18u})
        if (utc[i] < '0' || utc[i] > '9') return {};
    return utc.substr(8, 2) + "." + utc.substr(5, 2) + "." + utc.substr(0, 4) + "/" + utc.substr(11, 8);
}

}  // namespace

std::string dfq_text(const QdasStudy& study) {
    std::string out;
    const auto put = [&](const char* key, const std::string& text) {
        if (!text.empty()) out += fmt::format("{} {}\r\n", key, text);
    };
    const auto mm = [&](double value) { return fmt::format("{:.{}f}", value, study.decimals); };
    put("K0100", "1");
    put("K1001", ansi(study.part_number, 30));
    put("K1002", ansi(study.part_name, 80));
    put("K1081", ansi(study.machine_number, 24));
    put("K1082", ansi(study.machine_name, 40));
    put("K2001/1", ansi(study.characteristic_number, 20));
    put("K2002/1", ansi(study.characteristic_name, 80));
    put("K2004/1", "0");
    put("K2022/1", std::to_string(study.decimals));
    put("K2101/1", mm(study.nominal_mm));
    put("K2110/1", mm(study.lower_mm));
    put("K2111/1", mm(study.upper_mm));
    put("K2120/1", "1");
    put("K2121/1", "1");
    put("K2142/1", "mm");
    put("K2401/1", ansi(study.gauge_number, 40));
    put("K2402/1", ansi(study.gauge_name, 40));
    for (const StudyValue& v : study.values) {
        put("K0001/1", mm(v.value_mm));
        put("K0002/1", "0");
        put("K0004/1", qdas_time(v.utc));
        put("K0006/1", ansi(v.rehang, 14));
        put("K0014/1", ansi(v.part, 40));
    }
    return out;
}

}  // namespace seamwright
