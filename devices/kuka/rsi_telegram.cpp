#include "devices/kuka/rsi_telegram.h"

#include <fmt/format.h>

#include <charconv>
#include <cmath>

namespace seamwright {
namespace {

constexpr int kDepth = 16;
constexpr std::array<std::string_view, 6> kAxes = {"X", "Y", "Z", "A", "B", "C"};

bool blank(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}
bool name_sign(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || c == '.' || c == ':';
}
std::string_view without_blanks(std::string_view s) {
    while (!s.empty() && blank(s.front())) s.remove_prefix(1);
    while (!s.empty() && blank(s.back())) s.remove_suffix(1);
    return s;
}

template <class Number>
bool number(std::string_view text, Number& value) {
    text = without_blanks(text);
    if (!text.empty() && text.front() == '+') text.remove_prefix(1);
    const auto [end, e] = std::from_chars(text.data(), text.data() + text.size(), value);
    return e == std::errc() && end == text.data() + text.size() && !text.empty();
}

// A reader of the part of XML that controllers write: declaration, comments, elements, attributes, text.
// Entities stay as they are: no number holds one. Answers nullptr, or what is wrong.
//   on.attribute(depth, element, name, value)   on.begin(depth, element) on.text(depth, element, text)
template <class On>
const char* read_xml(std::string_view s, On& on) {
    std::array<std::string_view, kDepth> open;
    int depth = 0;
    bool root_seen = false;
    std::size_t i = 0;
    if (s.starts_with("\xEF\xBB\xBF")) i = 3;
    while (i < s.size()) {
        if (s[i] != '<') {
            const std::size_t end = std::min(s.find('<', i), s.size());
            const std::string_view text = s.substr(i, end - i);
            if (depth > 0) {
                if (const char* wrong = on.text(depth, open[static_cast<std::size_t>(depth - 1)], text))
                    return wrong;
            } else if (!without_blanks(text).empty() && without_blanks(text) != std::string_view("\0", 1)) {
                return "there is text outside the document";
            }
            i = end;
            continue;
        }
        if (s.substr(i).starts_with("<?")) {
            const std::size_t end = s.find("?>", i);
            if (end == std::string_view::npos || root_seen) return "the declaration is wrong";
            i = end + 2;
            continue;
        }
        if (s.substr(i).starts_with("<!--")) {
            const std::size_t end = s.find("-->", i + 4);
            if (end == std::string_view::npos) return "a comment does not end";
            i = end + 3;
            continue;
        }
        const bool closing = s.substr(i).starts_with("</");
        i += closing ? 2 : 1;
        const std::size_t start = i;
        while (i < s.size() && name_sign(s[i])) ++i;
        const std::string_view name = s.substr(start, i - start);
        if (name.empty()) return "an element has no name";
        if (closing) {
            while (i < s.size() && blank(s[i])) ++i;
            if (i >= s.size() || s[i] != '>') return "an element is cut off";
            if (depth == 0 || open[static_cast<std::size_t>(depth - 1)] != name)
                return "elements do not close in order";
            --depth;
            ++i;
            continue;
        }
        if (depth == 0 && root_seen) return "there is more than one document";
        if (depth == kDepth) return "elements are nested too deep";
        root_seen = true;
        open[static_cast<std::size_t>(depth++)] = name;
        if (const char* wrong = on.begin(depth, name)) return wrong;
        while (true) {
            while (i < s.size() && blank(s[i])) ++i;
            if (i >= s.size()) return "an element is cut off";
            if (s[i] == '>') {
                ++i;
                break;
            }
            if (s[i] == '/') {
                if (i + 1 >= s.size() || s[i + 1] != '>') return "an element is cut off";
                if (const char* wrong = on.text(depth, name, {})) return wrong;
                --depth;
                i += 2;
                break;
            }
            const std::size_t key_start = i;
            while (i < s.size() && name_sign(s[i])) ++i;
            const std::string_view key = s.substr(key_start, i - key_start);
            while (i < s.size() && blank(s[i])) ++i;
            if (key.empty() || i >= s.size() || s[i] != '=') return "an attribute is wrong";
            ++i;
            while (i < s.size() && blank(s[i])) ++i;
            if (i >= s.size() || (s[i] != '"' && s[i] != '\'')) return "an attribute has no quotes";
            const std::size_t end = s.find(s[i], i + 1);
            if (end == std::string_view::npos) return "an attribute is cut off";
            if (const char* wrong = on.attribute(depth, name, key, s.substr(i + 1, end - i - 1)))
                return wrong;
            i = end + 1;
        }
    }
    if (depth != 0) return "the document is cut off";
    return root_seen ? nullptr : "it is empty";
}

// One frame with six attributes, each once.
struct FrameReader {
    RsiFrame frame;
    int seen = 0;
    bool begun = false;

