#include "projects/report/svg_bars.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "projects/report/html.h"

namespace seamwright::report {

std::string svg_bars(const std::string& title, const std::vector<ShareBar>& bars, int width_px) {
    constexpr double kRow = 22, kTitle = 30, kNames = 200, kFigures = 150, kMargin = 8;
    const double height = kTitle + kRow * static_cast<double>(bars.size()) + kMargin;
    const double length = std::max(50.0, width_px - kNames - kFigures);
    std::string out = fmt::format(
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {0} {1:.0f}' width='{0}' height='{1:.0f}' "
        "role='img' "
        "aria-label='{2}' font-family='DejaVu Sans, sans-serif' font-size='11' fill='#1e2226'>"
        "<text x='12' y='18' font-weight='600' class='title'>{2}</text>",
        width_px, height, escape(title));
    auto it = std::back_inserter(out);
    double top = kTitle;
    for (const ShareBar& bar : bars) {
        const double share = std::isfinite(bar.percent) ? std::clamp(bar.percent, 0.0, 100.0) : 0;
        fmt::format_to(it, "<text x='{:.0f}' y='{:.0f}' text-anchor='end'>{}</text>", kNames - 8, top + 14,
                       escape(bar.name));
        fmt::format_to(it, "<rect x='{:.0f}' y='{:.0f}' width='{:.1f}' height='14' fill='#e8eaed'/>", kNames,
                       top + 3, length);
        fmt::format_to(it, "<rect x='{:.0f}' y='{:.0f}' width='{:.1f}' height='14' fill='{}'/>", kNames,
                       top + 3, share / 100 * length, bar.colour);
        fmt::format_to(it, "<text x='{:.1f}' y='{:.0f}'>{:.1f} %{}{}</text>", kNames + length + 8, top + 14,
                       share, bar.remark.empty() ? "" : ", ", escape(bar.remark));
        top += kRow;
    }
    return out + "</svg>";
}

}  // namespace seamwright::report
