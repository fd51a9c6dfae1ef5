#pragma once
// The acceptance as it is read: one chapter a study with its indices, their 95 % limits, what is required, plots
// and verdict, in English or German. A page of blocks (report::Page) for HTML and PDF; the same chapters as text
// for the command line.

#include <functional>
#include <string>

#include "projects/acceptance/study/studies.h"
#include "projects/report/html.h"

namespace seamwright {

struct AcceptancePageOptions {
    Language language = Language::english;
    std::string now_utc;                                // ISO 8601; empty: the clock's
    std::string program;                                // "Seamwright 0.1.0"
    std::function<void(report::Page&, Language)> more;  // chapters after the studies
};

report::Page acceptance_page(const Acceptance& acceptance, const AcceptancePageOptions& options);

// The chapters of that page alone, for another one: verdict, requirements, forecast, a heading of `level` a study.
void add_chapters(report::Page& page, Language language, const Acceptance& acceptance, int level = 2);
// One study's chapter, where it was made; the forecast beside what was measured, where there is one.
void add_chapter(report::Page& page, Language language, const Acceptance& acceptance, Study study,
                 int level = 2);
void add_forecast_chapter(report::Page& page, Language language, const Acceptance& acceptance, int level = 2);
void add_studies_not_done(report::Page& page, Language language, const Acceptance& acceptance, int level = 2);

// Title and first line of an acceptance of `file`, and the lines to sign at its end, under what is
// signed (nullptr: nothing was studied). Empty `now_utc`: the clock's.
report::Page begin_acceptance_page(const std::string& file, Language language, const std::string& now_utc,
                                   const std::string& program);
void add_signatures(report::Page& page, Language language, const Acceptance* acceptance);

Text title_of(Study study);
// The word of a verdict and its colour.
Text name_of(AcceptanceVerdict verdict);
report::Tone tone_of(AcceptanceVerdict verdict);

}  // namespace seamwright