    const char* take(std::string_view key, std::string_view value) {
        for (std::size_t k = 0; k < 6; ++k) {
            if (key != kAxes[k]) continue;
            if (seen & (1 << k)) return "a coordinate is given twice";
            seen |= 1 << k;
            double& x = frame.xyzabc[k];
            if (!number(value, x)) {
                // Beyond double is still a number; anything else is not.
                x = NAN;
                const std::string_view t = without_blanks(value);
                if (t.empty() || t.find_first_not_of("+-.0123456789eEinfaINFA#") != std::string_view::npos)
                    return "a coordinate is no number";
            }
            if (!(std::abs(x) <= (k < 3 ? 1e5 : 720.0))) frame.usable = false;
            return nullptr;
        }
        return nullptr;
    }
    const char* finish(std::optional<RsiFrame>& result) const {
        if (!begun) return nullptr;
        if (seen != 63) return "a frame lacks a coordinate";
        result = frame;
        return nullptr;
    }
};

struct Reader {
    std::string_view root;
    FrameReader rist, rsol, rkorr;
    std::string_view ipoc, type;
    bool ipoc_seen = false;
    std::optional<std::uint64_t> delay;
    std::optional<std::int64_t> digital_in;
    std::optional<bool> on_path, release;

    FrameReader* frame(std::string_view element) {
        return element == "RIst" ? &rist : element == "RSol" ? &rsol : element == "RKorr" ? &rkorr : nullptr;
    }
    const char* begin(int depth, std::string_view element) {
        if (depth == 1 && element != root) return "its root has another name";
        if (depth != 2) return nullptr;
        if (FrameReader* f = frame(element)) {
            if (f->begun) return "a frame is given twice";
            f->begun = true;
        }
        if (element == "IPOC") {
            if (ipoc_seen) return "the IPOC is given twice";
            ipoc_seen = true;
        }
        return nullptr;
    }
    const char* attribute(int depth, std::string_view element, std::string_view key, std::string_view value) {
        if (depth == 1 && (key == "Type" || key == "TYPE")) type = value;
        if (depth != 2) return nullptr;
        if (FrameReader* f = frame(element)) return f->take(key, value);
        if (element == "Delay" && key == "D") {
            std::uint64_t d = 0;
            if (delay || !number(value, d)) return "the count of late packets is wrong";
            delay = d;
        }
        return nullptr;
    }
    const char* text(int depth, std::string_view element, std::string_view value) {
        if (depth != 2) return nullptr;
        if (element == "IPOC" && !without_blanks(value).empty()) {
            if (!ipoc.empty()) return "the IPOC is given twice";
            ipoc = without_blanks(value);
        }
        std::int64_t d = 0;
        if (element == "DiL" && number(value, d)) digital_in = d;
        if (element == "Path" && number(value, d)) on_path = d != 0;
        if (element == "Release" && number(value, d)) release = d != 0;
        return nullptr;
    }
};

std::string_view text_of(std::span<const std::byte> datagram) {
    return {reinterpret_cast<const char*>(datagram.data()), datagram.size()};
}

tl::unexpected<Error> refused(const char* wrong) {
    return device_error(Text("an RSI telegram is refused: {}", wrong));
}

}  // namespace

Expected<RsiRob> parse_rsi_rob(std::span<const std::byte> datagram) {
    if (datagram.size() > kLargestRsiTelegram) return refused("it is too long");
    Reader r;
    r.root = "Rob";
    if (const char* wrong = read_xml(text_of(datagram), r)) return refused(wrong);
    RsiRob rob;
    if (const char* wrong = r.rist.finish(rob.rist)) return refused(wrong);
    if (const char* wrong = r.rsol.finish(rob.rsol)) return refused(wrong);
    if (r.ipoc.empty() || r.ipoc.size() >= rob.ipoc_text.size() || r.ipoc.front() == '+' ||
        !number(r.ipoc, rob.ipoc))
        return refused("it has no IPOC of digits");
    r.ipoc.copy(rob.ipoc_text.data(), r.ipoc.size());
    rob.delay = r.delay;
    rob.digital_in = r.digital_in;
    rob.on_path = r.on_path;
    return rob;
}

Expected<RsiSen> parse_rsi_sen(std::span<const std::byte> datagram) {
    if (datagram.size() > kLargestRsiTelegram) return refused("it is too long");
    Reader r;
    r.root = "Sen";
    if (const char* wrong = read_xml(text_of(datagram), r)) return refused(wrong);
    RsiSen sen;
    if (const char* wrong = r.rkorr.finish(sen.rkorr)) return refused(wrong);
    sen.type = r.type;
    sen.ipoc = r.ipoc;
    sen.release = r.release;
    return sen;
}

std::string_view write_rsi_sen(std::span<char> buffer, std::string_view type,
                               const std::array<double, 6>& rkorr, int decimals, std::string_view ipoc,
                               std::optional<bool> release) {
    const auto written = fmt::format_to_n(
        buffer.data(), buffer.size(),
        "<Sen Type=\"{}\"><RKorr X=\"{:.{}f}\" Y=\"{:.{}f}\" Z=\"{:.{}f}\" A=\"{:.{}f}\" B=\"{:.{}f}\" "
        "C=\"{:.{}f}\" />{}<IPOC>{}</IPOC></Sen>",
        type, rkorr[0], decimals, rkorr[1], decimals, rkorr[2], decimals, rkorr[3], decimals, rkorr[4],
        decimals, rkorr[5], decimals,
        !release   ? ""
        : *release ? "<Release>1</Release>"
                   : "<Release>0</Release>",
        ipoc);
    if (written.size > buffer.size()) return {};
    return {buffer.data(), written.size};
}

}  // namespace seamwright
