#include "projects/report/svg_plot.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "projects/report/html.h"

namespace seamwright::report {
namespace {

struct Range {
    double from = std::numeric_limits<double>::infinity(), to = -std::numeric_limits<double>::infinity();
    void include(double v) {
        if (std::isfinite(v)) from = std::min(from, v), to = std::max(to, v);
    }
    bool valid() const { return from <= to; }
    double span() const { return to - from; }
    void pad(double share) {
        const double by = span() > 0 ? share * span() : std::max(1e-6, 0.1 * std::abs(from));
        from -= by, to += by;
    }
};

// Where the drawing area lies inside the picture.
constexpr double kLeft = 64, kRight = 14, kTop = 42, kBottom = 44;

struct Frame {
    Range x, y;
    double width, height;
    double px(double v) const { return kLeft + (v - x.from) / x.span() * (width - kLeft - kRight); }
    double py(double v) const {
        return height - kBottom - (v - y.from) / y.span() * (height - kTop - kBottom);
    }
};

std::string number(double v) {
    if (std::abs(v) < 1e-12) v = 0;
    return fmt::format("{:.6g}", v);
}

void draw_axes(std::string& out, const Plot& plot, const Frame& f) {
    auto it = std::back_inserter(out);
    const double bottom = f.height - kBottom, right = f.width - kRight;
    if (plot.categories.empty()) {
        for (double t : axis_ticks(f.x.from, f.x.to, 8)) {
            fmt::format_to(it, "<line class='grid' x1='{0:.1f}' x2='{0:.1f}' y1='{1}' y2='{2}'/>", f.px(t),
                           kTop, bottom);
            fmt::format_to(it, "<text x='{:.1f}' y='{}' text-anchor='middle'>{}</text>", f.px(t), bottom + 15,
                           number(t));
        }
    } else {
        for (std::size_t i = 0; i < plot.categories.size(); ++i)
            fmt::format_to(it, "<text x='{:.1f}' y='{}' text-anchor='middle'>{}</text>",
                           f.px(static_cast<double>(i)), bottom + 15, escape(plot.categories[i]));
    }
    for (double t : axis_ticks(f.y.from, f.y.to, 6)) {
        fmt::format_to(it, "<line class='grid' x1='{1}' x2='{2}' y1='{0:.1f}' y2='{0:.1f}'/>", f.py(t), kLeft,
                       right);
        fmt::format_to(it, "<text x='{}' y='{:.1f}' text-anchor='end'>{}</text>", kLeft - 6, f.py(t) + 4,
                       number(t));
    }
    fmt::format_to(it, "<rect class='axes' x='{}' y='{}' width='{}' height='{}'/>", kLeft, kTop,
                   right - kLeft, bottom - kTop);
    fmt::format_to(it, "<text class='title' x='{}' y='16'>{}</text>", kLeft, escape(plot.title));
    fmt::format_to(it, "<text x='{:.1f}' y='{:.1f}' text-anchor='middle'>{}</text>", (kLeft + right) / 2,
                   f.height - 10, escape(plot.x_label));
    fmt::format_to(it, "<text transform='translate(14 {:.1f}) rotate(-90)' text-anchor='middle'>{}</text>",
                   (kTop + bottom) / 2, escape(plot.y_label));
}

void draw_series(std::string& out, const Series& s, const Frame& f, double bar_offset, double bar_width) {
    auto it = std::back_inserter(out);
    const std::size_t n = std::min(s.x.size(), s.y.size());
    if (s.mark == Mark::line || s.mark == Mark::dashed || s.mark == Mark::area) {
        bool pen_down = false;
        std::string path;
        for (std::size_t i = 0; i < n; ++i) {
            if (!std::isfinite(s.x[i]) || !std::isfinite(s.y[i])) {
                pen_down = false;
                continue;
            }
            path += fmt::format("{}{:.1f} {:.1f}", pen_down ? 'L' : 'M', f.px(s.x[i]), f.py(s.y[i]));
            pen_down = true;
        }
        if (s.mark == Mark::area) {
            fmt::format_to(it,
                           "<path d='{0}' fill='{1}' fill-opacity='0.5' stroke='{1}' stroke-width='0.8'/>",
                           path, s.colour);
            return;
        }
        fmt::format_to(it, "<path d='{}' fill='none' stroke='{}' stroke-width='1.6'{}/>", path, s.colour,
                       s.mark == Mark::dashed ? " stroke-dasharray='6 4'" : "");
        return;
    }
    for (std::size_t i = 0; i < n; ++i) {
        if (!std::isfinite(s.x[i]) || !std::isfinite(s.y[i])) continue;
        const double px = f.px(s.x[i]), py = f.py(s.y[i]);
        if (s.mark == Mark::dots)
            fmt::format_to(it, "<circle cx='{:.1f}' cy='{:.1f}' r='2.4' fill='{}'/>", px, py, s.colour);
        else if (s.mark == Mark::crosses)
            fmt::format_to(it, "<path d='M{0:.1f} {1:.1f}l6 6m0 -6l-6 6' stroke='{2}' stroke-width='1.6'/>",
                           px - 3, py - 3, s.colour);
        else {
            const double zero = f.py(std::clamp(0.0, f.y.from, f.y.to));
            fmt::format_to(it, "<rect x='{:.1f}' y='{:.1f}' width='{:.1f}' height='{:.1f}' fill='{}'/>",
                           px + bar_offset, std::min(py, zero), bar_width, std::abs(py - zero), s.colour);
        }
    }
}

}  // namespace

std::vector<double> axis_ticks(double from, double to, int count) {
    if (!(to > from) || count < 1 || !std::isfinite(from) || !std::isfinite(to)) return {};
    const double raw = (to - from) / count, power = std::pow(10.0, std::floor(std::log10(raw)));
    double step = 10 * power;
    for (double m : {1.0, 2.0, 5.0})
        if (m * power >= raw) {
            step = m * power;
            break;
        }
    std::vector<double> ticks;
    for (double k = std::ceil(from / step); k * step <= to * (1 + 1e-12) + 1e-300; ++k)
        ticks.push_back(k * step);
    return ticks;
}

std::string svg(const Plot& plot) {
    Frame f;
    f.width = plot.width_px;
    f.height = plot.height_px;
    int bar_series = 0;
    for (const Series& s : plot.series) {
        for (double v : s.x) f.x.include(v);
        for (double v : s.y) f.y.include(v);
        if (s.mark == Mark::bars) ++bar_series, f.y.include(0);
    }
    std::string out = fmt::format(
        "<svg xmlns='http://www.w3.org/2000/svg' viewBox='0 0 {0} {1}' width='{0}' height='{1}' role='img' "
        "aria-label='{2}'>",
        plot.width_px, plot.height_px, escape(plot.title));
    if (!f.x.valid() || !f.y.valid()) {
        out += fmt::format("<text x='{}' y='{}' text-anchor='middle'>{}: no data</text></svg>",
                           plot.width_px / 2, plot.height_px / 2, escape(plot.title));
        return out;
    }
    for (const Band& b : plot.bands) f.y.include(b.from), f.y.include(b.to);
    if (plot.categories.empty()) {
        f.x.pad(0.02);
    } else {
        f.x.from = -0.6, f.x.to = static_cast<double>(plot.categories.size()) - 0.4;
    }
    f.y.pad(0.06);
    if (plot.y_min) f.y.from = *plot.y_min;
    if (plot.y_max) f.y.to = *plot.y_max;
    if (!(f.y.span() > 0)) f.y.to = f.y.from + 1;
    if (plot.equal_scale) {
        const double wide = f.width - kLeft - kRight, high = f.height - kTop - kBottom;
        const double mm_per_px = std::max(f.x.span() / wide, f.y.span() / high);
        const double x_more = mm_per_px * wide - f.x.span(), y_more = mm_per_px * high - f.y.span();
        f.x.from -= x_more / 2, f.x.to += x_more / 2;
        f.y.from -= y_more / 2, f.y.to += y_more / 2;
    }
    for (const Band& b : plot.bands) {
        const double top = f.py(std::min(b.to, f.y.to)), bottom = f.py(std::max(b.from, f.y.from));
        out += fmt::format(
            "<rect class='band' x='{}' y='{:.1f}' width='{}' height='{:.1f}'><title>{}</title></rect>", kLeft,
            top, f.width - kLeft - kRight, std::max(0.0, bottom - top), escape(b.name));
    }
    draw_axes(out, plot, f);
    const double slot = (f.px(1) - f.px(0)) * 0.8, bar = bar_series ? slot / bar_series : 0;
    int bar_index = 0;
    for (const Series& s : plot.series) {
        const double offset = -slot / 2 + bar * bar_index;
        if (s.mark == Mark::bars) ++bar_index;
        draw_series(out, s, f, offset, bar);
    }
    double legend_x = kLeft;  // a line of its own under the title
    for (const Series& s : plot.series) {
        if (s.name.empty()) continue;
        out += fmt::format(
            "<rect x='{:.1f}' y='{}' width='12' height='{}' fill='{}'/><text x='{:.1f}' y='34'>{}</text>",
            legend_x, s.mark == Mark::bars ? 26 : 29, s.mark == Mark::bars ? 9 : 4, s.colour, legend_x + 16,
            escape(s.name));
        legend_x += 6.2 * static_cast<double>(s.name.size()) + 30;
    }
    return out + "</svg>";
}

}  // namespace seamwright::report
