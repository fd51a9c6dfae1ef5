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
    return dfq_text(std::vector{study});
}

std::string dfq_text(const std::vector<QdasStudy>& characteristics) {
    std::string out;
    if (characteristics.empty()) return out;
    const auto put = [&](const std::string& key, const std::string& text) {
        if (!text.empty()) out += fmt::format("{} {}\r\n", key, text);
    };
    const QdasStudy& part = characteristics.front();
    put("K0100", std::to_string(characteristics.size()));
    put("K1001", ansi(part.part_number, 30));
    put("K1002", ansi(part.part_name, 80));
    put("K1081", ansi(part.machine_number, 24));
    put("K1082", ansi(part.machine_name, 40));
    std::size_t number = 0;
    for (const QdasStudy& study : characteristics) {
        const auto of = [at = ++number](const char* key) { return fmt::format("{}/{}", key, at); };
        const auto mm = [&](double value) { return fmt::format("{:.{}f}", value, study.decimals); };
        put(of("K2001"), ansi(study.characteristic_number, 20));
        put(of("K2002"), ansi(study.characteristic_name, 80));
        put(of("K2004"), "0");
        put(of("K2022"), std::to_string(study.decimals));
        put(of("K2101"), mm(study.nominal_mm));
        put(of("K2110"), mm(study.lower_mm));
        put(of("K2111"), mm(study.upper_mm));
        put(of("K2120"), "1");
        put(of("K2121"), "1");
        put(of("K2142"), ansi(study.unit, 20));
        put(of("K2401"), ansi(part.gauge_number, 40));
        put(of("K2402"), ansi(part.gauge_name, 40));
    }
    number = 0;
    for (const QdasStudy& study : characteristics) {
        const auto of = [at = ++number](const char* key) { return fmt::format("{}/{}", key, at); };
        for (const StudyValue& v : study.values) {
            put(of("K0001"), fmt::format("{:.{}f}", v.value_mm, study.decimals));
            put(of("K0002"), "0");
            put(of("K0004"), qdas_time(v.utc));
            put(of("K0006"), ansi(v.rehang, 14));
            put(of("K0014"), ansi(v.part, 40));
        }
    }
    return out;
}

}  // namespace seamwright
