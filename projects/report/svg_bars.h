#pragma once
// Shares as horizontal bars, one a line with its name before and its figure behind: names of any length, as many as
// there are. Needs no style sheet.

#include <string>
#include <vector>

namespace seamwright::report {

struct ShareBar {
    std::string name;
    double percent = 0;  // 0..100
    const char* colour = "#0072B2";
    std::string remark = {};  // behind the figure: what the colour means
};

// An <svg> element.
std::string svg_bars(const std::string& title, const std::vector<ShareBar>& bars, int width_px = 800);

}  // namespace seamwright::report
