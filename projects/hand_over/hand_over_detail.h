#pragma once
// Shared by the chapters of the hand-over report (hand_over.cpp, hand_over_acceptance.cpp, hand_over_panel.cpp,
// hand_over_proof.cpp).

#include <cmath>

#include "projects/hand_over/hand_over.h"
#include "projects/report/svg_plot.h"

namespace seamwright {

struct HandOverWriter {
    const Project& project;
    const Facts& facts;
    const HandOverOptions& options;
    report::Page& page;

    template <class... A>
    std::string t(const char* english, const A&... arguments) const {
        return Text::chosen(english, arguments...).in(options.language);
    }
    std::string number(double value, int decimals) const {
        return std::isfinite(value) ? fmt::format("{:.{}f}", value, decimals) : "-";
    }
    // "2024-05-01 12:00" of an ISO time.
    static std::string time_of(const std::string& utc) {
        std::string text = utc.substr(0, 16);
        if (text.size() == 16) text[10] = ' ';
        return text;
    }
    // The setup that evidence was made with is the present project's.
    bool holds(const Evidence& e) const {
        const auto then = facts.setups.find(e.setup);
        return then != facts.setups.end() && changed_since(*then->second, project).empty();
    }
    void stale_note(const Evidence& e) {
        if (!holds(e))
            page.verdict(t("stale"), report::Tone::attention,
                         t("the project was changed since {}", time_of(e.utc)));
    }
};

void regions_chapter(HandOverWriter& w);
void zero_shift_chapter(HandOverWriter& w);
void known_shift_chapter(HandOverWriter& w);
void headless_chapter(HandOverWriter& w);
// The acceptance of each region's measuring process, as its own report has it. Error: the file.
Expected<void> acceptance_chapter(HandOverWriter& w, const ProjectFile& file);
// Panel jobs as taught, and each one's last panel. Error: the file.
Expected<void> panels_chapter(HandOverWriter& w, const ProjectFile& file);

}  // namespace seamwright
