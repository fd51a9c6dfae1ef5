#pragma once
// The stripe model's settings on the command line.

#include "app/cli/command.h"
#include "core/profile/filter.h"

namespace seamwright::cli {

// --noise-mm, --band, --lookahead, --min-segment.
void add_filter_options(CLI::App* command, FilterOptions& options);

}  // namespace seamwright::cli
