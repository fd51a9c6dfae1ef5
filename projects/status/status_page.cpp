#include <fmt/format.h>

#include <cmath>
#include <set>

#include "projects/report/html.h"
#include "projects/report/svg_plot.h"
#include "projects/status/status_board.h"

namespace seamwright {
namespace {

constexpr std::size_t kShownParts = 20;

class PageWriter {
  public:
    PageWriter(const StatusView& v, Language language)
        : v_(v), language_(language), page_(v.project, std::string(code_of(language))) {}

    std::string html() {
        state();
        parts();
        trends();
        alarms();
        page_.paragraph(fmt::format("{} · {}", v_.program, v_.now_utc));
        return page_.html_again_after(5);
    }

  private:
    template <class... A>
    std::string t(const char* english, const A&... arguments) const {
        return Text::chosen(english, arguments...).in(language_);
    }

    void state() {
        const bool bad =
            v_.state == to_string(WatchState::lost) || v_.state == to_string(WatchState::stopped);
        page_.verdict(Text::chosen(v_.state).in(language_), bad ? report::Tone::alarm : report::Tone::good,
                      v_.text);
        const WatchCounts& c = v_.counts;
        page_.table({{t("Parts"), t("Corrected"), t("Refused"), t("Failed"), t("Alarms"), t("Outages"),
                      t("Not measured"), t("Since (UTC)")},
                     {std::to_string(c.parts), std::to_string(c.corrected), std::to_string(c.refused),
                      std::to_string(c.failed), std::to_string(c.alarms), std::to_string(c.lost),
                      std::to_string(c.missed), v_.started_utc.substr(0, 19)}});
        if (v_.drift.watched) {
            const DriftStanding& d = v_.drift;
            const auto tone = d.stopped || !d.trouble.empty() || d.verdict == DriftVerdict::recalibrate
                                  ? report::Tone::alarm
                              : d.verdict == DriftVerdict::fine ? report::Tone::good
                                                                : report::Tone::attention;
            page_.verdict(t("Drift"), tone, (d.stopped ? d.trouble : said_of(d.acting)).in(language_));
            if (d.due) page_.paragraph(t("The reference is due to be measured."));
        }
        if (!v_.push) page_.paragraph(t("Dry run: nothing is written to a robot."));
        if (!v_.part.empty()) page_.paragraph(t("Part {}: spot {} of {}.", v_.part, v_.spots_done, v_.spots));
    }

    void parts() {
        page_.heading(t("Last parts"));
        report::Rows rows{{t("Time (UTC)"), t("Part"), t("Run"), t("Outcome"), t("Seconds"),
                           t("Displacement (mm)"), t("Message")}};
        for (std::size_t i = 0; i < std::min(kShownParts, v_.parts.size()); ++i) {
            const StatusPart& p = v_.parts[v_.parts.size() - 1 - i];
            std::string shifts;
            for (const StatusRegion& r : p.regions)
                if (r.xyz_mm)
                    shifts += fmt::format("{}{}: {:.2f} {:.2f} {:.2f}", shifts.empty() ? "" : "; ", r.id,
                                          r.xyz_mm->x(), r.xyz_mm->y(), r.xyz_mm->z());
            rows.push_back({p.utc.substr(11, 8), p.part, std::to_string(p.run),
                            Text::chosen(p.status).in(language_), fmt::format("{:.1f}", p.seconds), shifts,
                            p.text});
        }
        if (rows.size() > 1)
            page_.table(rows);
        else
            page_.paragraph(t("None yet."));
    }

    void trends() {
        std::set<std::string> ids;
        for (const StatusPart& p : v_.parts)
            for (const StatusRegion& r : p.regions) ids.insert(r.id);
        std::vector<std::string> plots;
        for (const std::string& id : ids) {
            report::Plot plot;
            plot.title = t("Displacement of region {}", id);
            plot.x_label = t("part");
            plot.y_label = "mm";
            plot.width_px = 560;
            plot.height_px = 260;
            for (int k = 0; k < 3; ++k) {
                constexpr const char* colours[] = {report::colour::kBlue, report::colour::kVermilion,
                                                   report::colour::kGreen};
                report::Series s{std::string(1, "XYZ"[k]),
                                 {},
                                 {},
                                 k == 1 ? report::Mark::dashed : report::Mark::line,
                                 colours[k]};
                for (std::size_t i = 0; i < v_.parts.size(); ++i)
                    for (const StatusRegion& r : v_.parts[i].regions)
                        if (r.id == id && r.xyz_mm) {
                            s.x.push_back(static_cast<double>(i + 1));
                            s.y.push_back((*r.xyz_mm)[k]);
                        }
                plot.series.push_back(std::move(s));
            }
            plots.push_back(report::svg(plot));
        }
        if (plots.empty()) return;
        page_.heading(t("Trends"));
        page_.figures(plots);
    }

    void alarms() {
        page_.heading(t("Warnings and alarms"));
        report::Rows rows{{t("Time (UTC)"), t("Level"), t("Message")}};
        for (std::size_t i = 0; i < std::min(kShownParts, v_.alarms.size()); ++i) {
            const StatusAlarm& a = v_.alarms[v_.alarms.size() - 1 - i];
            rows.push_back({a.utc.substr(0, 19), Text::chosen(a.level).in(language_), a.text});
        }
        if (rows.size() > 1)
            page_.table(rows);
        else
            page_.paragraph(t("None."));
    }

    const StatusView& v_;
    Language language_;
    report::Page page_;
};

}  // namespace

std::string status_page(const StatusView& view, Language language) {
    return PageWriter(view, language).html();
}

}  // namespace seamwright
