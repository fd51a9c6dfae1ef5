#include "projects/report/html.h"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cstring>

namespace seamwright::report {
namespace {

constexpr const char* kStyle = R"(
:root { color-scheme: light; }
body { font: 15px/1.5 system-ui, "Segoe UI", "DejaVu Sans", sans-serif; color: #1e2226; background: #f6f7f8; margin: 0; }
main { max-width: 1080px; margin: 0 auto; padding: 24px; }
h1 { font-size: 26px; margin: 8px 0 4px; } h2 { font-size: 19px; margin: 32px 0 8px; } h3 { font-size: 16px; margin: 20px 0 6px; }
p { max-width: 75ch; margin: 6px 0; }
table { border-collapse: collapse; margin: 10px 0; background: #fff; font-size: 14px; }
caption { text-align: left; color: #6b7280; padding: 4px 0; }
th, td { border-bottom: 1px solid #e2e5e9; padding: 4px 12px; text-align: left; }
th { border-bottom: 2px solid #c3c8ce; font-weight: 600; }
td.n, th.n { text-align: right; font-variant-numeric: tabular-nums; }
.verdict { display: inline-block; font-weight: 700; padding: 2px 12px; border-radius: 4px; border: 2px solid; }
.good { color: #00664b; border-color: #009E73; } .attention { color: #7a5200; border-color: #E69F00; }
.alarm { color: #a33f00; border-color: #D55E00; } .neutral { color: #1e2226; border-color: #6b7280; }
figure { margin: 10px 0; } .row { display: flex; flex-wrap: wrap; gap: 12px; }
figcaption { color: #4b5563; font-size: 14px; }
svg { background: #fff; border: 1px solid #e2e5e9; max-width: 100%; height: auto; }
svg text { font: 11px system-ui, "DejaVu Sans", sans-serif; fill: #1e2226; } svg .title { font-weight: 600; }
svg .grid { stroke: #e8eaed; } svg .axes { fill: none; stroke: #6b7280; } svg .band { fill: #009E73; opacity: 0.12; }
@media print { body { background: #fff; } h2 { break-after: avoid; } figure, table { break-inside: avoid; } }
)";

bool is_number(std::string_view cell) {
    if (cell.empty() || cell == "-") return true;
    bool digit = false;
    for (char c : cell) {
        if (std::isdigit(static_cast<unsigned char>(c)))
            digit = true;
        else if (!std::strchr("+-.,e %", c))
            return false;
    }
    return digit;
}

}  // namespace

std::string escape(std::string_view text) {
    std::string out;
    out.reserve(text.size());
    for (char c : text) {
        switch (c) {
            case '&': out += "&amp;"; break;
            case '<': out += "&lt;"; break;
            case '>': out += "&gt;"; break;
            case '"': out += "&quot;"; break;
            case '\'': out += "&#39;"; break;
            default: out += c;
        }
    }
    return out;
}

Page::Page(std::string title, std::string language) : title_(std::move(title)), language_(std::move(language)) {}

void Page::heading(std::string_view text, int level) { body_ += fmt::format("<h{0}>{1}</h{0}>\n", level, escape(text)); }

void Page::paragraph(std::string_view text) { body_ += fmt::format("<p>{}</p>\n", escape(text)); }

void Page::verdict(std::string_view word, Tone tone, std::string_view explanation) {
    const char* name = tone == Tone::good        ? "good"
                       : tone == Tone::attention ? "attention"
                       : tone == Tone::alarm     ? "alarm"
                                                 : "neutral";
    body_ += fmt::format("<p><span class=\"verdict {}\">{}</span> {}</p>\n", name, escape(word), escape(explanation));
}

void Page::table(const std::vector<std::vector<std::string>>& rows, std::string_view caption) {
    if (rows.empty()) return;
    std::vector<bool> numeric(rows[0].size(), rows.size() > 1);
    for (std::size_t r = 1; r < rows.size(); ++r)
        for (std::size_t c = 0; c < numeric.size(); ++c)
            if (c >= rows[r].size() || !is_number(rows[r][c])) numeric[c] = false;
    body_ += "<table>";
    if (!caption.empty()) body_ += fmt::format("<caption>{}</caption>", escape(caption));
    for (std::size_t r = 0; r < rows.size(); ++r) {
        body_ += r == 0 ? "<thead><tr>" : "<tr>";
        for (std::size_t c = 0; c < rows[r].size(); ++c)
            body_ += fmt::format("<{0}{1}>{2}</{0}>", r == 0 ? "th" : "td",
                                 c < numeric.size() && numeric[c] ? " class=\"n\"" : "", escape(rows[r][c]));
        body_ += r == 0 ? "</tr></thead><tbody>" : "</tr>";
    }
    body_ += "</tbody></table>\n";
}

void Page::figure(const std::string& svg, std::string_view caption) { figures({svg}, caption); }

void Page::figures(const std::vector<std::string>& svgs, std::string_view caption) {
    body_ += "<figure><div class=\"row\">";
    for (const std::string& s : svgs) body_ += s;
    body_ += fmt::format("</div><figcaption>{}</figcaption></figure>\n", escape(caption));
}

std::string Page::html() const {
    return fmt::format(
        "<!DOCTYPE html>\n<html lang=\"{}\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
        "content=\"width=device-width, initial-scale=1\"><title>{}</title><style>{}</style></head>\n<body><main>\n<h1>{}</h1>\n{}"
        "</main></body></html>\n",
        language_, escape(title_), kStyle, escape(title_), body_);
}

}  // namespace seamwright::report
