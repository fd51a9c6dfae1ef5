#pragma once
// Figures in Prometheus' text format, version 0.0.4.

#include <fmt/format.h>

#include <cmath>
#include <string>
#include <utility>

namespace seamwright::report {

class Metrics {
  public:
    void head(const char* name, const char* type, const char* help) {
        text_ += fmt::format("# HELP {} {}\n# TYPE {} {}\n", name, help, name, type);
    }
    void value(const std::string& name_and_labels, double value) {
        text_ += std::isfinite(value) ? fmt::format("{} {}\n", name_and_labels, value)
                                      : fmt::format("{} NaN\n", name_and_labels);
    }
    std::string text() { return std::move(text_); }
    // What stands between the quotes of a label.
    static std::string label(const std::string& text) {
        std::string out;
        for (const char c : text) {
            if (c == '\\' || c == '"') out += '\\';
            if (c == '\n')
                out += "\\n";
            else
                out += c;
        }
        return out;
    }

  private:
    std::string text_;
};

}  // namespace seamwright::report
