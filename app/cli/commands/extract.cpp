// seamwright extract: stripe peaks of a camera image.

#include <fmt/format.h>

#include "app/cli/command.h"
#include "core/profile/peaks.h"
#include "devices/exchange/files.h"
#include "devices/exchange/image_file.h"

namespace seamwright::cli {
namespace {

struct ExtractArguments {
    std::string image, out, method = "centre-of-gravity";
    bool rows = false, columns = false;
    PeakOptions options;
};

Expected<Answer> extract(ExtractArguments a) {
    if (a.method == "centre-of-gravity")
        a.options.method = PeakMethod::centre_of_gravity;
    else if (a.method == "gaussian")
        a.options.method = PeakMethod::gaussian;
    else
        a.options.method = PeakMethod::steger;
    Frame frame;
    if (auto read = read_image_file(a.image, frame); !read) return tl::unexpected(read.error());
    if (a.rows) {
        a.options.scan = ScanLines::rows;
    } else if (!a.columns) {
        auto guess = guess_scan_lines(frame.image);
        if (!guess) return tl::unexpected(guess.error());
        a.options.scan = *guess;
    }
    StripePeaks peaks;
    if (auto found = find_peaks(frame.image, a.options, peaks); !found) return tl::unexpected(found.error());
    std::string csv = "index,position_px,intensity,width_px,peak\n";
    int lines_with_stripe = 0;
    for (int line = 0; line < peaks.lines; ++line) {
        if (peaks.count[line]) ++lines_with_stripe;
        for (int k = 0; k < peaks.count[line]; ++k) {
            const int i = peaks.index(line, k);
            fmt::format_to(std::back_inserter(csv), "{},{:.4f},{:.1f},{:.3f},{}\n", line,
                           peaks.position_px[i], peaks.intensity[i], peaks.width_px[i], k);
        }
    }
    if (auto written = write_text_file(a.out, csv); !written) return tl::unexpected(written.error());
    const char* scan = peaks.scan == ScanLines::rows ? "rows" : "columns";
    Answer answer;
    answer.json = {{"status", lines_with_stripe ? "ok" : "no_stripe"},
                   {"scan", scan},
                   {"lines", peaks.lines},
                   {"lines_with_stripe", lines_with_stripe},
                   {"width", frame.image.width},
                   {"height", frame.image.height},
                   {"bit_depth", frame.image.bit_depth}};
    answer.text = fmt::format("{} of {} {} show the stripe\n", lines_with_stripe, peaks.lines, scan);
    answer.exit_code = lines_with_stripe ? kExitOk : kExitVerdict;
    return answer;
}

}  // namespace

void add_extract(CommandLine& line) {
    auto a = std::make_shared<ExtractArguments>();
    CLI::App* command =
        line.add("extract", "Where the laser stripe crosses each row or column of a camera image.",
                 "seamwright extract frame.png --rows --peaks 3 --out peaks.csv\n"
                 "  columns: index,position_px,intensity,width_px,peak (0 = strongest)");
    command->add_option("image", a->image, "PNG, BMP, TIFF or PGM, 8 or 16 bit")
        ->required()
        ->type_name("IMAGE");
    command->add_option("--out", a->out, "Where the peaks go")->required()->type_name("OUT.csv");
    auto* rows = command->add_flag("--rows", a->rows, "One cut per image row (stripe runs top to bottom)");
    command
        ->add_flag("--columns", a->columns,
                   "One cut per image column (stripe runs left to right); default: seen from the image")
        ->excludes(rows);
    command->add_option("--peaks", a->options.per_line, "Candidates per line, strongest first")
        ->capture_default_str()
        ->check(CLI::Range(1, 16));
    command->add_option("--method", a->method, "How the sub-pixel position is found")
        ->check(CLI::IsMember({"centre-of-gravity", "gaussian", "steger"}))
        ->capture_default_str();
    command->add_option("--threshold", a->options.threshold, "Grey value above background; 0 = automatic")
        ->capture_default_str();
    line.on(command, [a] { return extract(*a); });
}

}  // namespace seamwright::cli
