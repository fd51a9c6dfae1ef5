#pragma once
// Plots as SVG text, for reports that stand in one file without scripts.

#include <optional>
#include <string>
#include <vector>

namespace seamwright::report {

// Okabe-Ito colours; meaning is never carried by colour alone, a series has its marker or dash too.
namespace colour {
inline constexpr const char* kBlue = "#0072B2";
inline constexpr const char* kVermilion = "#D55E00";
inline constexpr const char* kGreen = "#009E73";
inline constexpr const char* kAmber = "#E69F00";
inline constexpr const char* kGrey = "#6B7280";
inline constexpr const char* kPurple = "#CC79A7";
}  // namespace colour

enum class Mark { line, dashed, dots, crosses, bars, area };  // area: a line filled down to 0

struct Series {
    std::string name;
    std::vector<double> x, y;  // equal length; non-finite points are gaps
    Mark mark = Mark::line;
    const char* colour = colour::kBlue;
};

// A shaded range of y, for limits and tolerances.
struct Band {
    double from = 0, to = 0;
    std::string name;
};

struct Plot {
    std::string title, x_label, y_label;  // labels carry the unit: "travel (mm)"
    std::vector<Series> series;
    std::vector<Band> bands;
    std::vector<std::string> categories;  // names of x = 0, 1, 2, ... instead of numbers
    bool equal_scale = false;             // maps and profiles: one mm is as long on both axes
    int width_px = 640, height_px = 320;
    std::optional<double> y_min, y_max;
};

// An <svg> element. A plot without any finite point says "no data".
std::string svg(const Plot& plot);

// Round axis steps (1, 2, 5 times a power of ten) covering [from, to]; about `count` of them.
std::vector<double> axis_ticks(double from, double to, int count);

}  // namespace seamwright::report
