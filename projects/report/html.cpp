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
.sign { display: flex; gap: 24px; margin-top: 56px; } .sign span { flex: 1; border-top: 1px solid #1e2226; color: #4b5563; font-size: 14px; }
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

Tone tone_of(Verdict verdict) {
    switch (verdict) {
        case Verdict::good:
            return Tone::good;
        case Verdict::usable:
            return Tone::attention;
        case Verdict::poor:
        case Verdict::undetermined:
            return Tone::alarm;
    }
    return Tone::alarm;
}

std::string escape(std::string_view text) {
    std::string out;
    out.reserve(text.size());
    for (char c : text) {
        switch (c) {
            case '&':
                out += "&amp;";
                break;
            case '<':
                out += "&lt;";
                break;
            case '>':
                out += "&gt;";
                break;
            case '"':
                out += "&quot;";
                break;
            case '\'':
                out += "&#39;";
                break;
            default:
                out += c;
        }
    }
    return out;
}

std::vector<bool> numeric_columns(const Rows& rows) {
    if (rows.empty()) return {};
    std::vector<bool> numeric(rows[0].size(), rows.size() > 1);
    for (std::size_t r = 1; r < rows.size(); ++r)
        for (std::size_t c = 0; c < numeric.size(); ++c)
            if (c >= rows[r].size() || !is_number(rows[r][c])) numeric[c] = false;
    return numeric;
}

Page::Page(std::string title, std::string language)
    : title_(std::move(title)), language_(std::move(language)) {}

void Page::heading(std::string_view text, int level) {
    Block& b = blocks_.emplace_back();
    b.kind = Block::Kind::heading;
    b.level = level;
    b.text = text;
}

void Page::paragraph(std::string_view text) {
    blocks_.emplace_back().text = text;
}

void Page::verdict(std::string_view word, Tone tone, std::string_view explanation) {
    Block& b = blocks_.emplace_back();
    b.kind = Block::Kind::verdict;
    b.word = word;
    b.tone = tone;
    b.text = explanation;
}

void Page::table(const Rows& rows, std::string_view caption) {
    if (rows.empty()) return;
    Block& b = blocks_.emplace_back();
    b.kind = Block::Kind::table;
    b.rows = rows;
    b.text = caption;
}

void Page::figure(const std::string& svg, std::string_view caption) {
    figures({svg}, caption);
}

void Page::figures(const std::vector<std::string>& svgs, std::string_view caption) {
    Block& b = blocks_.emplace_back();
    b.kind = Block::Kind::figures;
    b.svgs = svgs;
    b.text = caption;
}

void Page::signatures(const Rows& lines) {
    Block& b = blocks_.emplace_back();
    b.kind = Block::Kind::signatures;
    b.rows = lines;
}

namespace {

std::string table_html(const Block& b) {
    const std::vector<bool> numeric = numeric_columns(b.rows);
    std::string out = "<table>";
    if (!b.text.empty()) out += fmt::format("<caption>{}</caption>", escape(b.text));
    for (std::size_t r = 0; r < b.rows.size(); ++r) {
        out += r == 0 ? "<thead><tr>" : "<tr>";
        for (std::size_t c = 0; c < b.rows[r].size(); ++c)
            out += fmt::format("<{0}{1}>{2}</{0}>", r == 0 ? "th" : "td",
                               c < numeric.size() && numeric[c] ? " class=\"n\"" : "", escape(b.rows[r][c]));
        out += r == 0 ? "</tr></thead><tbody>" : "</tr>";
    }
    return out + "</tbody></table>\n";
}

std::string block_html(const Block& b) {
    switch (b.kind) {
        case Block::Kind::heading:
            return fmt::format("<h{0}>{1}</h{0}>\n", b.level, escape(b.text));
        case Block::Kind::paragraph:
            return fmt::format("<p>{}</p>\n", escape(b.text));
        case Block::Kind::verdict: {
            const char* name = b.tone == Tone::good        ? "good"
                               : b.tone == Tone::attention ? "attention"
                               : b.tone == Tone::alarm     ? "alarm"
                                                           : "neutral";
            return fmt::format("<p><span class=\"verdict {}\">{}</span> {}</p>\n", name, escape(b.word),
                               escape(b.text));
        }
        case Block::Kind::table:
            return table_html(b);
        case Block::Kind::figures: {
            std::string out = "<figure><div class=\"row\">";
            for (const std::string& s : b.svgs) out += s;
            return out + fmt::format("</div><figcaption>{}</figcaption></figure>\n", escape(b.text));
        }
        case Block::Kind::signatures: {
            std::string out;
            for (const auto& line : b.rows) {
                out += "<div class=\"sign\">";
                for (const std::string& field : line) out += fmt::format("<span>{}</span>", escape(field));
                out += "</div>\n";
            }
            return out;
        }
    }
    return {};
}

}  // namespace

std::string Page::html_again_after(int seconds) const {
    std::string text = html();
    if (const auto at = text.find("<head>"); at != std::string::npos)
        text.insert(at + 6, "<meta http-equiv=\"refresh\" content=\"" + std::to_string(seconds) + "\">");
    return text;
}

std::string Page::html() const {
    std::string body;
    for (const Block& b : blocks_) body += block_html(b);
    return fmt::format(
        "<!DOCTYPE html>\n<html lang=\"{}\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" "
        "content=\"width=device-width, "
        "initial-scale=1\"><title>{}</title><style>{}</style></head>\n<body><main>\n<h1>{}</h1>\n{}"
        "</main></body></html>\n",
        language_, escape(title_), kStyle, escape(title_), body);
}

std::string Page::text() const {
    std::string out = title_ + "\n";
    for (const Block& b : blocks_) {
        switch (b.kind) {
            case Block::Kind::heading:
                out += "\n" + b.text + "\n";
                break;
            case Block::Kind::paragraph:
                out += b.text + "\n";
                break;
            case Block::Kind::verdict:
                out += b.word + ": " + b.text + "\n";
                break;
            case Block::Kind::table: {
                if (!b.text.empty()) out += b.text + "\n";
                const std::vector<bool> numeric = numeric_columns(b.rows);
                std::vector<std::size_t> widths;
                for (const auto& row : b.rows) {
                    widths.resize(std::max(widths.size(), row.size()));
                    for (std::size_t c = 0; c < row.size(); ++c)
                        widths[c] = std::max(widths[c], row[c].size());
                }
                for (const auto& row : b.rows) {
                    std::string line = " ";
                    for (std::size_t c = 0; c < row.size(); ++c)
                        line += c < numeric.size() && numeric[c] ? fmt::format(" {:>{}} ", row[c], widths[c])
                                                                 : fmt::format(" {:<{}} ", row[c], widths[c]);
                    out += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
                }
                break;
            }
            default:
                break;
        }
    }
    return out;
}

}  // namespace seamwright::report
