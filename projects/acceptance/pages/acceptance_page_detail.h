#pragma once
// Shared by the chapters and the plots of the acceptance's page (acceptance_page.cpp, acceptance_plots.cpp).

#include <cmath>

#include "projects/acceptance/pages/acceptance_page.h"

namespace seamwright {

struct AcceptanceWriter {
    const Acceptance& a;
    Language language;
    report::Page& page;
    int level;  // of a study's heading

    template <class... A>
    std::string t(const char* english, const A&... arguments) const {
        return Text::chosen(english, arguments...).in(language);
    }
    void heading(const std::string& text) { page.heading(text, level); }
    std::string number(double value, int decimals) const {
        return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : "-";
    }
    void index(report::Rows& rows, const std::string& name, double value, const Interval& limits,
               int decimals, const std::string& required = {}) const {
        rows.push_back({name, number(value, decimals), number(limits.low, decimals),
                        number(limits.high, decimals), required});
    }
    report::Rows head() const {
        return {{t("Index"), t("Value"), t("from (95 %)"), t("to (95 %)"), t("Required")}};
    }
    void verdict(AcceptanceVerdict v, const std::string& why) const {
        page.verdict(name_of(v).in(language), tone_of(v), why);
    }
    void verdict(Study study, AcceptanceVerdict v, const std::string& why) const {
        const Text lacks = what_lacks(a, study);
        verdict(v, lacks.empty() ? why : lacks.in(language));
    }
    double lower() const { return a.settings.nominal_mm - a.settings.tolerance_mm / 2; }
    double upper() const { return a.settings.nominal_mm + a.settings.tolerance_mm / 2; }
};

// Type 1: the values in their order, and over the tolerance.
std::string run_chart(const AcceptanceWriter& w);
std::string histogram(const AcceptanceWriter& w);
// Type 3: every value over its part, and about its part's mean.
std::vector<std::string> parts_plots(const AcceptanceWriter& w);
// Stability: means, or with `spread` standard deviations.
std::string control_chart(const AcceptanceWriter& w, const Stability& r, bool spread);

}  // namespace seamwright
