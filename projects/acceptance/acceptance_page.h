#pragma once
// The acceptance as it is read: one chapter a study with its indices, their 95 % limits, what is required, plots
// and verdict, in English or German. A page of blocks (report::Page) for HTML and PDF; the same chapters as text
// for the command line.

#include <functional>
#include <string>

#include "projects/acceptance/studies.h"
#include "projects/report/html.h"

namespace seamwright {

struct AcceptancePageOptions {
    Language language = Language::english;
    std::string now_utc;                                // ISO 8601; empty: the clock's
    std::string program;                                // "Seamwright 0.1.0"
    std::function<void(report::Page&, Language)> more;  // chapters after the studies
};

report::Page acceptance_page(const Acceptance& acceptance, const AcceptancePageOptions& options);

// The word of a verdict and its colour.
Text name_of(AcceptanceVerdict verdict);
report::Tone tone_of(AcceptanceVerdict verdict);

}  // namespace seamwright
